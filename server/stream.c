/* See server/stream.h. */
#include "server/stream.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "lod/plan/planner.h"
#include "ecofiles/format/wire_body.h"
#include "server/log.h"

#define BODY_MAX_DEFAULT (1ull << 31)
#define STEP_RATIO 1.3                       /* bytes of a step over those of the step before */
#define STEP_BYTES_LEAST 10000u              /* no step goes before one that lacks so few */
#define COARSER_PART 128u                     /* of the bytes is left to coarser answers: 1 / so many */
#define FIRST_MOST 64u                       /* times the bytes of a first picture: more seldom bind, and steps come */
#define SIZING_WORK 12u                      /* a cut or a list whose bytes are counted */
#define AHEAD_PART 4u                        /* the next view is planned if so much of the work is left */

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

static enum eco_code needs_of(struct srv_stream *stream, struct srv_step *step, struct eco_error *error)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	free(step->needs.items);
	step->needs = (struct eco_holdings){ 0 };
	enum eco_code code = lod_plan_needs(scene, &step->plan, &step->needs, error);
	if (!code)
		step->missing_bytes = lod_plan_missing(scene, stream->input.holdings, &step->needs, NULL);
	return code;
}

uint64_t srv_work_left(const struct srv_stream *stream)
{
	uint64_t most = stream->input.work_max;
	return !most ? UINT64_MAX : most > stream->work ? most - stream->work : 0;
}

/* The answer and coarser ones, from fine to coarse: on their ground, within the bytes if these fit at all. */
static enum eco_code plan_answer(struct srv_stream *stream, struct srv_step *step, struct eco_error *error)
{
	const struct srv_stream_input *input = &stream->input;
	struct lod_planner_stats stats = { 0 };
	struct lod_planner_coarser coarser = { STEP_RATIO, STEP_BYTES_LEAST, SRV_STEPS_MAX - 1, stream->coarser, 0 };
	struct eco_request request = *input->request;
	request.bytes -= input->single || request.bytes == ECO_BYTES_UNBOUNDED ? 0 : request.bytes / COARSER_PART;
	const struct lod_planner_input planner = { .scene = &input->scene->pack->scene,
		.tables = input->scene->tables, .request = &request, .holdings = input->holdings,
		.rule = input->rule, .ignore_occlusion = input->ignore_occlusion, .work_max = input->work_max,
		.level_work = input->level_work,
		.places = input->places, .cancelled = input->cancelled, .stats = &stats, .sent = true, .coarser = input->single ? NULL : &coarser,
		.explanation = input->explain ? &step->why : NULL, .wanted = &stream->wanted };
	enum eco_code code = lod_plan(&step->plan, &planner, error);
	stream->work += stats.work;
	stream->cut_short |= planner.work_max && stats.work >= planner.work_max / 2;
	stream->fits = stats.bytes <= input->request->bytes;
	stream->body_bytes = stats.bytes;
	if (!code)
		srv_trace(SRV_TRACE_PLAN, "%llu of %llu vertices in %u cuts: the search %s, a byte must save "
			"%g pixels, %u answers sized, ground of %g pixels, %llu bytes",
			(unsigned long long)step->plan.vertices, (unsigned long long)input->request->vertices,
			step->plan.cut_count, stats.converged ? "converged" : "ended at its bound of tries",
			stats.price, stats.sized, step->plan.ground_px, (unsigned long long)stats.bytes);
	assert(code || step->plan.vertices <= input->request->vertices);
	stream->coarser_count = coarser.count;
	return code ? code : needs_of(stream, step, error);
}

/* `ends`: per step, the body's bytes so far; NULL: not asked for. */
static enum eco_code add_frames(struct eco_wire_body *to, const struct srv_stream *stream, uint64_t *ends,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	eco_wire_body_scene(to);
	for (uint32_t i = 0; i < stream->step_count && !code; i++) {
		code = eco_wire_body_step(to, &stream->steps[i].plan, &stream->steps[i].needs, error);
		if (ends)
			ends[i] = to->bytes;
	}
	if (stream->next_count && !code)
		eco_wire_body_ahead(to);
	for (uint32_t i = 0; i < stream->next_count && !code; i++)
		code = eco_wire_body_needs(to, &stream->next[i], error);
	if (!code)
		code = eco_wire_body_needs(to, &stream->rest, error);
	if (!code)
		eco_wire_body_end(to, stream->steps[stream->step_count - 1].plan.vertices);
	return code;
}

