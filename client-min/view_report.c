#include "client-min/view_report.h"
#include "client-min/draw/view_shader.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/json_read.h"
#include "ecofiles/base/memory.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The figures of a frame by name, for frames and their means; `score`: as a line for people calls it. */
#define FIGURE(name) offsetof(struct view_frame, name)
static const struct { const char *name, *score; size_t offset; } measures[] = {
	{ "precision", "P", FIGURE(measures.score.precision) },
	{ "recall", "R", FIGURE(measures.score.recall) },
	{ "q", "Q", FIGURE(measures.score.q) }, { "skill", "skill", FIGURE(measures.score.skill) },
	{ "owner_q", "owner_q", FIGURE(measures.score.owner_q) },
	{ "soft_q", "soft_q", FIGURE(measures.soft_q) }, { "ceiling", "ceiling", FIGURE(ceiling) },
	{ "picture_error", "picture_error", FIGURE(measures.picture_error) },
	{ "m16", "m16", FIGURE(measures.blocks.color) }, { "s16", "s16", FIGURE(measures.blocks.contrast) },
	{ "s16_abs", NULL, FIGURE(measures.blocks.contrast_abs) },
	{ "bias_error", NULL, FIGURE(bias) }, { "floor_error", NULL, FIGURE(floor) },
	{ "shimmer", NULL, FIGURE(motion.shimmer) }, { "pop", NULL, FIGURE(motion.pop) },
	{ "truth_cpu_ms", NULL, FIGURE(truth_cpu_ms) },
	{ "predicted_q", NULL, FIGURE(predicted_q) }, { "predicted_m16", NULL, FIGURE(predicted_m16) },
	{ "plan_ms", NULL, FIGURE(fetched.plan_ms) },
	{ "first_byte_ms", NULL, FIGURE(fetched.first_byte_ms) },
	{ "stream_ms", NULL, FIGURE(fetched.stream_ms) }, { "decode_ms", NULL, FIGURE(decode_ms) },
	{ "draw_ms", NULL, FIGURE(draw_ms) }, { "reference_ms", NULL, FIGURE(reference_ms) },
	{ "shadow_ms", NULL, FIGURE(shadow_ms) }, { "shadow_texels_per_pixel", NULL, FIGURE(shadow_texels) },
	{ "reference_coarse", NULL, FIGURE(reference_coarse) } };
#define MEASURES (sizeof measures / sizeof measures[0])
static const struct { const char *name; size_t offset; } counts[] = {
	{ "budget_vertices", FIGURE(budget_vertices) }, { "vertices", FIGURE(vertices) },
	{ "bytes", FIGURE(fetched.bytes) }, { "requests", FIGURE(fetched.requests) },
	{ "broken_answers", FIGURE(fetched.broken) }, { "cancelled_bytes", FIGURE(fetched.cancelled) },
	{ "named_chunks", FIGURE(fetched.named) }, { "named_bytes", FIGURE(fetched.named_bytes) },
	{ "memory_bytes", FIGURE(memory_bytes) }, { "evicted_chunks", FIGURE(evictions) },
	{ "refetched_bytes", FIGURE(again_bytes) } };

static double measure(const struct view_frame *frame, size_t i)
{
	double v;
	memcpy(&v, (const char *)frame + measures[i].offset, sizeof v);
	return v;
}

static json_t *count(const struct view_frame *frame, size_t i)
{
	uint64_t v;
	memcpy(&v, (const char *)frame + counts[i].offset, sizeof v);
	return json_integer((json_int_t)v);
}

struct view_frame view_frame_empty(uint32_t frame, double time_s, const struct eco_request *request)
{
	struct view_frame f = { .frame = frame, .time_s = time_s, .budget_vertices = request->vertices,
		.budget_bytes = request->bytes };
	for (size_t i = 0; i < MEASURES; i++)
		memcpy((char *)&f + measures[i].offset, &(double){ NAN }, sizeof(double));
	return f;
}

