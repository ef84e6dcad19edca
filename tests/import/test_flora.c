/* Names of plants: genera, common names, codes, forms, leaves. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/places/growth.h"
#include "tests/support/cases.h"
#include "tests/support/unit_test.h"

static struct eco_flora spelt(const char *name)
{
	return eco_flora_of(name, &(struct eco_flora_hint){ .spelling = true });
}

static void check(const char *name, const struct eco_flora *flora, const char *wanted, enum eco_form form)
{
	const char *genus = flora->genus ? flora->genus : "?";
	if (strcmp(genus, wanted ? wanted : "?") != 0 || flora->form != form)
		fail_msg("%s is %s, %s, not %s, %s", name, genus, eco_form_names[flora->form], wanted,
			eco_form_names[form]);
}

static enum eco_form form_of(const char *name)
{
	int form = 0;
	while (form < ECO_FORM_COUNT && strcmp(eco_form_names[form], name) != 0)
		form++;
	assert_int_not_equal(form, ECO_FORM_COUNT);
	return (enum eco_form)form;
}

UNIT_TEST(genera_and_forms_are_known_in_several_languages)
{
	struct species_case { const char *name, *genus, *form; };
	uint32_t count;
	const struct species_case *names = cases_read("tests/import/cases/species.tsv", sizeof *names, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_flora flora = spelt(names[i].name);
		check(names[i].name, &flora, names[i].genus, form_of(names[i].form));
		assert_string_equal(flora.misspelt, "");
	}
}

UNIT_TEST(the_noun_of_a_name_decides)
{
	uint32_t count;
	const char *const (*names)[2] = cases_read("tests/import/cases/nouns.tsv", sizeof *names, &count);
	for (size_t i = 0; i < count; i++) {
		struct eco_flora flora = eco_flora_of(names[i][0], NULL);
		if (!flora.genus || strcmp(flora.genus, names[i][1]) != 0)
			fail_msg("%s is %s, not %s", names[i][0], flora.genus ? flora.genus : "?", names[i][1]);
	}
}

UNIT_TEST(a_region_has_its_own_names)
{
	static const struct { const char *name; enum eco_region region; const char *genus; } names[] = {
		{ "Sycamore", ECO_REGION_AMERICA, "platanus" }, { "Sycamore", ECO_REGION_EUROPE, "acer" },
		{ "Cedar", ECO_REGION_AMERICA, "juniperus" }, { "Cedar", ECO_REGION_EUROPE, "cedrus" },
		{ "Alpine ash", ECO_REGION_OCEANIA, "eucalyptus" }, { "Lime", ECO_REGION_EUROPE, "tilia" },
		{ "Lime", ECO_REGION_AMERICA, "citrus" } };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct eco_flora flora = eco_flora_of(names[i].name,
			&(struct eco_flora_hint){ .region = names[i].region });
		if (!flora.genus || strcmp(flora.genus, names[i].genus) != 0)
			fail_msg("%s is %s, not %s", names[i].name, flora.genus ? flora.genus : "?", names[i].genus);
	}
	assert_int_equal(eco_region_of(-97.1, 33.2), ECO_REGION_AMERICA);
	assert_int_equal(eco_region_of(16.4, 48.2), ECO_REGION_EUROPE);
	assert_int_equal(eco_region_of(139.7, 35.7), ECO_REGION_ASIA);
	assert_int_equal(eco_region_of(144.9, -37.8), ECO_REGION_OCEANIA);
	assert_int_equal(eco_region_of(18.4, -33.9), ECO_REGION_AFRICA);
}

UNIT_TEST(species_and_cultivars_grow_in_their_own_way)
{
	struct growth_case { const char *name, *form, *leaf; };
	uint32_t count;
	const struct growth_case *names = cases_read("tests/import/cases/growth.tsv", sizeof *names, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_flora flora = eco_flora_of(names[i].name, NULL);
		if (flora.form != form_of(names[i].form)
			|| flora.leaf != (*names[i].leaf == 'e' ? ECO_LEAF_EVERGREEN : ECO_LEAF_DECIDUOUS))
			fail_msg("%s is a %s, leaves %d", names[i].name, eco_form_names[flora.form], flora.leaf);
		assert_true(flora.height_m > 0);
	}
}

UNIT_TEST(codes_of_first_letters_are_known_where_a_column_has_them)
{
	static const char *const codes[][2] = { { "piab", "picea abies" }, { "FASY", "fagus sylvatica" },
		{ "quru", "quercus rubra" }, { "QUEROB", "quercus robur" }, { "litu", "liriodendron tulipifera" },
		{ "QUMA2", "quercus macrocarpa" }, { "PINNIGnig", "pinus nigra" }, { "ACE", "acer" }, { "MALPEReve", "malus perpetu" } };
	const struct eco_flora_hint letters = { .codes = "letters" };
	for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
		struct eco_flora flora = eco_flora_of(codes[i][0], &letters);
		assert_string_equal(flora.coded, codes[i][1]);
		assert_true(flora.genus && strncmp(flora.genus, codes[i][1], strlen(flora.genus)) == 0);
		assert_true(eco_form_is_tree(flora.form));
		assert_null(spelt(codes[i][0]).genus);
	}
	assert_null(eco_flora_of("quxy", &letters).genus);
	assert_null(spelt("alba").genus);                 /* Aloidendron barberae in a column of codes alone */
}

