/* Plants from models: nothing is lost, nothing is twice, and everything refers to what it should. */
#include "ecofiles/format/chunk/chunk.h"
#include "lod/build/plant.h"
#include "lod/geometry.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* ---- Plants to try ---- */

/* Made by the test under way, until finish. */
static struct soup soup;
static struct lod_plant plant;

enum kind { SMALL_TREE, TREE_WITH_CELLS, TEXTURED_TREE, BARE_TREE, SHADED_BARK, GRASS, HULL, KINDS };

static void make_model(enum kind kind)
{
	switch (kind) {
	case SMALL_TREE: soup_tree(&soup, 300, 25, false); return;
	case TREE_WITH_CELLS: soup_tree(&soup, 4000, 900, false); return;
	case TEXTURED_TREE: soup_tree(&soup, 1500, 40, true); return;
	case BARE_TREE: soup_tree(&soup, 0, 0, false); return;
	case SHADED_BARK:
		soup_tree(&soup, 0, 0, false);
		soup.material[0].image = soup_disc_image(&soup, 8);
		for (uint32_t i = 0; i < 64; i++)
			memcpy(soup.image[0].rgba + 4 * i, i % 2 ? "\x60\x40\x20\xff" : "\x40\x28\x10\xff",
				4);
		return;
	default: soup_begin(&soup);
	}
	uint32_t green = soup_material(&soup, 60, 150, 40, ECO_NONE, false);
	if (kind == HULL)
		soup_ball(&soup, green, (struct lod_v3){ 0, 0, 1 }, 1, 30);
	for (uint32_t i = 0; i < 900 && kind == GRASS; i++) {
		struct lod_v3 at = { soup_random(&soup, -1, 1), soup_random(&soup, -1, 1), 0.2 };
		soup_quad(&soup, green, at, (struct lod_v3){ 0.01, 0, 0 },
			(struct lod_v3){ soup_random(&soup, -0.1, 0.1), soup_random(&soup, -0.1, 0.1), 0.4 });
	}
}

static struct lod_plant_options options_for(enum kind kind)
{
	return (struct lod_plant_options){ .name = "test", .seed = 3, .order = LOD_ORDER_COMBINED,
		.grid_bits = 14,
		.cell_triangles = kind == SMALL_TREE ? 0 : 600, .importance = { [ECO_ORGAN_FLOWER] = 3 } };
}

static void build(enum kind kind)
{
	struct lod_plant_options options = options_for(kind);
	make_model(kind);
	assert_good(lod_plant_build(&plant, &soup.model, &options, &cause));
}

static void finish(void)
{
	lod_plant_free(&plant);
	soup_free(&soup);
}

/* ---- Nothing lost, nothing twice ---- */

struct corners { int32_t p[9]; };

static int compare_corners(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct corners));
}

static int compare_position(const void *a, const void *b)
{
	return memcmp(a, b, 3 * sizeof(int32_t));
}

static void add_triangle(struct corners *to, const int32_t *a, const int32_t *b, const int32_t *c)
{
	memcpy(to->p, a, 12);
	memcpy(to->p + 3, b, 12);
	memcpy(to->p + 6, c, 12);
	qsort(to->p, 3, 12, compare_position);
}

/* Triangles of full detail: all fans, and the last level of wood. */
static uint32_t stored_triangles(struct corners *out)
{
	uint32_t n = 0;
	for (uint32_t l = 0; l < plant.ladder_count; l++) {
		const struct eco_ladder *ladder = &plant.ladders[l];
		if (ladder->triangles == ECO_NONE)
			continue;
		const struct eco_elements *e = &plant.lists[ladder->triangles].elements;
		uint32_t first = ladder->level_count > 1 ? ladder->level_end[ladder->level_count - 2] : 0,
			triangle = 0;
		const int32_t *p = e->position;
		for (uint32_t i = 0; i < e->element_count; p += 3 * e->corners[i++])
			for (uint32_t k = 0; k + 2 < e->corners[i]; k++)
				if (triangle++ >= first)
					add_triangle(&out[n++], p, p + 3 * (k + 1), p + 3 * (k + 2));
	}
	qsort(out, n, sizeof *out, compare_corners);
	return n;
}

static uint32_t source_triangles(struct corners *out)
{
	const struct eco_model *model = &soup.model;
	const struct eco_list *list = &plant.lists[0].list;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		int32_t p[3][3];
		for (int k = 0; k < 3; k++)
			for (int a = 0; a < 3; a++)
				p[k][a] = (int32_t)floor((model->position[3 * model->index[3 * t + k] + a]
					- list->grid_origin[a]) / list->grid_step[a] + 0.5);
		add_triangle(&out[t], p[0], p[1], p[2]);
	}
	qsort(out, model->triangle_count, sizeof *out, compare_corners);
	return model->triangle_count;
}

