#include "client-min/draw/view_light.h"

#include <math.h>
#include <stdlib.h>

#include "client-min/view_owners.h"
#include "client-min/draw/view_shade.h"
#include "client-min/draw/view_shadow.h"
#include "client-min/view_threads.h"
#include "lod/light.h"

#define HAZE_M 5200.0
#define SHADED 0.14f                     /* of sunlight, that gets through a crown and off its leaves */
#define GRAIN_M 0.25f                    /* texels so wide hide all grain of the ground */
#define LEAST_STRAIGHT 0.02              /* a ray that meets the ground flatter is taken to meet it so */
#define PI 3.1415927f
#define ALL_DIRECTIONS 0.2122066f        /* 2 / (3 pi): see round_sun */

struct vec { float x, y, z; };

/* Where the sun is, its light and the sky's on surfaces; how bright the sky is, and how red around the sun. */
struct sunlight { struct vec to, color, sky; float day, glow; };
static const struct sunlight usual = { { -0.5145f, -0.4287f, 0.7427f }, { 1.55f, 1.42f, 1.18f },
	{ 0.42f, 0.52f, 0.68f }, 1, 0 };
static const struct vec EARTH_COLOR = { 0.16f, 0.15f, 0.10f }, LEAF_COLOR = { 1.25f, 1.35f, 0.45f };

const uint8_t view_tint_colors[VIEW_ROLE_COUNT][3] = {
	[VIEW_ROLE_TRIANGLES] = { 26, 158, 41 }, [VIEW_ROLE_LINES] = { 219, 26, 26 },
	[VIEW_ROLE_SIMPLE] = { 107, 204, 26 }, [VIEW_ROLE_POINTS] = { 31, 71, 242 },
	[VIEW_ROLE_BLEND_TRIANGLES] = { 255, 219, 26 }, [VIEW_ROLE_BLEND_SIMPLE] = { 255, 173, 20 },
	[VIEW_ROLE_BLEND_LINES] = { 242, 82, 26 }, [VIEW_ROLE_BLEND_POINTS] = { 255, 128, 13 },
	[VIEW_ROLE_SPLATS] = { 150, 60, 200 }, [VIEW_ROLE_IMPOSTORS] = { 230, 90, 220 },
	 [VIEW_ROLE_SUMMARY] = { 115, 158, 255 } };

/* ---- Arithmetic ---- */

static struct vec add(struct vec a, struct vec b) { return (struct vec){ a.x + b.x, a.y + b.y, a.z + b.z }; }
static struct vec scale(struct vec a, float t) { return (struct vec){ a.x * t, a.y * t, a.z * t }; }
static struct vec times(struct vec a, struct vec b)
{
	return (struct vec){ a.x * b.x, a.y * b.y, a.z * b.z };
}
static float dot(struct vec a, struct vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static float length(struct vec a) { return sqrtf(dot(a, a)); }
static struct vec unit(struct vec a) { return scale(a, 1 / fmaxf(length(a), 1e-20f)); }
static float mix(float a, float b, float t) { return a + (b - a) * t; }
static struct vec blend(struct vec a, struct vec b, float t)
{
	return (struct vec){ mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t) };
}
static float clamp(float v) { return v > 0 ? v < 1 ? v : 1 : 0; }
static float smoothstep(float low, float high, float v)
{
	float t = clamp((v - low) / (high - low));
	return t * t * (3 - 2 * t);
}

/* exp(-x), x >= 0, within 1e-6. */
static float fade(float x)
{
	float y = fminf(x, 64) / 64, e = 1 / (1 + y * (1 + y * (0.5f + y * (1 / 6.0f + y / 24))));
	for (int i = 0; i < 6; i++)
		e *= e;
	return e;
}

/* Within 7e-5 (Abramowitz and Stegun, 4.4.45). */
static float arc_cosine(float c)
{
	float a = fminf(fabsf(c), 1),
		arc = sqrtf(1 - a) * (1.5707288f + a * (-0.2121144f + a * (0.0742610f - a * 0.0187293f)));
	return c < 0 ? PI - arc : arc;
}

/* ---- The sun ---- */

