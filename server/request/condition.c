#include "server/request/condition.h"

#include <string.h>
#include <strings.h>
#include <time.h>

/* Digits at *text, saturating: a position beyond 2^64 is simply beyond the end. */
static bool take_count(const char **text, uint64_t *value)
{
	const char *first = *text;
	uint64_t sum = 0;
	for (; **text >= '0' && **text <= '9'; ++*text) {
		uint64_t digit = (uint64_t)(**text - '0');
		sum = sum > (UINT64_MAX - digit) / 10 ? UINT64_MAX : sum * 10 + digit;
	}
	*value = sum;
	return *text != first;
}

struct srv_range srv_range_parse(const char *value, uint64_t size)
{
	struct srv_range range = { SRV_RANGE_ALL, 0, size };
	uint64_t first = 0, last = UINT64_MAX;
	if (!value || strncasecmp(value, "bytes=", 6) != 0)     /* units have no case */
		return range;
	const char *at = value + 6;
	bool has_first = take_count(&at, &first);
	if (*at++ != '-')
		return range;
	bool has_last = take_count(&at, &last);
	if (*at || (!has_first && !has_last) || (has_first && has_last && last < first))
		return range;
	if (!has_first) {                                /* the last n bytes */
		first = last < size ? size - last : 0;
		if (last == 0)
			first = size;
		last = UINT64_MAX;
	} else if (!has_last) {
		last = UINT64_MAX;
	}
	if (first >= size)
		return (struct srv_range){ SRV_RANGE_OUTSIDE, 0, 0 };
	return (struct srv_range){ SRV_RANGE_PART, first, last < size ? last + 1 : size };
}

bool srv_etag_any(const char *value)
{
	value += strspn(value, " \t");
	return value[0] == '*' && value[1 + strspn(value + 1, " \t")] == 0;
}

/* `strongly`: a weak tag is none. */
static bool list_names(const char *value, const char *etag, bool strongly)
{
	size_t size = strlen(etag);
	while (*value) {
		value += strspn(value, " \t,");
		bool weak = value[0] == 'W' && value[1] == '/';
		value += 2 * weak;
		if (*value != '"')
			return false;
		const char *close = strchr(value + 1, '"');
		if (!close)
			return false;
		if (!(weak && strongly) && (size_t)(close + 1 - value) == size &&
			memcmp(value, etag, size) == 0)
			return true;
		value = close + 1;
		if (*value && !strchr(" \t,", *value))
			return false;
	}
	return false;
}

bool srv_etag_match(const char *value, const char *etag)
{
	return value && (srv_etag_any(value) || list_names(value, etag, false));
}

/* The three forms of RFC 9110, 5.6.7; false for anything else. */
static bool read_date(const char *text, int64_t *at_s)
{
	static const char *const forms[] = { "%a, %d %b %Y %H:%M:%S GMT", "%A, %d-%b-%y %H:%M:%S GMT",
		"%a %b %e %H:%M:%S %Y" };
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
		struct tm parts = { 0 };
		const char *end = strptime(text, forms[i], &parts);
		if (end && !end[strspn(end, " \t")]) {
			*at_s = timegm(&parts);
			return true;
		}
	}
	return false;
}

void srv_date_format(char text[SRV_DATE_BYTES], int64_t at_s)
{
	struct tm parts;
	time_t at = (time_t)at_s;
	if (!gmtime_r(&at, &parts) || !strftime(text, SRV_DATE_BYTES, "%a, %d %b %Y %H:%M:%S GMT", &parts))
		text[0] = 0;
}

enum srv_verdict srv_conditions_judge(const struct srv_conditions *conditions, const char *etag,
	int64_t modified_s)
{
	const char *match = conditions->if_match, *since = conditions->if_unmodified_since;
	int64_t at_s;
	if (match && !srv_etag_any(match) && !(etag && list_names(match, etag, true)))
		return SRV_VERDICT_FAILED;
	if (!match && since && modified_s && read_date(since, &at_s) && modified_s > at_s)
		return SRV_VERDICT_FAILED;
	return etag && srv_etag_match(conditions->if_none_match, etag) ? SRV_VERDICT_NOT_MODIFIED
		: SRV_VERDICT_GO;
}
