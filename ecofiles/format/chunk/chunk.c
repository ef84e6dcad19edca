/* Chunks without their coding: kinds and coders that go together, draw order, sizes, and the payload's
 * frame. */
#include "ecofiles/format/chunk/chunk.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/base/random.h"

#define PAYLOAD_VERSION 1u
#define PAYLOAD_ALONE 3u         /* low bits of a byte that also has coder and corners */
#define CODER_AT 2
#define CORNERS_AT 5

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

struct eco_chunk_id eco_chunk_hash(const uint8_t *bytes, size_t size_bytes)
{
	XXH128_canonical_t canonical;
	struct eco_chunk_id id;
	XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes, size_bytes));
	memcpy(id.bytes, canonical.digest, sizeof id.bytes);
	return id;
}

/* Fisher-Yates. Scaling 32 random bits to the range by a multiplication is biased by at most count / 2^32. */
void eco_chunk_permutation(uint32_t ordinal, uint32_t count, uint32_t *order)
{
	uint64_t state = 0x65636f73u + ((uint64_t)ordinal << 32);
	for (uint32_t i = 0; i < count; i++)
		order[i] = i;
	for (uint32_t i = count; i > 1; i--) {
		uint32_t j = (uint32_t)((eco_random_next(&state) >> 32) * i >> 32);
		uint32_t kept = order[j];
		order[j] = order[i - 1];
		order[i - 1] = kept;
	}
}

/* Counts the chunks; fills ends unless it is NULL. */
static uint32_t split(uint64_t count, uint64_t smallest, uint64_t growth_percent, uint64_t largest,
	uint32_t *ends)
{
	uint32_t n = 0;
	for (uint64_t sent = 0; sent < count; n++) {
		uint64_t size = sent * growth_percent / 100;
		size = size < smallest ? smallest : size;
		size = size > largest ? largest : size;
		/* A remainder below half a chunk joins this one. */
		if (count - sent <= size + size / 2)
			size = count - sent <= largest ? count - sent : (count - sent + 1) / 2;
		sent += size;
		if (ends)
			ends[n] = (uint32_t)sent;
	}
	return n;
}

uint32_t eco_chunk_split(uint32_t element_count, uint32_t smallest, uint32_t *ends, uint32_t max)
{
	uint64_t first = smallest < 1 ? 1 : smallest, growth = 25, largest = 1u << 16;
	if (element_count == 0)
		return 0;
	assert(max >= 1 && (uint64_t)max * ECO_CHUNK_ELEMENTS_MAX >= element_count);
	if (first > largest)
		first = largest;
	while (split(element_count, first, growth, largest, NULL) > max) {
		first = 2 * first > ECO_CHUNK_ELEMENTS_MAX ? ECO_CHUNK_ELEMENTS_MAX : 2 * first;
		largest = 2 * largest > ECO_CHUNK_ELEMENTS_MAX ? ECO_CHUNK_ELEMENTS_MAX : 2 * largest;
		growth *= 2;
	}
	return split(element_count, first, growth, largest, ends);
}

uint32_t eco_corners_primitives(uint8_t corners)
{
	return corners < 3 ? 1 : corners - 2u;
}

bool eco_list_allows_corners(const struct eco_list *list, uint8_t corners)
{
	if (list->kind == ECO_LIST_TRIANGLES)
		return corners >= 3
			&& corners <= (list->coder == ECO_CODER_MESH ? 3 : list->coder == ECO_CODER_FORM ? 4
			: ECO_CORNERS_MAX);
	return corners == (list->kind == ECO_LIST_LINES ? 2 : 1);
}

