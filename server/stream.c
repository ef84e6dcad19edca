/* Longer than 600 lines: steps, byte budgets and ground are made of one another's. */
#include "server/stream.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "lod/plan/planner.h"
#include "server/emit.h"
#include "server/log.h"

#define BODY_MAX_DEFAULT (1ull << 31)
#define STEP_RATIO 1.3                       /* bytes of a step over those of the step before */
#define STEP_BYTES_LEAST 10000u              /* no step goes before one of so few, ... */
#define FIRST_MOST 64u                       /* times the bytes of a first picture: more seldom bind, and steps come */
#define STEP_PRICED_LEAST 5000u              /* ground and bytes without a price may be half of it */
#define SEARCH_PLANS_MAX 40u
#define SEARCH_SLACK 256u                    /* the search ends within 1/256 of the budget */
#define GROUND_STEP 4.0                      /* how much coarser the ground of each coarse step is */
#define GROUND_PX_SCARCE 2.0                 /* up to here ground gives way before plants */
#define GROUND_TRIES 8u                      /* halvings of the way from the tolerance asked for to that */
/* ground takes at most this part of a byte budget that plants do not fit in */
#define GROUND_SHARE 4u
#define SIZING_WORK 12u                      /* a cut or a list whose bytes are counted */
#define AHEAD_PART 4u                        /* the next view is planned if so much of the work is left */
#define SEARCH_PART 8u                       /* of the work may each plan of a search of vertices take */

static void step_free(struct srv_step *step)
{
	eco_plan_free(&step->plan);
	lod_explanation_free(&step->why);
	free(step->needs.items);
	*step = (struct srv_step){ 0 };
}

static void drop_coarser(struct srv_stream *stream)
{
	for (uint32_t i = 0; i < stream->coarser_count; i++)
		eco_plan_free(&stream->coarser[i]);
	stream->coarser_count = 0;
}

void srv_stream_free(struct srv_stream *stream)
{
	drop_coarser(stream);
	srv_stream_drop_next(stream);
	free(stream->wanted.items);
	free(stream->rest.items);
	for (uint32_t i = 0; i < stream->step_count; i++)
		step_free(&stream->steps[i]);
	*stream = (struct srv_stream){ 0 };
}

void srv_body_free(struct srv_body *body)
{
	free(body->pieces);
	eco_writer_free(&body->frames);
	*body = (struct srv_body){ 0 };
}

enum eco_code srv_holdings_check(const struct eco_scene *scene, const struct eco_holdings *holdings,
	struct eco_error *error)
{
	for (uint32_t i = 0; i < holdings->count; i++) {
		const struct eco_holding *item = &holdings->items[i];
		if (item->list >= scene->list_count)
			return eco_fail(error, ECO_BAD_INPUT, "list %u does not exist: the scene has %u "
				"lists; send the holdings of this pack, or "
				"none", item->list, scene->list_count);
		if (item->chunks > scene->lists[item->list].chunk_count)
			return eco_fail(error, ECO_BAD_INPUT, "%u chunks of list %u are said to be held, but "
				"it has %u; send the holdings of this pack, or none", item->chunks,
				item->list, scene->lists[item->list].chunk_count);
	}
	return ECO_OK;
}

uint64_t srv_missing_bytes(const struct eco_scene *scene, const struct eco_holdings *holdings,
	const struct eco_holdings *needs)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < needs->count; i++) {
		const struct eco_list *list = &scene->lists[needs->items[i].list];
		for (uint32_t c = eco_holdings_chunks(holdings, needs->items[i].list);
				c < needs->items[i].chunks; c++)
			sum += scene->chunks[list->chunk_first + c].size_bytes;
	}
	return sum;
}

static enum eco_code needs_of(struct srv_stream *stream, struct srv_step *step, struct eco_error *error)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	free(step->needs.items);
	step->needs = (struct eco_holdings){ 0 };
	enum eco_code code = lod_plan_needs(scene, &step->plan, &step->needs, error);
	if (!code)
		step->missing_bytes = srv_missing_bytes(scene, stream->input.holdings, &step->needs);
	return code;
}

static struct lod_planner_input planner_input(const struct srv_stream_input *input,
	const struct eco_request *request)
{
	return (struct lod_planner_input){ .scene = &input->scene->pack->scene,
		.tables = input->scene->tables, .request = request, .holdings = input->holdings,
		.rule = input->rule, .ignore_occlusion = input->ignore_occlusion, .work_max = input->work_max,
		.cancelled = input->cancelled };
}

