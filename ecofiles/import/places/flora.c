/* From a name to a genus. A Latin name is surest: a genus where a part of the name begins, or one with an
 * epithet of its own behind it. Next come common names, the longest phrase first. In Germanic languages and
 * those of East Asia the noun ends a name ("cedar elm", "Stieleiche"), in others it begins it ("pin noir").
 * Codes and misspellings are looked for last. Longer than 600 lines: each step of one search, in its
 * order. */
#include "ecofiles/import/places/flora.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/codes.table"
#include "build/words/forms.table"
#include "build/words/genera.table"
#include "build/words/growth.table"
#include "build/words/names.table"
#include "build/words/species.table"
#include "ecofiles/base/order.h"
#include "ecofiles/import/places/words.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))
#define PHRASE_WORDS 5u
#define WORDS 40u
#define PARTS 8u

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

static enum eco_leaf leaf_named(const char *name)
{
	return strcmp(name, "evergreen") == 0 ? ECO_LEAF_EVERGREEN
		: strcmp(name, "deciduous") == 0 ? ECO_LEAF_DECIDUOUS : ECO_LEAF_UNKNOWN;
}

enum eco_region eco_region_of(double longitude, double latitude)
{
	if (isnan(longitude) || isnan(latitude))
		return ECO_REGION_UNKNOWN;
	if (longitude < -30)
		return ECO_REGION_AMERICA;
	if (latitude < -8 && longitude > 110)
		return ECO_REGION_OCEANIA;
	if (latitude < 34.5 && longitude < 52)
		return ECO_REGION_AFRICA;
	return longitude < 45 || (latitude > 47 && longitude < 60) ? ECO_REGION_EUROPE : ECO_REGION_ASIA;
}

static bool is_region(const char *where, enum eco_region region)
{
	static const char *const names[] = { "", "america", "europe", "africa", "asia", "oceania" };
	return strcmp(where, names[region]) == 0;
}

/* ---- A name in words and parts ---- */

struct name {
	char words[ECO_WORDS_BYTES], word[WORDS][ECO_WORD_BYTES];
	unsigned count, part[PARTS], parts;  /* part: number of the first word of each part, as the brackets and
	                                      * commas of the name make them */
	bool one_comma;
};

/* Whether a part of a name ends before `at`: brackets, commas, colons, quotes and dashes between spaces. */
static bool parts_here(const char *from, const char *at)
{
	bool open = at == from || at[-1] == ' ', close = at[1] == ' ' || at[1] == 0;
	if (strchr("()[]{},;:/|\"`+", *at))
		return true;
	return (*at == '\'' && (open || close)) || (*at == '-' && open && close);
}

static void add_words(struct name *n, const char *words)
{
	while (n->count < WORDS && eco_words_next(&words, n->word[n->count]))
		n->count++;
}

static void add_part(struct name *n, const char *text, size_t bytes)
{
	char part[ECO_WORDS_BYTES], words[ECO_WORDS_BYTES];
	snprintf(part, sizeof part, "%.*s", (int)(bytes < sizeof part ? bytes : sizeof part - 1), text);
	if (eco_words_of(part, words, sizeof words) == 0)
		return;
	if (n->parts < PARTS)
		n->part[n->parts++] = n->count;
	add_words(n, words);
}

static void read_name(struct name *n, const char *text)
{
	const char *from = text, *at = text;
	unsigned commas = 0;
	n->count = n->parts = 0;
	for (; *at != 0; at++) {
		if (!parts_here(text, at))
			continue;
		commas += *at == ',' ? 1 : 2;
		add_part(n, from, (size_t)(at - from));
		from = at + 1;
	}
	add_part(n, from, (size_t)(at - from));
	n->one_comma = commas == 1 && n->parts == 2;
	eco_words_of(text, n->words, sizeof n->words);
}

/* Whether words, of one space between, hold a phrase. */
static bool has_phrase(const char *words, const char *phrase, size_t bytes)
{
	for (const char *at = words; (at = strstr(at, (char[2]){ *phrase, 0 })); at++)
		if ((at == words || at[-1] == ' ') && strncmp(at, phrase, bytes) == 0
				&& (at[bytes] == ' ' || at[bytes] == 0))
			return true;
	return false;
}

