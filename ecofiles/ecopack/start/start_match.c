/* A model for each species: of its name, else of its genus, else of its form. */
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/text.h"
#include "ecofiles/generate/library.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"

#define FEW 10u                  /* a share that says nothing of the rows without a species */

/* ---- Scores: same species, genus, form, leaves, size, in this order ---- */

#define SPECIES 200
#define GENUS 100
#define WORD 40                  /* a word that both have, where neither's genus is known */
#define FORM 20
#define KIND 10                  /* tree for tree, low plant for low plant */
#define NEAR 8                   /* the form that is most like theirs */
#define LEAF 5
#define PLAIN 2                  /* a model of no genus stands for any */
#define SIZE 1
#define DEAD 1
#define LIKE_SIZE 1.5            /* heights that differ by less are alike */

/* Words of species and model that are the same and tell something: no numbers, no sizes, no "tree". */
static int shared_words(const char *species, const char *model)
{
	static const char empty[] = "tree large small medium big old young common the and var low poly high";
	char word[ECO_WORD_BYTES];
	int shared = 0;
	for (const char *at = species; eco_words_next(&at, word);)
		shared += strlen(word) >= 3 && (word[0] < '0' || word[0] > '9') &&
			!eco_words_have(empty, word) && eco_words_have(model, word);
	return shared;
}

/* Whether two names begin with one word: an epithet says nothing without its genus. */
static bool begin_alike(const char *a, const char *b)
{
	char p[ECO_WORD_BYTES], q[ECO_WORD_BYTES];
	return eco_words_next(&a, p) && eco_words_next(&b, q) && strcmp(p, q) == 0;
}

static bool says_genus(const struct eco_flora *a, const struct eco_flora *b)
{
	return a->genus && b->genus && strcmp(a->genus, b->genus) == 0;
}

static bool is_near(enum eco_form form, enum eco_form of_model)
{
	static const enum eco_form near[ECO_FORM_COUNT] = { [ECO_FORM_COLUMN] = ECO_FORM_CONIFER,
		[ECO_FORM_WEEPING] = ECO_FORM_BROAD, [ECO_FORM_HERB] = ECO_FORM_GRASS,
		[ECO_FORM_GRASS] = ECO_FORM_HERB };
	return near[form] != ECO_FORM_UNKNOWN && near[form] == of_model;
}

/* A column of a broad-leaved genus is nearer to a broad-leaved tree, one of needles to a conifer. */
static bool is_column_of(const struct eco_flora *flora, enum eco_form of_model)
{
	bool needles = flora->leaf == ECO_LEAF_EVERGREEN;
	return flora->form == ECO_FORM_COLUMN && flora->genus
		&& of_model == (needles ? ECO_FORM_CONIFER : ECO_FORM_BROAD);
}

static int score(const struct eco_flora *flora, const char *words, const struct start_model *model,
	enum start_tier *tier)
{
	const struct eco_flora *own = &model->flora;
	enum eco_form form = flora->form != ECO_FORM_UNKNOWN ? flora->form : ECO_FORM_BROAD;
	bool genus = says_genus(flora, own), unknown = !flora->genus && !own->genus;
	bool species = genus && flora->epithet[0] != 0 && strcmp(flora->epithet, own->epithet) == 0;
	int shared = genus || (unknown && begin_alike(words, model->words)) ? shared_words(words, model->words) : 0;
	int sum = species ? SPECIES : WORD * (genus ? shared > 1 : shared);
	*tier = START_BY_NOTHING;
	if (own->form == ECO_FORM_NOTHING)
		return -GENUS;
	/* a dead or bare tree stands for a living one only where there is no other */
	if (model->is_dead && !eco_words_have(words, "dead"))
		return DEAD;
	sum += genus ? GENUS : own->genus ? 0 : PLAIN;
	sum += form == own->form ? FORM : is_column_of(flora, own->form) || is_near(form, own->form) ? NEAR : 0;
	sum += eco_form_is_tree(form) == eco_form_is_tree(own->form) ? KIND : 0;
	sum += flora->leaf != ECO_LEAF_UNKNOWN && flora->leaf == own->leaf ? LEAF : 0;
	sum += flora->height_m > 0 && flora->height_m < LIKE_SIZE * own->height_m
		&& own->height_m < LIKE_SIZE * flora->height_m ? SIZE : 0;
	*tier = species || (shared > (genus ? 1 : 0)) ? START_BY_NAME : genus ? START_BY_GENUS
		: flora->form == own->form ? START_BY_FORM : START_BY_NOTHING;
	return sum;
}

