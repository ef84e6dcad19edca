/* cmocka with the headers that it needs before it. Tests have a parameter that few of them look at (Makefile:
 * -Wno-unused-parameter). */
#ifndef TESTS_UNIT_TEST_H
#define TESTS_UNIT_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#endif