/* Whether words hold one of some phrases, a bar between. */
static bool has_one(const char *words, const char *phrases)
{
	for (const char *at = phrases; *at != 0;) {
		size_t bytes = strcspn(at, "|");
		if (has_phrase(words, at, bytes))
			return true;
		at += bytes + (at[bytes] == '|');
	}
	return false;
}

/* Letters of any alphabet. */
static size_t letters(const char *word)
{
	size_t count = 0;
	for (; *word != 0; word++)
		count += ((unsigned char)*word & 0xc0) != 0x80;
	return count;
}

/* ---- Genera, epithets and names ---- */

static int compare_genus(const void *word, const void *row)
{
	return strcmp(word, *(const char *const *)row);
}

/* The row of a genus; COUNT(genera_rows): none. */
static size_t genus_row(const char *word)
{
	const char *const *row = bsearch(word, genera_rows, COUNT(genera_rows), sizeof *genera_rows,
		compare_genus);
	return row ? (size_t)((const char *)row - (const char *)genera_rows) / sizeof *genera_rows
		: COUNT(genera_rows);
}

static const char *epithets_of(const char *genus)
{
	const char *const *row = bsearch(genus, species_rows, COUNT(species_rows), sizeof *species_rows,
		compare_genus);
	return row ? row[1] : "";
}

static void take_genus(struct eco_flora *flora, size_t row)
{
	flora->genus = genera_rows[row].genus;
	flora->form = form_named(genera_rows[row].form);
	flora->leaf = leaf_named(genera_rows[row].leaf);
	flora->height_m = genera_rows[row].height_m;
}

const char *eco_flora_leaf(const char *genus, enum eco_form form, double *leaf_cm)
{
	size_t row = genus ? genus_row(genus) : COUNT(genera_rows);
	bool known = row < COUNT(genera_rows);
	*leaf_cm = known ? genera_rows[row].leaf_cm : form == ECO_FORM_CONIFER ? 3 : form == ECO_FORM_SHRUB ? 5
		: form == ECO_FORM_GRASS ? 20 : form == ECO_FORM_PALM ? 250 : 9;
	return known ? genera_rows[row].shape : form == ECO_FORM_CONIFER ? "needle" : form == ECO_FORM_PALM ? "palm"
		: form == ECO_FORM_GRASS ? "blade" : "simple";
}

static void take_taxon(struct eco_flora *flora, const char *taxon)
{
	char genus[ECO_WORD_BYTES];
	eco_words_next(&taxon, genus);
	take_genus(flora, genus_row(genus));
	snprintf(flora->epithet, sizeof flora->epithet, "%s", *taxon ? taxon + 1 : "");
}

static bool ends_name(const char *language)
{
	return eco_words_have("en de nl sv da no fi hu tr ja zh ko lt lv et sl sr bg hi", language);
}

static bool is_compounded(const char *language)
{
	return eco_words_have("de nl sv da no fi et hu ja zh ko", language);
}

/* The first row of names with this name; COUNT(names_rows): none. */
static size_t name_row(const char *name)
{
	size_t low = 0, high = COUNT(names_rows);
	ECO_LEAST(low, high, i, strcmp(names_rows[i].name, name) >= 0)
	return low < COUNT(names_rows) && strcmp(names_rows[low].name, name) == 0 ? low : COUNT(names_rows);
}

/* The row that means a name in a region, there before everywhere. */
static size_t name_in(const char *name, enum eco_region region)
{
	size_t first = name_row(name), best = COUNT(names_rows);
	for (size_t i = first; i < COUNT(names_rows) && strcmp(names_rows[i].name, name) == 0; i++) {
		if (region != ECO_REGION_UNKNOWN && is_region(names_rows[i].where, region))
			return i;
		if (best == COUNT(names_rows) && strcmp(names_rows[i].where, "all") == 0)
			best = i;
	}
	/* a name of other regions alone is the best guess where the region is not known */
	return best == COUNT(names_rows) && region == ECO_REGION_UNKNOWN ? first : best;
}

/* A name, or its plural. */
static size_t name_or_plural(const char *phrase, enum eco_region region)
{
	char singular[ECO_WORDS_BYTES];
	size_t row = name_in(phrase, region), bytes = strlen(phrase);
	if (row < COUNT(names_rows) || bytes < 4 || phrase[bytes - 1] != 's')
		return row;
	snprintf(singular, sizeof singular, "%.*s", (int)bytes - 1, phrase);
	row = name_in(singular, region);
	return row < COUNT(names_rows) && strcmp(names_rows[row].language, "en") == 0 ? row : COUNT(names_rows);
}

