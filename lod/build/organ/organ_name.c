/* A name is cut into words at everything that is no letter, and where a capital follows a small letter. A
 * long word of the table matches words that begin with it (leaf: leafs, but also leafcard). A short one
 * matches only itself, a plural or a number, so that `bois` is not found in unrelated names. German joins
 * words, so its longer ones also match at the end (Birkenrinde). */
#include "lod/build/organ/organ_state.h"

#include <stdbool.h>
#include <string.h>

#include "ecofiles/format/pack.h"
#include "build/words/organs.table"

#define WORD_MOST 64u
#define PREFIX_LEAST 4u          /* letters of a table word that matches beginnings and ends */

static bool is_letter(unsigned char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c >= 0x80;
}

/* The next word of *at, in lower case; false at the end. */
static bool next_word(const char **at, char word[WORD_MOST])
{
	size_t n = 0;
	while (**at && !is_letter((unsigned char)**at))
		++*at;
	while (is_letter((unsigned char)**at)) {
		unsigned char c = (unsigned char)**at;
		bool capital = c >= 'A' && c <= 'Z';
		if (capital && n > 0 && !((*at)[-1] >= 'A' && (*at)[-1] <= 'Z'))
			break;
		if (n + 1 < WORD_MOST)
			word[n++] = (char)(capital ? c - 'A' + 'a' : c);
		++*at;
	}
	word[n] = 0;
	return n > 0;
}

/* The quality of a word's match with a known one: 0 for none; longer is better, and an end is better than a
 * beginning, since the last part of a compound is its noun. */
static size_t match(const char *word, const char *known, size_t k)
{
	size_t n = strlen(word);
	if (n < k)
		return 0;
	const char *rest = word + k;
	if (k > PREFIX_LEAST && strncmp(word + n - k, known, k) == 0)
		return WORD_MOST + k;
	bool begins = strncmp(word, known, k) == 0;
	return begins && (k >= PREFIX_LEAST || !*rest || strcmp(rest, "s") == 0 || strcmp(rest, "es") == 0)
		? k : 0;
}

static enum lod_hint hint_of(const char *organ)
{
	int i = 0;
	while (strcmp(eco_organ_names[i], organ))
		i++;
	return (enum lod_hint)(LOD_HINT_WOOD + i);
}
_Static_assert(LOD_HINT_FLOWER - LOD_HINT_WOOD == ECO_ORGAN_FLOWER, "hints are organs");

static enum lod_hint word_hint(const char *word)
{
	enum lod_hint hint = LOD_HINT_NONE;
	size_t best = 0;
	for (size_t i = 0; i < sizeof organs_rows / sizeof *organs_rows; i++)
		for (const char *known = organs_rows[i].words; *known; known += strcspn(known, "|"), known += *known == '|') {
			size_t good = match(word, known, strcspn(known, "|"));
			if (good <= best)
				continue;
			best = good;
			hint = hint_of(organs_rows[i].organ);
		}
	return hint;
}

enum lod_hint lod_name_hint(const char *name)
{
	enum lod_hint found = LOD_HINT_NONE;
	char word[WORD_MOST];
	while (next_word(&name, word)) {
		enum lod_hint hint = word_hint(word);
		if (hint != LOD_HINT_NONE && found != LOD_HINT_NONE && found != hint)
			return LOD_HINT_NONE;
		found = hint != LOD_HINT_NONE ? hint : found;
	}
	return found;
}
