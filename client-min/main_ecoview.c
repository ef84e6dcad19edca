/* ecoview: streams the frames of a camera script, draws them, and scores them against the full-detail
 * reference. Longer than 600 lines: all steps of a frame work on struct viewer. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "client-min/view_fetch.h"
#include "client-min/draw/view_gl.h"
#include "client-min/view_options.h"
#include "client-min/view_reference.h"
#include "client-min/view_report.h"
#include "client-min/view_measure.h"
#include "ecofiles/base/json_read.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/options.h"
#include "ecofiles/base/progress.h"
#include "ecofiles/format/chunk/draco_shim.h"
#include "ecofiles/format/image.h"

#define RESUMES 8                        /* of an answer that breaks off: for some 15 s */
#define PATIENCE_MS 60000                /* with a server that has too much to do */
#define REPLACED 409                     /* status: the scene has another pack than what is held, ... */
#define REPLACED_MOST 3                  /* ... so often for one frame */

struct viewer {                          /* everything that lives as long as the program */
	struct eco_error *error;                 /* of the steps under way (eco_try) */
	struct view_options options;
	struct eco_camera *camera;
	struct view_fetch *fetch;
	struct view_fetch *asks;                 /* of plants, also while a stream comes; NULL: of none */
	/* the reference has a store of its own: it must not count as held by the frames */
	struct view_store *store, *full;
	struct view_gl *gl;                      /* NULL: all is drawn in software */
	struct view_picture picture, reference;
	struct view_picture fine, rough;         /* if they are compared: its cuts and full detail, at as many
	                                          * samples as the other */
	uint8_t *before[2];                      /* colours of picture and reference of the last frame */
	float *error_map;                        /* of the two, if they are compared */
	double ceiling, truth_cpu_ms, coarse;    /* of the reference; coarse: view_selection's */
	struct view_report report;
	struct view_explain explain;
	double parts, part;
	double turns_ms, begun_ms;               /* of the frame under way: turns_after, and when it began */
	const struct lod_eye *eye;               /* of the frame under way, for its parts */
	struct view_frame *frame;
	uint32_t number;                         /* its own */
	uint32_t frame_parts;                    /* drawn of it, ... */
	struct view_frame drawn;                 /* ... the last of them */
	bool replaced;                           /* it met another pack than that of what is held */
	char digest[VIEW_DIGEST_BYTES];          /* of the frame, if it is asked for */
	/* how far the last eye was below the ground that was drawn; else 0 or less */
	double under_m;
	struct view_sky sky;
	struct view_map map;                     /* for --geojson and the sun */
};

/* ---- Files ---- */

static void save(const struct viewer *v, const char *format, uint32_t frame, const uint8_t *bytes, uint32_t channels)
{
	struct eco_pixels pixels = { v->options.width, v->options.height, channels, bytes };
	eco_check(view_save(v->options.dir, format, frame, &pixels, v->error));
}

static void save_masks(struct viewer *v, uint32_t frame)
{
	uint32_t count = v->options.width * v->options.height;
	uint8_t *rgb = eco_alloc(count, 3);
	view_picture_compare(v->picture.cover, v->reference.cover, count, rgb);
	save(v, "reference-%04u.png", frame, v->reference.rgb, 3);
	save(v, "frame-%04u.mask.png", frame, v->picture.cover, 1);
	save(v, "reference-%04u.mask.png", frame, v->reference.cover, 1);
	save(v, "pr-%04u.png", frame, rgb, 3);
	free(rgb);
}

static void save_owners(struct viewer *v, uint32_t frame)
{
	uint8_t *rgb = eco_alloc((size_t)v->options.width * v->options.height, 3);
	view_picture_owners(&v->picture, rgb);
	save(v, "frame-%04u.owners.png", frame, rgb, 3);
	free(rgb);
}

