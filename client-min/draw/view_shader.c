/* One text for all programs; what a program needs is switched on by a #define, so that a scene without lines
 * compiles no lines. Longer than 600 lines: parts of the text are shared by most programs.
 *
 * Geometry: positions are taken to view space (right, up, forward; metres from the eye) by one float matrix
 * an instance, made in doubles, as lod/raster/raster.h does; y points down in the picture, so that row 0 is
 * the top and the same corner rule applies; depth is near / distance. Elements are scaled about their centre
 * by the root of their area factor: what each growth code comes to at the cut's scale is a uniform, as is the
 * side of a point of each size code.
 *
 * The result is not a picture yet, but the input of view_light.h: of each pixel four words, as
 * view_gl.h has them. With SHADOW it is a shadow map: a picture in which W is distance, whose depths are
 * heights towards the sun; the rules are those of view_shadow_cast.c. */
#include "client-min/draw/view_shader.h"

#include <epoxy/gl.h>

#include "client-min/draw/view_shadow.h"
#include "ecofiles/format/list.h"
#include "lod/hash.h"
#include "lod/leaf.h"

const char *const view_program_names[VIEW_PROGRAM_COUNT] = { "triangles", "textured", "lines", "points",
	"summary", "splats", "ground", "impostors", "leafy points", "leafy splats",
	"leafy impostors" };

#define TEXT(macro) TEXT_OF(macro)
#define TEXT_OF(value) #value

static const char head_desktop[] = "#version 450 core\n";
static const char head_es[] = "#version 300 es\n"
	"precision highp float; precision highp int; precision highp sampler2D; precision highp "
	"usampler2D;\n";

/* view_surface_direction and so on; the words are those of view_light.h. */
static const char common[] =
	"const uint FACET = 0u, AXIS = 1u, CLOUD = 2u, BALL = 3u, SUMMARY = 1u << 24;\n"
	"uint direction_word(vec3 d, int bits) {\n"
	"	d *= 1.0 / max(abs(d.x) + abs(d.y) + abs(d.z), 1e-30);\n"
	"	vec2 at = d.xy;\n"
	"	vec2 side = vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);\n"
	"	if (d.z < 0.0) at = (1.0 - abs(at.yx)) * side;\n"
	"	uvec2 whole = uvec2((at * 0.5 + 0.5) * float((1 << bits) - 1) + 0.5);\n"
	"	return whole.y << bits | whole.x;\n"
	"}\n"
	"uint surface_direction(uint kind, vec3 d) { return kind << 30 | direction_word(d, 15); }\n"
	"uint surface_ball(uint look, vec3 d) { return BALL << 30 | look << 20 | direction_word(d, 10); }\n"
	/* texels by number, as view_gpu.h lays them out */
	"uniform highp usampler2D u_records;\n"
	"uniform highp ivec3 u_shift;    // of records, instances, members\n"
	"uvec4 texel_of(highp usampler2D texels, int shift, int i) {\n"
	"	return texelFetch(texels, ivec2(i & ((1 << shift) - 1), i >> shift), 0);\n"
	"}\n"
	"uvec4 record_at(int i) { return texel_of(u_records, u_shift.x, i); }\n";

/* A fragment's ellipse, in as few vectors as possible, as software drivers make a copy for
 * each primitive; and what all share is among it, as they look up uniforms pixel by pixel
 * (lod/EXPERIMENTS.md, A frame's time). Then lod_splat_covers. */
static const char splat_common[] =
	"#ifdef ELLIPSE\n"
	"FLAT vec4 v_ellipse;            // x, y of the centre, lean, half\n"
	"FLAT vec4 v_near_side;          // of the centre, aside, below, bulge\n"
	"#if TEXELS == 4\n"
	"FLAT vec4 v_normals[3];\n"
	"#define HEIGHT v_normals[0].w\n"
	"#define HALF (vec2(v_seen.y & 65535u, v_seen.y >> 16) * 0.5)\n"
	"#define NEAR v_normals[1].w\n"
	"#define BALL_LOOK uint(v_normals[2].w)  // how large, how level: bits 20 on of its surface\n"
	"#else\n"
	"FLAT vec4 v_frame;\n"
	"#define HEIGHT v_frame.x\n"
	"#define HALF v_frame.yz\n"
	"#define NEAR v_frame.w\n"
	"#endif\n"
	"bool splat_covers(uvec4 seen, uvec2 pixel) {\n"
	"	uint salt = seen.w, column = pixel.x, row = pixel.y, hash;\n"
	"	" TEXT(LOD_HASH_SPLAT) ";\n"
	"	return hash >> 24 < seen.z >> 24 << 4;\n"
	"}\n"
	"#endif\n";

/* Leaves on ellipses: a leaf_splat in four vectors, whose last numbers are ragged, amount (negative: wood, which is
 * smooth), opacity and deviation of tone; and the direction to the eye in plant space. */