enum eco_code view_frame_check(const struct view_frame *f, struct eco_error *error)
{
	if (f->vertices > f->budget_vertices)
		return eco_fail(error, ECO_DAMAGED, "frame %u: %llu vertices were drawn, %llu were allowed",
			f->frame, (unsigned long long)f->vertices, (unsigned long long)f->budget_vertices);
	if (f->fetched.most_bytes > f->budget_bytes)
		return eco_fail(error, ECO_DAMAGED, "frame %u: the response took %llu bytes, %llu were "
			"allowed", f->frame, (unsigned long long)f->fetched.most_bytes,
			(unsigned long long)f->budget_bytes);
	return ECO_OK;
}

void view_frames_add(struct view_frames *frames, const struct view_frame *frame)
{
	eco_grow(&frames->items, &frames->room, frames->count, sizeof *frames->items);
	frames->items[frames->count++] = *frame;
}

const char *view_report_score(char text[VIEW_SCORE_BYTES], double v)
{
	if (isnan(v))
		snprintf(text, VIEW_SCORE_BYTES, "-");
	else
		snprintf(text, VIEW_SCORE_BYTES, "%.4f", v);
	return text;
}

void view_report_line(const struct view_frame *f, bool is_part, FILE *out)
{
	char text[VIEW_SCORE_BYTES];
	if (is_part)
		fprintf(out, "frame %04u  after %llu bytes and %.0f ms: vertices %llu", f->frame,
			(unsigned long long)f->fetched.bytes, f->fetched.stream_ms,
			(unsigned long long)f->vertices);
	else
		fprintf(out, "frame %04u  vertices %llu of %llu  bytes %llu", f->frame,
			(unsigned long long)f->vertices, (unsigned long long)f->budget_vertices,
			(unsigned long long)f->fetched.bytes);
	for (size_t i = 0; i < MEASURES && measures[i].score; i++)
		fprintf(out, "  %s %s", measures[i].score, view_report_score(text, measure(f, i)));
	fputc('\n', out);
	fflush(out);
}

struct totals { uint64_t vertices, bytes, broken, cancelled, repeats, evictions, again_bytes; };

static struct totals add_up(const struct view_report *report)
{
	struct totals t = { 0 };
	for (uint32_t i = 0; i < report->frames.count; i++) {
		const struct view_frame *f = &report->frames.items[i];
		t.vertices += f->vertices;
		t.bytes += f->fetched.bytes;
		t.broken += f->fetched.broken;
		t.cancelled += f->fetched.cancelled;
		t.repeats += f->fetched.requests > 1 + f->fetched.broken
			? f->fetched.requests - 1 - f->fetched.broken : 0;
		t.evictions += f->evictions;
		t.again_bytes += f->again_bytes;
	}
	return t;
}

void view_report_memory_line(const struct view_report *report, FILE *out)
{
	struct totals t = add_up(report);
	if (t.evictions)
		fprintf(out, "memory  %.1f MiB held at most  %llu chunks evicted  %llu of %llu bytes fetched "
			"again  %llu requests repeated\n", (double)report->memory_peak_bytes / (1 << 20),
			(unsigned long long)t.evictions, (unsigned long long)t.again_bytes,
			(unsigned long long)t.bytes, (unsigned long long)t.repeats);
}

/* ---- JSON ---- */

static json_t *number(double v)
{
	return isfinite(v) ? json_real(v) : json_null();
}

/* null also where the text is not UTF-8 */
static json_t *text_json(const char *text)
{
	json_t *value = text ? json_string(text) : NULL;
	return value ? value : json_null();
}

static json_t *frame_json(const struct view_frame *f)
{
	json_t *o = json_pack("{s:I, s:o, s:o}", "frame", (json_int_t)f->frame, "time_s", number(f->time_s),
		"budget_bytes", f->budget_bytes == ECO_BYTES_UNBOUNDED ? json_null()
		: json_integer((json_int_t)f->budget_bytes));
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		json_object_set_new(o, counts[i].name, count(f, i));
	for (size_t i = 0; i < MEASURES; i++)
		json_object_set_new(o, measures[i].name, number(measure(f, i)));
	return o;
}

