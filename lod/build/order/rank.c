/* See rank.h.
 *
 * The list is made in steps. Picks of earlier steps are drawn anew at the step's scale; then elements are
 * added greedily, each time the one whose pixels raise Q most per triangle, by Q's gradient. A trial on a few
 * of the views tells the step's best scale. The list begins with points, all at one scale: the first third,
 * or 6 % if as many vertices show more as leaves. Variants: lod/EXPERIMENTS.md, The greedy order. */
#include "lod/build/order/rank.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/build/order/rank_state.h"
#include "lod/sort.h"

#define VIEWS_LEAST 24u
#define VIEWS_MOST 44u
#define SEEN 160000u                     /* elements times views, within these bounds */
/* Elements: larger plants use half of the least number of views, to end in time. */
#define LARGE 100000u
/* Share of the elements up to which they are picked as points. */
#define POINTS_MOST 0.35
#define POINTS_LEAST 0.06                /* if leaves show more */
/* Share of the loss of leaves of as many vertices that points may have: they must lose less, as curves have
 * simple leaves, too. */
#define POINTS_LOSS 0.95
/* Views of a trial; rounding of the stride makes them up to nine. */
#define TRIAL_VIEWS 5u
#define SECOND 16                        /* value of a second layer: this fraction of the first */
#define WEIGHT 4096
#define SCALES 5u                        /* tried in every step */
#define CANDIDATES_LEAST 1024u
#define CANDIDATES_SHARE 32u             /* times the number of elements at the step's end */
#define CANDIDATES_ROUGH 8u              /* for rough trials */
#define CANDIDATES_LEAST_ROUGH 256u
#define CANDIDATES_MOST 40000u           /* plus three for each pick of the step */
/* Share of the elements up to which a step takes the codes that its trials found: those of the last look. */
#define KNOWN_MOST 0.5
#define BATCH 256u
#define ASK 512u                         /* looks between two calls of progress */
#define PARTS 16u                        /* batches between two calls of progress */
#define PARTS_DRAWN 8192u                /* elements drawn between two calls of progress */

struct weights { int64_t right, wrong, second; };

struct candidate { int64_t score; uint32_t element; uint8_t code; };

struct ranking {
	struct lod_crown crown;
	const struct lod_rank_options *options;
	struct lod_arena *arena;
	uint32_t *order, picked, count;
	uint8_t *growth;
	struct lod_simple *simple;
	bool *taken;
	struct candidate *heap;
	uint32_t heap_count;
	uint32_t points;             /* so many first elements are picked as points */
	/* Half the views, smaller pictures and fewer candidates: only the quality of the step is wanted. */
	bool rough;
	/* the step */
	bool known;                  /* codes were found by its trials */
	double scale;
	struct lod_crown_views views;
	struct weights weights;
	struct lod_crown_edges edges;
	/* The work that runs in parts. */
	void (*piece)(void *pieces, uint32_t i);
	uint32_t piece_first;
	double share;                /* of the work, as reported last */
	bool stopped;
};

/* ---- The value of an element ---- */

static int64_t score_of(const struct ranking *r, uint32_t element, const struct lod_gain *gain)
{
	int64_t sum = r->weights.right * gain->right - r->weights.wrong * gain->wrong
		+ r->weights.second * gain->second;
	const uint32_t *first = r->crown.foliage->first;
	int64_t triangles = r->crown.points ? 1 : first[element + 1] - first[element] - 2;
	return sum > 0 ? sum * 12 / triangles : sum * triangles;
}

/* Scores of codes first .. last, but for `known` (ECO_NONE: none), whose score is there. Codes with the same
 * edge share one look. */
static void look(const struct ranking *r, uint32_t element, uint32_t first, uint32_t last, uint32_t known,
	int64_t score[ECO_GROWTHS])
{
	struct lod_gain gain[ECO_GROWTHS];
	double edge[ECO_GROWTHS] = { 0 };
	uint32_t at[ECO_GROWTHS], count = 0;
	const uint16_t *step = r->edges.step;
	for (uint32_t c = first; c <= last; c++) {
		at[c] = ECO_NONE;
		if (known != ECO_NONE && step[c] == step[known])
			continue;
		if (c == first || at[c - 1] == ECO_NONE || step[c] != step[c - 1])
			edge[count++] = r->edges.edge[c];
		at[c] = count - 1;
	}
	if (count)
		lod_crown_gain(&r->crown, element, edge, count, r->views, gain);
	for (uint32_t c = first; c <= last; c++)
		score[c] = at[c] == ECO_NONE ? score[known] : score_of(r, element, &gain[at[c]]);
}

