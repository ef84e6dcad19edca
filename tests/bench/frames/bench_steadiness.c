/* Motion in pictures that should stand still: slow cameras, a plan for every frame, and beside each picture
 * the full detail of the same view. Two measures (Neubert 2011, section 4.3 fights the same with hysteresis,
 * which a stateless server does not have):
 *
 *   pixels    that change from one frame to the next, over those that change in full detail: leaves move
 *             against each other there too. What changes only in ours is shown beside it
 *   switches  the share of like plants (one model, in view in both frames) whose cuts change from one frame
 *             to the next, be it by one leaf; the worst frame counts. A plant that is drawn in parts, as near
 *             ones are, counts with the part that changes. Leaves that grow by less than a sixteenth of their
 *             area blend, and do not switch. Where only few of a model are in view a single plant would be a
 *             large share: those do not count. Plants of a model at all distances are like here, as few are
 *             at one distance; beside it stands the same for those within an octave of distance, how many
 *             change by more than an eighth of what they draw, and the share of vertices that change
 *
 * Cameras move towards what they look at, around it, and zoom, all by about the same angle of the picture a
 * frame. Drawn by the software rasteriser: the same bits everywhere. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/bench_shots.h"
#include "tests/bench/frames/bench_still.h"

#define WIDTH 480u
#define HEIGHT 360u
#define COLOR_TOLD 24            /* of 255 in a channel: a change that is seen */
#define LIKE_LEAST 40u
#define OCTAVES (ECO_BANDS / 4)
#define SAME_SIZE (1 / 16.0)
#define SWITCH_MOST 0.05         /* of like plants */
#define VIEWS 2u                 /* starts along a scene's path */
#define PAIRS_QUICK 2u           /* of frames, a start */
#define PAIRS_FULL 12u
#define NEARER 0.997             /* a frame: half the distance in eight seconds of thirty frames */
#define TURN_RAD 0.003           /* a frame: ten degrees in two seconds */

enum motion { DOLLY, ORBIT, ZOOM, MOTIONS };
static const char *const motion_names[MOTIONS] = { "dolly", "orbit", "zoom" };
static const uint64_t budgets[] = { 100000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
static const char *const scenes[] = { "outdoor", "trees1276", "scbi", "sunflowers", "palms", "trees640",
	"trees5000" };
#define SCENES (sizeof scenes / sizeof *scenes)

struct sums {
	uint64_t ours, reference, beyond, pixels, pairs;
	double worst_pair, worst_switch, worst_octave, worst_jump;
	/* plants; models in frames, and those of which too many switch */
	uint64_t like, models, over;
	double switched;
	uint64_t vertices, vertices_changed; /* of like plants */
};

/* ---- Cameras ---- */

/* The view after `t` frames. Around the target means around the vertical through it. */
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

static bool changed(const struct view_picture *a, const struct view_picture *b, size_t i)
{
	if (!a->cover[i] && !b->cover[i])
		return false;
	bool is = a->cover[i] != b->cover[i];
	for (int k = 0; k < 3; k++)
		is = is || abs(a->rgb[3 * i + k] - b->rgb[3 * i + k]) > COLOR_TOLD;
	return is;
}

static void count_pixels(struct sums *sums, const struct view_picture ours[2],
	const struct view_picture full[2])
{
	uint64_t mine = 0, theirs = 0;
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
		bool o = changed(&ours[0], &ours[1], i), r = changed(&full[0], &full[1], i);
		mine += o;
		theirs += r;
		sums->beyond += o && !r;
	}
	sums->ours += mine;
	sums->reference += theirs;
	sums->pixels += (uint64_t)WIDTH * HEIGHT;
	sums->pairs++;
	if (theirs)
		sums->worst_pair = fmax(sums->worst_pair, (double)mine / (double)theirs);
}

static const struct bench_plant *find(const struct bench_plants *plants, uint64_t owner)
{
	uint32_t low = 0, high = plants->count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (plants->items[middle].owner < owner)
			low = middle + 1;
		else
			high = middle;
	}
	return low < plants->count && plants->items[low].owner == owner ? &plants->items[low] : NULL;
}

/* A change that could be seen by itself: an eighth of a plant's vertices. */
static bool is_jump(uint64_t a, uint64_t b)
{
	uint64_t more = a > b ? a : b, less = a > b ? b : a;
	return more - less > more / 8;
}

