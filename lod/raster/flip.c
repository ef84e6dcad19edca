/* Two differences of a pixel, multiplied as exponents (section 4 of the paper): error = colour ^ (1 - feature).
 *
 *   colour   distance of both pictures as the eye blurs them (contrast sensitivity; HyAB over Lab, Hunt's effect)
 *   feature  edges and points that only one of the pictures has, by derivatives of Gaussians
 *
 * Filters are separable, four pixels at a time. At its borders a picture goes on with its last pixel. */
#include "lod/raster/flip.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/lanes.h"
#include "lod/light.h"

#define PI 3.14159265358979323846
#define PIXELS_PER_DEGREE (0.7 * 3840 / 0.7 * (PI / 180))
#define REACH 10                         /* pixels of the widest filter: 3 deviations of blue-yellow's */
#define TAPS (2 * REACH + 1)
#define BAND 64u                         /* rows */

/* Constants of the paper, by its names. */
#define Q_C 0.7
#define P_C 0.4
#define P_T 0.95
#define W 0.082
#define Q_F 0.5

enum channel { LUMA, RED_GREEN, BLUE_YELLOW, CHANNELS };
enum filtered { SEEN, EDGE_X = SEEN + CHANNELS, EDGE_Y, POINT_X, POINT_Y, FILTERED };

struct kernel { float tap[TAPS]; };
/* One separable filter: a row's times a column's, weighted, of one channel. */
struct filter { enum channel from; enum filtered to; const struct kernel *across, *down; float weight; };

struct filters {
	struct kernel luma, red_green, blue_yellow[2], smooth, edge, point;
	struct filter all[CHANNELS + 1 + 4];
	int count;
};

/* ---- Filters ---- */

static double gauss(double x, double variance) { return exp(-x * x / (2 * variance)); }

static double kernel_sum(const struct kernel *k)
{
	double sum = 0;
	for (int i = 0; i < TAPS; i++)
		sum += k->tap[i];
	return sum;
}

/* exp(-pi^2 d^2 / b), d in degrees; returns its sum. */
static double blur_kernel(struct kernel *k, double b)
{
	for (int i = 0; i < TAPS; i++) {
		double d = (i - REACH) / PIXELS_PER_DEGREE;
		k->tap[i] = (float)exp(-PI * PI * d * d / b);
	}
	return kernel_sum(k);
}

static void scale_kernel(struct kernel *k, double by)
{
	for (int i = 0; i < TAPS; i++)
		k->tap[i] = (float)(k->tap[i] * by);
}

static void add_filter(struct filters *f, enum channel from, enum filtered to, const struct kernel *across,
	const struct kernel *down, double weight)
{
	f->all[f->count++] = (struct filter){ from, to, across, down, (float)weight };
}

/* Contrast sensitivity (table 1 of the paper): luminance and red-green are one Gaussian, blue-yellow two. */
static void make_blurs(struct filters *f)
{
	static const double a[2] = { 34.1, 13.5 }, b[2] = { 0.04, 0.025 };
	double weight[2], all = 0;
	scale_kernel(&f->luma, 1 / blur_kernel(&f->luma, 0.0047));
	scale_kernel(&f->red_green, 1 / blur_kernel(&f->red_green, 0.0053));
	for (int i = 0; i < 2; i++) {
		double sum = blur_kernel(&f->blue_yellow[i], b[i]);
		weight[i] = a[i] * sqrt(PI / b[i]) * sum * sum;
		all += weight[i];
		scale_kernel(&f->blue_yellow[i], 1 / sum);
	}
	add_filter(f, LUMA, SEEN + LUMA, &f->luma, &f->luma, 1);
	add_filter(f, RED_GREEN, SEEN + RED_GREEN, &f->red_green, &f->red_green, 1);
	for (int i = 0; i < 2; i++)
		add_filter(f, BLUE_YELLOW, SEEN + BLUE_YELLOW, &f->blue_yellow[i], &f->blue_yellow[i],
			weight[i] / all);
}

/* Positive and negative taps are each scaled to a sum of 1. */
static void balance_kernel(struct kernel *k)
{
	double sum[2] = { 0, 0 };
	for (int i = 0; i < TAPS; i++)
		sum[k->tap[i] < 0] += fabs((double)k->tap[i]);
	for (int i = 0; i < TAPS; i++)
		k->tap[i] = (float)(k->tap[i] / sum[k->tap[i] < 0]);
}

