#include "ecofiles/import/model/model_spare.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/phrase.h"
#include "ecofiles/import/model/import_model.h"
#include "ecofiles/import/model/model_parts.h"

static bool begins_word(const char *name, const char *at)
{
	return at == name || !isalnum((unsigned char)at[-1])
		|| (islower((unsigned char)at[-1]) && isupper((unsigned char)*at));
}

static bool ends_word(const char *at) { return !isalpha((unsigned char)*at); }

/* Whether a name has a word, as a word of its own. */
static bool has_word(const char *name, const char *word)
{
	for (const char *at = name; (at = strcasestr(at, word)); at++)
		if (begins_word(name, at) && ends_word(at + strlen(word)))
			return true;
	return false;
}

/* Names of Decentraland and Unity, of Unreal, and of Godot. */
static bool is_collider(const char *name)
{
	static const char *const words[] = { "collider", "collision", "ucx", "ubx", "usp", "ucp", "colonly",
		"convcolonly" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (has_word(name, words[i]))
			return true;
	return false;
}

int eco_model_spare_level(const char *name)
{
	if (is_collider(name))
		return ECO_SPARE_COLLIDER;
	for (const char *at = name; (at = strcasestr(at, "lod")); at++) {
		const char *digits = at + 3 + (at[3] == '_' || at[3] == '-' || at[3] == ' ');
		if (begins_word(name, at) && isdigit((unsigned char)*digits) && !isdigit((unsigned char)digits[1]))
			return *digits - '0';
	}
	return has_word(name, "billboard") || has_word(name, "impostor") || has_word(name, "imposter")
		? ECO_SPARE_CARD : ECO_SPARE_NONE;
}

static bool is_ruled(const char *name, const struct eco_part_rule *rules, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		if (rules[i].kind == ECO_PART_NAME && eco_part_name_fits(rules[i].name, name))
			return true;
	return false;
}

/* The level of each part that a triangle has, ECO_SPARE_NONE where it is to stay; false: all stay. */
static bool find_levels(const struct eco_model *m, const struct eco_part_rule *rules, uint32_t count,
	int *level)
{
	int finest = ECO_SPARE_CARD, levels = 0;
	bool any = false;
	for (uint32_t i = 0; i < m->part_count; i++) {
		level[i] = is_ruled(m->parts[i].name, rules, count) ? ECO_SPARE_NONE
			: eco_model_spare_level(m->parts[i].name);
		levels += level[i] >= 0 && level[i] < ECO_SPARE_CARD;
		finest = level[i] >= 0 && level[i] < finest ? level[i] : finest;
	}
	for (uint32_t i = 0; i < m->part_count; i++) {
		if (level[i] == finest || (level[i] == ECO_SPARE_CARD && levels == 0))
			level[i] = ECO_SPARE_NONE;
		any |= level[i] != ECO_SPARE_NONE;
	}
	return any;
}

/* Keeps triangles of parts without a level; returns how many there are. With `move` they are moved up. */
static uint32_t keep(struct eco_model *m, const int *level, bool move)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		if (level[m->part[i]] != ECO_SPARE_NONE)
			continue;
		if (move) {
			memmove(&m->index[(size_t)kept * 3], &m->index[(size_t)i * 3], 3 * sizeof *m->index);
			m->material[kept] = m->material[i];
			m->part[kept] = m->part[i];
		}
		kept++;
	}
	return kept;
}

void eco_model_drop_spare(struct eco_model *m, const struct eco_part_rule *rules, uint32_t count,
	struct eco_notes *notes)
{
	char names[200] = "";
	int *level = m->part && m->part_count > 0 ? malloc(m->part_count * sizeof *level) : NULL;
	if (level && find_levels(m, rules, count, level)) {
		uint32_t kept = keep(m, level, false);
		if (kept > 0 && kept < m->triangle_count) {
			for (uint32_t i = 0; i < m->part_count; i++)
				if (level[i] != ECO_SPARE_NONE)
					eco_phrase_add(names, sizeof names, m->parts[i].name);
			eco_note(notes, "%u triangles of coarser levels of detail or shapes for collisions are left "
				"out: %s; name them in \"parts\" if they are the plant's",
				m->triangle_count - kept, names);
			m->dropped[ECO_DROP_LEFT_OUT] += m->triangle_count - kept;
			m->triangle_count = keep(m, level, true);
		}
	}
	free(level);
}

