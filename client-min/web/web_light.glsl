/* Light by view_light.glsl of what view_gl has recorded.
 *
 * Values that all pixels share come to them from the vertices: software drivers look up a uniform for
 * each pixel (lod/EXPERIMENTS.md, A frame's time). u_frame: where the sun is and the day, its light and its
 * glow, the sky's and haze_m, the earth's and by_kind, from where feet are told to the eye and the shift of
 * plants, u_shade's corner from the eye and 1 / its side. u_part, u_cell: where the eye is in octaves, two a
 * vector. 14 vectors of the 15 that any driver has. */
FLAT vec4 v_frame[6], v_part[3];
FLAT ivec4 v_cell[3];
uniform usampler2D u_seen;

#ifdef VERTEX
uniform vec4 u_frame[6], u_part[3];
uniform ivec4 u_cell[3];
uniform mat3 u_ray;             // the image plane's half extents, and its middle
out vec3 v_ray;
out vec2 v_pixel;
void more() {
	v_frame = u_frame;
	v_part = u_part;
	v_cell = u_cell;
	v_ray = u_ray * vec3(gl_Position.x, -gl_Position.y, 1.0);
	v_pixel = (gl_Position.xy * 0.5 + 0.5) * vec2(textureSize(u_seen, 0));
}
#else

/* Places on the ground are metres from the eye. */
#define ground_place vec2
float noise_at(vec2 at, int which, int finer);
#include "lod/plant_light.glsl"
#include "client-min/draw/view_light.glsl"

/* vec3 ground_own(vec3 n, vec3 to): the ground's own colour, by its image if there is one. */
#ifdef IMAGE
#define wide float
#define widened(x) (x)
#define whole(x) uint(x)
#define tree ivec3
uniform usampler2D u_nodes;
uniform sampler2D u_texels;
uniform ivec3 u_tree;           // log2 of their widths, where blocks begin
uniform vec4 u_image;           // the eye in the root, 1 / its side, radians of a pixel
#include "client-min/view_image.glsl"
ivec2 texel_of(int shift, uint i) { return ivec2(int(i) & ((1 << shift) - 1), int(i) >> shift); }
uint tree_node(tree t, uint i) { return texelFetch(u_nodes, texel_of(t.x, i), 0).x; }
uint tree_level(tree t, uint leaf, uint level) {
	return tree_node(t, uint(t.z) + 4u * (leaf & 0x1fffffffu) + level) * 1024u;
}
image_color tree_texel(tree t, uint of, uint texel) {
	vec4 c = texelFetch(u_texels, texel_of(t.y, of + texel), 0);
	return image_color(c.r * c.a, c.g * c.a, c.b * c.a, c.a, 0.0);
}
#ifdef WATER
float water_seen = 0.0;         // where ground_own looked last
#endif
vec3 ground_own(vec3 n, vec3 to) {
	footprint foot = footprint_of(n, to, u_image.w);
	vec2 at = u_image.xy + to.xy * u_image.z, along = vec2(foot.x, foot.y) * u_image.z;
	image_color c = image_seen(u_tree, image_pixel(at.x, at.y, along.x, along.y, foot.across * u_image.z));
#ifdef WATER
	water_seen = water_of(vec3(c.red, c.green, c.blue), c.alpha);
	c.texel *= 1.0 - water_seen;    // it has no grain
#endif
	return imaged_albedo(to.xy, n.z, length(to), vec3(c.red, c.green, c.blue), c.alpha, c.texel / u_image.z);
}
#else
vec3 ground_own(vec3 n, vec3 to) { return ground_albedo(to.xy, n.z, length(to)); }
#endif

/* vec2 cast_at(vec3 to, vec3 n, bool facet): the share of sunlight that arrives at a place from the eye, -1 beyond
 * the map, and how large a texel is there. facet: the surface has that one normal. */
#ifdef SHADOW
#define tops int
uniform usampler2D u_rows;
uniform sampler2D u_tops;
uniform vec3 u_moved;           // the eye, since the map was made
#include "client-min/draw/view_shadow.glsl"
shadow_row row_of(int i) {
	vec4 r = uintBitsToFloat(texelFetch(u_rows, ivec2(i, 0), 0));
	return shadow_row(r.xyz, r.w);
}
bool tops_below(int t, float x, float y, float height) {
	return shadow_depth(height) >= texelFetch(u_tops, ivec2(int(x), int(y)), 0).r;
}
vec2 cast_at(vec3 to, vec3 n, bool facet) {
	shadow_light s = shadow_at(shadow_map(row_of(0), row_of(1), row_of(2), row_of(3),
		float(textureSize(u_tops, 0).x)), 0, to + u_moved, n, facet);
	return vec2(s.lit, s.texel_m);
}
#else
vec2 cast_at(vec3 to, vec3 n, bool facet) { return vec2(-1.0, 0.0); }
#endif