static enum eco_code write_frames(struct eco_wire_body *to, const struct srv_stream *stream, bool dry, uint64_t *ends,
	struct eco_error *error)
{
	const struct srv_stream_input *input = &stream->input;
	enum eco_code code = eco_wire_body_init(to, &input->scene->pack->scene, dry ? NULL : input->scene->pack,
		input->holdings, input->request->name_from, error);
	to->cancelled = input->cancelled;
	return code ? code : add_frames(to, stream, ends, error);
}

/* A dry run of the answer's frames takes about so much. */
static void count_sizing(struct srv_stream *stream, const struct srv_step *step)
{
	uint64_t lists = stream->input.scene->pack->scene.list_count;
	stream->work += SIZING_WORK * ((uint64_t)step->plan.cut_count + step->needs.count) + lists / 4;
}

/* ---- Steps ---- */

/* Puts coarser answers before the answer. */
static enum eco_code add_coarser(struct srv_stream *stream, struct eco_error *error)
{
	const uint32_t count = stream->coarser_count;
	enum eco_code code = ECO_OK;
	stream->steps[count] = stream->steps[0];
	stream->step_count += count;
	for (uint32_t i = 0; i < count; i++)
		stream->steps[i] = (struct srv_step){ .plan = stream->coarser[count - 1 - i] };
	stream->coarser_count = 0;
	for (uint32_t i = 0; i < count && !code; i++)
		code = needs_of(stream, &stream->steps[i], error);
	return code;
}

enum eco_code srv_size_all(struct srv_stream *stream, struct eco_error *error)
{
	uint64_t ends[SRV_STEPS_MAX];
	for (uint32_t i = 0; i < stream->step_count; i++)
		count_sizing(stream, &stream->steps[i]);
	struct eco_wire_body dry;
	enum eco_code code = write_frames(&dry, stream, true, ends, error);
	for (uint32_t i = 0; !code && i < stream->step_count; i++)
		stream->steps[i].end_bytes = ends[i];
	stream->body_bytes = dry.bytes;
	stream->chunk_count = dry.chunk_count;
	stream->chunk_bytes = dry.chunk_bytes;
	stream->named_bytes = dry.named_bytes;
	eco_wire_body_free(&dry);
	return code;
}

/* Bytes of a step that the answer does not use. */
static uint64_t wasted_bytes(const struct srv_stream *stream, uint32_t number)
{
	const struct eco_holdings *needs = &stream->steps[number].needs, *answer = &stream->steps[stream->step_count - 1].needs;
	uint64_t sum = 0;
	for (uint32_t i = 0; i < needs->count; i++) {
		const struct eco_list *list = &stream->input.scene->pack->scene.lists[needs->items[i].list];
		uint32_t held = eco_holdings_chunks(stream->input.holdings, needs->items[i].list),
			used = eco_holdings_chunks(answer, needs->items[i].list);
		for (uint32_t c = held > used ? held : used; c < needs->items[i].chunks; c++)
			sum += stream->input.scene->pack->scene.chunks[list->chunk_first + c].size_bytes;
	}
	return sum;
}

/* Leaves out the coarse step that wastes most; of equals the finest. */
static void leave_out_step(struct srv_stream *stream)
{
	uint32_t worst = 0;
	for (uint32_t i = 1; i + 1 < stream->step_count; i++)
		worst = wasted_bytes(stream, i) >= wasted_bytes(stream, worst) ? i : worst;
	srv_trace(SRV_TRACE_PLAN, "a step of %llu vertices left out: no room in the byte budget",
		(unsigned long long)stream->steps[worst].plan.vertices);
	step_free(&stream->steps[worst]);
	stream->step_count--;
	for (uint32_t i = worst; i < stream->step_count; i++)
		stream->steps[i] = stream->steps[i + 1];
}

/* Coarse steps send a little that the answer does not use: they give way where the byte budget has no room
 * for that. */
