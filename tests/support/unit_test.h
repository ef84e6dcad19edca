/* cmocka with the headers that it needs before it, and tests that a program's main finds by itself:
 *
 *   UNIT_TEST(a_turn_is_a_rotation)
 *   {
 *           assert_int_equal(...);
 *   }
 *
 * Each is named once, where it stands, and none can be forgotten in a list. They run in the order of their
 * lines. A test program needs a main of its own only for what stands around all of them: unit_tests_run.
 * Tests have a parameter, unit_state, that few of them look at (Makefile: -Wno-unused-parameter). */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "ecofiles/base/status.h"

/* A call must go well; otherwise the test fails with the error's text. */
#define assert_ok(code, error) \
	do { \
		if (code) \
			fail_msg("%s", (error).text); \
	} while (0)

/* The error of the two checks below, as &cause in their calls; each empties it first. */
static struct eco_error cause __attribute__((unused));
#define assert_good(call) \
	do { \
		cause = (struct eco_error){ ECO_OK, "" }; \
		assert_ok(call, cause); \
	} while (0)
/* `wanted`: the code, or ECO_CODE_COUNT for any failure. */
#define assert_code(call, wanted, says) \
	do { \
		cause = (struct eco_error){ ECO_OK, "" }; \
		enum eco_code code_ = (call); \
		if (((wanted) == ECO_CODE_COUNT ? !code_ : code_ != (wanted)) || !strstr(cause.text, says)) \
			fail_msg("%s: %s\n  wanted %s ... %s", eco_code_name(code_), cause.text, \
				eco_code_name(wanted), says); \
	} while (0)

/* Variables that are freed at the end of their block, after a test that goes well: FREED(type) one = ...; by
 * type_free, AT_END(function) by that function of the address, FREED_MEMORY char *text = ...; by free.
 * OWNED(type) *one = ...; by what OWNABLE(type, function) says. */
#define FREED(type) __attribute__((cleanup(type##_free))) struct type
#define FREED_MEMORY __attribute__((cleanup(free_at)))
#define AT_END(function) __attribute__((cleanup(function)))
#define OWNED(type) __attribute__((cleanup(type##_end))) struct type
#define OWNABLE(type, function) static inline void type##_end(struct type **owned) { function(*owned); }

static inline void free_at(void *pointer)
{
	void *memory;
	memcpy(&memory, pointer, sizeof memory);
	free(memory);
}

struct eco_pack;
void eco_pack_close(struct eco_pack *pack);
OWNABLE(eco_pack, eco_pack_close)

#define UNIT_TEST(name) UNIT_TEST_BETWEEN(name, NULL, NULL)
/* With what is done before and after it, or NULL. */
#define UNIT_TEST_BETWEEN(name, set_up, tear_down) \
	static void name(void **unit_state); \
	__attribute__((constructor)) static void name##_is_there(void) \
	{ \
		unit_test_add(&(struct CMUnitTest){ #name, name, set_up, tear_down, NULL }, __LINE__); \
	} \
	static void name(void **unit_state)

void unit_test_add(const struct CMUnitTest *test, unsigned line);
/* Runs all, between the two where they are not NULL; how many failed, which is main's status. */
int unit_tests_run(CMFixtureFunction set_up, CMFixtureFunction tear_down);
/* A main that does so; programs without one have unit_main.c, without a fixture. */
#define UNIT_MAIN(set_up, tear_down) int main(void) { return unit_tests_run(set_up, tear_down); }
