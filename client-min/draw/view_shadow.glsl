/* The place of a shadow map, and the light that it lets through, in words that C and GLSL share: view_shadow.c
 * includes this text, and the client in a browser compiles it as parts of shaders (client-min/web/web_cells.glsl,
 * web_light.glsl), so that there is one definition of both. The rules of view_light.glsl hold. Before it both
 * define what cells and tops are, after it what is in them; parts for which one is not defined are left out. */

/* The largest texel's side over the smallest's, at most; how many times as far as the farthest plant ground
 * is still shaded; how far the near plane is pulled back: about a texel a pixel near the eye
 * (lod/EXPERIMENTS.md, Shadow maps); texels around what is seen. */
#define SPREAD 64.0f
#define BEYOND 1.25f
#define BACK 0.25f
#define MARGIN 2.0f
#define NOTHING 1e30f

/* A linear function of places, which are metres from the eye in the world's axes. */
struct shadow_row { vec3 slope; float at_eye; };
/* U, V and W of texels, and metres towards the sun, whose slope is the sun. */
struct shadow_map { shadow_row u, v, w, up; float size; };
/* The eye's axes, and the half extents of its image plane at distance 1. */
struct shadow_eye { vec3 right, up, forward; float tan_x, tan_y; };
/* A cell of the picture: its sides in the image plane, [-1, 1]; and 1 / distance forward of the nearest thing
 * that is seen in it (0: there is none), of the farthest, and of the farthest plant (NOTHING: no such). */
struct shadow_cell { float west, east, south, north, nearest, farthest, plant; };
/* Metres forward. */
struct shadow_range { float nearest, farthest; };
struct shadow_sides { vec3 first, second; };
struct shadow_extent { float low_x, low_y, high_x, high_y; };
/* Position of a place in the map, texels, and its W; that is 0 beyond the edges. */
struct shadow_spot { float x, y, w; };
/* The share of sunlight that arrives, -1: beyond the map; how large a texel is there. */
struct shadow_light { float lit, texel_m; };

LIGHT float row_at(shadow_row r, vec3 to) { return dot(r.slope, to) + r.at_eye; }

/* a times one row and b times another. */
LIGHT shadow_row row_mixed(shadow_row r, float a, shadow_row s, float b)
{
	return shadow_row(add(scale(r.slope, a), scale(s.slope, b)), r.at_eye * a + s.at_eye * b);
}

/* ---- What is seen ---- */

#ifdef cells
LIGHT int cells_count(cells c);
LIGHT shadow_cell cells_at(cells c, int i);

/* Ground counts as far as plants are seen; without plants all of it. */
LIGHT shadow_range range_of(cells c)
{
	float nearest = 1.0f / NOTHING, farthest = NOTHING, plant = NOTHING;
	for (int i = 0; i < cells_count(c); i++) {
		shadow_cell s = cells_at(c, i);
		nearest = max(nearest, s.nearest);
		farthest = min(farthest, s.farthest);
		plant = min(plant, s.plant);
	}
	return shadow_range(1.0f / nearest, plant < NOTHING ? BEYOND / plant : 1.0f / farthest);
}

/* Corners of what a cell may show; of nearness, then to the east and to the north. */
LIGHT vec3 corner_of(shadow_eye e, shadow_cell s, float nearness, int k)
{
	vec3 across = scale(e.right, ((k & 1) == 1 ? s.east : s.west) * e.tan_x);
	vec3 up = scale(e.up, ((k & 2) == 2 ? s.north : s.south) * e.tan_y);
	return scale(add(e.forward, add(across, up)), 1.0f / nearness);
}

/* Ranges of W, or of U / W and V / W, which are extreme at corners as W is positive. */
LIGHT shadow_extent extent_of(cells c, shadow_eye e, float farthest_m, shadow_map m, bool of_w)
{
	shadow_extent x = shadow_extent(NOTHING, NOTHING, -NOTHING, -NOTHING);
	float least = 1.0f / farthest_m;
	for (int i = 0; i < cells_count(c); i++) {
		shadow_cell s = cells_at(c, i);
		for (int k = 0; k < 8 && s.nearest >= least; k++) {
			vec3 to = corner_of(e, s, k < 4 ? s.nearest : max(s.farthest, least), k);
			float w = row_at(m.w, to), a = of_w ? w : row_at(m.u, to) / w,
				b = of_w ? w : row_at(m.v, to) / w;
			x = shadow_extent(min(x.low_x, a), min(x.low_y, b), max(x.high_x, a),
				max(x.high_y, b));
		}
	}
	return x;
}

/* ---- Maps ---- */

/* Two directions across an axis, the first of them across `other`, too; where that is the axis, `instead`. */
LIGHT shadow_sides sides_of(vec3 axis, vec3 other, vec3 instead)
{
	vec3 first = cross(axis, other);
	if (!(dot(first, first) > 1e-7f * dot(axis, axis) * dot(other, other)))
		first = cross(axis, instead);
	return shadow_sides(unit(first), unit(cross(axis, first)));
}

LIGHT shadow_map map_standard(shadow_eye e, vec3 sun, float size)
{
	shadow_sides side = sides_of(sun, e.forward, e.up);
	return shadow_map(shadow_row(side.first, 0.0f), shadow_row(side.second, 0.0f),
		shadow_row(vec3(0.0f, 0.0f, 0.0f), 1.0f), shadow_row(sun, 0.0f), size);
}