UNIT_TEST(systems_of_codes_are_read_where_a_column_uses_them)
{
	static const char *const codes[][3] = { { "cz", "SM", "picea" }, { "cz", "DBZ", "quercus" },
		{ "de", "RBu", "fagus" }, { "ch", "Fi", "picea" }, { "at", "L\u00e4", "larix" },
		{ "fr", "P.S", "pinus" }, { "fr number", "09", "fagus" }, { "de number", "20", "pinus" },
		{ "plants", "ACSA3", "acer" }, { "plants", "QUMA2", "quercus" }, { "fia", "316", "acer" } };
	for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
		struct eco_flora flora = eco_flora_of(codes[i][1], &(struct eco_flora_hint){ .codes = codes[i][0] });
		if (!flora.genus || strcmp(flora.genus, codes[i][2]) != 0)
			fail_msg("%s %s is %s", codes[i][0], codes[i][1], flora.genus ? flora.genus : "?");
		assert_true(eco_flora_has_code(codes[i][0], codes[i][1]));
	}
	assert_false(eco_flora_has_code("cz", "XYZ"));
}

UNIT_TEST(misspellings_are_told_and_only_where_asked_for)
{
	struct eco_flora flora = spelt("Qercus robur");
	assert_string_equal(flora.genus, "quercus");
	assert_string_equal(flora.misspelt, "qercus");
	assert_null(eco_flora_of("Qercus robur", NULL).genus);
	assert_null(spelt("Xyzzy plugh").genus);
	assert_string_equal(spelt("Pseudotsgua menziesii").genus, "pseudotsuga");
	assert_string_equal(spelt("Norway mapel").genus, "acer");
	assert_null(spelt("Pirus alba").genus);           /* Pinus has no such species, nor has Pyrus */
	assert_string_equal(spelt("Pinus sp.").genus, "pinus");
	assert_string_equal(spelt("Handroathus vellosoi").genus, "handroanthus");
	assert_string_equal(spelt("Chrysaldocarpus lutescens").genus, "chrysalidocarpus");
	assert_string_equal(spelt("Querqus").genus, "quercus");
	assert_string_equal(spelt("Tabebuja rosea").genus, "tabebuia");
	assert_string_equal(spelt("Acer platanodes").epithet, "platanoides");
	assert_string_equal(spelt("Acer platanodes").misspelt, "platanodes");
	assert_string_equal(eco_flora_of("Acer platanodes", NULL).epithet, "platanodes");
	assert_string_equal(spelt("Crataegus uriflora").epithet, "uriflora"); /* triflora or uniflora */
	assert_null(spelt("morta").genus);                /* nearly a Polish mulberry */
}

/* ---- Sizes of plants from others of theirs ---- */

