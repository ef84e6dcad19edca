/* Rasters become the ground's image: the tree of squares, and what each square shows. gdal_colors.c reads
 * one raster's colours. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/ground/gdal_ground.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/ground/gdal_module.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
#define PIXEL_M 0.00076706               /* 2 tan(22.5 degrees) / 1080, 1 m away */
#define TILES_MAX 4096u
#define EXTENT_M_MAX 1e7
#define BEYOND_M 5.0                     /* a crown over the image's border is not worth a word */
#define FADE (SIDE / 32)                 /* texels of the root */

struct job {
	struct eco_ground_image_job *asked;
	const struct eco_ground_image_options *options;
	struct ground_scene scene;
	struct ground_colors *rasters; uint32_t count;
	const char *name;                        /* of the first file, for messages */
	double low[2], high[2], finest_m;        /* of all rasters, in the scene; infinite: none */
	double drawn_m;                          /* texels that the drawing is worth; infinite: none */
	double range[2];                         /* black and white, once one is not of bytes */
	double pixel_m;                          /* PIXEL_M, or more for fewer squares */
	float *fade; /* SIDE x SIDE, of the root, rows from the north: 0 clear .. 1 */
	uint8_t *layer;                          /* room for what one raster shows of a square */
	FILE *out;
	struct eco_error *error;
};

struct square { double low[2], texel_m; uint32_t depth; };

static struct square root_of(const struct job *job)
{
	const struct ground_image_head *head = &job->asked->head;
	return (struct square){ { head->low[0], head->low[1] }, head->texel_m, 0 };
}

static struct square quarter_of(const struct square *s, uint32_t quarter)
{
	struct eco_list list = { .grid_origin = { s->low[0], s->low[1] },
		.grid_step = { s->texel_m, s->texel_m } };
	eco_ground_image_quarter(&list, quarter);
	return (struct square){ { list.grid_origin[0], list.grid_origin[1] }, list.grid_step[0],
		s->depth + 1 };
}

/* ---- The tree ---- */

static double gap(double low, double high, double from, double to)
{
	return fmax(0, fmax(from - high, low - to));
}

/* Metres between a square and a box; 0 where they touch. */
static double apart(const struct square *s, const double low[2], const double high[2])
{
	double side = SIDE * s->texel_m, x = gap(s->low[0], s->low[0] + side, low[0], high[0]),
		y = gap(s->low[1], s->low[1] + side, low[1], high[1]);
	return sqrt(x * x + y * y);
}

static bool splits(const struct job *job, const struct square *s)
{
	const struct eco_ground_image_options *o = job->options;
	double away = o->low[0] <= o->high[0] ? apart(s, o->low, o->high) : 0,
	       high[2] = { s->low[0] + SIDE * s->texel_m, s->low[1] + SIDE * s->texel_m };
	if (s->depth + 2 >= GROUND_IMAGE_DEPTH || !(s->texel_m > 1.0001 * job->pixel_m * fmax(1, away)))
		return false;
	return (s->texel_m > 1.0001 * job->finest_m && apart(s, job->low, job->high) <= 0) ||
		(s->texel_m > 1.0001 * job->drawn_m && o->drawing->touches(o->drawing->ctx, s->low, high));
}

/* Squares that are not split; stops beyond `most`. */
static uint64_t count_squares(const struct job *job, const struct square *s, uint64_t most)
{
	uint64_t count = 0;
	if (!splits(job, s))
		return 1;
	for (uint32_t q = 0; q < 4 && count <= most; q++) {
		struct square quarter = quarter_of(s, q);
		count += count_squares(job, &quarter, most - count);
	}
	return count;
}

/* The least width of texels among the plants with so few squares. */
static void bound_squares(struct job *job)
{
	uint64_t most = job->options->tiles_max ? job->options->tiles_max : TILES_MAX;
	double finest = fmin(job->finest_m, job->drawn_m), doubled = 1;
	const struct square root = root_of(job);
	while (count_squares(job, &root, most) > most) {
		job->finest_m *= 2;
		job->drawn_m *= 2;
		job->pixel_m *= 2;
		doubled *= 2;
	}
	if (doubled > 1 && job->count)
		eco_note(job->scene.notes,
			"%.200s: texels of %.3g m, averaged up to %.3g m, as an image has %llu squares of %u "
			"x %u texels at most; cut out the part that is needed, or say \"texel_m\"",
			job->name, finest, finest * doubled, (unsigned long long)most, SIDE,
			SIDE);
}

