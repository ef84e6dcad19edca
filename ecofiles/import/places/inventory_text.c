/* Small readers of texts in tables. They ignore the locale, so that a table means the same on every
 * machine. */
#include "ecofiles/import/places/inventory_text.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "build/words/sizes.table"

#define NUMBER_BYTES 64u

static bool is_small(char c) { return c >= 'a' && c <= 'z'; }

/* Goes past the first phrase of that kind (words/sizes.tsv) that *text begins with; a word of letters must
 * end there. Returns its metres; -1: none. */
static double take_phrase(const char **text, const char *kind)
{
	const char *from = eco_text_skip_spaces(*text);
	for (size_t i = 0; i < sizeof sizes_rows / sizeof *sizes_rows; i++)
		for (const char *at = sizes_rows[i].phrases; strcmp(sizes_rows[i].kind, kind) == 0
			&& *at != 0;) {
			size_t length = strcspn(at, "|");
			if (strncmp(from, at, length) == 0 && !(is_small(at[length - 1])
				&& is_small(from[length]))) {
				*text = from + length;
				return sizes_rows[i].metres;
			}
			at += length + (at[length] == '|');
		}
	return -1;
}

bool eco_text_is_missing(const char *text)
{
	char folded[16];
	if (eco_text_fold(text, folded, sizeof folded) + 1 == sizeof folded)
		return false;
	const char *at = folded;
	return *folded == 0 || (take_phrase(&at, "nothing") >= 0 && *at == 0);
}

const char *eco_text_trim(const char *text, char *buffer, size_t size)
{
	while (isspace((unsigned char)*text))
		text++;
	size_t length = strlen(text);
	while (length > 0 && isspace((unsigned char)text[length - 1]))
		length--;
	length = length < size ? length : size - 1;
	memcpy(buffer, text, length);
	buffer[length] = 0;
	return buffer;
}

void eco_text_join(char *text, size_t size, const char *more)
{
	size_t used = strlen(text);
	if (*more == 0 || (used > 0 && eco_text_is_missing(more)))
		return;
	bool again = strncasecmp(more, text, used) == 0 && (more[used] == 0 || more[used] == ' ');
	if (used == 0 || again || eco_text_is_missing(text))
		used = 0;
	else if (used + 1 < size)
		text[used++] = ' ';
	size_t bytes = strlen(more), room = size - 1 - used;
	memcpy(text + used, more, bytes < room ? bytes : room);
	text[used + (bytes < room ? bytes : room)] = 0;
}

/* ---- Numbers ---- */

/* Bytes of the space or apostrophe before three digits at the start of a text; 0: none. */
static size_t gap_bytes(const char *text)
{
	size_t bytes = *text == '\'' ? 1 : strncmp(text, "\u2019", 3) == 0 ? 3 : eco_text_space(text);
	return bytes > 0 && strspn(text + bytes, "0123456789") == 3 ? bytes : 0;
}

/* Copies the number at the start of a text, with '.' as decimal sign and without group signs. Returns the
 * bytes read; 0: no number. Groups are three digits wide; the group sign is a space, an apostrophe, or the
 * sign that is not decimal. One such sign alone is ambiguous. */
static size_t plain_number(const char *text, char decimal, char *plain)
{
	char group = decimal == ',' ? '.' : ',';
	size_t at = 0, used = 0, digits = 0, groups = 0, in_group = 0, gap;
	bool fraction = false, lone = false, gaps = false;
	if (text[at] == '+' || text[at] == '-')
		plain[used++] = text[at++];
	for (; used + 1 < NUMBER_BYTES; at++) {
		char c = text[at];
		if (c >= '0' && c <= '9') {
			plain[used++] = c;
			digits++;
			in_group++;
		} else if (c == decimal && !fraction && text[at + 1] != c) {
			if (groups > 0 && in_group != 3)
				return 0;
			plain[used++] = '.';
			fraction = true;
		} else if (!fraction && groups == 0 && in_group > 0 && in_group <= 3
				&& (gap = gap_bytes(text + at)) > 0) {
			gaps = true;
			at += gap - 1;
			in_group = 0;
		} else if (c == group && !fraction && !gaps && digits > 0 && text[at + 1] >= '0'
				&& text[at + 1] <= '9') {
			if (in_group > 3 || (groups > 0 && in_group != 3))
				break;
			groups++;
			in_group = 0;
		} else {
			break;
		}
	}
	if (groups == 1 && !fraction)
		lone = true;
	if (digits == 0 || (lone && group == ',') || (!fraction && groups > 1 && in_group != 3))
		return 0;
	if (lone) {                          /* a decimal point although commas are expected */
		plain[used] = 0;
		memmove(plain + used - in_group + 1, plain + used - in_group, in_group + 1);
		plain[used - in_group] = '.';
		used++;
	}
	if ((text[at] == 'e' || text[at] == 'E') && used + 8 < NUMBER_BYTES) {
		size_t sign = text[at + 1] == '+' || text[at + 1] == '-',
			n = strspn(text + at + 1 + sign, "0123456789");
		if (n > 0 && n < 4) {
			memcpy(plain + used, text + at, 1 + sign + n);
			used += 1 + sign + n;
			at += 1 + sign + n;
		}
	}
	plain[used] = 0;
	return at;
}

