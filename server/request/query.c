/* One table of parameters; what is parsed by hand is checked against a grammar before strtod sees it, so that
 * "nan", "inf", "0x10", leading blanks and whatever else strtod accepts stay out. */
#include "server/request/query.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_BYTES_MAX 48u

enum param_kind { PARAM_POINT, PARAM_NUMBER, PARAM_SIZE, PARAM_COUNT, PARAM_RULE, PARAM_FLAG, PARAM_ID };

#define AT(field) offsetof(struct srv_query, field)
static const struct param_row {
	const char *name;
	enum param_kind kind;
	bool required;
	size_t offset;
	uint64_t max;                /* counts and sizes */
} param_rows[] = {
	{ "eye", PARAM_POINT, true, AT(request.view.eye), 0 },
	{ "target", PARAM_POINT, true, AT(request.view.target), 0 },
	{ "up", PARAM_POINT, false, AT(request.view.up), 0 },
	{ "fov_y_deg", PARAM_NUMBER, false, AT(request.view.fov_y_deg), 0 },
	{ "width", PARAM_SIZE, true, AT(request.view.width), ECO_IMAGE_MAX },
	{ "height", PARAM_SIZE, true, AT(request.view.height), ECO_IMAGE_MAX },
	{ "vertices", PARAM_COUNT, true, AT(request.vertices), ECO_VERTICES_MAX },
	{ "bytes", PARAM_COUNT, false, AT(request.bytes), ECO_BYTES_UNBOUNDED },
	{ "ground_px", PARAM_NUMBER, false, AT(request.ground_px), 0 },
	{ "texel_px", PARAM_NUMBER, false, AT(request.texel_px), 0 },
	{ "next_eye", PARAM_POINT, false, AT(request.next.eye), 0 },
	{ "next_target", PARAM_POINT, false, AT(request.next.target), 0 },
	{ "name_from", PARAM_COUNT, false, AT(request.name_from), ECO_BYTES_UNBOUNDED },
	{ "rule", PARAM_RULE, false, AT(rule), 0 },
	{ "explain", PARAM_FLAG, false, AT(explain), 1 },
	{ "pack", PARAM_ID, false, AT(pack), 0 },
};
#undef AT
#define PARAM_ROWS (sizeof param_rows / sizeof *param_rows)

static const struct { const char *name; lod_rule *rule; } rules[] = { { "optimal", lod_rule_optimal },
	{ "deussen", lod_rule_deussen } };

static const char *skip_digits(const char *text)
{
	while (*text >= '0' && *text <= '9')
		text++;
	return text;
}

bool srv_parse_number(const char *text, double *value)
{
	const char *at = text + (*text == '-'), *digits = at;
	at = skip_digits(at);
	if (at == digits)
		return false;
	if (*at == '.') {
		digits = ++at;
		at = skip_digits(at);
		if (at == digits)
			return false;
	}
	if (*at == 'e' || *at == 'E') {
		at++;
		at += *at == '+' || *at == '-';
		digits = at;
		at = skip_digits(at);
		if (at == digits)
			return false;
	}
	if (*at || (size_t)(at - text) > NUMBER_BYTES_MAX)
		return false;
	*value = strtod(text, NULL);
	return isfinite(*value);
}

bool srv_parse_count(const char *text, uint64_t *value)
{
	uint64_t sum = 0;
	if (!*text)
		return false;
	for (; *text; text++) {
		if (*text < '0' || *text > '9')
			return false;
		uint64_t digit = (uint64_t)(*text - '0');
		if (sum > (UINT64_MAX - digit) / 10)
			return false;
		sum = sum * 10 + digit;
	}
	*value = sum;
	return true;
}

static bool parse_point(const char *text, double value[3])
{
	char part[NUMBER_BYTES_MAX + 1];
	for (int i = 0; i < 3; i++) {
		size_t size = i < 2 ? strcspn(text, ",") : strlen(text);
		if (size >= sizeof part || (i < 2 && !text[size]))
			return false;
		memcpy(part, text, size);
		part[size] = 0;
		if (!srv_parse_number(part, &value[i]))
			return false;
		text += size + (i < 2);
	}
	return true;
}

bool srv_parse_id(const char *text, struct eco_chunk_id *id)
{
	static const char digits[] = "0123456789abcdef";
	for (size_t i = 0; i < 2 * sizeof id->bytes; i++) {
		const char *digit = text[i] ? strchr(digits, text[i]) : NULL;
		if (!digit)
			return false;
		id->bytes[i / 2] = (uint8_t)((i % 2 ? id->bytes[i / 2] << 4 : 0) | (digit - digits));
	}
	return !text[2 * sizeof id->bytes];
}

void srv_format_id(char text[SRV_ID_TEXT_BYTES], const struct eco_chunk_id *id)
{
	static const char digits[] = "0123456789abcdef";
	for (size_t i = 0; i < sizeof id->bytes; i++) {
		text[2 * i] = digits[id->bytes[i] >> 4];
		text[2 * i + 1] = digits[id->bytes[i] & 15];
	}
	text[2 * sizeof id->bytes] = 0;
}

