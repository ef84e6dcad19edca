/* One text for all programs; what a program needs is switched on by a #define, so that a scene without lines
 * compiles no lines.
 *
 * Geometry: positions are taken to view space (right, up, forward; metres from the eye) by one float matrix
 * an instance, made in doubles, as lod/raster/raster.h does; y points down in the picture, so that row 0 is
 * the top and the same corner rule applies; depth is near / distance. Elements are scaled about their centre
 * by the root of their area factor: what each growth code comes to at the cut's scale is a uniform, as is the
 * side of a point of each size code.
 *
 * Light: a sun and a sky. A leaf reflects on its lit side and lets light through on the other, always seen
 * from the visible side; a crown shades itself towards its dark side and its inside. A point or line stands
 * for leaves of every direction, so it gets the mean of the same expressions over directions, and a plant
 * keeps its tone when its representation changes; a summary's point, which does not know where in a crown it
 * is, gets the mean over a crown as well, and so does a point as large as a crown. */
#include "client-min/view_shader.h"

#include <epoxy/gl.h>
#include <stdio.h>

#include "ecofiles/format/list.h"

const char *const view_program_names[VIEW_PROGRAM_COUNT] = { "triangles", "textured", "lines", "points",
	"summary", "ground", "sky" };

#define TEXT(macro) TEXT_OF(macro)
#define TEXT_OF(value) #value

static const char head_desktop[] = "#version 450 core\n";
static const char head_es[] = "#version 320 es\n"
	"precision highp float; precision highp int; precision highp sampler2D; precision highp "
	"usamplerBuffer;\n";

static const char common[] =
	"uniform vec3 u_right, u_up, u_forward;\n"
	"uniform vec4 u_lens;            // 1/tan_x, 1/tan_y, near, metres of haze\n"
	"const vec3 SUN = vec3(-0.5145, -0.4287, 0.7427);\n"
	"const vec3 SUN_COLOR = vec3(1.55, 1.42, 1.18), SKY_COLOR = vec3(0.42, 0.52, 0.68), EARTH_COLOR = "
	"vec3(0.16, 0.15, 0.10);\n"
	"vec3 linear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, "
	"c)); }\n"
	"vec3 encode(vec3 c) {\n"
	"	c *= 1.38;\n"
	"	c = c * (1.0 + c * 0.08) / (1.0 + c * 0.40);\n"
	"	return mix(c * 12.92, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, "
	"c));\n"
	"}\n"
	"vec3 sky(vec3 ray) {\n"
	"	float low = 1.0 - clamp(ray.z, 0.0, 1.0), s = max(dot(ray, SUN), 0.0), s2 = s * s;\n"
	"	return mix(vec3(0.10, 0.25, 0.58), vec3(0.50, 0.61, 0.74), low * low * low) + vec3(0.17, "
	"0.14, 0.09) * (s2 * s2 * s2 * s2);\n"
	"}\n"
	"vec3 air(vec3 to) { return sky(normalize(to) * vec3(1.0, 1.0, 0.2)); }\n"
	"vec3 world_of(vec3 v) { return u_right * v.x + u_up * v.y + u_forward * v.z; }\n";

