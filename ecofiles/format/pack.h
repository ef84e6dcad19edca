/* The pack: one file that holds a scene, ready to be served by mapping it.
 *
 *   eco_pack_create(&w, path, &error);              writes path.tmp-PID beside the target, locked;
 *                                                   removes such files of processes that were killed
 *   eco_pack_add_list(w, &list, &elements, ...);    encodes chunks as it goes; returns the list's id
 *   scene.plants = ...;                             fill the other tables of a struct eco_scene
 *   eco_pack_commit(w, &scene, meta, &error);       tables, hashes, fsync, rename, fsync: all or nothing
 *
 *   eco_pack_open(&pack, path, &error);             maps, checks hashes, bounds every index
 *   ... any number of threads read pack->scene ...  immutable, so without locks
 *   eco_pack_close(pack);
 *
 * File (little-endian, sections 64-byte aligned, padding zero):
 *
 *   0    8  "ECOPACK1"
 *   8    u32 version = ECO_PACK_VERSION        12  u32 section count n
 *   16   u64 file size        24  u64 XXH3-64 of bytes [0,24) and of the section table
 *   32   n * 40-byte section records:
 *          u32 kind, u32 record count, u64 offset, u64 size, u64 XXH3-64 of the section's bytes (0 for
 *          CHUNK_DATA, whose chunks carry their own hashes), u32 record size, u32 0
 *   .    sections, ascending by kind and offset, at most one of a kind; an absent section is an empty table
 *
 *   kind 1 META        JSON: name, crs, origin, generator, statistics (for people and `ecopack info`)
 *        2 SCENE       one record: name, needs, root tile, ground columns, rows, margin, near (bounds:
 *                      the root tile's)
 *        3 PLANTS  4 ANCHORS  5 LADDERS  6 CURVES  7 TILES  8 GROUPS  9 CHILDREN  10 LISTS  11 CHUNKS
 *        12 PALETTE  13 PLACES  14 GROUND  15 GROUND_IMAGES  16 CHUNK_DATA   payloads, one after the other
 *
 * Each section starts at the first multiple of 64 after the one before; the file ends with the last
 * section. META and CHUNK_DATA have no records (count and size of a record 0); PALETTE has 3 bytes a
 * colour. In the chunk table, a payload either follows the payloads so far or lies within them (equal
 * payloads are stored once), so that every byte of CHUNK_DATA has a hash. Fields of a record are in the
 * order of the structs below; pack_record.c reads and writes each by name. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/format/list.h"

#define ECO_PACK_VERSION 28u

/* ---- The scene's tables. All cross references are indices; ECO_NONE where absent. ---- */

enum eco_need {                  /* what a scene uses; a reader skips what is not listed */
	ECO_NEED_POINTS = 1, ECO_NEED_LINES = 2, ECO_NEED_TRIANGLES = 4, ECO_NEED_TEXTURES = 8,
		ECO_NEED_CUTOUTS = 16,
	ECO_NEED_GROUND = 32, ECO_NEED_CELLS = 64, ECO_NEED_SUMMARIES = 128, ECO_NEED_PLACEMENTS = 256,
	ECO_NEED_SPLATS = 512, ECO_NEED_IMPOSTORS = 1024, ECO_NEED_GROUND_IMAGE = 2048,
	ECO_NEED_WIDTHS = 4096,  /* instances with a width of their own */
	ECO_NEED_TINTS = 8192,   /* instances with a colour by a column of their inventory */
	ECO_NEED_WATER = 16384,  /* water in the image of the ground (ground_tile.h) */
	ECO_NEEDS_ALL = 32767
};

enum eco_organ { ECO_ORGAN_WOOD, ECO_ORGAN_FOLIAGE, ECO_ORGAN_FLOWER, ECO_ORGAN_COUNT };
extern const char *const eco_organ_names[ECO_ORGAN_COUNT];

/* A sphere in plant space. A plant's first anchor is the whole plant; the others are its cells. Distance
 * bands (lod/eye.h) are taken from the eye to an anchor's centre. */
struct eco_anchor {
	float center[3];
	float radius;
};

#define ECO_LEVELS_MAX 10
enum eco_ladder_flag {
	/* drawn where the plant's cells are not (its band: at or beyond the gate) */
	ECO_LADDER_FAR = 1,
	ECO_LADDER_NEAR = 2,         /* a cell: drawn only where the plant's band is below the gate */
	/* a second curve, measured from above, has the same shares and reaches */
	ECO_LADDER_ABOVE = 4,
	/* shows the whole plant, all organs: where it is drawn, no other ladder of the plant is. At the
	 * plant's first anchor */
	ECO_LADDER_WHOLE = 8
};