static enum eco_code fit_steps(struct srv_stream *stream, struct eco_error *error)
{
	enum eco_code code = add_coarser(stream, error);
	if (!code)
		code = srv_size_all(stream, error);
	while (!code && stream->body_bytes > stream->input.request->bytes) {
		assert(stream->step_count > 1);
		leave_out_step(stream);
		code = srv_size_all(stream, error);
	}
	return code;
}

/* ---- The answer ---- */

/* Whether bytes probably bind and nothing would be drawn before most of them have come. */
static bool is_first_visit(const struct srv_stream *stream)
{
	uint64_t bytes = stream->input.request->bytes;
	return (!stream->input.rule || stream->input.rule == lod_rule_optimal) && bytes > 2 * SRV_FIRST_BYTES && bytes < FIRST_MOST * SRV_FIRST_BYTES
		&& !(stream->input.holdings && stream->input.holdings->count);
}

static enum eco_code check_body(const struct srv_stream *stream, struct eco_error *error)
{
	uint64_t most = stream->input.body_max ? stream->input.body_max : BODY_MAX_DEFAULT;
	return !stream->fits || stream->body_bytes - stream->named_bytes <= most ? ECO_OK
		: eco_fail(error, ECO_TOO_LARGE, "the response would have %llu bytes; at most %llu are sent: ask for "
		"fewer vertices, or set 'bytes'", (unsigned long long)stream->body_bytes, (unsigned long long)most);
}

static enum eco_code plan_all(struct srv_stream *stream, struct eco_error *error)
{
	const struct eco_request *request = stream->input.request;
	enum eco_code code = is_first_visit(stream) ? srv_plan_first(stream, error) : ECO_OK;
	if (code || stream->step_count)
		return code;
	code = plan_answer(stream, &stream->steps[stream->step_count++], error);
	if (code || !stream->fits)
		return code;
	code = fit_steps(stream, error);
	if (!code && request->next.given && srv_work_left(stream) >= stream->input.work_max / AHEAD_PART)
		code = srv_plan_next(stream, error);
	return code ? code : srv_send_rest(stream, error);
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
	*stream = (struct srv_stream){ .input = *input };
	stream->input.explain |= srv_trace_on(SRV_TRACE_CUTS);
	enum eco_code code = plan_all(stream, error);
	code = code ? code : check_body(stream, error);
	if (code) {
		srv_stream_free(stream);
		return code;
	}
	if (srv_trace_on(SRV_TRACE_CUTS))
		trace_cuts(stream);
	return ECO_OK;
}

/* Pieces are frames, and the payloads between them, whose hashes are checked. */
static enum eco_code take_pieces(const struct srv_stream *stream, struct eco_wire_body *from, struct srv_body *body,
	struct eco_error *error)
{
	body->pieces = malloc((2 * (size_t)from->payload_count + 1) * sizeof *body->pieces);
	if (!body->pieces)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the response's frames");
	body->frames = from->frames;
	body->size_bytes = from->bytes - from->named_bytes;
	from->frames = (struct eco_writer){ 0 };
	size_t at = 0;
	for (uint32_t i = 0; i <= from->payload_count; i++) {
		const struct eco_wire_payload *payload = &from->payloads[i];
		size_t end = i < from->payload_count ? payload->at : body->frames.size;
		if (end > at || i == from->payload_count)
			body->pieces[body->piece_count++] = (struct srv_piece){ body->frames.bytes + at, end - at };
		at = end;
		if (i == from->payload_count)
			break;
		struct srv_piece *piece = &body->pieces[body->piece_count++];
		const uint8_t *bytes;
		ECO_PASS(srv_scene_payload(stream->input.scene, payload->chunk, &bytes, &piece->size, error));
		piece->bytes = bytes;
	}
	return ECO_OK;
}

enum eco_code srv_stream_write(const struct srv_stream *stream, struct srv_body *body,
	struct eco_error *error)
{
	struct eco_wire_body frames;
	assert(stream->fits);
	*body = (struct srv_body){ 0 };
	enum eco_code code = write_frames(&frames, stream, false, NULL, error);
	code = code ? code : take_pieces(stream, &frames, body, error);
	eco_wire_body_free(&frames);
	if (code)
		srv_body_free(body);
	assert(code || body->size_bytes == stream->body_bytes - stream->named_bytes);
	return code;
}