static const char vertex_common[] =
	"uniform highp usamplerBuffer u_records, u_instances, u_members;\n"
	"uniform int u_first_member;\n"
	"uniform float u_scale;\n"
	"uniform vec4 u_tint;            // rgb, and how much of it; where none, r > 0: crowns do not shade "
	"themselves\n"
	"uniform uint u_path;            // summaries: what the placement adds to the owner\n"
	"flat out uvec2 v_owner;\n"
	"out vec4 v_albedo;              // linear; alpha is haze\n"
	"out vec3 v_light;\n"
	"out vec2 v_uv;\n"
	"out vec3 v_world;\n"
	"vec3 xyz(uvec4 t) { return uintBitsToFloat(t.xyz); }\n"
	"vec3 color_of(uint c) { return linear(vec3(c & 255u, c >> 8 & 255u, c >> 16 & 255u) / 255.0); }\n"
	"vec4 project(vec3 v) {\n"
	"#ifdef ZERO_TO_ONE\n"
	"	return vec4(v.x * u_lens.x, -v.y * u_lens.y, u_lens.z, v.z);\n"
	"#else\n"
	"	return vec4(v.x * u_lens.x, -v.y * u_lens.y, 2.0 * u_lens.z - v.z, v.z);\n"
	"#endif\n"
	"}\n"
	"float haze_at(float d) { return 1.0 - exp(-d / u_lens.w); }\n"
	/* Sunlight on what is seen of something (x), and through it (y). A triangle has one normal n; blades
	 * and bark around an axis and leaves of all directions have the means over the normals that face the
	 * eye, each by the area that it shows: c is the cosine between eye and sun, u = 1/4 for an axis, 2/(3
	 * pi) for all directions. */
	"vec2 round_sun(float c, float u) {\n"
	"	float sine = sqrt(max(1.0 - c * c, 0.0)), away = acos(clamp(c, -1.0, 1.0));\n"
	"	return u * vec2(sine + (3.1415927 - away) * c, sine - away * c);\n"
	"}\n"
	"vec2 axis_sun(vec3 axis, vec3 n) {\n"
	"	vec3 across = SUN - axis * dot(SUN, axis);\n"
	"	float l = length(across);\n"
	"	return round_sun(dot(n, across) / max(l, 1e-6), 0.25 * l);\n"
	"}\n"
	/* What a crown leaves of the light: shade of the sun's, open of the sky's; rise: height of the
	 * direction out of the crown. */
	"struct Crown { float shade, open, rise; };\n"
	"Crown crown_at(vec3 d, float outer, float height) {\n"
	"	float shade = mix(0.22, 1.0, smoothstep(-0.7, 0.8, dot(d, SUN))) * mix(0.25, 1.0, "
	"smoothstep(0.2, 0.95, outer));\n"
	"	return Crown(shade, mix(0.45, 1.0, outer) * mix(0.65, 1.0, height), d.z);\n"
	"}\n"
	/* The mean over what is seen of a crown: crown_at integrated over ellipsoids full of leaves, on their
	 * stems, of which an eye sees 1/e through a sixth of their radius; within 0.05. */
	"Crown crown_mean(vec3 to_eye) {\n"
	"	return Crown(0.61 + 0.25 * dot(to_eye, SUN), 0.75 + 0.12 * to_eye.z, 0.25 + 0.48 * "
	"to_eye.z);\n"
	"}\n"
	/* facing: height of the mean normal. */
	"vec3 light(vec2 sunny, float facing, Crown crown, float leaf) {\n"
	"	float up = 0.5 + 0.5 * mix(facing, crown.rise, 0.65);\n"
	"	vec3 ambient = mix(EARTH_COLOR, SKY_COLOR, up) * crown.open;\n"
	"	vec3 sun = SUN_COLOR * (sunny.x * mix(1.0, 0.95, leaf)) + vec3(1.25, 1.35, 0.45) * (0.62 * "
	"leaf * sunny.y);\n"
	"	return sun * crown.shade * 1.25 + ambient;\n"
	"}\n"
	"struct Plant { vec4 row[3]; uvec2 owner; float hash, scale; vec3 center; vec2 half_size; };\n"
	"Plant plant_of(uint i) {\n"
	"	int at = int(i) * 5;\n"
	"	Plant p;\n"
	"	for (int k = 0; k < 3; k++) p.row[k] = uintBitsToFloat(texelFetch(u_instances, at + k));\n"
	"	uvec4 a = texelFetch(u_instances, at + 3), b = texelFetch(u_instances, at + 4);\n"
	"	p.owner = a.xy; p.hash = uintBitsToFloat(a.z); p.scale = uintBitsToFloat(a.w);\n"
	"	p.center = vec3(0.0, 0.0, uintBitsToFloat(b.x)); p.half_size = uintBitsToFloat(b.yz);\n"
	"	return p;\n"
	"}\n"
	"vec3 view_of(Plant p, vec3 a) {\n"
	"	return vec3(dot(p.row[0].xyz, a), dot(p.row[1].xyz, a), dot(p.row[2].xyz, a)) + "
	"vec3(p.row[0].w, p.row[1].w, p.row[2].w);\n"
	"}\n"
	"vec3 turned(Plant p, vec3 a) {\n"
	"	return vec3(dot(p.row[0].xyz, a), dot(p.row[1].xyz, a), dot(p.row[2].xyz, a)) / p.scale;\n"
	"}\n"
	/* reach: of what is drawn, from its middle; what is as large as a crown is lit as a crown is in the
	 * mean. */
	"void shade(Plant p, vec3 local, float reach, vec3 view, vec2 sunny, float facing, vec3 albedo) {\n"
	"	float leaf = smoothstep(0.0, 0.25, (albedo.g - max(albedo.r * 0.9, albedo.b)) / "
	"max(albedo.g, 1e-4));\n"
	"	vec2 vary = vec2(fract(p.hash * 16.0), p.hash) - 0.5;\n"
	"	albedo *= (1.0 + 0.28 * vary.x) * (1.0 + 0.16 * vary.y * leaf * vec3(1.0, 0.1, -1.0));\n"
	"	vec3 in_crown = (local - p.center) / p.half_size.xxy, to_eye = -normalize(world_of(view));\n"
	"	bool alone = u_tint.w == 0.0 && u_tint.r > 0.0;\n"
	"	Crown crown = crown_at(normalize(to_eye + vec3(0, 0, 0.8)), 0.88, 0.75);\n"
	"	if (!alone && p.half_size.y > 0.0) crown = crown_at(world_of(turned(p, in_crown / "
	"max(length(in_crown), 1e-4))),\n"
	"		clamp(length(in_crown), 0.0, 1.0), clamp(local.z / (2.0 * p.half_size.y), 0.0, "
	"1.0));\n"
	"	if (!alone) {\n"
	"		Crown mean = crown_mean(to_eye);\n"
	"		float t = clamp(p.half_size.y > 0.0 ? reach / p.half_size.x : 1.0, 0.0, 1.0);\n"
	"		crown = Crown(mix(crown.shade, mean.shade, t), mix(crown.open, mean.open, t), "
	"mix(crown.rise, mean.rise, t));\n"
	"	}\n"
	"	v_light = light(sunny, facing, crown, leaf);\n"
	"	if (u_tint.w > 0.0) { albedo = linear(u_tint.rgb); v_light = mix(vec3(0.75), v_light, "
	"0.35); }\n"
	"	v_albedo = vec4(albedo, haze_at(length(view)) * (1.0 - u_tint.w));\n"
	"	v_world = world_of(view);\n"
	"	v_uv = vec2(0.0);\n"
	"}\n";

