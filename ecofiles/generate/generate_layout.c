/* Shared by the layouts: files that appear whole, models, cameras, ground, and plants that keep their
 * distance. */
#include "ecofiles/generate/generate_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/generate/generate_plants.h"

/* ---- Texts ---- */

enum eco_code gen_text_open(struct gen_text *text, struct eco_error *error)
{
	*text = (struct gen_text){ 0 };
	text->out = open_memstream(&text->bytes, &text->size);
	return text->out ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "generating: no memory");
}

enum eco_code gen_text_write(struct gen_text *text, const struct gen_layout *layout, const char *name,
	struct eco_error *error)
{
	char path[4096];
	enum eco_code code = ECO_OK;
	if (fclose(text->out))
		code = eco_fail(error, ECO_NO_MEMORY, "generating %s: no memory", name);
	else if (snprintf(path, sizeof path, "%s/%s", layout->options->folder, name) >= (int)sizeof path)
		code = eco_fail(error, ECO_BAD_INPUT, "%s: path too long", layout->options->folder);
	else
		code = gen_file_write(path, text->bytes, text->size, error);
	free(text->bytes);
	return code;
}

enum eco_code gen_progress(const struct gen_layout *layout, const char *stage, double share,
	struct eco_error *error)
{
	const struct eco_generate_options *o = layout->options;
	return !o->progress || o->progress(o->ctx, stage, share) ? ECO_OK
		: eco_fail(error, ECO_INTERRUPTED, "interrupted");
}

/* ---- Shared parts of scenes ---- */

static enum eco_code write_model(const struct gen_layout *layout, const char *name, struct eco_error *error)
{
	const struct gen_plant *plant = gen_plant_find(name);
	char folder[4096];
	struct gen_mesh mesh = { 0 };
	uint64_t seed = layout->options->seed;
	for (const char *c = name; *c; c++)
		seed = seed * 131 + (unsigned char)*c;
	struct gen_random random = { seed };
	snprintf(folder, sizeof folder, "%s/models", layout->options->folder);
	mesh.detail = layout->options->detail > 0 ? layout->options->detail : 1;
	plant->grow(&mesh, plant->kind, &random);
	enum eco_code code = gen_mesh_write(&mesh, folder, name, error);
	gen_mesh_free(&mesh);
	if (!code && plant->texture)
		code = gen_texture_write(folder, plant->texture, error);
	return code;
}

enum eco_code gen_write_models(const struct gen_layout *layout, const char *const names[],
	struct eco_error *error)
{
	uint32_t count = 0;
	while (names[count])
		count++;
	for (uint32_t i = 0; i < count; i++) {
		enum eco_code code = gen_progress(layout, names[i], 0.8 * i / count, error);
		if (!code)
			code = write_model(layout, names[i], error);
		if (code)
			return code;
	}
	return ECO_OK;
}

void gen_print_head(FILE *out, const char *name, uint32_t tile_instances)
{
	fprintf(out, "{\n  \"name\": \"%s\", \"crs\": \"" GEN_CRS "\", \"origin\": [%.0f, %.0f, %.0f],\n",
		name, GEN_EASTING, GEN_NORTHING, GEN_ALTITUDE);
	fprintf(out, "  \"ground\": {\"heights\": \"dem.tif\"}, \"tile\": {\"instances\": %u},\n",
		tile_instances);
}

static bool has_flowers(const char *name)
{
	return !strcmp(name, "azalea") || !strcmp(name, "daisy") || !strcmp(name, "poppy")
		|| !strcmp(name, "cornflower") || !strcmp(name, "sunflower");
}

void gen_print_plants(FILE *out, const char *const names[])
{
	fputs("  \"plants\": {", out);
	for (uint32_t i = 0; names[i]; i++)
		fprintf(out, "%s\n    \"%s\": {\"model\": \"models/%s.obj\", \"unit\": \"m\"%s}",
			i ? "," : "", names[i], names[i], has_flowers(names[i])
			? ", \"importance\": {\"flower\": 2}" : "");
	fputs("\n  },\n", out);
}

void gen_print_listed(FILE *out, const char *name, uint32_t tile_instances, const char *const names[])
{
	gen_print_head(out, name, tile_instances);
	gen_print_plants(out, names);
	fputs("  \"instances\": [\n    {\"from\": \"plants.csv\", \"x\": \"easting\", \"y\": \"northing\", "
		"\"crs\": \""
		GEN_CRS "\", \"species\": \"plant\",\n"
		"     \"map\": {", out);
	for (uint32_t i = 0; names[i]; i++)
		fprintf(out, "%s\"%s\": \"%s\"", i ? ", " : "", names[i], names[i]);
	fputs("}, \"height_m\": {\"column\": \"height_m\"}, \"seed\": 1}\n  ]\n}\n", out);
}

enum eco_code gen_write_camera(const struct gen_layout *layout, const struct gen_terrain *terrain,
	const struct gen_look *looks, uint32_t count, struct eco_error *error)
{
	struct gen_text text;
	enum eco_code code = gen_text_open(&text, error);
	if (code)
		return code;
	fputs("{\"fps\": 1, \"keyframes\": [", text.out);
	for (uint32_t i = 0; i < count; i++) {
		const struct gen_look *l = &looks[i];
		fprintf(text.out, "%s\n  {\"time_s\": %.0f, \"eye\": [%.2f, %.2f, %.2f], \"target\": [%.2f, "
			"%.2f, %.2f], \"up\": [0, 0, 1], "
			"\"fov_y_deg\": %.0f}", i ? "," : "", l->time_s, l->eye[0], l->eye[1],
			l->eye[2] + gen_terrain_height(terrain, l->eye[0], l->eye[1]), l->target[0],
			l->target[1], l->target[2] + gen_terrain_height(terrain, l->target[0], l->target[1]),
			l->fov_deg);
	}
	fputs("\n]}\n", text.out);
	return gen_text_write(&text, layout, "camera.json", error);
}

enum eco_code gen_write_ground(const struct gen_layout *layout, const struct gen_terrain *terrain,
	double half_m, double step_m, struct eco_error *error)
{
	char path[4096];
	enum eco_code code = gen_progress(layout, "ground", 0.8, error);
	if (code)
		return code;
	snprintf(path, sizeof path, "%s/dem.tif", layout->options->folder);
	while (half_m / step_m > 1000)
		step_m *= 2;
	return gen_terrain_write(terrain, ceil(half_m / step_m) * step_m, step_m, path, error);
}

/* ---- Plants that keep their distance: a hash grid of the plants so far ---- */

enum eco_code gen_stand_open(struct gen_stand *stand, uint32_t capacity, double half_m, double room_max,
	struct eco_error *error)
{
	*stand = (struct gen_stand){ .capacity = capacity, .half_m = half_m, .cell_m = room_max };
	while (half_m * 2 / stand->cell_m > 4096)
		stand->cell_m *= 2;
	stand->side = (uint32_t)(2 * half_m / stand->cell_m) + 1;
	stand->plants = malloc(((size_t)capacity + 1) * sizeof *stand->plants);
	stand->cells = malloc((size_t)stand->side * stand->side * sizeof *stand->cells);
	if (!stand->plants || !stand->cells) {
		free(stand->plants);
		free(stand->cells);
		return eco_fail(error, ECO_NO_MEMORY, "generating: no memory for %u plants", capacity);
	}
	memset(stand->cells, 0xFF, (size_t)stand->side * stand->side * sizeof *stand->cells);
	return ECO_OK;
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
