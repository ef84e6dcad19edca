/* The stream: frames and holdings. Whatever is written is read back the same, in any portions; whatever is
 * damaged is found. */
#include <math.h>
#include <stdio.h>

#include "tests/support/unit_test.h"
#include "tests/support/wire_random.h"

/* ---- Streams ---- */

static struct eco_writer random_stream(uint64_t seed, uint32_t steps)
{
	struct wire_random r = { seed };
	struct eco_writer w = { 0 };
	wire_random_stream(&r, &w, steps);
	assert_false(w.failed);
	return w;
}

UNIT_TEST(portions_do_not_matter)
{
	static const size_t portions[] = { 0, 1, 2, 3, 5, 15, 16, 17, 64, 1000, 4096 };
	for (uint64_t seed = 1; seed <= 20; seed++) {
		FREED(eco_writer) w = random_stream(seed, 8);
		struct wire_told whole = { 0 };
		assert_good(wire_tell(w.bytes, w.size, w.size, &whole, &cause));
		assert_true(whole.events >= 1 + 2 + 6 + 8 + 1);
		for (size_t i = 0; i < sizeof portions / sizeof *portions; i++) {
			struct wire_told told = { 0 };
			assert_good(wire_tell(w.bytes, w.size, portions[i], &told, &cause));
			assert_true(told.w.size == whole.w.size);
			assert_memory_equal(told.w.bytes, whole.w.bytes, told.w.size);
			eco_writer_free(&told.w);
		}
		eco_writer_free(&whole.w);
	}
}

struct damage { const struct wire_told *sound; struct wire_told told; uint32_t found, harmless; };

static void damage_tried(struct damage *d, const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	d->told.w.size = d->told.events = 0;
	if (wire_tell(bytes, size, size ? size : 1, &d->told, &error) != ECO_OK) {
		assert_true(error.text[0]);
		d->found++;
		return;
	}
	assert_true(d->told.w.size == d->sound->w.size);
	assert_memory_equal(d->told.w.bytes, d->sound->w.bytes, d->told.w.size);
	d->harmless++;
}