#define LOD_LEAF_TEXT(...) #__VA_ARGS__
static const char leaf_common[] =
	"#ifdef LEAVES\n"
	"#define LEAF\n"
	"#define real(x) float(x)\n"
	"#define whole(x) uint(int(x))\n"
#include "lod/leaf.glsl"
	"\n"
	"float side_of(float leaf, float pixel) {\n"
	"	while (leaf < " TEXT(LOD_LEAF_PIXEL) " * pixel) leaf *= 2.0;\n"
	"	return leaf;\n"
	"}\n"
	"#ifdef ELLIPSE\n"
	"FLAT vec4 v_leaves[4];\n"
	"FLAT vec3 v_to_eye;\n"
	"#endif\n"
	"#endif\n";

static const char vertex_common[] =
	"uniform vec4 u_lens;            // 1/tan_x, 1/tan_y, near\n"
	"uniform vec2 u_middle;          // lod_eye\n"
	"vec4 project(vec3 v) {\n"
	"	v.xy -= u_middle * v.z;\n"
	"#ifdef ZERO_TO_ONE\n"
	"	return vec4(v.x * u_lens.x, -v.y * u_lens.y, u_lens.z, v.z);\n"
	"#else\n"
	"	return vec4(v.x * u_lens.x, -v.y * u_lens.y, 2.0 * u_lens.z - v.z, v.z);\n"
	"#endif\n"
	"}\n";

/* A map's rows are from its corner; view space is from its middle, and down. Lengths across beams and along
 * them are those of the plant. */
static const char vertex_shadow[] =
	"#ifdef SHADOW\n"
	"uniform highp usampler2D u_map;\n"
	"out float v_height;\n"
	"vec4 map_row(int i) { return uintBitsToFloat(texelFetch(u_map, ivec2(i, 0), 0)); }\n"
	"vec4 of_plant(vec4 row, vec4 world[3]) {\n"
	"	return row.x * world[0] + row.y * world[1] + row.z * world[2] + vec4(0.0, 0.0, 0.0, row.w);\n"
	"}\n"
	"vec3 axis_across(vec3 sun, int i) {\n"
	"	vec3 first = normalize(cross(sun, abs(sun.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));\n"
	"	return i == 0 ? first : cross(sun, first);\n"
	"}\n"
	"#endif\n";

static const char vertex_plant[] =
	"uniform highp usampler2D u_instances, u_members;\n"
	/* splats have twice HALF in place of a surface */
	"flat out uvec4 v_seen;          // whose, surface, colour; of ellipses opacity << 24, salt\n"
	"uniform int u_first_member;\n"
	"uniform int u_first;            // the first primitive, where gl_VertexID does not begin with it\n"
	"uniform float u_scale;\n"
	"uniform vec4 u_tint;            // rgb, if w is 1: instead of a colour of its own\n"
	"uniform uint u_path;            // summaries: what the placement adds to the owner\n"
	"vec3 xyz(uvec4 t) { return uintBitsToFloat(t.xyz); }\n"
	"struct Plant { vec4 row[3]; uint whose; float scale, half_width, width; vec4 high; };\n"
	"Plant plant_of_member(int member) {\n"
	"	int number = int(texel_of(u_members, u_shift.z, u_first_member + member).x);\n"
	"	int at = number * 4;\n"
	"	Plant p;\n"
	"	for (int k = 0; k < 3; k++)\n"
	"		p.row[k] = uintBitsToFloat(texel_of(u_instances, u_shift.y, at + k));\n"
	"	uvec4 t = texel_of(u_instances, u_shift.y, at + 3);\n"
	"	p.whose = uint(number) + 1u;\n"
	"	p.scale = uintBitsToFloat(t.x); p.half_width = uintBitsToFloat(t.y);\n"
	"	p.width = uintBitsToFloat(t.z);\n"
	"#ifdef SHADOW\n"
	"	vec4 world[3] = p.row, w = map_row(2);\n"
	"	p.row[0] = of_plant(map_row(0) - w / u_lens.x, world);\n"
	"	p.row[1] = of_plant(w / u_lens.y - map_row(1), world);\n"
	"	p.row[2] = of_plant(w, world);\n"
	"	p.high = of_plant(map_row(3), world);\n"
	"#endif\n"
	"	return p;\n"
	"}\n"
	"vec3 sun_of(Plant p) { return p.high.xyz / p.scale; }\n"
	"float height_of(Plant p, vec3 a) { return dot(p.high.xyz, a) + p.high.w; }\n"
	"vec3 view_of(Plant p, vec3 a) {\n"
	"	return vec3(dot(p.row[0].xyz, a), dot(p.row[1].xyz, a), dot(p.row[2].xyz, a)) + "
	"vec3(p.row[0].w, p.row[1].w, p.row[2].w);\n"
	"}\n"
	"vec3 axis_of(Plant p, vec3 h) {         // y down\n"
	"	return vec3(dot(p.row[0].xyz, h), -dot(p.row[1].xyz, h), dot(p.row[2].xyz, h));\n"
	"}\n"
	"uint color_of(uint word) {\n"
	"	uvec3 tint = uvec3(u_tint.rgb * 255.0 + 0.5);\n"
	"	return u_tint.w > 0.0 ? tint.r | tint.g << 8 | tint.b << 16 : word & 0xffffffu;\n"
	"}\n";

