/* One plant of a pack, alone, as the planner draws it with a given budget.
 *
 *   plant_view_open(&view, pack, number, pixels, &error);     decodes lists and textures, sets the camera
 *   plant_view_drawing_make(&drawing, &view, vertices, &error);       the cuts, as triangles, lines, points
 *   plant_view_raster(&raster, &view, &eye, &drawing, false);         draws them
 *   plant_view_drawing_free(&drawing);
 *   plant_view_close(&view);
 *
 * The plant is put into a scene of one tile with one instance, which goes through lod_plan as any scene: a
 * drawing holds what a viewer gets. */
#pragma once

#include "ecofiles/format/model.h"
#include "ecofiles/format/pack.h"
#include "lod/build/plant.h"
#include "lod/geometry.h"
#include "lod/impostor.h"
#include "lod/raster/raster.h"

struct plant_view_list {         /* a list of the plant, decoded */
	const struct eco_list *list;
	const uint8_t (*palette)[3];
	struct eco_elements *chunks; /* as many as the list has */
	uint32_t chunk_count;
	struct lod_impostor *impostors;      /* of a list of kind IMPOSTOR: one a chunk */
	uint32_t image;              /* index of the texture's list, or ECO_NONE */
	struct eco_image picture;    /* of a list of kind IMAGE */
	bool cutout;                 /* the picture has transparent pixels */
	uint8_t organ;
};

struct plant_view {
	const struct eco_pack *pack;
	uint32_t number;
	struct eco_scene scene;      /* the pack's, with this plant alone */
	struct eco_tile tile;
	struct eco_group group;
	struct eco_list *scene_lists;
	uint8_t place[ECO_PLACE_BYTES];
	/* per list of the pack; list NULL: not this plant's */
	struct plant_view_list *lists; uint32_t list_count;
	struct eco_view view; /* from the south, a little from above; the picture just holds the plant */
	struct lod_eye eye;
	uint64_t full;               /* vertices of full detail */
	struct lod_raster raster;    /* pixels x pixels */
	uint8_t *reference;          /* cover of full detail in it */
};

struct plant_view_batch {        /* one cut, as triangles, lines, points or an impostor */
	const struct plant_view_list *list;
	struct lod_geometry geometry;
	const struct lod_impostor *impostor;     /* its cells are the primitives; NULL: none */
	uint32_t count, first;       /* primitives; number of the first in the drawing */
	float area;                  /* points */
};
struct plant_view_drawing {
	struct plant_view_batch *batches;
	uint32_t count, primitives;
	uint64_t vertices;
};

enum eco_code plant_view_open(struct plant_view *view, const struct eco_pack *pack, uint32_t number,
	uint32_t pixels, struct eco_error *error);
void plant_view_close(struct plant_view *view);

/* Plans and gathers the cuts for `vertices`. */
enum eco_code plant_view_drawing_make(struct plant_view_drawing *drawing, const struct plant_view *view,
	uint64_t vertices, struct eco_error *error);
void plant_view_drawing_free(struct plant_view_drawing *drawing);

/* Draws into a raster, which is cleared first. Owners are 1, or with `one_by_one` numbers of primitives
 * from 1 (cells of an impostor: the raster's items, after its first primitive). */
void plant_view_raster(struct lod_raster *raster, const struct plant_view *view, const struct lod_eye *eye,
	const struct plant_view_drawing *drawing, bool one_by_one);

/* Q of a drawing against full detail, in view->raster. */
double plant_view_q(struct plant_view *view, const struct plant_view_drawing *drawing);
