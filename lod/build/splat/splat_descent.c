#include "lod/build/splat/splat_state.h"

#include <math.h>
#include <string.h>

#include "ecofiles/base/random.h"

#define BATCHES 4u               /* a round over all views is so many steps */
/* with enough views and no blades; lod/EXPERIMENTS.md, Coarse views, fewer a step */
#define BATCHES_MANY 7u
#define MANY_VIEWS 28u
#define MEMORY_1 0.9f            /* Adam's */
#define MEMORY_2 0.99f
#define STEPS 300u
/* more steps gain .001 of Q in levels of 192 splats, and less than that in finer ones */
#define STEPS_192 400u
#define STEPS_768 200u
#define STEPS_3072 100u
#define ALONE 0.4f              /* of a descent: then between levels, too */
#define RATE 0.08f               /* of a splat's size, in the first step */
#define LEAST_RATE 0.002f
/* Soft Q alone draws few splats up to 2.5 times as large as the plant, whose color then is too strong far away. As a
 * factor of the loss it leaves levels alone that fit well (lod/EXPERIMENTS.md, Thin plants). */
#define AREA_WEIGHT 0.3f
#define SETTLE_STEPS 40u
#define STEPS_DRAFT 4u           /* of a draft: one of so many */
#define SETTLE_RATE 0.008f
#define SETTLE_FROM 0.9          /* of all the work */

struct moment { struct splat_params first, second; };

struct state {
	struct splat_descent *d;
	const struct splat_views *views;     /* drawn now */
	struct splat_softness soft;
	struct moment *moments;
	struct splat_params **gradient;      /* per view of a batch */
	struct splat_picture *pictures;      /* the same */
	struct splat_params *drawn;          /* what a step draws */
	uint32_t drawn_count, moving;        /* the first `moving` are of the level: splats index[i] */
	uint32_t *index;
	double *loss;
	uint32_t batch, batches, room;       /* views batch, batch + batches, ... */
	float size;                          /* of the splats in the mean at first */
};

static void view_piece(void *pieces, uint32_t i)
{
	struct state *s = pieces;
	const struct splat_descent *d = s->d;
	memset(s->gradient[i], 0, d->count * sizeof **s->gradient);
	s->loss[i] = splat_view_loss(s->views, s->batch + i * s->batches, s->drawn, s->drawn_count, s->moving,
		&s->soft, &s->pictures[i], s->gradient[i]);
}

static void draw_level(struct state *s)
{
	s->moving = s->drawn_count = s->d->count;
	memcpy(s->drawn, s->d->splats, s->moving * sizeof *s->drawn);
	for (uint32_t i = 0; i < s->moving; i++)
		s->index[i] = i;
}

/* A random share of the parents has given way to its children. */
static void draw_between(struct state *s, uint64_t *seed)
{
	const struct splat_descent *d = s->d;
	double share = eco_random_unit(eco_random_next(seed));
	s->moving = 0;
	s->drawn_count = d->count;           /* parents that stay are gathered behind all children */
	for (uint32_t i = 0; i < d->count / d->children; i++) {
		if (eco_random_unit(eco_random_next(seed)) >= share) {
			s->drawn[s->drawn_count++] = d->parents[i];
			continue;
		}
		for (uint32_t k = i * d->children; k < (i + 1) * d->children; k++) {
			s->drawn[s->moving] = d->splats[k];
			s->index[s->moving++] = k;
		}
	}
	uint32_t stay = s->drawn_count - d->count;
	memmove(s->drawn + s->moving, s->drawn + d->count, stay * sizeof *s->drawn);
	s->drawn_count = s->moving + stay;
}

/* Mean loss of a batch; gradients are summed in the order of views. */
static double batch_gradient(struct state *s)
{
	const struct splat_descent *d = s->d;
	uint32_t views = (d->views->count - s->batch + s->batches - 1) / s->batches;
	lod_each_run(d->options->each, d->options->ctx, views, view_piece, s);
	double loss = s->loss[0];
	for (uint32_t i = 1; i < views; i++) {
		loss += s->loss[i];
		for (uint32_t k = 0; k < s->moving; k++)
			for (uint32_t j = 0; j < SPLAT_PARAMS; j++)
				s->gradient[0][k].v[j] += s->gradient[i][k].v[j];
	}
	return loss / views;
}

static float size_of(const struct splat_params *splat)
{
	float square = 0;
	for (uint32_t j = SPLAT_AXES; j < SPLAT_OPACITY; j++)
		square += splat->v[j] * splat->v[j];
	return sqrtf(square / 3);
}