/* Low it is red and weak; below the horizon the sky goes dark. */
static struct sunlight sunlight_of(const float sun[3])
{
	if (sun[0] == 0 && sun[1] == 0 && sun[2] == 0)
		return usual;
	struct sunlight s = { .to = unit((struct vec){ sun[0], sun[1], sun[2] }) };
	struct vec red = { 1.5f, 0.62f, 0.22f };
	s.color = scale(blend(red, usual.color, smoothstep(0, 0.35f, s.to.z)),
		smoothstep(-0.03f, 0.15f, s.to.z));
	s.day = mix(0.06f, 1, smoothstep(-0.14f, 0.2f, s.to.z));
	s.sky = scale(usual.sky, s.day);
	s.glow = 1 - smoothstep(0.02f, 0.35f, fabsf(s.to.z));
	return s;
}

/* What a leaf lets through of its light. */
static struct vec through_leaf(const struct sunlight *s)
{
	return times(LEAF_COLOR, (struct vec){ s->color.x / usual.color.x, s->color.y / usual.color.y,
		s->color.z / usual.color.z });
}

/* ---- Surfaces ---- */

static uint32_t coordinate(float at) { return (uint32_t)((at * 0.5f + 0.5f) * 32767 + 0.5f); }

uint32_t view_surface_direction(enum view_surface kind, const float d[3])
{
	float sum = fabsf(d[0]) + fabsf(d[1]) + fabsf(d[2]), part = sum > 0 && sum < INFINITY ? 1 / sum : 0;
	float x = d[0] * part, y = d[1] * part, z = part > 0 ? d[2] : 1;
	if (z < 0) {
		float folded = (1 - fabsf(y)) * (x < 0 ? -1 : 1);
		y = (1 - fabsf(x)) * (y < 0 ? -1 : 1);
		x = folded;
	}
	return (uint32_t)kind << 30 | coordinate(y) << 15 | coordinate(x);
}

uint32_t view_surface_cloud(double reach, double level)
{
	uint32_t whole = (uint32_t)(fmin(fmax(reach, 0), 1) * 65535 + 0.5);
	return (uint32_t)VIEW_CLOUD << 30 | (uint32_t)(fmin(fmax(level, 0), 1) * 255 + 0.5) << 16 | whole;
}

static struct vec direction_of(uint32_t surface)
{
	float x = (float)(surface & 32767) / 32767 * 2 - 1;
	float y = (float)(surface >> 15 & 32767) / 32767 * 2 - 1;
	float z = 1 - fabsf(x) - fabsf(y), under = z < 0 ? -z : 0;
	return unit((struct vec){ x + (x < 0 ? under : -under), y + (y < 0 ? under : -under), z });
}

/* ---- The sky, and what is far ---- */

static struct vec sky(const struct sunlight *s, struct vec ray)
{
	float low = 1 - clamp(ray.z), c = fmaxf(dot(ray, s->to), 0), c2 = c * c, c8 = c2 * c2 * c2 * c2;
	struct vec blue = blend((struct vec){ 0.10f, 0.25f, 0.58f }, (struct vec){ 0.50f, 0.61f, 0.74f },
		low * low * low);
	/* low sunlight comes through much air, which leaves its red: most of it near the horizon and the sun */
	float red = s->glow * low * low * low * (0.35f + 0.65f * c2);
	blue = blend(blue, (struct vec){ 0.86f, 0.50f, 0.25f }, 0.75f * red);
	return scale(add(blue, scale((struct vec){ 0.17f, 0.14f, 0.09f }, c8)), s->day);
}

static struct vec haze(const struct sunlight *s, struct vec color, struct vec to, float distance,
	float haze_m)
{
	struct vec ray = scale(to, 1 / fmaxf(distance, 1e-20f));
	return blend(sky(s, (struct vec){ ray.x, ray.y, ray.z * 0.2f }), color, fade(distance / haze_m));
}

static struct vec background(const struct sunlight *light, struct vec ray)
{
	if (!(ray.z > 0))
		return blend(sky(light, (struct vec){ ray.x, ray.y, 0 }), scale((struct vec){ 0.34f, 0.39f,
			0.41f },
			light->day),
			smoothstep(0, 0.9f, -ray.z));
	float s = fmaxf(dot(ray, light->to), 0), s2 = s * s, s4 = s2 * s2, s8 = s4 * s4, s64 = s8 * s8;
	s64 *= s64;
	s64 *= s64;
	/* s^200 */
	return add(sky(light, ray), scale((struct vec){ 0.6f, 0.5f, 0.3f }, s64 * s64 * s64 * s8));
}

