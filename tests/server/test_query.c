/* Parsing of text that comes in: targets, parameters, ranges, entity tags, dates. Tables of what is
 * accepted and what is refused. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/request/address.h"
#include "server/request/condition.h"
#include "server/request/json.h"
#include "server/request/query.h"
#include "server/store.h"
#include "tests/support/cases.h"
#include "tests/support/unit_test.h"

#define VIEW "eye=1,2,3&target=4,5,6&width=800&height=600&vertices=1000"

static enum eco_code parse_target(struct srv_target *target, const char *raw)
{
	struct eco_error error = { 0 };
	enum eco_code code = srv_target_parse(target, raw, strlen(raw), &error);
	assert_int_equal(code != ECO_OK, error.text[0] != 0);
	return code;
}

UNIT_TEST(paths_are_allow_listed)
{
	static const struct { const char *raw; uint32_t segments; } rows[] = {      /* 0: refused; / is 99 */
		{ "/", 99 }, { "/healthz", 1 }, { "/v1/scenes", 2 }, { "/v1/scenes/a-b_c.d/plan", 4 },
			{ "/A/0", 2 },
		{ "http://127.0.0.1:8080/v1/scenes", 2 }, { "http://host/", 99 },
		{ "", 0 }, { "v1", 0 }, { "*", 0 }, { "http://host", 0 }, { "https://host/healthz", 0 },
		{ "//healthz", 0 }, { "/a//b", 0 },
		{ "/healthz/", 0 }, { "/..", 0 }, { "/../..", 0 }, { "/v1/./scenes", 0 },
		{ "/v1/.hidden", 0 }, { "/healthz%00", 0 },
		{ "/%68ealthz", 0 }, { "/%zz", 0 }, { "/a%2fb", 0 }, { "/a;b", 0 }, { "/a#b", 0 },
		{ "/a b", 0 }, { "/a\\b", 0 }, { "/a\tb", 0 },
		{ "/\xc3\xa4", 0 }, { "/a/b/c/d/e/f/g/h", 8 }, { "/a/b/c/d/e/f/g/h/i", 0 },
	};
	struct srv_target target;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		enum eco_code code = parse_target(&target, rows[i].raw);
		assert_int_equal(code, rows[i].segments ? ECO_OK : ECO_BAD_INPUT);
		if (!code)
			assert_int_equal(target.segment_count, rows[i].segments % 99);
	}
	char *large = malloc(SRV_TARGET_BYTES_MAX + 1);
	memset(large, 'a', SRV_TARGET_BYTES_MAX);
	large[0] = '/';
	large[SRV_TARGET_BYTES_MAX] = 0;
	assert_int_equal(parse_target(&target, large), ECO_TOO_LARGE);
	large[SRV_TARGET_BYTES_MAX - 1] = 0;
	assert_int_equal(parse_target(&target, large), ECO_OK);
	free(large);
	assert_int_equal(srv_target_parse(&target, "/a\0b", 4, NULL), ECO_BAD_INPUT);
}

UNIT_TEST(parameters_are_decoded_strictly)
{
	/* of parameter x; NULL: refused */
	static const struct { const char *raw, *value; } rows[] = {
		{ "/p?x=1", "1" }, { "/p?y=2&x=1", "1" }, { "/p?x=1%2C2", "1,2" }, { "/p?x=%41%7e", "A~" },
			{ "/p?x=a=b", "a=b" },
		{ "/p?x=a+b", "a+b" }, { "/p?x=a?b", "a?b" },
		{ "/p?", NULL }, { "/p?x", NULL }, { "/p?x=", NULL }, { "/p?=1", NULL }, { "/p?x=1&", NULL },
		{ "/p?&x=1", NULL },
		{ "/p?x=1&&y=2", NULL }, { "/p?x=1&x=1", NULL }, { "/p?x=1&y=2&x=3", NULL },
		{ "/p?X=1", NULL }, { "/p?x1=1", NULL },
		{ "/p?%78=1", NULL }, { "/p?x=%", NULL }, { "/p?x=%4", NULL }, { "/p?x=%zz", NULL },
		{ "/p?x=%4g", NULL }, { "/p?x=%00", NULL },
		{ "/p?x=a%0Ab", NULL }, { "/p?x=%20", NULL }, { "/p?x=%80", NULL }, { "/p?x=%7f", NULL },
		{ "/p?x=\xc3\xa4", NULL },
		{ "/p?x=%2", NULL }, { "/p?x=1%", NULL },
	};
	struct srv_target target;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		enum eco_code code = parse_target(&target, rows[i].raw);
		assert_int_equal(code, rows[i].value ? ECO_OK : ECO_BAD_INPUT);
		if (!code)
			assert_string_equal(srv_target_param(&target, "x"), rows[i].value);
	}
}

