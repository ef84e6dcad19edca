/* The geometry of a cut in memory, for drawing in software: made once, shared by all plants that draw it; and
 * how a primitive of it looks at a pixel where it is nearest. */
#pragma once

#include "client-min/view_select.h"
#include "lod/geometry.h"
#include "lod/raster/raster.h"

struct view_mesh {                       /* owns its geometry; zero is empty */
	const struct view_list *list, *image;    /* image: NULL if there is no texture */
	struct lod_raster_batch batch;
	struct lod_geometry geometry;
	const struct lod_impostor *impostor;     /* NULL: none; its cells are primitives */
	float center[3], radius;         /* of all that is drawn, object space */
	float half_width;                /* of the plant; 0: a summary's */
	float tone;                      /* deviation of leaves' own light, if batch.leaf says that there are any */
	bool by_point;                   /* a summary: each point has its own owner ... */
	unsigned halvings;               /* ... and is 2^halvings primitives */
};

/* `plant` is whose the cut is; NULL: a summary's. view_mesh_free frees all that was made so far. */
enum eco_code view_mesh_make(struct view_mesh *mesh, const struct view_store *store,
	const struct eco_cut *cut, const struct view_plant *plant, struct eco_error *error);
void view_mesh_free(struct view_mesh *mesh);
/* Draws leaves on splats and points from now on. */
void view_mesh_add_leaves(struct view_mesh *mesh, const struct eco_plant *plant);
/* How far a line or a point reaches from its corners; of a splat, its longest half axis. */
float view_mesh_reach(const struct view_mesh *mesh, uint32_t primitive);

/* The eye, and rays through a pixel's centre, one pixel to the right and one down: object space. */
struct view_rays { double eye[3], ray[3][3]; };
/* Own colour and surface (view_light.h) of a primitive. `rays` is read only if the mesh has an image, splats
 * or leaves; leaf: lod_raster.leaf. */
void view_mesh_look(const struct view_mesh *mesh, uint32_t primitive, const struct view_rays *rays,
	uint32_t leaf, uint8_t rgb[3], uint32_t *surface);
/* Gives its own colour an instance's tint (lod/tint.h), which wood does not take. */
void view_mesh_tint(const struct view_mesh *mesh, uint32_t primitive, uint32_t tint, uint8_t rgb[3]);
