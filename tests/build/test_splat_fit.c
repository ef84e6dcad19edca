/* Splats fitted to plants; to grass, turf and reeds too, whose many blades are thinner than a pixel. */
#include "lod/build/splat/splat_fit.h"

#include <string.h>

#include "lod/build/splat/splat_state.h"
#include "lod/tint.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

static const struct lod_splats_options quick = { .views = 12, .pixels = 40 };

static void fit(struct lod_splats *splats, const struct eco_model *model,
	const struct lod_splats_options *options)
{
	assert_good(lod_splats_fit(splats, model, options, &cause));
}

UNIT_TEST(levels_have_their_sizes_and_come_closer_and_closer)
{
	static const uint32_t ends[] = { 1, 4, 10, 22, 46, 94, 286 };
	FREED(soup) soup;
	FREED(lod_splats) splats;
	soup_tree(&soup, 300, 25, false);
	fit(&splats, &soup.model, &quick);
	assert_in_range(splats.level_count, 7, LOD_SPLAT_LEVELS);
	for (uint32_t level = 0; level < 7; level++) {
		assert_int_equal(splats.level_end[level], ends[level]);
		assert_true(level < 2 || splats.loss[level] < splats.loss[level - 2]);
	}
	for (uint32_t i = 0; i < splats.level_end[splats.level_count - 1]; i++) {
		const struct lod_splat *splat = &splats.items[i];
		assert_true(eco_splat_good(splat->code));
		for (int k = 0; k < 3; k++)
			assert_in_range(splat->at[k], 0, LOD_SPLAT_GRID - 1);
	}
}

UNIT_TEST(a_ball_is_one_splat)
{
	FREED(soup) soup;
	FREED(lod_splats) splats;
	soup_begin(&soup);
	soup_ball(&soup, soup_material(&soup, 200, 30, 10, ECO_NONE, false), (struct lod_v3){ 1, 2, 3 },
		0.5, 24);
	fit(&splats, &soup.model, &(struct lod_splats_options){ .levels = 1 });
	assert_int_equal(splats.level_count, 1);
	assert_true(splats.loss[0] < 0.05);
	const struct lod_splat *splat = splats.items;
	static const float center[3] = { 1, 2, 3 };
	static const uint8_t red[3] = { 200, 30, 10 };
	for (int k = 0; k < 3; k++) {
		const float *half = splat->shape.half[k];
		double length = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
		assert_true(length > 0.46 && length < 0.54);
		assert_true(fabsf(splat->center[k] - center[k]) < 0.02f);
		assert_in_range(splat->rgb[k], red[k] - 1, red[k] + 1);
	}
	assert_true(splat->shape.opacity > 0.9f);
}

/* ---- Threads and progress ---- */

struct watch { double last, stop_at; };

static bool watched(void *ctx, double share)
{
	struct watch *watch = ctx;
	assert_true(share >= watch->last && share <= 1);
	watch->last = share;
	return share < watch->stop_at;
}

UNIT_TEST(progress_rises_and_can_stop_it)
{
	FREED(soup) soup;
	struct lod_splats splats;
	struct watch watch = { 0, 2 };
	struct lod_splats_options options = quick;
	soup_tree(&soup, 300, 25, false);
	options.levels = 3;
	options.progress = watched;
	options.ctx = &watch;
	fit(&splats, &soup.model, &options);
	assert_true(watch.last > 0.9);
	lod_splats_free(&splats);
	watch = (struct watch){ 0, 0.5 };
	assert_code(lod_splats_fit(&splats, &soup.model, &options, &cause), ECO_INTERRUPTED, "");
	assert_null(splats.items);
	assert_true(watch.last < 0.6);
}

/* ---- Models that are hardly any ---- */

