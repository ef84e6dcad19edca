/* All formats of this project are read and written by these functions. take and grow alone compare with
 * bounds, so that no parser compares an offset by hand. */
#include "ecofiles/base/bytes.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t *take(struct eco_reader *r, size_t count)
{
	if (r->failed || r->at > r->size || count > r->size - r->at) {
		r->failed = true;
		return NULL;
	}
	const uint8_t *p = r->bytes + r->at;
	r->at += count;
	return p;
}

static uint64_t read_little(struct eco_reader *r, size_t count)
{
	const uint8_t *p = take(r, count);
	uint64_t v = 0;
	if (!p)
		return 0;
	for (size_t i = 0; i < count; i++)
		v |= (uint64_t)p[i] << (8 * i);
	return v;
}

uint64_t eco_read_varint(struct eco_reader *r)
{
	uint64_t v = 0;
	for (unsigned shift = 0; shift < 70; shift += 7) {
		const uint8_t *p = take(r, 1);
		if (!p)
			return 0;
		/* The tenth byte holds one bit; a zero last byte would be a second spelling of the same
		 * number. */
		if ((shift == 63 && *p > 1) || (shift > 0 && *p == 0))
			break;
		v |= (uint64_t)(*p & 0x7f) << shift;
		if (*p < 0x80)
			return v;
	}
	r->failed = true;
	return 0;
}

int64_t eco_read_zigzag(struct eco_reader *r)
{
	uint64_t v = eco_read_varint(r);
	return (int64_t)(v >> 1) ^ -(int64_t)(v & 1);
}

const uint8_t *eco_read_bytes(struct eco_reader *r, size_t count)
{
	return take(r, count);
}

static uint8_t *grow(struct eco_writer *w, size_t count)
{
	if (w->failed || count > SIZE_MAX / 2 - w->size) {
		w->failed = true;
		return NULL;
	}
	if (!w->bytes || w->size + count > w->capacity) {
		size_t capacity = w->capacity < 64 ? 64 : w->capacity;
		uint8_t *bytes;
		while (capacity < w->size + count)
			capacity *= 2;
		bytes = realloc(w->bytes, capacity);
		if (!bytes) {
			w->failed = true;
			return NULL;
		}
		w->bytes = bytes;
		w->capacity = capacity;
	}
	w->size += count;
	return w->bytes + w->size - count;
}

static void write_little(struct eco_writer *w, uint64_t v, size_t count)
{
	uint8_t *p = grow(w, count);
	if (!p)
		return;
	for (size_t i = 0; i < count; i++)
		p[i] = (uint8_t)(v >> (8 * i));
}

#define INTEGER(bits) \
	uint##bits##_t eco_read_u##bits(struct eco_reader *r) { return (uint##bits##_t)read_little(r, bits / 8); } \
	void eco_write_u##bits(struct eco_writer *w, uint##bits##_t v) { write_little(w, v, bits / 8); }
#define REAL(type, bits) \
	type eco_read_f##bits(struct eco_reader *r) \
	{ \
		uint##bits##_t code = eco_read_u##bits(r); \
		type v; \
		memcpy(&v, &code, sizeof v); \
		return v; \
	} \
	void eco_write_f##bits(struct eco_writer *w, type v) \
	{ \
		uint##bits##_t code; \
		memcpy(&code, &v, sizeof code); \
		eco_write_u##bits(w, code); \
	}
INTEGER(8)
INTEGER(16)
INTEGER(32)
INTEGER(64)
REAL(float, 32)
REAL(double, 64)

void eco_write_varint(struct eco_writer *w, uint64_t v)
{
	while (v >= 0x80) {
		eco_write_u8(w, (uint8_t)(v | 0x80));
		v >>= 7;
	}
	eco_write_u8(w, (uint8_t)v);
}

void eco_write_zigzag(struct eco_writer *w, int64_t v)
{
	eco_write_varint(w, ((uint64_t)v << 1) ^ (v < 0 ? UINT64_MAX : 0));
}

void eco_write_bytes(struct eco_writer *w, const void *bytes, size_t count)
{
	uint8_t *p = grow(w, count);
	if (p && count > 0)
		memcpy(p, bytes, count);
}

void eco_write_format(struct eco_writer *w, const char *format, ...)
{
	char text[512];
	va_list arguments;
	va_start(arguments, format);
	int size = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	if (size > 0)
		eco_write_bytes(w, text, (size_t)size < sizeof text ? (size_t)size : sizeof text - 1);
}

void eco_writer_free(struct eco_writer *w)
{
	free(w->bytes);
	memset(w, 0, sizeof *w);
}
