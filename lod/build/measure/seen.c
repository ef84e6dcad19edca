#include "lod/build/measure/seen.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/geometry.h"
#include "lod/leaf.h"
#include "lod/light.h"
#include "lod/plant_light.h"
#include "lod/raster/blocks.h"
#include "lod/raster/texel.h"
#include "lod/vector.h"

#define FINEST ECO_SEEN_PX(0)    /* pixels a side of the largest size */

/* The background of plants: a mean of ground and sky. */
static const float before_open[3] = { 0.22f, 0.27f, 0.26f };
#define OVERHEAD 0.56f           /* of the usual sunlight: it comes from overhead, for a sun in any part of the sky */
#define TONE 0.53125f            /* of a plant as bright as all in the mean (plant_light) */

struct lod_seen_light { struct sunlight sun; struct plant plant; };     /* the sky's alone */
struct pixel { float light[3], cover; };        /* means over samples; light of what is covered */
struct errors { double color, contrast; };       /* sums over pixels */
/* A block's mean colour; means of lightness and of its square, which becomes the deviation. */
struct look { float lab[3], sum, squares; };
#define LOOKS 144u               /* blocks of the finest size; of others less, in all WAYS to lay blocks over them */
#define WAYS 4
/* back: what is drawn before all else, if it is; its samples have item BACK, and light. covered: pixels of
 * the finest size that the reference covers beside it. */
struct lod_seen_view {
	struct lod_raster raster, back;
	float (*light)[3];
	struct pixel *reference, *pixels;
	double covered;
	struct errors errors[ECO_SEEN_SIZES][2];
	struct look looks[ECO_SEEN_SIZES][2][LOOKS];     /* the reference's */
};
#define BACK UINT32_MAX
#define SHARE_LEAST 0.02         /* of what the whole reference covers: less of it is hardly seen */

/* Pixels of all sizes, the finest first. */
static uint32_t side_of(uint32_t size) { return FINEST >> 2 * size; }
static size_t pixels_of(uint32_t size) { return (size_t)side_of(size) * side_of(size); }
static size_t first_of(uint32_t size)
{
	size_t sum = 0;
	for (uint32_t i = 0; i < size; i++)
		sum += pixels_of(i);
	return sum;
}

static uint32_t samples_across(const struct lod_seen *seen) { return FINEST * seen->options.samples; }
static size_t samples_of(const struct lod_seen *seen)
{
	return (size_t)samples_across(seen) * samples_across(seen);
}

/* ---- Colour ---- */

/* The cube root of t > 0, by Newton's method: libm must not decide a curve. */
static float cube_root(float t)
{
	uint32_t bits;
	float root;
	memcpy(&bits, &t, sizeof bits);
	bits = bits / 3 + 709921077u;
	memcpy(&root, &bits, sizeof root);
	for (int i = 0; i < 3; i++)
		root = (2 * root + t / (root * root)) * (1.0f / 3);
	return root;
}

static float lab_part(float t) { return t > 0.008856452f ? cube_root(t) : t * 7.787037f + 0.13793103f; }

static float lightness_of(const float light[3])
{
	return 116 * lab_part(0.212671f * light[0] + 0.715160f * light[1] + 0.072169f * light[2]) - 16;
}

static void lab_of(const float light[3], float lab[3])
{
	float x = lab_part((0.412453f * light[0] + 0.357580f * light[1] + 0.180423f * light[2]) / 0.950456f),
		y = lab_part(0.212671f * light[0] + 0.715160f * light[1] + 0.072169f * light[2]),
		z = lab_part((0.019334f * light[0] + 0.119193f * light[1] + 0.950227f * light[2])
			/ 1.088754f);
	lab[0] = 116 * y - 16;
	lab[1] = 500 * (x - y);
	lab[2] = 200 * (y - z);
}

/* ---- Looks of samples ---- */

static vec3 facing(vec3 n, vec3 to_eye) { return unit(dot(n, to_eye) < 0 ? scale(n, -1) : n); }

static face facet_of(const struct lod_seen *seen, vec3 n, vec3 to_eye, float reach)
{
	n = facing(n, to_eye);
	return face(facet_sun(seen->light->sun, n), n, true, reach, 0);
}