uint64_t srv_work_left(const struct srv_stream *stream)
{
	uint64_t most = stream->input.work_max;
	return !most ? UINT64_MAX : most > stream->work ? most - stream->work : 0;
}

static enum eco_code check_cancelled(const struct srv_stream *stream, struct eco_error *error)
{
	const atomic_bool *cancelled = stream->input.cancelled;
	return cancelled && atomic_load(cancelled) ? eco_fail(error, ECO_INTERRUPTED,
		"the client closed the connection, or the server is stopping; ask again in a "
		"moment") : ECO_OK;
}

/* Deussen's rule knows no bytes: vertices are searched for it. */
static bool searches(const struct srv_stream *stream)
{
	return stream->input.rule && stream->input.rule != lod_rule_optimal;
}

/* Sizes answers while they are planned, with their ground. */
struct sizing {
	struct srv_stream *stream;
	struct srv_emit *dry;
	uint64_t most;               /* bytes */
	double ground_px;
	bool settled;                /* the ground has given way */
};

/* `sizing` NULL: bytes do not bind. */
static enum eco_code size_answer(void *ctx, struct eco_plan *plan, uint64_t *bytes,
	struct eco_error *error);
static enum eco_code take_coarser(void *ctx, struct eco_plan *plan, double wrong, struct eco_error *error);

static enum eco_code make_step(struct srv_stream *stream, uint64_t vertices, double ground_px,
	struct sizing *sizing, struct srv_step *step, struct eco_error *error)
{
	const struct srv_stream_input *input = &stream->input;
	struct eco_request request = *input->request;
	struct lod_planner_stats stats = { 0 };
	struct lod_planner_input planner = planner_input(input, &request);
	const struct lod_planner_coarser coarser = { STEP_RATIO, STEP_PRICED_LEAST, SRV_STEPS_MAX - 1,
		take_coarser, stream };
	if (searches(stream) && input->request->bytes != ECO_BYTES_UNBOUNDED)
		planner.work_max /= SEARCH_PART;
	planner.stats = &stats;
	planner.explanation = input->explain ? &step->why : NULL;
	*step = (struct srv_step){ .ground_px = ground_px };
	if (check_cancelled(stream, error))
		return ECO_INTERRUPTED;
	request.vertices = vertices;
	request.ground_px = ground_px;
	if (sizing) {
		request.bytes = sizing->most;
		planner.size = size_answer;
		planner.size_ctx = sizing;
		planner.coarser = &coarser;
		planner.wanted = &stream->wanted;
		drop_coarser(stream);
	}
	enum eco_code code = lod_plan(&step->plan, &planner, error);
	stream->work += stats.work;
	stream->cut_short |= planner.work_max && stats.work >= planner.work_max / 2;
	if (!code)
		srv_trace(SRV_TRACE_PLAN, "%llu of %llu vertices in %u cuts: the search %s, a byte must save "
			"%g pixels, %u answers sized",
			(unsigned long long)step->plan.vertices, (unsigned long long)vertices,
			step->plan.cut_count, stats.converged ? "converged" : "ended at its bound of tries",
			stats.price, stats.sized);
	if (!code && sizing && sizing->ground_px != ground_px)
		code = lod_plan_ground(&step->plan, planner.scene, &request.view, sizing->ground_px, error);
	if (!code && sizing)
		step->ground_px = sizing->ground_px;
	if (!code)
		code = needs_of(stream, step, error);
	if (code) {
		step_free(step);
		return code;
	}
	assert(step->plan.vertices <= vertices);
	return ECO_OK;
}

/* The same plants on other ground. */
static enum eco_code change_ground(struct srv_stream *stream, struct srv_step *step, double ground_px,
	struct eco_error *error)
{
	step->ground_px = ground_px;
	enum eco_code code = lod_plan_ground(&step->plan, &stream->input.scene->pack->scene,
		&stream->input.request->view, ground_px, error);
	return code ? code : needs_of(stream, step, error);
}

