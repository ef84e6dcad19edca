#include "client-min/web/web_text.h"

void web_say_name(struct eco_writer *text, const char *name)
{
	eco_write_format(text, "\"");
	for (; *name; name++)
		if (*name == '"' || *name == '\\' || (unsigned char)*name < ' ')
			eco_write_format(text, "\\u%04x", (unsigned char)*name);
		else
			eco_write_format(text, "%c", *name);
	eco_write_format(text, "\"");
}
