#include "tests/support/raster_flat.h"

#include "tests/support/unit_test.h"

uint64_t rnd_seed;

uint32_t rnd(uint32_t below)
{
	rnd_seed = rnd_seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)((rnd_seed >> 33) * (uint64_t)below >> 31);
}

double uniform(double low, double high)
{
	return low + (high - low) * rnd(1u << 30) / (double)(1u << 30);
}

struct lod_eye flat_eye(uint32_t width, uint32_t height)
{
	return (struct lod_eye){ .right = { 1, 0, 0 }, .up = { 0, 0, 1 }, .forward = { 0, 1, 0 },
		.tan_x = width / 2.0,
		.tan_y = height / 2.0, .pixel_rad = 1 };
}

void raster_start(struct lod_raster *raster, uint32_t width, uint32_t height, const struct lod_eye *eye)
{
	struct lod_raster_options options = { .width = width, .height = height, .owner = true, .item = true };
	assert_int_equal(lod_raster_init(raster, &options, NULL), ECO_OK);
	struct lod_eye flat = flat_eye(width, height);
	lod_raster_camera(raster, eye ? eye : &flat, 1.0 / 1024);
}

void raster_put(float *p, const struct lod_raster *raster, double x, double y, double w)
{
	p[0] = (float)((x / 256 - raster->width / 2.0) * w);
	p[1] = (float)w;
	p[2] = (float)((raster->height / 2.0 - y / 256) * w);
}

void raster_draw(struct lod_raster *raster, const float *position, uint32_t count, uint64_t owner)
{
	struct lod_raster_batch batch = { .count = count, .position = position, .owner = owner };
	lod_raster_triangles(raster, &batch);
}

uint64_t raster_covered(const struct lod_raster *raster)
{
	uint64_t n = 0;
	for (size_t i = 0; i < (size_t)raster->width * raster->height; i++)
		n += raster->cover[i] != 0;
	return n;
}
