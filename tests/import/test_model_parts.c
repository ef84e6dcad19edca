/* Rules about parts of a plant: which triangles they name, and what becomes of these. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/cases.h"
#include "tests/support/model_try.h"

#include "ecofiles/import/model/model_parts.h"
#include "ecofiles/format/pack.h"

UNIT_TEST(names_fit_patterns_whole_or_between_slashes)
{
	struct row { const char *pattern, *name; bool fits; };
	uint32_t count;
	const struct row *cases = cases_rows("tests/import/cases/part_names.tsv", "ssb", sizeof *cases,
		&count);

	for (size_t i = 0; i < count; i++)
		if (eco_part_name_fits(cases[i].pattern, cases[i].name) != cases[i].fits)
			fail_msg("%s on %s", cases[i].pattern, cases[i].name);
}

/* A square of side `size` at (x, z), standing, of two triangles that share two of their four vertices. */
static size_t put_square(char *to, size_t room, double x, double z, double size, int first)
{
	return (size_t)snprintf(to, room, "v %g %g 0\nv %g %g 0\nv %g %g 0\nv %g %g 0\nf %d %d %d\nf %d %d "
		"%d\n", x, z, x + size, z, x + size, z + size, x, z + size, first, first + 1, first + 2,
		first, first + 2, first + 3);
}

/* Bark of 4 x 4, a pot of 6 x 6 below it in two materials, and three leaves of sides 1, 1 and 2. */
static const char *write_plant(void)
{
	char text[2000];
	size_t used = 0;
	input_text("parts", "plant.mtl", "newmtl bark\nKd 1 1 0\nnewmtl clay\nKd 1 0 0\nnewmtl soil\nKd 0 0 "
		"0\nnewmtl leaf\nKd 0 1 0\n");
	used += (size_t)snprintf(text, sizeof text, "mtllib plant.mtl\no Stem\nusemtl bark\n");
	used += put_square(text + used, sizeof text - used, 0, 6, 4, 1);
	used += (size_t)snprintf(text + used, sizeof text - used, "o Pot\nusemtl clay\n");
	used += put_square(text + used, sizeof text - used, -1, 0, 6, 5);
	used += (size_t)snprintf(text + used, sizeof text - used,
		"usemtl soil\nf 8 7 4\no Crown\nusemtl leaf\n");
	used += put_square(text + used, sizeof text - used, 0, 11, 1, 9);
	used += put_square(text + used, sizeof text - used, 2, 11, 1, 13);
	put_square(text + used, sizeof text - used, 4, 11, 2, 17);
	return input_text("parts", "plant.obj", text);
}

static void import_with(const struct eco_part_rule *rules, uint32_t count)
{
	import_file(write_plant(), &(struct eco_model_options){ .up = ECO_UP_Y, .rules = rules, .rule_count = count,
		.unit_m = 1 });
}

UNIT_TEST(components_hang_together_by_place_within_a_material)
{
	static const double areas[] = { 36, 16, 12, 4, 1, 1 };      /* pot, stem, soil, leaves */
	struct eco_components all, by_material;
	uint32_t *place;
	import_with(NULL, 0);
	place = calloc(m.vertex_count, sizeof *place);
	eco_model_places(&m, place);
	eco_components_find(&by_material, &m, place, true);
	eco_components_find(&all, &m, place, false);
	assert_int_equal(by_material.count, 6);
	assert_int_equal(all.count, 4);              /* soil hangs together with pot and stem */
	for (uint32_t i = 0; i < 6; i++)
		assert_true(close_to(by_material.items[i].area, areas[i], 1e-4));
	/* as large as each other: as in the file */
	assert_true(by_material.items[4].first < by_material.items[5].first);
	for (uint32_t i = 0; i < m.triangle_count; i++)
		assert_true(by_material.of[i] < 6 && strcmp(m.materials[m.material[i]].name,
			m.materials[m.material[by_material.items[by_material.of[i]].first]].name) == 0);
	eco_components_free(&all);
	eco_components_free(&by_material);
	free(place);
}

