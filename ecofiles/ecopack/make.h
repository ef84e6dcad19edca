/* From a scene source to a pack.
 *
 *   sources     eco_sources_load: the scene file and the files it nests, each once
 *   ground      eco_ground_import, rounded to the pack's grid, cut into tiles                make_ground.c
 *   footprints  put on the ground, gathered in blocks, each a plant with one instance       make_buildings.c
 *   plants      distinct models, in parallel: import, lod_plant_build, lod_plant_measure     make_plants.c
 *               or taken from the cache of finished plants                                        cache.c
 *   textures    those that plants share, once                                                  make_plants.c
 *   places      instances and inventories, put on the ground, scaled to their heights        make_places.c
 *   tiles       lod_tiles_build; instance lists, tables, point summaries                          make_tiles.c
 *   image       rasters of colours or classes, cut into tiles                                 make_ground.c
 *   inventory   which row of which inventory each plant is, and of which species
 *                                                                                        make_inventory.c
 *   commit      tables, META, rename                                                         make_inventory.c
 *
 * Everything up to the commit is deterministic and independent of the number of threads. */
#pragma once

#include <jansson.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/generate/buildings.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/ecopack/cache.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/texture.h"
#include "ecofiles/scene/scene.h"
#include "lod/build/plant.h"
#include "lod/build/texture.h"
#include "lod/build/summary.h"
#include "lod/build/tile.h"

struct make_options {
	const char *scene, *pack;
	uint32_t jobs;               /* threads; 0: as many as there are processors */
	enum lod_order_method order; /* of leaves; a draft's: LOD_ORDER_COMBINED */
	bool draft;                  /* for a first look (lod/build/plant.h), with textures of few texels */
	/* season of all plants of the library, whatever the scene says; without season_given as it says */
	enum eco_season season;
	bool season_given;
	/* folder of finished plants; NULL or "": none. Does not change the pack */
	const char *cache;
	bool no_rows;                /* leaves out which row of which inventory a plant is */
	struct eco_string_pool columns;      /* whose values of each row the pack has, ECO_CELLS_MAX at most */
	uint64_t cache_bytes;        /* the cache's bound; 0: 2 GiB */
};

/* From now on this process reads only below `folder` (that of the scene file if ""), and writes only
 * beside the pack and in the cache (ecofiles/base/confine.h). Before any thread. */
enum eco_code make_confine(const struct make_options *options, const char *folder, struct eco_error *error);

/* Builds options->pack. On failure the target is untouched. */
enum eco_code make_pack(const struct make_options *options, struct eco_error *error);

/* ---- Inside ---- */

/* Counts of a file; lost: footprints that are no buildings. */
struct make_footprints { struct eco_footprints footprints; struct eco_building *buildings; uint32_t count, lost; };
struct make_block {              /* buildings near each other, an object */
	uint32_t source, plant;
	double at[3];                /* where it stands */
	struct eco_building *buildings; uint32_t count;
	struct eco_buildings_notes notes;
};

struct make_plant {              /* a model on its way into the pack */
	const struct eco_source_plant *source;   /* the first source plant that names it */
	struct make_block *block;    /* NULL: of a model, or of the library */
	char *path;                  /* canonical paths of its files, one a line */
	double importance;           /* of its eco file */
	char name[64];
	uint32_t palette_first;      /* in the scene's palette */
	struct lod_plant built;
	struct lod_texture *textures;        /* one per built.images */
	uint32_t *images;            /* the same in the pack: lists, once make_textures is done */
	bool cutout;
	double reach, low, high;     /* bounds: within reach of the axis, z from low to high */
	double base;                 /* where its crown begins, as a share of its height */
	double crown;                /* radius of the disc of the area that it covers from above */
	uint32_t triangles_in, dropped[ECO_DROP_COUNT];
	double foot[3], scale;       /* as the model was re-based (struct eco_model) */
};

/* species: of m->species; file: of the source's inventories, from 1 on, 0: of none; row, line: positions.h;
 * cells: of m->cells, from 1 on, 0: none */
struct make_place {
	double at[3], scale;
	uint32_t plant, species, file, row, line, cells;
	double yaw_deg;              /* NaN: any */
	uint8_t width;               /* a code for eco_place_width */
	uint32_t tint;               /* of eco_tints_value while rows are read, then a class of the eco file's */
};
struct make_nested { double at[3]; uint32_t child; };        /* place of a child of the source */

struct make_eco {                /* an eco file with its places, tiled */
	struct make_place *places;   uint32_t place_count, place_capacity;
	struct make_nested *nested;  /* as many as the source has children */
	struct lod_tiles tiles;      /* items are places, then nested eco files */
	uint32_t tile_first;
	uint64_t instances;          /* plants, with nested ones */
	uint64_t rows, bases, bases_off;     /* bases: rows that say where the crown begins; off: no model has it there */
	struct eco_skipped skipped[ECO_SKIP_COUNT];
	struct eco_tints tints;
	uint32_t tint_first;         /* their colours in the scene's palette */
};

