/* Whole plants of all kinds, as models have them: their leaves in at most three quarters of what plain
 * corners take, no chunk in more, and every corner as near to where it was as rounding to the grid would put
 * it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/generate/generate_plants.h"
#include "ecofiles/import/model/model_import.h"
#include "lod/build/plant.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define FOLDER "build/tmp/shape_plants"
#define SOUP_BITS 85.0           /* a leaf: where corners are few and coarse, less is saved */
#define SHARE 0.75

struct tally { double soup, coded, leaves; };

/* The model of a kind through its file, whose numbers have few digits. */
static void build(struct lod_plant *plant, const char *name, uint64_t seed)
{
	const struct gen_plant *kind = gen_plant_find(name);
	struct gen_mesh mesh = { 0 };
	struct gen_random random = { seed };
	struct eco_model model = { 0 };
	struct eco_error error = { 0 };
	char path[200];
	const char *paths[1] = { path };
	const struct lod_plant_options options = { .name = name, .seed = 1, .order = LOD_ORDER_COMBINED,
		.grid_bits = 14 };
	folder_make(FOLDER);
	assert_non_null(kind);
	kind->grow(&mesh, kind->kind, &random);
	assert_int_equal(gen_mesh_write(&mesh, FOLDER, name, &error), ECO_OK);
	gen_mesh_free(&mesh);
	if (kind->texture)
		assert_int_equal(gen_texture_write(FOLDER, kind->texture, &error), ECO_OK);
	snprintf(path, sizeof path, FOLDER "/%s.obj", name);
	assert_int_equal(eco_model_import(&model,
		&(struct eco_model_options){ .paths = paths, .path_count = 1 }, &error), ECO_OK);
	assert_int_equal(lod_plant_build(plant, &model, &options, &error), ECO_OK);
	eco_model_free(&model);
}

/* Corners are compared with where they were, on the finer grid: by half a step along each axis at most, and
 * what `exact` was rounded by. */
static void compare(const struct eco_elements *in, uint32_t first, const uint32_t *order,
	const struct eco_elements *out)
{
	size_t *from = malloc((in->element_count + 1) * sizeof *from), corner = 0;
	const double most = 3 * 4.5 * 4.5;
	assert_non_null(from);
	from[0] = 0;
	for (uint32_t i = 0; i < in->element_count; i++)
		from[i + 1] = from[i] + in->corners[i];
	for (uint32_t i = 0; i < out->element_count; corner += out->corners[i++]) {
		uint32_t of = first + order[i];
		assert_int_equal(out->corners[i], in->corners[of]);
		if (in->extra_count)
			assert_memory_equal(out->extra + (size_t)in->extra_count * i,
				in->extra + (size_t)in->extra_count * of,
				in->extra_count * sizeof *in->extra);
		if (in->uv)
			assert_memory_equal(out->uv + 2 * corner, in->uv + 2 * from[of],
				2 * in->corners[of] * sizeof *in->uv);
		for (uint32_t k = 0; k < in->corners[of]; k++) {
			double d2 = 0;
			for (uint32_t a = 0; a < 3; a++)
				d2 += pow((double)out->position[3 * (corner + k) + a]
					- in->exact[3 * (from[of] + k) + a], 2);
			assert_true(d2 <= most);
		}
	}
	free(from);
}

static void code_chunk(const struct lod_list_draft *draft, uint32_t first, uint32_t ordinal,
	struct tally *tally)
{
	struct eco_elements plain = draft->elements, out;
	uint32_t end = draft->ends[ordinal], primitives = 0, *order = malloc((end - first) * sizeof *order);
	struct eco_error error = { 0 };
	uint8_t *bytes, *soup;
	size_t size, soup_size;
	plain.exact = NULL;
	assert_non_null(order);
	for (uint32_t i = first; i < end; i++)
		primitives += plain.corners[i] - 2u;
	assert_int_equal(eco_chunk_encode(&(struct eco_chunk_input){ &draft->list, &plain, first, end,
		ordinal }, &soup, &soup_size, NULL, &error), ECO_OK);
	assert_int_equal(eco_chunk_encode(&(struct eco_chunk_input){ &draft->list, &draft->elements, first,
		end, ordinal }, &bytes, &size, order, &error), ECO_OK);
	assert_true(size <= soup_size);
	const struct eco_chunk chunk = { .size_bytes = (uint32_t)size, .primitive_count = primitives,
		.element_count = end - first };
	assert_int_equal(eco_chunk_decode(&draft->list, &chunk, ordinal, bytes, size, &out, &error), ECO_OK);
	compare(&draft->elements, first, order, &out);
	eco_elements_free(&out);
	free(order);
	free(bytes);
	free(soup);
	tally->soup += 8.0 * (double)soup_size;
	tally->coded += 8.0 * (double)size;
	tally->leaves += end - first;
}

UNIT_TEST(leaves_of_all_kinds_of_plants_are_small)
{
	static const char *const kinds[] = { "birch", "pine", "shrub", "linden", "palm", "azalea", "fern",
		"grass", "daisy", "sunflower" };
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		struct lod_plant plant = { 0 };
		struct tally tally = { 0 };
		build(&plant, kinds[i], 40 + i);
		for (uint32_t l = 0; l < plant.list_count; l++) {
			const struct lod_list_draft *draft = &plant.lists[l];
			uint32_t first = 0;
			for (uint32_t c = 0; draft->list.coder == ECO_CODER_ELEMENTS && draft->elements.exact
					&& c < draft->end_count; first = draft->ends[c++])
				code_chunk(draft, first, c, &tally);
		}
		lod_plant_free(&plant);
		assert_true(tally.leaves > 0);
		if (getenv("ECO_VERBOSE"))
			print_message("%s: %.0f leaves, %.1f bits of %.1f: %.2f\n", kinds[i], tally.leaves,
				tally.coded / tally.leaves, tally.soup / tally.leaves,
				tally.coded / tally.soup);
		if (tally.soup >= SOUP_BITS * tally.leaves && tally.coded > SHARE * tally.soup)
			fail_msg("%s: %.1f bits a leaf, and %.1f as corners", kinds[i],
				tally.coded / tally.leaves, tally.soup / tally.leaves);
	}
}
