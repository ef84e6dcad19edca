/* plans PACK: the planner's answers to twelve views of a pack at four budgets each, by both rules: a line a
 * plan, the bytes of the wire as hex digits. Two builds that print the same plan the same. */
#include <stdio.h>

#include "ecofiles/format/wire.h"
#include "ecofiles/base/bytes.h"
#include "lod/plan/planner.h"

#define VIEWS 12u

/* Around the scene and nearer and nearer, by arithmetic that every machine rounds alike. */
static struct eco_request request_of(const struct eco_tile *root, uint32_t view, uint64_t vertices)
{
	static const double around[VIEWS / 3][2] = { { 1, 0.25 }, { -0.5, 1 }, { -1, -0.75 }, { 0.25, -1 } };
	struct eco_request request =
		{ .view = { .up = { 0, 0, 1 }, .fov_y_deg = 45, .width = 800, .height = 600 },
			.vertices = vertices,
			.bytes = ECO_BYTES_UNBOUNDED };
	double size = root->high[0] - root->low[0], away = size * (view < 4 ? 2 : view < 8 ? 0.5 : 0.03125);
	for (int i = 0; i < 3; i++) {
		request.view.target[i] = 0.5 * (root->low[i] + root->high[i]);
		request.view.eye[i] = request.view.target[i] + away * (i < 2 ? around[view % 4][i] : 0.375);
	}
	return request;
}

static enum eco_code print_plan(const struct eco_scene *scene, uint32_t view, uint64_t vertices,
	lod_rule *rule, struct eco_error *error)
{
	struct eco_request request = request_of(&scene->tiles[scene->root], view, vertices);
	struct lod_planner_input input = { .scene = scene, .request = &request, .rule = rule };
	struct eco_plan plan = { 0 };
	struct eco_writer bytes = { 0 };
	enum eco_code code = lod_plan(&plan, &input, error);
	if (code)
		return code;
	eco_wire_write_plan(&bytes, &plan);
	printf("view %u, %llu vertices, rule %d: ", view, (unsigned long long)vertices,
		rule == lod_rule_deussen);
	for (size_t i = 0; i < bytes.size; i++)
		printf("%02x", bytes.bytes[i]);
	putchar('\n');
	eco_writer_free(&bytes);
	eco_plan_free(&plan);
	return ECO_OK;
}

int main(int argc, char **argv)
{
	static const uint64_t budgets[] = { 100, 3000, 100000, ECO_VERTICES_MAX };
	struct eco_error error = { 0 };
	struct eco_pack *pack = NULL;
	if (argc != 2) {
		fputs("plans PACK\n", stderr);
		return 2;
	}
	enum eco_code code = eco_pack_open(&pack, argv[1], &error);
	for (uint32_t i = 0; i < VIEWS * 4 * 2 && !code; i++)
		code = print_plan(&pack->scene, i / 8, budgets[i / 2 % 4], i % 2 ? lod_rule_deussen
			: lod_rule_optimal, &error);
	eco_pack_close(pack);
	if (code)
		fprintf(stderr, "plans: %s\n", error.text);
	return code ? 1 : 0;
}