/* A triangle's normal, or a line's that faces the eye. */
static face solid_face(const struct lod_seen *seen, const struct lod_drawing *d, const float *position, uint32_t i,
	vec3 to_eye)
{
	const float *p = position + (d->list->kind == ECO_LIST_LINES ? 6 : 9) * (size_t)i;
	vec3 a = vec3(p[3] - p[0], p[4] - p[1], p[5] - p[2]);
	if (d->list->kind == ECO_LIST_TRIANGLES)
		return facet_of(seen, cross(a, vec3(p[6] - p[0], p[7] - p[1], p[8] - p[2])), to_eye, 0);
	a = unit(a);
	vec3 n = unit(add(to_eye, scale(a, -dot(a, to_eye))));
	return face(axis_sun(seen->light->sun, a, n), n, true, 0, 0);
}

/* The normal of an ellipsoid at a point of it. */
static vec3 ball_normal(const float *half, const float *center, const double at[3])
{
	vec3 normal = vec3(0, 0, 0), from = vec3((float)(at[0] - (double)center[0]), (float)(at[1] - (double)center[1]),
		(float)(at[2] - (double)center[2]));
	for (int k = 0; k < 3; k++) {
		vec3 h = vec3(half[3 * k], half[3 * k + 1], half[3 * k + 2]);
		float square = dot(h, h);
		normal = add(normal, scale(h, square > 0 ? dot(h, from) / (square * square) : 0));
	}
	return normal;
}

/* A leaf on a splat, a point or an impostor, as clients draw it (client-min/draw/view_mesh.c). ball: the surface's
 * normal, of a splat. */
static face leaf_face(const struct lod_seen *seen, face smooth, float level, const vec3 *ball, uint32_t leaf, vec3 to_eye)
{
	uint32_t number = leaf_look(leaf), side = leaf_side(number);
	if (!leaf_is_lit(leaf, number))
		return smooth;
	vec3 turn = vec3(leaf_turn(side, 0), leaf_turn(side, 1), leaf_turn(side, 2));
	return facet_of(seen, leaf_is_level(number, leaf_level(level, to_eye.z)) ? vec3(0, 0, 1)
		: ball && leaf_is_surface(number) ? *ball : add(unit(turn), to_eye), to_eye, smooth.reach);
}

/* The own colour of a primitive: of the palette, times its texture's mean. */
static void own_color(const struct lod_seen *seen, const struct lod_drawing *d, const struct lod_geometry *g,
	uint32_t i, uint8_t rgb[3])
{
	static const uint8_t plain[3] = { 95, 127, 79 }, white[3] = { 255, 255, 255 };
	const struct lod_plant *of = seen->probe->plant;
	int32_t color = g->color[i];
	bool listed = color >= 0 && (uint32_t)color < d->list->palette_count;
	memcpy(rgb, listed ? of->palette[d->list->palette_first + (uint32_t)color]
		: d->list->image != ECO_NONE ? white : plain, 3);
	if (!g->uv)
		return;
	int32_t uv[6];
	for (size_t k = 0; k < 6; k++)
		uv[k] = (int32_t)floorf(g->uv[6 * (size_t)i + k] * ECO_UV_ONE + 0.5f);
	lod_texels_mean(&seen->texels[of->images[d->list->image]], rgb, uv, rgb);
}

static void color_drawings(struct lod_seen *seen)
{
	const struct lod_probe *probe = seen->probe;
	uint64_t need = probe->primitive_count + (probe->impostor ? probe->impostor->cell_count : 0);
	if (need > seen->rgb_capacity) {
		seen->rgb_capacity = need / 2 * 3 + 1024;
		seen->rgb = eco_realloc(seen->rgb, seen->rgb_capacity, sizeof *seen->rgb);
	}
	for (uint32_t i = 0; i < probe->drawing_count; i++) {
		const struct lod_drawing *d = &probe->drawings[i];
		struct lod_geometry g = lod_probe_geometry(probe, d);
		for (uint32_t k = 0; k < d->count; k++)
			own_color(seen, d, &g, k, seen->rgb[d->item + k]);
	}
	if (probe->impostor)
		memcpy(seen->rgb + probe->item_count, probe->impostor->rgb,
			probe->impostor->cell_count * sizeof *seen->rgb);
}