static const char vertex_triangles[] =
	"uniform float u_edges[" TEXT(ECO_GROWTHS) "];\n"
	"out vec2 v_uv;\n"
	"void main() {\n"
	"	Plant p = plant_of_member(gl_InstanceID);\n"
	"	int corner = gl_VertexID % 3, at = gl_VertexID / 3 * TEXELS;\n"
	"	uvec4 t0 = record_at(at), t1 = record_at(at + 1), t2 = "
	"record_at(at + 2);\n"
	"	uvec4 t3 = record_at(at + 3);\n"
	"	vec3 a = xyz(t0), b = xyz(t1), c = xyz(t2), center = uintBitsToFloat(uvec3(t1.w, t2.w, "
	"t3.x));\n"
	"	vec3 at_corner = corner == 0 ? a : corner == 1 ? b : c, n = cross(b - a, c - a);\n"
	"	float edge = u_edges[t0.w >> 24];\n"
	"	if (edge != 1.0) at_corner = center + (at_corner - center) * edge;\n"
	"	n /= max(length(n), 1e-20);\n"
	"	v_seen = uvec4(p.whose, surface_direction(FACET, n), color_of(t0.w), 0u);\n"
	"	v_uv = vec2(0.0);\n"
	"#if TEXELS == 5\n"
	"	uvec4 t4 = record_at(at + 4);\n"
	"	v_uv = uintBitsToFloat(corner == 0 ? t3.yz : corner == 1 ? uvec2(t3.w, t4.x) : t4.yz);\n"
	"#endif\n"
	"	gl_Position = project(view_of(p, at_corner));\n"
	"#ifdef SHADOW\n"
	"	v_height = height_of(p, at_corner);\n"
	"#endif\n"
	"}\n";

static const char vertex_lines[] =
	"void main() {\n"
	"	Plant p = plant_of_member(gl_InstanceID);\n"
	"	int corner = gl_VertexID & 3, at = ((gl_VertexID >> 2) + u_first) * 2;\n"
	"	uvec4 t0 = record_at(at), t1 = record_at(at + 1);\n"
	"	vec3 a = xyz(t0), b = xyz(t1);\n"
	"	LINE_SCALE\n"
	"	bool at_b = corner == 1 || corner == 2, plus = corner >= 2;\n"
	"#ifdef SHADOW\n"
	"	vec3 side = cross(b - a, sun_of(p));\n"
	"	float half_width = 0.5 * width;\n"
	"#else\n"
	"	vec3 va = view_of(p, a), vb = view_of(p, b), side = cross(vb - va, 0.5 * (va + vb));\n"
	"	float half_width = 0.5 * width * p.scale;\n"
	"#endif\n"
	"	float len2 = dot(side, side);\n"
	"	vec3 offset = side * (half_width * inversesqrt(max(len2, 1e-38)));\n"
	"	offset = plus ? offset : -offset;\n"
	"#ifdef SHADOW\n"
	"	vec3 place = (at_b ? b : a) + offset, view = view_of(p, place);\n"
	"	v_height = height_of(p, place);\n"
	"#else\n"
	"	vec3 view = (at_b ? vb : va) + offset;\n"
	"#endif\n"
	"	v_seen = uvec4(p.whose, surface_direction(AXIS, b - a), color_of(t1.w), 0u);\n"
	"	gl_Position = len2 > 0.0 && half_width > 0.0 ? project(view) : vec4(2.0, 2.0, 2.0, 1.0);\n"
	"}\n";

/* u_level: eco_level_share, in 1/255. Ellipses as lod/splat.h has them. Each is a point as large as the
 * pixels whose middles lie within its sides, of which the fragment shader tells those that it covers; one
 * that covers none is not drawn. Where some may be larger than the driver's points (u_corners is 3, not 1)
 * each is the least triangle around its ellipse, and a quarter of a pixel more, as drivers round vertices.
 * All plants of a cut are one instance: drivers begin anew with each (lod/EXPERIMENTS.md, A frame's time). */
