/* ecobench: error against run time, for the methods of the literature and ours, on the same scenes.
 *
 *   each section is a file bench_NAME.c with one `const struct bench_section`; ecobench.c lists them
 *   a section works in units, each a JSON value that is kept on disk: the next run makes missing ones only
 *   its units become tables (CSV), plots, pictures, paragraphs of report.html, and keys of summary.json
 *
 * A unit is kept under a stamp: this program, and the section's own (packs, number of views). A change of
 * these makes the unit anew. */
#pragma once

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "client-min/view_measure.h"
#include "ecofiles/base/progress.h"
#include "ecofiles/base/status.h"
#include "ecofiles/format/model.h"
#include "ecofiles/format/plan.h"
#include "lod/plan/planner.h"
#include "lod/raster/raster.h"

struct bench {
	const char *build;           /* folder of the programs: build, or build/CONFIG */
	const char *out;             /* build/bench: CSV, plots, report.html, summary.json */
	const char *cache;           /* build/bench/cache: scenes, packs, units */
	/* folder with models/, inventories/, terrain/; NULL: generated scenes only */
	const char *data;
	bool full;                   /* all methods and scenes; else fewer frames, the same keys */
	bool quiet;
	struct view_sky sky;         /* of pictures that are judged: with shadows, as ecoview draws, or without */
};

struct bench_section {
	const char *name, *title;
	void (*run)(struct bench *bench);
};
/* The whole program: reads the command line, runs sections (NULL ends), returns the exit status. */
int bench_main(int argc, char **argv, const struct bench_section *const *sections);

/* Ends the section, which has failed, unless `code` is ECO_OK; must_error, to which the call fails, says why.
 * Functions of this header that return no code end it likewise. */
