/* Wavefront OBJ and MTL: shared by the two readers. */
#ifndef ECO_IMPORT_OBJ_H
#define ECO_IMPORT_OBJ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_model.h"

/* ---- Lines and words of a text in memory, which is cut up in place ---- */

struct eco_obj_text {
	const char *path;
	char *at, *end;              /* *end is 0 */
	uint32_t line;               /* of the line returned last */
};

/* ---- Libraries of materials ---- */

struct eco_mtl_material {
	char *name;
	double rgb[3];
	bool has_color, has_d, has_tr;
	double d, tr;
	char *texture, *opacity;     /* as written; NULL: none */
	double uv_scale[2], uv_offset[2];    /* of the texture: -s, -o */
};

struct eco_mtl {                 /* of one or several libraries; owns everything */
	struct eco_mtl_material *items;
	uint32_t count;
	bool linear;                 /* Blender wrote one of them, so colours are linear */
};

/* Appends a library's materials; skips lines that it does not understand. */
enum eco_code eco_mtl_read(struct eco_mtl *mtl, const char *path, struct eco_error *error);
/* For each name: the last material of that name, else the last that differs only in case, else NULL. */
void eco_mtl_find(const struct eco_mtl *mtl, char *const *names, uint32_t count,
	const struct eco_mtl_material **found);
/* 1 is opaque. */
double eco_mtl_alpha(const struct eco_mtl_material *material);
void eco_mtl_free(struct eco_mtl *mtl);

/* ---- An OBJ file's content ---- */

struct eco_obj_corner { uint32_t v, vt; };   /* ECO_NONE: not given, or missing */
struct eco_obj_face { uint32_t first, material, part; };     /* its corners end where the next face begins */

struct eco_obj {
	struct eco_obj_text text;
	struct eco_error *error;
	struct eco_notes *notes;
	double (*place)[3];          uint32_t place_count, place_room;
	float (*color)[3];
	uint32_t color_count, color_room; /* of the first vertices; r < 0: none */
	float (*uv)[2];              uint32_t uv_count, uv_room;
	struct eco_obj_corner *corners;      uint32_t corner_count, corner_room;
	struct eco_obj_face *faces;  uint32_t face_count, face_room;
	struct eco_string_pool materials, parts, libraries;
	uint32_t material, part, triangles_max;
	uint64_t triangles, loose;
	char object[256], group[256];
	double unit_m;               /* from a comment; 0: none */
	bool linear;                 /* Blender wrote it, so its materials' colours are linear */
};

/* Makes a soup: materials from the libraries, polygons split, vertices shared where position and texture
 * coordinate are equal, missing ones counted. Fills the frame. */
enum eco_code eco_obj_soup(struct eco_model *model, struct eco_model_frame *frame, const struct eco_obj *obj);

#endif
