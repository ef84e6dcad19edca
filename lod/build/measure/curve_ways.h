/* The inside of the measurement of curves (lod/build/measure/curve.c). A share of an organ's vertices is
 * drawn; the search finds the scale with the least loss and, for leaves in several forms, the number of
 * elements to draw (reach). A way is one reach at one share. */
#pragma once

#include "lod/build/measure/probe.h"

/* Scales are 2^(step/8) times Cook's, from 1/4 to 8. With other limits plants or scenes lose
 * (lod/EXPERIMENTS.md, Limits of scales). */
#define LOD_CURVE_STEP_LOW (-16)
#define LOD_CURVE_STEP_HIGH 24
#define LOD_CURVE_FORMS_MAX 4
#define LOD_CURVE_SAMPLES_MAX 96u
/* Reaches tried at a share: from all in full detail (0) to all in the coarsest form. */
#define LOD_CURVE_WAYS_MAX 8

struct lod_curve_way {               /* one reach at one share */
	/* The sample whose vertices, all in the coarsest form, are this reach; ECO_NONE: that of full
	 * detail. */
	uint32_t rung;
	double reach, step, loss;    /* step: the scale is 2^(step/8) times Cook's */
	double play;                 /* steps by which the scale may differ from the best at little loss */
	double finer[LOD_CURVE_FORMS_MAX];   /* elements in this form or a finer one */
	bool given_up;               /* its scale is not the best */
};

struct lod_curve_sample {
	double share;                /* of the organ's vertices */
	double reach, step, play;
	double fp, fn;
	bool free;                   /* its scale is searched */
	struct lod_curve_way ways[LOD_CURVE_WAYS_MAX];   uint32_t way_count, chosen;
};

struct lod_curve_organ {             /* ladders that share one curve */
	struct lod_probe *probe;
	uint32_t *members, member_count; /* indices of ladders; [0] is the whole plant's if there is one */
	bool far_only;               /* FAR ladders: measured against the organ's other ladders */
	bool whole;                  /* a WHOLE ladder: measured against all others */
	bool scaled;                 /* not wood */
	bool draft;                  /* fewer samples, none from above */
	bool forms;                  /* leaves in several forms */
	double unit[LOD_CURVE_FORMS_MAX];    /* forms: mean vertices of an element, coarsest first */
	uint32_t units;
	double elements, full;       /* of all members; full: in vertices */
	struct lod_curve_sample samples[LOD_CURVE_SAMPLES_MAX];
	uint32_t sample_count;
	struct lod_solved solved;
};

static inline const struct eco_ladder *lod_curve_member(const struct lod_curve_organ *curve, uint32_t i)
{
	return &curve->probe->plant->ladders[curve->members[i]];
}

static inline uint64_t lod_curve_primitives(const struct lod_curve_organ *curve, uint32_t list)
{
	return list == ECO_NONE ? 0 : curve->probe->lists[list].primitive_count;
}

/* 2^(step / 8) for a step in [LOD_CURVE_STEP_LOW, LOD_CURVE_STEP_HIGH]: linear between whole steps, so that
 * every machine has the same. */
double lod_curve_scale(double step);

/* Adds a ladder of the plant to the probe's pictures, as drawn at that sample. */
void lod_curve_add(const struct lod_curve_organ *curve, const struct eco_ladder *ladder,
	const struct eco_curve *sample);
/* Clears the probe's pictures and draws a share of all members. */
void lod_curve_draw(const struct lod_curve_organ *curve, double share, double reach, double step);

/* Searches the best scale for way->reach from step `start` on; sets step, loss and play. `warm`: `start` is
 * near the answer; if the loss there is more than `most` the way is given up. */
void lod_curve_try_way(const struct lod_curve_organ *curve, double share, struct lod_curve_way *way,
	double start, bool warm, double most);

/* Tries all ways of sample `at`, each from the best scale of the same rung at the next larger share (NULL:
 * none), or from that of its neighbour. */
void lod_curve_try_ways(struct lod_curve_organ *curve, uint32_t at, const struct lod_curve_sample *larger);

/* Chooses a way for each of the first `count` samples, and with it reach, step and play: the ascending
 * sequence of ways with the least total loss. If it contains ways that were given up their scales are
 * searched, and the choice is repeated; losses only fall, so this ends. */
void lod_curve_settle(struct lod_curve_organ *curve, uint32_t count);