extern struct eco_error *const must_error;
void must(enum eco_code code);
void bench_progress(double share, const char *what);
/* Runs a shell command and waits. Ctrl-C ends this program, too. */
void bench_command(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* ---- Units ---- */

/* The unit of this name and stamp, from an earlier run or from `make`, which gives up its reference. Borrowed
 * until the section ends. `stamp` may be NULL. */
json_t *bench_unit(struct bench *bench, const char *unit, const char *stamp, json_t *(*make)(void *ctx), void *ctx);
/* Numbers as a JSON array, null for what is not finite; a cell, or the first `count`, NaN for what is no
 * number. */
json_t *bench_reals(const double *values, uint32_t count);
double bench_cell(const json_t *array, size_t i);
void bench_cells(const json_t *array, double *values, uint32_t count);
/* Hash of a file's bytes; 0 where it cannot be read. */
uint64_t bench_file_hash(const char *path);

/* ---- Results ---- */

/* A CSV file in `out`; the same rows as a table in the report where `show`. `columns` and rows hold cells
 * separated by commas, as many in each, without commas inside. */
struct bench_table;
struct bench_table *bench_table_open(struct bench *bench, const char *name, const char *columns, bool show);
void bench_table_row(struct bench_table *table, const char *format,
	...) __attribute__((format(printf, 2, 3)));
void bench_table_close(struct bench_table *table);
/* A table whose columns after `first` hold numbers: a row is its first cells and the numbers. */
struct bench_column { const char *head; unsigned decimals; };
struct bench_table *bench_table_described(struct bench *bench, const char *name, const char *first,
	const struct bench_column *columns, uint32_t count, bool show);
void bench_table_values(struct bench_table *table, const double *values, const char *format,
	...) __attribute__((format(printf, 3, 4)));

/* A figure of summary.json; NaN becomes null: not reached, and the report says why. `bar` names the figure to
 * reach, in words. */
void bench_key(struct bench *bench, const char *key, double value, const char *bar);

/* A heading within the section, and a paragraph: plain text, escaped. */
void bench_head(struct bench *bench, const char *text);
void bench_say(struct bench *bench, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A plant, scene or view that only FULL=1 looks at: the section's last paragraph names them. */
void bench_left_out(struct bench *bench, const char *name);

/* Lines over a common axis, as NAME.png and in the report (report.py draws them). NaN interrupts a line. */
struct bench_series { const char *name; const double *x, *y; uint32_t count; bool points; };
struct bench_plot {
	const char *name, *title, *x, *y;
	bool log_x, log_y;
	const struct bench_series *series;
	uint32_t series_count;
};
void bench_plot(struct bench *bench, const struct bench_plot *plot);
/* A PNG of `out` in the report. */
void bench_picture(struct bench *bench, const char *file, const char *caption);
/* Writes one: 3 bytes a pixel, rows from the top. */
void bench_picture_write(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	const uint8_t *rgb);
/* Pictures of one size beside each other. */
void bench_pictures_write(struct bench *bench, const char *file, uint32_t width, uint32_t height,
	const uint8_t *const *rgb, uint32_t count);

/* ---- Scenes and plants (bench_scene.c, bench_models.c) ---- */

/* Plant models of the data folder, then generated ones, by number of leaves: files that read as one plant
 * each. A quick bench that stops after some sees many, and the sparse ones, which are hard. */
struct bench_model { char name[64], path[512]; bool generated; uint32_t leaves; };
struct bench_model *bench_models(struct bench *bench, uint32_t *count);
/* Reads one (in a child process). The caller frees it with eco_model_free. */
void bench_model_read(const struct bench_model *model, struct eco_model *out);

/* The tree of 6,143 leaves (bench_crown.c): as a model, which the caller frees; as FOLDER/NAME.obj and .mtl. */
struct eco_model bench_crown_make(void);
enum eco_code bench_crown_write(const char *folder, const char *name, struct eco_error *error);

/* The pack of a scene (crown, trees640, palms, outdoor, sunflowers, trees1276, trees5000, park, grove,
 * forest, city, scbi), built with `ecopack` if it is not there (order: "greedy", "combined", ...; NULL: the
 * default). Writes its path. */
void bench_scene(struct bench *bench, const char *name, const char *order, char path[512]);
/* False where the quick bench leaves the scene out: the report says so. */
bool bench_scene_asked(struct bench *bench, const char *name);
/* False, too, where the scene needs data that is not there (scbi): the report says so. Makes its pack. */
bool bench_scene_there(struct bench *bench, const char *name, char pack[512]);
/* The pack of one model, made anew each time; its plant comes from a cache. */
void bench_model_pack(struct bench *bench, const struct bench_model *model, char pack[512]);
/* Stamp of the pack's content for units: the same for the same bytes. Borrowed until the next call. */
const char *bench_pack_stamp(const char *path);
/* Its cameras: `room` requests along the scene's path; views never used in building. Returns their number. */
uint32_t bench_scene_views(struct bench *bench, const char *name, struct eco_request *requests,
	uint32_t room);

/* ---- One picture (bench_frame.c): plan -> stream -> decode -> draw -> score, in this process, each step
 * timed ---- */

#define BENCH_SAMPLES 8u                 /* a pixel of pictures that are judged: what ecoview draws */

/* Figures of the truth of a view: processor time of drawing it, also where it was kept; picture error of full
 * detail with BENCH_SAMPLES samples (F8) and with one (F1); lod_q_ceiling. */
struct bench_truth { double cpu_ms, floor, floor_one, ceiling; };
#define BENCH_TRUTH_FIGURES 4u

/* zero with rule, occlusion, look and request set asks; the rest is the answer */
struct bench_frame {
	lod_rule *rule;
	bool ignore_occlusion;
	/* called with the job of the picture, while it can be drawn; may be NULL */
	void (*look)(void *ctx, const struct view_draw_job *job);
	void *ctx;
	struct eco_request request;
	double predicted_q, colour_rms;      /* of sRGB bytes / 255 over pixels covered in either */
	/* Against the truth, with BENCH_SAMPLES samples a pixel; all but the score is NaN of a client that does not see. */
	struct view_measures measures;
	struct bench_truth truth;
	uint64_t vertices, bytes;
	double plan_ms, decode_ms, draw_ms;
};
struct bench_client;                 /* a pack open for many frames: a server's half and a viewer's half */
struct bench_client *bench_client_open(const char *pack);
void bench_client_close(struct bench_client *client);                /* NULL is fine */
/* From now on frames are judged by the truth of their view, which `bench` keeps: they take many times longer. */
void bench_client_see(struct bench_client *client, struct bench *bench);
/* From now on OpenGL draws nothing: draw_ms is the rasteriser's. */
void bench_client_untimed(struct bench_client *client);
/* Full detail of the request's view, or the nearest to it that a plan may come, drawn by the CPU rasteriser
 * and kept for this view; with the colours of the truth where the client sees. */
void bench_client_reference(struct bench_client *client, const struct eco_request *request);
/* The last reference. */
const struct view_picture *bench_client_full(const struct bench_client *client);
/* Scores a picture of the last reference's view that was drawn elsewhere: fills measures, truth and
 * colour_rms. A client that sees wants BENCH_SAMPLES and soft counts. */
void bench_client_score(const struct bench_client *client, struct bench_frame *frame,
	const struct view_picture *picture);
/* Plants and tiles that are coarse even in the last reference; 0: it is full detail. */
uint64_t bench_client_coarse(const struct bench_client *client);
/* `picture` may be NULL; if not, the caller frees it. Draws from an empty client: bytes are those of a first
 * visit. */
void bench_client_frame(struct bench_client *client, struct bench_frame *frame, struct view_picture *picture);
/* Milliseconds in which OpenGL draws a selection the second time; NaN where there is no OpenGL. */
struct view_store;
struct view_selection;
double bench_gl_ms(const struct view_store *store, const struct view_selection *selection,
	const struct eco_view *view);
/* Writes that picture beside the truth of the same view and the error that people see, as `file` of the
 * report's folder, with words under each (ASCII). Only of a client that sees. */
void bench_client_compare(struct bench_client *client, struct bench *bench, const char *file,
	const struct view_picture *picture, const char *const words[3]);