uniform sampler2D u_shade;
uniform usampler2D u_plants;
in vec3 v_ray;
in vec2 v_pixel;
out vec4 o_color;
sunlight sun() {
	return sunlight(v_frame[0].xyz, v_frame[1].xyz, v_frame[2].xyz, v_frame[3].xyz, v_frame[0].w, v_frame[1].w);
}
float haze_m() { return v_frame[2].w; }
bool by_kind() { return v_frame[3].w != 0.0; }
float noise_at(vec2 at, int which, int finer) {
	bool odd = (which & 1) == 1;
	vec4 part = v_part[which >> 1], metre = METRE[which];
	ivec4 base = v_cell[which >> 1];
	vec2 p = float(finer) * ((odd ? part.zw : part.xy) + metre.xy * at.x + metre.zw * at.y), cell = floor(p);
	uvec2 whole = uvec2(finer * (odd ? base.zw : base.xy) + ivec2(cell));
	return noise_in(whole.x, whole.y, p.x - cell.x, p.y - cell.y);
}
vec4 plant_texel(uint i) {
	int shift = int(v_frame[4].w);
	ivec2 at = ivec2(int(i) & ((1 << shift) - 1), int(i) >> shift);
	return uintBitsToFloat(texelFetch(u_plants, at, 0));
}
/* of a pixel; foot: of the plant, and its scale */
plant plant_of(uvec4 seen, out vec4 foot) {
	foot = vec4(0.0, 0.0, 0.0, 1.0);
	if (is_summary(seen)) return plant(0.0, 0.0, 0.0, 0.0, 0.0, summary_tone(seen.x >> 2));
	uint at = (seen.x - 1u) * 3u;
	vec4 a = plant_texel(at), b = plant_texel(at + 2u);
	foot = plant_texel(at + 1u);
	return plant(a.x, a.y, a.z, a.w, b.x, b.y);
}
/* sunshine: what a shadow map says, the share of sunlight that arrives and how large a texel is */
vec3 plant_pixel(uvec4 seen, vec3 to, plant p, vec4 foot, face look, vec2 sunshine) {
	vec3 own = light_of_bytes(vec3(uvec3(seen.w, seen.w >> 8, seen.w >> 16) & 255u) / 255.0);
	return plant_color(sun(), p, own, look, (to + v_frame[4].xyz - foot.xyz) / foot.w, to,
		sunshine.x, sunshine.y, foot.w, haze_m(), by_kind());
}
vec3 ground_pixel(vec3 n, vec3 to, vec2 sunshine) {
	vec2 at = (to.xy - v_frame[5].xy) * v_frame[5].z, taken = vec2(0.0);
	if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0))))
		taken = textureLod(u_shade, at, 0.0).rg;
	vec3 lit = ground_light(sun(), n, sunshine.x < 0.0 ? taken.x : 1.0 - sunshine.x, taken.y);
	lit *= ground_own(n, to);
#ifdef WATER
	if (water_seen > 0.0) lit = water_color(sun(), to.xy, lit, to, water_seen);
#endif
	return ground_color(sun(), lit, to, haze_m(), by_kind());
}
vec3 color_of(uvec4 seen, vec3 to) {
	bool ground = seen.x == 0u && !is_summary(seen);
	vec4 foot;
	plant p = plant_of(seen, foot);
	face look = face(sunny(0.0, 0.0, 0.0), direction_of(seen.y), true, 0.0, 0.0);
	if (!ground) look = face_of(sun(), p, seen.y, -unit(to));
	vec2 sunshine = cast_at(to, look.n, look.facet);
	if (ground) return ground_pixel(look.n, to, sunshine);
	return plant_pixel(seen, to, p, foot, look, sunshine);
}
void main() {
	uvec4 seen = texelFetch(u_seen, ivec2(v_pixel), 0);
	float nearness = uintBitsToFloat(seen.z);
	vec3 color = nearness == 0.0 ? sky_color(sun(), v_ray, by_kind()) : color_of(seen, v_ray / nearness);
	o_color = vec4(bytes_of_light(vec3(shown(color.x), shown(color.y), shown(color.z))), 1.0);
}
#endif
