/* Tints: colours that plants get by a column of their inventory, and the classes that a legend names.
 *
 *   eco_tint_palette(&tint, "health")                 or classes that a scene states (scene_rows.c)
 *   number = eco_tints_value(tints, &tint, text)      of each row that becomes a plant
 *   eco_tints_settle(tints, &error)                   once all rows are read
 *   eco_tints_class(tints, number)                    the plant's class: 1 + its place in tints->classes; 0: none
 *   eco_tints_free(tints)
 *
 * Palettes are rows of words/tints.tsv. Values without a class of the palette take its free colours, the
 * commonest first, then the class "other"; missing values and what is no number are "not stated". Texts are
 * compared without capitals, marks and signs. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_TINT_CLASSES_MAX 64u /* of a palette */
#define ECO_TINTS_CLASSES_MAX 255u       /* of all inventories of a scene file: a code is a byte */
#define ECO_TINT_FREE "*"
#define ECO_TINT_OTHER "other"
#define ECO_TINT_NOT_STATED "not stated"

/* phrases NULL: the name; own: the plant keeps its colour, and rgb is 0, 0, 0 */
struct eco_tint_class { char *name; const char *phrases; uint8_t rgb[3]; bool own; };

struct eco_tint {                /* of an inventory; owned by the spec's maker; column NULL: none */
	char *column;
	struct eco_tint_class *classes;  uint32_t class_count;
	/* not 0: the first break_count + 1 classes are those of numbers below, between and from the breaks on */
	double *breaks;                  uint32_t break_count;
	char decimal;                    /* of the column's numbers: '.' or ',' */
};

/* Appends a class; `name` is copied. rgb NULL: it keeps its own colour. */
void eco_tint_add(struct eco_tint *tint, const char *name, const char *phrases, const uint8_t rgb[3]);
/* Takes the classes of a palette of words/tints.tsv. False: there is none of this name. */
bool eco_tint_palette(struct eco_tint *tint, const char *name);
/* "age", "health", ...: the names, for a message. */
const char *eco_tint_palettes(char *text, size_t size);
/* Adds "other" and "not stated" where they are absent; the last step. */
void eco_tint_close(struct eco_tint *tint);
/* Replaces the classes by those of the breaks, with their colours evenly from the first to the last. */
void eco_tint_divide(struct eco_tint *tint);
void eco_tint_free(struct eco_tint *tint);

/* The palette with classes for the most of these texts, of which each class may be met by several; *share: of
 * texts that are stated. NULL: none has two of them. */
const char *eco_tint_fitting(const char *const *texts, uint32_t count, double *share);

struct eco_tint_legend {         /* a class that some plant has */
	const char *column;
	char *name;
	uint8_t rgb[3];
	bool own;
	uint64_t plants;
};
struct eco_tints {               /* zero is empty */
	struct eco_tint_legend *classes; uint32_t class_count, class_room;
	struct eco_tint_values *values;
};

/* 0: `tint` has no column. */
uint32_t eco_tints_value(struct eco_tints *tints, const struct eco_tint *tint, const char *text);
/* ECO_TOO_LARGE: more than ECO_TINTS_CLASSES_MAX classes. */
enum eco_code eco_tints_settle(struct eco_tints *tints, struct eco_error *error);
uint32_t eco_tints_class(const struct eco_tints *tints, uint32_t number);
void eco_tints_free(struct eco_tints *tints);
