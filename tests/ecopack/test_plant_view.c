/* One plant of a pack as the planner draws it: budgets are kept, full detail is perfect, holes in a texture
 * are holes, and a damaged pack is an error. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/export/plant_view.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/image.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/test_plant_view"
#define PIXELS 64u

/* An upright card of 2 m; the upper half of its right side is transparent. */
static void write_card(void)
{
	uint8_t rgba[32 * 32 * 4];
	for (int y = 0; y < 32; y++)
		for (int x = 0; x < 32; x++)
			memcpy(rgba + 4 * (32 * y + x),
				(uint8_t[4]){ 220, 10, 10, x >= 16 && y < 16 ? 0 : 255 }, 4);
	assert_int_equal(eco_png_write(&(struct eco_pixels){ 32, 32, 4, rgba }, ROOT "/card.png", NULL),
		ECO_OK);
	file_write_text(ROOT "/card.obj",
		"mtllib card.mtl\nusemtl leaf\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nvt 0 0\nvt 1 0\nvt 1 "
		"1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
	file_write_text(ROOT "/card.mtl", "newmtl leaf\nmap_Kd card.png\n");
}

static int make_packs(void **state)
{
	struct eco_error error = { 0 };
	folder_make(ROOT);
	main_progress_quiet(true);
	write_shrub(ROOT "/tree.obj", "", 8, 400);
	write_card();
	file_write_text(ROOT "/two.json", "{\"plants\": {\"tree\": {\"model\": \"tree.obj\", \"up\": \"y\"}, \"card\": "
		"{\"model\": \"card.obj\", \"unit\": \"m\", \"up\": "
		"\"y\"}}, \"instances\": [{\"plant\": \"tree\", \"at\": [0, 0]}, {\"plant\": \"card\", "
		"\"at\": [9, 0]}]}");
	assert_ok(make_pack(&(struct make_options){ .scene = ROOT "/two.json", .pack = ROOT "/two.eco",
		.jobs = 1, .draft = true }, &error), error);
	return 0;
}

static struct eco_pack *open_plant(struct plant_view *view, const char *name)
{
	struct eco_pack *pack;
	struct eco_error error = { 0 };
	uint32_t i = 0;
	assert_ok(eco_pack_open(&pack, ROOT "/two.eco", &error), error);
	while (i + 1 < pack->scene.plant_count && strcmp(pack->scene.plants[i].name, name) != 0)
		i++;
	assert_ok(plant_view_open(view, pack, i, PIXELS, &error), error);
	return pack;
}

static double q_of(struct plant_view *view, uint64_t vertices, uint64_t *drawn)
{
	struct plant_view_drawing drawing;
	assert_int_equal(plant_view_drawing_make(&drawing, view, vertices, NULL), ECO_OK);
	double q = plant_view_q(view, &drawing);
	*drawn = drawing.vertices;
	plant_view_drawing_free(&drawing);
	return q;
}

UNIT_TEST(test_budgets_are_kept_and_full_detail_is_everything)
{
	struct plant_view view;
	uint64_t drawn;
	double last = -1;
	struct eco_pack *pack = open_plant(&view, "tree");
	assert_int_equal(view.full, 3 * (uint64_t)pack->scene.plants[view.number].triangles);
	assert_true(q_of(&view, 0, &drawn) == 0);
	for (uint64_t share = 64; share > 0; share /= 4) {
		double q = q_of(&view, view.full / share, &drawn);
		assert_true(drawn <= view.full / share);
		assert_true(q > last && (share == 1) == (q == 1));
		last = q;
	}
	assert_int_equal(drawn, view.full);
	plant_view_close(&view);
	eco_pack_close(pack);
}

UNIT_TEST(test_holes_of_textures_are_holes)
{
	static const struct { uint32_t x, y; bool covered; } cases[] = { { 16, 16, true }, { 16, 48, true },
		{ 48, 48, true }, { 48, 16, false } };
	struct plant_view view;
	struct eco_pack *pack = open_plant(&view, "card");
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_int_equal(view.reference[(size_t)cases[i].y * PIXELS + cases[i].x] != 0,
			cases[i].covered);
	plant_view_close(&view);
	eco_pack_close(pack);
}

UNIT_TEST(test_damaged_packs_are_an_error)
{
	struct plant_view view;
	struct eco_pack *pack;
	size_t size;
	uint8_t *bytes = file_read(ROOT "/two.eco", &size);
	assert_int_equal(eco_pack_open(&pack, ROOT "/two.eco", NULL), ECO_OK);
	const struct eco_chunk *chunk = &pack->scene.chunks[0];
	bytes[chunk->offset + chunk->size_bytes / 2] ^= 0xff;
	eco_pack_close(pack);
	file_write(ROOT "/bad.eco", bytes, size);
	free(bytes);
	assert_int_equal(eco_pack_open(&pack, ROOT "/bad.eco", NULL), ECO_OK);
	enum eco_code first = ECO_OK;
	for (uint32_t i = 0; i < pack->scene.plant_count && !first; i++)
		if (!(first = plant_view_open(&view, pack, i, PIXELS, NULL)))
			plant_view_close(&view);
	assert_int_equal(first, ECO_DAMAGED);
	eco_pack_close(pack);
}

UNIT_MAIN(make_packs, NULL)
