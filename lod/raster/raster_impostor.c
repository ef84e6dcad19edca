/* Drawing impostors: see lod/impostor.h. */
#include "lod/impostor.h"
#include "lod/raster/raster_state.h"

/* Rays of pixels in plant space: middle + x across + y down, for pixels from the picture's middle; a metre of
 * depth long. */
struct rays { float middle[3], across[3], down[3]; };

/* A direction of the world in plant space, `scale` times as long. */
static void turn_back(const struct lod_place *place, const double d[3], double scale, double out[3])
{
	scale /= place->scale;
	out[0] = (d[0] * place->cosine + d[1] * place->sine) * scale;
	out[1] = (d[1] * place->cosine - d[0] * place->sine) * scale;
	out[2] = d[2] * scale;
}

static void rays_make(struct rays *rays, const struct lod_raster_state *state)
{
	const struct lod_eye *eye = &state->eye;
	double across[3], down[3], forward[3];
	turn_back(&state->place, eye->right, 2 * eye->tan_x / state->full[0], across);
	turn_back(&state->place, eye->up, -2 * eye->tan_y / state->full[1], down);
	turn_back(&state->place, eye->forward, 1, forward);
	for (int k = 0; k < 3; k++) {
		rays->across[k] = (float)across[k];
		rays->down[k] = (float)down[k];
		rays->middle[k] = (float)(forward[k] + state->shift[0] / LOD_SUBPIXEL * across[k]
			+ state->shift[1] / LOD_SUBPIXEL * down[k]);
	}
}

static void look_from(struct lod_impostor_look *look, const struct lod_impostor *impostor,
	const struct lod_raster_state *state)
{
	const struct lod_place *place = &state->place;
	double offset[3], at[3];
	float eye[3];
	for (int k = 0; k < 3; k++)
		offset[k] = state->eye.at[k] - place->at[k];
	turn_back(place, offset, 1, at);
	for (int k = 0; k < 3; k++)
		eye[k] = (float)(at[k] - (double)impostor->body.center[k]);
	lod_impostor_look(look, impostor, eye);
}

static void fill_row(struct lod_paint *paint, uint32_t item, const struct lod_impostor *impostor,
	const struct lod_impostor_look *look, const struct rays *rays, uint32_t row, uint32_t from,
	uint32_t to)
{
	const struct lod_raster *raster = paint->raster;
	float near_w = raster->state->near_w, y = (float)row + 0.5f - 0.5f * (float)raster->height;
	bool any = false;
	for (uint32_t column = from; column < to; column++) {
		float x = (float)column + 0.5f - 0.5f * (float)raster->width, ray[3];
		struct lod_impostor_hit hit;
		for (int k = 0; k < 3; k++)
			ray[k] = rays->middle[k] + y * rays->down[k] + x * rays->across[k];
		if (!lod_impostor_hit(impostor, look, ray, &hit))
			continue;
		paint->item = item + hit.cell;
		any |= lod_paint_pixel(paint, (size_t)row * raster->width + column,
			1 / (hit.along > near_w ? hit.along : near_w));
	}
	if (any)
		lod_mark_stale(paint, row, from, to);
}

void lod_raster_impostor(struct lod_raster *raster, const struct lod_impostor *impostor,
	const struct lod_raster_batch *batch)
{
	const struct lod_raster_state *state = raster->state;
	struct lod_paint paint = lod_paint_make(raster, batch);
	struct lod_outline outline;
	struct lod_impostor_look look;
	struct rays rays;
	if (!lod_ball_outline(state, impostor->body.center, (float)(impostor->radius * state->place.scale),
			&outline))
		return;
	rays_make(&rays, state);
	look_from(&look, impostor, state);
	const struct lod_ellipse *ellipse = &outline.ellipse;
	uint32_t top = lod_outline_from(outline.y - ellipse->high, raster->height),
		bottom = lod_outline_from(outline.y + ellipse->high, raster->height);
	for (uint32_t row = top; row < bottom; row++) {
		float y = (float)row + 0.5f - 0.5f * (float)raster->height - outline.y,
			half = lod_ellipse_row(ellipse, y), x = outline.x + ellipse->lean * y;
		if (half < 0)
			continue;
		uint32_t from = lod_outline_from(x - half, raster->width),
			to = lod_outline_from(x + half, raster->width);
		if (from < to)
			fill_row(&paint, batch->item, impostor, &look, &rays, row, from, to);
	}
}
