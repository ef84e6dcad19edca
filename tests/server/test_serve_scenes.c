/* Scenes that are served: their names, and that they are checked. */
#include "tests/support/serve/serve_daemon.h"

UNIT_TEST(files_give_names_that_can_be_asked_for)
{
	static const struct { const char *path, *name; bool valid; } rows[] = {
		{ "/data/park.eco", "park", true }, { "park", "park", true }, { "a--b_.eco", "a--b_", true },
			{ "x.y/Park.ECO", "park-eco", true },
		{ "Parque Eduardo VII.eco", "parque-eduardo-vii", true }, { "__ (2) .eco", "2", true },
		{ "\xc3\xa1rvores.eco", "rvores", true },
		{ "\xc3\x81.eco", "\xc3\x81", false }, { ".eco", "eco", true }, { "dir/", "", false },
		{ "0123456789012345678901234567890123456789012345678901234567890123456789.eco",
			"012345678901234567890123456789012345678901234567890123456789012", true },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char name[SRV_NAME_BYTES];
		srv_name_of_file(name, rows[i].path);
		assert_string_equal(name, rows[i].name);
		assert_int_equal(srv_name_valid(name), rows[i].valid);
	}
}

UNIT_TEST(scenes_are_named_and_checked)
{
	struct srv_store other;
	struct eco_error error = { 0 };
	srv_store_init(&other);
	assert_int_equal(srv_store_add(&other, "a", pack_path, &error), ECO_OK);
	assert_int_equal(srv_store_add(&other, "b-2", pack_path, &error), ECO_OK);
	assert_int_equal(srv_store_add(&other, "a", pack_path, &error), ECO_BAD_USAGE);
	assert_non_null(strstr(error.text, "two scenes are named 'a'"));
	error = (struct eco_error){ 0 };
	assert_int_equal(srv_store_add(&other, "Bad", pack_path, &error), ECO_BAD_USAGE);
	error = (struct eco_error){ 0 };
	assert_true(srv_store_add(&other, NULL, "build/tmp/not-there.eco", &error) != ECO_OK);
	assert_non_null(strstr(error.text, "not-there.eco"));
	assert_int_equal(other.count, 2);
	assert_ptr_equal(srv_store_find(&other, "b-2"), other.scenes[1]);
	for (uint32_t i = 0; i < other.scenes[0]->pack->scene.chunk_count; i++) {
		const struct eco_chunk *chunks = other.scenes[0]->pack->scene.chunks;
		uint32_t found = srv_scene_chunk(other.scenes[0], &chunks[i].id);
		assert_memory_equal(chunks[found].id.bytes, chunks[i].id.bytes, sizeof chunks->id.bytes);
	}
	srv_store_free(&other);
}

int main(void)
{
	return unit_tests_run(serve_start, serve_stop);
}