/* ---- Plants ---- */

/* Sunlight on what is seen of something, and through it. */
struct sunny { float on, through; };

/* A facet has one normal; blades and bark around an axis and leaves of all directions have the means over the
 * normals that face the eye, each by the area that it shows: c is the cosine between eye and sun, u = 1/4 for
 * an axis, 2/(3 pi) for all directions. */
static struct sunny round_sun(float c, float u)
{
	c = fminf(fmaxf(c, -1), 1);
	float sine = sqrtf(fmaxf(1 - c * c, 0)), away = arc_cosine(c);
	return (struct sunny){ u * (sine + (PI - away) * c), u * (sine - away * c) };
}

static struct sunny facet_sun(const struct sunlight *s, struct vec n)
{
	float c = dot(n, s->to);
	return (struct sunny){ fmaxf(c, 0), fmaxf(-c, 0) };
}

static struct sunny axis_sun(const struct sunlight *s, struct vec axis, struct vec n)
{
	struct vec across = add(s->to, scale(axis, -dot(s->to, axis)));
	float l = length(across);
	return round_sun(dot(n, across) / fmaxf(l, 1e-6f), 0.25f * l);
}

/* A splat is half a surface and half a cloud: of balls in a crown mostly the outer sides show, and all facet
 * would be too bright there; as a cloud alone it has no form (lod/EXPERIMENTS.md, Light of splats). */
static struct sunny ball_sun(const struct sunlight *s, struct vec n, struct vec to_eye)
{
	struct sunny facet = facet_sun(s, n), all = round_sun(dot(to_eye, s->to), ALL_DIRECTIONS);
	return (struct sunny){ mix(facet.on, all.on, 0.5f), mix(facet.through, all.through, 0.5f) };
}

/* level: the share of leaves that lie level, among those of all directions (eco_level_share). Both are
 * weighted by the area that they show. */
static struct sunny cloud_sun(const struct sunlight *s, float level, struct vec to_eye, float *facing)
{
	float lying = level * fabsf(to_eye.z), shows = lying / (lying + fmaxf(0.5f * (1 - level), 1e-3f)),
		side = to_eye.z < 0 ? -1 : 1;
	struct sunny all = round_sun(dot(to_eye, s->to), ALL_DIRECTIONS);
	*facing = mix(0.667f * to_eye.z, side, shows);
	return (struct sunny){ mix(all.on, fmaxf(side * s->to.z, 0), shows),
		mix(all.through, fmaxf(-side * s->to.z, 0), shows) };
}

/* Shares of light that a crown lets through: shade of the sun's, open of the sky's; rise: height of the
 * direction out of the crown. */
struct crown { float shade, open, rise; };

static struct crown crown_at(const struct sunlight *s, struct vec d, float outer, float height)
{
	float shade = mix(0.22f, 1, smoothstep(-0.7f, 0.8f, dot(d, s->to)))
		* mix(0.25f, 1, smoothstep(0.2f, 0.95f, outer));
	return (struct crown){ shade, mix(0.45f, 1, outer) * mix(0.65f, 1, height), d.z };
}

/* The mean over what is seen of a crown: crown_at integrated over ellipsoids full of leaves, on their stems,
 * of which an eye sees 1/e through a sixth of their radius; within 0.05. */
static struct crown crown_mean(const struct sunlight *s, struct vec to_eye)
{
	return (struct crown){ 0.61f + 0.25f * dot(to_eye, s->to), 0.75f + 0.12f * to_eye.z,
		0.25f + 0.48f * to_eye.z };
}

/* The plant of a pixel. Summaries' points have no place in a plant: half_height is 0. */
struct plant { uint64_t owner; struct lod_place place; struct view_shape shape; float hash; };

static struct vec turned(const struct plant *p, struct vec v)
{
	float s = (float)p->place.sine, c = (float)p->place.cosine;
	return (struct vec){ v.x * c - v.y * s, v.x * s + v.y * c, v.z };
}