/* Vertices of a that are not so in b. */
static uint64_t unlike(const struct bench_plants *in, const struct bench_plant *a,
	const struct bench_plants *of, const struct bench_plant *b)
{
	uint64_t sum = 0;
	for (uint32_t i = a->cut_first; i < a->cut_first + a->cut_count; i++) {
		const struct bench_cut *x = &in->cuts[i];
		bool same = false;
		for (uint32_t k = b->cut_first; k < b->cut_first + b->cut_count && !same; k++) {
			const struct bench_cut *y = &of->cuts[k];
			same = x->list == y->list && x->first == y->first && x->end == y->end
				&& fabsf(x->scale - y->scale) <= SAME_SIZE * fmaxf(x->scale, y->scale);
		}
		sum += same ? 0 : x->vertices;
	}
	return sum;
}

/* Switching share of a plant, between its cuts in [0] and those in [1]. */
static double switched(struct sums *sums, const struct bench_plants some[2], const struct bench_plant *a,
	const struct bench_plant *b)
{
	uint64_t from = unlike(&some[0], a, &some[1], b), to = unlike(&some[1], b, &some[0], a),
		all = a->vertices > b->vertices ? a->vertices : b->vertices, most = from > to ? from : to;
	sums->vertices += all;
	sums->vertices_changed += most;
	return all ? (double)most / (double)all : 0;
}

struct likes { uint32_t all, jumped; double switched; };

static double switched_share(const struct likes *like)
{
	return like->all < LIKE_LEAST ? 0 : like->switched / like->all;
}

/* `all`: the plants in view; `some`: those with cuts of their own, which may be fewer where a tile's summary
 * stands for its plants. */
static bool count_switches(struct sums *sums, uint32_t plant_count, const struct bench_plants all[2],
	const struct bench_plants some[2])
{
	struct likes *likes = calloc((size_t)plant_count + 1, (1 + OCTAVES) * sizeof *likes),
		*octaves = likes + plant_count;
	if (!likes)
		return false;
	for (uint32_t i = 0; i < all[0].count; i++) {
		const struct bench_plant *plant = &all[0].items[i], none = { 0 };
		if (!find(&all[1], plant->owner))
			continue;
		const struct bench_plant *a = find(&some[0], plant->owner), *b = find(&some[1], plant->owner);
		a = a ? a : &none;
		b = b ? b : &none;
		struct likes *like = &likes[plant->plant],
			*near = &octaves[plant->plant * (size_t)OCTAVES + plant->band / 4];
		double part = switched(sums, some, a, b);
		like->all++;
		near->all++;
		like->switched += part;
		near->switched += part;
		like->jumped += is_jump(a->vertices, b->vertices);
	}
	for (uint32_t i = 0; i < plant_count; i++) {
		sums->like += likes[i].all;
		sums->switched += likes[i].switched;
		for (uint32_t k = 0; k < OCTAVES; k++)
			sums->worst_octave =
				fmax(sums->worst_octave, switched_share(&octaves[i * (size_t)OCTAVES + k]));
		if (likes[i].all < LIKE_LEAST)
			continue;
		sums->worst_switch = fmax(sums->worst_switch, switched_share(&likes[i]));
		sums->models++;
		sums->over += likes[i].switched > SWITCH_MOST * likes[i].all;
		sums->worst_jump = fmax(sums->worst_jump, (double)likes[i].jumped / likes[i].all);
	}
	free(likes);
	return true;
}

/* ---- One slow camera ---- */

struct reel {                            /* the last two frames */
	struct bench_still *still;
	struct view_picture pictures[2];
	struct bench_plants plants[2];
};

static enum eco_code next_frame(struct reel *reel, const struct eco_request *request, struct eco_error *error)
{
	struct view_picture picture = reel->pictures[0];
	struct bench_plants plants = reel->plants[0];
	reel->pictures[0] = reel->pictures[1];
	reel->plants[0] = reel->plants[1];
	reel->pictures[1] = picture;
	reel->plants[1] = plants;
	return bench_still_draw(reel->still, request, &reel->pictures[1], &reel->plants[1], error);
}

