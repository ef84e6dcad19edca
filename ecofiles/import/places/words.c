#include "ecofiles/import/places/words.h"

#include <string.h>

#include "build/words/sets.table"

/* Letters from U+00C0 on without their marks. */
static const char latin_1[] = "aaaaaaaceeeeiiiidnooooo ouuuuyts" "aaaaaaaceeeeiiiidnooooo ouuuuyty";
static const char latin_a[] = "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiiiiijjkkklllllllllln"
	"nnnnnnnnoooooooorrrrrrsssssssstttttt" "uuuuuuuuuuuuwwyyyzzzzzzs";

enum kind { GAP, LETTER, CAPITAL, DIGIT };

/* Cyrillic letters: small, and without the marks of two. */
static enum kind take_cyrillic(unsigned point, char sign[3])
{
	unsigned small = point >= 0x410 && point < 0x430 ? point + 0x20 : point < 0x410 ? point + 0x50 : point;
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
