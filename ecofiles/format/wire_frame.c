/* Frames: type, length, hash, payload. The hash also covers the frame's number, which is not sent: so a
 * frame that is lost, repeated or swapped is noticed although each frame is sound in itself. */
#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "ecofiles/format/wire.h"

#include <assert.h>
#include <string.h>

/* Bounds what decoding may take; a plan of ten thousand nested eco files stays below 1 MiB. */
#define PLAN_PAYLOAD_MAX (1u << 24)
#define SCENE_PAYLOAD_LEAST 49u
#define STRING_MAX 64u
#define BUNDLE_PAYLOAD_LEAST (1u + 2)

static const struct { const char *name; uint32_t least, most; } frames[] = {
	[ECO_FRAME_SCENE] = { "scene", SCENE_PAYLOAD_LEAST, SCENE_PAYLOAD_LEAST + STRING_MAX },
	[ECO_FRAME_BUNDLE] = { "bundle", BUNDLE_PAYLOAD_LEAST, ECO_FRAME_PAYLOAD_MAX },
	[ECO_FRAME_PLAN] = { "plan", 1, PLAN_PAYLOAD_MAX },
	[ECO_FRAME_END] = { "end", 16, 16 },
	[ECO_FRAME_AHEAD] = { "ahead", 0, 0 },
};

const char *eco_frame_name(uint32_t type)
{
	return type < sizeof frames / sizeof *frames ? frames[type].name : NULL;
}

void eco_frame_limits(enum eco_frame_type type, uint32_t *least, uint32_t *most)
{
	assert(eco_frame_name(type));
	*least = frames[type].least;
	*most = frames[type].most;
}

static void put_u32(uint8_t *p, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		p[i] = (uint8_t)(v >> (8 * i));
}

uint64_t eco_frame_hash(const uint8_t header[8], uint32_t number, const uint8_t *payload, size_t size)
{
	XXH3_state_t state;
	uint8_t head[12];
	memcpy(head, header, 8);
	put_u32(head + 8, number);
	XXH3_INITSTATE(&state);
	XXH3_64bits_reset(&state);
	XXH3_64bits_update(&state, head, sizeof head);
	XXH3_64bits_update(&state, payload, size);
	return XXH3_64bits_digest(&state);
}

struct eco_frame_mark eco_frame_begin(struct eco_writer *w, enum eco_frame_type type, uint32_t number)
{
	struct eco_frame_mark mark = { w->size, number };
	assert(eco_frame_name(type));
	eco_write_u32(w, type);
	eco_write_u32(w, 0);
	eco_write_u64(w, 0);
	return mark;
}

void eco_frame_end(struct eco_writer *w, struct eco_frame_mark mark)
{
	if (w->failed)
		return;
	assert(w->size >= mark.at + ECO_FRAME_HEADER_BYTES);
	uint8_t *header = w->bytes + mark.at;
	size_t size = w->size - mark.at - ECO_FRAME_HEADER_BYTES;
	uint32_t least, most;
	eco_frame_limits(header[0], &least, &most);
	if (size < least || size > most) {
		w->failed = true;
		return;
	}
	put_u32(header + 4, (uint32_t)size);
	uint64_t hash = eco_frame_hash(header, mark.number, header + ECO_FRAME_HEADER_BYTES, size);
	put_u32(header + 8, (uint32_t)hash);
	put_u32(header + 12, (uint32_t)(hash >> 32));
}