static const char vertex_points[] =
	"#if TEXELS == 2\n"
	"uniform int u_halvings;         // of scattered points\n"
	"uniform float u_reach;          // of a point before it is scattered\n"
	/* lod/scattered.c */
	"vec3 scatter_offset(uint point, uint part) {\n"
	"	uint hash;\n"
	"	" TEXT(LOD_HASH_SCATTER) ";\n"
	"	ivec3 a = ivec3(uvec3(hash, hash >> 10, hash >> 20) & 31u), b = ivec3(uvec3(hash >> 5, hash "
	">> 15, hash >> 25) & 31u);\n"
	"	return vec3(a + b - 31) / 32.0;\n"
	"}\n"
	"#endif\n"
	"uniform float u_sides[" TEXT(ECO_SIZES) "];\n"
	"uniform uint u_level;\n"
	"uniform vec2 u_half, u_window;  // of the picture and of the viewport, pixels\n"
	"uniform int u_corners, u_count; // of an ellipse; of a plant's ellipses\n"
	"uniform uint u_sample;\n"
	"uniform vec2 u_leaf;            // width of a leaf, deviation of tone\n"
	"uint salt_of(uvec3 bits) {\n"
	"	uint x = bits.x, y = bits.y, z = bits.z, nth = u_sample, salt;\n"
	"	" TEXT(LOD_HASH_SALT) ";\n"
	"	return salt;\n"
	"}\n"
	"bool covers_one(vec2 pixel, bool leafy, float grown) {  // or nearly so\n"
	"	vec2 at = pixel + 0.5 - u_half - v_ellipse.xy;\n"
	"	float v = at.y / HEIGHT, rest = 1.001 * grown * grown - v * v;\n"
	"	return rest >= 0.0 && abs(at.x - v_ellipse.z * at.y) <= v_ellipse.w * sqrt(rest) + 0.001\n"
	"		&& (leafy || splat_covers(v_seen, uvec2(ivec2(pixel))));\n"
	"}\n"
	"void main() {\n"
	"	int corner = gl_VertexID % u_corners, point = gl_VertexID / u_corners;\n"
	"	Plant p = plant_of_member(point / u_count);\n"
	"	point = point % u_count + u_first;\n"
	"#if TEXELS == 2\n"
	"	uint scattered = uint(point & ((1 << u_halvings) - 1));\n"
	"	point >>= u_halvings;\n"
	"#endif\n"
	"	int at = point * TEXELS;\n"
	"	uvec4 t0 = record_at(at);\n"
	"	vec3 middle_of = xyz(t0);\n"
	"#if TEXELS == 2\n"
	"	if (u_halvings > 0) middle_of += u_reach * scatter_offset(uint(point), scattered);\n"
	"#endif\n"
	"	vec3 view = view_of(p, middle_of);\n"
	"	vec2 focal = u_lens.xy * u_half, middle = vec2(view.x, -view.y) * focal / view.z;\n"
	"	mat3 axes, to_plant = mat3(0.0); // half axes in view space, y down; columns: normals of "
	"plant space\n"
	"	mat3 halves;                     // half axes in plant space\n"
	"	float reach = u_scale;\n"
	"#if TEXELS == 4\n"
	"	for (int k = 0; k < 3; k++) {\n"
	"		vec3 h = xyz(record_at(at + 1 + k));\n"
	"		halves[k] = h * u_scale;\n"
	"		axes[k] = axis_of(p, h) * u_scale;\n"
	"		to_plant[k] = h / max(dot(h, h), 1e-30);\n"
	"	}\n"
	"	uint opacity = t0.w >> 24 & 31u;\n"
	"#else\n"
	"	reach *= u_sides[t0.w >> 24];\n"
	"#ifdef SHADOW\n"
	"	axes = mat3(0.0);\n"
	"	for (int k = 0; k < 2; k++) axes[k] = reach * axis_of(p, axis_across(sun_of(p), k));\n"
	"#else\n"
	"	axes = mat3(reach * p.scale);\n"
	"	for (int k = 0; k < 3; k++) halves[k] = p.row[k].xyz * (k == 1 ? -reach : reach) / p.scale;\n"
	"#endif\n"
	"	uint opacity = 16u;\n"
	"#endif\n"
	"	bool leafy = false;\n"
	"	float grown = 1.0;\n"
	"#if TEXELS == 2\n"
	"	uvec4 t1 = record_at(at + 1);\n"
	"	p.whose = t1.x >> 30 | ((t1.y & ~t1.z) | ((t1.y + u_path) & t1.z)) << 2;\n"
	"#endif\n"
	"	float xx = 0.0, xy = 0.0, yy = 0.0, zz = 0.0;\n"
	"	vec2 to_z = vec2(0.0);\n"
	"	vec3 across, down;\n"
	"	for (int k = 0; k < 3; k++) {\n"
	"		vec2 d = (axes[k].xy * focal - axes[k].z * middle) / view.z;\n"
	"		float q = axes[k].z / view.z;\n"
	"		across[k] = d.x, down[k] = d.y;\n"
	"		xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;\n"
	"		to_z += d * q, zz += q * q;\n"
	"	}\n"
	"	float part = 1.0 / (1.0 - zz);\n"
	"	bool there = view.z >= u_lens.z && zz < 1.0 && xx > 0.0 && yy > 0.0 && xx < 1e30 && yy < "
	"1e30;\n"
	"	xx = (xx + to_z.x * to_z.x * part) * part;\n"
	"	xy = (xy + to_z.x * to_z.y * part) * part;\n"
	"	yy = (yy + to_z.y * to_z.y * part) * part;\n"
	"	middle -= to_z * part + vec2(u_middle.x, -u_middle.y) * focal;\n"
	"	float lean = xy / yy, cloud = p.half_width > 0.0 ? min(reach / p.half_width, 1.0) : 1.0;\n"
	"	float height = sqrt(yy);\n"
	"	v_ellipse = vec4(middle, lean, sqrt(max(xx - lean * xy, 0.0)));\n"
	"	vec2 slope = vec2(v_ellipse.w > 0.0 ? (to_z.x - lean * to_z.y) / v_ellipse.w : 0.0, to_z.y "
	"/ height);\n"
	"	float bulge = sqrt(max(zz - dot(slope, slope), 0.0));\n"
	"	v_near_side = view.z * vec4(1.0, slope, bulge);\n"
	/* the point at (u, v) of the near side, in a space where the ellipsoid is a ball, is this matrix
	 * times (u, v, sqrt(1 - u^2 - v^2)); and so is its normal, which `to_plant` takes to plant space */
	"#if TEXELS == 4 || defined(LEAVES)\n"
	"	vec3 e_u = v_ellipse.w > 0.0 ? (across - lean * down) / v_ellipse.w : vec3(0.0), e_v = down "
	"/ height;\n"
	"	vec3 farther = vec3(axes[0].z, axes[1].z, axes[2].z) / view.z - slope.x * e_u - slope.y * "
	"e_v;\n"
	"	mat3 near_side = mat3(e_u, e_v, farther / -max(bulge, 1e-30));\n"
	"#endif\n"
	"#ifdef LEAVES\n"
	"	float pixel = view.z / (focal.y * p.scale);\n"
	"	float cells = 1.0 / (" TEXT(LOD_LEAF_LATTICE) " * side_of(u_leaf.x, pixel));\n"
	"	mat3 to_cells = halves * near_side * cells;\n"
	"	float radius = sqrt(v_ellipse.w * height), ragged = leaf_rim(min(u_leaf.x / (pixel * radius), "
	TEXT(LOD_LEAF_RAGGED) "), radius);\n"
	"	leafy = t0.w < 0x80000000u;\n"
	"	v_leaves[0] = vec4(to_cells[0], ragged);\n"
	"	v_leaves[1] = vec4(to_cells[1], leafy ? min(u_leaf.x / pixel, 1.0) : -1.0);\n"
	"	v_leaves[2] = vec4(to_cells[2], float(opacity) / 16.0);\n"
	"	v_leaves[3] = vec4(middle_of * cells, u_leaf.y);\n"
	"	v_to_eye = -normalize(p.row[0].xyz * view.x + p.row[1].xyz * view.y + p.row[2].xyz * view.z);\n"
	"	if (leafy) grown = sqrt(1.0 + ragged);\n"
	"#endif\n"
	"#if TEXELS == 4\n"
	"	mat3 normals = to_plant * near_side;\n"
	"	v_normals[0] = vec4(normals[0], height);\n"
	"	float mean_half = pow(abs(dot(halves[0], cross(halves[1], halves[2]))), 1.0 / 3.0);\n"
	"	uint level = t0.w < 0x80000000u ? (u_level * 30u + 127u) / 255u : 0u;\n"
	"	v_normals[1] = vec4(normals[1], u_lens.z);\n"
	"	v_normals[2] = vec4(normals[2], float(level << 5 | uint(min(mean_half / p.half_width, 1.0) * 31.0 + 0.5)));\n"
	"	uint surface = uint(2.0 * u_half.x) | uint(2.0 * u_half.y) << 16;\n"
	"#else\n"
	"	v_frame = vec4(height, u_half, u_lens.z);\n"
	"	uint surface = CLOUD << 30 | u_level << 16 | uint(cloud * 65535.0 + 0.5);\n"
	"#endif\n"
	"#if TEXELS == 2\n"
	"	surface |= SUMMARY;\n"
	"#endif\n"
	"	v_seen = uvec4(p.whose, surface, color_of(t0.w) | opacity << 24, salt_of(t0.xyz));\n"
	"#ifdef LEAVES\n"
	"	if (leafy) v_seen.w = u_sample;\n"
	"#endif\n"
	/* the first and the last of columns and rows whose middles it may cover */
	"	vec2 sides = vec2(sqrt(xx), height) * grown + 0.01, from = middle + u_half - 0.5;\n"
	"	vec2 low = ceil(from - sides), high = floor(from + sides), size = high - low + 1.0;\n"
	"	there = there && min(size.x, size.y) > 0.0\n"
	"		&& min(high.x, high.y) >= 0.0 && low.x < 2.0 * u_half.x && low.y < 2.0 * u_half.y\n"
	"		&& (max(size.x, size.y) > 1.0 || covers_one(low, leafy, grown));\n"
	"	vec2 around = corner == 0 ? vec2(0.0, 2.0)\n"
	"		: vec2(corner == 1 ? 1.7320508 : -1.7320508, -1.0);\n"
	"	around *= vec2(v_ellipse.w, height) * grown + 0.25;\n"
	"	around.x += lean * around.y;\n"
	"	vec2 place = u_corners == 1 ? 0.5 * (low + high + 1.0) - u_half : middle + around;\n"
	"	gl_PointSize = max(size.x, size.y);\n"
	"	gl_Position = project(view);\n"
	"	gl_Position.xy = place / u_window * gl_Position.w;\n"
	/* a point that is not drawn lies beside the picture, yet within the viewport: drivers go a long way
	 * round with points that they have to clip */
	"#ifdef SHADOW\n"
	"	v_height = height_of(p, middle_of);\n"
	"#endif\n"
	"	if (there) return;\n"
	"	gl_PointSize = 1.0;\n"
	"	gl_Position = u_corners == 1 ? vec4(-1.0, -1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);\n"
	"}\n";

