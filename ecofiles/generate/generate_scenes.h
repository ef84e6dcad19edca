/* Layouts of example scenes, and what they share. */
#pragma once

#include <stdio.h>

#include "ecofiles/generate/generate.h"
#include "ecofiles/generate/generate_plants.h"

/* ---- Ground: hills from smooth noise, in two sizes ---- */

struct gen_terrain {
	uint64_t seed;
	double hill_m, hill_length_m, bump_m, bump_length_m;
};
/* [0, 1], smooth, one bump a unit */
double gen_noise(uint64_t seed, double x, double y);

/* The scenes' place: UTM zone 32 north, so that coordinates look like a surveyor's. */
#define GEN_CRS "EPSG:32632"
#define GEN_EASTING 691000.0
#define GEN_NORTHING 5334000.0
#define GEN_ALTITUDE 520.0

/* ---- Layouts ---- */

/* Each writes its scene.json last. Errors stop (memory.h). */
struct gen_layout {
	const struct eco_generate_options *options;
	uint32_t plants;             /* low 32 bits of those asked for; not 0 */
	struct gen_random random;
	struct eco_error *error;
	char *bytes; size_t size;    /* of the file that is open */
};
void gen_park(struct gen_layout *layout);
void gen_forest(struct gen_layout *layout);
void gen_meadow(struct gen_layout *layout);
void gen_grove(struct gen_layout *layout);
void gen_palms(struct gen_layout *layout);
void gen_sunflowers(struct gen_layout *layout);
void gen_outdoor(struct gen_layout *layout);
void gen_billion(struct gen_layout *layout);
void gen_city(struct gen_layout *layout);

/* ---- Shared by layouts (generate_layout.c) ---- */

void gen_progress(struct gen_layout *layout, const char *stage, double share);

/* Print to what gen_open returns; the file appears in the scene's folder when it is whole. One file at a time. */
FILE *gen_open(struct gen_layout *layout);
void gen_close(struct gen_layout *layout, FILE *out, const char *name);

/* A camera's key frame. Eye and target in metres above the ground below them. */
struct gen_look { double time_s, eye[3], target[3], fov_deg; };
/* Models with textures (`names` ends with NULL); dem.tif: a square of side 2 half_m around the origin with a
 * sample every step_m, or coarser; camera.json. */
struct gen_setting {
	const char *const *names;
	const struct gen_terrain *terrain;
	double half_m, step_m;
	const struct gen_look *looks; uint32_t look_count;
};
void gen_write_setting(struct gen_layout *layout, const struct gen_setting *setting);

void gen_print_head(FILE *out, const char *name, uint32_t tile_instances);
void gen_print_plants(FILE *out, const char *const names[]);
/* A whole scene.json whose plants stand in plants.csv (plant, easting, northing, height_m). */
void gen_write_listed(struct gen_layout *layout, const char *name, uint32_t tile_instances,
	const char *const names[]);

/* Plants that keep their distance: a hash grid of the plants so far, `half_m` around the origin. */
struct gen_stand {
	struct standing { float x, y, room; uint32_t next; } *plants;
	uint32_t count, capacity, *cells, side;
	double cell_m, half_m;
};
void gen_stand_open(struct gen_stand *stand, uint32_t capacity, double half_m, double room_max);
void gen_stand_close(struct gen_stand *stand);
/* Adds the plant and returns true if no other is nearer than the mean of both rooms. */
bool gen_stand_add(struct gen_stand *stand, double x, double y, double room);
