/* A flight of a minute: what is sent, with all that came held. A client asks ten times a second for the view
 * of that moment. Bytes are whole answers, plans included. */
#include "tests/bench/bench_shots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/view.h"
#include "tests/bench/bench_fetch.h"

/* ---- The path: from the bounds of a scene's plants and the height of its ground alone ---- */

#define FOV_DEG 55.0
#define EYE_M 2.5                        /* above the ground, where the flight goes through */
#define EYE_LEAST_M 1.0                  /* between keyframes */
#define DOWN_S 20u                       /* the air ends; the rest goes through */
#define KEY_S 4u

/* The longer horizontal side is along. */
struct stage {
	const struct view_ground *ground;
	double centre[3], along[2], across[2], half_along, half_across, half;
};

/* Metres from the centre, and above the ground there. */
static void put(const struct stage *s, double along, double across, double above, double out[3])
{
	double ground;
	for (int k = 0; k < 2; k++)
		out[k] = s->centre[k] + along * s->along[k] + across * s->across[k];
	bool has = view_ground_height(s->ground, out[0], out[1], &ground);
	out[2] = above + (has ? ground : s->centre[2]);
}

/* The eye on its way through, from 0 to 1. */
static void put_through(const struct stage *s, double way, double above, double out[3])
{
	put(s, s->half_along * (1.8 * way - 0.9), 0.2 * s->half_across * sin(2 * M_PI * way), above, out);
}

static void put_keyframe(const struct stage *s, double time_s, double eye[3], double target[3])
{
	double way = (time_s - DOWN_S) / (BENCH_FLIGHT_S - DOWN_S), air = 1 - time_s / DOWN_S;
	if (way >= 0) {
		put_through(s, way, EYE_M, eye);
		put_through(s, way + 0.15, EYE_M, target);
		return;
	}
	put(s, -s->half_along * (0.9 + 1.1 * air), s->half * 0.8 * air, EYE_M + s->half * 1.2 * air * air,
		eye);
	put(s, s->half_along * (-0.63 + 0.63 * air), 0, EYE_M, target);
}

static char *write_script(const struct stage *s)
{
	char *text = NULL;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	if (!out)
		eco_end("no memory for a path");
	fprintf(out, "{\"fps\": %u, \"keyframes\": [", BENCH_FLIGHT_FPS);
	for (uint32_t t = 0; t <= BENCH_FLIGHT_S; t += KEY_S) {
		double eye[3], target[3];
		put_keyframe(s, t, eye, target);
		fprintf(out, "%s{\"time_s\": %u, \"eye\": [%.9g, %.9g, %.9g], "
			"\"target\": [%.9g, %.9g, %.9g], \"fov_y_deg\": %g}", t ? ", " : "", t, eye[0],
			eye[1], eye[2], target[0], target[1], target[2], FOV_DEG);
	}
	fputs("]}", out);
	fclose(out);
	return text;
}

static void take_views(const struct stage *s, const struct eco_camera *camera, uint32_t first, uint32_t count,
	struct eco_view *views)
{
	for (uint32_t f = 0; f < count; f++) {
		struct eco_view *view = &views[f];
		double ground;
		*view = (struct eco_view){ 0 };
		eco_camera_frame(camera, first + f, view);
		view->width = BENCH_SHOT_WIDTH;
		view->height = BENCH_SHOT_HEIGHT;
		if (view_ground_height(s->ground, view->eye[0], view->eye[1], &ground))
			view->eye[2] = fmax(view->eye[2], ground + EYE_LEAST_M);
	}
}

static struct stage stage_of(const struct eco_tile *root, const struct view_ground *ground)
{
	double side[2] = { root->high[0] - root->low[0], root->high[1] - root->low[1] };
	int longer = side[1] > side[0];
	struct stage s = { .ground = ground, .centre = { 0, 0, root->low[2] } };
	for (int k = 0; k < 2; k++)
		s.centre[k] = (root->low[k] + root->high[k]) / 2;
	s.along[longer] = s.across[!longer] = 1;
	s.half_along = side[longer] / 2;
	s.half_across = side[!longer] / 2;
	s.half = fmax(s.half_along, root->high[2] - root->low[2]);
	return s;
}

/* The whole ground, at full detail: a picture from straight above. */
static void fetch_ground(const struct srv_scene *scene, struct view_store *store,
	struct view_selection *selection)
{
	const struct eco_tile *root = &scene->pack->scene.tiles[scene->pack->scene.root];
	struct eco_request request = { .bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN,
		.view = { .up = { 0, 1, 0 }, .fov_y_deg = 90, .width = 512, .height = 512 } };
	struct lod_eye eye;
	for (int k = 0; k < 3; k++)
		request.view.eye[k] = request.view.target[k] = (root->low[k] + root->high[k]) / 2;
	request.view.eye[2] =
		root->high[2] + hypot(root->high[0] - root->low[0], root->high[1] - root->low[1]);
	lod_eye_make(&eye, &request.view);
	must(bench_fetch(NULL, scene, &request, store, must_error));
	must(view_select_make(selection, store, &eye, must_error));
}

