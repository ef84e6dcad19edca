/* Lists of plants: greedy orders with growth codes and simpler forms; splats with their colours, chunks by
 * level and curves with the impostor's; and all of a plant as bytes. */
#include <stdlib.h>

#include "lod/build/impostor/impostor_make.h"
#include "lod/build/measure/probe.h"
#include "lod/build/splat/splat_fit.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* Made by the test under way, until finish. */
static struct soup soup;
static struct lod_plant plant;

static void measure(struct lod_plant *p, const struct lod_plant_options *options)
{
	assert_good(lod_plant_measure(p, &soup.model, options, &cause));
}

static void build(struct lod_plant *p, const struct lod_plant_options *options)
{
	assert_good(lod_plant_build(p, &soup.model, options, &cause));
}

static void finish(void)
{
	lod_plant_free(&plant);
	soup_free(&soup);
}

/* ---- Orders ---- */

static struct lod_plant_options ordered(enum lod_order_method order, uint32_t bits)
{
	return (struct lod_plant_options){ .name = "test", .seed = 3, .order = order, .grid_bits = bits,
		.views = 3, .pixels = 64 };
}

/* The leaves' triangles, and their simpler form or NULL. */
static const struct lod_list_draft *leaves_of(const struct lod_plant *p, const struct lod_list_draft **simple)
{
	for (uint32_t i = 0; i < p->ladder_count; i++) {
		const struct eco_ladder *ladder = &p->ladders[i];
		*simple = ladder->simple == ECO_NONE ? NULL : &p->lists[ladder->simple];
		if (ladder->organ == ECO_ORGAN_FOLIAGE && ladder->triangles != ECO_NONE)
			return &p->lists[ladder->triangles];
	}
	fail_msg("no leaves");
	return NULL;
}

static const struct eco_list *points_of_cards(bool punched)
{
	soup_tree(&soup, 60, 0, true);
	struct eco_image *image = &soup.image[0];
	for (uint32_t i = 0; punched && i < image->width * image->height; i++)
		if ((i % image->width / 4 + i / image->width / 4) % 2)
			image->rgba[4 * (size_t)i + 3] = 0;
	struct lod_plant_options options = ordered(LOD_ORDER_COMBINED, 0);
	build(&plant, &options);
	for (uint32_t i = 0; i < plant.list_count; i++)
		if (plant.lists[i].list.kind == ECO_LIST_POINTS && plant.lists[i].list.coder == ECO_CODER_FORM)
			return &plant.lists[i].list;
	fail_msg("no points");
	return NULL;
}

/* A disc with holes is as wide as one without, and half of it is covered. */
UNIT_TEST(points_of_cut_outs_cover_what_these_cover)
{
	const struct eco_list disc = *points_of_cards(false);
	finish();
	const struct eco_list *holes = points_of_cards(true);
	assert_int_equal(disc.cover, 0);
	assert_true(holes->cover >= 7 && holes->cover <= 9);
	assert_true(fabsf(holes->unit_area / disc.unit_area - 1) < 0.12f);
	finish();
}

/* Each leaf of a greedy order has a code, and its simpler form the same. */
static void check_greedy(const struct lod_list_draft *leaves, const struct lod_list_draft *simple)
{
	const struct eco_elements *e = &leaves->elements, *s = &simple->elements;
	assert_int_equal(simple->list.coder, ECO_CODER_FORM);
	assert_ptr_equal(&plant.lists[simple->list.partner], leaves);
	assert_int_equal(s->element_count, e->element_count);
	assert_true(s->primitive_count < e->primitive_count);
	for (uint32_t i = 0; i < e->element_count; i++) {
		int32_t code = e->extra[(size_t)e->extra_count * (i + 1) - 1];
		assert_in_range(code, 0, ECO_GROWTHS - 1);
		assert_int_equal(s->corners[i], s->corners[0]);
		assert_int_equal(s->extra[(size_t)s->extra_count * (i + 1) - 1], code);
	}
}

static bool same_order(const struct lod_list_draft *a, const struct lod_list_draft *b)
{
	const struct eco_elements *x = &a->elements, *y = &b->elements;
	assert_int_equal(x->corner_count, y->corner_count);
	return memcmp(x->position, y->position, 3 * (size_t)x->corner_count * sizeof *x->position) == 0;
}