/* `t`: the share of a crown that stands in one pixel's surface. */
static struct crown crown_of(const struct sunlight *s, const struct plant *p, const double world[3],
	struct vec to_eye, float t)
{
	struct crown mean = crown_mean(s, to_eye);
	if (!(p->shape.half_height > 0))
		return mean;
	const struct lod_place *place = &p->place;
	double x = world[0] - place->at[0], y = world[1] - place->at[1], z = world[2] - place->at[2];
	struct vec local = { (float)((x * place->cosine + y * place->sine) / place->scale),
		(float)((y * place->cosine - x * place->sine) / place->scale), (float)(z / place->scale) };
	struct vec inside = { local.x / p->shape.half_width, local.y / p->shape.half_width,
		(local.z - p->shape.center_z) / p->shape.half_height };
	float out = length(inside);
	struct crown at = crown_at(s, turned(p, scale(inside, 1 / fmaxf(out, 1e-4f))), clamp(out),
		clamp(local.z / (2 * p->shape.half_height)));
	return (struct crown){ mix(at.shade, mean.shade, t), mix(at.open, mean.open, t),
		mix(at.rise, mean.rise, t) };
}

/* facing: height of the mean normal. */
static struct vec light_of(const struct sunlight *s, struct sunny sunny, float facing, struct crown crown,
	float leaf)
{
	float up = 0.5f + 0.5f * mix(facing, crown.rise, 0.65f);
	struct vec ambient = scale(blend(scale(EARTH_COLOR, s->day), s->sky, up), crown.open);
	struct vec sun = add(scale(s->color, sunny.on * mix(1, 0.95f, leaf)),
		scale(through_leaf(s), 0.62f * leaf * sunny.through));
	return add(scale(sun, crown.shade * 1.25f), ambient);
}

/* ---- Ground ---- */

static float hash_at(int64_t x, int64_t y)
{
	uint32_t h = (uint32_t)x * 0x9E3779B1u ^ (uint32_t)y * 0x85EBCA77u;
	h = (h ^ h >> 15) * 0x2C1B3C6Du;
	return (float)((h ^ h >> 13) & 65535) / 65535;
}

static float noise(double x, double y)
{
	if (!(fabs(x) < 1e15 && fabs(y) < 1e15))
		return 0.5f;
	int64_t i = (int64_t)x, j = (int64_t)y;
	i -= x < (double)i;
	j -= y < (double)j;
	float u = (float)(x - (double)i), v = (float)(y - (double)j);
	u = u * u * (3 - 2 * u);
	v = v * v * (3 - 2 * v);
	float south = mix(hash_at(i, j), hash_at(i + 1, j), u),
		north = mix(hash_at(i, j + 1), hash_at(i + 1, j + 1), u);
	return mix(south, north, v);
}

/* Octaves fade out where a period comes near a pixel, so that far ground does not sparkle. */
static float octave(double x, double y, float near)
{
	return near > 0 ? mix(0.5f, noise(x, y), fminf(near, 1)) : 0.5f;
}

static struct vec ground_albedo(double x, double y, float up, float distance)
{
	double tx = 0.8 * x - 0.6 * y, ty = 0.6 * x + 0.8 * y;
	float near = 1.2f - distance / 260;
	float fine = octave(x * 9, y * 9, 1 - distance / 45) * 0.6f
		+ octave(x * 38, y * 31, 1 - distance / 14) * 0.4f;
	float mid = 0.6f * octave(tx * 1.3, ty * 1.3, near) + 0.4f * octave(x * 0.47, y * 0.47, near);
	float wide = 0.65f * noise(tx * 0.045 + 7, ty * 0.045 + 7) + 0.35f * noise(x * 0.13, y * 0.13);
	struct vec grass = blend((struct vec){ 0.070f, 0.098f, 0.026f },
		(struct vec){ 0.150f, 0.148f, 0.050f }, clamp(0.55f * wide + 0.45f * mid));
	grass = scale(grass, 0.72f + 0.38f * mid + 0.7f * (fine - 0.5f));
	struct vec soil = scale((struct vec){ 0.150f, 0.112f, 0.072f }, 0.75f + 0.5f * mid);
	return blend(grass, soil, clamp(smoothstep(0.10f, 0.42f, 1 - up)
		+ 0.28f * smoothstep(0.62f, 0.9f, wide * 0.6f + mid * 0.4f)));
}

