/* Leaf collapse (Hidalgo, Abad, Camahort 2007) against orders and splats at equal vertices, and the paper's
 * figures: the quad of two leaves (1), the atlas (2), an example of a chain and its table of levels (3, 4),
 * levels at distances (5), sectors (6). What the paper has no figure for is the time of the search for pairs.
 *
 * The paper compares with nothing and gives no count of leaves, no time and no frame rate; its scenes of
 * millions of trees are a matter of the renderer. The section measures Q: of levels drawn as the paper says
 * (quads of the printed size), of levels whose quads are scaled as all other methods here are
 * (bench_savings.h), without textures, and by sectors that each have a level by how they face the eye. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/base/random.h"
#include "tests/bench/collapse/bench_collapse_draw.h"
#include "tests/bench/collapse/bench_collapse_q.h"

#define READ_QUICK 3u
#define MADE_QUICK 1u
#define CHAIN_LEAVES 10u
#define CROWN_RADIUS 5.0
#define LEAF_HALF 0.05

/* ---- Kept ---- */

static json_t *pack_row(const double *values, uint32_t count)
{
	json_t *row = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(row, isfinite(values[i]) ? json_real(values[i]) : json_null());
	return row;
}

static void read_row(const json_t *row, double *values, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		const json_t *value = json_array_get(row, i);
		values[i] = json_is_number(value) ? json_number_value(value) : NAN;
	}
}

static json_t *pack(const struct bench_collapse_q *q)
{
	json_t *kinds = json_array(), *levels = json_array();
	for (int k = 0; k < BENCH_COLLAPSE_KINDS; k++)
		json_array_append_new(kinds, pack_row(q->q[k], BENCH_SHARES));
	for (uint32_t i = 0; i < q->level_count; i++) {
		const struct bench_collapse_level *l = &q->level[i];
		const double row[4 + BENCH_COLLAPSE_SIZES] = { l->a, l->b, l->c, (double)l->vertices, l->q[0],
			l->q[1], l->q[2], l->q[3] };
		json_array_append_new(levels, pack_row(row, 4 + BENCH_COLLAPSE_SIZES));
	}
	const double plant[5] = { q->leaves, q->quads, q->roots, q->seconds, q->least };
	return json_pack("{s:o,s:o,s:o}", "kinds", kinds, "levels", levels, "plant", pack_row(plant, 5));
}

static void unpack(struct bench_collapse_q *q, const json_t *kept)
{
	double plant[5], row[4 + BENCH_COLLAPSE_SIZES];
	read_row(json_object_get(kept, "plant"), plant, 5);
	*q = (struct bench_collapse_q){ (uint32_t)plant[0], (uint32_t)plant[1], (uint32_t)plant[2],
		.seconds = plant[3], .least = plant[4] };
	for (size_t k = 0; k < BENCH_COLLAPSE_KINDS; k++)
		read_row(json_array_get(json_object_get(kept, "kinds"), k), q->q[k], BENCH_SHARES);
	const json_t *levels = json_object_get(kept, "levels");
	for (; q->level_count < BENCH_COLLAPSE_LEVELS && q->level_count < json_array_size(levels);
		q->level_count++) {
		struct bench_collapse_level *l = &q->level[q->level_count];
		read_row(json_array_get(levels, q->level_count), row, 4 + BENCH_COLLAPSE_SIZES);
		*l = (struct bench_collapse_level){ (uint32_t)row[0], (uint32_t)row[1], (uint32_t)row[2],
			(uint64_t)row[3], { row[4], row[5], row[6], row[7] } };
	}
}

static enum eco_code measure(struct bench *bench, const struct bench_model *model, struct bench_collapse_q *q,
	struct eco_error *error)
{
	char unit[96], stamp[64];
	struct eco_model read;
	snprintf(unit, sizeof unit, "collapse-%s", model->name);
	snprintf(stamp, sizeof stamp, "%u views %016llx", bench->full ? 12 : 6,
		(unsigned long long)bench_file_hash(model->path));
	json_t *kept = bench_recall(bench, unit, stamp);
	if (kept) {
		unpack(q, kept);
		return ECO_OK;
	}
	enum eco_code code = bench_model_read(bench, model, &read, error);
	if (!code)
		code = bench_collapse_measure(bench, model->name, q, &read, error);
	if (!code)
		bench_keep(bench, unit, stamp, pack(q));
	return code;
}