enum { MAKE_WEST, MAKE_EAST, MAKE_SOUTH, MAKE_NORTH, MAKE_SIDES };

struct make_array { void *items; uint64_t count, capacity; };

struct make {
	const struct make_options *options;
	struct eco_error *error;     /* of eco_try, which its functions fail to */
	struct eco_sources sources;
	struct make_plant *plants;   uint32_t plant_count;
	struct make_array footprints, blocks;    /* make_buildings.c */
	struct main_cache cache;
	uint32_t **plant_of;         /* [source][plant of the source] */
	bool tinted;                 /* a column of some rows colours their plants */
	struct eco_drawing *drawing;             /* on the ground; NULL: nothing */
	struct eco_ground ground;
	bool has_ground, ground_through;         /* from rasters, or through the plants */
	double ground_low_m, ground_step_m;      /* its heights are whole steps above this */
	struct eco_ground_tile *ground_tiles;
	uint8_t *ground_shifts;                  /* see lod/ground_choice.h */
	struct eco_ground_image *ground_images;
	/* plants and nested eco files beyond the ground's border, how far the farthest is, and how many on
	 * each side */
	uint64_t off_ground;
	double off_ground_m;
	uint64_t off_side[MAKE_SIDES];
	struct make_eco *ecos;       /* per source */
	struct eco_string_pool species;    /* of places, as their rows, else their scene files, name them */
	struct eco_string_pool columns, cell_texts;  /* columns of the pack's rows, and what stands in them */
	struct make_array cells;     /* const char *[ECO_INVENTORY_CELLS] each */
	struct eco_pack_writer *writer;
	struct make_array textures;  /* struct make_texture */
	/* make_tiles.c: plants of one kind in one leaf; each a group and a list */
	struct make_array stands;
	struct make_inventory *inventory;        /* make_inventory.c; NULL before the first place */
	/* the scene's tables as they grow */
	struct make_array anchors, ladders, curves, tiles, groups, children, lists, palette;
	struct make_array places;    /* of ECO_PLACE_BYTES */
	struct eco_plant *table;     /* per plant */
	struct eco_scene scene;
};

/* Begins the pack; eco_end removes what is unfinished of it. */
void make_create(struct make *m);
/* Frees what make and link have in common, the writer too. */
void make_tables_free(struct make *m);
/* Room for one more record. */
void *make_append(struct make_array *array, size_t size);
/* Appends `count` records. */
void make_add(struct make_array *array, const void *records, size_t count, size_t size);

/* A plant's tables where it comes from: their ladders count anchors from anchor_first and curves from
 * curve_first. */
struct make_tables {
	const struct eco_anchor *anchors; uint32_t anchor_first;
	const struct eco_curve *curves;   uint32_t curve_first, curve_count;
	const struct eco_ladder *ladders; uint32_t ladder_count;
};
/* Appends them for m->table[id]. lists: per list of the plant, its list in the pack. */
void make_add_plant(struct make *m, uint32_t id, const struct make_tables *from,
	const uint32_t *lists);

/* Finds a run of colours in the scene's palette, or appends it; returns its first. */
uint32_t make_add_colors(struct make *m, const uint8_t (*rgb)[3], uint32_t count);

/* Adds a list that the writer has to m->lists, and its requirements to the scene's needs. */
void make_keep_list(struct make *m, uint32_t list_id);
/* Adds a list to the pack and to m->lists; returns its number. */
uint32_t make_add_list(struct make *m, const struct eco_list *list, const struct eco_elements *elements,
	const uint32_t *ends, uint32_t end_count, const struct eco_elements *partner);
/* The same for a list encoded before, and for the bytes of chunks. */
uint32_t make_add_encoded(struct make *m, const struct eco_list *list, const struct eco_encoded *encoded);
uint32_t make_add_bytes(struct make *m, const struct eco_list *list, const struct eco_bytes *chunks, uint32_t count);
/* Levels of texels, each as eco_texture_write_strips wrote it. */
uint32_t make_add_levels(struct make *m, const struct eco_list *list, const struct eco_writer *levels, uint32_t count);

/* as many as the options ask for, or the machine has processors */
uint32_t make_threads(const struct make *m);

void make_ground_read(struct make *m);       /* reports errors before plants are built */
void make_ground_pack(struct make *m);
/* Lays ground through the plants of m->scene, whose tables but ground are done, and packs it, unless there is
 * some. */