UNIT_TEST(rules_give_importances)
{
	const struct eco_part_rule rules[] =
		{ { .kind = ECO_PART_NAME, .name = (char *)"clay", .is = ECO_ORGAN_WOOD, .importance = 2 },
		{ .kind = ECO_PART_NAME, .name = (char *)"soil", .is = ECO_PART_LEFT_OUT, .importance = 9 },
		{ .kind = ECO_PART_NAME, .name = (char *)"bark", .is = ECO_ORGAN_FOUND, .importance = 0.5f },
		{ .kind = ECO_PART_COMPONENT, .component = 3, .is = ECO_ORGAN_FLOWER, .importance = 2 } };
	import_with(rules, 4);
	assert_non_null(m.importance);
	for (uint32_t i = 0; i < m.triangle_count; i++) {
		const char *material = m.materials[m.material[i]].name;
		float given = m.importances[m.importance[i]];
		assert_true(m.importance[i] < m.importance_count);
		assert_true(given == (strcmp(material, "clay") == 0 ? 2 : strcmp(material, "bark") == 0 ? 0.5f
			: 0));
		assert_true(strcmp(material, "bark") != 0 || m.organ[i] == ECO_ORGAN_FOUND);
	}
	import_with(rules + 1, 1);
	for (uint32_t i = 0; i < m.triangle_count; i++)
		assert_true(m.importances[m.importance[i]] == 0);
}

UNIT_TEST(the_first_rule_that_fits_counts)
{
	const struct eco_part_rule rules[] =
		{ { .kind = ECO_PART_NAME, .name = (char *)"cl?y", .is = ECO_ORGAN_WOOD },
		{ .kind = ECO_PART_NAME, .name = (char *)"Pot", .is = ECO_PART_LEFT_OUT },
		{ .kind = ECO_PART_COMPONENT, .component = 2,
			.is = ECO_ORGAN_FLOWER },
		{ .kind = ECO_PART_SIZE, .size = { 0, 0.15 }, .is = ECO_ORGAN_FOLIAGE },
		{ .kind = ECO_PART_NAME, .name = (char *)"*",
			.is = ECO_ORGAN_WOOD } };
	uint32_t count[256] = { 0 };
	import_with(rules, 5);
	assert_int_equal(m.dropped[ECO_DROP_LEFT_OUT], 1);       /* the soil: the clay is wood first */
	for (uint32_t i = 0; i < m.triangle_count; i++) {
		const char *material = m.materials[m.material[i]].name;
		count[m.organ[i]]++;
		assert_int_equal(m.organ[i] == ECO_ORGAN_FLOWER, strcmp(material, "bark") == 0);
		assert_true(strcmp(material, "clay") != 0 || m.organ[i] == ECO_ORGAN_WOOD);
	}
	assert_int_equal(count[ECO_ORGAN_FLOWER], 2);
	assert_int_equal(count[ECO_ORGAN_FOLIAGE], 4);           /* two small leaves */
	/* the pot, and the large leaf by the last rule */
	assert_int_equal(count[ECO_ORGAN_WOOD], 4);
	assert_int_equal(import_said[0], 0);
}

UNIT_TEST(rules_that_fit_nothing_say_what_there_is)
{
	const struct eco_part_rule rules[] =
		{ { .kind = ECO_PART_NAME, .name = (char *)"vase*", .is = ECO_PART_LEFT_OUT },
		{ .kind = ECO_PART_COMPONENT, .component = 7, .is = ECO_ORGAN_WOOD },
		{ .kind = ECO_PART_SIZE, .size = { 2, 3 }, .is = ECO_ORGAN_WOOD } };
	import_with(rules, 3);
	import_says("the rule {\"name\": \"vase*\"} fits nothing: ecopack model lists the names of");
	import_says("the rule {\"component\": 7} fits nothing: there are 6 components");
	import_says("the rule {\"size\": [2, 3]} fits nothing");
}

UNIT_TEST(rules_that_leave_nothing_are_an_error)
{
	const struct eco_part_rule rules[] =
		{ { .kind = ECO_PART_NAME, .name = (char *)"*", .is = ECO_PART_LEFT_OUT } };
	const char *path = write_plant();
	eco_model_free(&m);
	assert_code(eco_model_import(&m,
		&(struct eco_model_options){ .paths = &path, .path_count = 1, .rules = rules,
		.rule_count = 1 }, &cause), ECO_BAD_INPUT, "leave out all of it");
	assert_null(m.position);
}
/* ---- What files of games hold beside the plant ---- */

