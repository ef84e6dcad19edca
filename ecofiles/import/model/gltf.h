/* A glTF 2.0 document, .glb or .gltf with its files: its JSON, numbers and nodes, checked. Its users give
 * it meaning: models (import_gltf.c).
 *
 *   eco_gltf_open(&doc, path, &error);
 *   nodes = json_object_get(eco_gltf_json(doc), "nodes");
 *   eco_gltf_accessor_open(doc, eco_gltf_index(attributes, "POSITION"), 3, &positions, &error);
 *   eco_gltf_node_matrix(doc, node, world, &error);
 *   eco_gltf_close(doc);
 *
 * assimp 5.2 is not used for glTF: it ignores extensions that files require (quantization, meshopt,
 * instances), and so loses leaves. Run this in the child of guard.h: the code here bounds whatever it
 * allocates, but Draco and meshopt unpack small files to large ones. Numbers are read byte by byte. A
 * buffer is loaded when it is first needed, so unneeded ones may be missing. Not thread-safe. Errors name
 * the file and the item in it. */
#ifndef ECO_GLTF_H
#define ECO_GLTF_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_GLTF_NODES_MAX (1u << 20)            /* nodes visited in a scene */
#define ECO_GLTF_VALUES_MAX ((uint64_t)1 << 28)  /* numbers of one accessor */

struct eco_gltf;

/* ---- The document ---- */

/* Errors: no file, not glTF 2.0, cut off, bad JSON (with its line). */
enum eco_code eco_gltf_open(struct eco_gltf **doc, const char *path, struct eco_error *error);
/* The same from memory, which must outlive the document; other files are looked for beside `name`. */
enum eco_code eco_gltf_open_memory(struct eco_gltf **doc, const char *name, const uint8_t *bytes, size_t size,
	struct eco_error *error);
void eco_gltf_close(struct eco_gltf *doc);       /* NULL is fine */

const json_t *eco_gltf_json(const struct eco_gltf *doc);     /* an object; owned by the document */
const char *eco_gltf_path(const struct eco_gltf *doc);

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

/* ---- Numbers ---- */

/* Any accessor, resolved: component types, normalized integers, strides, sparse substitution, meshopt
 * compression. */
struct eco_gltf_accessor {
	const uint8_t *bytes;            /* of element 0; NULL: all elements are 0 */
	uint8_t *owned;
	uint64_t count;
	/* bytes from element to element, and from column to column of a matrix */
	size_t stride, column_bytes;
	uint32_t components, rows;       /* rows of a matrix, else as components */
	uint32_t type;                   /* glTF's component type, 5120 to 5126 (and 5130, double) */
	bool normalized;
};

/* `components` is 1 to 4, 9 or 16, or 0 for any. Bytes live until close, or until the document is closed. */
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
/* Bytes of a data: URI; malloc'ed. *is_data false: another URI, and nothing else is set. */
enum eco_code eco_gltf_data_uri(const char *uri, bool *is_data, uint8_t **bytes, size_t *size,
	struct eco_error *error);

/* ---- Nodes: matrices are 4 x 4, column by column, as in glTF: Y up ---- */

enum eco_code eco_gltf_node_local(const struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error);
/* To the world: the product over its ancestors. Cycles are errors. */
enum eco_code eco_gltf_node_matrix(struct eco_gltf *doc, uint32_t node, double matrix[16],
	struct eco_error *error);
/* a * b; out may be either */
void eco_gltf_multiply(double out[16], const double a[16], const double b[16]);
/* Translation, rotation (a quaternion, normalized here) and scale as a matrix. */
void eco_gltf_compose(double out[16], const double translation[3], const double rotation[4],
	const double scale[3]);
void eco_gltf_apply(const double matrix[16], const double point[3], double out[3]);

/* Whether the scene that a viewer shows exists: the default one, or the first if the file names none. */
bool eco_gltf_has_scene(const struct eco_gltf *doc);
/* Calls visit(ctx, node, world) for each node of that scene, or below all roots if there is none, parents
 * first. Hidden nodes (KHR_node_visibility) are skipped with everything below. A node below several
 * parents is visited for each. Stops at the first status other than ECO_OK. */
typedef enum eco_code eco_gltf_visit(void *ctx, uint32_t node, const double world[16]);
enum eco_code eco_gltf_walk(struct eco_gltf *doc, eco_gltf_visit *visit, void *ctx, struct eco_error *error);

/* The instances of a node with EXT_mesh_gpu_instancing. */
struct eco_gltf_instances {
	uint64_t count;
	struct eco_gltf_accessor translation, rotation, scale;       /* count 0: absent */
};
/* *there is false, and nothing else set, if the node does not have the extension. */
enum eco_code eco_gltf_instances_open(struct eco_gltf *doc, uint32_t node, bool *there,
	struct eco_gltf_instances *instances, struct eco_error *error);
void eco_gltf_instances_close(struct eco_gltf_instances *instances);
/* World matrix of instance i of a node whose world matrix is `world`. */
void eco_gltf_instance_matrix(const struct eco_gltf_instances *instances, uint64_t i, const double world[16],
	double out[16]);

#endif