/* ---- Plants ---- */

#define ROWS (BENCH_METHODS + (int)BENCH_COLLAPSE_KINDS)

struct sums { double q[ROWS][BENCH_SHARES]; uint32_t count[ROWS][BENCH_SHARES], read, made; };
struct tables { struct bench_table *q, *levels; };

static const char *row_name(int row)
{
	return row < BENCH_METHODS ? bench_method_names[row] : bench_collapse_kind_names[row - BENCH_METHODS];
}

static void write_plant(const struct tables *t, struct sums *sums, const struct bench_model *model,
	const struct bench_savings *s, const struct bench_collapse_q *q)
{
	for (int row = 0; row < ROWS; row++) {
		const double *at = row < BENCH_METHODS ? s->q[row] : q->q[row - BENCH_METHODS];
		bench_table_row(t->q, "%s,%u,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", model->name, q->leaves,
			row_name(row), at[0], at[1], at[2], at[3], at[4], at[5]);
		for (uint32_t i = 0; i < BENCH_SHARES; i++)
			if (isfinite(at[i])) {
				sums->q[row][i] += at[i];
				sums->count[row][i]++;
			}
	}
	for (uint32_t i = 0; i < q->level_count; i++) {
		const struct bench_collapse_level *l = &q->level[i];
		bench_table_row(t->levels, "%s,%u,%u,%u,%u,%llu,%.3f,%.3f,%.3f,%.3f", model->name,
			l->a + l->c, l->a, l->b, l->c, (unsigned long long)l->vertices, l->q[0], l->q[1],
			l->q[2], l->q[3]);
	}
}

static enum eco_code study_plant(struct bench *bench, const struct bench_model *model, const struct tables *t,
	struct sums *sums, struct eco_error *error)
{
	struct bench_collapse_q q;
	struct bench_savings savings;
	char file[128];
	enum eco_code code = measure(bench, model, &q, error);
	const char *before = bench_objects(bench, BENCH_OBJECTS_PLANTS BENCH_OBJECTS_SAVINGS);
	if (!code)
		code = bench_savings_of(bench, &savings, model->name, model->path, error);
	bench_objects(bench, before);
	if (code)
		return code;
	write_plant(t, sums, model, &savings, &q);
	*(model->generated ? &sums->made : &sums->read) += 1;
	snprintf(file, sizeof file, "collapse-%s-levels.png", model->name);
	bench_picture(bench, file, "all leaves; levels of a quarter, a sixteenth and a 64th of the vertices");
	snprintf(file, sizeof file, "collapse-%s-atlas.png", model->name);
	bench_picture(bench, file, "its atlas: pairs of leaves, then classes of counts by density");
	snprintf(file, sizeof file, "collapse-%s-sectors.png", model->name);
	bench_picture(bench, file, "its sectors from above");
	return ECO_OK;
}

static enum eco_code study_plants(struct bench *bench, struct sums *sums, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	enum eco_code code = bench_models(bench, &models, &count, error);
	const struct tables t = { bench_table_open(bench, "collapse", "plant,leaves,method,Q at 2 %,Q at 5 %,"
		"Q at 10 %,Q at 20 %,Q at 30 %,Q at 50 % of the vertices", true),
		bench_table_open(bench, "collapse_levels", "plant,leaves of the level,a,b,c,vertices,"
		"Q at 256 pixels,Q at 128 pixels,Q at 64 pixels,Q at 32 pixels", true) };
	for (uint32_t i = 0; i < count && !code; i++) {
		uint32_t *done = models[i].generated ? &sums->made : &sums->read,
			quick = models[i].generated ? MADE_QUICK : READ_QUICK;
		if (models[i].leaves < BENCH_ELEMENTS_LEAST)
			continue;
		if (!bench->full && *done >= quick) {
			bench_left_out(bench, models[i].name);
			continue;
		}
		bench_progress(bench, (double)i / count, models[i].name);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: study_plant(bench, &models[i], &t, sums, error);
	}
	bench_table_close(t.q);
	bench_table_close(t.levels);
	free(models);
	return code;
}

