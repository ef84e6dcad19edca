/* Colour variation (Neubert 2011, section 5). Figure 9: an oak in three cases of colour, large regions, a
 * gradation and few red leaves, drawn with ever fewer vertices. Figure 10: as many trees as the paper's path
 * has, each with one of ten tints; the measure is the share of trees whose mean colour is nearest to that of
 * their class in full detail. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "ecofiles/base/random.h"
#include "tests/bench/bench.h"

#define TREES 1276u
#define CLASSES 10u
#define PIXELS_LEAST 12u         /* of a tree in full detail: smaller ones are told apart by nobody */
#define SIDE 12.0                /* metres between trees */

static const uint64_t oak_budgets[] = { 300, 3000, 30000, ECO_VERTICES_MAX },
	wood_budgets[] = { 10000, 30000, 100000, 1000000, ECO_VERTICES_MAX };
#define OAKS 4u
#define WOODS 5u

/* ---- Figure 9 ---- */

/* An index of the oak's leaf colours by the place (x, z) of a leaf and its number, in awk, and these colours. */
static const struct { const char *name, *leaf, *colors; } cases[] = {
	{ "regions", "x < -1 ? 0 : x > 1 ? 1 : 2", ".75 .15 .1 .1 .25 .75 .85 .7 .1" },
	{ "gradation", "int(z / 2 + (number % 7 - 3) / 7)", ".9 .8 .1 .7 .75 .1 .5 .7 .15 .3 .6 .2 .15 .5 .3 .1 .4 .4 .1 .3 .5 .1 .2 .6" },
	{ "details", "number % 12 ? 0 : 1", ".2 .4 .12 .8 .08 .06" } };
#define CASES 3u

static void make_oak(struct bench *bench, uint32_t which, char path[512])
{
	char folder[400];
	snprintf(folder, sizeof folder, "%.380s/tints", bench->cache);
	bench_command("mkdir -p '%s' && { [ -d '%s/park' ] || '%s/ecopack' generate park -o '%s/park' --plants 20 --quiet; }",
		folder, folder, bench->build, folder);
	bench_command("cd '%s' && awk '/^v / { x[++n] = $2; z[n] = $3 } /^mtllib/ { $2 = \"%s.mtl\" } "
		"/^usemtl/ { bark = $2 == \"bark\"; now = -1 } /^f / && !bark { split($2, at, \"/\"); "
		"if (at[1] != leaf) number++; leaf = at[1]; c = index_of(x[leaf], z[leaf]); if (c != now) print \"usemtl c\" c; "
		"now = c } !/^usemtl leaf/ { print } function index_of(x, z) { c = %s; return c < 0 ? 0 : c > 7 ? 7 : c }' "
		"park/models/oak.obj >%s.obj && { sed -n '/newmtl bark/,/^$/p' park/models/oak.mtl; echo '%s' | "
		"awk '{ for (i = 1; i < NF; i += 3) printf \"newmtl c%%d\\nKd %%s %%s %%s\\n\", i / 3, $i, $(i + 1), $(i + 2) }'; } "
		">%s.mtl && echo '{\"plants\": {\"oak\": {\"model\": \"%s.obj\", \"unit\": \"m\"}}, \"instances\": [{\"plant\": \"oak\", "
		"\"at\": [0, 0]}]}' >%s.json", folder, cases[which].name, cases[which].leaf, cases[which].name, cases[which].colors,
		cases[which].name, cases[which].name, cases[which].name);
	snprintf(path, 512, "%s/%s.eco", folder, cases[which].name);
	bench_command("'%s/ecopack' make '%s/%s.json' -o '%s' --quiet --cache '%s/plants'", bench->build,
		folder, cases[which].name, path, bench->cache);
}

static struct eco_request request_of(const double eye[3], const double target[3], uint32_t width, uint64_t vertices)
{
	struct eco_request r = { .view = { .up = { 0, 0, 1 }, .fov_y_deg = 40, .width = width, .height = width * 3 / 4 },
		.vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN,
		.texel_px = ECO_TEXEL_PX_MIN };
	memcpy(r.view.eye, eye, sizeof r.view.eye);
	memcpy(r.view.target, target, sizeof r.view.target);
	return r;
}

