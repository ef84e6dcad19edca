/* Inventories as scenes ask for them: coordinates, species, filters, sizes, and what is said of rows that
 * cannot be used or were guessed at. Formats are tested in test_rows*.c, texts in test_words.c. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/scene/scene.h"
#include "tests/support/cases.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

#define UTM32 "\"crs\":\"EPSG:25832\",\"origin\":[690000,5335000,0],"
#define XY "\"x\":\"x\",\"y\":\"y\""

/* species: what each plant's row states; "": none, "-": no column does. */
struct inventory { char plants[8000], species[8000], report[8000], error[1024]; };

static void inventory_say(void *ctx, const char *text)
{
	struct inventory *in = ctx;
	size_t used = strlen(in->report);
	snprintf(in->report + used, sizeof in->report - used, "%s\n", text);
}

static void inventory_put(struct inventory *in, const struct eco_source *source, const struct eco_position *p)
{
	size_t used = strlen(in->plants), size = sizeof in->plants;
#define INVENTORY_PUT(...) (used += used < size ? (size_t)snprintf(in->plants + used, size - used, \
	__VA_ARGS__) : 0)
	INVENTORY_PUT("%s%s %.9g %.9g", used > 0 ? " / " : "", source->plants[p->plant].name, p->at[0],
		p->at[1]);
	if (p->absolute)
		INVENTORY_PUT(" z%.9g", p->at[2]);
	if (!isnan(p->height_m))
		INVENTORY_PUT(" h%.9g", p->height_m);
	if (!isnan(p->crown_radius_m))
		INVENTORY_PUT(" c%.9g", p->crown_radius_m);
	if (p->scale != 1)
		INVENTORY_PUT(" s%.9g", p->scale);
#undef INVENTORY_PUT
	used = strlen(in->species);
	snprintf(in->species + used, sizeof in->species - used, "%s%s", used > 0 ? " / " : "",
		p->species ? p->species : "-");
}

static enum eco_code inventory_read_rows(struct inventory *in, const struct eco_source *source,
	struct eco_error *error)
{
	struct eco_frame frame = { .crs = source->crs, .vertical = source->vertical,
		.origin = { source->origin[0], source->origin[1], source->origin[2] } };
	struct eco_positions *reader;
	struct eco_position record;
	enum eco_code code = eco_positions_open(&reader, &source->positions[0], &frame, error);
	if (code)
		return code;
	while ((code = eco_positions_next(reader, &record, error)) == ECO_OK && record.plant != ECO_NONE)
		inventory_put(in, source, &record);
	if (!code)
		eco_positions_report(reader, inventory_say, in);
	eco_positions_close(reader);
	return code;
}

/* `scene`: its fields before "plants", each with its comma; `entry`: fields of the entry, after "from".
 * Plants are oak, ash and elm; elm has three variants. The message of a failure is in `error`, which is empty
 * otherwise. */
static const struct inventory *inventory_of(const char *test, const char *scene, const char *file, const char *entry)
{
	static struct inventory in;
	struct eco_error error = { .code = ECO_OK };
	struct eco_source source;
	char json[6000], path[600];
	in = (struct inventory){ .plants = "" };
	snprintf(path, sizeof path, "%s", input_path(test, "scene.json"));
	snprintf(json, sizeof json, "{%s\"plants\":{\"oak\":{\"model\":\"m.obj\"},"
		"\"ash\":{\"model\":\"m.obj\"},\"elm\":{\"variants\":[\"a.obj\","
		"\"b.obj\",\"c.obj\"]}},\"instances\":[{\"from\":\"%s\"%s%s}]}", scene, file,
		*entry != 0 ? "," : "", entry);
	if (eco_source_parse(&source, json, strlen(json), path, false, &error) == ECO_OK) {
		inventory_read_rows(&in, &source, &error);
		eco_source_free(&source);
	}
	snprintf(in.error, sizeof in.error, "%s", error.text);
	return &in;
}

/* The report must hold each of `says`, parted by "|". */
static void check_report(const struct inventory *in, const char *says)
{
	char all[1000], *rest = all;
	snprintf(all, sizeof all, "%s", says);
	for (const char *one; (one = strsep(&rest, "|"));)
		if (!strstr(in->report, one))
			fail_msg("%s\n  wanted ... %s", in->report, one);
}

