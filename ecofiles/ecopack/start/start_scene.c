/* scene.json: what was guessed, with the reasons in "notes". Longer than 600 lines: each key is written beside its note. */
#include "ecofiles/base/files.h"
#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/ecopack/start/start.h"

#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/text.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/scene/scene.h"

#define TREE_M 25.0              /* some trees reach it, no shrub */
#define RATE_PER_MM 0.002        /* of shrubs and herbs: half of their height at a trunk of 0.3 m */
#define SPREAD 0.15              /* of guessed sizes: trees of one trunk or age differ so */
/* The share of rows below which known heights are those of odd plants: volunteers' maps have a height where a tree
 * was planted lately, or is a monument. */
#define FEW_HEIGHTS 0.1

static double round_to(double value, double step) { return round(value / step) * step; }

static json_t *path_json(const struct start *s, const char *path)
{
	char *seen = start_path(s, path);
	json_t *text = json_string(seen);
	free(seen);
	return text;
}

static void set_text(json_t *object, const char *key, const char *text)
{
	if (text && text[0] != 0)
		json_object_set_new(object, key, json_string(text));
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

/* A number, or an array of several. */
static void set_numbers(json_t *to, const char *key, const double *numbers, uint32_t count)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(all, json_real(numbers[i]));
	if (count > 0 && numbers[0] > 0)
		json_object_set(to, key, count > 1 ? all : json_array_get(all, 0));
	json_decref(all);
}

static json_t *library_json(const struct start_model *m)
{
	json_t *plant = json_object();
	set_text(plant, "library", m->habit);
	set_text(plant, "genus", m->genus);
	set_numbers(plant, "height_m", m->size_m, m->sizes);
	set_numbers(plant, "crown_m", m->width_m, m->sizes);
	set_numbers(plant, "base", m->base, m->sizes);
	if (m->individuals > 1)
		json_object_set_new(plant, "individual", json_pack("[i,i]", 1, 2));
	return plant;
}

static json_t *plant_json(const struct start *s, const struct start_model *m)
{
	if (m->habit)
		return library_json(m);
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
	if (m->grade)
		json_object_set_new(plant, "grade", json_true());
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
	const struct eco_place_guess *p = &s->place;
	char took[120];
	if (s->trunk.column != ECO_NONE)
		start_guess(s, s->height.column == ECO_NONE ? "heights" : "other heights", "from the trunk, by species, genus "
			"or form", "\"height_m\" in the scene", "published curves; \"per_plant\" gives each kind its own");
	if (p->per_ha > 0)
		start_guess(s, "grown", p->stand ? "in a stand" : "in the open", "\"grown\" in the scene", "%.3g plants a "
			"hectare; guessed heights and crowns follow from it", p->per_ha);
	else if (p->stand)
		start_guess(s, "grown", "in a stand", "\"grown\" in the scene", "plots of a survey; guessed heights and crowns "
			"follow from it");
	if (s->height.column != ECO_NONE) {
		enum eco_form form = s->models[s->fallback].flora.form;
		bool few = s->height.share < FEW_HEIGHTS;
		s->height_m = few ? eco_form_size(form).typical_m : s->height.median * metres(s->height.unit.unit);
		snprintf(took, sizeof took, "%.3g m", s->height_m);
		if (few)
			start_guess(s, "without a size", took, "\"height_m\" in the scene", "usual for a %s; only %.2g %% of "
				"the rows have a height", eco_form_names[form], 100 * s->height.share);
		else
			start_guess(s, "without a size", took, "\"height_m\" in the scene", "the middle of the heights "
				"that are known");
	} else if (s->trunk.column != ECO_NONE || s->columns.of[ECO_ROLE_AGE] != ECO_NONE
			|| s->columns.of[ECO_ROLE_PLANTED] != ECO_NONE) {
		enum eco_form form = s->models[s->fallback].flora.form;
		s->height_m = eco_form_size(form == ECO_FORM_UNKNOWN ? ECO_FORM_BROAD : form).typical_m;
		snprintf(took, sizeof took, "%.3g m", s->height_m);
		start_guess(s, "without a size", took, "\"height_m\" in the scene", "usual for a %s",
			eco_form_names[form]);
	} else
		start_guess(s, "heights", "the models' own", "--height-column, --dbh-column", "no "
			"column of heights or trunks was found");
}

