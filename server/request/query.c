/* One table of parameters; what is parsed by hand is checked against a grammar before strtod sees it, so that
 * "nan", "inf", "0x10", leading blanks and whatever else strtod accepts stay out. */
#include "server/request/query.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_BYTES_MAX 48u

enum param_kind { PARAM_POINT, PARAM_NUMBER, PARAM_SIZE, PARAM_COUNT, PARAM_RULE, PARAM_FLAG, PARAM_ID, PARAM_TEXT };

struct param_row {
	const char *name;
	enum param_kind kind;
	bool required;
	size_t offset;
	uint64_t max, least;         /* counts and sizes */
};

#define AT(field) offsetof(struct srv_query, field)
static const struct param_row view_rows[] = {
	{ "eye", PARAM_POINT, true, AT(request.view.eye), 0, 0 },
	{ "target", PARAM_POINT, true, AT(request.view.target), 0, 0 },
	{ "up", PARAM_POINT, false, AT(request.view.up), 0, 0 },
	{ "fov_y_deg", PARAM_NUMBER, false, AT(request.view.fov_y_deg), 0, 0 },
	{ "width", PARAM_SIZE, true, AT(request.view.width), ECO_IMAGE_MAX, 1 },
	{ "height", PARAM_SIZE, true, AT(request.view.height), ECO_IMAGE_MAX, 1 },
	{ "vertices", PARAM_COUNT, true, AT(request.vertices), ECO_VERTICES_MAX, 0 },
	{ "bytes", PARAM_COUNT, false, AT(request.bytes), ECO_BYTES_UNBOUNDED, 0 },
	{ "ground_px", PARAM_NUMBER, false, AT(request.ground_px), 0, 0 },
	{ "texel_px", PARAM_NUMBER, false, AT(request.texel_px), 0, 0 },
	{ "next_eye", PARAM_POINT, false, AT(request.next.eye), 0, 0 },
	{ "next_target", PARAM_POINT, false, AT(request.next.target), 0, 0 },
	{ "name_from", PARAM_COUNT, false, AT(request.name_from), ECO_BYTES_UNBOUNDED, 0 },
	{ "rule", PARAM_RULE, false, AT(rule), 0, 0 },
	{ "explain", PARAM_FLAG, false, AT(explain), 1, 0 },
	{ "pack", PARAM_ID, false, AT(pack), 0, 0 },
	{ NULL, 0, 0, 0, 0, 0 }
};
#undef AT
#define AT(field) offsetof(struct srv_plants_query, field)
static const struct param_row plants_rows[] = { { "first", PARAM_COUNT, false, AT(first), UINT64_MAX, 0 },
	{ "count", PARAM_COUNT, false, AT(count), SRV_PLANTS_MAX, 1 }, { "pack", PARAM_ID, false, AT(pack), 0,
	0 }, { NULL, 0, 0, 0, 0, 0 } };
#undef AT
#define AT(field) offsetof(struct srv_find_query, field)
static const struct param_row find_rows[] = { { "text", PARAM_TEXT, true, AT(text), 0, 0 },
	{ "first", PARAM_COUNT, false, AT(first), UINT64_MAX, 0 }, { "count", PARAM_COUNT, false, AT(count), SRV_FIND_MAX, 1 },
	{ "pack", PARAM_ID, false, AT(pack), 0, 0 }, { NULL, 0, 0, 0, 0, 0 } };
#undef AT

static const struct { const char *name; lod_rule *rule; } rules[] = { { "optimal", lod_rule_optimal },
	{ "deussen", lod_rule_deussen } };

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

bool srv_parse_number(const char *text, double *value)
{
	const char *point = strchr(text, '.');
	char *end;
	if (!is_digit(text[*text == '-']) || text[strspn(text, "0123456789.eE+-")] || (point && !is_digit(point[1]))
			|| strlen(text) > NUMBER_BYTES_MAX)
		return false;
	*value = strtod(text, &end);
	return !*end && isfinite(*value);
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

/* Stores the value in its field. NULL, or what it should have been. */
static const char *parse_field(void *field, const struct param_row *row, const char *text)
{
	struct srv_pack_named *pack = field;
	uint64_t count;
	switch (row->kind) {
	case PARAM_POINT:
		return parse_point(text, field) ? NULL : "not three decimal numbers x,y,z";
	case PARAM_NUMBER:
		return srv_parse_number(text, field) ? NULL : "not a decimal number";
	case PARAM_SIZE:
	case PARAM_COUNT:
		if (!srv_parse_count(text, &count) || count < row->least || count > row->max)
			return "not a whole number";
		if (row->kind == PARAM_SIZE)
			*(uint32_t *)field = (uint32_t)count;
		else
			*(uint64_t *)field = count;
		return NULL;
	case PARAM_RULE:
		for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
			if (strcmp(rules[i].name, text) == 0) {
				*(lod_rule **)field = rules[i].rule;
				return NULL;
			}
		return "neither optimal nor deussen";
	case PARAM_FLAG:
		if (!srv_parse_count(text, &count) || count > 1)
			return "neither 0 nor 1";
		*(bool *)field = count;
		return NULL;
	case PARAM_ID:
		pack->given = srv_parse_id(text, &pack->id);
		return pack->given ? NULL : "not an id of 32 lower-case hex digits";
	case PARAM_TEXT:
		if (!*text || strlen(text) > SRV_FIND_TEXT_BYTES)
			return "not a text of 1 to 100 bytes";
		strcpy(field, text);
		return NULL;
	}
	return NULL;
}

static enum eco_code parse_params(void *query, const struct param_row *rows, const char *known,
	const struct srv_target *target, struct eco_error *error)
{
	for (uint32_t i = 0; i < target->param_count; i++) {
		const struct srv_param *param = &target->params[i];
		const struct param_row *row = rows;
		char range[64] = "";
		while (row->name && strcmp(row->name, param->name) != 0)
			row++;
		if (!row->name)
			return eco_fail(error, ECO_BAD_INPUT, "unknown parameter '%.40s'; known are %s",
				param->name, known);
		const char *wrong = parse_field((char *)query + row->offset, row, param->value);
		if (wrong && (row->kind == PARAM_SIZE || row->kind == PARAM_COUNT))
			snprintf(range, sizeof range, " from %llu to %llu", (unsigned long long)row->least,
				(unsigned long long)row->max);
		if (wrong)
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is %s%s", row->name,
				param->value, wrong, range);
	}
	return ECO_OK;
}

enum eco_code srv_plants_query_parse(struct srv_plants_query *query, const struct srv_target *target,
	struct eco_error *error)
{
	*query = (struct srv_plants_query){ .count = SRV_PLANTS_MAX };
	return parse_params(query, plants_rows, "first, count and pack", target, error);
}

enum eco_code srv_find_query_parse(struct srv_find_query *query, const struct srv_target *target,
	struct eco_error *error)
{
	*query = (struct srv_find_query){ .count = SRV_FIND_MAX };
	enum eco_code code = parse_params(query, find_rows, "text, first, count and pack", target, error);
	return code || *query->text ? code : eco_fail(error, ECO_BAD_INPUT, "parameter 'text' is missing: what is to be found");
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
	ECO_PASS(parse_params(query, view_rows, "eye, target, up, fov_y_deg, width, height, vertices, "
		"bytes, ground_px, texel_px, next_eye, next_target, name_from, rule, pack and explain", target, error));
	for (const struct param_row *row = view_rows; row->name; row++)
		if (row->required && !srv_target_param(target, row->name))
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s' is missing; a view has "
				"eye=X,Y,Z, target=X,Y,Z, width, height and vertices", row->name);
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