static void reel_close(struct reel *reel)
{
	for (int i = 0; i < 2; i++) {
		view_picture_free(&reel->pictures[i]);
		bench_plants_free(&reel->plants[i]);
	}
	bench_still_close(reel->still);
}

/* All budgets along one camera: the full detail is drawn once for them. reels[BUDGETS] is the full detail. */
static enum eco_code run_camera(struct bench *bench, struct reel *reels, const struct eco_view *start,
	enum motion motion, struct sums *sums, struct eco_error *error)
{
	uint32_t pairs = bench->full ? PAIRS_FULL : PAIRS_QUICK,
		plant_count = bench_still_scene(reels[BUDGETS].still)->plant_count;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i <= pairs && !code; i++) {
		struct eco_request request = { .view = moved(start, motion, i),
			.bytes = ECO_BYTES_UNBOUNDED };
		request.view.width = WIDTH;
		request.view.height = HEIGHT;
		if (bench_stopped(bench))
			return eco_fail(error, ECO_INTERRUPTED, "interrupted");
		for (size_t b = BUDGETS + 1; b-- > 0 && !code;) {
			request.vertices = b < BUDGETS ? budgets[b] : ECO_VERTICES_MAX;
			request.ground_px = b < BUDGETS ? 0 : ECO_GROUND_PX_MIN;
			request.texel_px = b < BUDGETS ? 0 : ECO_TEXEL_PX_MIN;
			code = next_frame(&reels[b], &request, error);
			if (code || i == 0 || b == BUDGETS)
				continue;
			count_pixels(&sums[b], reels[b].pictures, reels[BUDGETS].pictures);
			if (!count_switches(&sums[b], plant_count, reels[BUDGETS].plants, reels[b].plants))
				code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u plants", plant_count);
		}
	}
	return code;
}

static json_t *json_of(const struct sums *s)
{
	double reference = s->reference ? (double)s->reference : 1, like = s->like ? (double)s->like : 1,
		vertices = s->vertices ? (double)s->vertices : 1;
	return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "ours",
		(double)s->ours / (double)s->pixels, "reference", (double)s->reference / (double)s->pixels,
		"ratio", (double)s->ours / reference, "beyond", (double)s->beyond / reference, "worst_pair",
		s->worst_pair, "worst_switch", s->worst_switch, "worst_octave", s->worst_octave, "worst_jump",
		s->worst_jump, "switched", s->switched / like,
		"vertices", (double)s->vertices_changed / vertices, "over",
		s->models ? (double)s->over / (double)s->models : 0);
}

static enum eco_code run_motion(struct bench *bench, const char *pack, const struct eco_request *starts,
	uint32_t count, enum motion motion, json_t **out, struct eco_error *error)
{
	struct reel reels[BUDGETS + 1] = { { 0 } };
	struct sums sums[BUDGETS] = { { 0 } };
	enum eco_code code = ECO_OK;
	for (size_t b = 0; b <= BUDGETS && !code; b++)
		code = bench_still_open(&reels[b].still, pack, error);
	for (uint32_t k = 0; k < count && !code; k++)
		code = run_camera(bench, reels, &starts[k].view, motion, sums, error);
	for (size_t b = 0; b <= BUDGETS; b++)
		reel_close(&reels[b]);
	if (code)
		return code;
	*out = json_array();
	for (size_t b = 0; b < BUDGETS; b++)
		json_array_append_new(*out, json_of(&sums[b]));
	return ECO_OK;
}

/* ---- Report ---- */

struct worst { double ratio, change, octave, jump; char ratio_of[96], change_of[96]; };

static double number(const json_t *row, const char *key)
{
	return json_number_value(json_object_get(row, key));
}