/* Half a pixel on the ground, along the ray and across it. */
static struct view_image_spot spot_of(const struct lod_eye *eye, struct vec n, struct vec to,
	const double world[3])
{
	double distance = (double)length(to), half = 0.5 * eye->pixel_rad * distance;
	struct vec ray = unit(to);
	float straight = dot(n, ray);
	struct vec level = add(ray, scale(n, -straight));
	double part =
		half / (fmax(fabs((double)straight), LEAST_STRAIGHT) * fmax((double)length(level), 1e-6));
	return (struct view_image_spot){ { world[0], world[1] },
		{ part * (double)level.x, part * (double)level.y }, half };
}

/* Grain of the ground, finer than texels that are wide. */
static float grain(double x, double y, double texel_m, float distance)
{
	float fine = octave(x * 9, y * 9, 1 - distance / 45) * 0.6f +
		octave(x * 38, y * 31, 1 - distance / 14) * 0.4f;
	return 1 + 0.6f * clamp((float)texel_m / GRAIN_M) * (fine - 0.5f);
}

static struct vec ground_light(const struct sunlight *s, struct vec n, const float below[2])
{
	float sun = 1.1f * fmaxf(dot(n, s->to), 0) * (1 - 0.9f * below[0]);
	return add(scale(s->color, sun), scale(blend(scale(EARTH_COLOR, s->day), s->sky, 0.5f + 0.5f * n.z),
		1 - 0.6f * below[1]));
}

/* ---- Pixels ---- */

struct lamp {                            /* of one picture */
	const struct view_light_job *job;
	struct view_picture *picture;
	struct view_shade shade;
	struct view_shadow shadow;
	struct view_owners owners;
	struct sunlight sun;
	uint32_t threads;
	float haze_m;
	struct vec right, up, forward;   /* the image plane's half extents, and its middle */
	uint8_t bytes[65536];            /* lod_light_byte of every light */
};

static void find_plant(const struct lamp *lamp, uint64_t owner, struct plant *p)
{
	const struct view_instance *instance = view_owners_find(&lamp->owners, owner);
	*p = (struct plant){ .owner = owner, .hash = (float)(owner >> 46 & 4095) * 0.61803f };
	p->hash -= floorf(p->hash);
	if (!instance)
		return;
	p->place = instance->place;
	p->shape = view_shape_of(view_store_plant(lamp->job->store, instance->plant));
	p->hash = (float)(instance->hash / (double)ECO_SHARE_ONE);
}

/* With a shadow map a crown's own shade is what the map has of it, but for what one texel of it, or one
 * primitive, holds: there it stays as it is without a map. Leaves pass light on, so no shadow is black. */
static void cast_on_plant(const struct lamp *lamp, const struct plant *p, struct vec to, const struct vec *n,
	float reach, struct crown *crown)
{
	float texel_m = 0, half_m = p->shape.half_width * (float)p->place.scale;
	float lit = view_shadow_lit(&lamp->shadow, (const float[3]){ to.x, to.y, to.z },
		n ? (const float[3]){ n->x, n->y, n->z } : NULL, &texel_m);
	if (lit < 0)
		return;
	float coarse = p->shape.half_height > 0 ? clamp(fmaxf(reach, texel_m / half_m)) : 1;
	crown->shade = mix(SHADED, 1, lit) * mix(1, crown->shade, coarse);
}

