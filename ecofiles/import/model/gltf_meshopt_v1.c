/* The second version of meshoptimizer's vertex codec, after the specification of KHR_meshopt_compression,
 * and its filter for colours.
 *
 *   0xa1, blocks, tail:  the vertex before the first (stride bytes), then a byte a channel (stride / 4)
 *   block: one control byte a channel, then for each of a channel's four bytes that byte of all vertices
 *
 * A channel is four bytes of a vertex. Its control byte has two bits for each of the four: groups with 0,
 * 1, 2 or 4 bits (0), or 1, 2, 4 or 8 bits (1), all zero (2), plain bytes (3). The channel's kind says
 * what the bytes are: differences of bytes (0), of 16-bit numbers (1), or rotated 32-bit exclusive ors (2)
 * with the vertex before. */
#include "ecofiles/import/model/gltf_meshopt.h"

#include <string.h>

#define BLOCK_BYTES 8192u
#define BLOCK_VERTICES 256u
#define GROUP 16u

struct input { const uint8_t *at, *end; };

/* Bytes of a group, each in `bits` bits; all ones: the byte follows in full behind the group. */
static bool decode_group(struct input *in, uint32_t bits, uint8_t to[GROUP])
{
	uint32_t packed = GROUP * bits / 8, escape = (1u << bits) - 1;
	const uint8_t *from = in->at;
	if ((size_t)(in->end - in->at) < packed)
		return false;
	in->at += packed;
	if (bits == 8)
		memcpy(to, from, GROUP);
	for (uint32_t i = 0; i < GROUP && bits < 8; i++) {
		uint32_t place = i * bits % 8, shift = bits == 1 ? place : 8 - bits - place;
		uint32_t value = bits == 0 ? 0 : (uint32_t)from[i * bits / 8] >> shift & escape;
		if (bits > 0 && value == escape) {
			if (in->at == in->end)
				return false;
			value = *in->at++;
		}
		to[i] = (uint8_t)value;
	}
	return true;
}

/* One byte of each of `count` vertices; `wide` is 0 or 1, from the control byte. */
static bool decode_groups(struct input *in, uint32_t wide, size_t count, uint8_t *to)
{
	static const uint8_t widths[5] = { 0, 1, 2, 4, 8 };
	size_t groups = (count + GROUP - 1) / GROUP, head = (groups + 3) / 4;
	const uint8_t *header = in->at;
	if ((size_t)(in->end - in->at) < head)
		return false;
	in->at += head;
	for (size_t i = 0; i < groups; i++)
		if (!decode_group(in, widths[(header[i / 4] >> (i % 4 * 2) & 3) + wide], to + i * GROUP))
			return false;
	return true;
}

static bool decode_plane(struct input *in, uint32_t control, size_t count, uint8_t *to)
{
	if (control < 2)
		return decode_groups(in, control, count, to);
	if (control == 2) {
		memset(to, 0, count);
		return true;
	}
	if ((size_t)(in->end - in->at) < count)
		return false;
	memcpy(to, in->at, count);
	in->at += count;
	return true;
}

/* Adds up `width` bytes of a channel; planes are BLOCK_VERTICES bytes each. */
static void add_differences(const uint8_t *planes, size_t count, uint32_t width, uint8_t *to, size_t stride,
	uint8_t *last)
{
	uint32_t mask = width == 1 ? 0xff : 0xffff;
	for (uint32_t k = 0; k < 4; k += width)
		for (size_t i = 0; i < count; i++) {
			uint32_t before = last[k], value = planes[k * BLOCK_VERTICES + i];
			if (width == 2) {
				before |= (uint32_t)last[k + 1] << 8;
				value |= (uint32_t)planes[(k + 1) * BLOCK_VERTICES + i] << 8;
			}
			value = ((0u - (value & 1)) ^ (value >> 1)) + before;
			value &= mask;
			for (uint32_t b = 0; b < width; b++)
				to[i * stride + k + b] = last[k + b] = (uint8_t)(value >> (8 * b));
		}
}

