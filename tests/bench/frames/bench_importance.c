/* Importance of flowers (Deussen 2002, 4.3 and figure 4): a flowering shrub and poppies drawn at small
 * budgets, with flowers as important as leaves and more. The measure is the share of the reference's flower
 * pixels, those clearly more red than green, that a picture shows as such, beside Q of all that is covered.
 * */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench.h"
#include "tests/support/files.h"

#define RED_LEAST 40                     /* bytes that red is above green; bark has fewer */

static const double importances[] = { 1, 2, 4, 8 };
#define IMPORTANCES (sizeof importances / sizeof *importances)
static const uint64_t budgets[] = { 1000, 3000, 10000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define SHOWN 1                          /* budget of the picture */

static enum eco_code make_pack(struct bench *bench, double importance, char path[512],
	struct eco_error *error)
{
	char scene[600], text[1200];
	int used = snprintf(text, sizeof text, "{\"plants\": {");
	static const char *const names[] = { "azalea", "poppy" };
	for (int i = 0; i < 2; i++)
		used += snprintf(text + used, sizeof text - (size_t)used, "%s\"%s\": {\"model\": "
			"\"park/models/%s.obj\", \"unit\": \"m\", \"importance\": {\"flower\": %g}}",
			i ? ", " : "", names[i], names[i], importance);
	used += snprintf(text + used, sizeof text - (size_t)used, "}, \"instances\": [{\"plant\": "
		"\"azalea\", \"at\": [0, 0]}");
	for (int i = 0; i < 8; i++)
		used += snprintf(text + used, sizeof text - (size_t)used, ", {\"plant\": \"poppy\", \"at\": "
			"[%g, %g], \"yaw_deg\": %d}", 1.4 + 0.2 * (i % 2), 0.35 * (i - 4), 40 * i);
	snprintf(text + used, sizeof text - (size_t)used, "]}\n");
	snprintf(path, 512, "%s/importance/flower%g.eco", bench->cache, importance);
	if (access(path, R_OK) == 0)
		return ECO_OK;
	snprintf(scene, sizeof scene, "%s/importance", bench->cache);
	folder_make(scene);
	snprintf(scene, sizeof scene, "%s/importance/flower%g.json", bench->cache, importance);
	file_write_text(scene, text);
	return bench_command(bench, error, "program=$(realpath '%s/ecopack'); cd '%s/importance' && { [ -d "
		"park ] || \"$program\" generate park -o park --plants 20 --quiet; } && "
		"\"$program\" make flower%g.json -o flower%g.eco --quiet",
		bench->build, bench->cache, importance, importance);
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
static enum eco_code try_pack(struct bench *bench, size_t which, struct bench_table *table,
	struct view_picture pictures[IMPORTANCES + 1], double share[BUDGETS], struct eco_error *error)
{
	char path[512];
	struct bench_client *client = NULL;
	struct view_picture other = { 0 };
	enum eco_code code = make_pack(bench, importances[which], path, error);
	code = code ? code : bench_client_open(&client, path, error);
	if (!code)
		bench_client_untimed(client);
	for (size_t b = 0; b < BUDGETS && !code; b++) {
		struct view_picture *at = b == SHOWN ? &pictures[which + 1] : &other;
		struct bench_frame frame = { .request = request_of(budgets[b]) };
		code = bench_client_frame(client, &frame, at, error);
		if (code)
			break;
		share[b] = shown(at, bench_client_full(client));
		bench_table_row(table, "%g,%llu,%llu,%.4f,%.4f", importances[which],
			(unsigned long long)budgets[b], (unsigned long long)frame.vertices, share[b],
			frame.score.q);
		view_picture_free(&other);
	}
	struct bench_frame full = { .request = request_of(ECO_VERTICES_MAX) };
	if (!code && which == 0)
		code = bench_client_frame(client, &full, &pictures[0], error);
	bench_client_close(client);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	double share[IMPORTANCES][BUDGETS];
	struct view_picture pictures[IMPORTANCES + 1] = { { 0 } };
	const uint8_t *rgb[IMPORTANCES + 1];
	enum eco_code code = ECO_OK;
	bench_say(bench, "A flowering shrub and poppies; the share of flower pixels of full detail that are "
		"flowers in the picture, by the flowers' importance. Leaves count 1.");
	struct bench_table *table = bench_table_open(bench, "importance",
		"importance,budget,vertices,flowers_shown,q", true);
	for (size_t i = 0; i < IMPORTANCES && !code; i++)
		code = try_pack(bench, i, table, pictures, share[i], error);
	bench_table_close(table);
	for (size_t i = 0; i <= IMPORTANCES; i++)
		rgb[i] = pictures[i].rgb;
	if (!code)
		code = bench_pictures_write(bench, "importance.png", pictures[0].width, pictures[0].height,
			rgb, IMPORTANCES + 1, error);
	for (size_t i = 0; i <= IMPORTANCES; i++)
		view_picture_free(&pictures[i]);
	if (code)
		return code;
	bench_picture(bench, "importance.png", "Full detail; 3,000 vertices at importance 1, 2, 4 and 8 of "
		"flowers.");
	bench_key(bench, "importance_shown", share[IMPORTANCES - 2][SHOWN],
		"flower pixels shown at importance 4 and 3,000 vertices");
	bench_key(bench, "importance_shown_neutral", share[0][SHOWN], "the baseline: importance 1");
	return ECO_OK;
}

const struct bench_section bench_importance = { .name = "importance", .title = "Importance of flowers",
	.run = run };
