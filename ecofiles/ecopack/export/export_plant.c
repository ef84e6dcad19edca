#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/ecopack/export/plant_view.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/image.h"

#define PIXELS 96u               /* a side of the picture that a level is scored in */
static const uint64_t wanted[EXPORT_LEVELS] = { 64, 1024, UINT64_MAX };

/* ---- Meshes ---- */

static void pad(struct eco_writer *file)
{
	while (file->size % 4)
		eco_write_u8(file, 0);
}

static size_t write_array(struct eco_writer *file, const struct lod_bake *bakes, const uint32_t *images,
	uint32_t count, uint32_t image, enum export_array what)
{
	size_t from = file->size;
	uint32_t before = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_bake *b = &bakes[i];
		size_t vertices = b->vertex_count;
		if (images[i] != image || !b->index_count)
			continue;
		if (what == EXPORT_POSITION)
			eco_write_bytes(file, b->position, vertices * 3 * sizeof *b->position);
		else if (what == EXPORT_COLOR)
			eco_write_bytes(file, b->color, vertices * 4 * sizeof *b->color);
		else if (what == EXPORT_UV)
			eco_write_bytes(file, b->uv, vertices * 2 * sizeof *b->uv);
		for (uint32_t k = 0; what == EXPORT_INDEX && k < b->index_count; k++)
			eco_write_u32(file, before + b->index[k]);
		before += b->vertex_count;
	}
	pad(file);
	return from;
}

static void bound(struct export_part *part, const struct lod_bake *bake)
{
	for (size_t i = 0; i < (size_t)bake->vertex_count * 3; i++) {
		part->low[i % 3] = fminf(part->low[i % 3], bake->position[i]);
		part->high[i % 3] = fmaxf(part->high[i % 3], bake->position[i]);
	}
}

void export_mesh_make(const struct export *x, struct export_mesh *mesh, struct eco_writer *file,
	const struct lod_bake *bakes, const uint32_t *images, uint32_t count)
{
	mesh->parts = eco_alloc(count, sizeof *mesh->parts);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t image = images[i], known = 0;
		if (!bakes[i].index_count)
			continue;
		for (; known < mesh->part_count && mesh->parts[known].image != image; known++)
			;
		if (known == mesh->part_count)
			mesh->parts[mesh->part_count++] = (struct export_part){ .image = image,
				.low = { INFINITY, INFINITY, INFINITY },
				.high = { -INFINITY, -INFINITY, -INFINITY } };
		mesh->parts[known].vertices += bakes[i].vertex_count;
		mesh->parts[known].indices += bakes[i].index_count;
		mesh->triangles += bakes[i].index_count / 3;
		bound(&mesh->parts[known], &bakes[i]);
	}
	for (uint32_t i = 0; i < mesh->part_count; i++) {
		struct export_part *part = &mesh->parts[i];
		for (enum export_array what = 0; what < EXPORT_ARRAYS; what++)
			if (what != EXPORT_UV || part->image != ECO_NONE)
				part->at[what] = write_array(file, bakes, images, count, part->image, what);
	}
	mesh->bytes = file->size;
	if (file->failed)
		eco_end("no memory");
	if (!x->is_plain)
		export_mesh_compress(mesh, file);
}

void export_mesh_free(struct export_mesh *mesh)
{
	free(mesh->parts);
	*mesh = (struct export_mesh){ .parts = NULL };
}

/* ---- Plants ---- */

static void bake(struct export *x, struct export_mesh *mesh, struct eco_writer *file,
	const struct plant_view_drawing *drawing)
{
	struct lod_bake *bakes = eco_alloc(drawing->count, sizeof *bakes);
	uint32_t *images = eco_alloc(drawing->count, sizeof *images);
	for (uint32_t i = 0; i < drawing->count; i++) {
		const struct plant_view_batch *b = &drawing->batches[i];
		images[i] = b->geometry.uv ? b->list->image : ECO_NONE;
		eco_check(lod_bake_make(&bakes[i], &(struct lod_bake_input){ b->list->list, b->list->palette,
			&b->geometry, b->impostor, b->count, b->area }, x->error));
	}
	export_mesh_make(x, mesh, file, bakes, images, drawing->count);
	for (uint32_t i = 0; i < drawing->count; i++)
		lod_bake_free(&bakes[i]);
	free(bakes);
	free(images);
}

static void write_images(struct export *x, const struct plant_view *plant)
{
	for (uint32_t i = 0; i < plant->list_count; i++) {
		const struct eco_image *image = &plant->lists[i].picture;
		struct eco_pixels pixels = { image->width, image->height, 4, image->rgba };
		char name[EXPORT_NAME];
		uint8_t *png = NULL;
		size_t size;
		if (!image->rgba)
			continue;
		snprintf(name, sizeof name, "plants/image-%u.png", i);
		eco_check(eco_png_encode(&pixels, &png, &size, x->error));
		export_file(x, name, png, size);
		free(png);
	}
}

/* How far a drawing is from full detail. */
static double error_of(struct plant_view *plant, const struct plant_view_drawing *drawing)
{
	const struct eco_scene *s = &plant->scene;
	const struct eco_anchor *whole = &s->anchors[s->plants[plant->number].anchor_first];
	return fmin(fmax(1 - plant_view_q(plant, drawing), 0), 1) * (double)whole->radius;
}

static void write_level(struct export *x, struct plant_view *plant, uint64_t vertices)
{
	struct export_plant *to = &x->plants[plant->number];
	struct export_mesh *mesh = &to->level[to->levels];
	struct plant_view_drawing drawing;
	struct eco_writer file = { 0 };
	char name[EXPORT_NAME];
	eco_check(plant_view_drawing_make(&drawing, plant, vertices, x->error));
	bake(x, mesh, &file, &drawing);
	snprintf(name, sizeof name, "plants/%u-%u.bin", plant->number, to->levels);
	export_file(x, name, file.bytes, file.size);
	double *error_m = &to->error_m[to->levels];
	*error_m = vertices < plant->full ? error_of(plant, &drawing) : 0;
	if (to->levels)
		*error_m = fmin(*error_m, error_m[-1]);
	to->levels++;
	plant_view_drawing_free(&drawing);
	eco_writer_free(&file);
}

void export_plant(struct export *x, uint32_t number)
{
	struct plant_view plant;
	eco_check(plant_view_open(&plant, x->pack, number, PIXELS, x->error));
	write_images(x, &plant);
	for (uint32_t i = 0; i < EXPORT_LEVELS; i++)
		if (wanted[i] == UINT64_MAX || wanted[i] * 2 <= plant.full)
			write_level(x, &plant, wanted[i] < plant.full ? wanted[i] : ECO_VERTICES_MAX);
	plant_view_close(&plant);
}