/* The score of the code that was best at the last look. */
static int64_t score_now(const struct ranking *r, const struct candidate *c)
{
	int64_t score[ECO_GROWTHS];
	look(r, c->element, c->code, c->code, ECO_NONE, score);
	return score[c->code];
}

/* Climbs from the code that was best at the last look. `fresh`: its score is that of now. */
static void assess(const struct ranking *r, struct candidate *c, bool fresh)
{
	int64_t score[ECO_GROWTHS];
	uint32_t code = c->code, first = code > 0 ? code - 1 : code;
	uint32_t last = code + 1 < ECO_GROWTHS ? code + 1 : code;
	score[code] = c->score;
	look(r, c->element, first, last, fresh ? code : ECO_NONE, score);
	for (uint32_t next = first; next <= last; next++)
		if (score[next] > score[code])
			code = next;
	for (uint32_t way = code - c->code; way && code > 0 && code + 1 < ECO_GROWTHS; code += way) {
		look(r, c->element, code + way, code + way, code, score);
		if (score[code + way] <= score[code])
			break;
	}
	c->score = score[code];
	c->code = (uint8_t)code;
}

/* ---- Picking ---- */

static bool before(const struct candidate *a, const struct candidate *b)
{
	return a->score != b->score ? a->score > b->score : a->element < b->element;
}

static void sift_down(struct candidate *heap, uint32_t count, uint32_t i)
{
	struct candidate moved = heap[i];
	for (uint32_t child; (child = 2 * i + 1) < count; i = child) {
		if (child + 1 < count && before(&heap[child + 1], &heap[child]))
			child++;
		if (!before(&heap[child], &moved))
			break;
		heap[i] = heap[child];
	}
	heap[i] = moved;
}

/* Reports progress now and then. The share never falls, although trials undo their picks. */
static bool goes_on(struct ranking *r)
{
	double share = LOD_RANK_REFINE_FROM * r->picked / r->count;
	r->share = share > r->share ? share : r->share;
	if (!r->stopped && r->options->progress)
		r->stopped = !r->options->progress(r->options->ctx, r->share);
	return !r->stopped;
}

static void assess_batch(void *pieces, uint32_t batch)
{
	struct ranking *r = pieces;
	uint32_t end = (batch + 1) * BATCH < r->heap_count ? (batch + 1) * BATCH : r->heap_count;
	for (uint32_t i = batch * BATCH; i < end; i++)
		if (r->known)
			r->heap[i].score = score_now(r, &r->heap[i]);
		else
			assess(r, &r->heap[i], false);
}

static void run_part(void *pieces, uint32_t i)
{
	struct ranking *r = pieces;
	r->piece(r, r->piece_first + i);
}

/* Runs pieces in parts, and reports progress between them. */
static bool run(struct ranking *r, uint32_t count, void (*piece)(void *, uint32_t))
{
	r->piece = piece;
	for (uint32_t at = 0; at < count && goes_on(r); at += PARTS) {
		uint32_t part = count - at < PARTS ? count - at : PARTS;
		r->piece_first = at;
		lod_each_run(r->options->each, r->options->ctx, part, run_part, r);
	}
	return !r->stopped;
}

/* Candidates: all elements that are not taken; of a long list a sample that is large against the step (as
 * good in expectation but for e^-SHARE; Mirzasoleiman and others 2015). */
static void gather(struct ranking *r, uint32_t end, uint64_t salt)
{
	uint64_t most = (uint64_t)end * (r->rough ? CANDIDATES_ROUGH : CANDIDATES_SHARE);
	uint64_t enough = CANDIDATES_MOST + 3 * (uint64_t)(end - r->picked);
	uint32_t left = r->count - r->picked;
	uint32_t least = r->rough ? CANDIDATES_LEAST_ROUGH : CANDIDATES_LEAST;
	most = most < least ? least : most < enough ? most : enough;
	r->heap_count = 0;
	for (uint32_t i = 0; i < r->count; i++)
		if (!r->taken[i] && (most >= left || lod_mix(salt * r->count + i) % left < most))
			r->heap[r->heap_count++] = (struct candidate){ .element = i, .code = r->growth[i] };
}

static void make_heap(struct ranking *r)
{
	if (!run(r, (r->heap_count + BATCH - 1) / BATCH, assess_batch))
		return;
	for (uint32_t i = 0; i < r->heap_count; i++)
		r->growth[r->heap[i].element] = r->heap[i].code;         /* the next look begins there */
	for (uint32_t i = r->heap_count / 2; i-- > 0;)
		sift_down(r->heap, r->heap_count, i);
}

