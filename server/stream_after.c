/* Parts of an answer that are answers of their own: the first picture, and chunks that the next view lacks.
 * And more lists for bytes that are left. */
#include "ecofiles/base/random.h"
#include "ecofiles/base/order.h"
#include "ecofiles/format/wire.h"
#include "server/stream.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

/* ---- The first picture ---- */

#define FIRST_PART 4u                    /* of the work may the first picture take */

/* `rest`, behind the last step of `first`. */
static void join(struct srv_stream *stream, struct srv_stream *first, struct srv_stream *rest)
{
	const struct srv_stream_input input = stream->input;
	const uint64_t work = stream->work + rest->work;
	const struct srv_step picture = first->steps[--first->step_count];
	rest->cut_short |= first->cut_short;
	*stream = *rest;
	*rest = (struct srv_stream){ .step_count = 0 };
	stream->input = input;
	stream->work = work;
	for (uint32_t i = stream->step_count++; i > 0; i--)
		stream->steps[i] = stream->steps[i - 1];
	stream->steps[0] = picture;
}

static bool draws(const struct srv_stream *stream)
{
	return stream->fits && stream->steps[stream->step_count - 1].plan.vertices;
}

/* The first picture is all of the answer. */
static void keep(struct srv_stream *stream, struct srv_stream *first, uint64_t work)
{
	const struct srv_stream_input input = stream->input;
	work += stream->work;
	*stream = *first;
	*first = (struct srv_stream){ .step_count = 0 };
	stream->input = input;
	stream->work = work;
	stream->cut_short = true;
}

/* Little work is left where the rest draws nothing. */
static enum eco_code plan_rest(struct srv_stream *stream, struct srv_stream *first,
	struct eco_error *error)
{
	const struct srv_step *picture = &first->steps[first->step_count - 1];
	struct eco_request request = *stream->input.request;
	struct srv_stream_input input = stream->input;
	struct srv_stream rest;
	input.request = &request;
	input.holdings = &picture->needs;
	input.level_work = input.work_max;
	input.work_max = input.work_max ? srv_work_left(stream) + 1 : 0;
	request.bytes -= picture->end_bytes;
	enum eco_code code = srv_stream_plan(&rest, &input, error);
	if (!code && draws(&rest) && rest.step_count < SRV_STEPS_MAX)
		join(stream, first, &rest);
	else if (!code && rest.cut_short)
		keep(stream, first, rest.work);
	if (!code)
		srv_stream_free(&rest);
	return !code && stream->step_count ? srv_size_all(stream, error) : code;
}

enum eco_code srv_plan_first(struct srv_stream *stream, struct eco_error *error)
{
	struct eco_request request = *stream->input.request;
	struct srv_stream_input input = stream->input;
	struct srv_stream first;
	input.request = &request;
	input.explain = false;
	input.single = true;
	input.level_work = input.work_max;
	input.work_max = input.work_max ? input.work_max / FIRST_PART + 1 : 0;
	request.bytes = SRV_FIRST_BYTES;
	request.next.given = false;
	enum eco_code code = srv_stream_plan(&first, &input, error);
	if (code)
		return code;
	stream->work += first.work;
	if (draws(&first))
		code = plan_rest(stream, &first, error);
	srv_stream_free(&first);
	if (!code && stream->body_bytes > stream->input.request->bytes) {
		input = stream->input;
		const uint64_t work = stream->work;
		srv_stream_free(stream);
		*stream = (struct srv_stream){ .input = input, .work = work };
	}
	return code;
}

/* ---- The next view ---- */

void srv_stream_drop_next(struct srv_stream *stream)
{
	for (uint32_t i = 0; i < stream->next_count; i++)
		free(stream->next[i].items);
	stream->next_count = 0;
}

/* The client's holdings after the answer: the longest prefix of each list. */
static enum eco_code held_then(const struct srv_stream *stream, struct eco_holdings *then,
	struct eco_error *error)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	const struct eco_holdings *now = stream->input.holdings;
	uint32_t *chunks = calloc(scene->list_count + 1u, sizeof *chunks), count = 0;
	*then = (struct eco_holdings){ .items = malloc((scene->list_count + 1u) * sizeof *then->items) };
	for (uint32_t i = 0; chunks && now && i < now->count; i++)
		chunks[now->items[i].list] = now->items[i].chunks;
	for (uint32_t s = 0; chunks && s < stream->step_count + stream->next_count; s++) {
		const struct eco_holdings *needs = s < stream->step_count ? &stream->steps[s].needs
			: &stream->next[s - stream->step_count];
		for (uint32_t i = 0; i < needs->count; i++)
			if (needs->items[i].chunks > chunks[needs->items[i].list])
				chunks[needs->items[i].list] = needs->items[i].chunks;
	}
	for (uint32_t list = 0; chunks && then->items && list < scene->list_count; list++)
		if (chunks[list])
			then->items[count++] = (struct eco_holding){ list, chunks[list] };
	then->count = count;
	free(chunks);
	return chunks && then->items ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory to follow %u lists",
		scene->list_count);
}

