/* The rasteriser: triangles against a slow twin that tests every pixel with 128-bit edge functions; depth,
 * batches, merging, hiding, cut-outs and lines. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/raster/raster_state.h"
#include "tests/support/unit_test.h"

/* The state of the two below; each test sets it. */
static uint64_t rnd_seed;

static uint32_t rnd(uint32_t below)
{
	rnd_seed = rnd_seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)((rnd_seed >> 33) * (uint64_t)below >> 31);
}

static double uniform(double low, double high)
{
	return low + (high - low) * rnd(1u << 30) / (double)(1u << 30);
}

/* An eye at the origin looking along +y, one pixel a unit at distance 1: pixel = middle + x / y, middle - z /
 * y, exactly. */
static struct lod_eye flat_eye(uint32_t width, uint32_t height)
{
	return (struct lod_eye){ .right = { 1, 0, 0 }, .up = { 0, 0, 1 }, .forward = { 0, 1, 0 },
		.tan_x = width / 2.0,
		.tan_y = height / 2.0, .pixel_rad = 1 };
}

/* A raster with owners and items; eye NULL: the flat one. */
static void raster_start(struct lod_raster *raster, uint32_t width, uint32_t height, const struct lod_eye *eye)
{
	struct lod_raster_options options = { .width = width, .height = height, .owner = true, .item = true };
	lod_raster_init(raster, &options);
	struct lod_eye flat = flat_eye(width, height);
	lod_raster_camera(raster, eye ? eye : &flat, 1.0 / 1024);
}

/* The object-space point that a flat eye sees at (x, y) / 256 pixels at distance w; exact for small integers
 * and powers of two. */
static void raster_put(float *p, const struct lod_raster *raster, double x, double y, double w)
{
	p[0] = (float)((x / 256 - raster->width / 2.0) * w);
	p[1] = (float)w;
	p[2] = (float)((raster->height / 2.0 - y / 256) * w);
}

static void raster_draw(struct lod_raster *raster, const float *position, uint32_t count, uint64_t owner)
{
	struct lod_raster_batch batch = { .count = count, .position = position, .owner = owner };
	lod_raster_triangles(raster, &batch);
}

static uint64_t raster_covered(const struct lod_raster *raster)
{
	uint64_t n = 0;
	for (size_t i = 0; i < (size_t)raster->width * raster->height; i++)
		n += raster->cover[i] != 0;
	return n;
}

/* ---- The twin ---- */

static bool twin_edge(const int64_t a[2], const int64_t b[2], int64_t x, int64_t y)
{
	__int128 dx = b[0] - a[0], dy = b[1] - a[1], at = dx * (y - a[1]) - dy * (x - a[0]);
	return at > 0 || (at == 0 && (dy < 0 || (dy == 0 && dx > 0)));
}

