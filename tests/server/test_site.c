/* The viewer's files: what is read at start, and which form of a file a browser gets. */
#include "tests/support/cases.h"
#include "tests/support/input_files.h"
#include "tests/support/serve/serve_daemon.h"

#define DIR "build/tmp/test_site"

static void write_three(const char *name)
{
	static const char *const ends[3] = { "", ".gz", ".br" };
	char form[64];
	for (int i = 0; i < 3; i++) {
		snprintf(form, sizeof form, "%s%s", name, ends[i]);
		input_text("test_site", form, form);
	}
}

static void begin(void)
{
	assert_int_equal(system("rm -rf " DIR), 0);
	folder_make(DIR);
}

UNIT_TEST(a_folder_is_read_with_all_forms_and_types)
{
	static const char *const rows[][2] = { { "index.html", "text/html; charset=utf-8" },
		{ "a.css", "text/css; charset=utf-8" }, { "a.js", "text/javascript; charset=utf-8" },
		{ "a.mjs", "text/javascript; charset=utf-8" }, { "a.wasm", "application/wasm" } };
	struct srv_site site;
	begin();
	for (size_t i = 0; i < 5; i++)
		write_three(rows[i][0]);
	assert_int_equal(srv_site_read(&site, DIR, NULL), ECO_OK);
	assert_int_equal(site.count, 5);
	for (size_t i = 0; i < 5; i++) {
		const struct srv_site_file *file = srv_site_find(&site, rows[i][0]);
		assert_non_null(file);
		assert_string_equal(file->type, rows[i][1]);
		assert_int_equal(file->forms[SRV_FORM_PLAIN].size, strlen(rows[i][0]));
		assert_memory_equal(file->forms[SRV_FORM_GZIP].bytes + strlen(rows[i][0]), ".gz", 3);
		assert_memory_equal(file->forms[SRV_FORM_BROTLI].bytes + strlen(rows[i][0]), ".br", 3);
	}
	assert_string_equal(site.version, "");
	assert_null(srv_site_find(&site, "a.wasm.gz"));
	assert_null(srv_site_find(&site, "../index.html"));
	srv_site_free(&site);
}

UNIT_TEST(a_folder_that_is_none_of_ours_is_refused_by_name)
{
	struct srv_site site;
	assert_good(srv_site_read(&site, DIR "/none", &cause));
	assert_int_equal(site.count, 0);
	begin();
	write_three("notes.txt");
	assert_code(srv_site_read(&site, DIR, &cause), ECO_BAD_INPUT, "notes.txt");
	begin();
	input_text("test_site", "index.html", "alone");
	assert_code(srv_site_read(&site, DIR, &cause), ECO_NOT_FOUND, "index.html.gz");
}

UNIT_TEST(a_version_is_a_line_of_hex_digits)
{
	static const struct { const char *text; enum eco_code code; } rows[] = { { "0f\n", ECO_OK },
		{ "", ECO_BAD_INPUT }, { "\n", ECO_BAD_INPUT }, { "0f", ECO_BAD_INPUT },
		{ "0F\n", ECO_BAD_INPUT }, { "../0f\n", ECO_BAD_INPUT }, { "0f\n\n", ECO_BAD_INPUT },
		{ "0123456789012345678901234567890123456789012345678901234567890123\n", ECO_OK },
		{ "01234567890123456789012345678901234567890123456789012345678901234\n", ECO_BAD_INPUT } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct srv_site site;
		begin();
		input_text("test_site", "version", rows[i].text);
		assert_code(srv_site_read(&site, DIR, &cause), rows[i].code, "");
		assert_int_equal(strlen(site.version), rows[i].code ? 0 : strlen(rows[i].text) - 1);
		assert_true(!rows[i].code || strstr(cause.text, DIR "/version"));
		srv_site_free(&site);
	}
}

UNIT_TEST(a_browser_gets_the_smallest_form_that_it_takes)
{
	static const struct { const char *accepts; enum srv_form form; } rows[] = {
		{ NULL, SRV_FORM_PLAIN }, { "", SRV_FORM_PLAIN }, { "identity", SRV_FORM_PLAIN },
		{ "gzip", SRV_FORM_GZIP }, { "gzip, deflate, br, zstd", SRV_FORM_BROTLI },
		{ "GZIP;q=0.5 , x", SRV_FORM_GZIP }, { "br;q=0, gzip", SRV_FORM_GZIP },
		{ "br;q=0.0,gzip;q=0", SRV_FORM_PLAIN }, { "brotli", SRV_FORM_PLAIN },
		{ ",,br", SRV_FORM_BROTLI } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		assert_int_equal(srv_site_form(&sample_site.files[0], rows[i].accepts), rows[i].form);
}

UNIT_TEST(files_have_addresses_forms_and_validators)
{
	/* the page's addresses are relative to it; those with a version name their content */
	struct site_case { const char *target, *headers, *status, *body, *name, *value; };
	uint32_t count;
	const struct site_case *rows = cases_read("tests/server/cases/site.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct http_answer answer = http_ask(port, "GET", rows[i].target, rows[i].headers, NULL, 0);
		if (answer.status != (unsigned)atoi(rows[i].status) || !strstr(answer.body, rows[i].body))
			fail_msg("%s: %u\n%s", rows[i].target, answer.status, answer.body);
		assert_header(&answer, rows[i].name, rows[i].value);
		http_free(&answer);
	}
}

UNIT_TEST(parameters_that_others_append_to_a_link_are_ignored)
{
	static const char *const paths[] = { "/", "/favicon.ico", "/viewer/icon.svg",
		"/viewer/0123abcd/icon.svg" };
	static const char *const queries[] = { "?fbclid=IwAR0_x-1", "?utm_source=a%20b&utm_source=%C3%A4",
		"?v=2", "?", "?v", "?V=", "?=1&&", "?%zz", "?next=/../..", "?ref=http://host/?a=b" };
	for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
		for (size_t k = 0; k < sizeof queries / sizeof *queries; k++) {
			char target[128], place[128], place_without[128];
			snprintf(target, sizeof target, "%s%s", paths[i], queries[k]);
			struct http_answer answer = http_get(port, target);
			struct http_answer without = http_get(port, paths[i]);
			if (answer.status != without.status || answer.size != without.size)
				fail_msg("%s: %u\n%s", target, answer.status, answer.body);
			assert_memory_equal(answer.body, without.body, answer.size);
			bool moved = http_header(&answer, "Location", place, sizeof place);
			assert_int_equal(moved, http_header(&without, "Location", place_without,
				sizeof place_without));
			assert_true(!moved || strcmp(place, place_without) == 0);
			http_free(&answer);
			http_free(&without);
		}
}

UNIT_MAIN(serve_start, serve_stop)