/* Looks at the top with its present code. Whether it is no longer the best: then its other codes need no look
 * yet. */
static bool fades(const struct ranking *r, struct candidate *top)
{
	int64_t known = top->score, next = r->heap_count > 1 ? r->heap[1].score : INT64_MIN;
	if (r->heap_count > 2 && r->heap[2].score > next)
		next = r->heap[2].score;
	top->score = score_now(r, top);
	return top->score < next && top->score < known;
}

/* Picks the best until `end` are taken. Lazy: only the element that gained most at its last look is looked at
 * again. */
static void pick(struct ranking *r, uint32_t end)
{
	for (uint32_t looks = 1; r->picked < end && r->heap_count && (looks % ASK || goes_on(r)); looks++) {
		struct candidate *top = &r->heap[0];
		int64_t known = top->score;
		if (fades(r, top)) {
			sift_down(r->heap, r->heap_count, 0);
			continue;
		}
		assess(r, top, true);
		if (top->score < known) {
			struct candidate now = *top;
			sift_down(r->heap, r->heap_count, 0);
			if (r->heap[0].element != now.element)
				continue;
		}
		uint32_t element = r->heap[0].element;
		r->growth[element] = r->heap[0].code;
		r->taken[element] = true;
		r->order[r->picked++] = element;
		lod_crown_add(&r->crown, element, r->edges.edge[r->growth[element]], r->views);
		r->heap[0] = r->heap[--r->heap_count];
		if (r->heap_count)
			sift_down(r->heap, r->heap_count, 0);
	}
}

/* ---- Steps ---- */

static void redraw(struct ranking *r)
{
	lod_crown_clear(&r->crown, r->views);
	for (uint32_t k = 0; k < r->picked && ((k + 1) % PARTS_DRAWN || goes_on(r)); k++)
		lod_crown_add(&r->crown, r->order[k], r->edges.edge[r->growth[r->order[k]]], r->views);
}

static double quality(const struct lod_crown_sum *s)
{
	double p = s->right + s->wrong ? (double)s->right / (double)(s->right + s->wrong) : 1;
	double recall = s->wanted ? (double)s->right / (double)s->wanted : 1;
	return 1 - sqrt((1 - p) * (1 - p) + (1 - recall) * (1 - recall));
}

/* Q's gradient at Precision = Recall = 1 - e, the balance that the choice of scales stays near: there a wrong
 * pixel costs (1 - e) / (1 + e) of the gain of a right one. Taken at the end of the trial instead it swings
 * from step to step. */
static struct weights gradient(double reached)
{
	double e = (1 - reached) * 0.70710678;
	return (struct weights){ WEIGHT, (int64_t)(WEIGHT * (1 - e) / (1 + e)), WEIGHT / SECOND };
}

static double try_scale(struct ranking *r, uint32_t end, double scale)
{
	uint32_t picked = r->picked;
	r->views = (struct lod_crown_views){ 0, r->crown.views > TRIAL_VIEWS ? r->crown.views / TRIAL_VIEWS
		: 1 };
	lod_crown_set_scale(&r->edges, scale, r->crown.points);
	redraw(r);
	gather(r, end, picked);
	make_heap(r);
	pick(r, end);
	struct lod_crown_sum sum = lod_crown_sum(&r->crown, r->views);
	for (; r->picked > picked; r->taken[r->order[r->picked]] = false)
		r->picked--;
	return quality(&sum);
}

static double choose_scale(struct ranking *r, uint32_t end, double last)
{
	double best_scale = 1, best = -2;
	r->known = false;
	if (end == r->count)
		return 1;
	for (uint32_t i = 0; i < SCALES; i++) {
		static const double part[SCALES] = { 1, 0.8, 0.64, 0.5, 0.36 };
		double scale = 1 + (last - 1) * part[i];
		double reached = try_scale(r, end, scale);
		if (reached > best) {
			best = reached;
			best_scale = scale;
		}
		if (r->stopped || scale == 1 || reached < best - 0.002)
			break;
	}
	r->weights = gradient(best);
	r->known = end <= KNOWN_MOST * r->count;
	return best_scale;
}

/* Ends of steps: about twice as many elements, finer where few are left out. */
static uint32_t next_end(uint32_t count, uint32_t picked)
{
	double share = (double)picked / count, next = share * 1.8;
	if (picked < 4)
		return picked + 1 < count ? picked + 1 : count;
	if (share > 0.49)
		next = share + 0.17;
	uint32_t end = (uint32_t)(next * count + 0.5);
	return next > 0.95 || end > count ? count : end > picked ? end : picked + 1;
}