static void step_splat(const struct state *s, struct splat_params *splat, struct moment *moment,
	const struct splat_params *gradient, float rate, float mend_1, float mend_2)
{
	float size = size_of(splat);
	size = size > 0.5f * s->size ? size : 0.5f * s->size;
	for (uint32_t j = 0; j < SPLAT_PARAMS; j++) {
		if (s->d->settle && j >= SPLAT_AXES && j < SPLAT_OPACITY)
			continue;
		float g = gradient->v[j], *a = &moment->first.v[j], *b = &moment->second.v[j];
		*a = MEMORY_1 * *a + (1 - MEMORY_1) * g;
		*b = MEMORY_2 * *b + (1 - MEMORY_2) * g * g;
		float by = *a * mend_1 / (sqrtf(*b * mend_2) + 1e-12f);
		splat->v[j] -= rate * (j < SPLAT_OPACITY ? size : 1) * by;
	}
	float *opacity = &splat->v[SPLAT_OPACITY];
	*opacity = *opacity > 1 ? 1 : *opacity < 0.0625f ? 0.0625f : *opacity;
}

static void prepare(struct state *s, struct lod_arena *arena)
{
	struct splat_descent *d = s->d;
	size_t pixels = (size_t)d->views->pixels * d->views->stride;
	s->moments = lod_arena_take(arena, d->count, sizeof *s->moments);
	s->gradient = lod_arena_take(arena, s->room, sizeof *s->gradient);
	s->pictures = lod_arena_take(arena, s->room, sizeof *s->pictures);
	size_t parents = d->parents ? d->count / d->children : 0;
	s->drawn = lod_arena_take(arena, d->count + parents, sizeof *s->drawn);
	s->index = lod_arena_take(arena, d->count, sizeof *s->index);
	s->loss = lod_arena_take(arena, s->room, sizeof *s->loss);
	for (uint32_t i = 0; i < s->room; i++) {
		s->gradient[i] = lod_arena_take(arena, d->count, sizeof **s->gradient);
		s->pictures[i].free = lod_arena_take(arena, pixels, sizeof(float));
		s->pictures[i].weight = lod_arena_take(arena, pixels, sizeof(float));
		s->pictures[i].ellipses = lod_arena_take(arena, d->count + parents,
			sizeof *s->pictures[i].ellipses);
	}
	for (uint32_t k = 0; k < d->count; k++)
		s->size += size_of(&d->splats[k]) / (float)d->count;
}

static bool told(const struct splat_descent *d, double share)
{
	double all = (d->level + share) / d->levels;
	return !d->options->progress || d->options->progress(d->options->ctx,
		d->settle ? SETTLE_FROM + (1 - SETTLE_FROM) * all : SETTLE_FROM * all);
}

static double mean_loss(struct state *s)
{
	double loss = 0;
	draw_level(s);
	s->views = s->d->views;
	s->soft = (struct splat_softness){ .edge_px = 0.3f };
	for (s->batch = 0; s->batch < s->batches; s->batch++)
		loss += batch_gradient(s) / s->batches;
	return loss;
}

bool splat_descend(struct splat_descent *d, struct lod_arena *arena)
{
	const struct lod_arena_piece *mark = arena->last;
	uint32_t round = d->blades || d->views->count < MANY_VIEWS ? BATCHES : BATCHES_MANY,
		batches = d->views->count < round ? 1 : round;
	struct state s = { .d = d, .batches = batches, .room = (d->views->count + batches - 1) / batches };
	uint64_t seed = d->count;
	float fall_1 = 1, fall_2 = 1;
	bool go = true;
	prepare(&s, arena);
	uint32_t steps = d->settle ? SETTLE_STEPS : d->count >= 3072 ? STEPS_3072 : d->count >= 768 ? STEPS_768
		: d->count >= 192 ? STEPS_192 : STEPS;
	steps /= d->options->draft ? STEPS_DRAFT : 1;
	for (uint32_t i = 0; i < steps && go; i++) {
		float at = (float)i / (float)steps, rest = (1 - at) * (1 - at);
		s.views = at < d->coarse_share ? d->coarse : d->views;
		float unit = s.views->scale / d->views->scale;
		s.soft = (struct splat_softness){ .edge_px = 0.8f * unit,
			.least = d->settle ? 0 : 0.6f * rest,
			.blur_px2 = 0.2f * unit * unit, .chance = d->chance,
			.area = AREA_WEIGHT };
		s.batch = i % s.batches;
		if (d->parents && at > ALONE && i / s.batches % 2)
			draw_between(&s, &seed);
		else
			draw_level(&s);
		batch_gradient(&s);
		fall_1 *= MEMORY_1;
		fall_2 *= MEMORY_2;
		for (uint32_t k = 0; k < s.moving; k++)
			step_splat(&s, &d->splats[s.index[k]], &s.moments[s.index[k]], &s.gradient[0][k],
				d->settle ? SETTLE_RATE * rest : RATE * rest + LEAST_RATE, 1 / (1 - fall_1),
				1 / (1 - fall_2));
		go = told(d, at);
	}
	if (go)
		d->loss = mean_loss(&s);
	lod_arena_release(arena, mark);
	return go;
}