static void save_comparison(struct viewer *v, const struct view_frame *f)
{
	const struct lod_score *score = &f->measures.score;
	char ours[200], full[200], wrong[200], q[6][VIEW_SCORE_BYTES];
	uint32_t size[2];
	uint8_t *rgb;
	if (!v->error_map)
		return;
	snprintf(ours, sizeof ours,
		"ours: %llu of %llu vertices, %llu bytes\nQ %s  soft_q %s  ceiling %s",
		(unsigned long long)f->vertices, (unsigned long long)f->budget_vertices,
		(unsigned long long)f->fetched.bytes, view_report_score(q[0], score->q),
		view_report_score(q[1], f->measures.soft_q),
		view_report_score(q[2], f->ceiling));
	snprintf(full, sizeof full, "full: %llu vertices\nP %s  R %s  skill %s  owner_q %s",
		(unsigned long long)v->reference.vertices, view_report_score(q[0], score->precision),
		view_report_score(q[1], score->recall), view_report_score(q[2], score->skill),
		view_report_score(q[3], score->owner_q));
	snprintf(wrong, sizeof wrong, "picture_error %s  floor %s  bias %s\nm16 %s  s16 %s  s16_abs %s",
		view_report_score(q[0], f->measures.picture_error), view_report_score(q[1], f->floor),
		view_report_score(q[2], f->bias), view_report_score(q[3], f->measures.blocks.color),
		view_report_score(q[4], f->measures.blocks.contrast),
		view_report_score(q[5], f->measures.blocks.contrast_abs));
	struct view_compare compare = { &v->picture, &v->reference, v->error_map, { ours, full, wrong } };
	eco_check(view_compare_draw(&compare, &rgb, size, v->error));
	eco_check(view_save(v->options.dir, "compare-%04u.png", f->frame,
		&(struct eco_pixels){ size[0], size[1], 3, rgb }, v->error));
	free(rgb);
}

/* ---- Frames ---- */

static void step(struct viewer *v, uint32_t frame, const char *what)
{
	char text[96];
	snprintf(text, sizeof text, "frame %u: %s", frame, what);
	eco_progress("drawing", text, v->part++ / v->parts);
}

/* Draws in software what scores need beside the pictures. */
static void draw_samples(struct viewer *v, const struct view_draw_job *job, struct view_picture *picture)
{
	bool lit = job->tint == VIEW_TINT_NONE, full = picture == &v->reference;
	eco_check(view_measure_soft(job, picture, v->error));
	if (v->error_map && lit)
		eco_check(full ? view_reference_draw(job, &v->rough, v->error)
			: view_reference_fine(job, VIEW_TRUTH_SIDE, &v->fine, v->error));
	if (full && lit)
		eco_check(view_truth_draw(job, v->options.truths, picture, &v->truth_cpu_ms, v->error));
	if (full)
		eco_check(view_measure_ceiling(job, picture, &v->ceiling, v->error));
}

/* Draws a store's plan into `picture`, with OpenGL if there is one. */
static void draw(struct viewer *v, const struct view_store *store, const struct lod_eye *eye, struct view_picture *picture)
{
	struct view_selection selection, casters = { .instances = NULL };
	double ground_m;
	eco_check(view_select_make(&selection, store, eye, v->error));
	v->coarse = (double)selection.coarse;
	selection.sky = v->sky;
	selection.sky.casters = &casters;
	if (v->sky.shadows)
		eco_check(view_select_casters(&casters, store, eye, v->error));
	if (v->options.digest && store == v->store)
		eco_check(view_digest_write(v->digest, store, &selection, v->error));
	struct view_draw_job job = { store, &selection, eye, view_store_near_m(store), 0,
		&view_interrupted, (enum view_tint)v->options.tint, (uint32_t)v->options.samples, v->options.smooth };
	bool shown = store == v->store || job.tint != VIEW_TINT_NONE;   /* the truth's colours are drawn later */
	job.samples = shown ? job.samples : 1;
	eco_check(v->gl ? view_gl_draw(v->gl, &job, picture, v->error) : view_reference_draw(&job, picture, v->error));
	if (v->options.geojson && store == v->store && view_store_complete(store))
		eco_check(view_geojson_save(&(struct view_geojson_job){ store, &selection, picture, &v->map, v->asks },
			v->options.dir, v->frame->frame, v->error));
	job.samples = (uint32_t)v->options.samples;
	if (v->options.reference)
		draw_samples(v, &job, picture);
	v->under_m = view_ground_height(&selection.ground, eye->at[0], eye->at[1], &ground_m)
		? ground_m - eye->at[2] : 0;
	view_select_free(&selection);
	view_select_free(&casters);
}

/* From there the ground hides what should be seen, in a plan that does not expect it: almost always a script
 * whose heights count from the ground, not from the scene's origin. */
static void note_under_ground(struct viewer *v, uint32_t frame)
{
	if (!(v->under_m > 0))
		return;
	eco_progress_note("frame %u: the eye is %.2f m below the ground; heights in the script count "
		"from the scene's origin, unless it says \"above_ground\": true", frame, v->under_m);
}