/* ---- A view ---- */

static const struct lod_drawing *drawing_of(const struct lod_probe *probe, uint32_t item)
{
	uint32_t low = 0, high = probe->drawing_count - 1;
	while (low < high) {
		uint32_t middle = low + (high - low + 1) / 2;
		if (probe->drawings[middle].item <= item)
			low = middle;
		else
			high = middle - 1;
	}
	return &probe->drawings[low];
}

/* The radius of a splat or a point over the crown's. */
static float reach_of(const struct lod_drawing *d, const struct lod_geometry *g, uint32_t i, float half_width)
{
	const float *h = g->half + 9 * (size_t)i;
	if (!g->half)
		return sqrtf(d->area * 0.3183f * (g->size ? g->size[i] : 1)) / half_width;
	float volume = fabsf(h[0] * (h[4] * h[8] - h[5] * h[7]) + h[1] * (h[5] * h[6] - h[3] * h[8])
		+ h[2] * (h[3] * h[7] - h[4] * h[6]));
	return volume > 0 ? cube_root(volume) / half_width : 0;
}

/* The surface seen of a primitive; *tone: a factor of its color, which stays 1 without leaves. */
static face face_at(const struct lod_seen *seen, uint32_t item, uint32_t leaf, float *tone, const double at[3],
	vec3 to_eye)
{
	const struct lod_probe *probe = seen->probe;
	const float deviation = (float)probe->plant->plant.leaf_tone / ECO_TONE_ONE;
	if (item >= probe->item_count) {
		float level = (float)eco_level_share(probe->plant->impostor_level);
		face smooth = face(cloud_sun(seen->light->sun, level, to_eye), to_eye, false, LOD_IMPOSTOR_REACH, 0);
		*tone = leaf ? leaf_tone(leaf, leaf_look(leaf), deviation) : 1;
		return leaf ? leaf_face(seen, smooth, level, NULL, leaf, to_eye) : smooth;
	}
	const struct lod_drawing *d = drawing_of(probe, item);
	struct lod_geometry g = lod_probe_geometry(probe, d);
	uint32_t i = item - d->item;
	if (d->list->kind != ECO_LIST_POINTS)
		return solid_face(seen, d, g.position, i, to_eye);
	bool wood = g.wood && g.wood[i] > 0;
	float level = wood ? 0 : (float)eco_level_share(d->list->level), reach = reach_of(d, &g, i, seen->light->plant.half_width);
	leaf = wood ? 0 : leaf;
	if (!g.half) {
		face smooth = face(cloud_sun(seen->light->sun, level, to_eye), to_eye, false, reach, reach);
		return leaf ? leaf_face(seen, smooth, level, NULL, leaf, to_eye) : smooth;
	}
	vec3 n = facing(ball_normal(g.half + 9 * (size_t)i, g.position + 3 * (size_t)i, at), to_eye);
	face smooth = face(ball_sun(seen->light->sun, n, level, to_eye), n, false, reach, 0);
	*tone = leaf ? leaf_tone(leaf, leaf_look(leaf), deviation) : 1;
	return leaf ? leaf_face(seen, smooth, level, &n, leaf, to_eye) : smooth;
}

static void light_sample(const struct lod_seen *seen, const struct lod_eye *eye,
	const struct lod_raster *raster, float (*behind)[3], size_t sample, float light[3])
{
	uint32_t item = raster->item[sample];
	if (item == BACK) {
		memcpy(light, behind[sample], sizeof behind[sample]);
		return;
	}
	uint32_t side = samples_across(seen);
	double u = ((double)(sample % side) + 0.5) / side * 2 - 1,
		v = 1 - ((double)(sample / side) + 0.5) / side * 2, w = 1 / (double)raster->depth[sample],
		at[3], ray[3];
	for (int k = 0; k < 3; k++) {
		ray[k] = eye->forward[k] + eye->tan_x * (u * eye->right[k] + v * eye->up[k]);
		at[k] = eye->at[k] + w * ray[k];
	}
	vec3 to_eye = unit(vec3((float)-ray[0], (float)-ray[1], (float)-ray[2])),
		own = vec3(lod_light_of[seen->rgb[item][0]] / 65535.0f, lod_light_of[seen->rgb[item][1]] / 65535.0f,
			lod_light_of[seen->rgb[item][2]] / 65535.0f);
	float tone = 1;
	face here = face_at(seen, item, raster->leaf[sample], &tone, at, to_eye);
	crown around = crown_of(seen->light->sun, seen->light->plant, here, vec3((float)at[0], (float)at[1], (float)at[2]), to_eye);
	around.sun = around.sky;
	vec3 seen_light = plant_light(seen->light->sun, seen->light->plant, scale(own, tone), here.sun, around, false);
	light[0] = seen_light.x;
	light[1] = seen_light.y;
	light[2] = seen_light.z;
}

