/* Names as words: "Höhe (m)", "HOEHE_M", "decimalLatitude" and "utm17n_e" become "hohe m", "hoehe m",
 * "decimal latitude" and "utm 17 n e". For comparing the names of columns, species and files. The words that
 * are known stand in words/NAME.tsv; the Makefile makes build/words/NAME.table of each, an array of its
 * rows. */
#ifndef ECO_WORDS_H
#define ECO_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ECO_WORDS_BYTES 256u
#define ECO_WORD_BYTES 48u

/* Lower case (Latin and Cyrillic), letters without their marks, one space between runs of letters and of
 * digits. Cut to `size` bytes with the ending 0. Returns the length. */
size_t eco_words_of(const char *text, char *words, size_t size);
/* Goes to the next word of such a text; *at is the text at first. False behind the last. */
bool eco_words_next(const char **at, char word[ECO_WORD_BYTES]);
/* Whether a text of words has this word. */
bool eco_words_have(const char *words, const char *word);
/* Whether a name, as written, has one of these words. */
bool eco_words_any(const char *name, const char *words);
/* The words of a set of words/sets.tsv, which has it. */
const char *eco_words_set(const char *set);
/* Letters inserted, left out, replaced or swapped with their neighbours between two words; more than
 * `most`: most + 1. */
unsigned eco_words_distance(const char *a, const char *b, unsigned most);

/* ---- Plants by name: the genus, the form of growth and the usual size behind a species' name or a model's,
 * Latin or common, in a few languages. For choosing models and for doubting sizes; nothing of it decides
 * where a scene file says ---- */

enum eco_form {
	ECO_FORM_UNKNOWN, ECO_FORM_BROAD, ECO_FORM_CONIFER, ECO_FORM_COLUMN, ECO_FORM_WEEPING, ECO_FORM_PALM,
	ECO_FORM_SHRUB, ECO_FORM_HERB, ECO_FORM_GRASS,
	ECO_FORM_NOTHING,        /* a vacant place, a stump, a rock: no plant */
	ECO_FORM_COUNT
};
extern const char *const eco_form_names[ECO_FORM_COUNT];

struct eco_flora {
	const char *genus;           /* "quercus"; NULL: not known */
	enum eco_form form;
	char misspelt[48];           /* the word that is not quite the genus; "": spelt well */
	const char *meant;           /* the word taken for it */
	char coded[64];              /* the species that a code stands for; "": it is none */
};

/* The plant that a name means. `spelling`: also by words of five letters and more that are nearly a genus or
 * its common name, and by codes of two or three letters of each word of a common species: "fasy",
 * "QUEROB". */
struct eco_flora eco_flora_of(const char *name, bool spelling);

/* Whether a name is such a code. */
bool eco_flora_is_code(const char *name);

/* Heights in metres between which a full-grown plant of that form is usual, and a typical one. A plant of
 * unknown form may be anything that grows. */
struct eco_form_size { double least_m, most_m, typical_m; };
struct eco_form_size eco_form_size(enum eco_form form);
/* Whether a plant of one form may stand for one of the other: trees for trees, low plants for low ones. */
bool eco_form_is_tree(enum eco_form form);

#endif
