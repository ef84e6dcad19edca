/* Makes the hashes of a damaged pack fit again, so that tests and fuzzers reach what lies behind them: what a
 * malicious, not a broken, pack would look like. Payloads keep their names. */
#pragma once

#include <string.h>
#include <xxhash.h>

#include "ecofiles/format/pack_record.h"

static inline uint64_t resign_u64(const uint8_t *p)
{
	struct eco_reader r = { .bytes = p, .size = 8 };
	return eco_read_u64(&r);
}

static inline void resign_put(uint8_t *p, uint64_t v)
{
	for (int i = 0; i < 8; i++)
		p[i] = (uint8_t)(v >> (8 * i));
}

static inline void pack_resign(uint8_t *bytes, size_t size)
{
	uint8_t hashed[24 + ECO_SECTION_KIND_END * ECO_PACK_SECTION_BYTES];
	size_t count, table;
	if (size < ECO_PACK_HEADER_BYTES)
		return;
	memcpy(bytes, ECO_PACK_MAGIC, 8);
	count = bytes[12] % ECO_SECTION_KIND_END;
	table = count * ECO_PACK_SECTION_BYTES;
	if (size < ECO_PACK_HEADER_BYTES + table)
		return;
	resign_put(bytes + 16, size);
	for (size_t i = 0; i < count; i++) {
		uint8_t *record = bytes + ECO_PACK_HEADER_BYTES + i * ECO_PACK_SECTION_BYTES;
		uint64_t offset = resign_u64(record + 8), length = resign_u64(record + 16);
		if (offset <= size && length <= size - offset)
			resign_put(record + 24, record[0] == ECO_SECTION_CHUNK_DATA ? 0
				: XXH3_64bits(bytes + offset, length));
	}
	memcpy(hashed, bytes, 24);
	memcpy(hashed + 24, bytes + ECO_PACK_HEADER_BYTES, table);
	resign_put(bytes + 24, XXH3_64bits(hashed, 24 + table));
}