static enum eco_code parse_rule(lod_rule **rule, const char *text, struct eco_error *error)
{
	for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
		if (strcmp(rules[i].name, text) == 0) {
			*rule = rules[i].rule;
			return ECO_OK;
		}
	return eco_fail(error, ECO_BAD_INPUT, "parameter 'rule': '%.80s' is neither optimal nor deussen",
		text);
}

static enum eco_code parse_row(struct srv_query *query, const struct param_row *row, const char *text,
	struct eco_error *error)
{
	void *field = (char *)query + row->offset;
	uint64_t count, least;
	switch (row->kind) {
	case PARAM_POINT:
		if (!parse_point(text, field))
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is not three decimal "
				"numbers x,y,z", row->name, text);
		return ECO_OK;
	case PARAM_NUMBER:
		if (!srv_parse_number(text, field))
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is not a decimal "
				"number", row->name, text);
		return ECO_OK;
	case PARAM_SIZE:
	case PARAM_COUNT:
		least = row->kind == PARAM_SIZE;
		if (!srv_parse_count(text, &count) || count < least || count > row->max)
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is not a whole "
				"number from %llu to %llu", row->name, text, (unsigned long long)least,
				(unsigned long long)row->max);
		if (row->kind == PARAM_SIZE)
			*(uint32_t *)field = (uint32_t)count;
		else
			*(uint64_t *)field = count;
		return ECO_OK;
	case PARAM_RULE:
		return parse_rule(&query->rule, text, error);
	case PARAM_FLAG:
		if (!srv_parse_count(text, &count) || count > 1)
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is neither 0 nor 1",
				row->name, text);
		*(bool *)field = count;
		return ECO_OK;
	case PARAM_ID:
		if (!srv_parse_id(text, field))
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is not an id of 32 "
				"lower-case hex digits", row->name, text);
		query->has_pack = true;
		return ECO_OK;
	}
	return ECO_OK;
}

static const struct param_row *find_row(const char *name)
{
	for (size_t i = 0; i < PARAM_ROWS; i++)
		if (strcmp(param_rows[i].name, name) == 0)
			return &param_rows[i];
	return NULL;
}

static enum eco_code check_next(struct srv_query *query, const struct srv_target *target,
	struct eco_error *error)
{
	bool eye = srv_target_param(target, "next_eye"), at = srv_target_param(target, "next_target");
	struct eco_view view = eco_view_next(&query->request);
	struct eco_error why = { 0 };
	if (eye != at)
		return eco_fail(error, ECO_BAD_INPUT, "parameter '%s' is missing: the next view has both, "
			"next_eye and next_target", eye ? "next_target" : "next_eye");
	query->request.next.given = eye;
	return eye && eco_view_check(&view, &why) ? eco_fail(error, ECO_BAD_INPUT, "the next view: %s",
		why.text) : ECO_OK;
}

enum eco_code srv_query_parse(struct srv_query *query, const struct srv_target *target,
	struct eco_error *error)
{
	*query =
		(struct srv_query){ .request = { .view = { .up = { 0, 0, 1 }, .fov_y_deg = 45 },
		.bytes = ECO_BYTES_UNBOUNDED,
		.ground_px = ECO_GROUND_PX, .texel_px = ECO_TEXEL_PX } };
	for (uint32_t i = 0; i < target->param_count; i++) {
		const struct srv_param *param = &target->params[i];
		const struct param_row *row = find_row(param->name);
		if (!row)
			return eco_fail(error, ECO_BAD_INPUT, "unknown parameter '%.40s'; known are eye, "
				"target, up, fov_y_deg, width, height, vertices, bytes, ground_px, texel_px, "
				"next_eye, next_target, name_from, rule, pack and explain", param->name);
		enum eco_code code = parse_row(query, row, param->value, error);
		if (code)
			return code;
	}
	for (size_t i = 0; i < PARAM_ROWS; i++)
		if (param_rows[i].required && !srv_target_param(target, param_rows[i].name))
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s' is missing; a view has "
				"eye=X,Y,Z, target=X,Y,Z, width, height and vertices", param_rows[i].name);
	if (!(query->request.ground_px >= ECO_GROUND_PX_MIN && query->request.ground_px <= ECO_GROUND_PX_MAX))
		return eco_fail(error, ECO_BAD_INPUT, "ground_px: %g; give a number of pixels from %g to %g",
			query->request.ground_px, ECO_GROUND_PX_MIN, ECO_GROUND_PX_MAX);
	if (!(query->request.texel_px >= ECO_TEXEL_PX_MIN && query->request.texel_px <= ECO_TEXEL_PX_MAX))
		return eco_fail(error, ECO_BAD_INPUT, "texel_px: %g; give a number of pixels from %g to %g",
			query->request.texel_px, ECO_TEXEL_PX_MIN, ECO_TEXEL_PX_MAX);
	enum eco_code code = eco_view_check(&query->request.view, error);
	return code ? code : check_next(query, target, error);
}

enum eco_code srv_query_none(const struct srv_target *target, struct eco_error *error)
{
	if (target->param_count == 0)
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT, "unknown parameter '%.40s': this resource takes none",
		target->params[0].name);
}
