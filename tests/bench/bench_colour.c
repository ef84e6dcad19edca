/* Colours of a plan against those of full detail, drawn by OpenGL and in software.
 *
 *   rms          root mean square of sRGB bytes / 255 over the pixels that either covers
 *   tone         mean light over covered pixels as an sRGB byte / 255, less that of full detail
 *   perceptual   pixels that a person would call different (Yee 2001 in OpenImageIO, as `idiff -p`: by hue,
 *                image.h), over covered ones
 *
 * A variant of the same plan shows the worth of prefiltering: with flat colours (one colour a list without a
 * texture; for cut-outs the plain mean of the texture's bytes, clear texels included). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gl.h"
#include "client-min/view_reference.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/image.h"
#include "lod/light.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_shots.h"

#define VIEWS_QUICK 1u
#define VIEWS_FULL 4u
#define NEAR 300                         /* squared distance of colours, bytes: 10 in each channel */
/* more at full detail takes OpenGL in software minutes: the rasteriser's colours only */
#define REFERENCE_VERTICES 100e6

static const char *const scenes[] = { "crown", "trees640", "scbi", "sunflowers", "palms", "outdoor",
	"trees1276" };
#define SCENES (sizeof scenes / sizeof *scenes)
static const double distances[] = { 1, 4, 16 };
#define DISTANCES (sizeof distances / sizeof *distances)
static const uint64_t budgets[] = { 10000, 100000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

enum variant { OURS, FLAT, SOFTWARE, VARIANTS };
static const char *const variant_names[VARIANTS] = { "ours", "flat colours", "rasteriser" };
/* TONE: the mean over channels. */
enum { RMS, TONE, PERCEPTUAL, Q, FIGURES };

/* ---- Drawing and comparing ---- */

/* Fills FIGURES, or leaves them NaN where one picture is empty. */
static void compare(const struct view_picture *a, const struct view_picture *r, double figure[FIGURES])
{
	const struct view_picture *pictures[2] = { a, r };
	struct lod_light sum[2] = { { { 0 }, 0 }, { { 0 }, 0 } };
	struct lod_score score;
	double square = 0, either = 0, tone = 0;
	uint64_t different = 0;
	for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
		for (int side = 0; side < 2; side++)
			if (pictures[side]->cover[i])
				lod_light_add(&sum[side], pictures[side]->rgb + 3 * i, 1);
		if (!a->cover[i] && !r->cover[i])
			continue;
		either++;
		for (size_t k = 3 * i; k < 3 * i + 3; k++)
			square += (a->rgb[k] - r->rgb[k]) * (a->rgb[k] - r->rgb[k]) / 65025.0;
	}
	if (!(sum[0].weight > 0 && sum[1].weight > 0))
		return;
	for (int k = 0; k < 3; k++)
		tone += abs(lod_light_byte(sum[0].sum[k] / sum[0].weight)
			- lod_light_byte(sum[1].sum[k] / sum[1].weight)) / 765.0;
	must(eco_pixels_compare(&(struct eco_pixels){ a->width, a->height, 3, a->rgb },
		&(struct eco_pixels){ r->width, r->height, 3, r->rgb }, &different, must_error));
	lod_score(&score, &(struct lod_score_input){ a->width, a->height, a->cover, r->cover, a->owner,
		r->owner });
	figure[RMS] = sqrt(square / (3 * either));
	figure[TONE] = tone;
	figure[PERCEPTUAL] = (double)different / either;
	figure[Q] = score.q;
}

/* One plan, or full detail; the picture is the rasteriser's. */
struct frame { struct view_store *store; struct bench_drawing drawing; struct view_picture picture; };

static void close_frame(struct frame *frame)
{
	view_select_free(&frame->drawing.selection);
	view_picture_free(&frame->picture);
	view_store_free(frame->store);
}

static void open_frame(struct frame *frame, const struct srv_scene *scene, const struct eco_request *request)
{
	const struct view_store_options options = { .images = true, .memory_max = 16ull << 30 };
	*frame = (struct frame){ 0 };
	must(view_store_new(&frame->store, &options, must_error));
	must(bench_fetch(NULL, scene, request, frame->store, must_error));
	must(bench_draw(&frame->drawing, frame->store, &request->view, NULL, &frame->picture, must_error));
}

/* Nothing where there is no OpenGL. */
static struct view_picture draw_gl(const struct frame *frame)
{
	struct view_gl *gl;
	struct eco_error why = { 0 };
	struct view_picture picture = { 0 };
	uint32_t width = frame->picture.width, height = frame->picture.height;
	if (view_gl_open(&gl, &(struct view_gl_options){ width, height }, &why))
		return picture;
	must(view_picture_init(&picture, width, height, must_error));
	must(view_gl_draw(gl, &(struct view_draw_job){ frame->store, &frame->drawing.selection,
		&frame->drawing.eye, frame->drawing.job.near_m, 0, NULL, VIEW_TINT_NONE, 1, false }, &picture, must_error));
	view_gl_close(gl);
	return picture;
}

