#include "client-min/draw/view_light.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_shadow.h"
#include "client-min/draw/view_picture.h"
#include "lod/light.h"

#define HAZE_M 20000.0                  /* clear weather: a dark hill is seen for 80 km */

const uint8_t view_tint_colors[VIEW_ROLE_COUNT][3] = {
	[VIEW_ROLE_TRIANGLES] = { 26, 158, 41 }, [VIEW_ROLE_LINES] = { 219, 26, 26 },
	[VIEW_ROLE_SIMPLE] = { 107, 204, 26 }, [VIEW_ROLE_POINTS] = { 31, 71, 242 },
	[VIEW_ROLE_BLEND_TRIANGLES] = { 255, 219, 26 }, [VIEW_ROLE_BLEND_SIMPLE] = { 255, 173, 20 },
	[VIEW_ROLE_BLEND_LINES] = { 242, 82, 26 }, [VIEW_ROLE_BLEND_POINTS] = { 255, 128, 13 },
	[VIEW_ROLE_SPLATS] = { 150, 60, 200 }, [VIEW_ROLE_IMPOSTORS] = { 230, 90, 220 },
	 [VIEW_ROLE_SUMMARY] = { 115, 158, 255 } };

/* ---- Shapes, and soft discs that are thrown as shadows ---- */

#define REACH_M 450.0                    /* plants further away cast no shadow that is worth a texel */
#define AIR_M 1200.0                     /* of dust and vapour, not of air itself */
#define LOWEST 0.12                      /* of the sun: lower, shadows are too long to be seen as such */

/* The mean over the way down of a density that falls to 1/e every AIR_M. */
double view_shade_haze_m(double sea_m, double eye_z)
{
	double height = eye_z / AIR_M;
	return height < 1e-6 ? sea_m : sea_m * height / (1 - exp(-height));
}

static void dim(uint8_t *texel, double share)
{
	*texel = (uint8_t)(255 - (255 - *texel) * (1 - share));
}

/* A disc of radius r (metres) around (x, y) that takes `share` of the light at its middle. */
static void splat(struct view_shade *shade, int channel, double x, double y, double r, double share)
{
	double texel = shade->size_m / VIEW_SHADE_PIXELS, radius = r / texel;
	double cx = (x - shade->low[0]) / texel - 0.5, cy = (y - shade->low[1]) / texel - 0.5;
	if (radius < 0.6) {
		share *= radius * radius / 0.36;
		radius = 0.6;
	}
	if (!(cx + radius >= 0 && cy + radius >= 0 && cx - radius < VIEW_SHADE_PIXELS
			&& cy - radius < VIEW_SHADE_PIXELS) || share < 0.01)
		return;
	int x0 = (int)fmax(ceil(cx - radius), 0), x1 = (int)fmin(floor(cx + radius), VIEW_SHADE_PIXELS - 1);
	int y0 = (int)fmax(ceil(cy - radius), 0), y1 = (int)fmin(floor(cy + radius), VIEW_SHADE_PIXELS - 1);
	for (int j = y0; j <= y1; j++)
		for (int i = x0; i <= x1; i++) {
			double d2 = ((i - cx) * (i - cx) + (j - cy) * (j - cy)) / (radius * radius);
			if (d2 < 1)
				dim(&shade->texels[2 * ((size_t)j * VIEW_SHADE_PIXELS + (size_t)i)
					+ (size_t)channel], share * (1 - d2 * d2));
		}
}

/* A plant as seen by the sun: a foot, a stem, and a crown that is widest above its middle. */
static const struct { double height, width, share; } disc[] = { { 0, 0.12, 0.7 }, { 0.1, 0.12, 0.6 },
	{ 0.2, 0.15, 0.6 }, { 0.35, 0.6, 0.4 },
	{ 0.5, 0.95, 0.55 }, { 0.65, 1.0, 0.55 }, { 0.8, 0.8, 0.5 }, { 0.92, 0.5, 0.4 } };
#define DISCS (int)(sizeof disc / sizeof disc[0])

/* Metres of shadow to the east and north, a metre of height; false: there are none. */
static bool find_throw(const struct view_sky *sky, double away[2])
{
	struct view_light_sun sun;
	view_light_sun(sky, 0, &sun);
	for (int k = 0; k < 2; k++)
		away[k] = -(double)sun.to[k] / fmax((double)sun.to[2], LOWEST);
	return (double)sun.to[2] > LOWEST;
}

