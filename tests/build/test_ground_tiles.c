/* The tree of ground tiles: its errors hold, what a view gets covers all it sees exactly once, and between
 * tiles of any levels there is no gap, not even of one pixel. */
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/base/random.h"
#include "lod/build/ground_tree.h"
#include "lod/raster/raster.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/unit_test.h"

/* ---- Terrain of several kinds ---- */

static uint64_t noise_state;

static uint64_t bits(void)
{
	return eco_random_next(&noise_state);
}

static double unit(void) { return eco_random_unit(bits()); }

static double rough(double x, double y)
{
	double z = 0;
	for (int i = 0; i < 7; i++) {
		double f = 0.004 * (1 << i);
		z += 30.0 / (1 << i) * sin(f * x * 1.3 + i * i) * cos(f * y - 0.7 * i + 0.3 * sin(f * x));
	}
	return z;
}

static double cliffs(double x, double y)
{
	return (x > 300 ? 120 : 0) + (y > 210 && x < 500 ? -80 : 0) + 0.01 * x;
}

static double mostly_flat(double x, double y)
{
	double d = (x - 130) * (x - 130) + (y - 90) * (y - 90);
	return d < 1600 ? rough(8 * x, 8 * y) : 5;
}

static double coast(double x, double y)
{
	return x < 4200 ? 5 : 5 + (x - 4200) / 100 + rough(x, y);
}

static const struct terrain { const char *name; double (*height)(double, double); uint32_t columns, rows;
	double step; uint32_t margin;
} terrains[] = {
	{ "rough", rough, 517, 389, 5, 0 },
	{ "cliffs", cliffs, 130, 70, 7, 0 },
	{ "mostly flat", mostly_flat, 700, 260, 1, 0 },
	{ "one tile", rough, 12, 40, 3, 0 },
	{ "long", rough, 8193, 9, 4, 0 },
	{ "coast", coast, 8193, 9, 1, 0 },
	{ "the least", rough, 2, 2, 10, 0 },
	{ "power", rough, 257, 257, 2, 0 },
	{ "to the horizon", rough, 150, 119, 2, 11 },
	{ "all margin", rough, 20, 19, 100, 8 },
};
#define TERRAINS (sizeof terrains / sizeof *terrains)

struct world {
	struct eco_ground ground;
	struct lod_ground_tree tree;
	struct eco_scene scene;
	struct eco_list *lists;
	struct eco_chunk *chunks;
};

static void world_make(struct world *w, const struct terrain *t, double least_m)
{
	struct eco_error error = { 0 };
	memset(w, 0, sizeof *w);
	w->ground = ground_make_wide(t->columns, t->rows, t->margin, 0, 0, t->step, t->height);
	if (lod_ground_build(&w->tree, &w->ground, GROUND_TILES_STEP_M, least_m, &error))
		fail_msg("%s: %s", t->name, error.text);
	w->lists = calloc(w->tree.count, sizeof *w->lists);
	w->chunks = calloc(w->tree.count, sizeof *w->chunks);
	for (uint32_t i = 0; i < w->tree.count; i++) {
		w->tree.tiles[i].list = i;
		w->lists[i] = ground_list(&w->ground, &w->tree.tiles[i]);
		w->lists[i].chunk_first = i;
		w->chunks[i] = (struct eco_chunk){ .size_bytes = 1,
			.primitive_count = w->lists[i].primitive_count,
			.element_count = w->lists[i].element_count };
	}
	w->scene = (struct eco_scene){ .name = "ground", .needs = ECO_NEED_GROUND, .near_m = 0.1,
		.ground = w->tree.tiles,
		.ground_count = w->tree.count, .ground_columns = t->columns, .ground_rows = t->rows,
		.ground_margin = t->margin,
		.lists = w->lists, .list_count = w->tree.count,
		.chunks = w->chunks, .chunk_count = w->tree.count };
}

static void world_free(struct world *w)
{
	lod_ground_tree_free(&w->tree);
	free(w->lists);
	free(w->chunks);
	eco_ground_free(&w->ground);
}

static double height_of(const struct world *w, uint32_t column, uint32_t row)
{
	return (double)w->ground.height_m[(size_t)row * w->ground.columns + column];
}

/* The place of a sample in steps, and places between samples. */
static double place_x(const struct world *w, double sample)
{
	uint32_t i = (uint32_t)fmin(sample, w->ground.columns - 2), m = w->ground.margin;
	double low = eco_ground_place(i, w->ground.columns, m);
	return low + (sample - i) * (eco_ground_place(i + 1, w->ground.columns, m) - low);
}