UNIT_TEST(hardly_any_models_have_few_levels)
{
	enum { NOTHING, TOO_THIN, CLEAR, TRIANGLE, SPECKS, KINDS };      /* a sample or two shows of specks */
	for (int kind = 0; kind < KINDS; kind++) {
		FREED(soup) soup;
		struct lod_splats splats;
		soup_begin(&soup);
		uint32_t green = soup_material(&soup, 9, 99, 9, ECO_NONE, false);
		if (kind == TOO_THIN || kind == TRIANGLE) {          /* without area, for any sample */
			bool wide = kind == TRIANGLE;
			for (int i = 0; i < 3; i++)
				soup_vertex(&soup, (struct lod_v3){ wide ? i % 2 : i, wide * (i / 2), wide * 0.1 * i }, 0, 0);
			soup_triangle(&soup, green, 0, 1, 2);
		}
		for (uint32_t i = 0; i < 40 && kind == SPECKS; i++)
			soup_quad(&soup, green, (struct lod_v3){ 0, 0, 0.1 * i }, (struct lod_v3){ 1e-4, 0, 0 },
				(struct lod_v3){ 0, 0, 1e-4 });
		if (kind == CLEAR) {
			uint32_t image = soup_disc_image(&soup, 16);
			memset(soup.model.images[image].rgba, 0, 16 * 16 * 4);
			soup_quad(&soup, soup_material(&soup, 255, 255, 255, image, true), (struct lod_v3){ 0, 0, 1 },
				(struct lod_v3){ 1, 0, 0 }, (struct lod_v3){ 0, 0, 1 });
		}
		fit(&splats, &soup.model, &quick);
		if (kind != SPECKS)
			assert_int_equal(splats.level_count, kind == TRIANGLE);
		for (uint32_t l = 0; l < splats.level_count; l++)
			assert_true(splats.loss[l] >= 0 && splats.loss[l] <= (kind == TRIANGLE ? 0.5 : 1.5));
		if (splats.level_count)
			lod_splats_free(&splats);
	}
}

/* ---- The gradient ---- */

/* Differences of the loss in each parameter say the same, in pixels of one share and of four. */
static void check_gradient(uint32_t planes)
{
	enum { PIXELS = 40, STRIDE = PIXELS + 4, COUNT = 3 };
	static float cover[4 * PIXELS * STRIDE], left[PIXELS * STRIDE], weight[PIXELS * STRIDE];
	struct splat_ellipse ellipses[COUNT];
	struct splat_view view = { .right = { 0.8, 0.6, 0 }, .down = { 0, 0, -1 },
		.forward = { -0.6, 0.8, 0 }, .cover = cover };
	struct splat_views views = { .count = 1, .pixels = PIXELS, .stride = STRIDE, .planes = planes,
		.scale = 18, .items = &view };
	struct splat_softness soft = { .edge_px = 1.5f, .least = 0.5f, .blur_px2 = 0.3f, .chance = 1,
		.area = 0.5f };
	struct splat_picture picture = { left, weight, ellipses };
	struct splat_params splats[COUNT] = {
		{ { 0.1f, 0, 0.1f, 0.3f, 0.1f, 0, 0, 0.4f, 0.1f, 0, 0, 0.2f, 0.8f } },
		{ { -0.3f, 0.2f, 0.2f, 0.2f, 0, 0, 0, 0.1f, 0, 0.1f, 0, 0.5f, 0.6f } },
		{ { 0.3f, -0.2f, -0.3f, 0.1f, 0, 0.1f, 0, 0.2f, 0, 0, 0.1f, 0.3f, 0.9f } } };
	for (uint32_t i = 0; i < planes * PIXELS * STRIDE; i++) {
		uint32_t x = i % STRIDE, y = i / STRIDE % PIXELS, plane = i / STRIDE / PIXELS;
		cover[i] = x < PIXELS ? (float)((x * 7 + y * 3 + plane) % 17 < 9 && x > 8 && y < 30) * 0.75f
			: 0;
		view.covered += cover[i];
	}
	struct splat_params gradient[COUNT] = { 0 };
	splat_view_loss(&views, 0, splats, COUNT, COUNT, &soft, &picture, gradient);
	for (uint32_t i = 0; i < COUNT; i++)
		for (uint32_t j = 0; j < SPLAT_PARAMS; j++) {
			struct splat_params unused[COUNT] = { 0 };
			float at = splats[i].v[j], step = 2e-3f;
			double loss[2];
			for (int k = 0; k < 2; k++) {
				splats[i].v[j] = k ? at + step : at - step;
				loss[k] = splat_view_loss(&views, 0, splats, COUNT, COUNT, &soft, &picture,
					unused);
			}
			splats[i].v[j] = at;
			double slope = (loss[1] - loss[0]) / (2.0 * step),
				error = fabs(slope - gradient[i].v[j]);
			if (error > 0.01 + 0.1 * fabs(slope))
				fail_msg("%u planes, splat %u, parameter %u: %g, not %g", planes, i, j,
					gradient[i].v[j], slope);
		}
}