static void cast_discs(struct view_shade *shade, const struct view_instance *instance,
	const struct view_plant *plant, const double away[2], bool shadows)
{
	struct view_shape shape = view_shape_of(plant);
	double scale = instance->place.scale, height = 2 * shape.half_height * scale,
		width = shape.half_width * scale * lod_place_width(&instance->place);
	const double *at = instance->place.at;
	splat(shade, 1, at[0], at[1], width * 0.9, 0.55);
	splat(shade, 1, at[0], at[1], width * 0.3, 0.35);
	for (int i = 0; i < DISCS && shadows; i++) {
		double z = height * disc[i].height, r = width * disc[i].width;
		splat(shade, 0, at[0] + away[0] * z, at[1] + away[1] * z, r, disc[i].share);
	}
}

static void find_square(struct view_shade *shade, const struct view_selection *selection)
{
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < selection->instance_count; i++) {
		const struct view_instance *p = &selection->instances[i];
		if (p->plant == ECO_NONE || p->distance_m > REACH_M)
			continue;
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], p->place.at[k]);
			high[k] = fmax(high[k], p->place.at[k]);
		}
	}
	double size = fmax(fmax(high[0] - low[0], high[1] - low[1]), 1);
	double margin = 12;
	shade->size_m = isfinite(size) ? size + 2 * margin : 1;
	for (int k = 0; k < 2; k++)
		shade->low[k] = isfinite(low[k]) ? low[k] - margin : 0;
}

enum eco_code view_shade_make(struct view_shade *shade, const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error)
{
	shade->texels = calloc((size_t)VIEW_SHADE_PIXELS * VIEW_SHADE_PIXELS, 2);
	if (!shade->texels)
		return eco_no_memory(error, "shadows");
	double away[2];
	bool shadows = find_throw(&selection->sky, away);
	find_square(shade, selection);
	for (uint32_t i = 0; i < selection->instance_count; i++) {
		const struct view_instance *p = &selection->instances[i];
		if (p->plant != ECO_NONE && p->distance_m <= REACH_M)
			cast_discs(shade, p, view_store_plant(store, p->plant), away, shadows);
	}
	return ECO_OK;
}

void view_shade_at(const struct view_shade *shade, const double world[2], float taken[2])
{
	double at[2];
	uint32_t from[2], to[2];
	taken[0] = taken[1] = 0;
	for (int k = 0; k < 2; k++) {
		double share = (world[k] - shade->low[k]) / shade->size_m;
		if (!shade->texels || !(share > 0 && share < 1))
			return;
		double texel = fmin(fmax(share * VIEW_SHADE_PIXELS - 0.5, 0), VIEW_SHADE_PIXELS - 1);
		from[k] = (uint32_t)texel;
		to[k] = from[k] + 1 < VIEW_SHADE_PIXELS ? from[k] + 1 : from[k];
		at[k] = texel - from[k];
	}
	const uint8_t *south = shade->texels + 2 * (size_t)from[1] * VIEW_SHADE_PIXELS,
		*north = shade->texels + 2 * (size_t)to[1] * VIEW_SHADE_PIXELS;
	for (int c = 0; c < 2; c++) {
		double a = south[2 * from[0] + c] + at[0] * (south[2 * to[0] + c] - south[2 * from[0] + c]);
		double b = north[2 * from[0] + c] + at[0] * (north[2 * to[0] + c] - north[2 * from[0] + c]);
		taken[c] = (float)((a + at[1] * (b - a)) / 255);
	}
}

void view_shade_free(struct view_shade *shade)
{
	free(shade->texels);
	*shade = (struct view_shade){ 0 };
}

/* ---- What view_light.glsl is written in ---- */

#include "client-min/draw/view_light_inline.h"

struct view_shape view_shape_of(const struct view_plant *of)
{
	struct plant shape = lod_plant_shape((double)of->anchors[0].radius, (double)of->plant.height_m);
	return (struct view_shape){ shape.center_z, shape.half_width, shape.half_height };
}

/* The place is turned or not, stretched and moved for each octave. */
static const struct { bool turned; double x, y, moved; } octaves[VIEW_OCTAVES] = { { false, 22, 26, 0 },
	{ true, 5, 5, 0 }, { false, 1.1, 1.1, 0 }, { true, 0.23, 0.23, 3 }, { false, 0.045, 0.045, 7 },
	{ true, 0.009, 0.009, 11 } };