static const char vertex_triangles[] =
	"uniform float u_edges[" TEXT(ECO_GROWTHS) "];\n"
	"void main() {\n"
	"	Plant p = plant_of(texelFetch(u_members, u_first_member + gl_InstanceID).x);\n"
	"	int corner = gl_VertexID % 3, at = gl_VertexID / 3 * TEXELS;\n"
	"	uvec4 t0 = texelFetch(u_records, at), t1 = texelFetch(u_records, at + 1), t2 = "
	"texelFetch(u_records, at + 2);\n"
	"	uvec4 t3 = texelFetch(u_records, at + 3);\n"
	"	vec3 a = xyz(t0), b = xyz(t1), c = xyz(t2), center = uintBitsToFloat(uvec3(t1.w, t2.w, "
	"t3.x));\n"
	"	vec3 at_corner = corner == 0 ? a : corner == 1 ? b : c;\n"
	"	float edge = u_edges[t0.w >> 24];\n"
	"	if (edge != 1.0) at_corner = center + (at_corner - center) * edge;\n"
	"	vec3 n = cross(b - a, c - a), view = view_of(p, at_corner);\n"
	"	n = world_of(turned(p, n / max(length(n), 1e-20)));\n"
	"	n = dot(n, world_of(view)) > 0.0 ? -n : n;\n"
	"	shade(p, at_corner, 0.0, view, max(vec2(dot(n, SUN), -dot(n, SUN)), 0.0), n.z, "
	"color_of(t0.w));\n"
	"#if TEXELS == 5\n"
	"	uvec4 t4 = texelFetch(u_records, at + 4);\n"
	"	v_uv = uintBitsToFloat(corner == 0 ? t3.yz : corner == 1 ? uvec2(t3.w, t4.x) : t4.yz);\n"
	"#endif\n"
	"	v_owner = p.owner;\n"
	"	gl_Position = project(view);\n"
	"}\n";

