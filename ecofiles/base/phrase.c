#include "ecofiles/base/phrase.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* The words that eco_phrase_add wrote for names that did not fit; NULL: all fitted. */
static char *find_rest(char *list, uint32_t *missing)
{
	char *rest = NULL;
	int used = 0;
	for (char *at = list; (at = strstr(at, " and ")); at++)
		rest = at;
	if (rest && sscanf(rest, " and %" SCNu32 " more%n", missing, &used) == 1 && used > 0 && !rest[used])
		return rest;
	return sscanf(list, "%" SCNu32 " more%n", missing, &used) == 1 && used > 0 && !list[used] ? list : NULL;
}

void eco_phrase_add(char *list, size_t size, const char *name)
{
	size_t used = strlen(list);
	uint32_t missing = 0;
	char *rest = find_rest(list, &missing);
	assert(size >= 32);
	if (!rest && used + strlen(", ") + strlen(name) + sizeof " and 4294967295 more" <= size) {
		snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", name);
		return;
	}
	rest = rest ? rest : list + used;
	snprintf(rest, size - (size_t)(rest - list), "%s%" PRIu32 " more", rest > list ? " and " : "", missing + 1);
}

void eco_phrase_cut(char *text, size_t size, int wanted)
{
	static const char dots[] = " ...";
	if (wanted < 0 || (size_t)wanted < size)
		return;
	size_t end = size - sizeof dots;
	while (end > 0 && text[end] != ' ')
		end--;
	memcpy(text + (end > 0 ? end : size - sizeof dots), dots, sizeof dots);
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