enum eco_code srv_plan_next(struct srv_stream *stream, struct eco_error *error)
{
	struct eco_request request = *stream->input.request;
	struct srv_stream_input input = stream->input;
	struct srv_stream next;
	struct eco_holdings then;
	uint64_t without = stream->body_bytes, ahead = without + ECO_FRAME_HEADER_BYTES;
	if (stream->input.request->bytes < ahead)
		return ECO_OK;
	enum eco_code code = held_then(stream, &then, error);
	request.view = eco_view_next(stream->input.request);
	request.next.given = false;
	if (request.bytes != ECO_BYTES_UNBOUNDED)
		request.bytes -= ahead;
	input.request = &request;
	input.holdings = &then;
	input.explain = false;
	input.work_max = input.work_max ? srv_work_left(stream) : 0;
	if (!code)
		code = srv_stream_plan(&next, &input, error);
	free(then.items);
	if (code)
		return code;
	stream->work += next.work;
	stream->cut_short |= next.cut_short;
	for (uint32_t i = 0; i < next.step_count && next.fits; i++) {
		stream->next[stream->next_count++] = next.steps[i].needs;
		next.steps[i].needs = (struct eco_holdings){ 0 };
	}
	srv_stream_free(&next);
	code = srv_size_all(stream, error);
	if (!code && (stream->body_bytes > stream->input.request->bytes || stream->body_bytes == ahead)) {
		srv_stream_drop_next(stream);
		code = srv_size_all(stream, error);
	}
	stream->next_bytes = stream->body_bytes - without;
	return code;
}

/* ---- The rest of the bytes ---- */

struct lacking { struct eco_holding item; uint32_t held; uint64_t bytes; };

ECO_ORDER_TWO(by_bytes, struct lacking, ->bytes, ->item.list)

/* The wanted lists that lack something; returns their number. */
static uint32_t find_lacking(const struct srv_stream *stream, const struct eco_holdings *held,
	struct lacking *lacking)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	uint32_t count = 0;
	for (uint32_t i = 0; i < stream->wanted.count; i++) {
		const struct eco_holdings one = { .items = &stream->wanted.items[i], .count = 1 };
		struct lacking *to = &lacking[count];
		*to = (struct lacking){ one.items[0], eco_holdings_chunks(held, one.items[0].list),
			lod_plan_missing(scene, held, &one, NULL) };
		count += to->bytes > 0;
	}
	qsort(lacking, count, sizeof *lacking, by_bytes);
	return count;
}

/* As many chunks of these as `room` holds; frames about them are not counted. */
static void take_chunks(struct srv_stream *stream, const struct lacking *lacking, uint32_t count,
	uint64_t room)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t end = lacking[i].held, first = scene->lists[lacking[i].item.list].chunk_first;
		const struct eco_chunk *chunks = &scene->chunks[first];
		for (; end < lacking[i].item.chunks && chunks[end].size_bytes <= room; end++)
			room -= chunks[end].size_bytes;
		if (end > lacking[i].held)
			stream->rest.items[stream->rest.count++]
				= (struct eco_holding){ lacking[i].item.list, end };
	}
}

/* The last chunk of the last list goes until the frames have room, too. */
static enum eco_code fit_rest(struct srv_stream *stream,
	const struct eco_holdings *held, struct eco_error *error)
{
	enum eco_code code = srv_size_all(stream, error);
	while (!code && stream->body_bytes > stream->input.request->bytes) {
		struct eco_holding *last = &stream->rest.items[stream->rest.count - 1];
		if (--last->chunks <= eco_holdings_chunks(held, last->list))
			stream->rest.count--;
		code = srv_size_all(stream, error);
	}
	return code;
}

enum eco_code srv_send_rest(struct srv_stream *stream, struct eco_error *error)
{
	struct eco_holdings held;
	uint64_t room = stream->input.request->bytes - stream->body_bytes;
	/* bytes go to a later picture only once there is one */
	if (!stream->wanted.count || !stream->steps[stream->step_count - 1].plan.vertices)
		return ECO_OK;
	enum eco_code code = held_then(stream, &held, error);
	struct lacking *lacking = malloc(stream->wanted.count * sizeof *lacking);
	stream->rest.items = malloc(stream->wanted.count * sizeof *stream->rest.items);
	if (!code && (!lacking || !stream->rest.items))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u lists", stream->wanted.count);
	if (!code) {
		take_chunks(stream, lacking, find_lacking(stream, &held, lacking), room);
		code = fit_rest(stream, &held, error);
	}
	free(lacking);
	free(held.items);
	return code;
}

