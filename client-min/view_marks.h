/* Where in an answer that arrives a picture is drawn: after so many bytes, or milliseconds. */
#ifndef VIEW_MARKS_H
#define VIEW_MARKS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define VIEW_MARKS_MAX 64u

struct view_marks {
	uint64_t bytes[VIEW_MARKS_MAX], ms[VIEW_MARKS_MAX];     /* each ascending */
	uint32_t bytes_count, ms_count;
};

/* Such as "20000,50000" or "200ms,1000ms,20000": numbers from 1 on, in any order. ECO_BAD_USAGE says what is
 * wrong with which of them. */
enum eco_code view_marks_read(struct view_marks *marks, const char *text, struct eco_error *error);

/* How far an answer has come in them. */
struct view_marks_at { uint32_t bytes, ms; };

/* Bytes from `now` on up to the next mark: at least 1. UINT64_MAX: there is none. */
uint64_t view_marks_room(const struct view_marks *marks, const struct view_marks_at *at, uint64_t now);
/* Steps over the marks that have been reached; true if there was one. */
bool view_marks_pass(const struct view_marks *marks, struct view_marks_at *at, uint64_t bytes, double ms);

#endif