/* Means of samples as pixels of all sizes. */
static void take_pixels(const struct lod_seen *seen, uint32_t view, struct pixel *pixels)
{
	const struct lod_seen_view *v = &seen->views[view];
	const struct lod_raster *raster = &v->raster;
	uint32_t side = samples_across(seen), each = seen->options.samples;
	float part = 1.0f / (float)(each * each);
	memset(pixels, 0, first_of(ECO_SEEN_SIZES) * sizeof *pixels);
	for (size_t i = 0; i < samples_of(seen); i++) {
		if (!raster->cover[i])
			continue;
		float light[3];
		struct pixel *pixel = &pixels[i / side / each * FINEST + i % side / each];
		light_sample(seen, &seen->eyes[view], raster, v->light, i, light);
		for (int k = 0; k < 3; k++)
			pixel->light[k] += part * light[k];
		pixel->cover += part;
	}
	for (uint32_t size = 1; size < ECO_SEEN_SIZES; size++) {
		const struct pixel *from = pixels + first_of(size - 1);
		struct pixel *to = pixels + first_of(size);
		uint32_t wide = side_of(size - 1);
		for (uint32_t i = 0; i < wide * wide; i++) {
			struct pixel *pixel = &to[i / wide / 4 * (wide / 4) + i % wide / 4];
			for (int k = 0; k < 3; k++)
				pixel->light[k] += from[i].light[k] / 16;
			pixel->cover += from[i].cover / 16;
		}
	}
}

/* ---- Blocks ---- */

static void add_pixel(struct look *look, const float light[3], float l)
{
	for (int k = 0; k < 3; k++)
		look->lab[k] += light[k];
	look->sum += l;
	look->squares += l * l;
}

/* The block whose first pixel is (x, y), in part outside the picture; empty: lightness of `before`. */
static void look_at_block(struct look *look, const struct pixel *pixels, int32_t side, const int32_t at[2],
	const float before[3], float empty)
{
	const float count = LOD_BLOCK_SIDE * LOD_BLOCK_SIDE;
	float light[3];
	*look = (struct look){ .sum = 0 };
	for (int32_t i = 0; i < (int32_t)(LOD_BLOCK_SIDE * LOD_BLOCK_SIDE); i++) {
		int32_t x = at[0] + i % (int32_t)LOD_BLOCK_SIDE, y = at[1] + i / (int32_t)LOD_BLOCK_SIDE;
		const struct pixel *pixel = x >= 0 && y >= 0 && x < side && y < side ? &pixels[y * side + x] : NULL;
		if (!pixel || !(pixel->cover > 0)) {
			add_pixel(look, before, empty);
			continue;
		}
		for (int k = 0; k < 3; k++)
			light[k] = pixel->light[k] + (1 - pixel->cover) * before[k];
		add_pixel(look, light, lightness_of(light));
	}
	for (int k = 0; k < 3; k++)
		light[k] = look->lab[k] / count;
	lab_of(light, look->lab);
	look->sum /= count;
	look->squares = sqrtf(fmaxf(look->squares / count - look->sum * look->sum, 0));
}

/* Plants stand anywhere in blocks: of small ones the mean of four ways is taken, each half a block further. Returns the
 * number of looks. */