/* Emits a whole body of one step; *emit has been initialised or restarted. */
static enum eco_code emit_one(struct srv_emit *emit, const struct srv_step *step, struct eco_error *error)
{
	srv_emit_scene(emit);
	enum eco_code code = srv_emit_step(emit, &step->plan, &step->needs, error);
	if (!code)
		srv_emit_end(emit, step->plan.vertices);
	return code;
}

/* The same of all of the stream. `ends`: per step; NULL: not asked for. */
static enum eco_code emit_all(struct srv_emit *emit, const struct srv_stream *stream, uint64_t *ends,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	srv_emit_scene(emit);
	for (uint32_t i = 0; i < stream->step_count && !code; i++) {
		code = srv_emit_step(emit, &stream->steps[i].plan, &stream->steps[i].needs, error);
		if (ends)
			ends[i] = emit->bytes;
	}
	if (stream->next_count && !code)
		srv_emit_ahead(emit);
	for (uint32_t i = 0; i < stream->next_count && !code; i++)
		code = srv_emit_needs(emit, &stream->next[i], error);
	if (!code)
		code = srv_emit_needs(emit, &stream->rest, error);
	if (!code)
		srv_emit_end(emit, stream->steps[stream->step_count - 1].plan.vertices);
	return code;
}

/* A dry run of the answer's frames takes about so much. */
static void count_sizing(struct srv_stream *stream, const struct srv_step *step)
{
	uint64_t lists = stream->input.scene->pack->scene.list_count;
	stream->work += SIZING_WORK * ((uint64_t)step->plan.cut_count + step->needs.count) + lists / 4;
}

static enum eco_code size_of(struct srv_stream *stream, struct srv_emit *dry, const struct srv_step *step,
	uint64_t *bytes, struct eco_error *error)
{
	count_sizing(stream, step);
	srv_emit_restart(dry, stream->input.holdings);
	enum eco_code code = check_cancelled(stream, error);
	code = code ? code : emit_one(dry, step, error);
	*bytes = dry->bytes;
	return code;
}

/* ---- Byte budget ---- */

struct search {
	uint64_t low, low_bytes;     /* fits */
	uint64_t high, high_bytes;   /* does not */
	uint32_t tries;
};

/* Bytes grow fast at first and slower later, so a straight line between the ends aims too low in vertices or
 * too high in bytes; every other try halves the interval, which bounds the number of tries whatever the
 * curve. */
static uint64_t next_try(const struct search *s, uint64_t budget_bytes)
{
	uint64_t span = s->high - s->low;
	if (s->tries % 2 || s->high_bytes <= s->low_bytes)
		return s->low + span / 2;
	double part = (double)(budget_bytes - s->low_bytes) / (double)(s->high_bytes - s->low_bytes);
	part = part < 1 / 64.0 ? 1 / 64.0 : part > 63 / 64.0 ? 63 / 64.0 : part;
	uint64_t step = (uint64_t)(part * (double)span);
	return s->low + (step < 1 ? 1 : step >= span ? span - 1 : step);
}

static bool search_done(const struct search *s, uint64_t budget_bytes)
{
	uint64_t span = s->high - s->low;
	return span <= 1 || span <= s->low / SEARCH_SLACK || budget_bytes - s->low_bytes
		<= budget_bytes / SEARCH_SLACK || s->tries >= SEARCH_PLANS_MAX;
}

static enum eco_code size_on(struct srv_stream *stream, struct srv_emit *dry, struct srv_step *step,
	double ground_px, uint64_t *bytes, struct eco_error *error)
{
	enum eco_code code = change_ground(stream, step, ground_px, error);
	if (!code)
		code = size_of(stream, dry, step, bytes, error);
	srv_trace(SRV_TRACE_PLAN, "byte budget %llu: ground of %g pixels, %llu vertices take %llu bytes",
		(unsigned long long)stream->input.request->bytes, ground_px,
		(unsigned long long)step->plan.vertices, (unsigned long long)*bytes);
	return code;
}

/* All the plants that were asked for, on about the finest ground up to GROUND_PX_SCARCE with which they fit;
 * else *fits is false. */
