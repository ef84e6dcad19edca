/* Curves of crowns made here: what they must look like whatever the plant, and that cells share the whole
 * plant's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/build/grid.h"
#include "lod/ladder.h"
#include "lod/build/measure/curve_ways.h"
#include "tests/support/unit_test.h"

#define STEP 0.001
#define CELLS 4u
#define GAP_LEAST 100.0          /* vertices: fewer are rough */

static uint64_t seed;

static double uniform(double low, double high)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return low + (high - low) * (double)(seed >> 34) / (double)(1u << 30);
}

/* A crown of quads in a ball, with the model's triangles to match. Lists and ladders are added by the tests.
 */
struct crown {
	struct lod_plant plant;
	struct eco_model model;
	uint32_t leaves;
	int32_t *corner;             /* 12 a leaf */
	struct lod_list_draft lists[4 + 2 * CELLS];
	struct eco_ladder ladders[2 + CELLS];
	struct eco_anchor anchors[1 + CELLS];
	struct eco_material material;
};

static void make_leaf(int32_t *corner, double size)
{
	double c[3], a[3], b[3], length2;
	do {
		length2 = 0;
		for (int k = 0; k < 3; k++) {
			c[k] = uniform(-1, 1);
			length2 += c[k] * c[k];
		}
	} while (length2 > 1);
	for (int k = 0; k < 3; k++) {
		a[k] = uniform(-size, size);
		b[k] = uniform(-size, size);
	}
	for (int q = 0; q < 4; q++)
		for (int k = 0; k < 3; k++) {
			double at = 3 + c[k] * 2 + (q == 1 || q == 2 ? a[k] : 0) + (q >= 2 ? b[k] : 0);
			corner[3 * q + k] = (int32_t)(at / STEP);
		}
}

static void crown_make(struct crown *crown, uint32_t leaves, double size)
{
	memset(crown, 0, sizeof *crown);
	crown->leaves = leaves;
	crown->corner = malloc(leaves * 12 * sizeof *crown->corner);
	for (uint32_t i = 0; i < leaves; i++)
		make_leaf(crown->corner + 12 * i, size);
	struct eco_model *model = &crown->model;
	model->vertex_count = 4 * leaves;
	model->triangle_count = 2 * leaves;
	model->material_count = 1;
	model->materials = &crown->material;
	crown->material.image = ECO_NONE;
	model->position = malloc(12 * leaves * sizeof(float));
	model->index = malloc(6 * leaves * sizeof(uint32_t));
	model->material = calloc(2 * leaves, sizeof(uint32_t));
	for (uint32_t i = 0; i < 12 * leaves; i++)
		model->position[i] = (float)(crown->corner[i] * STEP);
	for (uint32_t i = 0; i < 6 * leaves; i++)
		model->index[i] = i / 6 * 4 + (uint32_t[]){ 0, 1, 2, 0, 2, 3 }[i % 6];
	struct lod_plant *plant = &crown->plant;
	plant->lists = crown->lists;
	plant->ladders = crown->ladders;
	plant->anchors = crown->anchors;
	plant->plant.height_m = 5;
	crown->anchors[0] = (struct eco_anchor){ { 3, 3, 3 }, 2.5f };
}

static struct lod_list_draft *add_list(struct crown *crown, uint8_t kind, uint32_t elements, uint32_t corners)
{
	struct lod_list_draft *draft = &crown->lists[crown->plant.list_count++];
	uint32_t primitives = kind == ECO_LIST_TRIANGLES ? elements * (corners - 2) : elements;
	draft->list = (struct eco_list){ .kind = kind, .coder = ECO_CODER_ELEMENTS, .image = ECO_NONE,
		.partner = ECO_NONE,
		.grid_step = { STEP, STEP, STEP }, .primitive_count = primitives, .element_count = elements };
	draft->elements = (struct eco_elements){ .element_count = elements,
		.corner_count = elements * corners,
		.primitive_count = primitives, .corners = malloc(elements),
		.position = malloc(elements * corners * 3 * sizeof(int32_t)) };
	memset(draft->elements.corners, (int)corners, elements);
	draft->ends = malloc(sizeof *draft->ends);
	draft->ends[0] = elements;
	draft->end_count = elements ? 1 : 0;
	return draft;
}

