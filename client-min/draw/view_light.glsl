/* Light of pictures, in words that C and GLSL share: view_light_inline.h includes this text after that of plants
 * (lod/plant_light.glsl), whose rules hold, and the client in a browser compiles both as a part of a shader. Before it
 * both also say what ground_place and noise_at are. */

LIGHT vec3 grey(vec3 c, vec3 weight)
{
	float g = dot(c, weight);
	return blend(c, vec3(g, g, g), 0.7f);
}

/* Read the word of view_light.h. */
LIGHT vec3 direction_in(uint surface, int bits)
{
	uint most = (1u << bits) - 1u;
	float x = real(surface & most) / real(most) * 2.0f - 1.0f;
	float y = real(surface >> bits & most) / real(most) * 2.0f - 1.0f;
	float z = 1.0f - abs(x) - abs(y), under = z < 0.0f ? -z : 0.0f;
	return unit(vec3(x + (x < 0.0f ? under : -under), y + (y < 0.0f ? under : -under), z));
}

LIGHT vec3 direction_of(uint surface) { return direction_in(surface, 15); }

/* ---- The sky, and what is far ---- */

LIGHT vec3 sky_at(sunlight s, vec3 ray)
{
	float low = 1.0f - within(ray.z), c = max(dot(ray, s.to), 0.0f), c2 = c * c, c8 = c2 * c2 * c2 * c2;
	float low4 = low * low * low * low;
	vec3 blue = blend(vec3(0.09f, 0.20f, 0.46f), vec3(0.46f, 0.58f, 0.74f), low4);
	/* low sunlight comes through much air, which leaves its red: most of it near the horizon and the
	 * sun */
	float red = s.glow * low4 * (0.35f + 0.65f * c2);
	blue = blend(blue, vec3(0.86f, 0.50f, 0.25f), 0.75f * red);
	return scale(add(blue, scale(vec3(0.20f, 0.16f, 0.10f), c8)), s.day);
}

LIGHT vec3 haze(sunlight s, vec3 color, vec3 to, float distance_m, float haze_m)
{
	vec3 ray = scale(to, 1.0f / max(distance_m, 1e-20f));
	return blend(sky_at(s, vec3(ray.x, ray.y, ray.z * 0.2f)), color, fade(distance_m / haze_m));
}

/* The sun's disc is twice as wide as it is, as a part of its halo is as bright. */
LIGHT vec3 background(sunlight light, vec3 ray)
{
	if (!(ray.z > 0.0f))
		return blend(sky_at(light, vec3(ray.x, ray.y, 0.0f)),
			scale(vec3(0.20f, 0.24f, 0.22f), light.day), smoothstep(0.0f, 0.3f, -ray.z));
	float s = max(dot(ray, light.to), 0.0f), s4 = s * s * s * s, s16 = s4 * s4 * s4 * s4,
		s64 = s16 * s16 * s16 * s16;
	float halo = 0.5f * s64 * s64 * s64 + 12.0f * smoothstep(0.99985f, 0.99996f, s);
	return add(sky_at(light, ray), scale(light.color, halo));
}

/* ---- Plants ---- */

