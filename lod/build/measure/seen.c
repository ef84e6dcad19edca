#include "lod/build/measure/seen.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/geometry.h"
#include "lod/leaf.h"
#include "lod/light.h"
#include "lod/raster/blocks.h"
#include "lod/raster/texel.h"
#include "lod/vector.h"

#define FINEST ECO_SEEN_PX(0)    /* pixels a side of the largest size */

/* Light that comes from the whole sky, from overhead, and from the ground, about as on a fine day
 * (client-min/draw/view_light.c), but alike from all sides; and what plants are seen before: the ground,
 * the sky and their means. */
static const float sky[3] = { 0.36f, 0.42f, 0.52f }, overhead[3] = { 0.95f, 0.88f, 0.75f },
			earth[3] = { 0.20f, 0.19f, 0.11f };
static const float before_open[3] = { 0.22f, 0.27f, 0.26f };
#define SEEN_DEPTH 0.14          /* radii of a splat: how far behind it its leaves are in the mean */
#define IMPOSTOR_REACH 0.3f /* the same for an impostor, in radii of the crown (client-min/view_record.c) */
#define TAKES 0.8f               /* of a crown: Beer's exponent for a radius of the way out upwards */

struct pixel { float light[3], cover; };        /* means over samples; light of what is covered */
struct errors { double color, contrast; };       /* sums over pixels */
/* back: what is drawn before all else, if it is; its samples have item BACK, and light. covered: pixels of
 * the finest size that the reference covers beside it. */