UNIT_TEST(the_gradient_is_that_of_the_loss)
{
	check_gradient(1);
	check_gradient(4);
}

/* ---- Blades ---- */

struct field { uint32_t count; double height, spread, width, lean; };

/* Blades of three triangles around the foot of a disc; their upper halves bend down. */
static void make_blades(struct soup *soup, const struct field *field)
{
	soup_begin(soup);
	uint32_t material = soup_material(soup, 60, 100, 40, ECO_NONE, false);
	for (uint32_t i = 0; i < field->count; i++) {
		double turn = soup_random(soup, 0, 6.28), r = field->spread * sqrt(soup_random(soup, 0, 1)),
			high = field->height * soup_random(soup, 0.6, 1), lean = field->lean * high;
		struct lod_v3 foot = { r * cos(turn), r * sin(turn), 0 },
			out = { cos(3 * turn + i), sin(3 * turn + i), 0 }, side = { -out.y, out.x, 0 },
			up = { 0, 0, 0.6 * high };
		side = lod_v3_scale(side, field->width / 2);
		struct lod_v3 middle = lod_v3_add(lod_v3_add(foot, up), lod_v3_scale(out, 0.2 * lean)),
			tip = lod_v3_add(lod_v3_add(foot, lod_v3_scale(up, 1.5)), lod_v3_scale(out, lean));
		uint32_t v[5] = { soup_vertex(soup, lod_v3_sub(foot, side), 0, 0),
			soup_vertex(soup, lod_v3_add(foot, side), 1, 0),
			soup_vertex(soup, lod_v3_add(middle, side), 1, 0.5),
			soup_vertex(soup, lod_v3_sub(middle, side), 0, 0.5),
			soup_vertex(soup, tip, 0.5, 1) };
		soup_triangle(soup, material, v[0], v[1], v[2]);
		soup_triangle(soup, material, v[0], v[2], v[3]);
		soup_triangle(soup, material, v[3], v[2], v[4]);
	}
}

static uint32_t size_of(const struct lod_splats *splats, uint32_t level)
{
	return splats->level_end[level] - lod_splats_first(splats, level);
}

static void check_sizes(const struct lod_splats *splats)
{
	assert_in_range(splats->level_count, 3, LOD_SPLAT_LEVELS);
	assert_int_equal(splats->level_end[0], 1);
	for (uint32_t level = 1; level < splats->level_count; level++) {
		uint32_t size = size_of(splats, level), before = size_of(splats, level - 1);
		assert_int_equal(size % before, 0);
		assert_in_range(size / before, 2, 4);
	}
}

/* The share of a level's splats that are four times as long as wide. */
static double long_share(const struct lod_splats *splats, uint32_t level)
{
	uint32_t first = lod_splats_first(splats, level), count = 0;
	for (uint32_t i = first; i < splats->level_end[level]; i++) {
		double most = 0, second = 0;
		for (int k = 0; k < 3; k++) {
			const float *half = splats->items[i].shape.half[k];
			double length = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
			second = length > most ? most : length > second ? length : second;
			most = length > most ? length : most;
		}
		count += most > 4 * second;
	}
	return (double)count / (splats->level_end[level] - first);
}