/* The model that has the very name, whatever it names; ECO_NONE: none. */
static uint32_t model_named(const struct start *s, const char *words)
{
	for (uint32_t i = 0; i < s->model_count && words[0] != 0; i++)
		if (!s->models[i].habit && strcmp(words, s->models[i].words) == 0)
			return i;
	return ECO_NONE;
}

/* Ties: a hash of the genus takes one of the models, so that not all woods look alike. */
static struct start_match best_match(const struct start *s, const char *text, const struct eco_flora *flora)
{
	struct start_match match = { .model = ECO_NONE, .tier = START_LEFT_OUT, .flora = *flora };
	char words[ECO_WORDS_BYTES];
	int best = -1000;
	uint64_t hash = 0, taken = 0;
	eco_words_of(text, words, sizeof words);
	match.model = model_named(s, words);
	if (match.model != ECO_NONE)
		match.tier = START_BY_NAME;
	if (match.model != ECO_NONE || match.flora.form == ECO_FORM_NOTHING)
		return match;
	for (const char *c = match.flora.genus ? match.flora.genus : words; *c != 0; c++)
		hash = eco_random(hash, (uint64_t)*c);
	for (uint32_t i = 0; i < s->model_count; i++) {
		enum start_tier tier;
		int own = score(&match.flora, words, &s->models[i], &tier);
		uint64_t order = eco_random(hash, i);
		if (s->models[i].habit || own < best || (own == best && order > taken))
			continue;
		best = own;
		taken = order;
		match.model = i;
		match.tier = tier;
	}
	return match;
}

/* ---- What else the rows say ---- */

/* Whether a column may say how a plant grows: by a word of its name, if it holds no species. */
static bool may_say_form(const struct start *s, uint32_t column)
{
	return column != s->columns.of[ECO_ROLE_SPECIES] && column != s->columns.species_more[0]
		&& eco_words_any(s->table.columns[column], eco_words_set("growth"));
}

static bool is_row_of(const struct start *s, uint32_t row, const char *species)
{
	char text[ECO_WORDS_BYTES] = "", part[ECO_WORDS_BYTES];
	const uint32_t columns[] = { s->columns.of[ECO_ROLE_SPECIES], s->columns.species_more[0],
		s->columns.species_more[1] };
	for (size_t i = 0; i < 3 && columns[i] != ECO_NONE; i++)
		eco_text_join(text, sizeof text, eco_text_trim(eco_table_field(&s->table, row, columns[i]), part,
			sizeof part));
	return strcmp(text, species) == 0;
}

/* The form that most rows of an unknown species say in another column: "conifer", "evergreen palm". */
static void find_form_beside(const struct start *s, const char *species, struct eco_flora *flora)
{
	uint32_t counts[ECO_FORM_COUNT] = { 0 };
	enum eco_form best = ECO_FORM_UNKNOWN;
	for (uint32_t column = 0; column < s->table.column_count; column++)
		for (uint32_t row = 0; may_say_form(s, column) && row < s->table.row_count; row++) {
			enum eco_leaf leaf;
			if (!is_row_of(s, row, species))
				continue;
			enum eco_form form = eco_form_of(eco_table_field(&s->table, row, column), &leaf);
			counts[form == ECO_FORM_NOTHING ? ECO_FORM_UNKNOWN : form]++;
			flora->leaf = leaf != ECO_LEAF_UNKNOWN ? leaf : flora->leaf;
		}
	for (int form = 1; form < ECO_FORM_NOTHING; form++)
		if (counts[form] > counts[best] || (best == ECO_FORM_UNKNOWN && counts[form] > 0))
			best = (enum eco_form)form;
	flora->form = best;
}

/* The system of codes that explains four of five rows, and more of them than names do; NULL: none. */
static const char *find_codes(const struct start *s)
{
	const char *best = NULL, *system;
	uint64_t filled = 0, named = 0, most = 0;
	for (uint32_t i = 0; i < s->species.count; i++) {
		const struct eco_table_value *value = &s->species.items[i];
		bool missing = eco_text_is_missing(value->text);
		filled += missing ? 0 : value->rows;
		named += !missing && eco_flora_of(value->text, NULL).genus ? value->rows : 0;
	}
	for (size_t k = 0; (system = eco_flora_system(k)) != NULL; k++) {
		uint64_t sum = 0;
		for (uint32_t i = 0; i < s->species.count; i++)
			sum += eco_flora_has_code(system, s->species.items[i].text) ? s->species.items[i].rows : 0;
		if (sum > most) {
			most = sum;
			best = system;
		}
	}
	return most > named && 5 * most >= 4 * filled ? best : NULL;
}