/* Plain mean of an image's bytes, whatever is clear. */
static void image_mean(const struct eco_image *image, uint8_t rgb[3])
{
	uint64_t count = (uint64_t)image->width * image->height, sum[3] = { 0, 0, 0 };
	for (uint64_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			sum[k] += image->rgba[4 * i + (uint64_t)k];
	for (int k = 0; k < 3 && count; k++)
		rgb[k] = (uint8_t)(sum[k] / count);
}

/* The cut-out whose opaque texels are nearest to this colour: that the colour is the mean of. NULL where
 * there is none that is near. */
static const struct eco_image *image_of(const struct view_store *full, const uint8_t rgb[3])
{
	const struct eco_image *best = NULL;
	int least = NEAR;
	for (uint32_t i = 0; i < view_store_list_count(full); i++) {
		const struct eco_list *textured = &view_store_list_at(full, i)->list;
		const struct view_list *image = textured->image != ECO_NONE
			? view_store_list(full, textured->image) : NULL;
		struct lod_light light = { { 0 }, 0 };
		uint8_t mean[3] = { 0, 0, 0 };
		int distance = 0;
		if (!image || !image->cutout)
			continue;
		for (size_t t = 0; t < (size_t)image->image.width * image->image.height; t++)
			if (image->image.rgba[4 * t + 3] >= 128)
				lod_light_add(&light, image->image.rgba + 4 * t, 1);
		lod_light_mean(&light, mean);
		for (int k = 0; k < 3; k++)
			distance += (mean[k] - rgb[k]) * (mean[k] - rgb[k]);
		if (distance < least) {
			least = distance;
			best = &image->image;
		}
	}
	return best;
}

/* One colour a list for what is not textured. Nothing may be fetched afterwards. */
static void flatten(const struct view_store *store, const struct view_store *full)
{
	for (uint32_t i = 0; i < view_store_list_count(store); i++) {
		const struct view_list *list = view_store_list_at(store, i);
		uint64_t sum[3] = { 0, 0, 0 };
		uint32_t count = list->elements.element_count, colors = list->list.palette_count;
		if (!count || !colors || !(list->list.attributes & ECO_ATTR_COLOR)
				|| list->list.attributes & ECO_ATTR_PLANT || list->list.image != ECO_NONE)
			continue;
		uint8_t mean[3];
		for (uint32_t e = 0; e < count; e++) {
			const uint8_t *rgb = list->palette[list->elements.extra[(size_t)e
				* list->elements.extra_count]];
			for (int k = 0; k < 3; k++)
				sum[k] += rgb[k];
		}
		for (int k = 0; k < 3; k++)
			mean[k] = (uint8_t)(sum[k] / count);
		const struct eco_image *image = image_of(full, mean);
		if (image)
			image_mean(image, mean);
		for (uint32_t c = 0; c < colors; c++)
			memcpy(list->palette[c], mean, 3);
	}
}

/* ---- One view ---- */

struct work {
	struct bench *bench;
	const struct srv_scene *scene;
	struct eco_request request;
	const char *name;            /* of its pictures */
	struct frame full;
	struct view_picture reference;       /* OpenGL's; empty where there is none */
};

/* Full detail, ours, and four times the difference around gray. */
static void write_pictures(const struct work *w, const struct view_picture *ours,
	const struct view_picture *reference, uint64_t budget)
{
	size_t size = 3 * (size_t)ours->width * ours->height;
	char file[160];
	uint8_t *off = eco_alloc(size, 1);
	for (size_t i = 0; i < size; i++) {
		int d = 128 + 4 * (ours->rgb[i] - reference->rgb[i]);
		off[i] = (uint8_t)(d < 0 ? 0 : d > 255 ? 255 : d);
	}
	snprintf(file, sizeof file, "%s-%llu.png", w->name, (unsigned long long)budget);
	bench_pictures_write(w->bench, file, ours->width, ours->height,
		(const uint8_t *[]){ reference->rgb, ours->rgb, off }, 3);
	free(off);
}

static void try_budget(const struct work *w, uint64_t budget, double figure[VARIANTS][FIGURES])
{
	struct eco_request request = w->request;
	struct frame frame;
	request.vertices = budget;
	open_frame(&frame, w->scene, &request);
	compare(&frame.picture, &w->full.picture, figure[SOFTWARE]);
	if (!w->reference.rgb)
		write_pictures(w, &frame.picture, &w->full.picture, budget);
	for (size_t v = OURS; v <= FLAT && w->reference.rgb; v++) {
		if (v == FLAT)
			flatten(frame.store, w->full.store);
		struct view_picture picture = draw_gl(&frame);
		compare(&picture, &w->reference, figure[v]);
		if (v == OURS)
			write_pictures(w, &picture, &w->reference, budget);
		view_picture_free(&picture);
	}
	close_frame(&frame);
}

/* The unit: figures by budget and variant. */
#define NUMBERS (BUDGETS * VARIANTS * FIGURES)

static json_t *study_view(void *ctx)
{
	struct work *w = ctx;
	struct eco_request all = { .view = w->request.view, .vertices = ECO_VERTICES_MAX,
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
	double figure[BUDGETS][VARIANTS][FIGURES];
	for (double *f = figure[0][0]; f < figure[0][0] + NUMBERS; f++)
		*f = NAN;
	open_frame(&w->full, w->scene, &all);
	if ((double)w->full.drawing.selection.vertices <= REFERENCE_VERTICES)
		w->reference = draw_gl(&w->full);
	for (size_t b = 0; b < BUDGETS; b++)
		try_budget(w, budgets[b], figure[b]);
	close_frame(&w->full);
	view_picture_free(&w->reference);
	return bench_reals(figure[0][0], NUMBERS);
}

/* Further away along the same line, and higher, so that the ground does not hide everything. */
static struct eco_view away(const struct eco_view *view, double times)
{
	struct eco_view v = *view;
	double length = 0;
	for (int k = 0; k < 3; k++) {
		double d = view->eye[k] - view->target[k];
		v.eye[k] = view->target[k] + times * d;
		length += d * d;
	}
	v.eye[2] += 0.1 * (times - 1) * sqrt(length);
	return v;
}

/* ---- Tables ---- */

struct sums { double figure[FIGURES]; uint32_t count; };

static void add_row(struct sums sums[VARIANTS], double figure[VARIANTS][FIGURES])
{
	for (size_t v = 0; v < VARIANTS; v++) {
		for (size_t f = 0; f < FIGURES && !isnan(figure[v][Q]); f++)
			sums[v].figure[f] += figure[v][f];
		sums[v].count += !isnan(figure[v][Q]);
	}
}

static void study_scene(struct bench *bench, size_t number, struct sums sums[VARIANTS])
{
	const char *scene = scenes[number];
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	struct srv_store server;
	char pack[512];
	if (!bench_scene_there(bench, scene, pack))
		return;
	uint32_t views = bench_shot_views(bench, scene, requests), most = bench->full ? VIEWS_FULL
		: VIEWS_QUICK;
	srv_store_init(&server);
	must(srv_store_add(&server, scene, pack, must_error));
	for (uint32_t i = 0; i < (views < most ? views : most) * DISTANCES; i++) {
		double distance = distances[i % DISTANCES], figure[BUDGETS][VARIANTS][FIGURES];
		char name[100], file[160], caption[300];
		uint32_t view = i / DISTANCES;
		snprintf(name, sizeof name, "colour-%s-%u-%g", scene, view, distance);
		bench_progress(bench, ((double)number + (double)i / (most * DISTANCES)) / SCENES, name);
		struct work work = { .bench = bench, .scene = server.scenes[0], .request = requests[view],
			.name = name };
		work.request.view = away(&requests[view].view, distance);
		bench_cells(bench_unit(bench, name, bench_pack_stamp(pack), study_view, &work), figure[0][0],
			NUMBERS);
		for (size_t b = 0; b < BUDGETS; b++)
			add_row(sums, figure[b]);
		if (view)
			continue;
		snprintf(file, sizeof file, "%s-%llu.png", name, (unsigned long long)budgets[1]);
		snprintf(caption, sizeof caption,
			"%s, %g times the distance: full detail, %llu vertices, four "
			"times the difference; Q %.3f", scene, distance, (unsigned long long)budgets[1],
			figure[1][SOFTWARE][Q]);
		bench_picture(bench, file, caption);
	}
	srv_store_free(&server);
}

static void run(struct bench *bench)
{
	struct sums sums[VARIANTS] = { { { 0 }, 0 } };
	for (size_t s = 0; s < SCENES; s++)
		study_scene(bench, s, sums);
	bench_say(bench, "Colours against full detail, means over scenes, views, distances and budgets. "
		"Tone is the mean light over covered pixels; the first three are drawn by OpenGL with light "
		"and shade, the last flat, each against full detail drawn in the same way.");
	struct bench_table *table = bench_table_open(bench, "colour_means",
		"colours,frames,rms,tone,perceptual", true);
	for (int v = 0; v < VARIANTS; v++) {
		const double *sum = sums[v].figure, count = sums[v].count;
		if (sums[v].count)
			bench_table_row(table, "%s,%u,%.4f,%.4f,%.4f", variant_names[v], sums[v].count,
				sum[RMS] / count, sum[TONE] / count, sum[PERCEPTUAL] / count);
	}
	bench_table_close(table);
}

const struct bench_section bench_colour = { "colour", "Colour against full detail", run };