static void fit_batch(void *pieces, uint32_t batch)
{
	struct ranking *r = pieces;
	uint32_t end = (batch + 1) * BATCH < r->count ? (batch + 1) * BATCH : r->count;
	for (uint32_t i = batch * BATCH; i < end; i++) {
		struct lod_fan fan = lod_foliage_fan(r->crown.foliage, i);
		lod_simple_fit(&r->simple[i], &fan);
	}
}

/* Makes steps until the list has `until` elements; steps that end at or before `points` pick points. */
static bool take_steps(struct ranking *r, uint32_t until, uint32_t points)
{
	while (r->picked < until) {
		uint32_t end = next_end(r->count, r->picked);
		end = end < until ? end : until;
		r->crown.points = end <= points;
		lod_crown_set_level(&r->crown, r->rough ? (end + 1) / 2 : end);
		r->scale = choose_scale(r, end, r->scale);
		r->views = (struct lod_crown_views){ 0, r->rough ? 2 : 1 };
		lod_crown_set_scale(&r->edges, r->scale, r->crown.points);
		redraw(r);
		gather(r, end, r->picked);
		make_heap(r);
		pick(r, end);
		if (!goes_on(r))
			return false;
	}
	return true;
}

static void begin_anew(struct ranking *r)
{
	r->picked = 0;
	r->scale = r->count;
	r->weights = gradient(0.5);
	memset(r->taken, 0, r->count * sizeof *r->taken);
	memset(r->growth, ECO_GROWTH_PLAIN, r->count);
}

/* The beginning is made of points, unless as many vertices show more as leaves. A rough trial tells as well
 * as one with all views (lod/EXPERIMENTS.md, Lists that begin with points). */
static bool begin_list(struct ranking *r)
{
	uint32_t points = (uint32_t)(POINTS_MOST * r->count);
	uint32_t leaves =
		(uint32_t)((double)points * r->count / (3.0 * r->crown.foliage->triangle_first[r->count]));
	double q[2];
	r->points = points;
	if (leaves == 0)
		return true;
	for (int as_points = 0; as_points < 2; as_points++) {
		begin_anew(r);
		r->rough = !as_points;
		if (!take_steps(r, as_points ? points : leaves, as_points ? points : 0))
			return false;
		struct lod_crown_sum sum = lod_crown_sum(&r->crown, r->views);
		q[as_points] = quality(&sum);
	}
	if (1 - q[1] > POINTS_LOSS * (1 - q[0])) {
		begin_anew(r);
		r->points = (uint32_t)(POINTS_LEAST * r->count);
	}
	return true;
}

static bool make_steps(struct ranking *r)
{
	begin_anew(r);
	return (r->options->leaves || begin_list(r))
		&& take_steps(r, r->count, r->points);
}

/* Larger plants are seen from fewer directions, since more elements lie in each (lod/EXPERIMENTS.md, Views of
 * the greedy order). */
static uint32_t views_of(uint32_t count)
{
	uint32_t views = SEEN / count;
	if (count > LARGE)
		return VIEWS_LEAST / 2;
	return views < VIEWS_LEAST ? VIEWS_LEAST : views > VIEWS_MOST ? VIEWS_MOST : views;
}

enum eco_code lod_rank_make(struct lod_rank *rank, const struct lod_foliage *foliage,
	const struct lod_rank_options *options, struct lod_arena *arena, struct eco_error *error)
{
	struct ranking r = { .options = options, .arena = arena, .count = foliage->count };
	struct lod_rank_options crown = *options;
	crown.views = crown.views ? crown.views : views_of(foliage->count);
	assert(foliage->count > 0);
	rank->order = r.order = lod_arena_take(arena, r.count, sizeof *r.order);
	rank->growth = r.growth = lod_arena_take(arena, r.count, sizeof *r.growth);
	rank->simple = r.simple = lod_arena_take(arena, r.count, sizeof *rank->simple);
	const struct lod_arena_piece *mark = arena->last;
	r.taken = lod_arena_take(arena, r.count, sizeof *r.taken);
	r.heap = lod_arena_take(arena, r.count, sizeof *r.heap);
	lod_crown_open(&r.crown, foliage, &crown, arena);
	bool good = run(&r, (r.count + BATCH - 1) / BATCH, fit_batch) && make_steps(&r)
		&& lod_rank_refine(&(struct lod_rank_refining){ &r.crown, options, r.count, r.order, r.growth,
		r.points == (uint32_t)(POINTS_MOST * r.count) }, arena);
	lod_arena_release(arena, mark);
	return good ? ECO_OK : eco_fail(error, ECO_INTERRUPTED, "interrupted while ordering leaves");
}