LIGHT face face_of(sunlight s, plant p, uint surface, vec3 to_eye)
{
	uint kind = surface >> 30;
	if (kind == 2u) {
		float reach = real(surface & 65535u) / 65535.0f;
		return face(cloud_sun(s, real(surface >> 16 & 255u) / 255.0f, to_eye), to_eye, false, reach,
			reach * real(1u - (surface >> 25 & 1u)));
	}
	vec3 d = turned(p, kind == 3u ? direction_in(surface, 10) : direction_of(surface));
	float reach = kind == 3u ? real(surface >> 20 & 31u) / 31.0f : 0.0f;
	if (kind == 1u) {
		vec3 n = unit(add(to_eye, scale(d, -dot(d, to_eye))));
		return face(axis_sun(s, d, n), n, true, 0.0f, 0.0f);
	}
	d = dot(d, to_eye) < 0.0f ? scale(d, -1.0f) : d;
	uint level = kind == 3u ? surface >> 25 & 31u : 31u;
	if (level < 31u)
		return face(ball_sun(s, d, real(level) / 30.0f, to_eye), d, false, reach, 0.0f);
	return face(facet_sun(s, d), d, true, reach, 0.0f);
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

/* An octave, or one `finer`, fades out where its period, a metre over `per_m`, comes near a pixel, so that far ground
 * does not sparkle. Its mean is 0. */
LIGHT float finer_octave(ground_place at, int which, int finer, float per_m, float distance_m)
{
	float near = 1.4f - distance_m * per_m / 450.0f;
	return near > 0.0f ? (noise_at(at, which, finer) - 0.5f) * min(near, 1.0f) : 0.0f;
}

LIGHT float octave(ground_place at, int which, float per_m, float distance_m)
{
	return finer_octave(at, which, 1, per_m, distance_m);
}

/* Factor of light by blades and tufts; its mean is 1. */
LIGHT float fine_at(ground_place at, float depth, float distance_m)
{
	return (1.0f + depth * finer_octave(at, 0, 5, 120.0f, distance_m)) * (1.0f + depth * octave(at, 0, 24.0f, distance_m))
		* (1.0f + depth * finer_octave(at, 1, 2, 10.0f, distance_m)) * (1.0f + 0.6f * depth * octave(at, 1, 5.0f, distance_m));
}

/* Grass has detail at each distance: blades, tufts, patches, meadows; octaves are about a factor of five
 * apart. Coarse ones decide how dry it is, fine ones how bright. */
LIGHT vec3 ground_albedo(ground_place at, float up, float distance_m)
{
	float tufts = octave(at, 2, 1.1f, distance_m), patches = octave(at, 3, 0.23f, distance_m),
		wide = octave(at, 4, 0.045f, distance_m) + octave(at, 5, 0.009f, distance_m);
	vec3 grass = blend(vec3(0.036f, 0.060f, 0.018f), vec3(0.092f, 0.096f, 0.042f),
		within(0.40f + 0.7f * wide + 0.6f * patches + 0.25f * tufts));
	grass = scale(grass, fine_at(at, 0.9f, distance_m) + 0.35f * tufts);
	vec3 soil = scale(vec3(0.130f, 0.096f, 0.062f), 1.0f + 0.8f * tufts);
	return blend(grass, soil, within(smoothstep(0.10f, 0.42f, 1.0f - up)
		+ 0.5f * smoothstep(0.5f, 0.85f, patches + tufts + 0.5f * wide)));
}

/* Grain of the ground, finer than texels that are wide: those of .25 m hide all of it. */
LIGHT float grain(ground_place at, float texel_m, float distance_m)
{
	return fine_at(at, 0.6f * within(texel_m / 0.25f), distance_m);
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
	float sun = max(dot(n, s.to), 0.0f) * (1.0f - 0.92f * sun_taken);
	vec3 around = blend(s.earth, s.sky, 0.5f + 0.5f * n.z);
	return add(scale(s.color, sun), scale(around, 1.0f - 0.6f * sky_taken));
}

/* ---- Water ---- */

#ifdef WATER
/* Share of water in a texel of the ground's image: the code in its alpha, which other borders pass, too, and its blue. */
LIGHT float water_of(vec3 image, float alpha)
{
	return within(1.0f - 0.5f * abs(255.0f * alpha - ECO_GROUND_WATER)) * within(30.0f * (image.z - image.x));
}

/* Small waves mirror sky and sun, by the angle of the look (Schlick 1994). */
LIGHT vec3 water_color(sunlight s, ground_place at, vec3 lit, vec3 to, float water)
{
	float distance_m = length(to), wave = 0.05f;
	vec3 ray = scale(to, 1.0f / max(distance_m, 1e-20f)), n = unit(vec3(wave * octave(at, 1, 5.0f, distance_m)
		+ wave * octave(at, 2, 1.1f, distance_m), wave * octave(at, 0, 24.0f, distance_m)
		+ wave * octave(at, 3, 0.23f, distance_m), 1.0f));
	float flat_look = 1.0f - within(-dot(ray, n)), f2 = flat_look * flat_look;
	vec3 away = add(ray, scale(n, -2.0f * dot(ray, n)));
	return blend(lit, background(s, vec3(away.x, away.y, abs(away.z))), water * (0.02f + 0.98f * f2 * f2 * flat_look));
}
#endif

/* ---- Colours of pixels ---- */

LIGHT vec3 sky_color(sunlight s, vec3 ray, bool by_kind)
{
	vec3 color = background(s, unit(ray));
	return by_kind ? grey(color, vec3(0.34f, 0.34f, 0.34f)) : color;
}

/* lit and texel_m: crown_by_map; size: the plant's scale. */
LIGHT vec3 plant_color(sunlight s, plant p, vec3 own, face seen, vec3 from_foot, vec3 to, float lit, float texel_m,
	float size, float haze_m, bool by_kind)
{
	crown around = crown_by_map(p, crown_of(s, p, seen, from_foot, scale(unit(to), -1.0f)), lit,
		texel_m / max(p.half_width * size, 1e-6f), 0.5f * (seen.reach + seen.whole));
	vec3 color = plant_light(s, p, own, seen.sun, around, by_kind);
	return by_kind ? color : haze(s, color, to, length(to), haze_m);
}

LIGHT vec3 ground_color(sunlight s, vec3 lit, vec3 to, float haze_m, bool by_kind)
{
	vec3 color = haze(s, lit, to, length(to), haze_m);
	return by_kind ? grey(color, vec3(0.3f, 0.5f, 0.2f)) : color;
}

/* Light of what is shown, [0, 1], as film has it: contrast in the middle, dark and bright ends that fade
 * (after Narkowicz 2015, ACES filmic tone mapping curve; shade is less dark than there). */
LIGHT float shown(float light)
{
	return within(light * (2.51f * light + 0.08f) / (light * (2.43f * light + 0.59f) + 0.14f));
}
