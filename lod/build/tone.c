#include "lod/build/tone.h"

#include <math.h>
#include <string.h>

#include "lod/build/foliage.h"
#include "lod/build/model_draw.h"
#include "lod/light.h"
#include "lod/raster/raster.h"

#define VIEWS 8u
#define PIXELS 160u              /* of a side: in all about as many hits as a large crown has leaves */
#define AWAY 16.0                /* radii */
#define BATCH 4096u
/* Each of the first FIRST_BLOCK points stands for the whole plant; a later one the more for its own part of
 * it. */
#define FIRST_BLOCK 8u
/* A block's light changes at least by this factor, at most by its inverse. */
#define LEAST_RATIO 0.25

/* ---- Visibility ---- */

static void eye_from(struct lod_eye *eye, const double from[3], const double center[3], double radius)
{
	double flat = sqrt(from[0] * from[0] + from[1] * from[1]), half = 1 / sqrt(AWAY * AWAY - 1);
	double right[3] = { flat > 1e-9 ? -from[1] / flat : 1, flat > 1e-9 ? from[0] / flat : 0, 0 };
	*eye = (struct lod_eye){ .tan_x = half, .tan_y = half, .pixel_rad = 2 * half / PIXELS };
	for (int k = 0; k < 3; k++) {
		int a = (k + 1) % 3, c = (k + 2) % 3;
		eye->at[k] = center[k] + AWAY * radius * from[k];
		eye->right[k] = right[k];
		eye->up[k] = from[a] * right[c] - from[c] * right[a];
		eye->forward[k] = -from[k];
	}
}

static double sphere(const struct lod_mesh *mesh, double center[3])
{
	double far = 0;
	for (int k = 0; k < 3; k++)
		center[k] = 0.5 * ((double)mesh->low[k] + mesh->high[k]);
	for (int k = 0; k < 3; k++)
		far += (mesh->high[k] - center[k]) * (mesh->high[k] - center[k]);
	return far > 0 ? sqrt(far) : 1;
}

static void draw_mesh(const void *ctx, struct lod_raster *raster)
{
	const struct lod_mesh *mesh = ctx;
	float position[9 * BATCH];
	for (uint32_t t = 0, n = 0; t < mesh->triangle_count; t++) {
		for (uint32_t c = 0; c < 3; c++)
			for (uint32_t a = 0; a < 3; a++)
				position[9 * n + 3 * c + a] = (float)(mesh->origin[a]
					+ mesh->step * mesh->grid[3 * (size_t)mesh->index[3 * (size_t)t + c]
					+ a]);
		if (++n < BATCH && t + 1 < mesh->triangle_count)
			continue;
		lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = n, .position = position,
			.item = t + 1 - n, .owner = 1 });
		n = 0;
	}
}

void lod_tone_count(uint32_t *seen, const struct lod_tone_views *views)
{
	struct lod_raster raster;
	double directions[VIEWS][3];
	lod_raster_init(&raster, &(struct lod_raster_options){ .width = PIXELS, .height = PIXELS, .item = true });
	lod_directions_spread(directions, VIEWS, 1);
	for (uint32_t v = 0; v < VIEWS; v++) {
		struct lod_eye eye;
		eye_from(&eye, directions[v], views->center, views->radius);
		lod_raster_look(&raster, &eye, (AWAY - 4) * views->radius);
		views->draw(views->ctx, &raster);
		for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++) {
			uint32_t item = raster.cover[i] ? raster.item[i] : 0,
				name = !raster.cover[i] ? 0 : views->names ? views->names[item] : item + 1;
			if (name)
				seen[name - 1]++;
		}
	}
	lod_raster_free(&raster);
}

void lod_tone_seen(uint32_t *seen, const struct lod_tone_input *input, struct lod_arena *arena)
{
	uint32_t count = input->elements->count;
	struct lod_arena_piece *mark = arena->last;
	uint32_t *names = lod_arena_take(arena, input->mesh->triangle_count, sizeof *names);
	struct lod_tone_views views = { .draw = draw_mesh, .ctx = input->mesh, .names = names };
	views.radius = sphere(input->mesh, views.center);
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = 0; k + 2 < input->elements->items[i].corners; k++)
			names[input->elements->items[i].triangle[k]] = i + 1;
	memset(seen, 0, count * sizeof *seen);
	lod_tone_count(seen, &views);
	lod_arena_release(arena, mark);
}

