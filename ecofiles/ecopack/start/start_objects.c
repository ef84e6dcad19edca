/* Models of buildings among the arguments: what is no plant by the names of its parts, else by its shape. It stands as its file
 * says, with its zero at the scene's origin; in map coordinates, where they say. */
#include "ecofiles/ecopack/start/start.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/import/model/model_parts.h"

#define ALONG 0.02           /* a cosine: one degree beside an axis */
#define PLANE_LEAST 0.5      /* of a building's surface is upright or level */
#define SQUARE_LEAST 0.5     /* of its walls go two ways that cross squarely, as those of a block do, and of a stem do not */
#define WIDE_M 60.0          /* they need not where it is wider than a crown */
#define REACH_M 50000.0      /* as far from the trees at most */
#define NAME_BYTES 40u       /* that a plant's name takes from its file's */
#define ZERO_NEAR 0.05       /* of the height, its foot is from the file's zero */

struct look { double plane[3], square[3]; int words[2]; bool cutout; double low[3], high[3]; };

/* Votes of one name, for buildings and for plants. */
static void look_at_name(struct look *look, const char *name)
{
	look->words[0] += eco_words_any(name, eco_words_set("building"));
	look->words[1] += eco_words_any(name, eco_words_set("foliage")) || eco_flora_of(name, NULL).genus;
}

/* Shares of the surface that are upright or level, were each axis that which points up. */
static void look_at_shape(struct look *look, const struct eco_model *m)
{
	double all = 0, walls[3] = { 0 }, turn[3][2] = { { 0 } };
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		const float *p[3];
		double e[2][3], n[3];
		for (int k = 0; k < 3; k++)
			p[k] = &m->position[3 * (size_t)m->index[3 * (size_t)t + (size_t)k]];
		for (int k = 0; k < 3; k++) {
			e[0][k] = (double)(p[1][k] - p[0][k]);
			e[1][k] = (double)(p[2][k] - p[0][k]);
			for (int i = 0; i < 3; i++) {
				look->low[k] = fmin(look->low[k], (double)p[i][k]);
				look->high[k] = fmax(look->high[k], (double)p[i][k]);
			}
		}
		for (int k = 0; k < 3; k++)
			n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
		double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		all += area;
		for (int k = 0; k < 3 && area > 0; k++) {
			double x = n[(k + 1) % 3] / area, y = n[(k + 2) % 3] / area, x2 = x * x - y * y, y2 = 2 * x * y;
			bool wall = fabs(n[k]) < ALONG * area, level = x * x + y * y < ALONG * ALONG;
			look->plane[k] += wall || level ? area : 0;
			walls[k] += wall ? area : 0;
			turn[k][0] += wall ? area * (x2 * x2 - y2 * y2) : 0;     /* four times the angle */
			turn[k][1] += wall ? area * 2 * x2 * y2 : 0;
		}
	}
	for (int k = 0; k < 3 && all > 0; k++) {
		look->plane[k] /= all;
		look->square[k] = walls[k] > 0 ? hypot(turn[k][0], turn[k][1]) / walls[k] : 0;
	}
}

static bool read_object(struct look *look, const char *path, struct eco_model *m)
{
	struct eco_error own = { .code = ECO_OK };
	*look = (struct look){ .low = { INFINITY, INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY, -INFINITY } };
	if (eco_model_import(m, &(struct eco_model_options){ .paths = &path, .path_count = 1, .object = true }, &own))
		return false;
	look_at_shape(look, m);
	look_at_name(look, eco_path_last(path));
	for (uint32_t i = 0; i < m->material_count; i++) {
		look_at_name(look, m->materials[i].name);
		look->cutout |= m->materials[i].cutout;
	}
	for (uint32_t i = 0; i < m->part_count; i++)
		look_at_name(look, m->parts[i].name);
	return true;
}

/* Why a model is none of a plant, by what is in it; "": it may be one. */
static void why_object(const struct look *look, char why[120])
{
	double plane = 0, wide = fmax(look->high[0] - look->low[0], look->high[1] - look->low[1]);
	bool square = wide > WIDE_M;
	for (int k = 1; k < 3; k++) {
		plane = fmax(plane, look->plane[k]);
		square |= look->square[k] > SQUARE_LEAST && look->plane[k] > PLANE_LEAST;
	}
	*why = 0;
	if (look->words[0] > look->words[1])
		snprintf(why, 120, "%d name%s of its file, materials and parts %s of buildings", look->words[0],
			look->words[0] == 1 ? "" : "s", look->words[0] == 1 ? "is" : "are");
	else if (!look->words[1] && !look->cutout && plane > PLANE_LEAST && square)
		snprintf(why, 120, "%.0f %% of its surface are walls and floors", 100 * plane);
}

/* ---- Files ---- */

/* An object's place waits for that of the trees. */
static bool take_file(struct start *s, const char *path)
{
	struct look look;
	struct eco_model m = { 0 };
	char why[120] = "";
	if (read_object(&look, path, &m))
		why_object(&look, why);
	if (*why && !eco_utf8_valid(path, strlen(path)))
		eco_stop(ECO_BAD_INPUT, "%.300s: a building, as %s; its name is no UTF-8, which a scene's names are: rename it", path, why);
	if (*why)
		json_array_append_new(s->objects, json_pack("{s:s, s:s, s:[f,f,f], s:[f,f,f], s:f, s:b}", "path", path, "why", why,
			"low", look.low[0], look.low[1], look.low[2], "high", look.high[0], look.high[1], look.high[2], "unit", m.scale,
			"doubt", m.source.up_how == ECO_HOW_CONVENTION && m.source.up == ECO_UP_Y));
	eco_model_free(&m);
	return *why;
}

