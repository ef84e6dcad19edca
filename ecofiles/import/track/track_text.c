/* Texts of recordings: lines, numbers, clocks and dates, without the C library's locale. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "ecofiles/import/track/track_read.h"

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool track_next_line(const struct track_input *in, struct track_line *line)
{
	const char *last = in->text + in->size, *start = line->number ? line->end : in->text;
	/* behind the line's end: CR LF, LF, or the CR of old Macs */
	if (line->number && start < last)
		start += *start == '\r' && start + 1 < last && start[1] == '\n' ? 2 : 1;
	if (start >= last)
		return false;
	const char *end = start;
	while (end < last && *end != '\n' && *end != '\r')
		end++;
	*line = (struct track_line){ start, end, line->number + 1 };
	return true;
}

bool track_is(const char *text, const char *end, const char *word)
{
	return (size_t)(end - text) == strlen(word) && strncasecmp(text, word, strlen(word)) == 0;
}

bool track_holds(const char *text, const char *end, const char *word)
{
	size_t length = strlen(word);
	for (; (size_t)(end - text) >= length; text++)
		if (strncasecmp(text, word, length) == 0)
			return true;
	return false;
}

static const char *skip_spaces(const char *text, const char *end)
{
	while (text < end && (*text == ' ' || *text == '\t'))
		text++;
	return text;
}

bool track_number(const char **text, const char *end, double *value)
{
	char copy[64];
	size_t length = 0;
	const char *at = skip_spaces(*text, end);
	while (at + length < end && length < sizeof copy - 1 && at[length]
			&& strchr("+-.0123456789eE", at[length])) {
		copy[length] = at[length];
		length++;
	}
	copy[length] = 0;
	char *stop;
	double number = strtod(copy, &stop);
	if (stop == copy || !isfinite(number))
		return false;
	*value = number;
	*text = at + (stop - copy);
	return true;
}

/* ---- Time ---- */

/* Up to `most` digits as a whole number; how many there were. */
static int read_whole(const char **text, const char *end, int most, int *value)
{
	int digits = 0;
	for (*value = 0; *text < end && is_digit(**text) && digits < most; digits++)
		*value = *value * 10 + (*(*text)++ - '0');
	return digits;
}

/* .72 or ,720, or thousandths and millionths: ,720,764 */
static void read_fraction(const char **text, const char *end, double *time_s)
{
	double place = 0.1;
	for (const char *at = *text; at + 1 < end && (*at == '.' || *at == ',') && is_digit(at[1]);
			*text = at)
		for (at++; at < end && is_digit(*at); at++, place /= 10)
			*time_s += place * (*at - '0');
}

bool track_clock(const char **text, const char *end, double *time_s)
{
	const char *at = skip_spaces(*text, end);
	int hour, minute, second = 0;
	if (!read_whole(&at, end, 4, &hour) || at >= end || *at++ != ':' || !read_whole(&at, end, 4, &minute)
			|| minute > 59)
		return false;
	if (at < end && *at == ':' && (at++, !read_whole(&at, end, 4, &second) || second > 60))
		return false;
	*time_s = hour * 3600.0 + minute * 60 + second;
	read_fraction(&at, end, time_s);
	*text = at;
	return true;
}

static void read_zone(const char **text, const char *end, double *time_s)
{
	const char *at = *text;
	int sign = at < end && *at == '-' ? -1 : at < end && *at == '+' ? 1 : 0, hours, minutes;
	if (at < end && (*at == 'Z' || *at == 'z'))
		*text = at + 1;
	if (!sign || (at++, read_whole(&at, end, 2, &hours) < 2))
		return;
	*text = at;
	at += at < end && *at == ':';
	if (read_whole(&at, end, 2, &minutes) == 2)
		*text = at;
	else
		minutes = 0;
	*time_s -= sign * (hours * 3600.0 + minutes * 60);
}

bool track_date_time(const char **text, const char *end, double *time_s)
{
	const char *at = skip_spaces(*text, end);
	int year, month, day;
	if (read_whole(&at, end, 4, &year) != 4 || at >= end || !*at || !strchr("-./", *at))
		return false;
	char mark = *at++;
	if (!read_whole(&at, end, 2, &month) || at >= end || *at++ != mark || !read_whole(&at, end, 2, &day))
		return false;
	if (month < 1 || month > 12 || day < 1 || day > 31)
		return false;
	*time_s = (double)timegm(&(struct tm){ .tm_year = year - 1900, .tm_mon = month - 1, .tm_mday = day });
	double clock;
	const char *behind = at + (at < end && (*at == 'T' || *at == 't' || *at == '_'));
	if (track_clock(&behind, end, &clock)) {
		*time_s += clock;
		at = behind;
		read_zone(&at, end, time_s);
	}
	*text = at;
	return true;
}