/* Errors that are seen where a plant is so many pixels across as ECO_SEEN_PX says, in ECO_SEEN_UNIT of CIELAB
 * a pixel that the reference covers: distance of mean colours of blocks of 16 x 16 pixels, and of deviations
 * of lightness within them (lod/build/measure/seen.h). [0]: before plants that look alike; [1]: before ground
 * and sky. */
#define ECO_SEEN_SIZES 3u
#define ECO_SEEN_PX(size) (192u >> 2 * (size))
#define ECO_SEEN_UNIT (1.0 / 256)
struct eco_seen { uint16_t color[ECO_SEEN_SIZES][2], contrast[ECO_SEEN_SIZES][2]; };

/* A sequence of sets of cuts over the lists of one organ at one anchor, in ascending vertices:
 *   leaves: the forms of one list of elements, in one order: points (one an element), lines (of blades, one
 *           an element), simple (one triangle an element) and triangles; all but the triangles may be absent.
 *           Finer forms replace coarser ones from the front: elements [0,f) of the finer form with elements
 *           [f,e) of the coarser one, until f = e. The curve says which e belongs to a share of vertices
 *           (`reach`).
 *   wood:   the first p/2 lines -> level 0 -> ... -> the last level: triangles [level_end[i-1], level_end[i]).
 *           Between two of these stand samples of the curve with a reach below 1: the first of the finer
 *           level's triangles, `reach` of them, with so many of the last triangles, or lines, of the coarser
 *           one that together they have the sample's vertices: other branches
 *   plain:  the first p/3 triangles, scaled                                   (triangles only, no levels)
 *   splats: `points` with ECO_ATTR_SPLAT in levels; a level has a whole multiple, m, of the splats of the one
 *           before it, and splats [m i, m (i + 1)) stand for splat i of that one. The first p of a level
 *           give way to their children: [0, m p) of the next level with [p, all) of this one. Then, with
 *           `triangles`, the first p/3 of the last `total` of these with all of the last level, at the curve's
 *           scale. Where `total` is more than there are, the rest are those of the plant's cells, an equal
 *           share of each (eco_ladder_front), and the ladder is the plant's last. With `impostor` one vertex is
 *           a level of it in place of a splat, up to LOD_IMPOSTOR_PIXELS (lod/impostor.h)
 * lod/ladder.h turns (ladder, vertices) into cuts. Absent lists are ECO_NONE; a FAR ladder may have lines
 * only. */
struct eco_ladder {
	uint32_t plant, anchor;      /* anchor: index into the scene's anchors */
	uint8_t organ, flags;
	uint8_t level_count;         /* 0: the triangles list is one level */
	uint8_t reserved;
	uint32_t points, lines, simple, triangles, impostor;
	uint32_t level_end[ECO_LEVELS_MAX];
	uint32_t total, before;      /* points (or lines) in this anchor's region: all, and those that the
	                              * whole-plant ladder of the same organ and texture already holds (0 in
	                              * that ladder and in wood) */
	float importance;            /* multiplies this ladder's share of the budget; 1 is neutral */
	float area;                  /* m^2 of all elements in this region, a leaf counted once */
	float length;                /* m, of all lines */
	float epsilon;               /* m, greatest distance of a line from the wood it stands for */
	uint32_t curve_first, curve_count;
	struct eco_seen nothing;     /* where none of it is drawn */
};

/* Samples of a ladder's curves. */
static inline uint32_t eco_ladder_samples(const struct eco_ladder *ladder)
{
	return ladder->flags & ECO_LADDER_ABOVE ? 2 * ladder->curve_count : ladder->curve_count;
}

/* One sample of a ladder's curve, measured on the whole organ (for cells: the curve of the organ, by
 * density). Samples run geometrically from one element up to everything; `share` strictly ascends in (0,
 * 1]. Of a ladder with an impostor of n levels, the first n samples are these levels: their shares are 1/n,
 * 2/n, ... of a vertex. */
struct eco_curve {
	/* Neubert's lambda: vertices drawn / vertices of the ladder at full detail */
	float share;
	float scale;                 /* s_opt * share of primitives drawn: 1 is Cook's area preservation. A
	                              * cut's scale is this / (primitives drawn / primitives of the stage).
	                              * Bounded where s_opt is singular, so it may be interpolated */
	float reach;                 /* leaves: share of the region's elements that are drawn in any form; wood
	                              * between two levels: share of the finer one; else 1 */
	/* wrong pixels over covered pixels of the reference, mean over views: from all around, or from above
	 * */
	float fp, fn;
	struct eco_seen seen;        /* from all around; of curves from above 0 */
};

