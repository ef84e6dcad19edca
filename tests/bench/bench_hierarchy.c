/* Hierarchy at scale: forests of 10^6, 10^9 and 10^12 plants from one hectare in blocks of blocks. A plan
 * costs what is seen, not what exists. */
#include <math.h>
#include <sys/stat.h>

#include "client-min/draw/view_picture.h"
#include "client-min/view_store.h"
#include "ecofiles/format/pack.h"
#include "tests/bench/bench.h"

#define HEIGHTS 6u
#define VERTICES 1000000u
#define PLANS 5

static const struct forest { const char *name; double plants, half_m; } forests[] =
{ { "million", 1e6, 200 }, { "billion", 1e9, 50000 },
	{ "trillion", 1e12, 2e6 } };

static void make_forest(struct bench *bench, const struct forest *f, char pack[512])
{
	char folder[480];
	snprintf(folder, sizeof folder, "%s/hierarchy-%s", bench->cache, f->name);
	snprintf(pack, 512, "%s.eco", folder);
	bench_command("'%s/ecopack' generate billion --plants %.0f -o '%s' "
		"--quiet && '%s/ecopack' make '%s/scene.json' -o '%s' --order stochastic --cache '%s/plants' "
		"--quiet", bench->build, f->plants, folder, bench->build, folder, pack, bench->cache);
}

static double megabytes(const char *path)
{
	struct stat status;
	return stat(path, &status) ? NAN : (double)status.st_size / 1048576;
}

/* Mean milliseconds of planning alone, in memory. */
static double plan_ms(const char *path, const struct eco_request *request)
{
	struct eco_pack *pack = NULL;
	must(eco_pack_open(&pack, path, must_error));
	struct lod_planner_input input = { .scene = &pack->scene, .request = request };
	must(lod_plan_tables_make(&input.tables, &pack->scene, must_error));
	double from = view_clock_ms();
	for (int i = 0; i < PLANS; i++) {
		struct eco_plan plan = { 0 };
		must(lod_plan(&plan, &input, must_error));
		eco_plan_free(&plan);
	}
	double ms = (view_clock_ms() - from) / PLANS;
	lod_plan_tables_free(input.tables);
	eco_pack_close(pack);
	return ms;
}

/* From the walker's eyes to where all is seen. */
static struct eco_request look_from_height(uint32_t i, double high)
{
	double h = i ? 16 * pow(high / 16, (i - 1.0) / (HEIGHTS - 2)) : 1.7;
	return (struct eco_request){ .vertices = VERTICES, .bytes = ECO_BYTES_UNBOUNDED,
		.view = { .eye = { i ? 0.3 * h : 0.5, i ? -1.4 * h : -40, h },
			.target = { i ? 0 : 1.5, i == 1 ? 30 : 0, i ? 0 : 4 }, .up = { 0, 0, 1 },
			.fov_y_deg = 50, .width = 800, .height = 600 } };
}

/* Full detail is drawn where few enough plants are in view, but for tiles at the horizon that are counted in
 * the table. */
static void draw_height(struct bench *bench, const struct forest *f, const char *pack,
	struct bench_client *client, uint32_t i, struct bench_table *table, double *worst_q)
{
	struct bench_frame frame = { .request = look_from_height(i, 1.7 * f->half_m) };
	struct view_picture picture = { 0 };
	bool scored = i == 1 || i == 2;
	char name[64], caption[160];
	double h = frame.request.view.eye[2];
	bench_client_frame(client, &frame, &picture);
	snprintf(name, sizeof name, "hierarchy-%s-%u.png", f->name, i);
	snprintf(caption, sizeof caption, "%s plants from %.4g m, %u vertices", f->name, h, VERTICES);
	bench_picture_write(bench, name, picture.width, picture.height, picture.rgb);
	bench_picture(bench, name, caption);
	bench_table_row(table, "%s,%.4g,%llu,%llu,%.1f,%.4f,%.4f,%.0f", f->name, h,
		(unsigned long long)frame.vertices, (unsigned long long)frame.bytes,
		plan_ms(pack, &frame.request), frame.predicted_q, scored ? frame.measures.score.q : NAN,
		scored ? (double)bench_client_coarse(client) : NAN);
	*worst_q = scored ? fmin(*worst_q, frame.measures.score.q) : *worst_q;
	view_picture_free(&picture);
}

static void draw_heights(struct bench *bench, const struct forest *f, const char *pack,
	struct bench_table *table, double *worst_q)
{
	struct bench_client *client = NULL;
	client = bench_client_open(pack);
	for (uint32_t i = 0; i < HEIGHTS; i++) {
		bench_progress((double)i / HEIGHTS, f->name);
		draw_height(bench, f, pack, client, i, table, worst_q);
	}
	bench_client_close(client);
}

/* Memory of ecoserve after random views. */
struct resident { double now_mb, most_mb; int bad, views; };

static struct resident serve(struct bench *bench, const char *pack)
{
	char path[512];
	struct resident r = { NAN, NAN, -1, 0 };
	snprintf(path, sizeof path, "%s/hierarchy-resident.txt", bench->cache);
	bench_command("sh tests/bench/hierarchy.sh '%s' '%s' %d %.0f '%s'", bench->build, pack, bench->full ? 1000 : 100, forests[1].half_m, path);
	FILE *file = fopen(path, "r");
	if (file && fscanf(file, "%lf %lf %d %d", &r.now_mb, &r.most_mb, &r.bad, &r.views) != 4)
		r.now_mb = NAN;
	if (file)
		fclose(file);
	return r;
}

static void run(struct bench *bench)
{
	struct bench_table *table = bench_table_open(bench, "hierarchy",
		"plants,height_m,vertices,bytes,plan_ms,predicted_q,q,reference_coarse", true);
	char packs[3][512];
	double worst_q = 1;
	for (uint32_t i = 0; i < 3; i++) {
		make_forest(bench, &forests[i], packs[i]);
		draw_heights(bench, &forests[i], packs[i], table, &worst_q);
	}
	bench_table_close(table);
	struct resident resident = serve(bench, packs[1]);
	bench_key(bench, "hierarchy_pack_mb", megabytes(packs[1]), "<= 67: MB of 10^9 plants (64 MiB)");
	bench_key(bench, "hierarchy_trillion_mb", megabytes(packs[2]),
		"MB of 10^12 plants, which open and plan");
	bench_key(bench, "hierarchy_resident_mb", resident.now_mb,
		"<= 134: MB of ecoserve after 1,000 random views (128 MiB)");
	bench_key(bench, "hierarchy_q", worst_q, ">= 0.8 where full detail can be drawn");
	bench_say(bench, "%d random views served, %d not answered with a stream; %.1f MB resident at the end, %.1f at "
		"most.", resident.views, resident.bad, resident.now_mb, resident.most_mb);
}

const struct bench_section bench_hierarchy = { "hierarchy", "Hierarchy at scale", run };