static void make_features(struct filters *f)
{
	double deviation = 0.5 * W * PIXELS_PER_DEGREE, variance = deviation * deviation;
	int reach = (int)ceil(3 * deviation);
	for (int i = 0; i < TAPS; i++) {
		double x = i - REACH, g = abs(i - REACH) <= reach ? gauss(x, variance) : 0;
		f->smooth.tap[i] = (float)g;
		f->edge.tap[i] = (float)(-x * g);
		f->point.tap[i] = (float)((x * x / variance - 1) * g);
	}
	scale_kernel(&f->smooth, 1 / kernel_sum(&f->smooth));
	balance_kernel(&f->edge);
	balance_kernel(&f->point);
	add_filter(f, LUMA, EDGE_X, &f->edge, &f->smooth, 1);
	add_filter(f, LUMA, EDGE_Y, &f->smooth, &f->edge, 1);
	add_filter(f, LUMA, POINT_X, &f->point, &f->smooth, 1);
	add_filter(f, LUMA, POINT_Y, &f->smooth, &f->point, 1);
}

/* ---- Colours ---- */

static const double white[3] = { 0.950428545377181, 1.0, 1.088900370798128 };

static void xyz_of(const double rgb[3], double xyz[3])
{
	static const double m[3][3] = {
		{ 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794 },
		{ 2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897 },
		{ 1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382 } };
	for (int k = 0; k < 3; k++)
		xyz[k] = (m[k][0] * rgb[0] + m[k][1] * rgb[1] + m[k][2] * rgb[2]) / white[k];
}

/* The opponent space YCxCz: of a byte's light, linear, so that blurring mixes light. */
static void opponent_of(const uint8_t *srgb, float *out, size_t stride)
{
	double rgb[3], xyz[3];
	for (int k = 0; k < 3; k++)
		rgb[k] = lod_light_of[srgb[k]] / 65535.0;
	xyz_of(rgb, xyz);
	out[LUMA * stride] = (float)(116 * xyz[1] - 16);
	out[RED_GREEN * stride] = (float)(500 * (xyz[0] - xyz[1]));
	out[BLUE_YELLOW * stride] = (float)(200 * (xyz[1] - xyz[2]));
}