static const char vertex_lines[] =
	"void main() {\n"
	"	Plant p = plant_of(texelFetch(u_members, u_first_member + gl_InstanceID).x);\n"
	"	int corner = gl_VertexID & 3, at = (gl_VertexID >> 2) * 2;\n"
	"	uvec4 t0 = texelFetch(u_records, at), t1 = texelFetch(u_records, at + 1);\n"
	"	vec3 a = xyz(t0), b = xyz(t1);\n"
	"	LINE_SCALE\n"
	"	vec3 va = view_of(p, a), vb = view_of(p, b), along = vb - va, side = cross(along, 0.5 * (va "
	"+ vb));\n"
	"	float len2 = dot(side, side), half_width = 0.5 * width * p.scale;\n"
	"	vec3 offset = side * (half_width * inversesqrt(max(len2, 1e-38)));\n"
	"	bool at_b = corner == 1 || corner == 2, plus = corner >= 2;\n"
	"	vec3 view = (at_b ? vb : va) + (plus ? offset : -offset);\n"
	"	vec3 axis = world_of(along / max(length(along), 1e-12)), n = "
	"world_of(normalize(cross(along, side)));\n"
	"	shade(p, at_b ? b : a, 0.0, view, axis_sun(axis, n), 0.785 * n.z, color_of(t1.w));\n"
	"	v_owner = p.owner;\n"
	"	gl_Position = len2 > 0.0 && half_width > 0.0 ? project(view) : vec4(2.0, 2.0, 2.0, 1.0);\n"
	"}\n";

/* u_level: the share of leaves that lie level, among those of all directions (eco_level_share). What is seen
 * of the two is by the area that they show.
 *
 * The clip-space square is the picture-space square: x and y offsets of one size in pixels need one focal
 * length. */
static const char vertex_points[] =
	"uniform float u_sides[" TEXT(ECO_SIZES) "];\n"
	"uniform float u_level;\n"
	"void main() {\n"
	"	Plant p = plant_of(texelFetch(u_members, u_first_member + gl_InstanceID).x);\n"
	"	int corner = gl_VertexID & 3, at = (gl_VertexID >> 2) * TEXELS;\n"
	"	uvec4 t0 = texelFetch(u_records, at);\n"
	"	vec3 local = xyz(t0), view = view_of(p, local);\n"
	"	vec2 sign = vec2(corner == 1 || corner == 2 ? 1.0 : -1.0, corner >= 2 ? 1.0 : -1.0);\n"
	"#if TEXELS == 2\n"
	"	uvec4 t1 = texelFetch(u_records, at + 1);\n"
	"	v_owner = uvec2(t1.x, (t1.y & ~t1.z) | ((t1.y + u_path) & t1.z));\n"
	"	p.hash = fract(float(t1.y >> 14 & 4095u) * 0.61803);\n"
	"#else\n"
	"	v_owner = p.owner;\n"
	"#endif\n"
	"	vec3 to_eye = -normalize(world_of(view));\n"
	"	float level = u_level * abs(to_eye.z), shows = level / (level + max(0.5 * (1.0 - u_level), "
	"1e-3)), side = to_eye.z < 0.0 ? -1.0 : 1.0;\n"
	"	vec2 sunny = mix(round_sun(dot(to_eye, SUN), 0.2122066), max(vec2(side, -side) * SUN.z, "
	"0.0), shows);\n"
	"	float reach = u_scale * u_sides[t0.w >> 24];\n"
	"	shade(p, local, reach, view, sunny, mix(0.667 * to_eye.z, side, shows), color_of(t0.w));\n"
	"	gl_Position = project(view);\n"
	"	gl_Position.xy += sign * (reach * p.scale) * u_lens.xy;\n"
	"}\n";

