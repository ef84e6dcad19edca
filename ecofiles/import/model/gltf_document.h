/* Shared by the files of the glTF reader; private. */
#ifndef ECO_GLTF_DOCUMENT_H
#define ECO_GLTF_DOCUMENT_H

#include "ecofiles/import/model/gltf.h"

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

#endif