UNIT_TEST(orders_differ_and_greedy_ones_have_codes_and_simpler_forms)
{
	FREED(lod_plant) first;
	const struct lod_list_draft *simple, *unused;
	soup_tree(&soup, 200, 25, false);
	struct lod_plant_options options = ordered(LOD_ORDER_STOCHASTIC, 12);
	build(&first, &options);
	for (int order = 0; order < LOD_ORDER_COUNT; order++) {
		options.order = (enum lod_order_method)order;
		build(&plant, &options);
		const struct lod_list_draft *leaves = leaves_of(&plant, &simple);
		assert_int_equal(same_order(leaves_of(&first, &unused), leaves), order == LOD_ORDER_STOCHASTIC);
		assert_int_equal(!!(leaves->list.attributes & ECO_ATTR_GROWTH), order == LOD_ORDER_GREEDY);
		assert_int_equal(simple != NULL, order == LOD_ORDER_GREEDY);
		if (simple)
			check_greedy(leaves, simple);
		lod_plant_free(&plant);
	}
	soup_free(&soup);
}

/* While the grid is still to be chosen there is a draft, which measuring replaces. */
UNIT_TEST(order_waits_for_the_grid)
{
	const struct lod_list_draft *simple;
	struct lod_plant_options options = ordered(LOD_ORDER_GREEDY, 0);
	soup_tree(&soup, 200, 25, false);
	build(&plant, &options);
	assert_false(leaves_of(&plant, &simple)->list.attributes & ECO_ATTR_GROWTH);
	measure(&plant, &options);
	assert_true(leaves_of(&plant, &simple)->list.attributes & ECO_ATTR_GROWTH);
	assert_true(plant.curve_count > 0);
	finish();
}

/* ---- Splats ---- */

#define MOST 16u                 /* colours of splats */

static const struct lod_plant_options draft = { .name = "p", .seed = 1, .order = LOD_ORDER_STOCHASTIC,
	.grid_bits = 12, .views = 3, .pixels = 48 };
/* With cells. */
static const struct lod_plant_options quick = { .name = "tree", .grid_bits = 14, .cell_triangles = 400,
	.order = LOD_ORDER_STOCHASTIC, .views = 6, .pixels = 96 };

/* The list of splats, which comes last; its colours lie behind those of the other lists, and the color of
 * wood behind these. */
static const struct lod_list_draft *splats_of_plant(void)
{
	const struct lod_list_draft *last = &plant.lists[plant.list_count - 1];
	assert_true(last->list.attributes & ECO_ATTR_SPLAT);
	assert_in_range(last->list.palette_count, 1, MOST);
	assert_int_equal(last->list.palette_first + last->list.palette_count + (last->list.wood != 0),
		plant.palette_count);
	for (uint32_t i = 0; i + 1 < plant.list_count; i++)
		assert_true(plant.lists[i].list.palette_first + plant.lists[i].list.palette_count
			<= last->list.palette_first);
	return last;
}

/* Mean distance of a channel from the splats as they are fitted, with as many views as a draft has. */
static double mean_error(void)
{
	const struct lod_list_draft *list = splats_of_plant();
	const struct eco_elements *e = &list->elements;
	FREED(lod_splats) fitted;
	double sum = 0;
	assert_good(lod_splats_fit(&fitted, &soup.model,
		&(struct lod_splats_options){ .views = 8, .pixels = 72 }, &cause));
	uint32_t count = fitted.level_end[fitted.level_count - 1];
	assert_int_equal(count, e->element_count);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t color = (uint32_t)e->extra[(size_t)e->extra_count * i];
		assert_true(color < list->list.palette_count);
		for (int k = 0; k < 3; k++)
			sum += abs(plant.palette[list->list.palette_first + color][k] - fitted.items[i].rgb[k]);
	}
	return sum / (3.0 * count);
}

/* Green leaves and white blossoms: a splat's mean of them is far from both. */
UNIT_TEST(mixed_colours_are_kept)
{
	for (int blossoms = 0; blossoms <= 300; blossoms += 300) {
		soup_begin(&soup);
		soup.state = 11;
		uint32_t green = soup_material(&soup, 40, 110, 20, ECO_NONE, false),
			white = soup_material(&soup, 250, 245, 255, ECO_NONE, false);
		soup_leaves(&soup, green, 300, (struct lod_v3){ 0, 0, 3 }, 1.5, 0.3);
		soup_leaves(&soup, white, blossoms, (struct lod_v3){ 0, 0, 3.2 }, 1.5, 0.2);
		build(&plant, &draft);
		measure(&plant, &draft);
		double error = mean_error();
		if (error > 6)
			fail_msg("%d blossoms: splats are %.2f off", blossoms, error);
		finish();
	}
}

