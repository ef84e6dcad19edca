/* Packs that are built apart and linked, and packs that are built again after a change, are those that one
 * full build gives: byte for byte. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/link.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/wire.h"
#include "lod/plan/planner.h"
#include "lod/tint.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

#define PARTS 3u
#define PLANTS 150u
#define MOST 220u

static char cache[300];

struct plant { double x, y; int kind; double scale; };
static struct { struct plant plants[MOST]; uint32_t count; } parts[PARTS];

/* Each model has a colour and a height of its own. */
static const struct model { const char *name; double height; int leaves; uint8_t rgb[3]; } models[] = {
	{ "a", 4, 60, { 40, 120, 30 } },
	{ "b", 1.5, 25, { 190, 170, 20 } },
	{ "c", 2.5, 40, { 180, 20, 60 } } };
#define MODELS (sizeof models / sizeof *models)

static void write_model(const struct model *model)
{
	char name[16], head[40];
	double height = model->height;
	snprintf(name, sizeof name, "%s.mtl", model->name);
	FILE *file = open_text(name);
	fprintf(file, "newmtl m\nKd %f %f %f\n", model->rgb[0] / 255.0, model->rgb[1] / 255.0,
		model->rgb[2] / 255.0);
	assert_int_equal(fclose(file), 0);
	snprintf(name, sizeof name, "%s.obj", model->name);
	snprintf(head, sizeof head, "mtllib %s.mtl\nusemtl m\n", model->name);
	write_shrub(in_root(name), head, height, model->leaves);
}

static uint32_t below(uint64_t *seed, uint32_t count)
{
	uint64_t number = (*seed)++;
	return (uint32_t)(eco_random(77, number) % count);
}

static struct plant random_plant(uint64_t *seed, uint32_t part)
{
	struct plant p;
	p.x = 60.0 * part + below(seed, 6000) / 100.0;
	p.y = below(seed, 6000) / 100.0;
	p.kind = (int)below(seed, 2);
	p.scale = 0.7 + below(seed, 60) / 100.0;
	return p;
}

#define BOTH "\"a\": {\"model\": \"a.obj\", \"unit\": \"m\"}, \"b\": {\"model\": \"b.obj\", \"unit\": \"m\"}"

static void write_part(uint32_t part, const char *plants)
{
	char name[32];
	snprintf(name, sizeof name, "part%u.json", part);
	FILE *file = open_text(name);
	fprintf(file, "{\"name\": \"p\", \"date\": \"%s\", \"tile\": {\"instances\": 16}, \"plants\": {%s}, \"instances\": [",
		strcmp(plants, BOTH) ? "2026-05" : "2024", plants);
	for (uint32_t i = 0; i < parts[part].count; i++) {
		const struct plant *p = &parts[part].plants[i];
		fprintf(file, "%s\n{\"plant\": \"%s\", \"at\": [%.2f, %.2f, %.2f], \"scale\": %.2f}",
			i ? "," : "", p->kind ? "b" : "a", p->x, p->y, 0.1 * p->x + 2 * sin(p->y / 9),
			p->scale);
	}
	fputs("]}\n", file);
	assert_int_equal(fclose(file), 0);
}

static void write_parts(uint64_t seed)
{
	for (uint32_t part = 0; part < PARTS; part++) {
		parts[part].count = PLANTS;
		for (uint32_t i = 0; i < PLANTS; i++)
			parts[part].plants[i] = random_plant(&seed, part);
		write_part(part, BOTH);
	}
	FILE *file = open_text("whole.json");
	fputs("{\"name\": \"linked\", \"date\": \"2024\", \"children\": [", file);
	for (uint32_t part = 0; part < PARTS; part++)
		fprintf(file, "%s{\"eco\": \"part%u.json\", \"at\": [0, 0, 0]}", part ? ", " : "", part);
	fputs("]}\n", file);
	assert_int_equal(fclose(file), 0);
}

static void make(const char *scene, const char *pack, bool cached)
{
	struct eco_error error = { 0 };
	char from[512], to[512];
	snprintf(from, sizeof from, "%s", in_root(scene));
	snprintf(to, sizeof to, "%s", in_root(pack));
	if (make_pack(&(struct make_options){ .scene = from, .pack = to, .jobs = 2,
			.order = LOD_ORDER_STOCHASTIC,
		.cache = cached ? cache : NULL }, &error))
		fail_msg("%s: %s", scene, error.text);
}

