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

static const char *const readers[] = { "path", "parameter", "number", "count", "id", "authority", "loopback",
	"name", "file", "range", "tag", "network", NULL };
enum { PATH, PARAMETER, NUMBER, COUNT, ID, AUTHORITY, LOOPBACK, NAME, FILE_NAME, RANGE, TAG, NETWORK };

/* Returns what a reader makes of a text, in `room`, or "yes"; NULL: it is refused. */
static const char *read_text(int reader, const char *text, char room[128])
{
	struct srv_target target;
	struct srv_networks trusted;
	struct srv_range range;
	struct eco_chunk_id id;
	char name[SRV_NAME_BYTES];
	uint64_t count;
	double number;
	bool good = true;
	strcpy(room, "yes");
	switch (reader) {
	case PATH: case PARAMETER:
		good = parse_target(&target, text) == ECO_OK;
		snprintf(room, 128, "%u", target.segment_count);
		if (good && reader == PARAMETER)
			snprintf(room, 128, "%s", srv_target_param(&target, "x"));
		break;
	case NUMBER:
		good = srv_parse_number(text, &number);
		snprintf(room, 128, "%g", good ? number : 0);
		break;
	case COUNT:
		good = srv_parse_count(text, &count);
		snprintf(room, 128, "%llu", good ? (unsigned long long)count : 0);
		break;
	case FILE_NAME:
		srv_name_of_file(name, text);
		snprintf(room, 128, "%s%s", srv_name_valid(name) ? "" : "invalid ", name);
		break;
	case RANGE:
		range = srv_range_parse(text, 100);
		snprintf(room, 128, "%llu-%llu", (unsigned long long)range.first, (unsigned long long)range.end);
		return range.kind == SRV_RANGE_ALL ? "all" : range.kind == SRV_RANGE_OUTSIDE ? "outside" : room;
	case ID: good = srv_parse_id(text, &id); break;
	case AUTHORITY: good = srv_authority_valid(text, strlen(text)); break;
	case LOOPBACK: good = srv_host_is_loopback(text); break;     /* no name is this machine but localhost */
	case NAME: good = srv_name_valid(text); break;
	case TAG: good = srv_etag_match(text, "\"abc\""); break;
	default: good = srv_networks_parse(text, &trusted, NULL) != ECO_BAD_USAGE;
	}
	return good ? room : NULL;
}

UNIT_TEST(texts_are_read_strictly)
{
	struct text { const char *reader, *text, *wanted; };
	uint32_t count;
	const struct text *rows = cases_read("tests/server/cases/texts.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		char room[128];
		const char *got = read_text(cases_choice(rows[i].reader, readers), rows[i].text, room);
		if (!got != !rows[i].wanted || (got && strcmp(got, rows[i].wanted) != 0))
			fail_msg("%s '%s' is %s, not %s", rows[i].reader, rows[i].text, got, rows[i].wanted);
	}
}

UNIT_TEST(a_target_has_a_largest_size_and_no_zero)
{
	struct srv_target target;
	char large[SRV_TARGET_BYTES_MAX + 1];
	memset(large, 'a', SRV_TARGET_BYTES_MAX);
	large[0] = '/';
	large[SRV_TARGET_BYTES_MAX] = 0;
	assert_int_equal(parse_target(&target, large), ECO_TOO_LARGE);
	large[SRV_TARGET_BYTES_MAX - 1] = 0;
	assert_int_equal(parse_target(&target, large), ECO_OK);
	assert_int_equal(srv_target_parse(&target, "/a\0b", 4, NULL), ECO_BAD_INPUT);
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