/* A beginning of a level is drawn alone, and fetched without the rest: no chunk but the first is more than a
 * quarter of its level and of 96 splats. Chunks end where levels do. */
UNIT_TEST(a_part_of_a_level_is_fetched_in_part)
{
	soup_tree(&soup, 3000, 0, false);
	build(&plant, &draft);
	measure(&plant, &draft);
	const struct lod_list_draft *list = splats_of_plant();
	const struct eco_ladder *ladder = &plant.ladders[plant.ladder_count - 1];
	uint32_t i = 0, first = 0;
	assert_true(ladder->flags & ECO_LADDER_WHOLE);
	for (uint32_t level = 0; level < ladder->level_count; level++) {
		uint32_t end = ladder->level_end[level],
			size = end - (level ? ladder->level_end[level - 1] : 0);
		for (; i < list->end_count && list->ends[i] <= end; first = list->ends[i++])
			assert_true(!first || list->ends[i] - first < 96
				|| list->ends[i] - first <= size / 4);
		assert_true(end <= 16 || first == end);
	}
	assert_int_equal(i, list->end_count);
	assert_true(ladder->level_end[ladder->level_count - 1] > 500 && list->end_count > 8);
	finish();
}

static const struct eco_ladder *whole_of_plant(void)
{
	for (uint32_t i = 0; i < plant.ladder_count; i++)
		if (plant.ladders[i].flags & ECO_LADDER_WHOLE)
			return &plant.ladders[i];
	fail_msg("no ladder of splats");
	return NULL;
}

/* A sample has the error that a probe measures that draws a level of the impostor, or a cut, and nothing else. */
static void check_error(const struct eco_curve *sample, const struct lod_plant_options *options,
	uint32_t level, const struct eco_cut *cut)
{
	const struct lod_probe_options size = { options->views, options->pixels, NULL, NULL };
	FREED(lod_probe) probe;
	struct lod_probe_result result;
	struct lod_impostor impostor;
	lod_probe_init(&probe, &plant, &soup.model, &size);
	assert_true(lod_probe_keep_model(&probe));
	lod_probe_clear(&probe);
	if (cut) {
		lod_probe_add(&probe, cut);
	} else {
		lod_plant_open_impostor(&impostor, &plant, level);
		lod_probe_add_impostor(&probe, &impostor);
	}
	lod_probe_compare(&probe, 1, &result);
	if (!cut)
		lod_impostor_close(&impostor);
	double measured = (double)sample->fp + (double)sample->fn, drawn = result.fp + result.fn;
	if (fabs(measured - drawn) > (cut ? 0.03 : 0.01) * drawn)
		fail_msg("%s: an error of %g, not %g", cut ? "splats" : "impostor", measured, drawn);
}

/* Triangles of all leaves, in cells or not, that stand before splats. */
static uint32_t leaves_before(const struct eco_ladder *whole)
{
	uint32_t sum = 0, organ = ECO_ORGAN_COUNT;
	for (uint32_t i = 0; i < plant.ladder_count; i++) {
		const struct eco_ladder *ladder = &plant.ladders[i];
		if (ladder != whole && ladder->triangles == whole->triangles)
			organ = ladder->organ;
		sum += ladder != whole && ladder->organ == organ ? plant.lists[ladder->triangles].list.primitive_count : 0;
	}
	return sum;
}

/* The first samples are levels of the impostor, those after them splats. Errors are of the whole plant, in
 * one with cells, too, whose whole-plant lists do not stand for what the cells hold. */