static void show(struct bench *bench, const char *file, struct view_picture *pictures, uint32_t count, const char *says)
{
	const uint8_t *rgb[WOODS] = { NULL };
	for (uint32_t i = 0; i < count; i++)
		rgb[i] = pictures[i].rgb;
	bench_pictures_write(bench, file, pictures[0].width, pictures[0].height, rgb, count);
	bench_picture(bench, file, says);
	for (uint32_t i = 0; i < count; i++)
		view_picture_free(&pictures[i]);
}

static void draw_oak(struct bench *bench, uint32_t which, struct bench_table *table)
{
	static const double eye[3] = { 0, -26, 9 }, target[3] = { 0, 0, 7 };
	struct view_picture pictures[OAKS] = { { 0 } };
	char path[512], file[64];
	make_oak(bench, which, path);
	struct bench_client *client = bench_client_open(path);
	bench_client_untimed(client);
	for (uint32_t b = 0; b < OAKS; b++) {
		struct bench_frame frame = { .request = request_of(eye, target, 320, oak_budgets[b]) };
		bench_client_frame(client, &frame, &pictures[b]);
		bench_table_row(table, "%s,%llu,%.4f,%.4f", cases[which].name,
			(unsigned long long)frame.vertices, frame.measures.score.q, frame.colour_rms);
	}
	bench_client_close(client);
	snprintf(file, sizeof file, "tints-%s.png", cases[which].name);
	show(bench, file, pictures, OAKS, "300, 3,000, 30,000 and all vertices.");
}

/* ---- Figure 10 ---- */

static void make_wood(struct bench *bench, char path[512])
{
	static const char *const names[] = { "oak", "linden", "birch", "spruce" };
	char file[512];
	snprintf(file, sizeof file, "%.440s/tints/wood.csv", bench->cache);
	FILE *table = fopen(file, "w");
	if (!table)
		must(eco_fail(must_error, ECO_IO, "%s cannot be written", file));
	fputs("x,y,species,colour\n", table);
	for (uint32_t i = 0; i < TREES; i++)
		fprintf(table, "%g,%g,%s,c%u\n", SIDE * (i % 36 + 0.6 * eco_random_unit(eco_random(1, i))),
			SIDE * (i / 36 + 0.6 * eco_random_unit(eco_random(2, i))), names[eco_random(3, i) % 4],
			(unsigned)(eco_random(4, i) % CLASSES));
	fclose(table);
	json_t *plants = json_object();
	for (int i = 0; i < 4; i++)
		json_object_set_new(plants, names[i], json_pack("{s:o, s:s}", "model",
			json_sprintf("park/models/%s.obj", names[i]), "unit", "m"));
	json_t *scene = json_pack("{s:o, s:[{s:s, s:s, s:s, s:s, s:{s:s, s:s}}]}", "plants", plants, "instances", "from", "wood.csv",
		"x", "x", "y", "y", "species", "species", "tint", "column", "colour", "palette", "owner");
	snprintf(file, sizeof file, "%.440s/tints/wood.json", bench->cache);
	json_dump_file(scene, file, 0);
	json_decref(scene);
	snprintf(path, 512, "%.440s/tints/wood.eco", bench->cache);
	bench_command("'%s/ecopack' make '%s' -o '%s' --quiet --cache '%s/plants'", bench->build, file, path, bench->cache);
}

struct tree { uint64_t owner; uint32_t tint; };
struct trees { struct tree items[2 * TREES]; uint32_t count; };

static void note_trees(void *ctx, const struct view_draw_job *job)
{
	struct trees *trees = ctx;
	for (uint32_t i = 0; i < job->selection->instance_count; i++) {
		const struct view_instance *p = &job->selection->instances[i];
		if (p->owner && trees->count < 2 * TREES)
			trees->items[trees->count++] = (struct tree){ p->owner, p->tint };
	}
}

/* Sums of pixels by owner: red, green, blue and their number; trees in order of note_trees. */
static void find_means(const struct trees *trees, const struct view_picture *p, double (*mean)[4])
{
	memset(mean, 0, 2 * TREES * sizeof *mean);
	uint32_t last = 0;
	for (size_t i = 0; i < (size_t)p->width * p->height; i++) {
		if (!p->owner[i])
			continue;
		for (uint32_t k = 0; k < trees->count && trees->items[last].owner != p->owner[i]; k++)
			last = (last + 1) % trees->count;
		if (trees->items[last].owner != p->owner[i])
			continue;
		for (size_t k = 0; k < 3; k++)
			mean[last][k] += p->rgb[3 * i + k];
		mean[last][3]++;
	}
}

