/* Inside `ecopack sheet`: one plant of a pack, alone, as the planner draws it with a given budget.
 *
 *   sheet_plant_open(&plant, pack, number, pixels, &error);    decodes lists and textures, sets the view
 *   sheet_plant_draw(&plant, vertices, &picture, &error);      planned, drawn with light and textures, scored
 *   sheet_plant_close(&plant);
 *
 * The plant is put into a scene of one tile with one instance, which goes through lod_plan as any scene:
 * so a cell of the sheet shows what a viewer gets. */
#ifndef ECO_MAIN_SHEET_H
#define ECO_MAIN_SHEET_H

#include "ecofiles/format/model.h"
#include "ecofiles/format/pack.h"
#include "lod/build/plant.h"
#include "lod/geometry.h"
#include "lod/impostor.h"
#include "lod/raster/raster.h"

#define SHEET_SAMPLES 3u         /* samples a pixel and axis */

struct sheet_list {              /* a list of the plant, decoded */
	const struct eco_list *list;
	const uint8_t (*palette)[3];
	struct eco_elements *chunks; /* as many as the list has */
	uint32_t chunk_count;
	struct lod_impostor *impostors;      /* of a list of kind IMPOSTOR: one a chunk */
	uint32_t image;              /* index of the texture's sheet_list, or ECO_NONE */
	struct eco_image picture;    /* of a list of kind IMAGE */
	bool cutout;                 /* the picture has transparent pixels */
	uint8_t organ;
};

struct sheet_plant {
	const struct eco_pack *pack;
	uint32_t number;
	struct eco_scene scene;      /* the pack's, with this plant alone */
	struct eco_tile tile;
	struct eco_group group;
	struct eco_list *scene_lists;
	uint8_t place[ECO_PLACE_BYTES];
	/* per list of the pack; list NULL: not this plant's */
	struct sheet_list *lists; uint32_t list_count;
	struct eco_view view;
	struct lod_eye eye, fine_eye;
	double metres_a_pixel;       /* at the plant's middle */
	uint64_t full;               /* vertices of full detail */
	struct lod_raster fine, coarse;
	uint8_t *reference;          /* mask of full detail, pixels x pixels */
};

enum sheet_colors { SHEET_NATURAL, SHEET_ORGANS };
extern const uint8_t sheet_organ_rgb[ECO_ORGAN_COUNT][3];

struct sheet_picture {
	uint8_t *rgb;                /* the caller's, pixels x pixels x 3 */
	uint64_t vertices;           /* drawn */
	double q;                    /* against full detail, in this view and size */
};

enum eco_code sheet_plant_open(struct sheet_plant *plant, const struct eco_pack *pack, uint32_t number,
	uint32_t pixels, struct eco_error *error);
void sheet_plant_close(struct sheet_plant *plant);
enum eco_code sheet_plant_draw(struct sheet_plant *plant, uint64_t vertices, enum sheet_colors colors,
	struct sheet_picture *picture, struct eco_error *error);

/* ---- Shared by its two files ---- */

struct sheet_batch {             /* one cut, as triangles, lines, points or an impostor */
	const struct sheet_list *list;
	struct lod_geometry geometry;
	const struct lod_impostor *impostor;     /* its cells are the primitives; NULL: none */
	uint32_t count, first;       /* primitives; number of the first in the drawing */
	float area;                  /* points */
};
struct sheet_drawing { struct sheet_batch *batches; uint32_t count, primitives; uint64_t vertices; };

/* Plans and gathers the cuts for `vertices`. */
enum eco_code sheet_drawing_make(struct sheet_drawing *drawing, const struct sheet_plant *plant,
	uint64_t vertices, struct eco_error *error);
void sheet_drawing_free(struct sheet_drawing *drawing);

#endif