static enum eco_code link_parts(const char *pack, struct eco_error *error)
{
	static const char *const names[PARTS] = { "part0.eco", "part1.eco", "part2.eco" };
	const char *paths[PARTS];
	char to[512];
	for (uint32_t i = 0; i < PARTS; i++)
		paths[i] = in_root(names[i]);
	snprintf(to, sizeof to, "%s", in_root(pack));
	return link_packs(&(struct link_options){ .pack = to, .parts = paths, .count = PARTS, .jobs = 2 },
		error);
}

static void make_parts(void)
{
	make("part0.json", "part0.eco", true);
	make("part1.json", "part1.eco", true);
	make("part2.json", "part2.eco", true);
}

static bool same(const char *a, const char *b) { return files_alike(in_root(a), in_root(b)); }

static const uint8_t *color_of_height(double height)
{
	const uint8_t *rgb = NULL;
	for (size_t i = 0; i < MODELS; i++)
		rgb = fabs(models[i].height - height) < 0.3 ? models[i].rgb : rgb;
	assert_non_null(rgb);
	return rgb;
}

/* Points of summaries have the colours of their plants, of a palette of their own. */
static void check_summary(const struct eco_pack *pack, uint32_t list)
{
	const struct eco_scene *s = &pack->scene;
	const struct eco_list *l = &s->lists[list];
	FREED(eco_elements) e = { 0 };
	assert_in_range(l->palette_count, 1, 32);
	assert_good(eco_pack_points(pack, list, &e, &cause));
	for (uint32_t i = 0; i < e.element_count; i++) {
		const int32_t *extra = e.extra + (size_t)e.extra_count * i;
		assert_in_range(extra[0], 0, l->palette_count - 1);
		const uint8_t *rgb = s->palette[l->palette_first + (uint32_t)extra[0]],
			*wanted = color_of_height((double)s->plants[extra[1]].height_m);
		for (int k = 0; k < 3; k++)
			assert_in_range(rgb[k] + 2, wanted[k], wanted[k] + 4);
	}
}

/* Returns the number of palettes that the pack's summaries have. */
static uint32_t check_summaries(const char *name)
{
	struct eco_pack *pack = NULL;
	uint32_t summaries = 0, seen[16], palettes = 0;
	assert_good(eco_pack_open(&pack, in_root(name), &cause));
	for (uint32_t i = 0; i < pack->scene.list_count; i++) {
		if (!(pack->scene.lists[i].attributes & ECO_ATTR_PLANT))
			continue;
		uint32_t first = pack->scene.lists[i].palette_first, k = 0;
		check_summary(pack, i);
		summaries++;
		while (k < palettes && seen[k] != first)
			k++;
		assert_true(k < 16);
		seen[k] = first;
		palettes = k == palettes ? k + 1 : palettes;
	}
	assert_int_equal(summaries, pack->scene.tile_count);
	eco_pack_close(pack);
	return palettes;
}

/* Parts with plants of their own: numbers and colours change, and what is alike is there once. */
UNIT_TEST(parts_keep_plants_of_their_own)
{
	struct eco_error error = { 0 };
	struct eco_pack *pack = NULL;
	struct inspect_counts counts;
	FILE *out = tmpfile();
	write_parts(2);
	write_part(1, "\"b\": {\"model\": \"c.obj\", \"unit\": \"m\"}, \"a\": {\"model\": \"a.obj\", "
		"\"unit\": \"m\"}");
	make_parts();
	if (link_parts("linked.eco", &error) || inspect_verify(in_root("linked.eco"), out, &counts, &error))
		fail_msg("%s", error.text);
	fclose(out);
	assert_int_equal(counts.damaged, 0);
	assert_int_equal(eco_pack_open(&pack, in_root("linked.eco"), NULL), ECO_OK);
	assert_non_null(memmem(pack->meta, pack->meta_size, "\"2024 - 2026-05\"", 16));
	assert_int_equal(pack->scene.plant_count, 3);
	assert_int_equal(pack->scene.tiles[0].instance_count, PARTS * PLANTS);
	eco_pack_close(pack);
	const char *const again[] = { in_root("linked.eco"), in_root("part1.eco") };
	assert_good(link_packs(&(struct link_options){ in_root("again.eco"), again, 2, .jobs = 2 }, &cause));
	assert_good(eco_pack_open(&pack, in_root("again.eco"), &cause));
	assert_non_null(memmem(pack->meta, pack->meta_size, "\"2024 - 2026-05\"", 16));
	eco_pack_close(pack);
	check_summaries("part1.eco");
	check_summaries("linked.eco");
}

