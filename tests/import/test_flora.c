/* Names of plants and of columns: words, genera, forms, misspellings. */
#include <string.h>

#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"
#include "tests/support/unit_test.h"

UNIT_TEST(names_become_words)
{
	static const char *const pairs[][2] = { { "H\u00f6he (m)", "hohe m" }, { "HOEHE_M", "hoehe m" },
		{ "decimalLatitude", "decimal latitude" },
		{ "utm17n_e", "utm 17 n e" },
		{ "\u00c9pic\u00e9a", "epicea" }, { "sapling_oak_s7.obj", "sapling oak s 7 obj" },
		{ "CommonTree_1", "common tree 1" }, { "Stra\u00dfe", "strase" },
		{ "\u0160\u0164\u0158\u0142\u0153", "strlo" }, { "\u4e2d x", "\u4e2d x" }, { "  ", "" },
		{ "20\u00a0m\u00b2", "20 m" }, { "Высота, м", "высота м" }, { "ЁЛКАКрона2", "елкакрона 2" } };
	char words[ECO_WORDS_BYTES];
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		assert_int_equal(eco_words_of(pairs[i][0], words, sizeof words), strlen(pairs[i][1]));
		assert_string_equal(words, pairs[i][1]);
	}
	for (size_t size = 1; size < 20; size++)             /* cut anywhere */
		assert_true(eco_words_of("abc d\u00e9fg 12 hij", words, size) < size);
}

UNIT_TEST(genera_and_forms_are_known_in_several_languages)
{
	static const struct { const char *name, *genus; enum eco_form form;
	} names[] = { { "Quercus robur", "quercus", ECO_FORM_BROAD },
		{ "Stieleiche", "quercus", ECO_FORM_BROAD },
		{ "ch\u00eane p\u00e9doncul\u00e9", "quercus", ECO_FORM_BROAD },
		{ "oak, pin (Quercus palustris)", "quercus", ECO_FORM_BROAD },
		{ "d\u0105b szypu\u0142kowy", "quercus", ECO_FORM_BROAD },
		{ "sosna zwyczajna", "pinus", ECO_FORM_CONIFER }, { "b\u0159\u00edza", "betula", ECO_FORM_BROAD },
		{ "salgueiro", "salix", ECO_FORM_WEEPING }, { "lind", "tilia", ECO_FORM_BROAD },
		{ "Laburnum anagyroides", "laburnum", ECO_FORM_BROAD },  /* nearly Viburnum, and none */
		{ "Берёза повислая", "betula", ECO_FORM_BROAD },
		{ "СЛИВА", "prunus", ECO_FORM_BROAD },       /* ends as a willow does, which is too short */
		{ "maples", "acer", ECO_FORM_BROAD }, { "Rotfichte", "picea", ECO_FORM_CONIFER },
		{ "Populus nigra 'Italica' fastigiata", "populus", ECO_FORM_COLUMN },
		{ "Betula pendula", "betula", ECO_FORM_WEEPING }, { "palmera", "phoenix", ECO_FORM_PALM },
		{ "CommonTree_1", NULL, ECO_FORM_BROAD }, { "Bush_1", NULL, ECO_FORM_SHRUB },
		{ "Rock_2", NULL, ECO_FORM_NOTHING },
		{ "Vacant site small (vacant site small)", NULL, ECO_FORM_NOTHING },
		{ "Pinus pinea :: Italian Stone Pine", "pinus", ECO_FORM_CONIFER },
		{ "Rock elm", "ulmus", ECO_FORM_BROAD }, { "Oak (removed)", "quercus", ECO_FORM_NOTHING },
		{ "Tabebuia rosea", NULL, ECO_FORM_UNKNOWN },        /* nearly a rose, and none */
		{ "Terminalia catappa L.", NULL, ECO_FORM_UNKNOWN },
		{ "Thespesia populnea (L.) Sol. ex Correa", NULL, ECO_FORM_UNKNOWN },
		{ "Stump", NULL, ECO_FORM_NOTHING }, { "thing", NULL, ECO_FORM_UNKNOWN },
		{ "", NULL, ECO_FORM_UNKNOWN } };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct eco_flora flora = eco_flora_of(names[i].name, true);
		const char *genus = flora.genus ? flora.genus : "?";
		if (strcmp(genus, names[i].genus ? names[i].genus : "?") != 0 || flora.form != names[i].form)
			fail_msg("%s is %s, %s", names[i].name, genus, eco_form_names[flora.form]);
		assert_string_equal(flora.misspelt, "");
	}
}

UNIT_TEST(codes_are_known_where_spelling_is_asked_for)
{
	static const char *const codes[][2] = { { "piab", "picea abies" }, { "FASY", "fagus sylvatica" },
		{ "quru", "quercus rubra" }, { "QUEROB", "quercus robur" }, { "litu", "liriodendron tulipifera" } };
	for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
		struct eco_flora flora = eco_flora_of(codes[i][0], true);
		assert_string_equal(flora.coded, codes[i][1]);
		assert_true(flora.genus && strncmp(flora.genus, codes[i][1], strlen(flora.genus)) == 0);
		assert_true(eco_form_is_tree(flora.form));
		assert_null(eco_flora_of(codes[i][0], false).genus);
	}
	assert_string_equal(eco_flora_of("pine", true).coded, "");     /* a word, though pinus nes... */
	assert_null(eco_flora_of("quxy", true).genus);
}

UNIT_TEST(misspellings_are_told_and_only_where_asked_for)
{
	struct eco_flora flora = eco_flora_of("Qercus robur", true);
	assert_string_equal(flora.genus, "quercus");
	assert_string_equal(flora.misspelt, "qercus");
	assert_null(eco_flora_of("Qercus robur", false).genus);
	assert_null(eco_flora_of("Xyzzy plugh", true).genus);
	assert_string_equal(eco_flora_of("Pseudotsgua menziesii", true).genus, "pseudotsuga");
	assert_string_equal(eco_flora_of("Norway mapel", true).genus, "acer");
}