void view_light_octave(int which, const double at[2], double out[2])
{
	double x = at[0], y = at[1];
	if (octaves[which].turned) {
		x = 0.8 * at[0] - 0.6 * at[1];
		y = 0.6 * at[0] + 0.8 * at[1];
	}
	out[0] = x * octaves[which].x + octaves[which].moved;
	out[1] = y * octaves[which].y + octaves[which].moved;
}

/* ---- The sun ---- */

/* Low it is red and weak; below the horizon the sky goes dark. */
static struct sunlight sunlight_of(const float sun[3])
{
	if (sun[0] == 0 && sun[1] == 0 && sun[2] == 0)
		return lod_usual_light;
	struct sunlight s = { .to = unit(vec3(sun[0], sun[1], sun[2])) };
	vec3 red = { 1.70f, 0.70f, 0.25f };
	s.color = scale(blend(red, lod_usual_light.color, smoothstep(0, 0.35f, s.to.z)),
		smoothstep(-0.03f, 0.15f, s.to.z));
	s.day = mix(0.06f, 1, smoothstep(-0.14f, 0.2f, s.to.z));
	s.sky = scale(lod_usual_light.sky, s.day);
	s.earth = scale(lod_usual_light.earth, s.day);
	s.glow = 1 - smoothstep(0.02f, 0.35f, fabsf(s.to.z));
	return s;
}

static float haze_of(const struct view_sky *sky, double eye_z)
{
	return (float)view_shade_haze_m(sky->haze_m > 0 ? sky->haze_m : HAZE_M, eye_z);
}

void view_light_sun(const struct view_sky *sky, double eye_z, struct view_light_sun *out)
{
	struct sunlight s = sunlight_of(sky->sun);
	_Static_assert(sizeof s == offsetof(struct view_light_sun, haze_m), "view_light_sun is a sunlight");
	memcpy(out, &s, sizeof s);
	out->haze_m = haze_of(sky, eye_z);
}

/* ---- Surfaces ---- */

/* A direction as an octahedron's x and y, [-1, 1]. */
static void octahedron(const float d[3], float at[2])
{
	float sum = fabsf(d[0]) + fabsf(d[1]) + fabsf(d[2]), part = sum > 0 && sum < INFINITY ? 1 / sum : 0;
	float x = d[0] * part, y = d[1] * part, z = part > 0 ? d[2] : 1;
	if (z < 0) {
		float folded = (1 - fabsf(y)) * (x < 0 ? -1 : 1);
		y = (1 - fabsf(x)) * (y < 0 ? -1 : 1);
		x = folded;
	}
	at[0] = x;
	at[1] = y;
}

static uint32_t whole_of(float share, float most) { return (uint32_t)(share * most + 0.5f); }

uint32_t view_surface_direction(enum view_surface kind, const float direction[3])
{
	float at[2];
	octahedron(direction, at);
	return (uint32_t)kind << 30 | whole_of(at[1] * 0.5f + 0.5f, 32767) << 15 | whole_of(at[0] * 0.5f + 0.5f, 32767);
}

static float share_of(double v) { return (float)fmin(fmax(v, 0), 1); }

static uint32_t ball_of(double reach, uint32_t level, const float direction[3])
{
	float at[2];
	octahedron(direction, at);
	return (uint32_t)VIEW_BALL << 30 | level << 25 | whole_of(share_of(reach), 31) << 20
		| whole_of(at[1] * 0.5f + 0.5f, 1023) << 10 | whole_of(at[0] * 0.5f + 0.5f, 1023);
}

uint32_t view_surface_ball(double reach, double level, const float direction[3])
{
	return ball_of(reach, whole_of(share_of(level), 30), direction);
}

uint32_t view_surface_leaf(double reach, const float direction[3]) { return ball_of(reach, 31, direction); }

uint32_t view_surface_cloud(double reach, double level)
{
	return (uint32_t)VIEW_CLOUD << 30 | whole_of(share_of(level), 255) << 16 | whole_of(share_of(reach), 65535);
}

/* ---- Pixels ---- */

/* The last pixel's plant: most pixels follow one of the same plant. */
struct owned { uint64_t owner; struct lod_place place; struct plant plant; };

