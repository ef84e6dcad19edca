#include "ecofiles/import/places/tints.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/tints.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/words.h"

#define ROWS (sizeof tints_rows / sizeof *tints_rows)
#define VALUES_MAX 65536u        /* of all columns; beyond, those without a class of the palette are "other" */
#define KEY_BYTES 272u

/* ---- Palettes ---- */

void eco_tint_add(struct eco_tint *tint, const char *name, const char *phrases, const uint8_t rgb[3])
{
	tint->classes = eco_realloc(tint->classes, tint->class_count + 1u, sizeof *tint->classes);
	struct eco_tint_class *class = &tint->classes[tint->class_count++];
	*class = (struct eco_tint_class){ .name = eco_copy_text(name), .phrases = phrases, .own = !rgb };
	for (int k = 0; rgb && k < 3; k++)
		class->rgb[k] = rgb[k];
	class->rgb[2] += rgb && !(rgb[0] | rgb[1] | rgb[2]);     /* 0, 0, 0 says that plants keep theirs */
}

static void add_row(struct eco_tint *tint, size_t row)
{
	unsigned value = 0;
	bool own = sscanf(tints_rows[row].colour, "#%6x", &value) != 1;
	const uint8_t rgb[3] = { (uint8_t)(value >> 16), (uint8_t)(value >> 8), (uint8_t)value };
	eco_tint_add(tint, tints_rows[row].class, tints_rows[row].phrases, own ? NULL : rgb);
}

bool eco_tint_palette(struct eco_tint *tint, const char *name)
{
	uint32_t before = tint->class_count;
	for (size_t i = 0; i < ROWS; i++)
		if (strcmp(tints_rows[i].palette, name) == 0 && strcmp(name, "-") != 0)
			add_row(tint, i);
	return tint->class_count > before;
}

const char *eco_tint_palettes(char *text, size_t size)
{
	*text = 0;
	for (size_t i = 0; i < ROWS; i++)
		if ((i == 0 || strcmp(tints_rows[i].palette, tints_rows[i - 1].palette) != 0)
				&& strcmp(tints_rows[i].palette, "-") != 0)
			eco_phrase_add(text, size, tints_rows[i].palette);
	return text;
}

static uint32_t class_named(const struct eco_tint *tint, const char *name)
{
	uint32_t i = 0;
	while (i < tint->class_count && strcmp(tint->classes[i].name, name) != 0)
		i++;
	return i;
}

void eco_tint_close(struct eco_tint *tint)
{
	for (size_t i = 0; i < ROWS; i++)
		if (strcmp(tints_rows[i].palette, "-") == 0
				&& class_named(tint, tints_rows[i].class) == tint->class_count)
			add_row(tint, i);
}

static void drop_classes(struct eco_tint *tint)
{
	for (uint32_t i = 0; i < tint->class_count; i++)
		free(tint->classes[i].name);
	free(tint->classes);
	tint->classes = NULL;
	tint->class_count = 0;
}

void eco_tint_divide(struct eco_tint *tint)
{
	struct eco_tint from = *tint;
	tint->classes = NULL;
	tint->class_count = 0;
	for (uint32_t i = 0; i <= tint->break_count; i++) {
		uint32_t of = (uint32_t)((uint64_t)i * (from.class_count - 1) / tint->break_count);
		char name[64];
		if (i == 0)
			snprintf(name, sizeof name, "below %g", tint->breaks[0]);
		else if (i < tint->break_count)
			snprintf(name, sizeof name, "%g to %g", tint->breaks[i - 1], tint->breaks[i]);
		else
			snprintf(name, sizeof name, "%g and more", tint->breaks[i - 1]);
		eco_tint_add(tint, name, NULL, from.classes[of].own ? NULL : from.classes[of].rgb);
	}
	drop_classes(&from);
}

void eco_tint_free(struct eco_tint *tint)
{
	drop_classes(tint);
	free(tint->column);
	free(tint->breaks);
}

/* ---- The class of a value ---- */