/* Fields of an entry in single quotes. Each has a plant, if no species, and x and y, if it is of a CSV and
 * does not name its own or begin with "-". */
static const char *entry_of(const char *fields, bool csv)
{
	static char entry[1000];
	bool bare = *fields == '-', placed = bare || !csv || strstr(fields, "'x':");
	fields += bare;
	int used = snprintf(entry, sizeof entry, "%s%s", strstr(fields, "'species':") || strstr(fields, "'plant':") ? ""
		: *fields || !placed ? "'plant':'oak'," : "'plant':'oak'", fields);
	if (!placed)
		snprintf(entry + used, sizeof entry - (size_t)used, "%s'x':'x','y':'y'", *fields ? "," : "");
	for (char *c = entry; *c; c++)
		*c = *c == '\'' ? '"' : *c;
	return entry;
}

struct inventory_case { const char *name, *scene, *text, *entry, *plants, *says; };

static void check(const char *name, const char *scene, const char *text, const char *entry, const char *plants,
	const char *says)
{
	bool csv = text[0] != '{';
	const char *file = csv ? "rows.csv" : "rows.geojson";
	input_text("positions", file, text);
	const struct inventory *in = inventory_of("positions", scene, file, entry_of(entry, csv));
	if (plants ? in->error[0] != 0 || strcmp(in->plants, plants) != 0 : !strstr(in->error, says))
		fail_msg("%s: %s: %s%s\n  wanted %s", name, text, in->error, in->plants, plants ? plants : says);
	if (plants)
		check_report(in, says);
}

UNIT_TEST(inventories_become_plants_or_questions)
{
	const char *name = NULL;
	uint32_t count;
	const struct inventory_case *cases = cases_read("tests/import/cases/positions.tsv", sizeof *cases, &count);
	for (uint32_t i = 0; i < count; i++) {
		name = cases[i].name ? cases[i].name : name;
		check(name, cases[i].scene, cases[i].text, cases[i].entry, cases[i].plants, cases[i].says);
	}
}

static void expect_species(const char *file, const char *text, const char *entry, const char *species)
{
	input_text("positions", file, text);
	const struct inventory *in = inventory_of("positions", UTM32, file, entry);
	assert_string_equal(in->error, "");
	assert_string_equal(in->species, species);
}

/* As the file has it, whatever the map leads it to; what nobody could read, or would rather not, is not there. */
UNIT_TEST(a_row_says_its_own_species)
{
	static const char mapped[] = "\"species\":\"s\",\"map\":{\"oak\":\"oak\",\"*\":\"elm\"},\"crs\":"
		"\"EPSG:25832\"," XY;
	char csv[700], long_name[256], want[600];
	expect_species("rows.csv", "s,x,y\n OAK ,1,1\ncards-3,2,1\n,3,1\nn/a,4,1\n?,5,1\n", mapped,
		"OAK / cards-3 /  /  / ");
	expect_species("rows.csv", "s,x,y\noak,1,1\n", "\"plant\":\"oak\",\"crs\":\"EPSG:25832\"," XY, "-");
	expect_species("rows.csv", "s,x,y\n\"a\tb\x01\x7f\nc\xc2\x85\",1,1\n\"\x02\",2,1\nB\xe4um,3,1\n", mapped,
		"a b   c   /  / B\xc3\xa4um");
	snprintf(long_name, sizeof long_name, "%0253d", 0);
	snprintf(csv, sizeof csv, "s,x,y\n%s\xc3\xa9t\xc3\xa9,1,1\n%sx\xe2\x82\xac,2,1\n", long_name, long_name);
	snprintf(want, sizeof want, "%s\xc3\xa9 / %sx", long_name, long_name);
	expect_species("rows.csv", csv, mapped, want);
	expect_species("rows.geojson", "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\","
		"\"properties\":{\"s\":\"a\xff\u202e\"},\"geometry\":{\"type\":\"Point\",\"coordinates\":[11.5,48.1]}},"
		"{\"type\":\"Feature\",\"properties\":{\"s\":null},\"geometry\":{\"type\":\"Point\","
		"\"coordinates\":[11.5,48.2]}}]}", "\"species\":\"s\",\"map\":{\"*\":\"elm\"}", "a?    / ");
}