static const char vertex_ground[] =
	"uniform vec3 u_origin;          // of the anchor, view space\n"
	"uniform ivec3 u_anchor;         // the grid's point near the eye\n"
	"uniform vec3 u_step;\n"
	"uniform ivec3 u_columns;        // of the list; samples of the ring before the tile's first\n"
	"uniform ivec2 u_inner;          // columns and rows that are drawn\n"
	"uniform ivec4 u_seam;           // levels by which the neighbours in west, east, south, north are "
	"coarser\n"
	"uniform vec4 u_shade_box;       // corner relative to the grid's origin, 1 / size\n"
	"out vec3 v_normal, v_local;\n"
	"int snapped(int i, int levels, int inner) { return min((i + ((1 << levels) >> 1)) >> levels << "
	"levels, inner - 1); }\n"
	"void main() {\n"
	"	int cell = gl_VertexID / 6, corner = gl_VertexID % 6;\n"
	"	ivec2 at = ivec2(cell % (u_inner.x - 1), cell / (u_inner.x - 1));\n"
	/* south-west, south-east, north-east; south-west, north-east, north-west */
	"	at += ivec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner "
	"== 5);\n"
	"	ivec2 to = at;\n"
	"	if (at.x == 0) to.y = snapped(to.y, u_seam.x, u_inner.y);\n"
	"	if (at.x == u_inner.x - 1) to.y = snapped(to.y, u_seam.y, u_inner.y);\n"
	"	if (at.y == 0) to.x = snapped(to.x, u_seam.z, u_inner.x);\n"
	"	if (at.y == u_inner.y - 1) to.x = snapped(to.x, u_seam.w, u_inner.x);\n"
	"	uvec4 t = texelFetch(u_records, (to.y + u_columns.z) * u_columns.x + to.x + u_columns.y);\n"
	"	ivec3 whole = ivec3(t.xyz);\n"
	"	vec3 p = vec3(whole - u_anchor) * u_step;\n"
	"	vec3 view = vec3(dot(u_right, p), dot(u_up, p), dot(u_forward, p)) + u_origin;\n"
	"	vec2 n = vec2(ivec2(t.ww) << ivec2(16, 0) >> 16) / 32767.0;\n"
	"	v_normal = vec3(n, sqrt(max(1.0 - dot(n, n), 0.0)));\n"
	"	p = vec3(whole) * u_step;\n"
	"	v_local = p;\n"
	"	v_world = world_of(view);\n"
	"	v_owner = uvec2(0u);\n"
	"	v_albedo = vec4(0.0, 0.0, 0.0, haze_at(length(view)));\n"
	"	v_light = vec3(u_shade_box.xy, 0.0);\n"
	"	v_uv = (p.xy - u_shade_box.xy) * u_shade_box.zw;\n"
	"	gl_Position = project(view);\n"
	"}\n";

static const char fragment_plant[] =
	"flat in uvec2 v_owner;\n"
	"in vec4 v_albedo;\n"
	"in vec3 v_light, v_world;\n"
	"in vec2 v_uv;\n"
	"layout(location = 0) out vec4 o_color;\n"
	"layout(location = 1) out uvec2 o_owner;\n"
	"#if TEXELS == 5\n"
	"uniform sampler2D u_texture, u_alpha;\n"
	"uniform vec4 u_tint;\n"
	"#endif\n"
	"void main() {\n"
	"	vec3 albedo = v_albedo.rgb;\n"
	"#if TEXELS == 5\n"
	/* coverage by the nearest texel, as the rasteriser; colour from a filtered copy whose clear texels
	 * hold their neighbours' colour */
	"	ivec2 size = textureSize(u_alpha, 0), texel = ivec2(floor(v_uv * vec2(size)));\n"
	"	texel = clamp(texel - size * ivec2(floor(vec2(texel) / vec2(size))), ivec2(0), size - 1);\n"
	"	vec3 texture_color = texture(u_texture, v_uv).rgb;\n"
	"	if (texelFetch(u_alpha, texel, 0).r < 0.5) discard;\n"
	"	albedo *= mix(texture_color, vec3(1.0), u_tint.w);\n"
	"#endif\n"
	"	o_color = vec4(encode(mix(albedo * v_light, air(v_world), v_albedo.a)), 1.0);\n"
	"	o_owner = v_owner;\n"
	"}\n";

