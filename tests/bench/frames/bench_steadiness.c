/* Motion in pictures that should stand still: slow cameras, a plan for every frame, and beside each picture
 * the full detail of the same view (Neubert 2011, section 4.3 has hysteresis against the same, which a
 * stateless server has not). Counted are pixels that change from one frame to the next, over those that
 * change in full detail, where leaves move against each other, too.
 *
 * Cameras move towards what they look at, around it, and zoom, all by about the same angle of the picture a
 * frame. The software rasteriser draws: the same bits everywhere. */
#include <math.h>
#include <stdlib.h>

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench_shots.h"

#define WIDTH 480u
#define HEIGHT 360u
#define COLOR_TOLD 24            /* of 255 in a channel: a change that is seen */
#define VIEWS 2u                 /* starts along a scene's path */
#define PAIRS_QUICK 2u           /* of frames, a start */
#define PAIRS_FULL 12u
#define NEARER 0.997             /* a frame: half the distance in eight seconds of thirty frames */
#define TURN_RAD 0.003           /* a frame: ten degrees in two seconds */

enum motion { DOLLY, ORBIT, ZOOM, MOTIONS };
static const char *const motion_names[MOTIONS] = { "dolly", "orbit", "zoom" };
static const uint64_t budgets[] = { 100000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define FULL BUDGETS                                         /* the reel of full detail */
static const char *const scenes[] = { "outdoor", "trees1276", "scbi", "sunflowers", "palms", "trees640",
	"trees5000" };
#define SCENES (sizeof scenes / sizeof *scenes)

struct sums {
	uint64_t ours, reference, pixels;
	double worst_pair;
};

/* The view after `t` frames; ORBIT turns around the vertical through the target. */
static struct eco_view moved(const struct eco_view *start, enum motion motion, double t)
{
	struct eco_view v = *start;
	double near = pow(NEARER, t), x = start->eye[0] - start->target[0],
		y = start->eye[1] - start->target[1];
	if (motion == DOLLY) {
		for (int k = 0; k < 3; k++)
			v.eye[k] = start->target[k] + near * (start->eye[k] - start->target[k]);
	} else if (motion == ORBIT) {
		double c = cos(TURN_RAD * t), s = sin(TURN_RAD * t);
		v.eye[0] = start->target[0] + c * x - s * y;
		v.eye[1] = start->target[1] + s * x + c * y;
	} else {
		v.fov_y_deg *= near;
	}
	return v;
}

/* ---- Two frames ---- */

static bool changed(const struct view_picture frames[2], size_t i)
{
	const struct view_picture *a = &frames[0], *b = &frames[1];
	bool is = a->cover[i] != b->cover[i];
	for (int k = 0; k < 3; k++)
		is = is || abs(a->rgb[3 * i + k] - b->rgb[3 * i + k]) > COLOR_TOLD;
	return is && (a->cover[i] || b->cover[i]);
}

static void count_pixels(struct sums *sums, const struct view_picture ours[2],
	const struct view_picture full[2])
{
	uint64_t mine = 0, theirs = 0;
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
		mine += changed(ours, i);
		theirs += changed(full, i);
	}
	sums->ours += mine;
	sums->reference += theirs;
	sums->pixels += (uint64_t)WIDTH * HEIGHT;
	if (theirs)
		sums->worst_pair = fmax(sums->worst_pair, (double)mine / (double)theirs);
}

/* ---- One slow camera ---- */

struct work { struct bench *bench; const char *pack; struct eco_request starts[VIEWS]; uint32_t count;
	enum motion motion; };
/* Frames of one budget, the earlier one first. */
struct reel { struct bench_client *client; struct view_picture frames[2]; };