void make_ground_through(struct make *m);
void make_ground_free(struct make *m);
void make_image_look(struct make *m);        /* reports errors before plants are built */
/* Packs the image of the ground, if the scene names one, once tiles and ground are there. */
void make_image(struct make *m);
void make_buildings_read(struct make *m);    /* fills footprints and blocks */
void make_buildings_plant(struct make *m, uint32_t block, struct make_plant *plant);
void make_buildings_model(struct make_plant *plant, struct eco_model *model);
void make_buildings_place(struct make *m, uint32_t source);
void make_buildings_say(const struct make *m);       /* what was done to footprints, once they are built */
void make_buildings_free(struct make *m);
void make_plants(struct make *m);            /* finds, builds and packs them */
void make_plants_pack(struct make *m);       /* those that are built: m->plants */
void make_plants_free(struct make *m);
/* Sets reach, low, high, crown and base of a plant that is built. */
void make_body(struct make_plant *plant);

/* opens each inventory and takes its first plant; reads areas and masks */
void make_places_check(struct make *m);
void make_place_add(struct make *m, uint32_t source, const struct make_place *place);
/* Fills m->ecos with places, by the heights and reaches of m->plants, and tiles them. */
void make_places(struct make *m);
void make_places_drop(struct make *m);               /* frees the parts of m->ecos that only tiles need */
void make_places_free(struct make *m);
/* a nested eco file's weight when tiles are split (lod/build/tile.h) */
uint32_t make_nested_weight(uint64_t instances);
void make_tiles(struct make *m);             /* tables and lists of tiles */
void make_refer(struct make *m);                     /* points m->scene to the tables as they are now */
/* sums areas and plants of tiles [0, tiles_end) from later tiles */
void make_add_up(struct make *m, uint32_t tiles_end);
/* Summaries, an eco file's tiles at a time; nested eco files come before the files that nest them. */
struct make_summing {
	struct make *m;
	struct lod_pool *pools;      /* per plant; NULL where all points come from roots */
	struct lod_summary_root **roots;         /* per tile: kept root, or NULL */
	struct lod_summary_palette palette;      /* of this range */
	uint32_t palette_first;      /* where it lies in the scene's */
	uint32_t first;
	uint64_t done;
};
void make_summing_begin(struct make_summing *summing, struct make *m);
void make_summing_run(struct make_summing *summing, uint32_t first, uint32_t count);
/* keeps the root for files that nest it */
void make_summing_keep(struct make_summing *summing, uint32_t tile);
void make_summing_end(struct make_summing *summing);
void make_summaries(struct make *m);         /* of all tiles */
/* Adds the row of the next place of section PLACES, which has that plant. Names are copied. */
void make_inventory_add(struct make *m, uint32_t plant, const struct eco_inventory_row *row);
/* Packs them, as the last list, unless there is nothing to be said of any. */
void make_inventory_pack(struct make *m);
void make_inventory_free(struct make *m);
/* Adds "species" to plants of META that are of any: {"of": how many, "most": [[name, or null where rows state
 * none, plants], ...]}, the commonest first, as many as fit a legend. */
void make_species_say(const struct make *m, json_t *plants);
/* Names META's "columns", if there are any: those of the rows' cells. */
void make_columns_say(const struct make *m, json_t *meta);
/* Adds a class of plants to META's "tints": [{"column", "classes": [{"name", "color": "#rrggbb" or null,
 * "plants"}]}]. A nested file counts once. */
void make_tint_say(json_t *meta, const char *column, const char *name, json_t *color, uint64_t plants);
/* META's "ground": where it comes from. */
#define MAKE_GROUND_THROUGH "plants"
const char *make_ground_origin(const struct make *m);
json_t *make_meta(const struct make *m);
/* Names the scene, finds its near plane and commits the pack. Frees meta. */
void make_commit(struct make *m, json_t *meta);

/* Textures of a pack belong to no plant: models that show one image, at whatever size, share its lists, and a
 * stream sends them once. Levels halve from the image (lod/build/texture.h): fewer levels are the first ones
 * of more, and the most that a plant needs serve all. */
struct make_texture {
	uint32_t count;              /* of levels */
	bool outlined;
	struct eco_chunk_id colors[ECO_TEXTURE_LEVELS_MAX], outlines[ECO_TEXTURE_LEVELS_MAX];
	float texel_area;            /* of the last level, on the plant where it is largest */
	void *from;                  /* the caller's: where its levels come from */
	uint32_t list;               /* in the pack, once it is there; before, the caller's */
};

/* Finds a texture in m->textures, adds it, or makes the one there finer; returns where it is. */
uint32_t make_share_texture(struct make *m, const struct make_texture *texture);

/* Packs the textures of all plants, and sets their `images`. */
void make_textures(struct make *m);