/* Lower forms of growth, for rows whose species nobody knows: as high as these reach; NULL: all models are trees. */
static json_t *low_plants_json(const struct start *s)
{
	json_t *plants = json_object();
	for (uint32_t i = 0; i < s->model_count; i++) {
		double most_m = eco_form_size(s->models[i].flora.form).most_m;
		if (is_used(s, i) && s->models[i].flora.form != ECO_FORM_UNKNOWN && most_m < TREE_M)
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
		json_array_append_new(heights, json_pack("{s:s, s:s, s:s, s:f, s:o*}", "by", "species",
			s->trunk_is_girth ? "from_girth" : "from_dbh", start_column(s, s->trunk.column),
			"unit", s->trunk.unit.unit, "spread", SPREAD, "per_plant", low_plants_json(s)));
	if (s->columns.of[ECO_ROLE_AGE] != ECO_NONE)
		json_array_append_new(heights, json_pack("{s:s, s:s, s:f}", "from_age",
			start_column(s, s->columns.of[ECO_ROLE_AGE]), "by", "species", "spread", SPREAD));
	if (s->columns.of[ECO_ROLE_PLANTED] != ECO_NONE)
		json_array_append_new(heights, json_pack("{s:s, s:i, s:s, s:f}", "from_year",
			start_column(s, s->columns.of[ECO_ROLE_PLANTED]), "now", s->now, "by", "species", "spread", SPREAD));
	if (s->height_m > 0)
		json_array_append_new(heights, json_real(round_to(s->height_m, 0.1)));
	return heights;
}

/* Measured crowns; a guess by species where any size of a plant is known. */
static json_t *crown_json(const struct start *s)
{
	bool sized = s->height.column != ECO_NONE || s->trunk.column != ECO_NONE
		|| s->columns.of[ECO_ROLE_AGE] != ECO_NONE || s->columns.of[ECO_ROLE_PLANTED] != ECO_NONE;
	json_t *crown = json_object(), *columns = json_array();
	for (uint32_t i = 0; i < ECO_CROWN_COLUMNS && s->crown.column != ECO_NONE; i++)
		if (i == 0 || i < s->crown_columns)
			json_array_append_new(columns, json_string(start_column(s, i == 0 ? s->crown.column : s->crowns[i])));
	if (s->table.crown_m > 0)
		set_text(crown, "is", "polygon");
	else if (json_array_size(columns) > 0) {
		json_object_set(crown, "column", s->crown_columns > 0 ? columns : json_array_get(columns, 0));
		set_text(crown, "is", s->crown_is_area ? "area" : s->crown_is_radius ? "radius" : "diameter");
		set_text(crown, "unit", s->crown.unit.unit);
	}
	if (sized) {
		set_text(crown, "otherwise", "species");
		json_object_set_new(crown, "spread", json_real(SPREAD));
	}
	json_decref(columns);
	return crown;
}

/* ---- The entry ---- */

static json_t *species_json(const struct start *s)
{
	const uint32_t *more = s->columns.species_more;
	json_t *first = json_string(start_column(s, s->columns.of[ECO_ROLE_SPECIES])), *all;
	if (more[0] == ECO_NONE)
		return first;
	all = json_pack("[o,s]", first, start_column(s, more[0]));
	if (more[1] != ECO_NONE)
		json_array_append_new(all, json_string(start_column(s, more[1])));
	return all;
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
		json_object_set_new(entry, "species", species_json(s));
		set_text(entry, "codes", s->hint.codes);
		json_object_set_new(entry, "map", map_json(s));
	}
	json_t *heights = heights_json(s);
	if (json_array_size(heights) > 0)
		json_object_set(entry, "height_m", heights);
	json_decref(heights);
	json_t *crown = crown_json(s);
	if (json_object_size(crown) > 0)
		json_object_set(entry, "crown_m", crown);
	if (s->crown_base != ECO_NONE)
		json_object_set_new(entry, "crown_base", json_pack("{s:s, s:s, s:s*}", "column", start_column(s, s->crown_base),
			"is", s->base_is_ratio ? "ratio" : "height", "unit", s->base_is_ratio ? NULL : s->base_unit));
	set_text(entry, "grown", p->stand ? "stand" : "");
	json_decref(crown);
	if (s->tint)
		json_object_set(entry, "tint", s->tint);
	if (json_object_size(s->skip) > 0)
		json_object_set(entry, "skip", s->skip);
	if (s->dead_model != ECO_NONE)
		json_object_set_new(entry, "instead", json_pack("{s:O}", s->models[s->dead_model].name, s->dead));
	for (size_t i = 0; i < 2; i++) {         /* a file's own turn and scale, as a plan's blocks have them */
		const char *own = i ? "scale" : "yaw_deg";
		for (uint32_t k = 0; k < s->table.column_count; k++)
			if (strcmp(s->table.columns[k], own) == 0)
				set_text(entry, own, own);
	}
	return entry;
}