/* Every single bit, every truncation, and random handfuls of bits. */
UNIT_TEST(damage_is_found)
{
	FREED(eco_writer) w = random_stream(7, 5);
	struct wire_told sound = { 0 };
	struct damage d = { .sound = &sound };
	struct wire_random r = { 99 };
	assert_int_equal(wire_tell(w.bytes, w.size, w.size, &sound, NULL), ECO_OK);
	for (size_t bit = 0; bit < 8 * w.size; bit++) {
		w.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
		damage_tried(&d, w.bytes, w.size);
		w.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
	for (size_t size = 0; size < w.size; size++)
		damage_tried(&d, w.bytes, size);
	FREED_MEMORY uint8_t *copy = malloc(w.size);
	while (d.found + d.harmless < 100000) {
		memcpy(copy, w.bytes, w.size);
		for (uint32_t n = 1 + wire_random_below(&r, 8); n > 0; n--)
			copy[wire_random_below(&r, (uint32_t)w.size)] ^= (uint8_t)(1u
				<< wire_random_below(&r, 8));
		damage_tried(&d, copy, w.size);
	}
	print_message("stream of %zu bytes, %u events: damage found %u times, harmless %u times, missed 0 "
		"times\n", w.size, sound.events, d.found, d.harmless);
	eco_writer_free(&d.told.w);
	eco_writer_free(&sound.w);
}

static size_t frame_size(const uint8_t *header)
{
	struct eco_reader r = { .bytes = header, .size = 8, .at = 4 };
	return ECO_FRAME_HEADER_BYTES + eco_read_u32(&r);
}

/* Each frame is sound, but one is lost, comes twice, or changes places with the next. */
UNIT_TEST(lost_repeated_and_swapped_frames_are_found)
{
	FREED(eco_writer) w = random_stream(8, 6);
	FREED_MEMORY uint8_t *copy = malloc(2 * w.size);
	for (size_t at = 0; at < w.size; at += frame_size(w.bytes + at)) {
		struct wire_told told = { 0 };
		size_t one = frame_size(w.bytes + at), after = at + one, two = after < w.size
			? frame_size(w.bytes + after) : 0;
		memcpy(copy, w.bytes, at);
		memcpy(copy + at, w.bytes + after, w.size - after);
		assert_int_equal(wire_tell(copy, w.size - one, 0, &told, NULL), ECO_DAMAGED);
		memcpy(copy, w.bytes, after);
		memcpy(copy + after, w.bytes + at, w.size - at);
		assert_int_equal(wire_tell(copy, w.size + one, 0, &told, NULL), ECO_DAMAGED);
		memcpy(copy, w.bytes, w.size);
		memcpy(copy + at, w.bytes + after, two);
		memcpy(copy + at + two, w.bytes + at, one);
		if (two)
			assert_int_equal(wire_tell(copy, w.size, 0, &told, NULL), ECO_DAMAGED);
		eco_writer_free(&told.w);
	}
}

/* Streams whose hashes are right and whose contents are not. */
enum fault { FAULT_NONE, FAULT_NO_SCENE, FAULT_TWO_SCENES, FAULT_VERSION, FAULT_PLANT_ID, FAULT_ANCHOR,
	FAULT_LIST_ID, FAULT_LIST_KIND, FAULT_LIST_CODER, FAULT_LIST_ATTRIBUTES, FAULT_LIST_GRID,
	FAULT_LIST_GROUPS, FAULT_GROUP_PLANT, FAULT_GROUP_BEFORE, FAULT_GROUP_LARGE, FAULT_GROUP_SMALL,
	FAULT_GROUP_LOST, FAULT_LIST_IMAGE, FAULT_LIST_CHUNKS, FAULT_FORM_KIND, FAULT_FORM_PARTNER,
	FAULT_FORM_ITSELF, FAULT_FORM_COUNT, FAULT_PALETTE, FAULT_CHUNK_SIZE, FAULT_CHUNK_SKIPS,
	FAULT_CHUNK_AGAIN, FAULT_PLAN_LIST, FAULT_PLAN_RUN, FAULT_PLAN_GATE, FAULT_PLAN_TRAILING,
	FAULT_NO_PLAN, FAULT_END_VERTICES, FAULT_END_BYTES, FAULT_AFTER_END, FAULT_TYPE,
	FAULT_COUNT };

static void put_faulty_groups(struct eco_wire_bundle *b, enum fault fault)
{
	struct eco_group groups[2] = { { .plant = fault == FAULT_GROUP_PLANT ? WIRE_RANDOM_PLANTS : 1,
		.count = 600 }, { .plant = fault == FAULT_GROUP_BEFORE ? ECO_NONE : 0,
		.count = 400u + (fault == FAULT_GROUP_LARGE) - (fault == FAULT_GROUP_SMALL) } };
	for (uint32_t i = 0; i < (fault == FAULT_GROUP_LOST ? 1u : 2u); i++)
		eco_wire_group_code(&b->range, b->items, i, &groups[i]);
}

static void put_faulty_list(struct eco_writer *w, uint32_t *number, enum fault fault)
{
	struct eco_list list = wire_random_list(3);
	list.kind = fault == FAULT_LIST_KIND ? 9 : list.kind;
	list.coder = fault == FAULT_LIST_CODER ? ECO_CODER_BYTES : list.coder;
	list.attributes = fault == FAULT_LIST_ATTRIBUTES ? ECO_ATTR_GROWTH : list.attributes;
	if (fault >= FAULT_FORM_KIND && fault <= FAULT_FORM_COUNT) {
		list.coder = ECO_CODER_FORM;
		list.kind = fault == FAULT_FORM_KIND ? ECO_LIST_INSTANCES : ECO_LIST_POINTS;
		list.partner = fault == FAULT_FORM_PARTNER ? ECO_NONE : fault == FAULT_FORM_ITSELF ? 3 : 1;
		list.primitive_count += fault == FAULT_FORM_COUNT;
		list.group_count = 0;
	}
	list.grid_step[1] = fault == FAULT_LIST_GRID ? NAN : list.grid_step[1];
	list.group_count = fault == FAULT_LIST_GROUPS ? 0 : list.group_count;
	list.image = fault == FAULT_LIST_IMAGE ? WIRE_RANDOM_LISTS : list.image;
	list.chunk_count = fault == FAULT_LIST_CHUNKS ? list.element_count + 1 : list.chunk_count;
	struct eco_wire_bundle bundle;
	struct eco_frame_mark mark = wire_bundle_begin(w, number, &bundle);
	list.palette_count = fault == FAULT_PALETTE ? 1u << 20 : 0;
	struct eco_wire_item item = { .kind = ECO_ITEM_LIST, .list = list,
		.id = fault == FAULT_LIST_ID ? WIRE_RANDOM_LISTS : 3 };
	eco_wire_item_code(&bundle.range, bundle.items, &item);
	if (list.group_count)
		put_faulty_groups(&bundle, fault);
	wire_bundle_end(w, mark, &bundle, NULL, 0);
}

static void put_faulty_plan(struct eco_writer *w, uint32_t *number, enum fault fault)
{
	struct eco_placement placement = { .scale = 1 };
	struct eco_run run = { 0, 3, fault == FAULT_PLAN_RUN ? 7 : 4, 0 };
	struct eco_gate gate = { fault == FAULT_PLAN_GATE ? 2 : 1, eco_gate_place(60, 0x1234) };
	struct eco_cut cut = { .list = fault == FAULT_PLAN_LIST ? 6 : 1, .end = 9, .scale = 1, .band_end = 90,
		.share_end = ECO_SHARE_ONE };
	struct eco_plan plan = { .vertices = 77, .placements = &placement, .placement_count = 1, .runs = &run,
		.run_count = 1,
		.gates = &gate, .gate_count = 1, .cuts = &cut, .cut_count = 1 };
	struct eco_frame_mark mark = eco_frame_begin(w, ECO_FRAME_PLAN, (*number)++);
	eco_wire_write_plan(w, &plan);
	if (fault == FAULT_PLAN_TRAILING)
		eco_write_u8(w, 0);
	eco_frame_end(w, mark);
}

static struct eco_writer faulty_stream(enum fault fault)
{
	struct eco_writer w = { 0 };
	struct eco_anchor anchors[3] = { { { 0, 0, fault == FAULT_ANCHOR ? INFINITY : 1 }, 1 } };
	uint32_t number = 0;
	if (fault != FAULT_NO_SCENE)
		wire_put_scene(&w, &number, ECO_WIRE_VERSION + (fault == FAULT_VERSION));
	if (fault == FAULT_TWO_SCENES)
		wire_put_scene(&w, &number, ECO_WIRE_VERSION);
	if (fault == FAULT_PLANT_ID) {
		struct eco_wire_bundle bundle;
		struct eco_frame_mark mark = wire_bundle_begin(&w, &number, &bundle);
		struct eco_wire_item item = { .kind = ECO_ITEM_PLANT, .id = WIRE_RANDOM_PLANTS,
			.plant = { .name = "oak", .height_m = 18, .anchor_count = 1 } };
		eco_wire_item_code(&bundle.range, bundle.items, &item);
		eco_wire_anchor_code(&bundle.range, bundle.items, &anchors[0]);
		wire_bundle_end(&w, mark, &bundle, NULL, 0);
	}
	wire_put_plant(&w, &number, 1, anchors, 1);
	put_faulty_list(&w, &number, fault);
	wire_put_chunk(&w, &number, 3, 0, "12345", 5, fault != FAULT_CHUNK_SIZE);
	wire_put_chunk(&w, &number, 3, fault == FAULT_CHUNK_SKIPS ? 2 : fault == FAULT_CHUNK_AGAIN ? 0 : 1,
		"1234567", 7, true);
	if (fault == FAULT_TYPE) {
		struct eco_frame_mark mark = eco_frame_begin(&w, ECO_FRAME_BUNDLE, number++);
		w.bytes[mark.at] = 7;
		eco_write_u64(&w, 0);
	}
	if (fault != FAULT_NO_PLAN)
		put_faulty_plan(&w, &number, fault);
	wire_put_end(&w, &number, fault == FAULT_END_VERTICES ? 78 : 77, fault == FAULT_END_BYTES ? 1 : 0);
	if (fault == FAULT_AFTER_END)
		eco_write_u8(&w, 0);
	assert_false(w.failed);
	return w;
}

UNIT_TEST(impossible_contents_are_refused)
{
	for (int fault = 0; fault < FAULT_COUNT; fault++) {
		FREED(eco_writer) w = faulty_stream(fault);
		struct wire_told told = { 0 };
		struct eco_error error = { 0 };
		enum eco_code code = wire_tell(w.bytes, w.size, 0, &told, &error);
		if ((code == ECO_OK) != (fault == FAULT_NONE))
			fail_msg("fault %d: code %d %s", fault, code, error.text);
		if (fault)
			assert_true(strncmp(error.text, "stream, frame ", 14) == 0);
		eco_writer_free(&told.w);
	}
}

/* Frames in this order: scene, plan, ahead, end; or ahead with a payload. */
static struct eco_writer stream_in_order(const char *order)
{
	struct eco_writer w = { 0 };
	uint32_t number = 0;
	for (; *order; order++) {
		if (*order == 's')
			wire_put_scene(&w, &number, ECO_WIRE_VERSION);
		else if (*order == 'p')
			put_faulty_plan(&w, &number, FAULT_NONE);
		else if (*order == 'e')
			wire_put_end(&w, &number, 77, 0);
		else if (*order == 'a')
			eco_frame_end(&w, eco_frame_begin(&w, ECO_FRAME_AHEAD, number++));
	}
	return w;
}

UNIT_TEST(ahead_comes_once_behind_the_last_plan)
{
	static const struct { const char *order; bool good; } rows[] = { { "spe", true }, { "spae", true },
		{ "sppae", true }, { "sape", false }, { "apse", false }, { "spape", false }, { "spaae", false },
		{ "spa", false } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		FREED(eco_writer) w = stream_in_order(rows[i].order);
		for (size_t portion = 1; portion <= w.size; portion += 15) {
			struct wire_told told = { 0 };
			struct eco_error error = { 0 };
			enum eco_code code = wire_tell(w.bytes, w.size, portion, &told, &error);
			assert_int_equal(code == ECO_OK, rows[i].good);
			if (rows[i].good)
				assert_int_equal(told.events, strlen(rows[i].order));
			eco_writer_free(&told.w);
		}
	}
}

/* ---- Named chunks ---- */

static struct eco_writer stream_of(const char *payload, bool named)
{
	struct eco_writer w = { 0 };
	struct eco_anchor anchors[3] = { { { 0, 0, 1 }, 1 } };
	uint32_t number = 0;
	wire_put_scene(&w, &number, ECO_WIRE_VERSION);
	wire_put_plant(&w, &number, 1, anchors, 1);
	put_faulty_list(&w, &number, FAULT_NONE);
	(named ? wire_put_name(&w, &number, 3, 0, payload, strlen(payload))
		: wire_put_chunk(&w, &number, 3, 0, payload, strlen(payload), true));
	put_faulty_plan(&w, &number, FAULT_NONE);
	wire_put_end(&w, &number, 77, 0);
	assert_false(w.failed);
	return w;
}

UNIT_TEST(named_chunks_are_as_carried_ones)
{
	static const char payload[] = "a payload of some bytes";
	FREED(eco_writer) carried = stream_of(payload, false), named = stream_of(payload, true);
	struct wire_told all = { 0 }, same = { .hosted = payload }, less = { 0 },
		damaged = { .hosted = "A payload of some bytes" };
	assert_in_range(named.size - carried.size + strlen(payload), sizeof(struct eco_chunk_id),
		sizeof(struct eco_chunk_id) + 1);
	assert_good(wire_tell(carried.bytes, carried.size, 0, &all, &cause));
	assert_good(wire_tell(named.bytes, named.size, 0, &same, &cause));
	assert_int_equal(same.w.size, all.w.size);
	assert_memory_equal(same.w.bytes, all.w.bytes, all.w.size);
	assert_good(wire_tell(named.bytes, named.size, 0, &less, &cause));
	assert_int_equal(less.events, all.events - 1);
	assert_code(wire_tell(named.bytes, named.size, 0, &damaged, &cause), ECO_DAMAGED,
		"the hash that names it");
	for (size_t size = 0; size < named.size; size++) {
		struct wire_told told = { .hosted = payload };
		assert_int_equal(wire_tell(named.bytes, size, 0, &told, &(struct eco_error){ 0 }), ECO_DAMAGED);
		eco_writer_free(&told.w);
	}
	eco_writer_free(&all.w);
	eco_writer_free(&same.w);
	eco_writer_free(&less.w);
	eco_writer_free(&damaged.w);
}

UNIT_TEST(first_failure_is_final)
{
	FREED(eco_writer) w = random_stream(9, 3);
	struct wire_told whole = { 0 };
	assert_int_equal(wire_tell(w.bytes, w.size, 0, &whole, NULL), ECO_OK);
	for (uint32_t n = 1; n <= whole.events; n++) {
		struct wire_told told = { .fail_at = n };
		struct eco_wire_parser *parser;
		struct eco_error a = { 0 }, b = { 0 }, c = { 0 };
		assert_int_equal(eco_wire_parser_new(&parser, &wire_telling, &told, NULL), ECO_OK);
		assert_int_equal(eco_wire_feed(parser, w.bytes, w.size, &a), ECO_INTERRUPTED);
		assert_int_equal(told.events, n);
		assert_int_equal(eco_wire_feed(parser, w.bytes, w.size, &b), ECO_INTERRUPTED);
		assert_int_equal(eco_wire_finish(parser, &c), ECO_INTERRUPTED);
		assert_string_equal(a.text, b.text);
		assert_string_equal(a.text, c.text);
		assert_int_equal(told.events, n);
		eco_wire_parser_free(parser);
		eco_writer_free(&told.w);
	}
	eco_writer_free(&whole.w);
}

/* The bytes themselves: this must never change within a version that is released. */
UNIT_TEST(golden_stream)
{
	static const char expected[] =
		"010000003e000000c87bff556c3fe9e41c00000001020300000000000000"
		"0000000000009a9999999999b93f21000000500000003c00000007000000"
		"02000000060000000957c3a46c646368656e020000001f00000094f515da"
		"c377b2151d044204e1aac55fb67bf43a6cfa0000176e236e6703469ff5ee"
		"760023c3c90200000023000000fa52568feccd20c12103c1b08d1e125469"
		"0604ecdeee252cb86da1cac0831053c2057ca3bc284c63fd467502000000"
		"0d000000e2d4abed862550a50603e016f51f81203132333435030000001d"
		"000000d0b91002a01b67784d0000000001010101000000000103060201e8"
		"c8e00387020202108b0104000000100000001f585c3f6af1fbff4d000000"
		"000000001a01000000000000";
	FREED(eco_writer) w = { 0 };
	struct eco_anchor anchor = { { 0.5f, -1, 9 }, 10 };
	uint32_t number = 0;
	char hex[1024], *p = hex;
	wire_put_scene(&w, &number, ECO_WIRE_VERSION);
	wire_put_plant(&w, &number, 1, &anchor, 1);
	put_faulty_list(&w, &number, FAULT_NONE);
	wire_put_chunk(&w, &number, 3, 0, "12345", 5, true);
	put_faulty_plan(&w, &number, FAULT_NONE);
	wire_put_end(&w, &number, 77, 0);
	for (size_t i = 0; i < w.size; i++)
		p += sprintf(p, "%02x", w.bytes[i]);
	assert_string_equal(hex, expected);
}

UNIT_TEST(names_in_other_encodings_do_not_break_a_stream)
{
	static const struct { const char *name, *sent; } names[] =
		{ { "Ahorn", "Ahorn" }, { "W\xC3\xA4ldchen", "W\xC3\xA4ldchen" },
		{ "W\xE4ldchen", "W?ldchen" }, { "cut\xC3", "cut?" }, { "\xED\xA0\x80", "???" },
		{ "\xC0\x80", "??" }, { "\xF5\x80\x80\x80", "????" },
		{ "\xF0\x9F\x8C\xB3", "\xF0\x9F\x8C\xB3" }, { "\xF0\x80\x80\x80", "????" },
		{ "\xE0\x80\x80", "???" } };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct eco_scene scene = { .near_m = 1 };
		struct eco_chunk_id id = { { 0 } };
		FREED(eco_writer) w = { 0 };
		strcpy(scene.name, names[i].name);
		eco_wire_write_scene(&w, &scene, &id);
		assert_int_equal(w.bytes[52], strlen(names[i].sent));
		assert_memory_equal(w.bytes + 53, names[i].sent, strlen(names[i].sent));
	}
}