static void check_triangles(void)
{
	uint32_t n = soup.model.triangle_count;
	FREED_MEMORY struct corners *stored = calloc(n, sizeof *stored), *source = calloc(n, sizeof *source);
	assert_int_equal(plant.triangles_in, n);
	assert_int_equal(plant.triangles_stored, n);     /* nothing here is too small or hidden */
	for (int d = 0; d < ECO_DROP_COUNT; d++)
		assert_int_equal(plant.dropped[d], 0);
	assert_int_equal(stored_triangles(stored), n);
	source_triangles(source);
	assert_memory_equal(stored, source, n * sizeof *stored);
}

/* ---- Lists ---- */

static void check_list(const struct lod_list_draft *draft)
{
	const struct eco_elements *e = &draft->elements;
	const struct eco_list *list = &draft->list;
	uint32_t corners = 0, primitives = 0;
	assert_true(e->element_count > 0);
	assert_int_equal(list->element_count, e->element_count);
	assert_int_equal(list->primitive_count, e->primitive_count);
	assert_int_equal(e->extra_count, eco_list_extra_count(list));
	for (uint32_t i = 0; i < e->element_count; i++) {
		corners += e->corners[i];
		primitives += e->corners[i] < 3 ? 1 : e->corners[i] - 2u;
		if (list->attributes & ECO_ATTR_COLOR)
			assert_in_range(e->extra[i * e->extra_count], 0, list->palette_count - 1);
		if (list->attributes & ECO_ATTR_WIDTH)
			assert_true(e->extra[i * e->extra_count + 1] >= 1);
	}
	assert_int_equal(corners, e->corner_count);
	assert_int_equal(primitives, e->primitive_count);
	for (uint32_t i = 0; i < 3 * corners; i++)
		assert_in_range(e->position[i] + 2, 0, (1 << 14) + 4);
	for (uint32_t i = 0; i < 2 * corners && e->uv; i++)
		assert_true(e->uv[i] >= 0);
	assert_true(list->image == ECO_NONE || list->image < plant.image_count);
	assert_true((list->attributes & ECO_ATTR_UV ? 1 : 0) == (e->uv != NULL));
	assert_true(list->palette_first + list->palette_count <= plant.palette_count);
	assert_true(draft->end_count >= 1);
	for (uint32_t c = 0; c < draft->end_count; c++)
		assert_true(draft->ends[c] > (c ? draft->ends[c - 1] : 0));
	assert_int_equal(draft->ends[draft->end_count - 1], e->element_count);
}

/* Each form has an element for each of its partner's, close to it, and of the same area in all. */
static void check_form(const struct lod_list_draft *form)
{
	const struct lod_list_draft *fans = &plant.lists[form->list.partner];
	const struct eco_elements *f = &fans->elements, *e = &form->elements;
	const int32_t *p = f->position, *q = e->position;
	uint32_t at = form->list.kind == ECO_LIST_POINTS ? eco_list_extra_at(&form->list, ECO_ATTR_SIZE) : 0;
	double sizes = 0;
	assert_int_equal(e->element_count, f->element_count);
	assert_int_equal(form->end_count, fans->end_count);
	assert_memory_equal(form->ends, fans->ends, form->end_count * sizeof *form->ends);
	for (uint32_t i = 0; i < f->element_count; p += 3 * f->corners[i], q += 3 * e->corners[i], i++) {
		struct lod_v3 low = { p[0], p[1], p[2] }, high = low;
		assert_int_equal(e->corners[i], e->corners[0]);
		for (uint32_t k = 1; k < f->corners[i]; k++) {
			low = (struct lod_v3){ fmin(low.x, p[3 * k]), fmin(low.y, p[3 * k + 1]),
				fmin(low.z, p[3 * k + 2]) };
			high = (struct lod_v3){ fmax(high.x, p[3 * k]), fmax(high.y, p[3 * k + 1]),
				fmax(high.z, p[3 * k + 2]) };
		}
		double slack = form->list.kind == ECO_LIST_POINTS ? 1 : 0.3 * lod_v3_distance(low, high) + 2;
		for (uint32_t k = 0; k < e->corners[i]; k++) {
			assert_true(q[3 * k] >= low.x - slack && q[3 * k + 1] >= low.y - slack
				&& q[3 * k + 2] >= low.z - slack);
			assert_true(q[3 * k] <= high.x + slack && q[3 * k + 1] <= high.y + slack
				&& q[3 * k + 2] <= high.z + slack);
		}
		if (form->list.kind == ECO_LIST_POINTS)
			sizes += eco_size((uint32_t)e->extra[i * e->extra_count + at]);
	}
	if (form->list.kind == ECO_LIST_POINTS)
		assert_true(form->list.unit_area > 0 && sizes > 0.5 * e->element_count
			&& sizes < 2.5 * e->element_count);
	assert_true(form->list.primitive_count * eco_list_vertices(&form->list)
		<= 3 * fans->list.primitive_count);
}