/* A path, or an array of the tiles'. */
static json_t *tiles_json(const struct start *s, const struct start_raster *raster)
{
	json_t *paths = json_array();
	if (raster->tile_count == 1) {
		json_decref(paths);
		return path_json(s, raster->path);
	}
	for (uint32_t i = 0; i < raster->tile_count; i++)
		json_array_append_new(paths, path_json(s, raster->tiles[i].path));
	return paths;
}

static json_t *ground_json(const struct start *s)
{
	json_t *ground = json_object();
	if (s->dem.path) {
		json_object_set_new(ground, "heights", tiles_json(s, &s->dem));
		set_text(ground, "crs", s->place.dem_crs);
	}
	if (s->image.path && s->image.crs)
		json_object_set_new(ground, "image", json_pack("{s:o, s:s}", "file", tiles_json(s, &s->image), "crs",
			s->image.crs));
	else if (s->image.path)
		json_object_set_new(ground, "image", tiles_json(s, &s->image));
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
	say_heights(s);
	start_scene_text(s);
}

void start_scene_text(struct start *s)
{
	char name[64];
	start_name(s->options->folder, name);
	json_t *scene = json_object();
	set_text(scene, "name", name);
	json_object_set_new(scene, "notes", notes_json(s));
	set_text(scene, "crs", s->place.scene_crs);
	if (s->other)
		json_object_set(scene, "origin", json_object_get(s->other, "origin"));
	else
		json_object_set_new(scene, "origin", json_pack("[f,f]", s->place.origin[0], s->place.origin[1]));
	json_t *instances = json_pack("[o]", entry_json(s)), *ground = ground_json(s);
	json_t *plants = plants_json(s);
	start_land_add(s, ground, instances);
	start_objects_add(s, plants, instances);
	if (json_object_size(ground))
		json_object_set(scene, "ground", ground);
	json_decref(ground);
	json_object_set_new(scene, "plants", plants);
	json_object_set_new(scene, "instances", instances);
	free(s->scene);
	s->scene = json_dumps(scene, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
	json_decref(scene);
}

/* ---- Files ---- */

/* The files: each is written beside its name, and all get their names when all are there. */

#define MAP_PIXELS 1200u

enum { SCENE, MAP, CAMERA, FILES };
static const char *const names[FILES] = { "scene.json", "map.png", "camera.json" };

struct writing {
	struct start *start;
	char *beside[FILES], *path[FILES];
	struct map map;
};

/* ---- Paths ---- */

char *start_path(const struct start *s, const char *path)
{
	char *from = realpath(s->options->folder, NULL), *to = realpath(path, NULL);
	size_t same = 0, ups = 0;
	if (!from || !to)
		eco_end("a folder of the scene has gone");
	for (size_t i = 0; from[i] == to[i] && to[i] != 0; i++)
		if (to[i] == '/')
			same = i + 1;
	size_t length = strlen(from);
	if (strncmp(from, to, length) == 0 && to[length] == '/')
		same = length + 1;               /* it lies within the folder */
	for (size_t i = same; i < length; i++)
		ups += from[i] == '/';
	ups += same < length;
	char *seen = eco_alloc(3 * ups + strlen(to + same) + 1, 1);
	for (size_t i = 0; i < ups; i++)
		strcat(seen, "../");
	strcat(seen, to + same);
	free(from);
	free(to);
	return seen;
}

static void name_files(struct writing *w)
{
	const char *folder = w->start->options->folder;
	for (int i = 0; i < FILES; i++) {
		w->path[i] = start_text("%s/%s", folder, names[i]);
		w->beside[i] = start_text("%s/%s.start-%ld", folder, names[i], (long)getpid());
	}
}

static void remove_unfinished(void *writing)
{
	struct writing *w = writing;
	for (int i = 0; i < FILES; i++)
		unlink(w->beside[i]);
}

/* ---- The camera ---- */

/* The first look: from the south and a little above, at where many plants stand, near enough that a plant is
 * more than a dot. */

#define SEEN 200u                /* plants around the middle that the picture is for */
#define SQUARE_M 200.0
#define FAR_M 250.0              /* farther away plants are dots */
#define FIELD_DEG 45.0
#define STEEP 0.5                /* the look goes down no steeper, if that does not take it too far away */
#define UNKNOWN_M 10.0
#define CLEAR_M 10.0             /* around the eye no plant reaches so near to it */
#define STEPS 32                 /* of the ground between eye and target */

ECO_ORDER(compare, double, [0])

static double ground_at(const struct map *m, double x, double y)
{
	double z = 0;
	if (m->has_ground)
		eco_ground_height(&m->ground, x, y, &z);
	return z;
}

static uint32_t count_around(double (*points)[2], uint32_t count, const double at[2])
{
	uint32_t around = 0;
	for (uint32_t i = 0; i < count; i++)
		around += fmax(fabs(points[i][0] - at[0]), fabs(points[i][1] - at[1])) <= SQUARE_M / 2;
	return around;
}

/* The medians of x and y; where they lie beside the plants, as in a river, the square that holds the most, or
 * half as many and nearer. */
static void find_crowd(const struct map *m, double at[2])
{
	uint32_t n = m->points.count;
	double *sorted = eco_alloc(n, sizeof *sorted), (*points)[2] = eco_alloc(n, sizeof *points);
	struct eco_cluster *crowds = eco_alloc(n, sizeof *crowds);
	for (int k = 0; k < 2; k++) {
		for (uint32_t i = 0; i < n; i++)
			sorted[i] = points[i][k] = (double)(k ? m->points.items[i].y : m->points.items[i].x);
		qsort(sorted, n, sizeof *sorted, compare);
		at[k] = sorted[n / 2];
	}
	const struct eco_cluster *near = eco_cluster_near(crowds, eco_clusters_find(points, n, SQUARE_M, crowds), at);
	if (count_around(points, n, at) < near->count)
		memcpy(at, near->middle, sizeof near->middle);
	eco_free(sorted, points, crowds);
}

/* The plant nearest to `at`, and the distance within which SEEN others stand. */
static void find_middle(const struct map *m, double at[2], double *reach)
{
	uint32_t n = m->points.count, middle = 0;
	double *away = eco_alloc(n, sizeof *away), nearest = INFINITY;
	for (uint32_t i = 0; i < n; i++) {
		double distance = hypot((double)m->points.items[i].x - at[0], (double)m->points.items[i].y - at[1]);
		if (distance < nearest) {
			nearest = distance;
			middle = i;
		}
	}
	at[0] = (double)m->points.items[middle].x;
	at[1] = (double)m->points.items[middle].y;
	for (uint32_t i = 0; i < n; i++)
		away[i] = hypot((double)m->points.items[i].x - at[0], (double)m->points.items[i].y - at[1]);
	qsort(away, n, sizeof *away, compare);
	*reach = fmin(away[n > SEEN ? SEEN : n - 1], SQUARE_M / 2);
	free(away);
}

/* The least height of an eye there that clears plants, and the ground on the way to the target. */
static double least_height(const struct map *m, const double eye[2], const double target[3])
{
	double least = ground_at(m, eye[0], eye[1]) + 1.7;
	for (uint32_t i = 0; i < m->points.count; i++) {
		const struct map_point *p = &m->points.items[i];
		double x = (double)p->x, y = (double)p->y,
		       height = p->height_m > 0 ? (double)p->height_m : m->typical_m;
		if (hypot(x - eye[0], y - eye[1]) < CLEAR_M)
			least = fmax(least, ground_at(m, x, y) + height + CLEAR_M / 2);
	}
	for (int i = 1; i < STEPS; i++) {
		double t = (double)i / STEPS, x = eye[0] + t * (target[0] - eye[0]),
		       y = eye[1] + t * (target[1] - eye[1]);
		/* the line from eye to target is above this ground by 2 m if the eye is so high */
		least = fmax(least, (ground_at(m, x, y) + 2 - t * target[2]) / (1 - t));
	}
	return least;
}

/* The height that one in ten exceeds. */
static double tall_m(const struct map *m)
{
	struct eco_spread heights = { 0 };
	for (uint32_t i = 0; i < m->points.count; i++)
		if (m->points.items[i].height_m > 0)
			eco_spread_add(&heights, (double)m->points.items[i].height_m);
	double tall = eco_spread_quantile(&heights, 0.9);
	eco_spread_free(&heights);
	return tall > 0 ? tall : UNKNOWN_M;
}

/* A camera script of one picture, malloc'ed. */
static char *start_camera(const struct map *map)
{
	double middle[2] = { 0, 0 }, reach = 0, tall = tall_m(map);
	if (map->points.count == 0)
		eco_stop(ECO_BAD_INPUT, "no plant is left to look at");
	find_crowd(map, middle);
	find_middle(map, middle, &reach);
	double away = fmin(fmax(reach + 2 * tall, 3 * tall), FAR_M - 1);
	double target[3] = { middle[0], middle[1], ground_at(map, middle[0], middle[1]) + tall / 2 },
		eye[3] = { middle[0], middle[1] - away };
	for (eye[2] = INFINITY; eye[2] - target[2] > STEEP * (target[1] - eye[1]) && away < FAR_M;
		away *= 1.25) {
		eye[1] = middle[1] - away;
		eye[2] = fmax(target[2] + away / 4, least_height(map, eye, target));
	}
	return start_text("{\"fps\": 1, \"keyframes\": [\n  {\"time_s\": 0, \"eye\": [%.2f, %.2f, %.2f], \"target\": [%.2f, "
		"%.2f, %.2f], \"fov_y_deg\": %g}]}\n", eye[0], eye[1], eye[2], target[0], target[1], target[2], FIELD_DEG);
}

/* ---- Content ---- */

/* The camera beside the scene of --same-place-as, malloc'ed. */
static char *other_camera(const struct start *s)
{
	const char *scene = s->options->same_place, *last = eco_path_last(scene);
	char *path = start_text("%.*scamera.json", (int)(last - scene), scene);
	json_t *camera = json_load_file(path, 0, NULL);
	if (!camera)
		eco_stop(ECO_BAD_INPUT, "%.300s: no camera is beside the scene of --same-place-as: copy one there", path);
	char *text = json_dumps(camera, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
	json_decref(camera);
	free(path);
	return text;
}

/* The scene is read back as make reads it: what is wrong with it shows now. */
static void write_all(void *writing)
{
	struct writing *w = writing;
	struct start *s = w->start;
	w->map.error = s->error;
	eco_check(eco_file_write(w->beside[SCENE], s->scene, strlen(s->scene), s->error));
	eco_check(map_gather(&w->map, w->beside[SCENE]));
	if (w->map.total == 0)
		eco_stop(ECO_BAD_INPUT, "%.200s: no row became a plant", s->options->table);
	start_library_sizes(s, &w->map);
	start_scene_text(s);
	eco_check(eco_file_write(w->beside[SCENE], s->scene, strlen(s->scene), s->error));
	char *camera = s->other ? other_camera(s) : start_camera(&w->map);
	eco_check(eco_file_write(w->beside[CAMERA], camera, strlen(camera), s->error));
	free(camera);
	eco_check(map_write(&w->map, w->beside[MAP], MAP_PIXELS));
	for (int i = 0; i < FILES; i++)
		if (rename(w->beside[i], w->path[i]) != 0)
			eco_check(eco_fail_write(s->error, w->path[i], errno));
}

void start_write(struct start *s)
{
	struct writing w = { .start = s };
	name_files(&w);
	eco_at_end(remove_unfinished, &w);
	enum eco_code code = eco_try(write_all, &w, s->error);
	eco_at_end(NULL, NULL);
	if (!code && w.map.off_ground > 0)
		main_note("%s: %llu of %llu plants stand beyond its border", s->dem.path,
			(unsigned long long)w.map.off_ground, (unsigned long long)w.map.total);
	remove_unfinished(&w);
	for (int i = 0; i < FILES; i++) {
		free(w.beside[i]);
		free(w.path[i]);
	}
	map_free(&w.map);
	eco_check(code);
}
