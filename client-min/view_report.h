/* Figures of a frame, as a line for people and as report.json for scripts. NaN is null: not applicable, or
 * not measured. */
#pragma once

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>

#include "client-min/view_fetch.h"
#include "client-min/view_measure.h"
#include "ecofiles/format/image.h"
#include "ecofiles/format/plan.h"

struct view_frame {
	uint32_t frame;
	double time_s;
	uint64_t budget_vertices, vertices;
	uint64_t budget_bytes;                   /* ECO_BYTES_UNBOUNDED: null */
	struct view_fetch_result fetched;        /* all answers that the frame took */
	struct view_measures measures;
	double ceiling, predicted_q, predicted_m16, decode_ms, draw_ms, reference_ms;
	double truth_cpu_ms;                     /* processor time of drawing the truth; NaN: there is none */
	/* picture errors of 64 samples of the cuts, and of full detail at the picture's own samples */
	double bias, floor;
	struct view_motion motion;               /* since the frame before */
	double shadow_ms, shadow_texels;         /* view_picture's, where shadows are cast */
	/* decoded bytes held after it; chunks that went while it came, and bytes fetched that had been
	 * fetched
	 * before */
	uint64_t memory_bytes, evictions, again_bytes;
	double reference_coarse;                 /* plants and tiles drawn coarsely there: 0 where it is full detail */
};

struct view_frames { struct view_frame *items; uint32_t count, room; };

struct view_report {                             /* owns `frames` and `parts` */
	struct view_frames frames;
	/* pictures of frames that had come in part: bytes and stream_ms are those until then */
	struct view_frames parts;
	const char *scene, *renderer, *reference;    /* reference: "cpu", "egl" or NULL */
	/* of OpenGL, that were compiled: bits of enum view_program */
	uint32_t programs;
	uint32_t width, height;
	/* of decoded data: allowed (0: no limit was given), and held at most */
	uint64_t memory_max, memory_peak_bytes;
	bool complete;                           /* every frame that was asked for is here */
};

/* A frame with everything that may be missing set to NaN. */
struct view_frame view_frame_empty(uint32_t frame, double time_s, const struct eco_request *request);
/* ECO_DAMAGED if more was drawn, or came in one answer, than the frame's budgets. */
enum eco_code view_frame_check(const struct view_frame *frame, struct eco_error *error);

void view_frames_add(struct view_frames *frames, const struct view_frame *frame);
/* is_part: what was there after so many bytes and milliseconds. */
void view_report_line(const struct view_frame *frame, bool is_part, FILE *out);
/* A line on memory, if anything had to go for want of it. */
void view_report_memory_line(const struct view_report *report, FILE *out);
/* Writes DIR/report.json beside and renames it. */
enum eco_code view_report_write(const struct view_report *report, const char *dir, struct eco_error *error);
void view_report_free(struct view_report *report);

/* ---- Pictures, as files of the same folder ---- */

/* Makes the folder, and those that it lies in, where they are missing. */
enum eco_code view_save_dir(const char *dir, struct eco_error *error);

/* Writes DIR/NAME, a PNG; `format` makes the name of the frame's number. */
enum eco_code view_save(const char *dir, const char *format, uint32_t frame, const struct eco_pixels *pixels,
	struct eco_error *error) __attribute__((format(printf, 2, 0)));

/* A score as people read it: four decimals, or "-" where there is none. Returns `text`. */
#define VIEW_SCORE_BYTES 24
const char *view_report_score(char text[VIEW_SCORE_BYTES], double v);

/* ---- Programs ---- */

/* Set by Ctrl-C or SIGTERM once view_catch_signals was called; a second signal ends the program at once. */
extern volatile sig_atomic_t view_interrupted;
void view_catch_signals(void);