UNIT_TEST(a_level_has_a_splat_for_each_blade)
{
	static const struct field fields[] = { { 48, 1.5, 0.3, 0.02, 0.2 }, { 100, 0.5, 0.4, 0.015, 0.6 },
		{ 250, 0.3, 0.8, 0.01, 0.4 } };
	for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
		FREED(soup) soup;
		FREED(lod_splats) splats;
		make_blades(&soup, &fields[i]);
		fit(&splats, &soup.model, &(struct lod_splats_options){ .views = 20, .pixels = 160 });
		check_sizes(&splats);
		uint32_t level = 0;
		while (level + 1 < splats.level_count && size_of(&splats, level) < fields[i].count)
			level++;
		assert_in_range(size_of(&splats, level), fields[i].count, 2 * fields[i].count - 1);
		assert_int_equal(size_of(&splats, level), 2 * size_of(&splats, level - 1));
		assert_true(long_share(&splats, level) > 0.8);
		assert_true(splats.loss[level] < 0.95 * splats.loss[level - 2]);
	}
}
/* Squares of `leaves` x `leaves` cut-out discs, `size` wide each, in a ball. */
static void make_cards(struct soup *soup, uint32_t count, uint32_t leaves, double size)
{
	static const int corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	soup_begin(soup);
	uint32_t material = soup_material(soup, 40, 90, 20, soup_disc_image(soup, 64), true);
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 n = soup_direction(soup), u = lod_v3_unit(lod_v3_cross(n, soup_direction(soup))),
			v = lod_v3_cross(n, u), at = lod_v3_scale(soup_direction(soup), soup_random(soup, 0.5, 2));
		uint32_t vertex[4];
		for (int k = 0; k < 4; k++)
			vertex[k] = soup_vertex(soup, lod_v3_add(at, lod_v3_add(lod_v3_scale(u, leaves * size * corner[k][0]),
				lod_v3_scale(v, leaves * size * corner[k][1]))), leaves * corner[k][0], leaves * corner[k][1]);
		soup_triangle(soup, material, vertex[0], vertex[1], vertex[2]);
		soup_triangle(soup, material, vertex[0], vertex[2], vertex[3]);
	}
}

/* A level of at most 12 splats draws so much more or less than the plant covers, mean over views: what the
 * area's part of the loss says. */
static double too_much(const struct lod_splats *splats, uint32_t level, const struct eco_model *model)
{
	uint32_t count = size_of(splats, level);
	struct lod_arena arena = { 0 };
	struct splat_views views;
	struct splat_params params[12], unused[12];
	struct splat_ellipse ellipses[12];
	assert_in_range(count, 1, 12);
	double sum = 0;
	splat_views_make(&views, model, &quick, &arena);
	size_t pixels = (size_t)views.pixels * views.stride;
	struct splat_picture picture = { lod_arena_take(&arena, pixels, sizeof(float)),
		lod_arena_take(&arena, pixels, sizeof(float)), ellipses };
	for (uint32_t i = 0; i < count; i++)
		splat_restore(&params[i], &splats->items[lod_splats_first(splats, level) + i], splats);
	for (uint32_t view = 0; view < views.count; view++) {
		double loss[2];
		for (int k = 0; k < 2; k++)
			loss[k] = splat_view_loss(&views, view, params, count, 0,
				&(struct splat_softness){ .edge_px = 0.3f, .area = (float)k }, &picture, unused);
		sum += sqrt(fmax(0, loss[1] / loss[0] - 1)) / views.count;
	}
	lod_arena_free(&arena);
	return sum;
}

/* Cards, and blades thinner than a pixel: soft Q alone draws them up to 2.5 times too large. */
UNIT_TEST(few_splats_cover_as_much_as_a_thin_plant)
{
	for (int blades = 0; blades < 2; blades++) {
		FREED(soup) soup;
		FREED(lod_splats) splats;
		if (blades)
			make_blades(&soup, &(struct field){ 200, 0.3, 0.8, 0.01, 0.4 });
		else
			make_cards(&soup, 60, 1, 0.3);
		fit(&splats, &soup.model, &(struct lod_splats_options){ .views = 20, .pixels = 160 });
		for (uint32_t level = 1; size_of(&splats, level) <= 12; level++) {
			double more = too_much(&splats, level, &soup.model);
			print_message("%u splats draw %.2f too much or too little\n", size_of(&splats, level), more);
			assert_true(more < 0.3);
		}
	}
}

