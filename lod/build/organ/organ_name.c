/* A name is cut into words at everything that is no letter, and where a capital follows a small letter. A
 * long word of the table matches words that begin with it (leaf: leafs, but also leafcard). A short one
 * matches only itself, a plural or a number, so that `bois` is not found in unrelated names. German joins
 * words, so its longer ones also match at the end (Birkenrinde). */
#include "lod/build/organ/organ_state.h"

#include <stdbool.h>
#include <string.h>

#define WORD_MOST 64u
#define PREFIX_LEAST 4u          /* letters of a table word that matches beginnings and ends */

static const char *const wood_words[] = {
	"bark", "trunk", "wood", "stem", "stalk", "branch", "twig", "log", "stump", "root", "cane", "culm",
		"rachis", "limb",
	"rinde", "borke", "stamm", "holz", "ast", "äste", "aeste", "zweig", "stiel", "stängel", "staengel",
	"stengel", "wurzel", "halm",
	"tronc", "écorce", "ecorce", "bois", "branche", "rameau", "tige", "racine", "souche",
	"corteza", "tronco", "madera", "rama", "tallo", "raíz", "raiz", "corteccia", "legno", "ramo", "fusto",
	"casca", "madeira", "galho",
	"caule", "schors", "stam", "tak", "hout", "takken", "kora", "kmen", "větev", "pień", "kmień", "gałąź",
	"drewno", "gren", "stamme",
	"кора", "ствол", "ветка", "ветви", "дерево", "树干", "树皮", "树枝", "幹", "枝", "樹皮",
	/* not of the plant, treated as wood */
	"pot", "planter", "vase", "jar", "soil", "ground", "dirt", "earth", "rock", "stone", "gravel",
	"fence", "frame",
	"topf", "kasten", "erde", "stein", "zaun", "terre", "pierre", "maceta", "tierra", "piedra", "vaso",
	"terra", "pietra", "bloempot",
};
static const char *const foliage_words[] = {
	"leaf", "leaves", "leef", "foliage", "needle", "frond", "blade", "grass", "canopy", "crown", "fern",
		"moss", "ivy",
	"blatt", "blätter", "blaetter", "laub", "nadel", "gras", "krone", "farn", "feuille", "feuillage",
	"aiguille", "herbe", "fougère",
	"hoja", "follaje", "aguja", "hierba", "copa", "foglia", "foglie", "ago", "erba", "folha", "folhagem",
	"agulha", "grama",
	"blad", "bladeren", "naald", "list", "listy", "liść", "liście", "igła", "trawa", "löv", "gräs",
	"лист", "листья", "хвоя", "трава", "叶", "树叶", "草", "葉", "葉っぱ",
};
static const char *const flower_words[] = {
	"flower", "petal", "blossom", "bloom", "sepal", "stamen", "pistil", "inflorescence",
	"blüte", "bluete", "blume", "fleur", "pétale", "petale", "flor", "pétalo", "petalo", "flore", "fiore",
	"pétala", "bloem",
	"květ", "kwiat", "płatek", "blomma", "цветок", "цветы", "лепесток", "花", "花瓣",
};

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
static size_t match(const char *word, const char *known)
{
	size_t n = strlen(word), k = strlen(known);
	if (n < k)
		return 0;
	const char *rest = word + k;
	if (k > PREFIX_LEAST && strcmp(word + n - k, known) == 0)
		return WORD_MOST + k;
	bool begins = strncmp(word, known, k) == 0;
	return begins && (k >= PREFIX_LEAST || !*rest || strcmp(rest, "s") == 0 || strcmp(rest, "es") == 0)
		? k : 0;
}

static enum lod_hint word_hint(const char *word)
{
	static const struct { const char *const *words; size_t count; enum lod_hint hint; } table[] = {
		{ wood_words, sizeof wood_words / sizeof *wood_words, LOD_HINT_WOOD },
		{ foliage_words, sizeof foliage_words / sizeof *foliage_words, LOD_HINT_FOLIAGE },
		{ flower_words, sizeof flower_words / sizeof *flower_words, LOD_HINT_FLOWER },
	};
	enum lod_hint hint = LOD_HINT_NONE;
	size_t best = 0;
	for (size_t i = 0; i < sizeof table / sizeof *table; i++)
		for (size_t k = 0; k < table[i].count; k++) {
			size_t good = match(word, table[i].words[k]);
			if (good > best) {
				best = good;
				hint = table[i].hint;
			}
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
