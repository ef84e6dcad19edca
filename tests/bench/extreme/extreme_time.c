/* Time: a server that keeps nothing between requests must answer a camera that does not move with the same
 * bytes for ever, and one that trembles by less than anyone can see with a plan that does not swing between
 * two. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/sort.h"
#include "tests/bench/extreme/extreme_scene.h"
#include "tests/support/serve/random_request.h"

/* ---- Still ---- */

static void still_plans(struct extreme *x)
{
	const struct eco_scene *scene = extreme_tables(extreme_world(x));
	struct eco_request request = extreme_request(5000);
	struct eco_writer first = { 0 };
	uint32_t count = x->quick ? 200 : 10000;
	for (uint32_t i = 0; i < count; i++)
		extreme_again(x, scene, &request, &first, NULL);
	extreme_say(x, "%u requests, %zu bytes of plan, all the same", count, first.size);
	eco_writer_free(&first);
}

static void still_streams(struct extreme *x)
{
	static const uint64_t most[] = { ECO_BYTES_UNBOUNDED, 100000, 20000 };
	for (int b = 0; b < 3; b++) {
		struct eco_request request = extreme_request(20000);
		struct eco_writer first = { 0 };
		request.bytes = most[b];
		for (uint32_t i = 0; i < (x->quick ? 5 : 100); i++) {
			struct eco_writer next = { 0 }, *to = i ? &next : &first;
			struct srv_body body;
			bool fits = random_answer(extreme_world(x)->scene, &request, NULL, 0, &body);
			extreme_must(x, fits, "no body fits");
			for (uint32_t p = 0; p < body.piece_count; p++)
				eco_write_bytes(to, body.pieces[p].bytes, body.pieces[p].size);
			srv_body_free(&body);
			extreme_must(x, !i || extreme_same_bytes(&first, &next), "body %u differs", i);
			eco_writer_free(&next);
		}
		extreme_most(x, "bytes", (double)first.size, (double)most[b]);
		extreme_say(x, "%zu bytes", first.size);
		eco_writer_free(&first);
	}
}

/* ---- Trembling ---- */

/* vertices, predicted wrong pixels */
struct swing { uint64_t least, most; double wrong[2]; uint32_t changes; };

/* Plans around one view, the eye moved by up to `reach_m` along so many axes. */
static struct swing tremble(struct extreme *x, const struct eco_request *still, double reach_m, int axes,
	uint32_t count, uint64_t *state)
{
	struct eco_writer last = { 0 };
	struct swing s = { .least = UINT64_MAX, .wrong = { INFINITY, 0 } };
	for (uint32_t i = 0; i < count; i++) {
		struct eco_request request = *still;
		struct eco_plan plan = { 0 };
		struct eco_writer bytes = { 0 };
		for (int k = 0; k < axes; k++)
			request.view.eye[k] += reach_m * (eco_random_unit(*state = lod_mix(*state + 1)) * 2
				- 1);
		extreme_plan(x, extreme_tables(extreme_world(x)), &request, &plan);
		double wrong = plan.prediction.fp + plan.prediction.fn;
		s.least = plan.vertices < s.least ? plan.vertices : s.least;
		s.most = plan.vertices > s.most ? plan.vertices : s.most;
		s.wrong[0] = fmin(s.wrong[0], wrong);
		s.wrong[1] = fmax(s.wrong[1], wrong);
		/* numbers that may differ in their last bits */
		plan.prediction = (struct eco_prediction){ 0 };
		eco_wire_write_plan(&bytes, &plan);
		s.changes += i && !extreme_same_bytes(&last, &bytes);
		eco_writer_free(&last);
		last = bytes;
		eco_plan_free(&plan);
	}
	eco_writer_free(&last);
	return s;
}

/* Views that differ by a nanometre: how many different plans there are, how often one follows another, and
 * how far apart they are. */
static void jitter(struct extreme *x)
{
	enum { VIEWS = 4 };
	uint32_t count = x->quick ? 50 : 1000, changes = 0;
	uint64_t state = 5;
	for (int v = 0; v < VIEWS; v++) {
		struct eco_request still = extreme_request(5000);
		still.view.eye[0] += 3.7 * v;
		still.view.eye[1] += 1.3 * v;
		struct swing s = tremble(x, &still, 1e-9, 3, count, &state);
		changes += s.changes;
		extreme_most(x, "swing of predicted wrong pixels", s.wrong[1] - s.wrong[0], 1e-4
			* s.wrong[1]);
		extreme_most(x, "swing of vertices", (double)(s.most - s.least), (double)(s.most / 1000));
	}
	extreme_most(x, "plans that differ from the one before", changes, VIEWS * count / 100.0);
	extreme_say(x, "%u views, %u requests each: %u plans differ from the one before", VIEWS, count,
		changes);
}

/* An eye exactly on the border between two bands of a plant: trembling may change that plant's band, with it
 * whether it is drawn as splats or by its organs, and hardly anything else. */
static void on_border(struct extreme *x)
{
	uint64_t state = 9;
	double largest = 0;
	for (int v = 0; v < 6; v++) {
		struct eco_request request = extreme_request(5000);
		double away = 8 * exp2(v / 4.0);
		memcpy(request.view.eye, (double[3]){ -away, -away, 3 }, sizeof request.view.eye);
		struct swing s = tremble(x, &request, 1e-3, 1, x->quick ? 40 : 200, &state);
		largest = fmax(largest, s.wrong[1] / s.wrong[0] - 1);
		extreme_most(x, "predicted wrong pixels, a millimetre to and fro", s.wrong[1], 1.04
			* s.wrong[0]);
	}
	extreme_say(x, "predicted wrong pixels move by %.2f %% at most", 100 * largest);
}

/* ---- Teleporting ---- */

static void teleport(struct extreme *x)
{
	static const double eyes[][3] = { { -26, -21, 6.5 }, { 0, 0, 1.7 }, { 1e6, 0, 1e5 }, { 5, 5, -2 },
		{ 1e9, 1e9, 1 }, { -26, -21, 6.5 + 1e-9 } };
	enum { EYES = sizeof eyes / sizeof *eyes };
	const struct eco_scene *scene = extreme_tables(extreme_world(x));
	struct eco_writer first[EYES] = { { 0 } };
	uint32_t count = x->quick ? 100 : 1000;
	uint64_t state = 3;
	for (uint32_t i = 0; i < count + EYES; i++) {
		uint32_t at = i < EYES ? i : (uint32_t)(lod_mix(state++) % EYES);
		struct eco_request request = extreme_request(5000);
		memcpy(request.view.eye, eyes[at], sizeof request.view.eye);
		extreme_again(x, scene, &request, &first[at], NULL);
	}
	for (int i = 0; i < EYES; i++)
		eco_writer_free(&first[i]);
	extreme_say(x, "%u jumps between %d places, each answered as at first", count, EYES);
}

const struct extreme_case extreme_time[] = {
	EXTREME_CASE("a camera that stands still", "10^4 plans of the same request are the same bytes",
		still_plans),
	EXTREME_CASE("streams to a camera that stands still",
		"100 bodies are the same bytes, also where bytes are bounded", still_streams),
	EXTREME_CASE("trembling by 1e-9 m",
		"at most 1 % of plans differ from the one before; vertices within 0.1 %, predicted error "
		"within 1e-4", jitter),
	EXTREME_CASE("trembling by 1 mm on the way past borders of bands", "predicted error within 2 %",
		on_border),
	EXTREME_CASE("teleporting",
		"1000 jumps between six places, from inside the stand to 1e9 m: each answered as at first",
			teleport),
	{ .name = NULL } };
