/* JSON from outside, read so that every error has a line and a column.
 *
 * jansson keeps no positions. A node here knows its parent; only when there is an error, the path from the
 * root to the value is walked in the text again. So reading costs nothing extra and no index is kept.
 *
 *   json_t *root = eco_json_open(&file);                                  file: name, text, size, error
 *   struct eco_json top = eco_json_root(&file, root);
 *   if (!eco_json_object(&top, fields) || !eco_json_number(&top, "fps", 0.001, 1000, &fps)) fail: file.error
 *   json_decref(root);
 *
 * Functions that return bool return false after an error; an absent optional field leaves *out alone and
 * is true. Texts returned live as long as the root. */
#pragma once

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct eco_json_file {
	const char *name, *text;
	size_t size;
	struct eco_error *error;     /* may be NULL */
};

struct eco_json {
	const struct eco_json_file *file;
	const struct eco_json *parent;       /* must outlive this node */
	const char *key;                     /* in an object, for messages; NULL in an array or at the root */
	/* among the parent's members or items, in the order of the text */
	size_t index;
	const json_t *value;                 /* NULL: absent */
};

/* Parses UTF-8, with or without a byte order mark. NULL after an error; a syntax error has the parser's
 * position. A key that comes twice is an error. */
json_t *eco_json_open(const struct eco_json_file *file);
struct eco_json eco_json_root(const struct eco_json_file *file, const json_t *root);
struct eco_json eco_json_member(const struct eco_json *object, const char *key);
/* Goes to the next member of an object; `member` is zero before the first. False behind the last. */
bool eco_json_next(const struct eco_json *object, struct eco_json *member);
struct eco_json eco_json_item(const struct eco_json *array, size_t index);

/* Writes the error "NAME:LINE:COLUMN: text" for the start of `at` (of its parent if it is absent). Returns
 * false, for `return`. */
bool eco_json_fail(const struct eco_json *at, enum eco_code code, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* Line and column (in characters, from 1) of a node. */
void eco_json_place(const struct eco_json *at, uint32_t *line, uint32_t *column);

/* An object with no members but `fields` (ends with NULL); the error names the unknown member and lists
 * the known ones. */
bool eco_json_object(const struct eco_json *at, const char *const *fields);
/* An object of at most count_max members whose keys are names, not fields. */
bool eco_json_names(const struct eco_json *at, size_t count_max);
bool eco_json_array(const struct eco_json *at, size_t count_max);
bool eco_json_required(const struct eco_json *object, const char *key);
/* A number in [low, high]. */
bool eco_json_number(const struct eco_json *object, const char *key, double low, double high, double *out);
bool eco_json_whole(const struct eco_json *object, const char *key, uint64_t low, uint64_t high,
	uint64_t *out);
bool eco_json_flag(const struct eco_json *object, const char *key, bool *out);       /* true or false */
/* `least` to `most` numbers; those not given stay as they are. */
bool eco_json_numbers(const struct eco_json *object, const char *key, size_t least, size_t most, double low,
	double high, double *out);
/* A text of 1 to bytes_max bytes. */
bool eco_json_text(const struct eco_json *object, const char *key, size_t bytes_max, const char **out);
bool eco_json_is_text(const struct eco_json *at, size_t bytes_max);

/* ---- Memory ---- */

/* jansson leaves out what it has no memory for, and mostly says nothing: json_object_set_new of a value that
 * was not made returns an error that few look at, and json_dumps drops keys. So a program asks once, at the
 * end of what it writes.
 *
 *   eco_json_watch();                                    first of all in main
 *   ... json_object_set_new(...) ... text = json_dumps(...);
 *   if (!text || eco_json_lost()) fail: no memory */

/* Before any other thread is there. For programs, not for libraries: there is one allocator for all of a
 * process. */
void eco_json_watch(void);
/* Has jansson lacked memory in this thread? */
bool eco_json_lost(void);
