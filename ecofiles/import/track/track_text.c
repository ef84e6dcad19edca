/* Texts of recordings: lines, numbers, clocks and dates, without the C library's locale. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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
	while (at + length < end && length < sizeof copy - 1 && at[length] && strchr("+-.0123456789eE", at[length])) {
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

int track_by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

bool track_is_number(const char *text, const char *end, double *value)
{
	double number;
	if (!track_number(&text, end, &number) || skip_spaces(text, end) != end)
		return false;
	*value = number;
	return true;
}

int track_digits(const char *text, const char *end, int count)
{
	int value = 0;
	for (int i = 0; i < count; i++) {
		if (text + i >= end || !is_digit(text[i]))
			return -1;
		value = value * 10 + (text[i] - '0');
	}
	return value;
}

bool track_starts(const char *text, const char *end, const char *word)
{
	size_t length = strlen(word);
	return (size_t)(end - text) >= length && strncasecmp(text, word, length) == 0;
}

const char *track_find(const char *text, const char *end, const char *word)
{
	for (; text < end; text++)
		if (track_starts(text, end, word))
			return text;
	return NULL;
}

/* ---- Time ---- */

/* Days from civil, Howard Hinnant's chrono-compatible algorithms: years from March, so that leap days come last. */
double track_days(int year, int month, int day)
{
	int y = month <= 2 ? year - 1 : year, era = (y >= 0 ? y : y - 399) / 400, of_era = y - era * 400;
	int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
	int days = of_era * 365 + of_era / 4 - of_era / 100 + of_year;
	return era * 146097.0 + days - 719468;
}

/* One or more digits, at most four. */
static bool read_whole(const char **text, const char *end, int *value, int *digits)
{
	*value = *digits = 0;
	while (*text < end && is_digit(**text) && *digits < 4) {
		*value = *value * 10 + (*(*text)++ - '0');
		(*digits)++;
	}
	return *digits > 0;
}

static void read_fraction(const char **text, const char *end, double *time_s)
{
	const char *at = *text;
	if (at + 1 >= end || !strchr(".,", *at) || !is_digit(at[1]))
		return;
	double place = 0.1;
	for (at++; at < end && is_digit(*at); at++, place /= 10)
		*time_s += place * (*at - '0');
	/* milliseconds, microseconds: 58,720,764 */
	if (at - *text == 4 && **text == ',' && *at == ',' && track_digits(at + 1, end, 3) >= 0) {
		*time_s += 1e-6 * track_digits(at + 1, end, 3);
		at += 4;
	}
	*text = at;
}

bool track_clock(const char **text, const char *end, double *time_s)
{
	const char *at = skip_spaces(*text, end);
	int hour, minute, second = 0, digits;
	if (!read_whole(&at, end, &hour, &digits) || at >= end || *at++ != ':' || !read_whole(&at, end, &minute, &digits) || minute > 59)
		return false;
	if (at < end && *at == ':') {
		at++;
		if (!read_whole(&at, end, &second, &digits) || second > 60)
			return false;
	}
	*time_s = hour * 3600.0 + minute * 60 + second;
	read_fraction(&at, end, time_s);
	*text = at;
	return true;
}

static void read_zone(const char **text, const char *end, double *time_s)
{
	const char *at = *text;
	int sign = at < end && *at == '-' ? -1 : at < end && *at == '+' ? 1 : 0;
	if (at < end && (*at == 'Z' || *at == 'z'))
		*text = at + 1;
	int hours = sign ? track_digits(at + 1, end, 2) : -1;
	if (hours < 0)
		return;
	at += 3;
	int minutes = track_digits(at + (at < end && *at == ':'), end, 2);
	*time_s -= sign * (hours * 3600.0 + (minutes > 0 ? minutes * 60 : 0));
	*text = minutes < 0 ? at : at + (*at == ':') + 2;
}

bool track_date_time(const char **text, const char *end, double *time_s)
{
	const char *at = skip_spaces(*text, end);
	int part[3], digits[3];
	char mark = 0;
	for (int i = 0; i < 3; i++) {
		if (i && (at >= end || !strchr("-./", *at) || (i == 2 && *at != mark)))
			return false;
		if (i)
			mark = *at++;
		if (!read_whole(&at, end, &part[i], &digits[i]))
			return false;
	}
	bool year_first = digits[0] == 4;
	if (!year_first && digits[2] != 4)
		return false;
	int year = part[year_first ? 0 : 2], month = part[1], day = part[year_first ? 2 : 0];
	/* 4/25/2020 is American */
	if (!year_first && mark == '/' && day <= 12) {
		int swap = month;
		month = day;
		day = swap;
	}
	if (month < 1 || month > 12 || day < 1 || day > 31)
		return false;
	*time_s = track_days(year, month, day) * 86400;
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

/* ---- Names ---- */

int track_compare_names(const char *a, const char *b)
{
	while (*a && *b) {
		if (is_digit(*a) && is_digit(*b)) {
			size_t la, lb;
			while (*a == '0')
				a++;
			while (*b == '0')
				b++;
			la = strspn(a, "0123456789");
			lb = strspn(b, "0123456789");
			if (la != lb)
				return la < lb ? -1 : 1;
			int order = strncmp(a, b, la);
			if (order)
				return order;
			a += la;
			b += lb;
		} else if (*a != *b)
			return (unsigned char)*a < (unsigned char)*b ? -1 : 1;
		else {
			a++;
			b++;
		}
	}
	return *a ? 1 : *b ? -1 : 0;
}