static enum eco_code spare_ground(struct srv_stream *stream, struct srv_emit *dry, struct srv_step *step,
	uint64_t *bytes, bool *fits, struct eco_error *error)
{
	double finer = step->ground_px, px = GROUND_PX_SCARCE;
	*fits = false;
	if (!stream->input.scene->pack->scene.ground_count || finer >= px)
		return ECO_OK;
	enum eco_code code = size_on(stream, dry, step, px, bytes, error);
	*fits = !code && *bytes <= stream->input.request->bytes;
	if (!*fits)
		return code;
	for (uint32_t tries = 0; !code && tries < GROUND_TRIES; tries++) {
		double middle = sqrt(finer * px);
		uint64_t size;
		code = size_on(stream, dry, step, middle, &size, error);
		if (code)
			break;
		if (size <= stream->input.request->bytes) {
			px = middle;
			*bytes = size;
		} else {
			finer = middle;
		}
	}
	return code || step->ground_px == px ? code : change_ground(stream, step, px, error);
}

static uint64_t missing_ground_bytes(const struct srv_stream *stream, const struct srv_step *step)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	uint64_t sum = 0;
	for (uint32_t i = 0; i < step->needs.count; i++) {
		const struct eco_list *list = &scene->lists[step->needs.items[i].list];
		if (list->kind == ECO_LIST_GROUND
				&& !eco_holdings_chunks(stream->input.holdings, step->needs.items[i].list))
			sum += scene->chunks[list->chunk_first].size_bytes;
	}
	return sum;
}

/* Whether ground takes more than its share of so many bytes. */
static bool ground_is_large(const struct srv_stream *stream, const struct srv_step *step, uint64_t most)
{
	return missing_ground_bytes(stream, step) > most / GROUND_SHARE;
}

/* Makes the ground coarser until it takes no more than its share; where it always does, as coarse as takes
 * least: a few tiles of rough ground may need more than finer ones beside the view. */
static enum eco_code coarsen_ground(struct srv_stream *stream, struct srv_step *step, uint64_t most,
	struct eco_error *error)
{
	double best_px = step->ground_px;
	uint64_t least = missing_ground_bytes(stream, step);
	enum eco_code code = ECO_OK;
	while (!code && step->ground_px < ECO_GROUND_PX_MAX && ground_is_large(stream, step, most)) {
		code = change_ground(stream, step, fmin(GROUND_STEP * step->ground_px, ECO_GROUND_PX_MAX), error);
		if (code || missing_ground_bytes(stream, step) >= least)
			continue;
		least = missing_ground_bytes(stream, step);
		best_px = step->ground_px;
	}
	return code || step->ground_px == best_px ? code : change_ground(stream, step, best_px, error);
}

/* Makes the ground coarser until it leaves room, when plants give way too. `step` is the plan for 0 vertices;
 * *bytes its body. */
static enum eco_code scarce_ground(struct srv_stream *stream, struct srv_emit *dry, struct srv_step *step,
	uint64_t *bytes, struct eco_error *error)
{
	enum eco_code code = size_of(stream, dry, step, bytes, error);
	uint64_t most = stream->input.request->bytes;
	while (!code && step->ground_px < ECO_GROUND_PX_MAX
			&& (ground_is_large(stream, step, most)
		|| (*bytes > most && stream->input.scene->pack->scene.ground_count)))
		code = size_on(stream, dry, step, fmin(GROUND_STEP * step->ground_px, ECO_GROUND_PX_MAX),
			bytes, error);
	return code;
}

/* For a rule that knows no bytes. `best` holds the plan for the whole vertex budget, whose body of `bytes`
 * does not fit. Afterwards it holds the step to send, or that for 0 vertices with *fits false. */
static enum eco_code search_budget(struct srv_stream *stream, struct srv_emit *dry, struct srv_step *best,
	uint64_t *bytes, bool *fits, struct eco_error *error)
{
	uint64_t budget_bytes = stream->input.request->bytes;
	double ground_px = best->ground_px;
	enum eco_code code = spare_ground(stream, dry, best, bytes, fits, error);
	if (code || *fits)
		return code;
	struct search s = { .high = best->plan.vertices, .high_bytes = *bytes };
	step_free(best);
	code = make_step(stream, 0, ground_px > GROUND_PX_SCARCE ? ground_px : GROUND_PX_SCARCE, NULL, best,
		error);
	if (!code)
		code = scarce_ground(stream, dry, best, &s.low_bytes, error);
	ground_px = best->ground_px;
	*fits = !code && s.low_bytes <= budget_bytes;
	*bytes = s.low_bytes;
	for (; !code && *fits && !search_done(&s, budget_bytes) && srv_work_left(stream) > 0; s.tries++) {
		uint64_t vertices = next_try(&s, budget_bytes), size;
		struct srv_step step;
		code = make_step(stream, vertices, ground_px, NULL, &step, error);
		if (code)
			break;
		code = size_of(stream, dry, &step, &size, error);
		if (code) {
			step_free(&step);
			break;
		}
		srv_trace(SRV_TRACE_PLAN, "byte budget %llu: %llu vertices take %llu bytes",
			(unsigned long long)budget_bytes, (unsigned long long)vertices,
			(unsigned long long)size);
		if (size <= budget_bytes) {
			step_free(best);
			*best = step;
			s.low = vertices;
			s.low_bytes = *bytes = size;
		} else {
			step_free(&step);
			s.high = vertices;
			s.high_bytes = size;
		}
	}
	return code;
}

