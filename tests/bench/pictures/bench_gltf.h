/* The plants of a view, or one of each kind, as glTF at full detail, as a tile server without levels would
 * send them; and what gltfpack 0.18 makes of that, read again.
 *
 *   bench_gltf_buffer(&full, "F", &error);                              once for all files in F
 *   bench_gltf_view(&full, &eye, "F/view.gltf", &plants, &error);       a node for each plant in sight
 *   bench_gltf_kinds(&full, "F/kinds.gltf", &error);                    a node for each kind
 *   ... gltfpack -i F/kinds.gltf -o F/kinds.glb -kn -km ...
 *   bench_gltf_read(&read, &full, "F/kinds.glb", &error);
 *   bench_gltf_pack(&full, &read, "F/kinds.eco", &error);
 *
 * A mesh for each kind of plant, a primitive for each of its textures. Colours are the vertices': gltfpack
 * writes all instances anew for each material. There are no normals: that is less for the peers to send,
 * and flat shading is what our pictures have. gltfpack gathers nodes that share a mesh as instances. */
#ifndef TESTS_BENCH_GLTF_H
#define TESTS_BENCH_GLTF_H

#include "tests/bench/pictures/bench_full.h"

/* FOLDER/plants.bin, all meshes, and the textures' last levels as the pack has them; gltfpack copies them. */
enum eco_code bench_gltf_buffer(const struct bench_full *full, const char *folder, struct eco_error *error);
/* The plants whose bounds meet the view. *outlines: bytes of their textures' outlines, which are in no file.
 * *plants: their number; 0: nothing is written. */
enum eco_code bench_gltf_view(const struct bench_full *full, const struct lod_eye *eye, const char *path,
	uint64_t *plants, uint64_t *outlines, struct eco_error *error);
/* Each kind once, at the origin; nodes and materials are named for bench_gltf_read. */
enum eco_code bench_gltf_kinds(const struct bench_full *full, const char *path, struct eco_error *error);
/* The ground's tiles in sight at full detail, as one mesh: PATH.gltf and PATH.bin. *any false: there is none,
 * and nothing is written. */
enum eco_code bench_gltf_ground(const struct bench_full *full, const struct lod_eye *eye, const char *path,
	bool *any, struct eco_error *error);

/* What gltfpack made of bench_gltf_kinds with -kn -km: meshes alone, to be freed by bench_full_close. */
enum eco_code bench_gltf_read(struct bench_full *read, const struct bench_full *full, const char *path,
	struct eco_error *error);
/* A pack of the scene of `full` whose plants are these meshes and nothing coarser. */
enum eco_code bench_gltf_pack(const struct bench_full *full, const struct bench_full *meshes,
	const char *path, struct eco_error *error);

#endif
