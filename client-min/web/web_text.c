#include "client-min/web/web_text.h"

#include <stdarg.h>
#include <stdio.h>

const char *const web_role_names[VIEW_ROLE_COUNT] = { "triangles", "simpler triangles", "lines", "points",
	"blended triangles", "blended simpler triangles", "blended lines", "blended points", "ellipsoids",
	"impostors", "summaries" };

void web_say(struct eco_writer *text, const char *format, ...)
{
	char line[256];
	va_list arguments;
	va_start(arguments, format);
	int size = vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	eco_write_bytes(text, line, (size_t)size < sizeof line ? (size_t)size : sizeof line - 1);
}

void web_say_name(struct eco_writer *text, const char *name)
{
	web_say(text, "\"");
	for (; *name; name++)
		if (*name == '"' || *name == '\\' || (unsigned char)*name < ' ')
			web_say(text, "\\u%04x", (unsigned char)*name);
		else
			web_say(text, "%c", *name);
	web_say(text, "\"");
}