static const int32_t *first_corner(const struct eco_elements *e, uint32_t element)
{
	uint32_t at = 0;
	for (uint32_t i = 0; i < element; i++)
		at += e->corners[i];
	return e->position + 3 * (size_t)at;
}

/* Leaves are measured in the order in which clients decode them: elements that change places begin in one corner. */
static void check_order(const struct eco_chunk_input *input)
{
	uint32_t count = input->end - input->first;
	FREED_MEMORY uint32_t *order = malloc(count * sizeof *order);
	assert_good(eco_chunk_order(input, order, &cause));
	for (uint32_t i = 0; i < count; i++)
		assert_true(order[i] == i || !memcmp(first_corner(input->elements, input->first + i),
			first_corner(input->elements, input->first + order[i]), 3 * sizeof(int32_t)));
}

static void check_coded(const struct lod_list_draft *draft)
{
	const struct lod_list_draft *of = draft->list.coder == ECO_CODER_FORM ? &plant.lists[draft->list.partner]
		: draft;
	for (uint32_t c = 0; c < draft->end_count && c < 4; c++) {
		struct eco_chunk_input input =
			{ &of->list, &of->elements, c ? of->ends[c - 1] : 0, of->ends[c], c };
		FREED_MEMORY uint8_t *bytes;
		size_t size;
		if (of->list.coder == ECO_CODER_ELEMENTS && of->list.kind == ECO_LIST_TRIANGLES)
			check_order(&input);
		assert_good(of == draft ? eco_chunk_encode(&input, &bytes, &size, &cause)
			: eco_chunk_encode_form(&input, &draft->list, &draft->elements, &bytes, &size, &cause));
	}
}

static void check_lists(void)
{
	for (uint32_t l = 0; l < plant.list_count; l++) {
		check_list(&plant.lists[l]);
		check_coded(&plant.lists[l]);
		for (int a = 0; a < 3; a++) {            /* one grid for the whole plant */
			assert_true(plant.lists[l].list.grid_origin[a] == plant.lists[0].list.grid_origin[a]);
			assert_true(plant.lists[l].list.grid_step[a] == plant.lists[0].list.grid_step[0]);
		}
		if (plant.lists[l].list.coder == ECO_CODER_FORM)
			check_form(&plant.lists[l]);
	}
}

/* ---- Ladders and cells ---- */

static bool inside(const struct eco_anchor *anchor, const struct lod_list_draft *draft)
{
	for (uint32_t i = 0; i < draft->elements.corner_count; i++) {
		double sum = 0;
		for (int a = 0; a < 3; a++) {
			double d = draft->list.grid_origin[a]
				+ draft->elements.position[3 * i + a] * draft->list.grid_step[a]
				- anchor->center[a];
			sum += d * d;
		}
		if (sqrt(sum) > anchor->radius)
			return false;
	}
	return true;
}

static uint32_t primitives(uint32_t list)
{
	return list == ECO_NONE ? 0 : plant.lists[list].list.primitive_count;
}