const char *eco_list_coding_fault(const struct eco_list *list)
{
	static const struct { uint8_t coders, attributes; } allowed[] = {
#define CODER(name) (1u << ECO_CODER_##name)
		[ECO_LIST_TRIANGLES] = { CODER(ELEMENTS) | CODER(MESH) | CODER(FORM),
			ECO_ATTR_COLOR | ECO_ATTR_UV | ECO_ATTR_GROWTH },
		[ECO_LIST_LINES] =
		{ CODER(ELEMENTS) | CODER(FORM), ECO_ATTR_COLOR | ECO_ATTR_UV | ECO_ATTR_WIDTH },
		[ECO_LIST_POINTS] = { CODER(ELEMENTS) | CODER(KD) | CODER(ROWS) | CODER(FORM),
			ECO_ATTR_COLOR | ECO_ATTR_UV | ECO_ATTR_PLANT | ECO_ATTR_SIZE | ECO_ATTR_SPLAT },
		[ECO_LIST_INSTANCES] = { CODER(ROWS), ECO_ATTR_COLOR | ECO_ATTR_WIDTH | ECO_ATTR_PLACE },
		[ECO_LIST_GROUND] = { CODER(ROWS), 0 },
		[ECO_LIST_IMAGE] = { CODER(BYTES), 0 },
		[ECO_LIST_IMPOSTOR] = { CODER(BYTES), 0 },
		[ECO_LIST_OUTLINE] = { CODER(BYTES), 0 },
		[ECO_LIST_GROUND_IMAGE] = { CODER(BYTES), 0 },
		[ECO_LIST_INVENTORY] = { CODER(BYTES), 0 },
#undef CODER
	};

	if (list->kind < ECO_LIST_TRIANGLES || list->kind > ECO_LIST_INVENTORY)
		return "its kind is unknown";
	if (list->coder < ECO_CODER_ELEMENTS || list->coder > ECO_CODER_BYTES
			|| !(allowed[list->kind].coders >> list->coder & 1))
		return "its kind cannot have its coder";
	return list->attributes & ~allowed[list->kind].attributes
		|| (list->attributes & ECO_ATTR_SPLAT && list->attributes & (ECO_ATTR_SIZE | ECO_ATTR_UV))
		|| (list->kind == ECO_LIST_INSTANCES && !(list->attributes & ECO_ATTR_PLACE))
		? "its kind cannot have its attributes" : NULL;
}

/* The rest behind the first byte. */
static enum eco_code read_alone(struct eco_payload *payload, uint8_t first, struct eco_reader *r,
	struct eco_error *error)
{
	struct eco_stream *s = &payload->streams[0];
	payload->coder = first >> CODER_AT & 7;
	payload->stream_count = 1;
	s->corners = first >> CORNERS_AT;
	s->zeros = eco_read_u8(r);
	uint8_t flags = eco_read_u8(r);
	s->shift = flags >> 1 & 7;
	s->uv_shift = flags >> 4;
	s->predictors = s->corners > 2 ? eco_read_u16(r) : 0;
	bool known = payload->coder == ECO_CODER_ELEMENTS || payload->coder == ECO_CODER_FORM
		|| payload->coder == ECO_CODER_KD || payload->coder == ECO_CODER_ROWS;
	if (r->failed || !known || (flags & 1) || s->corners < 1 || s->corners > ECO_CORNERS_MAX)
		return BAD("chunk: rows of coder %u with %u corners are impossible", payload->coder, s->corners);
	s->bytes = r->bytes + r->at;
	s->size = r->size - r->at;
	return ECO_OK;
}