/* Leaves [first, end), every `each`-th, as triangles. */
static uint32_t add_triangles(struct crown *crown, uint32_t first, uint32_t end, uint32_t each)
{
	struct lod_list_draft *draft = add_list(crown, ECO_LIST_TRIANGLES, (end - first) / each, 4);
	for (uint32_t i = 0; i < (end - first) / each; i++)
		memcpy(draft->elements.position + 12 * i, crown->corner + 12 * (first + i * each),
			12 * sizeof(int32_t));
	return crown->plant.list_count - 1;
}

/* A point in the middle of each of those leaves, of list `triangles`. */
static uint32_t add_points(struct crown *crown, uint32_t first, uint32_t end, uint32_t each,
	uint32_t triangles)
{
	uint32_t leaves = (end - first) / each;
	struct lod_list_draft *draft = add_list(crown, ECO_LIST_POINTS, leaves, 1);
	double area = 0;
	draft->list.coder = ECO_CODER_FORM;
	draft->list.partner = triangles;
	for (uint32_t i = 0; i < leaves; i++) {
		const int32_t *leaf = crown->corner + 12 * (first + i * each);
		double u[3], v[3];
		for (int k = 0; k < 3; k++) {
			u[k] = leaf[3 + k] - leaf[k];
			v[k] = leaf[9 + k] - leaf[k];
			draft->elements.position[3 * i + (uint32_t)k] = (leaf[k] + leaf[6 + k]) / 2;
		}
		double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
			u[0] * v[1] - u[1] * v[0] };
		area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) * STEP * STEP;
	}
	draft->list.unit_area = (float)(area / 2 / leaves);
	return crown->plant.list_count - 1;
}

/* A line along each `each`-th leaf. */
static uint32_t add_lines(struct crown *crown, uint32_t each)
{
	struct lod_list_draft *draft = add_list(crown, ECO_LIST_LINES, crown->leaves / each, 2);
	draft->list.attributes = ECO_ATTR_WIDTH;
	draft->elements.extra_count = 1;
	draft->elements.extra = malloc(draft->elements.element_count * sizeof(int32_t));
	for (uint32_t i = 0; i < draft->elements.element_count; i++) {
		const int32_t *leaf = crown->corner + 12 * i * each;
		for (int k = 0; k < 3; k++) {
			draft->elements.position[6 * i + (uint32_t)k] = (leaf[k] + leaf[9 + k]) / 2;
			draft->elements.position[6 * i + 3 + (uint32_t)k] = (leaf[3 + k] + leaf[6 + k]) / 2;
		}
		draft->elements.extra[i] = 100;
	}
	return crown->plant.list_count - 1;
}

static struct eco_ladder *add_ladder(struct crown *crown, uint32_t points, uint32_t triangles)
{
	struct eco_ladder *ladder = &crown->ladders[crown->plant.ladder_count++];
	*ladder = (struct eco_ladder){ .organ = ECO_ORGAN_FOLIAGE, .points = points, .lines = ECO_NONE,
		.simple = ECO_NONE, .impostor = ECO_NONE,
		.triangles = triangles, .importance = 1 };
	ladder->total = crown->lists[triangles != ECO_NONE ? triangles : points].list.element_count;
	return ladder;
}

static void crown_free(struct crown *crown)
{
	for (uint32_t i = 0; i < crown->plant.list_count; i++) {
		free(crown->lists[i].elements.corners);
		free(crown->lists[i].elements.position);
		free(crown->lists[i].elements.extra);
		free(crown->lists[i].ends);
	}
	free(crown->plant.curves);
	free(crown->corner);
	free(crown->model.position);
	free(crown->model.index);
	free(crown->model.material);
}

static void measure(struct crown *crown, uint32_t pixels)
{
	struct lod_plant_options options = { .grid_bits = 1, .no_splats = true, .views = 8,
		.pixels = pixels };
	struct eco_error error = { 0 };
	assert_int_equal(lod_plant_measure(&crown->plant, &crown->model, &options, &error), ECO_OK);
}

static double error_of(const struct eco_curve *sample)
{
	return (double)sample->fp + sample->fn;
}

