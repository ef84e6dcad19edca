/* The inventory rows of plants, as the server gives them. */
#include <string.h>

#include "server/exchange.h"
#include "server/request/json.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/serve/serve_daemon.h"

#define LIST(number) BASE "/plants/" number

static uint32_t instance_list(const struct eco_scene *s)
{
	uint32_t list = 0;
	while (s->lists[list].kind != ECO_LIST_INSTANCES)
		list++;
	return list;
}

/* The small pack in a store of its own; `spoil`: its last byte, which is of its rows, is another. */
static void open_small(struct srv_store *other, char path[64], bool spoil)
{
	struct scene_builder b;
	size_t size;
	snprintf(path, 64, "build/tmp/plants-%d.eco", (int)getpid());
	assert_good(small_pack_write(&b, path, NULL, &cause));
	scene_free(&b);
	uint8_t *bytes = file_read(path, &size);
	bytes[size - 1] ^= spoil;
	file_write(path, bytes, size);
	free(bytes);
	srv_store_init(other);
	assert_good(srv_store_add(other, "small", path, &cause));
}

static const char *text_of(const json_t *plant, const char *key)
{
	const char *text = json_string_value(json_object_get(plant, key));
	return text ? text : "nothing";
}

UNIT_TEST(species_file_and_row_are_those_of_the_pack)
{
	struct srv_store other;
	char path[64];
	open_small(&other, path, false);
	const struct srv_scene *small = other.scenes[0];
	uint32_t list = instance_list(&small->pack->scene);
	for (uint32_t first = 0; first < SMALL_PACK_PLANTS; first++) {
		struct srv_json json = { 0 };
		const struct srv_plants_query query = { .first = first, .count = 3 };
		assert_good(srv_describe_plants(&json, small, list, &query, &cause));
		json_t *said = json_loadb((char *)json.out.bytes, json.out.size, 0, NULL),
			*plants = json_object_get(said, "plants");
		assert_int_equal(count_in(said, "of"), SMALL_PACK_PLANTS);
		assert_int_equal(json_array_size(plants),
			SMALL_PACK_PLANTS - first < 3 ? SMALL_PACK_PLANTS - first : 3);
		for (uint32_t i = 0; i < json_array_size(plants); i++) {
			const json_t *plant = json_array_get(plants, i);
			const struct eco_inventory_row *row = &small_pack_rows[first + i];
			assert_string_equal(text_of(plant, "species"), row->species ? row->species : "oak");
			assert_string_equal(text_of(plant, "file"), row->file ? row->file : "nothing");
			assert_int_equal(count_in(plant, "row"), row->row);
			assert_int_equal(count_in(plant, "line"), row->line);
		}
		json_decref(said);
		eco_writer_free(&json.out);
	}
	srv_store_free(&other);
	unlink(path);
}

/* The whole scene is searched, in pieces; a number is one of a row. */
UNIT_TEST(plants_are_found_by_species_model_and_row)
{
	static const struct { const char *text; uint64_t first, count; const char *found; } cases[] = { { "AS", 0, 9, "2 3 " },
		{ "elm", 0, 9, "5 " }, { "oak", 0, 9, "0 1 2 3 4 5 6 " }, { "oak", 2, 3, "2 3 4 " }, { "4", 0, 9, "2 " },
		{ "70000", 0, 9, "5 " }, { "trees", 0, 9, "" } };
	struct srv_store other;
	char path[64];
	open_small(&other, path, false);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct srv_json json = { 0 };
		struct srv_find_query query = { .first = cases[i].first, .count = cases[i].count };
		char found[64] = "";
		snprintf(query.text, sizeof query.text, "%s", cases[i].text);
		assert_good(srv_describe_found(&json, other.scenes[0], NULL, &query, &cause));
		json_t *said = json_loadb((char *)json.out.bytes, json.out.size, 0, NULL), *plant;
		size_t k;
		json_array_foreach(json_object_get(said, "plants"), k, plant) {
			snprintf(found + strlen(found), sizeof found - strlen(found), "%lld ", (long long)count_in(plant, "index"));
			assert_int_equal(json_array_size(json_object_get(plant, "foot")), 3);
			assert_true(json_number_value(json_object_get(plant, "height_m")) > 0);
		}
		assert_string_equal(found, cases[i].found);
		assert_true(cases[i].count == 3 ? count_in(said, "next") == 5 : json_is_null(json_object_get(said, "next")));
		json_decref(said);
		eco_writer_free(&json.out);
	}
	struct srv_json json = { 0 };
	assert_code(srv_describe_found(&json, other.scenes[0], NULL, &(struct srv_find_query){ "oak", .first = 7, .count = 1 },
		&cause), ECO_BAD_INPUT, "has 7 plants");
	eco_writer_free(&json.out);
	/* a scene without plants is no fault */
	struct eco_pack bare = *other.scenes[0]->pack;
	struct srv_json none = { 0 };
	bare.scene.place_count = bare.scene.group_count = 0;
	cause = (struct eco_error){ 0 };
	assert_good(srv_describe_found(&none, &(struct srv_scene){ .pack = &bare }, NULL, &(struct srv_find_query){ "oak", .count = 1 }, &cause));
	eco_writer_free(&none.out);
	srv_store_free(&other);
	unlink(path);
}