/* Notes the store's figures, which were `before` before the frame. */
static void count_memory(struct viewer *v, const struct view_store_stats *before, struct view_frame *f)
{
	struct view_store_stats now = view_store_stats(v->store);
	const struct view_store *stores[2] = { v->store, v->full };
	f->decode_ms = now.decode_ms;
	f->memory_bytes = now.memory_bytes;
	f->evictions = now.evictions - before->evictions;
	f->again_bytes = now.again_bytes - before->again_bytes;
	if (now.memory_peak_bytes > v->report.memory_peak_bytes)
		v->report.memory_peak_bytes = now.memory_peak_bytes;
	if (v->gl && f->evictions)
		view_gl_keep(v->gl, stores, v->full ? 2 : 1);
}

/* Draws and scores what there is of the frame under way. */
static void draw_part(void *viewer)
{
	struct viewer *v = viewer;
	v->drawn = *v->frame;
	draw(v, v->store, v->eye, &v->picture);
	v->drawn.vertices = v->picture.vertices;
	v->drawn.draw_ms = v->picture.draw_ms;
	v->drawn.ceiling = v->options.reference ? v->ceiling : NAN;
	if (v->options.reference)
		view_measure_pair(&v->picture, &v->reference, NULL, &v->drawn.measures);
}

/* A picture for each mark, the same again where nothing came since the one before: a film keeps its time. Called while an
 * answer comes, whose code no step may leave. */
static enum eco_code save_part(void *ctx, const struct view_fetch_result *so_far, struct eco_error *error)
{
	struct viewer *v = ctx;
	char format[64];
	enum eco_code code = ECO_OK;
	if (!v->frame_parts || so_far->bytes > v->drawn.fetched.bytes)
		code = eco_try(draw_part, v, error);
	v->drawn.fetched.bytes = so_far->bytes;
	v->drawn.fetched.stream_ms = so_far->stream_ms;
	if (code)
		return code;
	snprintf(format, sizeof format, "frame-%%04u-part-%02u.png", v->frame_parts++);
	eco_progress_end();
	view_report_line(&v->drawn, true, stdout);
	code = view_save(v->options.dir, format, v->drawn.frame, &(struct eco_pixels){ v->options.width, v->options.height, 3,
		v->picture.rgb }, error);
	if (!code)
		view_frames_add(&v->report.parts, &v->drawn);
	return code;
}

/* Milliseconds until the script is at the next frame, if that looks elsewhere than was told. */
static double turns_after(const struct viewer *v, uint32_t number, const struct eco_request *request)
{
	struct eco_view now = request->view;
	if (!request->next.given || number + 1 >= eco_camera_frame_count(v->camera))
		return INFINITY;
	double time_s = eco_camera_frame(v->camera, number, &now),
		wait_s = eco_camera_frame(v->camera, number + 1, &now) - time_s;
	return eco_view_turned(request, &now) ? wait_s * 1e3 : INFINITY;
}

static bool has_turned(void *ctx)
{
	const struct viewer *v = ctx;
	return view_clock_ms() - v->begun_ms > v->turns_ms;
}

static void stream_frame(struct viewer *v, const struct eco_request *request, const struct lod_eye *eye, struct view_frame *f)
{
	struct view_fetch_result result;
	struct view_store_stats before = view_store_stats(v->store);
	step(v, f->frame, "stream");
	v->eye = eye;
	v->frame = f;
	v->frame_parts = 0;
	view_fetch_watch(v->fetch, &(struct view_fetch_watch){ &v->options.marks, save_part, has_turned, v });
	v->begun_ms = view_clock_ms();
	enum eco_code code = view_fetch_stream(v->fetch, v->store, request, &result, v->error);
	v->replaced |= result.status == REPLACED;
	view_fetch_watch(v->fetch, &(struct view_fetch_watch){ 0 });
	eco_check(code);
	result.bytes += f->fetched.bytes;
	f->fetched = result;
	if (result.host_left) {
		eco_progress_note("frame %u: %s hangs: chunks come from the scene's server from now on", f->frame,
			v->options.chunks);
	}
	count_memory(v, &before, f);
	if (result.nothing) {
		eco_progress_note("frame %u: no picture fits in --bytes, nothing is drawn; allow more", f->frame);
	} else {
		f->predicted_q = eco_predicted_q(&view_store_plan(v->store)->prediction);
		f->predicted_m16 = view_store_plan(v->store)->m16;
	}
	step(v, f->frame, "draw");
	draw(v, v->store, eye, &v->picture);
	note_under_ground(v, f->frame);
	f->vertices = v->picture.vertices;
	f->draw_ms = v->picture.draw_ms;
	if (v->sky.shadows) {
		f->shadow_ms = v->picture.shadow_ms;
		f->shadow_texels = v->picture.shadow_texels;
	}
	eco_check(view_frame_check(f, v->error));
}

