#include "tests/support/told.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/unit_test.h"

char import_said[8192];

void import_note(void *ctx, const char *text)
{
	size_t used = strlen(import_said);
	snprintf(import_said + used, sizeof import_said - used, "%s\n", text);
}

void import_says(const char *text)
{
	if (!strstr(import_said, text))
		fail_msg("said: %s\n  wanted %s", import_said, text);
}

bool close_to(double a, double b, double most)
{
	return fabs(a - b) <= most;
}

/* Texts alike, or lists of numbers that differ by rounding to float. */
static bool tells(const char *got, const char *wanted)
{
	char *end, *other;
	while (strcmp(got, wanted) != 0) {
		double a = strtod(got, &end), b = strtod(wanted, &other);
		if (end == got || other == wanted || !close_to(a, b, 1e-5 * fabs(b) + 1e-6) || *end != *other)
			return false;
		if (!*end)
			return true;
		got = end + 1;
		wanted = other + 1;
	}
	return true;
}

void expect_told(const char *wanted, told_value *value_of)
{
	char all[1000], got[400], key[20], *rest = all;
	snprintf(all, sizeof all, "%s", wanted);
	for (char *one; (one = strsep(&rest, "|"));) {
		char *value = strchr(one, '=');
		unsigned number = 0;
		if (*one == '~' || *one == '!') {
			if ((strstr(import_said, one + 1) != NULL) != (*one == '~'))
				fail_msg("said: %s\n  wanted %s", import_said, one);
			continue;
		}
		assert_true(!*one || (value && sscanf(one, "%19[a-z_]%u", key, &number) >= 1));
		if (*one)
			value_of(key, number, value + 1, got, sizeof got);
		if (*one && !tells(got, value + 1))
			fail_msg("%.*s is %s, not %s\n  said: %s", (int)(value - one), one, got, value + 1, import_said);
	}
}