static double place_y(const struct world *w, double sample)
{
	uint32_t i = (uint32_t)fmin(sample, w->ground.rows - 2), m = w->ground.margin;
	double low = eco_ground_place(i, w->ground.rows, m);
	return low + (sample - i) * (eco_ground_place(i + 1, w->ground.rows, m) - low);
}

/* ---- The tree ---- */

/* It passes the checks of a pack. A sea larger than the tiles that fine ones may touch has children, so that
 * beside a coast they can be chosen. */
static void check_tree(struct world *w, const char *name)
{
	static const struct eco_tile tile = { .summary = ECO_NONE };
	struct eco_error error = { 0 };
	w->scene.tiles = &tile;
	w->scene.tile_count = 1;
	if (eco_scene_check(&w->scene, &error))
		fail_msg("%s: %s", name, error.text);
	for (uint32_t i = 0; i < w->tree.count; i++)
		assert_true(w->tree.tiles[i].child_count > 0 || w->tree.tiles[i].level <= ECO_GROUND_APART_MAX);
}

/* A tile is found by its samples, and not by others. */
static void check_samples(const struct world *w, uint32_t tile)
{
	const struct eco_ground_tile *t = &w->tree.tiles[tile];
	FREED(eco_elements) e = ground_elements(&w->ground, t, w->tree.shifts[tile]);
	struct eco_ground_tile found;
	for (int changed = 0; changed < 2; changed++) {
		assert_int_equal(eco_ground_tile_of(&found, &w->lists[tile], &e, w->ground.columns,
			w->ground.rows, w->ground.margin, NULL), changed ? ECO_DAMAGED : ECO_OK);
		assert_true(changed || (found.level == t->level && found.column == t->column
			&& found.row == t->row));
		e.position[3 * (bits() % e.element_count) + tile % 2] += tile % 3 ? 1 : -1;
	}
}

/* The simple twin: interpolates in the tile's own samples, at random places between them too. */
static double surface(const struct world *w, const struct eco_ground_tile *tile, double x, double y)
{
	struct eco_ground_span sx, sy;
	uint32_t c = 0, r = 0;
	eco_ground_spans(&sx, &sy, tile, w->ground.columns, w->ground.rows);
	while (c + 2 < sx.inner && x >= place_x(w, eco_ground_span_at(&sx, sx.before + c + 1)))
		c++;
	while (r + 2 < sy.inner && y >= place_y(w, eco_ground_span_at(&sy, sy.before + r + 1)))
		r++;
	uint32_t x0 = eco_ground_span_at(&sx, sx.before + c), x1 = eco_ground_span_at(&sx, sx.before + c + 1);
	uint32_t y0 = eco_ground_span_at(&sy, sy.before + r), y1 = eco_ground_span_at(&sy, sy.before + r + 1);
	double u = (x - place_x(w, x0)) / (place_x(w, x1) - place_x(w, x0)),
		v = (y - place_y(w, y0)) / (place_y(w, y1) - place_y(w, y0)), sw = height_of(w, x0, y0),
		ne = height_of(w, x1, y1);
	return u >= v ? sw + u * (height_of(w, x1, y0) - sw) + v * (ne - height_of(w, x1, y0))
		: sw + v * (height_of(w, x0, y1) - sw) + u * (ne - height_of(w, x0, y1));
}

UNIT_TEST(errors_hold_everywhere_and_are_met_somewhere_and_samples_name_their_tile)
{
	for (size_t k = 0; k < TERRAINS; k++) {
		FREED(world) w;
		noise_state = k;
		world_make(&w, &terrains[k], 0);
		for (uint32_t i = 0; i < w.tree.count; i++) {
			const struct eco_ground_tile *t = &w.tree.tiles[i];
			struct eco_ground_span x, y;
			double most = 0, children = 0;
			eco_ground_spans(&x, &y, t, w.ground.columns, w.ground.rows);
			for (int n = 0; n < 300; n++) {
				double px = x.low + unit() * (x.high - x.low),
					py = y.low + unit() * (y.high - y.low), z;
				if (n % 2) {
					px = floor(px);
					py = floor(py);
				}
				px = place_x(&w, px);
				py = place_y(&w, py);
				eco_ground_height(&w.ground, px * terrains[k].step, py * terrains[k].step,
					&z);
				double off = fabs(z - surface(&w, t, px, py));
				if (off > (double)t->error_m + 1e-4)
					fail_msg("%s, tile %u of level %u: off by %g m at %g, %g, its error "
						"is %g m", terrains[k].name, i, t->level, off, px, py,
						(double)t->error_m);
				most = off > most ? off : most;
				assert_true(z >= (double)t->low_m - 1e-4 && z <= (double)t->high_m + 1e-4);
			}
			for (uint32_t c = 0; c < t->child_count; c++)
				children = fmax(children, (double)w.tree.tiles[t->child_first + c].error_m);
			assert_true((double)t->error_m >= children);
			assert_true(t->level > 0 || t->error_m == 0);
			if (k == 0 && t->level > 0 && t->level < 3 && (double)t->error_m > children)
				assert_true(most > 0.05 * (double)t->error_m);
			check_samples(&w, i);
		}
	}
}

