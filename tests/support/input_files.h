/* Small files for tests of readers, under build/tmp/NAME/. */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/files.h"

/* Path of a file in the test's folder; four may be in use at a time. */
static inline const char *input_path(const char *test, const char *name)
{
	static char paths[4][512];
	static unsigned turn;
	char *path = paths[turn++ % 4];
	snprintf(path, sizeof paths[0], "build/tmp/%s", test);
	folder_make(path);
	snprintf(path, sizeof paths[0], "build/tmp/%s/%s", test, name);
	return path;
}

static inline const char *input_bytes(const char *test, const char *name, const void *bytes, size_t size)
{
	const char *path = input_path(test, name);
	file_write(path, bytes, size);
	return path;
}

static inline const char *input_text(const char *test, const char *name, const char *text)
{
	return input_bytes(test, name, text, strlen(text));
}

/* JSON in which ' stands for ". */
static inline const char *input_json(const char *test, const char *name, char *text)
{
	for (char *at = text; (at = strchr(at, '\'')); )
		*at = '"';
	return input_text(test, name, text);
}
