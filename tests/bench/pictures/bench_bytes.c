/* First visits that bytes bound: what people see of scenes for 10 kB to 10 MB, at up to a million vertices,
 * over the cameras of the section pictures; beside the commit before bytes had a price (bytes_start.csv), and
 * what bench_beside.h names. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/pictures/bench_beside.h"

#define START "tests/bench/pictures/bytes_start.csv"
#define STARTS_MAX 256u
#define VERTICES 1000000u
#define SAME_Q 1e-4
#define SHOWN 2                  /* budgets[SHOWN] is shown as a picture */

static const uint64_t budgets[] = { 10000, 20000, 100000, 300000, 1000000, 3000000, 10000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

enum figure { DRAWN, BYTES, QUALITY, SKILL, OWNER, SEEN, PREDICTED, BALL, FIGURES };
static const char *const keys[FIGURES] = { "vertices", "bytes", "q", "skill", "owner_q", "picture_error",
	"predicted_q", "widest_ball_px" };

struct start { char scene[32], camera[16]; unsigned long long budget; double figure[FIGURES]; };
struct study {
	struct start starts[STARTS_MAX];
	uint32_t start_count;
	struct bench_table *table;
	struct bench_beside *beside;
	char scene[32];              /* of the last view */
	double used, off;            /* sums over rows that bind */
	uint32_t binding, better, worse;     /* the last two: rows with a start, by Q */
	uint32_t peers, fewer;       /* glTF files, and those that ours shows no worse for fewer bytes */
};

/* ---- The start ---- */

/* Lines that begin with # are words; those without numbers are the names of columns. */
static void read_start(struct study *s)
{
	char line[512];
	FILE *file = fopen(START, "r");
	while (file && s->start_count < STARTS_MAX && fgets(line, sizeof line, file)) {
		struct start *at = &s->starts[s->start_count];
		double *f = at->figure;
		f[PREDICTED] = NAN;
		s->start_count += *line != '#' && sscanf(line, "%31[^,],%15[^,],%llu,%lf,%lf,%lf,%lf,%lf,%lf",
			at->scene, at->camera, &at->budget, &f[0], &f[1], &f[2], &f[3], &f[4], &f[5]) == 9;
	}
	if (file)
		fclose(file);
}

static const double *start_of(const struct study *s, const char *scene, const char *camera, uint64_t budget)
{
	for (uint32_t i = 0; i < s->start_count; i++)
		if (s->starts[i].budget == budget && !strcmp(s->starts[i].scene, scene)
				&& !strcmp(s->starts[i].camera, camera))
			return s->starts[i].figure;
	return NULL;
}

/* ---- Pictures ---- */

static enum eco_code show(struct bench *bench, struct bench_client *client, const char *scene,
	const char *camera, const struct bench_frame *frame, const struct view_picture *picture,
	struct eco_error *error)
{
	char file[128], ours[160], seen[96];
	snprintf(file, sizeof file, "bytes-%s-%s.png", scene, camera);
	snprintf(ours, sizeof ours, "%.0f kB, %llu vertices, Q %.4f, owner_q %.3f",
		(double)frame->bytes / 1e3, (unsigned long long)frame->vertices, frame->score.q,
		frame->score.owner_q);
	snprintf(seen, sizeof seen, "picture error %.4f", frame->picture_error);
	return bench_client_compare(client, bench, file, picture,
		(const char *const[]){ ours, "full detail", seen }, error);
}

static void ask(uint32_t budget, struct bench_frame *frame)
{
	frame->request.vertices = VERTICES;
	frame->request.bytes = budgets[budget];
}

static enum eco_code take(struct bench *bench, struct bench_client *client, const struct bench_view *view,
	uint32_t budget, const struct bench_frame *frame, const struct view_picture *picture, json_t **row,
	struct eco_error *error)
{
	const double values[FIGURES] = { (double)frame->vertices, (double)frame->bytes, frame->score.q,
		frame->score.skill, frame->score.owner_q, frame->picture_error, frame->predicted_q,
		frame->widest_ball_px };
	*row = json_object();
	for (int f = 0; f < FIGURES; f++)
		bench_shot_set(*row, keys[f], values[f]);
	return budget == SHOWN ? show(bench, client, view->scene, view->camera, frame, picture, error)
		: ECO_OK;
}

static const struct bench_view_shoot shoot = { "bytes", BUDGETS, ask, take };

/* ---- Rows ---- */

static void add_row(struct study *s, const char *scene, const char *camera, size_t b, const json_t *rows)
{
	static const double none[FIGURES] = { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN };
	const double *start = start_of(s, scene, camera, budgets[b]);
	double now[FIGURES], all = bench_shot_number(json_array_get(rows, BUDGETS - 1), "bytes");
	for (int f = 0; f < FIGURES; f++)
		now[f] = bench_shot_number(json_array_get(rows, b), keys[f]);
	if (all > (double)budgets[b]) {
		s->used += now[BYTES] / (double)budgets[b];
		s->off += fabs(now[PREDICTED] - now[QUALITY]);
		s->binding++;
	}
	if (start) {
		s->better += now[QUALITY] > start[QUALITY] + SAME_Q;
		s->worse += now[QUALITY] < start[QUALITY] - SAME_Q;
	}
	start = start ? start : none;
	bench_table_row(s->table, "%s,%s,ours,%llu,%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,%.4f,%.1f,"
		"%.0f,%.0f,%.4f,%.4f,%.4f,%.4f",
		scene, camera, (unsigned long long)budgets[b], now[DRAWN], now[BYTES], now[QUALITY],
		now[SKILL], now[OWNER], now[SEEN], now[PREDICTED], now[BALL], start[DRAWN], start[BYTES],
		start[QUALITY], start[SKILL], start[OWNER], start[SEEN]);
}

/* Whether ours shows no more wrong for fewer bytes than a peer. */
static bool is_fewer(const json_t *rows, const json_t *peer)
{
	double bytes = bench_shot_number(peer, "bytes"), seen = bench_shot_number(peer, "picture_error");
	for (size_t b = 0; b < BUDGETS; b++) {
		const json_t *row = json_array_get(rows, b);
		if (bench_shot_number(row, "bytes") < bytes
				&& bench_shot_number(row, "picture_error") <= seen)
			return true;
	}
	return false;
}

/* All chunks are those of the scene: a row for its first view. */
static void add_beside(struct study *s, const struct bench_view *view, const json_t *rows,
	const json_t *beside)
{
	bool first = strcmp(s->scene, view->scene) != 0;
	snprintf(s->scene, sizeof s->scene, "%s", view->scene);
	for (size_t i = 0; i < json_array_size(beside); i++) {
		const json_t *row = json_array_get(beside, i);
		const char *method = json_string_value(json_object_get(row, "method"));
		bool chunks = !strcmp(method, bench_beside_chunks);
		if (!strcmp(method, bench_beside_gltf)) {
			s->peers++;
			s->fewer += is_fewer(rows, row);
		}
		if (chunks && !first)
			continue;
		bench_table_row(s->table, "%s,%s,%s: %s,nan,%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,nan,"
			"nan,nan,nan,nan,nan,nan,nan", view->scene, chunks ? "all" : view->camera, method,
			json_string_value(json_object_get(row, "setting")),
			bench_shot_number(row, "vertices"), bench_shot_number(row, "bytes"),
			bench_shot_number(row, "q"), bench_shot_number(row, "skill"),
			bench_shot_number(row, "owner_q"), bench_shot_number(row, "picture_error"));
	}
}

/* ---- Plots ---- */

#define POINTS 16u
enum line { OURS, CHUNKS, GLTF, FAST, STILL, BEFORE, LINES };
struct line_points { double x[POINTS], y[POINTS]; uint32_t count; };

static void add_point(struct line_points *line, double x, double y)
{
	if (line->count == POINTS)
		return;
	line->x[line->count] = x;
	line->y[line->count++] = y;
}

static void gather(const struct study *s, const struct bench_view *view, enum figure figure,
	const json_t *rows, const json_t *beside, struct line_points lines[LINES])
{
	static const char *const methods[LINES] = { [CHUNKS] = bench_beside_chunks,
		[GLTF] = bench_beside_gltf, [FAST] = bench_beside_fast, [STILL] = bench_beside_webp };
	add_point(&lines[CHUNKS], 1e4, NAN);     /* so that all plots have one axis of bytes */
	add_point(&lines[CHUNKS], 1e7, NAN);
	for (size_t b = 0; b < BUDGETS; b++) {
		const json_t *row = json_array_get(rows, b);
		const double *start = start_of(s, view->scene, view->camera, budgets[b]);
		add_point(&lines[OURS], bench_shot_number(row, "bytes"),
			bench_shot_number(row, keys[figure]));
		if (start)
			add_point(&lines[BEFORE], start[BYTES], start[figure]);
	}
	for (size_t i = 0; i < json_array_size(beside); i++) {
		const json_t *row = json_array_get(beside, i);
		const char *method = json_string_value(json_object_get(row, "method"));
		for (int l = 0; l < LINES; l++)
			if (methods[l] && !strcmp(method, methods[l]) && (l != STILL || figure == SEEN))
				add_point(&lines[l], bench_shot_number(row, "bytes"),
					bench_shot_number(row, keys[figure]));
	}
}

static enum eco_code plot(struct bench *bench, const struct study *s, const struct bench_view *view,
	enum figure figure, const json_t *rows, const json_t *beside, struct eco_error *error)
{
	static const char *const names[LINES] = { "ours", "all chunks",
		"glTF, gltfpack -cc: 1, 10, 100 % of triangles", "glTF, gltfpack -c", "WebP of the picture",
		"before bytes had a price" };
	struct line_points lines[LINES] = { { .count = 0 } };
	struct bench_series series[LINES];
	uint32_t count = 0;
	char name[96], title[160];
	gather(s, view, figure, rows, beside, lines);
	for (int l = 0; l < LINES; l++)
		if (lines[l].count)
			series[count++] = (struct bench_series){ names[l], lines[l].x, lines[l].y,
				lines[l].count, l == CHUNKS || l == FAST };
	snprintf(name, sizeof name, "bytes-%s-%s-%s", figure == SEEN ? "error" : "q", view->scene,
		view->camera);
	snprintf(title, sizeof title, "%s, camera %s: %s for the bytes of a first visit", view->scene,
		view->camera, figure == SEEN ? "what people see wrong" : "Q");
	return bench_plot(bench, &(struct bench_plot){ .name = name, .title = title, .x = "bytes",
		.y = figure == SEEN ? "picture error" : "Q", .log_x = true, .series = series,
		.series_count = count }, error);
}

static enum eco_code study_view(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error)
{
	struct study *s = ctx;
	json_t *rows, *beside;
	enum eco_code code = bench_view_rows(bench, view, &shoot, &rows, error);
	if (!code)
		code = bench_beside_rows(s->beside, view, &beside, error);
	if (code)
		return code;
	for (size_t b = 0; b < BUDGETS; b++)
		add_row(s, view->scene, view->camera, b, rows);
	add_beside(s, view, rows, beside);
	code = plot(bench, s, view, SEEN, rows, beside, error);
	return code ? code : plot(bench, s, view, QUALITY, rows, beside, error);
}

/* ---- The report ---- */

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *views;
	const json_t *scenes = bench_views_load(&views, error);
	struct study *s = calloc(1, sizeof *s);
	if (!s || !scenes) {
		json_decref(views);
		free(s);
		return scenes ? eco_fail(error, ECO_NO_MEMORY, "no memory for figures") : ECO_BAD_INPUT;
	}
	read_start(s);
	bench_say(bench, "Every picture %u x %u, of a first visit with at most %u vertices and so many "
		"bytes, drawn and lit in software.", BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, VERTICES);
	enum eco_code code = bench_beside_open(&s->beside, bench, error);
	s->table = bench_table_open(bench, "bytes", "scene,camera,method,budget,vertices,bytes,Q,skill,"
		"owner_q,picture error,predicted Q,widest ball (pixels),start vertices,start bytes,start Q,start skill,"
		"start owner_q,start picture error", true);
	if (!code)
		code = bench_views_each(bench, scenes, BENCH_VIEWS_QUICK, study_view, s, error);
	bench_table_close(s->table);
	bench_beside_close(s->beside);
	if (!code && s->peers)
		bench_say(bench, "For fewer bytes ours shows no more wrong than glTF -cc in %u of %u "
			"cases. Ours draws at most %u vertices, glTF as many as there are.", s->fewer,
			s->peers, VERTICES);
	if (!code && s->binding) {
		bench_say(bench, "Of %u rows where bytes bind. With a start, Q is above it in %u rows and "
			"below it in %u.", s->binding, s->better, s->worse);
		bench_key(bench, "bytes_used", s->used / s->binding,
			">= 0.95: share of the bytes used where they bind");
		bench_key(bench, "bytes_predicted_off", s->off / s->binding,
			"<= 0.03: predicted Q off by, where they bind");
	}
	json_decref(views);
	free(s);
	return code;
}

const struct bench_section bench_bytes = { "bytes", "What people see for the bytes of a first visit", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o "
	"tests/bench/pictures/bench_bytes.o tests/bench/pictures/bench_beside.o "
	"tests/bench/pictures/bench_gltf*.o tests/bench/pictures/bench_full.o "
	"tests/bench/pictures/bench_views.o tests/bench/pictures/bench_widest.o" };
