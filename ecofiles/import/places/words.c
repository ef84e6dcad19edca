#include "ecofiles/import/places/words.h"

#include <string.h>

#include "build/words/sets.table"

/* Letters from U+00C0 on without their marks. */
static const char latin_1[] = "aaaaaaaceeeeiiiidnooooo ouuuuytS" "aaaaaaaceeeeiiiidnooooo ouuuuyty";
static const char latin_a[] = "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiiiiijjkkklllllllllln"
	"nnnnnnnnoooooooorrrrrrsssssssstttttt" "uuuuuuuuuuuuwwyyyzzzzzzs";

/* OTHER: letters that begin no word within a name, "HöHE" */
enum kind { GAP, LETTER, CAPITAL, DIGIT, OTHER, OTHER_CAPITAL };

/* Letters of two bytes in small, without the marks of some. */
static enum kind take_small(unsigned point, unsigned small, char sign[4])
{
	sign[0] = (char)(0xc0 | small >> 6);
	sign[1] = (char)(0x80 | (small & 0x3f));
	return small != point ? CAPITAL : LETTER;
}

static enum kind take_cyrillic(unsigned point, char sign[4])
{
	unsigned small = point >= 0x410 && point < 0x430 ? point + 0x20 : point < 0x410 ? point + 0x50
		: point;
	enum kind kind = take_small(point, small, sign);
	take_small(0, small == 0x451 ? 0x435 : small, sign);
	return kind;
}

static enum kind take_greek(unsigned point, char sign[4])
{
	static const uint16_t plain[][2] = { { 0x386, 0x3b1 }, { 0x388, 0x3b5 }, { 0x389, 0x3b7 }, { 0x38a, 0x3b9 },
		{ 0x38c, 0x3bf }, { 0x38e, 0x3c5 }, { 0x38f, 0x3c9 }, { 0x390, 0x3b9 }, { 0x3ac, 0x3b1 }, { 0x3ad, 0x3b5 },
		{ 0x3ae, 0x3b7 }, { 0x3af, 0x3b9 }, { 0x3b0, 0x3c5 }, { 0x3c2, 0x3c3 }, { 0x3ca, 0x3b9 }, { 0x3cb, 0x3c5 },
		{ 0x3cc, 0x3bf }, { 0x3cd, 0x3c5 }, { 0x3ce, 0x3c9 } };
	unsigned small = point >= 0x391 && point <= 0x3a9 ? point + 0x20 : point;
	for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
		small = plain[i][0] == point ? plain[i][1] : small;
	return take_small(0, small, sign), point < 0x3ac && point != 0x390 ? CAPITAL : LETTER;
}

/* Narrow katakana, as old systems write them; their sound marks are signs of their own and stand behind. */
static unsigned wide_kana(unsigned point, unsigned mark)
{
	static const uint16_t wide[] = { 0x30f2, 0x30a1, 0x30a3, 0x30a5, 0x30a7, 0x30a9, 0x30e3, 0x30e5, 0x30e7,
		0x30c3, 0x30fc, 0x30a2, 0x30a4, 0x30a6, 0x30a8, 0x30aa, 0x30ab, 0x30ad, 0x30af, 0x30b1, 0x30b3,
		0x30b5, 0x30b7, 0x30b9, 0x30bb, 0x30bd, 0x30bf, 0x30c1, 0x30c4, 0x30c6, 0x30c8, 0x30ca, 0x30cb,
		0x30cc, 0x30cd, 0x30ce, 0x30cf, 0x30d2, 0x30d5, 0x30d8, 0x30db, 0x30de, 0x30df, 0x30e0, 0x30e1,
		0x30e2, 0x30e4, 0x30e6, 0x30e8, 0x30e9, 0x30ea, 0x30eb, 0x30ec, 0x30ed, 0x30ef, 0x30f3 };
	return wide[point - 0xff66] + (mark == 0xff9e ? 1 : mark == 0xff9f ? 2 : 0);
}

static unsigned three_bytes(const unsigned char *at)
{
	bool three = at[0] >= 0xe0 && at[0] <= 0xef && (at[1] & 0xc0) == 0x80 && (at[2] & 0xc0) == 0x80;
	return three ? (at[0] & 0xfu) << 12 | (at[1] & 0x3fu) << 6 | (at[2] & 0x3fu) : 0;
}