/* ---- The work of an ordinary request ---- */

#define WORK_MOST 4000000u       /* of one of them: a scene so large is not asked for more */
#define BYTES_EVERY 4u           /* requests with a byte budget */
#define FAILED_MOST 4u           /* requests that need more tiles or plants than any may */
#define PLANT_WORK 29u           /* least that is ordinary, for each plant of the scene */

static double between(uint64_t *state, double low, double high)
{
	return low + (high - low) * eco_random_unit(eco_random_next(state));
}

/* Each power of two as likely, by arithmetic that every machine rounds alike. */
static uint64_t power(uint64_t *state, int low, int high)
{
	return (uint64_t)ldexp(1, low + (int)between(state, 0, high - low + 1));
}

static struct eco_request request_of(const struct eco_tile *root, uint64_t *state, uint32_t number)
{
	struct eco_request request = { .view = { .up = { 0, 0, 1 },
		.width = (uint32_t)power(state, 0, 12), .height = (uint32_t)power(state, 0, 12) },
		.bytes = ECO_BYTES_UNBOUNDED };
	double reach = ldexp((double)power(state, 0, 9), -4);
	request.view.fov_y_deg = between(state, 1, 150);
	for (int i = 0; i < 3; i++) {
		double middle = (root->low[i] + root->high[i]) / 2, half = (root->high[i] - root->low[i]) / 2
			+ 1e-3;
		request.view.target[i] = middle + half * between(state, -1, 1);
		request.view.eye[i] = request.view.target[i] + half * reach * between(state, -1, 1);
	}
	request.vertices = power(state, 0, 27);
	if (number % BYTES_EVERY == 0)
		request.bytes = power(state, 3, 25);
	return request;
}

ECO_ORDER(ascending, uint64_t, [0])

/* 0: cancelled. */
static uint64_t median_work(const struct srv_scene *scene, const atomic_bool *cancelled)
{
	const struct eco_scene *tables = &scene->pack->scene;
	uint64_t works[SRV_TYPICAL_REQUESTS] = { 0 }, state = 1;
	for (uint32_t i = 0, failed = 0; i < SRV_TYPICAL_REQUESTS && tables->tile_count; i++) {
		struct eco_request request = request_of(&tables->tiles[tables->root], &state, i);
		struct srv_stream stream;
		if (eco_view_check(&request.view, NULL))
			continue;
		enum eco_code code = srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = scene,
			.request = &request, .work_max = WORK_MOST, .cancelled = cancelled }, NULL);
		if (code == ECO_INTERRUPTED)
			return 0;
		if (code == ECO_TOO_LARGE && ++failed == FAILED_MOST)
			return WORK_MOST;
		if (code)
			continue;
		works[i] = stream.work;
		srv_stream_free(&stream);
	}
	qsort(works, SRV_TYPICAL_REQUESTS, sizeof *works, ascending);
	uint64_t work = works[SRV_TYPICAL_REQUESTS / 2];
	return work > SRV_TYPICAL_WORK_LEAST ? work : SRV_TYPICAL_WORK_LEAST;
}

static uint64_t least_work(const struct srv_scene *scene)
{
	const struct eco_scene *tables = &scene->pack->scene;
	uint64_t plants = tables->tile_count ? tables->tiles[tables->root].instance_count : 0;
	const uint64_t wide = SRV_TYPICAL_WORK_WIDE, least = plants < wide ? PLANT_WORK * plants : wide;
	return least < SRV_TYPICAL_WORK_LEAST ? SRV_TYPICAL_WORK_LEAST : least < wide ? least : wide;
}

uint64_t srv_typical_find(struct srv_scene *scene, const atomic_bool *cancelled)
{
	static pthread_mutex_t finding = PTHREAD_MUTEX_INITIALIZER; /* one thread finds it, the others wait */
	uint64_t work = atomic_load(&scene->typical_work);
	if (work)
		return work;
	pthread_mutex_lock(&finding);
	work = atomic_load(&scene->typical_work);
	if (!work) {
		work = median_work(scene, cancelled);
		work = work == 0 || work > least_work(scene) ? work : least_work(scene);
		atomic_store(&scene->typical_work, work);
	}
	pthread_mutex_unlock(&finding);
	return work;
}

bool srv_typical_find_all(const struct srv_store *store, const atomic_bool *cancelled)
{
	for (uint32_t i = 0; i < store->count; i++)
		if (!srv_typical_find(store->scenes[i], cancelled))
			return false;
	return true;
}
