/* Targets that read formats of our own: files, payloads and the wire. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/texture.h"
#include "ecofiles/format/view.h"
#include "ecofiles/format/wire.h"
#include "lod/ground_choice.h"
#include "lod/impostor.h"
#include "server/stream.h"
#include "tests/fuzz/fuzz.h"
#include "tests/support/chunk_kinds.h"
#include "tests/support/pack_resign.h"
#include "tests/support/wire_random.h"

/* Camera scripts: whatever parses gives frames in ascending time that can be drawn. */
void fuzz_camera(const uint8_t *bytes, size_t size)
{
	struct eco_camera *camera;
	struct eco_error error = { 0 };
	enum eco_code code = eco_camera_parse(&camera, (const char *)bytes, size, "camera.json", &error);
	assert(code == error.code && (code == ECO_OK) == (camera != NULL));
	if (code)
		return;
	uint32_t count = eco_camera_frame_count(camera), step = count / 100 + 1;
	double before = 0;
	assert(count > 0);
	for (uint32_t i = 0; i < count; i += step) {
		struct eco_view view = { .width = 4, .height = 3 };
		double time_s = eco_camera_frame(camera, i, &view);
		assert(i == 0 || time_s > before);
		assert(eco_view_check(&view, NULL) == ECO_OK);
		before = time_s;
	}
	eco_camera_free(camera);
}

static void check_elements(const struct eco_list *list, const struct eco_chunk *chunk, const struct eco_elements *e)
{
	const int32_t bound = (1 << 28) - 1;
	uint32_t corners = 0;
	assert(e->element_count == chunk->element_count && e->primitive_count == chunk->primitive_count);
	for (uint32_t i = 0; i < e->element_count; i++)
		corners += e->corners[i];
	assert(corners == e->corner_count);
	for (size_t i = 0; i < 3 * (size_t)corners; i++)
		assert(e->position[i] <= bound && e->position[i] >= -bound);
	assert((e->uv != NULL) == ((list->attributes & ECO_ATTR_UV) != 0));
	for (size_t i = 0; e->uv && i < 2 * (size_t)corners; i++)
		assert(e->uv[i] <= bound && e->uv[i] >= -bound);
	for (size_t i = 0; i < (size_t)e->element_count * e->extra_count; i++)
		assert(e->extra[i] <= bound && e->extra[i] >= -bound);
}

static void encode_again(const struct eco_list *list, const struct eco_elements *e)
{
	const struct eco_chunk_input input = { list, e, 0, e->element_count, 3 };
	struct eco_error error = { 0 };
	uint8_t *bytes;
	size_t size;
	assert(kind_encode(&input, &bytes, &size, &error) == ECO_OK);
	free(bytes);
}

/* Payloads without their hash: what a decoder must withstand if everything else is forged. The first bytes
 * choose the list and the declared counts: u8 kind, u8 coder, u8 attributes, u8 columns, u16 elements, u16
 * primitives; the rest is the payload. A payload that decodes must keep its promises: counts as declared,
 * values in bounds, and it must encode again. */
void fuzz_chunk(const uint8_t *bytes, size_t size)
{
	struct eco_list list;
	struct eco_chunk chunk;
	struct eco_elements elements;
	if (size < 8)
		return;
	list = (struct eco_list){ .kind = bytes[0], .coder = bytes[1], .attributes = bytes[2],
		.columns = bytes[3] };
	chunk = (struct eco_chunk){ .size_bytes = (uint32_t)(size - 8),
		.element_count = bytes[4] | (uint32_t)bytes[5] << 8,
		.primitive_count = bytes[6] | (uint32_t)bytes[7] << 8 };
	if (eco_chunk_decode(&list, &chunk, 3, bytes + 8, size - 8, &elements, NULL) == ECO_OK) {
		check_elements(&list, &chunk, &elements);
		encode_again(&list, &elements);
	}
	eco_elements_free(&elements);
}

/* Holdings that a stranger posts. If they are accepted they are sorted, and have exactly these bytes. A scene
 * accepts only those that it has. */