static void check_samples(const struct lod_plant_options *options)
{
	const struct eco_ladder *whole = whole_of_plant();
	uint32_t levels = plant.impostor_count, count = whole->curve_count, end = whole->level_count - 1;
	struct eco_cut all = { .list = whole->points, .first = end ? whole->level_end[end - 1] : 0,
		.end = whole->level_end[end], .scale = 1 };
	double splats = all.end - all.first, full = splats + (whole->triangles == ECO_NONE ? 0 : 3.0 * whole->total);
	uint32_t last = count - 1;       /* sample of splats alone */
	while (last && plant.curves[whole->curve_first + last].share > (float)(splats / full))
		last--;
	assert_int_equal(whole->impostor, plant.list_count);
	assert_int_equal(whole->total, leaves_before(whole));
	assert_true(count > levels);
	for (uint32_t from = 0; from < eco_ladder_samples(whole); from += count) {
		const struct eco_curve *samples = plant.curves + whole->curve_first + from;
		for (uint32_t i = 0; i < levels; i++) {
			assert_true(samples[i].share == (float)((i + 1.0) / levels / full));
			assert_true(samples[i].scale == 1 && samples[i].reach == 1 && samples[i].fn <= 1);
			assert_true(samples[i].fp >= 0 && samples[i].fn >= 0 && samples[i].fp + samples[i].fn <= 2);
		}
		for (uint32_t i = 1; i < count; i++)
			assert_true(samples[i].share > samples[i - 1].share);
		/* no sample of one splat is left */
		assert_true((double)samples[levels].share * full > 1.5);
		assert_true(samples[last].share == (float)(splats / full));
	}
	for (uint32_t i = 0; i < levels; i++)
		check_error(&plant.curves[whole->curve_first + i], options, i, NULL);
	check_error(&plant.curves[whole->curve_first + last], options, 0, &all);
}

/* Wood, which stands upright, does not count. */
UNIT_TEST(splats_say_how_level_leaves_lie)
{
	const struct lod_v3 x = { 0.2, 0, 0 }, sides[] = { { 0, 0.2, 0 }, { 0, 0.1, 0.1 }, { 0, 0, 0.2 } };
	static const double shares[] = { 1, 0.25, 0 };
	for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
		soup_begin(&soup);
		uint32_t wood = soup_material(&soup, 90, 60, 40, ECO_NONE, false),
			leaf = soup_material(&soup, 60, 150, 40, ECO_NONE, false);
		soup_tube(&soup, wood, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 4 }, 0.1, 0.05, 8, 4);
		for (int k = 0; k < 60; k++)
			soup_quad(&soup, leaf, (struct lod_v3){ soup_random(&soup, -2, 2), soup_random(&soup, -2, 2),
				soup_random(&soup, 2, 5) }, x, sides[i]);
		build(&plant, &quick);
		assert_true(fabs(eco_level_share(plant.lists[plant.ladders[plant.ladder_count - 1].points].list.level)
			- shares[i]) < 0.01);
		finish();
	}
}

UNIT_TEST(a_body_of_one_piece_has_no_leaves)
{
	for (int leaves = 0; leaves < 2; leaves++) {
		soup_begin(&soup);
		if (leaves)
			soup_tree(&soup, 300, 0, false);
		else
			soup_ball(&soup, soup_material(&soup, 60, 150, 40, ECO_NONE, false), (struct lod_v3){ 0, 0, 2 }, 2, 24);
		measure(&plant, &draft);
		assert_int_equal(plant.plant.leaf_width > 0, leaves);
		finish();
	}
}

/* A draft has two levels of the impostor, a plant all; those larger than the plant are left out, unless it
 * has a picture, which is larger still. */
UNIT_TEST(curves_of_whole_plants_have_the_levels_of_the_impostor_and_of_splats)
{
	enum { TREE, CARDS, TEXTURED };
	static const struct { int kind; uint32_t pixels, least, most; } rows[] = { { TREE, 96, 2, 2 },
		{ TREE, 160, ECO_IMPOSTOR_LEVELS, ECO_IMPOSTOR_LEVELS }, { CARDS, 160, 1, ECO_IMPOSTOR_LEVELS - 1 },
		{ TEXTURED, 160, ECO_IMPOSTOR_LEVELS, ECO_IMPOSTOR_LEVELS } };
	for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
		struct lod_plant_options options = quick;
		bool textured = rows[row].kind == TEXTURED;
		options.pixels = rows[row].pixels;
		if (rows[row].kind == TREE) {
			soup_tree(&soup, 300, 20, false);
		} else {
			soup_begin(&soup);
			uint32_t leaf = soup_material(&soup, 60, 150, 40, textured ? soup_disc_image(&soup, 256)
				: ECO_NONE, textured);
			for (uint32_t i = 0; i < 40; i++)
				soup_leaf(&soup, leaf, (struct lod_v3){ 0, 0, 0.1 * i }, 1, 0.2);
		}
		build(&plant, &options);
		measure(&plant, &options);
		assert_int_equal(plant.plant.anchor_count > 2, rows[row].kind == TREE);
		assert_in_range(plant.impostor_count, rows[row].least, rows[row].most);
		for (uint32_t i = 1; i < plant.impostor_count && rows[row].kind == CARDS; i++)
			assert_true(plant.impostor[i].size <= 12u * soup.model.triangle_count);
		for (uint32_t k = 0; k < plant.ladder_count; k++)
			assert_true(plant.ladders[k].flags & ECO_LADDER_WHOLE || plant.ladders[k].impostor == ECO_NONE);
		check_samples(&options);
		finish();
	}
}

