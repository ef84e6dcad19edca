/* wood MODEL ...: the share of their wood that plants show, by the forms that their cells draw. Exit 1 if a
 * mix of cells or a level has a hole, or if a level loses more than 2 % of the wood. Lines alone have no
 * bound: from above a line does not show the foot of a trunk, and a pot is no line. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/import/model/model_import.h"
#include "lod/build/measure/probe.h"
#include "lod/build/plant.h"

#define MIXES 16u

/* Wood of a plant's cells, drawn as lines in some cells and as levels of triangles in others: how much of the
 * wood that full detail shows at a pixel or more of width is there?
 *
 * Twelve directions: N, NE, ... NW from 10 degrees above the horizon, N, E, S and W from 45 degrees; 512 pixels
 * around the plant, drawn at twice that. A pixel is covered if wood is drawn within one pixel of it. A cell
 * without lines has none in the state of lines. */
#define WOOD_DIRECTIONS 12u
#define WOOD_STATES 4u           /* of a cell: lines, levels from coarse to fine */

struct wood_cover {
	uint32_t cells;              /* that have wood */
	/* Shares of the wide wood covered, means over the directions: all cells in one state; the least of
	 * the mixes. */
	double same[WOOD_STATES], mixed;
	/* The greatest share, in one direction, that each of the states covers and a mix does not. */
	double hole;
	/* The greatest share of a level's edges in one cell that have one triangle, though full detail has no
	 * such edge at their ends. */
	double torn;
};

#define PIXELS 1024u
#define ALL (PIXELS * PIXELS)
#define LADDERS_MAX 4096u

struct state {
	struct lod_probe probe;
	const struct eco_ladder *ladder[LADDERS_MAX];
	uint32_t count;
	uint8_t *wide;               /* per direction: 1 where full detail shows wide wood, 2 where each state does too */
	uint8_t *scratch;
};

static void look(struct lod_probe *probe, uint32_t view)
{
	static const double height[2] = { 0.17364817766693033, 0.70710678118654752 },
		flat[2] = { 0.98480775301220806, 0.70710678118654752 }, half = 0.70710678118654752;
	static const double compass[8][2] = { { 0, 1 }, { 1, 1 }, { 1, 0 }, { 1, -1 }, { 0, -1 }, { -1, -1 },
		{ -1, 0 }, { -1, 1 } };
	struct lod_eye *eye = &probe->eyes[view];
	uint32_t high = view >= 8, turn = high ? 2 * (view - 8) : view;
	double scale = turn % 2 ? half : 1, x = scale * compass[turn][0], y = scale * compass[turn][1],
		z = height[high], f = flat[high], far = 16 * probe->radius;
	const double from[3] = { f * x, f * y, z };
	for (int k = 0; k < 3; k++) {
		eye->at[k] = probe->center[k] + far * from[k];
		eye->forward[k] = -from[k];
	}
	eye->right[0] = -y, eye->right[1] = x, eye->right[2] = 0;
	eye->up[0] = -z * x, eye->up[1] = -z * y, eye->up[2] = f;
}

/* Pixels of 2 x 2 blocks that are covered as a whole, so a pixel of half the size wide. */
static void open_blocks(const uint8_t *cover, uint8_t *out)
{
	memset(out, 0, ALL);
	for (size_t i = 0; i + PIXELS + 1 < ALL; i++)
		if (i % PIXELS + 1 < PIXELS && cover[i] && cover[i + 1] && cover[i + PIXELS]
				&& cover[i + PIXELS + 1])
			out[i] = out[i + 1] = out[i + PIXELS] = out[i + PIXELS + 1] = 1;
}

/* Covered pixels grow by two, along rows and columns. */
static void widen(uint8_t *cover, uint8_t *scratch)
{
	for (int k = 0; k < 2; k++) {
		memcpy(scratch, cover, ALL);
		for (size_t i = PIXELS; i < ALL - PIXELS; i++)
			cover[i] |= scratch[i - 1] | scratch[i + 1] | scratch[i - PIXELS] | scratch[i + PIXELS];
	}
}

/* State 0: lines; 1, 2, ...: levels, of which the last is full detail. */
static struct eco_cut cut_of(const struct lod_plant *plant, const struct eco_ladder *ladder, uint32_t state)
{
	struct eco_cut cut = { .scale = 1, .list = state ? ladder->triangles : ladder->lines };
	if (cut.list == ECO_NONE)
		return cut;
	if (state == 0) {
		cut.end = plant->lists[cut.list].list.primitive_count;
	} else if (ladder->level_count == 0) {
		cut.end = plant->lists[cut.list].list.primitive_count;
	} else {
		uint32_t level = state - 1;
		level = level < ladder->level_count ? level : ladder->level_count - 1u;
		cut.first = level ? ladder->level_end[level - 1] : 0;
		cut.end = ladder->level_end[level];
	}
	return cut;
}