/* x, y, z, w are the eye's space after perspective, x, y, z in [-1, 1], and at the sun's place there. */
LIGHT shadow_map map_perspective(shadow_eye e, vec3 sun, shadow_range r, float size)
{
	float back = BACK * sqrt(r.nearest * r.farthest), near = r.nearest + back,
		far = max(r.farthest, r.nearest * 1.01f) + back, deep = (far + near) / (far - near);
	shadow_row x = shadow_row(scale(e.right, 1.0f / e.tan_x), 0.0f),
		y = shadow_row(scale(e.up, 1.0f / e.tan_y), 0.0f),
		z = shadow_row(scale(e.forward, deep), back * deep - 2.0f * far * near / (far - near)),
		w = shadow_row(e.forward, back);
	vec3 at = vec3(dot(x.slope, sun), dot(y.slope, sun), dot(z.slope, sun));
	float away = length(at);
	shadow_sides side = sides_of(at, vec3(0.0f, 0.0f, 1.0f), vec3(0.0f, 1.0f, 0.0f));
	shadow_row along = row_mixed(row_mixed(x, at.x, y, at.y), 1.0f, z, at.z);
	return shadow_map(row_mixed(row_mixed(x, side.first.x, y, side.first.y), 1.0f, z, side.first.z),
		row_mixed(row_mixed(x, side.second.x, y, side.second.y), 1.0f, z, side.second.z),
		row_mixed(w, away, along, -dot(e.forward, sun) / away), shadow_row(sun, 0.0f), size);
}

/* A W that is the same everywhere makes texels of one size: as much of it as keeps them within SPREAD; then
 * the least W is 1. */
LIGHT shadow_row spread_limited(shadow_row w, shadow_extent x)
{
	float more = max((x.high_x / SPREAD - x.low_x) / (1.0f - 1.0f / SPREAD), 0.0f),
		part = 1.0f / max(x.low_x + more, 1e-9f);
	return shadow_row(scale(w.slope, part), (w.at_eye + more) * part);
}

/* Moves and stretches what is seen to the whole map. */
LIGHT shadow_row stretched(shadow_row r, shadow_row w, float low, float high, float size)
{
	float factor = (size - 2.0f * MARGIN) / max(high - low, 1e-6f);
	return row_mixed(r, factor, w, MARGIN - low * factor);
}

/* Without anything seen W is 0 everywhere, and no place is in the map. */
LIGHT shadow_map map_of(cells c, shadow_eye e, vec3 sun, bool perspective, float size)
{
	shadow_range range = range_of(c);
	shadow_row none = shadow_row(vec3(0.0f, 0.0f, 0.0f), 0.0f);
	if (!(range.nearest < 1e-6f * NOTHING))
		return shadow_map(none, none, none, none, size);
	shadow_map m = map_standard(e, sun, size);
	if (perspective) {
		m = map_perspective(e, sun, range, size);
		m.w = spread_limited(m.w, extent_of(c, e, range.farthest, m, true));
	}
	shadow_extent x = extent_of(c, e, range.farthest, m, false);
	return shadow_map(stretched(m.u, m.w, x.low_x, x.high_x, size),
		stretched(m.v, m.w, x.low_y, x.high_y, size), m.w, m.up, size);
}

#endif

/* ---- Looking up ---- */

#ifdef tops
/* Whether nothing in the map at that texel is higher. */
LIGHT bool tops_below(tops t, float x, float y, float height);

/* How much lower a surface may be within the texels that are looked at, so that it is not its own shadow.
 * right and down: from one texel to the next, metres across the beams. facet: it has one normal. */
LIGHT float slack_of(vec3 sun, vec3 right, vec3 down, vec3 n, bool facet)
{
	float sum = facet ? abs(dot(n, right)) + abs(dot(n, down)) : length(right) + length(down);
	return 1.5f * sum / (facet ? max(abs(dot(n, sun)), 0.1f) : 1.0f);
}

/* The share of one of three texels in a row, for a place in the middle one: `part` of its way. */
LIGHT float share_of(float part, int i)
{
	return i == 1 ? 0.5f : 0.5f * (i == 0 ? 1.0f - part : part);
}

LIGHT shadow_spot spot_of(shadow_map m, vec3 to)
{
	float w = row_at(m.w, to), x = row_at(m.u, to) / w, y = row_at(m.v, to) / w, last = m.size - 1.5f;
	return shadow_spot(x, y, w > 0.0f && x >= 1.5f && y >= 1.5f && x < last && y < last ? w : 0.0f);
}

/* The mean of 3 x 3 texels. */
LIGHT shadow_light shadow_at(shadow_map m, tops t, vec3 to, vec3 n, bool facet)
{
	shadow_spot s = spot_of(m, to);
	if (!(s.w > 0.0f))
		return shadow_light(-1.0f, 0.0f);
	vec3 across = scale(add(m.u.slope, scale(m.w.slope, -s.x)), 1.0f / s.w),
		along = scale(add(m.v.slope, scale(m.w.slope, -s.y)), 1.0f / s.w);
	vec3 right = cross(along, m.up.slope), down = cross(m.up.slope, across);
	float part = 1.0f / dot(across, right), lit = 0.0f;
	right = scale(right, part);
	down = scale(down, part);
	float height = row_at(m.up, to) + slack_of(m.up.slope, right, down, n, facet);
	float west = floor(s.x - 1.0f), north = floor(s.y - 1.0f);
	for (int k = 0; k < 9; k++)
		if (tops_below(t, west + real(k % 3), north + real(k / 3), height))
			lit += share_of(s.x - 1.0f - west, k % 3) * share_of(s.y - 1.0f - north, k / 3);
	return shadow_light(lit, sqrt(max(dot(right, right), dot(down, down))));
}
#endif