struct eco_plant {
	char name[64];
	float height_m;
	uint32_t anchor_first, anchor_count;   /* >= 1: whole plant, then cells */
	uint32_t ladder_first, ladder_count;   /* whole-plant ladders before those of cells */
	float area;                            /* m^2, all organs, a leaf counted once */
	uint32_t triangles;                    /* full detail */
	/* for leaves that are drawn on its splats and points (lod/leaf.h): their width as far as they are
	 * seen, ECO_LEAF_UNIT_M, 0: none are drawn; and the deviation, over the mean, of the luminance of
	 * what a splat stands for, 1/ECO_TONE_ONE */
	uint16_t leaf_width;
	uint8_t leaf_tone;
};
#define ECO_LEAF_UNIT_M 1e-4
#define ECO_TONE_ONE 128

/* A view opens a tile or draws its summary. Below a tile that is open it opens all tiles without a summary,
 * and looks at their plants one by one. A pack with more of these below one tile is refused: no view of it
 * would ever be planned. */
#define ECO_OPEN_TILES_MAX (1u << 16)
#define ECO_OPEN_PLANTS_MAX (1u << 18)

struct eco_tile {
	double low[3], high[3];      /* bounds of all its plants, in the coordinates of its own eco file */
	double area;                 /* m^2 of all plants, scaled */
	uint64_t instance_count;     /* plants in the whole subtree, nested eco files counted each time */
	uint32_t summary;            /* list id of the point summary, or ECO_NONE */
	uint32_t group_first, group_count;
	uint32_t child_first, child_count;
};

/* The plants of one species in one leaf tile: instances [first, first + count) of a list. The groups of a
 * list follow each other in the table, in the list and in section PLACES, and are all of it. `ecopack make`
 * puts all plants of a tile into one list: its record and the heads of its payload are sent once
 * (lod/EXPERIMENTS.md, One list for a tile's plants). */
struct eco_group {
	uint32_t tile, plant, list;
	uint64_t place_first;        /* the same plants in section PLACES: as many, from this place on */
	uint32_t first, count;
};

/* An instance as integers on its list's grid. The pack keeps instances twice: coded in the instance lists
 * (sent), and plain in section PLACES (mapped, never sent), because the planner must look at plants and
 * the server decodes nothing. `ecopack verify` compares the two. */
struct eco_place {
	int32_t position[3];
	uint16_t turn;               /* yaw, 1/65536 turns */
	uint32_t scale;              /* 1/65536 */
	uint8_t width;               /* across: a code for eco_place_width; 0: as high */
	/* 0: none, else a colour of its list's palette, and 1 more, which colours what does not keep its own
	 * (lod/tint.h); 0, 0, 0 there is a class that stays as it is */
	uint8_t tint;
};
#define ECO_PLACE_BYTES 20u      /* i32 x 3, u16 turn, u8 width, u8 tint, u32 scale */
#define ECO_LIST_TINTS_MAX 255u       /* classes of an instance list */
#define ECO_WIDTH_ONE 64u
#define ECO_WIDTH_LEAST 16u      /* a quarter of the model's proportions */
#define ECO_WIDTH_MOST 255u
/* The factor of x and y beside the scale. */
static inline double eco_place_width(uint8_t code) { return code ? code / (double)ECO_WIDTH_ONE : 1; }
/* The factor of its leaves' area: seen from beside it grows with the width and the height. */
static inline double eco_place_area(const struct eco_place *place)
{
	double scale = place->scale / 65536.0;
	return scale * scale * eco_place_width(place->width);
}

struct eco_child {               /* child tile ids are greater than their parent's: the tree has no cycle */
	uint32_t tile;
	bool placed;                 /* another eco file with a transform; else the parent's coordinates */
	double at[3];                /* metres, in the parent's coordinates */
	uint16_t turn;               /* 1/65536 turns about Z, counter-clockwise */
	float scale;
};

/* A tile of the ground: a square of ECO_GROUND_CELLS cells a side between samples of the scene's grid that
 * lie 2^level apart (smaller where the grid ends). The tiles are a quadtree: the first is the root and
 * covers everything; children follow their parents, level by level, and together cover their parent. A
 * tile without children has the finest detail there. ground_tile.h says which samples a tile holds. All
 * ground lists have the scene's grid, with the south-west sample inside its margins at 0, 0 (heights.h). */