/* Draws each cell in a state of its own (`mix` not 0), or all in one. */
static enum eco_code draw(struct state *s, uint32_t mix, uint32_t state, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	lod_probe_clear(&s->probe);
	for (uint32_t i = 0; i < s->count && !code; i++) {
		uint64_t random = (uint64_t)mix << 32 | i;
		struct eco_cut cut = cut_of(s->probe.plant, s->ladder[i],
			mix ? eco_random_next(&random) % WOOD_STATES : state);
		if (cut.list == ECO_NONE)
			continue;
		code = lod_probe_add(&s->probe, &cut, error);
	}
	if (!code)
		lod_probe_keep(&s->probe);
	return code;
}

struct covered { double mean, hole; };

/* Shares that the last picture covers. `all`: it is one of those that a mix may not fall below. */
static struct covered compare(struct state *s, bool all)
{
	struct covered covered = { 0, 0 };
	for (uint32_t view = 0; view < WOOD_DIRECTIONS; view++) {
		uint8_t *cover = s->probe.reference + (size_t)view * ALL, *wide = s->wide + (size_t)view * ALL;
		uint64_t total = 0, there = 0, hole = 0;
		widen(cover, s->scratch);
		for (size_t i = 0; i < ALL; i++) {
			total += wide[i] != 0;
			there += wide[i] && cover[i];
			hole += wide[i] == 2 && !cover[i];
			if (all && wide[i] && !cover[i])
				wide[i] = 1;
		}
		covered.mean += total ? (double)there / (double)total / WOOD_DIRECTIONS : 1.0 / WOOD_DIRECTIONS;
		covered.hole = fmax(covered.hole, total ? (double)hole / (double)total : 0);
	}
	return covered;
}

static enum eco_code measure(struct state *s, struct wood_cover *cover, uint32_t mixes,
	struct eco_error *error)
{
	enum eco_code code = draw(s, 0, WOOD_STATES - 1, error);
	for (uint32_t view = 0; view < WOOD_DIRECTIONS && !code; view++) {
		open_blocks(s->probe.reference + (size_t)view * ALL, s->wide + (size_t)view * ALL);
		for (size_t i = 0; i < ALL; i++)
			s->wide[(size_t)view * ALL + i] *= 2;
	}
	for (uint32_t state = 0; state < WOOD_STATES && !code; state++) {
		code = draw(s, 0, state, error);
		cover->same[state] = compare(s, true).mean;
	}
	cover->mixed = 1;
	for (uint32_t mix = 1; mix <= mixes && !code; mix++) {
		code = draw(s, mix, 0, error);
		struct covered covered = compare(s, false);
		cover->mixed = fmin(cover->mixed, covered.mean);
		cover->hole = fmax(cover->hole, covered.hole);
	}
	return code;
}

/* ---- Edges ---- */

struct edge { uint64_t end[2]; };

static int by_ends(const void *a, const void *b) { return memcmp(a, b, sizeof(struct edge)); }
static int by_place(const void *a, const void *b) { return memcmp(a, b, sizeof(uint64_t)); }

static uint64_t place(const int32_t *p)
{
	return (uint64_t)p[0] << 42 | (uint64_t)p[1] << 21 | (uint64_t)p[2];
}

/* Edges of a level that have one triangle, into `open`, which has room for all; `total`: of the level. */
static uint32_t open_edges(const struct lod_list_draft *list, uint32_t first, uint32_t end, struct edge *open,
	uint32_t *total)
{
	struct edge *edge = malloc(((size_t)end - first) * 3 * sizeof *edge + 1);
	uint32_t count = 0, kept = 0;
	for (uint32_t t = first; t < end && edge; t++)
		for (uint32_t k = 0; k < 3; k++) {
			uint64_t a = place(list->elements.position + 9 * (size_t)t + 3 * k),
				b = place(list->elements.position + 9 * (size_t)t + 3 * ((k + 1) % 3));
			edge[count++] = (struct edge){ { a < b ? a : b, a < b ? b : a } };
		}
	qsort(edge, count, sizeof *edge, by_ends);
	*total = 0;
	for (uint32_t i = 0, next; i < count; i = next, ++*total) {
		for (next = i; next < count && !by_ends(&edge[next], &edge[i]); next++)
			;
		if (next == i + 1)
			open[kept++] = edge[i];
	}
	free(edge);
	return kept;
}

