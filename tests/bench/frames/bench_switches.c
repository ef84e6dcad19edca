/* Cameras at eye level, at a budget of vertices. One moves sideways, slowly, with a plan for every frame: plants that
 * another cut draws than in the frame before, vertices that these gain or lose, and pixels that they show. One turns,
 * and its answers come late: pixels of plants that are not drawn. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/wire.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_shots.h"

#define WIDTH 400u
#define HEIGHT 300u
#define SCENES 6u                    /* of pictures.json */
#define STEPS 10u
#define STEP_M 0.05
#define TURNS 3u                     /* pictures of the camera that turns */
#define TURN_DEG 8.0                 /* from one to the next */
#define LATE_DEG 2.0                 /* 10 degrees a second, 200 ms */
#define BUDGET 300000u               /* vertices */

static const struct bench_column columns[] = { { "plants", 1 }, { "vertices", 0 }, { "pixels", 0 }, { "holes %", 2 },
	{ "in time %", 2 }, { "bytes of a plan", 0 } };
enum { PLANTS, VERTICES, PIXELS, HOLES, IN_TIME, PLAN, FIGURES };

/* The representation of each instance of a selection. */
struct drawn { struct view_selection selection; struct view_table owners; uint64_t *cuts, *vertices; };

static void fetch(const struct srv_scene *scene, const struct eco_view *view, uint64_t vertices,
	struct view_store *store, double *plan_bytes)
{
	struct eco_request request = { .view = *view, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
	must(bench_fetch(NULL, scene, &request, store, must_error));
	*plan_bytes += (double)eco_wire_plan_bytes(view_store_plan(store));
}

static void find_drawn(struct drawn *d, const struct view_store *store, const struct eco_view *view)
{
	struct lod_eye eye;
	lod_eye_make(&eye, view);
	must(view_select_make(&d->selection, store, &eye, must_error));
	const struct view_selection *s = &d->selection;
	must(view_owners_make(&d->owners, s) ? ECO_OK : eco_fail(must_error, ECO_NO_MEMORY, "owners"));
	d->cuts = eco_alloc(s->instance_count + 1, sizeof *d->cuts);
	d->vertices = eco_alloc(s->instance_count + 1, sizeof *d->vertices);
	for (uint32_t i = 0; i < s->instance_count; i++)
		for (uint32_t k = s->cut_first[i]; k < s->cut_first[i + 1]; k++) {
			const struct eco_cut *cut = &s->plan_cuts[s->cuts[k]];
			d->vertices[i] += eco_cut_vertices(cut, &view_store_list(store, cut->list)->list);
			d->cuts[i] ^= (uint64_t)cut->list << 40 ^ (uint64_t)cut->end << 20 ^ cut->first;
			d->cuts[i] *= 0x9E3779B97F4A7C15u;
		}
}

static void forget(struct drawn *d)
{
	view_select_free(&d->selection);
	view_table_free(&d->owners);
	free(d->cuts);
	free(d->vertices);
}

static void compare(const struct drawn *last, const struct drawn *now, const struct drawn *full,
	const uint32_t *pixels, double figures[FIGURES])
{
	for (uint32_t i = 0; i < last->selection.instance_count; i++) {
		uint64_t owner = last->selection.instances[i].owner;
		const struct view_instance *then = view_owners_find(&now->owners, &now->selection, owner),
			*seen = view_owners_find(&full->owners, &full->selection, owner);
		size_t k = then ? (size_t)(then - now->selection.instances) : 0;
		if (!then || now->cuts[k] == last->cuts[i])
			continue;
		figures[PLANTS] += 1.0 / STEPS;
		figures[VERTICES] += fabs((double)now->vertices[k] - (double)last->vertices[i]) / STEPS;
		figures[PIXELS] += seen ? pixels[seen - full->selection.instances] / (double)STEPS : 0;
	}
}

static void move(const struct srv_scene *scene, const struct eco_view *start, struct view_store *store,
	const struct drawn *full, const uint32_t *pixels, double figures[FIGURES])
{
	struct drawn last = { .cuts = NULL }, now = { .cuts = NULL };
	struct lod_eye eye;
	lod_eye_make(&eye, start);
	for (uint32_t step = 0; step <= STEPS; step++) {
		struct eco_view view = *start;
		for (int k = 0; k < 3; k++) {
			view.eye[k] += STEP_M * step * eye.right[k];
			view.target[k] += STEP_M * step * eye.right[k];
		}
		fetch(scene, &view, BUDGET, store, &figures[PLAN]);
		find_drawn(&now, store, &view);
		if (step)
			compare(&last, &now, full, pixels, figures);
		forget(&last);
		last = now;
	}
	forget(&last);
	figures[PLAN] /= STEPS + 1;
}

static struct eco_view turned(const struct eco_view *start, double degrees)
{
	struct eco_view view = *start;
	double turn = degrees * 3.14159265358979323846 / 180, x = start->target[0] - start->eye[0],
		y = start->target[1] - start->eye[1];
	view.target[0] = start->eye[0] + cos(turn) * x - sin(turn) * y;
	view.target[1] = start->eye[1] + sin(turn) * x + cos(turn) * y;
	return view;
}

/* Covers `picture` with the plan of one view, seen from another. */
static void draw(struct view_store *store, const struct eco_view *planned, const struct eco_view *view,
	struct view_picture *picture)
{
	struct view_selection selection;
	struct lod_eye of, eye;
	lod_eye_make(&of, planned);
	lod_eye_make(&eye, view);
	must(view_select_make(&selection, store, &of, must_error));
	must(view_picture_init(picture, WIDTH, HEIGHT, must_error));
	must(view_reference_draw(&(struct view_draw_job){ .store = store, .selection = &selection, .eye = &eye,
		.near_m = bench_near_m(store) }, picture, must_error));
	view_select_free(&selection);
}

static void turn(const struct srv_scene *scene, const struct eco_view *start, struct view_store *store,
	struct view_store *full, double figures[FIGURES])
{
	for (uint32_t i = 0; i < 2 * TURNS; i++) {
		struct eco_view view = turned(start, TURN_DEG * (i / 2 + 1)),
			planned = turned(start, TURN_DEG * (i / 2 + 1) - (i % 2 ? 0 : LATE_DEG));
		struct view_picture truth = { 0 }, picture = { 0 };
		double unused = 0, holes = 0;
		fetch(scene, &view, ECO_VERTICES_MAX, full, &unused);
		draw(full, &view, &view, &truth);
		fetch(scene, &planned, BUDGET, store, &unused);
		draw(store, &planned, &view, &picture);
		for (size_t k = 0; k < (size_t)WIDTH * HEIGHT; k++)
			holes += truth.cover[k] && !picture.cover[k];
		figures[i % 2 ? IN_TIME : HOLES] += 100 * holes / (WIDTH * HEIGHT) / TURNS;
		view_picture_free(&truth);
		view_picture_free(&picture);
	}
}

struct study { struct bench_table *table; double sums[FIGURES]; uint32_t views; };

static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	struct study *s = ctx;
	struct srv_store served;
	struct view_store *stores[2];
	struct view_picture truth = { 0 };
	struct drawn full;
	struct eco_view at = view->view;
	double figures[FIGURES] = { 0 }, unused = 0;
	if (strcmp(view->camera, "eye"))
		return;
	at.width = WIDTH;
	at.height = HEIGHT;
	srv_store_init(&served);
	must(srv_store_add(&served, "bench", view->pack, must_error));
	for (int i = 0; i < 2; i++)
		must(view_store_new(&stores[i], &(struct view_store_options){ .memory_max = 16ull << 30 }, must_error));
	fetch(served.scenes[0], &at, ECO_VERTICES_MAX, stores[1], &unused);
	find_drawn(&full, stores[1], &at);
	draw(stores[1], &at, &at, &truth);
	uint32_t *pixels = view_pixels_of(&full.selection, &truth, NULL);
	move(served.scenes[0], &at, stores[0], &full, pixels, figures);
	turn(served.scenes[0], &at, stores[0], stores[1], figures);
	bench_table_values(s->table, figures, "%s", view->scene);
	for (int i = 0; i < FIGURES; i++)
		s->sums[i] += figures[i];
	s->views++;
	free(pixels);
	forget(&full);
	view_picture_free(&truth);
	view_store_free(stores[0]);
	view_store_free(stores[1]);
	srv_store_free(&served);
	(void)bench;
}

static void run(struct bench *bench)
{
	struct study s = { .views = 0 };
	bench_say(bench, "Eye level, %u x %u pixels, %u vertices. The camera moves %g cm to the right: plants that draw other "
		"elements than before, vertices that they gain or lose, pixels that they show in full detail; means of %u "
		"steps. The camera turns by 10 degrees a second, with answers that are 200 ms late, or in time: share of "
		"the picture where full detail shows a plant and nothing is drawn.", WIDTH, HEIGHT, BUDGET, 100 * STEP_M, STEPS);
	s.table = bench_table_described(bench, "switches", "scene", columns, FIGURES, true);
	bench_views_each(bench, SCENES, study_view, &s);
	bench_table_close(s.table);
	bench_key(bench, "switches_vertices", s.views ? s.sums[VERTICES] / s.views : NAN,
		"no more than the release before: vertices that switch in a step of 5 cm, mean of views");
	bench_key(bench, "switches_holes", s.views ? s.sums[HOLES] / s.views : NAN,
		"no more than the release before: % of the picture that a turning camera shows empty");
}

const struct bench_section bench_switches = { "switches", "Slow and turning cameras: what switches, and holes", run };
