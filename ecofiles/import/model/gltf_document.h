/* Inside glTF reading: what its files share. Not for others. */
#ifndef ECO_GLTF_DOCUMENT_H
#define ECO_GLTF_DOCUMENT_H

#include "ecofiles/import/model/gltf.h"

#define ECO_GLTF_FILE_MAX ((uint64_t)1 << 32)
#define ECO_GLTF_JSON_MAX ((size_t)256 << 20)
#define ECO_GLTF_UNPACKED_MAX ((uint64_t)1 << 32)    /* bytes of all compressed views together */

struct gltf_bytes {              /* of a buffer, or of a compressed view once it is unpacked */
	const uint8_t *bytes;        /* NULL: not asked for yet */
	size_t size;
	uint8_t *owned;
};

struct eco_gltf {
	char *path;
	uint8_t *owned;              /* the file, unless it is the caller's */
	json_t *root;
	struct gltf_bytes chunk;     /* of a .glb */
	struct gltf_bytes *buffers, *views;
	size_t buffer_count, view_count, node_count;
	uint64_t unpacked;           /* bytes so far */
	uint32_t *parent;            /* per node; NULL: not known yet */
};

/* [offset, offset + size) of a buffer. */
enum eco_code gltf_buffer_range(struct eco_gltf *doc, uint32_t buffer, uint64_t offset, uint64_t size, const uint8_t **bytes,
	struct eco_error *error);

/* The meshopt extension of a view; NULL: it is not compressed. */
const json_t *gltf_meshopt_extension(const json_t *view);
/* Unpacks view `index`; *to then owns its bytes. */
enum eco_code gltf_meshopt_unpack(struct eco_gltf *doc, uint32_t index, const json_t *extension, struct gltf_bytes *to,
	struct eco_error *error);

#endif