/* Also accepts one sign of the other kind that cannot separate groups: decimal ',' and "565123.45". */
static size_t number_at(const char *text, char decimal, double *number)
{
	char plain[NUMBER_BYTES + 8];
	size_t bytes = plain_number(text, decimal == ',' ? ',' : '.', plain);
	if (decimal == ',' && (bytes == 0 || text[bytes] == '.'))
		bytes = plain_number(text, '.', plain);
	if (bytes == 0)
		return 0;
	*number = strtod(plain, NULL);
	return isfinite(*number) ? bytes : 0;
}

/* Goes past one of the marks. */
static bool take_mark(const char **text, const char *const *marks, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (strncmp(*text, marks[i], strlen(marks[i])) == 0) {
			*text = eco_text_skip_spaces(*text + strlen(marks[i]));
			return true;
		}
	return false;
}

/* N and E are +1, S and W -1; 0: another letter. */
static int take_hemisphere(const char **text)
{
	static const char letters[] = "NESW", *const east[] = { "\u5317\u7def", "\u6771\u7d4c" }, *const west[] = { "\u5357\u7def",
		"\u897f\u7d4c" };           /* in Japanese */
	if (take_mark(text, east, 2))
		return 1;
	if (take_mark(text, west, 2))
		return -1;
	const char *letter = **text ? strchr(letters, toupper((unsigned char)**text)) : NULL;
	*text = letter ? eco_text_skip_spaces(*text + 1) : *text;
	return !letter ? 0 : letter - letters < 2 ? 1 : -1;
}

/* Minutes, seconds and a hemisphere behind degrees, each if it is there. Their signs may be missing where the
 * degrees have none, "40 24 36 N", and that of minutes, "75\u00b045 38''". */
static bool add_sixtieths(const char *text, char decimal, int sign, bool marked, double *number)
{
	static const char *const minute[] = { "'", "\u2032", "\u2019", "\u00b4", "`", "\u5206", "min", "m", ":", "-" }, *const second[] = {
		"''", "\"", "\u2033", "\u201d", "\u2019\u2019", "\u00b4\u00b4", "``", "\u2032\u2032", "\u79d2", "sec", "s" };
	double parts[2] = { 0, 0 };
	size_t bytes = number_at(text, decimal, &parts[0]);
	const char *rest = eco_text_skip_spaces(text + bytes);
	bool bare = !marked || (rest > text + bytes && *rest >= '0' && *rest <= '9');
	if (bytes > 0 && ((!take_mark(&rest, minute, 10) && !bare) || !(parts[0] >= 0 && parts[0] < 60)))
		return false;
	bytes = bytes > 0 ? number_at(rest, decimal, &parts[1]) : 0;
	rest = eco_text_skip_spaces(rest + bytes);
	if (bytes > 0 && ((!take_mark(&rest, second, 11) && marked) || !(parts[1] >= 0 && parts[1] < 60)))
		return false;
	int letter = take_hemisphere(&rest);
	double size = fabs(*number) + parts[0] / 60 + parts[1] / 3600;
	bool below = signbit(*number), named = sign || letter;
	*number = (named ? sign + letter < 0 : below) ? -size : size;
	return *rest == 0 && !(sign && letter) && !(named && below);
}

