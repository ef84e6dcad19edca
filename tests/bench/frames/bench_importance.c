/* Importance of flowers (Deussen 2002, 4.3 and figure 4): a flowering shrub and poppies drawn at small
 * budgets, with flowers as important as leaves and more. Measured is the share of the reference's flower
 * pixels, those clearly more red than green, that a picture shows as such, beside Q of all that is
 * covered. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "lod/raster/raster.h"
#include "tests/bench/bench.h"
#include "tests/bench/frames/bench_still.h"
#include "tests/support/files.h"

#define RED_LEAST 40                     /* bytes that red is above green; bark has fewer */

static const double importances[] = { 1, 2, 4, 8 };
#define IMPORTANCES (sizeof importances / sizeof *importances)
static const uint64_t budgets[] = { 1000, 3000, 10000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

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
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN,
		.texel_px = ECO_TEXEL_PX_MIN };
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

/* ---- One pack ---- */

/* Side by side: full detail, then a picture for each importance, at the budget in the middle. */
struct strip { uint8_t *rgb; size_t row; };

static void put(struct strip *strip, size_t column, const struct view_picture *picture)
{
	size_t row = 3 * (size_t)picture->width;
	for (size_t y = 0; y < picture->height && strip->rgb; y++)
		memcpy(strip->rgb + y * strip->row + column * row, picture->rgb + y * row, row);
}

static enum eco_code try_pack(struct bench *bench, size_t which, struct bench_table *table,
	struct strip *strip, double share[BUDGETS], struct eco_error *error)
{
	char path[512];
	struct bench_still *still = NULL;
	struct view_picture full = { 0 }, ours = { 0 };
	struct eco_request request = request_of(ECO_VERTICES_MAX);
	enum eco_code code = make_pack(bench, importances[which], path, error);
	if (!code)
		code = bench_still_open(&still, path, error);
	if (!code)
		code = bench_still_draw(still, &request, &full, NULL, error);
	if (!code && which == 0)
		put(strip, 0, &full);
	for (size_t b = 0; b < BUDGETS && !code; b++) {
		struct lod_score score;
		request = request_of(budgets[b]);
		code = bench_still_draw(still, &request, &ours, NULL, error);
		if (code)
			break;
		lod_score(&score, &(struct lod_score_input){ ours.width, ours.height, ours.cover, full.cover,
			ours.owner, full.owner });
		share[b] = shown(&ours, &full);
		bench_table_row(table, "%g,%llu,%llu,%.4f,%.4f", importances[which],
			(unsigned long long)budgets[b], (unsigned long long)ours.vertices, share[b], score.q);
		if (b == BUDGETS / 2)
			put(strip, which + 1, &ours);
	}
	view_picture_free(&full);
	view_picture_free(&ours);
	bench_still_close(still);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct eco_view view = request_of(0).view;
	struct strip strip = { .row = 3 * (IMPORTANCES + 1) * (size_t)view.width };
	double share[IMPORTANCES][BUDGETS];
	enum eco_code code = ECO_OK;
	strip.rgb = calloc(view.height, strip.row);
	if (!strip.rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	bench_say(bench, "A flowering shrub and poppies; the share of flower pixels of full detail that are "
		"flowers in the picture, by the flowers' importance. Leaves count 1.");
	struct bench_table *table = bench_table_open(bench, "importance",
		"importance,budget,vertices,flowers_shown,q", true);
	for (size_t i = 0; i < IMPORTANCES && !code; i++)
		code = try_pack(bench, i, table, &strip, share[i], error);
	bench_table_close(table);
	if (!code)
		code = bench_picture_write(bench, "importance.png", (uint32_t)(strip.row / 3), view.height,
			strip.rgb, error);
	free(strip.rgb);
	if (code)
		return code;
	bench_picture(bench, "importance.png", "Full detail; 3,000 vertices at importance 1, 2, 4 and 8 of "
		"flowers.");
	bench_key(bench, "importance_shown", share[IMPORTANCES - 2][BUDGETS / 2],
		"flower pixels shown at importance 4 and 3,000 vertices");
	bench_key(bench, "importance_shown_neutral", share[0][BUDGETS / 2], "the baseline: importance 1");
	return ECO_OK;
}

const struct bench_section bench_importance = { .name = "importance", .title = "Importance of flowers",
	.run = run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/frames/bench_importance.o "
	"tests/bench/frames/bench_still.o" };