/* ---- Choosing ---- */

static struct eco_view random_view(const struct world *w)
{
	struct eco_view view = { .up = { 0, 0, 1 }, .fov_y_deg = 25 + 70 * unit(), .width = 320,
		.height = 240 };
	double reach_x = (w->ground.columns - 2 * w->ground.margin) * w->ground.step_x_m,
		reach_y = (w->ground.rows - 2 * w->ground.margin) * w->ground.step_y_m, z;
	for (int i = 0; i < 2; i++) {
		double reach = i ? reach_y : reach_x;
		view.eye[i] = reach * (1.4 * unit() - 0.2);
		view.target[i] = reach * unit();
	}
	eco_ground_height(&w->ground, view.eye[0], view.eye[1], &z);
	view.eye[2] = z + (bits() % 3 ? 2 + 60 * unit() : 5 + reach_x * unit());
	eco_ground_height(&w->ground, view.target[0], view.target[1], &view.target[2]);
	return view;
}

static bool covers(const struct world *w, const struct eco_ground_tile *t, double px, double py)
{
	struct eco_ground_span x, y;
	eco_ground_spans(&x, &y, t, w->ground.columns, w->ground.rows);
	return px >= x.low && px < x.high && py >= y.low && py < y.high;
}

/* Tiles that touch share samples between their corners. */
static void assert_close(const struct world *w, const struct lod_ground_choice *choice)
{
	FREED_MEMORY struct eco_ground_tile *tiles = malloc((choice->count + 1) * sizeof *tiles);
	FREED_MEMORY struct lod_ground_seam *seams = malloc((choice->count + 1) * sizeof *seams);
	for (uint32_t i = 0; i < choice->count; i++)
		tiles[i] = w->tree.tiles[choice->tiles[i]];
	assert_true(lod_ground_seams(seams, tiles, choice->count));
	for (uint32_t i = 0; i < choice->count; i++)
		for (int side = 0; side < 4; side++)
			assert_true(seams[i].coarser[side] <= ECO_GROUND_APART_MAX);
}

UNIT_TEST(trees_are_sound_and_what_is_in_view_is_covered_once_and_fine_enough)
{
	for (size_t k = 0; k < TERRAINS; k++) {
		struct world w;
		noise_state = 100 + k;
		world_make(&w, &terrains[k], 0.01);
		check_tree(&w, terrains[k].name);
		for (int n = 0; n < 60; n++) {
			struct eco_view view = random_view(&w);
			struct lod_ground_limits limits = { .tolerance_px = n % 3 == 0 ? ECO_GROUND_PX_MAX
				: pow(2, (double)(bits() % 8) - 2) };
			struct lod_ground_choice choice, again;
			struct lod_eye eye;
			lod_eye_make(&eye, &view);
			assert_int_equal(lod_ground_select(&choice, &w.scene, &eye, &limits, NULL), ECO_OK);
			assert_int_equal(lod_ground_select(&again, &w.scene, &eye, &limits, NULL), ECO_OK);
			assert_int_equal(choice.count, again.count);
			if (choice.count)
				assert_memory_equal(choice.tiles, again.tiles,
					choice.count * sizeof *choice.tiles);
			assert_true(choice.error_px <= limits.tolerance_px);
			assert_close(&w, &choice);
			for (int s = 0; s < 400; s++) {
				double px = unit() * (w.ground.columns - 1),
				       py = unit() * (w.ground.rows - 1),
				       at[3] = { place_x(&w, px) * terrains[k].step,
					       place_y(&w, py) * terrains[k].step };
				eco_ground_height(&w.ground, at[0], at[1], &at[2]);
				if (!lod_eye_sees(&eye, at, 0))
					continue;
				uint32_t found = 0;
				for (uint32_t i = 0; i < choice.count; i++) {
					const struct eco_ground_tile *t = &w.tree.tiles[choice.tiles[i]];
					if (!covers(&w, t, px, py))
						continue;
					double depth = 0;
					for (int a = 0; a < 3; a++)
						depth += eye.forward[a] * (at[a] - eye.at[a]);
					found++;
					assert_true(t->child_count == 0
						|| (double)t->error_m
						<= limits.tolerance_px * depth * eye.pixel_rad * 1.001);
				}
				assert_int_equal(found, 1);
			}
			free(choice.tiles);
			free(again.tiles);
		}
		world_free(&w);
	}
}

