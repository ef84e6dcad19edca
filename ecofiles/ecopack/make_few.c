/* Few models for many plants: looks at all models, counts who uses them, chooses those that stand for the
 * others (few.h), and leaves only these to be built. Places are read before the plants are built, as they say
 * how often a model is used; so they are scaled by heights of models as imported, and once more when the
 * heights as built are known (make_places.c). */
#include "ecofiles/ecopack/make.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/few.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/ecopack/times.h"

struct few {
	struct make *m;
	struct few_look *looks;
	/* sum of heights of the plants that use it: the stretch of a path on which a plant is large in the
	 * picture is as long as the plant is high. By area herbs would have no say, by number trees little */
	double *weight;
	uint64_t *plants;            /* that use the model */
	double *difference;
	uint32_t *stand_in, *place;  /* per model: who stands for it, and where that one is kept */
};

static enum eco_code look_at_all(struct few *f)
{
	struct make *m = f->m;
	enum eco_code code = ECO_OK;
	main_times_stage(MAIN_STAGE_MODELS);
	for (uint32_t i = 0; i < m->plant_count && !code; i++) {
		struct make_plant *plant = &m->plants[i];
		struct eco_model model = { 0 };
		if (!main_progress("looking at models", plant->name, (double)i / m->plant_count))
			return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
		code = make_import(plant, &model, false, m->error);
		if (!code)
			code = few_look(&f->looks[i], &model, m->error);
		eco_model_free(&model);
		plant->looked_m = f->looks[i].height_m;
		plant->reach = f->looks[i].reach_m;
		plant->built.plant.height_m = (float)plant->looked_m;
	}
	return code;
}

/* An eco file counts as often as it is placed. */
static enum eco_code count_uses(struct few *f)
{
	struct make *m = f->m;
	double *times = calloc(m->sources.count + 1u, sizeof *times);
	if (!times)
		return eco_fail(m->error, ECO_NO_MEMORY, "no memory for %u eco files", m->sources.count);
	times[0] = 1;
	for (uint32_t s = 0; s < m->sources.count; s++) {
		const struct eco_source *source = &m->sources.items[s];
		for (uint32_t i = 0; i < source->child_count; i++)
			times[source->children[i].source] += times[s];
		for (uint32_t i = 0; i < m->ecos[s].place_count; i++) {
			const struct make_place *p = &m->ecos[s].places[i];
			f->weight[p->plant] += times[s] * p->scale * m->plants[p->plant].looked_m;
			f->plants[p->plant] += (uint64_t)times[s];
		}
	}
	free(times);
	return ECO_OK;
}

static enum eco_code choose(struct few *f, uint32_t keep)
{
	uint32_t n = f->m->plant_count;
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t k = 0; k < i; k++)
			f->difference[(size_t)i * n + k] = f->difference[(size_t)k * n + i] =
				few_difference(&f->looks[i], &f->looks[k]);
	return few_choose(f->difference, f->weight, n, keep, f->stand_in, f->m->error);
}

/* ---- What stands for what ---- */

static enum eco_code note_stood_for(struct few *f, uint32_t kept)
{
	struct make *m = f->m;
	struct make_plant *plant = &m->plants[kept];
	uint32_t n = m->plant_count;
	plant->stood_for = calloc(n, sizeof *plant->stood_for);
	if (!plant->stood_for)
		return eco_fail(m->error, ECO_NO_MEMORY, "no memory for %u models", n);
	for (uint32_t pass = 0; pass < 2; pass++)            /* itself first */
		for (uint32_t i = 0; i < n; i++) {
			if (f->stand_in[i] != kept || (i == kept) != (pass == 0))
				continue;
			struct make_stood_for *s = &plant->stood_for[plant->stood_count++];
			memcpy(s->name, m->plants[i].name, sizeof s->name);
			s->plants = f->plants[i];
			s->difference = f->difference[(size_t)i * n + kept];
		}
	return ECO_OK;
}