static void check_curve(const struct lod_plant *plant, const struct eco_ladder *ladder, uint32_t least)
{
	const struct eco_curve *curve = plant->curves + ladder->curve_first;
	assert_in_range(ladder->curve_count, least, LOD_CURVE_SAMPLES_MAX);
	assert_true(ladder->flags & ECO_LADDER_ABOVE);
	assert_true(ladder->curve_first + 2 * ladder->curve_count <= plant->curve_count);
	for (uint32_t i = 0; i < 2 * ladder->curve_count; i++) {
		uint32_t k = i % ladder->curve_count;            /* then seen from above, at the same shares */
		assert_true(curve[i].share == curve[k].share && curve[i].reach == curve[k].reach);
		assert_true(curve[i].share > 0 && curve[i].share <= 1);
		assert_true(curve[i].scale >= 0.25f && curve[i].scale <= 64);
		assert_true(curve[i].fp >= 0 && curve[i].fn >= 0);
		assert_true(k == 0 || (curve[i].share > curve[i - 1].share
			&& error_of(&curve[i]) <= error_of(&curve[i - 1]) + 1e-6));
	}
	assert_true(curve[ladder->curve_count - 1].share == 1);
	assert_true(error_of(&curve[ladder->curve_count - 1]) == 0);
}

static struct eco_curve at(const struct lod_plant *plant, const struct eco_ladder *ladder, double share)
{
	struct eco_scene scene = { .curves = plant->curves };
	return lod_ladder_curve(&scene, ladder, share);
}

/* ---- */

UNIT_TEST(points_and_triangles_get_a_falling_curve_from_one_point_to_all)
{
	struct crown crown;
	seed = 1;
	crown_make(&crown, 1500, 0.12);
	uint32_t triangles = add_triangles(&crown, 0, 1500, 1),
		points = add_points(&crown, 0, 1500, 1, triangles);
	struct eco_ladder *ladder = add_ladder(&crown, points, triangles);
	measure(&crown, 128);
	check_curve(&crown.plant, ladder, 8);
	assert_true(fabs(crown.plant.curves[0].share - 1.0 / 9000) < 1e-8);
	assert_true(error_of(&crown.plant.curves[0]) > 0.5);
	struct eco_curve all_points = at(&crown.plant, ladder, 1.0 / 6);
	assert_true(error_of(&all_points) < 0.6 && all_points.scale > 0.5 && all_points.scale < 3);
	crown_free(&crown);
}

static double loss_at_scale(struct crown *crown, uint32_t list, uint32_t end, double scale)
{
	struct lod_probe probe;
	assert_int_equal(lod_probe_init(&probe, &crown->plant, &crown->model,
		&(struct lod_probe_options){ .views = 8, .pixels = 192 }, NULL), ECO_OK);
	assert_true(lod_probe_keep_model(&probe));
	struct eco_cut cut = { .list = list, .end = end, .scale = (float)scale };
	assert_int_equal(lod_probe_add(&probe, &cut, NULL), ECO_OK);
	struct lod_probe_result result;
	lod_probe_compare(&probe, 1, &result);
	lod_probe_free(&probe);
	return result.loss;
}

UNIT_TEST(the_scale_is_better_than_its_neighbours_and_cooks)
{
	struct crown crown;
	seed = 2;
	crown_make(&crown, 2000, 0.2);
	uint32_t triangles = add_triangles(&crown, 0, 2000, 1);
	struct eco_ladder *ladder = add_ladder(&crown, ECO_NONE, triangles);
	measure(&crown, 192);
	check_curve(&crown.plant, ladder, 8);
	uint32_t ends[] = { 80, 400, 1600 };
	for (int i = 0; i < 3; i++) {
		double share = ends[i] / 4000.0, scale = at(&crown.plant, ladder, share).scale;
		double here = loss_at_scale(&crown, triangles, ends[i], scale / share);
		assert_true(here < loss_at_scale(&crown, triangles, ends[i], scale / share * 1.5) + 0.01);
		assert_true(here < loss_at_scale(&crown, triangles, ends[i], scale / share / 1.5) + 0.01);
		assert_true(here < loss_at_scale(&crown, triangles, ends[i], 1 / share) + 0.01);
	}
	crown_free(&crown);
}

/* Needles that cover little would be right soonest as a few balloons that cover everything beside them. */
UNIT_TEST(a_few_leaves_of_a_sparse_crown_are_no_balloons)
{
	for (int kind = 0; kind < 3; kind++) {
		struct crown crown;
		seed = 4;
		crown_make(&crown, 1200, kind == 0 ? 0.015 : kind == 1 ? 0.04 : 0.1);
		uint32_t triangles = add_triangles(&crown, 0, 1200, 1),
			points = add_points(&crown, 0, 1200, 1, triangles);
		struct eco_ladder *ladder = add_ladder(&crown, points, triangles);
		measure(&crown, 128);
		check_curve(&crown.plant, ladder, 8);
		for (uint32_t i = 0; i < ladder->curve_count; i++)
			assert_true(error_of(&crown.plant.curves[i]) < 2.1);
		crown_free(&crown);
	}
}