struct eco_view *bench_flight_path(const char *pack, uint32_t first, uint32_t count)
{
	struct view_store_options options = { .images = false };
	struct view_selection selection;
	struct view_store *store;
	struct eco_camera *camera;
	struct srv_store served;
	struct eco_view *views = eco_alloc(count, sizeof *views);
	srv_store_init(&served);
	must(srv_store_add(&served, "flight", pack, must_error));
	must(view_store_new(&store, &options, must_error));
	fetch_ground(served.scenes[0], store, &selection);
	const struct eco_scene *tables = &served.scenes[0]->pack->scene;
	struct stage stage = stage_of(&tables->tiles[tables->root], &selection.ground);
	char *script = write_script(&stage);
	must(eco_camera_parse(&camera, script, strlen(script), "flight", must_error));
	take_views(&stage, camera, first, count, views);
	free(script);
	eco_camera_free(camera);
	view_select_free(&selection);
	view_store_free(store);
	srv_store_free(&served);
	return views;
}

/* ---- A flight ---- */

#define FULL_EVERY 20u                   /* the middle one of so many frames is scored */
#define QUICK_EVERY 10u
#define QUICK_FRAMES 60u
#define QUICK_FIRST 170u                 /* down to eye level, and on */

static const uint64_t budgets[] = { 100000, 300000, 1000000, 3000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define MILLION 1000000u
static const char *const scenes[] = { "park", "city", "scbi" };
#define SCENES (sizeof scenes / sizeof *scenes)

struct flight { struct bench *bench; const char *pack; uint32_t count, every; struct eco_view *views;
	uint64_t vertices; };
enum figure { BYTES, FIRST, PLANS, DRAWN, QUALITY, SEEN, M16, S16, FIGURES };

/* Adds frame `f`; scores it where `scored`. */
static void step(const struct flight *flight, struct bench_client *client, uint32_t f, bool scored,
	double sums[FIGURES])
{
	struct bench_frame frame = { .rule = lod_rule_optimal, .request = { .view = flight->views[f],
		.vertices = flight->vertices, .bytes = ECO_BYTES_UNBOUNDED } };
	struct view_picture picture = { 0 };
	double share = (double)flight->every / flight->count;
	if (scored)
		bench_client_reference(client, &frame.request);
	bench_client_step(client, &frame, scored ? &picture : NULL);
	if (scored) {
		bench_client_score(client, &frame, &picture);
		sums[QUALITY] += share * frame.measures.score.q;
		sums[SEEN] += share * frame.measures.picture_error;
		sums[M16] += share * frame.measures.blocks.color;
		sums[S16] += share * frame.measures.blocks.contrast;
	}
	view_picture_free(&picture);
	sums[BYTES] += (double)frame.bytes;
	sums[FIRST] += f ? 0 : (double)frame.bytes;
	sums[PLANS] += (double)frame.plan_bytes;
	sums[DRAWN] += (double)frame.vertices / flight->count;
}

static json_t *fly(void *ctx)
{
	const struct flight *flight = ctx;
	struct bench_client *client = NULL;
	double sums[FIGURES] = { 0 };
	client = bench_client_open(flight->pack);
	bench_client_see(client, flight->bench);
	bench_client_untimed(client);
	for (uint32_t f = 0; f < flight->count; f++)
		step(flight, client, f, f % flight->every == flight->every / 2, sums);
	bench_client_close(client);
	return bench_reals(sums, FIGURES);
}

/* Returns the bytes at a million vertices; NaN where the scene is left out. */
static double study_scene(struct bench *bench, const char *scene, struct bench_table *table)
{
	char pack[512], stamp[320], unit[96];
	struct flight flight = { .bench = bench, .pack = pack,
		.count = bench->full ? BENCH_FLIGHT_FRAMES : QUICK_FRAMES,
		.every = bench->full ? FULL_EVERY : QUICK_EVERY };
	double bytes = NAN, now[FIGURES];
	if (!bench_scene_there(bench, scene, pack))
		return NAN;
	flight.views = bench_flight_path(pack, bench->full ? 0 : QUICK_FIRST, flight.count);
	snprintf(stamp, sizeof stamp, "%s %u %016llx", bench_pack_stamp(pack), flight.every,
		(unsigned long long)XXH3_64bits(flight.views, flight.count * sizeof *flight.views));
	for (size_t i = 0; i < BUDGETS; i++) {
		unsigned long long budget = flight.vertices = budgets[i];
		json_t *row;
		snprintf(unit, sizeof unit, "flight-%s-%u-%llu", scene, flight.count, budget);
		bench_progress(bench, (double)i / BUDGETS, scene);
		row = bench_unit(bench, unit, stamp, fly, &flight);
		bench_cells(row, now, FIGURES);
		bench_table_row(table, "%s,%u,%llu,%.0f,%.0f,%.0f,%.0f,%.4f,%.5f,%.3f,%.3f", scene, flight.count, budget,
			now[DRAWN], now[BYTES], now[FIRST], now[PLANS], now[QUALITY], now[SEEN], now[M16],
			now[S16]);
		bytes = budget == MILLION ? now[BYTES] : bytes;
	}
	free(flight.views);
	return bytes;
}

static void run(struct bench *bench)
{
	double bytes = NAN;
	bench_say(bench, "%u frames a second, %u x %u, from the air down to eye level and through; Q and the "
		"errors against the truth are means over every %u-th frame, bytes those of all.", BENCH_FLIGHT_FPS,
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, bench->full ? FULL_EVERY : QUICK_EVERY);
	struct bench_table *table = bench_table_open(bench, "flight", "scene,frames,budget,vertices,"
		"bytes,first frame bytes,bytes of plans,Q,S8,m16,s16", true);
	for (size_t i = 0; i < SCENES; i++)
		bytes = fmax(bytes, study_scene(bench, scenes[i], table));
	bench_table_close(table);
	bench_key(bench, "flight_bytes", bytes, "bytes of a flight at 1,000,000 vertices, the most");
}

const struct bench_section bench_flight = { "flight", "Bytes of a flight", run };
