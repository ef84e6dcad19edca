/* The programs that draw, each compiled when something first needs it. */
#pragma once

#include <stdbool.h>

#include "ecofiles/base/status.h"

enum view_program { VIEW_PROGRAM_TRIANGLES, VIEW_PROGRAM_TEXTURED, VIEW_PROGRAM_LINES, VIEW_PROGRAM_POINTS,
	VIEW_PROGRAM_SUMMARY, VIEW_PROGRAM_SPLATS, VIEW_PROGRAM_GROUND, VIEW_PROGRAM_IMPOSTORS,
	/* with leaves on them (lod/leaf.h) */
	VIEW_PROGRAM_LEAFY_POINTS, VIEW_PROGRAM_LEAFY_SPLATS, VIEW_PROGRAM_LEAFY_IMPOSTORS,
	VIEW_PROGRAM_COUNT };

enum view_uniform { VIEW_U_RIGHT, VIEW_U_UP, VIEW_U_FORWARD, VIEW_U_LENS, VIEW_U_ORIGIN, VIEW_U_FIRST_MEMBER,
	VIEW_U_SCALE, VIEW_U_TINT, VIEW_U_COLUMNS, VIEW_U_RECORDS, VIEW_U_INSTANCES, VIEW_U_MEMBERS,
	VIEW_U_TEXTURE, VIEW_U_PATH, VIEW_U_ANCHOR, VIEW_U_STEP,
	VIEW_U_INNER, VIEW_U_SEAM, VIEW_U_EDGES, VIEW_U_SIDES, VIEW_U_LEVEL, VIEW_U_HALF,
	VIEW_U_FIRST_RECORD, VIEW_U_WINDOW, VIEW_U_CORNERS, VIEW_U_SURFACE, VIEW_U_SHIFT,
	VIEW_U_FIRST, VIEW_U_HALVINGS, VIEW_U_REACH, VIEW_U_COUNT, VIEW_U_MAP, VIEW_U_MIDDLE, VIEW_U_SAMPLE,
	VIEW_U_LEAF, VIEW_U_WOOD, VIEW_U_COVER,
	VIEW_UNIFORM_COUNT };

/* program 0: not compiled yet; uniform -1: unused */
struct view_shader { unsigned program; int uniform[VIEW_UNIFORM_COUNT]; };

extern const char *const view_program_names[VIEW_PROGRAM_COUNT];

struct view_dialect { bool es; bool depth_zero_to_one; };

/* SHADOW draws the same into a shadow map (view_gl_cast), TINTED plants with tints; neither is of the ground. */
enum view_variant { VIEW_VARIANT_PLAIN, VIEW_VARIANT_SHADOW, VIEW_VARIANT_TINTED, VIEW_VARIANTS };
enum eco_code view_shader_compile(struct view_shader *shader, enum view_program which,
	enum view_variant variant, const struct view_dialect *dialect, struct eco_error *error);

/* Parts of the texts of a program. */
struct view_shader_text {
	const char *const *vertex;
	int vertex_count;
	const char *const *fragment;
	int fragment_count;
};
/* 0, with *error: the driver refuses it. */
unsigned view_shader_link(const struct view_shader_text *text, const char *what, struct eco_error *error);
