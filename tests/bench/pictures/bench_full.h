/* The full detail of a pack outside any client: its plants' triangles, where they stand, and what a client
 * that fetches all at once would fetch.
 *
 *   bench_full_open(&full, "city.eco", &error);
 *   ... full.meshes, full.stands ...
 *   bench_full_close(&full); */
#ifndef TESTS_BENCH_FULL_H
#define TESTS_BENCH_FULL_H

#include "ecofiles/format/pack.h"
#include "lod/eye.h"

/* A plant's triangles of one texture, in plant space. */
struct bench_full_mesh {
	uint32_t plant;
	uint32_t image;              /* list of the texture; ECO_NONE: none */
	bool colored;
	uint32_t corners, room;      /* three a triangle; what the arrays have space for */
	float *position, *uv;        /* metres; uv NULL without a texture, (0,0) is its top left */
	uint32_t *color;             /* one a triangle, of the scene's palette; NULL: all white */
};
struct bench_full_stand { uint32_t plant; struct lod_place place; };

struct bench_full {                      /* owns its arrays; zero is empty */
	struct eco_pack *pack;
	struct bench_full_mesh *meshes; uint32_t mesh_count;
	struct bench_full_stand *stands; uint64_t stand_count;
};

enum eco_code bench_full_open(struct bench_full *full, const char *pack, struct eco_error *error);
void bench_full_close(struct bench_full *full);
/* Makes arrays of a mesh large enough for so many corners. False: no memory. */
bool bench_full_room(struct bench_full_mesh *mesh, uint32_t corners);

/* Bytes of the chunks that full detail of the whole scene is made of: places, triangles, or lines where wood
 * has no triangles, the last level of each texture with its outline, the finest ground; each payload once.
 * ECO_NO_MEMORY. */
enum eco_code bench_full_bytes(const struct eco_scene *scene, uint64_t *bytes, struct eco_error *error);
/* The chunk that is the last level of a texture or an outline. */
uint32_t bench_full_last_chunk(const struct eco_scene *scene, uint32_t image);

#endif
