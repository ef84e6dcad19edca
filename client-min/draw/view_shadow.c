#include "client-min/draw/view_shadow.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/order.h"
#include "lod/vec3.h"

/* ---- What view_shadow.glsl is written in ---- */

#include "lod/glsl.h"

typedef struct shadow_row shadow_row;
typedef struct shadow_map shadow_map;
typedef struct shadow_eye shadow_eye;
typedef struct shadow_cell shadow_cell;
typedef struct shadow_range shadow_range;
typedef struct shadow_sides shadow_sides;
typedef struct shadow_extent shadow_extent;
typedef struct shadow_spot shadow_spot;
typedef struct shadow_light shadow_light;
#define cells const struct shadow_cell *
#define tops const struct view_shadow *
#define shadow_row(...) ((struct shadow_row){ __VA_ARGS__ })
#define shadow_map(...) ((struct shadow_map){ __VA_ARGS__ })
#define shadow_range(...) ((struct shadow_range){ __VA_ARGS__ })
#define shadow_sides(...) ((struct shadow_sides){ __VA_ARGS__ })
#define shadow_extent(...) ((struct shadow_extent){ __VA_ARGS__ })
#define shadow_spot(...) ((struct shadow_spot){ __VA_ARGS__ })
#define shadow_light(...) ((struct shadow_light){ __VA_ARGS__ })

#include "client-min/draw/view_shadow.glsl"
#include "lod/glsl_end.h"

static int cells_count(cells c) { return c ? VIEW_SHADOW_CELLS * VIEW_SHADOW_CELLS : 0; }
static struct shadow_cell cells_at(cells c, int i) { return c[i]; }

static bool tops_below(tops t, float x, float y, float height)
{
	return height >= t->top[(size_t)y * t->size + (size_t)x];
}

/* ---- Making ---- */

static vec3 vec_of(const double v[3]) { return vec3((float)v[0], (float)v[1], (float)v[2]); }

static struct shadow_eye eye_of(const struct lod_eye *eye)
{
	return (struct shadow_eye){ vec_of(eye->right), vec_of(eye->up), vec_of(eye->forward),
		(float)eye->tan_x, (float)eye->tan_y };
}

static void note_pixel(struct shadow_cell *cell, float depth, bool plant)
{
	if (!(depth > 0))
		return;
	cell->nearest = depth > cell->nearest ? depth : cell->nearest;
	cell->farthest = depth < cell->farthest ? depth : cell->farthest;
	if (plant && depth < cell->plant)
		cell->plant = depth;
}

/* The cell (column, row) holds the pixels from column * width / VIEW_SHADOW_CELLS on, and so down. */
static void fill_cell(const struct view_picture *p, uint32_t column, uint32_t row, struct shadow_cell *cell)
{
	uint32_t west = column * p->width / VIEW_SHADOW_CELLS, east = (column + 1) * p->width / VIEW_SHADOW_CELLS,
		north = row * p->height / VIEW_SHADOW_CELLS, south = (row + 1) * p->height / VIEW_SHADOW_CELLS;
	float across = 2 / (float)p->width, down = 2 / (float)p->height;
	*cell = (struct shadow_cell){ (float)west * across - 1, (float)east * across - 1,
		1 - (float)south * down, 1 - (float)north * down, 0, NOTHING, NOTHING };
	for (uint32_t y = north; y < south; y++)
		for (uint32_t x = west; x < east; x++) {
			size_t i = (size_t)y * p->width + x;
			note_pixel(cell, p->depth[i], p->owner[i]);
		}
}

static void fill_cells(const struct view_picture *p, struct shadow_cell *cell)
{
	for (uint32_t row = 0; row < VIEW_SHADOW_CELLS; row++)
		for (uint32_t column = 0; column < VIEW_SHADOW_CELLS; column++)
			fill_cell(p, column, row, cell++);
}

/* False: nothing is seen. */
static bool find_map(struct view_shadow *shadow, const struct view_shadow_job *job)
{
	struct shadow_cell cell[VIEW_SHADOW_CELLS * VIEW_SHADOW_CELLS];
	fill_cells(job->picture, cell);
	struct shadow_map map = map_of(cell, eye_of(job->eye), vec3(job->sun[0], job->sun[1], job->sun[2]),
		job->kind == VIEW_SHADOWS_PERSPECTIVE, (float)job->size);
	_Static_assert(offsetof(struct shadow_map, size) == sizeof shadow->row, "a map is its rows");
	memcpy(shadow->row, &map, sizeof shadow->row);
	return map.up.slope.z > 0;
}