/* One line: "oak: 12 models, 431 plants, 0.08 of the picture differs, at most 0.21 (elm)". */
static void say(const struct make_plant *plant)
{
	const struct make_stood_for *worst = plant->stood_for;
	double sum = 0;
	uint64_t plants = 0;
	for (uint32_t i = 0; i < plant->stood_count; i++) {
		const struct make_stood_for *s = &plant->stood_for[i];
		sum += (double)s->plants * s->difference;
		plants += s->plants;
		worst = s->difference > worst->difference ? s : worst;
	}
	if (plant->stood_count == 1)
		main_note("%s stands for itself, %llu plants", plant->name, (unsigned long long)plants);
	else
		main_note("%s stands for %u models, %llu plants: %.2f of their pictures differs in the "
			"mean, at most %.2f (%s)", plant->name, plant->stood_count,
			(unsigned long long)plants,
			plants ? sum / (double)plants : 0, worst->difference, worst->name);
}

/* ---- Leaving the others out ---- */

static void drop_others(struct few *f)
{
	struct make *m = f->m;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->plant_count; i++)
		f->place[i] = f->stand_in[i] == i ? kept++ : ECO_NONE;
	for (uint32_t s = 0; s < m->sources.count; s++) {
		for (uint32_t i = 0; i < m->sources.items[s].plant_count; i++)
			m->plant_of[s][i] = f->place[f->stand_in[m->plant_of[s][i]]];
		for (uint32_t i = 0; i < m->ecos[s].place_count; i++) {
			struct make_place *p = &m->ecos[s].places[i];
			uint32_t by = f->stand_in[p->plant];
			p->scale *= m->plants[p->plant].looked_m / m->plants[by].looked_m;
			p->plant = f->place[by];
		}
	}
	for (uint32_t i = 0; i < m->plant_count; i++) {
		if (f->place[i] == ECO_NONE) {
			free(m->plants[i].path);
			continue;
		}
		m->plants[i].built = (struct lod_plant){ 0 };
		m->plants[f->place[i]] = m->plants[i];
	}
	m->models_given = m->plant_count;
	m->plant_count = kept;
}

static enum eco_code few(struct few *f, uint32_t keep)
{
	struct make *m = f->m;
	size_t n = m->plant_count;
	f->looks = calloc(n, sizeof *f->looks);
	f->weight = calloc(n, sizeof *f->weight);
	f->plants = calloc(n, sizeof *f->plants);
	f->difference = calloc(n * n, sizeof *f->difference);
	f->stand_in = calloc(n, sizeof *f->stand_in);
	f->place = calloc(n, sizeof *f->place);
	if (!f->looks || !f->weight || !f->plants || !f->difference || !f->stand_in || !f->place)
		return eco_fail(m->error, ECO_NO_MEMORY, "no memory to compare %zu models", n);
	enum eco_code code = look_at_all(f);
	main_times_stage(MAIN_STAGE_POSITIONS);
	if (!code)
		code = make_places_read(m);
	if (!code)
		code = count_uses(f);
	main_times_stage(MAIN_STAGE_MODELS);
	if (!code)
		code = choose(f, keep);
	for (uint32_t i = 0; i < m->plant_count && !code; i++)
		if (f->stand_in[i] == i)
			code = note_stood_for(f, i);
	for (uint32_t i = 0; i < m->plant_count && !code; i++)
		if (f->stand_in[i] == i)
			say(&m->plants[i]);
	if (!code)
		drop_others(f);
	return code;
}

enum eco_code make_few(struct make *m)
{
	struct few f = { .m = m };
	uint32_t keep = m->options->models ? m->options->models : m->sources.items[0].models;
	if (!keep)
		return ECO_OK;
	if (keep >= m->plant_count) {
		main_note("all models are kept: the scene has %u, and %u may be", m->plant_count, keep);
		return ECO_OK;
	}
	if (m->plant_count > FEW_MODELS_MAX)
		return eco_fail(m->error, ECO_TOO_LARGE, "%u models are too many to choose from: at most %u",
			m->plant_count, FEW_MODELS_MAX);
	enum eco_code code = few(&f, keep);
	free(f.looks);
	free(f.weight);
	free(f.plants);
	free(f.difference);
	free(f.stand_in);
	free(f.place);
	return code;
}