/* Full detail of very many plants is more than a plan may take: then the score is against the best plan. */
static void note_coarse(struct viewer *v, struct view_frame *f)
{
	f->reference_coarse = v->coarse;
	if (v->coarse > 0) {
		eco_progress_note("frame %u: the reference is not full detail: %.0f plants or tiles are "
			"drawn coarsely there, too. Look at fewer plants, or serve with a greater --plan-work",
			f->frame, v->coarse);
	}
}

static void draw_reference(struct viewer *v, const struct eco_request *request, const struct lod_eye *eye, struct view_frame *f)
{
	struct eco_request everything = { .view = request->view, .vertices = ECO_VERTICES_MAX,
		.bytes = ECO_BYTES_UNBOUNDED, .ground_px = ECO_GROUND_PX_MIN, .texel_px = ECO_TEXEL_PX_MIN };
	struct view_fetch_result result;
	double start = view_clock_ms();
	step(v, f->frame, "fetch the reference");
	enum eco_code code = view_fetch_stream(v->fetch, v->full, &everything, &result, v->error);
	v->replaced |= result.status == REPLACED;
	eco_check(code);
	step(v, f->frame, "draw the reference");
	draw(v, v->full, eye, &v->reference);
	f->reference_ms = view_clock_ms() - start;
	note_coarse(v, f);
}

static void measure_motion(struct viewer *v, struct view_frame *f)
{
	const uint8_t *const now[2] = { v->picture.rgb, v->reference.rgb };
	const size_t bytes = 3 * (size_t)v->options.width * v->options.height;
	if (v->before[0])
		view_measure_motion(v->options.width, v->options.height,
			(const uint8_t *const[2]){ v->before[0], now[0] },
			(const uint8_t *const[2]){ v->before[1], now[1] }, &f->motion);
	for (int i = 0; i < 2; i++) {
		v->before[i] = v->before[i] ? v->before[i] : eco_alloc(bytes, 1);
		memcpy(v->before[i], now[i], bytes);
	}
}

static void score_frame(struct viewer *v, struct view_frame *f)
{
	view_measure_pair(&v->picture, &v->reference, v->error_map, &f->measures);
	f->ceiling = v->ceiling;
	f->truth_cpu_ms = v->truth_cpu_ms > 0 ? v->truth_cpu_ms : NAN;
	if (v->options.tint != VIEW_TINT_NONE) {         /* there is no truth of such colours */
		f->measures.picture_error = NAN;
		f->measures.blocks = (struct lod_block_error){ NAN, NAN, NAN };
	} else if (v->error_map) {
		f->bias = view_picture_error(&v->fine, &v->reference);
		f->floor = view_picture_error(&v->rough, &v->reference);
	}
	measure_motion(v, f);
	save_masks(v, f->frame);
	save_comparison(v, f);
}

static void one_frame(void *viewer)
{
	struct viewer *v = viewer;
	const struct view_options *o = &v->options;
	struct eco_request request = { .vertices = o->vertices, .bytes = o->bytes, .ground_px = o->ground_px,
		.texel_px = o->texel_px, .view = { .width = o->width, .height = o->height } };
	struct view_fetch_result asked = { .requests = 0 };
	double time_s = eco_camera_frame(v->camera, v->number, &request.view);
	enum eco_code code = eco_view_check(&request.view, v->error);
	eco_check(code);
	if (o->ahead_s > 0)
		eco_camera_ahead(v->camera, v->number, o->ahead_s, &request);
	v->turns_ms = turns_after(v, v->number, &request);
	if (eco_camera_above_ground(v->camera))
		code = view_stand(v->fetch, v->store, &request, &asked, v->error);
	v->replaced |= asked.status == REPLACED;
	eco_check(code);
	eco_request_snap(&request, o->snap_m);
	struct lod_eye eye;
	lod_eye_make(&eye, &request.view);
	struct view_frame f = view_frame_empty(v->number, time_s, &request);
	f.fetched.bytes = asked.bytes;
	/* parts are scored while they come */
	bool parts = o->marks.bytes_count + o->marks.ms_count > 0;
	if (o->reference && parts)
		draw_reference(v, &request, &eye, &f);
	stream_frame(v, &request, &eye, &f);
	save(v, "frame-%04u.png", v->number, v->picture.rgb, 3);
	if (o->owners)
		save_owners(v, v->number);
	if (o->reference && !parts)
		draw_reference(v, &request, &eye, &f);
	if (o->reference)
		score_frame(v, &f);
	eco_check(view_explain_frame(&v->explain, v->fetch, v->number, &request, &(struct view_full){ v->full, &eye,
		o->reference ? &v->reference : NULL }, v->error));
	view_frames_add(&v->report.frames, &f);
	eco_progress_end();
	view_report_line(&f, false, stdout);
	if (o->digest)
		printf("frame %u: digest %s\n", v->number, v->digest);
}

