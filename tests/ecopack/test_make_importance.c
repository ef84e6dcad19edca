/* Importance from scene files to plans: of an organ, of a part that a rule names, and of an eco file. */
#include <math.h>
#include <stdlib.h>

#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "lod/plan/planner.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

#define LEAVES 100
#define PETALS 20

static void write_blades(FILE *file, const char *name, int count, double low, double high, int *vertices)
{
	fprintf(file, "o %s\n", name);
	for (int i = 0; i < count; i++) {
		double turn = 2.4 * i, z = low + (high - low) * i / count;
		double r = 0.2 + 0.8 * (i * 37 % 100) / 100, x = r * cos(turn), y = r * sin(turn);
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\n", x, z, y, x + 0.1, z, y,
			x + 0.1, z + 0.1, y + 0.05, x, z + 0.1, y + 0.05);
		fprintf(file, "f %d %d %d %d\n", *vertices + 1, *vertices + 2, *vertices + 3, *vertices + 4);
		*vertices += 4;
	}
}

/* Leaves and petals of one form and colour: nothing but the rules tells them apart. */
static void write_plant(void)
{
	int vertices = 0;
	FILE *file = open_text("plant.obj");
	write_blades(file, "leaves", LEAVES, 0, 1.5, &vertices);
	write_blades(file, "top", PETALS, 1.5, 2, &vertices);
	assert_int_equal(fclose(file), 0);
}

static struct eco_pack *made(const char *scene, const char *text)
{
	char from[512], to[512];
	struct eco_pack *pack = NULL;
	write_text(scene, text);
	snprintf(from, sizeof from, "%s/%s", scratch_root, scene);
	snprintf(to, sizeof to, "%s/%.200s.eco", scratch_root, scene);
	assert_good(make_pack(&(struct make_options){ .scene = from, .pack = to,
		.order = LOD_ORDER_STOCHASTIC }, &cause));
	assert_good(eco_pack_open(&pack, to, &cause));
	return pack;
}

/* One plant of these rules. */
static struct eco_pack *made_one(const char *scene, const char *rules)
{
	char text[1000];
	snprintf(text, sizeof text, "{\"plants\": {\"a\": {\"model\": \"plant.obj\", \"up\": \"y\"%s}}, "
		"\"instances\": [{\"plant\": \"a\", \"at\": [0, 0]}]}", rules);
	return made(scene, text);
}

static bool draws(const struct eco_ladder *l, uint32_t list)
{
	return l->points == list || l->lines == list || l->simple == list || l->triangles == list;
}

/* Vertices of a plan that the lists of a plant's ladders of so many elements take, 0: all lists of the
 * plant. */
static uint64_t drawn(const struct eco_scene *scene, uint64_t vertices, uint32_t plant, uint32_t total)
{
	struct eco_request request = { .view = { .eye = { 4, 0, 2 }, .target = { 0, 0, 1 }, .up = { 0, 0, 1 },
		.fov_y_deg = 45, .width = 400, .height = 300 }, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED };
	struct lod_planner_input input = { .scene = scene, .request = &request };
	struct eco_plan plan, part;
	assert_good(lod_plan(&plan, &input, &cause));
	part = plan;
	part.cut_count = 0;
	part.cuts = calloc(plan.cut_count + 1, sizeof *part.cuts);
	assert_non_null(part.cuts);
	for (uint32_t i = 0; i < plan.cut_count; i++) {
		bool counts = total == 0 && scene->lists[plan.cuts[i].list].owner == plant;
		for (uint32_t l = 0; l < scene->ladder_count; l++)
			counts = counts || (scene->ladders[l].plant == plant
				&& scene->ladders[l].total == total
				&& draws(&scene->ladders[l], plan.cuts[i].list));
		if (counts)
			part.cuts[part.cut_count++] = plan.cuts[i];
	}
	uint64_t sum = plan_twin_vertices(scene, &part, &request.view, NULL);
	free(part.cuts);
	eco_plan_free(&plan);
	return sum;
}

static uint32_t elements_of(const struct eco_scene *scene, float importance)
{
	uint32_t sum = 0;
	for (uint32_t l = 0; l < scene->ladder_count; l++)
		if (!(scene->ladders[l].flags & ECO_LADDER_WHOLE)
				&& scene->ladders[l].importance == importance)
			sum += scene->ladders[l].total;
	return sum;
}

/* ---- The tests ---- */

UNIT_TEST(a_rule_s_importance_wins_over_the_organ_s)
{
	struct eco_pack *pack = made_one("organ.json", ", \"importance\": {\"foliage\": 2, \"flower\": 4}, "
		"\"parts\": [{\"name\": \"top*\", \"is\": \"flower\"}]");
	assert_int_equal(elements_of(&pack->scene, 4), PETALS);
	assert_int_equal(elements_of(&pack->scene, 2), LEAVES);
	eco_pack_close(pack);
	pack = made_one("both.json", ", \"importance\": {\"foliage\": 2}, "
		"\"parts\": [{\"name\": \"top*\", \"is\": \"flower\", \"importance\": 0.5}]");
	assert_int_equal(elements_of(&pack->scene, 0.5f), PETALS);
	assert_int_equal(elements_of(&pack->scene, 2), LEAVES);
	eco_pack_close(pack);
}

UNIT_TEST(an_eco_file_s_importance_multiplies_that_of_its_plants)
{
	uint64_t last = 0;
	for (int i = 0; i < 2; i++) {
		char text[400];
		snprintf(text, sizeof text, "{\"importance\": %s, \"plants\": {\"a\": {\"model\": "
			"\"plant.obj\", \"up\": \"y\", "
			"\"importance\": {\"foliage\": 1.5, \"flower\": 1.5}}}, "
			"\"instances\": [{\"plant\": \"a\", \"at\": [0, 0.5]}]}", i ? "16" : "0.5");
		write_text("inner.json", text);
		OWNED(eco_pack) *pack = made("outer.json", "{\"plants\": {\"a\": {\"model\": \"plant.obj\", "
			"\"up\": \"y\", \"importance\": {\"foliage\": 1.5, \"flower\": 1.5}}}, "
			"\"instances\": [{\"plant\": \"a\", \"at\": [0, -0.5]}], "
			"\"children\": [{\"eco\": \"inner.json\", \"at\": [0, 0]}]}");
		assert_int_equal(elements_of(&pack->scene, 1.5f * (i ? 16.0f : 0.5f)), LEAVES + PETALS);
		assert_int_equal(elements_of(&pack->scene, 1.5f), LEAVES + PETALS);
		uint32_t inner = pack->scene.ladders[0].importance == 1.5f;
		uint64_t now = 0;
		for (uint64_t vertices = 60; vertices < 1200; vertices *= 2)
			now += drawn(&pack->scene, vertices, inner, 0);
		assert_true(now > 1.1 * (double)last);
		last = now;
	}
}

static int prepare(void **state)
{
	scratch_open("importance");
	eco_progress_quiet(true);
	write_plant();
	return 0;
}

int main(void) { return unit_tests_run(prepare, scratch_close); }
