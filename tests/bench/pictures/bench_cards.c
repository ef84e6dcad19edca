/* Trees of alpha-cut cards at shares of their vertices, one at a time: three seeds of `ecopack generate
 * city`, two heights in pixels, from all around and between 10 degrees below and 60 above the horizon. */
#include <math.h>

#include "tests/bench/bench_shots.h"

#define TREES 3u
#define WAYS 24u
#define CENTER_M 5.8
#define HEIGHT_M 11.0
#define FOV_DEG 6.0              /* far away, nearly orthographic */

static const double heights_px[] = { 64, 256 };
static const double shares[] = { 1, 2, 4, 8, 16, 64, 256 };          /* one of so many vertices */
#define SHARES (sizeof shares / sizeof *shares)

static void look_from(struct eco_view *view, uint32_t way, double height_px)
{
	double turn = (way + 0.37) * M_PI * (3 - sqrt(5)),
		rise = (-10 + 70 * (way + 0.5) / WAYS) * M_PI / 180, side = 1.6,
		tan_half = tan(FOV_DEG * M_PI / 360), far_m = side * HEIGHT_M / (2 * tan_half);
	uint32_t px = (uint32_t)(side * height_px + 0.5);
	*view = (struct eco_view){ .eye = { far_m * cos(rise) * cos(turn), far_m * cos(rise) * sin(turn),
		CENTER_M + far_m * sin(rise) }, .target = { 0, 0, CENTER_M }, .up = { 0, 0, 1 },
		.fov_y_deg = FOV_DEG, .width = px, .height = px };
}

/* Adds Q at each share from one direction; the first is all there is. */
static enum eco_code shoot(struct bench_client *client, const struct eco_view *view, double q[SHARES],
	struct eco_error *error)
{
	uint64_t all = 0;
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < SHARES && !code; i++) {
		struct bench_frame frame = { .method = "ours", .rule = lod_rule_optimal, .request = {
			.view = *view, .bytes = ECO_BYTES_UNBOUNDED,
			.vertices = i ? (uint64_t)((double)all / shares[i]) : ECO_VERTICES_MAX } };
		code = bench_client_frame(client, &frame, NULL, error);
		all = i ? all : frame.vertices;
		q[i] += code ? 0 : frame.score.q / WAYS;
	}
	return code;
}

static enum eco_code study(struct bench *bench, const char *name, double height_px, const char *pack,
	json_t **row, struct eco_error *error)
{
	struct bench_client *client = NULL;
	double q[SHARES] = { 0 };
	enum eco_code code = bench_client_open(&client, pack, error);
	if (!code)
		bench_client_untimed(client);
	for (uint32_t way = 0; way < WAYS && !code; way++) {
		struct eco_view view;
		look_from(&view, way, height_px);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: shoot(client, &view, q, error);
	}
	bench_client_close(client);
	if (code)
		return code;
	char unit[64];
	snprintf(unit, sizeof unit, "cards-%s-%.0f", name, height_px);
	json_t *made = json_array();
	for (size_t i = 0; i < SHARES; i++)
		json_array_append_new(made, json_real(q[i]));
	*row = bench_keep(bench, unit, bench_pack_stamp(pack), made);
	return ECO_OK;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	static const char *const names[TREES] = { "cards-1", "cards-2", "cards-3" };
	double sum[SHARES] = { 0 };
	uint32_t count = 0;
	enum eco_code code = ECO_OK;
	bench_say(bench, "Mean Q of %u directions, one tree in view, planned and drawn as in a scene.", WAYS);
	struct bench_table *table = bench_table_open(bench, "cards", "tree,height px,Q of all,Q at 1/2,"
		"Q at 1/4,Q at 1/8,Q at 1/16,Q at 1/64,Q at 1/256", true);
	for (uint32_t i = 0; i < 2 * TREES && !code; i++) {
		char pack[512], unit[64];
		double height_px = heights_px[i % 2], q[SHARES];
		if (!bench_scene_asked(bench, names[i / 2]))
			continue;
		code = bench_scene(bench, names[i / 2], NULL, pack, error);
		snprintf(unit, sizeof unit, "cards-%s-%.0f", names[i / 2], height_px);
		json_t *row = code ? NULL : bench_recall(bench, unit, bench_pack_stamp(pack));
		if (!code && !row)
			code = study(bench, names[i / 2], height_px, pack, &row, error);
		for (size_t k = 0; k < SHARES && !code; k++) {
			q[k] = json_number_value(json_array_get(row, k));
			sum[k] += q[k];
		}
		if (code)
			break;
		bench_table_row(table, "%s,%.0f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f", names[i / 2], height_px,
			q[0], q[1], q[2], q[3], q[4], q[5], q[6]);
		count++;
	}
	bench_table_close(table);
	if (!code) {
		bench_key(bench, "cards_q_8", sum[3] / count, ">= 0.7: mean Q at 1/8 of the vertices");
		bench_key(bench, "cards_q_64", sum[5] / count, ">= 0.62: at 1/64");
	}
	return code;
}

const struct bench_section bench_cards = { "cards", "Trees of cards", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o "
	"tests/bench/pictures/bench_cards.o" };
