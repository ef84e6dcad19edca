/* The stream parser. The first byte says what the rest is:
 *
 *   0   a stream as it is, mostly to shake the frame assembler
 *   1   frames without hashes, { u8 type, u16 length, payload }: here they get their hashes, lengths and
 *       chunk ids, so that a fuzzer
 *       reaches the readers behind them
 *   2   one PLAN payload
 *
 * A stream is fed whole and in portions of the second byte + 1, which must not make a difference. */
#include <assert.h>
#include <string.h>

#include "tests/support/wire_random.h"

static void parse_twice(const uint8_t *bytes, size_t size, size_t portion)
{
	struct wire_told whole = { 0 }, parts = { 0 };
	struct eco_error error = { 0 }, again = { 0 };
	enum eco_code code = wire_tell(bytes, size, size ? size : 1, &whole, &error);
	assert(code == error.code && (code == ECO_OK || error.text[0]));
	assert(wire_tell(bytes, size, portion, &parts, &again) == code);
	assert(whole.events == parts.events && whole.w.size == parts.w.size);
	assert(!whole.w.size || memcmp(whole.w.bytes, parts.w.bytes, whole.w.size) == 0);
	eco_writer_free(&whole.w);
	eco_writer_free(&parts.w);
}

/* An END's byte count is right. */
static void mend(struct eco_writer *w, struct eco_frame_mark mark, uint8_t type)
{
	uint8_t *payload = w->bytes + mark.at + ECO_FRAME_HEADER_BYTES;
	size_t size = w->size - mark.at - ECO_FRAME_HEADER_BYTES;
	for (size_t i = 0; type == ECO_FRAME_END && size == 16 && i < 8; i++)
		payload[8 + i] = (uint8_t)((uint64_t)w->size >> (8 * i));
}

static void parse_frames(const uint8_t *bytes, size_t size, size_t portion)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	struct eco_writer w = { 0 };
	for (uint32_t number = 0; r.at < r.size && !r.failed; number++) {
		uint8_t type = eco_read_u8(&r);
		uint16_t length = eco_read_u16(&r);
		const uint8_t *payload = eco_read_bytes(&r, length);
		if (!payload || !eco_frame_name(type))
			break;
		struct eco_frame_mark mark = eco_frame_begin(&w, type, number);
		eco_write_bytes(&w, payload, length);
		if (w.failed)
			break;
		mend(&w, mark, type);
		eco_frame_end(&w, mark);
		if (w.failed)
			break;
	}
	if (!w.failed)
		parse_twice(w.bytes, w.size, portion);
	eco_writer_free(&w);
}

static void read_plan(const uint8_t *bytes, size_t size)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	struct eco_plan plan;
	if (eco_wire_read_plan(&r, &plan, NULL))
		return;
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, &plan);
	assert(!w.failed && w.size == r.at && memcmp(w.bytes, bytes, w.size) == 0);
	eco_writer_free(&w);
	eco_plan_free(&plan);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	if (size < 2)
		return 0;
	if (bytes[0] == 0)
		parse_twice(bytes + 2, size - 2, bytes[1] + 1u);
	else if (bytes[0] == 1)
		parse_frames(bytes + 2, size - 2, bytes[1] + 1u);
	else
		read_plan(bytes + 1, size - 1);
	return 0;
}
