/* Lines and areas of files, such as roads, water and land use, drawn into the picture on the ground.
 *
 *   eco_drawing_open(&drawing, specs, count, &frame, &error);       reads all files, each in a child process
 *   eco_drawing_level(drawing, &ground, say, ctx);                  still water is flat
 *   options.drawing = eco_drawing_ground(drawing);                  for eco_ground_image_open
 *   eco_drawing_report(drawing, say, ctx);
 *   eco_drawing_close(drawing);
 *
 * A feature's class is a row of words/ground.tsv, found by its attributes; the class says colour, width and
 * what lies above what. Cairo draws (cairo_drawing.c): borders are smooth by a texel, and rings cross and
 * nest by the even-odd rule. */
#pragma once

#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/import/land/areas.h"

#define ECO_DRAWN_WIDE_M 100.0   /* no line is wider */
#define ECO_DRAW_MAX 64u         /* files of a scene */

/* ---- Classes ---- */

struct eco_land_class { const char *name, *plants; double spacing_m; bool line, drawn; };
/* Class number i; false: there are no more. */
bool eco_land_class(uint32_t i, struct eco_land_class *class);
/* Its number; ECO_NONE: none has that name. Or the class that a text's words tell, such as a file's name. */
uint32_t eco_land_class_named(const char *name);
uint32_t eco_land_class_told(const char *text, bool line);

/* Tests of the texts in a file's columns, in the order of the classes. */
struct eco_land_reader { struct eco_land_test *tests; uint32_t count, capacity; };
void eco_land_reader_open(struct eco_land_reader *reader, char *const *columns, uint32_t count);
void eco_land_reader_close(struct eco_land_reader *reader);
/* The class of a feature with these texts; *column: the one that told it (may be NULL). ECO_NONE: none. */
uint32_t eco_land_class_of(const struct eco_land_reader *reader, const char *const *fields, uint32_t field_count, bool line,
	uint32_t *column);

/* ---- Drawing ---- */

struct eco_draw_spec {           /* texts are owned by the spec's maker; NULL: not given */
	char *path, *layer, *crs;
	char *class;             /* of all features; NULL: by their attributes */
	char *width;             /* column of metres; NULL: width_m, or where it is 0 the class's */
	double width_m;
	struct eco_filter *filters; uint32_t filter_count;
	uint32_t line, column;   /* in the scene file, for messages */
};

struct eco_drawing;
/* `specs` must outlive it, `frame` need not. Errors name the file and what to add. */
enum eco_code eco_drawing_open(struct eco_drawing **drawing, const struct eco_draw_spec *specs, uint32_t count,
	const struct eco_frame *frame, struct eco_error *error);
/* NULL where nothing is left to draw. Valid until the drawing is closed. */
const struct eco_ground_drawing *eco_drawing_ground(const struct eco_drawing *drawing);
/* Levels the ground, which has no margins yet, below each area of water whose samples differ by at most
 * ECO_STILL_M: at its lowest. Steeper water flows, and stays. */
#define ECO_STILL_M 3.0
void eco_drawing_level(const struct eco_drawing *drawing, struct eco_ground *ground, void (*say)(void *ctx, const char *text),
	void *ctx);
/* Number i of all that is drawn, from the lowest to the topmost: an area of a file, its class's name; false: no more. */
bool eco_drawing_feature(const struct eco_drawing *drawing, uint32_t i, const struct eco_areas **areas, uint32_t *area,
	const char **class, const struct eco_draw_spec **spec);
/* Class number i: its name, colour and the features of it that are drawn; false: there are no more. */
bool eco_drawing_class(const struct eco_drawing *drawing, uint32_t i, const char **name, uint8_t rgb[3], uint64_t *features);
/* Whether water is drawn, whose alpha is ECO_GROUND_WATER. */
bool eco_drawing_has_water(const struct eco_drawing *drawing);
/* Reports what is drawn and what was left out: a line per call. */
void eco_drawing_report(const struct eco_drawing *drawing, void (*say)(void *ctx, const char *text), void *ctx);
void eco_drawing_close(struct eco_drawing *drawing);

/* Inside ecocairo.so: as struct eco_ground_drawing's paint; `drawing` is a struct eco_drawing. */
enum eco_code cairo_drawing_paint(const void *drawing, const double low[2], double texel_m, uint8_t *rgba,
	struct eco_error *error);