static void check_ladder(const struct eco_ladder *l)
{
	const uint32_t lists[4] = { l->points, l->lines, l->simple, l->triangles };
	uint32_t own = l->organ == ECO_ORGAN_WOOD ? primitives(l->lines)
		: plant.lists[l->triangles].list.element_count, last = 0;
	assert_true(l->anchor < plant.plant.anchor_count);
	assert_true((l->flags & ECO_LADDER_NEAR ? 1 : 0) == (l->anchor > 0));
	assert_true(l->importance == (l->organ == ECO_ORGAN_FLOWER ? 3 : 1));
	assert_true(l->area > 0);
	for (int i = 0; i < 4; i++)
		if (lists[i] != ECO_NONE) {
			assert_true(inside(&plant.anchors[0], &plant.lists[lists[i]]));
			assert_true(inside(&plant.anchors[l->anchor], &plant.lists[lists[i]]));
		}
	if (l->organ == ECO_ORGAN_WOOD)
		assert_int_equal(l->before, 0);
	if (l->flags != ECO_LADDER_FAR && l->anchor > 0)
		assert_int_equal(l->total, l->before + own);
	assert_true(l->total >= own);
	for (uint32_t i = 0; i < l->level_count; i++) {
		bool is_end = false;
		const struct lod_list_draft *draft = &plant.lists[l->triangles];
		for (uint32_t c = 0; c < draft->end_count; c++)
			is_end = is_end || draft->ends[c] == l->level_end[i];
		assert_true(is_end);
		assert_true(l->level_end[i] - last
			> (i ? l->level_end[i - 1] - (i > 1 ? l->level_end[i - 2] : 0) : 0));
		const int32_t *limb = draft->elements.part;
		assert_true(!limb == (plant.plant.anchor_count > 1));
		for (uint32_t t = last + 1; limb && t < l->level_end[i]; t++)
			assert_true(limb[t] >= limb[t - 1]);
		last = l->level_end[i];
	}
	if (l->level_count)
		assert_int_equal(last, primitives(l->triangles));
}

UNIT_TEST(every_triangle_is_stored_once_and_lists_and_ladders_are_consistent)
{
	for (enum kind kind = 0; kind < KINDS; kind++) {
		build(kind);
		check_triangles();
		check_lists();
		assert_true((plant.plant.anchor_count > 1) == (kind != SMALL_TREE));
		uint32_t anchor = 0, flowers = 0;
		for (uint32_t l = 0; l < plant.ladder_count; l++) {
			check_ladder(&plant.ladders[l]);
			assert_true(plant.ladders[l].anchor >= anchor || anchor > 0);
			anchor = plant.ladders[l].anchor ? plant.ladders[l].anchor : anchor;
			/* the whole plant's come first */
			assert_true(anchor == 0 || plant.ladders[l].anchor != 0);
			flowers += plant.ladders[l].organ == ECO_ORGAN_FLOWER;
		}
		assert_int_equal(plant.image_count, kind == TEXTURED_TREE || kind == SHADED_BARK);
		assert_true(kind != TEXTURED_TREE || flowers == 1);      /* 40 of them are not parted */
		finish();
	}
}

/* Regions of the cells add up to the whole: samples, area, and what the coarse list holds of them. */
UNIT_TEST(cells_add_up)
{
	build(TREE_WITH_CELLS);
	assert_true(plant.plant.anchor_count > 8);
	for (uint32_t organ = ECO_ORGAN_FOLIAGE; organ <= ECO_ORGAN_FLOWER; organ++) {
		const struct eco_ladder *whole = NULL;
		uint32_t total = 0, before = 0;
		double area = 0;
		for (uint32_t l = 0; l < plant.ladder_count; l++) {
			const struct eco_ladder *ladder = &plant.ladders[l];
			if (ladder->organ != organ)
				continue;
			if (ladder->anchor == 0)
				whole = ladder;
			total += ladder->anchor ? ladder->total : 0;
			before += ladder->anchor ? ladder->before : 0;
			area += ladder->anchor ? ladder->area : 0;
		}
		assert_non_null(whole);
		assert_int_equal(whole->flags, 0);
		assert_int_equal(total, whole->total);
		assert_int_equal(before, primitives(whole->points));
		assert_true(before >= 256 && before <= total / 3);
		assert_true(fabs(area - whole->area) < 1e-3 * area);
	}
	finish();
}

/* ---- Behaviour ---- */

struct watch { double last, stop; };

static bool watch_progress(void *ctx, double share)
{
	struct watch *watch = ctx;
	assert_true(share >= watch->last && share <= 1);
	watch->last = share;
	return share < watch->stop;
}

/* In combined order, then in the greedy one, which is stopped while it picks and while it refines. */
UNIT_TEST(progress_ascends_and_may_stop_the_build)
{
	static const double stops[2][5] = { { 0, 0.05, 0.1, 0.93, 2 }, { 0.11, 0.35, 0.7, 0.85, 2 } };
	for (int greedy = 0; greedy < 2; greedy++) {
		make_model(greedy ? SMALL_TREE : TREE_WITH_CELLS);
		for (int i = 0; i < 5; i++) {
			struct watch watch = { 0, stops[greedy][i] };
			struct eco_error error = { 0 };
			struct lod_plant_options options = options_for(greedy ? SMALL_TREE : TREE_WITH_CELLS);
			options.order = greedy ? LOD_ORDER_GREEDY : LOD_ORDER_COMBINED;
			options.progress = watch_progress;
			options.ctx = &watch;
			enum eco_code code = lod_plant_build(&plant, &soup.model, &options, &error);
			assert_int_equal(code, stops[greedy][i] <= 1 ? ECO_INTERRUPTED : ECO_OK);
			assert_true((plant.lists != NULL) == (code == ECO_OK));
			assert_true(code || watch.last == 1);
			lod_plant_free(&plant);
		}
		soup_free(&soup);
	}
}