/* The ground gives way first, as far as it may and once; then it leaves room. */
static enum eco_code settle_ground(struct sizing *sizing, struct srv_step *step, uint64_t *bytes,
	struct eco_error *error)
{
	bool fits;
	double asked = step->ground_px;
	enum eco_code code = spare_ground(sizing->stream, sizing->dry, step, bytes, &fits, error);
	if (!code && !fits) {
		code = change_ground(sizing->stream, step, fmax(asked, GROUND_PX_SCARCE), error);
		if (!code)
			code = coarsen_ground(sizing->stream, step, sizing->most, error);
		if (!code)
			code = size_of(sizing->stream, sizing->dry, step, bytes, error);
	}
	sizing->ground_px = step->ground_px;
	sizing->settled = true;
	return code;
}

static enum eco_code size_answer(void *ctx, struct eco_plan *plan, uint64_t *bytes, struct eco_error *error)
{
	struct sizing *sizing = ctx;
	struct srv_step step = { .plan = *plan, .ground_px = sizing->ground_px };
	enum eco_code code = change_ground(sizing->stream, &step, sizing->ground_px, error);
	if (!code)
		code = size_of(sizing->stream, sizing->dry, &step, bytes, error);
	if (!code && !sizing->settled && *bytes > sizing->most)
		code = settle_ground(sizing, &step, bytes, error);
	*plan = step.plan;
	free(step.needs.items);
	return code;
}

/* ---- Steps ---- */

static enum eco_code take_coarser(void *ctx, struct eco_plan *plan, double wrong, struct eco_error *error)
{
	(void)error, (void)wrong;
	struct srv_stream *stream = ctx;
	stream->coarser[stream->coarser_count++] = *plan;
	return ECO_OK;
}

/* Puts a coarser answer before steps[0], on ground that takes no more than its share. */
static enum eco_code add_coarser(struct srv_stream *stream, uint32_t number, struct eco_error *error)
{
	struct eco_plan *plan = &stream->coarser[number];
	struct srv_step step = { .plan = *plan };
	*plan = (struct eco_plan){ 0 };
	enum eco_code code = change_ground(stream, &step, stream->steps[0].ground_px, error);
	while (!code && step.ground_px < ECO_GROUND_PX_MAX && ground_is_large(stream, &step, step.missing_bytes))
		code = change_ground(stream, &step, fmin(GROUND_STEP * step.ground_px, ECO_GROUND_PX_MAX),
			error);
	bool clear = step.missing_bytes < stream->steps[0].missing_bytes;
	srv_trace(SRV_TRACE_PLAN, "coarser answer of %llu vertices: %llu missing bytes before %llu%s",
		(unsigned long long)step.plan.vertices, (unsigned long long)step.missing_bytes,
		(unsigned long long)stream->steps[0].missing_bytes, clear ? "" : ": left out");
	if (code || !clear) {
		step_free(&step);
		return code;
	}
	for (uint32_t i = stream->step_count++; i > 0; i--)
		stream->steps[i] = stream->steps[i - 1];
	stream->steps[0] = step;
	return ECO_OK;
}

enum eco_code srv_size_all(struct srv_stream *stream, struct srv_emit *dry, struct eco_error *error)
{
	uint64_t ends[SRV_STEPS_MAX];
	for (uint32_t i = 0; i < stream->step_count; i++)
		count_sizing(stream, &stream->steps[i]);
	srv_emit_restart(dry, stream->input.holdings);
	enum eco_code code = check_cancelled(stream, error);
	code = code ? code : emit_all(dry, stream, ends, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < stream->step_count; i++)
		stream->steps[i].end_bytes = ends[i];
	stream->body_bytes = dry->bytes;
	stream->chunk_count = dry->chunk_count;
	stream->chunk_bytes = dry->chunk_bytes;
	stream->named_bytes = dry->named_bytes;
	return ECO_OK;
}