/* Corners in 1/256 pixel, by the formula of raster.h in the rasteriser's own floats. */
static void twin_snap(const struct lod_raster *raster, const float *p, int64_t out[2])
{
	float c[3];
	for (int i = 0; i < 3; i++) {
		const float *row = raster->state->clip[i];
		c[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
	}
	float z = 1.0f / c[2];
	out[0] = (int64_t)rintf(c[0] * z) + raster->width * 128;
	out[1] = (int64_t)rintf(c[1] * z) + raster->height * 128;
}

static uint64_t twin_differences(const struct lod_raster *raster, const float *position)
{
	int64_t c[3][2];
	for (int i = 0; i < 3; i++)
		twin_snap(raster, position + 3 * i, c[i]);
	__int128 area = (__int128)(c[1][0] - c[0][0]) * (c[2][1] - c[0][1])
		- (__int128)(c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
	const int64_t *a = c[0], *b = area < 0 ? c[2] : c[1], *d = area < 0 ? c[1] : c[2];
	uint64_t wrong = 0;
	for (uint32_t y = 0; y < raster->height; y++) {
		for (uint32_t x = 0; x < raster->width; x++) {
			int64_t px = x * 256 + 128, py = y * 256 + 128;
			bool in = area != 0 && twin_edge(a, b, px, py) && twin_edge(b, d, px, py)
				&& twin_edge(d, a, px, py);
			wrong += in != (raster->cover[(size_t)y * raster->width + x] != 0);
		}
	}
	return wrong;
}

/* corners within +-size pixels of a centre within +-middle, on a grid of 1/256 */
struct shape { double size, middle; int grid; };

static void random_triangle(float *p, const struct lod_raster *raster, const struct shape *shape)
{
	double x = uniform(-shape->middle, shape->middle) + raster->width / 2.0,
		y = uniform(-shape->middle, shape->middle) + raster->height / 2.0;
	bool sliver = rnd(4) == 0;
	double dx = uniform(-1, 1), dy = uniform(-1, 1);
	for (int i = 0; i < 3; i++) {
		double t = uniform(-shape->size, shape->size), u = sliver ? 0.02 * uniform(-1, 1)
			: uniform(-shape->size, shape->size);
		double cx = sliver ? x + t * dx - u * dy : x + t, cy = sliver ? y + t * dy + u * dx : y + u;
		raster_put(p + 3 * i, raster, rint(cx * 256 / shape->grid) * shape->grid,
			rint(cy * 256 / shape->grid) * shape->grid, (double)(1u << rnd(4)));
	}
}

UNIT_TEST(covers_what_the_exact_twin_covers)
{
	static const struct shape shapes[] = {
		{ 0.4, 20, 1 }, { 1, 20, 1 }, { 2, 20, 128 }, { 3, 22, 1 }, { 4, 20, 64 }, { 6, 20, 1 },
			{ 9, 20, 128 }, { 20, 30, 1 },
		{ 40, 10, 256 }, { 300, 100, 1 }, { 7000, 500, 1 },
	};
	FREED(lod_raster) raster;
	rnd_seed = 1;
	raster_start(&raster, 45, 38, NULL);
	for (size_t s = 0; s < sizeof shapes / sizeof shapes[0]; s++) {
		for (int i = 0; i < 400; i++) {
			float p[9];
			random_triangle(p, &raster, &shapes[s]);
			lod_raster_clear(&raster);
			raster_draw(&raster, p, 1, 7);
			assert_int_equal(twin_differences(&raster, p), 0);
		}
	}
}

static struct lod_eye turned_eye(uint32_t width, uint32_t height)
{
	struct eco_view view = { { 1e6 + 3, -20, 9 }, { 1e6, 0, 5 }, { 0.1, 0, 1 }, 50, width, height };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	return eye;
}

UNIT_TEST(covers_what_the_twin_covers_in_perspective)
{
	FREED(lod_raster) raster;
	struct lod_eye eye = turned_eye(64, 48);
	rnd_seed = 2;
	raster_start(&raster, 64, 48, &eye);
	struct lod_place place = { { 1e6 + 1, 2, 0 }, 0.6, 0.8, 1.25, 0, 0 };
	lod_raster_object(&raster, &place);
	uint64_t drawn = 0;
	for (int i = 0; i < 2500; i++) {
		float p[9], size = i % 5 ? 0.5f : 6.0f,
			c[3] = { (float)uniform(-6, 6), (float)uniform(-6, 6), (float)uniform(0, 10) };
		for (int k = 0; k < 9; k++)
			p[k] = c[k % 3] + (float)uniform(-size, size);
		lod_raster_clear(&raster);
		raster_draw(&raster, p, 1, 7);
		assert_int_equal(twin_differences(&raster, p), 0);
		drawn += raster_covered(&raster);
	}
	assert_true(drawn > 10000);
}

/* A plane below the eye, from behind it to far beyond: what is in front of the near plane covers, the rest
 * does not. */
UNIT_TEST(planes_through_the_near_plane_cover_up_to_the_horizon)
{
	static const float reach[] = { 3, 100, 1e5f, 1e9f, 1e14f };
	struct lod_raster raster;
	for (size_t r = 0; r < sizeof reach / sizeof reach[0]; r++) {
		struct lod_eye eye = flat_eye(80, 60);
		eye.tan_x = eye.tan_y = 1;
		raster_start(&raster, 80, 60, &eye);
		lod_raster_camera(&raster, &eye, 0.1);
		float f = reach[r], z = -1, p[18] = { -f, -f, z, f, -f, z, f, f, z, -f, -f, z, f, f, z, -f, f,
			z };
		raster_draw(&raster, p, 2, 3);
		uint64_t wrong = 0;
		for (int y = 0; y < 60; y++) {
			for (int x = 0; x < 80; x++) {
				double down = (y + 0.5 - 30) / 30, w = down > 0 ? 1 / down : INFINITY,
					across = (x + 0.5 - 40) / 40 * w;
				bool in = w < f && fabs(across) < f;
				size_t i = (size_t)y * 80 + (size_t)x;
				wrong += in != (raster.cover[i] != 0);
				if (in && raster.cover[i])
					assert_true(fabs(raster.depth[i] * w - 1) < 2e-3);
			}
		}
		assert_true(wrong <= 2);
		lod_raster_free(&raster);
	}
}

UNIT_TEST(what_is_no_number_or_behind_draws_nothing)
{
	static const float bad[][9] = {
		{ NAN, 1, 0, 1, 1, 0, 0, 1, 1 }, { INFINITY, 1, 0, 1, 1, 0, 0, 1, 1 },
			{ 0, 1, 0, 1, 1, 0, 0, NAN, 1 },
		{ 0, -1, 0, 1, -1, 0, 0, -1, 1 }, { 0, 0, 0, 0, 0, 0, 0, 0, 0 },
		{ 3e38f, 3e38f, 3e38f, -3e38f, 3e38f, 0, 0, 3e38f, 3e38f },
		{ 0, 1, 0, 0, 1, 0, 0, 1, 0 },
	};
	FREED(lod_raster) raster;
	raster_start(&raster, 32, 32, NULL);
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		float width = 3;
		struct lod_raster_batch batch = { .count = 1, .position = bad[i], .width = &width,
			.area = i == 3 ? 5 : NAN, .owner = 1 };
		raster_draw(&raster, bad[i], 1, 1);
		if (i != 2 && i != 6)
			lod_raster_lines(&raster,
				&(struct lod_raster_batch){ .count = 1, .position = bad[i],
				.width = (float[]){ NAN } });
		lod_raster_splats(&raster, &batch);
		if (i != 5)
			assert_int_equal(raster_covered(&raster), 0);
		lod_raster_clear(&raster);
	}
}

static bool same_picture(const struct lod_raster *a, const struct lod_raster *b)
{
	size_t pixels = (size_t)a->width * a->height;
	return !memcmp(a->depth, b->depth, pixels * sizeof *a->depth) && !memcmp(a->cover, b->cover, pixels)
		&& !memcmp(a->owner, b->owner, pixels * sizeof *a->owner);
}

/* ---- Depth, order, batches ---- */

/* groups of triangles, an owner each */
struct crowd { float *position; uint64_t *owner; uint32_t groups, each; };

static struct crowd crowd_make(uint32_t groups, uint32_t each, double size)
{
	struct crowd crowd = { malloc(groups * each * 9 * sizeof(float)), malloc(groups * sizeof(uint64_t)),
		groups, each };
	for (uint32_t g = 0; g < groups; g++) {
		double c[3] = { uniform(-40, 40), uniform(20, 120), uniform(-30, 30) };
		crowd.owner[g] = g % 5 ? g + 1 : 0;
		for (uint32_t i = 0; i < each; i++) {
			double t[3] = { c[0] + uniform(-4, 4), c[1] + uniform(-4, 4), c[2] + uniform(-4, 4) };
			for (uint32_t k = 0; k < 9; k++)
				crowd.position[(g * each + i) * 9 + k] =
					(float)(t[k % 3] + uniform(-size, size));
		}
	}
	return crowd;
}

static void crowd_free(struct crowd *crowd)
{
	free(crowd->position);
	free(crowd->owner);
}

static void crowd_draw(struct lod_raster *raster, const struct crowd *crowd, uint32_t first, uint32_t end)
{
	for (uint32_t g = first; g < end; g++)
		raster_draw(raster, crowd->position + (size_t)g * crowd->each * 9, crowd->each,
			crowd->owner[g]);
}

static struct lod_eye wide_eye(void)
{
	struct lod_eye eye = flat_eye(2, 2);
	eye.tan_x = 0.8, eye.tan_y = 0.6;
	return eye;
}

UNIT_TEST(nearer_wins_and_of_equals_the_smaller_owner)
{
	static const struct { double w[2]; uint64_t owner[2], wins; } rows[] = {
		{ { 2, 4 }, { 9, 1 }, 9 }, { { 4, 2 }, { 1, 9 }, 9 }, { { 2, 2 }, { 3, 5 }, 3 },
			{ { 2, 2 }, { 5, 3 }, 3 },
		{ { 2, 2 }, { 0, 5 }, 0 }, { { 2, 2 }, { 5, 0 }, 0 }, { { 2, 4 }, { 0, 5 }, 0 },
		{ { 4, 2 }, { 0, 5 }, 5 },
	};
	static const double corner[3][2] = { { -4096, -4096 }, { 16384, -4096 }, { -4096, 16384 } };
	for (int owners = 0; owners < 2; owners++) {
		for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
			FREED(lod_raster) raster;
			struct lod_raster_options options = { .width = 16, .height = 16, .owner = owners };
			struct lod_eye eye = flat_eye(16, 16);
			lod_raster_init(&raster, &options);
			lod_raster_camera(&raster, &eye, 0.1);
			for (int i = 0; i < 2; i++) {
				float p[9];
				for (int k = 0; k < 3; k++)
					raster_put(p + 3 * k, &raster, corner[k][0], corner[k][1],
						rows[r].w[i]);
				raster_draw(&raster, p, 1, rows[r].owner[i]);
			}
			assert_int_equal(raster_covered(&raster), rows[r].wins ? 256 : 0);
			assert_true(!owners || raster.owner[77] == rows[r].wins);
		}
	}
}

