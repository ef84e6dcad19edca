/* Shared by the files of the reader of glTF; private. */
#pragma once

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/import/model/import_model.h"

struct gltf_look {               /* the part of a material that geometry needs */
	bool used, invisible;
	bool textured;               /* has a base colour texture: then uv_set and uv matter */
	uint32_t uv_set;
	struct { double offset[2], scale[2], sine, cosine; } uv;
};

#define GLTF_JOINT_SETS 4             /* of four joints each */
enum gltf_attribute { GLTF_POSITION, GLTF_TEXCOORD, GLTF_COLOR, GLTF_JOINTS,
	GLTF_WEIGHTS = GLTF_JOINTS + GLTF_JOINT_SETS,
	GLTF_ATTRIBUTES = GLTF_WEIGHTS + GLTF_JOINT_SETS };

struct gltf_piece {                   /* a primitive */
	struct { bool there; struct eco_gltf_accessor a; } values[GLTF_ATTRIBUTES];
	uint32_t material, triangle_count,
		*index;   /* 3 per triangle, into `source`; ECO_NONE: a missing vertex */
	uint32_t vertex_count, *source;              /* vertices in use, by their numbers in the file */
	double far;                  /* largest coordinate, if the file holds it in single precision */
};

struct gltf_mesh { bool read; uint32_t first, count; uint64_t triangles; };       /* its pieces */

struct gltf_skin { bool read; uint32_t count; double *matrix; };  /* 16 per joint, to the world */

struct gltf_reader {
	struct eco_gltf *doc;
	struct eco_error *error;
	uint32_t triangles_max;
	struct eco_soup soup;
	struct gltf_look *looks;     uint32_t look_count;
	struct gltf_piece *pieces;        uint32_t piece_count, piece_room;
	struct gltf_mesh *meshes;
	struct gltf_skin *skins;          uint32_t skin_count;
	uint64_t read;               /* triangles of all meshes */
	/* things not drawn, or odd, for the notes */
	uint64_t instances, points, lines, shapeless, partial, morphed, faint, weighted;
	/* the primitive being read */
	const json_t *primitive;
	struct gltf_piece *to;
	uint32_t mesh, number;
	struct eco_gltf_accessor indices;
	uint64_t vertex_count, index_count;          /* in the file */
	bool indexed, draco;
};

/* Reads all primitives of a mesh, once. */
enum eco_code gltf_mesh_read(struct gltf_reader *reader, uint32_t mesh);
/* False beyond an attribute's end, where values stay: the exporter made one accessor too short. */
bool gltf_values(const struct gltf_piece *piece, enum gltf_attribute which, uint32_t vertex, double *values);
/* ECO_TOO_LARGE, if it is more than may be. */
enum eco_code gltf_too_many(const struct gltf_reader *reader, uint64_t triangles);
void gltf_piece_free(struct gltf_piece *piece);