static double lab_root(double t)
{
	const double delta = 6.0 / 29;
	return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

void lod_lab(const double rgb[3], double lab[3])
{
	double xyz[3];
	xyz_of(rgb, xyz);
	for (int k = 0; k < 3; k++)
		xyz[k] = lab_root(xyz[k]);
	lab[0] = 116 * xyz[1] - 16;
	lab[1] = 500 * (xyz[0] - xyz[1]);
	lab[2] = 200 * (xyz[1] - xyz[2]);
}

/* With Hunt's effect. */
static void lab_of(const double rgb[3], double lab[3])
{
	lod_lab(rgb, lab);
	lab[1] *= 0.01 * lab[0];
	lab[2] *= 0.01 * lab[0];
}

/* L*a*b* of a blurred colour, clamped to the colours of a screen. */
static void seen_lab(const float *seen, size_t stride, double lab[3])
{
	static const double m[3][3] = { { 3.241003275, -1.537398934, -0.498615861 },
		{ -0.969224334, 1.875930071, 0.041554224 }, { 0.055639423, -0.204011202, 1.057148933 } };
	double y = (seen[LUMA * stride] + 16.0) / 116, rgb[3];
	const double xyz[3] = { (y + seen[RED_GREEN * stride] / 500.0) * white[0], y * white[1],
		(y - seen[BLUE_YELLOW * stride] / 200.0) * white[2] };
	for (int k = 0; k < 3; k++)
		rgb[k] = fmin(fmax(m[k][0] * xyz[0] + m[k][1] * xyz[1] + m[k][2] * xyz[2], 0), 1);
	lab_of(rgb, lab);
}

static double distance_of(const double a[3], const double b[3])
{
	double across = a[1] - b[1], along = a[2] - b[2];
	return fabs(a[0] - b[0]) + sqrt(across * across + along * along);
}

/* The farthest apart that colours of a screen are, raised as all distances are. */
static double farthest(void)
{
	double green[3], blue[3];
	lab_of((const double[3]){ 0, 1, 0 }, green);
	lab_of((const double[3]){ 0, 0, 1 }, blue);
	return pow(distance_of(green, blue), Q_C);
}

/* ---- Bands ---- */

struct band {                            /* of one picture: rows with REACH more on either side */
	uint32_t width, rows;
	size_t stride;                   /* floats a plane */
	float *channels, *filtered;      /* CHANNELS and FILTERED planes */
	float *line, *turned;            /* a padded row; a plane that is filtered along rows */
};

static void band_free(struct band *band)
{
	eco_free(band->channels, band->filtered, band->line, band->turned);
}

static void band_make(struct band *band, uint32_t width)
{
	*band = (struct band){ .width = width,
		.stride = ((size_t)width + 3) / 4 * 4 * (BAND + 2 * REACH) };
	band->channels = eco_alloc(CHANNELS * band->stride, sizeof(float));
	band->filtered = eco_alloc(FILTERED * band->stride, sizeof(float));
	band->line = eco_alloc((size_t)width + TAPS + 4, sizeof(float));
	band->turned = eco_alloc(band->stride, sizeof(float));
}

static void load(struct band *band, const uint8_t *rgb, uint32_t height, uint32_t first)
{
	for (uint32_t r = 0; r < band->rows + 2 * REACH; r++) {
		int64_t y = (int64_t)first + r - REACH, last = (int64_t)height - 1;
		y = y < 0 ? 0 : y > last ? last : y;
		const uint8_t *row = rgb + 3 * (size_t)band->width * (size_t)y;
		for (uint32_t x = 0; x < band->width; x++)
			opponent_of(row + 3 * (size_t)x, band->channels + (size_t)r * band->width + x,
				band->stride);
	}
}

static inline lod_f4 weigh(const float *from, size_t step, const struct kernel *k)
{
	lod_f4 sum = lod_f4_all(0);
	for (size_t i = 0; i < TAPS; i++)
		sum += lod_f4_all(k->tap[i]) * lod_f4_load(from + i * step);
	return sum;
}

/* The planes' rows lie close together, so four pixels may begin in one row and end in the next. */
static void filter_rows(const struct band *band, const struct filter *f)
{
	const float *from = band->channels + f->from * band->stride;
	for (uint32_t r = 0; r < band->rows + 2 * REACH; r++, from += band->width) {
		for (uint32_t i = 0; i < REACH; i++) {
			band->line[i] = from[0];
			band->line[REACH + band->width + i] = from[band->width - 1];
		}
		memcpy(band->line + REACH, from, band->width * sizeof(float));
		float *to = band->turned + (size_t)r * band->width;
		for (uint32_t x = 0; x < band->width; x += 4) {
			lod_f4 sum = weigh(band->line + x, 1, f->across);
			memcpy(to + x, &sum, (band->width - x < 4 ? band->width - x : 4) * sizeof(float));
		}
	}
}

static void filter_columns(const struct band *band, const struct filter *f)
{
	float *to = band->filtered + f->to * band->stride;
	lod_f4 weight = lod_f4_all(f->weight);
	for (size_t i = 0; i < (size_t)band->rows * band->width; i += 4)
		lod_f4_store(to + i, lod_f4_load(to + i) + weight * weigh(band->turned + i, band->width,
			f->down));
}

static void filter_band(struct band *band, const struct filters *filters)
{
	memset(band->filtered, 0, FILTERED * band->stride * sizeof(float));
	for (int i = 0; i < filters->count; i++) {
		filter_rows(band, &filters->all[i]);
		filter_columns(band, &filters->all[i]);
	}
}

/* ---- Errors ---- */

static double colour_error(const struct band band[2], size_t i, double most)
{
	double lab[2][3];
	for (int k = 0; k < 2; k++)
		seen_lab(band[k].filtered + SEEN * band[k].stride + i, band[k].stride, lab[k]);
	double e = pow(distance_of(lab[0], lab[1]), Q_C), bend = P_C * most;
	return e < bend ? P_T / bend * e : P_T + (e - bend) / (most - bend) * (1 - P_T);
}

/* Length of a pair of derivatives; luminance counts from 0 to 1 here. */
static double strength(const struct band *band, enum filtered x, size_t i)
{
	double a = band->filtered[x * band->stride + i] / 116.0,
		b = band->filtered[(x + 1) * band->stride + i] / 116.0;
	return sqrt(a * a + b * b);
}

static double feature_error(const struct band band[2], size_t i)
{
	double edge = fabs(strength(&band[0], EDGE_X, i) - strength(&band[1], EDGE_X, i));
	double point = fabs(strength(&band[0], POINT_X, i) - strength(&band[1], POINT_X, i));
	return pow(fmin(fmax(edge, point) / sqrt(2), 1), Q_F);
}

static double sum_errors(const struct band band[2], double most, float *error)
{
	double sum = 0;
	for (size_t i = 0; i < (size_t)band[0].rows * band[0].width; i++) {
		double e = pow(colour_error(band, i, most), 1 - feature_error(band, i));
		sum += e;
		if (error)
			error[i] = (float)e;
	}
	return sum;
}

double lod_flip(const struct lod_flip_input *input)
{
	const uint8_t *pictures[2] = { input->test, input->reference };
	struct filters filters = { .count = 0 };
	struct band band[2];
	double most = farthest(), sum = 0;
	make_blurs(&filters);
	make_features(&filters);
	for (int k = 0; k < 2; k++)
		band_make(&band[k], input->width);
	for (uint32_t y = 0; y < input->height; y += BAND) {
		for (int k = 0; k < 2; k++) {
			band[k].rows = input->height - y < BAND ? input->height - y : BAND;
			load(&band[k], pictures[k], input->height, y);
			filter_band(&band[k], &filters);
		}
		sum += sum_errors(band, most, input->error ? input->error + (size_t)y * input->width : NULL);
	}
	band_free(&band[0]);
	band_free(&band[1]);
	return sum / ((double)input->width * input->height);
}
