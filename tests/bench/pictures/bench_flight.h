/* A flight through a scene: its path, its pictures in full detail, and the video that x264 makes of them.
 *
 *   struct bench_flight flight = { .scene = .., .pack = .., .count = .., .every = .. };
 *   bench_flight_path(&flight, first, &error);                  its views
 *   bench_flight_reference(bench, &flight, &error);             draws what is not drawn yet
 *           bench_flight_full(&flight, n, &picture, &error);        full detail of the n-th scored frame
 *           bench_flight_video(bench, &flight, &coding, &row, &error);  encodes, decodes and scores
 *   free(flight.views);
 *
 * Every `every`-th frame is scored, the one in the middle of as many, so that neither the first frame of a
 * video, which is the best, nor a first visit is favoured. */
#ifndef TESTS_BENCH_FLIGHT_H
#define TESTS_BENCH_FLIGHT_H

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench_shots.h"

#define BENCH_FLIGHT_FPS 10u
#define BENCH_FLIGHT_S 60u               /* a whole flight */
#define BENCH_FLIGHT_FRAMES (BENCH_FLIGHT_FPS * BENCH_FLIGHT_S)
#define BENCH_FLIGHT_PIXELS ((size_t)BENCH_SHOT_WIDTH * BENCH_SHOT_HEIGHT)

struct bench_flight {
	const char *scene, *pack;
	uint32_t count, every;           /* frames; count is a multiple of every */
	struct eco_view *views;          /* count; the caller frees them */
	char stamp[128], files[1200];    /* of what is kept; how the names of its files begin */
};

/* The views of `count` frames from frame `first` of BENCH_FLIGHT_FRAMES on: from the air down to eye level in
 * a third of the time, then along the longer side of the scene's bounds through it. */
enum eco_code bench_flight_path(struct bench *bench, struct bench_flight *flight, uint32_t first,
	struct eco_error *error);

/* Number of scored frames, and the n-th of them. */
static inline uint32_t bench_flight_scored(const struct bench_flight *flight)
{
	return flight->count / flight->every;
}
static inline uint32_t bench_flight_frame(const struct bench_flight *flight, uint32_t n)
{
	return n * flight->every + flight->every / 2;
}

/* Full detail of all frames, in pieces of `every` frames that are kept. *draw_ms: mean of a frame. */
enum eco_code bench_flight_reference(struct bench *bench, const struct bench_flight *flight, double *draw_ms,
	struct eco_error *error);
/* rgb, cover and owner of what bench_flight_reference drew; the caller frees the picture. */
enum eco_code bench_flight_full(const struct bench_flight *flight, uint32_t n, struct view_picture *picture,
	struct eco_error *error);

/* Colours of a scored frame as `what` drew it: kept for the report, and read again. Reading: false where they
 * are not there. */
enum eco_code bench_flight_keep(const struct bench_flight *flight, const char *what, const uint8_t *rgb,
	struct eco_error *error);
bool bench_flight_kept(const struct bench_flight *flight, const char *what, uint8_t *rgb);
#define BENCH_FLIGHT_SHOWN(flight) (bench_flight_scored(flight) / 2)       /* the scored frame shown */

bool bench_flight_has_x264(void);
/* 4:4:4, else 4:2:0; x264's rate factor */
struct bench_flight_coding { bool whole_chroma; uint32_t crf; };
void bench_flight_coding_name(const struct bench_flight_coding *coding, char name[32]);
/* {"bytes", "picture_error"} of a video of all frames, picture error as a mean over the scored frames;
 * borrowed. Keeps what it shows (bench_flight_kept) under the coding's name. */
enum eco_code bench_flight_video(struct bench *bench, const struct bench_flight *flight,
	const struct bench_flight_coding *coding, json_t **row, struct eco_error *error);

#endif
