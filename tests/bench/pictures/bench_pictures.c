/* Pictures at small budgets as people see them: picture error (FLIP), soft Q and the rest, of scenes and
 * cameras that nothing was chosen on (pictures.json), beside the figures of the commit before splats
 * (pictures_start.csv). Every picture stands in the report, beside full detail and its error. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/pictures/bench_views.h"

#define START "tests/bench/pictures/pictures_start.csv"
#define STARTS_MAX 256u
#define SEEN_LEAST 5e-4          /* picture errors below are none */
#define FINE_VERTICES 100000u    /* from here on no point may be wide */

static const uint64_t budgets[] = { 10000, 100000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

/* As columns of the table, and of the start. */
enum figure { VERTICES, BYTES, QUALITY, SOFT, OWNER, PREDICTED, SEEN, WIDEST, CEILING, FIGURES };
static const char *const keys[FIGURES] = { "vertices", "bytes", "q", "soft_q", "owner_q", "predicted_q",
	"picture_error", "widest_px", "ceiling" };

struct start { char scene[32], camera[16]; unsigned long long budget; double figure[FIGURES]; };
struct study {
	struct start starts[STARTS_MAX];
	uint32_t start_count;
	struct bench_table *table;
	double log_sum, worst_ratio, worst_lost, worst_bytes, widest, scbi_owner[BUDGETS];
	uint32_t ratios;
	char worst[96];
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
		s->start_count += *line != '#' && sscanf(line,
			"%31[^,],%15[^,],%llu,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", at->scene, at->camera,
			&at->budget, &f[0], &f[1], &f[2], &f[3], &f[4], &f[5], &f[6], &f[7], &f[8]) == 12;
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

static void name_picture(char file[128], const struct bench_view *view, uint32_t budget)
{
	snprintf(file, 128, "pictures-%s-%s-%llu.png", view->scene, view->camera,
		(unsigned long long)budgets[budget]);
}

static enum eco_code show(struct bench *bench, struct bench_client *client, const struct bench_view *view,
	uint32_t budget, const struct bench_frame *frame, const struct view_picture *picture,
	struct eco_error *error)
{
	char file[128], ours[160], full[96], seen[96];
	const struct lod_score *score = &frame->score;
	name_picture(file, view, budget);
	snprintf(ours, sizeof ours, "%llu vertices, %.0f kB, Q %.4f, soft Q %.4f, owner_q %.3f",
		(unsigned long long)frame->vertices, (double)frame->bytes / 1e3, score->q, frame->soft_q,
		score->owner_q);
	snprintf(full, sizeof full, "full detail, ceiling %.4f", frame->ceiling);
	snprintf(seen, sizeof seen, "picture error %.4f, widest point %.1f px", frame->picture_error,
		frame->widest_px);
	return bench_client_compare(client, bench, file, picture, (const char *const[]){ ours, full, seen },
		error);
}

static void ask(uint32_t budget, struct bench_frame *frame)
{
	frame->request.vertices = budgets[budget];
	frame->request.bytes = ECO_BYTES_UNBOUNDED;
}

static const struct bench_view_shoot shoot = { "seen", BUDGETS, ask, show };

/* ---- Rows ---- */

/* NaN where both pictures are right, as full detail is, or where there is no start. */
static double ratio_of(const double now[FIGURES], const double start[FIGURES])
{
	bool both = now[SEEN] < SEEN_LEAST && start[SEEN] < SEEN_LEAST;
	return both || isnan(now[SEEN]) || isnan(start[SEEN]) ? NAN
		: fmax(now[SEEN], SEEN_LEAST) / fmax(start[SEEN], SEEN_LEAST);
}

static void compare(struct study *s, const char *what, uint64_t budget, const double now[FIGURES],
	const double start[FIGURES])
{
	double ratio = ratio_of(now, start);
	s->worst_lost = fmax(s->worst_lost, start[QUALITY] - now[QUALITY]);
	s->worst_bytes = fmax(s->worst_bytes, now[BYTES] / start[BYTES]);
	if (isnan(ratio))
		return;
	s->log_sum += log(ratio);
	s->ratios++;
	if (ratio > s->worst_ratio) {
		s->worst_ratio = ratio;
		snprintf(s->worst, sizeof s->worst, "%s at %llu", what, (unsigned long long)budget);
	}
}

static void add_row(struct study *s, const struct bench_view *view, size_t b, const json_t *row)
{
	static const double none[FIGURES] = { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN };
	const char *scene = view->scene, *camera = view->camera;
	const double *start = start_of(s, scene, camera, budgets[b]);
	double now[FIGURES];
	char what[64];
	for (int f = 0; f < FIGURES; f++)
		now[f] = bench_shot_number(row, keys[f]);
	snprintf(what, sizeof what, "%s, %s", scene, camera);
	if (start)
		compare(s, what, budgets[b], now, start);
	if (budgets[b] >= FINE_VERTICES)
		s->widest = fmax(s->widest, now[WIDEST]);
	if (!strcmp(scene, "scbi") && !strcmp(camera, "air"))
		s->scbi_owner[b] = now[OWNER];
	start = start ? start : none;
	bench_table_row(s->table, "%s,%s,%llu,%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,%.5f,%.1f,%.4f,"
		"%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,%.5f,%.1f,%.3f,%.3f", scene, camera,
		(unsigned long long)budgets[b], now[VERTICES], now[BYTES], now[QUALITY], now[SOFT],
		now[OWNER], now[PREDICTED], now[SEEN], now[WIDEST], now[CEILING],
		start[VERTICES], start[BYTES], start[QUALITY], start[SOFT], start[OWNER],
		start[PREDICTED], start[SEEN], start[WIDEST],
		now[BYTES] / start[BYTES], ratio_of(now, start));
}

static enum eco_code study_view(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error)
{
	json_t *rows;
	enum eco_code code = bench_view_rows(bench, view, &shoot, &rows, error);
	for (uint32_t b = 0; b < BUDGETS && !code; b++) {
		char file[128], caption[160];
		add_row(ctx, view, b, json_array_get(rows, b));
		name_picture(file, view, b);
		snprintf(caption, sizeof caption, "%s, %s, at most %llu vertices; full detail; error",
			view->scene, view->camera, (unsigned long long)budgets[b]);
		bench_picture(bench, file, caption);
	}
	return code;
}

/* ---- The report ---- */

static void write_keys(struct bench *bench, const struct study *s)
{
	double mean = s->ratios ? exp(s->log_sum / s->ratios) : NAN;
	if (s->ratios)
		bench_say(bench, "Picture errors over those of the start, %u pictures: geometric mean %.3f, "
			"worst %.3f (%s). Q lost at worst %.4f, bytes at worst %.2f times the start's. The "
			"widest point at %u vertices or more: %.1f pixels.", s->ratios, mean, s->worst_ratio,
			s->worst, s->worst_lost, s->worst_bytes, FINE_VERTICES, s->widest);
	bench_key(bench, "pictures_error_ratio", mean,
		"<= 0.7: picture error over the start's, geometric mean");
	bench_key(bench, "pictures_error_worst", s->ratios ? s->worst_ratio : NAN,
		"<= 1.01: the worst of them");
	bench_key(bench, "pictures_q_lost", s->ratios ? s->worst_lost : NAN, "<= 0.01: Q below the start's");
	bench_key(bench, "pictures_bytes_ratio", s->ratios ? s->worst_bytes : NAN,
		"<= 1.25: bytes of a first visit over the start's, the worst");
	bench_key(bench, "pictures_widest_px", s->widest > 0 ? s->widest : NAN,
		"<= 12: pixels across the widest point at 100,000 vertices or more");
	bench_key(bench, "pictures_scbi_owner_q_1m", s->scbi_owner[2],
		">= 0.75: owner_q of SCBI from the air at 1,000,000 vertices");
	bench_key(bench, "pictures_scbi_owner_q_100k", s->scbi_owner[1], ">= 0.45: at 100,000");
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for figures");
	s->scbi_owner[0] = s->scbi_owner[1] = s->scbi_owner[2] = NAN;
	read_start(s);
	bench_say(bench, "Every picture %u x %u, all chunks sent anew, drawn and lit in software. The start "
		"is the commit that " START " names: the same measures on its packs and plans.",
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT);
	s->table = bench_table_open(bench, "pictures", "scene,camera,budget,vertices,bytes,Q,soft Q,owner_q,"
		"predicted Q,picture error,widest point px,ceiling,start vertices,start bytes,start Q,"
		"start soft Q,start owner_q,start predicted Q,start picture error,start widest point px,"
		"bytes ratio,picture error ratio", true);
	enum eco_code code = bench_views_each(bench, SIZE_MAX, study_view, s, error);
	bench_table_close(s->table);
	if (!code)
		write_keys(bench, s);
	free(s);
	return code;
}

const struct bench_section bench_pictures = { "pictures", "What people see at small budgets", run,
	.objects = BENCH_OBJECTS_VIEWS "tests/bench/pictures/bench_pictures.o" };