/* A word without the sign of a tree or a kind at its end: "银杏树". */
static bool shorten(const char *word, char *shorter)
{
	static const char *const signs[] = { "\u6811", "\u6a39", "\u6728", "\u985e", "\u7c7b" };
	size_t bytes = strlen(word);
	for (size_t i = 0; i < sizeof signs / sizeof *signs && bytes > 3; i++)
		if (strcmp(word + bytes - 3, signs[i]) == 0) {
			snprintf(shorter, ECO_WORDS_BYTES, "%.*s", (int)bytes - 3, word);
			return true;
		}
	return false;
}

/* The longest name that a word ends with: "stieleiche", in long words one of four letters, "schwarzerle", and
 * in East Asia's writings one of any length. */
static size_t name_at_end(const char *word, enum eco_region region)
{
	size_t all = letters(word), left = all;
	for (const char *at = word; *at != 0; at++) {
		if (((unsigned char)*at & 0xc0) == 0x80)
			continue;
		bool east = (unsigned char)*at >= 0xe3;
		if (at > word && (east || left >= 5 || (left == 4 && all >= 7))) {
			size_t row = name_in(at, region);
			if (row < COUNT(names_rows) && is_compounded(names_rows[row].language))
				return row;
		}
		left--;
	}
	return COUNT(names_rows);
}

/* ---- Latin names ---- */

static bool is_skipped(const char *word)
{
	return eco_words_have("x cf aff sp spp species hybr hybrid", word) || (word[0] >= '0' && word[0] <= '9');
}

/* The epithet behind the i-th word, if it is written in Latin letters: the next, or the one after the sign of
 * a hybrid. */
static const char *epithet_behind(const struct name *n, unsigned i)
{
	i++;
	if (i < n->count && strcmp(n->word[i], "x") == 0)
		i++;
	for (unsigned k = 0; k < n->parts; k++)
		if (n->part[k] == i)
			return "";
	return i < n->count && !is_skipped(n->word[i]) && (unsigned char)n->word[i][0] < 0x80 ? n->word[i] : "";
}

static bool begins_part(const struct name *n, unsigned i)
{
	for (unsigned k = 0; k < n->parts; k++) {
		unsigned first = n->part[k];
		while (first < n->count && is_skipped(n->word[first]))
			first++;
		if (first == i)
			return true;
	}
	return false;
}

/* A genus with an epithet that is known to be its own, or where a part of the name begins. */
static bool find_latin(const struct name *n, bool sure, struct eco_flora *flora)
{
	for (unsigned i = 0; i < n->count; i++) {
		size_t row = genus_row(n->word[i]);
		if (row == COUNT(genera_rows))
			continue;
		const char *epithet = epithet_behind(n, i);
		bool own = *epithet != 0 && eco_words_have(epithets_of(n->word[i]), epithet);
		if (sure ? !own : !begins_part(n, i))
			continue;
		take_genus(flora, row);
		snprintf(flora->epithet, sizeof flora->epithet, "%.31s", epithet);
		return true;
	}
	return false;
}

/* "Q. robur": the only genus with that initial and epithet. */
static bool find_initial(const struct name *n, struct eco_flora *flora)
{
	size_t found = COUNT(species_rows);
	if (n->count < 2 || n->word[0][1] != 0 || n->parts != 1 || letters(n->word[1]) < 4)
		return false;
	for (size_t i = 0; i < COUNT(species_rows); i++)
		if (species_rows[i].genus[0] == n->word[0][0] && eco_words_have(species_rows[i].epithets, n->word[1])) {
			if (found < COUNT(species_rows))
				return false;
			found = i;
		}
	if (found == COUNT(species_rows))
		return false;
	take_genus(flora, genus_row(species_rows[found].genus));
	snprintf(flora->epithet, sizeof flora->epithet, "%.31s", n->word[1]);
	return true;
}

/* ---- Common names ---- */