UNIT_TEST(a_bound_on_tiles_is_kept_and_spent_where_it_shows)
{
	FREED(world) w;
	struct eco_view view = { { 300, 300, 80 }, { 1200, 900, 0 }, { 0, 0, 1 }, 60, 640, 480 };
	struct lod_eye eye;
	double last = INFINITY;
	world_make(&w, &terrains[0], 0);
	lod_eye_make(&eye, &view);
	for (uint32_t most = 1; most < 200; most = most * 3 / 2 + 1) {
		struct lod_ground_limits limits = { .tolerance_px = 0.01, .tiles_max = most };
		struct lod_ground_choice choice;
		assert_int_equal(lod_ground_select(&choice, &w.scene, &eye, &limits, NULL), ECO_OK);
		assert_true(choice.count >= 1 && choice.count <= most && choice.error_px <= last);
		last = choice.error_px;
		free(choice.tiles);
	}
	assert_true(last < 50);
	/* a scene without ground has none, and asks for nothing */
	struct lod_ground_choice none;
	struct lod_ground_limits limits = { .tolerance_px = 1 };
	assert_int_equal(lod_ground_select(&none, &(struct eco_scene){ .near_m = 1 }, &eye, &limits, NULL),
		ECO_OK);
	assert_true(none.count == 0 && !none.tiles);
}

/* ---- Drawing ---- */

static void draw_tiles(struct lod_raster *raster, const struct world *w, const struct eco_ground_tile *tiles,
	uint32_t count)
{
	static const uint32_t corner[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };
	static float out[ECO_GROUND_CELLS * ECO_GROUND_CELLS * 18];
	FREED_MEMORY struct lod_ground_seam *seams = malloc(count * sizeof *seams);
	struct lod_place place = { .cosine = 1, .scale = 1 };
	assert_true(lod_ground_seams(seams, tiles, count));
	lod_raster_object(raster, &place);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_ground_span x, y;
		float *to = out;
		eco_ground_spans(&x, &y, &tiles[i], w->ground.columns, w->ground.rows);
		for (uint32_t r = 0; r + 1 < y.inner; r++)
			for (uint32_t c = 0; c + 1 < x.inner; c++)
				for (int k = 0; k < 6; k++) {
					uint32_t cc = c + corner[k][0], rr = r + corner[k][1];
					lod_ground_corner(&cc, &rr, &seams[i], &x, &y);
					uint32_t column = eco_ground_span_at(&x, x.before + cc),
						row = eco_ground_span_at(&y, y.before + rr);
					*to++ = (float)(place_x(w, column) * w->ground.step_x_m);
					*to++ = (float)(place_y(w, row) * w->ground.step_y_m);
					*to++ = (float)height_of(w, column, row);
				}
		struct lod_raster_batch batch = { .count = 2 * (x.inner - 1) * (y.inner - 1),
			.position = out };
		lod_raster_triangles(raster, &batch);
	}
}

/* Tiles of random levels that cover all: every other tile that could be refined is. */
static uint32_t random_cover(const struct world *w, struct eco_ground_tile *out, uint32_t chance)
{
	uint32_t *stack = malloc((w->tree.count + 1) * sizeof *stack), depth = 0, count = 0;
	stack[depth++] = 0;
	while (depth) {
		const struct eco_ground_tile *t = &w->tree.tiles[stack[--depth]];
		if (t->child_count == 0 || bits() % 100 >= chance) {
			out[count++] = *t;
			continue;
		}
		for (uint32_t i = 0; i < t->child_count; i++)
			stack[depth++] = t->child_first + i;
	}
	free(stack);
	return count;
}