/* ---- Holdings ---- */

UNIT_TEST(holdings_survive_the_wire)
{
	struct wire_random r = { 11 };
	for (int i = 0; i < 500; i++) {
		struct eco_holding items[64];
		struct eco_holdings held = { items, wire_random_below(&r, 65) }, back;
		uint64_t list = wire_random_size(&r, 1000);
		uint32_t count = 0;
		for (; count < held.count && list < ECO_NONE; count++) {
			items[count] = (struct eco_holding){ (uint32_t)list,
				1 + wire_random_size(&r, UINT32_MAX - 1) };
			list += 1 + (uint64_t)wire_random_size(&r, UINT32_MAX - 1);
		}
		held.count = count;
		FREED(eco_writer) w = { 0 }, again = { 0 };
		eco_wire_write_holdings(&w, &held);
		assert_int_equal(eco_wire_read_holdings(w.bytes, w.size, &back, NULL), ECO_OK);
		assert_int_equal(back.count, held.count);
		for (uint32_t n = 0; n < count; n++) {
			assert_memory_equal(&back.items[n], &items[n], sizeof *items);
			assert_int_equal(eco_holdings_chunks(&back, items[n].list), items[n].chunks);
			assert_int_equal(eco_holdings_chunks(&back, items[n].list + 1),
				n + 1 < count && items[n + 1].list == items[n].list + 1 ? items[n + 1].chunks
				: 0);
		}
		eco_wire_write_holdings(&again, &back);
		assert_true(again.size == w.size && memcmp(again.bytes, w.bytes, w.size) == 0);
		for (size_t size = 0; size < w.size; size++) {
			struct eco_holdings none;
			struct eco_error error = { 0 };
			assert_int_not_equal(eco_wire_read_holdings(w.bytes, size, &none, &error), ECO_OK);
			assert_true(error.text[0] && !none.items && none.count == 0);
		}
		free(back.items);
	}
	assert_int_equal(eco_holdings_chunks(NULL, 3), 0);
}