/* ---- Levelling tones ---- */

struct colors { uint8_t rgb[LOD_TONE_COLORS][3]; uint32_t count; bool all; };

static void find_colors(struct colors *colors, const uint8_t (*rgb)[3], uint32_t count)
{
	colors->count = 0;
	colors->all = true;
	for (uint32_t i = 0; i < count && colors->all; i++) {
		uint32_t k = 0;
		while (k < colors->count && memcmp(colors->rgb[k], rgb[i], 3) != 0)
			k++;
		colors->all = k < LOD_TONE_COLORS;
		if (k == colors->count && colors->all)
			memcpy(colors->rgb[colors->count++], rgb[i], 3);
	}
}

static const uint8_t *nearest(const struct colors *colors, const double light[3])
{
	uint32_t best = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < colors->count; i++) {
		double distance = 0;
		for (int k = 0; k < 3; k++) {
			double d = lod_light_of[colors->rgb[i][k]] - light[k];
			distance += d * d;
		}
		if (distance < least) {
			least = distance;
			best = i;
		}
	}
	return colors->rgb[best];
}

/* The change of a block's colours: multiplied by `ratio`, then mixed with `whole` by 1 - own. */
struct change { double ratio[3], whole[3], own; };

/* With given colours the nearest is taken, and the rest of the error carries over to the next element. */
static void apply(const struct change *change, uint8_t (*rgb)[3], const double *area, uint32_t count,
	const struct colors *colors, double owed[3])
{
	for (uint32_t i = 0; i < count; i++) {
		double light[3];
		for (int k = 0; k < 3; k++)
			light[k] = change->own * change->ratio[k] * lod_light_of[rgb[i][k]]
				+ (1 - change->own) * change->whole[k];
		if (colors->all && area[i] > 0) {
			double wanted[3];
			for (int k = 0; k < 3; k++)
				wanted[k] = light[k] + owed[k] / area[i];
			memcpy(rgb[i], nearest(colors, wanted), 3);
			for (int k = 0; k < 3; k++) {
				double most = 65535 * area[i];
				owed[k] =
					fmax(-most,
					fmin(most, owed[k] + area[i] * (light[k] - lod_light_of[rgb[i][k]])));
			}
		} else if (!colors->all) {
			for (int k = 0; k < 3; k++)
				rgb[i][k] = lod_light_byte(light[k]);
		}
	}
}

/* If few are drawn all of them are visible, if all are drawn only the unhidden ones: so blocks weigh by area,
 * then by pixels. */
void lod_tone_level(uint8_t (*rgb)[3], const double *area, const uint32_t *seen, uint32_t count)
{
	struct lod_light whole = { { 0, 0, 0 }, 0 };
	struct colors colors;
	double area_sum = 0, owed[3] = { 0, 0, 0 };
	for (uint32_t i = 0; i < count; i++) {
		lod_light_add(&whole, rgb[i], seen[i]);
		area_sum += area[i];
	}
	if (!(whole.weight > 0) || !(area_sum > 0))
		return;
	find_colors(&colors, (const uint8_t (*)[3])rgb, count);
	for (uint32_t first = 0, end; first < count; first = end) {
		struct lod_light block = { { 0, 0, 0 }, 0 };
		struct change c;
		end = first < FIRST_BLOCK ? FIRST_BLOCK : 2 * first;
		end = end < count && end >= first ? end : count;
		double share = (double)end / count;
		for (uint32_t i = first; i < end; i++)
			lod_light_add(&block, rgb[i],
				(1 - share) * area[i] / area_sum + share * seen[i] / whole.weight);
		c.own = 1 - (double)FIRST_BLOCK / (end > FIRST_BLOCK ? end : FIRST_BLOCK);
		for (int k = 0; k < 3; k++) {
			c.whole[k] = whole.sum[k] / whole.weight;
			c.ratio[k] = block.sum[k] > 0 ? c.whole[k] / (block.sum[k] / block.weight) : 1;
			c.ratio[k] = fmax(LEAST_RATIO, fmin(1 / LEAST_RATIO, c.ratio[k]));
		}
		apply(&c, rgb + first, area + first, end - first, &colors, owed);
	}
}
