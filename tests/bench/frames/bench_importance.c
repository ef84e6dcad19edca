/* Importance of flowers (Deussen 2002, 4.3 and figure 4): a flowering shrub and poppies drawn at small
 * budgets, with flowers as important as leaves and more. The measure is the share of the reference's flower
 * pixels, those clearly more red than green, that a picture shows as such, beside Q of all that is covered.
 * */
#include <math.h>

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench.h"

#define RED_LEAST 40                     /* bytes that red is above green; bark has fewer */

static const double importances[] = { 1, 2, 4, 8 };
#define IMPORTANCES (sizeof importances / sizeof *importances)
static const uint64_t budgets[] = { 1000, 3000, 10000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define SHOWN 1                          /* budget of the picture */

static void make_pack(struct bench *bench, double importance, char path[512])
{
	static const char *const names[] = { "azalea", "poppy" };
	char scene[512];
	json_t *plants = json_object(), *instances = json_pack("[{s:s, s:[i, i]}]", "plant", "azalea", "at", 0, 0);
	for (int i = 0; i < 2; i++) {
		char model[64];
		snprintf(model, sizeof model, "park/models/%s.obj", names[i]);
		json_object_set_new(plants, names[i], json_pack("{s:s, s:s, s:{s:f}}", "model", model, "unit",
			"m", "importance", "flower", importance));
	}
	for (int i = 0; i < 8; i++)
		json_array_append_new(instances, json_pack("{s:s, s:[f, f], s:i}", "plant", "poppy", "at",
			1.4 + 0.2 * (i % 2), 0.35 * (i - 4), "yaw_deg", 40 * i));
	json_t *made = json_pack("{s:o, s:o}", "plants", plants, "instances", instances);
	bench_command("mkdir -p '%s/importance' && { [ -d "
		"'%s/importance/park' ] || '%s/ecopack' generate park -o '%s/importance/park' --plants 20 --quiet; }", bench->cache, bench->cache, bench->build, bench->cache);
	snprintf(scene, sizeof scene, "%.440s/importance/flower%g.json", bench->cache, importance);
	snprintf(path, 512, "%.440s/importance/flower%g.eco", bench->cache, importance);
	json_dump_file(made, scene, 0);
	json_decref(made);
	bench_command("'%s/ecopack' make '%s' -o '%s' --quiet --cache "
		"'%s/plants'", bench->build, scene, path, bench->cache);
}

static struct eco_request request_of(uint64_t vertices)
{
	return (struct eco_request){ .view = { .eye = { 4.5, 0, 1.6 }, .target = { 0.5, 0, 0.6 },
		.up = { 0, 0, 1 }, .fov_y_deg = 35, .width = 480, .height = 360 }, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
}

static bool is_flower(const struct view_picture *p, size_t i)
{
	return p->cover[i] && p->rgb[3 * i] >= p->rgb[3 * i + 1] + RED_LEAST;
}

static double shown(const struct view_picture *ours, const struct view_picture *reference)
{
	uint64_t all = 0, both = 0;
	for (size_t i = 0; i < (size_t)ours->width * ours->height; i++) {
		all += is_flower(reference, i);
		both += is_flower(reference, i) && is_flower(ours, i);
	}
	return all ? (double)both / (double)all : NAN;
}

/* pictures[0]: full detail; the others at budget SHOWN, by importance */
static void try_pack(struct bench *bench, size_t which, struct bench_table *table,
	struct view_picture pictures[IMPORTANCES + 1], double share[BUDGETS])
{
	char path[512];
	struct bench_client *client = NULL;
	make_pack(bench, importances[which], path);
	client = bench_client_open(path);
	bench_client_untimed(client);
	for (size_t b = 0; b < BUDGETS; b++) {
		struct view_picture picture = { 0 };
		struct bench_frame frame = { .request = request_of(budgets[b]) };
		bench_client_frame(client, &frame, &picture);
		share[b] = shown(&picture, bench_client_full(client));
		bench_table_row(table, "%g,%llu,%llu,%.4f,%.4f", importances[which],
			(unsigned long long)budgets[b], (unsigned long long)frame.vertices, share[b],
			frame.measures.score.q);
		if (b == SHOWN)
			pictures[which + 1] = picture;
		else
			view_picture_free(&picture);
	}
	struct bench_frame full = { .request = request_of(ECO_VERTICES_MAX) };
	if (which == 0)
		bench_client_frame(client, &full, &pictures[0]);
	bench_client_close(client);
}

static void run(struct bench *bench)
{
	double share[IMPORTANCES][BUDGETS];
	struct view_picture pictures[IMPORTANCES + 1] = { { 0 } };
	const uint8_t *rgb[IMPORTANCES + 1];
	bench_say(bench, "A flowering shrub and poppies; the share of flower pixels of full detail that are "
		"flowers in the picture, by the flowers' importance. Leaves count 1.");
	struct bench_table *table = bench_table_open(bench, "importance",
		"importance,budget,vertices,flowers_shown,q", true);
	for (size_t i = 0; i < IMPORTANCES; i++)
		try_pack(bench, i, table, pictures, share[i]);
	bench_table_close(table);
	for (size_t i = 0; i <= IMPORTANCES; i++)
		rgb[i] = pictures[i].rgb;
	bench_pictures_write(bench, "importance.png", pictures[0].width, pictures[0].height, rgb,
		IMPORTANCES + 1);
	for (size_t i = 0; i <= IMPORTANCES; i++)
		view_picture_free(&pictures[i]);
	bench_picture(bench, "importance.png", "Full detail; 3,000 vertices at importance 1, 2, 4 and 8 of "
		"flowers.");
	bench_key(bench, "importance_shown", share[IMPORTANCES - 2][SHOWN],
		"flower pixels shown at importance 4 and 3,000 vertices");
	bench_key(bench, "importance_shown_neutral", share[0][SHOWN], "the baseline: importance 1");
}

const struct bench_section bench_importance = { .name = "importance", .title = "Importance of flowers",
	.run = run };
