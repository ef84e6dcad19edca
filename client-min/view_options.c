#include "client-min/view_options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/view.h"

bool view_option(int argc, char **argv, int *at, const char *name, const char **value)
{
	size_t length = strlen(name);
	const char *arg = argv[*at];
	if (strncmp(arg, name, length) != 0 || (arg[length] != '\0' && arg[length] != '='))
		return false;
	*at += 1;
	*value = arg[length] == '=' ? arg + length + 1 : NULL;
	if (!*value && *at < argc)
		*value = argv[(*at)++];
	return true;
}

bool view_flag(char **argv, int *at, const char *name)
{
	if (strcmp(argv[*at], name) != 0)
		return false;
	*at += 1;
	return true;
}

enum eco_code view_parse_count(const char *option, const char *text, uint64_t low, uint64_t high, uint64_t *out, struct eco_error *error)
{
	char *end = NULL;
	errno = 0;
	unsigned long long v = text && *text >= '0' && *text <= '9' ? strtoull(text, &end, 10) : 0;
	if (!end || *end || errno || v < low || v > high)
		return eco_fail(error, ECO_BAD_USAGE, "%s takes a whole number from %llu to %llu, not '%s'", option, (unsigned long long)low,
			(unsigned long long)high, text ? text : "");
	*out = v;
	return ECO_OK;
}

enum eco_code view_parse_seconds(const char *option, const char *text, double *out, struct eco_error *error)
{
	char *end = NULL;
	double v = text ? strtod(text, &end) : 0;
	if (!end || end == text || *end || !(v > 0 && v <= 1e6))
		return eco_fail(error, ECO_BAD_USAGE, "%s takes seconds above 0, not '%s'", option, text ? text : "");
	*out = v;
	return ECO_OK;
}

enum eco_code view_parse_size(const char *option, const char *text, uint32_t *width, uint32_t *height, struct eco_error *error)
{
	unsigned w = 0, h = 0;
	int used = 0;
	if (!text || sscanf(text, "%5ux%5u%n", &w, &h, &used) != 2 || text[used] || !w || !h || w > ECO_IMAGE_MAX || h > ECO_IMAGE_MAX)
		return eco_fail(error, ECO_BAD_USAGE, "%s takes WIDTHxHEIGHT, each from 1 to %u, not '%s'", option, ECO_IMAGE_MAX,
			text ? text : "");
	*width = w;
	*height = h;
	return ECO_OK;
}

int view_output_status(int status, const char *program)
{
	if (fflush(stdout) == 0 && !ferror(stdout))
		return status;
	fprintf(stderr, "%s: cannot write to stdout\n", program);
	return status ? status : 1;
}
