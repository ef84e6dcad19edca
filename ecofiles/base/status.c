/* One table of names, so that printed texts and problem documents agree. */
#include "ecofiles/base/status.h"
#include "ecofiles/base/text.h"

#include <assert.h>
#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char *const names[ECO_CODE_COUNT] = {
	[ECO_OK] = "ok", [ECO_BAD_USAGE] = "bad usage", [ECO_BAD_INPUT] = "bad input", [ECO_DAMAGED] = "damaged",
	[ECO_TOO_LARGE] = "too large", [ECO_UNSUPPORTED] = "unsupported", [ECO_NOT_FOUND] = "not found",
	[ECO_IO] = "input or output failed", [ECO_NO_MEMORY] = "out of memory", [ECO_INTERRUPTED] = "interrupted",
};

enum eco_code eco_fail(struct eco_error *error, enum eco_code code, const char *format, ...)
{
	va_list arguments;
	assert(code > ECO_OK && code < ECO_CODE_COUNT);
	if (!error || error->code != ECO_OK)
		return code;
	error->code = code;
	va_start(arguments, format);
	eco_phrase_cut(error->text, sizeof error->text,
		vsnprintf(error->text, sizeof error->text, format, arguments));
	va_end(arguments);
	eco_utf8_tame(error->text, "\n\t", '?');     /* texts quote input, which must not steer a terminal */
	return code;
}

/* ---- What the system refuses ---- */

#define NO_RIGHT "ask for the right to"
#define NO_ROOM "; free some space or write elsewhere"

static const struct { int reason; const char *read, *write; } advices[] = {
	{ ENOENT, "; check its name, and the folder that you are in", "; make its folder first (mkdir -p)" },
	{ EACCES, "; " NO_RIGHT " read it (chmod, chown)", "; " NO_RIGHT " write there, or write elsewhere" },
	{ EPERM, "; " NO_RIGHT " read it", "; " NO_RIGHT " write there, or write elsewhere" },
	{ ENOTDIR, "; a part of its path is a file", "; a part of its path is a file: take another name" },
	{ EISDIR, "; name a file in it", "; name a file in it" },
	{ ENAMETOOLONG, "; take a shorter name", "; take a shorter name" },
	{ EROFS, "", "; write elsewhere" },
	{ ENOSPC, "", NO_ROOM }, { EDQUOT, "", NO_ROOM }, { EFBIG, "", NO_ROOM },
	{ EMFILE, "; allow more open files (ulimit -n)", "; allow more open files (ulimit -n)" },
	{ EIO, "; the disk may be damaged: copy the file anew", "; the disk may be damaged: write elsewhere" },
};

static const char *advice(int reason, bool for_writing)
{
	for (size_t i = 0; i < sizeof advices / sizeof *advices; i++)
		if (advices[i].reason == reason)
			return for_writing ? advices[i].write : advices[i].read;
	return "";
}

const char *eco_advice_read(int reason) { return advice(reason, false); }
const char *eco_advice_write(int reason) { return advice(reason, true); }

enum eco_code eco_no_memory(struct eco_error *error, const char *what)
{
	return eco_fail(error, ECO_NO_MEMORY, "no memory for %s", what);
}

enum eco_code eco_fail_read(struct eco_error *error, const char *path, int reason)
{
	return eco_fail(error, reason == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.380s: %s%s", path,
		strerror(reason), eco_advice_read(reason));
}

enum eco_code eco_fail_write(struct eco_error *error, const char *path, int reason)
{
	return eco_fail(error, ECO_IO, "%.380s: %s%s", path, strerror(reason), eco_advice_write(reason));
}

const char *eco_code_name(enum eco_code code)
{
	return (unsigned)code < ECO_CODE_COUNT ? names[code] : "unknown";
}

int eco_exit_status(enum eco_code code)
{
	return code == ECO_OK ? 0 : code == ECO_BAD_USAGE ? 2 : 1;
}