static void apply_xors(const uint8_t *planes, size_t count, uint32_t rotation, uint8_t *to, size_t stride,
	uint8_t *last)
{
	for (size_t i = 0; i < count; i++) {
		uint32_t value = 0;
		for (uint32_t b = 0; b < 4; b++)
			value |= (uint32_t)planes[b * BLOCK_VERTICES + i] << (8 * b);
		value = rotation == 0 ? value : value << rotation | value >> (32 - rotation);
		for (uint32_t b = 0; b < 4; b++)
			to[i * stride + b] = last[b] ^= (uint8_t)(value >> (8 * b));
	}
}

static bool decode_block(struct input *in, uint8_t *to, size_t count, size_t stride, const uint8_t *channels,
	uint8_t *last)
{
	uint8_t planes[4 * BLOCK_VERTICES];
	const uint8_t *control = in->at;
	if ((size_t)(in->end - in->at) < stride / 4)
		return false;
	in->at += stride / 4;
	for (size_t k = 0; k < stride; k += 4) {
		uint32_t kind = channels[k / 4] & 3u, turn = channels[k / 4] >> 4;
		for (uint32_t b = 0; b < 4; b++)
			if (!decode_plane(in, control[k / 4] >> (2 * b) & 3u, count,
					planes + b * BLOCK_VERTICES))
				return false;
		if (kind == 3)
			return false;
		if (kind == 2)
			apply_xors(planes, count, (32 - turn) & 31, to + k, stride, last + k);
		else
			add_differences(planes, count, kind + 1, to + k, stride, last + k);
	}
	return true;
}

bool gltf_meshopt_decode_v1(uint8_t *to, size_t count, size_t stride, const uint8_t *bytes, size_t size)
{
	size_t tail = stride + stride / 4, padded = tail < 24 ? 24 : tail,
		block = BLOCK_BYTES / stride & ~(size_t)(GROUP - 1);
	struct input in = { bytes + 1, bytes + size };
	uint8_t last[256];
	if (block > BLOCK_VERTICES)
		block = BLOCK_VERTICES;
	if (size < 1 + padded || bytes[0] != GLTF_MESHOPT_V1)
		return false;
	memcpy(last, in.end - tail, stride);
	in.end -= padded;
	for (size_t done = 0; done < count; done += block)
		if (!decode_block(&in, to + done * stride, count - done < block ? count - done : block,
				stride, bytes + size - stride / 4, last))
			return false;
	return in.at == in.end;
}

/* ---- Colours ---- */

static uint32_t clamped(double value, uint32_t most)
{
	return value <= 0 ? 0 : value >= most ? most : (uint32_t)(value + 0.5);
}

/* Luma and two chroma, scaled by a power of two less one; the top bit of alpha gives the power. */
static void undo_color(uint32_t y, int32_t co, int32_t cg, uint32_t a, uint32_t most, uint32_t rgba[4])
{
	uint32_t scale = a;
	for (int shift = 1; shift <= 8; shift *= 2)
		scale |= scale >> shift;
	double unit = scale == 0 ? 0 : (double)most / scale;
	rgba[0] = clamped(((int32_t)y + co - cg) * unit, most);
	rgba[1] = clamped(((int32_t)y + cg) * unit, most);
	rgba[2] = clamped(((int32_t)y - co - cg) * unit, most);
	rgba[3] = clamped(((a << 1 & scale) | (a & 1)) * unit, most);
}

void gltf_meshopt_filter_color(uint8_t *bytes, size_t count, size_t stride)
{
	for (size_t i = 0; i < count; i++) {
		uint8_t *p = bytes + i * stride;
		uint32_t rgba[4];
		if (stride == 4) {
			undo_color(p[0], (int8_t)p[1], (int8_t)p[2], p[3], 255, rgba);
		} else {
			undo_color(p[0] | (uint32_t)p[1] << 8, (int16_t)(p[2] | p[3] << 8),
				(int16_t)(p[4] | p[5] << 8), p[6] | (uint32_t)p[7] << 8, 65535, rgba);
		}
		for (uint32_t c = 0; c < 4; c++)
			for (uint32_t b = 0; b < stride / 4; b++)
				p[c * stride / 4 + b] = (uint8_t)(rgba[c] >> (8 * b));
	}
}
