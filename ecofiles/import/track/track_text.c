/* Texts of recordings: numbers, clocks and dates. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/import/track/track_read.h"

bool track_number(const char **text, double *value)
{
	const char *at = *text + strspn(*text, " \t");
	char *stop = NULL;
	double number = *at && strchr("+-.0123456789", *at) ? strtod(at, &stop) : NAN;
	if (!isfinite(number) || stop == at)
		return false;
	*value = number;
	*text = stop;
	return true;
}

/* ---- Time ---- */

/* .72 or ,720, or thousandths and millionths: ,720,764 */
static double read_fraction(const char **text)
{
	double place = 0.1, sum = 0;
	for (const char *at = *text; (*at == '.' || *at == ',') && at[1] >= '0' && at[1] <= '9'; *text = at)
		for (at++; *at >= '0' && *at <= '9'; at++, place /= 10)
			sum += place * (*at - '0');
	return sum;
}

bool track_clock(const char **text, double *time_s)
{
	unsigned hour, minute, second = 0;
	int used = 0;
	if (sscanf(*text, " %4u:%2u%n:%2u%n", &hour, &minute, &used, &second, &used) < 2 || hour > 9999
			|| minute > 59 || second > 60)
		return false;
	*text += used;
	*time_s = hour * 3600.0 + minute * 60 + second + read_fraction(text);
	return true;
}

/* Z, +02, +02:00 or +0200: seconds ahead of UTC. */
static double read_zone(const char *text)
{
	char sign;
	unsigned hours, minutes = 0;
	if (sscanf(text, "%c%2u:%2u", &sign, &hours, &minutes) < 3
			&& sscanf(text, "%c%2u%2u", &sign, &hours, &minutes) < 2)
		return 0;
	double ahead_s = hours * 3600.0 + minutes * 60;
	return sign == '+' ? ahead_s : sign == '-' ? -ahead_s : 0;
}

double track_date_time(const char *text)
{
	struct tm day = { 0 };
	char mark = 0, again = 0;
	int used = 0;
	int found = sscanf(text, " %4d%c%2d%c%2d%n", &day.tm_year, &mark, &day.tm_mon, &again, &day.tm_mday,
		&used);
	if (found < 5 || day.tm_year < 1000 || !strchr("-./", mark) || again != mark || day.tm_mon < 1
			|| day.tm_mon > 12 || day.tm_mday < 1 || day.tm_mday > 31)
		return NAN;
	day.tm_year -= 1900;
	day.tm_mon--;
	double time_s = (double)timegm(&day), clock_s;
	text += used;
	text += *text && strchr("Tt_", *text);
	return track_clock(&text, &clock_s) ? time_s + clock_s - read_zone(text) : time_s;
}
