#include "client-min/load/view_answers.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/array_grow.h"

const char *const view_outcome_names[VIEW_OUTCOMES] = { "answered", "connection", "broken", "late", "busy",
	"refused", "damaged", "unfinished", "other" };

const char *const view_group_names[VIEW_GROUPS] = { "all", "warm", "cold" };

const struct view_quantile_kind view_quantiles[VIEW_QUANTILES] = { { "p50", 0.5 }, { "p90", 0.9 },
	{ "p99", 0.99 }, { "p99_9", 0.999 }, { "max", 1 } };

#define FIELD(name) offsetof(struct view_answer, name)
const struct view_column_kind view_columns[VIEW_COLUMNS_COUNT] = {
	[VIEW_COLUMN_LATENCY] = { "latency_ms", "latency", FIELD(done_ms), true },
	[VIEW_COLUMN_SERVICE] = { "service_ms", "of it service", FIELD(service_ms), true },
	[VIEW_COLUMN_FIRST_BYTE] = { "first_byte_ms", "first byte", FIELD(first_byte_ms), false },
	[VIEW_COLUMN_PICTURE] = { "picture_ms", "first picture", FIELD(picture_ms), false },
	[VIEW_COLUMN_Q80] = { "q80_ms", "predicted Q .8", FIELD(q80_ms), false },
	[VIEW_COLUMN_Q90] = { "q90_ms", "predicted Q .9", FIELD(q90_ms), false },
	[VIEW_COLUMN_PLAN] = { "plan_ms", "server's plan", FIELD(plan_ms), false },
};
#undef FIELD

bool view_answers_add(struct view_answers *answers, const struct view_answer *answer)
{
	if (!eco_array_grow(&answers->items, &answers->room, answers->count, sizeof *answers->items))
		return false;
	answers->items[answers->count++] = *answer;
	return true;
}

void view_answers_free(struct view_answers *answers)
{
	free(answers->items);
	*answers = (struct view_answers){ 0 };
}

float view_answer_value(const struct view_answer *answer, const struct view_column_kind *kind)
{
	return *(const float *)((const char *)answer + kind->offset);
}

static bool is_of(const struct view_answer *answer, enum view_group group)
{
	return group == VIEW_GROUP_ALL || answer->cold == (group == VIEW_GROUP_COLD);
}

/* A failure at once says nothing of times; an answer that was given up took at least so long. */
static bool has_time(const struct view_answer *answer, const struct view_column_kind *kind)
{
	return answer->outcome == VIEW_ANSWERED || (kind->given_up && (answer->outcome == VIEW_LATE
		|| answer->outcome == VIEW_UNFINISHED));
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return x < y ? -1 : x > y;
}

bool view_answers_column(const struct view_answers *answers, const struct view_column_kind *kind,
	enum view_group group, struct view_column *column)
{
	*column = (struct view_column){ .values = malloc((answers->count + 1) * sizeof *column->values) };
	if (!column->values)
		return false;
	for (uint32_t i = 0; i < answers->count; i++) {
		const struct view_answer *answer = &answers->items[i];
		if (!is_of(answer, group) || !has_time(answer, kind))
			continue;
		float value = view_answer_value(answer, kind);
		column->of++;
		if (!isnan(value))
			column->values[column->count++] = value;
	}
	qsort(column->values, column->count, sizeof *column->values, by_value);
	return true;
}

void view_column_free(struct view_column *column)
{
	free(column->values);
	*column = (struct view_column){ 0 };
}

bool view_answers_client_bytes(const struct view_answers *answers, uint32_t clients,
	struct view_column *column)
{
	uint64_t *bytes = calloc(clients + 1, sizeof *bytes);
	*column = (struct view_column){ .values = calloc(clients + 1, sizeof *column->values),
		.count = clients, .of = clients };
	bool good = bytes && column->values;
	for (uint32_t i = 0; i < answers->count && good; i++)
		bytes[answers->items[i].client] += answers->items[i].bytes;
	for (uint32_t i = 0; i < clients && good; i++)
		column->values[i] = (float)bytes[i];
	free(bytes);
	if (good)
		qsort(column->values, clients, sizeof *column->values, by_value);
	else
		view_column_free(column);
	return good;
}

double view_quantile(const float *values, uint32_t count, double share)
{
	double at = ceil(share * count);
	uint32_t index = at < 1 ? 0 : at > count ? count - 1 : (uint32_t)at - 1;
	return count ? (double)values[index] : NAN;
}
