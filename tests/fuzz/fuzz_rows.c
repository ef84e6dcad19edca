/* Tables that are read by code of our own, and the texts in them. The first byte says how the rest is read:
 * as a CSV with separator found or given, or as texts. Every row that comes out is whole; two
 * readings are the same. */
#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/rows/rows.h"

static enum eco_code open_rows(struct eco_rows **rows, uint8_t how, const char *path, struct eco_error *error)
{
	static const char separators[] = { 0, ',', ';', '\t' };

	return eco_rows_open_csv(rows, path, separators[how % 4], error);
}

/* A sum over all that was read, which must not depend on chance. */
static uint64_t read_all(uint8_t how, const char *path)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	uint64_t sum = 0;
	bool more = true;
	enum eco_code code = open_rows(&rows, how, path, &error);
	if (code != ECO_OK) {
		assert(!rows && code == error.code && error.text[0] != 0);
		return code;
	}
	assert(rows->column_count <= ECO_COLUMNS_MAX && rows->note_count <= ECO_ROWS_NOTES_MAX);
	while (rows->next(rows, &more, &error) == ECO_OK && more) {
		uint64_t row = rows->row;
		assert(rows->field_count <= ECO_COLUMNS_MAX && row > 0
			&& (rows->place.kind != ECO_PLACE_POINT || rows->has_geometry));
		for (uint32_t i = 0; i < rows->field_count; i++)
			for (const char *c = rows->fields[i]; *c != 0; c++)
				sum = sum * 31 + (unsigned char)*c;
		sum += rows->line + (uint64_t)rows->place.kind;
	}
	eco_rows_close(rows);
	return sum;
}

static void read_texts(const uint8_t *data, size_t size)
{
	char *text = malloc(size + 1), folded[100], again[100];
	double number, unit_m;
	enum eco_size_form form;
	if (!text)
		return;
	memcpy(text, data, size);
	text[size] = 0;
	eco_text_fold(text, folded, sizeof folded);
	assert(eco_text_fold(folded, again, sizeof again) <= strlen(folded));
	assert(eco_text_fits(folded, "*") && eco_text_fits("", folded)
		== (strspn(folded, "*") == strlen(folded)));
	eco_text_is_missing(text);
	for (int comma = 0; comma < 2; comma++) {
		if (eco_text_number(text, comma ? ',' : '.', &number))
			assert(isfinite(number));
		form = eco_text_size(text, comma ? ',' : '.', &number, &unit_m);
		assert(form == ECO_FORM_NONE
			|| (number >= 0 && isfinite(number) && unit_m >= 0 && unit_m <= 1));
	}
	free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	char path[64];
	int file;
	if (size == 0)
		return 0;
	if (data[0] % 8 == 7) {
		read_texts(data + 1, size - 1);
		return 0;
	}
	file = memfd_create("rows", 0);
	if (file < 0 || write(file, data + 1, size - 1) != (ssize_t)(size - 1))
		abort();
	snprintf(path, sizeof path, "/proc/self/fd/%d", file);
	assert(read_all(data[0] % 8, path) == read_all(data[0] % 8, path));
	close(file);
	return 0;
}
