/* A load test's report: for people, as JSON, and as CSV with a line an answer. */
#ifndef VIEW_LOAD_REPORT_H
#define VIEW_LOAD_REPORT_H

#include <jansson.h>
#include <stdio.h>

#include "client-min/load/view_load.h"
#include "client-min/load/view_score.h"

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

#endif