/* Triangles from slivers to larger than the picture, some behind the eye; lines. */
static void draw_anything(struct lod_raster *raster, uint32_t count, const struct eco_image *image,
	uint64_t owner)
{
	float position[9 * 64], uv[6 * 64], width[64];
	for (uint32_t kind = 0; kind < 3; kind++) {
		double size = uniform(0, 1) < 0.5 ? 0.05 : 0.6;
		for (uint32_t i = 0; i < count; i++) {
			double at[3] = { uniform(-4, 4), uniform(-1, 12), uniform(-3, 3) };
			for (uint32_t k = 0; k < 9; k++)
				position[9 * i + k] = (float)(at[k % 3] + uniform(-size, size));
			for (uint32_t k = 0; k < 6; k++)
				uv[6 * i + k] = (float)uniform(-1, 2);
			width[i] = (float)uniform(0, 0.2);
		}
		struct lod_raster_batch batch = { .count = count, .position = position, .uv = uv,
			.cutout = kind == 1 ? image : NULL, .width = width, .owner = owner };
		(kind < 2 ? lod_raster_triangles : lod_raster_lines)(raster, &batch);
	}
}

/* In two of three rounds with ground, which comes first. */
UNIT_TEST(a_silhouette_covers_what_a_picture_covers)
{
	uint8_t texels[4 * 64];
	const struct eco_image image = { 8, 8, texels };
	struct lod_eye eye = wide_eye();
	for (uint32_t round = 0; round < 60; round++) {
		FREED(lod_raster) whole, mask;
		uint32_t width = 1 + round * 3, height = 1 + round * 2;
		lod_raster_init(&whole, &(struct lod_raster_options){ .width = width, .height = height });
		lod_raster_init(&mask,
			&(struct lod_raster_options){ .width = width, .height = height, .silhouette = true });
		for (uint32_t i = 0; i < sizeof texels; i++)
			texels[i] = (uint8_t)rnd(256);
		for (uint32_t batch = 0; batch < 8; batch++) {
			struct lod_raster *rasters[2] = { &whole, &mask };
			for (int i = 0; i < 2; i++) {
				rnd_seed = 100 * round + batch;
				lod_raster_camera(rasters[i], &eye, 0.1);
				draw_anything(rasters[i], 1 + rnd(64), &image, batch >= round % 3);
			}
			assert_memory_equal(whole.cover, mask.cover, (size_t)width * height);
		}
	}
}