UNIT_TEST(too_many_parameters_are_refused)
{
	struct srv_target target;
	char raw[256] = "/p?";
	for (size_t i = 0; i <= SRV_PARAMS_MAX; i++) {
		size_t at = strlen(raw);
		raw[at++] = (char)('a' + i % 26);
		raw[at++] = (char)('a' + i / 26);
		strcpy(raw + at, i < SRV_PARAMS_MAX ? "=1&" : "=1");
	}
	assert_int_equal(parse_target(&target, raw), ECO_BAD_INPUT);
}

static bool is_number(const char *text) { return srv_parse_number(text, &(double){ 0 }); }
static bool is_count(const char *text) { return srv_parse_count(text, &(uint64_t){ 0 }); }
static bool is_id(const char *text) { return srv_parse_id(text, &(struct eco_chunk_id){ { 0 } }); }
static bool is_authority(const char *text) { return srv_authority_valid(text, strlen(text)); }

#define LONG_NAME "a23456789012345678901234567890123456789012345678901234567890123"

UNIT_TEST(texts_are_read_strictly)
{
	static const struct { bool (*reads)(const char *text); const char *good[14], *bad[26]; } rows[] = {
		{ is_number, { "0", "-1.5", "1e3", "1E-2", "1.25e+2", "007", "1e-999" },
			{ "", "-", ".", "1.", ".5", "+1", "1e", "1e+", "nan", "inf", "-inf", "0x10", " 1", "1 ", "1,5", "1e999",
			"--1", "1_000", "1d3", "1234567890123456789012345678901234567890123456789" } },
		{ is_count, { "0", "18446744073709551615" }, { "18446744073709551616",
			"99999999999999999999999", "", "-1", "1.0", "1e6", "0x1" } },
		{ is_id, { "0123456789abcdef0011223344556677" }, { "0123456789ABCDEF0011223344556677",
			"0123456789abcdef001122334455667", "0123456789abcdef00112233445566778", "",
			"0123456789abcdef00112233445566g7" } },
		{ is_authority, { "a", "a.b-c_d~.", "127.0.0.1", "a:", "a:80", "a:65535", "[::1]", "[1::a.2]:1" },
			{ "", ":80", ".", ".a", "a..b", "a:65536", "a:000080", "a:8o", "a:1:2", "a@b", "a/b",
			"a b", "a,b", "a%20", "[]", "[::1", "[::1]a", "[::g]", "::1", "\x80", "[", "[:" } },
		/* no name is this machine but localhost */
		{ srv_host_is_loopback, { "localhost", "LOCALHOST:8080", "127.0.0.1", "127.9.9.9:1", "[::1]", "[::1]:8080",
			"[::ffff:127.0.0.1]:80" }, { "", ":80", "localhost.evil.example", "localhost:", "localhost:x", "evil",
			"127.0.0.1.evil.example", "127.0.0.1:8080.evil.example", "10.0.0.1", "[::2]:80",
			"evil@localhost", "127.1" } },
		{ srv_name_valid, { "a", "0-9_z", "scbi", LONG_NAME }, { "", "-a", "_a", "A", "a.b", "a b",
			"a/b", "\xc3\xa4", LONG_NAME "4" } } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		for (const char *const *text = rows[i].good; *text; text++)
			if (!rows[i].reads(*text))
				fail_msg("row %zu: '%s' is refused", i, *text);
		for (const char *const *text = rows[i].bad; *text; text++)
			if (rows[i].reads(*text))
				fail_msg("row %zu: '%s' is taken", i, *text);
	}
	double value;
	assert_true(srv_parse_number("1.25e+2", &value) && value == 125);
	assert_true(srv_parse_number("1E-2", &value) && value == .01);
}

UNIT_TEST(files_give_names_that_can_be_asked_for)
{
	static const struct { const char *path, *name; bool valid; } rows[] = { { "/data/park.eco", "park", true },
		{ "park", "park", true }, { "a--b_.eco", "a--b_", true }, { "x.y/Park.ECO", "park-eco", true },
		{ "Parque Eduardo VII.eco", "parque-eduardo-vii", true }, { "__ (2) .eco", "2", true },
		{ "\xc3\xa1rvores.eco", "rvores", true }, { "\xc3\x81.eco", "\xc3\x81", false },
		{ ".eco", "eco", true }, { "dir/", "", false }, { LONG_NAME "45678.eco", LONG_NAME, true } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char name[SRV_NAME_BYTES];
		srv_name_of_file(name, rows[i].path);
		assert_string_equal(name, rows[i].name);
		assert_int_equal(srv_name_valid(name), rows[i].valid);
	}
}