UNIT_TEST(a_plus_sign_in_a_text_is_a_space)
{
	static const char asked[] = "/v1/scenes/x/find?text=wild+oak%2B";
	struct srv_target target;
	struct srv_find_query query;
	assert_good(srv_target_parse(&target, asked, strlen(asked), &cause));
	assert_good(srv_find_query_parse(&query, &target, &cause));
	assert_string_equal(query.text, "wild oak+");
}

UNIT_TEST(damaged_rows_are_an_error_of_these_alone)
{
	struct srv_store other;
	struct srv_json json = { 0 };
	char path[64];
	const struct srv_plants_query query = { .count = 1 };
	open_small(&other, path, true);
	const struct srv_scene *small = other.scenes[0];
	assert_code(srv_describe_plants(&json, small, instance_list(&small->pack->scene), &query, &cause),
		ECO_DAMAGED, "hash does not match");
	assert_int_equal(srv_problem_of(ECO_DAMAGED), SRV_PROBLEM_DAMAGED);
	eco_writer_free(&json.out);
	srv_store_free(&other);
	unlink(path);
}

/* A pack without rows says the species of each plant, in pieces that are asked for. */
UNIT_TEST(plants_of_a_list_are_asked_for_in_pieces)
{
	char target[200];
	uint32_t list = instance_list(scene()), all = scene()->lists[list].primitive_count, got = 0;
	const struct eco_group *group = eco_list_groups(scene(), list);
	while (got < all) {
		snprintf(target, sizeof target, LIST("%u?first=%u&count=70"), list, got);
		json_t *said = json_get(target), *plants = json_object_get(said, "plants");
		for (uint32_t i = 0; i < json_array_size(plants); i++, got++) {
			while (got >= group->first + group->count)
				group++;
			const json_t *plant = json_array_get(plants, i);
			assert_string_equal(text_of(plant, "species"), scene()->plants[group->plant].name);
			assert_null(json_object_get(plant, "file"));
		}
		assert_true(json_array_size(plants) == 70 || got == all);
		json_decref(said);
	}
	assert_int_equal(got, all);
}

UNIT_TEST(what_is_asked_for_must_be_there)
{
	struct row { const char *target; unsigned status; const char *says; };
	uint32_t count;
	const struct row *rows = cases_rows("tests/server/cases/plants.tsv", "sus", sizeof *rows, &count);
	for (size_t i = 0; i < count; i++) {
		char target[200];
		const char *number = strstr(rows[i].target, "%u");
		if (number)
			snprintf(target, sizeof target, "%.*s%u%s", (int)(number - rows[i].target),
				rows[i].target, instance_list(scene()), number + 2);
		else
			snprintf(target, sizeof target, "%s", rows[i].target);
		http_expect(port, "GET", target, "", rows[i].status, rows[i].says);
	}
}

/* A pack that does not say what its plants stand for has as many species as plants, of unknown numbers. */
UNIT_TEST(species_are_the_plants_names_where_a_pack_says_nothing)
{
	json_t *said = json_get(BASE "/species"), *plants = json_object_get(said, "plants");
	assert_int_equal(json_array_size(plants), scene()->plant_count);
	for (uint32_t i = 0; i < scene()->plant_count; i++) {
		const json_t *plant = json_array_get(plants, i), *species = json_object_get(plant, "species");
		assert_string_equal(text_of(plant, "plant"), scene()->plants[i].name);
		assert_null(json_object_get(plant, "object"));
		assert_true(count_in(plant, "species_count") == 1 && json_array_size(species) == 1);
		assert_string_equal(text_of(json_array_get(species, 0), "species"), scene()->plants[i].name);
		assert_null(json_object_get(json_array_get(species, 0), "plants"));
	}
	json_decref(said);
	assert_int_equal(http_status(port, "GET", BASE "/species", "If-None-Match: *\r\n"), 304);
	assert_int_equal(http_status(port, "GET", BASE "/species?first=0", ""), 400);
}

/* Ecopack names 32 species of a plant; what a pack of another maker names beyond is said, too, and counted. */
UNIT_TEST(all_species_that_a_pack_names_are_said)
{
	struct srv_store other;
	struct srv_json json = { 0 };
	char path[64], name[24];
	open_small(&other, path, false);
	struct srv_scene *small = other.scenes[0];
	json_t *most = json_array();
	for (int i = 0; i < 40; i++) {
		snprintf(name, sizeof name, "kind %d", i);
		json_array_append_new(most, json_pack("[s, i]", name, 40 - i));
	}
	json_decref(small->meta);
	small->meta = json_pack("{s: [{s: {s: i, s: o}, s: b}]}", "plants", "species", "of", 3, "most", most, "object", 1);
	srv_describe_species(&json, small);
	json_t *said = json_loadb((char *)json.out.bytes, json.out.size, 0, NULL);
	const json_t *plant = json_array_get(json_object_get(said, "plants"), 0),
	      *species = json_object_get(plant, "species");
	assert_true(json_is_true(json_object_get(plant, "object")));
	assert_true(count_in(plant, "species_count") == 40 && json_array_size(species) == 40);
	assert_string_equal(text_of(json_array_get(species, 39), "species"), "kind 39");
	assert_int_equal(count_in(json_array_get(species, 39), "plants"), 1);
	json_decref(said);
	eco_writer_free(&json.out);
	srv_store_free(&other);
	unlink(path);
}

UNIT_MAIN(serve_start, serve_stop)