struct lod_seen_view {
	struct lod_raster raster, back;
	float (*light)[3];
	struct pixel *reference, *pixels;
	double covered;
	struct errors errors[ECO_SEEN_SIZES][2];
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

/* exp(-x), x >= 0, within 1e-4 (view_light.glsl). */
static float fade(float x)
{
	float y = fminf(x, 64) / 16, e = 1 / (1 + y * (1 + y * (0.5f + y * (1.0f / 6 + y / 24))));
	e *= e;
	e *= e;
	e *= e;
	return e * e;
}

/* Height of the seen side's normal; light from overhead on it, and through it; radius of what stands for
 * leaves, over the crown's. */
struct look { float n_z, on, through, reach; };

static struct look facet_look(float n_z)
{
	return (struct look){ n_z, fmaxf(n_z, 0), fmaxf(-n_z, 0), 0 };
}

/* The mean over leaves of all directions of which a share lies level; as view_light.glsl has it for a sun
 * overhead. */
static struct look cloud_look(float level, float rise)
{
	float c = fminf(fmaxf(rise, -1), 1), sine = sqrtf(fmaxf(1 - c * c, 0)),
		away = (float)lod_arc_cosine((double)c), u = 0.2122066f, lying = level * fabsf(rise),
		side = rise < 0 ? -1 : 1;
	struct look all = { 0.667f * rise, u * (sine + (3.1415927f - away) * c), u * (sine - away * c), 0 };
	lying /= lying + fmaxf(0.5f * (1 - level), 1e-3f);
	return (struct look){ all.n_z + lying * (side - all.n_z), all.on + lying * (fmaxf(side, 0) - all.on),
		all.through + lying * (fmaxf(-side, 0) - all.through), 0 };
}

static struct look mixed(struct look a, struct look b, float t)
{
	return (struct look){ a.n_z + t * (b.n_z - a.n_z), a.on + t * (b.on - a.on),
		a.through + t * (b.through - a.through), 0 };
}

static void cross3(const float a[3], const float b[3], float out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static float unit_z(const float n[3], const double to_eye[3])
{
	float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	double side = (double)n[0] * to_eye[0] + (double)n[1] * to_eye[1] + (double)n[2] * to_eye[2];
	return length > 0 ? (side < 0 ? -n[2] : n[2]) / length : 0;
}

/* A triangle's normal, or a line's that faces the eye. */
static struct look solid_look(const struct lod_drawing *d, const float *position, uint32_t i,
	const double to_eye[3])
{
	const float *p = position + (d->list->kind == ECO_LIST_LINES ? 6 : 9) * (size_t)i;
	float a[3] = { p[3] - p[0], p[4] - p[1], p[5] - p[2] }, n[3], square = 0, along = 0;
	if (d->list->kind == ECO_LIST_TRIANGLES) {
		cross3(a, (const float[3]){ p[6] - p[0], p[7] - p[1], p[8] - p[2] }, n);
		return facet_look(unit_z(n, to_eye));
	}
	for (int k = 0; k < 3; k++) {
		square += a[k] * a[k];
		along += a[k] * (float)to_eye[k];
	}
	for (int k = 0; k < 3; k++)
		n[k] = (float)to_eye[k] - (square > 0 ? along / square : 0) * a[k];
	struct look look = facet_look(unit_z(n, to_eye));
	return (struct look){ 0.785f * look.n_z, 0.785f * look.on, 0.785f * look.through, 0 };
}

/* The normal of an ellipsoid at a point of it. */
static void ball_normal(const float *half, const float *center, const double at[3], float out[3])
{
	out[0] = out[1] = out[2] = 0;
	for (int k = 0; k < 3; k++) {
		const float *h = half + 3 * k;
		float square = h[0] * h[0] + h[1] * h[1] + h[2] * h[2], along = 0;
		for (int i = 0; i < 3; i++)
			along += h[i] * (float)(at[i] - (double)center[i]);
		for (int i = 0; i < 3; i++)
			out[i] += square > 0 ? along / (square * square) * h[i] : 0;
	}
}

/* A leaf on a splat or a point, as clients draw it. */
static struct look leaf_look_of(struct look smooth, float level, const float *normal, uint32_t leaf,
	const double to_eye[3])
{
	uint32_t number = leaf_look(leaf), side = leaf_side(number);
	float turn[3], square = 0;
	if (!leaf_is_lit(leaf, number))
		return smooth;
	if (leaf_is_level(number, leaf_level(level, (float)to_eye[2])))
		return facet_look(to_eye[2] < 0 ? -1 : 1);
	for (uint32_t k = 0; k < 3; k++) {
		turn[k] = leaf_turn(side, k);
		square += turn[k] * turn[k];
	}
	if (normal && leaf_is_surface(number))
		return facet_look(unit_z(normal, to_eye));
	for (int k = 0; k < 3; k++)
		turn[k] = turn[k] / sqrtf(square) + (float)to_eye[k];
	return facet_look(unit_z(turn, to_eye));
}

static struct look soft_look(const struct lod_drawing *d, const struct lod_geometry *g, uint32_t i,
	uint32_t leaf, const double at[3], const double to_eye[3])
{
	float level = g->wood && g->wood[i] > 0 ? 0 : (float)eco_level_share(d->list->level), normal[3];
	struct look look = cloud_look(level, (float)to_eye[2]);
	if (g->half) {
		ball_normal(g->half + 9 * (size_t)i, g->position + 3 * (size_t)i, at, normal);
		look = mixed(look, facet_look(unit_z(normal, to_eye)), 0.5f);
	}
	return leaf ? leaf_look_of(look, level, g->half ? normal : NULL, leaf, to_eye) : look;
}

/* The own colour of a primitive: of the palette, times its texture's mean. */
static void own_color(const struct lod_seen *seen, const struct lod_drawing *d, const struct lod_geometry *g,
	uint32_t i, uint8_t rgb[3])
{
	static const uint8_t plain[3] = { 95, 127, 79 }, white[3] = { 255, 255, 255 };
	const struct lod_plant *plant = seen->probe->plant;
	int32_t color = g->color[i];
	bool listed = color >= 0 && (uint32_t)color < d->list->palette_count;
	memcpy(rgb, listed ? plant->palette[d->list->palette_first + (uint32_t)color]
		: d->list->image != ECO_NONE ? white : plain, 3);
	if (!g->uv)
		return;
	int32_t uv[6];
	for (size_t k = 0; k < 6; k++)
		uv[k] = (int32_t)floorf(g->uv[6 * (size_t)i + k] * ECO_UV_ONE + 0.5f);
	lod_texels_mean(&seen->texels[plant->images[d->list->image]], rgb, uv, rgb);
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

/* Sets the light that is left at a place in the crown, a ball of leaves that is stretched: from above, and
 * from below. */
static void crown_light(const struct lod_seen *seen, const double at[3], const double to_eye[3],
	double deeper, float left[2])
{
	const struct eco_anchor *whole = &seen->probe->plant->anchors[0];
	double p[3] = { (at[0] - (double)whole->center[0]) / seen->half_width - deeper * to_eye[0],
		(at[1] - (double)whole->center[1]) / seen->half_width - deeper * to_eye[1],
		at[2] / seen->half_height - 1 - deeper * to_eye[2] };
	double square = lod_dot(p, p), part = square > 0.94 ? 0.97 / sqrt(square) : 1;
	for (int k = 0; k < 3; k++)
		p[k] *= part;
	double flat = sqrt(1 - p[0] * p[0] - p[1] * p[1]);
	left[0] = fade(TAKES * (float)(flat - p[2] + 0.15));
	left[1] = fade(TAKES * (float)(flat + p[2] + 0.15));
}

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

static struct look look_of(const struct lod_seen *seen, uint32_t item, uint32_t leaf, float *tone,
	const double at[3], const double to_eye[3])
{
	const struct lod_probe *probe = seen->probe;
	const float deviation = (float)probe->plant->plant.leaf_tone / ECO_TONE_ONE;
	if (item >= probe->item_count) {
		float level = (float)eco_level_share(probe->plant->impostor_level);
		struct look look = cloud_look(level, (float)to_eye[2]);
		*tone = leaf ? leaf_tone(leaf, leaf_look(leaf), deviation) : 1;
		look = leaf ? leaf_look_of(look, level, NULL, leaf, to_eye) : look;
		look.reach = IMPOSTOR_REACH;
		return look;
	}
	const struct lod_drawing *d = drawing_of(probe, item);
	struct lod_geometry g = lod_probe_geometry(probe, d);
	if (d->list->kind != ECO_LIST_POINTS)
		return solid_look(d, g.position, item - d->item, to_eye);
	uint32_t i = item - d->item;
	leaf = g.wood && g.wood[i] > 0 ? 0 : leaf;
	*tone = leaf && g.half ? leaf_tone(leaf, leaf_look(leaf), deviation) : 1;
	struct look look = soft_look(d, &g, i, leaf, at, to_eye);
	look.reach = reach_of(d, &g, i, seen->half_width);
	return look;
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
		at[3], to_eye[3], length = sqrt(1 + (u * u + v * v) * eye->tan_x * eye->tan_x);
	for (int k = 0; k < 3; k++) {
		double ray = eye->forward[k] + eye->tan_x * (u * eye->right[k] + v * eye->up[k]);
		at[k] = eye->at[k] + w * ray;
		to_eye[k] = -ray / length;
	}
	float tone = 1, left[2];
	struct look look = look_of(seen, item, raster->leaf[sample], &tone, at, to_eye);
	crown_light(seen, at, to_eye, SEEN_DEPTH * (double)look.reach, left);
	for (int k = 0; k < 3; k++) {
		float up = 0.5f + 0.5f * look.n_z, above = sky[k] * left[0], below = earth[k] * left[1],
			front = up * above + (1 - up) * below + overhead[k] * look.on * left[0],
			back = up * below + (1 - up) * above + overhead[k] * look.through * left[0];
		light[k] = tone * (float)lod_light_of[seen->rgb[item][k]] / 65535 *
			(0.7f * front + (k < 2 ? 0.3f : 0.1f) * back);
	}
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

struct block { float light[3], sum, squares; };

static void add_pixel(struct block *block, const struct pixel *pixel, const float before[3])
{
	float light[3], rest = 1 - pixel->cover;
	for (int k = 0; k < 3; k++)
		block->light[k] += light[k] = pixel->light[k] + rest * before[k];
	float l = lightness_of(light);
	block->sum += l;
	block->squares += l * l;
}

static float deviation_of(const struct block *block, float count)
{
	float mean = block->sum / count;
	return sqrtf(fmaxf(block->squares / count - mean * mean, 0));
}

static void compare_blocks(struct errors *errors, const struct block *a, const struct block *b)
{
	float count = LOD_BLOCK_SIDE * LOD_BLOCK_SIDE, lab[2][3], light[3], square = 0;
	for (int k = 0; k < 3; k++)
		light[k] = a->light[k] / count;
	lab_of(light, lab[0]);
	for (int k = 0; k < 3; k++)
		light[k] = b->light[k] / count;
	lab_of(light, lab[1]);
	for (int k = 0; k < 3; k++)
		square += (lab[0][k] - lab[1][k]) * (lab[0][k] - lab[1][k]);
	errors->color += (double)(count * sqrtf(square));
	errors->contrast += (double)(count * fabsf(deviation_of(a, count) - deviation_of(b, count)));
}

/* Adds the block whose first pixel is (x, y), in part outside the picture. */
static void compare_block(const struct pixel *a, const struct pixel *b, uint32_t side, const int32_t at[2],
	const float before[3], struct errors *errors)
{
	static const struct pixel empty;
	struct block blocks[2] = { { .sum = 0 } };
	const struct pixel *pixels[2][LOD_BLOCK_SIDE * LOD_BLOCK_SIDE];
	float covered = 0;
	for (int32_t i = 0; i < (int32_t)(LOD_BLOCK_SIDE * LOD_BLOCK_SIDE); i++) {
		int32_t x = at[0] + i % (int32_t)LOD_BLOCK_SIDE, y = at[1] + i / (int32_t)LOD_BLOCK_SIDE,
			s = (int32_t)side;
		bool inside = x >= 0 && y >= 0 && x < s && y < s;
		pixels[0][i] = inside ? &a[y * s + x] : &empty;
		pixels[1][i] = inside ? &b[y * s + x] : &empty;
		covered += pixels[0][i]->cover + pixels[1][i]->cover;
	}
	if (!(covered > 0))
		return;
	for (int k = 0; k < 2; k++)
		for (uint32_t i = 0; i < LOD_BLOCK_SIDE * LOD_BLOCK_SIDE; i++)
			add_pixel(&blocks[k], pixels[k][i], before);
	compare_blocks(errors, &blocks[0], &blocks[1]);
}

/* Plants stand anywhere in blocks: of small ones the mean of four ways is taken, each half a block
 * further. */
static void compare_pixels(const struct pixel *a, const struct pixel *b, uint32_t side, const float before[3],
	struct errors *errors)
{
	const int32_t block = LOD_BLOCK_SIDE, ways = side < FINEST ? 4 : 1;
	for (int32_t way = 0; way < ways; way++)
		for (int32_t y = way / 2 * -block / 2; y < (int32_t)side; y += block)
			for (int32_t x = way % 2 * -block / 2; x < (int32_t)side; x += block)
				compare_block(a, b, side, (const int32_t[2]){ x, y }, before, errors);
	errors->color /= ways;
	errors->contrast /= ways;
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
			v->errors[size][open] = (struct errors){ .color = 0 };
			compare_pixels(v->pixels + first_of(size), v->reference + first_of(size),
				side_of(size), open ? before_open : seen->alike, &v->errors[size][open]);
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
	const struct eco_anchor *whole = &probe->plant->anchors[0];
	const struct eco_model *model = probe->model;
	float half = 0.5f * probe->plant->plant.height_m, least = 0.12f * whole->radius,
		square = whole->radius * whole->radius - half * half;
	*seen = (struct lod_seen){ .probe = probe, .options = *options,
		.half_height = half > 0 ? half : whole->radius,
		.half_width = square > least * least ? sqrtf(square) : least };
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
