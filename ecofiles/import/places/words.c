#include "ecofiles/import/places/words.h"

#include <string.h>
#include <stdio.h>

#include "build/words/sets.table"
#include "build/words/forms.table"
#include "build/words/genera.table"
#include "build/words/species.table"

/* Letters from U+00C0 on without their marks. */
static const char latin_1[] = "aaaaaaaceeeeiiiidnooooo ouuuuyts" "aaaaaaaceeeeiiiidnooooo ouuuuyty";
static const char latin_a[] = "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiiiiijjkkklllllllllln"
	"nnnnnnnnoooooooorrrrrrsssssssstttttt" "uuuuuuuuuuuuwwyyyzzzzzzs";

enum kind { GAP, LETTER, CAPITAL, DIGIT };

/* Cyrillic letters: small, and without the marks of two. */
static enum kind take_cyrillic(unsigned point, char sign[3])
{
	unsigned small = point >= 0x410 && point < 0x430 ? point + 0x20 : point < 0x410 ? point + 0x50
		: point;
	enum kind kind = small != point ? CAPITAL : LETTER;
	small = small == 0x451 ? 0x435 : small;
	sign[0] = (char)(0xc0 | small >> 6);
	sign[1] = (char)(0x80 | (small & 0x3f));
	return kind;
}

/* The sign at *text as a letter of words, and its kind; *text moves on. Signs of other alphabets stay. */
static enum kind take_sign(const unsigned char **text, char sign[3])
{
	unsigned c = *(*text)++;
	sign[0] = (char)c;
	sign[1] = sign[2] = 0;
	if (c >= '0' && c <= '9')
		return DIGIT;
	if (c >= 'A' && c <= 'Z') {
		sign[0] = (char)(c + 32);
		return CAPITAL;
	}
	if (c < 0x80)
		return c >= 'a' && c <= 'z' ? LETTER : GAP;
	bool latin = c >= 0xc3 && c <= 0xc5, cyrillic = c == 0xd0 || c == 0xd1;
	if (!(latin || cyrillic) || (**text & 0xc0) != 0x80)
		return c == 0xc2 && **text != 0 ? (++*text, GAP) : LETTER;
	unsigned point = (c & 0x1f) << 6 | (*(*text)++ & 0x3fu);
	if (cyrillic)
		return take_cyrillic(point, sign);
	sign[0] = point < 0x100 ? latin_1[point - 0xc0] : latin_a[point - 0x100];
	if (sign[0] == ' ')
		return GAP;
	return point < 0xdf || (point >= 0x100 && point % 2 == 0) ? CAPITAL : LETTER;
}

static bool begins_word(enum kind before, enum kind now)
{
	return before != GAP && ((before == DIGIT) != (now == DIGIT) || (before == LETTER && now == CAPITAL));
}

size_t eco_words_of(const char *text, char *words, size_t size)
{
	const unsigned char *at = (const unsigned char *)text;
	enum kind before = GAP;
	size_t used = 0;
	while (*at != 0 && used + 4 < size) {
		char sign[3];
		enum kind now = take_sign(&at, sign);
		if (now != GAP && used > 0 && (before == GAP || begins_word(before, now)))
			words[used++] = ' ';
		for (const char *c = sign; now != GAP && *c != 0; c++)
			words[used++] = *c;
		before = now;
	}
	words[used] = 0;
	return used;
}

bool eco_words_next(const char **at, char word[ECO_WORD_BYTES])
{
	*at += strspn(*at, " ");
	size_t length = strcspn(*at, " "), kept = length < ECO_WORD_BYTES ? length : ECO_WORD_BYTES - 1;
	memcpy(word, *at, kept);
	word[kept] = 0;
	*at += length;
	return length > 0;
}

bool eco_words_have(const char *words, const char *word)
{
	char own[ECO_WORD_BYTES];
	while (eco_words_next(&words, own))
		if (strcmp(own, word) == 0)
			return true;
	return false;
}

bool eco_words_any(const char *name, const char *words)
{
	char own[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	eco_words_of(name, own, sizeof own);
	for (const char *at = own; eco_words_next(&at, word);)
		if (eco_words_have(words, word))
			return true;
	return false;
}

const char *eco_words_set(const char *set)
{
	size_t i = 0;
	while (strcmp(sets_rows[i].set, set) != 0)
		i++;
	return sets_rows[i].words;
}

/* Damerau's distance, by Wagner and Fischer's table in three rows. */
unsigned eco_words_distance(const char *a, const char *b, unsigned most)
{
	unsigned rows[3][ECO_WORD_BYTES], *before = rows[0], *last = rows[1], *now = rows[2];
	size_t n = strlen(a), m = strlen(b);
	if (n >= ECO_WORD_BYTES || m >= ECO_WORD_BYTES || (n > m ? n - m : m - n) > most)
		return most + 1;
	for (size_t j = 0; j <= m; j++)
		last[j] = (unsigned)j;
	for (size_t i = 1; i <= n; i++) {
		now[0] = (unsigned)i;
		for (size_t j = 1; j <= m; j++) {
			unsigned best = last[j - 1] + (a[i - 1] != b[j - 1]);
			best = last[j] + 1 < best ? last[j] + 1 : best;
			best = now[j - 1] + 1 < best ? now[j - 1] + 1 : best;
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				best = before[j - 2] + 1 < best ? before[j - 2] + 1 : best;
			now[j] = best;
		}
		unsigned *free_row = before;
		before = last;
		last = now;
		now = free_row;
	}
	return last[m] > most ? most + 1 : last[m];
}

/* ---- Plants ---- */

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
				snprintf(flora->coded, sizeof flora->coded, "%s %s", species_rows[i].genus,
					epithet);
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