/* Kana of one kind, and no signs of writing: "（" and "。" part words. */
static enum kind take_east(unsigned point, char sign[4])
{
	point += point >= 0x3041 && point <= 0x3096 ? 0x60 : 0;
	sign[0] = (char)(0xe0 | point >> 12);
	sign[1] = (char)(0x80 | (point >> 6 & 0x3f));
	sign[2] = (char)(0x80 | (point & 0x3f));
	return (point >= 0x2000 && point <= 0x206f) || (point >= 0x3000 && point <= 0x3020) ? GAP : OTHER;
}

/* The bytes of a letter that was written as UTF-8 twice: "Ã¶" is "ö". */
static unsigned written_twice(const unsigned char *text)
{
	return text[0] == 0xc3 && text[1] == 0x83 && text[2] == 0xc2 ? text[3] : 0;
}

/* The sign at *text as a letter of words, and its kind; *text moves on. Signs of other alphabets stay. */
static enum kind take_sign(const unsigned char **text, char sign[4])
{
	const unsigned char *at = *text;
	unsigned c = *(*text)++, second = at[1], east = three_bytes(at);
	memset(sign, 0, 4);
	if (east > 0xff00 && east < 0xff5f) {        /* wide signs: "（ｍ）" */
		c = east - 0xfee0;
		*text += 2;
	}
	sign[0] = (char)c;
	if (c >= '0' && c <= '9')
		return DIGIT;
	if (c >= 'A' && c <= 'Z') {
		sign[0] = (char)(c + 32);
		return CAPITAL;
	}
	if (c < 0x80)
		return c >= 'a' && c <= 'z' ? LETTER : GAP;
	unsigned mark = east ? three_bytes(at + 3) : 0;
	if (east) {
		bool narrow = east >= 0xff66 && east <= 0xff9d, marked = narrow && (mark == 0xff9e || mark == 0xff9f);
		*text += marked ? 5 : 2;
		return take_east(narrow ? wide_kana(east, mark) : east, sign);
	}
	bool latin = c >= 0xc3 && c <= 0xc5, cyrillic = c == 0xd0 || c == 0xd1, greek = c == 0xce || c == 0xcf;
	if (!(latin || cyrillic || greek) || (second & 0xc0) != 0x80)
		return c == 0xc2 && second != 0 ? (++*text, GAP) : OTHER;
	unsigned twice = written_twice(at);
	*text += twice ? 3 : 1;
	unsigned point = (c & 0x1f) << 6 | ((twice ? twice : second) & 0x3f);
	if (cyrillic || greek)
		return cyrillic ? take_cyrillic(point, sign) : take_greek(point, sign);
	sign[0] = point < 0x100 ? latin_1[point - 0xc0] : latin_a[point - 0x100];
	if (sign[0] == ' ')
		return GAP;
	if (sign[0] == 'S')
		memcpy(sign, "ss", 3);
	bool odd = (point >= 0x139 && point <= 0x148) || (point >= 0x179 && point <= 0x17e);      /* capitals there */
	return point < 0xdf || (point >= 0x100 && (point % 2 == 1) == odd) ? OTHER_CAPITAL : OTHER;
}

static bool begins_word(enum kind before, enum kind now)
{
	bool capital = now == CAPITAL || now == OTHER_CAPITAL;
	return before != GAP && ((before == DIGIT) != (now == DIGIT) || (before == LETTER && capital));
}

size_t eco_words_of(const char *text, char *words, size_t size)
{
	const unsigned char *at = (const unsigned char *)text;
	enum kind before = GAP;
	size_t used = 0;
	while (*at != 0 && used + 4 < size) {
		char sign[4];
		if (at[0] == 0xcc || (at[0] == 0xcd && at[1] < 0xb0)) {  /* a mark of its own behind its letter */
			at += at[1] != 0 ? 2 : 1;
			continue;
		}
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

bool eco_words_swapped(const char *a, const char *b)
{
	int sum = 0;
	bool alike = strlen(a) == strlen(b) && eco_words_distance(a, b, 1) == 1;
	for (size_t i = 0; alike && a[i] != 0; i++)
		sum += a[i] - b[i];
	return alike && sum == 0;
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
