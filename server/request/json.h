/* Writes JSON into a growing buffer: commas, indentation-free nesting and escapes are taken care of; the
 * caller says what.
 *
 *   srv_json_open(&json, '{');
 *   srv_json_key(&json, "vertices");  srv_json_count(&json, plan->vertices);
 *   srv_json_close(&json, '}');
 *
 * A writer of our own, because counts go up to 2^63 and plans have ten thousands of cuts, which a tree of
 * objects would hold twice. Nothing more is written once json.out.failed is set: without memory, beyond `most`,
 * or when it is cancelled. Long loops end then; srv_json_end says why. */
#ifndef SRV_JSON_H
#define SRV_JSON_H

#include <stdatomic.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"

struct srv_json {
	struct eco_writer out;
	bool comma;                  /* the next value or key follows another */
	size_t most;                 /* bytes, about; 0: any number */
	const atomic_bool *cancelled;        /* or NULL */
};

/* ECO_INTERRUPTED, ECO_TOO_LARGE or ECO_NO_MEMORY where it is not whole; frees it then. */
enum eco_code srv_json_end(struct srv_json *json);

void srv_json_open(struct srv_json *json, char bracket);         /* '{' or '[' */
void srv_json_close(struct srv_json *json, char bracket);        /* '}' or ']' */
void srv_json_key(struct srv_json *json, const char *key);
/* NULL: null; bytes that are not UTF-8 become U+FFFD */
void srv_json_text(struct srv_json *json, const char *text);
void srv_json_count(struct srv_json *json, uint64_t value);
void srv_json_bool(struct srv_json *json, bool value);
void srv_json_null(struct srv_json *json);
void srv_json_point(struct srv_json *json, const double value[3]);

/* "key": value in one call. Numbers are the shortest that read back the same; those that are not finite are
 * null. */
void srv_json_key_open(struct srv_json *json, const char *key, char bracket);
void srv_json_key_text(struct srv_json *json, const char *key, const char *text);
void srv_json_key_count(struct srv_json *json, const char *key, uint64_t value);
void srv_json_key_number(struct srv_json *json, const char *key, double value);
/* Nine digits, which a float has at most: in a third of the time. */
void srv_json_key_figure(struct srv_json *json, const char *key, double value);
void srv_json_key_bool(struct srv_json *json, const char *key, bool value);

#endif
