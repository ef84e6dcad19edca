/* Little-endian reading and writing, byte by byte, with bounds. A reader that runs out sets `failed` and
 * returns zeros from then on: check it once at the end. A writer grows its buffer; `failed` means out of
 * memory. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct eco_reader { const uint8_t *bytes; size_t size, at; bool failed; };
struct eco_writer { uint8_t *bytes; size_t size, capacity; bool failed; };

uint8_t eco_read_u8(struct eco_reader *r);
uint16_t eco_read_u16(struct eco_reader *r);
uint32_t eco_read_u32(struct eco_reader *r);
uint64_t eco_read_u64(struct eco_reader *r);
float eco_read_f32(struct eco_reader *r);
double eco_read_f64(struct eco_reader *r);
uint64_t eco_read_varint(struct eco_reader *r);      /* LEB128, at most 10 bytes, canonical or `failed` */
int64_t eco_read_zigzag(struct eco_reader *r);
const uint8_t *eco_read_bytes(struct eco_reader *r, size_t count);   /* NULL: it ran out */

void eco_write_u8(struct eco_writer *w, uint8_t v);
void eco_write_u16(struct eco_writer *w, uint16_t v);
void eco_write_u32(struct eco_writer *w, uint32_t v);
void eco_write_u64(struct eco_writer *w, uint64_t v);
void eco_write_f32(struct eco_writer *w, float v);
void eco_write_f64(struct eco_writer *w, double v);
void eco_write_varint(struct eco_writer *w, uint64_t v);
void eco_write_zigzag(struct eco_writer *w, int64_t v);
void eco_write_bytes(struct eco_writer *w, const void *bytes, size_t count);
/* Text, printf-like, without an ending 0: cut to 511 bytes. */
void eco_write_format(struct eco_writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
void eco_writer_free(struct eco_writer *w);
