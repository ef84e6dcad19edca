/* Impostors: what lod/impostor_look.c and lod/raster/raster_splat.c do, by the same operations in the same
 * order. A vertex chooses the tiles and the rays of pixels; a fragment follows its ray. Levels lie in records
 * as view_record.h says.
 *
 * A plant is two triangles that cover its outline.
 *
 * In a shadow map the outline is that of a disc across the beams, and rays come from a place that is
 * 64 radii towards the sun (view_shadow_cast.c). A beam (x, y) meets the disc where its two half axes have
 * shares s and t: (s, t, 1) is W times the inverse of the matrix of half axes and middle times (x, y, 1), so
 * that a ray, of any length, is linear in x and y. */
#ifdef IMPOSTORS
uniform int u_first_record;     // of the level
uvec4 record(uint at) { return record_at(u_first_record + int(at)); }
mat3 tile_at(uint start, uint i) {
	uint at = start + 2u * i;
	vec4 a = uintBitsToFloat(record(at)), b = uintBitsToFloat(record(at + 1u));
	return mat3(a.xyz, vec3(a.w, b.xy), vec3(0.0, b.zw));
}

#ifdef VERTEX
uniform uint u_surface, u_sample;
uniform vec2 u_half;
flat out vec3 v_eye, v_from[4];
flat out mat3 v_rays;           // through the middle, and what a pixel across and one down add
flat out vec4 v_outline;        // x, y, lean, half
flat out vec4 v_weight;
flat out uvec4 v_tile;
flat out uvec2 v_more;          // the outline's height, the tile of colours
struct Ring { float sine, cosine; uint first, stored, count; };
Ring ring_at(uint i) {
	uvec4 t = record(3u + i);
	return Ring(uintBitsToFloat(t.x), uintBitsToFloat(t.y), t.z & 255u, t.z >> 8 & 255u, t.z >> 16);
}
float beyond(uint tiles, Ring ring, uint i, vec3 d) {
	bool reversed = i >= ring.stored;
	uvec4 t = record(tiles + 2u * (ring.first + (reversed ? i - ring.stored : i)));
	float side = uintBitsToFloat(t.x) * d.x + uintBitsToFloat(t.w) * d.y;
	return reversed ? -side : side;
}
float between(uint tiles, Ring ring, vec3 d, out uvec2 tile) {       // the second one's share
	tile = uvec2(ring.first);
	if (ring.count < 2u) return 0.0;
	float past = beyond(tiles, ring, 0u, d);
	for (uint i = 0u; i < ring.count; i++) {
		uint next = i + 1u < ring.count ? i + 1u : 0u;
		float ahead = -beyond(tiles, ring, next, d);
		if (past >= 0.0 && ahead >= 0.0) {
			tile = ring.first + uvec2(i, next) % ring.stored;
			return past + ahead > 0.0 ? past / (past + ahead) : 0.0;
		}
		past = -ahead;
	}
	return 0.0;
}
void choose_tiles(uint rings, uint tiles, vec3 d) {
	uint low = 0u;
	while (low + 2u < rings && d.z >= ring_at(low + 1u).sine) low++;
	Ring lower = ring_at(low), upper = ring_at(low + 1u);
	float flat_part = sqrt(d.x * d.x + d.y * d.y);
	float past = max(d.z * lower.cosine - flat_part * lower.sine, 0.0);
	float ahead = max(flat_part * upper.sine - d.z * upper.cosine, 0.0);
	float part = past + ahead > 0.0 ? past / (past + ahead) : 0.0;
	uvec2 tile;
	float share = between(tiles, lower, d, tile);
	v_tile.xy = tile;
	v_weight.xy = (1.0 - part) * vec2(1.0 - share, share);
	share = between(tiles, upper, d, tile);
	v_tile.zw = tile;
	v_weight.zw = part * vec2(1.0 - share, share);
	if (v_weight.y > v_weight.x) v_weight.xy = v_weight.yx, v_tile.xy = v_tile.yx;
	if (v_weight.w > v_weight.z) v_weight.zw = v_weight.wz, v_tile.zw = v_tile.wz;
	if (v_weight.z > v_weight.x) v_weight.xz = v_weight.zx, v_tile.xz = v_tile.zx;
	if (v_weight.w > v_weight.y) v_weight.yw = v_weight.wy, v_tile.yw = v_tile.wy;
	if (v_weight.z > v_weight.y) v_weight.yz = v_weight.zy, v_tile.yz = v_tile.zy;
}
uint choose_color(uint tiles, uint count, vec3 d) {
	uint best = 0u;
	float nearest = -1.0;
	for (uint i = 0u; i < count; i++) {
		float near = abs((tile_at(tiles, i) * d).z);
		if (near > nearest) { nearest = near; best = i; }
	}
	return best;
}
void look(vec3 eye) {
	uvec4 head = record(1u), start = record(2u);
	float size = sqrt(dot(eye, eye));
	vec3 d = eye * ((eye.z < 0.0 ? -1.0 : 1.0) / (size > 0.0 ? size : 1.0));
	choose_tiles(head.z & 255u, start.x, d);
	v_more.y = choose_color(start.y, head.z >> 8 & 255u, d);
	v_eye = eye;
	for (int i = 0; i < 4; i++) v_from[i] = tile_at(start.x, v_tile[i]) * eye;
}
#ifdef LEAVES
uniform vec2 u_leaf;            // width of a leaf, deviation of tone
flat out vec3 v_leaf;           // cells a metre, amount, tone
#endif
#ifdef SHADOW
flat out vec4 v_high;           // height of places from the middle
mat3 disc;                      // its half axes in the map, y down, and its middle
#endif
/* lod_ball_outline, or of a disc; false where nothing is drawn */
bool outline(vec3 view, float radius, vec2 focal, out vec2 size) {
	vec2 middle = vec2(view.x, -view.y) * focal / view.z;
#ifdef SHADOW
	float zz = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
	vec2 to_z = vec2(0.0);
	for (int k = 0; k < 2; k++) {
		vec2 d = (disc[k].xy - disc[k].z * middle) / view.z;
		float q = disc[k].z / view.z;
		xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
		to_z += d * q, zz += q * q;
	}
#else
	float near = radius / view.z, zz = near * near;
	vec2 wide = focal * near, side = -middle * near, to_z = side * near;
	float xx = wide.x * wide.x + side.x * side.x, xy = side.x * side.y,
		yy = wide.y * wide.y + side.y * side.y;
#endif
	float part = 1.0 / (1.0 - zz);
	bool there = view.z >= u_lens.z && zz < 1.0 && xx > 0.0 && yy > 0.0 && xx < 1e30 && yy < 1e30;
	xx = (xx + to_z.x * to_z.x * part) * part;
	xy = (xy + to_z.x * to_z.y * part) * part;
	yy = (yy + to_z.y * to_z.y * part) * part;
	float lean = xy / yy;
	size = vec2(sqrt(xx), sqrt(yy));
	v_outline = vec4(middle - to_z * part - vec2(u_middle.x, -u_middle.y) * focal, lean,
		sqrt(max(xx - lean * xy, 0.0)));
	v_more.x = floatBitsToUint(size.y);
	return there;
}
void main() {
	Plant p = plant_of_member(gl_VertexID / 4 + u_first);
	vec4 ball = uintBitsToFloat(record(0u));
	vec3 view = view_of(p, ball.xyz);
	vec2 focal = u_lens.xy * u_half, size;
#ifdef SHADOW
	vec3 sun = sun_of(p), half_of[2];
	for (int k = 0; k < 2; k++) {
		half_of[k] = ball.w * axis_across(sun, k);
		disc[k] = axis_of(p, half_of[k]);
	}
	disc[2] = vec3(view.x, -view.y, view.z);
#endif
	bool there = outline(view, ball.w * p.scale * max(p.width, 1.0), focal, size);
	gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
	if (!there) return;
	int corner = gl_VertexID & 3;
	vec2 sign = vec2(corner == 1 || corner == 2 ? 1.0 : -1.0, corner >= 2 ? 1.0 : -1.0);
	gl_Position = project(view);
	gl_Position.xy = (v_outline.xy + sign * (size + 1.0)) / u_half * gl_Position.w;
	uint x = record(0u).x, y = record(0u).y, z = record(0u).z, nth = u_sample, salt;
	LOD_HASH_SALT;
	v_seen = uvec4(p.whose, u_surface, color_of(p, 0u), salt);
#ifdef SHADOW
	vec3 from = sun * (64.0 * ball.w);
	mat3 rays = mat3(half_of[0], half_of[1], -from) * inverse(disc);
	v_rays = mat3(rays[2], rays[0], rays[1]);
	v_high = vec4(p.high.xyz, height_of(p, ball.xyz));
	look(from);
#else
#ifdef LEAVES
	float pixel = view.z / (focal.y * p.scale);
	v_seen.w += p.salt;
	v_leaf = vec3(1.0 / (LOD_LEAF_LATTICE * side_of(u_leaf.x, pixel)), min(u_leaf.x / pixel, 1.0),
		u_leaf.y);
#endif
	vec3 square = p.scale * p.scale * vec3(p.width * p.width, p.width * p.width, 1.0); // of rows, too
	v_rays = mat3((p.row[2].xyz + u_middle.x * p.row[0].xyz + u_middle.y * p.row[1].xyz) / square,
		p.row[0].xyz / (square * focal.x), p.row[1].xyz / (-square * focal.y));
	look((p.row[0].xyz * view.x + p.row[1].xyz * view.y + p.row[2].xyz * view.z) / -square);
#endif
}
#else
uniform vec2 u_half;
uniform vec4 u_lens, u_tint;
flat in uvec4 v_seen;
flat in vec3 v_eye, v_from[4];
flat in mat3 v_rays;
flat in vec4 v_outline;
flat in vec4 v_weight;
flat in uvec4 v_tile;
flat in uvec2 v_more;
#ifdef LEAVES
flat in vec3 v_leaf;
#endif
#ifdef SHADOW
flat in vec4 v_high;
#endif
uint code_at(uint start, uint i, uint width) {
	uint bit = i * width;
	return record(start + (bit >> 7))[bit >> 5 & 3u] >> (bit & 31u) & ((1u << width) - 1u);
}
bool inside(vec2 pixel) {
	vec2 at = pixel - v_outline.xy;
	float v = at.y / uintBitsToFloat(v_more.x), rest = 1.0 - v * v, x = at.x - v_outline.z * at.y;
	float half_row = v_outline.w * sqrt(max(rest, 0.0));
	return rest >= 0.0 && x >= -half_row && x < half_row;
}
float mixed(vec4 corner, vec2 part) {
	vec2 rows = (1.0 - part.x) * corner.xz + part.x * corner.yw;
	return (1.0 - part.y) * rows.x + part.y * rows.y;
}
float texel_at(uint start, uint tile, int side, ivec2 at) {
	if (min(at.x, at.y) < 0 || max(at.x, at.y) >= side) return 0.0;
	return float(code_at(start, (tile * uint(side) + uint(at.y)) * uint(side) + uint(at.x), 1u));
}
float cover_at(uint start, uint tile, uint side, vec2 at) {
	at = (0.5 + vec2(0.5, -0.5) * at) * float(side) - 0.5;
	if (!(min(at.x, at.y) > -1.0 && max(at.x, at.y) < float(side))) return 0.0;
	vec2 low = floor(at);
	ivec2 to = ivec2(low);
	int last = int(side);
	vec4 corner = vec4(texel_at(start, tile, last, to), texel_at(start, tile, last, to + ivec2(1, 0)),
		texel_at(start, tile, last, to + ivec2(0, 1)), texel_at(start, tile, last, to + 1));
	return mixed(corner, at - low);
}
float depth_at(uint start, uint tile, uint side, uint codes, vec2 at) {
	at = clamp((0.5 + vec2(0.5, -0.5) * at) * float(side) - 0.5, 0.0, float(side - 1u));
	uvec2 low = uvec2(at), high = min(low + 1u, uvec2(side - 1u)),
		row = (tile * side + uvec2(low.y, high.y)) * side;
	uvec4 code = uvec4(code_at(start, row.x + low.x, 4u), code_at(start, row.x + high.x, 4u),
		code_at(start, row.y + low.x, 4u), code_at(start, row.y + high.x, 4u));
	return mixed(2.0 * vec4(code) / float(codes - 1u) - 1.0, at - vec2(low));
}
/* lod_impostor_hit; `rest`: 1 less the square of the distance from the middle */
bool hit(vec3 ray, out float along, out float rest) {
	uvec4 head = record(1u), start = record(2u);
	uint side = head.y & 255u, depths = head.y >> 8 & 255u, codes = head.y >> 24;
	float cover = 0.0, out2 = 0.0, left = 1.0;
	along = 0.0, rest = 0.0;
	for (int i = 0; i < 4; i++) {
		if (!(v_weight[i] > 0.0)) continue;
		uint tile = v_tile[i];
		vec3 from = v_from[i], slope = tile_at(start.x, tile) * ray;
		float part = 1.0 / slope.z, t = -from.z * part;
		float deep = depth_at(start.w, tile, depths, codes, from.xy + t * slope.xy);
		t = (deep - from.z) * part;
		vec2 at = from.xy + t * slope.xy;
		float here = v_weight[i] * cover_at(start.z, tile, side, at);
		left -= v_weight[i];
		if (cover + here + left < LOD_IMPOSTOR_HOPE) return false;
		if (!(here > 0.0)) continue;
		cover += here;
		along += here * t;
		out2 += here * (at.x * at.x + at.y * at.y);
		if (cover >= LOD_IMPOSTOR_LEAST && left < LOD_IMPOSTOR_LIGHT) break;
	}
	if (!(cover >= LOD_IMPOSTOR_LEAST)) return false;
	along /= cover;
	rest = max(1.0 - out2 / cover, 0.0);
	return true;
}
uint color_at(vec3 point) {
	uvec4 head = record(1u);
	uint side = head.y >> 16 & 255u;
	vec2 at = (tile_at(record(2u).y, v_more.y) * point).xy;
	uvec2 cell = uvec2(clamp((0.5 + vec2(0.5, -0.5) * at) * float(side), 0.0, float(side - 1u)));
	uint code = code_at(head.w, (v_more.y * side + cell.y) * side + cell.x, 16u);
	return color_word(((uvec3(code) >> uvec3(0, 5, 10) & 31u) * 255u + 15u) / 31u);
}
void main() {
	vec2 pixel = gl_FragCoord.xy - u_half;
	vec3 ray = v_rays[0] + pixel.y * v_rays[2] + pixel.x * v_rays[1];
	float along, rest;
	if (!inside(pixel) || !hit(ray, along, rest)) discard;
	float opacity = float(record(1u).z >> 16 & 255u) / 16.0;
#ifdef LEAVES
	float before = uintBitsToFloat(record(1u).x) * sqrt(rest / dot(ray, ray));
	vec3 at = (uintBitsToFloat(record(0u).xyz) + v_eye + (along - before) * ray) * v_leaf.x;
	uint cell = leaf_cell(at.x, at.y, at.z);
	float need = leaf_need(leaf_drawn(cell, v_leaf.y, v_seen.w));
#else
	uint salt = v_seen.w, column = uint(gl_FragCoord.x), row = uint(gl_FragCoord.y), hash;
	LOD_HASH_SPLAT;
	float need = float(hash >> 24) / 256.0;
#endif
	if (!(need < opacity)) discard;
#ifdef SHADOW
	gl_FragDepth = shadow_depth(dot(v_high.xyz, v_eye + along * ray) + v_high.w);
#else
#ifndef LEAVES
	float before = uintBitsToFloat(record(1u).x) * sqrt(rest / dot(ray, ray));
#endif
	uint color = u_tint.w > 0.0 ? v_seen.z : color_at(v_eye + along * ray), from = color;
	along += before * (2.0 * LOD_IMPOSTOR_DEEP(need, opacity) - 1.0);
	float nearness = 1.0 / max(along, u_lens.z);
	gl_FragDepth = nearness * u_lens.z;
	uint surface = v_seen.y;
#ifdef LEAVES
	look_leaf(leaf_in(cell, v_leaf.y), normalize(v_eye), v_leaf.z, vec3(0.0, 0.0, 1.0), surface, color);
#endif
	o_seen = uvec4(v_seen.x, surface, floatBitsToUint(nearness), tinted(from, color));
#endif
}
#endif
#endif