/* A part places a file of other plants, turned and scaled, twice: the whole knows it by its summary. */
UNIT_TEST(summaries_of_nested_files_keep_their_colours)
{
	write_parts(10);
	write_part(2, "\"b\": {\"model\": \"c.obj\", \"unit\": \"m\"}, "
		"\"a\": {\"model\": \"b.obj\", \"unit\": \"m\"}");
	rename(in_root("part2.json"), in_root("inner.json"));
	write_text("part2.json", "{\"name\": \"p\", \"plants\": {" BOTH "}, "
		"\"instances\": [{\"plant\": \"a\", \"at\": [1, 2, 0]}], "
		"\"children\": [{\"eco\": \"inner.json\", \"at\": [9, 9, 0], \"yaw_deg\": 90}, "
		"{\"eco\": \"inner.json\", \"at\": [200, 9, 0], \"scale\": 2}]}");
	make_parts();
	make("whole.json", "whole.eco", true);
	assert_good(link_parts("linked.eco", &cause));
	assert_true(check_summaries("whole.eco") <= 5);      /* one for a file at most */
	assert_int_equal(check_summaries("linked.eco"), check_summaries("whole.eco"));
	assert_int_equal(check_summaries("part2.eco"), 2);
}

/* A part's plants as an inventory, a tenth of them in a state that is not stated. */
static void write_tinted(uint32_t part, const char *column, const char *palette)
{
	char name[32];
	snprintf(name, sizeof name, "part%u.csv", part);
	FILE *file = open_text(name);
	fprintf(file, "x,y,%s\n", column);
	for (uint32_t i = 0; i < parts[part].count; i++)
		fprintf(file, "%.2f,%.2f,%s\n", parts[part].plants[i].x, parts[part].plants[i].y, i % 10 == 0 ? "" : i % 3 ? "good"
			: "dead");
	assert_int_equal(fclose(file), 0);
	snprintf(name, sizeof name, "part%u.json", part);
	file = open_text(name);
	fprintf(file, "{\"name\": \"p\", \"date\": \"2024\", \"tile\": {\"instances\": 16}, \"plants\": {" BOTH "}, \"instances\": [{\"from\": \"part%u.csv\", "
		"\"x\": \"x\", \"y\": \"y\", \"plant\": \"a\", \"tint\": {\"column\": \"%s\", \"palette\": %s}}]}", part, column, palette);
	assert_int_equal(fclose(file), 0);
}

/* The mean of a part's summary is that of its plants' colours, each with its tint. */
static void check_mean(const char *name)
{
	static const uint8_t classes[3][3] = { { 0x00, 0x9e, 0x73 }, { 0x4d, 0x4d, 0x4d }, { 0xc8, 0xc8, 0xc8 } };
	static const double shares[3] = { 0.6, 0.3, 0.1 };
	struct eco_pack *pack = NULL;
	FREED(eco_elements) e = { 0 };
	double mean[3] = { 0 }, wanted[3] = { 0 };
	assert_good(eco_pack_open(&pack, in_root(name), &cause));
	const struct eco_scene *s = &pack->scene;
	uint32_t list = s->tiles[s->root].summary;
	assert_good(eco_pack_points(pack, list, &e, &cause));
	for (uint32_t c = 0; c < 3; c++) {
		uint8_t rgb[3];
		memcpy(rgb, models[0].rgb, sizeof rgb);
		lod_tint_apply(lod_tint_word(classes[c]), NULL, models[0].rgb, rgb);
		for (int k = 0; k < 3; k++)
			wanted[k] += shares[c] * rgb[k];
	}
	for (uint32_t i = 0; i < e.element_count; i++)
		for (int k = 0; k < 3; k++)
			mean[k] += s->palette[s->lists[list].palette_first + (uint32_t)e.extra[3 * (size_t)i]][k] / (double)e.element_count;
	print_message("summary: %.1f %.1f %.1f, its plants: %.1f %.1f %.1f\n", mean[0], mean[1], mean[2], wanted[0], wanted[1],
		wanted[2]);
	for (int k = 0; k < 3; k++)
		assert_true(fabs(mean[k] - wanted[k]) < 6);
	eco_pack_close(pack);
}

UNIT_TEST(parts_with_tints_equal_the_whole)
{
	write_parts(5);
	write_tinted(0, "health", "\"health\"");
	write_tinted(2, "state", "{\"good\": \"#102030\", \"dead\": null}");
	make_parts();
	check_mean("part0.eco");
	make("whole.json", "whole.eco", true);
	assert_good(link_parts("linked.eco", &cause));
	assert_true(same("linked.eco", "whole.eco"));
}

/* ---- Impostors ---- */