/* How long the class's longest phrase is that a value, as words, begins with; 0: none. */
static size_t longest(const char *value, const struct eco_tint_class *class)
{
	size_t best = 0, bytes;
	for (const char *at = class->phrases ? class->phrases : ""; *at; at += bytes + (at[bytes] != 0)) {
		bytes = strcspn(at, "|");
		bool begins = strncmp(value, at, bytes) == 0 && (value[bytes] == 0 || value[bytes] == ' ');
		best = begins && bytes > best ? bytes : best;
	}
	return best;
}

/* A class that is named like the value comes first. */
static uint32_t class_of_text(const struct eco_tint *tint, const char *text)
{
	char value[ECO_WORDS_BYTES], name[ECO_WORDS_BYTES];
	uint32_t best = tint->class_count;
	size_t length = 0;
	eco_words_of(text, value, sizeof value);
	for (uint32_t i = 0; i < tint->class_count; i++) {
		eco_words_of(tint->classes[i].name, name, sizeof name);
		if (*name && strcmp(name, value) == 0)
			return i;
		size_t here = longest(value, &tint->classes[i]);
		best = here > length ? i : best;
		length = here > length ? here : length;
	}
	return best;
}

/* class_count: no class has this value. */
static uint32_t class_of(const struct eco_tint *tint, const char *text)
{
	double number, unit_m;
	uint32_t class = 0;
	if (eco_text_is_missing(text))
		return class_named(tint, ECO_TINT_NOT_STATED);
	if (!tint->break_count)
		return class_of_text(tint, text);
	if (!eco_text_number(text, tint->decimal, &number)
			&& eco_text_size(text, tint->decimal, &number, &unit_m) == ECO_FORM_NONE)
		return class_named(tint, ECO_TINT_NOT_STATED);
	while (class < tint->break_count && number >= tint->breaks[class])
		class++;
	return class;
}

const char *eco_tint_fitting(const char *const *texts, uint32_t count, double *share)
{
	const char *best = NULL;
	*share = 0;
	for (size_t row = 0; row < ROWS; row++) {
		struct eco_tint tint = { 0 };
		uint32_t stated = 0, met = 0, seen[ECO_TINT_CLASSES_MAX] = { 0 }, classes = 0;
		if ((row && strcmp(tints_rows[row].palette, tints_rows[row - 1].palette) == 0)
				|| !eco_tint_palette(&tint, tints_rows[row].palette))
			continue;
		for (uint32_t i = 0; i < count; i++) {
			uint32_t class = eco_text_is_missing(texts[i]) ? ECO_NONE : class_of_text(&tint, texts[i]);
			stated += class != ECO_NONE;
			met += class < tint.class_count;
			classes += class < tint.class_count && !seen[class]++;
		}
		if (classes >= 2 && met > *share * stated) {
			*share = (double)met / stated;
			best = tints_rows[row].palette;
		}
		eco_tint_free(&tint);
	}
	return best;
}

/* ---- Values of all rows ---- */

struct value { const struct eco_tint *tint; uint32_t class, code; char *text; uint64_t plants; };

struct eco_tint_values {
	struct eco_string_pool keys; /* the tint's number, then its class's or the folded text */
	struct value *items;         uint32_t room;
	const struct eco_tint **tints;       uint32_t tint_count, tint_room;
};

static uint32_t tint_number(struct eco_tint_values *v, const struct eco_tint *tint)
{
	uint32_t i = 0;
	while (i < v->tint_count && v->tints[i] != tint)
		i++;
	if (i == v->tint_count) {
		eco_grow(&v->tints, &v->tint_room, v->tint_count, sizeof *v->tints);
		v->tints[v->tint_count++] = tint;
	}
	return i;
}

uint32_t eco_tints_value(struct eco_tints *tints, const struct eco_tint *tint, const char *text)
{
	char key[KEY_BYTES], folded[KEY_BYTES - 16];
	if (!tint->column)
		return 0;
	if (!tints->values)
		tints->values = eco_alloc(1, sizeof *tints->values);
	struct eco_tint_values *v = tints->values;
	bool by_class = tint->break_count || v->keys.count >= VALUES_MAX;
	uint32_t number = tint_number(v, tint), class = by_class ? class_of(tint, text) : 0, before = v->keys.count;
	if (by_class && class == tint->class_count)
		class = class_named(tint, ECO_TINT_OTHER);
	eco_text_fold(text, folded, sizeof folded);
	if (by_class)
		snprintf(key, sizeof key, "%u+%u", number, class);
	else
		snprintf(key, sizeof key, "%u=%s", number, folded);
	uint32_t at = eco_string_number(&v->keys, key);
	if (at == before) {
		eco_grow(&v->items, &v->room, at, sizeof *v->items);
		v->items[at] = (struct value){ tint, by_class ? class : class_of(tint, text), 0, eco_copy_text(text), 0 };
	}
	v->items[at].plants++;
	return at + 1;
}