/* But for corners that floats snap to another 1/256 pixel. */
UNIT_TEST(parts_make_up_the_picture)
{
	enum { WIDTH = 150, HEIGHT = 110, PART_X = 47, PART_Y = 60 };
	FREED(lod_raster) whole, part;
	struct lod_eye eye = wide_eye();
	uint32_t differ = 0;
	raster_start(&whole, WIDTH, HEIGHT, &eye);
	raster_start(&part, PART_X, PART_Y, &eye);
	rnd_seed = 11;
	draw_anything(&whole, 64, NULL, 1);
	for (uint32_t y = 0; y < HEIGHT; y += PART_Y)
		for (uint32_t x = 0; x < WIDTH; x += PART_X) {
			lod_raster_clear(&part);
			struct lod_eye of_part = eye;
			lod_eye_part(&of_part, WIDTH, HEIGHT, (const uint32_t[2]){ x, y },
				(const uint32_t[2]){ PART_X, PART_Y });
			lod_raster_camera(&part, &of_part, 1.0 / 1024);
			rnd_seed = 11;
			draw_anything(&part, 64, NULL, 1);
			for (uint32_t i = 0; i < PART_X * PART_Y; i++)
				if (x + i % PART_X < WIDTH && y + i / PART_X < HEIGHT)
					differ += part.cover[i] != whole.cover[(y + i / PART_X) * WIDTH + x
						+ i % PART_X];
		}
	assert_true(raster_covered(&whole) > 5000 && raster_covered(&whole) < WIDTH * HEIGHT - 500);
	assert_true(differ <= WIDTH * HEIGHT / 2000);
}