static void join(const struct name *n, unsigned first, unsigned count, char phrase[ECO_WORDS_BYTES])
{
	size_t used = 0;
	for (unsigned i = first; i < first + count && used + ECO_WORD_BYTES < ECO_WORDS_BYTES; i++)
		used += (size_t)snprintf(phrase + used, ECO_WORDS_BYTES - used, "%s%s", i > first ? " " : "",
			n->word[i]);
}

/* The phrase that is the noun, among those of so many words in a part of the name. */
static size_t find_phrase(const struct name *n, unsigned from, unsigned end, unsigned count, bool at_end,
	enum eco_region region)
{
	size_t best = COUNT(names_rows);
	for (unsigned i = from; i + count <= end; i++) {
		char phrase[ECO_WORDS_BYTES];
		join(n, i, count, phrase);
		size_t row = at_end ? name_at_end(phrase, region) : name_or_plural(phrase, region);
		char shorter[ECO_WORDS_BYTES];
		if (row == COUNT(names_rows) && count == 1 && shorten(phrase, shorter))
			row = at_end ? name_at_end(shorter, region) : name_in(shorter, region);
		/* a word of two letters may be an article: "el", "al" */
		if (row == COUNT(names_rows) || (n->count > 1 && letters(phrase) < 3 && (unsigned char)*phrase < 0x80
				&& ends_name(names_rows[row].language)))
			continue;
		if (best == COUNT(names_rows) || ends_name(names_rows[row].language))
			best = row;
	}
	return best;
}

static bool find_common_in(const struct name *n, unsigned least, enum eco_region region, struct eco_flora *flora)
{
	for (unsigned count = PHRASE_WORDS; count >= least; count--)
		for (int at_end = 0; at_end <= (count == 1); at_end++)
			for (unsigned k = 0; k < n->parts; k++) {
				unsigned end = k + 1 < n->parts ? n->part[k + 1] : n->count;
				size_t row = find_phrase(n, n->part[k], end, count, at_end, region);
				if (row == COUNT(names_rows))
					continue;
				take_taxon(flora, names_rows[row].taxon);
				return true;
			}
	return false;
}

/* Phrases of `least` words and more. "Ash, mountain" is read as "mountain ash" first. */
static bool find_common(const struct name *n, unsigned least, enum eco_region region, struct eco_flora *flora)
{
	struct name turned = { .parts = 1 };
	if (n->one_comma && n->count <= PHRASE_WORDS) {
		for (unsigned i = 0; i < n->count; i++)
			memcpy(turned.word[i], n->word[(n->part[1] + i) % n->count], ECO_WORD_BYTES);
		turned.count = n->count;
		if (find_common_in(&turned, 2, region, flora))
			return true;
	}
	return find_common_in(n, least, region, flora);
}

/* ---- Codes and misspellings ---- */

/* The row of a code, written as words: "P.S" is "p s" in French, "SM 1" is "sm1" elsewhere. */
static size_t code_row(const char *words, const char *system)
{
	char code[ECO_WORDS_BYTES];
	size_t used = 0, i = 0;
	for (const char *c = words; *c != 0; c++)
		if (*c != ' ' || strcmp(system, "fr") == 0)
			code[used++] = *c;
	code[used] = 0;
	while (i < COUNT(codes_rows)
		&& (strcmp(codes_rows[i].system, system) != 0 || strcmp(codes_rows[i].code, code) != 0))
		i++;
	return i;
}

/* Letters of two halves of a code, "fasy", "QUEROB": of as many capitals as begin the name, "PINNIGnig", else
 * of its small letters. PLANTS numbers symbols that are alike: "QUMA2". 0: it is none. */
static size_t code_letters(const char *name, const char *words)
{
	size_t capitals = strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
	size_t count = capitals > 2 ? capitals : strspn(words, "abcdefghijklmnopqrstuvwxyz");
	const char *rest = capitals > 2 ? name + count : words + count + (words[count] == ' ');
	size_t small = capitals == 6 ? strspn(rest, "abcdefghijklmnopqrstuvwxyz") : 0;
	bool ends = strspn(rest + small, "123456789") <= 1 && rest[small + strspn(rest + small, "123456789")] == 0;
	return ends && (count == 3 || count == 4 || count == 6) ? count : 0;
}

/* The species whose genus and epithet begin with the two halves of a code, if it need not be sure, else the
 * genus that begins with the first half; of several, the genus with most species. */