bool eco_text_number(const char *text, char decimal, double *number)
{
	static const char *const degree[] = { "\u00b0", "\u00ba", "\u02da", "\u5ea6", "deg", "d" }, *const colon[] = { ":", "-" };
	text = eco_text_skip_spaces(text);
	int sign = take_hemisphere(&text);
	/* a comma beside degrees parts no groups: "13\u00b035'35,7''" */
	if ((strstr(text, degree[0]) || strstr(text, degree[1])) && strchr(text, ',') && !strchr(text, '.'))
		decimal = ',';
	size_t bytes = number_at(text, decimal, number), length = strlen(text);
	const char *rest = eco_text_skip_spaces(text + bytes);
	if (bytes > 0 && take_mark(&rest, degree, 6))
		return add_sixtieths(rest, decimal, sign, true, number);
	bool named = sign || (length > 0 && strchr("NESWnesw", text[length - 1]));
	bool parted = bytes > 0 && (take_mark(&rest, colon, named ? 2 : 1) ? named || strchr(rest, ':') : named);
	if (parted && *rest >= '0' && *rest <= '9')
		return add_sixtieths(rest, decimal, sign, false, number);
	bool decimals = bytes > 0 && memchr(text, '.', bytes);
	sign += !sign && decimals ? take_hemisphere(&rest) : 0;          /* "E8.65", "33.5 S" */
	if (bytes == 0 || *rest != 0 || (sign && (!decimals || signbit(*number))))
		return false;
	*number = sign < 0 ? -*number : *number;
	return true;
}

/* Copies a number without its group signs. False if it has none, or if they do not part groups of three. */
static bool ungroup(const char *text, char thousands, char plain[NUMBER_BYTES])
{
	size_t used = strspn(text, " +-"), digits = strspn(text + used, "0123456789"), at = used + digits;
	if (digits == 0 || digits > 3 || text[used] == '0' || text[at] != thousands || at >= NUMBER_BYTES)
		return false;
	memcpy(plain, text, at);
	used = at;
	for (; text[at] == thousands; at += 4, used += 3) {
		if (strspn(text + at + 1, "0123456789") != 3 || used + 4 > NUMBER_BYTES)
			return false;
		memcpy(plain + used, text + at + 1, 3);
	}
	size_t rest = strlen(text + at);
	if (strchr(text + at, thousands) || used + rest >= NUMBER_BYTES)
		return false;
	memcpy(plain + used, text + at, rest + 1);
	return true;
}

bool eco_text_grouped(const char *text, char thousands, double *number)
{
	char plain[NUMBER_BYTES];
	return ungroup(text, thousands, plain)
		&& eco_text_number(plain, thousands == ',' ? '.' : ',', number);
}

static bool is_year(double year) { return year >= 1500 && year < 2100; }

/* Whether the digits behind a year may be a month and a day; 0: not known. */
static bool is_month_day(const char *at)
{
	return (at[0] - '0') * 10 + at[1] - '0' <= 12 && (at[2] - '0') * 10 + at[3] - '0' <= 31;
}

double eco_text_year(const char *text)
{
	char folded[40];
	double number, year;
	if (eco_text_number(text, '.', &number) && fabs(number) > 1e10) {  /* milliseconds since 1970 */
		year = 1970 + floor(number / (365.2425 * 86400e3));
		if (is_year(year))
			return year;
	}
	if (eco_text_fold(text, folded, sizeof folded) + 1 < sizeof folded) {
		const char *at = folded;
		year = take_phrase(&at, "era");
		size_t digits = year >= 0 ? strspn(at = eco_text_skip_spaces(at), "0123456789") : 0;
		if (digits > 0 && digits <= 3 && is_year(year + atoi(at)))
			return year + atoi(at);
	}
	for (const char *at = text; *at != 0; at++) {
		size_t digits = strspn(at, "0123456789");
		year = digits < 4 ? 0 : strtod((char[5]){ at[0], at[1], at[2], at[3], 0 }, NULL);
		if ((digits == 4 || ((digits == 8 || digits == 14) && is_month_day(at + 4))) && is_year(year))
			return year;
		at += digits > 0 ? digits - 1 : 0;
	}
	return NAN;
}

/* ---- Sizes ---- */

static double take_unit(const char **text) { return fmax(take_phrase(text, "unit"), 0); }

/* Goes past a bracket that closes what "(5 to 10)" or "[5, 10)" opened. */
static void take_bracket(const char **text)
{
	const char *at = eco_text_skip_spaces(*text);
	*text = *at != 0 && strchr(")]}", *at) ? at + 1 : *text;
}

/* One or two digits behind a comma are decimals also where a point is the sign. */
static bool has_comma(const char *at)
{
	size_t digits = strspn(at, "0123456789"), more = digits > 0 && at[digits] == ',' ? strspn(at + digits + 1, "0123456789") : 0;
	const char *rest = at + digits + 1 + more;
	return (more == 1 || more == 2) && *rest != ',' && *rest != '.';
}

static bool take_number(const char **text, char decimal, double *number)
{
	const char *at = eco_text_skip_spaces(*text);
	decimal = has_comma(at) ? ',' : decimal;
	size_t bytes = *at == '-' || *at == '+' ? 0 : number_at(at, decimal, number);
	*text = at + bytes;
	return bytes > 0;
}

