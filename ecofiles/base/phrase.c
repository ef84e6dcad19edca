#include "ecofiles/base/phrase.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

void eco_phrase_add(char *list, size_t size, const char *name)
{
	static const char more[] = ", ...";
	size_t used = strlen(list), length = strlen(name);
	assert(size > sizeof more);
	if (used >= sizeof more - 1 && strcmp(list + used - (sizeof more - 1), more) == 0)
		return;
	if (used + 2 + length + sizeof more <= size)
		snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", name);
	else if (used + sizeof more <= size)
		strcpy(list + used, used > 0 ? more : more + 2);
}

const char *eco_phrase_count(uint64_t count, char text[32])
{
	char digits[24];
	int length = snprintf(digits, sizeof digits, "%" PRIu64, count), used = 0;
	for (int i = 0; i < length; i++) {
		if (i > 0 && (length - i) % 3 == 0)
			text[used++] = ',';
		text[used++] = digits[i];
	}
	text[used] = 0;
	return text;
}

const char *eco_path_last(const char *path)
{
	const char *last = path;
	for (const char *at = path; *at != 0; at++)
		if ((*at == '/' || *at == '\\') && at[1] != 0)
			last = at + 1;
	return last;
}
