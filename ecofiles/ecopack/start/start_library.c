/* Plants of the library, where the table has plants without a model: a plant for each genus or species that differs, in as many sizes as its
 * rows need. Sizes are about two times apart, so that leaves are drawn at .7 to 1.4 of the size they were grown in. */
#include "ecofiles/ecopack/start/start.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/generate/library.h"

#define GENERA_MOST 40u          /* and species with plants of their own; rarer ones share those of their genus or habit */
#define GROWN_MOST 72u           /* plants to be built: a second each for a draft */
#define SIZES_MOST 58u           /* of these without second individuals */
#define FEW 0.03                 /* a size for fewer of a plant's rows is not worth a model */
#define TALL 0.98                /* rows below the greatest size, to which it is drawn larger by little */
#define PAIR_ROWS 12u            /* fewer rows need no second individual */
#define OF_GENUS 0.7             /* height of a plant without one, as a share of its genus's greatest */

/* ---- Which plants ---- */

static uint32_t add_plant(struct start *s, const char *habit, const char *genus, enum eco_form form)
{
	for (uint32_t i = 0; i < s->model_count; i++) {
		const struct start_model *m = &s->models[i];
		if (m->habit && strcmp(m->habit, habit) == 0 && strcmp(m->genus, genus) == 0)
			return i;
	}
	char name[80];
	snprintf(name, sizeof name, "%s%s%s", genus, genus[0] ? " " : "", habit);
	struct start_model *m = start_model_add(s, name, strlen(name));
	m->habit = habit;
	m->genus = genus;
	m->flora.form = form;
	return s->model_count - 1;
}

uint32_t start_library_add(struct start *s, const char *name)
{
	struct eco_habit habit;
	for (size_t i = 0; eco_library_habit(i, &habit) && strcmp(habit.name, name) != 0; i++) {}
	return add_plant(s, name, "", habit.like);
}

uint32_t start_library_plant(struct start *s, const struct eco_flora *flora)
{
	uint32_t i = add_plant(s, eco_library_habit_of(flora), eco_library_taxon_of(flora),
		flora->form != ECO_FORM_UNKNOWN ? flora->form : ECO_FORM_BROAD);
	s->models[i].flora.height_m = fmax(s->models[i].flora.height_m, flora->height_m);
	return i;
}

static void hand_over(struct start *s, uint32_t from, uint32_t to)
{
	s->models[to].rows += s->models[from].rows;
	s->models[from].rows = 0;
	for (uint32_t i = 0; i < s->species.count; i++)
		if (s->matches[i].model == from)
			s->matches[i].model = to;
}

void start_library_merge(struct start *s)
{
	uint32_t merged = 0;
	for (;;) {
		uint32_t count = 0, least = ECO_NONE;
		for (uint32_t i = 0; i < s->model_count; i++) {
			if (!s->models[i].habit || s->models[i].genus[0] == 0 || s->models[i].rows == 0)
				continue;
			count++;
			if (least == ECO_NONE || s->models[i].rows <= s->models[least].rows)
				least = i;
		}
		if (count <= GENERA_MOST)
			break;
		const struct start_model *m = &s->models[least]; /* a species is handed to its genus first */
		const char *wider = strchr(m->genus, ' ') ? eco_flora_of(m->genus, NULL).genus : "";
		hand_over(s, least, add_plant(s, m->habit, wider, m->flora.form));
		merged++;
	}
	char took[80];
	snprintf(took, sizeof took, "%u rare species and genera share plants of their genera and habits", merged);
	if (merged > 0)
		start_guess(s, "library", took, "\"plants\" and \"map\" in the scene", "%u have plants of their own", GENERA_MOST);
}

/* ---- Which sizes ---- */

struct bin { uint64_t rows, crowns, bases; double height, square, crown, base; };    /* sums; square: of heights */
struct need { struct bin bin[START_SIZES]; double top; uint64_t rows; struct eco_spread heights; };

