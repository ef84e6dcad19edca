/* Parametric plants: each kind is a function from random numbers to a mesh with believable proportions, in metres. */
#ifndef ECO_GENERATE_PLANTS_H
#define ECO_GENERATE_PLANTS_H

#include "ecofiles/generate/generate_mesh.h"

struct gen_plant {
	const char *name;            /* of the model's files */
	const char *texture;         /* file that gen_texture_write paints, or NULL */
	void (*grow)(struct gen_mesh *mesh, struct gen_random *random);
};

extern const struct gen_plant gen_plants[];
extern const uint32_t gen_plant_count;
const struct gen_plant *gen_plant_find(const char *name);                      /* NULL if there is none */

/* Woody skeletons (generate_tree.c). A crown is a union of lobes; shoots grow from the nearest older wood to points in them, and the
 * wood is as thick as the shoots that it carries (da Vinci: cross-sections add up). */
struct gen_crown {
	double height, base, radius;         /* m: top, lowest leaves, greatest half width */
	double trunk_radius, lean;           /* m at the foot; sideways metres at the top */
	uint32_t lobes, shoots;
	double cone;                         /* 0 round, 1 a cone */
};
struct gen_shoot { struct gen_v3 at, along; double light; };                   /* light: 0 deep inside, 1 outermost */
/* Adds the wood to the mesh; writes `shoots` ends. */
void gen_tree(struct gen_mesh *mesh, uint8_t bark, const struct gen_crown *crown, struct gen_random *random,
	struct gen_shoot *shoots);

/* Fronds of palms and ferns: a midrib with leaflets on both sides, sinking to its tip. */
struct gen_frond {
	struct gen_v3 at;
	double azimuth_deg, elevation_deg, sink_deg;   /* direction at the foot; how much it turns down to the tip */
	double length, leaflet, width;
	uint32_t pairs;
	uint8_t rib, leaf, shades;           /* materials */
	double rib_radius;
	enum gen_leaf_shape shape;
};
void gen_frond(struct gen_mesh *mesh, const struct gen_frond *frond, struct gen_random *random);

/* ---- Textures (generate_texture.c) ---- */

enum eco_code gen_texture_write(const char *folder, const char *name, struct eco_error *error);

#endif
