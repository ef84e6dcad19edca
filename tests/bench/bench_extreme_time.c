/* Time: a server that keeps nothing between requests must answer a camera that does not move with the same bytes for ever, and one that
 * trembles by less than anyone can see with a plan that does not swing between two. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lod/arena.h"
#include "lod/sort.h"
#include "server/stream.h"
#include "tests/bench/bench_extreme_scene.h"

#define STILL 10000u
#define STILL_QUICK 200u
#define JITTER_M 1e-9

static bool bytes_of(struct extreme *x, struct extreme_world *world, const struct eco_request *request, struct eco_writer *bytes)
{
	struct eco_plan plan = { 0 };
	if (!extreme_plan_of(x, &world->scene->pack->scene, request, &plan))
		return false;
	*bytes = extreme_plan_bytes(&plan);
	eco_plan_free(&plan);
	return true;
}

/* ---- Still ---- */

static void still(struct extreme *x)
{
	struct extreme_world world;
	struct eco_request request = extreme_request(5000);
	struct eco_writer first = { 0 };
	uint32_t count = x->quick ? STILL_QUICK : STILL, asked = 1;
	bool good = extreme_world_shared(x, &world) && bytes_of(x, &world, &request, &first);
	for (; asked < count && good; asked++) {
		struct eco_writer next = { 0 };
		good = bytes_of(x, &world, &request, &next) && extreme_must(x, extreme_same_bytes(&first, &next),
			"request %u is answered differently", asked);
		eco_writer_free(&next);
	}
	extreme_say(x, "%u requests, %zu bytes of plan, all the same", asked, first.size);
	eco_writer_free(&first);
	extreme_world_close(&world);
}

/* The whole body, payloads and all, when nothing is held. */
static bool body_of(struct extreme *x, struct extreme_world *world, const struct eco_request *request, struct eco_writer *out)
{
	struct srv_stream stream = { 0 };
	struct srv_body body = { 0 };
	struct eco_error error = { 0 };
	bool good = extreme_good(x, srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = world->scene, .request = request }, &error), &error)
		&& extreme_must(x, stream.fits, "no body fits") && extreme_good(x, srv_stream_write(&stream, &body, &error), &error);
	for (uint32_t i = 0; i < body.piece_count && good; i++)
		eco_write_bytes(out, body.pieces[i].bytes, body.pieces[i].size);
	srv_body_free(&body);
	srv_stream_free(&stream);
	return good;
}

static void still_streams(struct extreme *x)
{
	static const uint64_t most[] = { ECO_BYTES_UNBOUNDED, 100000, 20000 };
	struct extreme_world world;
	bool good = extreme_world_shared(x, &world);
	for (int b = 0; b < 3 && good; b++) {
		struct eco_request request = extreme_request(20000);
		struct eco_writer first = { 0 };
		request.bytes = most[b];
		good = body_of(x, &world, &request, &first);
		for (uint32_t i = 1; i < (x->quick ? 5 : 100) && good; i++) {
			struct eco_writer next = { 0 };
			good = body_of(x, &world, &request, &next) && extreme_must(x, extreme_same_bytes(&first, &next), "body %u differs", i);
			eco_writer_free(&next);
		}
		extreme_must(x, !good || first.size <= most[b], "%zu bytes of at most %llu", first.size, (unsigned long long)most[b]);
		extreme_say(x, "%zu bytes", first.size);
		eco_writer_free(&first);
	}
	extreme_world_close(&world);
}

/* ---- Trembling ---- */

static double unit(uint64_t *state) { return eco_mix_unit(*state = lod_mix(*state + 1)) * 2 - 1; }

/* Plans of views that differ by a nanometre: how many different ones there are, how often one follows another, and how far apart they are. */
static void jitter(struct extreme *x)
{
	enum { VIEWS = 4 };
	struct extreme_world world;
	uint32_t count = x->quick ? 50 : 1000, changes = 0;
	uint64_t state = 5, least = UINT64_MAX, most = 0;
	bool good = extreme_world_shared(x, &world);
	for (int v = 0; v < VIEWS && good; v++) {
		struct eco_request still_request = extreme_request(5000);
		struct eco_writer last = { 0 };
		double wrong[2] = { INFINITY, 0 };
		still_request.view.eye[0] += 3.7 * v;
		still_request.view.eye[1] += 1.3 * v;
		least = UINT64_MAX;
		most = 0;
		for (uint32_t i = 0; i < count && good; i++) {
			struct eco_request request = still_request;
			struct eco_plan plan = { 0 };
			for (int k = 0; k < 3; k++)
				request.view.eye[k] += JITTER_M * unit(&state);
			good = extreme_plan_of(x, &world.scene->pack->scene, &request, &plan);
			if (!good)
				break;
			struct eco_prediction p = plan.prediction;
			plan.prediction = (struct eco_prediction){ 0 };      /* numbers that may differ in their last bits */
			struct eco_writer bytes = extreme_plan_bytes(&plan);
			changes += i && !extreme_same_bytes(&last, &bytes);
			eco_writer_free(&last);
			last = bytes;
			least = plan.vertices < least ? plan.vertices : least;
			most = plan.vertices > most ? plan.vertices : most;
			wrong[0] = fmin(wrong[0], p.fp + p.fn);
			wrong[1] = fmax(wrong[1], p.fp + p.fn);
			eco_plan_free(&plan);
		}
		extreme_must(x, !good || wrong[1] - wrong[0] <= 1e-4 * wrong[1], "predicted wrong pixels swing from %.6f to %.6f", wrong[0], wrong[1]);
		extreme_must(x, !good || most - least <= most / 1000, "vertices swing from %llu to %llu", (unsigned long long)least,
			(unsigned long long)most);
		eco_writer_free(&last);
	}
	extreme_must(x, changes <= VIEWS * count / 100, "%u of %u plans differ from the one before", changes, VIEWS * count);
	extreme_say(x, "%u views, %u requests each: %u plans differ from the one before", VIEWS, count, changes);
	extreme_world_close(&world);
}

