/* Impostors in memory: bodies, directions, levels. impostor_codec.c turns levels into bytes. */
#include "ecofiles/format/impostor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"

#define SIZE_MAX_M 1e6f

const struct eco_impostor_size eco_impostor_sizes[ECO_IMPOSTOR_LEVELS] = {
	{ ECO_IMPOSTOR_FEW, 16, 4, 8, 4 }, { ECO_IMPOSTOR_MANY, 32, 8, 8, 8 },
	{ ECO_IMPOSTOR_MANY, 64, 16, 16, 16 } };

/* ---- Bodies ---- */

bool eco_impostor_body_good(const struct eco_impostor_body *b)
{
	for (int k = 0; k < 3; k++)
		if (!(b->center[k] >= -SIZE_MAX_M && b->center[k] <= SIZE_MAX_M))
			return false;
	return b->wide >= 1e-6f && b->wide <= SIZE_MAX_M && b->high >= 1e-6f && b->high <= SIZE_MAX_M
		&& b->thick >= 0 && b->thick <= 2 * SIZE_MAX_M;
}

void eco_impostor_body_write(struct eco_writer *w, const struct eco_impostor_body *b)
{
	const float values[6] = { b->center[0], b->center[1], b->center[2], b->wide, b->high, b->thick };
	for (int i = 0; i < 6; i++)
		eco_write_f32(w, values[i]);
}

enum eco_code eco_impostor_body_read(struct eco_reader *r, struct eco_impostor_body *b,
	struct eco_error *error)
{
	float values[6];
	for (int i = 0; i < 6; i++)
		values[i] = eco_read_f32(r);
	*b = (struct eco_impostor_body){ { values[0], values[1], values[2] }, values[3], values[4],
		values[5] };
	if (r->failed || !eco_impostor_body_good(b))
		return eco_fail(error, ECO_DAMAGED, "impostor: a body that no plant has");
	return ECO_OK;
}

float eco_impostor_radius(const struct eco_impostor_body *b)
{
	return sqrtf(b->wide * b->wide + b->high * b->high);
}

/* ---- Directions ---- */

/* Rings are 22 or 15 degrees apart; so are directions along a ring, about. Every other ring is turned by
 * half a step. */
struct ring { uint32_t count; double elevation_deg; };
static const struct ring few[] = { { 12, 0 }, { 10, 22 }, { 8, 45 }, { 5, 67 }, { 1, 90 } };
static const struct ring many[] = { { 28, 0 }, { 24, 15 }, { 21, 30 }, { 17, 45 }, { 12, 60 }, { 6, 75 },
	{ 1, 90 } };
static const struct { const struct ring *rings; uint32_t count; } sets[] = {
	{ few, sizeof few / sizeof *few }, { many, sizeof many / sizeof *many } };

void eco_impostor_rings(enum eco_impostor_set set, struct eco_impostor_rings *rings)
{
	uint32_t first = 0;
	rings->count = sets[set].count;
	for (uint32_t i = 0; i < rings->count; i++) {
		const struct ring *ring = &sets[set].rings[i];
		struct eco_impostor_ring *out = &rings->items[i];
		*out = (struct eco_impostor_ring){ .first = first, .count = ring->count,
			.stored = i ? ring->count : ring->count / 2 };
		eco_angle16_sincos(eco_angle16_from_deg(ring->elevation_deg), &out->sine, &out->cosine);
		first += out->stored;
	}
}

uint32_t eco_impostor_tiles(enum eco_impostor_set set)
{
	struct eco_impostor_rings rings;
	eco_impostor_rings(set, &rings);
	const struct eco_impostor_ring *last = &rings.items[rings.count - 1];
	return last->first + last->stored;
}

void eco_impostor_axes(enum eco_impostor_set set, struct eco_impostor_axes out[ECO_IMPOSTOR_TILES_MAX])
{
	struct eco_impostor_axes *axes = out;
	for (uint32_t k = 0; k < sets[set].count; k++) {
		const struct ring *ring = &sets[set].rings[k];
		uint32_t stored = k ? ring->count : ring->count / 2;
		double up, flat, s, c;
		eco_angle16_sincos(eco_angle16_from_deg(ring->elevation_deg), &up, &flat);
		for (uint32_t i = 0; i < stored; i++, axes++) {
			double step = (k & 1) && ring->count > 1 ? i + 0.5 : i;
			eco_angle16_sincos((uint16_t)(65536 * step / ring->count), &s, &c);
			*axes = (struct eco_impostor_axes){ { flat * c, flat * s, up }, { -s, c, 0 },
				{ -up * c, -up * s, flat } };
		}
	}
}

double eco_impostor_reach_up(const struct eco_impostor_body *body, const struct eco_impostor_axes *axes)
{
	return (double)body->high * axes->up[2] + (double)body->wide * axes->toward[2];
}

/* ---- Levels ---- */

enum eco_code eco_impostor_level_make(struct eco_impostor_level *level, uint32_t number,
	struct eco_error *error)
{
	const struct eco_impostor_size *size = &eco_impostor_sizes[number];
	size_t tiles = eco_impostor_tiles(size->set), few_tiles = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	*level = (struct eco_impostor_level){ .level = number,
		.texel = calloc(tiles * size->texels * size->texels, 1),
		.depth = calloc(tiles * size->depths * size->depths, 1),
		.color = calloc(few_tiles * size->colors * size->colors * 3, 1) };
	if (level->texel && level->depth && level->color)
		return ECO_OK;
	eco_impostor_level_free(level);
	return eco_fail(error, ECO_NO_MEMORY, "no memory for an impostor");
}

void eco_impostor_level_free(struct eco_impostor_level *level)
{
	free(level->texel);
	free(level->depth);
	free(level->color);
	memset(level, 0, sizeof *level);
}
