/* A flight of a minute: what is sent, with all that came held, and with it dropped every second, beside the
 * video that x264 makes of full detail, at the same picture error.
 *
 * A client asks ten times a second for the view of that moment. Bytes are whole answers, plans included.
 * Pictures do not depend on what is held (no budget of bytes binds), so the flight that drops is not drawn.
 * Full detail has one sample a pixel, as all pictures here, and so flickers in leaves, which costs video
 * much: pictures of more samples would be cheaper to encode. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/raster/flip.h"
#include "tests/bench/pictures/bench_flight.h"

#define FULL_EVERY 20u
#define QUICK_EVERY 10u
#define QUICK_FRAMES 60u
#define QUICK_FIRST 170u         /* down to eye level, and on */
#define MILLION 2u               /* budgets[MILLION] is compared with video */
#define SPACE 4u                 /* between pictures side by side */

static const uint64_t budgets[] = { 100000, 300000, 1000000, 3000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
static const uint32_t crfs[] = { 0, 8, 16, 24, 32, 40, 51 };          /* 0: without loss but of colours */
#define CRFS (sizeof crfs / sizeof *crfs)
/* Of scbi full detail takes ten seconds a frame from the air: the whole flight, a hundred minutes. */
static const char *const scenes[] = { "park", "city", "scbi" };
#define SCENES (sizeof scenes / sizeof *scenes)

enum holding { KEPT, COLD, HOLDINGS };
static const char *const holding_names[HOLDINGS] = { "kept", "dropped each second" };

enum chroma { HALVED, WHOLE, CHROMAS };
static const char *const chroma_names[CHROMAS] = { "4:2:0", "4:4:4" };

struct curve { double bytes[CRFS], seen[CRFS]; uint32_t count; };       /* bytes fall; 0: no x264 */
struct study {
	struct bench_table *table, *video;
	double worst[HOLDINGS];
};

/* ---- Ours ---- */

static enum eco_code score(const struct bench_flight *flight, uint32_t n, const struct view_picture *picture,
	double *q, double *seen, struct eco_error *error)
{
	struct view_picture full = { 0 };
	struct lod_score found;
	double one = 0;
	enum eco_code code = bench_flight_full(flight, n, &full, error);
	if (!code)
		code = lod_flip(&(struct lod_flip_input){ picture->width, picture->height, picture->rgb,
			full.rgb, NULL }, &one, error);
	if (!code) {
		lod_score(&found, &(struct lod_score_input){ picture->width, picture->height, picture->cover,
			full.cover, picture->owner, full.owner });
		*q += found.q / bench_flight_scored(flight);
		*seen += one / bench_flight_scored(flight);
	}
	view_picture_free(&full);
	return code;
}

struct sums { double bytes, first, plans, vertices, q, seen; };

static enum eco_code step(const struct bench_flight *flight, struct bench_client *client, uint32_t f,
	size_t budget, bool drawn, struct sums *sums, struct eco_error *error)
{
	struct bench_frame frame = { .rule = lod_rule_optimal, .request = { .view = flight->views[f],
		.vertices = budgets[budget], .bytes = ECO_BYTES_UNBOUNDED } };
	struct view_picture picture = { 0 };
	uint32_t n = f / flight->every;
	drawn = drawn && f == bench_flight_frame(flight, n);
	enum eco_code code = bench_client_step(client, &frame, drawn ? &picture : NULL, error);
	if (!code && drawn)
		code = score(flight, n, &picture, &sums->q, &sums->seen, error);
	if (!code && drawn && budget == MILLION && n == BENCH_FLIGHT_SHOWN(flight))
		code = bench_flight_keep(flight, "ours", picture.rgb, error);
	view_picture_free(&picture);
	sums->bytes += (double)frame.bytes;
	sums->first += f ? 0 : (double)frame.bytes;
	sums->plans += (double)frame.plan_bytes;
	sums->vertices += (double)frame.vertices / flight->count;
	return code;
}

static enum eco_code fly(struct bench *bench, const struct bench_flight *flight, size_t budget,
	enum holding holding, json_t **row, struct eco_error *error)
{
	struct bench_client *client = NULL;
	struct sums sums = { 0 };
	enum eco_code code = bench_client_open(&client, flight->pack, error);
	for (uint32_t f = 0; f < flight->count && !code; f++) {
		if (holding == COLD && f % BENCH_FLIGHT_FPS == 0)
			bench_client_forget(client);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: step(flight, client, f, budget, holding == KEPT, &sums, error);
	}
	bench_client_close(client);
	if (!code)
		*row = json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "bytes", sums.bytes, "first", sums.first,
			"plans", sums.plans, "vertices", sums.vertices, "q", sums.q, "picture_error",
			sums.seen);
	return code;
}

