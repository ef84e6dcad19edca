/* Random elements of every kind of list, for every coder, and how what was decoded is compared with what went
 * in. */
#pragma once

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "tests/support/unit_test.h"

#define VALUE_MAX ((1 << 28) - 1)

enum pattern { SCATTERED, EQUAL, EXTREME, LEAVES };

struct kind {
	const char *name;
	uint8_t kind, coder, attributes, low_corners, high_corners;
	uint32_t count;
	int32_t low, high;           /* of coordinates */
	enum pattern pattern;
};

#define KIND_COUNT 37u
extern const struct kind kinds[KIND_COUNT];

struct eco_list kind_list(const struct kind *k);
struct eco_elements kind_elements(const struct kind *k, uint32_t count, uint64_t seed);
struct eco_chunk kind_chunk(const struct eco_elements *e, uint32_t first, uint32_t end, size_t size);
/* Forms are coded as those of triangles that all lie in one place, which keeps their order. */
enum eco_code kind_encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size,
	struct eco_error *error);
/* The decoded elements are [first, end) of those encoded: in `order`, or in any. */
void assert_same_elements(const struct kind *k, const struct eco_elements *in, uint32_t first, uint32_t end,
	const struct eco_elements *out, const uint32_t *order);
bool kind_ordered(const struct kind *k);