static uint32_t look_at(struct look looks[LOOKS], const struct pixel *pixels, uint32_t size, const float before[3])
{
	const int32_t block = LOD_BLOCK_SIDE, side = (int32_t)side_of(size), ways = size ? WAYS : 1;
	const float empty = lightness_of(before);
	uint32_t count = 0;
	for (int32_t way = 0; way < ways; way++)
		for (int32_t y = way / 2 * -block / 2; y < side; y += block)
			for (int32_t x = way % 2 * -block / 2; x < side; x += block)
				look_at_block(&looks[count++], pixels + first_of(size), side, (const int32_t[2]){ x, y }, before, empty);
	return count;
}

static struct errors compare_looks(const struct look *a, const struct look *b, uint32_t count, uint32_t size)
{
	const float pixels = LOD_BLOCK_SIDE * LOD_BLOCK_SIDE;
	struct errors errors = { .color = 0 };
	for (uint32_t i = 0; i < count; i++) {
		float square = 0;
		for (int k = 0; k < 3; k++)
			square += (a[i].lab[k] - b[i].lab[k]) * (a[i].lab[k] - b[i].lab[k]);
		errors.color += (double)(pixels * sqrtf(square));
		errors.contrast += (double)(pixels * fabsf(a[i].squares - b[i].squares));
	}
	errors.color /= size ? WAYS : 1;
	errors.contrast /= size ? WAYS : 1;
	return errors;
}

/* ---- Views, several at a time ---- */

enum drawing_as { AS_BACK, AS_REFERENCE, AS_TEST };
struct drawing_views { struct lod_seen *seen; enum drawing_as as; };

/* Keeps the drawing: all others are drawn before it. */
static void take_back(struct lod_seen *seen, uint32_t view)
{
	struct lod_seen_view *v = &seen->views[view];
	struct lod_raster drawn = v->raster;
	for (size_t i = 0; i < samples_of(seen); i++)
		if (drawn.cover[i]) {
			light_sample(seen, &seen->eyes[view], &drawn, v->light, i, v->light[i]);
			drawn.item[i] = BACK;
		}
	v->raster = v->back;
	v->back = drawn;
}

static void take_reference(struct lod_seen *seen, uint32_t view)
{
	struct lod_seen_view *v = &seen->views[view];
	double own = 0, all = 0;
	take_pixels(seen, view, v->reference);
	for (size_t i = 0; i < samples_of(seen); i++) {
		all += v->raster.cover[i] != 0;
		own += v->raster.cover[i] && v->raster.item[i] != BACK;
	}
	v->covered = fmax(own, SHARE_LEAST * all) / (seen->options.samples * seen->options.samples);
}

static void take_errors(struct lod_seen *seen, uint32_t view)
{
	struct lod_seen_view *v = &seen->views[view];
	take_pixels(seen, view, v->pixels);
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++)
		for (int open = 0; open < 2; open++) {
			struct look looks[LOOKS];
			uint32_t count = look_at(looks, v->pixels, size, open ? before_open : seen->alike);
			v->errors[size][open] = compare_looks(looks, v->looks[size][open], count, size);
		}
}

static void draw_view(void *pieces, uint32_t view)
{
	const struct drawing_views *d = pieces;
	struct lod_seen *seen = d->seen;
	struct lod_raster *raster = &seen->views[view].raster;
	lod_raster_look(raster, &seen->eyes[view], seen->probe->near_m);
	if (d->as != AS_BACK && seen->has_back)
		lod_raster_merge(raster, &seen->views[view].back);
	lod_probe_draw(seen->probe, raster);
	(d->as == AS_BACK ? take_back : d->as == AS_REFERENCE ? take_reference : take_errors)(seen, view);
}

static void draw_views(struct lod_seen *seen, enum drawing_as as)
{
	const struct lod_probe_options *o = &seen->probe->options;
	color_drawings(seen);
	lod_each_run(o->each, o->ctx, seen->options.views, draw_view, &(struct drawing_views){ seen, as });
}

void lod_seen_back(struct lod_seen *seen)
{
	seen->has_back = seen->probe->primitive_count > 0;
	if (seen->has_back)
		draw_views(seen, AS_BACK);
}

