#include "tests/support/serve/openapi.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/files.h"

/* Its paths; the text stays for ever. */
static const char *paths(void)
{
	static char *text;
	size_t size;
	if (!text) {
		text = (char *)file_read("server/openapi.yaml", &size);
		text[size - 1] = 0;
		char *end = strstr(text, "\ncomponents:");
		if (end)
			*end = 0;
	}
	return strstr(text, "\npaths:");
}

/* Text behind the line of this indentation and key, or NULL. */
static const char *find_key(const char *from, const char *end, unsigned indent, const char *key)
{
	char line[128];
	snprintf(line, sizeof line, "\n%*s%s:", (int)indent, "", key);
	const char *at = strstr(from, line);
	return at && at < end ? at + strlen(line) : NULL;
}

static const char *end_of(const char *from, unsigned indent)
{
	for (const char *at = from; (at = strchr(at, '\n')); at++)
		if (at[1] != '\n' && strspn(at + 1, " ") <= indent)
			return at;
	return from + strlen(from);
}

bool openapi_documents(const char *path, const char *method, unsigned status)
{
	char key[16] = "";
	const char *all = paths(), *at = find_key(all, all + strlen(all), 2, path);
	for (size_t i = 0; method[i] && i + 1 < sizeof key; i++)
		key[i] = (char)tolower(method[i]);
	at = at ? find_key(at, end_of(at, 2), 4, key) : NULL;
	snprintf(key, sizeof key, "\"%u\"", status);
	return at && (!status || find_key(at, end_of(at, 4), 8, key));
}

unsigned openapi_count(void)
{
	unsigned count = 0;
	for (const char *at = paths(); (at = strstr(at, "\n    ")); at++)
		count += strncmp(at + 5, "get:", 4) == 0 || strncmp(at + 5, "post:", 5) == 0;
	return count;
}