/* ---- What is said ---- */

static void say_tier(struct start *s, enum start_tier tier)
{
	static const char *const why[START_TIERS] = { "they share words with the model's name",
		"the model is of their genus", "no model is of their genus; this one has their form",
		"no model has their form: the library grows it", "their form is not known", "they name no plant: \"map\": null" };
	for (uint32_t m = 0; m <= s->model_count; m++) {
		char names[200] = "", took[160], rows[32];
		uint32_t kinds = 0, model = m < s->model_count ? m : ECO_NONE;
		uint64_t sum = 0;
		for (uint32_t i = 0; i < s->species.count; i++) {
			if (s->matches[i].model != model || s->matches[i].tier != tier)
				continue;
			eco_phrase_add(names, sizeof names, s->species.items[i].text);
			kinds++;
			sum += s->species.items[i].rows;
		}
		if (kinds == 0)
			continue;
		snprintf(took, sizeof took, "%.60s: %u species, %s row%s", model == ECO_NONE ? "left out"
			: s->models[model].name, kinds, eco_phrase_count(sum, rows), sum == 1 ? "" : "s");
		start_guess(s, "model", took, "\"map\" in the scene", "%s: %s", tier == START_BY_LIBRARY && !s->options->models
			? "the library grows it" : why[tier], names);
	}
}

static void say_spelling(struct start *s)
{
	char names[200] = "", took[160];
	uint32_t coded = 0;
	for (uint32_t i = 0; i < s->species.count; i++) {
		const struct eco_flora *f = &s->matches[i].flora;
		snprintf(took, sizeof took, f->coded[0] ? "%.60s: %.60s" : "\"%.60s\" is meant as %s", s->species.items[i].text,
			f->coded[0] ? f->coded : f->meant ? f->meant : f->epithet);
		coded += f->coded[0] != 0;
		if (f->coded[0])
			eco_phrase_add(names, sizeof names, took);
		else if (f->misspelt[0])
			start_guess(s, "spelling", took, "\"map\" in the scene", "\"%s\" is no plant, but "
				"nearly one (first in line %llu)", f->misspelt,
				(unsigned long long)s->species.items[i].first_line);
	}
	snprintf(took, sizeof took, "%u are codes of %s", coded, s->hint.codes ? s->hint.codes : "");
	if (coded > 0)
		start_guess(s, "species", took, "\"map\" in the scene", "as most rows have: %s", names);
}

/* ---- All ---- */

static void choose_fallback(struct start *s)
{
	char took[100];
	struct eco_flora any = eco_flora_of("tree", NULL);
	s->fallback = best_match(s, "tree", &any).model;
	for (uint32_t i = 0; i < s->model_count; i++)
		if (eco_form_is_tree(s->models[i].flora.form) && s->models[i].rows > (s->fallback == ECO_NONE ? 0
				: s->models[s->fallback].rows))
			s->fallback = i;
	/* a dozen palms among 400 trees of no species do not make the others palms */
	bool few = s->fallback != ECO_NONE && s->models[s->fallback].habit
		&& s->models[s->fallback].rows * FEW < s->table.rows;
	if (s->fallback == ECO_NONE || few)
		s->fallback = start_library_plant(s, &any);
	for (uint32_t i = 0; i < s->species.count; i++)
		if (s->matches[i].model == ECO_NONE && s->matches[i].tier != START_LEFT_OUT)
			s->models[s->fallback].rows += s->species.items[i].rows;
	snprintf(took, sizeof took, "%.64s", s->models[s->fallback].name);
	start_guess(s, "all other species", took, "\"*\" in the map", "%s; rows without a species get it, too",
		few ? "no tree has a tenth of the rows" : "the tree with most rows");
}

static void one_for_all(struct start *s, uint32_t model, const char *change, const char *why)
{
	s->fallback = model;
	s->models[model].rows = s->table.rows;
	s->columns.of[ECO_ROLE_SPECIES] = ECO_NONE;
	start_guess(s, "model", s->models[model].name, change, "%s", why);
}

static void take_plant(struct start *s)
{
	char known[300] = "";
	uint32_t i = 0;
	for (; i < s->model_count && strcmp(s->models[i].name, s->options->plant) != 0; i++)
		eco_phrase_add(known, sizeof known, s->models[i].name);
	if (i == s->model_count && eco_library_height(s->options->plant) > 0)
		start_library_add(s, s->options->plant);
	else if (i == s->model_count)
		eco_stop(ECO_BAD_INPUT, "--plant %.60s: no such model, and no habit of the library; there are: %s", s->options->plant, known);
	one_for_all(s, i, "--plant", "as you say");
}

