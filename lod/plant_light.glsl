/* Light on plants, in words that C and GLSL share: lod/plant_light.h includes this text, for clients and for
 * curves, and the client in a browser compiles it as a part of a shader (client-min/web/web_light.c), so that there
 * is one definition of all. Before it both say what vec3, uint, real(x), max, mix, dot and so on are. Numbers have
 * points, as GLSL makes no float of a whole number, and no name is a word of GLSL. */

/* Direction of the sun; what it sends to a surface that faces it, and what the whole sky and the whole ground
 * send; how bright the sky is, and how red around the sun. A surface of albedo 1 in the light 1 is 1. */
struct sunlight { vec3 to, color, sky, earth; float day, glow; };
/* Sunlight on what is seen of something, and through it; height of the mean normal. */
struct sunny { float on, through, facing; };
/* Shares of the sun's, the sky's and the ground's light that come through a crown. */
struct crown { float sun, sky, earth; };
/* The plant of a pixel: how it is turned, its shape, its tone. Summaries' points have no place in a plant:
 * half_height is 0. tone: in [0, 1), by plant. */
struct plant { float sine, cosine, center_z, half_width, half_height, tone; };
/* A pixel's surface: its normal, if it has one; how large it is, in radii of the crown; and the share of the crown
 * that is in it, before and behind alike. */
struct face { sunny sun; vec3 n; bool facet; float reach, whole; };

/* ---- Arithmetic ---- */

LIGHT float within(float v) { return v > 0.0f ? v < 1.0f ? v : 1.0f : 0.0f; }

/* exp(-x), x >= 0, within 1e-4. */
LIGHT float fade(float x)
{
	float y = min(x, 64.0f) / 16.0f,
		e = 1.0f / (1.0f + y * (1.0f + y * (0.5f + y * (1.0f / 6.0f + y / 24.0f))));
	e *= e;
	e *= e;
	e *= e;
	return e * e;
}

/* Within 7e-5 (Abramowitz and Stegun, 4.4.45). */
LIGHT float arc_cosine(float c)
{
	float a = min(abs(c), 1.0f),
		arc = sqrt(1.0f - a) * (1.5707288f + a * (-0.2121144f + a * (0.0742610f - a * 0.0187293f)));
	return c < 0.0f ? 3.1415927f - arc : arc;
}

/* ---- Surfaces ---- */

/* A facet has one normal; blades and bark around an axis and leaves of all directions have the means over
 * the normals that face the eye, each by the area that it shows: c is the cosine between eye and sun, u =
 * 1/4 for an axis, 2/(3 pi) for all directions. */
LIGHT sunny round_sun(float cosine, float u)
{
	float c = min(max(cosine, -1.0f), 1.0f), sine = sqrt(max(1.0f - c * c, 0.0f)), away = arc_cosine(c);
	return sunny(u * (sine + (3.1415927f - away) * c), u * (sine - away * c), 0.0f);
}

LIGHT sunny facet_sun(sunlight s, vec3 n)
{
	float c = dot(n, s.to);
	return sunny(max(c, 0.0f), max(-c, 0.0f), n.z);
}

LIGHT sunny axis_sun(sunlight s, vec3 axis, vec3 n)
{
	vec3 across = add(s.to, scale(axis, -dot(s.to, axis)));
	float l = length(across);
	sunny mean = round_sun(dot(n, across) / max(l, 1e-6f), 0.25f * l);
	return sunny(mean.on, mean.through, 0.785f * n.z);
}

/* The mean over leaves of all directions. */
LIGHT sunny all_sun(sunlight s, vec3 to_eye)
{
	sunny mean = round_sun(dot(to_eye, s.to), 0.2122066f);
	return sunny(mean.on, mean.through, 0.667f * to_eye.z);
}

LIGHT sunny sunny_mix(sunny a, sunny b, float t)
{
	return sunny(mix(a.on, b.on, t), mix(a.through, b.through, t), mix(a.facing, b.facing, t));
}

/* Leaves of which `level` lie level (eco_level_share) and the others give `other`, both by the area that they show. */
LIGHT sunny partly_level(sunlight s, float level, sunny other, vec3 to_eye)
{
	float lying = level * abs(to_eye.z), side = to_eye.z < 0.0f ? -1.0f : 1.0f;
	return sunny_mix(other, sunny(max(side * s.to.z, 0.0f), max(-side * s.to.z, 0.0f), side),
		lying / (lying + max(0.5f * (1.0f - level), 1e-3f)));
}

