/* How example scenes are laid out, and the ground that they stand on. */
#ifndef ECO_GENERATE_SCENES_H
#define ECO_GENERATE_SCENES_H

#include "ecofiles/generate.h"
#include "ecofiles/generate_mesh.h"

/* ---- Ground: hills from smooth noise, in two sizes ---- */

struct gen_terrain {
	uint64_t seed;
	double hill_m, hill_length_m, bump_m, bump_length_m;
};
double gen_noise(uint64_t seed, double x, double y);                           /* [0, 1], smooth, one bump a unit */
double gen_terrain_height(const struct gen_terrain *terrain, double x, double y);

/* Where the scenes lie: a place in UTM zone 32 north, so that coordinates look like a surveyor's. */
#define GEN_CRS "EPSG:32632"
#define GEN_EASTING 691000.0
#define GEN_NORTHING 5334000.0
#define GEN_ALTITUDE 520.0

/* A square of side 2 half_m around the origin, a sample every step_m; GeoTIFF, heights above sea level to the centimetre. */
enum eco_code gen_terrain_write(const struct gen_terrain *terrain, double half_m, double step_m, const char *path,
	struct eco_error *error);

/* ---- Layouts ---- */

/* Each writes its scene.json last. `plants` is not 0. */
struct gen_layout {
	const struct eco_generate_options *options;
	uint32_t plants;
	struct gen_random random;
};
enum eco_code gen_park(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_forest(struct gen_layout *layout, struct eco_error *error);
enum eco_code gen_meadow(struct gen_layout *layout, struct eco_error *error);

#endif