enum eco_code view_shadow_make(struct view_shadow *shadow, const struct view_shadow_job *job,
	struct eco_error *error)
{
	*shadow = (struct view_shadow){ .size = job->size };
	if (!(job->sun[2] > VIEW_SHADOW_LOWEST) || !job->casters->instance_count || !find_map(shadow, job))
		return ECO_OK;
	shadow->top = malloc((size_t)job->size * job->size * sizeof *shadow->top);
	if (!shadow->top)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a shadow map of %u x %u texels",
			job->size, job->size);
	enum eco_code code = view_shadow_cast(shadow, job, error);
	if (code)
		view_shadow_free(shadow);
	return code;
}

void view_shadow_free(struct view_shadow *shadow)
{
	free(shadow->top);
	*shadow = (struct view_shadow){ 0 };
}

/* ---- Looking up ---- */

static struct shadow_map map_in(const struct view_shadow *shadow)
{
	struct shadow_map map = { .size = (float)shadow->size };
	memcpy(&map, shadow->row, sizeof shadow->row);
	return map;
}

bool view_shadow_place(const struct view_shadow *shadow, const float to[3], float texel[2])
{
	struct shadow_spot spot = spot_of(map_in(shadow), vec3(to[0], to[1], to[2]));
	texel[0] = spot.x;
	texel[1] = spot.y;
	return shadow->top && spot.w > 0;
}

float view_shadow_lit(const struct view_shadow *shadow, const float to[3], const float normal[3],
	float *texel_m)
{
	if (!shadow->top)
		return -1;
	struct shadow_light light = shadow_at(map_in(shadow), shadow, vec3(to[0], to[1], to[2]),
		normal ? vec3(normal[0], normal[1], normal[2]) : vec3(0, 0, 0), normal);
	*texel_m = light.texel_m;
	return light.lit;
}

/* ---- How fine it is ---- */

struct pair { double depth, texels; };

ECO_ORDER(by_texels, struct pair, ->texels)

ECO_ORDER_FALLING(by_nearness, struct pair, ->depth)

/* From the eye to the ground that a pixel shows, if it does. */
static bool ground_at(const struct view_picture *p, const struct lod_eye *eye, uint32_t x, uint32_t y,
	float to[3])
{
	size_t i = (size_t)y * p->width + x;
	double ray[3];
	view_picture_ray(p, eye, x, y, ray);
	for (int k = 0; k < 3; k++)
		to[k] = (float)(ray[k] / (double)p->depth[i]);
	return !p->owner[i] && p->depth[i] > 0;
}

/* Texels between a pixel of the ground and the one to its right or below it, whichever are more. */
static bool pair_at(const struct view_shadow *shadow, const struct view_picture *p, const struct lod_eye *eye,
	const uint32_t at[2], struct pair *pair)
{
	float texel[3][2], to[3];
	pair->texels = 0;
	for (int i = 0; i < 3; i++) {
		if (!ground_at(p, eye, at[0] + (i == 1), at[1] + (i == 2), to)
				|| !view_shadow_place(shadow, to, texel[i]))
			return false;
		pair->texels = fmax(pair->texels, hypot((double)(texel[i][0] - texel[0][0]),
			(double)(texel[i][1] - texel[0][1])));
	}
	pair->depth = (double)p->depth[(size_t)at[1] * p->width + at[0]];
	return true;
}

double view_shadow_sharpness(const struct view_shadow *shadow, const struct view_picture *picture,
	const struct lod_eye *eye)
{
	size_t count = 0, near;
	struct pair *pairs = malloc((size_t)picture->width * picture->height * sizeof *pairs);
	double median = NAN;
	for (uint32_t y = 0; pairs && y + 1 < picture->height; y += 3)
		for (uint32_t x = 0; x + 1 < picture->width; x += 3)
			count += pair_at(shadow, picture, eye, (const uint32_t[2]){ x, y }, &pairs[count]);
	near = count / 10;
	if (near) {
		qsort(pairs, count, sizeof *pairs, by_nearness);
		qsort(pairs, near, sizeof *pairs, by_texels);
		median = pairs[near / 2].texels;
	}
	free(pairs);
	return median;
}
