/* Parametric plants: random numbers, vectors, a mesh of tubes, leaves and blades that is written as OBJ, and
 * kinds of plants, each a function from random numbers to a mesh of believable proportions.
 *
 * Plants grow along +Z here, in metres, and are written Y-up, as OBJ files are. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "ecofiles/format/model.h"

/* ---- Random numbers (random.h) ---- */

struct gen_random { uint64_t state; };
uint64_t gen_random_bits(struct gen_random *random);
double gen_random_unit(struct gen_random *random);                             /* [0, 1) */
double gen_random_in(struct gen_random *random, double low, double high);
/* A shade below `shades` by the light, 0 to 1, give or take `spread`. */
uint32_t gen_random_shade(struct gen_random *random, double light, double spread, uint32_t shades);

/* ---- Vectors ---- */

struct gen_v3 { double x, y, z; };
struct gen_v3 gen_v3(double x, double y, double z);
struct gen_v3 gen_add(struct gen_v3 a, struct gen_v3 b);
struct gen_v3 gen_sub(struct gen_v3 a, struct gen_v3 b);
struct gen_v3 gen_mul(struct gen_v3 a, double s);
struct gen_v3 gen_mad(struct gen_v3 a, struct gen_v3 b, double s);             /* a + s b */
struct gen_v3 gen_cross(struct gen_v3 a, struct gen_v3 b);
double gen_length(struct gen_v3 a);
/* +Z for a vector of length 0 */
struct gen_v3 gen_unit(struct gen_v3 a);
/* some unit vector at right angles */
struct gen_v3 gen_across(struct gen_v3 a);
struct gen_v3 gen_turned(struct gen_v3 v, struct gen_v3 axis, double degrees); /* about a unit axis */
struct gen_v3 gen_heading(double azimuth_deg, double elevation_deg);           /* unit vector */
/* unit vector, any direction */
struct gen_v3 gen_random_way(struct gen_random *random);
/* The point of a path `at` steps from its first of `count`, and the path's unit direction there. */
struct gen_v3 gen_along(const struct gen_v3 *path, uint32_t count, double at, struct gen_v3 *way);
double gen_clamp(double v, double low, double high);
double gen_smooth(double from, double to, double v);                           /* 0..1, cubic */

/* ---- Meshes ---- */

/* texture: file name beside the OBJ, or NULL */
struct gen_material { char name[32]; uint8_t rgb[3]; const char *texture; };
struct gen_face { uint32_t corner[4]; uint8_t corners, material; };

#define GEN_MATERIALS_MAX 24
struct gen_mesh {
	struct gen_v3 *position;     uint32_t count, capacity;
	float (*uv)[2];              /* one per vertex */
	struct gen_face *faces;      uint32_t face_count, face_capacity;
	struct gen_material materials[GEN_MATERIALS_MAX];
	uint32_t material_count;
	double detail;               /* leaves times this, each as much smaller; 0: 1 */
};
void gen_mesh_free(struct gen_mesh *mesh);

/* rgb, dark, bright: 0xRRGGBB */
uint8_t gen_material(struct gen_mesh *mesh, const char *name, uint32_t rgb, const char *texture);
/* The colour that is part/of of the way from a to b. */
uint32_t gen_mixed(uint32_t a, uint32_t b, uint32_t part, uint32_t of);
/* `count` materials from the dark colour to the bright one, named NAME-0, ...; returns the first. */
uint8_t gen_material_shades(struct gen_mesh *mesh, const char *name, uint32_t dark, uint32_t bright,
	uint32_t count);

/* Parts of other shapes: a vertex, whose number is returned, and a triangle. */
uint32_t gen_vertex(struct gen_mesh *mesh, struct gen_v3 at);
void gen_triangle(struct gen_mesh *mesh, uint8_t material, const uint32_t corner[3]);

/* A closed tube through points; radius 0 at the last point is a tip. */
struct gen_tube { const struct gen_v3 *points; const double *radius; uint32_t count, sides; };
void gen_tube(struct gen_mesh *mesh, uint8_t material, const struct gen_tube *tube);

/* A leaf from `at` along `along`, facing `face`: a card (one textured rectangle), a rhomb, an arched
 * hexagon or a pointed blade. */
enum gen_leaf_shape { GEN_LEAF_CARD, GEN_LEAF_RHOMB, GEN_LEAF_HEXAGON, GEN_LEAF_BLADE };
struct gen_leaf {
	struct gen_v3 at, along, face;
	double length, width;
	double bend;                 /* how far the tip sinks, in lengths (hexagon, blade) */
	/* of a card: quarter of the texture, 0 to 3 from the bottom left, row by row */
	uint32_t cell;
	enum gen_leaf_shape shape;
};
void gen_leaf(struct gen_mesh *mesh, uint8_t material, const struct gen_leaf *leaf);

/* Writes NAME.obj and NAME.mtl into `folder`, each to a temporary file first. */
void gen_mesh_write(const struct gen_mesh *mesh, const char *folder, const char *name, struct eco_error *error);

/* ---- Plants ---- */

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

void gen_texture_write(const char *folder, const char *name, struct eco_error *error);

/* A spray is shown by a card of a library plant: a twig of leaves, or twigs of leaves on a branch, in one plane. Lengths are in
 * leaves. */
#define GEN_SPRAY_SIDE 256u
struct gen_spray {
	uint32_t twigs, leaves;      /* leaves: of a twig; 0: no spray */
	double width, height;        /* of the card */
	double slim, strip;          /* a leaf's width; 0 ovate, 1 as wide at both ends */
	double teeth, lobes, skew;   /* depth of the saw at a leaf's edge, in half widths; their number and lean */
	double uneven;               /* of the leaves' light */
	uint8_t rgb[4][3], wood[3];  /* of the texture's cells: from inside a crown to its top */
};
/* Sets twigs, leaves, width and height for so many leaves or leaflets; of_leaf: leaflets of a leaf, which is a twig. */
void gen_spray_layout(struct gen_spray *spray, uint32_t leaves, uint32_t of_leaf);
/* Four cells of GEN_SPRAY_SIDE / 2 texels a side. The caller frees the image. */
void gen_spray_paint(struct eco_image *image, const struct gen_spray *spray);
