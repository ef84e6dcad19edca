#include "ecofiles/base/utf8.h"

#include <stdint.h>
#include <string.h>

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
