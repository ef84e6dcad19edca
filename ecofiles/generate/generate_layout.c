/* Shared by the layouts: files that appear whole, models, cameras, ground, and plants that keep their
 * distance. Ground is two octaves of value noise with a quintic between the lattice points, so that slopes
 * have no creases. */
#include "ecofiles/generate/generate_scenes.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/generate/generate_plants.h"

#define PATH_BYTES 4096u

/* ---- Files ---- */

static void gen_fail(struct gen_layout *layout, enum eco_code code, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
static void gen_fail(struct gen_layout *layout, enum eco_code code, const char *format, ...)
{
	char text[512];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	layout->code = layout->code ? layout->code : eco_fail(layout->error, code, "%s", text);
}

bool gen_progress(struct gen_layout *layout, const char *stage, double share)
{
	const struct eco_generate_options *o = layout->options;
	if (!layout->code && o->progress && !o->progress(o->ctx, stage, share))
		gen_fail(layout, ECO_INTERRUPTED, "interrupted");
	return !layout->code;
}

FILE *gen_open(struct gen_layout *layout)
{
	FILE *out = layout->code ? NULL : open_memstream(&layout->bytes, &layout->size);
	if (!out && !layout->code)
		eco_end("no memory");
	return out;
}

static bool path_of(struct gen_layout *layout, const char *name, char path[PATH_BYTES])
{
	if (snprintf(path, PATH_BYTES, "%s/%s", layout->options->folder, name) >= (int)PATH_BYTES)
		gen_fail(layout, ECO_BAD_INPUT, "%.300s: path too long", layout->options->folder);
	return !layout->code;
}

void gen_close(struct gen_layout *layout, FILE *out, const char *name)
{
	char path[PATH_BYTES];
	if (fclose(out))
		eco_end("no memory");
	if (path_of(layout, name, path))
		layout->code = eco_file_write(path, layout->bytes, layout->size, layout->error);
	free(layout->bytes);
}

/* ---- Ground ---- */

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

static void write_ground(struct gen_layout *layout, const struct gen_terrain *terrain, double half_m,
	double step_m)
{
	char path[PATH_BYTES], beside[PATH_BYTES + 32];
	while (half_m / step_m > 1000)
		step_m *= 2;
	half_m = ceil(half_m / step_m) * step_m;
	uint32_t side = (uint32_t)(2 * half_m / step_m + 0.5) + 1;
	float *samples = eco_alloc((size_t)side * side, sizeof *samples);
	for (size_t i = 0; i < (size_t)side * side; i++) {
		double z = gen_terrain_height(terrain, -half_m + (uint32_t)(i % side) * step_m,
			half_m - (uint32_t)(i / side) * step_m);
		samples[i] = (float)(floor((GEN_ALTITUDE + z) * 100 + 0.5) / 100);
	}
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, layout->error);
	if (!gdal)
		gen_fail(layout, ECO_NOT_FOUND, "no GDAL");
	if (path_of(layout, "dem.tif", path)) {
		snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid());
		layout->code = gdal->raster_write(&(struct eco_raster){ .samples = samples, .side = side,
			.west = GEN_EASTING - half_m, .north = GEN_NORTHING + half_m, .step_m = step_m,
			.epsg = 32632 }, beside, layout->error);
		if (!layout->code && rename(beside, path) != 0)
			layout->code = eco_fail_write(layout->error, path, errno);
		if (layout->code)
			unlink(beside);
	}
	free(samples);
}

/* ---- Settings ---- */

static void write_model(struct gen_layout *layout, const char *name)
{
	const struct gen_plant *plant = gen_plant_find(name);
	char folder[PATH_BYTES];
	struct gen_mesh mesh = { .detail = layout->options->detail > 0 ? layout->options->detail : 1 };
	uint64_t seed = layout->options->seed;
	for (const char *c = name; *c; c++)
		seed = seed * 131 + (unsigned char)*c;
	plant->grow(&mesh, plant->kind, &(struct gen_random){ seed });
	if (path_of(layout, "models", folder))
		layout->code = gen_mesh_write(&mesh, folder, name, layout->error);
	gen_mesh_free(&mesh);
	if (!layout->code && plant->texture)
		layout->code = gen_texture_write(folder, plant->texture, layout->error);
}

static void write_camera(struct gen_layout *layout, const struct gen_setting *setting)
{
	FILE *out = gen_open(layout);
	if (!out)
		return;
	fputs("{\"fps\": 1, \"keyframes\": [", out);
	for (uint32_t i = 0; i < setting->look_count; i++) {
		const struct gen_look *l = &setting->looks[i];
		fprintf(out, "%s\n  {\"time_s\": %.0f, \"eye\": [%.2f, %.2f, %.2f], \"target\": [%.2f, "
			"%.2f, %.2f], \"up\": [0, 0, 1], \"fov_y_deg\": %.0f}", i ? "," : "", l->time_s,
			l->eye[0], l->eye[1],
			l->eye[2] + gen_terrain_height(setting->terrain, l->eye[0], l->eye[1]), l->target[0],
			l->target[1],
			l->target[2] + gen_terrain_height(setting->terrain, l->target[0], l->target[1]),
			l->fov_deg);
	}
	fputs("\n]}\n", out);
	gen_close(layout, out, "camera.json");
}

