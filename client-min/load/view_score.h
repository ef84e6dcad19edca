/* Precision and Recall of a sample of the views of a load test: after it, each is asked for once more by a
 * client that holds nothing, drawn in software, and scored against every triangle of the scene. So the load
 * is not disturbed, and what the server predicts of its answers is seen to hold. */
#ifndef VIEW_SCORE_H
#define VIEW_SCORE_H

#include "client-min/load/view_load.h"
#include "client-min/view_fetch.h"

struct view_scored { uint32_t frame; double predicted_q, q, precision, recall; };

/* `count` of the views that were answered, evenly spread over the run, into scored[0 .. *done). */
enum eco_code view_score_sample(const struct view_load_options *options, const struct view_answers *answers,
	struct view_fetch *fetch, uint32_t count, struct view_scored *scored, uint32_t *done,
	struct eco_error *error);

#endif
