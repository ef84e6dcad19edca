/* Inside `ecopack start`: from a table of trees and a folder of models to a scene that can be packed.
 *
 *   start_buildings(...)          footprints among the arguments                      start_buildings.c
 *                                 roads, land use, extracts of OpenStreetMap        start_land.c
 *   start_objects(...)            models of buildings                               start_objects.c
 *   start_check_order(...)        which other argument is which
 *   start_rasters(&start)         terrain and picture                                 start_look.c
 *   start_look(&start)            the table: columns, units, CRS                      start_look.c
 *   start_models_find(&start)     the folder: which files are models                  start_models.c
 *   start_match(&start)           a model for each species, or a plant of the library start_match.c
 *   start_models_see(&start)      the chosen ones: their sizes
 *   start_tint(&start)            colours by a column                                 start_tint.c
 *   start_scene(&start)           scene.json as text                                  start_scene.c
 *   start_library_sizes(...)      sizes of the library's plants, by the rows          start_library.c
 *   start_write(&start)           scene.json, map.png, camera.json, all or nothing    start_scene.c
 *
 * Every guess is a line: what was taken, why, and what changes it. It is printed, and kept in the scene's
 * notes. */
#pragma once

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/ecopack/map.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"
#include "ecofiles/import/places/place_guess.h"
#include "ecofiles/import/places/positions.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/table_columns.h"

struct start_options {           /* NULL: not given; models NULL: the library alone */
	const char *table, *models, *dem, *image, *image_crs, *folder;
	char **rasters; uint32_t raster_count;       /* of which it is not said what they are */
	const char *crs, *scene_crs, *x, *y, *species, *height, *dbh, *girth, *layer, *plant, *tint;
	const char *height_unit, *dbh_unit, *separator, *decimal, *same_place;
	bool force;
};

struct start_guess { char what[24], took[160], why[ECO_WHY_BYTES], change[64]; };

#define START_SIZES 6u           /* of a plant of the library */
struct start_model {             /* a plant of the scene: a file, or several alike, or a plant of the library */
	char name[64], words[ECO_WORDS_BYTES];
	char **paths; uint32_t path_count;
	struct eco_flora flora;
	bool is_dead;
	uint64_t rows;               /* that use it */
	double height_m;             /* of the first file, by its unit; 0: not looked at */
	bool height_is_ours;         /* it is written into the scene, as the file's is none to believe */
	enum eco_up up;              /* as its shape says, where its format says another axis; else FOUND */
	bool grade;                  /* its foliage is too bright */
	const char *habit, *genus;   /* of the library; habit NULL: files; genus "": any of its form */
	double size_m[START_SIZES], width_m[START_SIZES], base[START_SIZES]; uint32_t sizes, individuals;   /* width, base 0: usual */
};

enum start_tier { START_BY_NAME, START_BY_GENUS, START_BY_FORM, START_BY_LIBRARY, START_BY_NOTHING, START_LEFT_OUT,
	START_TIERS };
struct start_match {
	uint32_t model;
	enum start_tier tier;
	struct eco_flora flora;
}; /* model ECO_NONE: left out */

/* Rasters that lie beside each other are one. path: of the first tile, NULL: none; extent: of all; crs NULL: the file's
 * own */
struct start_tile { const char *path; struct eco_raster_extent *extent; };
struct start_raster {
	const char *path; struct eco_raster_extent *extent; const char *crs;
	struct start_tile *tiles; uint32_t tile_count, tile_capacity;
};
struct start_size { uint32_t column; struct eco_unit_guess unit; double median, share; };  /* of rows that say it */

struct start {
	const struct start_options *options;
	struct eco_error *error;
	struct eco_rows_source source;
	struct eco_table table;
	struct eco_columns columns;
	struct start_raster dem, image;
	char **raster_paths; uint32_t raster_path_count, raster_path_capacity;       /* in folders that were given; owned */
	struct eco_place_guess place;
	/* column ECO_NONE: none; `trunk` is a diameter, or a girth */
	struct start_size height, trunk;
	bool trunk_is_girth, height_is_z;
	struct start_size crown;             /* a diameter, or a radius */
	bool crown_is_radius, crown_is_area;
	uint32_t crowns[ECO_CROWN_COLUMNS], crown_columns;   /* radii to the north, east, south, west; two widths; or none */
	uint32_t crown_base;                 /* a column */
	bool base_is_ratio;
	const char *base_unit;               /* else a height */
	int now;                             /* the year from which ages are counted */
	json_t *skip;                        /* of rows without a plant: column to values */
	json_t *dead; uint64_t dead_rows;    /* of rows with a dead plant, likewise */
	uint32_t dead_model;                 /* ECO_NONE: there are no such rows */
	uint32_t tint_column;                /* as --tint says; ECO_NONE: not given */
	json_t *tint;                        /* as a scene has it; NULL: none */
	struct start_model *models; uint32_t model_count, model_capacity;
	struct eco_table_values species;
	struct start_match *matches;         /* per value of species */
	struct eco_flora_hint hint;          /* for their names */
	uint32_t fallback;                   /* the model of all other species */
	double height_m;                     /* of plants of which no size is known */
	json_t *other;                       /* the scene of --same-place-as; NULL: none */
	/* entries of files of footprints, of what is drawn and of woods; "crs": null: the table's */
	json_t *buildings, *draws, *scatters;
	json_t *objects;                     /* models of buildings: path, why, box, and once they are placed foot and at */
	struct start_guess *guesses; uint32_t guess_count, guess_capacity;
	char *scene;                         /* the text */
};

