/* Light, in words that C and GLSL share: view_light.c includes this text, and the client in a browser
 * compiles it as a part of a shader (client-min/web/web_light.c), so that there is one definition of both.
 * Before it both say what vec3, uint, real(x), max, mix, dot and so on are, and ground_place with noise_at.
 * Numbers have points, as GLSL makes no float of a whole number, and no name is a word of GLSL. */

/* Direction of the sun; its light, what a leaf lets through of it, and the sky's and the earth's on surfaces;
 * how bright the sky is, and how red around the sun. */
struct sunlight { vec3 to, color, through, sky, earth; float day, glow; };
/* Sunlight on what is seen of something, and through it; height of the mean normal. */
struct sunny { float on, through, facing; };
/* Shares of light that a crown lets through: shade of the sun's, open of the sky's; rise: height of the
 * direction out of the crown. */
struct crown { float shade, open, rise; };
/* The plant of a pixel: how it is turned, its shape, its tone. Summaries' points have no place in a plant:
 * half_height is 0. */
struct plant { float sine, cosine, center_z, half_width, half_height, tone; };
/* A pixel's surface: its normal, if it has one, and the share of a crown that stands in it. */
struct face { sunny sun; vec3 n; bool facet; float reach; };

/* ---- Arithmetic ---- */

LIGHT float within(float v) { return v > 0.0f ? v < 1.0f ? v : 1.0f : 0.0f; }

/* exp(-x), x >= 0, within 1e-6. */
LIGHT float fade(float x)
{
	float y = min(x, 64.0f) / 64.0f,
		e = 1.0f / (1.0f + y * (1.0f + y * (0.5f + y * (1.0f / 6.0f + y / 24.0f))));
	for (int i = 0; i < 6; i++)
		e *= e;
	return e;
}

/* Within 7e-5 (Abramowitz and Stegun, 4.4.45). */
LIGHT float arc_cosine(float c)
{
	float a = min(abs(c), 1.0f),
		arc = sqrt(1.0f - a) * (1.5707288f + a * (-0.2121144f + a * (0.0742610f - a * 0.0187293f)));
	return c < 0.0f ? 3.1415927f - arc : arc;
}

LIGHT vec3 grey(vec3 c, vec3 weight)
{
	float g = dot(c, weight);
	return blend(c, vec3(g, g, g), 0.7f);
}

/* Reads the word of view_light.h. */
LIGHT vec3 direction_of(uint surface)
{
	float x = real(surface & 32767u) / 32767.0f * 2.0f - 1.0f;
	float y = real(surface >> 15 & 32767u) / 32767.0f * 2.0f - 1.0f;
	float z = 1.0f - abs(x) - abs(y), under = z < 0.0f ? -z : 0.0f;
	return unit(vec3(x + (x < 0.0f ? under : -under), y + (y < 0.0f ? under : -under), z));
}

/* ---- The sky, and what is far ---- */

LIGHT vec3 sky_at(sunlight s, vec3 ray)
{
	float low = 1.0f - within(ray.z), c = max(dot(ray, s.to), 0.0f), c2 = c * c, c8 = c2 * c2 * c2 * c2;
	vec3 blue = blend(vec3(0.10f, 0.25f, 0.58f), vec3(0.50f, 0.61f, 0.74f), low * low * low);
	/* low sunlight comes through much air, which leaves its red: most of it near the horizon and the
	 * sun */
	float red = s.glow * low * low * low * (0.35f + 0.65f * c2);
	blue = blend(blue, vec3(0.86f, 0.50f, 0.25f), 0.75f * red);
	return scale(add(blue, scale(vec3(0.17f, 0.14f, 0.09f), c8)), s.day);
}

LIGHT vec3 haze(sunlight s, vec3 color, vec3 to, float distance_m, float haze_m)
{
	vec3 ray = scale(to, 1.0f / max(distance_m, 1e-20f));
	return blend(sky_at(s, vec3(ray.x, ray.y, ray.z * 0.2f)), color, fade(distance_m / haze_m));
}

