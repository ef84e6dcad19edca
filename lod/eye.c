#include "lod/eye.h"

#include <assert.h>
#include <math.h>

#include "ecofiles/base/angle16.h"

/* Scales to unit length. The components are first divided by the largest, so that neither 1e-200 nor 1e200
 * over- or underflows. */
static bool normalize(double v[3])
{
	double largest = 0;
	for (int i = 0; i < 3; i++)
		largest = fabs(v[i]) > largest ? fabs(v[i]) : largest;
	if (!(largest > 0))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= largest;
	double length = sqrt(lod_dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

/* sin(x)/x and cos(x) by their series, x in [0, pi/4]: the last bit of libm's differs between machines. */
static double series_sinc(double x)
{
	double sum = 1, term = 1;
	for (int k = 2; k <= 24; k += 2) {
		term *= -x * x / (k * (k + 1));
		sum += term;
	}
	return sum;
}

static double series_cos(double x)
{
	double sum = 1, term = 1;
	for (int k = 2; k <= 24; k += 2) {
		term *= -x * x / ((k - 1) * k);
		sum += term;
	}
	return sum;
}

static double tangent_deg(double degrees)
{
	const double rad = 3.14159265358979323846 / 180.0;
	if (degrees > 45) {
		double x = (90.0 - degrees) * rad;
		return series_cos(x) / (x * series_sinc(x));
	}
	double x = degrees * rad;
	return x * series_sinc(x) / series_cos(x);
}

static void side_plane(double out[3], const double forward[3], const double axis[3], double sign,
	double tangent)
{
	double length = sqrt(1.0 + tangent * tangent);
	for (int i = 0; i < 3; i++)
		out[i] = (tangent * forward[i] - sign * axis[i]) / length;
}

void lod_eye_make(struct lod_eye *eye, const struct eco_view *view)
{
	double up[3];
	*eye = (struct lod_eye){ .sample = 0 };
	for (int i = 0; i < 3; i++) {
		eye->at[i] = view->eye[i];
		eye->forward[i] = view->target[i] - view->eye[i];
		up[i] = view->up[i];
	}
	bool looks = normalize(eye->forward);
	assert(looks);
	bool has_up = normalize(up);
	lod_cross(eye->forward, up, eye->right);
	if (!has_up || lod_dot(eye->right, eye->right) < 1e-24) {
		/* `up` is parallel to the view: take the world axis that is least along it, Z first, so that
		 * a level view stays level */
		int axis = fabs(eye->forward[2]) < 0.9 ? 2 : 1;
		for (int i = 0; i < 3; i++)
			up[i] = i == axis;
		lod_cross(eye->forward, up, eye->right);
	}
	normalize(eye->right);
	lod_cross(eye->right, eye->forward, eye->up);
	eye->tan_y = tangent_deg(view->fov_y_deg * 0.5);
	eye->tan_x = eye->tan_y * view->width / view->height;
	eye->pixel_rad = 2.0 * eye->tan_y / view->height;
	side_plane(eye->side[0], eye->forward, eye->right, 1, eye->tan_x);
	side_plane(eye->side[1], eye->forward, eye->right, -1, eye->tan_x);
	side_plane(eye->side[2], eye->forward, eye->up, 1, eye->tan_y);
	side_plane(eye->side[3], eye->forward, eye->up, -1, eye->tan_y);
}

void lod_eye_part(struct lod_eye *eye, uint32_t width, uint32_t height, const uint32_t at[2],
	const uint32_t size[2])
{
	eye->middle[0] += eye->tan_x * ((2.0 * at[0] + size[0]) / width - 1);
	eye->middle[1] -= eye->tan_y * ((2.0 * at[1] + size[1]) / height - 1);
	eye->tan_x *= (double)size[0] / width;
	eye->tan_y *= (double)size[1] / height;
}

void lod_eye_sample(struct lod_eye *eye, uint32_t number)
{
	static const int8_t places[LOD_SAMPLES_MAX][2] = { { 0, 0 }, { 29, -25 }, { -5, 27 }, { -26, -3 },
		{ 19, 19 }, { 11, -19 }, { -19, 13 }, { -10, -13 }, { 26, -6 }, { 14, 5 }, { 22, 30 },
		{ -14, -22 }, { 6, -30 }, { -2, 10 }, { -30, 22 }, { -22, -10 }, { 29, 8 }, { -18, 29 }, { -13, 1 }, { 6, 20 },
		{ 12, -7 }, { -1, -20 }, { 22, -16 }, { -25, -21 }, { -10, 18 }, { 2, -10 }, { -28, -32 }, { -32, -14 }, { 19, -25 },
		{ 13, 27 }, { -7, -28 }, { -25, 6 }, { 7, 11 }, { 22, 2 }, { -7, -5 }, { -21, 21 }, { -28, 14 }, { 27, 16 },
		{ -11, 9 }, { 21, 10 }, { -2, 19 }, { 8, 0 }, { -20, -27 }, { 31, 0 }, { -15, -7 }, { 3, 27 }, { 27, 24 }, { 19, -9 },
		{ 14, 13 }, { -12, 25 }, { -18, -16 }, { 14, -30 }, { 29, 31 }, { -6, 4 }, { -20, 1 }, { 5, -16 }, { -1, -31 },
		{ 5, -23 }, { -25, 26 }, { 15, -14 }, { 17, -2 }, { -14, -30 }, { 4, 5 }, { -31, -7 } };        /* 1/64 pixel */
	for (int k = 0; k < 2; k++)
		eye->middle[k] += places[number][k] / 64.0 * eye->pixel_rad;
	eye->sample = number;
}

void lod_place_instance(struct lod_place *out, const struct eco_placement *placement,
	const struct eco_list *list, const struct eco_place *place)
{
	double p[3], sine, cosine;
	for (int i = 0; i < 3; i++)
		p[i] = list->grid_origin[i] + place->position[i] * list->grid_step[i];
	eco_angle16_sincos(placement->turn, &sine, &cosine);
	out->at[0] = placement->at[0] + placement->scale * (cosine * p[0] - sine * p[1]);
	out->at[1] = placement->at[1] + placement->scale * (sine * p[0] + cosine * p[1]);
	out->at[2] = placement->at[2] + placement->scale * p[2];
	eco_angle16_sincos((uint16_t)(placement->turn + place->turn), &out->sine, &out->cosine);
	out->scale = placement->scale * (place->scale / 65536.0);
	out->wider = eco_place_width(place->width) - 1;
	out->salt = 0;
}

void lod_place_point(const struct lod_place *place, const float p[3], double world[3])
{
	double x = p[0] * lod_place_width(place), y = p[1] * lod_place_width(place), z = p[2];
	world[0] = place->at[0] + place->scale * (place->cosine * x - place->sine * y);
	world[1] = place->at[1] + place->scale * (place->sine * x + place->cosine * y);
	world[2] = place->at[2] + place->scale * z;
}

bool lod_eye_sees(const struct lod_eye *eye, const double center[3], double radius)
{
	double from_eye[3] = { center[0] - eye->at[0], center[1] - eye->at[1], center[2] - eye->at[2] };
	/* slightly more than the radius: a plant that is out of view only by rounding is drawn */
	double reach = radius * (1.0 + 1e-9);
	for (int i = 0; i < 4; i++)
		if (lod_dot(eye->side[i], from_eye) < -reach)
			return false;
	return lod_dot(eye->forward, from_eye) > -reach;
}

/* Factor on a squared distance, in [2^(-1/4), 2^(1/4)). Times an odd number modulo 2^16 the hash is permuted
 * so that any range of hashes is spread evenly: plants in one share of a cut are blurred like all others. */
static double blur(uint32_t hash)
{
	const double least = 0.84089641525371454303, most = 1.18920711500272106672;
	return least + (double)(hash * 40503u & (ECO_SHARE_ONE - 1)) * ((most - least) / ECO_SHARE_ONE);
}

uint8_t lod_eye_band(const struct lod_eye *eye, const double world[3], double scale, uint32_t hash)
{
	double d[3] = { world[0] - eye->at[0], world[1] - eye->at[1], world[2] - eye->at[2] };
	if (!(scale * scale > 0))        /* it is as small as if it were infinitely far away */
		return (uint8_t)(ECO_BANDS - 1);
	double square = lod_dot(d, d) / (scale * scale) * blur(hash);
	if (!(square > 0))
		return 0;
	int exponent;
	double mantissa = frexp(square, &exponent);              /* exact: square = mantissa * 2^exponent */
	int band = 2 * (exponent - 1) + 80 + (mantissa >= 0.70710678118654752440 ? 1 : 0);
	return (uint8_t)(band < 0 ? 0 : band >= (int)ECO_BANDS ? (int)ECO_BANDS - 1 : band);
}

double lod_band_distance_m(uint8_t band)
{
	static const double middle[4] = { 1.09050773266525765921, 1.29683955465100966593,
		1.54221082540794082361,
		1.83400808640934246349 };                            /* 2^(1/8), 2^(3/8), 2^(5/8), 2^(7/8) */
	return ldexp(middle[band & 3], (band >> 2) - 20);
}

uint32_t lod_instance_anchors(const struct lod_eye *eye, const struct lod_place *place,
	const struct eco_anchor *anchors, uint32_t anchor_first, uint32_t anchor_count, uint32_t gate,
	uint32_t hash, struct lod_anchor_band *out)
{
	double center[3];
	lod_place_point(place, anchors[0].center, center);
	if (!lod_eye_sees(eye, center, anchors[0].radius * lod_place_most(place)))
		return 0;
	out[0].anchor = anchor_first;
	out[0].band = lod_eye_band(eye, center, place->scale, hash);
	if (eco_gate_place(out[0].band, hash) >= gate)
		return 1;
	uint32_t count = 1;
	for (uint32_t i = 1; i < anchor_count; i++) {
		lod_place_point(place, anchors[i].center, center);
		if (!lod_eye_sees(eye, center, anchors[i].radius * lod_place_most(place)))
			continue;
		out[count].anchor = anchor_first + i;
		out[count++].band = lod_eye_band(eye, center, place->scale, hash);
	}
	return count;
}

uint32_t lod_share_hash(uint32_t path, uint32_t list, uint32_t index)
{
	uint64_t h = ((uint64_t)path << 32 | list) * 0x9E3779B97F4A7C15u + index;
	h ^= h >> 30;
	h *= 0xBF58476D1CE4E5B9u;
	h ^= h >> 27;
	h *= 0x94D049BB133111EBu;
	h ^= h >> 31;
	return (uint32_t)(h & (ECO_SHARE_ONE - 1));
}

uint32_t lod_distance_of(double m)
{
	uint32_t distance = 0;
	while (distance + 1 < LOD_DISTANCES && m >= lod_distance_from_m(distance + 1))
		distance++;
	return distance;
}

double lod_distance_from_m(uint32_t distance) { return distance ? LOD_DISTANCE_FIRST_M * (1u << (distance - 1)) : 0; }