struct view_lamp {
	const struct view_draw_job *job;
	struct view_shade shade;
	struct view_shadow shadow;
	struct view_table owners;
	struct sunlight sun;
	float haze_m;
	uint8_t bytes[65536];            /* lod_light_byte of every light */
};
struct shot {                            /* of one picture */
	const struct view_lamp *lamp;
	const struct lod_eye *eye;
	struct view_picture *picture;
	uint32_t threads;
	vec3 right, up, forward;         /* the image plane's half extents, and its middle */
};

void view_light_plant(const struct view_store *store, const struct view_instance *instance, uint64_t owner,
	struct view_light_plant *out)
{
	*out = (struct view_light_plant){ .tone = summary_tone((uint32_t)(owner >> 32)) };
	if (!instance)
		return;
	struct view_shape shape = view_shape_of(view_store_plant(store, instance->plant));
	*out = (struct view_light_plant){ (float)instance->place.sine, (float)instance->place.cosine,
		shape.center_z, shape.half_width, shape.half_height,
		(float)(instance->hash / (double)ECO_SHARE_ONE) };
}

static void find_plant(const struct shot *shot, uint64_t owner, struct owned *p)
{
	const struct view_instance *instance = view_owners_find(&shot->lamp->owners,
		shot->lamp->job->selection, owner);
	struct view_light_plant light;
	view_light_plant(shot->lamp->job->store, instance, owner, &light);
	*p = (struct owned){ .owner = owner };
	_Static_assert(sizeof light == sizeof p->plant, "view_light_plant is struct plant");
	memcpy(&p->plant, &light, sizeof light);
	if (instance)
		p->place = instance->place;
}

static vec3 plant_pixel(const struct shot *shot, const struct owned *p, size_t pixel, vec3 to,
	const double world[3])
{
	const uint8_t *own = shot->picture->rgb + 3 * pixel;
	const double *foot = p->place.at, size = p->plant.half_height > 0 ? p->place.scale : 1;
	vec3 albedo = { lod_light_of[own[0]] / 65535.0f, lod_light_of[own[1]] / 65535.0f,
		lod_light_of[own[2]] / 65535.0f };
	vec3 from_foot = { (float)((world[0] - foot[0]) / size), (float)((world[1] - foot[1]) / size),
		(float)((world[2] - foot[2]) / size) };
	struct face seen = face_of(shot->lamp->sun, p->plant, shot->picture->surface[pixel], scale(unit(to), -1));
	float texel_m = 0, lit = view_shadow_lit(&shot->lamp->shadow, (const float[3]){ to.x, to.y, to.z },
		seen.facet ? (const float[3]){ seen.n.x, seen.n.y, seen.n.z } : NULL, &texel_m);
	return plant_color(shot->lamp->sun, p->plant, albedo, seen, from_foot, to, lit, texel_m, (float)size,
		shot->lamp->haze_m, shot->lamp->job->tint == VIEW_TINT_KIND);
}

/* *water: the share of water there. */
static vec3 ground_albedo_at(const struct shot *shot, vec3 n, vec3 to, const double world[3], float *water)
{
	const struct view_selection *selection = shot->lamp->job->selection;
	const double *origin = selection->ground.origin;
	struct footprint foot = footprint_of(n, to, (float)shot->eye->pixel_rad);
	struct view_image_color image = view_image_at(&selection->image, &(struct view_image_spot){
		{ world[0], world[1] }, { (double)foot.x, (double)foot.y }, (double)foot.across });
	vec3 color = vec3(image.light[0], image.light[1], image.light[2]);
	*water = view_store_needs(shot->lamp->job->store) & ECO_NEED_WATER ? water_of(color, image.alpha) : 0;
	return imaged_albedo((ground_place){ world[0] - origin[0], world[1] - origin[1] }, n.z, length(to), color, image.alpha,
		image.texel_m * (1 - *water));        /* it has no grain */
}

static vec3 ground_pixel(const struct shot *shot, size_t pixel, vec3 to, const double world[3])
{
	vec3 n = direction_of(shot->picture->surface[pixel]);
	float below[2];
	view_shade_at(&shot->lamp->shade, world, below);
	if (shot->lamp->shadow.top) {
		float texel_m, lit = view_shadow_lit(&shot->lamp->shadow, (const float[3]){ to.x, to.y, to.z },
			(const float[3]){ n.x, n.y, n.z }, &texel_m);
		below[0] = lit < 0 ? below[0] : 1 - lit;
	}
	const double *origin = shot->lamp->job->selection->ground.origin;
	float water;
	vec3 lit = times(ground_albedo_at(shot, n, to, world, &water),
		ground_light(shot->lamp->sun, n, below[0], below[1]));
	if (water > 0)
		lit = water_color(shot->lamp->sun, (ground_place){ world[0] - origin[0], world[1] - origin[1] }, lit, to, water);
	return ground_color(shot->lamp->sun, lit, to, shot->lamp->haze_m, shot->lamp->job->tint == VIEW_TINT_KIND);
}