/* The same leaves as one ladder, and as a coarse list with the rest in cells (round robin, so that no cell is
 * special). */
UNIT_TEST(cells_share_the_curve_of_the_whole)
{
	struct crown whole, parts;
	seed = 5;
	crown_make(&whole, 1600, 0.2);
	add_ladder(&whole, ECO_NONE, add_triangles(&whole, 0, 1600, 1));
	measure(&whole, 128);
	seed = 5;
	crown_make(&parts, 1600, 0.2);
	add_ladder(&parts, ECO_NONE, add_triangles(&parts, 0, 200, 1))->total = 1600;
	for (uint32_t cell = 0; cell < CELLS; cell++) {
		parts.anchors[1 + cell] = parts.anchors[0];
		struct eco_ladder *ladder =
			add_ladder(&parts, ECO_NONE, add_triangles(&parts, 200 + cell, 1600 + cell, CELLS));
		ladder->anchor = 1 + cell;
		ladder->flags = ECO_LADDER_NEAR;
		ladder->total = 400;
		ladder->before = 50;
	}
	measure(&parts, 128);
	for (uint32_t i = 0; i < parts.plant.ladder_count; i++) {
		check_curve(&parts.plant, &parts.ladders[i], 8);
		assert_int_equal(parts.ladders[i].curve_first, 0);
	}
	assert_int_equal(parts.plant.curve_count, whole.plant.curve_count);
	for (uint32_t i = 0; i < whole.plant.curve_count; i++) {
		assert_true(fabs(parts.plant.curves[i].share - whole.plant.curves[i].share) < 1e-6);
		assert_true(fabs(error_of(&parts.plant.curves[i]) - error_of(&whole.plant.curves[i])) < 0.02);
	}
	crown_free(&whole);
	crown_free(&parts);
}

/* Adds what a ladder draws at a share; cells beside a whole-plant list show as many of its elements as
 * `density` says. */
static void add_share(struct lod_probe *probe, const struct eco_ladder *ladder, double share, double density)
{
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	struct lod_way way;
	lod_way_begin(&way, &probe->scene, ladder);
	uint64_t vertices = lod_way_vertices(&way, share);
	double own = lod_way_density(&way, vertices);
	uint32_t count = lod_way_cuts(&way, vertices, own > density ? own : density, 0, cuts);
	for (uint32_t i = 0; i < count; i++)
		assert_int_equal(lod_probe_add(probe, &cuts[i], NULL), ECO_OK);
}

/* Greatest difference between the errors of the curve and of drawings at its samples and between them, from
 * GAP_LEAST vertices on. */
static double curve_gap(struct crown *crown, uint32_t views)
{
	struct lod_probe probe;
	const struct eco_ladder *first = &crown->ladders[0];
	double gap = 0;
	uint64_t full = 0;
	assert_int_equal(lod_probe_init(&probe, &crown->plant, &crown->model,
		&(struct lod_probe_options){ .views = views, .pixels = 160 }, NULL), ECO_OK);
	assert_true(lod_probe_keep_model(&probe));
	for (uint32_t i = 0; i < crown->plant.ladder_count; i++)
		full += lod_ladder_full(&probe.scene, &crown->ladders[i]);
	for (uint32_t i = 0; i + 1 < 2 * first->curve_count; i++) {
		const struct eco_curve *sample = &crown->plant.curves[first->curve_first + i / 2];
		double share = i % 2 ? (sample[0].share + (double)sample[1].share) / 2 : sample->share;
		if (share * (double)full < GAP_LEAST)
			continue;
		struct eco_curve said = lod_ladder_curve(&probe.scene, first, share);
		struct lod_probe_result drawn;
		lod_probe_clear(&probe);
		for (uint32_t l = 0; l < crown->plant.ladder_count; l++)
			add_share(&probe, &crown->ladders[l], share, l ? 0 : said.reach);
		lod_probe_compare(&probe, 1, &drawn);
		gap = fmax(gap, fabs(drawn.fp + drawn.fn - said.fp - said.fn));
	}
	lod_probe_free(&probe);
	return gap;
}