static bool find_coded(const char *name, bool sure, struct eco_flora *flora)
{
	char words[ECO_WORDS_BYTES], epithet[ECO_WORD_BYTES];
	eco_words_of(name, words, sizeof words);
	size_t count = code_letters(name, words), half = count == 3 ? 3 : count / 2, most = 0;
	bool whole = false;
	for (size_t i = 0; i < COUNT(species_rows) && count > 0; i++) {
		size_t species = strlen(species_rows[i].epithets);
		if (strncmp(species_rows[i].genus, words, half) != 0)
			continue;
		const char *at = species_rows[i].epithets;
		bool found = false;
		while (count > 3 && !found && eco_words_next(&at, epithet))
			found = strncmp(epithet, words + half, half) == 0;
		if ((!found && (whole || sure || half != 3)) || (found == whole && species <= most))
			continue;
		whole = found;
		most = species;
		take_genus(flora, genus_row(species_rows[i].genus));
		snprintf(flora->epithet, sizeof flora->epithet, "%.31s", found ? epithet : "");
		snprintf(flora->coded, sizeof flora->coded, "%.30s%s%.30s", flora->genus, found ? " " : "", flora->epithet);
	}
	return most > 0;
}

#define LETTERS "letters"        /* the system of first letters, behind those of codes.tsv */

bool eco_flora_has_code(const char *system, const char *code)
{
	struct eco_flora flora = { .genus = NULL };
	char words[ECO_WORDS_BYTES];
	eco_words_of(code, words, sizeof words);
	return strcmp(system, LETTERS) == 0 ? find_coded(code, true, &flora)
		: code_row(words, system) < COUNT(codes_rows);
}

const char *eco_flora_system(size_t i)
{
	for (size_t row = 0; row < COUNT(codes_rows); row++)
		if ((row == 0 || strcmp(codes_rows[row].system, codes_rows[row - 1].system) != 0) && i-- == 0)
			return codes_rows[row].system;
	return i == 0 ? LETTERS : NULL;
}

