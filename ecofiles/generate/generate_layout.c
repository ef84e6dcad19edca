/* The list of example scenes, and what their layouts share: files that appear whole, models, cameras, ground, and
 * plants that keep their distance. Ground is two octaves of value noise with a quintic between the lattice points, so
 * that slopes have no creases. */
#include "ecofiles/generate/generate_scenes.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/generate/generate_plants.h"

#define PATH_BYTES 4096u

/* ---- Files ---- */

void gen_progress(struct gen_layout *layout, const char *stage, double share)
{
	const struct eco_generate_options *o = layout->options;
	if (o->progress && !o->progress(o->ctx, stage, share))
		eco_stop(ECO_INTERRUPTED, "interrupted");
}

FILE *gen_open(struct gen_layout *layout)
{
	FILE *out = open_memstream(&layout->bytes, &layout->size);
	if (!out)
		eco_end("no memory");
	return out;
}

static void path_of(struct gen_layout *layout, const char *name, char path[PATH_BYTES])
{
	if (snprintf(path, PATH_BYTES, "%s/%s", layout->options->folder, name) >= (int)PATH_BYTES)
		eco_stop(ECO_BAD_INPUT, "%.300s: path too long", layout->options->folder);
}

void gen_close(struct gen_layout *layout, FILE *out, const char *name)
{
	char path[PATH_BYTES];
	if (fclose(out))
		eco_end("no memory");
	path_of(layout, name, path);
	eco_check(eco_file_write(path, layout->bytes, layout->size, layout->error));
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

static double terrain_height(const struct gen_terrain *t, double x, double y)
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
		double z = terrain_height(terrain, -half_m + (uint32_t)(i % side) * step_m,
			half_m - (uint32_t)(i / side) * step_m);
		samples[i] = (float)(floor((GEN_ALTITUDE + z) * 100 + 0.5) / 100);
	}
	const struct eco_gdal_module *gdal = eco_module(ECO_MODULE_GDAL, layout->error);
	if (!gdal)
		eco_check(ECO_NOT_FOUND);
	path_of(layout, "dem.tif", path);
	snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid());
	enum eco_code code = gdal->raster_write(&(struct eco_raster){ .samples = samples, .side = side,
		.west = GEN_EASTING - half_m, .north = GEN_NORTHING + half_m, .step_m = step_m, .epsg = 32632 }, beside,
		layout->error);
	if (!code && rename(beside, path) != 0)
		code = eco_fail_write(layout->error, path, errno);
	if (code)
		unlink(beside);
	eco_check(code);
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
	path_of(layout, "models", folder);
	gen_mesh_write(&mesh, folder, name, layout->error);
	gen_mesh_free(&mesh);
	if (plant->texture)
		gen_texture_write(folder, plant->texture, layout->error);
}

static void write_camera(struct gen_layout *layout, const struct gen_setting *setting)
{
	FILE *out = gen_open(layout);
	fputs("{\"fps\": 1, \"keyframes\": [", out);
	for (uint32_t i = 0; i < setting->look_count; i++) {
		const struct gen_look *l = &setting->looks[i];
		fprintf(out, "%s\n  {\"time_s\": %.0f, \"eye\": [%.2f, %.2f, %.2f], \"target\": [%.2f, "
			"%.2f, %.2f], \"up\": [0, 0, 1], \"fov_y_deg\": %.0f}", i ? "," : "", l->time_s,
			l->eye[0], l->eye[1],
			l->eye[2] + terrain_height(setting->terrain, l->eye[0], l->eye[1]), l->target[0],
			l->target[1],
			l->target[2] + terrain_height(setting->terrain, l->target[0], l->target[1]),
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
	for (uint32_t i = 0; i < count; i++) {
		gen_progress(layout, setting->names[i], 0.8 * i / count);
		write_model(layout, setting->names[i]);
	}
	gen_progress(layout, "ground", 0.8);
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

/* ---- All scenes ---- */

const struct eco_generate_kind eco_generate_kinds[] = {
	{ "park", "trees along a path, groups of conifers, palms, shrubs, grasses and flowers on a gentle "
		"lawn", 60 },
	{ "forest", "a mixed stand on hills: stems with trunk diameters in a CSV file, shrubs and ferns "
		"below", 2000 },
	{ "meadow", "grasses and patches of flowers from nested eco files, with a few trees", 4000 },
	{ "grove", "trees of six kinds on gentle hills, along a ride that the camera walks", 640 },
	{ "palms", "a palm grove", 1500 },
	{ "sunflowers", "a field of sunflowers around an old tree", 13001 },
	{ "outdoor", "groups of trees, shrubs and patches of grasses and flowers on hills", 40000 },
	{ "billion", "a forest of any size: hectares of a thousand plants in blocks of blocks", 1000000000 },
	{ "city", "trees of alpha-cut cards along the streets of a grid", 4000 },
	{ NULL, NULL, 0 },
};
static void (*const layouts[])(struct gen_layout *) =
	{ gen_park, gen_forest, gen_meadow, gen_grove, gen_palms, gen_sunflowers, gen_outdoor, gen_billion,
	gen_city };

static enum eco_code make_folder(const char *path, struct eco_error *error)
{
	struct stat status;
	if (mkdir(path, 0777) == 0)
		return ECO_OK;
	if (errno == EEXIST && stat(path, &status) == 0 && S_ISDIR(status.st_mode))
		return ECO_OK;
	int reason = errno == EEXIST ? ENOTDIR : errno;
	return eco_fail(error, ECO_IO, "%.330s: cannot make this folder: %s%s", path, strerror(reason),
		eco_advice_write(reason));
}

struct generating { struct gen_layout layout; size_t kind; };

static void generate(void *ctx)
{
	struct generating *g = ctx;
	char models[PATH_BYTES];
	path_of(&g->layout, "models", models);
	eco_check(make_folder(g->layout.options->folder, g->layout.error));
	eco_check(make_folder(models, g->layout.error));
	layouts[g->kind](&g->layout);
}

enum eco_code eco_generate(const struct eco_generate_options *options, struct eco_error *error)
{
	size_t kind = 0;
	while (eco_generate_kinds[kind].name && strcmp(eco_generate_kinds[kind].name, options->name) != 0)
		kind++;
	if (!eco_generate_kinds[kind].name)
		return eco_fail(error, ECO_BAD_USAGE, "no scene is called %s: generate park, forest, "
			"meadow, grove, palms, sunflowers, outdoor, billion or city", options->name);
	uint64_t most = eco_generate_kinds[kind].plants > ECO_GENERATE_NAMED_MAX ? ECO_GENERATE_PLANTS_MAX
		: ECO_GENERATE_NAMED_MAX;
	if (options->plants > most)
		return eco_fail(error, ECO_TOO_LARGE, "%llu plants: at most %llu are generated; nest eco "
			"files for more", (unsigned long long)options->plants, (unsigned long long)most);
	if (!(options->detail >= 0 && options->detail <= ECO_GENERATE_DETAIL_MAX))
		return eco_fail(error, ECO_TOO_LARGE, "detail %g: 0.1 to %g times the leaves",
			options->detail, ECO_GENERATE_DETAIL_MAX);
	struct eco_error own = { .code = ECO_OK };
	struct generating g = { .kind = kind, .layout = { .options = options, .error = error ? error : &own,
		.plants = (uint32_t)(options->plants ? options->plants : eco_generate_kinds[kind].plants),
		.random = { options->seed * 0x9E3779B97F4A7C15u + kind } } };
	return eco_try(generate, &g, g.layout.error);
}