/* An eye exactly on the border between two bands of a plant: trembling may change that plant's band, and hardly anything else. */
static void on_border(struct extreme *x)
{
	struct extreme_world world;
	uint64_t state = 9;
	double largest = 0;
	uint32_t count = x->quick ? 40 : 200;
	bool good = extreme_world_shared(x, &world);
	for (int v = 0; v < 6 && good; v++) {
		struct eco_request request = extreme_request(5000);
		double wrong[2] = { INFINITY, 0 }, away = 8 * exp2(v / 4.0);
		memcpy(request.view.eye, (double[3]){ -away, -away, 3 }, sizeof request.view.eye);
		for (uint32_t i = 0; i < count && good; i++) {
			struct eco_request now = request;
			struct eco_plan plan = { 0 };
			now.view.eye[0] += 1e-3 * unit(&state);
			good = extreme_plan_of(x, &world.scene->pack->scene, &now, &plan);
			if (good) {
				wrong[0] = fmin(wrong[0], plan.prediction.fp + plan.prediction.fn);
				wrong[1] = fmax(wrong[1], plan.prediction.fp + plan.prediction.fn);
				eco_plan_free(&plan);
			}
		}
		largest = fmax(largest, wrong[1] / wrong[0] - 1);
		extreme_must(x, !good || wrong[1] <= 1.02 * wrong[0], "a millimetre to and fro: predicted wrong pixels from %.2f to %.2f", wrong[0],
			wrong[1]);
	}
	extreme_say(x, "predicted wrong pixels move by %.2f %% at most", 100 * largest);
	extreme_world_close(&world);
}

/* ---- Teleporting ---- */

static void teleport(struct extreme *x)
{
	static const double eyes[][3] = { { -26, -21, 6.5 }, { 0, 0, 1.7 }, { 1e6, 0, 1e5 }, { 5, 5, -2 }, { 1e9, 1e9, 1 }, { -26, -21, 6.5 + 1e-9 } };
	enum { EYES = sizeof eyes / sizeof *eyes };
	struct extreme_world world;
	struct eco_writer first[EYES] = { { 0 } };
	uint32_t count = x->quick ? 100 : 1000;
	uint64_t state = 3;
	bool good = extreme_world_shared(x, &world);
	for (uint32_t i = 0; i < count + EYES && good; i++) {
		uint32_t at = i < EYES ? i : (uint32_t)(lod_mix(state++) % EYES);
		struct eco_request request = extreme_request(5000);
		struct eco_writer bytes = { 0 };
		memcpy(request.view.eye, eyes[at], sizeof request.view.eye);
		good = bytes_of(x, &world, &request, &bytes)
			&& extreme_must(x, i < EYES || extreme_same_bytes(&first[at], &bytes), "jump %u back to place %u is answered differently", i, at);
		if (good && i < EYES)
			first[at] = bytes;
		else
			eco_writer_free(&bytes);
	}
	for (int i = 0; i < EYES; i++)
		eco_writer_free(&first[i]);
	extreme_say(x, "%u jumps between %d places, each answered as at first", count, EYES);
	extreme_world_close(&world);
}

static const struct extreme_case cases[] = {
	{ "a camera that stands still", "10^4 plans of the same request are the same bytes", false, still },
	{ "streams to a camera that stands still", "100 bodies are the same bytes, also where bytes are bounded", false, still_streams },
	{ "trembling by 1e-9 m", "at most 1 % of plans differ from the one before; vertices within 0.1 %, predicted error within 1e-4", false, jitter },
	{ "trembling by 1 mm on the way past borders of bands", "predicted error within 2 %", false, on_border },
	{ "teleporting", "1000 jumps between six places, from inside the stand to 1e9 m: each answered as at first", false, teleport },
};

const struct extreme_family extreme_time = { "time", cases, sizeof cases / sizeof *cases };