static const char vertex_ground[] =
	"uniform vec3 u_origin;          // of the anchor, view space\n"
	"uniform ivec3 u_anchor;         // the grid's point near the eye\n"
	"uniform vec3 u_step;\n"
	"uniform ivec3 u_columns;        // of the list; samples of the ring before the tile's first\n"
	"uniform ivec2 u_inner;          // columns and rows that are drawn\n"
	"uniform ivec4 u_seam;           // levels by which the neighbours in west, east, south, north are "
	"coarser\n"
	"uniform vec3 u_right, u_up, u_forward;\n"
	"out vec3 v_normal;\n"
	"int snapped(int i, int levels, int inner) { return min((i + ((1 << levels) >> 1)) >> levels << "
	"levels, inner - 1); }\n"
	"void main() {\n"
	/* a strip for each row of cells: north-west, south-west, north-east, south-east */
	"	ivec2 at = ivec2(gl_VertexID >> 1, gl_InstanceID + 1 - (gl_VertexID & 1));\n"
	"	ivec2 to = at;\n"
	"	if (at.x == 0) to.y = snapped(to.y, u_seam.x, u_inner.y);\n"
	"	if (at.x == u_inner.x - 1) to.y = snapped(to.y, u_seam.y, u_inner.y);\n"
	"	if (at.y == 0) to.x = snapped(to.x, u_seam.z, u_inner.x);\n"
	"	if (at.y == u_inner.y - 1) to.x = snapped(to.x, u_seam.w, u_inner.x);\n"
	"	uvec4 t = record_at((to.y + u_columns.z) * u_columns.x + to.x + u_columns.y);\n"
	"	ivec3 whole = ivec3(t.xyz);\n"
	"	vec3 p = vec3(whole - u_anchor) * u_step;\n"
	"	vec3 view = vec3(dot(u_right, p), dot(u_up, p), dot(u_forward, p)) + u_origin;\n"
	"	vec2 n = vec2(ivec2(t.ww) << ivec2(16, 0) >> 16) / 32767.0;\n"
	"	v_normal = vec3(n, sqrt(max(1.0 - dot(n, n), 0.0)));\n"
	"	gl_Position = project(view);\n"
	"}\n";