static int by_most(const void *a, const void *b, void *ctx)
{
	const struct value *v = ctx, *x = &v[*(const uint32_t *)a], *y = &v[*(const uint32_t *)b];
	return x->plants != y->plants ? (x->plants > y->plants ? -1 : 1) : strcmp(x->text, y->text);
}

/* Adds plants to a class of the legend; 1 + its place. */
static uint32_t add_class(struct eco_tints *tints, const struct eco_tint *tint, const struct eco_tint_class *class,
	const char *name, uint64_t plants)
{
	uint32_t i = 0;
	for (; i < tints->class_count; i++) {
		struct eco_tint_legend *l = &tints->classes[i];
		if (strcmp(l->column, tint->column) == 0 && strcmp(l->name, name) == 0 && l->own == class->own
				&& memcmp(l->rgb, class->rgb, sizeof l->rgb) == 0)
			break;
	}
	if (i == tints->class_count) {
		if (i == ECO_TINTS_CLASSES_MAX)
			eco_stop(ECO_TOO_LARGE, "the tints of one scene file have more than %u classes", ECO_TINTS_CLASSES_MAX);
		eco_grow(&tints->classes, &tints->class_room, i, sizeof *tints->classes);
		tints->classes[tints->class_count++] = (struct eco_tint_legend){ tint->column, eco_copy_text(name),
			{ class->rgb[0], class->rgb[1], class->rgb[2] }, class->own, 0 };
	}
	tints->classes[i].plants += plants;
	return i + 1;
}

/* The classes of one column: those of the palette in its order, then values in its free colours. */
static void settle_tint(struct eco_tints *tints, const struct eco_tint *tint)
{
	struct eco_tint_values *v = tints->values;
	uint32_t *left = eco_alloc(v->keys.count, sizeof *left), count = 0, taken = 0;
	for (uint32_t i = 0; i < v->keys.count; i++)
		if (v->items[i].tint == tint && v->items[i].class == tint->class_count)
			left[count++] = i;
	qsort_r(left, count, sizeof *left, by_most, v->items);
	for (uint32_t c = 0; c < tint->class_count; c++) {
		const struct eco_tint_class *class = &tint->classes[c];
		if (strcmp(class->name, ECO_TINT_FREE) == 0 && taken < count) {
			struct value *value = &v->items[left[taken++]];
			value->code = add_class(tints, tint, class, value->text, value->plants);
		}
		while (strcmp(class->name, ECO_TINT_OTHER) == 0 && taken < count)
			v->items[left[taken++]].class = c;
		for (uint32_t i = 0; i < v->keys.count; i++)
			if (v->items[i].tint == tint && v->items[i].class == c)
				v->items[i].code = add_class(tints, tint, class, class->name, v->items[i].plants);
	}
	free(left);
}

static void settle(void *ctx)
{
	struct eco_tints *tints = ctx;
	for (uint32_t i = 0; tints->values && i < tints->values->tint_count; i++)
		settle_tint(tints, tints->values->tints[i]);
}

enum eco_code eco_tints_settle(struct eco_tints *tints, struct eco_error *error)
{
	return eco_try(settle, tints, error);
}

uint32_t eco_tints_class(const struct eco_tints *tints, uint32_t number)
{
	return number ? tints->values->items[number - 1].code : 0;
}

void eco_tints_free(struct eco_tints *tints)
{
	struct eco_tint_values *v = tints->values;
	for (uint32_t i = 0; i < tints->class_count; i++)
		free(tints->classes[i].name);
	free(tints->classes);
	for (uint32_t i = 0; v && i < v->keys.count; i++)
		free(v->items[i].text);
	if (v) {
		eco_string_pool_free(&v->keys);
		eco_free(v->items, v->tints, v);
	}
	*tints = (struct eco_tints){ 0 };
}