UNIT_TEST(order_and_split_do_not_change_a_picture)
{
	struct lod_eye eye = wide_eye();
	rnd_seed = 5;
	FREED(crowd) crowd = crowd_make(300, 20, 2);
	for (uint32_t twin = 0; twin < 300; twin += 7)        /* equal depths, far apart in the order */
		memcpy(crowd.position + 9 * 20 * (size_t)twin, crowd.position + 9 * 20 * (size_t)(299 - twin),
			9 * 20 * sizeof(float));
	struct lod_raster whole, parts[3];
	raster_start(&whole, 160, 120, &eye);
	crowd_draw(&whole, &crowd, 0, 300);
	for (int i = 0; i < 3; i++)
		raster_start(&parts[i], 160, 120, &eye);
	for (int round = 0; round < 6; round++) {
		for (int i = 0; i < 3; i++)
			lod_raster_clear(&parts[i]);
		for (uint32_t g = 0; g < 300; g++) {
			uint32_t group = round & 1 ? 299 - g : g;
			crowd_draw(&parts[round < 2 ? g % 3 : rnd(3)], &crowd, group, group + 1);
		}
		lod_raster_merge(&parts[1], &parts[round % 3 == 0 ? 2 : 0]);
		lod_raster_merge(&parts[1], &parts[round % 3 == 0 ? 0 : 2]);
		assert_true(same_picture(&whole, &parts[1]));
	}
	lod_raster_free(&whole);
	for (int i = 0; i < 3; i++)
		lod_raster_free(&parts[i]);
}

static void group_sphere(const struct crowd *crowd, uint32_t group, double center[3], double *radius)
{
	const float *p = crowd->position + (size_t)group * crowd->each * 9;
	double far2 = 0;
	memset(center, 0, 3 * sizeof *center);
	for (uint32_t i = 0; i < crowd->each * 9; i++)
		center[i % 3] += p[i] / (crowd->each * 3.0);
	for (uint32_t i = 0; i < crowd->each * 3; i++) {
		double d2 = 0;
		for (int k = 0; k < 3; k++)
			d2 += (p[3 * i + (uint32_t)k] - center[k]) * (p[3 * i + (uint32_t)k] - center[k]);
		far2 = d2 > far2 ? d2 : far2;
	}
	*radius = sqrt(far2);
}

UNIT_TEST(skipping_what_is_hidden_changes_no_pixel)
{
	struct lod_eye eye = wide_eye();
	for (int round = 0; round < 6; round++) {
		rnd_seed = 6 + (uint64_t)round;
		FREED(crowd) crowd = crowd_make(1500, 12, round % 2 ? 9 : 1);
		FREED(lod_raster) all, few;
		raster_start(&all, 190, 133, &eye);
		raster_start(&few, 190, 133, &eye);
		lod_raster_camera(&all, &eye, 18);
		lod_raster_camera(&few, &eye, 18);
		uint32_t skipped = 0;
		for (uint32_t g = 0; g < crowd.groups; g++) {
			double center[3], radius;
			group_sphere(&crowd, g, center, &radius);
			crowd_draw(&all, &crowd, g, g + 1);
			if (lod_raster_hides(&few, center, radius))
				skipped++;
			else
				crowd_draw(&few, &crowd, g, g + 1);
		}
		assert_true(same_picture(&all, &few));
		assert_true(skipped > (round % 2 ? 300 : 30));
	}
}