UNIT_TEST(the_commonest_unknown_species_are_named)
{
	char csv[8000] = "s,x,y\n";
	size_t used = strlen(csv);
	for (int kind = 0; kind < 8; kind++)
		for (int i = 0; i <= kind; i++)
			used += (size_t)snprintf(csv + used, sizeof csv - used, "kind %d,%d,%d\n", kind, kind,
				i);
	check("unknown", "", csv, "'species':'s'", "", "36  left out: 8 species|of these 8: \"kind 7\"|of these 7: "
		"\"kind 6\"|of these 4: \"kind 3\"");
	assert_null(strstr(inventory_of("positions", "", "rows.csv", "\"species\":\"s\"," XY)->report,
		"kind 2\"\n"));
}

UNIT_TEST(levels_keep_the_tall_few_and_the_relative_error)
{
	char csv[20000] = "x,y,h\n", *at;
	double seen[64];
	uint32_t count = 0, rows = 0;
	size_t used = strlen(csv);
	const struct inventory *in;
	for (int i = 0; i < 300; i++)        /* many of 2 to 4 m, one in fifty of 20 to 32 m */
		used += (size_t)snprintf(csv + used, sizeof csv - used, "%d,1,%.2f\n", i,
			i % 50 == 0 ? 20 + i * 0.04 : 2 + (i * 7 % 200) * 0.01);
	input_text("positions", "rows.csv", csv);
	in = inventory_of("positions", "", "rows.csv", "\"plant\":\"oak\",\"levels\":6,"
		"\"height_m\":{\"column\":\"h\"}," XY);
	assert_string_equal(in->error, "");
	for (at = strstr(in->plants, " h"); at; at = strstr(at + 1, " h")) {
		int i = (int)rows++;
		double exact = i % 50 == 0 ? 20 + i * 0.04 : 2 + (i * 7 % 200) * 0.01,
			got = strtod(at + 2, NULL);
		uint32_t k = 0;
		assert_true(fabs(got / exact - 1) < 0.5);    /* one class spans 16^(1/6) = 1.59 */
		while (k < count && seen[k] != got)
			k++;
		if (k == count)
			seen[count++] = got;
	}
	assert_int_equal(rows, 300);
	assert_in_range(count, 3, 6);
	assert_non_null(strstr(in->report, "300 rows, 300 plants"));        /* though it was read twice */
}

static struct eco_positions *open_plain(struct eco_positions_spec *spec, const char *csv, uint64_t seed,
	const char *yaw)
{
	static const struct eco_frame plain;
	struct eco_positions *reader;
	*spec = (struct eco_positions_spec){ .path = (char *)input_text("positions", "turns.csv", csv),
		.x = (char *)"x", .y = (char *)"y",
		.fallback = { (char *)"*", 0, 3 }, .seed = seed, .yaw_deg = (char *)yaw };
	assert_int_equal(eco_positions_open(&reader, spec, &plain, NULL), ECO_OK);
	return reader;
}

UNIT_TEST(a_variant_is_the_seeds_and_the_rows_alone)
{
	static const char csv[] = "x,y,r\n1,1,90\n2,2,\n3,bad,\n4,4,\n";
	uint32_t first[3], again[3], other[3], *into[] = { first, again, other };
	struct eco_positions_spec spec;
	struct eco_positions *reader;
	struct eco_position record;
	for (int pass = 0; pass < 3; pass++) {
		reader = open_plain(&spec, csv, pass == 2 ? 8 : 7, NULL);
		for (int i = 0; i < 3; i++) {
			assert_int_equal(eco_positions_next(reader, &record, NULL), ECO_OK);
			assert_in_range(record.plant, 0, 2);
			assert_true(isnan(record.yaw_deg));
			into[pass][i] = record.plant;
		}
		eco_positions_close(reader);
	}
	assert_memory_equal(first, again, sizeof first);
	assert_memory_not_equal(first, other, sizeof first);
	reader = open_plain(&spec, csv, 7, "r");
	assert_int_equal(eco_positions_next(reader, &record, NULL), ECO_OK);
	assert_true(record.yaw_deg == 90);
	assert_int_equal(eco_positions_next(reader, &record, NULL), ECO_OK);
	assert_true(isnan(record.yaw_deg));
	eco_positions_close(reader);
}