static uint32_t bin_of(double top, double height)
{
	uint32_t bin = 0;
	for (double low = top / 2; height <= low && bin + 1 < START_SIZES; low /= 2)
		bin++;
	return bin;
}

static void gather(const struct start *s, const struct map *map, struct need *needs)
{
	uint32_t *model_of = eco_alloc(map->kind_count, sizeof *model_of);
	for (uint32_t k = 0; k < map->kind_count; k++) {
		model_of[k] = ECO_NONE;
		for (uint32_t i = 0; i < s->model_count; i++)
			if (s->models[i].habit && strcmp(s->models[i].name, map->kinds[k].name) == 0)
				model_of[k] = i;
	}
	for (int pass = 0; pass < 2; pass++) {
		for (uint32_t p = 0; p < map->points.count; p++) {
			const struct map_point *point = &map->points.items[p];
			uint32_t model = model_of[point->kind];
			double height = (double)point->height_m;
			if (model == ECO_NONE || !(height > 0))
				continue;
			struct need *n = &needs[model];
			if (pass == 0) {
				eco_spread_add(&n->heights, height);
				continue;
			}
			struct bin *bin = &n->bin[bin_of(n->top, height)];
			n->rows++;
			bin->rows++;
			bin->height += height;
			bin->square += height * height;
			bin->crown += (double)point->crown_m;
			bin->crowns += point->crown_m > 0;
			bin->base += (double)point->base;
			bin->bases += point->base > 0;
		}
		for (uint32_t i = 0; pass == 0 && i < s->model_count; i++)
			needs[i].top = needs[i].heights.seen ? eco_spread_quantile(&needs[i].heights, TALL) : 0;
	}
	free(model_of);
}

/* A bin's rows go to its neighbour, the next larger one if there is any. */
static void give_away(struct need *n, uint32_t bin)
{
	uint32_t to = bin;
	while (to > 0 && n->bin[--to].rows == 0) {}
	for (uint32_t b = bin + 1; n->bin[to].rows == 0 || to == bin; b++)
		to = b;
	struct bin *from = &n->bin[bin], *at = &n->bin[to];
	*at = (struct bin){ at->rows + from->rows, at->crowns + from->crowns, at->bases + from->bases, at->height + from->height,
		at->square + from->square, at->crown + from->crown, at->base + from->base };
	*from = (struct bin){ 0 };
}

/* The bins with the fewest rows are given away, until there are few enough. Returns how many are left. */
static uint32_t drop_bins(const struct start *s, struct need *needs)
{
	for (;;) {
		uint32_t all = 0, model = ECO_NONE, bin = 0;
		bool few = false;
		for (uint32_t i = 0; i < s->model_count && !few; i++) {
			uint32_t own = 0;
			for (uint32_t b = 0; b < START_SIZES; b++)
				own += needs[i].bin[b].rows > 0;
			all += own;
			for (uint32_t b = 0; b < START_SIZES && own > 1 && !few; b++) {
				uint64_t rows = needs[i].bin[b].rows;
				few = rows > 0 && (double)rows < FEW * (double)needs[i].rows;
				if (few || (rows > 0 && (model == ECO_NONE || rows < needs[model].bin[bin].rows))) {
					model = i;
					bin = b;
				}
			}
		}
		if (model == ECO_NONE || (!few && all <= SIZES_MOST))
			return all;
		give_away(&needs[model], bin);
	}
}

static double rounded(double m) { return m >= 2 ? round(m * 10) / 10 : fmax(round(m * 100) / 100, ECO_LIBRARY_LEAST_M); }