/* The root is a square of whole squares of the finest texels, from the south-west corner of the rasters and the drawing. */
static void find_root(struct job *job)
{
	struct ground_image_head *head = &job->asked->head;
	const struct eco_ground_drawing *drawing = job->options->drawing;
	double extent = 0, asked = fmax(job->options->source->texel_m, PIXEL_M), low[2], high[2];
	for (int k = 0; k < 2; k++) {
		job->low[k] = INFINITY;
		job->high[k] = -INFINITY;
	}
	job->finest_m = INFINITY;
	for (uint32_t i = 0; i < job->count; i++)
		for (int k = 0; k < 2; k++) {
			const struct ground_raster *r = &job->rasters[i].raster;
			job->low[k] = fmin(job->low[k], r->low[k] - job->options->origin[k]);
			job->high[k] = fmax(job->high[k], r->high[k] - job->options->origin[k]);
			job->finest_m = fmin(job->finest_m, r->step[k]);
		}
	for (int k = 0; k < 2; k++) {
		low[k] = fmin(job->low[k], drawing ? drawing->low[k] : INFINITY);
		high[k] = fmax(job->high[k], drawing ? drawing->high[k] : -INFINITY);
		extent = fmax(extent, high[k] - low[k]);
	}
	job->drawn_m = drawing ? fmax(drawing->texel_m, asked) : INFINITY;
	if (!(extent > 0) || extent > EXTENT_M_MAX || !(job->finest_m > 0))
		eco_stop(ECO_DAMAGED, "%.200s: an image of %g m with pixels of %g m is impossible", job->name, extent,
			job->finest_m);
	job->finest_m = fmax(job->finest_m, asked);
	head->texel_m = fmin(job->finest_m, job->drawn_m);
	while (SIDE * head->texel_m < extent)
		head->texel_m *= 2;
	memcpy(head->low, low, sizeof head->low);
}

/* By boxes: whether the image reaches the plants. */
static void doubt_overlap(struct job *job)
{
	const struct eco_ground_image_options *o = job->options;
	double x = gap(job->low[0], job->high[0], o->low[0], o->high[0]),
		y = gap(job->low[1], job->high[1], o->low[1], o->high[1]);
	bool lacks = false;
	for (int k = 0; k < 2; k++)
		lacks = lacks || fmax(o->high[k] - job->high[k], job->low[k] - o->low[k])
			> fmax(BEYOND_M, job->finest_m);
	if (!lacks || !(o->low[0] <= o->high[0]))
		return;
	eco_note(job->scene.notes,
		"%.200s: the image lies from %.0f, %.0f to %.0f, %.0f in the scene and does not "
		"reach %s plants%s", job->name, job->low[0], job->low[1], job->high[0],
		job->high[1],
		x + y > 0 ? "any" : "all", x + y > 0
		? "; look at its CRS and at the scene's \"crs\" and \"origin\"" : "");
}

/* ---- Squares ---- */

/* Colours of a square: of the first raster that has one. */
static void look_at(struct job *job, const struct square *s, uint8_t *rgba)
{
	const double *o = job->options->origin;
	const double bounds[4] = { s->low[0] + o[0], s->low[1] + o[1], s->low[0] + o[0] + SIDE * s->texel_m,
		s->low[1] + o[1] + SIDE * s->texel_m };
	memset(rgba, 0, ECO_GROUND_IMAGE_BYTES);
	for (uint32_t i = 0; i < job->count; i++) {
		const struct ground_raster *r = &job->rasters[i].raster;
		if (r->low[0] >= bounds[2] || r->high[0] <= bounds[0] || r->low[1] >= bounds[3]
				|| r->high[1] <= bounds[1])
			continue;
		ground_colors_read(&job->rasters[i], &job->scene, bounds, job->layer);
		for (size_t t = 0; t < ECO_GROUND_IMAGE_BYTES; t += 4)
			if (job->layer[t + 3] > rgba[t + 3])
				memcpy(rgba + t, job->layer + t, 4);
	}
}

/* Texels of the root by how far they are from one that is clear, or from its border, at most FADE: three
 * steps of a distance are 3 across and 4 diagonally (Borgefors 1986, chamfer 3-4). */
static void measure_fade(const uint8_t *rgba, float *fade)
{
	const int side = (int)SIDE, most = 3 * (int)FADE;
	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < side * side; k++) {
			int i = pass ? side * side - 1 - k : k, x = i % side, y = i / side, at = most,
			    back = pass ? 1 : -1;
			bool clear = rgba[4 * (size_t)i + 3] < 128;
			if (pass)
				at = (int)fade[i];
			for (int n = 0; n < 4 && !clear; n++) {
				int u = x + (n == 0 ? back : n - 2), v = y + (n == 0 ? 0 : back);
				bool inside = u >= 0 && v >= 0 && u < side && v < side;
				int there =
					(inside ? (int)fade[v * side + u] : 0) + (n == 0 || n == 2 ? 3 : 4);
				at = there < at ? there : at;
			}
			fade[i] = (float)(clear ? 0 : at);
		}
	for (int i = 0; i < side * side; i++) {
		float t = fade[i] > 3 ? (fade[i] - 3) / (float)(most - 3) : 0;
		fade[i] = t * t * (3 - 2 * t);
	}
}