/* These fail by eco_stop (memory.h). */

/* The arguments without options, one or more; whether the second is models. ECO_BAD_INPUT: the first is no table, or the
 * second neither models nor a raster. */
bool start_check_order(char **names, uint32_t count);
/* Takes files of footprints out of the arguments, whose number is returned. A lone table is that of the trees, whatever its
 * features are. */
uint32_t start_buildings(struct start *s, char **names, uint32_t count);
/* Takes a table of roads or land use, of which more than the share `least` must be known, or an extract of OpenStreetMap;
 * false: it is none, or the table of the trees, too. */
bool start_land(struct start *s, const char *path, double least);
bool start_is_osm(const char *path);
bool start_osm(struct start *s, const char *path, bool as_table);
void start_land_plants(struct start *s);     /* of woods, once the table's species have theirs */
/* Takes models of buildings, and folders of these alone, out of the arguments, whose number is returned. They get their places
 * after those of the trees are known. */
uint32_t start_objects(struct start *s, char **names, uint32_t count);
void start_objects_place(struct start *s);
void start_objects_add(const struct start *s, json_t *plants, json_t *instances);
/* Adds the entries of land and buildings. */
void start_land_add(const struct start *s, json_t *ground, json_t *instances);
bool start_is_table(const char *path);       /* by its ending, if it is there */
#define START_FORMATS ".glb, .gltf, .obj, .fbx, .dae, .ply, .3ds, .3mf or .stl"
bool start_is_model(const char *path); /* by its ending */
/* Reads the scene of --same-place-as, if there is one. */
void start_same_place(struct start *s);
void start_rasters(struct start *s);
void start_raster_free(struct start_raster *raster);
/* Fails with `code`, which says why the table was not read, or says that it is a raster. */
_Noreturn void start_told_raster(struct start *s, enum eco_code code);
void start_image_crs(struct start *s);       /* once the place is known */
void start_look(void *start);
void start_sizes(struct start *s);           /* start_sizes.c */
void start_models_find(struct start *s);
/* A model of that name, or one like it if there is one already. */
struct start_model *start_model_add(struct start *s, const char *base, size_t bytes);
void start_match_species(struct start *s);
uint32_t start_library_add(struct start *s, const char *name);       /* a plant of no genus; `name`: of a habit that is there */
/* The library's plant of a genus or form, which is added if it is not there; its number. */
uint32_t start_library_plant(struct start *s, const struct eco_flora *flora);
/* Rare genera get a plant of their habit together. */
void start_library_merge(struct start *s);
/* Usual sizes, for rows that say none: of trees beside models that are lower than usual, as much lower. */
void start_library_usual(struct start *s);
/* Sizes and individuals that the rows need. */
void start_library_sizes(struct start *s, const struct map *map);
void start_models_see(struct start *s);
void start_tint(struct start *s);
void start_scene(struct start *s);
void start_scene_text(struct start *s);      /* again, with what was guessed since */
void start_write(struct start *s);

/* Keeps a guess and prints it. `change`: the option or the field that changes it; "" if nothing does. */
void start_guess(struct start *s, const char *what, const char *took, const char *change,
	const char *why, ...) __attribute__((format(printf, 5, 6)));

/* The scene's name: the folder's, as a word of a URL. */
void start_name(const char *folder, char name[64]);

/* A text, malloc'ed. */
char *start_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* A line for people, unless --quiet. */
void start_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* A path as seen from the folder that is written, malloc'ed. */
char *start_path(const struct start *s, const char *path);

static inline const char *start_column(const struct start *s, uint32_t column)
{
	return column == ECO_NONE ? NULL : s->table.columns[column];
}
