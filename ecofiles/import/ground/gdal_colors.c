/* Colours of a raster: the bands that hold them, or the colours of its classes; and the texels of a square,
 * which GDAL warps. Colours are mixed where texels are wider than pixels. Classes are taken as they
 * are, four a texel, and then their colours are mixed. */
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/import/ground/gdal_ground.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_utils.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE ECO_GROUND_IMAGE_SIDE
#define CLASS_SAMPLES 2                  /* along each side of a texel */
#define RANGE_SAMPLES 256                /* along each side of a raster whose range is guessed */
#define RANGE_CUT 0.005                  /* share of its values below black, and above white */

/* ---- What it shows ---- */

ECO_ORDER(by_number, struct eco_ground_class, ->number)

static const struct eco_ground_class *class_of(const struct ground_colors *c, double value)
{
	struct eco_ground_class key = { .number = (int32_t)value };
	return key.number != value ? NULL
		: bsearch(&key, c->classes, c->class_count, sizeof key, by_number);
}

/* The scene's classes, then those of the file's own table that the scene does not name. */
static void gather_classes(struct ground_colors *c, const struct eco_ground_image_source *source)
{
	GDALColorTableH table = GDALGetRasterColorTable(GDALGetRasterBand(c->raster.file, 1));
	int own = table ? GDALGetColorEntryCount(table) : 0;
	c->classes = eco_alloc((size_t)source->class_count + (size_t)own + 1, sizeof *c->classes);
	c->class_count = source->class_count;
	if (source->class_count)
		memcpy(c->classes, source->classes, source->class_count * sizeof *c->classes);
	for (int i = 0; i < own; i++) {
		GDALColorEntry entry;
		struct eco_ground_class key = { .number = i };
		GDALGetColorEntryAsRGB(table, i, &entry);
		if (source->class_count && bsearch(&key, source->classes, source->class_count, sizeof key,
				by_number))
			continue;
		c->classes[c->class_count++] = (struct eco_ground_class){ i, { (uint8_t)entry.c1,
			(uint8_t)entry.c2, (uint8_t)entry.c3 }, entry.c4 == 0 };
	}
	qsort(c->classes, c->class_count, sizeof *c->classes, by_number);
}

static bool is_whole(GDALDataType type)
{
	return type == GDT_Byte || type == GDT_UInt16 || type == GDT_Int16 || type == GDT_UInt32
		|| type == GDT_Int32;
}

static void find_bands(struct ground_colors *c, int count)
{
	static const GDALColorInterp wanted[3] = { GCI_RedBand, GCI_GreenBand, GCI_BlueBand };
	bool named[3] = { false };
	for (int b = 1; b <= count; b++) {
		GDALColorInterp is = GDALGetRasterColorInterpretation(GDALGetRasterBand(c->raster.file, b));
		for (int k = 0; k < 3; k++)
			if (is == wanted[k]) {
				c->bands[k] = b;
				named[k] = true;
			}
		if (is == GCI_AlphaBand)
			c->alpha = b;
	}
	bool grey = count - (c->alpha > 0) < 3;
	for (int k = 0; k < 3 && !(named[0] && named[1] && named[2]); k++)
		c->bands[k] = grey ? 1 : k + 1;
}

/* ---- Numbers that are no bytes ---- */

ECO_ORDER(by_value, float, [0])

/* Values of a band all over the raster, without those that are none or clear; returns how many. `alpha` has
 * room for as many. */
static size_t sample_band(const struct ground_colors *c, int number, float *values, float *alpha)
{
	GDALRasterBandH band = GDALGetRasterBand(c->raster.file, number);
	int columns = GDALGetRasterXSize(c->raster.file), rows = GDALGetRasterYSize(c->raster.file),
		across = columns < RANGE_SAMPLES ? columns : RANGE_SAMPLES,
		down = rows < RANGE_SAMPLES ? rows : RANGE_SAMPLES, has_nodata = 0;
	double nodata = GDALGetRasterNoDataValue(band, &has_nodata);
	size_t count = 0;
	if (GDALRasterIO(band, GF_Read, 0, 0, columns, rows, values, across, down, GDT_Float32, 0, 0) !=
			CE_None ||
		(c->alpha &&
			GDALRasterIO(GDALGetRasterBand(c->raster.file, c->alpha), GF_Read, 0, 0, columns,
				rows, alpha, across, down, GDT_Float32, 0, 0) != CE_None))
		return 0;
	for (size_t i = 0; i < (size_t)across * (size_t)down; i++)
		if (isfinite(values[i]) && !(c->alpha && !(alpha[i] > 0)) &&
			!(has_nodata && (double)values[i] == nodata) &&
			!(c->has_nodata && (double)values[i] == c->nodata))
			values[count++] = values[i];
	return count;
}