void fuzz_holdings(const uint8_t *bytes, size_t size)
{
	static const struct eco_list lists[4] = { { .chunk_count = 1 }, { .chunk_count = 300 },
		{ .chunk_count = 0 }, { .chunk_count = 7 } };
	const struct eco_scene scene = { .lists = lists, .list_count = 4 };
	struct eco_holdings holdings;
	struct eco_error error = { 0 };
	enum eco_code code = eco_wire_read_holdings(bytes, size, &holdings, &error);
	assert(code == error.code);
	if (code) {
		assert(error.text[0] && !holdings.items && !holdings.count);
		return;
	}
	struct eco_writer w = { 0 };
	eco_wire_write_holdings(&w, &holdings);
	assert(!w.failed && w.size == size && memcmp(w.bytes, bytes, size) == 0);
	bool held = !srv_holdings_check(&scene, &holdings, NULL);
	for (uint32_t i = 0; i < holdings.count; i++) {
		assert(!held || holdings.items[i].chunks <= lists[holdings.items[i].list].chunk_count);
		assert(i == 0 || holdings.items[i].list > holdings.items[i - 1].list);
		assert(holdings.items[i].chunks > 0 && eco_holdings_chunks(&holdings, holdings.items[i].list)
			== holdings.items[i].chunks);
	}
	eco_writer_free(&w);
	free(holdings.items);
}

#define LEVEL_AT 24u                     /* of its bytes: after the body */
#define FINE_EVERY 32u                   /* sizes of inputs of which one may be of a finer level */

static void assert_same(const struct eco_impostor_level *a, const struct eco_impostor_level *b)
{
	const struct eco_impostor_size *s = &eco_impostor_sizes[a->level];
	size_t tiles = eco_impostor_tiles(s->set), few = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	assert(a->level == b->level && memcmp(a->texel, b->texel, tiles * s->texels * s->texels) == 0);
	assert(memcmp(a->depth, b->depth, tiles * s->depths * s->depths) == 0);
	assert(memcmp(a->color, b->color, few * s->colors * s->colors * 3) == 0);
}

static void look_around(const struct lod_impostor *impostor)
{
	for (int i = 0; i < 27; i++) {
		const float far = 3 * impostor->radius, eye[3] = { far * (float)(i % 3 - 1),
			far * (float)(i / 3 % 3 - 1), far * (float)(i / 9 - 1) }, ray[3] = { -eye[0], -eye[1],
			-eye[2] };
		struct lod_impostor_look look;
		struct lod_impostor_hit hit;
		lod_impostor_look(&look, impostor, eye);
		assert(!lod_impostor_hit(impostor, &look, ray, &hit) || hit.cell < impostor->cell_count);
	}
}

/* Levels of impostors, with the body before them: what is read can be written, and is then read as the same;
 * and drawn. */
void fuzz_impostor(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_impostor_body body;
	struct eco_impostor_level level, again;
	struct lod_impostor impostor;
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
	/* code that all levels share takes 3 ms for the coarsest, 36 and 180 ms for those after it */
	if (size > LEVEL_AT && bytes[LEVEL_AT] > (size % FINE_EVERY == 0))
		return;
#endif
	enum eco_code code = eco_impostor_level_read(&level, &body, bytes, size, &error);
	assert(code == error.code);
	if (code)
		return;
	struct eco_writer w = { 0 };
	code = eco_impostor_level_write(&w, &body, &level, NULL, &error);
	assert(!code);
	if (w.size != size || memcmp(w.bytes, bytes, size) != 0) { /* else it would be read as before */
		code = eco_impostor_level_read(&again, &body, w.bytes, w.size, &error);
		assert(!code);
		assert_same(&level, &again);
		eco_impostor_level_free(&again);
	}
	code = lod_impostor_open(&impostor, &body, &level, &error);
	assert(!code);
	look_around(&impostor);
	lod_impostor_close(&impostor);
	eco_impostor_level_free(&level);
	eco_writer_free(&w);
}

/* The payload's hash is passed over here, too. */
static void read_rows(const struct eco_pack *pack, const struct eco_chunk *chunk, uint32_t ordinal)
{
	uint64_t left = pack->scene.place_count - (uint64_t)ordinal * ECO_INVENTORY_PLACES;
	uint32_t count = left < ECO_INVENTORY_PLACES ? (uint32_t)left : ECO_INVENTORY_PLACES;
	struct eco_inventory_block block;
	if (eco_inventory_decode(&block, pack->map + chunk->offset, chunk->size_bytes, count, NULL) == ECO_OK)
		for (uint32_t i = 0; i < count; i++)
			assert(!block.rows[i].file == !block.rows[i].row
				&& (!block.rows[i].species || block.rows[i].species[0]));
	eco_inventory_free(&block);
}

static void read_chunks(const struct eco_pack *pack, const struct eco_list *list)
{
	for (uint32_t i = 0; i < list->chunk_count && i < 8; i++) {
		const struct eco_chunk *chunk = &pack->scene.chunks[list->chunk_first + i];
		struct eco_elements elements;
		const uint8_t *payload;
		size_t size;
		eco_pack_payload(pack, list->chunk_first + i, &payload, &size, NULL);
		if (list->kind == ECO_LIST_INVENTORY)
			read_rows(pack, chunk, i);
		if (list->coder == ECO_CODER_BYTES || chunk->element_count > 4096)
			continue;
		/* The payload's hash is passed over on purpose. */
		eco_chunk_decode(list, chunk, i, pack->map + chunk->offset, chunk->size_bytes, &elements,
			NULL);
		eco_elements_free(&elements);
	}
}