/* ---- Ground ---- */

#define SHEET_THICK 0.002        /* of its width */
#define SHEET_FULL 0.7           /* of its box: a disc has 0.79 */
#define SHEET_AT 0.1             /* of the height, from the lower end: stems reach into the ground */
#define LIES_BESIDE 1e-3         /* of its width: so far may the rest reach beyond it */

/* Extremes of all components along an axis, and the next ones: they bound all but any one component, so that
 * a model of many components is looked at once. */
struct extremes {
	double low[2], high[2];
	uint32_t lowest, highest;    /* the components that low[0] and high[0] are of */
};

static void find_extremes(const struct eco_components *all, int axis, struct extremes *e)
{
	*e = (struct extremes){ .low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY } };
	for (uint32_t i = 0; i < all->count; i++) {
		double low = all->items[i].low[axis], high = all->items[i].high[axis];
		if (low < e->low[0]) {
			e->low[1] = e->low[0];
			e->low[0] = low;
			e->lowest = i;
		} else if (low < e->low[1]) {
			e->low[1] = low;
		}
		if (high > e->high[0]) {
			e->high[1] = e->high[0];
			e->high[0] = high;
			e->highest = i;
		} else if (high > e->high[1]) {
			e->high[1] = high;
		}
	}
}

/* Whether all else of the model stands on the component. */
static bool is_sheet(const struct eco_components *all, const struct extremes of[3], uint32_t at)
{
	const struct eco_component *c = &all->items[at];
	double wide = c->high[0] - c->low[0], deep = c->high[1] - c->low[1], low[3], high[3];
	for (int k = 0; k < 3; k++) {
		low[k] = of[k].low[of[k].lowest == at];
		high[k] = of[k].high[of[k].highest == at];
	}
	double height = high[2] - c->low[2];
	if (!(height > 0) || c->high[2] - c->low[2] > SHEET_THICK * fmin(wide, deep)
			|| c->area < SHEET_FULL * wide * deep || c->high[2] > low[2] + SHEET_AT * height)
		return false;
	return low[0] >= c->low[0] - LIES_BESIDE * wide && high[0] <= c->high[0] + LIES_BESIDE * wide
		&& low[1] >= c->low[1] - LIES_BESIDE * deep && high[1] <= c->high[1] + LIES_BESIDE * deep;
}

static void drop_component(struct eco_model *m, const struct eco_components *all, uint32_t at)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		if (all->of[i] == at)
			continue;
		memmove(&m->index[(size_t)kept * 3], &m->index[(size_t)i * 3], 3 * sizeof *m->index);
		m->material[kept] = m->material[i];
		if (m->part)
			m->part[kept] = m->part[i];
		kept++;
	}
	m->dropped[ECO_DROP_LEFT_OUT] += m->triangle_count - kept;
	m->triangle_count = kept;
}

bool eco_model_drop_sheet(struct eco_model *m, const uint32_t *place, const struct eco_part_rule *rules,
	uint32_t count, struct eco_notes *notes)
{
	struct eco_components all = { .count = 0 };
	struct extremes of[3];
	if (!eco_components_find(&all, m, place, true))
		return false;
	for (int k = 0; k < 3; k++)
		find_extremes(&all, k, &of[k]);
	for (uint32_t i = 0; i < all.count && all.count > 1; i++) {
		const char *name = m->part ? m->parts[m->part[all.items[i].first]].name : "";
		if (!is_sheet(&all, of, i))
			continue;
		if (!is_ruled(name, rules, count)) {
			eco_note(notes, "a level sheet that it stands on (%u triangles of part \"%s\") is left "
				"out, as the scene has a ground; name it in \"parts\" if it is the plant's",
				all.items[i].triangle_count, name);
			drop_component(m, &all, i);
		}
		break;
	}
	eco_components_free(&all);
	return true;
}