/* [b][holding] of the flights' rows. */
static enum eco_code fly_all(struct bench *bench, const struct bench_flight *flight,
	json_t *rows[BUDGETS][HOLDINGS], struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < BUDGETS * HOLDINGS && !code; i++) {
		char unit[96];
		size_t b = i / HOLDINGS, h = i % HOLDINGS;
		snprintf(unit, sizeof unit, "flight-%s-%u-%llu-%zu", flight->scene, flight->count,
			(unsigned long long)budgets[b], h);
		bench_progress(bench, 0.3 + 0.1 * (double)i / (BUDGETS * HOLDINGS), flight->scene);
		json_t *row = bench_recall(bench, unit, flight->stamp);
		if (!row) {
			code = fly(bench, flight, b, (enum holding)h, &row, error);
			row = code ? NULL : bench_keep(bench, unit, flight->stamp, row);
		}
		rows[b][h] = row;
	}
	return code;
}

/* ---- Video ---- */

static enum eco_code encode_all(struct bench *bench, const struct bench_flight *flight, struct study *s,
	struct curve curves[CHROMAS], struct eco_error *error)
{
	uint32_t count = bench_flight_has_x264() ? CHROMAS * CRFS : 0;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code; i++) {
		struct bench_flight_coding coding = { i / CRFS == WHOLE, crfs[i % CRFS] };
		struct curve *curve = &curves[i / CRFS];
		json_t *row;
		bench_progress(bench, 0.4 + 0.6 * i / count, flight->scene);
		code = bench_flight_video(bench, flight, &coding, &row, error);
		if (code)
			break;
		curve->bytes[curve->count] = bench_shot_number(row, "bytes");
		curve->seen[curve->count] = bench_shot_number(row, "picture_error");
		bench_table_row(s->video, "%s,%s,%u,%.0f,%.5f", flight->scene, chroma_names[i / CRFS],
			coding.crf, curve->bytes[curve->count], curve->seen[curve->count]);
		curve->count++;
	}
	return code;
}

/* Between two logarithms; NaN where the curve does not come by. */
static double bytes_at(const struct curve *curve, double seen)
{
	for (uint32_t i = 1; i < curve->count; i++) {
		double low = curve->seen[i - 1], high = curve->seen[i];
		if (seen >= low && seen <= high && high > low) {
			double t = (seen - low) / (high - low);
			return exp((1 - t) * log(curve->bytes[i - 1]) + t * log(curve->bytes[i]));
		}
	}
	return NAN;
}

/* Bytes of the smaller video of a picture error. *least: none is so good, and the best has so many. NaN where
 * even the worst is better, or there is none. */
static double video_bytes(const struct curve curves[CHROMAS], double seen, bool *least)
{
	double bytes = fmin(bytes_at(&curves[HALVED], seen), bytes_at(&curves[WHOLE], seen));
	const struct curve *best = &curves[curves[WHOLE].seen[0] < curves[HALVED].seen[0] ? WHOLE : HALVED];
	*least = best->count && seen < best->seen[0];
	return *least ? best->bytes[0] : bytes;
}

/* ---- The report ---- */

static void write_rows(const struct bench_flight *flight, json_t *const rows[BUDGETS][HOLDINGS],
	const struct curve curves[CHROMAS], struct study *s)
{
	for (size_t i = 0; i < BUDGETS * HOLDINGS; i++) {
		size_t b = i / HOLDINGS, h = i % HOLDINGS;
		const json_t *row = rows[b][h], *drawn = rows[b][KEPT];
		bool least;
		char cells[64] = "-,-";
		double seen = bench_shot_number(drawn, "picture_error"),
			bytes = bench_shot_number(row, "bytes"), video = video_bytes(curves, seen, &least),
			ratio = bytes / video;
		if (!isnan(ratio))
			snprintf(cells, sizeof cells, "%s%.0f,%s%.4f", least ? "> " : "", video,
				least ? "< " : "", ratio);
		bench_table_row(s->table, "%s,%u,%llu,%s,%.0f,%.0f,%.0f,%.0f,%.4f,%.5f,%s", flight->scene,
			flight->count, (unsigned long long)budgets[b], holding_names[h],
			bench_shot_number(row, "vertices"), bytes, bench_shot_number(row, "first"),
			bench_shot_number(row, "plans"), bench_shot_number(drawn, "q"), seen, cells);
		if (b == MILLION)
			s->worst[h] = isnan(ratio) || isnan(s->worst[h]) ? NAN : fmax(s->worst[h], ratio);
	}
}

