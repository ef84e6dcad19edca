/* Parametric plants: each kind is a function from random numbers to a mesh of believable proportions, in
 * metres. */
#ifndef ECO_GENERATE_PLANTS_H
#define ECO_GENERATE_PLANTS_H

#include "ecofiles/generate/generate_mesh.h"

struct gen_plant {
	const char *name;            /* of the model's files */
	const char *texture;         /* file that gen_texture_write paints, or NULL */
	void (*grow)(struct gen_mesh *mesh, const void *kind, struct gen_random *random);
	const void *kind;            /* what `grow` tells from others that it grows, or NULL */
	bool flowers;
};

extern const struct gen_plant gen_plants[];
extern const uint32_t gen_plant_count;
const struct gen_plant *gen_plant_find(const char *name);                      /* NULL: no such plant */

/* Woody skeletons (generate_tree.c). A crown is a union of lobes. Shoots grow from the nearest older wood to
 * points in the lobes; the wood's cross-section is the sum of those of the shoots it carries (da Vinci). */
struct gen_crown {
	double height, base, radius;         /* m: top, lowest leaves, greatest half width */
	double trunk_radius, lean;           /* m at the foot; sideways metres at the top */
	uint32_t lobes, shoots;
	double cone;                         /* 0 round, 1 a cone */
};
/* light: 0 deep inside, 1 outermost */
struct gen_shoot { struct gen_v3 at, along; double light; };
/* Adds the wood to the mesh; writes the `shoots` ends of the shoots. */
void gen_tree(struct gen_mesh *mesh, uint8_t bark, const struct gen_crown *crown, struct gen_random *random,
	struct gen_shoot *shoots);

/* Fronds of palms and ferns: a midrib with leaflets on both sides, bending down to its tip. */
struct gen_frond {
	struct gen_v3 at;
	double azimuth_deg, elevation_deg, sink_deg;   /* direction at the foot; bend to the tip */
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
