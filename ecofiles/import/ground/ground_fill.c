/* Missing samples grow in from the known ones, one ring a round. A round uses only samples known before
 * it, so its values are written once all of them are computed. Rings from several sides leave creases
 * where they meet; sweeps outwards and inwards again, each sample becoming the mean of its neighbours,
 * level them. Memory beside the samples: a bit for each, and eight bytes for each missing one. */
#include "ecofiles/import/ground/ground.h"

#include <math.h>
#include <stdlib.h>

#define SWEEPS_MAX 64u
#define SWEPT_MAX ((size_t)1 << 28)  /* samples in all sweeps: a few seconds */

struct fill {
	struct eco_ground *ground;
	uint64_t *queued;            /* a bit a sample */
	uint32_t *queue; size_t end; /* indices of samples, ring after ring */
	float *values;               /* of one ring */
};

static bool take_bit(uint64_t *bits, size_t i)
{
	uint64_t bit = UINT64_C(1) << (i & 63);
	bool was = bits[i >> 6] & bit;
	bits[i >> 6] |= bit;
	return !was;
}

/* Runs the body for sample i and each of its up to eight neighbours. */
#define EACH_NEIGHBOUR(g, i, k) \
	for (size_t row_ = (i) / (g)->columns, y_ = row_ > 0 ? row_ - 1 : 0; \
	y_ <= row_ + 1 && y_ < (g)->rows; y_++) \
		for (size_t column_ = (i) % (g)->columns, x_ = column_ > 0 ? column_ - 1 : 0, k; \
			x_ <= column_ + 1 && x_ < (g)->columns && (k = y_ * (g)->columns + x_, true); x_++)

static void queue_missing_neighbours(struct fill *f, size_t i)
{
	EACH_NEIGHBOUR(f->ground, i, k)
		if (isnan(f->ground->height_m[k]) && take_bit(f->queued, k))
			f->queue[f->end++] = (uint32_t)k;
}

static float neighbour_mean(const struct eco_ground *g, size_t i)
{
	double sum = 0;
	int count = 0;
	EACH_NEIGHBOUR(g, i, k)
		if (!isnan(g->height_m[k])) {
			sum += (double)g->height_m[k];
			count++;
		}
	return (float)(sum / count);
}

static void grow(struct fill *f)
{
	struct eco_ground *g = f->ground;
	size_t count = (size_t)g->columns * g->rows, begin = 0;
	for (size_t i = 0; i < count; i++)
		if (!isnan(g->height_m[i]))
			queue_missing_neighbours(f, i);
	while (begin < f->end) {
		size_t last = f->end;
		for (size_t k = begin; k < last; k++)
			f->values[k - begin] = neighbour_mean(g, f->queue[k]);
		for (size_t k = begin; k < last; k++)
			g->height_m[f->queue[k]] = f->values[k - begin];
		for (; begin < last; begin++)
			queue_missing_neighbours(f, f->queue[begin]);
	}
}

static void level(struct fill *f)
{
	struct eco_ground *g = f->ground;
	size_t sweeps = SWEPT_MAX / f->end < SWEEPS_MAX ? SWEPT_MAX / f->end : SWEEPS_MAX;
	for (size_t sweep = 0; sweep < sweeps; sweep++)
		for (size_t k = 0; k < f->end; k++) {
			size_t i = f->queue[sweep % 2 ? k : f->end - 1 - k];
			g->height_m[i] = neighbour_mean(g, i);
		}
}

enum eco_code eco_ground_fill(struct eco_ground *ground, struct eco_error *error)
{
	size_t count = (size_t)ground->columns * ground->rows, missing = 0;
	struct fill f = { .ground = ground };
	for (size_t i = 0; i < count; i++)
		missing += isnan(ground->height_m[i]);
	ground->filled = missing;
	if (missing == 0)
		return ECO_OK;
	if (missing == count)
		return eco_fail(error, ECO_BAD_INPUT, "it holds no height at all, only NODATA");
	f.queued = calloc(count / 64 + 1, sizeof *f.queued);
	f.queue = malloc(missing * sizeof *f.queue);
	f.values = malloc(missing * sizeof *f.values);
	bool ready = f.queued && f.queue && f.values;
	if (ready) {
		grow(&f);
		level(&f);
	}
	free(f.queued);
	free(f.queue);
	free(f.values);
	return ready ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory to fill %zu samples", missing);
}