#define ECO_GROUND_APART_MAX 5u      /* levels between tiles that touch where both are drawn */
#define ECO_GROUND_CELLS (1u << ECO_GROUND_APART_MAX)
#define ECO_GROUND_LEVELS 9u
#define ECO_GROUND_SIDE_MAX ((ECO_GROUND_CELLS << (ECO_GROUND_LEVELS - 1)) + 1)   /* samples a side: 8193 */
struct eco_ground_tile {
	uint32_t list;               /* a list of one chunk */
	uint32_t column, row;        /* in tiles of its level, from the south-west */
	uint8_t level, child_count;  /* children: 0, 1, 2 or 4 */
	uint32_t child_first;        /* 0 without children */
	float error_m;               /* distance to the finest ground, not below that of a child */
	float low_m, high_m;         /* z in the scene of the finest ground in it */
};

/* A tile of the picture on the ground (ground_tile.h). The tiles are a quadtree: the first is the root;
 * children follow their parents, four each, level by level: south-west, south-east, north-west,
 * north-east. */
struct eco_ground_image {
	uint32_t list;               /* of kind GROUND_IMAGE, whose grid says where it lies */
	uint32_t child_first;        /* 0: it has no children */
};

struct eco_scene {
	char name[64];
	uint32_t needs;
	uint32_t root;               /* tile */
	uint32_t ground_columns, ground_rows;        /* samples of the ground at full detail; 0: no ground */
	uint32_t ground_margin;                      /* of these on each side (heights.h) */
	double near_m;               /* near plane of every picture of this scene */
	const struct eco_plant *plants;      uint32_t plant_count;
	const struct eco_anchor *anchors;    uint32_t anchor_count;
	const struct eco_ladder *ladders;    uint32_t ladder_count;
	const struct eco_curve *curves;      uint32_t curve_count;
	const struct eco_tile *tiles;        uint32_t tile_count;
	const struct eco_group *groups;      uint32_t group_count;
	const struct eco_child *children;    uint32_t child_count;
	const struct eco_list *lists;        uint32_t list_count;
	const struct eco_chunk *chunks;      uint32_t chunk_count;
	const uint8_t (*palette)[3];         uint32_t palette_count;    /* sRGB */
	/* ECO_PLACE_BYTES each, read with eco_place_read */
	const uint8_t *places;               uint64_t place_count;
	const struct eco_ground_tile *ground; uint32_t ground_count;
	const struct eco_ground_image *ground_images; uint32_t ground_image_count;
};

/* Are a ladder's points splats in levels? */
static inline bool eco_ladder_has_splats(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return ladder->points != ECO_NONE && (scene->lists[ladder->points].attributes & ECO_ATTR_SPLAT);
}

/* The lists of triangles that stand before a ladder's splats when its own are drawn: those of the plant's cells, of
 * the same organ and texture. Returns their number. */
#define ECO_FRONT_MAX 64u
uint32_t eco_ladder_front(const struct eco_scene *scene, const struct eco_ladder *ladder,
	uint32_t lists[ECO_FRONT_MAX]);

/* The needs that a list gives a scene; cells, cut-outs and placements come from elsewhere. */
uint32_t eco_list_needs(const struct eco_list *list);
/* The first of an instance list's group_count groups; one of the scene's groups must be of the list. */
const struct eco_group *eco_list_groups(const struct eco_scene *scene, uint32_t list);
struct eco_place eco_place_read(const struct eco_scene *scene, uint64_t index);      /* index < place_count */
/* The same for an instance of a decoded list. */
struct eco_place eco_place_of(const struct eco_list *list, const struct eco_elements *instances, uint32_t index);

/* ---- Reading ---- */

struct eco_pack {
	struct eco_scene scene;      /* parsed into memory; chunk payloads stay in the map */
	struct eco_chunk_id id;      /* XXH3-128 over the section table: names the content */
	const char *meta;            /* JSON text, not 0-terminated */
	size_t meta_size;
	const uint8_t *map;
	size_t map_size;
	uint8_t *const *payloads;    /* per chunk, of a pack without a map (server/publish/index.h): NULL until it is there */
	int file;                    /* that the map is of, where it is a private copy; else -1 */
};

/* A chunk's payload as it is in memory; NULL: it is not there. */
static inline const uint8_t *eco_pack_bytes(const struct eco_pack *pack, uint32_t chunk)
{
	return pack->payloads ? pack->payloads[chunk] : pack->map + pack->scene.chunks[chunk].offset;
}

/* Opens and checks everything but the payloads; eco_pack_payload checks the hash of each. */
enum eco_code eco_pack_open(struct eco_pack **pack, const char *path, struct eco_error *error);
/* The same of a private copy in `folder` (ecofiles/base/files.h): the pack stays what it is,
 * whatever is done to the file meanwhile. ECO_INTERRUPTED: *cancelled was set while it was copied. */
