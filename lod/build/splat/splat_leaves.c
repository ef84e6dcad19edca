/* Figures of a plant's own leaves that leaves drawn on splats follow (lod/leaf.h): how wide they are, and how much of their
 * difference is shade. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "lod/build/model_draw.h"
#include "lod/build/splat/splat_fit.h"
#include "lod/vector.h"

#define VIEWS 8u                 /* each looked from, and lit from each of the others */
#define PIXELS 256u              /* a side */
#define BLOCK 16u                /* pixels: deviations are those within blocks, as eyes and s16 see them */
#define FEW 16u                  /* of leaves in a block: too few for a deviation */
#define AWAY 512.0               /* of the camera, radii: as good as orthographic */
#define BIAS 3.0                 /* pixels that a leaf may slope by within one */

uint8_t lod_deviation_code(double deviation)
{
	double code = deviation * ECO_DEVIATION_ONE + 0.5;
	return (uint8_t)(code < 255 ? code : 255);
}

/* The mean by area of the width of the square that a leaf covers as seen from all sides, half its area. */
static void measure_width(struct eco_plant *plant, const struct lod_leaf_parts *parts)
{
	double area = 0, square = 0;
	for (uint32_t c = 0; c < parts->mesh->component_count; c++) {
		const struct lod_component *leaf = &parts->organs->components[c];
		if (leaf->organ == ECO_ORGAN_WOOD)
			continue;
		double own = 0;
		for (uint32_t i = parts->mesh->member_first[c]; i < parts->mesh->member_first[c + 1]; i++)
			own += parts->organs->area[parts->mesh->member[i]];
		area += own;
		square += own * own;
	}
	if (!(area > 0))
		return;
	double width = sqrt(0.5 * square / area) / ECO_LEAF_UNIT_M + 0.5;
	plant->leaf_width = (uint16_t)(width < 1 ? 1 : width < UINT16_MAX ? width : UINT16_MAX);
}

/* ---- Shade ---- */

struct look { struct lod_raster raster; struct lod_eye eye; };
struct shades { struct look looks[VIEWS]; const struct lod_leaf_parts *parts; double radius, center[3]; };

static void look_from(struct shades *s, uint32_t i, double x, double y, const struct lod_mask *masks)
{
	struct look *look = &s->looks[i];
	double z = 0.95 * (i + 0.5) / VIEWS, flat = sqrt(1 - z * z);
	const double forward[3] = { -flat * x, -flat * y, -z }, right[3] = { -y, x, 0 }, up[3] = { -z * x, -z * y, flat };
	look->eye = (struct lod_eye){ .tan_x = 1 / AWAY, .tan_y = 1 / AWAY, .pixel_rad = 2 / AWAY / PIXELS };
	for (int k = 0; k < 3; k++) {
		look->eye.at[k] = s->center[k] - AWAY * s->radius * forward[k];
		look->eye.forward[k] = forward[k];
		look->eye.right[k] = right[k];
		look->eye.up[k] = up[k];
	}
	lod_raster_init(&look->raster, &(struct lod_raster_options){ .width = PIXELS, .height = PIXELS, .item = true });
	lod_raster_look(&look->raster, &look->eye, (AWAY - 2) * s->radius);
	lod_model_draw(s->parts->model, masks, &look->raster);
}

/* Whether what `from` shows at pixel i is also what `sun` shows there. */
static bool is_lit(const struct shades *s, const struct look *from, const struct look *sun, size_t i)
{
	double w = 1 / (double)from->raster.depth[i], p[3],
		x = ((double)(i % PIXELS) + 0.5) / PIXELS * 2 - 1, y = 1 - ((double)(i / PIXELS) + 0.5) / PIXELS * 2;
	for (int k = 0; k < 3; k++)
		p[k] = from->eye.at[k] + w * (from->eye.forward[k] + (x * from->eye.right[k] + y * from->eye.up[k]) / AWAY)
			- sun->eye.at[k];
	double far = lod_dot(p, sun->eye.forward), column = (lod_dot(p, sun->eye.right) * AWAY / far + 1) * PIXELS / 2,
		row = (1 - lod_dot(p, sun->eye.up) * AWAY / far) * PIXELS / 2;
	if (!(column >= 0 && row >= 0 && column < PIXELS && row < PIXELS))
		return true;
	size_t at = (size_t)row * PIXELS + (size_t)column;
	return !(sun->raster.depth[at] > 0) || sun->raster.item[at] == from->raster.item[i]
		|| 1 / (double)sun->raster.depth[at] > far - BIAS * 2 * s->radius / PIXELS;
}

/* Sums over a block of leaves that are seen: how many, and of these lit. */
static void count_block(const struct shades *s, const struct look *from, const struct look *sun, size_t first,
	uint32_t *seen, uint32_t *lit)
{
	*seen = *lit = 0;
	for (size_t n = 0; n < BLOCK * BLOCK; n++) {
		size_t i = first + n / BLOCK * PIXELS + n % BLOCK;
		if (!from->raster.cover[i] || s->parts->organ[from->raster.item[i]] == ECO_ORGAN_WOOD)
			continue;
		++*seen;
		*lit += is_lit(s, from, sun, i);
	}
}

/* The deviation within blocks of what is lit, over the mean. */
static double shade_of(const struct shades *s)
{
	double variance = 0, weight = 0, light = 0;
	for (uint32_t n = 0; n < VIEWS * VIEWS; n++)
		for (uint32_t b = 0; b < PIXELS / BLOCK * (PIXELS / BLOCK) && n / VIEWS != n % VIEWS; b++) {
			uint32_t seen, lit, blocks = PIXELS / BLOCK;
			count_block(s, &s->looks[n / VIEWS], &s->looks[n % VIEWS],
				(size_t)(b / blocks) * BLOCK * PIXELS + b % blocks * BLOCK, &seen, &lit);
			if (seen < FEW)
				continue;
			variance += (double)lit * (seen - lit) / seen;
			light += lit;
			weight += seen;
		}
	return light > 0 ? sqrt(variance * weight) / light : 0;
}

void lod_plant_measure_leaves(struct eco_plant *plant, const struct lod_leaf_parts *parts)
{
	struct lod_arena arena = { 0 };
	measure_width(plant, parts);
	struct shades *s = eco_alloc(1, sizeof *s);
	s->parts = parts;
	s->radius = lod_model_sphere(parts->model, s->center);
	if (plant->leaf_width && s->radius > 0) {
		const struct lod_mask *masks = lod_model_masks(parts->model, &arena);
		double x = 0.6, y = 0.8;
		for (uint32_t i = 0; i < VIEWS; i++, lod_turn_golden(&x, &y))
			look_from(s, i, x, y, masks);
		plant->leaf_shade = lod_deviation_code(shade_of(s));
		for (uint32_t i = 0; i < VIEWS; i++)
			lod_raster_free(&s->looks[i].raster);
	}
	free(s);
	lod_arena_free(&arena);
}