enum eco_code eco_payload_read(struct eco_payload *payload, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	uint8_t version = eco_read_u8(&r), last_corners = 0, reserved;
	memset(payload, 0, sizeof *payload);
	if (!r.failed && (version & 3) == PAYLOAD_ALONE)
		return read_alone(payload, version, &r, error);
	payload->coder = eco_read_u8(&r);
	payload->stream_count = eco_read_u8(&r);
	reserved = eco_read_u8(&r);
	if (r.failed || version != PAYLOAD_VERSION || (reserved != 0 && payload->coder != ECO_CODER_SHAPES))
		return BAD("chunk: version %u of a payload of %zu bytes is unknown", version, size);
	if (payload->coder == ECO_CODER_SHAPES && payload->stream_count == 0 && size > r.at) {
		payload->stream_count = 1;
		payload->streams[0] = (struct eco_stream){ .zeros = reserved, .bytes = bytes + r.at,
			.size = size - r.at };
		return ECO_OK;
	}
	if (payload->coder == ECO_CODER_SHAPES || payload->stream_count < (payload->coder == ECO_CODER_MESH ? 1 : 2)
			|| payload->stream_count > ECO_PAYLOAD_STREAMS_MAX)
		return BAD("chunk: %u streams", payload->stream_count);
	for (uint32_t i = 0; i < payload->stream_count; i++) {
		struct eco_stream *s = &payload->streams[i];
		s->corners = eco_read_u8(&r);
		uint8_t flags = eco_read_u8(&r);
		s->zeros = eco_read_u8(&r);
		s->predictors = eco_read_u16(&r);
		s->elements = eco_read_u32(&r);
		s->size = eco_read_u32(&r);
		if (r.failed || (flags & 1) || s->corners <= last_corners || s->corners > ECO_CORNERS_MAX || s->elements == 0
				|| s->elements > ECO_CHUNK_ELEMENTS_MAX || s->size == 0)
			return BAD("chunk: record of stream %u is impossible", i);
		s->shift = flags >> 1 & 7;
		s->uv_shift = flags >> 4;
		last_corners = s->corners;
	}
	for (uint32_t i = 0; i < payload->stream_count; i++)
		payload->streams[i].bytes = eco_read_bytes(&r, payload->streams[i].size);
	if (r.failed || r.at != r.size)
		return BAD("chunk: the streams do not fill the payload's %zu bytes", size);
	return ECO_OK;
}

static void write_alone(struct eco_writer *w, const struct eco_payload *payload)
{
	const struct eco_stream *s = &payload->streams[0];
	eco_write_u8(w, (uint8_t)(PAYLOAD_ALONE | payload->coder << CODER_AT | s->corners << CORNERS_AT));
	eco_write_u8(w, s->zeros);
	eco_write_u8(w, (uint8_t)(s->shift << 1 | s->uv_shift << 4));
	if (s->corners > 2)
		eco_write_u16(w, s->predictors);
}

static void write_records(struct eco_writer *w, const struct eco_payload *payload)
{
	eco_write_u8(w, PAYLOAD_VERSION);
	eco_write_u8(w, payload->coder);
	eco_write_u8(w, payload->coder == ECO_CODER_SHAPES ? 0 : (uint8_t)payload->stream_count);
	eco_write_u8(w, payload->coder == ECO_CODER_SHAPES ? payload->streams[0].zeros : 0);
	for (uint32_t i = 0; i < payload->stream_count && payload->coder != ECO_CODER_SHAPES; i++) {
		const struct eco_stream *s = &payload->streams[i];
		eco_write_u8(w, s->corners);
		eco_write_u8(w, (uint8_t)(s->shift << 1 | s->uv_shift << 4));
		eco_write_u8(w, s->zeros);
		eco_write_u16(w, s->predictors);
		eco_write_u32(w, s->elements);
		eco_write_u32(w, (uint32_t)s->size);
	}
}

void eco_payload_write(const struct eco_payload *payload, struct eco_writer *w)
{
	assert(payload->stream_count >= 1 && payload->stream_count <= ECO_PAYLOAD_STREAMS_MAX);
	if (eco_payload_alone(payload))
		write_alone(w, payload);
	else
		write_records(w, payload);
	for (uint32_t i = 0; i < payload->stream_count; i++)
		eco_write_bytes(w, payload->streams[i].bytes, payload->streams[i].size);
}

void eco_payload_free_streams(struct eco_payload *payload)
{
	for (uint32_t i = 0; i < payload->stream_count; i++)
		free((void *)payload->streams[i].bytes);
	memset(payload, 0, sizeof *payload);
}
