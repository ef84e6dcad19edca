#include "ecofiles/base/text.h"

#include <assert.h>
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* ---- UTF-8 ---- */

/* The lead byte tells the length and the range of the second byte; further bytes are 80..BF. */
size_t eco_utf8_bytes(const char *text, size_t size)
{
	const uint8_t *p = (const uint8_t *)text;
	uint8_t low = 0x80, high = 0xBF;
	size_t length;
	if (!size || p[0] < 0x80)
		return size && p[0];
	if (p[0] >= 0xC2 && p[0] <= 0xDF) {
		length = 2;
	} else if (p[0] >= 0xE0 && p[0] <= 0xEF) {
		length = 3;
		low = p[0] == 0xE0 ? 0xA0 : low;
		high = p[0] == 0xED ? 0x9F : high;
	} else if (p[0] >= 0xF0 && p[0] <= 0xF4) {
		length = 4;
		low = p[0] == 0xF0 ? 0x90 : low;
		high = p[0] == 0xF4 ? 0x8F : high;
	} else {
		return 0;
	}
	if (size < length || p[1] < low || p[1] > high)
		return 0;
	for (size_t i = 2; i < length; i++)
		if (p[i] < 0x80 || p[i] > 0xBF)
			return 0;
	return length;
}

size_t eco_utf8_cut(const char *text, size_t size, size_t most)
{
	size_t at = 0, length = 1;
	for (; length && at < size; at += length) {
		length = eco_utf8_bytes(text + at, size - at);
		if (length > most - at)
			break;
	}
	return at;
}

bool eco_utf8_valid(const char *text, size_t size)
{
	return eco_utf8_cut(text, size, size) == size;
}

uint32_t eco_utf8_code(const char *text, size_t bytes)
{
	static const uint8_t first[5] = { 0, 0x7f, 0x1f, 0x0f, 0x07 };
	uint32_t code = bytes ? (uint8_t)text[0] & first[bytes] : 0;
	for (size_t i = 1; i < bytes; i++)
		code = code << 6 | ((uint8_t)text[i] & 0x3f);
	return code;
}

bool eco_utf8_printable(uint32_t code)
{
	bool control = code < 0x20 || (code >= 0x7f && code < 0xa0);
	bool turns = code == 0x061c || code == 0x200e || code == 0x200f || (code >= 0x202a && code <= 0x202e)
		|| (code >= 0x2066 && code <= 0x2069);
	return !control && !turns && code != 0x2028 && code != 0x2029;
}

size_t eco_utf8_control(const char *text, size_t size)
{
	size_t bytes = eco_utf8_bytes(text, size);
	if (size > 0 && *text == 0)
		return 1;
	return bytes && !eco_utf8_printable(eco_utf8_code(text, bytes)) ? bytes : 0;
}

bool eco_utf8_has_control(const char *text, size_t size)
{
	for (size_t i = 0; i < size; i++)
		if (eco_utf8_control(text + i, size - i))
			return true;
	return false;
}

void eco_utf8_tame(char *text, const char *keep, char sign)
{
	for (size_t left = strlen(text), bytes; left > 0; text += bytes, left -= bytes) {
		bytes = eco_utf8_control(text, left);
		if (bytes && !strchr(keep, *text))
			memset(text, sign, bytes);
		bytes += !bytes;
	}
}

/* ---- Parts of messages ---- */

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

/* ---- Cells of tables ---- */

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
