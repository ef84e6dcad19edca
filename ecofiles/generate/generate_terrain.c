/* Rolling ground: two octaves of value noise with a quintic between the lattice points, so that slopes
 * have no creases. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/generate/generate_scenes.h"
#include "ecofiles/base/module.h"

static double lattice(uint64_t seed, int64_t x, int64_t y)
{
	struct gen_random random =
		{ seed ^ (uint64_t)x * 0x9E3779B97F4A7C15u ^ (uint64_t)y * 0xC2B2AE3D27D4EB4Fu };
	gen_random_bits(&random);
	return gen_random_unit(&random);
}

static double ease(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

double gen_noise(uint64_t seed, double x, double y)
{
	double fx = floor(x), fy = floor(y), tx = ease(x - fx), ty = ease(y - fy);
	int64_t ix = (int64_t)fx, iy = (int64_t)fy;
	double south = lattice(seed, ix, iy) * (1 - tx) + lattice(seed, ix + 1, iy) * tx;
	double north = lattice(seed, ix, iy + 1) * (1 - tx) + lattice(seed, ix + 1, iy + 1) * tx;
	return south * (1 - ty) + north * ty;
}

double gen_terrain_height(const struct gen_terrain *t, double x, double y)
{
	return t->hill_m * gen_noise(t->seed, x / t->hill_length_m, y / t->hill_length_m) + t->bump_m
		* gen_noise(t->seed + 1, x / t->bump_length_m + 0.37, y / t->bump_length_m + 0.61);
}

enum eco_code gen_terrain_write(const struct gen_terrain *terrain, double half_m, double step_m,
	const char *path, struct eco_error *error)
{
	uint32_t side = (uint32_t)(2 * half_m / step_m + 0.5) + 1;
	char beside[4096];
	if (snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof beside)
		return eco_fail(error, ECO_BAD_INPUT, "%s: path too long", path);
	float *samples = malloc((size_t)side * side * sizeof *samples);
	if (!samples)
		return eco_fail(error, ECO_NO_MEMORY, "%s: no memory for %u x %u samples", path, side, side);
	for (uint32_t row = 0; row < side; row++) {
		for (uint32_t column = 0; column < side; column++) {
			double z = gen_terrain_height(terrain, -half_m + column * step_m,
				half_m - row * step_m);
			samples[(size_t)row * side + column] =
				(float)(floor((GEN_ALTITUDE + z) * 100 + 0.5) / 100);
		}
	}
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, error);
	enum eco_code code = gdal
		? gdal->raster_write(&(struct eco_raster){ .samples = samples, .side = side,
		.west = GEN_EASTING - half_m,
		.north = GEN_NORTHING + half_m, .step_m = step_m, .epsg = GEN_EPSG }, beside,
		error) : ECO_NOT_FOUND;
	free(samples);
	if (!code && rename(beside, path) != 0)
		code = eco_fail_write(error, path, errno);
	if (code)
		unlink(beside);
	return code;
}
