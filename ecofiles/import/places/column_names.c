/* A column's role by the words of its name, in points (words/columns.tsv). */
#include <stdio.h>
#include <string.h>

#include "build/words/columns.table"
#include "ecofiles/import/places/table_columns.h"
#include "ecofiles/import/places/words.h"

const char *const eco_role_names[ECO_ROLE_COUNT] = { "x", "y", "species", "height", "trunk diameter",
	"trunk girth", "crown", "age", "year of planting", "plot", "azimuth", "distance", "quadrat" };


/* A word of five letters (bytes) and more counts within a longer one, too, "kronendurchmesser", one of four
 * at its end, "baumhohe". */
static bool means(const char *word, const char *list)
{
	char own[ECO_WORD_BYTES];
	size_t length = strlen(word);
	while (eco_words_next(&list, own)) {
		size_t bytes = strlen(own);
		if (strcmp(own, word) == 0 || (bytes >= 5 && strstr(word, own)))
			return true;
		if (bytes == 4 && length > bytes && strcmp(word + length - bytes, own) == 0)
			return true;
	}
	return false;
}

/* Whether a word that a Shapefile cut to ten letters of a name ends with the beginning of one of a list,
 * "heigh", "stammumfan"; or a long one differs from it by a letter, "lattitude". */
static bool nearly_means(const char *word, const char *list, bool cut)
{
	char own[ECO_WORD_BYTES];
	size_t length = strlen(word);
	while (eco_words_next(&list, own)) {
		size_t bytes = strlen(own);
		if (word[0] == own[0] && ((bytes >= 8 && length >= 8 && eco_words_distance(own, word, 1) <= 1)
				|| (bytes >= 5 && eco_words_swapped(own, word))))
			return true;
		for (size_t k = bytes > 8 ? bytes / 2 : 4; cut && bytes >= 5 && k < bytes; k++)
			if (length >= k && strncmp(word + length - k, own, k) == 0)
				return true;
	}
	return false;
}

#define CUT_BYTES 10u            /* of names in a Shapefile */
#define NEARLY 5                 /* points less */

/* The best of the words that speak for a role, and all that speak against it. */
static int points_by_name(enum eco_role role, const char *name)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES], pair[2 * ECO_WORD_BYTES];
	int best = 0, against = 0;
	eco_words_of(name, words, sizeof words);
	for (size_t i = 0; i < sizeof columns_rows / sizeof *columns_rows; i++) {
		int points = (int)columns_rows[i].points;
		if (strcmp(columns_rows[i].role, eco_role_names[role]) != 0)
			continue;
		for (const char *at = words; eco_words_next(&at, word);) {
			bool last = *at == 0 && strlen(name) == CUT_BYTES;
			snprintf(pair, sizeof pair, "%s%.*s", word, *at ? (int)strcspn(at + 1, " ") : 0, *at ? at + 1 : "");
			/* "BlockName" is a word, too */
			if (!means(word, columns_rows[i].words) && !eco_words_have(columns_rows[i].words, pair)) {
				if (points < 0 || !nearly_means(word, columns_rows[i].words, last))
					continue;
				points -= NEARLY;
			}
			if (points < 0)
				against = points;
			else if (points > best)
				best = points;
		}
	}
	return best > 0 ? best + against : 0;
}

/* "x", "coord_x", "utm17n_e": one letter at an end of the name. */
static int points_by_letter(enum eco_role role, const char *name)
{
	static const char *const letters[][2] = { [ECO_ROLE_X] = { "x", "e" }, [ECO_ROLE_Y] = { "y", "n" } };
	char words[ECO_WORDS_BYTES], first[ECO_WORD_BYTES] = "", last[ECO_WORD_BYTES] = "",
				     word[ECO_WORD_BYTES];
	if (role != ECO_ROLE_X && role != ECO_ROLE_Y)
		return 0;
	eco_words_of(name, words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word);) {
		if (first[0] == 0)
			memcpy(first, word, sizeof first);
		memcpy(last, word, sizeof last);
	}
	/* a unit may follow: "x_m", "gx (m)" */
	if (strcmp(last, "m") == 0 || strcmp(last, "ft") == 0)
		memcpy(last, first, sizeof last);
	for (int i = 0; i < 2; i++)
		if (strcmp(last, letters[role][i]) == 0 || strcmp(first, letters[role][i]) == 0)
			return 70;
	return 0;
}

int eco_column_points(enum eco_role role, const char *name)
{
	int by_name = points_by_name(role, name), by_letter = points_by_letter(role, name);
	return by_name > by_letter ? by_name : by_letter;
}

bool eco_column_says_degrees(const char *name)
{
	return points_by_name(ECO_ROLE_X, name) + points_by_name(ECO_ROLE_Y, name) >= 100;
}

bool eco_column_says(const char *name, const char *set)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	eco_words_of(name, words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word);)
		if (means(word, eco_words_set(set)))
			return true;
	return false;
}