static _Noreturn void ask_for_species(const struct start *s)
{
	char there[200] = "", known[120] = "";
	for (uint32_t i = 0; i < s->table.column_count; i++)
		eco_phrase_add(there, sizeof there, s->table.columns[i]);
	for (uint32_t i = 0; i < s->model_count; i++)
		eco_phrase_add(known, sizeof known, s->models[i].name);
	if (s->table.column_count == 0)
		eco_stop(ECO_BAD_INPUT, "%.120s: it has no columns, so no species; give --plant NAME for one model "
			"everywhere (%s)", s->options->table, known);
	eco_stop(ECO_BAD_INPUT, "%.120s: which column names the species? Give --species-column NAME (there are: %s), or "
		"--plant NAME for one model everywhere (%s)", s->options->table, there, known);
}

/* No model has the plant's form, which is known, or none is given. */
static bool is_for_library(const struct start *s, const struct start_match *match)
{
	bool known = match->flora.genus || match->flora.form != ECO_FORM_UNKNOWN;
	return match->flora.form != ECO_FORM_NOTHING && (!s->options->models || (match->tier == START_BY_NOTHING && known));
}

static void match_all(struct start *s)
{
	const uint32_t *more = s->columns.species_more;
	const char *columns[ECO_COLUMNS_JOINED] = { start_column(s, s->columns.of[ECO_ROLE_SPECIES]),
		start_column(s, more[0]), start_column(s, more[1]) };
	uint32_t joined = more[0] == ECO_NONE ? 1 : more[1] == ECO_NONE ? 2 : 3;
	eco_check(eco_table_values_read(&s->species, &s->source, columns, joined, s->error));
	s->matches = eco_alloc(s->species.count, sizeof *s->matches);
	s->hint = (struct eco_flora_hint){ .spelling = true, .codes = find_codes(s),
		.region = eco_region_of(s->place.degrees[0], s->place.degrees[1]) };
	for (uint32_t i = 0; i < s->model_count; i++)    /* a lime is a Tilia where the plants stand in Europe */
		s->models[i].flora = eco_flora_of(s->models[i].name, &(struct eco_flora_hint){ .region = s->hint.region });
	for (uint32_t i = 0; i < s->species.count; i++) {
		struct start_match *match = &s->matches[i];
		*match = (struct start_match){ .model = ECO_NONE, .tier = START_TIERS };
		if (eco_text_is_missing(s->species.items[i].text))
			continue;        /* "*" */
		struct eco_flora flora = eco_flora_of(s->species.items[i].text, &s->hint);
		if (!flora.genus && flora.form == ECO_FORM_UNKNOWN)
			find_form_beside(s, s->species.items[i].text, &flora);
		*match = best_match(s, s->species.items[i].text, &flora);
		if (is_for_library(s, match)) {
			match->model = start_library_plant(s, &flora);
			match->tier = START_BY_LIBRARY;
		}
		if (match->model == ECO_NONE)
			continue;
		s->models[match->model].rows += s->species.items[i].rows;
	}
	start_library_merge(s);
	for (int tier = 0; tier < START_TIERS; tier++)
		say_tier(s, (enum start_tier)tier);
	say_spelling(s);
	choose_fallback(s);
}

/* A dead plant's model, else the library's. */
static void match_dead(struct start *s)
{
	s->dead_model = ECO_NONE;
	if (s->dead_rows == 0)
		return;
	for (uint32_t i = 0; i < s->model_count && s->dead_model == ECO_NONE; i++)
		if (s->models[i].is_dead)
			s->dead_model = i;
	if (s->dead_model == ECO_NONE)
		s->dead_model = start_library_add(s, "dead");
	s->models[s->dead_model].rows += s->dead_rows;
}

void start_match_species(struct start *s)
{
	if (s->options->plant)
		take_plant(s);
	else if (s->columns.of[ECO_ROLE_SPECIES] != ECO_NONE)
		match_all(s);
	else if (s->model_count == 1)
		one_for_all(s, 0, "--species-column, --plant", "it is the only one");
	else if (s->model_count == 0 && s->table.column_count > 0) {
		struct eco_flora any = eco_flora_of("tree", NULL);
		one_for_all(s, start_library_plant(s, &any), "--species-column, --plant", "no column names a species");
	} else
		ask_for_species(s);
	match_dead(s);
}