static const char fragment_ground[] =
	"flat in uvec2 v_owner;\n"
	"in vec4 v_albedo;\n"
	"in vec3 v_light, v_world, v_normal, v_local;\n"
	"in vec2 v_uv;\n"
	"uniform sampler2D u_shade;\n"
	"uniform vec4 u_tint;\n"
	"layout(location = 0) out vec4 o_color;\n"
	"layout(location = 1) out uvec2 o_owner;\n"
	"float hash(ivec2 p) {\n"
	"	uint h = uint(p.x) * 0x9E3779B1u ^ uint(p.y) * 0x85EBCA77u;\n"
	"	h = (h ^ h >> 15) * 0x2C1B3C6Du;\n"
	"	return float((h ^ h >> 13) & 65535u) / 65535.0;\n"
	"}\n"
	"float noise(vec2 p) {\n"
	"	ivec2 i = ivec2(floor(p));\n"
	"	vec2 f = fract(p), w = f * f * (3.0 - 2.0 * f);\n"
	"	return mix(mix(hash(i), hash(i + ivec2(1, 0)), w.x), mix(hash(i + ivec2(0, 1)), hash(i + "
	"ivec2(1, 1)), w.x), w.y);\n"
	"}\n"
	"void main() {\n"
	"	float d = length(v_world);\n"
	"	vec3 n = normalize(v_normal);\n"
	"	mat2 turn = mat2(0.8, 0.6, -0.6, 0.8);\n"
	/* octaves fade out where a period comes near a pixel, so that far ground does not sparkle */
	"	float blade = mix(0.5, noise(v_local.xy * vec2(38.0, 31.0)), clamp(1.0 - d / 14.0, 0.0, "
	"1.0));\n"
	"	float fine = mix(0.5, noise(v_local.xy * 9.0), clamp(1.0 - d / 45.0, 0.0, 1.0)) * 0.6 + "
	"blade * 0.4;\n"
	"	float mid = mix(0.5, 0.6 * noise(turn * v_local.xy * 1.3) + 0.4 * noise(v_local.xy * 0.47), "
	"clamp(1.2 - d / 260.0, 0.0, 1.0));\n"
	"	float wide = 0.65 * noise(turn * v_local.xy * 0.045 + 7.0) + 0.35 * noise(v_local.xy * "
	"0.13);\n"
	"	vec3 grass = mix(vec3(0.070, 0.098, 0.026), vec3(0.150, 0.148, 0.050), clamp(0.55 * wide + "
	"0.45 * mid, 0.0, 1.0));\n"
	"	grass *= 0.72 + 0.38 * mid + 0.7 * (fine - 0.5);\n"
	"	vec3 soil = vec3(0.150, 0.112, 0.072) * (0.75 + 0.5 * mid);\n"
	"	vec3 albedo = mix(grass, soil, clamp(smoothstep(0.10, 0.42, 1.0 - n.z) + 0.28 * "
	"smoothstep(0.62, 0.9, wide * 0.6 + mid * 0.4), 0.0, 1.0));\n"
	"	vec2 below = texture(u_shade, v_uv).rg;\n"
	"	float open = v_uv.x > 0.0 && v_uv.y > 0.0 && v_uv.x < 1.0 && v_uv.y < 1.0 ? 1.0 : 0.0;\n"
	"	below *= open;\n"
	"	vec3 lit = SUN_COLOR * 1.1 * max(dot(n, SUN), 0.0) * (1.0 - 0.9 * below.r);\n"
	"	lit += mix(EARTH_COLOR, SKY_COLOR, 0.5 + 0.5 * n.z) * (1.0 - 0.6 * below.g);\n"
	"	vec3 color = mix(albedo * lit, air(v_world), v_albedo.a);\n"
	"	color = mix(color, vec3(dot(color, vec3(0.3, 0.5, 0.2))), u_tint.w * 0.7);\n"
	"	o_color = vec4(encode(color), 1.0);\n"
	"	o_owner = v_owner;\n"
	"}\n";

static const char vertex_sky[] =
	"out vec3 v_ray;\n"
	"void main() {\n"
	"	vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
	"	v_ray = u_forward + u_right * (at.x / u_lens.x) - u_up * (at.y / u_lens.y);\n"
	"	gl_Position = vec4(at, 0.0, 1.0);\n"
	"}\n";

static const char fragment_sky[] =
	"in vec3 v_ray;\n"
	"uniform vec4 u_tint;\n"
	"layout(location = 0) out vec4 o_color;\n"
	"layout(location = 1) out uvec2 o_owner;\n"
	"void main() {\n"
	"	vec3 ray = normalize(v_ray);\n"
	"	vec3 c = ray.z > 0.0 ? sky(ray) + vec3(0.6, 0.5, 0.3) * pow(max(dot(ray, SUN), 0.0), 200.0)\n"
	"		: mix(sky(vec3(ray.xy, 0.0)), vec3(0.34, 0.39, 0.41), smoothstep(0.0, 0.9, "
	"-ray.z));\n"
	"	o_color = vec4(encode(mix(c, vec3(dot(c, vec3(0.34))), u_tint.w * 0.7)), 1.0);\n"
	"	o_owner = uvec2(0u);\n"
	"}\n";