LIGHT vec3 background(sunlight light, vec3 ray)
{
	if (!(ray.z > 0.0f))
		return blend(sky_at(light, vec3(ray.x, ray.y, 0.0f)),
			scale(vec3(0.34f, 0.39f, 0.41f), light.day), smoothstep(0.0f, 0.9f, -ray.z));
	float s = max(dot(ray, light.to), 0.0f), s2 = s * s, s4 = s2 * s2, s8 = s4 * s4, s64 = s8 * s8;
	s64 *= s64;
	s64 *= s64;
	/* s^200 */
	return add(sky_at(light, ray), scale(vec3(0.6f, 0.5f, 0.3f), s64 * s64 * s64 * s8));
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
LIGHT sunny all_sun(sunlight s, vec3 to_eye) { return round_sun(dot(to_eye, s.to), 0.2122066f); }

/* A splat is half a surface and half a cloud: of balls in a crown mostly the outer sides show, and all
 * facet would be too bright there; as a cloud alone it has no form (lod/EXPERIMENTS.md, Light of splats).
 * */
LIGHT sunny ball_sun(sunlight s, vec3 n, vec3 to_eye)
{
	sunny facet = facet_sun(s, n), all = all_sun(s, to_eye);
	return sunny(mix(facet.on, all.on, 0.5f), mix(facet.through, all.through, 0.5f),
		mix(n.z, 0.667f * to_eye.z, 0.5f));
}

/* level: the share of leaves that lie level, among those of all directions (eco_level_share). Both are
 * weighted by the area that they show. */
LIGHT sunny cloud_sun(sunlight s, float level, vec3 to_eye)
{
	float lying = level * abs(to_eye.z), shows = lying / (lying + max(0.5f * (1.0f - level), 1e-3f)),
		side = to_eye.z < 0.0f ? -1.0f : 1.0f;
	sunny all = all_sun(s, to_eye);
	return sunny(mix(all.on, max(side * s.to.z, 0.0f), shows),
		mix(all.through, max(-side * s.to.z, 0.0f), shows), mix(0.667f * to_eye.z, side, shows));
}

/* ---- Plants ---- */

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

LIGHT face face_of(sunlight s, plant p, uint surface, vec3 to_eye)
{
	uint kind = surface >> 30;
	if (kind == 2u)
		return face(cloud_sun(s, real(surface >> 16 & 255u) / 255.0f, to_eye), to_eye, false,
			real(surface & 65535u) / 65535.0f);
	vec3 d = turned(p, direction_of(surface));
	if (kind == 1u) {
		vec3 n = unit(add(to_eye, scale(d, -dot(d, to_eye))));
		return face(axis_sun(s, d, n), n, true, 0.0f);
	}
	d = dot(d, to_eye) < 0.0f ? scale(d, -1.0f) : d;
	if (kind == 3u)
		return face(ball_sun(s, d, to_eye), d, false, 0.0f);
	return face(facet_sun(s, d), d, true, 0.0f);
}

LIGHT crown crown_at(sunlight s, vec3 d, float outer, float height)
{
	float shade = mix(0.22f, 1.0f, smoothstep(-0.7f, 0.8f, dot(d, s.to)))
		* mix(0.25f, 1.0f, smoothstep(0.2f, 0.95f, outer));
	return crown(shade, mix(0.45f, 1.0f, outer) * mix(0.65f, 1.0f, height), d.z);
}

/* The mean over what is seen of a crown: crown_at integrated over ellipsoids full of leaves, on their
 * stems, of which an eye sees 1/e through a sixth of their radius; within 0.05. */
LIGHT crown crown_mean(sunlight s, vec3 to_eye)
{
	return crown(0.61f + 0.25f * dot(to_eye, s.to), 0.75f + 0.12f * to_eye.z, 0.25f + 0.48f * to_eye.z);
}

/* local: the place in plant space; t: the share of a crown that stands in the pixel's surface. */
LIGHT crown crown_of(sunlight s, plant p, vec3 local, vec3 to_eye, float t)
{
	crown mean = crown_mean(s, to_eye);
	if (!(p.half_height > 0.0f))
		return mean;
	vec3 inside = vec3(local.x / p.half_width, local.y / p.half_width,
		(local.z - p.center_z) / p.half_height);
	float out_of = length(inside);
	crown here = crown_at(s, turned(p, scale(inside, 1.0f / max(out_of, 1e-4f))), within(out_of),
		within(local.z / (2.0f * p.half_height)));
	return crown(mix(here.shade, mean.shade, t), mix(here.open, mean.open, t),
		mix(here.rise, mean.rise, t));
}

/* A plant that stands alone: VIEW_TINT_UNSHADED. */
LIGHT crown crown_alone(sunlight s, vec3 to_eye)
{
	return crown_at(s, unit(add(to_eye, vec3(0.0f, 0.0f, 0.8f))), 0.88f, 0.75f);
}

/* With a shadow map a crown's own shade is what the map has of it, but for what one texel of it, or one
 * primitive, holds: there it stays as it is without a map. Leaves pass light on, so no shadow is black.
 * lit: the share of sunlight that arrives, below 0 where there is no map; texel: a texel's side over half
 * the width of the plant. */
LIGHT crown crown_by_map(plant p, crown own, float lit, float texel, float reach)
{
	if (lit < 0.0f)
		return own;
	float coarse = p.half_height > 0.0f ? within(max(reach, texel)) : 1.0f;
	return crown(mix(0.14f, 1.0f, lit) * mix(1.0f, own.shade, coarse), own.open, own.rise);
}

LIGHT vec3 light_of(sunlight s, sunny sun, crown around, float leaf)
{
	float up = 0.5f + 0.5f * mix(sun.facing, around.rise, 0.65f);
	vec3 ambient = scale(blend(s.earth, s.sky, up), around.open);
	vec3 direct = add(scale(s.color, sun.on * mix(1.0f, 0.95f, leaf)),
		scale(s.through, 0.62f * leaf * sun.through));
	return add(scale(direct, around.shade * 1.25f), ambient);
}

LIGHT vec3 plant_light(sunlight s, plant p, vec3 own, sunny sun, crown around, bool by_kind)
{
	float green = own.y - max(own.x * 0.9f, own.z),
		leaf = smoothstep(0.0f, 0.25f, green / max(own.y, 1e-4f));
	float tone = p.tone * 16.0f - floor(p.tone * 16.0f) - 0.5f, warm = 0.16f * (p.tone - 0.5f) * leaf;
	vec3 light = light_of(s, sun, around, leaf);
	if (by_kind)
		return times(own, blend(vec3(0.75f, 0.75f, 0.75f), light, 0.35f));
	vec3 color = times(scale(own, 1.0f + 0.28f * tone),
		vec3(1.0f + warm, 1.0f + 0.1f * warm, 1.0f - warm));
	return times(color, light);
}

/* ---- Ground ---- */

LIGHT float hash_at(uint x, uint y)
{
	uint h = x * 0x9E3779B1u ^ y * 0x85EBCA77u;
	h = (h ^ h >> 15) * 0x2C1B3C6Du;
	return real((h ^ h >> 13) & 65535u) / 65535.0f;
}

/* At (u, v) within the cell (x, y). */
LIGHT float noise_in(uint x, uint y, float u, float v)
{
	float across = u * u * (3.0f - 2.0f * u), up = v * v * (3.0f - 2.0f * v);
	float south = mix(hash_at(x, y), hash_at(x + 1u, y), across),
		north = mix(hash_at(x, y + 1u), hash_at(x + 1u, y + 1u), across);
	return mix(south, north, up);
}

/* Octaves fade out where a period comes near a pixel, so that far ground does not sparkle. */
LIGHT float octave(ground_place at, int which, float near)
{
	return near > 0.0f ? mix(0.5f, noise_at(at, which), min(near, 1.0f)) : 0.5f;
}

LIGHT float fine_at(ground_place at, float distance_m)
{
	return octave(at, 0, 1.0f - distance_m / 45.0f) * 0.6f
		+ octave(at, 1, 1.0f - distance_m / 14.0f) * 0.4f;
}

LIGHT vec3 ground_albedo(ground_place at, float up, float distance_m)
{
	float near = 1.2f - distance_m / 260.0f, fine = fine_at(at, distance_m);
	float mid = 0.6f * octave(at, 2, near) + 0.4f * octave(at, 3, near);
	float wide = 0.65f * noise_at(at, 4) + 0.35f * noise_at(at, 5);
	vec3 grass = blend(vec3(0.070f, 0.098f, 0.026f), vec3(0.150f, 0.148f, 0.050f),
		within(0.55f * wide + 0.45f * mid));
	grass = scale(grass, 0.72f + 0.38f * mid + 0.7f * (fine - 0.5f));
	vec3 soil = scale(vec3(0.150f, 0.112f, 0.072f), 0.75f + 0.5f * mid);
	return blend(grass, soil, within(smoothstep(0.10f, 0.42f, 1.0f - up)
		+ 0.28f * smoothstep(0.62f, 0.9f, wide * 0.6f + mid * 0.4f)));
}

/* Grain of the ground, finer than texels that are wide: those of .25 m hide all of it. */
LIGHT float grain(ground_place at, float texel_m, float distance_m)
{
	return 1.0f + 0.6f * within(texel_m / 0.25f) * (fine_at(at, distance_m) - 0.5f);
}

/* image: its light, where it covers `alpha` of the ground, by texels of texel_m. */
LIGHT vec3 imaged_albedo(ground_place at, float up, float distance_m, vec3 image, float alpha, float texel_m)
{
	if (!(alpha > 0.0f))
		return ground_albedo(at, up, distance_m);
	vec3 color = scale(image, grain(at, texel_m, distance_m));
	return alpha < 1.0f ? blend(ground_albedo(at, up, distance_m), color, alpha) : color;
}

/* Half a pixel on the ground, along the ray (x, y) and across it. */
struct footprint { float x, y, across; };

LIGHT footprint footprint_of(vec3 n, vec3 to, float pixel_rad)
{
	float distance_m = length(to), across = 0.5f * pixel_rad * distance_m;
	vec3 ray = unit(to);
	/* a ray that meets the ground flatter than .02 is taken to meet it so */
	float straight = dot(n, ray);
	vec3 level = add(ray, scale(n, -straight));
	float along = across / (max(abs(straight), 0.02f) * max(length(level), 1e-6f));
	return footprint(along * level.x, along * level.y, across);
}

/* taken: shares of sunlight and skylight that are taken. */
LIGHT vec3 ground_light(sunlight s, vec3 n, float sun_taken, float sky_taken)
{
	float sun = 1.1f * max(dot(n, s.to), 0.0f) * (1.0f - 0.9f * sun_taken);
	vec3 around = blend(s.earth, s.sky, 0.5f + 0.5f * n.z);
	return add(scale(s.color, sun), scale(around, 1.0f - 0.6f * sky_taken));
}

/* ---- Colours of pixels ---- */

LIGHT vec3 sky_color(sunlight s, vec3 ray, bool by_kind)
{
	vec3 color = background(s, unit(ray));
	return by_kind ? grey(color, vec3(0.34f, 0.34f, 0.34f)) : color;
}

LIGHT vec3 ground_color(sunlight s, vec3 lit, vec3 to, float haze_m, bool by_kind)
{
	vec3 color = haze(s, lit, to, length(to), haze_m);
	return by_kind ? grey(color, vec3(0.3f, 0.5f, 0.2f)) : color;
}

/* Light of what is shown, [0, 1]. */
LIGHT float shown(float light)
{
	float c = light * 1.38f;
	return within(c * (1.0f + c * 0.08f) / (1.0f + c * 0.40f));
}