static const char fragment_common[] =
	"#ifdef SHADOW\n"
	"in float v_height;\n"
	VIEW_SHADOW_DEPTH
	"#else\n"
	"out uvec4 o_seen;               // view_gl_target\n"
	"#endif\n"
	"uint color_word(uvec3 c) { return c.r | c.g << 8 | c.b << 16; }\n";

static const char fragment_leaf[] =
	"#ifdef LEAVES\n"
	/* as leaf_of in view_mesh.c */
	"void look_leaf(uint leaf, vec3 to_eye, float tone, vec3 normal, inout uint surface, inout uint color) {\n"
	"	uint look = leaf_look(leaf), side = leaf_side(look);\n"
	"	vec3 own = vec3(uvec3(color, color >> 8, color >> 16) & 255u);\n"
	"	color = color_word(uvec3(min(sqrt(leaf_tone(leaf, look, tone)) * own + 0.5, 255.0)));\n"
	"	bool lit = leaf_is_lit(leaf, look);\n"
	"#if TEXELS == 4\n"
	"	uint reach = BALL_LOOK & 31u;\n"
	"	float level = float(BALL_LOOK >> 5) / 30.0;\n"
	"	if (!lit) surface = surface_ball(BALL_LOOK, normal);\n"
	"#else\n"
	"	uint reach = uint(float(surface & 65535u) * (31.0 / 65535.0) + 0.5);\n"
	"	float level = float(surface >> 16 & 255u) / 255.0;\n"
	"#endif\n"
	"	if (!lit) return;\n"
	"	if (leaf_is_level(look, leaf_level(level, to_eye.z))) normal = vec3(0.0, 0.0, 1.0);\n"
	"#if TEXELS == 4\n"
	"	else if (leaf_is_surface(look)) normal += 0.05 * to_eye;\n"
	"#endif\n"
	"	else normal = to_eye + normalize(vec3(leaf_turn(side, 0u), leaf_turn(side, 1u), leaf_turn(side, 2u)));\n"
	"	surface = surface_ball(31u << 5 | reach, normal);\n"
	"}\n"
	"#endif\n";