/* As many as there are colours. */
static bool is_plotted(int row)
{
	return row == BENCH_STOCHASTIC || row == BENCH_COLLAPSE || row >= BENCH_PRUNED;
}

/* A mean stands where all plants have a figure. */
static enum eco_code write_means(struct bench *bench, const struct sums *sums, struct eco_error *error)
{
	double y[ROWS][BENCH_SHARES];
	struct bench_series series[ROWS];
	uint32_t plants = sums->read + sums->made, plotted = 0;
	struct bench_table *table = bench_table_open(bench, "collapse_means", "method,Q at 2 %,Q at 5 %,Q at "
		"10 %,Q at 20 %,Q at 30 %,Q at 50 % of the vertices,plants", true);
	for (int row = 0; row < ROWS; row++) {
		for (uint32_t i = 0; i < BENCH_SHARES; i++)
			y[row][i] = plants && sums->count[row][i] == plants ? sums->q[row][i] / plants : NAN;
		bench_table_row(table, "%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%u", row_name(row), y[row][0],
			y[row][1], y[row][2], y[row][3], y[row][4], y[row][5], plants);
		if (is_plotted(row))
			series[plotted++] = (struct bench_series){ row_name(row), bench_shares, y[row],
				BENCH_SHARES, false };
	}
	bench_table_close(table);
	bench_key(bench, "collapse_q_10", y[BENCH_COLLAPSE][2], "Q of leaf collapse at 10 % of the vertices");
	bench_key(bench, "collapse_greedy_q_10", y[BENCH_PRUNED][2], "beside it: the greedy order");
	bench_key(bench, "collapse_splats_q_10", y[BENCH_METHODS + (int)BENCH_COLLAPSE_SPLATS][2],
		"beside it: splats");
	return bench_plot(bench, &(struct bench_plot){ .name = "collapse", .title = "Q at equal vertices, "
		"mean over plants", .x = "share of the vertices", .y = "Q", .log_x = true, .series = series,
		.series_count = plotted }, error);
}

/* ---- Made leaves: an example of a chain, and times ---- */

struct made { uint32_t *first; float (*corner)[3]; };

static double dice(uint64_t *state) { return 2 * eco_random_unit(eco_random_next(state)) - 1; }

/* Squares strewn in a ball. */
static void strew(struct made *made, uint32_t count, struct lod_arena *arena)
{
	static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
	uint64_t state = 2007;
	made->first = lod_arena_take(arena, (size_t)count + 1, sizeof *made->first);
	made->corner = lod_arena_take(arena, 4 * (size_t)count, sizeof *made->corner);
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 at, n;
		do
			at = (struct lod_v3){ dice(&state), dice(&state), dice(&state) };
		while (lod_v3_dot(at, at) > 1);
		n = (struct lod_v3){ dice(&state), dice(&state), dice(&state) };
		struct lod_v3 along = lod_v3_scale(lod_v3_unit(lod_v3_cross(n, (struct lod_v3){ 0, 0, 1 })),
			LEAF_HALF), across = lod_v3_scale(lod_v3_unit(lod_v3_cross(n, along)), LEAF_HALF);
		at = lod_v3_scale(at, CROWN_RADIUS);
		for (uint32_t k = 0; k < 4; k++) {
			struct lod_v3 p = lod_v3_add(at, lod_v3_add(lod_v3_scale(along, sign[k][0]),
				lod_v3_scale(across, sign[k][1])));
			float *to = made->corner[4 * i + k];
			to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z;
		}
		made->first[i + 1] = 4 * (i + 1);
	}
}

static void collapse(struct lod_collapse *c, uint32_t count, const struct lod_collapse_options *options,
	struct lod_arena *arena)
{
	struct made made;
	strew(&made, count, arena);
	lod_collapse_make(c, &(struct lod_collapse_leaves){ count, made.first,
		(const float (*)[3])made.corner, NULL, 0, 0 }, options, arena);
}

