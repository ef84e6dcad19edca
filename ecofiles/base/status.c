/* One table of codes, so that printed texts, names of problem documents and exit statuses agree. */
#include "ecofiles/base/status.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>

static const struct {
	const char *name;
	int exit_status;
} codes[ECO_CODE_COUNT] = {
	[ECO_OK] = { "ok", 0 },
	[ECO_BAD_USAGE] = { "bad usage", 2 },
	[ECO_BAD_INPUT] = { "bad input", 1 },
	[ECO_DAMAGED] = { "damaged", 1 },
	[ECO_TOO_LARGE] = { "too large", 1 },
	[ECO_UNSUPPORTED] = { "unsupported", 1 },
	[ECO_NOT_FOUND] = { "not found", 1 },
	[ECO_IO] = { "input or output failed", 1 },
	[ECO_NO_MEMORY] = { "out of memory", 1 },
	[ECO_INTERRUPTED] = { "interrupted", 1 },
};

/* Texts quote input: control characters must not reach a terminal. */
static void tame(char *text)
{
	for (; *text; text++)
		if (((unsigned char)*text < ' ' && *text != '\n' && *text != '\t') || *text == 127)
			*text = '?';
}

enum eco_code eco_fail(struct eco_error *error, enum eco_code code, const char *format, ...)
{
	va_list arguments;
	assert(code > ECO_OK && code < ECO_CODE_COUNT);
	if (!error || error->code != ECO_OK)
		return code;
	error->code = code;
	va_start(arguments, format);
	vsnprintf(error->text, sizeof error->text, format, arguments);
	va_end(arguments);
	tame(error->text);
	return code;
}

const char *eco_code_name(enum eco_code code)
{
	return (unsigned)code < ECO_CODE_COUNT ? codes[code].name : "unknown";
}

int eco_exit_status(enum eco_code code)
{
	return (unsigned)code < ECO_CODE_COUNT ? codes[code].exit_status : 1;
}
