/* Why each cut of each frame's plan is what it is, as a table for a spreadsheet: what the server's
 * plan?explain=1 says (server/openapi.yaml).
 *
 *   view_explain_open(&explain, "why.csv", &error);
 *   view_explain_frame(&explain, fetch, frame, &request, &error);
 *   view_explain_close(&explain, keep, &error);            the file appears complete or not at all */
#ifndef VIEW_EXPLAIN_H
#define VIEW_EXPLAIN_H

#include <stdio.h>

#include "client-min/view_fetch.h"

struct view_explain {
	const char *path;
	char *beside;
	FILE *out;                   /* NULL: nothing is explained */
};

enum eco_code view_explain_open(struct view_explain *explain, const char *path, struct eco_error *error);
enum eco_code view_explain_frame(struct view_explain *explain, struct view_fetch *fetch, uint32_t frame,
	const struct eco_request *request, struct eco_error *error);
enum eco_code view_explain_close(struct view_explain *explain, bool keep, struct eco_error *error);

/* The rows of a plan's JSON, as lines. */
enum eco_code view_explain_write(FILE *out, uint32_t frame, const char *json, struct eco_error *error);

#endif
