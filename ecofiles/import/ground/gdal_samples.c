/* From a raster's values to metres. Values are read row by row, in double, as they are in the file: GDAL's
 * own averaging rounds to the file's number type and does not skip absurd values, and pictures read as
 * pictures would be stretched to 0..1.
 *
 * A hole may have no mark. A value is taken for "no height" in two cases. Either it lies further from all
 * other values than these lie from each other, and many steps away (-32768, 3.4e38, 65535). Or it is one
 * that programs write (0, -9999, ...), and nearly everywhere it meets another value, the step is many
 * times that between usual neighbours. A sea at 0 passes, because its shores are gentle somewhere. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/ground/gdal_ground.h"

#include <cpl_error.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEIGHT_MAX_M 1e5
#define FOOT_M 0.3048
#define US_FOOT_M (1200.0 / 3937.0)
#define HEIGHT_ODD_M 9000.0          /* no ground on Earth is higher */
#define DEPTH_ODD_M 11500.0

/* ---- The meaning of a value ---- */

#define HOLES_MAX 12u
struct meaning {
	double scale, offset, unit_m;
	double holes[HOLES_MAX];     /* values that are no heights */
	uint32_t hole_count;
};

static bool is_hole(const struct meaning *m, double raw)
{
	for (uint32_t i = 0; i < m->hole_count; i++)
		if (raw == m->holes[i] || (float)raw == (float)m->holes[i])
			return true;
	return false;
}

/* Metres, or NaN if the value is no height. */
static double metres_of(const struct meaning *m, double raw)
{
	double metres = (raw * m->scale + m->offset) * m->unit_m;
	return fabs(metres) <= HEIGHT_MAX_M && !is_hole(m, raw) ? metres : NAN;
}

static double unit_named(const char *name)
{
	static const struct { const char *names; double metres;
	} units[] = { { "|m|metre|meter|metres|meters|", 1 }, { "|ft|foot|feet|international foot|", FOOT_M },
		{ "|us survey foot|us survey feet|us survey ft|ftus|us-ft|foot_us|", US_FOOT_M },
		{ "|cm|centimetre|centimeter|", 0.01 }, { "|mm|", 0.001 },
		{ "|dm|decimetre|decimeter|", 0.1 }, { "|km|", 1000 } };
	char word[60];
	snprintf(word, sizeof word, "|%s|", name);
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcasestr(units[i].names, word))
			return units[i].metres;
	return 0;
}

static double unit_of(const struct ground_raster *r, GDALRasterBandH band,
	const struct eco_ground_source *source, struct eco_notes *notes)
{
	const char *name = GDALGetRasterUnitType(band);
	double unit = name ? unit_named(name) : 0;
	if (source->unit_m > 0)
		return source->unit_m;
	if (name && name[0] != 0 && unit == 0)
		eco_note(notes, "%.200s: its heights are in \"%.40s\", which is not known here; taken as "
			"metres, else add \"unit\" to the ground", r->path, name);
	if (unit == 0)
		unit = r->crs_unit_m;
	if (unit > 0 && unit != 1)
		eco_note(notes, "%.200s: its heights are in units of %.9g m, as the file says", r->path,
			unit);
	return unit > 0 ? unit : 1;
}

static void meaning_of(struct meaning *m, const struct ground_raster *r, GDALRasterBandH band,
	const struct eco_ground_source *source, struct eco_notes *notes)
{
	int has_no_data = 0, has_scale = 0, has_offset = 0;
	double no_data = GDALGetRasterNoDataValue(band, &has_no_data);
	*m = (struct meaning){ .scale = GDALGetRasterScale(band, &has_scale),
		.offset = GDALGetRasterOffset(band, &has_offset), .unit_m = unit_of(r, band, source, notes) };
	if (!has_scale || !isfinite(m->scale) || m->scale == 0)
		m->scale = 1;
	if (!has_offset || !isfinite(m->offset))
		m->offset = 0;
	if (source->scale != 0)
		m->scale = source->scale;
	if (source->has_offset)
		m->offset = source->offset;
	if (source->has_nodata)
		m->holes[m->hole_count++] = source->nodata;
	if (has_no_data && !source->no_holes)
		m->holes[m->hole_count++] = no_data;
}

/* ---- Rows ---- */

struct rows {                        /* a row of values, and whether each counts */
	const struct ground_raster *raster;
	GDALRasterBandH band, mask;      /* mask: NULL if all count */
	double *raw;
	uint8_t *there;
};

