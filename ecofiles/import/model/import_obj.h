/* Wavefront OBJ (import_obj.c) and its libraries of materials, MTL (import_mtl.c). */
#pragma once

#include "ecofiles/import/model/import_model.h"

/* ---- Lines and words of a text in memory, which is cut up in place ---- */

struct eco_obj_text {
	const char *path;
	char *at, *end;              /* *end is 0 */
	uint32_t line;               /* of the line returned last */
	bool blender;                /* wrote it, so its materials' colours are linear */
};
/* Begins behind a byte order mark. */
void eco_obj_text_start(struct eco_obj_text *text, uint8_t *bytes, size_t size);
/* The next line without surrounding spaces; NULL at the end. Lines end with LF, CRLF or CR; if `joins`, a
 * backslash at the end of a line continues it. */
char *eco_obj_line(struct eco_obj_text *text, bool joins);
/* The next word of a line; NULL at its end or at a comment. */
char *eco_obj_word(char **line);
/* Cuts off a line's first word; returns what is behind it. */
char *eco_obj_arguments(char *line);

/* ---- Libraries of materials ---- */

struct eco_mtl_material {
	char *name;
	double rgb[3];
	bool has_color;
	double alpha;                /* 1 is opaque */
	bool has_d;                  /* alpha is from "d", which wins over "Tr" */
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
void eco_mtl_free(struct eco_mtl *mtl);