/* All budgets along one camera: the full detail is drawn once for them. */
static void run_camera(const struct work *w, const struct eco_view *start, struct sums *sums)
{
	struct reel reels[BUDGETS + 1] = { { NULL } };
	uint32_t pairs = w->bench->full ? PAIRS_FULL : PAIRS_QUICK;
	for (size_t b = 0; b <= FULL; b++)
		reels[b].client = bench_client_open(w->pack);
	for (uint32_t i = 0; i <= pairs; i++) {
		struct bench_frame frame = { .request = { .view = moved(start, w->motion, i), .bytes =
			ECO_BYTES_UNBOUNDED } };
		frame.request.view.width = WIDTH;
		frame.request.view.height = HEIGHT;
		for (size_t b = FULL + 1; b-- > 0;) {
			struct reel *reel = &reels[b];
			frame.request.vertices = b < FULL ? budgets[b] : ECO_VERTICES_MAX;
			frame.request.ground_px = b < FULL ? 0 : ECO_GROUND_PX_MIN;
			frame.request.texel_px = b < FULL ? 0 : ECO_TEXEL_PX_MIN;
			view_picture_free(&reel->frames[0]);
			reel->frames[0] = reel->frames[1];
			reel->frames[1] = (struct view_picture){ 0 };
			bench_client_step(reel->client, &frame, &reel->frames[1]);
			if (i > 0 && b < FULL)
				count_pixels(&sums[b], reel->frames, reels[FULL].frames);
		}
	}
	for (size_t b = 0; b <= FULL; b++) {
		view_picture_free(&reels[b].frames[0]);
		view_picture_free(&reels[b].frames[1]);
		bench_client_close(reels[b].client);
	}
}

static const struct bench_column columns[] = { { "changed %", 3 }, { "reference changed %", 3 },
	{ "ratio", 3 },
	{ "worst frame", 3 } };
enum { RATIO = 2, COLUMNS = 4 };

/* The columns, as shares, for each budget. */
static json_t *run_motion(void *ctx)
{
	const struct work *w = ctx;
	struct sums sums[BUDGETS] = { { 0 } };
	for (uint32_t k = 0; k < w->count; k++)
		run_camera(w, &w->starts[k].view, sums);
	json_t *made = json_array();
	for (size_t b = 0; b < BUDGETS; b++) {
		const struct sums *s = &sums[b];
		json_array_append_new(made, bench_reals((double[]){ (double)s->ours / (double)s->pixels,
			(double)s->reference / (double)s->pixels, (double)s->ours / fmax(1,
			(double)s->reference), s->worst_pair }, COLUMNS));
	}
	return made;
}

/* ---- Report ---- */

static void run_scene(struct bench *bench, const char *scene, const char *pack, struct bench_table *table,
	double worst[COLUMNS])
{
	struct work work = { .bench = bench, .pack = pack };
	work.count = bench_scene_views(bench, scene, work.starts, VIEWS);
	for (int m = 0; m < MOTIONS; m++) {
		char name[96];
		json_t *unit;
		snprintf(name, sizeof name, "steadiness-%s-%s-%s", scene, motion_names[m], bench->full
			? "full" : "quick");
		bench_progress(bench, (double)m / MOTIONS, name);
		work.motion = (enum motion)m;
		unit = bench_unit(bench, name, bench_pack_stamp(pack), run_motion, &work);
		for (size_t b = 0; b < BUDGETS; b++) {
			double value[COLUMNS];
			bench_cells(json_array_get(unit, b), value, COLUMNS);
			for (size_t i = 0; i < COLUMNS; i++) {
				worst[i] = fmax(worst[i], value[i]);
				value[i] *= i < RATIO ? 100 : 1;
			}
			bench_table_values(table, value, "%s,%s,%llu", scene, motion_names[m],
				(unsigned long long)budgets[b]);
		}
	}
}

static void run(struct bench *bench)
{
	double worst[COLUMNS] = { NAN, NAN, NAN, NAN };
	char pack[512];
	struct bench_table *table = bench_table_described(bench, "steadiness", "scene,camera,vertices",
		columns, COLUMNS, true);
	for (size_t i = 0; i < SCENES; i++) {
		if (bench_scene_there(bench, scenes[i], pack))
			run_scene(bench, scenes[i], pack, table, worst);
	}
	bench_table_close(table);
	bench_say(bench,
		"Slow cameras: %.1f %% nearer, %.2f degrees around or %.1f %% of zoom a frame, %u x %u "
		"pixels. A pixel changes where it is covered in one frame and not in the other, or a channel "
		"differs by more than %d.", 100 * (1 - NEARER), TURN_RAD * 57.29578, 100 * (1 - NEARER),
			WIDTH, HEIGHT, COLOR_TOLD);
	bench_key(bench, "steadiness_ratio", worst[RATIO],
		"<= 1.5: pixels that change over those of the reference, worst camera");
}

const struct bench_section bench_steadiness = { "steadiness", "Steadiness: slow cameras", run };