enum eco_code eco_pack_open_private(struct eco_pack **pack, const char *path, const char *folder,
	const atomic_bool *cancelled, struct eco_error *error);
/* The same from memory that stays owned by the caller (fuzzing, tests). */
enum eco_code eco_pack_open_memory(struct eco_pack **pack, const uint8_t *bytes, size_t size,
	struct eco_error *error);
void eco_pack_close(struct eco_pack *pack);

/* Payload of chunk `chunk` after checking its hash; ECO_DAMAGED names the chunk, list and offset.
 * Thread-safe. */
enum eco_code eco_pack_payload(const struct eco_pack *pack, uint32_t chunk, const uint8_t **bytes,
	size_t *size_bytes, struct eco_error *error);

/* Checks a scene's tables against each other (every index in range, counts add up, bounds finite, tree
 * acyclic, unused space zero). Called by open; public so that a client can check the scene that a stream
 * declared. */
enum eco_code eco_scene_check(const struct eco_scene *scene, struct eco_error *error);
/* One record alone. A fault says what is impossible, as "its grid is impossible"; NULL: the record is sound. */
const char *eco_list_fault(const struct eco_list *list);
bool eco_anchor_sound(const struct eco_anchor *anchor);
enum eco_code eco_chunk_check(const struct eco_list *list, const struct eco_chunk *chunk,
	struct eco_error *error);

/* ---- Writing ---- */

struct eco_pack_writer;

/* A file at `path` is replaced only if it is a pack or empty. */
enum eco_code eco_pack_create(struct eco_pack_writer **writer, const char *path, struct eco_error *error);

/* Functions that add a list return its id, and stop (eco_try) where it cannot be coded or written.
 *
 * Encodes `elements` in chunks that end at elements `ends[i]` and appends them. Sets chunk_first,
 * chunk_count, primitive_count and element_count of the stored list, whose grid is finer by
 * 2^ECO_EXACT_SHIFT where elements have `exact`. For FORM, `partner_elements` are the partner's elements
 * as they were given, `elements` holds one form of each in the same order, and the ends are the same. A
 * partner may have several forms. Chunks with equal payload are stored once. */
uint32_t eco_pack_add_list(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_elements *elements, const uint32_t *ends, uint32_t end_count,
	const struct eco_elements *partner_elements);
/* The same in two steps, for lists without a partner: encoding needs no writer and may run in many threads
 * at a time. The caller frees encoded chunks in any case. */
struct eco_encoded_chunk { uint8_t *bytes; size_t size; uint32_t elements, primitives; };
struct eco_encoded { struct eco_encoded_chunk *chunks; uint32_t count; };
enum eco_code eco_pack_encode(struct eco_encoded *encoded, const struct eco_list *list,
	const struct eco_elements *elements, const uint32_t *ends, uint32_t end_count,
	struct eco_error *error);
uint32_t eco_pack_add_encoded(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_encoded *encoded);
void eco_encoded_free(struct eco_encoded *encoded);
/* Adds a list of BYTES chunks, one a file. */
struct eco_bytes { uint8_t *at; size_t size; };
uint32_t eco_pack_add_bytes(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_bytes *files, uint32_t file_count);
/* Adds a list of another pack, with its payloads, after checking them: the code says what is wrong with
 * these. In `list` the references to other lists, tiles, plants and colours are those of the new pack. */
enum eco_code eco_pack_add_copied(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_pack *from, uint32_t from_list, uint32_t *list_id, struct eco_error *error);
/* All elements of a list of points added before, decoded from the payloads written. */
enum eco_code eco_pack_read_points(struct eco_pack_writer *writer, uint32_t list_id,
	struct eco_elements *points, struct eco_error *error);
/* The same for a list of an open pack. */
enum eco_code eco_pack_points(const struct eco_pack *pack, uint32_t list_id, struct eco_elements *points,
	struct eco_error *error);
/* The list as stored so far (valid until the next add). */
const struct eco_list *eco_pack_list(const struct eco_pack_writer *writer, uint32_t list_id);

/* Writes the tables (lists and chunks from the writer, the others from `scene`; the caller keeps its
 * arrays), syncs and renames. Frees the writer in any case; on failure the target is untouched. */
enum eco_code eco_pack_commit(struct eco_pack_writer *writer, const struct eco_scene *scene,
	const char *meta_json, struct eco_error *error);
void eco_pack_abort(struct eco_pack_writer *writer);   /* removes the unfinished file; NULL is fine */