static json_t *summary_json(const struct view_report *report)
{
	struct totals t = add_up(report);
	json_t *o = json_pack("{s:I, s:o, s:I, s:o, s:I, s:I, s:I, s:I}", "frames",
		(json_int_t)report->frames.count,
		"mean_vertices",
			number(report->frames.count ? (double)t.vertices / report->frames.count : NAN),
		"total_bytes", (json_int_t)t.bytes, "memory_max_bytes", report->memory_max
		? json_integer((json_int_t)report->memory_max) : json_null(),
		"memory_peak_bytes", (json_int_t)report->memory_peak_bytes,
		"evicted_chunks", (json_int_t)t.evictions, "refetched_bytes", (json_int_t)t.again_bytes,
		"repeated_requests", (json_int_t)t.repeats);
	json_object_set_new(o, "broken_answers", json_integer((json_int_t)t.broken));
	json_object_set_new(o, "cancelled_bytes", json_integer((json_int_t)t.cancelled));
	for (size_t m = 0; m < MEASURES; m++) {
		double sum = 0;
		uint32_t n = 0;
		for (uint32_t i = 0; i < report->frames.count; i++)
			if (isfinite(measure(&report->frames.items[i], m))) {
				sum += measure(&report->frames.items[i], m);
				n++;
			}
		char name[64];
		snprintf(name, sizeof name, "mean_%s", measures[m].name);
		json_object_set_new(o, name, number(n ? sum / n : NAN));
	}
	return o;
}

static json_t *frames_json(const struct view_frames *frames)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < frames->count; i++)
		json_array_append_new(all, frame_json(&frames->items[i]));
	return all;
}

static json_t *report_json(const struct view_report *report)
{
	json_t *programs = json_array();
	for (uint32_t i = 0; i < VIEW_PROGRAM_COUNT; i++)
		if (report->programs >> i & 1)
			json_array_append_new(programs, json_string(view_program_names[i]));
	return json_pack("{s:o, s:o, s:o, s:I, s:I, s:b, s:o, s:o, s:o, s:o}",
		"scene", text_json(report->scene), "renderer", text_json(report->renderer),
		"reference", text_json(report->reference),
		"width", (json_int_t)report->width, "height", (json_int_t)report->height,
		"complete", (int)report->complete, "shaders", programs, "frames",
			frames_json(&report->frames),
		"parts", frames_json(&report->parts),
		"summary", summary_json(report));
}

enum eco_code view_report_write(const struct view_report *report, const char *dir, struct eco_error *error)
{
	char path[4096];
	if (snprintf(path, sizeof path, "%s/report.json", dir) >= (int)sizeof path)
		return eco_fail(error, ECO_BAD_USAGE, "the folder's name is too long");
	json_t *root = report_json(report);
	char *text = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
	if (!text || eco_json_lost())
		eco_end("no memory");
	enum eco_code code = eco_file_write(path, text, strlen(text), error);
	json_decref(root);
	free(text);
	return code;
}

void view_report_free(struct view_report *report)
{
	free(report->frames.items);
	free(report->parts.items);
	*report = (struct view_report){ 0 };
}

/* ---- Pictures ---- */

enum eco_code view_save(const char *dir, const char *format, uint32_t frame, const struct eco_pixels *pixels,
	struct eco_error *error)
{
	char name[64], path[4096];
	snprintf(name, sizeof name, format, frame);
	if (snprintf(path, sizeof path, "%s/%s", dir, name) >= (int)sizeof path)
		return eco_fail(error, ECO_BAD_USAGE, "-o: the folder's name is too long");
	return eco_png_write(pixels, path, error);
}

enum eco_code view_save_dir(const char *dir, struct eco_error *error)
{
	char path[4096];
	if (!*dir || snprintf(path, sizeof path, "%s", dir) >= (int)sizeof path)
		return eco_fail(error, ECO_BAD_USAGE, "-o takes a folder's name of at most %zu characters",
			sizeof path - 1);
	for (char *at = path + 1;; at++) {
		char kept = *at;
		if (kept && kept != '/')
			continue;
		*at = '\0';
		if (mkdir(path, 0777) && errno != EEXIST)
			return eco_fail_write(error, path, errno);
		*at = kept;
		if (!kept)
			break;
	}
	struct stat status;
	if (stat(dir, &status) || !S_ISDIR(status.st_mode))
		return eco_fail(error, ECO_IO, "%s is not a folder", dir);
	return ECO_OK;
}

/* ---- Signals ---- */

volatile sig_atomic_t view_interrupted;

static void on_signal(int number)
{
	(void)number;
	view_interrupted = 1;
}

void view_catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND };
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
}