static float fade_at(const struct job *job, double x, double y)
{
	x = fmin(fmax(x - 0.5, 0), SIDE - 1.001);
	y = fmin(fmax(y - 0.5, 0), SIDE - 1.001);
	uint32_t i = (uint32_t)x, j = (uint32_t)y;
	float u = (float)(x - i), v = (float)(y - j);
	const float *at = job->fade + (size_t)j * SIDE + i, *below = at + SIDE;
	return (at[0] + u * (at[1] - at[0])) * (1 - v) + (below[0] + u * (below[1] - below[0])) * v;
}

/* Rows from the north: of the root's texels, where the square's are. */
static void fade_out(const struct job *job, const struct square *s, uint8_t *rgba)
{
	const struct square root = root_of(job);
	double scale = s->texel_m / root.texel_m, west = (s->low[0] - root.low[0]) / root.texel_m,
		north = SIDE - (s->low[1] - root.low[1]) / root.texel_m - SIDE * scale;
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++) {
			uint8_t *alpha = &rgba[4 * ((size_t)y * SIDE + x) + 3];
			if (*alpha)
				*alpha = (uint8_t)(0.5f + *alpha * fade_at(job, west + (x + 0.5) * scale,
					north + (y + 0.5) * scale));
		}
}

static void check_pipe(const struct job *job, bool good)
{
	if (!good)
		eco_stop(ECO_IO, "%.300s: the image could not be handed over: %s", job->name, strerror(errno));
}

static void send(struct job *job, const struct square *s, uint8_t *rgba)
{
	const struct eco_ground_drawing *drawing = job->options->drawing;
	bool split = splits(job, s);
	check_pipe(job, fputc(split, job->out) != EOF);
	for (uint32_t q = 0; q < 4 && split; q++) {
		struct square quarter = quarter_of(s, q);
		send(job, &quarter, rgba);
	}
	if (split)
		return;
	look_at(job, s, rgba);
	if (job->count)
		fade_out(job, s, rgba);
	if (drawing)
		eco_check(drawing->paint(drawing->ctx, s->low, s->texel_m, rgba, job->error));
	check_pipe(job, fwrite(rgba, ECO_GROUND_IMAGE_BYTES, 1, job->out) == 1);
}

/* ---- The whole ---- */

static void open_rasters(struct job *job)
{
	const struct eco_ground_image_source *source = job->options->source;
	ground_scene_check(&job->scene);
	job->rasters = eco_alloc(source->file_count + 1u, sizeof *job->rasters);
	for (uint32_t i = 0; i < source->file_count; i++) {
		struct ground_colors *colors = &job->rasters[job->count++];
		colors->raster.path = source->files[i];
		ground_raster_open(&colors->raster, &job->scene);
		ground_colors_open(colors, source, job->range, job->scene.notes);
		ground_raster_place(&colors->raster, &job->scene);
		ground_colors_locate(colors, source);
	}
}

static void read_image(void *ctx)
{
	struct job *job = ctx;
	open_rasters(job);
	find_root(job);
	if (job->count)
		doubt_overlap(job);
	bound_squares(job);
	check_pipe(job, fwrite(&job->asked->head, sizeof job->asked->head, 1, job->out) == 1);
	if (job->asked->only_look)
		return;
	uint8_t *rgba = eco_alloc(ECO_GROUND_IMAGE_BYTES, 1);
	const struct square root = root_of(job);
	job->layer = eco_alloc(ECO_GROUND_IMAGE_BYTES, 1);
	job->fade = eco_alloc(SIDE * SIDE, sizeof *job->fade);
	look_at(job, &root, rgba);
	measure_fade(rgba, job->fade);
	send(job, &root, rgba);
}

enum eco_code gdal_image_read(struct eco_ground_image_job *asked, FILE *out, struct eco_error *error)
{
	const struct eco_ground_image_options *o = asked->options;
	struct job job = { .asked = asked, .options = o, .out = out, .error = error, .pixel_m = PIXEL_M,
		.name = o->source->file_count ? o->source->files[0] : "\"draw\"",
		.range = { o->source->range[0], o->source->range[1] },
		.scene = { .scene_crs = o->scene_crs, .stated = o->source->crs, .has_place = o->source->has_place,
		.corner = o->source->corner, .pixel = o->source->pixel, .notes = &asked->head.notes,
		.where = { "\"image\": {\"file\": ...", "}" }, .what = "image" } };
	CPLPushErrorHandler(CPLQuietErrorHandler);
	CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
	GDALAllRegister();
	return eco_try(read_image, &job, error);
}