UNIT_TEST(parts_of_other_frames_are_refused)
{
	struct eco_error error = { 0 };
	write_parts(3);
	make_parts();
	FILE *file = open_text("utm.json");
	fputs("{\"crs\": \"EPSG:32632\", \"origin\": [691000, 5334000, 0], \"plants\": {" BOTH
		"}, \"instances\": [{\"plant\": \"a\", \"at\": [0, 0, "
		"0]}]}", file);
	assert_int_equal(fclose(file), 0);
	make("utm.json", "part2.eco", true);
	unlink(in_root("linked.eco"));
	assert_int_equal(link_parts("linked.eco", &error), ECO_BAD_INPUT);
	assert_non_null(strstr(error.text, "part2.eco is in EPSG:32632"));
	unlink(in_root("part2.eco"));
	error = (struct eco_error){ 0 };
	assert_int_not_equal(link_parts("linked.eco", &error), ECO_OK);
	assert_int_not_equal(access(in_root("linked.eco"), F_OK), 0);
}

static void edit(uint64_t *seed)
{
	uint32_t part = below(seed, PARTS), at = below(seed, parts[part].count);
	struct plant *p = &parts[part].plants[at];
	switch (below(seed, 4)) {
	case 0:
		*p = parts[part].plants[--parts[part].count];
		break;
	case 1:
		if (parts[part].count < MOST)
			parts[part].plants[parts[part].count++] = random_plant(seed, part);
		break;
	case 2:
		p->x += below(seed, 100) / 50.0 - 1;
		break;
	default:
		p->kind = !p->kind;
	}
	write_part(part, BOTH);
}

/* ECO_EDITS in the environment: how many. */
UNIT_TEST(edited_parts_that_are_linked_equal_the_whole)
{
	const char *wanted = getenv("ECO_EDITS");
	int edits = wanted ? atoi(wanted) : 4;
	uint64_t seed = 4;
	write_parts(5);
	for (int i = 0; i < edits; i++) {
		edit(&seed);
		make("whole.json", "whole.eco", i % 16 != 0);
		make_parts();
		assert_good(link_parts("linked.eco", &cause));
		if (!same("linked.eco", "whole.eco"))
			fail_msg("edit %d: parts that are linked are not the whole", i);
	}
}

/* Flips bytes of the payloads: what lies behind the tables, in the last quarter of the file. */
static void damage(const char *name)
{
	size_t size;
	FREED_MEMORY char *bytes = read_all(name, &size);
	for (size_t i = size - size / 4; i < size; i += 97)
		bytes[i] = (char)~bytes[i];
	FILE *file = open_text(name);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

UNIT_TEST(a_damaged_part_is_named)
{
	write_parts(8);
	make_parts();
	damage("part1.eco");
	unlink(in_root("linked.eco"));
	assert_code(link_parts("linked.eco", &cause), ECO_DAMAGED, "part1.eco: chunk ");
	assert_int_not_equal(access(in_root("linked.eco"), F_OK), 0);
	unlink(in_root("part1.eco"));
}

/* A pack may be right by its tables and yet not be one that ecopack made. */
UNIT_TEST(summaries_of_others_are_refused)
{
	struct eco_pack *pack;
	struct eco_pack_writer *writer;
	FREED_MEMORY char *meta;
	write_parts(9);
	make_parts();
	assert_int_equal(eco_pack_open(&pack, in_root("part1.eco"), NULL), ECO_OK);
	assert_int_equal(eco_pack_create(&writer, in_root("part1.eco"), NULL), ECO_OK);
	for (uint32_t i = 0, id; i < pack->scene.list_count; i++) {
		struct eco_list list = pack->scene.lists[i];
		if (list.attributes & ECO_ATTR_PLANT)
			list.coder = ECO_CODER_ROWS;
		assert_int_equal(eco_pack_add_copied(writer, &list, pack, i, &id, NULL), ECO_OK);
		assert_int_equal(id, i);
	}
	meta = strndup((const char *)pack->meta, pack->meta_size);
	assert_good(eco_pack_commit(writer, &pack->scene, meta, &cause));
	assert_code(link_parts("linked.eco", &cause), ECO_UNSUPPORTED, "part1.eco: list ");
	eco_pack_close(pack);
	unlink(in_root("part1.eco"));
}

static int set_up(void **state)
{
	scratch_open("link");
	snprintf(cache, sizeof cache, "%s/cache", scratch_root);
	eco_progress_quiet(true);
	for (size_t i = 0; i < MODELS; i++)
		write_model(&models[i]);
	return 0;
}

UNIT_MAIN(set_up, scratch_close)