static enum eco_code plot(struct bench *bench, const struct bench_flight *flight,
	json_t *const rows[BUDGETS][HOLDINGS], const struct curve curves[CHROMAS], struct eco_error *error)
{
	double x[HOLDINGS][BUDGETS], y[BUDGETS];
	char name[64], title[160];
	const struct curve *halved = &curves[HALVED], *whole = &curves[WHOLE];
	for (size_t b = 0; b < BUDGETS; b++) {
		y[b] = bench_shot_number(rows[b][KEPT], "picture_error");
		for (int h = 0; h < HOLDINGS; h++)
			x[h][b] = bench_shot_number(rows[b][h], "bytes");
	}
	const struct bench_series series[] = { { "ours", x[KEPT], y, BUDGETS, false },
		{ "ours, holdings dropped each second", x[COLD], y, BUDGETS, false },
		{ "x264 slow, 4:2:0", halved->bytes, halved->seen, halved->count, false },
		{ "x264 slow, 4:4:4", whole->bytes, whole->seen, whole->count, false } };
	snprintf(name, sizeof name, "flight-%s", flight->scene);
	snprintf(title, sizeof title, "%s: picture error for the bytes of a flight of %u s", flight->scene,
		flight->count / BENCH_FLIGHT_FPS);
	return bench_plot(bench, &(struct bench_plot){ .name = name, .title = title, .x = "bytes",
		.y = "picture error", .log_x = true, .series = series,
		.series_count = whole->count ? 4 : 2 }, error);
}

/* The video whose picture error is nearest, and its bytes. */
static struct bench_flight_coding nearest(const struct curve curves[CHROMAS], double seen, double *bytes)
{
	struct bench_flight_coding best = { false, crfs[0] };
	double off = INFINITY;
	for (uint32_t i = 0; i < CHROMAS * CRFS && curves[WHOLE].count; i++) {
		const struct curve *curve = &curves[i / CRFS];
		if (fabs(curve->seen[i % CRFS] - seen) >= off)
			continue;
		off = fabs(curve->seen[i % CRFS] - seen);
		best = (struct bench_flight_coding){ i / CRFS == WHOLE, crfs[i % CRFS] };
		*bytes = curve->bytes[i % CRFS];
	}
	return best;
}

/* Full detail, ours and, where `video` is a name, the video, side by side. False where one of an earlier run
 * has gone. */
static bool lay_out(const struct bench_flight *flight, const char *video, uint8_t *wide, uint32_t width)
{
	struct view_picture full = { 0 };
	uint8_t *rgb = malloc(3 * BENCH_FLIGHT_PIXELS);
	bool there = rgb && !bench_flight_full(flight, BENCH_FLIGHT_SHOWN(flight), &full, NULL);
	for (uint32_t i = 0; i < (video ? 3 : 2) && there; i++) {
		there = !i || bench_flight_kept(flight, i == 1 ? "ours" : video, rgb);
		const uint8_t *from = i ? rgb : full.rgb;
		for (size_t y = 0; y < BENCH_SHOT_HEIGHT && there; y++)
			memcpy(wide + 3 * (y * width + i * (BENCH_SHOT_WIDTH + SPACE)),
				from + 3 * y * BENCH_SHOT_WIDTH, 3 * BENCH_SHOT_WIDTH);
	}
	view_picture_free(&full);
	free(rgb);
	return there;
}