static struct vec plant_color(const struct lamp *lamp, const struct plant *p, size_t pixel, struct vec to,
	const double world[3])
{
	const struct sunlight *s = &lamp->sun;
	uint32_t surface = lamp->picture->surface[pixel];
	const uint8_t *own = lamp->picture->rgb + 3 * pixel;
	struct vec to_eye = scale(unit(to), -1), n;
	struct vec albedo = { lod_light_of[own[0]] / 65535.0f, lod_light_of[own[1]] / 65535.0f,
		lod_light_of[own[2]] / 65535.0f };
	struct sunny sunny;
	float facing, reach = 0;
	if (surface >> 30 == VIEW_CLOUD) {
		sunny = cloud_sun(s, (float)(surface >> 16 & 255) / 255, to_eye, &facing);
		reach = (float)(surface & 65535) / 65535;
	} else if (surface >> 30 == VIEW_AXIS) {
		struct vec axis = turned(p, direction_of(surface));
		n = unit(add(to_eye, scale(axis, -dot(axis, to_eye))));
		sunny = axis_sun(s, axis, n);
		facing = 0.785f * n.z;
	} else {
		n = turned(p, direction_of(surface));
		n = dot(n, to_eye) < 0 ? scale(n, -1) : n;
		bool ball = surface >> 30 == VIEW_BALL;
		sunny = ball ? ball_sun(s, n, to_eye) : facet_sun(s, n);
		facing = ball ? mix(n.z, 0.667f * to_eye.z, 0.5f) : n.z;
	}
	float green = albedo.y - fmaxf(albedo.x * 0.9f, albedo.z),
		leaf = smoothstep(0, 0.25f, green / fmaxf(albedo.y, 1e-4f));
	float tone = p->hash * 16 - floorf(p->hash * 16) - 0.5f, warm = 0.16f * (p->hash - 0.5f) * leaf;
	struct crown crown = lamp->job->tint == VIEW_TINT_UNSHADED
		? crown_at(s, unit(add(to_eye, (struct vec){ 0, 0, 0.8f })), 0.88f, 0.75f)
		: crown_of(s, p, world, to_eye, reach);
	if (lamp->shadow.top && lamp->job->tint != VIEW_TINT_UNSHADED)
		cast_on_plant(lamp, p, to, surface >> 30 == VIEW_FACET || surface >> 30 == VIEW_AXIS ? &n : NULL,
			reach, &crown);
	struct vec light = light_of(s, sunny, facing, crown, leaf);
	if (lamp->job->tint == VIEW_TINT_KIND)
		return times(albedo, blend((struct vec){ 0.75f, 0.75f, 0.75f }, light, 0.35f));
	albedo = times(scale(albedo, 1 + 0.28f * tone), (struct vec){ 1 + warm, 1 + 0.1f * warm, 1 - warm });
	return haze(s, times(albedo, light), to, length(to), lamp->haze_m);
}

static struct vec grey(struct vec c, struct vec weight)
{
	float g = dot(c, weight);
	return blend(c, (struct vec){ g, g, g }, 0.7f);
}

/* near: as view_image_at */
static struct vec ground_color(const struct lamp *lamp, size_t pixel, struct vec to, const double world[3],
	uint32_t *near)
{
	const struct sunlight *s = &lamp->sun;
	const struct view_ground *ground = &lamp->job->selection->ground;
	struct vec n = direction_of(lamp->picture->surface[pixel]);
	float below[2], distance = length(to);
	view_shade_at(&lamp->shade, world, below);
	if (lamp->shadow.top) {
		float texel_m, lit = view_shadow_lit(&lamp->shadow, (const float[3]){ to.x, to.y, to.z },
			(const float[3]){ n.x, n.y, n.z }, &texel_m);
		below[0] = lit < 0 ? below[0] : 1 - lit;
	}
	double x = world[0] - ground->origin[0], y = world[1] - ground->origin[1], texel_m = 0;
	const struct view_image_spot spot = spot_of(lamp->job->eye, n, to, world);
	struct view_image_color image = view_image_at(&lamp->job->selection->image, &spot, near, &texel_m);
	struct vec albedo = { 0, 0, 0 };
	if (image.alpha < 1)
		albedo = ground_albedo(x, y, n.z, distance);
	if (image.alpha > 0)
		albedo = blend(albedo, scale((struct vec){ image.light[0], image.light[1], image.light[2] },
			grain(x, y, texel_m, distance)), image.alpha);
	struct vec color = haze(s, times(albedo, ground_light(s, n, below)), to, distance, lamp->haze_m);
	return lamp->job->tint == VIEW_TINT_KIND ? grey(color, (struct vec){ 0.3f, 0.5f, 0.2f }) : color;
}

static struct vec sky_color(const struct lamp *lamp, struct vec ray)
{
	struct vec color = background(&lamp->sun, unit(ray));
	return lamp->job->tint == VIEW_TINT_KIND ? grey(color, (struct vec){ 0.34f, 0.34f, 0.34f }) : color;
}

static uint8_t encode(const struct lamp *lamp, float c)
{
	c *= 1.38f;
	return lamp->bytes[(uint32_t)(65535 * clamp(c * (1 + c * 0.08f) / (1 + c * 0.40f)) + 0.5f)];
}