static void write_places(const struct lod_collapse *c, uint32_t from, uint32_t count, char *text, size_t room)
{
	size_t at = 0;
	text[0] = 0;
	for (uint32_t i = from; i < from + count && at < room; i++)
		at += (size_t)snprintf(text + at, room - at, "%s%u", i > from ? " " : "", c->place[i]);
}

/* Figures 3 and 4: numbers up to 9 are leaves, the others quads in the order of their collapses. */
static void write_chain(struct bench *bench, struct lod_arena *arena)
{
	struct lod_collapse c;
	struct lod_collapse_options options = lod_collapse_defaults;
	options.distance_most = 4;
	struct bench_table *table = bench_table_open(bench, "collapse_chain",
		"level,leaves,a,b,c,first run [0;a),second run [b;b+c)", true);
	collapse(&c, CHAIN_LEAVES, &options, arena);
	for (uint32_t i = 0; i <= c.made; i++) {
		const struct lod_collapse_level *l = &c.level[i];
		char run[2][128];
		write_places(&c, 0, l->a, run[0], sizeof run[0]);
		write_places(&c, l->b, l->c, run[1], sizeof run[1]);
		bench_table_row(table, "%u,%u,%u,%u,%u,%s,%s", i, l->a + l->c, l->a, l->b, l->c, run[0],
			run[1]);
	}
	bench_table_close(table);
}

static void write_times(struct bench *bench, struct lod_arena *arena)
{
	static const uint32_t counts[] = { 10000, 30000, 100000, 300000 };
	struct bench_table *table = bench_table_open(bench, "collapse_times",
		"leaves,CPU s,collapses,roots,microseconds a leaf", true);
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		struct lod_collapse c;
		struct lod_arena_piece *mark = arena->last;
		bench_progress(bench, 0.9 + 0.02 * (double)i, "search for pairs");
		clock_t begun = clock();
		collapse(&c, counts[i], NULL, arena);
		double seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
		bench_table_row(table, "%u,%.2f,%u,%u,%.1f", counts[i], seconds, c.made, c.roots,
			1e6 * seconds / counts[i]);
		if (counts[i] == 300000)
			bench_key(bench, "collapse_300k_s", seconds,
				"<= 60: processor time of 300,000 leaves");
		lod_arena_release(arena, mark);
	}
	bench_table_close(table);
}

static enum eco_code write_made(struct bench *bench, struct eco_error *error)
{
	struct lod_arena arena = { 0 };
	if (setjmp(arena.failed)) {
		lod_arena_free(&arena);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for 300,000 leaves");
	}
	bench_head(bench, "A chain and its table of levels");
	write_chain(bench, &arena);
	bench_head(bench, "Search for pairs");
	write_times(bench, &arena);
	lod_arena_free(&arena);
	return ECO_OK;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct sums *sums = calloc(1, sizeof *sums);
	enum eco_code code = sums ? bench_collapse_draw_pair(bench, "collapse-pair.png", error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for sums");
	if (!code) {
		bench_picture(bench, "collapse-pair.png", "two leaves; what encloses them (dark) and the "
			"quad (red), whose area is the mean of both areas' sum and of what encloses them; "
			"the quad with its texture");
		code = study_plants(bench, sums, error);
	}
	if (!code)
		code = write_means(bench, sums, error);
	if (!code)
		code = write_made(bench, error);
	if (!code)
		bench_say(bench, "Rows of orders, of leaf collapse and of its quads without textures have "
			"each their best scale; those as printed and by sectors have the paper's sizes, "
			"which are too large: quads reach beyond the crown. Splats show wood and leaves "
			"together, "
			"one vertex each, over wood that is drawn whole as in all other rows. There is no "
			"figure where a coarsest level has more vertices than asked for.");
	free(sums);
	return code;
}

const struct bench_section bench_collapse = { "collapse", "Leaf collapse against orders and splats", run,
	.objects = BENCH_OBJECTS_PLANTS BENCH_OBJECTS_SAVINGS "tests/bench/collapse/bench_collapse*.o "
	"tests/bench/pictures/bench_splats*.o", .alone = true };