static void take_sizes(struct start_model *m, const struct need *n)
{
	bool crowns = true, bases = true;
	if (n->rows > 0)
		m->sizes = 0;
	for (uint32_t b = 0; b < START_SIZES; b++) {
		crowns = crowns && n->bin[b].crowns == n->bin[b].rows;
		bases = bases && (2 * n->bin[b].bases > n->bin[b].rows || n->bin[b].rows == 0);
	}
	for (uint32_t b = START_SIZES; b-- > 0;) {
		if (n->bin[b].rows == 0)
			continue;
		/* a mean in which tall plants count for more: leaves that are a little small are better than large ones */
		double height = fmin(rounded(n->bin[b].square / n->bin[b].height), ECO_LIBRARY_MOST_M);
		double crown = n->bin[b].crown / n->bin[b].height * height;
		m->size_m[m->sizes] = height;
		m->base[m->sizes] = bases ? fmin(round(100 * n->bin[b].base / n->bin[b].bases) / 100, ECO_LIBRARY_BASE_MOST) : 0;
		m->width_m[m->sizes++] = crowns ? rounded(fmin(fmax(crown, 0.05 * height), 4 * height)) : 0;
	}
}

/* The height of models that the rows use, as a share of what is usual for their like: the median, at most 1. */
static double given_share(const struct start *s)
{
	struct eco_spread shares = { .seen = 0 };
	double share;
	for (uint32_t i = 0; i < s->model_count; i++) {
		const struct start_model *m = &s->models[i];
		if (!m->habit && m->rows > 0 && m->height_m > 0 && eco_form_is_tree(m->flora.form))
			eco_spread_add(&shares, m->height_m / eco_library_height(eco_library_habit_of(&m->flora)));
	}
	share = shares.seen ? fmin(eco_spread_quantile(&shares, 0.5), 1) : 1;
	eco_spread_free(&shares);
	return share;
}

void start_library_usual(struct start *s)
{
	double share = given_share(s);
	for (uint32_t i = 0; i < s->model_count; i++) {
		struct start_model *m = &s->models[i];
		if (!m->habit)
			continue;
		double usual = eco_library_height(m->habit), genus = m->flora.height_m > 0 ? OF_GENUS * m->flora.height_m : usual;
		m->size_m[0] = rounded(fmin(usual, genus) * (eco_form_is_tree(m->flora.form) ? share : 1));
		m->sizes = 1;
	}
}

/* Second individuals, for the plants with most rows first. */
static void take_pairs(struct start *s, uint32_t grown)
{
	for (;;) {
		uint32_t best = ECO_NONE;
		for (uint32_t i = 0; i < s->model_count; i++) {
			const struct start_model *m = &s->models[i];
			bool may = m->habit && m->individuals == 0 && m->rows >= PAIR_ROWS && grown + m->sizes <= GROWN_MOST;
			if (may && (best == ECO_NONE || m->rows > s->models[best].rows))
				best = i;
		}
		if (best == ECO_NONE)
			return;
		s->models[best].individuals = 2;
		grown += s->models[best].sizes;
	}
}

static void say_plants(struct start *s)
{
	uint32_t plants = 0, sizes = 0, models = 0;
	char took[160], rows[32];
	uint64_t grown = 0;
	for (uint32_t i = 0; i < s->model_count; i++) {
		const struct start_model *m = &s->models[i];
		if (!m->habit || (m->rows == 0 && i != s->fallback))
			continue;
		uint32_t own = m->sizes > 0 ? m->sizes : 1;
		plants++;
		sizes += own;
		models += own * (m->individuals > 1 ? m->individuals : 1);
		grown += m->rows;
	}
	snprintf(took, sizeof took, "%u plants in %u sizes, %u models with second individuals, for %s rows", plants, sizes, models,
		eco_phrase_count(grown, rows));
	if (plants > 0)
		start_guess(s, "library", took, "\"library\" of \"plants\" in the scene", "%s; a size for rows of half to all of a "
			"height", s->options->models ? "no model has their form" : "no models are given");
}

void start_library_sizes(struct start *s, const struct map *map)
{
	struct need *needs = eco_alloc(s->model_count, sizeof *needs);
	gather(s, map, needs);
	uint32_t grown = drop_bins(s, needs);
	for (uint32_t i = 0; i < s->model_count; i++) {
		struct start_model *m = &s->models[i];
		if (m->habit)
			take_sizes(m, &needs[i]);
		eco_spread_free(&needs[i].heights);
	}
	free(needs);
	take_pairs(s, grown);
	say_plants(s);
}