void lod_seen_keep(struct lod_seen *seen)
{
	double sum[3] = { 0, 0, 0 }, covered = 0;
	draw_views(seen, AS_REFERENCE);
	for (uint32_t view = 0; view < seen->options.views; view++)
		for (size_t i = 0; i < pixels_of(0); i++) {
			const struct pixel *pixel = &seen->views[view].reference[i];
			for (int k = 0; k < 3; k++)
				sum[k] += (double)pixel->light[k];
			covered += (double)pixel->cover;
		}
	for (int k = 0; k < 3; k++)
		seen->alike[k] = covered > 0 ? (float)(sum[k] / covered) : 0;
	for (uint32_t i = 0; i < 2 * ECO_SEEN_SIZES * seen->options.views; i++) {
		struct lod_seen_view *v = &seen->views[i / 2 / ECO_SEEN_SIZES];
		uint32_t size = i / 2 % ECO_SEEN_SIZES, open = i % 2;
		look_at(v->looks[size][open], v->reference, size, open ? before_open : seen->alike);
	}
}

static uint16_t code_of(double sum, double covered)
{
	double code = covered > 0 ? sum / covered / ECO_SEEN_UNIT + 0.5 : 0;
	return (uint16_t)(code < UINT16_MAX ? code : UINT16_MAX);
}

void lod_seen_compare(struct lod_seen *seen, struct eco_seen *error)
{
	draw_views(seen, AS_TEST);
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++)
		for (int open = 0; open < 2; open++) {
			struct errors all = { .color = 0 };
			double covered = 0;
			for (uint32_t view = 0; view < seen->options.views; view++) {
				const struct errors *e = &seen->views[view].errors[size][open];
				all.color += e->color;
				all.contrast += e->contrast;
				covered += ldexp(seen->views[view].covered, -4 * (int)size);
			}
			error->color[size][open] = code_of(all.color, covered);
			error->contrast[size][open] = code_of(all.contrast, covered);
		}
}

/* ---- Set-up ---- */

void lod_seen_init(struct lod_seen *seen, struct lod_probe *probe, const struct lod_seen_options *options)
{
	const struct eco_model *model = probe->model;
	*seen = (struct lod_seen){ .probe = probe, .options = *options };
	seen->light = lod_arena_take(&seen->arena, 1, sizeof *seen->light);
	seen->light->sun = lod_usual_light;
	seen->light->sun.to = vec3(0, 0, 1);
	seen->light->sun.color = scale(lod_usual_light.color, OVERHEAD);
	seen->light->plant = lod_plant_shape((double)probe->plant->anchors[0].radius, (double)probe->plant->plant.height_m);
	seen->light->plant.tone = TONE;
	seen->texels = lod_arena_take(&seen->arena, model->image_count, sizeof *seen->texels);
	for (uint32_t i = 0; i < model->image_count; i++)
		lod_texels_open(&seen->texels[i], &model->images[i], eco_image_has_holes(&model->images[i]),
			&seen->arena);
	seen->views = lod_arena_take(&seen->arena, options->views, sizeof *seen->views);
	for (uint32_t i = 0; i < seen->options.views; i++) {
		struct lod_seen_view *v = &seen->views[i];
		v->reference = lod_arena_take(&seen->arena, first_of(ECO_SEEN_SIZES), sizeof *v->reference);
		v->pixels = lod_arena_take(&seen->arena, first_of(ECO_SEEN_SIZES), sizeof *v->pixels);
		v->light = lod_arena_take(&seen->arena, samples_of(seen), sizeof *v->light);
		lod_raster_init(&v->raster,
			&(struct lod_raster_options){ .width = samples_across(seen),
				.height = samples_across(seen),
				.item = true });
		lod_raster_init(&v->back,
			&(struct lod_raster_options){ .width = samples_across(seen),
				.height = samples_across(seen),
				.item = true });
	}
	lod_probe_eyes(probe, seen->eyes, options->views, samples_across(seen), LOD_PROBE_AROUND);
}

void lod_seen_free(struct lod_seen *seen)
{
	for (uint32_t i = 0; i < seen->options.views; i++) {
		lod_raster_free(&seen->views[i].raster);
		lod_raster_free(&seen->views[i].back);
	}
	free(seen->rgb);
	lod_arena_free(&seen->arena);
	*seen = (struct lod_seen){ .probe = NULL };
}