static bool find_in_system(const char *name, const char *words, const char *system, struct eco_flora *flora)
{
	size_t row = code_row(words, system);
	if (strcmp(system, LETTERS) == 0)
		return find_coded(name, false, flora);
	if (row == COUNT(codes_rows))
		return false;
	take_taxon(flora, codes_rows[row].taxon);
	snprintf(flora->coded, sizeof flora->coded, "%s", codes_rows[row].taxon);
	return true;
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
static bool is_binomial(const struct name *n)
{
	return n->count > 1 && ends_in_one_of(n->word[0], "a us um is on os es as ix ys")
		&& ends_in_one_of(n->word[1], "a us um is i ii ae ens ans oides or ior");
}

/* The number of a genus's epithets that a word is but for a letter, and the last of them; 1 and the word for its own. */
static unsigned epithets_like(const char *genus, const char *word, char like[ECO_WORD_BYTES])
{
	char epithet[ECO_WORD_BYTES];
	unsigned count = 0, away;
	for (const char *at = epithets_of(genus); eco_words_next(&at, epithet); count += away == 1) {
		away = eco_words_distance(epithet, word, 1);
		if (away <= 1)
			memcpy(like, epithet, sizeof epithet);
		if (away == 0)
			return 1;
	}
	return count;
}

static void take_misspelt(struct eco_flora *flora, const char *taxon, const char *word, const char *meant)
{
	take_taxon(flora, taxon);
	flora->meant = meant;
	snprintf(flora->misspelt, sizeof flora->misspelt, "%s", word);
}

/* The genus that a word differs from by a letter, from nine letters on by two: one that has an epithet like the second
 * word, else, of words of six letters, the only one. Only the first word of a Latin name may be a genus. */
static bool find_misspelt_latin(const struct name *n, struct eco_flora *flora)
{
	const char *found = NULL, *word = n->word[0];
	unsigned most = letters(word) >= 9 ? 2 : 1, count = 0;
	bool own = false;
	char like[ECO_WORD_BYTES];
	for (size_t i = 0; letters(word) >= 5 && i < COUNT(genera_rows) && !own; i++) {
		const char *genus = genera_rows[i].genus;
		if (eco_words_distance(genus, word, most) > most)
			continue;
		own = n->count > 1 && epithets_like(genus, n->word[1], like) > 0;
		found = genus;
		count++;
	}
	if (!found || (!own && (count > 1 || letters(word) < 6)))
		return false;
	take_misspelt(flora, found, word, found);
	snprintf(flora->epithet, sizeof flora->epithet, "%.31s", own ? n->word[1] : "");
	return true;
}

/* "Acer platanodes": an epithet of five letters and more that only one of its genus is like. */
static void mend_epithet(struct eco_flora *flora)
{
	char like[ECO_WORD_BYTES];
	if (letters(flora->epithet) < 5 || epithets_like(flora->genus, flora->epithet, like) != 1
			|| strcmp(like, flora->epithet) == 0)
		return;
	if (!flora->misspelt[0])
		snprintf(flora->misspelt, sizeof flora->misspelt, "%s", flora->epithet);
	snprintf(flora->epithet, sizeof flora->epithet, "%.31s", like);
}

/* A word of six letters that is nearly one name and the name of no other plant, or one of five with two swapped. */
static void find_misspelt(const struct name *n, enum eco_region region, struct eco_flora *flora)
{
	if (find_misspelt_latin(n, flora) || is_binomial(n))
		return;
	for (unsigned k = 0; k < n->count; k++)
		for (size_t i = 0; letters(n->word[k]) >= 5 && (unsigned char)n->word[k][0] < 0x80
			&& i < COUNT(names_rows); i++) {
			const char *name = names_rows[i].name;
			if (name[0] != n->word[k][0] || strchr(name, ' ') || letters(name) < 5 || strchr(names_rows[i].taxon, ' ')
					|| (letters(n->word[k]) == 5 ? !eco_words_swapped(name, n->word[k])
					: eco_words_distance(name, n->word[k], 1) > 1))
				continue;
			if (strcmp(names_rows[i].where, "all") == 0 || is_region(names_rows[i].where, region)) {
				take_misspelt(flora, names_rows[i].taxon, n->word[k], name);
				return;
			}
		}
}

/* ---- Forms ---- */

/* Whether a list of phrases has one that words hold, or a long word of it that begins or ends one of theirs:
 * "trauerweide". */
static bool says_form(const char *words, const char *phrases, const char *except, size_t least)
{
	char word[ECO_WORD_BYTES];
	for (const char *at = phrases; *at != 0;) {
		size_t bytes = strcspn(at, "|");
		if (!(strlen(except) == bytes && strncmp(at, except, bytes) == 0) && has_phrase(words, at, bytes))
			return true;
		size_t enough = (unsigned char)*at < 0x80 ? least : 5;
		for (const char *next = words; bytes >= enough && eco_words_next(&next, word);) {
			size_t length = strlen(word);
			if (length > bytes + 1 && strcmp(word, except) != 0 && (strncmp(word, at, bytes) == 0
					|| strncmp(word + length - bytes, at, bytes) == 0))
				return true;
		}
		at += bytes + (at[bytes] == '|');
	}
	return false;
}

/* Whether words are one of a list of phrases, and nothing else. */
static bool is_phrase(const char *words, const char *phrases)
{
	for (size_t bytes, length = strlen(words); *phrases != 0; phrases += bytes + (phrases[bytes] == '|')) {
		bytes = strcspn(phrases, "|");
		if (bytes == length && strncmp(words, phrases, bytes) == 0)
			return true;
	}
	return false;
}

static enum eco_form form_by_word(const char *words, bool known, const char *except)
{
	for (size_t i = 0; i < COUNT(forms_rows); i++) {
		bool whole = strcmp(forms_rows[i].where, "whole") == 0;
		if (whole ? !is_phrase(words, forms_rows[i].phrases) : known && strcmp(forms_rows[i].where, "always") != 0)
			continue;
		enum eco_form form = form_named(forms_rows[i].form);
		/* an epithet may begin like a word of the vacant: "mortonii" */
		if (says_form(words, forms_rows[i].phrases, except, form == ECO_FORM_NOTHING ? 7 : 5))
			return form;
	}
	return ECO_FORM_UNKNOWN;
}

static enum eco_leaf leaf_by_word(const char *words)
{
	char word[ECO_WORD_BYTES];
	while (eco_words_next(&words, word))
		if (eco_words_have(eco_words_set("evergreen"), word))
			return ECO_LEAF_EVERGREEN;
		else if (eco_words_have(eco_words_set("deciduous"), word))
			return ECO_LEAF_DECIDUOUS;
	return ECO_LEAF_UNKNOWN;
}

enum eco_form eco_form_of(const char *text, enum eco_leaf *leaf)
{
	char words[ECO_WORDS_BYTES];
	eco_words_of(text, words, sizeof words);
	*leaf = leaf_by_word(words);
	return form_by_word(words, false, "");
}

bool eco_flora_is_no_plant(const char *text, bool whole)
{
	char words[ECO_WORDS_BYTES];
	bool is = eco_words_of(text, words, sizeof words) > 0 && form_by_word(words, true, "") == ECO_FORM_NOTHING;
	for (size_t i = 0; whole && is && i < COUNT(forms_rows); i++)
		if (form_named(forms_rows[i].form) == ECO_FORM_NOTHING && is_phrase(words, forms_rows[i].phrases))
			return true;
	return is && !whole;
}

/* Takes the form, leaves and height by which a species or a cultivar differs. Returns whether a row says a
 * form: 1 of an epithet, 2 and more of a cultivar; else 0. */
static int grow(struct eco_flora *flora, const char *words)
{
	int best = -1;
	size_t row = 0;
	for (size_t i = 0; i < COUNT(growth_rows); i++) {
		bool epithet = growth_rows[i].epithet[0] != '-', cultivar = growth_rows[i].cultivars[0] != '-';
		int own = 2 * cultivar + epithet;
		if (strcmp(growth_rows[i].genus, flora->genus) != 0 || own <= best
				|| (epithet && strcmp(growth_rows[i].epithet, flora->epithet) != 0
				&& !has_phrase(words, growth_rows[i].epithet, strlen(growth_rows[i].epithet)))
				|| (cultivar && !has_one(words, growth_rows[i].cultivars)))
			continue;
		best = own;
		row = i;
	}
	if (best < 0)
		return 0;
	if (growth_rows[row].form[0] != '-')
		flora->form = form_named(growth_rows[row].form);
	if (growth_rows[row].leaf[0] != '-')
		flora->leaf = leaf_named(growth_rows[row].leaf);
	if (growth_rows[row].height_m > 0)
		flora->height_m = growth_rows[row].height_m;
	return growth_rows[row].form[0] != '-' ? best : 0;
}

static bool find_known(const char *name, const struct name *n, const struct eco_flora_hint *hint, struct eco_flora *flora)
{
	return (hint->codes && find_in_system(name, n->words, hint->codes, flora)) || find_latin(n, true, flora)
		|| find_common(n, 2, hint->region, flora) || find_latin(n, false, flora)
		|| find_common(n, 1, hint->region, flora) || find_initial(n, flora);
}

struct eco_flora eco_flora_of(const char *name, const struct eco_flora_hint *hint)
{
	static const struct eco_flora_hint nothing = { .spelling = false };
	struct eco_flora flora = { .genus = NULL };
	struct name n;
	if (!hint)
		hint = &nothing;
	read_name(&n, name);
	bool known = find_known(name, &n, hint, &flora);
	enum eco_form form = form_by_word(n.words, known, "");
	if (!known && form != ECO_FORM_NOTHING && hint->spelling) {
		/* "Plantanus hybrida" is no plant of any kind */
		if (n.count > 0 && form == ECO_FORM_UNKNOWN)
			find_misspelt(&n, hint->region, &flora);
		else if (is_binomial(&n))
			find_misspelt_latin(&n, &flora);
		known = flora.genus;
	}
	if (known && hint->spelling)
		mend_epithet(&flora);
	int said = known ? grow(&flora, n.words) : 0;
	if (known && form != ECO_FORM_NOTHING)       /* Betula pendula does not weep, its 'Youngii' does */
		form = said > 1 ? ECO_FORM_UNKNOWN : form_by_word(n.words, true, said ? flora.epithet : "");
	if (form != ECO_FORM_UNKNOWN)
		flora.form = form;
	if (flora.leaf == ECO_LEAF_UNKNOWN)
		flora.leaf = leaf_by_word(n.words);
	return flora;
}

bool eco_flora_has_epithet(const char *genus, const char *epithet)
{
	return epithet[0] != 0 && eco_words_have(epithets_of(genus), epithet);
}