/* ---- Cut-outs, lines ---- */

UNIT_TEST(cutouts_are_sampled_in_perspective_and_wrap)
{
	enum { TW = 7, TH = 5 };
	uint8_t texels[TW * TH * 4] = { 0 };
	struct eco_image image = { TW, TH, texels };
	FREED(lod_raster) raster;
	struct lod_eye eye = wide_eye();
	rnd_seed = 9;
	for (int i = 0; i < TW * TH; i++)
		texels[4 * i + 3] = (uint8_t)(rnd(2) ? 128 : 127);
	raster_start(&raster, 300, 200, &eye);
	/* a plane leaning away: corners at different depths; u = x / 3, v = -z / 2, both also negative */
	float p[18], uv[12], corner[6][2] = { { -9, -6 }, { 9, -6 }, { 9, 6 }, { -9, -6 }, { 9, 6 },
		{ -9, 6 } };
	for (int i = 0; i < 6; i++) {
		p[3 * i] = corner[i][0], p[3 * i + 1] = 20 + corner[i][1], p[3 * i + 2] = corner[i][1];
		uv[2 * i] = corner[i][0] / 3, uv[2 * i + 1] = -corner[i][1] / 2;
	}
	struct lod_raster_batch batch = { .count = 2, .position = p, .uv = uv, .cutout = &image, .owner = 1 };
	lod_raster_triangles(&raster, &batch);
	int wrong = 0, inside = 0;
	for (int y = 0; y < 200; y++) {
		for (int x = 0; x < 300; x++) {
			double a = (x + 0.5 - 150) / 150 * 0.8, b = -(y + 0.5 - 100) / 100 * 0.6,
				w = 20 / (1 - b), wx = a * w, wz = b * w;
			bool in = fabs(wx) < 9 && fabs(wz) < 6;
			double u = wx / 3 - floor(wx / 3), v = -wz / 2 - floor(-wz / 2);
			bool opaque = in && texels[4 * ((int)(v * TH) * TW + (int)(u * TW)) + 3] >= 128;
			inside += in;
			wrong += opaque != (raster.cover[y * 300 + x] != 0);
		}
	}
	assert_true(inside > 8000);
	assert_true(wrong < inside / 100);
}

/* ---- Bits ---- */

static uint64_t digest(const struct lod_raster *raster)
{
	uint64_t hash = 14695981039346656037u;
	for (size_t i = 0; i < (size_t)raster->width * raster->height; i++) {
		uint32_t bits;
		memcpy(&bits, &raster->depth[i], 4);
		hash = (hash ^ bits ^ (uint64_t)raster->cover[i] << 32 ^ raster->owner[i] << 40)
			* 1099511628211u;
	}
	return hash;
}

UNIT_TEST(every_build_paints_the_same_bits)
{
	FREED(lod_raster) raster;
	struct lod_eye eye = wide_eye();
	rnd_seed = 12;
	raster_start(&raster, 320, 200, &eye);
	lod_raster_object(&raster, &(struct lod_place){ { 1, 4, 2 }, 0.28, 0.96, 0.5, 0, 0 });
	FREED(crowd) crowd = crowd_make(200, 40, 3);
	crowd_draw(&raster, &crowd, 0, 200);
	FREED_MEMORY float *width = malloc(2000 * sizeof *width);
	for (int i = 0; i < 2000; i++)
		width[i] = (float)uniform(0.05, 0.3);
	struct lod_raster_batch lines = { .count = 2000, .position = crowd.position + 31, .width = width,
		.owner = 1001 };
	lod_raster_lines(&raster, &lines);
	assert_true(raster_covered(&raster) > 20000);
	assert_true(digest(&raster) == 0xf124b9c5252285c6u);
}
