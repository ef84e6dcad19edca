/* A load test's report: for people, as JSON, and as CSV with a line an answer. */
#ifndef VIEW_LOAD_REPORT_H
#define VIEW_LOAD_REPORT_H

#include <jansson.h>
#include <stdio.h>

#include "client-min/load/view_load.h"
#include "client-min/view_fetch.h"

struct view_scored { uint32_t frame; double predicted_q, q, precision, recall; };

struct view_load_summary {               /* what a report is written from; nothing of it is owned */
	const struct view_load_options *options;
	const struct view_load_report *report;
	const char *camera;                      /* as it was given */
	const struct view_scored *scored; uint32_t scored_count;
};

/* All of these: ECO_NO_MEMORY, or ECO_IO for a file, which appears whole or not at all. */
enum eco_code view_load_print(const struct view_load_summary *summary, FILE *out, struct eco_error *error);
enum eco_code view_load_json(const struct view_load_summary *summary, json_t **json, struct eco_error *error);
enum eco_code view_load_csv(const struct view_load_summary *summary, const char *path,
	struct eco_error *error);

/* Scores a sample of a run's views: after it, each is asked for once more by a client that holds nothing,
 * drawn in software, and scored against every triangle of the scene. So the load is not disturbed, and what
 * the server predicts of its answers is seen to hold.
 *
 * `count` of the views that were answered, evenly spread over the run, into scored[0 .. *done). */
enum eco_code view_score_sample(const struct view_load_options *options, const struct view_answers *answers,
	struct view_fetch *fetch, uint32_t count, struct view_scored *scored, uint32_t *done,
	struct eco_error *error);

#endif
