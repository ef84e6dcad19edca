/* One text for all programs (impostors: view_shader_impostor.glsl); what a program needs is switched on by a
 * #define of view_shader.c, so that a scene without lines compiles no lines. FLAT is flat out or flat in; TEXELS
 * are those of a record; numbers of lod/ and ecofiles/ have their names.
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

/* view_surface_direction and so on; the words are those of view_light.h. */
const uint FACET = 0u, AXIS = 1u, CLOUD = 2u, BALL = 3u, SUMMARY = 1u << 24;
uint direction_word(vec3 d, int bits) {
	d *= 1.0 / max(abs(d.x) + abs(d.y) + abs(d.z), 1e-30);
	vec2 at = d.xy;
	vec2 side = vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);
	if (d.z < 0.0) at = (1.0 - abs(at.yx)) * side;
	uvec2 whole = uvec2((at * 0.5 + 0.5) * float((1 << bits) - 1) + 0.5);
	return whole.y << bits | whole.x;
}
uint surface_direction(uint kind, vec3 d) { return kind << 30 | direction_word(d, 15); }
uint surface_ball(uint look, vec3 d) { return BALL << 30 | look << 20 | direction_word(d, 10); }
/* texels by number, as view_gpu.h lays them out */
uniform highp usampler2D u_records;
uniform highp ivec3 u_shift;    // of records, instances, members
uvec4 texel_of(highp usampler2D texels, int shift, int i) {
	return texelFetch(texels, ivec2(i & ((1 << shift) - 1), i >> shift), 0);
}
uvec4 record_at(int i) { return texel_of(u_records, u_shift.x, i); }

/* A fragment's ellipse, in as few vectors as possible, as software drivers make a copy for
 * each primitive; and what all share is among it, as they look up uniforms pixel by pixel
 * (lod/EXPERIMENTS.md, A frame's time). Then lod_splat_covers. */
#ifdef TINTED
FLAT uint v_tint;               // lod/tint.h
#endif

#ifdef ELLIPSE
FLAT vec4 v_ellipse;            // x, y of the centre, lean, half
FLAT vec4 v_near_side;          // of the centre, aside, below, bulge
#if TEXELS == 4
FLAT vec4 v_normals[3];
#define HEIGHT v_normals[0].w
#define HALF (vec2(v_seen.y & 65535u, v_seen.y >> 16) * 0.5)
#define NEAR v_normals[1].w
#define BALL_LOOK uint(v_normals[2].w)  // how large, how level: bits 20 on of its surface
#else
FLAT vec4 v_frame;
#define HEIGHT v_frame.x
#define HALF v_frame.yz
#define NEAR v_frame.w
#endif
bool splat_covers(uvec4 seen, uvec2 pixel) {
	uint salt = seen.w, column = pixel.x, row = pixel.y, hash;
	LOD_HASH_SPLAT;
	return hash >> 24 < seen.z >> 24 << 4;
}
#endif

/* Leaves on ellipses: a leaf_splat in four vectors, whose last numbers are ragged, amount (negative: wood, which
 * is smooth), opacity and deviation of tone; and the direction to the eye in plant space. */
#ifdef LEAVES
float side_of(float leaf, float pixel) {
	while (leaf < LOD_LEAF_PIXEL * pixel) leaf *= 2.0;
	return leaf;
}
#ifdef ELLIPSE
FLAT vec4 v_leaves[4];
FLAT vec3 v_to_eye;
#endif
#endif

/* ==== Vertices ==== */
#ifdef VERTEX

uniform vec4 u_lens;            // 1/tan_x, 1/tan_y, near
uniform vec2 u_middle;          // lod_eye
vec4 project(vec3 v) {
	v.xy -= u_middle * v.z;
#ifdef ZERO_TO_ONE
	return vec4(v.x * u_lens.x, -v.y * u_lens.y, u_lens.z, v.z);
#else
	return vec4(v.x * u_lens.x, -v.y * u_lens.y, 2.0 * u_lens.z - v.z, v.z);
#endif
}

/* A map's rows are from its corner; view space is from its middle, and down. Lengths across beams and along
 * them are those of the plant. */
