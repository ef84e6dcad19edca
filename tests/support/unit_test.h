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
#ifndef TESTS_UNIT_TEST_H
#define TESTS_UNIT_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* A call must go well; otherwise the test fails with the error's text. */
#define assert_ok(code, error) \
	do { \
		if (code) \
			fail_msg("%s", (error).text); \
	} while (0)

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

#endif