/* "5 ft 6 in", "5'6\"": adds the second number to the first, in units of the first. */
static void take_inches(const char **text, char decimal, double unit_m, double *number)
{
	const char *at = *text;
	double inches;
	if (unit_m == 0.3048 && take_number(&at, decimal, &inches) && inches < 12
			&& take_unit(&at) == 0.0254) {
		*number += inches / 12;
		*text = at;
	}
}

static bool take_measure(const char **text, char decimal, double *number, double *unit_m)
{
	double same;
	if (!take_number(text, decimal, number))
		return false;
	double unit = take_unit(text);
	take_phrase(text, "years");
	take_inches(text, decimal, unit, number);
	const char *at = eco_text_skip_spaces(*text);
	if (unit != 0 && *at++ == '(' && take_number(&at, decimal, &same) && take_unit(&at) != 0 && *at == ')')
		*text = at + 1;          /* the same in another unit */
	if (unit != 0 && *unit_m != 0 && unit != *unit_m)
		return false;
	if (unit != 0)
		*unit_m = unit;
	return true;
}

static enum eco_size_form size_at(const char *at, char decimal, double *number, double *unit_m)
{
	enum eco_size_form form = ECO_FORM_EXACT;
	double high;
	*unit_m = 0;
	bool between = take_phrase(&at, "between") >= 0;
	take_phrase(&at, "about");
	if (take_phrase(&at, "above") >= 0)
		form = ECO_FORM_OPEN;
	else if (take_phrase(&at, "below") >= 0)
		form = ECO_FORM_RANGE;
	if (!take_measure(&at, decimal, number, unit_m))
		return ECO_FORM_NONE;
	if (form == ECO_FORM_RANGE) {
		*number /= 2;
	} else if (form == ECO_FORM_EXACT && take_phrase(&at, "more") >= 0) {
		form = ECO_FORM_OPEN;
	} else if (form == ECO_FORM_EXACT && take_phrase(&at, "less") >= 0) {
		form = ECO_FORM_RANGE;
		*number /= 2;
	} else if (form == ECO_FORM_EXACT && (take_phrase(&at, "to") >= 0 || (between && take_phrase(&at, "and") >= 0))) {
		if (!take_measure(&at, decimal, &high, unit_m) || high < *number)
			return ECO_FORM_NONE;
		*number = (*number + high) / 2;
		form = ECO_FORM_RANGE;
	}
	take_bracket(&at);
	take_phrase(&at, "said");
	return *eco_text_skip_spaces(at) == 0 ? form : ECO_FORM_NONE;
}

/* Goes past what parts two stems: ";", "and", a space. *loose: it may part a range or a number; *dated: or a date. */
static bool take_parting(const char **text, bool *loose, bool *dated)
{
	const char *at = eco_text_skip_spaces(*text);
	bool spaces = (*text)[-1] == ' ';
	bool sign = *at != 0 && strchr(";/+,&|-\\", *at);
	*loose |= *at == '-' || (*at == ',' && at[1] != ' ');
	*text = at;
	if (sign)
		*text = at + 1;
	else if (take_phrase(text, "and") < 0 && !(spaces && *at >= '0' && *at <= '9'))
		return false;
	else
		*dated |= *text == at;
	return true;
}

/* The diameter of one trunk with the area of several stems: "12;15;9", "20+18", "14-12-9", "3x10". The square
 * root of the sum of squares (Magarik et al. 2020, "How should we measure the DBH of multi-stemmed urban
 * trees?"). *mean: of the numbers alone, as for "6 x 8". */