/* A chosen ground is drawn where the full detail is, to the tolerance and a pixel. */
UNIT_TEST(the_picture_is_that_of_the_full_detail)
{
	static const double tolerances[] = { 0.5, 1, 3 };
	FREED(world) w;
	noise_state = 300;
	world_make(&w, &terrains[0], 0);
	FREED_MEMORY struct eco_ground_tile *tiles = malloc(w.tree.count * sizeof *tiles);
	struct lod_raster_options options = { .width = 320, .height = 240 };
	FREED(lod_raster) whole, parts;
	lod_raster_init(&whole, &options);
	lod_raster_init(&parts, &options);
	for (int n = 0; n < 12; n++) {
		struct eco_view view = random_view(&w);
		struct lod_ground_limits limits = { .tolerance_px = tolerances[n % 3] };
		struct lod_ground_choice choice;
		struct lod_eye eye;
		lod_eye_make(&eye, &view);
		assert_int_equal(lod_ground_select(&choice, &w.scene, &eye, &limits, NULL), ECO_OK);
		lod_raster_camera(&whole, &eye, 0.1);
		lod_raster_clear(&whole);
		draw_tiles(&whole, &w, tiles, random_cover(&w, tiles, 100));
		for (uint32_t i = 0; i < choice.count; i++)
			tiles[i] = w.tree.tiles[choice.tiles[i]];
		lod_raster_camera(&parts, &eye, 0.1);
		lod_raster_clear(&parts);
		draw_tiles(&parts, &w, tiles, choice.count);
		int reach = (int)ceil(2 * tolerances[n % 3]) + 1;
		uint32_t wrong = 0;
		for (int y = reach; y < 240 - reach; y++)
			for (int x = 0; x < 320; x++) {
				bool all = true, none = true;
				for (int d = -reach; d <= reach; d++) {
					all &= whole.depth[(y + d) * 320 + x] > 0;
					none &= whole.depth[(y + d) * 320 + x] == 0;
				}
				wrong += (all && parts.depth[y * 320 + x] == 0)
					|| (none && parts.depth[y * 320 + x] > 0);
			}
		if (wrong)
			fail_msg("view %d: %u pixels are ground or sky where the full detail is not", n,
				wrong);
		free(choice.tiles);
	}
}

/* At borders, which tiles of other levels share, exactly; inside as the error deserves. And so coded, in
 * fewer bytes. */
UNIT_TEST(coarse_heights_are_rounded_inside_only)
{
	size_t exact_bytes = 0, rounded_bytes = 0;
	uint32_t rounded = 0;
	FREED(world) w;
	world_make(&w, &terrains[0], 0);
	for (uint32_t i = 0; i < w.tree.count; i++) {
		const struct eco_ground_tile *t = &w.tree.tiles[i];
		struct eco_elements exact = ground_elements(&w.ground, t, 0),
			e = ground_elements(&w.ground, t, w.tree.shifts[i]), back;
		struct eco_ground_span x, y;
		eco_ground_spans(&x, &y, t, w.ground.columns, w.ground.rows);
		int32_t most = 1 << w.tree.shifts[i] >> 1;
		assert_true(t->level > 0 || w.tree.shifts[i] == 0);
		assert_true(most * GROUND_TILES_STEP_M <= (double)t->error_m / 16);
		rounded += most > 0;
		for (uint32_t k = 0; k < e.element_count; k++) {
			uint32_t c = k % x.count - x.before, r = k / x.count - y.before;
			int32_t off = abs(e.position[3 * k + 2] - exact.position[3 * k + 2]);
			assert_true(off <= most
				&& (off == 0 || (c != 0 && r != 0 && c != x.inner - 1 && r != y.inner - 1)));
		}
		for (int pass = 0; pass < 2; pass++) {
			const struct eco_chunk_input input = { &w.lists[i], pass ? &e : &exact, 0,
				e.element_count, 0 };
			struct eco_chunk chunk = { .primitive_count = e.element_count,
				.element_count = e.element_count };
			FREED_MEMORY uint8_t *bytes;
			size_t size;
			assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL), ECO_OK);
			*(pass ? &rounded_bytes : &exact_bytes) += t->level > 0 ? size : 0;
			chunk.size_bytes = (uint32_t)size;
			assert_int_equal(eco_chunk_decode(&w.lists[i], &chunk, 0, bytes, size, &back, NULL),
				ECO_OK);
			assert_memory_equal(back.position, input.elements->position,
				12 * (size_t)e.element_count);
			eco_elements_free(&back);
		}
		eco_elements_free(&e);
		eco_elements_free(&exact);
	}
	assert_true(rounded > 5 && rounded_bytes < exact_bytes * 4 / 5);
}