static int is_model(const struct dirent *entry) { return start_is_model(entry->d_name); }

/* A folder is one of buildings if all of its models are. */
static bool take_folder(struct start *s, const char *path)
{
	struct dirent **entries = NULL;
	int count = scandir(path, &entries, is_model, alphasort), taken = 0;
	size_t before = json_array_size(s->objects);
	for (int i = 0; i < count; i++) {
		char *file = start_text("%s/%s", path, entries[i]->d_name);
		taken += taken == i && take_file(s, file);
		free(file);
		free(entries[i]);
	}
	free(entries);
	while (taken < count && json_array_size(s->objects) > before)
		json_array_remove(s->objects, before);
	return count > 0 && taken == count;
}

uint32_t start_objects(struct start *s, char **names, uint32_t count)
{
	uint32_t kept = 0;
	s->objects = json_array();
	for (uint32_t i = 0; i < count; i++)
		if (!(start_is_model(names[i]) ? take_file(s, names[i]) : take_folder(s, names[i])))
			names[kept++] = names[i];
	return kept;
}

/* ---- Places ---- */

static double number(const json_t *object, const char *key, int i)
{
	return json_real_value(json_array_get(json_object_get(object, key), (size_t)i));
}

/* Whether y of the file is up, or z, and whether its numbers count from the scene's origin or are the map's: what lies nearest
 * to the trees. Then as buildings have their lowest floor at the file's zero. */
struct stand { bool z_up, map; double at[2], low, away; };

static struct stand stand_of(const json_t *o, const double origin[2], bool z_up, bool map)
{
	struct stand s = { .z_up = z_up, .map = map, .low = z_up ? -number(o, "high", 1) : number(o, "low", 2) };
	double high = z_up ? -number(o, "low", 1) : number(o, "high", 2);
	s.at[0] = (number(o, "low", 0) + number(o, "high", 0)) / 2;
	s.at[1] = z_up ? (number(o, "low", 2) + number(o, "high", 2)) / 2 : (number(o, "low", 1) + number(o, "high", 1)) / 2;
	s.away = hypot(s.at[0] - (map ? origin[0] : 0), s.at[1] - (map ? origin[1] : 0)) +
		(fabs(s.low) > ZERO_NEAR * (high - s.low) ? high - s.low : 0);
	return s;
}

static void place(struct start *s, json_t *o)
{
	const char *path = json_string_value(json_object_get(o, "path"));
	struct stand best = stand_of(o, s->place.origin, false, false);
	char took[160];
	for (int i = 1; i < (json_is_true(json_object_get(o, "doubt")) ? 4 : 2); i++) {
		struct stand other = stand_of(o, s->place.origin, i & 2, i & 1);
		best = other.away < best.away ? other : best;
	}
	if (best.away > REACH_M)
		eco_stop(ECO_BAD_INPUT, "%.300s: a building, as %s; it lies %.0f km from the trees, in the scene's CRS and from its "
			"origin: in which CRS is it? Move it to the scene's", path, json_string_value(json_object_get(o, "why")),
			best.away / 1000);
	snprintf(took, sizeof took, "%.150s", path);
	start_guess(s, "building", took, "\"object\" and \"at\" in the scene", "%s; %s%s",
		json_string_value(json_object_get(o, "why")), best.map ? "its numbers are the map's, its lowest point stands on the ground" : "its zero stands at the scene's origin",
		best.z_up ? "; z points up, as it lies better so" : "");
	json_object_set_new(o, "z up", json_boolean(best.z_up));
	if (best.map) {
		double unit = json_real_value(json_object_get(o, "unit")), foot[2] = { floor(best.at[0]), floor(best.at[1]) };
		json_object_set_new(o, "foot", json_pack("[f,f,f]", foot[0] / unit, foot[1] / unit, best.low / unit));
		json_object_set_new(o, "at", json_pack("[f,f]", foot[0] - s->place.origin[0], foot[1] - s->place.origin[1]));
	}
}

void start_objects_place(struct start *s)
{
	size_t i;
	json_t *o;
	json_array_foreach(s->objects, i, o)
		place(s, o);
}

/* The start of a plant's name, from its model's file: as many whole characters as it has room for. */
static int name_bytes(const char *last)
{
	return (int)eco_utf8_cut(last, strcspn(last, "."), NAME_BYTES);
}

void start_objects_add(const struct start *s, json_t *plants, json_t *instances)
{
	size_t i;
	const json_t *o;
	json_array_foreach(s->objects, i, o) {
		const char *path = json_string_value(json_object_get(o, "path")), *last = eco_path_last(path);
		last += strspn(last, ".");
		char *seen = start_path(s, path), name[64];
		json_t *at = json_object_get(o, "at"), *foot = json_object_get(o, "foot");
		snprintf(name, sizeof name, "%.*s", name_bytes(last), last);
		for (unsigned n = 2; json_object_get(plants, name); n++)
			snprintf(name, sizeof name, "%.*s building %u", name_bytes(last), last, n);
		json_object_set_new(plants, name, json_pack("{s:s, s:b, s:s*, s:O*}", "model", seen, "object", 1, "up",
			json_is_true(json_object_get(o, "z up")) ? "z" : NULL, "foot", foot));
		json_array_append_new(instances, json_pack("{s:s, s:o}", "plant", name, "at", at ? json_incref(at) :
			json_pack("[i,i]", 0, 0)));
		free(seen);
	}
}
