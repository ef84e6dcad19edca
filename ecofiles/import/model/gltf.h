/* A glTF 2.0 document, .glb or .gltf with its files: its JSON, numbers and nodes, checked. import_gltf.c
 * gives it meaning.
 *
 *   eco_gltf_open(&doc, path, &error);
 *   nodes = json_object_get(doc->root, "nodes");
 *   eco_gltf_accessor_open(doc, eco_gltf_index(attributes, "POSITION"), 3, &positions, &error);
 *   eco_gltf_node_matrix(doc, node, world, &error);
 *   eco_gltf_close(doc);
 *
 * assimp 5.2 is not used for glTF: it ignores extensions that files require (quantization, meshopt,
 * instances), and so loses leaves. Run this in the child of guard.h: the code here bounds whatever it
 * allocates, but Draco and meshopt unpack small files to large ones. Numbers are read byte by byte. A
 * buffer is loaded when it is first needed, so unneeded ones may be missing. Not thread-safe. Errors name
 * the file and the item in it. */
#pragma once

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_GLTF_NODES_MAX (1u << 20)            /* nodes visited in a scene */
#define ECO_GLTF_VALUES_MAX ((uint64_t)1 << 28)  /* numbers of one accessor */

/* ---- The document ---- */

struct eco_gltf_bytes {          /* of a buffer, or of an unpacked view */
	const uint8_t *bytes;        /* NULL: not loaded yet */
	size_t size;
	uint8_t *owned;
};

struct eco_gltf {
	char *path;
	json_t *root;                /* an object */
	uint8_t *owned; size_t size; /* the file */
	struct eco_gltf_bytes chunk; /* of a .glb */
	struct eco_gltf_bytes *buffers, *views;
	size_t buffer_count, view_count, node_count;
	uint64_t unpacked;           /* bytes unpacked so far */
	uint64_t coarser;            /* nodes that the last walk left out, as coarser levels of others */
	uint32_t *parent;            /* per node; NULL: not computed yet */
};

/* Errors: no file, not glTF 2.0, cut off, bad JSON (with its line). */
enum eco_code eco_gltf_open(struct eco_gltf **doc, const char *path, struct eco_error *error);
void eco_gltf_close(struct eco_gltf *doc);       /* NULL is fine */

/* [offset, offset + size) of a buffer. */
enum eco_code eco_gltf_buffer_range(struct eco_gltf *doc, uint32_t buffer, uint64_t offset, uint64_t size,
	const uint8_t **bytes, struct eco_error *error);
/* Bytes of a data: URI; malloc'ed. *is_data false: another URI, and nothing else is set. */
enum eco_code eco_gltf_data_uri(const char *uri, bool *is_data, uint8_t **bytes, size_t *size,
	struct eco_error *error);

/* ---- JSON of strangers: a missing or wrong value becomes the default ---- */

/* Item `index` of an array of the root ("nodes", "meshes", ...); NULL if there is none. */
const json_t *eco_gltf_item(const struct eco_gltf *doc, const char *array, uint64_t index);
/* A reference to such an item; ECO_NONE (model.h): absent. */
uint32_t eco_gltf_index(const json_t *object, const char *key);
/* A whole number, even if written as 3.0. UINT64_MAX, which no bound lets pass: present, but not a whole
 * number. */
uint64_t eco_gltf_whole(const json_t *object, const char *key, uint64_t otherwise);
double eco_gltf_number(const json_t *object, const char *key, double otherwise);
/* Up to `count` numbers of an array; missing ones keep their values. False if the member is anything else. */
bool eco_gltf_numbers(const json_t *object, const char *key, double *values, size_t count);
const json_t *eco_gltf_extension(const json_t *object, const char *name);
/* A text; never NULL. */
const char *eco_gltf_text(const json_t *object, const char *key);

/* ---- Numbers (gltf_accessor.c) ---- */

/* An accessor, resolved: component types, normalized integers, strides, sparse substitution, meshopt
 * compression. */
struct eco_gltf_accessor {
	const uint8_t *bytes;            /* of element 0; NULL: all elements are 0 */
	uint8_t *owned;
	uint64_t count;
	size_t stride;
	uint32_t components, type;       /* glTF's component type, 5120 to 5126 */
	double divisor;                  /* of normalized integers; else 0 */
};

/* `components` is 1 to 4 or 16, or 0 for any. Bytes live until close, or until the document is closed. */
enum eco_code eco_gltf_accessor_open(struct eco_gltf *doc, uint32_t accessor, uint32_t components,
	struct eco_gltf_accessor *a, struct eco_error *error);
void eco_gltf_accessor_close(struct eco_gltf_accessor *a);
/* Element i < count as numbers; normalized integers as fractions. */
void eco_gltf_element(const struct eco_gltf_accessor *a, uint64_t i, double *values);
/* Component 0 of element i as a whole number; ECO_NONE: not a whole number. */
uint32_t eco_gltf_element_index(const struct eco_gltf_accessor *a, uint64_t i);

/* Bytes of a buffer view, decompressed; live as long as the document. */
enum eco_code eco_gltf_view(struct eco_gltf *doc, uint32_t view, const uint8_t **bytes, size_t *size,
	struct eco_error *error);

/* ---- Nodes: matrices are 4 x 4, column by column, as in glTF: Y up ---- */

/* To the world: the product over its ancestors. Cycles are errors. */
enum eco_code eco_gltf_node_matrix(struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error);
/* a * b; out may be either */
void eco_gltf_multiply(double out[16], const double a[16], const double b[16]);
/* Translation, rotation (a quaternion, normalized here) and scale as a matrix. */
void eco_gltf_compose(double out[16], const double translation[3], const double rotation[4],
	const double scale[3]);
void eco_gltf_apply(const double matrix[16], const double point[3], double out[3]);

/* The scene that a viewer shows: the default one, or the first if the file names none; NULL: it is not
 * there. */
const json_t *eco_gltf_scene(const struct eco_gltf *doc);
/* Calls visit(ctx, node, world) for each node of that scene, or below all roots if there is none, parents
 * first. Hidden nodes (KHR_node_visibility) are skipped with everything below. A node below several
 * parents is visited for each. Stops at the first status other than ECO_OK. */
typedef enum eco_code eco_gltf_visit(void *ctx, uint32_t node, const double world[16]);
enum eco_code eco_gltf_walk(struct eco_gltf *doc, eco_gltf_visit *visit, void *ctx, struct eco_error *error);