UNIT_TEST(impossible_holdings_are_refused)
{
	static const struct { const char *why; uint8_t bytes[16]; size_t size; enum eco_code code; } rows[] =
		{
		{ "none", { 0, 0, 0, 0 }, 4, ECO_OK },
		{ "two", { 2, 0, 0, 0, 5, 1, 1, 0x80, 1 }, 9, ECO_OK },
		{ "no count", { 0, 0, 0 }, 3, ECO_BAD_INPUT },
		{ "something after it", { 0, 0, 0, 0, 0 }, 5, ECO_BAD_INPUT },
		{ "more items than bytes", { 3, 0, 0, 0, 5, 1, 1, 1 }, 8, ECO_BAD_INPUT },
		{ "a count beyond all bounds", { 0, 0, 0, 0xFF, 5, 1 }, 6, ECO_TOO_LARGE },
		{ "the same list twice", { 2, 0, 0, 0, 5, 1, 0, 1 }, 8, ECO_BAD_INPUT },
		{ "no chunks", { 1, 0, 0, 0, 5, 0 }, 6, ECO_BAD_INPUT },
		{ "a long zero", { 1, 0, 0, 0, 0x80, 0, 1 }, 7, ECO_BAD_INPUT },
		{ "a list beyond 32 bits", { 1, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F, 1 }, 10,
			ECO_BAD_INPUT },
		{ "chunks beyond 32 bits", { 1, 0, 0, 0, 1, 0x80, 0x80, 0x80, 0x80, 0x10 }, 10,
			ECO_BAD_INPUT },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_holdings held;
		if (eco_wire_read_holdings(rows[i].bytes, rows[i].size, &held, NULL) != rows[i].code)
			fail_msg("%s", rows[i].why);
		free(held.items);
	}
}