static double measured_leaf(uint32_t count, uint32_t leaves, double size)
{
	FREED(soup) soup;
	FREED(lod_splats) splats;
	struct lod_splats_options options = { .levels = 1, .views = 12, .pixels = 160 };
	make_cards(&soup, count, leaves, size);
	uint32_t *leaf = calloc(2 * (size_t)count, sizeof *leaf);
	for (uint32_t t = 0; t < 2 * count; t++)
		leaf[t] = t / 2;
	options.leaf = leaf;
	fit(&splats, &soup.model, &options);
	free(leaf);
	return splats.leaf;
}

/* As wide as what is seen of a leaf, also where a card shows many; in thick foliage, where others hide a part, less. */
UNIT_TEST(leaves_are_as_wide_as_they_are_seen)
{
	double thin = measured_leaf(40, 1, 0.2), thick = measured_leaf(1280, 1, 0.2), cards = measured_leaf(20, 8, 0.2);
	print_message("leaves of .2 m: %.3f, in thick foliage %.3f, on cards %.3f m\n", thin, thick, cards);
	assert_true(thin > 0.08 && thin < 0.16);
	assert_true(thick > 0.04 && thick < 0.8 * thin);
	assert_true(cards > 0.8 * thick && cards < 1.25 * thin);
}

static double share(const struct lod_tint_wood *wood, const uint8_t c[3])
{
	return (double)LOD_TINT_WOOD(wood->share, lod_tint_light(c[0]), lod_tint_light(c[1]), lod_tint_light(c[2]));
}

/* A splat that is half bark and half leaves keeps the bark's half: its tint is the mean of theirs. */
UNIT_TEST(a_colour_says_how_much_of_it_is_wood)
{
	static const uint8_t bark[3] = { 110, 80, 50 }, leaf[3] = { 60, 150, 40 };     /* soup_tree's */
	static const uint8_t tints[][3] = { { 213, 94, 0 }, { 0, 114, 178 } };
	FREED(soup) soup;
	FREED(lod_plant) plant = { 0 };
	uint8_t both[3], leaves[3], mixed[3];
	soup_tree(&soup, 300, 0, false);
	const struct lod_plant_options options = { .name = "tree", .draft = true };
	assert_good(lod_plant_build(&plant, &soup.model, &options, &cause));
	assert_good(lod_plant_add_splats(&plant, &soup.model, &options, &cause));
	const struct eco_list *list = &plant.lists[plant.list_count - 1].list;
	assert_true(list->attributes & ECO_ATTR_SPLAT && list->wood);
	assert_int_equal(plant.palette_count, list->palette_first + list->palette_count + 1);
	assert_memory_equal(plant.palette[plant.palette_count - 1], bark, 3);
	struct lod_tint_wood wood = lod_tint_wood(list->wood, bark);
	for (int k = 0; k < 3; k++)
		both[k] = (uint8_t)(sqrt((bark[k] * bark[k] + leaf[k] * leaf[k]) / 2.0) + 0.5);
	double of_bark = share(&wood, bark), of_both = share(&wood, both), of_leaf = share(&wood, leaf);
	print_message("wood in bark %.2f, in both %.2f, in leaves %.2f\n", of_bark, of_both, of_leaf);
	assert_true(of_bark > 0.8 && fabs(of_both - 0.5) < 0.1 && of_leaf < 0.1);
	for (size_t t = 0; t < sizeof tints / sizeof *tints; t++) {
		memcpy(leaves, leaf, 3);
		memcpy(mixed, both, 3);
		lod_tint_apply(lod_tint_word(tints[t]), NULL, leaf, leaves);
		lod_tint_apply(lod_tint_word(tints[t]), &wood, both, mixed);
		for (int k = 0; k < 3; k++)
			assert_true(fabs(mixed[k] - sqrt((bark[k] * bark[k] + leaves[k] * leaves[k]) / 2.0)) < 8);
	}
}