/* At the samples and between them, on the curve's own views and on others, in one list and in cells. */
UNIT_TEST(ladders_draw_what_their_curve_was_measured_with)
{
	static const struct { uint32_t leaves; double size; bool cells; } rows[] =
		{ { 900, 0.25, false }, { 1500, 0.12, false }, { 1600, 0.2, true } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct crown crown;
		uint32_t n = rows[i].leaves, whole = rows[i].cells ? n / 8 : n;
		seed = 20 + i;
		crown_make(&crown, n, rows[i].size);
		uint32_t triangles = add_triangles(&crown, 0, whole, 1);
		add_ladder(&crown, add_points(&crown, 0, whole, 1, triangles), triangles)->total = n;
		for (uint32_t cell = 0; rows[i].cells && cell < CELLS; cell++) {
			crown.anchors[1 + cell] = crown.anchors[0];
			triangles = add_triangles(&crown, whole + cell, n + cell, CELLS);
			struct eco_ladder *ladder =
				add_ladder(&crown,
				add_points(&crown, whole + cell, n + cell, CELLS, triangles), triangles);
			ladder->anchor = 1 + cell;
			ladder->flags = ECO_LADDER_NEAR;
			ladder->total = n / CELLS;
			ladder->before = whole / CELLS;
		}
		measure(&crown, 160);
		double own = curve_gap(&crown, 8), other = curve_gap(&crown, 11);
		if (own > 0.02 || other > 0.04)
			fail_msg("crown %zu: the curve's own views differ from it by %g, others by %g", i,
				own, other);
		crown_free(&crown);
	}
}

UNIT_TEST(wood_keeps_its_size_and_far_ladders_have_curves_of_their_own)
{
	struct crown crown;
	seed = 6;
	crown_make(&crown, 300, 0.3);
	struct eco_ladder *wood = add_ladder(&crown, ECO_NONE, add_triangles(&crown, 0, 300, 1));
	struct eco_ladder *far = add_ladder(&crown, ECO_NONE, add_triangles(&crown, 0, 300, 3));
	wood->organ = far->organ = ECO_ORGAN_WOOD;
	far->flags = ECO_LADDER_FAR;
	measure(&crown, 128);
	check_curve(&crown.plant, wood, 8);
	assert_true(far->curve_count > 0 && far->curve_first == 2 * wood->curve_count);
	for (uint32_t i = 0; i < crown.plant.curve_count; i++)
		assert_true(crown.plant.curves[i].scale == 1);
	const struct eco_curve *last = &crown.plant.curves[crown.plant.curve_count - 1];
	assert_true(last->fn > 0.3 && last->fp == 0);
	crown_free(&crown);
}

/* Needles a few grid steps thick: 12 bits are too few for them. */
UNIT_TEST(grids_are_as_fine_as_the_picture_needs_and_no_finer)
{
	struct crown crown;
	struct lod_plant plant = { 0 };
	struct lod_plant_options options = { .name = "needles", .seed = 1, .views = 4, .pixels = 96 };
	struct eco_error error = { 0 };
	double loss;
	seed = 11;
	crown_make(&crown, 400, 0.3);
	for (uint32_t i = 0; i < 400; i++)
		for (int k = 0; k < 3; k++) {
			float *corner = crown.model.position + 12 * (size_t)i + k;
			corner[6] = corner[3] + (corner[6] - corner[3]) * 0.03f;
			corner[9] = corner[0] + (corner[9] - corner[0]) * 0.03f;
		}
	assert_int_equal(lod_plant_build(&plant, &crown.model, &options, &error), ECO_OK);
	assert_int_equal(lod_grid_loss(&plant, &crown.model, &options, &loss, &error), ECO_OK);
	assert_true(loss > LOD_GRID_LOSS);
	double coarse = plant.lists[0].list.grid_step[0];
	assert_int_equal(lod_plant_measure(&plant, &crown.model, &options, &error), ECO_OK);
	assert_int_equal(lod_grid_loss(&plant, &crown.model, &options, &loss, &error), ECO_OK);
	assert_true(loss <= LOD_GRID_LOSS && plant.curve_count > 0);
	assert_true(plant.solved[LOD_SOLVER_GRID].runs == 1 && plant.solved[LOD_SOLVER_GRID].converged == 1);
	assert_in_range(plant.solved[LOD_SOLVER_SCALE].converged, 1, plant.solved[LOD_SOLVER_SCALE].runs);
	uint32_t bits = LOD_GRID_BITS_MIN;
	for (double step = coarse; step > 1.5 * plant.lists[0].list.grid_step[0]; step /= 2)
		bits++;
	assert_in_range(bits, LOD_GRID_BITS_MIN + 1, LOD_GRID_BITS_MAX);
	lod_plant_free(&plant);
	options.grid_bits = bits - 1;
	assert_int_equal(lod_plant_build(&plant, &crown.model, &options, &error), ECO_OK);
	assert_int_equal(lod_grid_loss(&plant, &crown.model, &options, &loss, &error), ECO_OK);
	assert_true(loss > LOD_GRID_LOSS);
	lod_plant_free(&plant);
	crown_free(&crown);
}