static enum eco_code parse_query(struct srv_query *query, const char *parameters)
{
	struct srv_target target;
	char raw[512] = "/plan?";
	cause = (struct eco_error){ ECO_OK, "" };
	strcat(raw, parameters);
	enum eco_code code = srv_target_parse(&target, raw, strlen(raw), &cause);
	return code ? code : srv_query_parse(query, &target, &cause);
}

UNIT_TEST(a_query_has_defaults)
{
	struct srv_query query;
	assert_good(parse_query(&query, VIEW));
	const struct eco_view *view = &query.request.view;
	assert_true(view->eye[0] == 1 && view->eye[2] == 3 && view->target[1] == 5 && view->up[0] == 0
		&& view->up[2] == 1);
	assert_true(view->fov_y_deg == 45 && view->width == 800 && view->height == 600);
	assert_true(query.request.vertices == 1000 && query.request.bytes == ECO_BYTES_UNBOUNDED
		&& !query.pack.given && !query.rule);
	assert_good(parse_query(&query, VIEW "&up=0,1,"
		"0&fov_y_deg=60.5&bytes=5000&pack=00112233445566778899aabbccddeeff"));
	assert_true(view->up[1] == 1 && view->fov_y_deg == 60.5 && query.request.bytes == 5000
		&& query.pack.given);
	assert_int_equal(query.pack.id.bytes[15], 0xff);
	assert_true(!parse_query(&query, VIEW "&rule=deussen")
		&& query.rule == lod_rule_deussen);
	assert_true(!parse_query(&query, VIEW "&rule=optimal")
		&& query.rule == lod_rule_optimal);
	assert_false(query.request.next.given);
	assert_good(parse_query(&query, VIEW "&name_from=1024"));
	assert_int_equal(query.request.name_from, 1024);
	assert_good(parse_query(&query, VIEW "&next_target=7,8,9&next_eye=1,2,4"));
	struct eco_view next = eco_view_next(&query.request);
	assert_true(query.request.next.given && next.eye[2] == 4 && next.target[0] == 7 && next.width == 800
		&& next.fov_y_deg == 45);
}

UNIT_TEST(bad_queries_name_the_parameter)
{
	struct fault { const char *query, *named; };
	uint32_t count;
	const struct fault *rows = cases_read("tests/server/cases/query_faults.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct srv_query query;
		assert_int_equal(parse_query(&query, rows[i].query), ECO_BAD_INPUT);
		if (!strstr(cause.text, rows[i].named))
			fail_msg("%s: '%s' is not in \"%s\"", rows[i].query, rows[i].named, cause.text);
	}
}

