/* One text for all programs, view_shader.glsl; what a program needs is switched on by a #define. */
#include "client-min/draw/view_shader.h"

#include <epoxy/gl.h>

#include "client-min/draw/view_shadow.h"
#include "client-min/view_record.h"
#include "ecofiles/format/list.h"
#include "lod/hash.h"
#include "lod/impostor.h"
#include "lod/leaf.h"
#include "lod/tint.h"

const char *const view_program_names[VIEW_PROGRAM_COUNT] = { "triangles", "textured", "lines", "points",
	"summary", "splats", "ground", "impostors", "leafy points", "leafy splats",
	"leafy impostors" };

#define TEXT(macro) TEXT_OF(macro)
#define TEXT_OF(value) #value
#define DEFINE(macro) "#define " #macro " " TEXT(macro) "\n"

static const char head_desktop[] = "#version 450 core\n";
static const char head_es[] = "#version 300 es\n"
	"precision highp float; precision highp int; precision highp sampler2D; precision highp "
	"usampler2D;\n";

#define LOD_LEAF_TEXT(...) #__VA_ARGS__
static const char shared[] = DEFINE(ECO_GROWTHS) DEFINE(ECO_SIZES) DEFINE(LOD_HASH_SCATTER) DEFINE(LOD_HASH_SALT)
	DEFINE(LOD_HASH_SPLAT) DEFINE(LOD_LEAF_PIXEL) DEFINE(LOD_LEAF_RAGGED) DEFINE(LOD_LEAF_LATTICE)
	DEFINE(VIEW_WOOD) DEFINE(LOD_TINT_WHOLE) DEFINE(LOD_IMPOSTOR_HOPE) DEFINE(LOD_IMPOSTOR_LEAST) DEFINE(LOD_IMPOSTOR_LIGHT)
	"#define LOD_TINT_SHADE(wood, r, g, b) " TEXT(LOD_TINT_SHADE(wood, r, g, b)) "\n"
	"#define LOD_TINT_WOOD(share, r, g, b) " TEXT(LOD_TINT_WOOD(share, r, g, b)) "\n"
	"#define LOD_TINT_MIX(light, leaves, tint, shade) "
	TEXT(LOD_TINT_MIX(sqrt, min, light, leaves, tint, shade)) "\n"
	"#define LOD_IMPOSTOR_DEEP(need, opacity) " TEXT(LOD_IMPOSTOR_DEEP(need, opacity)) "\n"
	"#ifdef LEAVES\n"
	"#define LEAF\n"
	"#define real(x) float(x)\n"
	"#define whole(x) uint(int(x))\n"
#include "lod/leaf.glsl"
	"\n#endif\n";

static const char programs_text[] =
#include "build/text/client-min/draw/view_shader.glsl"
	;

#define ELLIPSES(texels) "#define ELLIPSE\n#define TEXELS " #texels "\n"
static const struct { const char *name, *defines; } programs[VIEW_PROGRAM_COUNT] = {
	[VIEW_PROGRAM_TRIANGLES] = { "triangles", "#define TRIANGLES\n#define TEXELS 4\n" },
	[VIEW_PROGRAM_TEXTURED] = { "textured triangles", "#define TRIANGLES\n#define TEXELS 5\n" },
	[VIEW_PROGRAM_LINES] = { "lines", "#define LINES\n#define TEXELS 3\n" },
	[VIEW_PROGRAM_POINTS] = { "points", ELLIPSES(1) },
	[VIEW_PROGRAM_SUMMARY] = { "summary points", ELLIPSES(2) },
	[VIEW_PROGRAM_SPLATS] = { "splats", ELLIPSES(4) },
	[VIEW_PROGRAM_GROUND] = { "ground", "#define GROUND\n" },
	[VIEW_PROGRAM_IMPOSTORS] = { "impostors", "#define IMPOSTORS\n" },
	[VIEW_PROGRAM_LEAFY_IMPOSTORS] = { "impostors with leaves",
		"#define IMPOSTORS\n#define LEAVES\n#define TEXELS 0\n" },
	[VIEW_PROGRAM_LEAFY_POINTS] = { "points with leaves", "#define LEAVES\n" ELLIPSES(1) },
	[VIEW_PROGRAM_LEAFY_SPLATS] = { "splats with leaves", "#define LEAVES\n" ELLIPSES(4) },
};

static const char *const uniform_names[VIEW_UNIFORM_COUNT] = { "u_right", "u_up", "u_forward", "u_lens",
	"u_origin", "u_first_member", "u_scale", "u_tint", "u_columns", "u_records", "u_instances",
	"u_members",
	"u_texture", "u_path", "u_anchor", "u_step", "u_inner", "u_seam", "u_edges", "u_sides",
	"u_level", "u_half", "u_first_record", "u_window", "u_corners",
	"u_surface", "u_shift", "u_first", "u_halvings", "u_reach", "u_count", "u_map", "u_middle", "u_sample",
	"u_leaf", "u_wood", "u_cover" };

static unsigned compile(unsigned program, unsigned type, const char *const *parts, int count)
{
	unsigned shader = glCreateShader(type);
	glShaderSource(shader, count, parts, NULL);
	glCompileShader(shader);
	glAttachShader(program, shader);
	return shader;
}

/* Linking says whether it compiles: so a browser's driver is waited for once, not three times. */
unsigned view_shader_link(const struct view_shader_text *text, const char *what, struct eco_error *error)
{
	unsigned program = glCreateProgram(), vertex = compile(program, GL_VERTEX_SHADER, text->vertex,
		text->vertex_count), fragment = compile(program, GL_FRAGMENT_SHADER, text->fragment,
		text->fragment_count);
	char log[400] = "";
	int linked = 0;
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &linked);
	if (!linked) {
		glGetShaderInfoLog(vertex, sizeof log, NULL, log);
		if (!log[0])
			glGetShaderInfoLog(fragment, sizeof log, NULL, log);
		if (!log[0])
			glGetProgramInfoLog(program, sizeof log, NULL, log);
		eco_fail(error, ECO_UNSUPPORTED,
			"the graphics driver does not compile the program for %s: %s", what, log);
		glDeleteProgram(program);
	}
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	return linked ? program : 0;
}

enum eco_code view_shader_compile(struct view_shader *shader, enum view_program which,
	enum view_variant variant, const struct view_dialect *dialect, struct eco_error *error)
{
	static const char *const of_variant[VIEW_VARIANTS] = { "", "#define SHADOW\n", "#define TINTED\n" };
	const char *start = dialect->es ? head_es : head_desktop, *defines = programs[which].defines;
	const char *vs[] = { start, "#define VERTEX\n#define FLAT flat out\n",
		dialect->depth_zero_to_one ? "#define ZERO_TO_ONE\n" : "", of_variant[variant], defines,
		shared, programs_text };
	const char *fs[] = { start, "#define FLAT flat in\n", of_variant[variant],
		variant == VIEW_VARIANT_SHADOW ? VIEW_SHADOW_DEPTH : "", defines,
		shared, programs_text };
	shader->program = view_shader_link(&(struct view_shader_text){ vs, 7, fs, 7 }, programs[which].name, error);
	if (!shader->program)
		return ECO_UNSUPPORTED;
	for (int i = 0; i < VIEW_UNIFORM_COUNT; i++)
		shader->uniform[i] = glGetUniformLocation(shader->program, uniform_names[i]);
	return ECO_OK;
}