/* Half a pixel from LOD_GRID_NEAR_M on: each doubling of the size beyond takes a bit more, up to the most. */
UNIT_TEST(large_plants_have_more_bits)
{
	static const float position[9] = { 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	static const uint32_t index[6] = { 0, 1, 2, 0, 1, 7 };
	static const struct { float size; uint32_t bits; } rows[] = { { 1e-3f, 12 }, { 6, 12 }, { 36, 12 },
		{ 37, 13 }, { 72, 13 }, { 73, 14 },
		{ 146, 15 }, { 1000, 17 },
		{ 1e7f, 18 } };
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		float at[9];
		for (int k = 0; k < 9; k++)
			at[k] = rows[i].size * position[k] + 5;
		struct eco_model model = { .position = at, .vertex_count = 3, .index = (uint32_t *)index,
			.triangle_count = 2 };
		assert_int_equal(lod_grid_bits_least(&model), rows[i].bits);
	}
	assert_int_equal(lod_grid_bits_least(&(struct eco_model){ .triangle_count = 0 }), LOD_GRID_BITS_MIN);
}

UNIT_TEST(every_kind_of_ladder_is_measured)
{
	static const uint32_t leaves[] = { 1, 2, 3, 40, 300 };
	for (size_t n = 0; n < sizeof leaves / sizeof leaves[0]; n++) {
		for (int kind = 0; kind < 5; kind++) {
			struct crown crown;
			seed = 9;
			crown_make(&crown, leaves[n], 0.5);
			uint32_t triangles = kind == 1 ? ECO_NONE : add_triangles(&crown, 0, leaves[n], 1);
			uint32_t points = kind < 2 ? add_points(&crown, 0, leaves[n], 1, triangles)
				: ECO_NONE;
			struct eco_ladder *ladder = add_ladder(&crown, points, triangles);
			if (kind == 3 || kind == 4)
				ladder->lines = add_lines(&crown, 1);
			if (kind == 4) {
				ladder->organ = ECO_ORGAN_WOOD;
				ladder->level_count = 2;
				ladder->level_end[0] = leaves[n] / 2;
				ladder->level_end[1] = 2 * leaves[n];
			}
			measure(&crown, 64);
			check_curve(&crown.plant, ladder, 1);
			assert_int_equal(crown.plant.curve_count, 2 * ladder->curve_count);
			crown_free(&crown);
		}
	}
}

UNIT_TEST(what_covers_nothing_has_no_curve)
{
	struct crown crown;
	seed = 10;
	crown_make(&crown, 3, 1e-5);
	add_ladder(&crown, ECO_NONE, add_triangles(&crown, 0, 3, 1));
	struct eco_ladder *empty = add_ladder(&crown, ECO_NONE, add_triangles(&crown, 0, 0, 1));
	measure(&crown, 64);
	assert_int_equal(crown.plant.curve_count, 0);
	assert_int_equal(empty->curve_count, 0);
	crown_free(&crown);
}

static bool stop_soon(void *ctx, double share)
{
	uint32_t *calls = ctx;
	assert_true(share > 0 && share <= 1);
	return ++*calls < 5;
}

UNIT_TEST(measuring_can_be_stopped_and_repeats_to_the_bit)
{
	struct crown crown;
	uint32_t calls = 0;
	seed = 7;
	crown_make(&crown, 200, 0.2);
	add_ladder(&crown, ECO_NONE, add_triangles(&crown, 0, 200, 1));
	struct lod_plant_options options = { .grid_bits = 1, .no_splats = true, .views = 4, .pixels = 64,
		.progress = stop_soon, .ctx = &calls };
	struct eco_error error = { 0 };
	assert_int_equal(lod_plant_measure(&crown.plant, &crown.model, &options, &error), ECO_INTERRUPTED);
	assert_int_equal(calls, 5);
	measure(&crown, 64);
	uint32_t count = crown.plant.curve_count;
	struct eco_curve *first = malloc(count * sizeof *first);
	memcpy(first, crown.plant.curves, count * sizeof *first);
	measure(&crown, 64);
	assert_int_equal(crown.plant.curve_count, count);
	assert_memory_equal(first, crown.plant.curves, count * sizeof *first);
	free(first);
	crown_free(&crown);
}