LIGHT sunny cloud_sun(sunlight s, float level, vec3 to_eye)
{
	return partly_level(s, level, all_sun(s, to_eye), to_eye);
}

/* A splat is half a surface and half a cloud: of balls in a crown mostly the outer sides show, and all
 * facet would be too bright there; as a cloud alone it has no form (lod/EXPERIMENTS.md, Light of splats). */
LIGHT sunny ball_sun(sunlight s, vec3 n, float level, vec3 to_eye)
{
	return partly_level(s, level, sunny_mix(facet_sun(s, n), all_sun(s, to_eye), 0.5f), to_eye);
}

/* ---- Plants ---- */

/* TAKES times the way out, in radii of the crown, is Beer's exponent. CLUMPS: waves of clumps in a radius;
 * CLUMP_DEPTH: how much further inside leaves are than their places, in the mean. Leaves that a ball stands for
 * are SEEN_DEPTH of its radius behind it. MEAN and TOWARDS are the means of crown_at over all leaves that are seen, if 1/e of
 * them are seen through a fifth of the radius; these are linear in the cosine between eye and light within 0.01
 * (lod/EXPERIMENTS.md, Light in crowns). */
#define TAKES_SUN 1.3f
#define TAKES_SKY 0.8f
#define SEEN_DEPTH 0.14f
#define CLUMPS 1.3f
#define CLUMP_DEPTH 0.15f
#define MEAN_SUN 0.445f
#define TOWARDS_SUN 0.212f
#define MEAN_SKY 0.581f
#define TOWARDS_SKY 0.192f
/* Leaves: a third of what they send on comes through them, as is typical of visible light; their wax reflects
 * WAX of all colors, which a model's colors have only in part. */
#define THROUGH 0.32f
#define WAX 0.025f

LIGHT vec3 turned(plant p, vec3 v)
{
	return vec3(v.x * p.cosine - v.y * p.sine, v.x * p.sine + v.y * p.cosine, v.z);
}

/* A point that stands for plants whose owner it has: the owner's upper word. */
LIGHT float summary_tone(uint owner)
{
	float t = real(owner >> 14 & 4095u) * 0.61803f;
	return t - floor(t);
}

/* From a place in a ball of radius 1 out of it, in the direction d. */
LIGHT float way_out(vec3 p, vec3 d)
{
	float along = dot(p, d);
	return sqrt(max(along * along + 1.0f - dot(p, p), 0.0f)) - along;
}

/* Triangle wave of period 1, [-1, 1]. */
LIGHT float wave(float x) { return 4.0f * abs(x - floor(x) - 0.5f) - 1.0f; }

/* Leaves grow in clumps: how much further inside than its place a leaf is, or less. A gyroid is a surface that
 * winds through space alike in all directions; its mean is 0, and no value is looked up. */
LIGHT float clump(vec3 p, float tone)
{
	float x = p.x * CLUMPS + 7.0f * tone, y = p.y * CLUMPS + 0.3f * p.x, z = p.z * CLUMPS + 0.4f * p.y;
	return CLUMP_DEPTH * (1.0f - 0.5f * (wave(x) * wave(y + 0.25f) + wave(y) * wave(z + 0.25f)
		+ wave(z) * wave(x + 0.25f)));
}

/* A crown is a ball of leaves, stretched; its leaves take light by Beer's law. Each of three kinds of light
 * comes straight: the sky's from above, the ground's from below. */
LIGHT crown crown_at(vec3 p, vec3 to_sun, float deeper)
{
	return crown(fade(TAKES_SUN * (way_out(p, to_sun) + deeper)),
		fade(TAKES_SKY * (way_out(p, vec3(0.0f, 0.0f, 1.0f)) + deeper)),
		fade(TAKES_SKY * (way_out(p, vec3(0.0f, 0.0f, -1.0f)) + deeper)));
}