static const struct { const char *name, *defines, *vertex, *fragment; bool bare;
	} programs[VIEW_PROGRAM_COUNT] = {
	[VIEW_PROGRAM_TRIANGLES] = { "triangles", "#define TEXELS 4\n", vertex_triangles, fragment_plant,
		false },
	[VIEW_PROGRAM_TEXTURED] = { "textured triangles", "#define TEXELS 5\n", vertex_triangles,
	fragment_plant, false }, [VIEW_PROGRAM_LINES] = { "lines", "#define TEXELS 3\n"
		"#define LINE_SCALE float width = uintBitsToFloat(t0.w); { vec3 m = 0.5 * (a + b); a = m + "
		"(a - m) * u_scale;"
		" b = m + (b - m) * u_scale; width *= u_scale; }\n", vertex_lines, fragment_plant, false },
	[VIEW_PROGRAM_POINTS] = { "points", "#define TEXELS 1\n", vertex_points, fragment_plant, false },
	[VIEW_PROGRAM_SUMMARY] = { "summary points", "#define TEXELS 2\n", vertex_points, fragment_plant,
	false }, [VIEW_PROGRAM_GROUND] = { "ground", "#define TEXELS 0\n", vertex_ground, fragment_ground,
	false }, [VIEW_PROGRAM_SKY] = { "sky", "#define TEXELS 0\n", vertex_sky, fragment_sky, true },
};

static const char *const uniform_names[VIEW_UNIFORM_COUNT] = { "u_right", "u_up", "u_forward", "u_lens",
	"u_origin", "u_first_member",
	"u_scale", "u_tint", "u_columns", "u_records", "u_instances", "u_members", "u_alpha", "u_texture",
	"u_shade", "u_shade_box",
	"u_path", "u_anchor", "u_step", "u_inner", "u_seam", "u_edges", "u_sides", "u_level" };

static unsigned compile(unsigned type, const char *const *parts, int count, const char *name,
	struct eco_error *error)
{
	unsigned shader = glCreateShader(type);
	glShaderSource(shader, count, parts, NULL);
	glCompileShader(shader);
	int ok = 0;
	glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return shader;
	char log[400];
	glGetShaderInfoLog(shader, sizeof log, NULL, log);
	glDeleteShader(shader);
	eco_fail(error, ECO_UNSUPPORTED, "the graphics driver does not compile the shader for %s: %s", name,
		log);
	return 0;
}

static enum eco_code link(struct view_shader *shader, unsigned vertex, unsigned fragment, const char *name,
	struct eco_error *error)
{
	shader->program = glCreateProgram();
	glAttachShader(shader->program, vertex);
	glAttachShader(shader->program, fragment);
	glLinkProgram(shader->program);
	int ok = 0;
	glGetProgramiv(shader->program, GL_LINK_STATUS, &ok);
	if (ok)
		return ECO_OK;
	char log[400];
	glGetProgramInfoLog(shader->program, sizeof log, NULL, log);
	glDeleteProgram(shader->program);
	shader->program = 0;
	return eco_fail(error, ECO_UNSUPPORTED, "the graphics driver does not link the program for %s: %s",
		name, log);
}

enum eco_code view_shader_compile(struct view_shader *shader, enum view_program which,
	const struct view_dialect *dialect, struct eco_error *error)
{
	const char *start = dialect->es ? head_es : head_desktop;
	const char *depth = dialect->depth_zero_to_one ? "#define ZERO_TO_ONE 1\n" : "";
	const char *vs[] = { start, depth, programs[which].defines, common, programs[which].bare ? ""
		: vertex_common, programs[which].vertex };
	const char *fs[] = { start, depth, programs[which].defines, common, programs[which].fragment };
	unsigned vertex = compile(GL_VERTEX_SHADER, vs, 6, programs[which].name, error);
	unsigned fragment = vertex ? compile(GL_FRAGMENT_SHADER, fs, 5, programs[which].name, error) : 0;
	enum eco_code code = vertex && fragment ? link(shader, vertex, fragment, programs[which].name, error)
		: ECO_UNSUPPORTED;
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	if (code)
		return code;
	for (int i = 0; i < VIEW_UNIFORM_COUNT; i++)
		shader->uniform[i] = glGetUniformLocation(shader->program, uniform_names[i]);
	return ECO_OK;
}
