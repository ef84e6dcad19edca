/* scene.json: what was guessed, with the reasons in "notes". */
#include "ecofiles/ecopack/start/start.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/scene/scene.h"

/* Heights from trunks where there is nothing better: trees of a city, of which the tallest reach 25 m, half
 * of that at a diameter of 0.3 m. */
#define TALLEST_M 25.0
#define RATE_PER_MM 0.002

static double round_to(double value, double step) { return round(value / step) * step; }

static json_t *path_json(const struct start *s, const char *path)
{
	char *seen = start_path(s, path);
	json_t *text = json_string(seen);
	free(seen);
	return text;
}

/* ---- Notes ---- */

/* Guesses that share a heading are several texts. */
static json_t *notes_json(const struct start *s)
{
	json_t *notes = json_object();
	json_object_set_new(notes, "start", json_string("Written by ecopack start. Each note says what was "
		"taken, why, and which option or field changes it. Nothing here is guessed again: what "
		"this file says holds."));
	for (uint32_t i = 0; i < s->guess_count; i++) {
		const struct start_guess *g = &s->guesses[i];
		char key[64], text[700];
		snprintf(text, sizeof text, "%s (%s)%s%s", g->took, g->why, g->change[0] ? "; "
			"change: " : "", g->change);
		snprintf(key, sizeof key, "%s", g->what);
		for (unsigned n = 2; json_object_get(notes, key); n++)
			snprintf(key, sizeof key, "%s %u", g->what, n);
		json_object_set_new(notes, key, json_string(text));
	}
	return notes;
}

/* ---- Plants ---- */

static bool is_used(const struct start *s, uint32_t i) { return s->models[i].rows > 0 || i == s->fallback; }

static json_t *plant_json(const struct start *s, const struct start_model *m)
{
	json_t *plant = json_object(), *files = json_array();
	for (uint32_t i = 0; i < m->path_count; i++)
		json_array_append_new(files, path_json(s, m->paths[i]));
	if (m->path_count == 1)
		json_object_set(plant, "model", json_array_get(files, 0));
	else
		json_object_set(plant, "variants", files);
	json_decref(files);
	if (m->up != ECO_UP_FOUND)
		json_object_set_new(plant, "up", json_string(eco_up_name(m->up)));
	if (m->height_is_ours)
		json_object_set_new(plant, "height_m", json_real(round_to(m->height_m, 0.001)));
	return plant;
}

static json_t *plants_json(const struct start *s)
{
	json_t *plants = json_object();
	for (uint32_t i = 0; i < s->model_count; i++)
		if (is_used(s, i))
			json_object_set_new(plants, s->models[i].name, plant_json(s, &s->models[i]));
	return plants;
}

/* Capitals do not count: the commonest way to write a species is its key. */
static json_t *map_json(const struct start *s)
{
	json_t *map = json_object(), *known = json_object();
	for (uint32_t i = 0; i < s->species.count; i++) {
		const struct start_match *match = &s->matches[i];
		const char *text = s->species.items[i].text;
		char folded[256];
		eco_text_fold(text, folded, sizeof folded);
		if (match->tier == START_TIERS || strlen(text) > 200 || json_object_get(known, folded))
			continue;
		json_object_set_new(known, folded, json_true());
		json_object_set_new(map, text, match->model == ECO_NONE ? json_null()
			: json_string(s->models[match->model].name));
	}
	json_object_set_new(map, "*", json_string(s->models[s->fallback].name));
	json_decref(known);
	return map;
}

/* ---- Heights ---- */

static double metres(const char *unit)
{
	double metres = 1;
	eco_unit_metres(unit, &metres);
	return metres;
}

static void say_heights(struct start *s)
{
	char took[120];
	if (s->trunk.column != ECO_NONE) {
		snprintf(took, sizeof took, "from the trunk: 1.3 + (%g - 1.3) (1 - exp(-%g mm))", TALLEST_M,
			RATE_PER_MM);
		start_guess(s, s->height.column == ECO_NONE ? "heights" : "other heights", took,
			"\"height_m\" in the scene", "a usual curve of city trees, %g m at most, shrubs and "
			"herbs as high as they grow; \"per_plant\" gives each kind its own", TALLEST_M);
	}
	s->height_m = s->height.column != ECO_NONE ? s->height.median * metres(s->height.unit.unit) : 0;
	if (s->height.column != ECO_NONE) {
		snprintf(took, sizeof took, "%.3g m", s->height_m);
		start_guess(s, "without a size", took, "\"height_m\" in the scene", "the middle of "
			"the heights that are known");
	} else if (s->trunk.column == ECO_NONE)
		start_guess(s, "heights", "the models' own", "--height-column, --dbh-column", "no "
			"column of heights or trunks was found");
}

/* The curve of trees, ending at what a lower form of growth reaches; NULL: all models are trees. */
static json_t *low_plants_json(const struct start *s)
{
	json_t *plants = json_object();
	for (uint32_t i = 0; i < s->model_count; i++) {
		double most_m = eco_form_size(s->models[i].flora.form).most_m;
		if (is_used(s, i) && s->models[i].flora.form != ECO_FORM_UNKNOWN && most_m < TALLEST_M)
			json_object_set_new(plants, s->models[i].name,
				json_pack("{s:f, s:f}", "max", most_m, "rate", RATE_PER_MM));
	}
	if (json_object_size(plants) > 0)
		return plants;
	json_decref(plants);
	return NULL;
}

