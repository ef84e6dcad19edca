#include "client-min/view_marks.h"

#include <stdlib.h>
#include <string.h>

#define MARK_MOST (UINT64_C(1) << 50)

static int ascending(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

enum eco_code view_marks_read(struct view_marks *marks, const char *text, struct eco_error *error)
{
	*marks = (struct view_marks){ 0 };
	for (const char *at = text;; at++) {
		char *end;
		unsigned long long value = *at >= '0' && *at <= '9' ? strtoull(at, &end, 10) : 0;
		bool ms = value && !strncmp(end, "ms", 2);
		if (!value || value > MARK_MOST || (end[ms ? 2 : 0] && end[ms ? 2 : 0] != ','))
			return eco_fail(error, ECO_BAD_USAGE, "'%.40s': must be numbers of bytes or of "
				"milliseconds, such as 20000,50000,200ms", at);
		if (marks->bytes_count + marks->ms_count == VIEW_MARKS_MAX)
			return eco_fail(error, ECO_BAD_USAGE, "more than %u marks", VIEW_MARKS_MAX);
		if (ms)
			marks->ms[marks->ms_count++] = value;
		else
			marks->bytes[marks->bytes_count++] = value;
		at = end + (ms ? 2 : 0);
		if (!*at)
			break;
	}
	qsort(marks->bytes, marks->bytes_count, sizeof *marks->bytes, ascending);
	qsort(marks->ms, marks->ms_count, sizeof *marks->ms, ascending);
	return ECO_OK;
}

uint64_t view_marks_room(const struct view_marks *marks, const struct view_marks_at *at, uint64_t now)
{
	for (uint32_t i = at->bytes; i < marks->bytes_count; i++)
		if (marks->bytes[i] > now)
			return marks->bytes[i] - now;
	return UINT64_MAX;
}

bool view_marks_pass(const struct view_marks *marks, struct view_marks_at *at, uint64_t bytes, double ms)
{
	struct view_marks_at before = *at;
	while (at->bytes < marks->bytes_count && marks->bytes[at->bytes] <= bytes)
		at->bytes++;
	while (at->ms < marks->ms_count && (double)marks->ms[at->ms] <= ms)
		at->ms++;
	return at->bytes > before.bytes || at->ms > before.ms;
}