static const char fragment_plant[] =
	"flat in uvec4 v_seen;\n"
	"#ifdef ELLIPSE\n"
	"float shown(inout uint surface, inout uint color) {     // 1 / distance; 0: nothing\n"
	"	vec2 at = gl_FragCoord.xy - HALF - v_ellipse.xy;\n"
	"	float v = at.y / HEIGHT, u = (at.x - v_ellipse.z * at.y) / v_ellipse.w;\n"
	"	float rest = 1.0 - v * v - u * u;\n"
	"#ifdef LEAVES\n"
	"	uint leaf = 0u;\n"
	"	if (v_leaves[1].w >= 0.0) {\n"
	"		leaf_splat leaves = leaf_splat(v_leaves[3].x, v_leaves[0].x, v_leaves[1].x, v_leaves[2].x,\n"
	"			v_leaves[3].y, v_leaves[0].y, v_leaves[1].y, v_leaves[2].y, v_leaves[3].z, v_leaves[0].z,\n"
	"			v_leaves[1].z, v_leaves[2].z, v_leaves[0].w, v_leaves[2].w, v_leaves[1].w, v_seen.w);\n"
	"		leaf = leaf_at(leaves, u, v);\n"
	"		if (leaf == 0u) return 0.0;\n"
	"		rest = leaf_height2(leaves, leaf & 3u, u, v);\n"
	"	} else\n"
	"#endif\n"
	"	if (!(rest >= 0.0) || !splat_covers(v_seen, uvec2(gl_FragCoord.xy))) return 0.0;\n"
	"	vec3 side = vec3(u, v, sqrt(rest)), normal = vec3(0.0, 0.0, 1.0);\n"
	"#if TEXELS == 4\n"
	"	normal = mat3(v_normals[0].xyz, v_normals[1].xyz, v_normals[2].xyz)\n"
	"		* vec3(u, v, sqrt(max(1.0 - v * v - u * u, 0.0)));    // leaves of all shells are turned alike\n"
	"#endif\n"
	"#ifdef LEAVES\n"
	"	if (leaf != 0u) look_leaf(leaf, v_to_eye, v_leaves[3].w, normalize(normal), surface, color);\n"
	"	else\n"
	"#endif\n"
	"#if TEXELS == 4\n"
	"	surface = surface_ball(BALL_LOOK, normal);\n"
	"#else\n"
	"	{}\n"
	"#endif\n"
	"	float far = v_near_side.x + v_near_side.y * u + v_near_side.z * v\n"
	"		- v_near_side.w * side.z;\n"
	"	return 1.0 / max(far, NEAR);\n"
	"}\n"
	"#endif\n"
	"#if TEXELS == 5\n"
	"in vec2 v_uv;\n"
	"uniform sampler2D u_texture;\n"
	"uniform vec4 u_tint;\n"
	"vec3 light_of(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, "
	"c)); }\n"
	"vec3 bytes_of(vec3 c) { return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, "
	"step(0.0031308, c)); }\n"
	"#endif\n"
	"void main() {\n"
	"	float nearness = gl_FragCoord.w;\n"
	"	uint surface = v_seen.y, color = v_seen.z;\n"
	"#ifdef ELLIPSE\n"
	"	nearness = shown(surface, color);\n"
	"	if (nearness == 0.0) discard;\n"
	"#ifndef SHADOW\n"
	"	gl_FragDepth = nearness * NEAR;\n"
	"#endif\n"
	"#endif\n"
	"#if TEXELS == 5\n"
	/* coverage by the nearest texel, as the rasteriser; colours are filtered, and clear texels hold their
	 * neighbours' */
	"	ivec2 size = textureSize(u_texture, 0), texel = ivec2(floor(v_uv * vec2(size)));\n"
	"	texel = clamp(texel - size * ivec2(floor(vec2(texel) / vec2(size))), ivec2(0), size - 1);\n"
	"	vec3 own = light_of(vec3(uvec3(color, color >> 8, color >> 16) & 255u) / 255.0);\n"
	"	own = bytes_of(own * texture(u_texture, v_uv).rgb);\n"
	"	if (texelFetch(u_texture, texel, 0).a < 0.5) discard;\n"
	"	if (u_tint.w == 0.0) color = color_word(uvec3(own * 255.0 + 0.5));\n"
	"#endif\n"
	"#ifdef SHADOW\n"
	"	gl_FragDepth = shadow_depth(v_height);\n"
	"#else\n"
	"	o_seen = uvec4(v_seen.x, surface, floatBitsToUint(nearness), color);\n"
	"#endif\n"
	"}\n";