static json_t *heights_json(const struct start *s)
{
	json_t *heights = json_array();
	if (s->height.column != ECO_NONE)
		json_array_append_new(heights, json_pack("{s:s, "
			"s:s}", "column", start_column(s, s->height.column),
			"unit", s->height.unit.unit));
	if (s->trunk.column != ECO_NONE)
		json_array_append_new(heights, json_pack("{s:s, s:s, s:f, s:f, s:o*}",
			s->trunk_is_girth ? "from_girth" : "from_dbh", start_column(s, s->trunk.column),
			"unit", s->trunk.unit.unit, "max", TALLEST_M, "rate", RATE_PER_MM,
			"per_plant", low_plants_json(s)));
	if (s->height_m > 0)
		json_array_append_new(heights, json_real(round_to(s->height_m, 0.1)));
	return heights;
}

/* ---- The entry ---- */

static void set_text(json_t *object, const char *key, const char *text)
{
	if (text && text[0] != 0)
		json_object_set_new(object, key, json_string(text));
}

static json_t *entry_json(const struct start *s)
{
	const struct eco_place_guess *p = &s->place;
	json_t *entry = json_object();
	json_object_set_new(entry, "from", path_json(s, s->options->table));
	set_text(entry, "layer", s->options->layer);
	set_text(entry, "separator", s->options->separator);
	if (!p->from_geometry) {
		set_text(entry, "x", start_column(s, s->columns.of[p->swapped ? ECO_ROLE_Y : ECO_ROLE_X]));
		set_text(entry, "y", start_column(s, s->columns.of[p->swapped ? ECO_ROLE_X : ECO_ROLE_Y]));
	}
	set_text(entry, "unit", p->unit);
	if (p->offsets.quadrat_m > 0)
		json_object_set_new(entry, "quadrat", json_pack("{s:s, s:f}", "column",
			start_column(s, s->columns.of[ECO_ROLE_QUADRAT]), "size_m", p->offsets.quadrat_m));
	if (p->offsets.polar)
		json_object_set_new(entry, "polar", json_pack("{s:s, s:s, s:s, s:f}", "azimuth",
			start_column(s, s->columns.of[ECO_ROLE_AZIMUTH]), "distance",
			start_column(s, s->columns.of[ECO_ROLE_DISTANCE]), "unit", p->offsets.distance_unit,
			"whole_turn", p->offsets.whole_turn));
	if (!p->file_says)
		set_text(entry, "crs", p->crs);
	if (s->columns.decimal == ',')
		set_text(entry, "decimal", ",");
	set_text(entry, "thousands", (const char[]){ s->columns.thousands, 0 });
	if (s->columns.of[ECO_ROLE_SPECIES] == ECO_NONE) {
		set_text(entry, "plant", s->models[s->fallback].name);
	} else {
		set_text(entry, "species", start_column(s, s->columns.of[ECO_ROLE_SPECIES]));
		json_object_set_new(entry, "map", map_json(s));
	}
	json_t *heights = heights_json(s);
	if (json_array_size(heights) > 0)
		json_object_set(entry, "height_m", heights);
	json_decref(heights);
	return entry;
}

static json_t *ground_json(const struct start *s)
{
	json_t *ground = json_object();
	if (s->dem.path) {
		json_object_set_new(ground, "heights", path_json(s, s->dem.path));
		set_text(ground, "crs", s->place.dem_crs);
	}
	if (s->image.path && s->image.crs)
		json_object_set_new(ground, "image", json_pack("{s:o, s:s}", "file", path_json(s, s->image.path), "crs",
			s->image.crs));
	else if (s->image.path)
		json_object_set_new(ground, "image", path_json(s, s->image.path));
	return ground;
}

void start_name(const char *folder, char name[64])
{
	char *real = realpath(folder, NULL);
	const char *last = real ? eco_path_last(real) : "";
	snprintf(name, 64, "%.63s", *last ? last : "scene");
	for (char *c = name; *c != 0; c++) {
		if (*c >= 'A' && *c <= 'Z')
			*c = (char)(*c + 32);
		else if (!(*c >= 'a' && *c <= 'z') && !(*c >= '0' && *c <= '9') && *c != '_')
			*c = '-';
	}
	free(real);
}

void start_scene(struct start *s)
{
	char name[64];
	say_heights(s);
	start_name(s->options->folder, name);
	json_t *scene = json_object();
	set_text(scene, "name", name);
	json_object_set_new(scene, "notes", notes_json(s));
	set_text(scene, "crs", s->place.scene_crs);
	json_object_set_new(scene, "origin", json_pack("[f,f]", s->place.origin[0], s->place.origin[1]));
	if (s->dem.path || s->image.path)
		json_object_set_new(scene, "ground", ground_json(s));
	json_object_set_new(scene, "plants", plants_json(s));
	json_object_set_new(scene, "instances", json_pack("[o]", entry_json(s)));
	s->scene = json_dumps(scene, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
	json_decref(scene);
}
