/* Shared by the files of the reader of glTF; private. */
#ifndef ECO_IMPORT_GLTF_H
#define ECO_IMPORT_GLTF_H

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/import/model/import_model.h"

/* ---- The document (gltf.c) ---- */

#define ECO_GLTF_FILE_MAX ((uint64_t)1 << 32)
#define ECO_GLTF_JSON_MAX ((size_t)256 << 20)
#define ECO_GLTF_UNPACKED_MAX ((uint64_t)1 << 32)    /* bytes of all compressed views together */

struct gltf_bytes {              /* of a buffer, or of an unpacked view */
	const uint8_t *bytes;        /* NULL: not loaded yet */
	size_t size;
	uint8_t *owned;
};

struct eco_gltf {
	char *path;
	uint8_t *owned;              /* the file; NULL: the caller owns it */
	json_t *root;
	struct gltf_bytes chunk;     /* of a .glb */
	struct gltf_bytes *buffers, *views;
	size_t buffer_count, view_count, node_count;
	uint64_t unpacked;           /* bytes unpacked so far */
	uint32_t *parent;            /* per node; NULL: not computed yet */
};

/* [offset, offset + size) of a buffer. */
enum eco_code gltf_buffer_range(struct eco_gltf *doc, uint32_t buffer, uint64_t offset, uint64_t size,
	const uint8_t **bytes, struct eco_error *error);

/* The meshopt extension of a view; NULL: not compressed. */
const json_t *gltf_meshopt_extension(const json_t *view);
/* Unpacks view `index`; *to then owns its bytes. */
enum eco_code gltf_meshopt_unpack(struct eco_gltf *doc, uint32_t index, const json_t *extension,
	struct gltf_bytes *to, struct eco_error *error);

/* ---- Materials (import_gltf_material.c) ---- */

struct gltf_look {               /* the part of a material that geometry needs */
	bool used, invisible;
	bool textured;               /* has a base colour texture: then uv_set and uv matter */
	uint32_t uv_set;
	struct { double offset[2], scale[2], sine, cosine; } uv;
};

/* Reads all materials; malloc'ed. Item `count` stands for primitives without a material. */
struct gltf_look *gltf_looks_read(const struct eco_gltf *doc, uint32_t *count);
void gltf_look_apply(const struct gltf_look *look, const double from[2], float to[2]);

/* Fills model->materials, and the images of materials used and visible. */
void gltf_materials_read(struct eco_model *model, struct eco_gltf *doc, const struct gltf_look *looks,
	uint32_t count, struct eco_notes *notes);

/* ---- Surfaces (import_gltf_surface.c) ---- */

#define GLTF_INFLUENCES_MAX 16u

/* a primitive: triangles in its mesh's own coordinates, only the vertices in use */
struct gltf_surface {
	uint32_t vertex_count, triangle_count, material;
	float *position;             /* 3 per vertex */
	float *uv;                   /* 2 per vertex; NULL: none */
	float *color;                /* 3 per vertex, linear; NULL: none */
	uint32_t *index;             /* 3 per triangle; ECO_NONE: a missing vertex */
	uint32_t influences;         /* joints per vertex; 0: not skinned */
	uint32_t *joint;             /* `influences` per vertex */
	float *weight;
	double far;                  /* largest coordinate, which the file holds in single precision */
};

struct gltf_counts {             /* things not drawn, for the notes */
	uint64_t points, lines, shapeless, partial, morphed, faint;
};

struct gltf_surface_source {
	struct eco_gltf *doc;
	const struct gltf_look *looks;       uint32_t look_count;
	const json_t *primitive;
	bool morphed;                        /* morph targets have weights at rest, which are not applied */
	uint32_t mesh, number;               /* number of the primitive in the mesh, for messages */
	uint32_t triangles_max;
	struct gltf_counts *counts;
};

/* Reads one primitive; no triangles if it consists of points or lines. */
enum eco_code gltf_surface_read(struct gltf_surface *surface, const struct gltf_surface_source *source,
	struct eco_error *error);
void gltf_surface_free(struct gltf_surface *surface);

/* ---- Skins at rest ---- */

struct gltf_skin {
	uint32_t count;
	double *matrix;              /* 16 per joint, to the world; NULL: not read */
};
enum eco_code gltf_skin_read(struct gltf_skin *skin, struct eco_gltf *doc, uint32_t index,
	struct eco_error *error);
/* Vertex `v` in the world; false: no joint holds it. */
bool gltf_skin_place(const struct gltf_skin *skin, const struct gltf_surface *surface, uint32_t v,
	double out[3]);

#endif