void gen_write_setting(struct gen_layout *layout, const struct gen_setting *setting)
{
	uint32_t count = 0;
	while (setting->names[count])
		count++;
	for (uint32_t i = 0; i < count && gen_progress(layout, setting->names[i], 0.8 * i / count); i++)
		write_model(layout, setting->names[i]);
	if (gen_progress(layout, "ground", 0.8))
		write_ground(layout, setting->terrain, setting->half_m, setting->step_m);
	write_camera(layout, setting);
}

/* ---- Parts of scene.json ---- */

void gen_print_head(FILE *out, const char *name, uint32_t tile_instances)
{
	fprintf(out, "{\n  \"name\": \"%s\", \"crs\": \"" GEN_CRS "\", \"origin\": [%.0f, %.0f, %.0f],\n",
		name, GEN_EASTING, GEN_NORTHING, GEN_ALTITUDE);
	fprintf(out, "  \"ground\": {\"heights\": \"dem.tif\"}, \"tile\": {\"instances\": %u},\n",
		tile_instances);
}

void gen_print_plants(FILE *out, const char *const names[])
{
	fputs("  \"plants\": {", out);
	for (uint32_t i = 0; names[i]; i++)
		fprintf(out, "%s\n    \"%s\": {\"model\": \"models/%s.obj\", \"unit\": \"m\"%s}",
			i ? "," : "", names[i], names[i], gen_plant_find(names[i])->flowers
			? ", \"importance\": {\"flower\": 2}" : "");
	fputs("\n  },\n", out);
}

void gen_write_listed(struct gen_layout *layout, const char *name, uint32_t tile_instances,
	const char *const names[])
{
	FILE *out = gen_open(layout);
	if (!out)
		return;
	gen_print_head(out, name, tile_instances);
	gen_print_plants(out, names);
	fputs("  \"instances\": [\n    {\"from\": \"plants.csv\", \"x\": \"easting\", \"y\": \"northing\", "
		"\"crs\": \"" GEN_CRS "\", \"species\": \"plant\",\n     \"map\": {", out);
	for (uint32_t i = 0; names[i]; i++)
		fprintf(out, "%s\"%s\": \"%s\"", i ? ", " : "", names[i], names[i]);
	fputs("}, \"height_m\": {\"column\": \"height_m\"}, \"seed\": 1}\n  ]\n}\n", out);
	gen_close(layout, out, "scene.json");
}

/* ---- Plants that keep their distance: a hash grid of the plants so far ---- */

void gen_stand_open(struct gen_stand *stand, uint32_t capacity, double half_m, double room_max)
{
	*stand = (struct gen_stand){ .capacity = capacity, .half_m = half_m, .cell_m = room_max };
	while (half_m * 2 / stand->cell_m > 4096)
		stand->cell_m *= 2;
	stand->side = (uint32_t)(2 * half_m / stand->cell_m) + 1;
	stand->plants = eco_alloc((size_t)capacity + 1, sizeof *stand->plants);
	stand->cells = eco_alloc((size_t)stand->side * stand->side, sizeof *stand->cells);
	memset(stand->cells, 0xFF, (size_t)stand->side * stand->side * sizeof *stand->cells);
}

void gen_stand_close(struct gen_stand *stand)
{
	free(stand->plants);
	free(stand->cells);
}

static uint32_t stand_cell(const struct gen_stand *stand, double v)
{
	return (uint32_t)gen_clamp((v + stand->half_m) / stand->cell_m, 0, stand->side - 1);
}

bool gen_stand_add(struct gen_stand *stand, double x, double y, double room)
{
	uint32_t column = stand_cell(stand, x), row = stand_cell(stand, y);
	for (uint32_t r = row ? row - 1 : 0; r <= row + 1 && r < stand->side; r++) {
		for (uint32_t c = column ? column - 1 : 0; c <= column + 1 && c < stand->side; c++) {
			for (uint32_t i = stand->cells[(size_t)r * stand->side + c]; i != ECO_NONE;
					i = stand->plants[i].next) {
				double dx = stand->plants[i].x - x, dy = stand->plants[i].y - y,
					far = 0.5 * (stand->plants[i].room + room);
				if (dx * dx + dy * dy < far * far)
					return false;
			}
		}
	}
	if (stand->count >= stand->capacity)
		return false;
	uint32_t *cell = &stand->cells[(size_t)row * stand->side + column];
	stand->plants[stand->count] = (struct standing){ (float)x, (float)y, (float)room, *cell };
	*cell = stand->count++;
	return true;
}