UNIT_TEST(ranges_follow_rfc_9110)
{
	static const struct { const char *value; enum srv_range_kind kind; uint64_t first, end; } rows[] = {
		{ NULL, SRV_RANGE_ALL, 0, 0 }, { "bytes=0-0", SRV_RANGE_PART, 0, 1 },
			{ "bytes=0-99", SRV_RANGE_PART, 0, 100 },
		{ "bytes=10-19", SRV_RANGE_PART, 10, 20 }, { "bytes=10-", SRV_RANGE_PART, 10, 100 },
		{ "bytes=-10", SRV_RANGE_PART, 90, 100 },
		{ "bytes=-1000", SRV_RANGE_PART, 0, 100 }, { "bytes=99-1000", SRV_RANGE_PART, 99, 100 },
		{ "Bytes=0-0", SRV_RANGE_PART, 0, 1 },
		{ "bytes=0-99999999999999999999999999", SRV_RANGE_PART, 0, 100 },
		{ "bytes=100-", SRV_RANGE_OUTSIDE, 0, 0 }, { "bytes=100-200", SRV_RANGE_OUTSIDE, 0, 0 },
		{ "bytes=-0", SRV_RANGE_OUTSIDE, 0, 0 },
		{ "bytes=99999999999999999999999999-", SRV_RANGE_OUTSIDE, 0, 0 },
		{ "bytes=0-1,5-6", SRV_RANGE_ALL, 0, 0 }, { "bytes=", SRV_RANGE_ALL, 0, 0 },
		{ "bytes=-", SRV_RANGE_ALL, 0, 0 },
		{ "bytes=5-4", SRV_RANGE_ALL, 0, 0 }, { "bytes=a-b", SRV_RANGE_ALL, 0, 0 },
		{ "bytes=1-2 ", SRV_RANGE_ALL, 0, 0 },
		{ "bytes= 1-2", SRV_RANGE_ALL, 0, 0 }, { "lines=1-2", SRV_RANGE_ALL, 0, 0 },
		{ "bytes=1", SRV_RANGE_ALL, 0, 0 }, { "b", SRV_RANGE_ALL, 0, 0 }, { "", SRV_RANGE_ALL, 0, 0 },
		{ "bytes=1--2", SRV_RANGE_ALL, 0, 0 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct srv_range range = srv_range_parse(rows[i].value, 100);
		assert_int_equal(range.kind, rows[i].kind);
		if (range.kind == SRV_RANGE_PART)
			assert_true(range.first == rows[i].first && range.end == rows[i].end);
	}
}

UNIT_TEST(entity_tags_match_weakly)
{
	static const struct { const char *value; bool match; } rows[] = {
		{ "\"abc\"", true }, { "W/\"abc\"", true }, { "*", true }, { " * ", true },
			{ "\"x\", \"abc\"", true }, { "\"x\",W/\"abc\"", true },
		{ NULL, false }, { "", false }, { "abc", false }, { "\"ab\"", false }, { "\"abcd\"", false },
		{ "\"abc", false }, { "**", false },
		{ "\"x\"\"abc\"", false }, { "\"a,\\\"abc\\\"", false },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		assert_int_equal(srv_etag_match(rows[i].value, "\"abc\""), rows[i].match);
}

UNIT_TEST(preconditions_are_judged_in_order)
{
	static const char early[] = "Sun, 06 Nov 1994 08:49:36 GMT",
			  same[] = "Sunday, 06-Nov-94 08:49:37 GMT", late[] = "Sun Nov  6 08:49:38 1994";
	static const struct { struct srv_conditions given; enum srv_verdict tagged, untagged; } rows[] = {
		{ { .range = "bytes=0-1" }, SRV_VERDICT_GO, SRV_VERDICT_GO },
		{ { .if_match = "\"a\"" }, SRV_VERDICT_GO, SRV_VERDICT_FAILED },
		{ { .if_match = "*" }, SRV_VERDICT_GO, SRV_VERDICT_GO },
		{ { .if_match = "\"b\", \"a\"" }, SRV_VERDICT_GO, SRV_VERDICT_FAILED },
		{ { .if_match = "W/\"a\"" }, SRV_VERDICT_FAILED, SRV_VERDICT_FAILED },
		{ { .if_match = "a" }, SRV_VERDICT_FAILED, SRV_VERDICT_FAILED },
		{ { .if_match = "\"b\"", .if_none_match = "\"a\"" }, SRV_VERDICT_FAILED, SRV_VERDICT_FAILED },
		{ { .if_match = "\"a\"", .if_none_match = "\"a\"" }, SRV_VERDICT_NOT_MODIFIED,
			SRV_VERDICT_FAILED },
		{ { .if_unmodified_since = early }, SRV_VERDICT_FAILED, SRV_VERDICT_FAILED },
		{ { .if_unmodified_since = same }, SRV_VERDICT_GO, SRV_VERDICT_GO },
		{ { .if_unmodified_since = late }, SRV_VERDICT_GO, SRV_VERDICT_GO },
		{ { .if_unmodified_since = "yesterday" }, SRV_VERDICT_GO, SRV_VERDICT_GO },
		{ { .if_match = "\"a\"", .if_unmodified_since = early }, SRV_VERDICT_GO, SRV_VERDICT_FAILED },
		{ { .if_none_match = "W/\"a\"" }, SRV_VERDICT_NOT_MODIFIED, SRV_VERDICT_GO },
	};
	char date[SRV_DATE_BYTES];
	srv_date_format(date, 784111776);
	assert_string_equal(date, early);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		assert_int_equal(srv_conditions_judge(&rows[i].given, "\"a\"", 784111777), rows[i].tagged);
		assert_int_equal(srv_conditions_judge(&rows[i].given, NULL, 784111777), rows[i].untagged);
	}
	assert_int_equal(srv_conditions_judge(&rows[8].given, NULL, 0), SRV_VERDICT_GO);
}

static struct srv_address address(const char *text)
{
	struct srv_address made;
	if (!srv_address_parse(&made, text, strlen(text)))
		fail_msg("%s is no address", text);
	return made;
}

UNIT_TEST(addresses_of_one_household_are_the_same)
{
	static const struct { const char *a, *b; bool same;
	} rows[] = { { "10.0.0.1", "10.0.0.1", true }, { "10.0.0.1", "10.0.0.2", false },
		{ "10.0.0.1", "::ffff:10.0.0.1", true }, { "2001:db8:0:1::1", "2001:db8:0:1:ffff::2", true },
		{ "2001:db8:0:1::1", "2001:db8:0:2::1", false }, { "10.0.0.1", "2001:db8::1", false } };
	char text[SRV_ADDRESS_TEXT_BYTES];
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct srv_address a = address(rows[i].a), b = address(rows[i].b);
		assert_int_equal(srv_address_same(&a, &b), rows[i].same);
		assert_int_equal(srv_address_same(&b, &a), rows[i].same);
		srv_address_format(text, &a);
		assert_string_equal(text, rows[i].a);
	}
}

