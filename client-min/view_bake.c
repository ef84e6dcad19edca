#include "client-min/view_bake.h"

#include <string.h>

#include "client-min/draw/view_mesh.h"

enum eco_code view_bake_cut(struct lod_bake *bake, const struct view_list **image,
	const struct view_store *store, const struct eco_cut *cut, struct eco_error *error)
{
	struct view_mesh mesh = { .list = NULL };
	enum eco_code code = view_mesh_make(&mesh, store, cut, NULL, error);
	if (!code)
		code = lod_bake_make(bake, &(struct lod_bake_input){ &mesh.list->list, mesh.list->palette,
			&mesh.geometry, mesh.impostor, mesh.batch.count, mesh.batch.area }, error);
	*image = mesh.image;
	view_mesh_free(&mesh);
	return code;
}

const float view_bake_plain[3] = { 0.11f, 0.12f, 0.04f };

/* The image's mean around a sample, as light; the ground's own colour where it is clear. */
static void color_sample(const struct view_ground *ground, const struct view_image *image, double half_m,
	const float at[3], uint16_t color[4])
{
	const struct view_image_spot spot = { { ground->at[0] + (double)at[0], ground->at[1] + (double)at[1] },
		{ 0, 0 }, half_m };
	struct view_image_color c = view_image_at(image, &spot);
	for (int k = 0; k < 3; k++)
		color[k] = (uint16_t)(65535 * (c.alpha * c.light[k] + (1 - c.alpha) * view_bake_plain[k]));
}

enum eco_code view_bake_ground(struct lod_bake *bake, const struct view_ground *ground,
	const struct view_image *image, const struct view_ground_tile *tile, struct eco_error *error)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	uint32_t columns = tile->x.inner, rows = tile->y.inner, *index;
	enum eco_code code = lod_bake_room(bake, (size_t)columns * rows,
		(size_t)(columns - 1) * (rows - 1) * 6, false,
		error);
	if (code)
		return code;
	for (uint32_t y = 0; y < rows; y++)
		for (uint32_t x = 0; x < columns; x++)
			view_ground_place(ground, tile, view_ground_sample(tile, x, y),
				bake->position + 3 * (size_t)(y * columns + x));
	lod_bake_color(white, bake->vertex_count, bake->color);
	for (uint32_t i = 0; i < bake->vertex_count && image->count; i++)
		color_sample(ground, image, 0.5 * tile->x.stride * (double)ground->step[0], bake->position + 3 * i,
			bake->color + 4 * (size_t)i);
	index = bake->index;
	for (uint32_t y = 0; y + 1 < rows; y++)
		for (uint32_t x = 0; x + 1 < columns; x++) {
			uint32_t at = y * columns + x;
			const uint32_t cell[6] = { at, at + 1, at + columns + 1, at, at + columns + 1,
				at + columns };
			memcpy(index, cell, sizeof cell);
			index += 6;
		}
	return ECO_OK;
}