/* Black and white of the three bands together, so that hues stay. */
static void guess_range(const struct ground_colors *c, double range[2], struct eco_notes *notes)
{
	float *values = eco_alloc(4 * RANGE_SAMPLES * RANGE_SAMPLES, sizeof *values);
	size_t count = 0;
	for (int k = 0; k < 3; k++)
		count += sample_band(c, c->bands[k], values + count,
			values + 3 * RANGE_SAMPLES * RANGE_SAMPLES);
	if (count) {
		qsort(values, count, sizeof *values, by_value);
		range[0] = (double)values[(size_t)(RANGE_CUT * (double)(count - 1))];
		range[1] = (double)values[(size_t)((1 - RANGE_CUT) * (double)(count - 1))];
	}
	free(values);
	if (!(range[0] < range[1]))
		eco_stop(ECO_BAD_INPUT,
			"%.200s: %s; say which of its values are black and white: "
			"\"image\": {\"file\": ..., \"range\": [0, 65535]}",
			c->raster.path, count ? "all its pixels are alike" : "it has no pixel with a value");
	eco_note(notes,
		"%.200s: its bands hold %s; %.6g is taken for black and %.6g for white, which leaves "
		"out the darkest and the brightest 1/200 (\"range\": [black, white] beside \"file\" says "
		"others)",
		c->raster.path,
		GDALGetDataTypeName(GDALGetRasterDataType(GDALGetRasterBand(c->raster.file, c->bands[0]))),
		range[0], range[1]);
}

/* Colours are bytes, or three bands of other numbers; one band of them may be heights or classes as well. */
static void find_range(struct ground_colors *c, bool said, double range[2], struct eco_notes *notes)
{
	GDALDataType other = GDT_Byte;
	for (int k = 0; k < 3; k++) {
		GDALDataType type = GDALGetRasterDataType(GDALGetRasterBand(c->raster.file, c->bands[k]));
		if (GDALDataTypeIsComplex(type))
			eco_stop(ECO_BAD_INPUT, "%.200s: band %d holds %s, which is no colour", c->raster.path, c->bands[k],
				GDALGetDataTypeName(type));
		other = type == GDT_Byte ? other : type;
	}
	c->by_range = said || other != GDT_Byte;
	if (!c->by_range)
		return;
	if (!(range[0] < range[1]) && c->bands[0] == c->bands[1])
		eco_stop(ECO_BAD_INPUT,
			"%.200s: it has one band of %s: heights, classes or grey? If "
			"they are classes, give their colours: \"image\": {\"file\": ..., \"classes\": "
			"{\"1\": \"#4c7300\"}}; if grey, black and white: \"range\": [0, 65535]",
			c->raster.path, GDALGetDataTypeName(other));
	if (!(range[0] < range[1]))
		guess_range(c, range, notes);
	memcpy(c->range, range, sizeof c->range);
}

void ground_colors_open(struct ground_colors *c, const struct eco_ground_image_source *source,
	double range[2], struct eco_notes *notes)
{
	const struct ground_raster *r = &c->raster;
	GDALRasterBandH first = GDALGetRasterBand(r->file, 1);
	GDALDataType type = GDALGetRasterDataType(first);
	int count = GDALGetRasterCount(r->file);
	c->by_class = source->class_count > 0 || GDALGetRasterColorTable(first);
	c->has_nodata = source->has_nodata;
	c->nodata = source->nodata;
	if (c->by_class && count != 1)
		eco_stop(ECO_BAD_INPUT,
			"%.200s: it has %d bands; a raster of classes has one, with "
			"their numbers. Leave out \"classes\" if its bands are colours",
			r->path, count);
	if (c->by_class && !is_whole(type))
		eco_stop(ECO_BAD_INPUT, "%.200s: its values are %s; numbers of classes are whole", r->path,
			GDALGetDataTypeName(type));
	if (c->by_class) {
		gather_classes(c, source);
	} else {
		find_bands(c, count);
		find_range(c, source->has_range, range, notes);
	}
}

/* ---- A square ---- */

/* A place that the scene states goes into a copy that has no pixels of its own. */
void ground_colors_locate(struct ground_colors *c, const struct eco_ground_image_source *source)
{
	struct ground_raster *r = &c->raster;
	char **arguments = CSLAddString(CSLAddString(NULL, "-of"), "VRT"), *wkt = NULL, text[40];
	int usage = 0;
	if (!source->crs && !source->has_place)
		return;
	if (r->crs && OSRExportToWkt(r->crs, &wkt) == OGRERR_NONE)
		arguments = CSLAddString(CSLAddString(arguments, "-a_srs"), wkt);
	const double *t = r->transform,
		     corners[4] = { t[0], t[3], t[0] + t[1] * r->columns, t[3] + t[5] * r->rows };
	if (source->has_place)
		arguments = CSLAddString(arguments, "-a_ullr");
	for (int i = 0; i < 4 && source->has_place; i++) {
		snprintf(text, sizeof text, "%.17g", corners[i]);
		arguments = CSLAddString(arguments, text);
	}
	GDALTranslateOptions *options = GDALTranslateOptionsNew(arguments, NULL);
	r->file = options ? GDALTranslate("", r->file, options, &usage) : NULL;
	ground_gdal_check(r->file, r->path, "it cannot be put where the scene says");
}