/* As the published equations give at these trunks, within what lines between the table's places lose. */
UNIT_TEST(curves_are_those_that_were_published)
{
	static const struct { const char *name; bool stand; double cm, height_m, crown_m; unsigned rank; } cases[] = {
		{ "Fagus sylvatica", false, 40, 16.72, 11.81, 0 },       /* UTD, Pacific Northwest, and Hasenauer */
		{ "Quercus alba", true, 25.4, 19.2, 6.45, 0 },            /* FVS SN, Bechtold 2003 */
		{ "Fagus sylvatica", true, 50, 35.7, 9.6, 0 },            /* SILVA, TreeGrOSS */
		{ "Picea abies", false, 30, 8.9, 6.47, 1 } };            /* the genus's; Hasenauer */
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_flora flora = eco_flora_of(cases[i].name, NULL);
		struct eco_grower plant = { &flora, cases[i].stand };
		double height = eco_growth_height(plant, cases[i].cm / 100), crown = eco_growth_crown(plant, NAN, cases[i].cm / 100);
		if (fabs(height / cases[i].height_m - 1) > 0.03 || fabs(crown / cases[i].crown_m - 1) > 0.1
				|| eco_growth_rank(plant) != cases[i].rank)
			fail_msg("%s: %.2f m high, %.2f m wide, rank %u", cases[i].name, height, crown, eco_growth_rank(plant));
	}
}

UNIT_TEST(a_felling_that_is_planned_leaves_its_tree)
{
	static const struct { const char *text; bool any, whole; } cases[] = { { "geplant", true, true }, { "Planned", true, true },
		{ "F\u00e4llung geplant", false, false }, { "planned removal", false, false }, { "Retirada de ramas", false, false },
		{ "Pflanzung geplant", true, true }, { "Stubben", true, true }, { "Stubben daneben entfernt", true, false },
		{ "boom in bos", false, false }, { "", false, false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		if (eco_flora_is_no_plant(cases[i].text, false) != cases[i].any || eco_flora_is_no_plant(cases[i].text, true) != cases[i].whole)
			fail_msg("\"%s\"", cases[i].text);
	assert_string_equal(eco_flora_of("Gewone es bos", NULL).genus, "fraxinus");
	assert_int_equal(eco_flora_of("Gewone es bos", NULL).form, ECO_FORM_BROAD);
}

UNIT_TEST(plants_grow_and_end_where_their_like_end)
{
	static const char *const names[] = { "Quercus robur", "Abies alba", "Prunus laurocerasus", "Malus", "Phoenix",
		"Acer platanoides 'Globosum'", "Salix babylonica", "Populus nigra 'Italica'", "Hosta", "xyzzy" };
	for (size_t i = 0; i < 2 * sizeof names / sizeof *names; i++) {
		struct eco_flora flora = eco_flora_of(names[i / 2], NULL);
		struct eco_grower plant = { i / 2 + 1 < sizeof names / sizeof *names ? &flora : NULL, i % 2 };
		double last[3] = { 0, 0, 0 };
		for (double by = 0; by <= 2; by += 0.01) {
			double size[3] = { eco_growth_height(plant, by), eco_growth_height_at(plant, 100 * by),
				eco_growth_crown(plant, NAN, by) };
			for (int k = 0; k < 3; k++) {
				assert_true(size[k] >= last[k] && size[k] < 80);
				last[k] = size[k];
			}
			/* a plant of that height is as wide as one of the trunk that gives it, where the curve still rises */
			if (eco_growth_height(plant, by + 0.001) > size[0])
				assert_true(fabs(eco_growth_crown(plant, size[0], NAN) - size[2]) < 1e-6);
		}
		assert_true(last[0] < 2.5 * fmax(flora.height_m, 25));
	}
	struct eco_flora tree = eco_flora_of("Acer platanoides", NULL), globe = eco_flora_of("Acer platanoides 'Globosum'", NULL),
		column = eco_flora_of("Quercus robur 'Fastigiata'", NULL);
	assert_true(eco_growth_height((struct eco_grower){ &globe, false }, 0.4)
		< 0.6 * eco_growth_height((struct eco_grower){ &tree, false }, 0.4));
	assert_true(eco_growth_crown((struct eco_grower){ &column, false }, 20, NAN) < 6);
}