UNIT_TEST(only_a_trusted_proxy_speaks_for_others)
{
	struct forwarded { const char *trusted, *peer, *forwarded, *client; };
	uint32_t count;
	const struct forwarded *rows = cases_read("tests/server/cases/forwarded.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct srv_networks trusted;
		char text[SRV_ADDRESS_TEXT_BYTES];
		assert_good(srv_networks_parse(rows[i].trusted, &trusted, &cause));
		struct srv_address peer = address(rows[i].peer), client = srv_networks_client(&trusted, &peer,
			rows[i].forwarded);
		srv_address_format(text, &client);
		assert_string_equal(text, rows[i].client);
	}
	static const char *const bad[] = { "", "x", "10.0.0.1/33", "10.0.0.1/", "10.0.0.1/1000", "::1/129",
		"10.0.0.1,", "10.0.0.1/-1", "10.0.0.0.1" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct srv_networks trusted;
		assert_code(srv_networks_parse(bad[i], &trusted, &cause), ECO_BAD_USAGE, "");
	}
}

/* The bound holds while a document is written, and so does the flag of who waits for it. */
UNIT_TEST(json_ends_where_it_is_too_large_or_nobody_waits)
{
	for (int i = 0; i < 3; i++) {
		atomic_bool cancelled = false;
		struct srv_json json = { .most = i ? 0 : 10000, .cancelled = &cancelled };
		srv_json_add(&json, "[");
		for (uint32_t n = 0; n < 100000; n++) {
			srv_json_add(&json, "%s", "twenty bytes or so ...");
			atomic_store(&cancelled, i == 1 && n > 1000);
		}
		srv_json_add(&json, "]");
		assert_int_equal(json.out.failed, i < 2);
		assert_in_range(json.out.size, 10000, i < 2 ? 30000 : 3000000);
		assert_int_equal(srv_json_end(&json), i == 0 ? ECO_TOO_LARGE : i == 1 ? ECO_INTERRUPTED : ECO_OK);
		eco_writer_free(&json.out);
		assert_null(json.out.bytes);
	}
}

UNIT_TEST(json_escapes_and_keeps_numbers)
{
	const char *nothing = getenv("NO SUCH VARIABLE");
	struct srv_json json = { 0 };
	srv_json_add(&json, "{a:%s n:%lu m:%lx o:%lx", "\"\\\n\x7f\xc3\xa4\xff\xed\xa0\x80\xf0\x9f\x8c\xb3",
		UINT64_MAX, UINT64_MAX, (uint64_t)7);
	srv_json_add(&json, "x:%g y:%g z:%.9g u:%g", 0.1, -1.0 / 3, -1.0 / 3, (double)INFINITY);
	srv_json_add(&json, "l:[%d {} null %u] t:%s}", true, 5u, nothing);
	eco_write_u8(&json.out, 0);
	assert_false(json.out.failed);
	assert_string_equal((char *)json.out.bytes,
		"{\"a\":\"\\\"\\\\\\u000a\\u007f\xc3\xa4\\ufffd\\ufffd\\ufffd\\ufffd\xf0\x9f\x8c\xb3\","
		"\"n\":18446744073709551615,\"m\":null,\"o\":7,\"x\":0.1,\"y\":-0.3333333333333333,"
		"\"z\":-0.333333333,\"u\":null,\"l\":[true,{},null,5],\"t\":null}");
	eco_writer_free(&json.out);
}

