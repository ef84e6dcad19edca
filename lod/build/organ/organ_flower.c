#include "lod/build/organ/organ_state.h"

#include "ecofiles/format/pack.h"
#include "lod/vector.h"

#define SMALL 0.7                /* of the plant's largest extent */
#define DIFFERENT 0.1            /* in chroma */
#define ALIKE 1.25               /* ratio of mean areas up to which leaves have one make */
#define KINDS 64u                /* of leaves, told apart by their number of triangles */

enum colour { DULL, GREEN, WARM, PALE, COOL };

/* Colour without brightness: the shares of red, green and blue. */
static struct lod_v3 chroma(const uint8_t rgb[3])
{
	double sum = rgb[0] + rgb[1] + rgb[2] + 1;
	return (struct lod_v3){ rgb[0] / sum, rgb[1] / sum, rgb[2] / sum };
}

static enum colour colour_of(const uint8_t rgb[3])
{
	int most = rgb[0] > rgb[1] ? rgb[0] : rgb[1], least = rgb[0] < rgb[1] ? rgb[0] : rgb[1];
	most = most > rgb[2] ? most : rgb[2];
	least = least < rgb[2] ? least : rgb[2];
	bool vivid = 10 * (most - least) > 4 * most && most > 60;
	if (lod_colour_is_green(rgb))
		return GREEN;
	if (vivid && 10 * rgb[2] > 12 * rgb[1] && 10 * rgb[2] > 4 * rgb[0])  /* crimson, pink, violet, blue */
		return COOL;
	if (vivid && rgb[2] >= rgb[1] && rgb[1] > rgb[0])
		return COOL;                         /* cyan */
	if (vivid && most > 150)
		return WARM;
	if (5 * (most - least) > most && 10 * rgb[2] > 11 * rgb[1] && rgb[0] > 140)
		return COOL;                         /* light pink */
	return least > 140 && most > 190 ? PALE : DULL;
}

struct census {
	double area[COOL + 1];       /* of small foliage, by colour */
	double greens;               /* of anything green, stems included */
	double stems, other;         /* of green wood, and of other wood */
	struct lod_v3 reference;     /* mean chroma of foliage that is no candidate, and of green stems */
	struct { double area; uint32_t count; } green[KINDS], warm[KINDS];  /* foliage by triangle count */
};

static uint32_t kind_of(const struct lod_shape *shape)
{
	return shape->triangle_count < KINDS ? shape->triangle_count : 0;
}

static struct census take_census(const uint8_t *organ, const struct lod_shape *shapes, uint32_t count,
	double extent)
{
	struct census c = { .reference = { 0, 0, 0 } };
	double weight = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_shape *b = &shapes[i];
		enum colour colour = colour_of(b->rgb);
		bool wood = organ[i] == ECO_ORGAN_WOOD;
		c.greens += colour == GREEN ? b->area : 0;
		if (wood)
			*(colour == GREEN ? &c.stems : &c.other) += b->area;
		if (!wood && b->diagonal <= SMALL * extent)
			c.area[colour] += b->area;
		if (!wood && colour == GREEN) {
			c.green[kind_of(b)].area += b->area;
			c.green[kind_of(b)].count++;
		}
		if (!wood && colour == WARM) {
			c.warm[kind_of(b)].area += b->area;
			c.warm[kind_of(b)].count++;
		}
		if (colour == GREEN || (!wood && colour == DULL)) {
			c.reference = lod_v3_add(c.reference, lod_v3_scale(chroma(b->rgb), b->area));
			weight += b->area;
		}
	}
	if (weight > 0)
		c.reference = lod_v3_scale(c.reference, 1 / weight);
	return c;
}

/* Whether components are made as green leaves are: as many triangles, about the same mean area, on twigs of
 * bark. Then they may be leaves in autumn. */
static bool is_leaf_made(const struct census *c, uint32_t kind)
{
	if (c->green[kind].count == 0 || c->warm[kind].count == 0 || c->stems > c->other)
		return false;
	double green = c->green[kind].area / c->green[kind].count,
		warm = c->warm[kind].area / c->warm[kind].count;
	return green < ALIKE * warm && warm < ALIKE * green;
}

static bool is_flower(const struct census *c, const struct lod_shape *b, enum lod_hint hint)
{
	enum colour colour = colour_of(b->rgb);
	double candidates = c->area[WARM] + c->area[PALE] + c->area[COOL];
	bool green_enough = c->greens > 0.05 * candidates;
	bool differs = lod_v3_distance(chroma(b->rgb), c->reference) > DIFFERENT || !green_enough;
	bool yellow;
	if (hint == LOD_HINT_FOLIAGE || colour == GREEN)
		return false;
	if (hint == LOD_HINT_FLOWER)
		return true;
	switch (colour) {
	case COOL: return differs && (green_enough || c->other > 0);
	case PALE: return differs && green_enough;
	case WARM:
		yellow = 10 * b->rgb[1] > 6 * b->rgb[0];
		return differs && green_enough
			&& !(is_leaf_made(c, kind_of(b)) && (yellow || c->area[WARM] > c->area[GREEN]));
	default: return false;
	}
}

void lod_flowers_find(uint8_t *organ, const struct lod_shape *shapes, uint32_t count, const bool *fixed,
	const enum lod_hint *hint, double extent)
{
	struct census c = take_census(organ, shapes, count, extent);
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_shape *b = &shapes[i];
		bool candidate = organ[i] == ECO_ORGAN_FOLIAGE && !fixed[i] && b->diagonal <= SMALL * extent;
		if (candidate && is_flower(&c, b, hint[i]))
			organ[i] = ECO_ORGAN_FLOWER;
	}
}
