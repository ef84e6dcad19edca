/* Inside `ecopack map`: everything seen from above, without building a model.
 *
 *   map_gather(&map, scene)       scene files, ground, inventories: kinds, points, rows      map_places.c
 *   map_write(&map, path, size)   the part of the world in the picture, the ground's image    map_command.c
 *     eco_cairo_module->map_png   the picture                                                  cairo_map.h
 *   write_table(...)             or, in place of a picture, all plants as points for a GIS
 *   map_free(&map) */
#pragma once

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/scene/scene.h"

#define MAP_COLORS 9u            /* kinds with a colour of their own */

struct map_kind {                /* plants of one name, in whatever file */
	char name[64];
	uint64_t count;              /* plants of a nested file count each time it is placed */
	double low_m, high_m;        /* known heights; INFINITY, -INFINITY: none */
	uint32_t color;              /* MAP_COLORS: the common gray */
};

/* metres from the origin; height 0: not known; species: of m->species; row of an inventory, from 1; 0: it is
 * of none; line of the file, from 1; 0: it has none; class: 1 + that of m->tints, 0: it has none */
struct map_point { float x, y, height_m, crown_m, base; uint32_t kind, species, file, row, line, class; };
struct map_points { struct map_point *items; uint32_t count, capacity; };

struct map_bounds { double low[2], high[2]; };   /* low > high: empty */

/* A line of the report on an inventory or areas (positions.h): the file's, or after spaces one about its rows. */
struct map_line { char text[240]; };

/* bounds of a nested file, turned: x and y */
struct map_outline { double corners[8]; char name[64]; };
struct map_edges { double *ends; uint32_t count, capacity; };     /* x0, y0, x1, y1 each, metres */

struct map {
	struct eco_error *error;
	const char *scene, *output;  /* files */
	uint32_t pixels;             /* of the picture's longer side */
	struct eco_sources sources;
	struct eco_ground ground;    bool has_ground;
	struct map_kind *kinds;      uint32_t kind_count, other_count;
	uint32_t **kind_of;          /* [source][plant of the source] */
	struct eco_string_pool species;    /* as rows state them ("": none), else the kinds' names */
	struct eco_tints tints;      /* of all files: where there are some, they colour the points */
	/* inventories, for the rows of points; of the sources */
	const char **files;          uint32_t file_count, file_capacity;
	struct map_points *own;      /* per source: its own plants, in its coordinates */
	struct map_bounds *bounds;   /* per source, with nested files */
	uint64_t *totals;            /* per source, with nested files */
	struct map_points points;    /* to be drawn: the outer file's, and nested files' if not too many */
	uint64_t not_expanded;       /* plants drawn only as outlines of their files */
	struct map_points left_points;           /* places of the outer file's rows that are left out */
	struct map_line *lines;      uint32_t line_count, line_capacity;
	struct map_outline *outlines; uint32_t outline_count, outline_capacity;
	/* areas of scattered plants, and features they keep clear of */
	struct map_edges areas, clear_of;
	uint64_t total, outside, off_ground, placements;
	double typical_m;            /* median of the known heights */
	/* the picture */
	uint8_t *image;              /* the ground's: pixels of the map, straight alpha; NULL: it has none */
	struct map_bounds view;      /* metres */
	double x, y, width, height;  /* pixels of the map */
	double scale;                /* pixels a metre */
	double low_m, high_m;        /* of the ground in view */
	double dot;                  /* radius of the typical height, pixels */
};

enum eco_code map_gather(struct map *m, const char *scene);
void map_free(struct map *m);

/* Draws the map of what was gathered, whose longer side gets `pixels`, and writes it as a PNG. Sorts the
 * points. */
enum eco_code map_write(struct map *m, const char *path, uint32_t pixels);

static inline void map_extend(struct map_bounds *b, double x, double y)
{
	b->low[0] = x < b->low[0] ? x : b->low[0];
	b->low[1] = y < b->low[1] ? y : b->low[1];
	b->high[0] = x > b->high[0] ? x : b->high[0];
	b->high[1] = y > b->high[1] ? y : b->high[1];
}
#define MAP_NOTHING ((struct map_bounds){ { INFINITY, INFINITY }, { -INFINITY, -INFINITY } })
static inline bool map_is_empty(const struct map_bounds *b) { return !(b->low[0] <= b->high[0]); }

/* ends: x0, y0, x1, y1. */
static inline void map_add_edge(struct map_edges *edges, const double ends[4])
{
	eco_grow(&edges->ends, &edges->capacity, edges->count, 4 * sizeof *ends);
	memcpy(edges->ends + 4 * (size_t)edges->count++, ends, 4 * sizeof *ends);
}

/* Heights of a kind; "" if none is known. */
static inline const char *map_range_text(const struct map_kind *kind, char text[32])
{
	text[0] = 0;
	if (kind->low_m < kind->high_m * 0.995)
		snprintf(text, 32, "%.3g to %.3g m", kind->low_m, kind->high_m);
	else if (kind->low_m <= kind->high_m)
		snprintf(text, 32, "%.3g m", kind->high_m);
	return text;
}

/* A place in metres to pixels. */
static inline double map_x(const struct map *m, double x) { return m->x + (x - m->view.low[0]) * m->scale; }
static inline double map_y(const struct map *m, double y) { return m->y + (m->view.high[1] - y) * m->scale; }
