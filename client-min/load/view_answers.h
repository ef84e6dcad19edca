/* Answers of a load test, a record each: every figure of its report is a column of these records.
 *
 *   view_answers_add(&answers, &answer);             while it runs
 *   view_answers_column(&answers, &VIEW_COLUMNS[i], VIEW_GROUP_ALL, &column);   sorted, once it is over
 *   view_quantile(column.values, column.count, 0.99);
 *   view_column_free(&column);
 * */
#ifndef VIEW_ANSWERS_H
#define VIEW_ANSWERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum view_outcome {
	VIEW_ANSWERED,                   /* with a picture, or with 204: none fits in the bytes */
	VIEW_CONNECTION,                 /* no connection */
	VIEW_BROKEN,                     /* the answer ended too soon */
	VIEW_LATE,                       /* not whole at its deadline */
	VIEW_BUSY,                       /* 503 */
	VIEW_REFUSED,                    /* another status of 400 and above */
	VIEW_DAMAGED,                    /* a stream that is not well */
	VIEW_UNFINISHED,                 /* due before the end, and not answered some time after it */
	VIEW_OTHER,                      /* such as want of memory */
	VIEW_OUTCOMES
};
extern const char *const view_outcome_names[VIEW_OUTCOMES];

/* Times are milliseconds since the answer was due; NaN: that did not happen. In a closed loop a request is
 * due when the last answer has come; in an open loop when its schedule says, so that a server that stalls
 * also has the time that requests waited behind others on its account (coordinated omission). */
struct view_answer {
	double due_ms;                   /* since the run began */
	float asked_ms, first_byte_ms, picture_ms, q80_ms, q90_ms, done_ms;
	float service_ms;                /* from asking to the end, as a closed loop sees it */
	float plan_ms;                   /* as the server says */
	float predicted_q;               /* of the last plan */
	uint64_t bytes, vertices;
	uint32_t client, frame;
	uint16_t status;                 /* of HTTP; 0: there was none */
	uint8_t outcome;                 /* enum view_outcome */
	bool cold, nothing;              /* the client held nothing; the answer was 204 */
	uint8_t resumed;                 /* so many times it broke off and was asked for again */
};

struct view_answers { struct view_answer *items; uint32_t count, room; };    /* owns its items */

/* False: no memory. */
bool view_answers_add(struct view_answers *answers, const struct view_answer *answer);
void view_answers_free(struct view_answers *answers);

/* ---- Columns ---- */

enum view_group { VIEW_GROUP_ALL, VIEW_GROUP_WARM, VIEW_GROUP_COLD, VIEW_GROUPS };
extern const char *const view_group_names[VIEW_GROUPS];

struct view_column_kind {
	const char *name;                /* as in JSON and CSV */
	const char *title;
	size_t offset;                   /* of a float in struct view_answer */
	bool given_up;                   /* also of answers that were given up: their time until then */
};
enum { VIEW_COLUMN_LATENCY, VIEW_COLUMN_SERVICE, VIEW_COLUMN_FIRST_BYTE, VIEW_COLUMN_PICTURE, VIEW_COLUMN_Q80,
	VIEW_COLUMN_Q90, VIEW_COLUMN_PLAN, VIEW_COLUMNS_COUNT };
extern const struct view_column_kind view_columns[VIEW_COLUMNS_COUNT];

/* Values that are not NaN, ascending; `of`: answers of the group that could have had one. */
struct view_column { float *values; uint32_t count, of; };

float view_answer_value(const struct view_answer *answer, const struct view_column_kind *kind);
/* False: no memory. */
bool view_answers_column(const struct view_answers *answers, const struct view_column_kind *kind,
	enum view_group group, struct view_column *column);
void view_column_free(struct view_column *column);
/* Bytes of each client together, ascending: `clients` values. */
bool view_answers_client_bytes(const struct view_answers *answers, uint32_t clients,
	struct view_column *column);

/* The least of the ascending values that a share of them does not exceed; NaN without values. */
double view_quantile(const float *values, uint32_t count, double share);
#define VIEW_QUANTILES 5
extern const struct view_quantile_kind { const char *name; double share; } view_quantiles[VIEW_QUANTILES];

#endif