UNIT_TEST(levels_are_known_by_names)
{
	static const struct {
		const char *name;
		int level;
	} cases[] = { { "tree_LOD0", 0 }, { "Tree.lod1/bark", 1 }, { "treeLOD2", 2 }, { "oak_lod_3", 3 },
		{ "LOD1", 1 }, { "LOD1.001", 1 }, { "Tree", ECO_SPARE_NONE }, { "melody1", ECO_SPARE_NONE },
		{ "exploded1", ECO_SPARE_NONE }, { "lod12", ECO_SPARE_NONE },
		{ "UCX_tree_00", ECO_SPARE_COLLIDER }, { "Tree_collider/mesh.0", ECO_SPARE_COLLIDER },
		{ "tree-colonly", ECO_SPARE_COLLIDER }, { "Collisions", ECO_SPARE_NONE },
		{ "Tree_Billboard", ECO_SPARE_CARD }, { "", ECO_SPARE_NONE } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		if (eco_model_spare_level(cases[i].name) != cases[i].level)
			fail_msg("%s is %d", cases[i].name, eco_model_spare_level(cases[i].name));
}

/* Squares of sides 4, 3, 2 and 1, each a part of a name. */
static const char *write_parts(const char *const names[4])
{
	char text[2000];
	size_t used = 0;
	for (int i = 0; i < 4; i++) {
		used += (size_t)snprintf(text + used, sizeof text - used, "o %s\n", names[i]);
		used += put_square(text + used, sizeof text - used, 0, 0, 4 - i, 4 * i + 1);
	}
	return input_text("parts", "levels.obj", text);
}

UNIT_TEST(levels_and_colliders_of_games_are_left_out)
{
	static const struct eco_part_rule rule = { .kind = ECO_PART_NAME,
		.name = "*LOD1",
		.is = ECO_ORGAN_FOUND };
	static const struct { const char *names[4]; uint32_t rules, triangles; } cases[] = {
		{ { "UCX_tree", "tree_LOD0", "tree_LOD1", "tree_Billboard" }, 1, 4 },
		{ { "billboard", "trunk", "leaves", "fruit" }, 0, 8 },
		{ { "collider", "collider", "collider", "collider" }, 0, 8 },
		{ { "UCX_tree", "tree_LOD0", "tree_LOD1", "tree_Billboard" }, 0, 2 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		import_file(write_parts(cases[i].names),
			&(struct eco_model_options){ .up = ECO_UP_Y,
				.rules = &rule,
				.rule_count = cases[i].rules });
		assert_int_equal(m.triangle_count, cases[i].triangles);
	}
	assert_int_equal(m.dropped[ECO_DROP_LEFT_OUT], 6);
	assert_string_equal(m.parts[m.part[0]].name, "tree_LOD0");
}

/* A stem with twigs on a sheet of `side`, in a file of its own, y up. */
static const char *write_on_sheet(double side, double level)
{
	char text[1000];
	double s = side / 2;
	snprintf(text, sizeof text, "o plant\nv 0 0 0\nv 0.2 0 0\nv 0 4 0\nv -1 3 -1\nv 1 3 1\nv 0 5 0\n"
		"f 1 2 3\nf 4 5 6\no floor\nv %g %g %g\nv %g %g %g\nv %g %g %g\nv %g %g %g\n"
		"f 7 8 9\nf 7 9 10\n", -s, level, -s, s, level, -s, s, level, s, -s, level, s);
	return input_text("parts", "sheet.obj", text);
}

UNIT_TEST(a_level_sheet_that_it_stands_on_is_left_out)
{
	static const struct eco_part_rule rule = { .kind = ECO_PART_NAME,
		.name = "floor",
		.is = ECO_ORGAN_FOUND };
	static const struct { double side, level; enum eco_up up; uint32_t rules, triangles;
	} cases[] = { { 8, 0, ECO_UP_Y, 0, 2 }, { 8, 0, ECO_UP_Y, 1, 4 }, { 8, 0.4, ECO_UP_Y, 0, 2 },
		{ 8, 0.6, ECO_UP_Y, 0, 4 },
		/* a leaf at the foot, a roof, and a card */
		{ 1, 0, ECO_UP_Y, 0, 4 }, { 8, 5, ECO_UP_Y, 0, 4 }, { 8, 0, ECO_UP_Z, 0, 4 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		import_file(write_on_sheet(cases[i].side, cases[i].level), &(struct eco_model_options){
			.up = cases[i].up, .rules = &rule, .rule_count = cases[i].rules });
		assert_int_equal(m.triangle_count, cases[i].triangles);
		assert_int_equal(m.dropped[ECO_DROP_LEFT_OUT], 4 - cases[i].triangles);
	}
}
