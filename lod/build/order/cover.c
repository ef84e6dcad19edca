#include "lod/build/order/cover.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "lod/heap.h"

#define RUN_BITS 6u              /* of a run: its length, below the place of its first pixel */
#define RUN_LONGEST ((1u << RUN_BITS) - 1)
#define LEVELS 4                 /* a pixel counts until so many leaves cover it */
#define LEVEL_SHIFT 3            /* each time an eighth of its value before */

/* The pixels of all pictures that each element covers on its own, as runs along rows. */
struct footprints {
	uint64_t *first;             /* per element, and one more: its first run */
	uint32_t *run;
	uint64_t count, capacity;
};

struct cover {
	const struct lod_foliage *foliage;
	const struct lod_sights *sights;
	uint32_t row_words;
	/* Masks of all pictures, consecutive: covered by at least so many elements, or by wood. */
	uint64_t *covered[LEVELS];
	struct footprints prints;
	struct lod_arena *arena;
};

/* ---- Footprints: pixel centres inside triangles, without a sub-pixel grid, as no other picture is compared
 * ---- */

static void add_run(struct footprints *f, struct lod_arena *arena, uint32_t at, uint32_t length)
{
	while (length) {
		uint32_t part = length < RUN_LONGEST ? length : RUN_LONGEST;
		if (f->count == f->capacity) {
			uint64_t capacity = f->capacity ? f->capacity + f->capacity / 2 : 1u << 16;
			uint32_t *bigger = lod_arena_take(arena, capacity, sizeof *bigger);
			if (f->count)
				memcpy(bigger, f->run, f->count * sizeof *bigger);
			f->run = bigger;
			f->capacity = capacity;
		}
		f->run[f->count++] = at << RUN_BITS | part;
		at += part;
		length -= part;
	}
}

struct corner { double x, y, u, v; };

static struct corner project(const struct lod_eye *eye, uint32_t pixels, const float p[3], const float uv[2])
{
	double d[3] = { p[0] - eye->at[0], p[1] - eye->at[1], p[2] - eye->at[2] };
	double w = d[0] * eye->forward[0] + d[1] * eye->forward[1] + d[2] * eye->forward[2];
	double x = d[0] * eye->right[0] + d[1] * eye->right[1] + d[2] * eye->right[2];
	double y = d[0] * eye->up[0] + d[1] * eye->up[1] + d[2] * eye->up[2];
	return (struct corner){ pixels * 0.5 * (1 + x / (w * eye->tan_x)),
		pixels * 0.5 * (1 - y / (w * eye->tan_y)), uv[0], uv[1] };
}

static bool opaque(const struct eco_image *image, double u, double v)
{
	u -= floor(u);
	v -= floor(v);
	uint32_t x = (uint32_t)(u * image->width), y = (uint32_t)(v * image->height);
	x = x < image->width ? x : image->width - 1;
	y = y < image->height ? y : image->height - 1;
	return image->rgba[4 * ((size_t)y * image->width + x) + 3] >= 128;
}

/* The interval in which the row at height y crosses the triangle; empty if it does not. */
static void span(const struct corner *c, double y, double *from, double *to)
{
	*from = INFINITY;
	*to = -INFINITY;
	for (int k = 0; k < 3; k++) {
		const struct corner *a = &c[k], *b = &c[(k + 1) % 3];
		if ((a->y <= y) == (b->y <= y))
			continue;
		double x = a->x + (y - a->y) / (b->y - a->y) * (b->x - a->x);
		*from = fmin(*from, x);
		*to = fmax(*to, x);
	}
}

static void add_triangle(struct cover *cover, uint32_t view, const struct corner *c,
	const struct eco_image *image)
{
	uint32_t pixels = cover->sights->pixels, row_bits = 64 * cover->row_words;
	double low = fmin(c[0].y, fmin(c[1].y, c[2].y)), high = fmax(c[0].y, fmax(c[1].y, c[2].y));
	double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
	if (!(area != 0) || !(high > 0.5) || !(low < pixels))
		return;
	uint32_t first = low > 0.5 ? (uint32_t)ceil(low - 0.5) : 0;
	for (uint32_t y = first; y < pixels && y + 0.5 <= high; y++) {
		double from, to;
		span(c, y + 0.5, &from, &to);
		if (!(to > 0.5) || !(from < pixels - 0.5))
			continue;
		uint32_t x = from > 0.5 ? (uint32_t)ceil(from - 0.5) : 0, end = to + 0.5 < pixels
			? (uint32_t)ceil(to - 0.5) : pixels;
		uint32_t at = view * cover->sights->words * 64 + y * row_bits;
		if (!image) {
			if (x < end)
				add_run(&cover->prints, cover->arena, at + x, end - x);
			continue;
		}
		for (uint32_t run = x; x < end; x++) {
			double s =
				((x + 0.5 - c[0].x) * (c[2].y - c[0].y)
				- (c[2].x - c[0].x) * (y + 0.5 - c[0].y)) / area;
			double t =
				((c[1].x - c[0].x) * (y + 0.5 - c[0].y)
				- (x + 0.5 - c[0].x) * (c[1].y - c[0].y)) / area;
			bool set = opaque(image, c[0].u + s * (c[1].u - c[0].u) + t * (c[2].u - c[0].u),
				c[0].v + s * (c[1].v - c[0].v) + t * (c[2].v - c[0].v));
			if (set && x + 1 == end)
				add_run(&cover->prints, cover->arena, at + run, end - run);
			else if (!set && run < x)
				add_run(&cover->prints, cover->arena, at + run, x - run);
			if (!set)
				run = x + 1;
		}
	}
}