/* ---- Bytes ---- */

/* With textured leaves and coloured flowers; cells where there are many. */
static void make_plant(uint32_t leaves, uint32_t cell_triangles, bool no_splats)
{
	const struct lod_plant_options options = { .name = "a name", .seed = 1, .grid_bits = 12,
		.cell_triangles = cell_triangles, .views = 3, .pixels = 48, .no_splats = no_splats };
	soup_tree(&soup, leaves, leaves / 10, true);
	build(&plant, &options);
	measure(&plant, &options);
}

#define SAME(a, b, count) assert_memory_equal(a, b, (size_t)(count) * sizeof *(a))

static void assert_same_list(const struct lod_list_draft *a, const struct lod_list_draft *b)
{
	const struct eco_elements *e = &a->elements, *f = &b->elements;
	assert_int_equal(a->list.element_count, b->list.element_count);
	assert_int_equal(e->uv != NULL, f->uv != NULL);
	assert_int_equal(e->exact != NULL, f->exact != NULL);
	SAME(a->ends, b->ends, a->end_count);
	SAME(e->corners, f->corners, e->element_count);
	SAME(e->position, f->position, 3 * e->corner_count);
	SAME(e->extra, f->extra, e->element_count * e->extra_count);
	assert_int_equal(e->part != NULL, f->part != NULL);
	if (e->part)
		SAME(e->part, f->part, e->element_count);
	if (e->exact)
		SAME(e->exact, f->exact, 3 * e->corner_count);
	if (e->uv)
		SAME(e->uv, f->uv, 2 * e->corner_count);
}

UNIT_TEST(what_is_read_is_what_was_written)
{
	static const struct { uint32_t leaves, cell_triangles; bool no_splats; } rows[] = { { 0, 0, false },
		{ 1, 0, true }, { 60, 0, true }, { 900, 300, false } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		FREED(lod_plant) again;
		FREED(eco_writer) w = { 0 };
		make_plant(rows[i].leaves, rows[i].cell_triangles, rows[i].no_splats);
		lod_plant_write(&w, &plant);
		assert_good(lod_plant_read(&again, w.bytes, w.size, &cause));
		assert_string_equal(again.plant.name, "");
		assert_int_equal(again.list_count, plant.list_count);
		SAME(again.solved, plant.solved, LOD_SOLVER_COUNT);
		SAME(again.anchors, plant.anchors, plant.plant.anchor_count);
		SAME(again.ladders, plant.ladders, plant.ladder_count);
		SAME(again.curves, plant.curves, plant.curve_count);
		SAME(again.palette, plant.palette, plant.palette_count);
		for (uint32_t l = 0; l < plant.list_count; l++)
			assert_same_list(&plant.lists[l], &again.lists[l]);
		assert_int_equal(plant.impostor_count > 0, !rows[i].no_splats);
		assert_int_equal(again.impostor_count, plant.impostor_count);
		for (uint32_t l = 0; l < plant.impostor_count; l++)
			SAME(again.impostor[l].at, plant.impostor[l].at, plant.impostor[l].size);
		assert_true(rows[i].cell_triangles == 0 || plant.plant.anchor_count > 1);
		finish();
	}
}

UNIT_TEST(truncations_are_refused)
{
	struct lod_plant again;
	FREED(eco_writer) w = { 0 };
	make_plant(12, 0, true);
	lod_plant_write(&w, &plant);
	for (size_t size = 0; size < w.size; size++) {
		/* exactly as long as said, so that a sanitizer sees a read beyond it */
		uint8_t *part = malloc(size + 1);
		struct eco_error error = { 0 };
		memcpy(part, w.bytes, size);
		part = realloc(part, size ? size : 1);
		assert_int_equal(lod_plant_read(&again, part, size, &error), ECO_DAMAGED);
		assert_true(error.text[0] && !again.lists && !again.impostor);
		free(part);
	}
	finish();
}
