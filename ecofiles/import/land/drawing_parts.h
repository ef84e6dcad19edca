/* Shared by drawing.c and ecocairo.so; private. */
#pragma once

#include "ecofiles/import/land/drawing.h"

struct drawn { uint32_t class; float width_m, cover; uint8_t rgb[3]; };  /* a feature; width 0: an area */
struct drawn_file {
	const struct eco_draw_spec *spec;
	struct eco_areas areas;
	struct drawn *items; uint32_t capacity;  /* per area */
	struct eco_areas_report report;
	uint64_t unknown, thin;      /* features of no class that is known; lines without a width */
	struct { uint64_t count; char example[40]; } odd;        /* texts of widths that are none */
};
/* The sea as one area, by the coastlines (features of that class) in files, with which its edges agree:
 * coast.c. No area, and *gap: coastlines have gaps. */
enum eco_code drawing_sea(struct drawn_file *sea, const struct drawn_file *files, uint32_t count, uint32_t class, bool *gap,
	struct eco_error *error);

struct drawn_order { uint32_t file, area; };

struct eco_drawing {
	struct drawn_file *files; uint32_t file_count;   /* the sea is the last */
	bool has_sea, gap;
	struct drawn_order *order; uint32_t count;       /* from the lowest to the topmost */
	struct eco_ground_drawing ground;
};