static const char fragment_ground[] =
	"in vec3 v_normal;\n"
	"void main() {\n"
	"	uint surface = surface_direction(FACET, v_normal);\n"
	"	o_seen = uvec4(0u, surface, floatBitsToUint(gl_FragCoord.w), 0u);\n"
	"}\n";

#define ELLIPSES(texels) "#define TEXELS " #texels "\n#define ELLIPSE 1\n"
static const struct { const char *name, *defines, *shared, *vertex, *fragment;
	} programs[VIEW_PROGRAM_COUNT] = {
	[VIEW_PROGRAM_TRIANGLES] = { "triangles", "#define TEXELS 4\n", vertex_plant, vertex_triangles,
		fragment_plant },
	[VIEW_PROGRAM_TEXTURED] = { "textured triangles", "#define TEXELS 5\n", vertex_plant,
		vertex_triangles, fragment_plant },
	[VIEW_PROGRAM_LINES] = { "lines", "#define TEXELS 3\n"
		"#define LINE_SCALE float width = uintBitsToFloat(t0.w); { vec3 m = 0.5 * (a + b); a = m + "
		"(a - m) * u_scale;"
		" b = m + (b - m) * u_scale; width *= u_scale; }\n", vertex_plant, vertex_lines,
		fragment_plant },
	[VIEW_PROGRAM_POINTS] = { "points", ELLIPSES(1), vertex_plant, vertex_points, fragment_plant },
	[VIEW_PROGRAM_SUMMARY] = { "summary points", ELLIPSES(2), vertex_plant, vertex_points,
	fragment_plant }, [VIEW_PROGRAM_SPLATS] = { "splats", ELLIPSES(4), vertex_plant, vertex_points,
	fragment_plant }, [VIEW_PROGRAM_GROUND] = { "ground", "", "", vertex_ground, fragment_ground },
	[VIEW_PROGRAM_IMPOSTORS] = { "impostors", "", vertex_plant, view_shader_impostor_vertex,
		view_shader_impostor_fragment },
	[VIEW_PROGRAM_LEAFY_IMPOSTORS] = { "impostors with leaves", "#define LEAVES 1\n#define TEXELS 0\n", vertex_plant,
		view_shader_impostor_vertex, view_shader_impostor_fragment },
	[VIEW_PROGRAM_LEAFY_POINTS] = { "points with leaves", "#define LEAVES 1\n" ELLIPSES(1), vertex_plant,
		vertex_points, fragment_plant },
	[VIEW_PROGRAM_LEAFY_SPLATS] = { "splats with leaves", "#define LEAVES 1\n" ELLIPSES(4), vertex_plant,
		vertex_points, fragment_plant },
};

static const char *const uniform_names[VIEW_UNIFORM_COUNT] = { "u_right", "u_up", "u_forward", "u_lens",
	"u_origin", "u_first_member", "u_scale", "u_tint", "u_columns", "u_records", "u_instances",
	"u_members",
	"u_texture", "u_path", "u_anchor", "u_step", "u_inner", "u_seam", "u_edges", "u_sides",
	"u_level", "u_half", "u_first_record", "u_window", "u_corners",
	"u_surface", "u_shift", "u_first", "u_halvings", "u_reach", "u_count", "u_map", "u_middle", "u_sample", "u_leaf" };

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
		eco_fail(error, ECO_UNSUPPORTED, "the graphics driver does not compile the program for %s: %s",
			what, log);
		glDeleteProgram(program);
	}
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	return linked ? program : 0;
}

enum eco_code view_shader_compile(struct view_shader *shader, enum view_program which, bool shadow,
	const struct view_dialect *dialect, struct eco_error *error)
{
	const char *start = dialect->es ? head_es : head_desktop;
	const char *depth = dialect->depth_zero_to_one ? "#define ZERO_TO_ONE 1\n" : "";
	const char *target = shadow ? "#define SHADOW 1\n" : "";
	const char *vs[] = { start, "#define FLAT flat out\n", depth, target, programs[which].defines, common,
		splat_common, leaf_common, vertex_common, vertex_shadow, programs[which].shared, programs[which].vertex };
	const char *fs[] = { start, "#define FLAT flat in\n", target, programs[which].defines, common,
		splat_common, leaf_common, fragment_common, fragment_leaf, programs[which].fragment };
	shader->program = view_shader_link(&(struct view_shader_text){ vs, 12, fs, 10 }, programs[which].name, error);
	if (!shader->program)
		return ECO_UNSUPPORTED;
	for (int i = 0; i < VIEW_UNIFORM_COUNT; i++)
		shader->uniform[i] = glGetUniformLocation(shader->program, uniform_names[i]);
	return ECO_OK;
}
