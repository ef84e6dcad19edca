#include "ecofiles/import/places/flora.h"

#include <stdio.h>
#include <string.h>

#include "build/words/forms.table"
#include "build/words/genera.table"
#include "build/words/species.table"
#include "ecofiles/import/places/words.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))

const char *const eco_form_names[ECO_FORM_COUNT] = { "plant", "broad-leaved tree", "conifer", "column",
	"weeping tree", "palm", "shrub", "herb", "grass", "no plant" };

struct eco_form_size eco_form_size(enum eco_form form)
{
	static const struct eco_form_size sizes[ECO_FORM_COUNT] = {
		[ECO_FORM_UNKNOWN] = { 0.05, 60, 3 }, [ECO_FORM_BROAD] = { 2, 50, 12 },
		[ECO_FORM_CONIFER] = { 2, 90, 18 }, [ECO_FORM_COLUMN] = { 1.5, 40, 10 },
		[ECO_FORM_WEEPING] = { 2, 40, 10 }, [ECO_FORM_PALM] = { 1.5, 40, 9 },
		[ECO_FORM_SHRUB] = { 0.3, 12, 2 }, [ECO_FORM_HERB] = { 0.03, 3, 0.5 },
		[ECO_FORM_GRASS] = { 0.03, 5, 0.4 }, [ECO_FORM_NOTHING] = { 0, 1000, 1 } };
	return sizes[form];
}

bool eco_form_is_tree(enum eco_form form)
{
	return form >= ECO_FORM_BROAD && form <= ECO_FORM_PALM;
}

static enum eco_form form_named(const char *name)
{
	int form = ECO_FORM_COUNT - 1;
	while (form > 0 && strcmp(eco_form_names[form], name) != 0)
		form--;
	return (enum eco_form)form;
}

/* ---- Matching ---- */

/* Letters of any alphabet. */
static size_t letters(const char *word)
{
	size_t count = 0;
	for (; *word != 0; word++)
		count += ((unsigned char)*word & 0xc0) != 0x80;
	return count;
}

/* Whether a list of words has `word`, or, where it is long, a word that it ends with: "stieleiche". */
static bool listed(const char *list, const char *word, bool ends)
{
	char found[ECO_WORD_BYTES];
	size_t length = strlen(word);
	while (eco_words_next(&list, found)) {
		size_t own = strlen(found);
		bool same = strcmp(found, word) == 0;
		bool plural = own + 1 == length && word[own] == 's' && strncmp(found, word, own) == 0;
		if (same || plural ||
			(ends && letters(found) >= 5 && length > own
			&& strcmp(word + length - own, found) == 0))
			return true;
	}
	return false;
}

static bool fits_genus(size_t i, const char *word)
{
	return strcmp(genera_rows[i].genus, word) == 0 || listed(genera_rows[i].names, word, true);
}

/* A word that lies within one letter, or two where it is long, of a genus or a name. */
static const char *nearly(size_t i, const char *word)
{
	unsigned most = letters(word) >= 8 ? 2 : 1;
	const char *list = genera_rows[i].names;
	char name[ECO_WORD_BYTES];
	if (eco_words_distance(genera_rows[i].genus, word, most) <= most)
		return genera_rows[i].genus;
	while (eco_words_next(&list, name))
		if (letters(name) >= 5 && eco_words_distance(name, word, most) <= most)
			return genera_rows[i].genus;
	return NULL;
}

static bool find_genus(const char *words, struct eco_flora *flora)
{
	char word[ECO_WORD_BYTES];
	/* a Latin name is surer than a common one: "plum pine (Podocarpus)", "Norway maple (Acer ...)" */
	for (int latin = 1; latin >= 0; latin--)
		for (const char *at = words; eco_words_next(&at, word);)
			for (size_t i = 0; i < COUNT(genera_rows); i++) {
				if (latin ? strcmp(genera_rows[i].genus, word) != 0 : !fits_genus(i, word))
					continue;
				flora->genus = genera_rows[i].genus;
				flora->form = form_named(genera_rows[i].form);
				return true;
			}
	return false;
}

/* The first species whose genus and epithet begin with the two halves of a word of four or six letters. */
static bool find_coded(const char *word, struct eco_flora *flora)
{
	size_t half = strlen(word) / 2;
	char epithet[ECO_WORD_BYTES];
	if (strlen(word) != 4 && strlen(word) != 6)
		return false;
	for (size_t i = 0; i < COUNT(species_rows); i++) {
		if (strncmp(species_rows[i].genus, word, half) != 0)
			continue;
		for (const char *at = species_rows[i].epithets; eco_words_next(&at, epithet);)
			if (strncmp(epithet, word + half, half) == 0) {
				find_genus(species_rows[i].genus, flora);
				snprintf(flora->coded, sizeof flora->coded, "%s %s", species_rows[i].genus, epithet);
				return true;
			}
	}
	return false;
}

static bool ends_in_one_of(const char *word, const char *endings)
{
	char ending[ECO_WORD_BYTES];
	size_t length = strlen(word);
	while (eco_words_next(&endings, ending)) {
		size_t own = strlen(ending);
		if (length > own + 1 && strcmp(word + length - own, ending) == 0)
			return true;
	}
	return false;
}

/* A Latin genus and what follows it, "Terminalia catappa": by its endings, which names in other languages
 * rarely have both. */
static bool is_binomial(const char *words)
{
	char genus[ECO_WORD_BYTES], epithet[ECO_WORD_BYTES];
	return eco_words_next(&words, genus) && eco_words_next(&words, epithet)
		&& ends_in_one_of(genus, "a us um is on os es as ix ys")
		&& ends_in_one_of(epithet, "a us um is i ii ae ens ans oides or ior");
}

/* Only the first word of a Latin name may be a genus: "rosea" is no rose. */
static void find_misspelt(const char *words, struct eco_flora *flora)
{
	char word[ECO_WORD_BYTES];
	bool latin = is_binomial(words);
	for (size_t k = 0; eco_words_next(&words, word) && !(latin && k > 0); k++)
		for (size_t i = 0; letters(word) >= 5 && i < COUNT(genera_rows); i++) {
			const char *meant = nearly(i, word);
			if (!meant)
				continue;
			flora->genus = genera_rows[i].genus;
			flora->form = form_named(genera_rows[i].form);
			flora->meant = meant;
			snprintf(flora->misspelt, sizeof flora->misspelt, "%s", word);
			return;
		}
}

static enum eco_form form_by_word(const char *words, bool after_genus)
{
	char word[ECO_WORD_BYTES];
	for (size_t i = 0; i < COUNT(forms_rows); i++) {
		if (after_genus && strcmp(forms_rows[i].where, "always") != 0)
			continue;
		for (const char *at = words; eco_words_next(&at, word);)
			if (listed(forms_rows[i].words, word, true))
				return form_named(forms_rows[i].form);
	}
	return ECO_FORM_UNKNOWN;
}

struct eco_flora eco_flora_of(const char *name, bool spelling)
{
	struct eco_flora flora = { .genus = NULL };
	char words[ECO_WORDS_BYTES];
	eco_words_of(name, words, sizeof words);
	bool known = find_genus(words, &flora);
	enum eco_form form = form_by_word(words, known);
	if (form != ECO_FORM_UNKNOWN)
		flora.form = form;
	else if (!known && spelling && !find_coded(words, &flora))
		find_misspelt(words, &flora);
	return flora;
}

bool eco_flora_is_code(const char *name)
{
	struct eco_flora flora = { .genus = NULL };
	char words[ECO_WORDS_BYTES];
	eco_words_of(name, words, sizeof words);
	return find_coded(words, &flora);
}
