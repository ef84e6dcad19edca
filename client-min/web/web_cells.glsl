/* The place of a shadow map: cells of what is seen, and with ROWS the rows of the map from these. */
#ifdef ROWS
#define cells int
#include "client-min/draw/view_shadow.glsl"

/* A fragment a row of the map; each finds all of it. */
uniform usampler2D u_cells;
uniform ivec3 u_count;          // of cells; the picture's width and height
uniform mat3 u_axes;            // to the right, up, forward
uniform vec4 u_sun;             // and the map's size
uniform vec3 u_lens;            // tan_x, tan_y, whether the map has perspective
out uvec4 o_row;
int cells_count(int c) { return c; }
shadow_cell cells_at(int c, int i) {
	ivec2 cell = ivec2(i % CELLS, i / CELLS);
	vec2 part = 2.0 / vec2(u_count.yz), from = vec2(cell * u_count.yz / CELLS) * part,
		end = vec2((cell + 1) * u_count.yz / CELLS) * part;
	vec3 found = uintBitsToFloat(texelFetch(u_cells, cell, 0).xyz);
	return shadow_cell(from.x - 1.0, end.x - 1.0, 1.0 - end.y, 1.0 - from.y, found.x, found.y, found.z);
}
void main() {
	shadow_map m = map_of(u_count.x, shadow_eye(u_axes[0], u_axes[1], u_axes[2], u_lens.x, u_lens.y),
		u_sun.xyz, u_lens.z != 0.0, u_sun.w);
	int which = int(gl_FragCoord.x);
	shadow_row r = m.u;
	if (which == 1) r = m.v;
	if (which == 2) r = m.w;
	if (which == 3) r = m.up;
	o_row = floatBitsToUint(vec4(r.slope, r.at_eye));
}
#else
#define NOTHING 1e30
/* A fragment a cell: 1 / distance of the nearest thing, the farthest, and the farthest plant. */
uniform usampler2D u_seen;
out uvec4 o_cell;
void main() {
	ivec2 size = textureSize(u_seen, 0), cell = ivec2(gl_FragCoord.xy);
	ivec2 from = cell * size / CELLS, end = (cell + 1) * size / CELLS;
	vec3 found = vec3(0.0, NOTHING, NOTHING);
	for (int y = from.y; y < end.y; y++)
		for (int x = from.x; x < end.x; x++) {
			uvec4 seen = texelFetch(u_seen, ivec2(x, y), 0);
			float near = uintBitsToFloat(seen.z);
			bool is_plant = seen.x != 0u || is_summary(seen);
			if (near > 0.0) found = vec3(max(found.x, near), min(found.y, near),
				is_plant ? min(found.z, near) : found.z);
		}
	o_cell = uvec4(floatBitsToUint(found), 0u);
}
#endif