static void add_rows(struct bench_table *table, struct worst *worst, const char *scene, enum motion motion,
	const json_t *unit)
{
	for (size_t b = 0; b < BUDGETS; b++) {
		const json_t *row = json_array_get(unit, b);
		bench_table_row(table, "%s,%s,%llu,%.3f,%.3f,%.3f,%.3f,%.3f,%.2f,%.2f,%.2f,%.1f,%.2f,%.2f",
			scene, motion_names[motion], (unsigned long long)budgets[b],
			100 * number(row, "ours"), 100 * number(row, "reference"),
			number(row, "ratio"), number(row, "beyond"),
			number(row, "worst_pair"), 100 * number(row, "switched"),
			100 * number(row, "vertices"),
			100 * number(row, "worst_switch"), 100 * number(row, "over"),
			100 * number(row, "worst_octave"), 100 * number(row, "worst_jump"));
		if (!(number(row, "ratio") <= worst->ratio)) {
			worst->ratio = number(row, "ratio");
			snprintf(worst->ratio_of, sizeof worst->ratio_of, "%s, %s, %llu", scene,
				motion_names[motion], (unsigned long long)budgets[b]);
		}
		worst->octave = fmax(worst->octave, number(row, "worst_octave"));
		worst->jump = fmax(worst->jump, number(row, "worst_jump"));
		if (!(number(row, "worst_switch") <= worst->change)) {
			worst->change = number(row, "worst_switch");
			snprintf(worst->change_of, sizeof worst->change_of, "%s, %s, %llu", scene,
				motion_names[motion], (unsigned long long)budgets[b]);
		}
	}
}

static enum eco_code run_scene(struct bench *bench, size_t scene, struct bench_table *table,
	struct worst *worst, struct eco_error *error)
{
	char pack[512], name[96];
	struct eco_request starts[2 * VIEWS + 1];
	const char *of = scenes[scene];
	enum eco_code code = bench_scene(bench, of, NULL, pack, error);
	uint32_t found = code ? 0 : bench_scene_views(bench, of, starts, VIEWS), done = 0;
	for (int m = 0; m < MOTIONS && !code; m++) {
		snprintf(name, sizeof name, "steadiness-%s-%s-%s", of, motion_names[m], bench->full ? "full"
			: "quick");
		bench_progress(bench, ((double)scene + (double)done++ / MOTIONS) / SCENES, name);
		json_t *unit = bench_recall(bench, name, bench_pack_stamp(pack));
		if (!unit) {
			code = run_motion(bench, pack, starts, found, (enum motion)m, &unit, error);
			unit = code ? NULL : bench_keep(bench, name, bench_pack_stamp(pack), unit);
		}
		if (!code)
			add_rows(table, worst, of, (enum motion)m, unit);
	}
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct worst worst = { .ratio = NAN, .change = NAN, .octave = NAN, .jump = NAN };
	char pack[512];
	enum eco_code code = ECO_OK;
	struct bench_table *table = bench_table_open(bench, "steadiness",
		"scene,camera,vertices,changed %,reference changed %,ratio,only ours over "
		"reference,worst frame,plants switched %,vertices switched %,worst model and frame %,"
		"models and frames over 5 %,worst octave of distance %,by over 1/8 of a plant %", true);
	for (size_t i = 0; i < SCENES && !code; i++) {
		if (bench_shot_scene(bench, scenes[i], pack, &code, error) && !code)
			code = run_scene(bench, i, table, &worst, error);
	}
	bench_table_close(table);
	if (code)
		return code;
	bench_say(bench, "Slow cameras: %.1f %% nearer, %.2f degrees around or %.1f %% of zoom a frame, %u "
		"x %u pixels. A pixel changes where it is covered in "
		"one frame and not in the other, or a channel differs by more than %d. Worst ratio: %s. A "
		"plant switches where anything of its cuts "
		"changes, be it one leaf, a near one with the part of it that does; leaves that grow by "
		"less than a sixteenth of their area do not. "
		"Worst share of a model with at least %u plants in view, at all distances: %s.",
		100 * (1 - NEARER), TURN_RAD * 57.29578, 100 * (1 - NEARER), WIDTH, HEIGHT, COLOR_TOLD,
		worst.ratio_of, LIKE_LEAST, worst.change_of);
	bench_key(bench, "steadiness_ratio", worst.ratio, "<= 1.5: pixels that change over those of the "
		"reference, worst camera");
	bench_key(bench, "steadiness_switch", worst.change, "<= 0.05: of a model's plants that switch at "
		"once, worst frame");
	bench_key(bench, "steadiness_octave", worst.octave, "of a model's plants within an octave of "
		"distance, worst");
	bench_key(bench, "steadiness_jump", worst.jump, "<= 0.05: of those, by more than an eighth of a "
		"plant's vertices");
	return ECO_OK;
}

const struct bench_section bench_steadiness = { "steadiness", "Steadiness: slow cameras", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/frames/bench_st*.o" };
