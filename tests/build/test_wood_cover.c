/* Cells of a plant show the same wood whatever each of them draws it as. */
#include <stdio.h>

#include "ecofiles/generate/generate_plants.h"
#include "ecofiles/import/model/model_import.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"
#include "tests/support/wood_cover.h"

#define FOLDER "build/tmp/wood_cover"
#define MIXES 6u

UNIT_TEST(a_mix_of_cells_covers_the_wood_that_full_detail_shows)
{
	static const struct { const char *name; uint64_t seed; } plants[] = { { "oak", 11 }, { "birch", 12 },
		{ "linden", 13 }, { "spruce", 14 }, { "beech", 15 }, { "maple", 16 } };
	folder_make(FOLDER);
	for (size_t i = 0; i < sizeof plants / sizeof *plants; i++) {
		const struct gen_plant *kind = gen_plant_find(plants[i].name);
		struct gen_mesh mesh = { 0 };
		struct gen_random random = { plants[i].seed };
		struct eco_model model;
		struct lod_plant plant;
		struct wood_cover cover;
		struct eco_error error;
		char path[200];
		const char *paths[1] = { path };
		kind->grow(&mesh, kind->kind, &random);
		assert_ok(gen_mesh_write(&mesh, FOLDER, kind->name, &error), error);
		gen_mesh_free(&mesh);
		if (kind->texture)
			assert_ok(gen_texture_write(FOLDER, kind->texture, &error), error);
		snprintf(path, sizeof path, FOLDER "/%s.obj", kind->name);
		assert_ok(eco_model_import(&model, &(struct eco_model_options){ .paths = paths, .path_count = 1 },
			&error), error);
		assert_ok(lod_plant_build(&plant, &model, &(struct lod_plant_options){ .name = kind->name,
			.seed = 1, .order = LOD_ORDER_COMBINED, .grid_bits = 14 }, &error), error);
		assert_ok(wood_cover_measure(&cover, &plant, &model, MIXES, &error), error);
		assert_true(cover.cells > 1);
		print_message("%s: %u cells; all lines %.4f, levels %.4f %.4f %.4f, mixes %.4f, holes %.5f, torn %.4f\n",
			kind->name, cover.cells, cover.same[0], cover.same[1], cover.same[2], cover.same[3],
			cover.mixed, cover.hole, cover.torn);
		for (uint32_t state = 0; state < WOOD_STATES; state++)
			assert_true(cover.same[state] >= 0.98);
		assert_true(cover.mixed >= 0.98);
		assert_true(cover.hole <= 0.001);
		assert_true(cover.torn <= 0.02);
		lod_plant_free(&plant);
		eco_model_free(&model);
	}
}
