/* Options of all commands, read by tables. */
#include "ecofiles/ecopack/command.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/progress.h"

bool main_is_quiet;

struct reading {
	const char *command;
	const struct main_option *options;
	struct eco_error *error;
};

static enum eco_code read_count(const struct reading *r, const struct main_option *o, const char *text)
{
	char *end;
	errno = 0;
	unsigned long long value = strtoull(text, &end, 10);
	if (text[0] < '0' || text[0] > '9' || *end || errno || (double)value < o->low || (double)value > o->high)
		return eco_fail(r->error, ECO_BAD_USAGE, "--%s %s: must be a whole number from %.0f to %.0f", o->name, text, o->low, o->high);
	*(uint64_t *)o->value = value;
	return ECO_OK;
}

static enum eco_code read_numbers(const struct reading *r, const struct main_option *o, const char *text, uint32_t count)
{
	double *to = o->value;
	const char *rest = text;
	for (uint32_t i = 0; i < count; i++) {
		char *end;
		double number = strtod(rest, &end);
		if (end == rest || *end != (i + 1 < count ? ',' : 0) || !(number >= o->low && number <= o->high))
			return eco_fail(r->error, ECO_BAD_USAGE, "--%s %s: must be %u number%s from %g to %g%s", o->name, text, count, count == 1 ? "" : "s",
				o->low, o->high, count == 1 ? "" : ", separated by commas");
		to[i] = number;
		rest = end + 1;
	}
	return ECO_OK;
}

static enum eco_code read_value(const struct reading *r, const struct main_option *o, const char *text)
{
	if (o->given)
		*o->given = true;
	if (o->kind == MAIN_FLAG)
		*(bool *)o->value = true;
	else if (o->kind == MAIN_TEXT)
		*(const char **)o->value = text;
	else if (o->kind == MAIN_COUNT)
		return read_count(r, o, text);
	else
		return read_numbers(r, o, text, o->kind == MAIN_NUMBER ? 1 : o->count);
	return ECO_OK;
}

static const struct main_option quiet = { "quiet", 'q', MAIN_FLAG, &main_is_quiet, 0, 0, 0, NULL };

/* `name` ends at '=' or at 0. */
static const struct main_option *find(const struct reading *r, const char *name, size_t length, bool is_letter)
{
	const struct main_option *o = r->options;
	for (;; o++) {
		const struct main_option *candidate = o && o->name ? o : &quiet;
		if (is_letter ? candidate->letter == *name : strlen(candidate->name) == length && strncmp(candidate->name, name, length) == 0)
			return candidate;
		if (candidate == &quiet)
			return NULL;
	}
}

/* --name VALUE, --name=VALUE, -l VALUE, -lVALUE */
static enum eco_code read_option(const struct reading *r, int argc, char **argv, int *at)
{
	const char *argument = argv[*at], *value = NULL;
	bool is_letter = argument[1] != '-';
	const char *name = argument + (is_letter ? 1 : 2);
	size_t length = is_letter ? 1 : strcspn(name, "=");
	const struct main_option *o = find(r, name, length, is_letter);
	if (!o)
		return eco_fail(r->error, ECO_BAD_USAGE, "ecopack %s has no %.100s", r->command, argument);
	if (name[length])
		value = name + length + (is_letter ? 0 : 1);
	if (o->kind == MAIN_FLAG)
		return value ? eco_fail(r->error, ECO_BAD_USAGE, "%.100s: --%s takes no value", argument, o->name) : read_value(r, o, NULL);
	if (!value && *at + 1 >= argc)
		return eco_fail(r->error, ECO_BAD_USAGE, "%.100s: a value must follow it", argument);
	return read_value(r, o, value ? value : argv[++*at]);
}

enum eco_code main_arguments(int argc, char **argv, const char *command, const struct main_option *options, const char *what,
	const char **inputs, uint32_t most, uint32_t *count, struct eco_error *error)
{
	struct reading r = { command, options, error };
	uint32_t found = 0;
	bool only_inputs = false;
	for (int i = 0; i < argc; i++) {
		enum eco_code code = ECO_OK;
		if (!only_inputs && strcmp(argv[i], "--") == 0)
			only_inputs = true;
		else if (!only_inputs && argv[i][0] == '-' && argv[i][1])
			code = read_option(&r, argc, argv, &i);
		else if (found == most)
			code = eco_fail(error, ECO_BAD_USAGE, "%.200s: one argument too many", argv[i]);
		else
			inputs[found++] = argv[i];
		if (code)
			return code;
	}
	if (!found)
		return eco_fail(error, ECO_BAD_USAGE, "ecopack %s: %s is missing", command, what);
	if (count)
		*count = found;
	main_progress_quiet(main_is_quiet);
	return ECO_OK;
}