static void rows_open(struct rows *rows, const struct ground_raster *r, GDALRasterBandH band, bool masked)
{
	int flags = GDALGetMaskFlags(band);
	*rows = (struct rows){ .raster = r, .band = band,
		.raw = eco_alloc((size_t)r->columns, sizeof *rows->raw),
		.there = eco_alloc((size_t)r->columns, 1) };
	if (masked && flags & (GMF_PER_DATASET | GMF_ALPHA))
		rows->mask = GDALGetMaskBand(band);
}

static void rows_read(struct rows *rows, int y)
{
	int columns = rows->raster->columns;
	memset(rows->there, 255, (size_t)columns);
	if (GDALRasterIO(rows->band, GF_Read, 0, y, columns, 1, rows->raw, columns, 1, GDT_Float64, 0, 0)
			!= CE_None || (rows->mask && GDALRasterIO(rows->mask, GF_Read, 0, y, columns, 1, rows->there, columns,
			1, GDT_Byte, 0, 0) != CE_None))
		eco_stop(ECO_BAD_INPUT, "%.200s: its heights cannot be read: %.250s", rows->raster->path,
			CPLGetLastErrorMsg()[0] != 0 ? CPLGetLastErrorMsg() : "GDAL gives no reason");
}

/* ---- Holes without a mark ---- */

static const double suspects[] = { 0, -1, -99, -999, -9999, -99999, -32768, -32767, 32767, 65535, 9999,
	99999 };
#define SUSPECTS (sizeof suspects / sizeof *suspects)
#define SPAN 4                       /* distinct values kept at either end */
#define STEEP 16.0                   /* steep: this many times the usual step between neighbours */
#define BUCKETS 256

struct census {
	/* steps: by binary logarithm */
	struct { uint64_t samples, borders, steps[BUCKETS]; double sum; } suspect[SUSPECTS];
	double lowest[SPAN], highest[SPAN];      /* distinct, the most extreme first */
	int lowest_count, highest_count;
	double steps_sum;
	uint64_t steps, samples;
	double first, last;              /* lowest and highest metres that count so far */
};

static int suspect_of(double raw)
{
	for (size_t i = 0; i < SUSPECTS; i++)
		if (raw == suspects[i])
			return (int)i;
	return -1;
}

static void keep_extreme(double *kept, int *count, double v, double sign)
{
	int at = 0;
	while (at < *count && kept[at] * sign < v * sign)
		at++;
	if (at == SPAN || (at < *count && kept[at] == v))
		return;
	if (*count < SPAN)
		++*count;
	memmove(&kept[at + 1], &kept[at], (size_t)(*count - 1 - at) * sizeof *kept);
	kept[at] = v;
}

static int bucket_of(double step)
{
	int exponent = 0;
	frexp(step, &exponent);
	return exponent < -BUCKETS / 2 ? 0 : exponent >= BUCKETS / 2 ? BUCKETS - 1 : exponent + BUCKETS / 2;
}

/* Counts the step between two neighbours that may both be heights. */
static void count_step(struct census *c, double a, double b)
{
	int x = suspect_of(a), y = suspect_of(b);
	double step = fabs(a - b);
	if (x < 0 && y < 0) {
		c->steps_sum += step;
		c->steps++;
		return;
	}
	if (x >= 0 && y >= 0)
		return;
	x = x >= 0 ? x : y;
	c->suspect[x].borders++;
	c->suspect[x].sum += step;
	c->suspect[x].steps[bucket_of(step)]++;
}

static void take_census(struct census *c, struct rows *rows, const struct meaning *m)
{
	int columns = rows->raster->columns;
	double *above = eco_alloc((size_t)columns, sizeof *above);
	for (int x = 0; x < columns; x++)
		above[x] = NAN;
	for (int y = 0; y < rows->raster->rows; y++) {
		rows_read(rows, y);
		for (int x = 0; x < columns; x++) {
			double v = rows->there[x] && isfinite(rows->raw[x]) && !is_hole(m, rows->raw[x])
				? rows->raw[x] : NAN;
			int s = suspect_of(v);
			if (!isnan(v)) {
				c->samples++;
				keep_extreme(c->lowest, &c->lowest_count, v, 1);
				keep_extreme(c->highest, &c->highest_count, v, -1);
				if (s >= 0)
					c->suspect[s].samples++;
				if (x > 0 && rows->there[x - 1] && isfinite(rows->raw[x - 1])
						&& !is_hole(m, rows->raw[x - 1]))
					count_step(c, rows->raw[x - 1], v);
				if (!isnan(above[x]))
					count_step(c, above[x], v);
			}
			above[x] = v;
		}
	}
	free(above);
}

