/* Inside `ecopack export`: a pack as plain files for any static server. Functions fail by eco_stop (memory.h).
 *
 * Its chunks, each named by its id, or 3D Tiles 1.1 (export.c):
 *
 *   export_plant(&x, number)   a plant in up to three levels: plants/N-L.bin           export_plant.c
 *   export_mesh_compress(...)  its triangles, for EXT_meshopt_compression                 export_plant.c
 *   export_instances(...)      where a tile's plants stand: tiles/T.bin                export_content.c
 *   export_level, export_summary, export_ground     contents of tiles: .gltf           export_content.c
 *   export_ground_image(...)   what lies on a tile of ground: tiles/ground-T.png       export_image.c
 *   export_tilesets(&x)        tileset.json, and one for each nested file              export_tree.c
 *
 *   tileset.json                    root, in the Earth's frame where the scene's place is known
 *    |-- tile                       REPLACE; content: its summary, as small unlit triangles
 *    |    |-- tile ...
 *    |    '-- plants, few triangles each, then more, then all       instanced; files shared by all tiles
 *    |-- tileset-N.json             a nested eco file, with its transform
 *    '-- ground tile ...
 *
 * Geometric errors are metres. A level of a plant has its radius times 1 - Q (against full detail,
 * plant_view.h); a summary, four of its points' widths; the ground, four times how far it is from where it
 * should be: viewers refine what is wrong by 16 pixels. */
#pragma once

#include <jansson.h>
#include <limits.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/inventory.h"
#include "lod/bake.h"

#define EXPORT_LEVELS 3u

/* Arrays of a part: a vertex has 3 floats, 4 normalized uint16 and 2 floats; a triangle, 3 uint32. */
enum export_array { EXPORT_POSITION, EXPORT_COLOR, EXPORT_UV, EXPORT_INDEX, EXPORT_ARRAYS };

struct export_part {             /* triangles of one material, in a file */
	size_t at[EXPORT_ARRAYS], packed[EXPORT_ARRAYS]; /* where, and compressed to how many bytes; 0: not */
	uint32_t vertices, indices, image;       /* image: list of the texture, or ECO_NONE */
	float low[3], high[3];
};
struct export_mesh {
	struct export_part *parts;
	uint32_t part_count;
	size_t bytes;
	uint64_t triangles;
	double precision_m;              /* positions may be rounded to; 0: a millimetre, or finer if small */
};

struct export_plant {            /* levels from coarse to fine; the last has no error */
	struct export_mesh level[EXPORT_LEVELS];
	double error_m[EXPORT_LEVELS];
	uint32_t levels;
};

struct export {
	struct eco_error *error;
	struct eco_pack *pack;
	json_t *meta;                    /* of the pack; NULL: it is no JSON */
	bool is_plain;                   /* nothing is compressed */
	bool is_made;                    /* `dir` */
	char dir[PATH_MAX];              /* where files are written until all are ... */
	const char *final;               /* ... and where they are then */
	struct export_plant *plants;     /* of the scene */
	struct eco_inventory_block rows; /* the block that was read last */
	uint64_t files, bytes, tiles, instances; /* written; plants of leaf tiles, each once */
};

/* 3D Tiles into a folder that is not there yet, which appears complete or not at all. */
enum eco_code export_tiles(struct eco_pack *pack, const char *dir, bool is_plain, struct eco_error *error);

/* Writes DIR/NAME. */
void export_file(struct export *x, const char *name, const void *bytes, size_t size);
void export_json(struct export *x, const char *name, json_t *json);  /* takes json */

/* Makes a mesh, whose bytes are `file`, of baked triangles; the same material is one part,
 * and what has no triangles none. */
void export_mesh_make(const struct export *x, struct export_mesh *mesh, struct eco_writer *file,
	const struct lod_bake *bakes, const uint32_t *images, uint32_t count);
/* Compresses a mesh and its file, both of them anew; which triangles there are stays, their order does not. */
void export_mesh_compress(struct export_mesh *mesh, struct eco_writer *file);
/* Bytes of a part's array that is not compressed. */
size_t export_array_bytes(const struct export_part *part, enum export_array array);
void export_mesh_free(struct export_mesh *mesh);

void export_plant(struct export *x, uint32_t number);
/* By META; nodes of objects say so in their extras. */
bool export_is_object(const struct export *x, uint32_t number);

/* Contents: write files, and `name` the one that a tile refers to. */
#define EXPORT_NAME 64
void export_summary(struct export *x, uint32_t tile, char name[EXPORT_NAME], double *error_m);
/* The instances of a tile's plants, for all its levels. */
void export_instances(struct export *x, uint32_t tile);
void export_level(struct export *x, uint32_t tile, uint32_t level, char name[EXPORT_NAME], double *error_m);
/* Ground that the rasters hold; an empty name: they hold nothing of the tile. */
void export_ground(struct export *x, uint32_t ground, char name[EXPORT_NAME], double low[3], double high[3]);

/* sRGB of ground without an image. */
extern const uint8_t export_grass[3];
/* Writes the image of that part of the ground, as DIR/NAME, a PNG whose rows come from the north; false:
 * there is none. A leaf's is as fine as the image, but at most 2048 texels a side. */
bool export_ground_image(struct export *x, const double low[3], const double high[3], bool is_leaf, const char *name);

void export_tilesets(struct export *x);