static void open_stores(struct viewer *v)
{
	struct view_store_options store = { .images = true, .memory_max = v->options.memory },
		full = { .images = true };
	eco_check(view_store_new(&v->store, &store, v->error));
	if (v->options.reference)
		eco_check(view_store_new(&v->full, &full, v->error));
}

static void close_stores(struct viewer *v)
{
	view_store_free(v->store);
	view_store_free(v->full);
	v->store = v->full = NULL;
}

/* The server has another pack of the scene: of the one before nothing is of use, on the GPU neither. */
static void begin_anew(void *viewer)
{
	struct viewer *v = viewer;
	eco_progress_note("frame %u: the server has another pack of the scene now: the client starts again with it",
		v->number);
	close_stores(v);
	open_stores(v);
	const struct view_store *stores[2] = { v->store, v->full };
	if (v->gl)
		view_gl_keep(v->gl, stores, v->full ? 2 : 1);
	one_frame(v);
}

/* All of a frame is of one pack. */
static enum eco_code whole_frame(struct viewer *v, uint32_t number, struct eco_error *error)
{
	const uint32_t parts = v->report.parts.count;
	const double part = v->part;
	struct eco_error one = { 0 };
	v->error = &one;
	v->number = number;
	enum eco_code code = eco_try(one_frame, v, &one);
	for (int i = 0; code && v->replaced && i < REPLACED_MOST; i++) {
		v->report.parts.count = parts;
		v->part = part;
		v->replaced = false;
		one = (struct eco_error){ 0 };
		code = eco_try(begin_anew, v, &one);
	}
	v->error = error;
	return code ? eco_fail(error, code, "%s", one.text) : ECO_OK;
}

static enum eco_code all_frames(struct viewer *v, struct eco_error *error)
{
	struct view_options *o = &v->options;
	uint32_t count = eco_camera_frame_count(v->camera);
	if (!o->has_frames)
		o->frame_last = count - 1;
	if (o->frame_last >= count)
		return eco_fail(error, ECO_BAD_USAGE, "--frames: the camera script has frames 0..%u",
			count - 1);
	v->parts = (double)(o->frame_last - o->frame_first + 1) * (o->reference ? 4 : 2);
	enum eco_code code = ECO_OK;
	for (uint64_t i = o->frame_first; i <= o->frame_last && !code; i++)
		code = view_interrupted ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: whole_frame(v, (uint32_t)i, error);
	v->report.complete = code == ECO_OK;
	eco_progress_end();
	v->report.scene = view_store_scene_name(v->store);
	view_report_memory_line(&v->report, stdout);
	v->report.programs = v->gl ? view_gl_programs(v->gl) : 0;
	enum eco_code written = view_report_write(&v->report, o->dir, error);
	if (!written)
		written = view_explain_close(&v->explain, v->report.frames.count > 0, error);
	if (code == ECO_INTERRUPTED)
		fprintf(stderr, "ecoview: interrupted after %u of %llu frames; %s/report.json holds them\n",
			v->report.frames.count, (unsigned long long)(o->frame_last - o->frame_first + 1),
				o->dir);
	return code ? code : written;
}

/* ---- Life ---- */