static void light_pixel(const struct shot *shot, struct owned *owned, uint32_t x, uint32_t y)
{
	struct view_picture *picture = shot->picture;
	size_t i = (size_t)y * picture->width + x;
	float depth = picture->depth[i], u = ((float)x + 0.5f) / (float)picture->width * 2 - 1,
		v = 1 - ((float)y + 0.5f) / (float)picture->height * 2;
	vec3 ray = add(add(scale(shot->right, u), scale(shot->up, v)), shot->forward), color;
	if (depth > 0) {
		vec3 to = scale(ray, 1 / depth);
		const double *eye = shot->eye->at;
		const double world[3] = { eye[0] + to.x, eye[1] + to.y, eye[2] + to.z };
		uint64_t owner = picture->owner[i];
		if (owner && owner != owned->owner)
			find_plant(shot, owner, owned);
		color = owner ? plant_pixel(shot, owned, i, to, world) : ground_pixel(shot, i, to, world);
	} else {
		color = sky_color(shot->lamp->sun, ray, shot->lamp->job->tint == VIEW_TINT_KIND);
	}
	const float channels[3] = { color.x, color.y, color.z };
	for (size_t k = 0; k < 3; k++) {
		uint16_t light = (uint16_t)(65535 * shown(channels[k]) + 0.5f);
		picture->rgb[3 * i + k] = shot->lamp->bytes[light];
		if (picture->light)
			picture->light[3 * i + k] = light;
	}
}

static void light_rows(void *ctx, uint32_t first)
{
	const struct shot *shot = ctx;
	struct owned owned = { .owner = 0 };
	for (uint32_t y = first; y < shot->picture->height; y += shot->threads)
		for (uint32_t x = 0; x < shot->picture->width; x++)
			light_pixel(shot, &owned, x, y);
}

static vec3 axis_of(const double axis[3], double t)
{
	return vec3((float)(axis[0] * t), (float)(axis[1] * t), (float)(axis[2] * t));
}

void view_lamp_light(const struct view_lamp *lamp, const struct lod_eye *eye, struct view_picture *picture,
	uint32_t threads)
{
	struct shot shot = { .lamp = lamp, .eye = eye, .picture = picture, .threads = threads,
		.right = axis_of(eye->right, eye->tan_x), .up = axis_of(eye->up, eye->tan_y) };
	shot.forward = add(axis_of(eye->forward, 1), add(axis_of(eye->right, eye->middle[0]),
		axis_of(eye->up, eye->middle[1])));
	for (size_t i = 0; lamp->job->tint == VIEW_TINT_OWN && i < (size_t)picture->width * picture->height; i++)
		if (!picture->owner[i])
			memset(picture->rgb + 3 * i, picture->depth[i] > 0 ? VIEW_OWN_GROUND : 0, 3);
	if (lamp->job->tint != VIEW_TINT_OWN)
		view_threads_run(threads, light_rows, &shot);
	for (size_t i = 0; lamp->job->tint == VIEW_TINT_OWN && picture->light && i < 3 * (size_t)picture->width
			* picture->height; i++)
		picture->light[i] = lod_light_of[picture->rgb[i]];
}

static enum eco_code cast_shadows(struct view_lamp *lamp, struct view_picture *picture, struct eco_error *error)
{
	const struct view_draw_job *job = lamp->job;
	const struct view_sky *sky = &job->selection->sky;
	double start = view_clock_ms();
	enum eco_code code = view_shadow_make(&lamp->shadow, &(struct view_shadow_job){ job->store,
		sky->casters ? sky->casters : job->selection, job->eye, picture,
		{ lamp->sun.to.x, lamp->sun.to.y, lamp->sun.to.z }, sky->shadows, sky->shadow_size,
		job->threads }, error);
	picture->shadow_ms = lamp->shadow.top ? view_clock_ms() - start : 0;
	if (!code)
		picture->shadow_texels = view_shadow_sharpness(&lamp->shadow, picture, job->eye);
	return code;
}