/* Coarse steps send a little that the answer does not use: they give way where the byte budget has no room
 * for that. */
static enum eco_code fit_steps(struct srv_stream *stream, struct srv_emit *dry, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < stream->coarser_count && !code
			&& stream->steps[0].missing_bytes > STEP_BYTES_LEAST; i++)
		code = add_coarser(stream, i, error);
	if (!code)
		code = srv_size_all(stream, dry, error);
	while (!code && stream->body_bytes > stream->input.request->bytes) {
		assert(stream->step_count > 1);
		uint32_t last = --stream->step_count;    /* the finest coarse step goes */
		srv_trace(SRV_TRACE_PLAN, "a step of %llu vertices left out: no room in the byte budget",
			(unsigned long long)stream->steps[last - 1].plan.vertices);
		step_free(&stream->steps[last - 1]);
		stream->steps[last - 1] = stream->steps[last];
		code = srv_size_all(stream, dry, error);
	}
	return code;
}

/* ---- The answer ---- */

/* `step` does not fit on the ground that sizing settled on. On ground that fits, some plants may, too. */
static enum eco_code plan_on_scarce_ground(struct srv_stream *stream, struct sizing *sizing,
	struct srv_step *step, uint64_t *bytes, struct eco_error *error)
{
	enum eco_code code = scarce_ground(stream, sizing->dry, step, bytes, error);
	if (code || *bytes > sizing->most)
		return code;
	sizing->ground_px = step->ground_px;
	sizing->settled = true;
	step_free(step);
	code = make_step(stream, stream->input.request->vertices, sizing->ground_px, sizing, step, error);
	return code ? code : size_of(stream, sizing->dry, step, bytes, error);
}

/* The smallest answer draws nothing on the coarsest ground. */
static enum eco_code make_smallest(struct srv_stream *stream, struct srv_emit *dry, struct srv_step *step,
	uint64_t *bytes, struct eco_error *error)
{
	const struct eco_view *view = &stream->input.request->view;
	*step = (struct srv_step){ .plan.placements = malloc(sizeof *step->plan.placements) };
	if (!step->plan.placements)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plan");
	step->plan.placements[step->plan.placement_count++] = (struct eco_placement){ .scale = 1 };
	step->plan.prediction.fn = (double)view->width * view->height;
	enum eco_code code = change_ground(stream, step, ECO_GROUND_PX_MAX, error);
	return code ? code : size_of(stream, dry, step, bytes, error);
}

/* steps[0] and its bytes, within the request's if stream->fits. `smallest` is known to fit. */
static enum eco_code plan_answer(struct srv_stream *stream, struct srv_emit *dry, struct srv_step *smallest,
	uint64_t *bytes, struct eco_error *error)
{
	const struct eco_request *request = stream->input.request;
	double ground_px = request->ground_px > 0 ? request->ground_px : ECO_GROUND_PX;
	struct sizing sizing = { stream, dry, request->bytes, ground_px, false };
	uint64_t smallest_bytes = *bytes;
	enum eco_code code = make_step(stream, request->vertices, ground_px, searches(stream) ? NULL
		: &sizing, &stream->steps[0], error);
	if (code)
		return code;
	stream->step_count = 1;
	code = size_of(stream, dry, &stream->steps[0], bytes, error);
	if (!code && *bytes > request->bytes && !searches(stream))
		code = plan_on_scarce_ground(stream, &sizing, &stream->steps[0], bytes, error);
	stream->fits = *bytes <= request->bytes;
	if (!code && !stream->fits && searches(stream))
		code = search_budget(stream, dry, &stream->steps[0], bytes, &stream->fits, error);
	if (!code && !stream->fits) {
		step_free(&stream->steps[0]);
		stream->steps[0] = *smallest;
		*smallest = (struct srv_step){ 0 };
		*bytes = smallest_bytes;
		stream->fits = true;
	}
	return code;
}