static void find_footprints(struct cover *cover)
{
	const struct lod_foliage *f = cover->foliage;
	for (uint32_t i = 0; i < f->count; i++) {
		uint32_t first = f->first[i], corners = f->first[i + 1] - first;
		struct corner c[3];
		cover->prints.first[i] = cover->prints.count;
		for (uint32_t view = 0; view < cover->sights->count; view++) {
			const struct lod_eye *eye = &cover->sights->eyes[view];
			c[0] = project(eye, cover->sights->pixels, f->corner[first], f->uv[first]);
			c[2] = project(eye, cover->sights->pixels, f->corner[first + 1], f->uv[first + 1]);
			for (uint32_t k = 2; k < corners; k++) {
				c[1] = c[2];
				c[2] = project(eye, cover->sights->pixels, f->corner[first + k],
					f->uv[first + k]);
				add_triangle(cover, view, c, f->cutout[i]);
			}
		}
	}
	cover->prints.first[f->count] = cover->prints.count;
}

/* ---- Greedy ---- */

/* Bits [from, from + length) of one word. */
static uint64_t bits(uint32_t from, uint32_t length)
{
	return (length < 64 ? (UINT64_C(1) << length) - 1 : ~UINT64_C(0)) << from;
}

static uint64_t gain(const struct cover *cover, uint32_t element)
{
	uint64_t sum = 0;
	for (uint64_t r = cover->prints.first[element]; r < cover->prints.first[element + 1]; r++) {
		uint32_t at = cover->prints.run[r] >> RUN_BITS, length = cover->prints.run[r] & RUN_LONGEST;
		while (length) {
			uint32_t part = 64 - at % 64 < length ? 64 - at % 64 : length;
			uint64_t mask = bits(at % 64, part);
			for (int level = 0; level < LEVELS; level++) {
				uint64_t left = mask & ~cover->covered[level][at / 64];
				sum += (uint64_t)__builtin_popcountll(left)
					<< LEVEL_SHIFT * (LEVELS - 1 - level);
				mask &= ~left;
			}
			at += part;
			length -= part;
		}
	}
	return sum;
}

static void take(struct cover *cover, uint32_t element)
{
	for (uint64_t r = cover->prints.first[element]; r < cover->prints.first[element + 1]; r++) {
		uint32_t at = cover->prints.run[r] >> RUN_BITS, length = cover->prints.run[r] & RUN_LONGEST;
		while (length) {
			uint32_t part = 64 - at % 64 < length ? 64 - at % 64 : length;
			uint64_t mask = bits(at % 64, part);
			for (int level = 0; level < LEVELS && mask; level++) {
				uint64_t full = mask & cover->covered[level][at / 64];
				cover->covered[level][at / 64] |= mask;
				mask = full;
			}
			at += part;
			length -= part;
		}
	}
}

static enum eco_code pick(struct cover *cover, uint32_t *order, const struct lod_cover_options *options,
	struct eco_error *error)
{
	uint32_t count = cover->foliage->count;
	struct lod_heap_item *heap = lod_arena_take(cover->arena, count, sizeof *heap);
	for (uint32_t i = 0; i < count; i++)
		heap[i] = (struct lod_heap_item){ (double)gain(cover, i), i };
	lod_heap_make(heap, count);
	for (uint32_t left = count, picked = 0; left;) {
		struct lod_heap_item best = { (double)gain(cover, heap[0].id), heap[0].id };
		if (best.key != heap[0].key) {                         /* a stale key: its gain has fallen */
			heap[0] = best;
			lod_heap_sift(heap, left, 0);
			continue;
		}
		if (picked % 256 == 0 && options->progress
				&& !options->progress(options->ctx, (double)picked / count))
			return eco_fail(error, ECO_INTERRUPTED, "interrupted while ordering leaves");
		take(cover, best.id);
		order[picked++] = best.id;
		heap[0] = heap[--left];
		lod_heap_sift(heap, left, 0);
	}
	return ECO_OK;
}

static enum eco_code open_cover(struct cover *cover, struct lod_sights *sights,
	const struct lod_foliage *foliage, const struct lod_cover_options *options, struct lod_arena *arena,
	struct eco_error *error)
{
	enum eco_code code = lod_sights_make(sights, foliage, options->directions, options->views,
		options->pixels, arena, error);
	if (code)
		return code;
	size_t words = (size_t)sights->words * sights->count;
	*cover = (struct cover){ .foliage = foliage, .sights = sights,
		.row_words = sights->words / sights->pixels, .arena = arena };
	assert(64 * words <= LOD_COVER_PIXELS_MAX);
	for (int level = 0; level < LEVELS; level++) {
		cover->covered[level] = lod_arena_take(arena, words, sizeof(uint64_t));
		for (uint32_t view = 0; view < sights->count; view++)
			memcpy(cover->covered[level] + (size_t)view * sights->words, sights->wood[view],
				sights->words * sizeof(uint64_t));
	}
	cover->prints.first = lod_arena_take(arena, (size_t)foliage->count + 1, sizeof *cover->prints.first);
	find_footprints(cover);
	return ECO_OK;
}

enum eco_code lod_cover_order(uint32_t *order, const struct lod_foliage *foliage,
	const struct lod_cover_options *options, struct lod_arena *arena, struct eco_error *error)
{
	struct cover cover;
	struct lod_sights sights;
	struct lod_arena_piece *mark = arena->last;
	enum eco_code code = open_cover(&cover, &sights, foliage, options, arena, error);
	if (!code)
		code = pick(&cover, order, options, error);
	lod_arena_release(arena, mark);
	return code;
}