static GDALDatasetH warp(const struct ground_colors *c, const struct ground_scene *scene,
	const double bounds[4], int side)
{
	const char *how[11] = { "-dstalpha", "-et", "0.125", "-r", c->by_class ? "near" : "bilinear" };
	int count = 5;
	if (c->by_range) {
		how[count++] = "-ot";
		how[count++] = "Float32";
	}
	if (c->has_nodata) {
		how[count++] = "-srcnodata";
		how[count++] = CPLSPrintf("%.17g", c->nodata);
	}
	return ground_warp(c->raster.path, c->raster.file, c->raster.crs ? scene->crs : NULL, bounds,
		(const int[2]){ side, side }, how);
}

static void read_band(const struct ground_colors *c, GDALDatasetH from, int band, int side, void *to, GDALDataType type,
	int pixel)
{
	ground_gdal_check(GDALRasterIO(GDALGetRasterBand(from, band), GF_Read, 0, 0, side, side, to, side, side, type,
		pixel, 0) == CE_None, c->raster.path, c->by_class ? "its classes cannot be read" : "its colours cannot be read");
}

static _Noreturn void no_class(const struct ground_colors *c, const double bounds[4], int at, double value)
{
	const int side = SIDE * CLASS_SAMPLES;
	double step = (bounds[2] - bounds[0]) / side;
	eco_stop(ECO_BAD_INPUT,
		"%.200s: class %.0f, at %.1f, %.1f, has no colour; add it to the "
		"scene's \"ground\": {\"image\": {..., \"classes\": {\"%.0f\": \"#4c7300\"}}}, or null in "
		"place "
		"of a colour to leave it out",
		c->raster.path, value, bounds[0] + (at % side + 0.5) * step,
		bounds[3] - (at / side + 0.5) * step, value);
}

/* The mean of the colours of a texel's classes; clear ones have none. */
static void mix_classes(const struct ground_colors *c, const double bounds[4], const double *values,
	const uint8_t *alpha, uint8_t *rgba)
{
	const int side = SIDE * CLASS_SAMPLES;
	for (int t = 0; t < (int)(SIDE * SIDE); t++) {
		uint32_t sum[3] = { 0 }, shown = 0;
		for (int k = 0; k < CLASS_SAMPLES * CLASS_SAMPLES; k++) {
			int at = (t / (int)SIDE * CLASS_SAMPLES + k / CLASS_SAMPLES) * side
				+ t % (int)SIDE * CLASS_SAMPLES + k % CLASS_SAMPLES;
			if (!alpha[at])
				continue;
			const struct eco_ground_class *class = class_of(c, values[at]);
			if (!class)
				no_class(c, bounds, at, values[at]);
			for (int i = 0; i < 3 && !class->clear; i++)
				sum[i] += class->rgb[i];
			shown += !class->clear;
		}
		for (uint32_t i = 0; i < 3 && shown; i++)
			rgba[4 * t + (int)i] = (uint8_t)((sum[i] + shown / 2) / shown);
		rgba[4 * t + 3] = (uint8_t)(255 * shown / (CLASS_SAMPLES * CLASS_SAMPLES));
	}
}

static void read_classes(const struct ground_colors *c, const struct ground_scene *scene,
	const double bounds[4], uint8_t *rgba)
{
	const int side = SIDE * CLASS_SAMPLES;
	GDALDatasetH from = warp(c, scene, bounds, side);
	double *values = eco_alloc((size_t)side * side, sizeof *values);
	uint8_t *alpha = eco_alloc((size_t)side * side, 1);
	read_band(c, from, 1, side, values, GDT_Float64, 0);
	read_band(c, from, 2, side, alpha, GDT_Byte, 0);
	mix_classes(c, bounds, values, alpha, rgba);
	free(values);
	free(alpha);
	GDALClose(from);
}

/* Channel k of `rgba`, of numbers that are no bytes. */
static void read_range(const struct ground_colors *c, GDALDatasetH from, int k, uint8_t *rgba)
{
	float *values = eco_alloc(SIDE * SIDE, sizeof *values);
	read_band(c, from, c->bands[k], SIDE, values, GDT_Float32, 0);
	for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
		double t = ((double)values[i] - c->range[0]) / (c->range[1] - c->range[0]);
		rgba[4 * i + (size_t)k] = (uint8_t)(t > 0 ? 255 * fmin(t, 1) + 0.5 : 0);
	}
	free(values);
}

void ground_colors_read(const struct ground_colors *c, const struct ground_scene *scene, const double bounds[4],
	uint8_t *rgba)
{
	memset(rgba, 0, ECO_GROUND_IMAGE_BYTES);
	if (c->by_class) {
		read_classes(c, scene, bounds, rgba);
		return;
	}
	GDALDatasetH from = warp(c, scene, bounds, SIDE);
	for (int k = 0; k < 3; k++)
		if (c->by_range)
			read_range(c, from, k, rgba);
		else
			read_band(c, from, c->bands[k], SIDE, rgba + k, GDT_Byte, 4);
	/* the warp's own alpha comes last, or takes the place of the file's */
	read_band(c, from, c->alpha ? c->alpha : GDALGetRasterCount(from), SIDE, rgba + 3, GDT_Byte, 4);
	GDALClose(from);
}