UNIT_TEST(models_without_anything_to_draw_are_refused)
{
	struct lod_plant_options options = { .name = "nothing" };
	for (int points = 0; points < 3; points++) {
		soup_begin(&soup);
		for (int i = 0; i < 3 * points; i++)
			soup_vertex(&soup, (struct lod_v3){ points == 2 ? i : 0, 0, 0 }, 0, 0);
		for (int i = 0; i < points; i++)
			soup_triangle(&soup, 0, 0, 1, 2);
		assert_code(lod_plant_build(&plant, &soup.model, &options, &cause), ECO_BAD_INPUT, "nothing");
		assert_null(plant.lists);
		soup_free(&soup);
	}
}

/* Random triangles with few vertices: fans, loops and edges with many triangles of every kind. */
UNIT_TEST(any_soup_is_stored_completely)
{
	for (uint32_t seed = 1; seed <= 40; seed++) {
		struct lod_plant_options options = { .name = "soup", .order = LOD_ORDER_COMBINED,
			.grid_bits = 5 + seed % 6, .cell_triangles = 20 };
		soup_begin(&soup);
		soup.state = seed;
		uint32_t m = soup_material(&soup, 255, 255, 255, seed % 2 ? soup_disc_image(&soup, 8)
			: ECO_NONE, seed % 4 == 1), n = 5 + seed;
		for (uint32_t v = 0; v < n; v++)
			soup_vertex(&soup,
				(struct lod_v3){ soup_random(&soup, 0, 1), soup_random(&soup, 0, 1),
				soup_random(&soup, 0, 1) }, soup_random(&soup, -40, 40),
				soup_random(&soup, 0, 1));
		for (uint32_t t = 0; t < 4 * n; t++)
			soup_triangle(&soup, m, (uint32_t)soup_random(&soup, 0, n + 1),
				(uint32_t)soup_random(&soup, 0, n), (uint32_t)soup_random(&soup, 0, n));
		assert_good(lod_plant_build(&plant, &soup.model, &options, &cause));
		uint32_t dropped = 0;
		for (int d = 0; d < ECO_DROP_COUNT; d++)
			dropped += plant.dropped[d];
		assert_int_equal(4 * n, plant.triangles_stored + dropped);
		FREED_MEMORY struct corners *stored = calloc(8 * n, sizeof *stored);
		assert_int_equal(stored_triangles(stored), plant.triangles_stored);
		for (uint32_t l = 0; l < plant.list_count; l++)
			assert_int_equal(plant.lists[l].ends[plant.lists[l].end_count - 1],
				plant.lists[l].elements.element_count);
		finish();
	}
}

/* ---- Geometry ---- */

UNIT_TEST(geometry_of_a_range_is_part_of_the_whole)
{
	build(TEXTURED_TREE);
	for (uint32_t l = 0; l < plant.list_count; l++) {
		const struct lod_list_draft *d = &plant.lists[l];
		uint32_t n = d->elements.primitive_count, floats = 3 * eco_list_vertices(&d->list);
		FREED_MEMORY float *all = calloc(n, 36), *part = calloc(n, 36), *uv = calloc(n, 24),
			*width = calloc(n, 4);
		FREED_MEMORY int32_t *color = calloc(n, 4);
		assert_int_equal(lod_list_geometry(&d->list, &d->elements, 0, n, 2,
			&(struct lod_geometry){ .position = all, .uv = uv, .width = width, .color = color }),
			n);
		for (uint32_t first = 0; first < n; first += n / 3 + 1) {
			uint32_t end = first + n / 5 < n ? first + n / 5 : n;
			assert_int_equal(lod_list_geometry(&d->list, &d->elements, first, end, 2,
				&(struct lod_geometry){ .position = part }), end - first);
			assert_memory_equal(part, all + (size_t)floats * first,
				4 * (size_t)floats * (end - first));
		}
	}
	finish();
}