/* Whether a value that programs write is steep wherever it meets terrain. */
static bool stands_out(const struct census *c, size_t s)
{
	double usual = c->steps > 0 ? c->steps_sum / (double)c->steps : 0;
	uint64_t gentle = 0;
	int limit = bucket_of(STEEP / 4 * usual);
	if (c->suspect[s].samples == 0 || c->suspect[s].borders == 0 || c->steps == 0 || usual <= 0)
		return false;
	for (int i = 0; i < limit; i++)
		gentle += c->suspect[s].steps[i];
	return c->suspect[s].sum > STEEP * usual * (double)c->suspect[s].borders
		&& gentle * 50 <= c->suspect[s].borders;
}

/* Finds the most extreme value not yet dropped, if it is further from the next one than that is from the
 * other end, and many steps away. */
static bool lies_beyond(const struct meaning *m, const struct census *c, const double *kept, int count,
	double other_end, double *value)
{
	double usual = c->steps > 0 ? c->steps_sum / (double)c->steps : 0;
	int at = 0, next;
	while (at < count && is_hole(m, kept[at]))
		at++;
	next = at + 1;
	while (next < count && is_hole(m, kept[next]))
		next++;
	if (next >= count)
		return false;
	*value = kept[at];
	return fabs(kept[next] - kept[at]) > fmax(fabs(other_end - kept[next]), STEEP * usual)
		&& other_end != kept[next];
}

static double end_of(const struct meaning *m, const double *kept, int count)
{
	int at = 0;
	while (at + 1 < count && is_hole(m, kept[at]))
		at++;
	return kept[at];
}

static void add_hole(struct meaning *m, double value, const char *path, uint64_t samples,
	struct eco_notes *notes)
{
	char many[40] = "samples";
	if (m->hole_count >= HOLES_MAX)
		return;
	m->holes[m->hole_count++] = value;
	if (samples > 0)
		snprintf(many, sizeof many, "%llu sample%s", (unsigned long long)samples,
			samples == 1 ? "" : "s");
	eco_note(notes, "%.200s: %s of %.9g stand out from all around, and are taken for holes; if they "
		"are heights, add \"nodata\": null to "
		"the ground, if they are holes, \"nodata\": %.9g", path, many, value, value);
}

static void find_holes(struct meaning *m, struct rows *rows, struct eco_notes *notes)
{
	const char *path = rows->raster->path;
	struct census *c = eco_alloc(1, sizeof *c);
	double value;
	take_census(c, rows, m);
	for (size_t s = 0; s < SUSPECTS; s++)
		if (stands_out(c, s))
			add_hole(m, suspects[s], path, c->suspect[s].samples, notes);
	for (int n = 0; n < SPAN - 1 &&
		(lies_beyond(m, c, c->lowest, c->lowest_count, end_of(m, c->highest, c->highest_count),
			 &value) ||
			lies_beyond(m, c, c->highest, c->highest_count, end_of(m, c->lowest, c->lowest_count),
				&value));
		n++) {
		int s = suspect_of(value);
		add_hole(m, value, path, s >= 0 ? c->suspect[s].samples : 0, notes);
	}
	free(c);
}

/* ---- Averaging ---- */

struct sums { double *sum, *weight; };

/* Adds a row's metres to columns of `ratio` pixels each, weighted by the share of each pixel in the
 * column. */
static void add_row(const struct sums *s, const struct rows *rows, const struct meaning *m, uint32_t columns,
	double ratio, double share)
{
	for (uint32_t c = 0; c < columns; c++) {
		double from = c * ratio, to = (c + 1) * ratio;
		int end = (int)ceil(to - 1e-9);
		for (int x = (int)floor(from + 1e-9); x < end && x < rows->raster->columns; x++) {
			double metres = rows->there[x] ? metres_of(m, rows->raw[x]) : NAN;
			double part = fmin(x + 1.0, to) - fmax(x, from);
			if (isnan(metres))
				continue;
			s->sum[c] += part * share * metres;
			s->weight[c] += part * share;
		}
	}
}

