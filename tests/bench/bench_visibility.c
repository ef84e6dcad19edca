/* Pixels that plants show, by their distance: what the planner expects before it spends a budget
 * (lod/seen/visibility.h) beside what full detail shows, by the owners of its pixels. At eye level, and in
 * the crown of the plant that shows most of there. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "lod/plan/explain.h"
#include "lod/plan/planner.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_fetch.h"

#define VIEWS "tests/bench/visibility.json"
#define WIDTH 400u
#define HEIGHT 300u
#define BESIDE 0.2                   /* of a plant's radius: as far the eye in its crown is from its trunk */
#define PART_LEAST 0.03              /* of the pixels seen: a bin with fewer has no bar */
#define BUDGET 1000000u              /* vertices: all tiles near the eye are open */

static const struct bench_column columns[] = { { "expected", 0 }, { "seen", 0 }, { "off of all seen %", 1 },
	{ "off of the bin %", 1 } };

struct view_bins { double expected[LOD_DISTANCES], seen[LOD_DISTANCES]; };
/* off: sum over bins of |expected - seen| / all seen, mean of views and most */
struct study { struct bench_table *table; double off, most, bin; uint32_t views; char row[64], bin_row[64]; };

/* `crown`: in the plant that shows most, beside its trunk. */
static void see(const struct srv_scene *scene, const struct eco_view *view, double seen[LOD_DISTANCES],
	double crown[3])
{
	struct eco_request full = { .view = *view, .vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED };
	struct view_store *store;
	struct view_picture picture = { 0 };
	struct bench_drawing drawing;
	uint32_t most = 0;
	must(view_store_new(&store, &(struct view_store_options){ .memory_max = 16ull << 30 }, must_error));
	must(bench_fetch(NULL, scene, &full, store, must_error));
	must(bench_draw(&drawing, store, view, NULL, &picture, must_error));
	uint32_t *pixels = view_pixels_of(&drawing.selection, &picture, NULL);
	view_pixels_by_distance(&drawing.selection, pixels, seen);
	for (uint32_t i = 0; i < drawing.selection.instance_count; i++)
		most = pixels[i] > pixels[most] ? i : most;
	free(pixels);
	memcpy(crown, view->eye, sizeof view->eye);
	if (most < drawing.selection.instance_count) {
		const struct view_instance *one = &drawing.selection.instances[most];
		const struct eco_scene *s = &scene->pack->scene;
		const struct eco_anchor *whole = &s->anchors[s->plants[one->plant].anchor_first];
		lod_place_point(&one->place, whole->center, crown);
		for (int k = 0; k < 3; k++)
			crown[k] += BESIDE * (double)whole->radius * one->place.scale * drawing.eye.right[k];
	}
	view_select_free(&drawing.selection);
	view_picture_free(&picture);
	view_store_free(store);
}

static void expect(const struct srv_scene *scene, const struct eco_view *view, double expected[LOD_DISTANCES])
{
	struct eco_request request = { .view = *view, .vertices = BUDGET, .bytes = ECO_BYTES_UNBOUNDED };
	struct lod_explanation why = { 0 };
	struct eco_plan plan = { 0 };
	must(lod_plan(&plan, &(struct lod_planner_input){ .scene = &scene->pack->scene, .request = &request,
		.explanation = &why }, must_error));
	memcpy(expected, why.expected_px, sizeof why.expected_px);
	lod_explanation_free(&why);
	eco_plan_free(&plan);
}

