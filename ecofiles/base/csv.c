#include "ecofiles/base/csv.h"

#include <string.h>

/* Fullwidth signs are taken for the plain ones by some spreadsheets. */
static int begins_formula(const char *text)
{
	static const char *const signs[] = { "\xef\xbc\x9d", "\xef\xbc\x8b", "\xef\xbc\x8d", "\xef\xbc\xa0" };
	text += strspn(text, " ");
	for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
		if (strncmp(text, signs[i], 3) == 0)
			return 1;
	return *text != 0 && strchr("=+-@\t\r\n", *text) != NULL;
}

void eco_csv_write_text(FILE *out, const char *text)
{
	int formula = begins_formula(text), quoted = text[strcspn(text, ",;\"\t\r\n")] != 0;
	if (quoted)
		fputc('"', out);
	if (formula)
		fputc('\'', out);
	for (; *text; text++)
		fprintf(out, *text == '"' ? "\"\"" : "%c", *text);
	if (quoted)
		fputc('"', out);
}