static enum eco_size_form stems_at(const char *at, char decimal, double *number, double *unit_m, double *mean)
{
	double sum = 0, stem, high = 0, low = INFINITY, all = 0;
	unsigned stems = 0, numbers = 0;
	bool loose = false, dated = false, listed = decimal == '.' && !strpbrk(at, ";/+&|");
	for (*unit_m = 0; *at != 0 && !strchr(")]}", *at);) {
		size_t digits = strspn(at = eco_text_skip_spaces(at), "0123456789");
		if (listed && digits > 0 && digits < 4 && at[digits] == ',') {      /* "12,15,9" */
			stem = atoi(at);
			at += digits;
		} else if (!take_number(&at, decimal, &stem))
			return ECO_FORM_NONE;
		double unit = take_unit(&at);
		at = eco_text_skip_spaces(at);
		all += stem;
		numbers++;
		size_t cross = *at == 'x' || *at == '*' ? 1 : strncmp(at, "\u00d7", 2) == 0 ? 2 : 0;
		double first = stem;
		bool counts = cross > 0 && unit == 0 && stem >= 1 && stem <= 50 && stem == floor(stem);
		if (cross > 0) {
			at += cross;
			if (!take_number(&at, decimal, &stem))
				return ECO_FORM_NONE;
			all += stem;
			numbers++;
			unit = fmax(take_unit(&at), unit);
		}
		*unit_m = unit != 0 ? unit : *unit_m;
		/* "6.5 x 8" are the axes of one stem */
		sum += !cross ? stem * stem : first * (counts ? stem * stem : stem);
		high = fmax(high, stem);
		low = fmin(low, stem);
		stems += counts ? (unsigned)first : 1;
		if (!take_parting(&at, &loose, &dated))
			break;
		at = eco_text_skip_spaces(at);
	}
	take_bracket(&at);
	/* two with a dash are a range, with a comma a number; three unlike ones are a date */
	if (*eco_text_skip_spaces(at) != 0 || numbers < 2 || (loose && stems < 3)
			|| ((loose || dated) && numbers == 3 && high > 9 * low))
		return ECO_FORM_NONE;
	*number = sqrt(sum);
	*mean = all / numbers;
	return ECO_FORM_STEMS;
}

/* The text behind a class's name, as in "a. up to 6 m", "2: 5-10 m", "small (< 10 ft)"; NULL: no such
 * name. */
static const char *behind_class(const char *folded)
{
	size_t sign = strspn(folded, "abcdefghijklmnopqrstuvwxyz");
	const char *bracket = strchr(folded, '(');
	if (sign == 0)
		sign = strspn(folded, "0123456789");
	if (sign > 0 && sign <= 2 && folded[sign] != 0 && strchr(".:)", folded[sign]) != NULL
			&& folded[sign + 1] == ' ')
		return folded + sign + 2;
	return bracket && strcspn(folded, "0123456789<>") > (size_t)(bracket - folded) ? bracket : NULL;
}

static enum eco_size_form read_size(const char *text, char decimal, double *number, double *unit_m, double *mean)
{
	char folded[80], line[80];
	size_t used = 0;
	*unit_m = 0;
	for (; text[used] != 0 && used + 1 < sizeof line; used++)
		line[used] = text[used] == '\n' && text[used + 1] != 0 ? ';' : text[used];  /* a line for each stem */
	line[used] = 0;
	if (eco_text_fold(line, folded, sizeof folded) + 1 >= sizeof folded || text[used] != 0)
		return ECO_FORM_NONE;
	char *comma = strchr(folded, ','), last = folded[strlen(folded) - (*folded != 0)];
	if (comma && ((*folded == '(' && strchr(")]", last)) || (*folded == '[' && last == ')')))
		*comma = '-';            /* an interval, "(10,15]" */
	enum eco_size_form form = size_at(folded, decimal, number, unit_m);
	const char *behind = form == ECO_FORM_NONE ? behind_class(folded) : NULL;
	if (behind)
		form = size_at(behind, decimal, number, unit_m);
	return form != ECO_FORM_NONE ? form : stems_at(folded + (*folded == '[' || *folded == '{'), decimal, number, unit_m, mean);
}

enum eco_size_form eco_text_size(const char *text, char decimal, double *number, double *unit_m)
{
	double mean;
	return read_size(text, decimal, number, unit_m, &mean);
}

enum eco_size_form eco_text_width(const char *text, char decimal, double *number, double *unit_m)
{
	double mean;
	enum eco_size_form form = read_size(text, decimal, number, unit_m, &mean);
	*number = form == ECO_FORM_STEMS ? mean : *number;
	return form == ECO_FORM_STEMS ? ECO_FORM_RANGE : form;
}

#define TEXT_BYTES 256u

static bool has_value(const struct eco_filter *filter, const char *text, char decimal)
{
	char folded[TEXT_BYTES];
	double number;
	bool numeric = eco_text_number(text, decimal, &number);
	eco_text_fold(text, folded, sizeof folded);
	for (uint32_t i = 0; i < filter->value_count; i++) {
		const struct eco_value *value = &filter->values[i];
		if (value->text ? eco_text_fits(folded, value->text, 0) : numeric && number == value->number)
			return true;
	}
	return false;
}

bool eco_filter_passes(const struct eco_filter *filter, const char *text, char decimal)
{
	return has_value(filter, text, decimal) == filter->only;
}

void eco_filters_free(struct eco_filter *filters, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		for (uint32_t k = 0; k < filters[i].value_count; k++)
			free(filters[i].values[k].text);
		free(filters[i].values);
		free(filters[i].column);
	}
	free(filters);
}
