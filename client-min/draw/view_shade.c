#include "client-min/draw/view_shade.h"

#include <math.h>
#include <stdlib.h>

#define REACH_M 450.0                    /* plants further away cast no shadow that is worth a texel */
#define AIR_M 1200.0                     /* of dust and vapour, not of air itself */
#define LOWEST 0.12                      /* of the sun: lower, shadows are too long to be seen as such */
/* metres of shadow a metre of height, away from the usual sun of light */
static const double usual[2] = { 0.693, 0.577 };

struct view_shape view_shape_of(const struct view_plant *plant)
{
	const struct eco_anchor *whole = &plant->anchors[0];
	double half = 0.5 * plant->plant.height_m, square = (double)whole->radius * whole->radius
		- half * half;
	double least = 0.12 * whole->radius;
	if (!(half > 0))
		half = whole->radius;
	return (struct view_shape){ (float)half, (float)(square > least * least ? sqrt(square) : least),
		(float)half };
}

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

/* To the east and north; false: there are none. */
static bool find_throw(const float sun[3], double away[2])
{
	bool own = sun[0] != 0 || sun[1] != 0 || sun[2] != 0;
	for (int k = 0; k < 2; k++)
		away[k] = own ? -(double)sun[k] / fmax((double)sun[2], LOWEST) : usual[k];
	return !own || (double)sun[2] > LOWEST;
}

static void cast(struct view_shade *shade, const struct view_instance *instance,
	const struct view_plant *plant, const double away[2], bool shadows)
{
	struct view_shape shape = view_shape_of(plant);
	double scale = instance->place.scale, height = 2 * shape.half_height * scale,
		width = shape.half_width * scale;
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
		return eco_fail(error, ECO_NO_MEMORY, "no memory for shadows");
	double away[2];
	bool shadows = find_throw(selection->sky.sun, away);
	find_square(shade, selection);
	for (uint32_t i = 0; i < selection->instance_count; i++) {
		const struct view_instance *p = &selection->instances[i];
		if (p->plant != ECO_NONE && p->distance_m <= REACH_M)
			cast(shade, p, view_store_plant(store, p->plant), away, shadows);
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