static void add_bins(struct study *s, const char *scene, const char *camera, const struct view_bins *bins)
{
	double all = 0, off = 0;
	for (uint32_t i = 0; i < LOD_DISTANCES; i++) {
		all += bins->seen[i];
		off += fabs(bins->expected[i] - bins->seen[i]);
	}
	for (uint32_t i = 0; i < LOD_DISTANCES; i++) {
		double expected = bins->expected[i], seen = bins->seen[i], from = lod_distance_from_m(i), bin = seen > 0 ? fabs(expected - seen) / seen : NAN;
		bench_table_values(s->table, (const double[]){ expected, seen,
			100 * fabs(expected - seen) / all, 100 * bin }, "%s,%s,%g m", scene, camera, from);
		if (seen > PART_LEAST * all && bin > s->bin) {
			s->bin = bin;
			snprintf(s->bin_row, sizeof s->bin_row, "%s %s from %g m", scene, camera, from);
		}
	}
	off /= all;
	s->off += off;
	s->views++;
	if (off > s->most) {
		s->most = off;
		snprintf(s->row, sizeof s->row, "%s %s", scene, camera);
	}
}

/* From the eye, then from a crown that it sees. */
static void study_view(struct study *s, const char *name, const char *pack, struct eco_view view)
{
	struct srv_store store;
	double crown[3], unused[3];
	srv_store_init(&store);
	must(srv_store_add(&store, "bench", pack, must_error));
	for (int inside = 0; inside < 2; inside++) {
		struct view_bins bins = { { 0 }, { 0 } };
		see(store.scenes[0], &view, bins.seen, inside ? unused : crown);
		expect(store.scenes[0], &view, bins.expected);
		add_bins(s, name, inside ? "in a crown" : "eye", &bins);
		for (int k = 0; k < 3 && !inside; k++) {
			view.target[k] += crown[k] - view.eye[k];
			view.eye[k] = crown[k];
		}
	}
	srv_store_free(&store);
}

/* A camera at eye level in each scene that is there. No weight, curve or fit was chosen on them. */
static void study_scenes(struct bench *bench, struct study *s)
{
	json_t *views = json_load_file(VIEWS, 0, NULL), *item;
	char pack[512];
	size_t i;
	if (!json_is_array(views))
		must(eco_fail(must_error, ECO_BAD_INPUT, VIEWS " cannot be read"));
	json_array_foreach(views, i, item) {
		const char *name;
		struct eco_view v = { .up = { 0, 0, 1 }, .width = WIDTH, .height = HEIGHT };
		if (json_unpack(item, "{s:s, s:[F,F,F], s:[F,F,F], s:F}", "scene", &name, "eye", &v.eye[0], &v.eye[1], &v.eye[2],
				"target", &v.target[0], &v.target[1], &v.target[2], "fov_y_deg", &v.fov_y_deg))
			must(eco_fail(must_error, ECO_BAD_INPUT, VIEWS ": view %zu is none", i));
		bench_progress((double)i / (double)json_array_size(views), name);
		if (bench_scene_there(bench, name, pack))
			study_view(s, name, pack, v);
	}
	json_decref(views);
}

static void run(struct bench *bench)
{
	struct study s = { .most = 0 };
	char words[192];
	bench_say(bench, "%u x %u pixels. expected: pixels that plants show in full detail, as the planner expects; "
		"seen: those that they own in a picture of full detail, drawn in software.", WIDTH, HEIGHT);
	s.table = bench_table_described(bench, "visibility", "scene,camera,from", columns, 4, true);
	study_scenes(bench, &s);
	bench_table_close(s.table);
	bench_key(bench, "visibility_off", s.views ? s.off / s.views : NAN,
		"<= 0.4: sum over distances of |expected - seen|, over all pixels that plants show; mean of views");
	snprintf(words, sizeof words, "the worst view: %s", s.row);
	bench_key(bench, "visibility_off_worst", s.views ? s.most : NAN, words);
	snprintf(words, sizeof words, "<= 0.6: |expected - seen| over seen, of the worst distance that holds more than "
		"3 %% of the pixels seen: %s", s.bin_row);
	bench_key(bench, "visibility_bin_worst", s.views ? s.bin : NAN, words);
}

const struct bench_section bench_visibility = { "visibility", "Pixels that plants are expected to show", run };