#ifdef SHADOW
uniform highp usampler2D u_map;
out float v_height;
vec4 map_row(int i) { return uintBitsToFloat(texelFetch(u_map, ivec2(i, 0), 0)); }
vec4 of_plant(vec4 row, vec4 world[3]) {
	return row.x * world[0] + row.y * world[1] + row.z * world[2] + vec4(0.0, 0.0, 0.0, row.w);
}
vec3 axis_across(vec3 sun, int i) {
	vec3 first = normalize(cross(sun, abs(sun.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
	return i == 0 ? first : cross(sun, first);
}
#endif

#ifndef GROUND
uniform highp usampler2D u_instances, u_members;
/* splats have twice HALF in place of a surface */
flat out uvec4 v_seen;          // whose, surface, colour; of ellipses opacity << 24, salt
uniform int u_first_member;
uniform int u_first;            // the first primitive, where gl_VertexID does not begin with it
uniform float u_scale;
uniform vec4 u_tint;            // rgb, if w is 1: instead of a colour of its own
uniform uint u_path;            // summaries: what the placement adds to the owner
vec3 xyz(uvec4 t) { return uintBitsToFloat(t.xyz); }
struct Plant { vec4 row[3]; uint whose, salt; float scale, half_width, width; vec4 high; uint tint; };
Plant plant_of_member(int member) {
	int number = int(texel_of(u_members, u_shift.z, u_first_member + member).x);
	int at = number * 4;
	Plant p;
	for (int k = 0; k < 3; k++)
		p.row[k] = uintBitsToFloat(texel_of(u_instances, u_shift.y, at + k));
	uvec4 t = texel_of(u_instances, u_shift.y, at + 3);
	p.whose = uint(number) + 1u;
	p.scale = uintBitsToFloat(t.x);
	p.half_width = uintBitsToFloat(t.y & 0xffff0000u);
	p.salt = t.y & 0xffffu;
	p.width = uintBitsToFloat(t.z);
	p.tint = t.w;
#ifdef SHADOW
	vec4 world[3] = p.row, w = map_row(2);
	p.row[0] = of_plant(map_row(0) - w / u_lens.x, world);
	p.row[1] = of_plant(w / u_lens.y - map_row(1), world);
	p.row[2] = of_plant(w, world);
	p.high = of_plant(map_row(3), world);
#endif
	return p;
}
vec3 sun_of(Plant p) { return p.high.xyz / p.scale; }
float height_of(Plant p, vec3 a) { return dot(p.high.xyz, a) + p.high.w; }
vec3 view_of(Plant p, vec3 a) {
	return vec3(dot(p.row[0].xyz, a), dot(p.row[1].xyz, a), dot(p.row[2].xyz, a)) +
		vec3(p.row[0].w, p.row[1].w, p.row[2].w);
}
vec3 axis_of(Plant p, vec3 h) {         // y down
	return vec3(dot(p.row[0].xyz, h), -dot(p.row[1].xyz, h), dot(p.row[2].xyz, h));
}
// and the tint of what it is the colour of
uint color_of(Plant p, uint word) {
#ifdef TINTED
	v_tint = u_tint.w > 0.0 || (word >= VIEW_WOOD && p.tint < LOD_TINT_WHOLE) ? 0u : p.tint;
#endif
	uvec3 tint = uvec3(u_tint.rgb * 255.0 + 0.5);
	return u_tint.w > 0.0 ? tint.r | tint.g << 8 | tint.b << 16 : word & 0xffffffu;
}
#endif

#ifdef TRIANGLES
uniform float u_edges[ECO_GROWTHS];
out vec2 v_uv;
void main() {
	Plant p = plant_of_member(gl_InstanceID);
	int corner = gl_VertexID % 3, at = gl_VertexID / 3 * TEXELS;
	uvec4 t0 = record_at(at), t1 = record_at(at + 1), t2 = record_at(at + 2);
	uvec4 t3 = record_at(at + 3);
	vec3 a = xyz(t0), b = xyz(t1), c = xyz(t2), center = uintBitsToFloat(uvec3(t1.w, t2.w, t3.x));
	vec3 at_corner = corner == 0 ? a : corner == 1 ? b : c, n = cross(b - a, c - a);
	float edge = u_edges[t0.w >> 24 & 127u];
	if (edge != 1.0) at_corner = center + (at_corner - center) * edge;
	n /= max(length(n), 1e-20);
	v_seen = uvec4(p.whose, surface_direction(FACET, n), color_of(p, t0.w), 0u);
	v_uv = vec2(0.0);
#if TEXELS == 5
	uvec4 t4 = record_at(at + 4);
	v_uv = uintBitsToFloat(corner == 0 ? t3.yz : corner == 1 ? uvec2(t3.w, t4.x) : t4.yz);
#endif
	gl_Position = project(view_of(p, at_corner));
#ifdef SHADOW
	v_height = height_of(p, at_corner);
#endif
}
#endif

#ifdef LINES
void main() {
	Plant p = plant_of_member(gl_InstanceID);
	int corner = gl_VertexID & 3, at = ((gl_VertexID >> 2) + u_first) * 2;
	uvec4 t0 = record_at(at), t1 = record_at(at + 1);
	vec3 a = xyz(t0), b = xyz(t1);
	vec3 m = 0.5 * (a + b);
	a = m + (a - m) * u_scale;
	b = m + (b - m) * u_scale;
	float width = uintBitsToFloat(t0.w) * u_scale;
	bool at_b = corner == 1 || corner == 2, plus = corner >= 2;
#ifdef SHADOW
	vec3 side = cross(b - a, sun_of(p));
	float half_width = 0.5 * width;
#else
	vec3 va = view_of(p, a), vb = view_of(p, b), side = cross(vb - va, 0.5 * (va + vb));
	float half_width = 0.5 * width * p.scale;
#endif
	float len2 = dot(side, side);
	vec3 offset = side * (half_width * inversesqrt(max(len2, 1e-38)));
	offset = plus ? offset : -offset;
#ifdef SHADOW
	vec3 place = (at_b ? b : a) + offset, view = view_of(p, place);
	v_height = height_of(p, place);
#else
	vec3 view = (at_b ? vb : va) + offset;
#endif
	v_seen = uvec4(p.whose, surface_direction(AXIS, b - a), color_of(p, t1.w), 0u);
	gl_Position = len2 > 0.0 && half_width > 0.0 ? project(view) : vec4(2.0, 2.0, 2.0, 1.0);
}
#endif

/* u_level: eco_level_share, in 1/255. Ellipses as lod/splat.h has them. Each is a point as large as the
 * pixels whose middles lie within its sides, of which the fragment shader tells those that it covers; one
 * that covers none is not drawn. If some may be larger than the driver's points (u_corners is 3, not 1)
 * each is the least triangle around its ellipse, and a quarter of a pixel more, as drivers round vertices.
 * All plants of a cut are one instance: drivers begin anew with each (lod/EXPERIMENTS.md, A frame's time). */
#ifdef ELLIPSE
#if TEXELS == 2
uniform int u_halvings;         // of scattered points
uniform float u_reach;          // of a point before it is scattered
/* lod/scattered.c */
vec3 scatter_offset(uint point, uint part) {
	uint hash;
	LOD_HASH_SCATTER;
	ivec3 a = ivec3(uvec3(hash, hash >> 10, hash >> 20) & 31u),
		b = ivec3(uvec3(hash >> 5, hash >> 15, hash >> 25) & 31u);
	return vec3(a + b - 31) / 32.0;
}
#endif
uniform float u_sides[ECO_SIZES];
uniform uint u_cover;            // sixteenths of a point's disc
uniform uint u_level;
uniform vec2 u_half, u_window;  // of the picture and of the viewport, pixels
uniform int u_corners, u_count; // of an ellipse; of a plant's ellipses
uniform uint u_sample;
uniform vec2 u_leaf;            // width of a leaf, deviation of tone
uint salt_of(uvec3 bits) {
	uint x = bits.x, y = bits.y, z = bits.z, nth = u_sample, salt;
	LOD_HASH_SALT;
	return salt;
}
bool covers_one(vec2 pixel, bool leafy, float grown) {  // or nearly so
	vec2 at = pixel + 0.5 - u_half - v_ellipse.xy;
	float v = at.y / HEIGHT, rest = 1.001 * grown * grown - v * v;
	return rest >= 0.0 && abs(at.x - v_ellipse.z * at.y) <= v_ellipse.w * sqrt(rest) + 0.001
		&& (leafy || splat_covers(v_seen, uvec2(ivec2(pixel))));
}
void main() {
	int corner = gl_VertexID % u_corners, point = gl_VertexID / u_corners;
	Plant p = plant_of_member(point / u_count);
	point = point % u_count + u_first;
#if TEXELS == 2
	uint scattered = uint(point & ((1 << u_halvings) - 1));
	point >>= u_halvings;
#endif
	int at = point * TEXELS;
	uvec4 t0 = record_at(at);
	vec3 middle_of = xyz(t0);
#if TEXELS == 2
	if (u_halvings > 0) middle_of += u_reach * scatter_offset(uint(point), scattered);
#endif
	vec3 view = view_of(p, middle_of);
	vec2 focal = u_lens.xy * u_half, middle = vec2(view.x, -view.y) * focal / view.z;
	mat3 axes, to_plant = mat3(0.0); // half axes in view space, y down; columns: normals of plant space
	mat3 halves;                     // half axes in plant space
	float reach = u_scale;
#if TEXELS == 4
	for (int k = 0; k < 3; k++) {
		vec3 h = xyz(record_at(at + 1 + k));
		halves[k] = h * u_scale;
		axes[k] = axis_of(p, h) * u_scale;
		to_plant[k] = h / max(dot(h, h), 1e-30);
	}
	uint opacity = t0.w >> 24 & 31u;
#else
	reach *= u_sides[t0.w >> 24];
#ifdef SHADOW
	axes = mat3(0.0);
	for (int k = 0; k < 2; k++) axes[k] = reach * axis_of(p, axis_across(sun_of(p), k));
#else
	axes = mat3(reach * p.scale);
	for (int k = 0; k < 3; k++) halves[k] = p.row[k].xyz * (k == 1 ? -reach : reach) / p.scale;
#endif
	uint opacity = u_cover;
#endif
	bool leafy = false;
	float grown = 1.0;
#if TEXELS == 2
	uvec4 t1 = record_at(at + 1);
	p.whose = t1.x >> 30 | ((t1.y & ~t1.z) | ((t1.y + u_path) & t1.z)) << 2;
#endif
	float xx = 0.0, xy = 0.0, yy = 0.0, zz = 0.0;
	vec2 to_z = vec2(0.0);
	vec3 across, down;
	for (int k = 0; k < 3; k++) {
		vec2 d = (axes[k].xy * focal - axes[k].z * middle) / view.z;
		float q = axes[k].z / view.z;
		across[k] = d.x, down[k] = d.y;
		xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
		to_z += d * q, zz += q * q;
	}
	float part = 1.0 / (1.0 - zz);
	bool there = view.z >= u_lens.z && zz < 1.0 && xx > 0.0 && yy > 0.0 && xx < 1e30 && yy < 1e30;
	xx = (xx + to_z.x * to_z.x * part) * part;
	xy = (xy + to_z.x * to_z.y * part) * part;
	yy = (yy + to_z.y * to_z.y * part) * part;
	middle -= to_z * part + vec2(u_middle.x, -u_middle.y) * focal;
	float lean = xy / yy, cloud = p.half_width > 0.0 ? min(reach / p.half_width, 1.0) : 1.0;
	float height = sqrt(yy);
	v_ellipse = vec4(middle, lean, sqrt(max(xx - lean * xy, 0.0)));
	vec2 slope = vec2(v_ellipse.w > 0.0 ? (to_z.x - lean * to_z.y) / v_ellipse.w : 0.0, to_z.y / height);
	float bulge = sqrt(max(zz - dot(slope, slope), 0.0));
	v_near_side = view.z * vec4(1.0, slope, bulge);
	/* the point at (u, v) of the near side, in a space where the ellipsoid is a ball, is this matrix
	 * times (u, v, sqrt(1 - u^2 - v^2)); and so is its normal, which `to_plant` takes to plant space */
#if TEXELS == 4 || defined(LEAVES)
	vec3 e_u = v_ellipse.w > 0.0 ? (across - lean * down) / v_ellipse.w : vec3(0.0), e_v = down / height;
	vec3 farther = vec3(axes[0].z, axes[1].z, axes[2].z) / view.z - slope.x * e_u - slope.y * e_v;
	mat3 near_side = mat3(e_u, e_v, farther / -max(bulge, 1e-30));
#endif
#ifdef LEAVES
	float pixel = view.z / (focal.y * p.scale);
	float cells = 1.0 / (LOD_LEAF_LATTICE * side_of(u_leaf.x, pixel));
	mat3 to_cells = halves * near_side * cells;
	float radius = sqrt(v_ellipse.w * height),
		ragged = leaf_rim(min(u_leaf.x / (pixel * radius), LOD_LEAF_RAGGED), radius);
	leafy = t0.w < VIEW_WOOD;
	v_leaves[0] = vec4(to_cells[0], ragged);
	v_leaves[1] = vec4(to_cells[1], leafy ? min(u_leaf.x / pixel, 1.0) : -1.0);
	v_leaves[2] = vec4(to_cells[2], float(opacity) / 16.0);
	v_leaves[3] = vec4(middle_of * cells, u_leaf.y);
	v_to_eye = -normalize(p.row[0].xyz * view.x + p.row[1].xyz * view.y + p.row[2].xyz * view.z);
	if (leafy) grown = sqrt(1.0 + ragged);
#endif
#if TEXELS == 4
	mat3 normals = to_plant * near_side;
	v_normals[0] = vec4(normals[0], height);
	float mean_half = pow(abs(dot(halves[0], cross(halves[1], halves[2]))), 1.0 / 3.0);
	uint level = t0.w < VIEW_WOOD ? (u_level * 30u + 127u) / 255u : 0u;
	v_normals[1] = vec4(normals[1], u_lens.z);
	v_normals[2] = vec4(normals[2],
		float(level << 5 | uint(min(mean_half / p.half_width, 1.0) * 31.0 + 0.5)));
	uint surface = uint(2.0 * u_half.x) | uint(2.0 * u_half.y) << 16;
#else
	v_frame = vec4(height, u_half, u_lens.z);
	uint surface = CLOUD << 30 | u_level << 16 | uint(cloud * 65535.0 + 0.5);
#endif
#if TEXELS == 2
	surface |= SUMMARY;
#endif
	v_seen = uvec4(p.whose, surface, color_of(p, t0.w) | opacity << 24, salt_of(t0.xyz));
#ifdef LEAVES
	if (leafy) v_seen.w += p.salt;
#endif
	/* the first and the last of columns and rows whose middles it may cover */
	vec2 sides = vec2(sqrt(xx), height) * grown + 0.01, from = middle + u_half - 0.5;
	vec2 low = ceil(from - sides), high = floor(from + sides), size = high - low + 1.0;
	there = there && min(size.x, size.y) > 0.0
		&& min(high.x, high.y) >= 0.0 && low.x < 2.0 * u_half.x && low.y < 2.0 * u_half.y
		&& (max(size.x, size.y) > 1.0 || covers_one(low, leafy, grown));
	vec2 around = corner == 0 ? vec2(0.0, 2.0)
		: vec2(corner == 1 ? 1.7320508 : -1.7320508, -1.0);
	around *= vec2(v_ellipse.w, height) * grown + 0.25;
	around.x += lean * around.y;
	vec2 place = u_corners == 1 ? 0.5 * (low + high + 1.0) - u_half : middle + around;
	gl_PointSize = max(size.x, size.y);
	gl_Position = project(view);
	gl_Position.xy = place / u_window * gl_Position.w;
	/* a point that is not drawn lies beside the picture, yet within the viewport: drivers go a long way
	 * round with points that they have to clip */
#ifdef SHADOW
	v_height = height_of(p, middle_of);
#endif
	if (there) return;
	gl_PointSize = 1.0;
	gl_Position = u_corners == 1 ? vec4(-1.0, -1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
#endif

#ifdef GROUND
uniform vec3 u_origin;          // of the anchor, view space
uniform ivec3 u_anchor;         // the grid's point near the eye
uniform vec3 u_step;
uniform ivec3 u_columns;        // of the list; samples of the ring before the tile's first
uniform ivec2 u_inner;          // columns and rows that are drawn
uniform ivec4 u_seam;           // levels by which the neighbours in west, east, south, north are coarser
uniform vec3 u_right, u_up, u_forward;
out vec3 v_normal;
int snapped(int i, int levels, int inner) {
	return min((i + ((1 << levels) >> 1)) >> levels << levels, inner - 1);
}
void main() {
	/* a strip for each row of cells: north-west, south-west, north-east, south-east */
	ivec2 at = ivec2(gl_VertexID >> 1, gl_InstanceID + 1 - (gl_VertexID & 1));
	ivec2 to = at;
	if (at.x == 0) to.y = snapped(to.y, u_seam.x, u_inner.y);
	if (at.x == u_inner.x - 1) to.y = snapped(to.y, u_seam.y, u_inner.y);
	if (at.y == 0) to.x = snapped(to.x, u_seam.z, u_inner.x);
	if (at.y == u_inner.y - 1) to.x = snapped(to.x, u_seam.w, u_inner.x);
	uvec4 t = record_at((to.y + u_columns.z) * u_columns.x + to.x + u_columns.y);
	ivec3 whole = ivec3(t.xyz);
	vec3 p = vec3(whole - u_anchor) * u_step;
	vec3 view = vec3(dot(u_right, p), dot(u_up, p), dot(u_forward, p)) + u_origin;
	vec2 n = vec2(ivec2(t.ww) << ivec2(16, 0) >> 16) / 32767.0;
	v_normal = vec3(n, sqrt(max(1.0 - dot(n, n), 0.0)));
	gl_Position = project(view);
}
#endif

/* ==== Fragments ==== */
#else

#ifdef SHADOW
in float v_height;
#else
out uvec4 o_seen;               // view_gl_target
#endif
uint color_word(uvec3 c) { return c.r | c.g << 8 | c.b << 16; }

#ifdef TINTED
uniform vec4 u_wood[2];         // of the list: share and light of lod_tint_wood
vec3 parts_of(uint word) { return vec3(uvec3(word, word >> 8, word >> 16) & 255u) / 255.0; }
#endif
// lod_tint_apply
uint tinted(uint from, uint color) {
#ifdef TINTED
	vec3 tint = parts_of(v_tint), light = parts_of(from) * parts_of(from);
	float wood = clamp(LOD_TINT_WOOD(u_wood[0], light.r, light.g, light.b), 0.0, 1.0);
	if (v_tint >= LOD_TINT_WHOLE) wood = 0.0;
	vec3 part = 1.0 - min(wood * u_wood[1].rgb / max(light, 1e-4), 1.0);
	light = parts_of(color) * parts_of(color);
	vec3 leaves = light * part;
	float shade = LOD_TINT_SHADE(wood, leaves.r, leaves.g, leaves.b);
	if (v_tint != 0u) color = color_word(uvec3(255.0 * LOD_TINT_MIX(light, leaves, tint, shade) + 0.5));
#endif
	return color;
}

#ifdef LEAVES
/* as leaf_of in view_mesh.c */
void look_leaf(uint leaf, vec3 to_eye, float tone, vec3 normal, inout uint surface, inout uint color) {
	uint look = leaf_look(leaf), side = leaf_side(look);
	vec3 own = vec3(uvec3(color, color >> 8, color >> 16) & 255u);
	color = color_word(uvec3(min(sqrt(leaf_tone(leaf, look, tone)) * own + 0.5, 255.0)));
	bool lit = leaf_is_lit(leaf, look);
#if TEXELS == 4
	uint reach = BALL_LOOK & 31u;
	float level = float(BALL_LOOK >> 5) / 30.0;
	if (!lit) surface = surface_ball(BALL_LOOK, normal);
#else
	uint reach = uint(float(surface & 65535u) * (31.0 / 65535.0) + 0.5);
	float level = float(surface >> 16 & 255u) / 255.0;
#endif
	if (!lit) return;
	if (leaf_is_level(look, leaf_level(level, to_eye.z))) normal = vec3(0.0, 0.0, 1.0);
#if TEXELS == 4
	else if (leaf_is_surface(look)) normal += 0.05 * to_eye;
#endif
	else normal = to_eye + normalize(vec3(leaf_turn(side, 0u), leaf_turn(side, 1u), leaf_turn(side, 2u)));
	surface = surface_ball(31u << 5 | reach, normal);
}
#endif

#if !defined(GROUND) && !defined(IMPOSTORS)
flat in uvec4 v_seen;
#ifdef ELLIPSE
float shown(inout uint surface, inout uint color) {     // 1 / distance; 0: nothing
	vec2 at = gl_FragCoord.xy - HALF - v_ellipse.xy;
	float v = at.y / HEIGHT, u = (at.x - v_ellipse.z * at.y) / v_ellipse.w;
	float rest = 1.0 - v * v - u * u;
#ifdef LEAVES
	uint leaf = 0u;
	if (v_leaves[1].w >= 0.0) {
		leaf_splat leaves = leaf_splat(v_leaves[3].x, v_leaves[0].x, v_leaves[1].x, v_leaves[2].x,
			v_leaves[3].y, v_leaves[0].y, v_leaves[1].y, v_leaves[2].y,
			v_leaves[3].z, v_leaves[0].z, v_leaves[1].z, v_leaves[2].z,
			v_leaves[0].w, v_leaves[2].w, v_leaves[1].w, v_seen.w);
		leaf = leaf_at(leaves, u, v);
		if (leaf == 0u) return 0.0;
		rest = leaf_height2(leaves, leaf & 3u, u, v);
	} else
#endif
	if (!(rest >= 0.0) || !splat_covers(v_seen, uvec2(gl_FragCoord.xy))) return 0.0;
	vec3 side = vec3(u, v, sqrt(rest)), normal = vec3(0.0, 0.0, 1.0);
#if TEXELS == 4
	normal = mat3(v_normals[0].xyz, v_normals[1].xyz, v_normals[2].xyz)
		* vec3(u, v, sqrt(max(1.0 - v * v - u * u, 0.0)));    // leaves of all shells are turned alike
#endif
#ifdef LEAVES
	if (leaf != 0u) look_leaf(leaf, v_to_eye, v_leaves[3].w, normalize(normal), surface, color);
	else
#endif
#if TEXELS == 4
	surface = surface_ball(BALL_LOOK, normal);
#else
	{}
#endif
	float far = v_near_side.x + v_near_side.y * u + v_near_side.z * v
		- v_near_side.w * side.z;
	return 1.0 / max(far, NEAR);
}
#endif
#if TEXELS == 5
in vec2 v_uv;
uniform sampler2D u_texture;
uniform vec4 u_tint;
vec3 light_of(vec3 c) {
	return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}
vec3 bytes_of(vec3 c) {
	return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
#endif
void main() {
	float nearness = gl_FragCoord.w;
	uint surface = v_seen.y, color = v_seen.z;
#ifdef ELLIPSE
	nearness = shown(surface, color);
	if (nearness == 0.0) discard;
#ifndef SHADOW
	gl_FragDepth = nearness * NEAR;
#endif
#endif
#if TEXELS == 5
	/* coverage by the nearest texel, as the rasteriser; colours are filtered, and clear texels hold their
	 * neighbours' */
	ivec2 size = textureSize(u_texture, 0), texel = ivec2(floor(v_uv * vec2(size)));
	texel = clamp(texel - size * ivec2(floor(vec2(texel) / vec2(size))), ivec2(0), size - 1);
	vec3 own = light_of(vec3(uvec3(color, color >> 8, color >> 16) & 255u) / 255.0);
	own = bytes_of(own * texture(u_texture, v_uv).rgb);
	if (texelFetch(u_texture, texel, 0).a < 0.5) discard;
	if (u_tint.w == 0.0) color = color_word(uvec3(own * 255.0 + 0.5));
#endif
#ifdef SHADOW
	gl_FragDepth = shadow_depth(v_height);
#else
	o_seen = uvec4(v_seen.x, surface, floatBitsToUint(nearness), tinted(v_seen.z, color));
#endif
}
#endif

#ifdef GROUND
in vec3 v_normal;
void main() {
	uint surface = surface_direction(FACET, v_normal);
	o_seen = uvec4(0u, surface, floatBitsToUint(gl_FragCoord.w), 0u);
}
#endif

#endif

#include "client-min/draw/view_shader_impostor.glsl"