/* Whatever is compared is drawn alike, so that no difference between renderers counts as error. */
static enum eco_code open_engine(struct viewer *v, struct eco_error *error)
{
	struct view_gl_options options = { v->options.width, v->options.height };
	struct eco_error why = { 0 };
	enum view_engine *engine = &v->options.reference;
	if (*engine != VIEW_ENGINE_CPU && view_gl_open(&v->gl, &options, &why)) {
		if (*engine == VIEW_ENGINE_EGL)
			return eco_fail(error, why.code, "--reference=egl: %s", why.text);
		fprintf(stderr, "ecoview: %s; pictures are drawn in software\n", why.text);
	}
	if (*engine == VIEW_ENGINE_AUTO)
		*engine = v->gl && view_gl_hardware(v->gl) ? VIEW_ENGINE_EGL : VIEW_ENGINE_CPU;
	if (*engine == VIEW_ENGINE_CPU) {
		view_gl_close(v->gl);
		v->gl = NULL;
	}
	v->report.renderer = v->gl ? view_gl_renderer(v->gl) : "software";
	v->report.reference = *engine == VIEW_ENGINE_NONE ? NULL : *engine == VIEW_ENGINE_CPU ? "cpu" : "egl";
	v->report.memory_max = v->options.memory;
	v->report.width = v->options.width;
	v->report.height = v->options.height;
	return ECO_OK;
}

static void start(void *viewer)
{
	struct viewer *v = viewer;
	const struct view_options *o = &v->options;
	struct eco_error *error = v->error;
	struct view_fetch_options fetch = { .url = o->url, .chunks = o->chunks,
		.rule = o->rule ? view_rules[o->rule] : NULL,
		.patience_ms = PATIENCE_MS, .resumes = RESUMES, .stop = &view_interrupted };
	eco_check(view_fetch_setup(error));
	eco_check(eco_camera_load(&v->camera, o->camera, error));
	eco_check(view_save_dir(o->dir, error));
	if (o->explain)
		view_explain_open(&v->explain, o->explain);
	eco_check(view_fetch_new(&v->fetch, &fetch, error));
	v->sky = o->sky;
	if (o->geojson || o->tint != VIEW_TINT_OWN || !isnan(o->sun_s))
		eco_check(view_map_fetch(v->fetch, &v->map, error));
	if (!isnan(o->sun_s) && !v->map.has_place)
		eco_stop(ECO_BAD_INPUT, "the scene's place on Earth is not stated: give it a crs and make the pack again");
	if (!isnan(o->sun_s))
		view_sun_at(&v->map.place, o->sun_s, v->sky.sun);
	else if (v->map.has_place)
		view_sun_usual(&v->map.place, v->sky.sun);
	fetch.chunks = NULL;
	if (o->geojson)
		eco_check(view_fetch_new(&v->asks, &fetch, error));
	eco_check(open_engine(v, error));
	open_stores(v);
	eco_check(view_picture_init(&v->picture, o->width, o->height, error));
	if (o->reference)
		eco_check(view_picture_init(&v->reference, o->width, o->height, error));
	if (o->compare) {
		v->error_map = eco_alloc((size_t)o->width * o->height, sizeof *v->error_map);
		eco_check(view_picture_init(&v->fine, o->width, o->height, error));
		eco_check(view_picture_init(&v->rough, o->width, o->height, error));
	}
	if (o->truths)
		eco_check(view_save_dir(o->truths, error));
}

static void finish(struct viewer *v)
{
	view_picture_free(&v->picture);
	view_picture_free(&v->reference);
	view_picture_free(&v->fine);
	view_picture_free(&v->rough);
	eco_free(v->before[0], v->before[1], v->error_map);
	view_gl_close(v->gl);
	view_report_free(&v->report);
	view_explain_close(&v->explain, false, NULL);
	close_stores(v);
	view_fetch_free(v->asks);
	view_fetch_free(v->fetch);
	eco_camera_free(v->camera);
}

int main(int argc, char **argv)
{
	static struct viewer viewer;
	static struct eco_error error;
	if (eco_command_answers(&view_command, argc - 1, argv + 1))
		return eco_command_end(&view_command, ECO_OK, &error);
	enum eco_code code = view_options_read(argc, argv, &viewer.options, &error);
	eco_progress_begin("ecoview");
	view_catch_signals();
	eco_draco_end_without_memory(NULL);
	eco_json_watch();
	viewer.error = &error;
	if (!code)
		code = eco_try(start, &viewer, &error);
	if (!code)
		code = all_frames(&viewer, &error);
	finish(&viewer);
	view_fetch_teardown();
	if (code == ECO_INTERRUPTED)
		error.text[0] = 0;                   /* all_frames told it */
	return eco_command_end(&view_command, code, &error);
}