/* The greatest share of torn edges of the ladder's levels. */
static double torn(const struct lod_plant *plant, const struct eco_ladder *ladder)
{
	double most = 0;
	if (ladder->level_count < 2)
		return 0;
	const struct lod_list_draft *list = &plant->lists[ladder->triangles];
	uint32_t all = list->list.primitive_count, total, last = ladder->level_count - 1u;
	struct edge *open = malloc(3 * (size_t)all * sizeof *open), *border = malloc(3 * (size_t)all * sizeof *border);
	if (open && border) {
		uint32_t border_count = open_edges(list, ladder->level_end[last - 1], all, border, &total);
		uint64_t *ends = border[0].end;
		qsort(ends, 2 * border_count, sizeof *ends, by_place);
		for (uint32_t level = 0; level < last; level++) {
			uint32_t count = open_edges(list, level ? ladder->level_end[level - 1] : 0,
				ladder->level_end[level], open, &total), found = 0;
			for (uint32_t i = 0; i < count; i++)
				found += !bsearch(&open[i].end[0], ends, 2 * border_count, sizeof *ends, by_place)
					|| !bsearch(&open[i].end[1], ends, 2 * border_count, sizeof *ends, by_place);
			most = fmax(most, (double)found / total);
		}
	}
	free(open);
	free(border);
	return most;
}

/* `mixes`: pictures whose cells have a state each, by chance. */
static enum eco_code wood_cover_measure(struct wood_cover *cover, const struct lod_plant *plant,
	const struct eco_model *model, uint32_t mixes, struct eco_error *error)
{
	struct state *s = calloc(1, sizeof *s);
	*cover = (struct wood_cover){ 0 };
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory to measure wood");
	enum eco_code code = lod_probe_init(&s->probe, plant, model,
		&(struct lod_probe_options){ .views = WOOD_DIRECTIONS, .pixels = PIXELS }, error);
	for (uint32_t i = 0; i < plant->ladder_count && s->count < LADDERS_MAX; i++)
		if (plant->ladders[i].organ == ECO_ORGAN_WOOD && plant->ladders[i].flags & ECO_LADDER_NEAR)
			s->ladder[s->count++] = &plant->ladders[i];
	cover->cells = s->count;
	for (uint32_t i = 0; i < s->count; i++)
		cover->torn = fmax(cover->torn, torn(plant, s->ladder[i]));
	s->wide = malloc((size_t)WOOD_DIRECTIONS * ALL);
	s->scratch = malloc(ALL);
	if (!code && (!s->wide || !s->scratch))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for pictures of wood");
	for (uint32_t view = 0; view < WOOD_DIRECTIONS && !code; view++)
		look(&s->probe, view);
	if (!code)
		code = measure(s, cover, mixes, error);
	lod_probe_free(&s->probe);
	free(s->wide);
	free(s->scratch);
	free(s);
	return code;
}

static bool holds(const struct wood_cover *cover)
{
	bool good = cover->hole <= 0.001 && cover->torn <= 0.02;
	for (uint32_t state = 1; state < WOOD_STATES; state++)
		good = good && cover->same[state] >= 0.98;
	return good;
}

static enum eco_code measure_file(const char *path, bool *good, struct eco_error *error)
{
	struct eco_model model;
	struct lod_plant plant;
	struct wood_cover cover;
	enum eco_code code = eco_model_import(&model, &(struct eco_model_options){ .paths = &path,
		.path_count = 1 }, error);
	if (code)
		return code;
	code = lod_plant_build(&plant, &model, &(struct lod_plant_options){ .name = "plant", .seed = 1,
		.order = LOD_ORDER_COMBINED }, error);
	if (!code) {
		code = wood_cover_measure(&cover, &plant, &model, MIXES, error);
		lod_plant_free(&plant);
	}
	eco_model_free(&model);
	if (code)
		return code;
	*good = holds(&cover);
	printf("%s: %u cells; all lines %.4f, levels %.4f %.4f %.4f, mixes %.4f, holes %.5f, torn %.4f%s\n",
		path, cover.cells, cover.same[0], cover.same[1], cover.same[2], cover.same[3], cover.mixed,
		cover.hole, cover.torn, *good ? "" : ": FAILED");
	return ECO_OK;
}

int main(int argc, char **argv)
{
	int failed = 0;
	for (int i = 1; i < argc; i++) {
		struct eco_error error = { 0 };
		bool good = false;
		if (measure_file(argv[i], &good, &error))
			printf("%s: %s\n", argv[i], error.text);
		failed += !good;
		fflush(stdout);
	}
	printf("wood: %d of %d failed\n", failed, argc - 1);
	return failed > 0;
}