static void light_pixel(const struct lamp *lamp, struct plant *plant, uint32_t *near, uint32_t x, uint32_t y)
{
	struct view_picture *picture = lamp->picture;
	size_t i = (size_t)y * picture->width + x;
	float depth = picture->depth[i], u = ((float)x + 0.5f) / (float)picture->width * 2 - 1,
		v = 1 - ((float)y + 0.5f) / (float)picture->height * 2;
	struct vec ray = add(add(scale(lamp->right, u), scale(lamp->up, v)), lamp->forward), color;
	if (depth > 0) {
		struct vec to = scale(ray, 1 / depth);
		const double *eye = lamp->job->eye->at;
		const double world[3] = { eye[0] + to.x, eye[1] + to.y, eye[2] + to.z };
		uint64_t owner = picture->owner[i];
		if (owner && owner != plant->owner)
			find_plant(lamp, owner, plant);
		color = owner ? plant_color(lamp, plant, i, to, world) : ground_color(lamp, i, to, world,
			near);
	} else {
		color = sky_color(lamp, ray);
	}
	picture->rgb[3 * i] = encode(lamp, color.x);
	picture->rgb[3 * i + 1] = encode(lamp, color.y);
	picture->rgb[3 * i + 2] = encode(lamp, color.z);
}

static void light_rows(void *ctx, uint32_t first)
{
	const struct lamp *lamp = ctx;
	struct plant plant = { .owner = 0 };
	uint32_t near = 0;
	for (uint32_t y = first; y < lamp->picture->height; y += lamp->threads)
		for (uint32_t x = 0; x < lamp->picture->width; x++)
			light_pixel(lamp, &plant, &near, x, y);
}

static struct vec axis_of(const double axis[3], double t)
{
	return (struct vec){ (float)(axis[0] * t), (float)(axis[1] * t), (float)(axis[2] * t) };
}

static void lamp_init(struct lamp *lamp, const struct view_light_job *job, struct view_picture *picture)
{
	const struct lod_eye *eye = job->eye;
	lamp->job = job;
	lamp->picture = picture;
	lamp->sun = sunlight_of(job->selection->sky.sun);
	lamp->threads = view_thread_count(job->threads);
	double haze_m = job->selection->sky.haze_m;
	lamp->haze_m = (float)view_shade_haze_m(haze_m > 0 ? haze_m : HAZE_M, eye->at[2]);
	lamp->right = axis_of(eye->right, eye->tan_x);
	lamp->up = axis_of(eye->up, eye->tan_y);
	lamp->forward = axis_of(eye->forward, 1);
	for (uint32_t light = 0, byte = 0; light < 65536; light++) {
		while (byte < 255 && 2 * light > (uint32_t)lod_light_of[byte] + lod_light_of[byte + 1])
			byte++;
		lamp->bytes[light] = (uint8_t)byte;
	}
}

static enum eco_code cast_shadows(struct lamp *lamp, struct eco_error *error)
{
	const struct view_light_job *job = lamp->job;
	const struct view_sky *sky = &job->selection->sky;
	struct view_picture *picture = lamp->picture;
	double start = view_clock_ms();
	enum eco_code code = view_shadow_make(&lamp->shadow, &(struct view_shadow_job){ job->store,
		sky->casters ? sky->casters : job->selection, job->eye, picture,
		{ lamp->sun.to.x, lamp->sun.to.y, lamp->sun.to.z }, sky->shadows, sky->shadow_size,
		job->threads }, error);
	picture->shadow_ms = view_clock_ms() - start;
	if (!code)
		picture->shadow_texels = view_shadow_sharpness(&lamp->shadow, picture, job->eye);
	return code;
}

enum eco_code view_light_picture(const struct view_light_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	struct lamp *lamp = calloc(1, sizeof *lamp);
	if (!lamp)
		return eco_fail(error, ECO_NO_MEMORY, "no memory to light a picture");
	lamp_init(lamp, job, picture);
	enum eco_code code = view_owners_make(&lamp->owners, job->selection, error);
	if (!code && job->selection->ground.count)
		code = view_shade_make(&lamp->shade, job->store, job->selection, error);
	if (!code && job->selection->sky.shadows)
		code = cast_shadows(lamp, error);
	if (!code)
		view_threads_run(lamp->threads, light_rows, lamp);
	view_shade_free(&lamp->shade);
	view_shadow_free(&lamp->shadow);
	view_owners_free(&lamp->owners);
	free(lamp);
	return code;
}