static void average(struct ground_samples *out, struct rows *rows, const struct meaning *m)
{
	const struct sums sums = { eco_alloc(out->columns, sizeof(double)), eco_alloc(out->columns, sizeof(double)) }, *s = &sums;
	double ratio_x = (double)rows->raster->columns / out->columns,
		ratio_y = (double)rows->raster->rows / out->rows;
	int held = -1;
	for (uint32_t r = 0; r < out->rows; r++) {
		double from = r * ratio_y, to = (r + 1) * ratio_y;
		int end = (int)ceil(to - 1e-9);
		memset(s->sum, 0, out->columns * sizeof *s->sum);
		memset(s->weight, 0, out->columns * sizeof *s->weight);
		for (int y = (int)floor(from + 1e-9); y < end && y < rows->raster->rows; y++) {
			if (y != held)
				rows_read(rows, y);
			held = y;
			add_row(s, rows, m, out->columns, ratio_x, fmin(y + 1.0, to) - fmax(y, from));
		}
		for (uint32_t c = 0; c < out->columns; c++)
			out->metres[(size_t)r * out->columns + c] = s->weight[c] > 0
				? (float)(s->sum[c] / s->weight[c]) : NAN;
	}
}

static void say_range(const struct ground_samples *samples, const char *path, struct eco_notes *notes)
{
	double low = INFINITY, high = -INFINITY;
	for (size_t i = 0; i < (size_t)samples->columns * samples->rows; i++) {
		low = samples->metres[i] < low ? (double)samples->metres[i] : low;
		high = samples->metres[i] > high ? (double)samples->metres[i] : high;
	}
	if (low == high)
		eco_note(notes, "%.200s: every height is %.9g m; is it the right band?", path, low);
	else if (high > HEIGHT_ODD_M || low < -DEPTH_ODD_M)
		eco_note(notes, "%.200s: heights from %.9g to %.9g m are not of this Earth; are "
			"\"scale\", \"offset\" or \"unit\" missing in the ground?", path, low, high);
}

static GDALRasterBandH pick_band(const struct ground_raster *r, const struct eco_ground_source *source,
	struct eco_notes *notes)
{
	int count = GDALGetRasterCount(r->file), wanted = source->band > 0 ? (int)source->band : 1;
	if (wanted > count)
		eco_stop(ECO_BAD_INPUT, "%.300s: it has %d band%s, not a band %d", r->path, count, count == 1 ? "" : "s",
			wanted);
	GDALRasterBandH band = GDALGetRasterBand(r->file, wanted);
	if (GDALDataTypeIsComplex(GDALGetRasterDataType(band)))
		eco_stop(ECO_BAD_INPUT, "%.300s: band %d holds complex numbers, not heights", r->path, wanted);
	if (source->band > 0)
		return band;
	if (GDALGetRasterColorInterpretation(band) == GCI_RedBand || GDALGetRasterColorTable(band))
		eco_stop(ECO_BAD_INPUT, "%.300s: it holds colours, not heights; if one of its bands is heights, say which: "
			"\"band\": 1", r->path);
	const char *name = GDALGetDescription(band);
	if (count > 1)
		eco_note(notes, "%.200s: band 1 of %d%s%.60s%s is taken for heights; for another add "
			"\"band\" to the ground", r->path, count, name[0] != 0 ? " (" : "", name,
			name[0] != 0 ? ")" : "");
	return band;
}

void ground_samples_read(struct ground_samples *samples, const struct ground_raster *raster,
	const struct eco_ground_source *source, uint32_t columns, uint32_t rows_wanted, struct eco_notes *notes)
{
	struct rows rows;
	struct meaning meaning;
	GDALRasterBandH band = pick_band(raster, source, notes);
	*samples = (struct ground_samples){ .columns = columns, .rows = rows_wanted };
	memcpy(samples->transform, raster->transform, sizeof samples->transform);
	for (int i = 0; i < 2; i++) {
		samples->transform[3 * i + 1] *= (double)raster->columns / columns;
		samples->transform[3 * i + 2] *= (double)raster->rows / rows_wanted;
	}
	samples->metres = eco_alloc((size_t)columns * rows_wanted, sizeof *samples->metres);
	rows_open(&rows, raster, band, !source->no_holes);
	meaning_of(&meaning, raster, band, source, notes);
	if (!source->has_nodata && !source->no_holes)
		find_holes(&meaning, &rows, notes);
	average(samples, &rows, &meaning);
	say_range(samples, raster->path, notes);
}