static double apart(const double a[4], const double b[4])
{
	double sum = 0, all[2] = { a[0] + a[1] + a[2], b[0] + b[1] + b[2] };
	for (int k = 0; k < 3; k++)
		sum += (a[k] / all[0] - b[k] / all[1]) * (a[k] / all[0] - b[k] / all[1]);
	return sum;
}

/* The share of trees whose colour, whatever its brightness, is nearest to the mean of their class in full detail. */
static double told_apart(const struct trees *trees, const struct view_picture *ours, const struct view_picture *full)
{
	static double mine[2 * TREES][4], all[2 * TREES][4];
	struct { uint32_t tint; double sum[4]; } classes[CLASSES + 1] = { { 0 } };
	uint32_t count = 0, seen = 0, right = 0;
	find_means(trees, ours, mine);
	find_means(trees, full, all);
	for (uint32_t i = 0; i < trees->count; i++) {
		uint32_t c = 0;
		while (c < count && classes[c].tint != trees->items[i].tint)
			c++;
		count += c == count && count < CLASSES;
		classes[c].tint = trees->items[i].tint;
		for (int k = 0; k < 4; k++)
			classes[c].sum[k] += all[i][k];
	}
	for (uint32_t i = 0; i < trees->count; i++) {
		uint32_t best = 0;
		if (all[i][3] < PIXELS_LEAST)
			continue;
		for (uint32_t c = 1; c < count; c++)
			best = apart(mine[i], classes[c].sum) < apart(mine[i], classes[best].sum) ? c : best;
		seen++;
		right += mine[i][3] > 0 && classes[best].tint == trees->items[i].tint;
	}
	return seen ? (double)right / seen : NAN;
}

static void draw_wood(struct bench *bench)
{
	static const double eye[3] = { 150, -60, 45 }, target[3] = { 215, 120, 0 };
	static struct trees trees;
	struct view_picture pictures[WOODS] = { { 0 } };
	double share[WOODS];
	char path[512];
	make_wood(bench, path);
	struct bench_client *client = bench_client_open(path);
	bench_client_untimed(client);
	struct bench_table *table = bench_table_open(bench, "tints_wood", "vertices,told_apart,q,colour_rms", true);
	for (uint32_t b = 0; b < WOODS; b++) {
		struct bench_frame frame = { .request = request_of(eye, target, 640, wood_budgets[b]),
			.look = note_trees, .ctx = &trees };
		trees.count = 0;
		bench_client_frame(client, &frame, &pictures[b]);
		share[b] = told_apart(&trees, &pictures[b], bench_client_full(client));
		bench_table_row(table, "%llu,%.4f,%.4f,%.4f", (unsigned long long)frame.vertices, share[b],
			frame.measures.score.q, frame.colour_rms);
	}
	bench_table_close(table);
	bench_client_close(client);
	show(bench, "tints-wood.png", pictures, WOODS, "10,000, 30,000, 100,000, a million and all vertices.");
	bench_key(bench, "tints_told_apart", share[2], "trees of ten classes told apart at 100,000 vertices");
	bench_key(bench, "tints_told_apart_full", share[WOODS - 1], "the baseline: full detail");
}

static void run(struct bench *bench)
{
	bench_say(bench, "An oak of three cases of colour: regions, a gradation, and one red leaf of twelve.");
	struct bench_table *table = bench_table_open(bench, "tints_oak", "colours,vertices,q,colour_rms", true);
	for (uint32_t i = 0; i < CASES; i++)
		draw_oak(bench, i, table);
	bench_table_close(table);
	bench_say(bench, "%u trees of four species and ten tints. told_apart: of the trees with %u pixels or more in full "
		"detail, the share whose mean colour is nearest to that of their class.", TREES, PIXELS_LEAST);
	draw_wood(bench);
}

const struct bench_section bench_tints = { .name = "tints", .title = "Colour variation", .run = run };
