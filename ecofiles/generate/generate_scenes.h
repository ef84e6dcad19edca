/* Layouts of example scenes, and their ground. */
#ifndef ECO_GENERATE_SCENES_H
#define ECO_GENERATE_SCENES_H

#include <stdio.h>

#include "ecofiles/generate/generate.h"
#include "ecofiles/generate/generate_mesh.h"

/* ---- Ground: hills from smooth noise, in two sizes ---- */

struct gen_terrain {
	uint64_t seed;
	double hill_m, hill_length_m, bump_m, bump_length_m;
};
/* [0, 1], smooth, one bump a unit */
double gen_noise(uint64_t seed, double x, double y);
double gen_terrain_height(const struct gen_terrain *terrain, double x, double y);

/* The scenes' place: UTM zone 32 north, so that coordinates look like a surveyor's. */
#define GEN_CRS "EPSG:32632"
#define GEN_EPSG 32632
#define GEN_EASTING 691000.0
#define GEN_NORTHING 5334000.0
#define GEN_ALTITUDE 520.0

/* A square of side 2 half_m around the origin, a sample every step_m; GeoTIFF, heights above sea level to
 * the centimetre. */
enum eco_code gen_terrain_write(const struct gen_terrain *terrain, double half_m, double step_m,
	const char *path, struct eco_error *error);

/* ---- Layouts ---- */

/* Each writes its scene.json last. `plants` is not 0. */
struct gen_layout {
	const struct eco_generate_options *options;
	uint32_t plants;             /* low 32 bits of those asked for */
	struct gen_random random;
};
enum eco_code gen_progress(const struct gen_layout *layout, const char *stage, double share,
	struct eco_error *error);

/* ---- Shared by layouts (generate_layout.c) ---- */

/* Print to `out`; the file appears in the scene's folder when it is whole. A caller that does not write it
 * closes `out` and frees `bytes`. */
struct gen_text { FILE *out; char *bytes; size_t size; };
enum eco_code gen_text_open(struct gen_text *text, struct eco_error *error);
enum eco_code gen_text_write(struct gen_text *text, const struct gen_layout *layout, const char *name,
	struct eco_error *error);

/* Models with textures; `names` ends with NULL. */
enum eco_code gen_write_models(const struct gen_layout *layout, const char *const names[],
	struct eco_error *error);
void gen_print_head(FILE *out, const char *name, uint32_t tile_instances);
void gen_print_plants(FILE *out, const char *const names[]);
/* A whole scene.json whose plants stand in plants.csv (plant, easting, northing, height_m). */
void gen_print_listed(FILE *out, const char *name, uint32_t tile_instances, const char *const names[]);

/* A camera script. Eye and target in metres above the ground below them. */
struct gen_look { double time_s, eye[3], target[3], fov_deg; };
enum eco_code gen_write_camera(const struct gen_layout *layout, const struct gen_terrain *terrain,
	const struct gen_look *looks, uint32_t count, struct eco_error *error);
enum eco_code gen_write_ground(const struct gen_layout *layout, const struct gen_terrain *terrain,
	double half_m, double step_m, struct eco_error *error);

/* Plants that keep their distance: a hash grid of the plants so far, `half_m` around the origin. */
struct gen_stand {
	struct standing { float x, y, room; uint32_t next; } *plants;
	uint32_t count, capacity, *cells, side;
	double cell_m, half_m;
};
enum eco_code gen_stand_open(struct gen_stand *stand, uint32_t capacity, double half_m, double room_max,
	struct eco_error *error);
void gen_stand_close(struct gen_stand *stand);
/* Adds the plant and returns true if no other is nearer than the mean of both rooms. */
bool gen_stand_add(struct gen_stand *stand, double x, double y, double room);

/* ---- Layouts ---- */

enum eco_code gen_park(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_forest(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_meadow(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_grove(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_palms(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_sunflowers(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_outdoor(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_billion(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_city(struct gen_layout *layout, struct eco_error *error);

#endif