/* Whether bytes probably bind and nothing would be drawn before most of them have come. */
static bool is_first_visit(const struct srv_stream *stream)
{
	uint64_t bytes = stream->input.request->bytes;
	return !searches(stream) && bytes > 2 * SRV_FIRST_BYTES && bytes < FIRST_MOST * SRV_FIRST_BYTES
		&& !(stream->input.holdings && stream->input.holdings->count);
}

static enum eco_code check_body(const struct srv_stream *stream, struct eco_error *error)
{
	uint64_t most = stream->input.body_max ? stream->input.body_max : BODY_MAX_DEFAULT;
	return !stream->fits || stream->body_bytes - stream->named_bytes <= most ? ECO_OK
		: eco_fail(error, ECO_TOO_LARGE, "the response would have %llu bytes; at most %llu are sent: ask for "
		"fewer vertices, or set 'bytes'", (unsigned long long)stream->body_bytes, (unsigned long long)most);
}

static enum eco_code plan_all(struct srv_stream *stream, struct srv_emit *dry, struct eco_error *error)
{
	const struct eco_request *request = stream->input.request;
	struct srv_step smallest;
	enum eco_code first = is_first_visit(stream) ? srv_plan_first(stream, dry, error) : ECO_OK;
	if (first || stream->step_count)
		return first;
	enum eco_code code = make_smallest(stream, dry, &smallest, &stream->body_bytes, error);
	if (!code && stream->body_bytes <= request->bytes) {
		code = plan_answer(stream, dry, &smallest, &stream->body_bytes, error);
		step_free(&smallest);
	} else {
		stream->steps[0] = smallest;
		stream->step_count = 1;
	}
	if (code || !stream->fits)
		return code;
	code = fit_steps(stream, dry, error);
	if (!code && request->next.given && srv_work_left(stream) >= stream->input.work_max / AHEAD_PART)
		code = srv_plan_next(stream, dry, error);
	return code ? code : srv_send_rest(stream, dry, error);
}

static void trace_cuts(const struct srv_stream *stream)
{
	const struct srv_scene *scene = stream->input.scene;
	const struct lod_explanation *why = &stream->steps[stream->step_count - 1].why;
	srv_trace(SRV_TRACE_CUTS, "%s: lambda %.4g, %u rows, %llu more", scene->name, why->lambda, why->count,
		(unsigned long long)why->omitted);
	for (uint32_t i = 0; i < why->count; i++) {
		char line[320];
		lod_explain_line(line, sizeof line, &scene->pack->scene, why, &why->rows[i]);
		srv_trace(SRV_TRACE_CUTS, "%s: %s", scene->name, line);
	}
}

enum eco_code srv_stream_plan(struct srv_stream *stream, const struct srv_stream_input *input,
	struct eco_error *error)
{
	struct srv_emit dry;
	*stream = (struct srv_stream){ .input = *input };
	stream->input.explain |= srv_trace_on(SRV_TRACE_CUTS);
	enum eco_code code = srv_emit_init(&dry, input->scene, input->holdings, input->request->name_from,
		true, error);
	if (code)
		return code;
	dry.cancelled = input->cancelled;
	code = plan_all(stream, &dry, error);
	code = code ? code : check_body(stream, error);
	srv_emit_free(&dry);
	if (code) {
		srv_stream_free(stream);
		return code;
	}
	struct srv_step *last = &stream->steps[stream->step_count - 1];
	if (stream->input.explain && last->why.most)     /* else it was not planned */
		lod_explain_ground(&last->why, &last->plan, &input->scene->pack->scene, last->ground_px);
	if (srv_trace_on(SRV_TRACE_CUTS))
		trace_cuts(stream);
	return ECO_OK;
}

enum eco_code srv_stream_write(const struct srv_stream *stream, struct srv_body *body,
	struct eco_error *error)
{
	struct srv_emit emit;
	assert(stream->fits);
	*body = (struct srv_body){ 0 };
	enum eco_code code = srv_emit_init(&emit, stream->input.scene, stream->input.holdings,
		stream->input.request->name_from, false, error);
	if (code)
		return code;
	emit.cancelled = stream->input.cancelled;
	code = emit_all(&emit, stream, NULL, error);
	if (!code)
		code = srv_emit_take(&emit, body, error);
	srv_emit_free(&emit);
	assert(code || body->size_bytes == stream->body_bytes - stream->named_bytes);
	return code;
}