static enum eco_code show(struct bench *bench, const struct bench_flight *flight, const json_t *million,
	const struct curve curves[CHROMAS], struct eco_error *error)
{
	double video_size = 0;
	struct bench_flight_coding coding = nearest(curves, bench_shot_number(million, "picture_error"),
		&video_size);
	uint32_t parts = curves[WHOLE].count ? 3 : 2, width = parts * (BENCH_SHOT_WIDTH + SPACE) - SPACE;
	uint8_t *wide = calloc(3u * width, BENCH_SHOT_HEIGHT);
	char what[32], file[96], caption[256], video[64] = "";
	enum eco_code code = ECO_OK;
	if (!wide)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	bench_flight_coding_name(&coding, what);
	if (video_size > 0)
		snprintf(video, sizeof video, "; x264 (%s), %.0f kB", what, video_size / 1e3);
	snprintf(file, sizeof file, "flight-%s-shown.png", flight->scene);
	snprintf(caption, sizeof caption, "%s, frame %u of %u: full detail; ours at most %llu vertices, "
		"%.0f kB%s", flight->scene, bench_flight_frame(flight, BENCH_FLIGHT_SHOWN(flight)),
		flight->count, (unsigned long long)budgets[MILLION],
		bench_shot_number(million, "bytes") / 1e3, video);
	if (lay_out(flight, video_size > 0 ? what : NULL, wide, width)) {
		code = bench_picture_write(bench, file, width, BENCH_SHOT_HEIGHT, wide, error);
		if (!code)
			bench_picture(bench, file, caption);
	}
	free(wide);
	return code;
}

/* ---- Scenes ---- */

static enum eco_code study_flight(struct bench *bench, struct bench_flight *flight, struct study *s,
	struct eco_error *error)
{
	json_t *rows[BUDGETS][HOLDINGS];
	struct curve curves[CHROMAS] = { { .count = 0 } };
	double draw_ms = NAN;
	enum eco_code code = bench_flight_path(bench, flight,
		flight->count == BENCH_FLIGHT_FRAMES ? 0 : QUICK_FIRST, error);
	if (!code)
		code = bench_flight_reference(bench, flight, &draw_ms, error);
	if (!code)
		code = fly_all(bench, flight, rows, error);
	if (!code)
		code = encode_all(bench, flight, s, curves, error);
	if (code)
		return code;
	bench_say(bench, "%s: a frame of full detail is drawn in %.2f s.", flight->scene, draw_ms / 1e3);
	write_rows(flight, rows, curves, s);
	code = plot(bench, flight, rows, curves, error);
	return code ? code : show(bench, flight, rows[MILLION][KEPT], curves, error);
}

static enum eco_code each_scene(struct bench *bench, struct study *s, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < SCENES && !code; i++) {
		char pack[512];
		struct bench_flight flight = { .scene = scenes[i], .pack = pack,
			.count = bench->full ? BENCH_FLIGHT_FRAMES : QUICK_FRAMES,
			.every = bench->full ? FULL_EVERY : QUICK_EVERY };
		if (!bench_shot_scene(bench, scenes[i], pack, &code, error) || code)
			continue;
		code = study_flight(bench, &flight, s, error);
		free(flight.views);
	}
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct study s = { .worst = { 0, 0 } };
	bench_say(bench, "%u frames a second, %u x %u, from the air down to eye level and through; picture "
		"error and Q are means over every %u-th frame, bytes those of all. The video: full detail in "
		"BT.601, by x264 --preset slow --keyint infinite at several rate factors; the smaller of "
		"4:2:0 and 4:4:4 at our picture error counts, where neither is so good the best of them: then "
		"ours over x264 is less than that.", BENCH_FLIGHT_FPS,
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, bench->full ? FULL_EVERY : QUICK_EVERY);
	if (!bench_flight_has_x264())
		bench_say(bench, "x264 is not installed: apt-get install x264; the video's rows are left "
			"out.");
	s.table = bench_table_open(bench, "flight", "scene,frames,budget,holdings,vertices,bytes,"
		"first frame bytes,bytes of plans,Q,picture error,bytes of x264 at that error,"
		"ours over x264", true);
	s.video = bench_table_open(bench, "flight_video", "scene,chroma,crf,bytes,picture error", true);
	enum eco_code code = each_scene(bench, &s, error);
	bench_table_close(s.table);
	bench_table_close(s.video);
	if (code)
		return code;
	bench_key(bench, "flight_bytes_ratio", s.worst[KEPT] > 0 ? s.worst[KEPT] : NAN,
		"<= 0.5: bytes of a flight over x264's at the picture error of 1,000,000 vertices, the worst "
		"scene");
	bench_key(bench, "flight_bytes_ratio_cold", s.worst[COLD] > 0 ? s.worst[COLD] : NAN,
		"the same, with holdings dropped each second");
	return ECO_OK;
}

const struct bench_section bench_flight = { "flight", "Bytes of a flight beside video", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o tests/bench/bench_shots.o "
	"tests/bench/pictures/bench_flight.o tests/bench/pictures/bench_flight_path.o "
	"tests/bench/pictures/bench_flight_video.o" };