enum eco_code view_lamp_make(struct view_lamp **out, const struct view_draw_job *job,
	struct view_picture *first, struct eco_error *error)
{
	struct view_lamp *lamp = *out = calloc(1, sizeof *lamp);
	if (!lamp || !view_owners_make(&lamp->owners, job->selection))
		return eco_no_memory(error, "the light of a picture");
	lamp->job = job;
	lamp->sun = sunlight_of(job->selection->sky.sun);
	lamp->haze_m = haze_of(&job->selection->sky, job->eye->at[2]);
	for (uint32_t light = 0, byte = 0; light < 65536; light++) {
		while (byte < 255 && 2 * light > (uint32_t)lod_light_of[byte] + lod_light_of[byte + 1])
			byte++;
		lamp->bytes[light] = (uint8_t)byte;
	}
	if (job->selection->ground.count && job->tint != VIEW_TINT_OWN)
		ECO_PASS(view_shade_make(&lamp->shade, job->store, job->selection, error));
	if (job->selection->sky.shadows && job->tint != VIEW_TINT_OWN)
		ECO_PASS(cast_shadows(lamp, first, error));
	return ECO_OK;
}

void view_lamp_free(struct view_lamp *lamp)
{
	if (!lamp)
		return;
	view_shade_free(&lamp->shade);
	view_shadow_free(&lamp->shadow);
	view_table_free(&lamp->owners);
	free(lamp);
}

/* ---- Samples ---- */

/* Adds one sample of all pixels to the sums. */
static enum eco_code add_sample(const struct view_draw_job *job, const struct view_lamp *lamp, view_record *record,
	void *ctx, uint32_t number, struct view_picture *picture, uint32_t *sums, struct eco_error *error)
{
	struct lod_eye eye = *job->eye;
	struct view_draw_job at = *job;
	at.eye = &eye;
	lod_eye_sample(&eye, number);
	ECO_PASS(record(ctx, &at, picture, error));
	view_lamp_light(lamp, &eye, picture, view_thread_count(job->threads));
	for (size_t i = 0; i < 3 * (size_t)picture->width * picture->height; i++)
		sums[i] += picture->light[i];
	return ECO_OK;
}

/* Replaces the colours of the first sample by the mean of all. */
static enum eco_code all_samples(const struct view_draw_job *job, const struct view_lamp *lamp,
	view_record *record, void *ctx, struct view_picture *first, struct eco_error *error)
{
	size_t channels = 3 * (size_t)first->width * first->height;
	uint32_t *sums = calloc(channels, sizeof *sums), count = job->samples;
	struct view_picture picture = { 0 };
	enum eco_code code = view_picture_init(&picture, first->width, first->height, error);
	picture.light = calloc(channels, sizeof *picture.light);
	if (!code && (!sums || !picture.light))
		code = eco_no_memory(error, "the samples of a picture");
	for (size_t i = 0; i < channels && !code; i++)
		sums[i] = first->light[i];
	for (uint32_t i = 1; i < count && !code; i++)
		code = add_sample(job, lamp, record, ctx, i, &picture, sums, error);
	for (size_t i = 0; i < channels && !code; i++)
		first->rgb[i] = lamp->bytes[(sums[i] + count / 2) / count];
	view_picture_free(&picture);
	free(sums);
	return code;
}

enum eco_code view_light_samples(const struct view_draw_job *job, view_record *record, void *ctx,
	struct view_picture *picture, struct eco_error *error)
{
	struct view_lamp *lamp = NULL;
	double start = view_clock_ms();
	enum eco_code code = record(ctx, job, picture, error);
	if (!code)
		code = view_lamp_make(&lamp, job, picture, error);
	if (!code && job->samples > 1) {
		free(picture->light);
		picture->light = calloc(3 * (size_t)picture->width * picture->height, sizeof *picture->light);
		if (!picture->light)
			code = eco_no_memory(error, "the samples of a picture");
	}
	if (!code)
		view_lamp_light(lamp, job->eye, picture, view_thread_count(job->threads));
	if (!code && job->samples > 1)
		code = all_samples(job, lamp, record, ctx, picture, error);
	free(picture->light);
	picture->light = NULL;
	view_lamp_free(lamp);
	picture->draw_ms = view_clock_ms() - start;
	return code;
}