/* Any table of ground that passes must be safe to walk. */
static void choose_ground(const struct eco_scene *s)
{
	const struct eco_view view = { { 3, -4, 9 }, { 20, 30, 0 }, { 0, 0, 1 }, 60, 640, 480 };
	const struct lod_ground_limits limits = { .tolerance_px = 0.5 };
	struct lod_ground_choice choice;
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	if (lod_ground_select(&choice, s, &eye, &limits, NULL) != ECO_OK)
		return;
	for (uint32_t i = 0; i < choice.count; i++)
		assert(choice.tiles[i] < s->ground_count
			&& (i == 0 || choice.tiles[i] > choice.tiles[i - 1]));
	free(choice.tiles);
}

static void read_all(const struct eco_pack *pack)
{
	const struct eco_scene *s = &pack->scene;
	uint64_t sum = 0;
	for (uint32_t i = 0; i < s->list_count && i < 64; i++)
		read_chunks(pack, &s->lists[i]);
	for (uint64_t i = 0; i < s->place_count; i++)
		sum += eco_place_read(s, i).scale;
	for (uint32_t i = 0; i < s->palette_count; i++)
		sum += s->palette[i][2];
	for (size_t i = 0; i < pack->meta_size; i++)
		sum += (unsigned char)pack->meta[i];
	choose_ground(s);
	assert(sum < UINT64_MAX);
}

static void open_and_read(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_pack *pack;
	if (eco_pack_open_memory(&pack, bytes, size, &error) == ECO_OK) {
		read_all(pack);
		eco_pack_close(pack);
	} else {
		assert(!pack && error.text[0] != 0);
	}
}

/* Packs, as they are and with their hashes made to fit, which is what opens the way to the tables' checks. A
 * pack that opens must be consistent enough to read everything in it. */
void fuzz_pack(const uint8_t *bytes, size_t size)
{
	uint8_t *copy = malloc(size > 0 ? size : 1);
	if (!copy)
		return;
	open_and_read(bytes, size);
	memcpy(copy, bytes, size);
	pack_resign(copy, size);
	open_and_read(copy, size);
	free(copy);
}

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

/* The stream parser. The first byte says what the rest is:
 *
 *   0   a stream as it is, mostly to shake the frame assembler
 *   1   frames without hashes, { u8 type, u16 length, payload }: here they get their hashes, lengths and
 *       chunk ids, so that a fuzzer
 *       reaches the readers behind them
 *   2   one PLAN payload
 *
 * A stream is fed whole and in portions of the second byte + 1, which must not make a difference. */
void fuzz_stream(const uint8_t *bytes, size_t size)
{
	if (size < 2)
		return;
	if (bytes[0] == 0)
		parse_twice(bytes + 2, size - 2, bytes[1] + 1u);
	else if (bytes[0] == 1)
		parse_frames(bytes + 2, size - 2, bytes[1] + 1u);
	else
		read_plan(bytes + 1, size - 1);
}

#define TEXELS_MAX (1u << 14)            /* more only make it slower */

/* Parts of textures: the first byte's lowest two bits say whether an outline, colours, or those of the
 * ground, which may have alpha. An outline that is read
 * can be written, and is then read as the same. */
void fuzz_texture(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_texture_part part, again;
	if (!size || eco_texture_texels(bytes + 1, size - 1, !(bytes[0] & 3)) > TEXELS_MAX)
		return;
	enum eco_code code = eco_texture_read(&part, bytes[0] & 2 ? ECO_LIST_GROUND_IMAGE : bytes[0] & 1
		? ECO_LIST_IMAGE : ECO_LIST_OUTLINE, bytes + 1, size - 1, &error);
	assert(code == error.code && (!code || !part.texels));
	if (code)
		return;
	size_t texels = (size_t)part.width * part.height;
	assert(part.width <= ECO_TEXTURE_SIDE_MAX && part.height <= ECO_TEXTURE_SIDE_MAX);
	if (part.channels == 1) {
		struct eco_writer w = { 0 };
		code = eco_texture_write_outline(&w, &part, &error);
		if (!code)
			code = eco_texture_read(&again, ECO_LIST_OUTLINE, w.bytes, w.size, &error);
		assert(!code && memcmp(part.texels, again.texels, texels) == 0);
		eco_texture_part_free(&again);
		eco_writer_free(&w);
	}
	eco_texture_part_free(&part);
}