/* The mean over what an eye sees of a crown; both directions are those of the ball. */
LIGHT crown crown_mean(vec3 to_sun, vec3 to_eye)
{
	return crown(MEAN_SUN + TOWARDS_SUN * dot(to_eye, to_sun), MEAN_SKY + TOWARDS_SKY * to_eye.z,
		MEAN_SKY - TOWARDS_SKY * to_eye.z);
}

/* A direction as it is in the ball that a crown is when it is not stretched. */
LIGHT vec3 unstretched(plant p, vec3 v)
{
	float aspect = p.half_height > 0.0f ? p.half_width / p.half_height : 1.0f;
	return unit(vec3(v.x, v.y, v.z * aspect));
}

/* from_foot: from the plant's foot, in the world's axes, metres over the plant's scale. */
LIGHT crown crown_of(sunlight s, plant p, face seen, vec3 from_foot, vec3 to_eye)
{
	vec3 sun = unstretched(p, s.to), eye = unstretched(p, to_eye);
	crown mean = crown_mean(sun, eye);
	if (!(p.half_height > 0.0f))
		return mean;
	vec3 place = vec3(from_foot.x / p.half_width, from_foot.y / p.half_width,
		(from_foot.z - p.center_z) / p.half_height);
	float out_of = length(place);
	place = scale(place, out_of > 0.97f ? 0.97f / out_of : 1.0f);
	crown here = crown_at(add(place, scale(eye, SEEN_DEPTH * (seen.whole - seen.reach))), sun, clump(place, p.tone));
	return crown(mix(here.sun, mean.sun, seen.whole), mix(here.sky, mean.sky, seen.whole),
		mix(here.earth, mean.earth, seen.whole));
}

/* With a shadow map a crown's own shade is what the map has of it, but for what one texel of it, or one
 * primitive, holds: that is as it is without a map. Leaves pass light on, so no shadow is black.
 * lit: the share of sunlight that arrives, below 0 where there is no map; texel: a texel's side over half
 * the width of the plant; reach: of the part of the primitive that the map does not shade. The mean way out of a
 * ball is 3/4 of its radius, and leaves are seen through a fifth of a crown's: INSIDE = 5 * 3/4. */
#define INSIDE 3.75f

LIGHT crown crown_by_map(plant p, crown own, float lit, float texel, float reach)
{
	if (lit < 0.0f)
		return own;
	float coarse = p.half_height > 0.0f ? within(max(1.0f - fade(INSIDE * reach), texel)) : 1.0f;
	return crown(mix(0.08f, 1.0f, lit) * mix(1.0f, own.sun, coarse), own.sky, own.earth);
}

/* A leaf's own color is the share of light that it sends on: most of it is reflected, the rest comes through,
 * yellower. Each side gets its half of the sky's and the ground's light. */
LIGHT vec3 light_of(sunlight s, sunny sun, crown around, float leaf)
{
	vec3 sky = scale(s.sky, around.sky), earth = scale(s.earth, around.earth), direct = scale(s.color, around.sun);
	vec3 front = add(blend(earth, sky, 0.5f + 0.5f * sun.facing), scale(direct, sun.on)),
		back = add(blend(sky, earth, 0.5f + 0.5f * sun.facing), scale(direct, sun.through));
	return add(scale(front, 1.0f - THROUGH * leaf), times(back, scale(vec3(1.0f, 1.0f, 0.35f), THROUGH * leaf)));
}

LIGHT vec3 plant_light(sunlight s, plant p, vec3 own, sunny sun, crown around, bool by_kind)
{
	float green = own.y - max(own.x * 0.9f, own.z),
		leaf = smoothstep(0.0f, 0.25f, green / max(own.y, 1e-4f));
	float tone = p.tone * 16.0f - floor(p.tone * 16.0f) - 0.5f, warm = 0.16f * (p.tone - 0.5f) * leaf;
	vec3 light = light_of(s, sun, around, leaf);
	own = blend(own, add(scale(own, 0.82f), vec3(WAX, WAX, WAX)), leaf);
	if (by_kind)
		return times(own, blend(vec3(0.75f, 0.75f, 0.75f), light, 0.35f));
	vec3 color = times(scale(own, 1.0f + 0.28f * tone),
		vec3(1.0f + warm, 1.0f + 0.1f * warm, 1.0f - warm));
	return times(color, light);
}
