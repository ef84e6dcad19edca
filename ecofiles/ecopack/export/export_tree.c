#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/version.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/ecopack/run.h"

#define DEPTH_MAX 256u
#define GROUND_ERROR 4.0
/* of a tile without content, which viewers must always look into: wider than the Earth */
#define NO_CONTENT_ERROR 2e7
#define SEMI_MAJOR_M 6378137.0           /* WGS 84 */
#define FLATTENING (1 / 298.257223563)

struct tree { struct export *x; uint8_t *nested; };      /* tiles that are roots of tilesets of their own */

/* ---- Volumes and places ---- */

static json_t *box_of(const double low[3], const double high[3])
{
	double c[3], h[3];
	for (int k = 0; k < 3; k++) {
		c[k] = (low[k] + high[k]) / 2;
		h[k] = fmax((high[k] - low[k]) / 2, 0.01);
	}
	return json_pack("{s:[f,f,f,f,i,i,i,f,i,i,i,f]}", "box", c[0], c[1], c[2], h[0], 0, 0, 0, h[1], 0, 0,
		0,
		h[2]);
}

/* From the scene, Z up and +Y the map's north, to the Earth's middle. null: nobody knows. */
static json_t *place_of(const struct export *x)
{
	json_t *matrix = json_array();
	const json_t *place = json_object_get(x->meta, "place");
	double degree = M_PI / 180, lon = json_number_value(json_object_get(place, "longitude_deg")) * degree,
		lat = json_number_value(json_object_get(place, "latitude_deg")) * degree,
		turn = json_number_value(json_object_get(place, "convergence_deg")) * degree,
		height = json_number_value(json_array_get(json_object_get(x->meta, "origin"), 2));
	const double east[3] = { -sin(lon), cos(lon), 0 },
		north[3] = { -sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat) },
		up[3] = { cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat) };
	double e2 = FLATTENING * (2 - FLATTENING), n = SEMI_MAJOR_M / sqrt(1 - e2 * sin(lat) * sin(lat));
	for (int column = 0; column < 4; column++)
		for (int k = 0; k < 4; k++) {
			double v = k == 3 ? column == 3 : column == 0
				? cos(turn) * east[k] - sin(turn) * north[k]
				: column == 1 ? sin(turn) * east[k] + cos(turn) * north[k] : column == 2
				? up[k]
				: (n * (k == 2 ? 1 - e2 : 1) + height) * up[k];
			json_array_append_new(matrix, json_real(v));
		}
	if (json_is_object(place))
		return matrix;
	json_decref(matrix);
	return NULL;
}

static json_t *transform_of(const struct eco_child *child)
{
	double yaw = child->turn * (2 * M_PI / 65536), s = (double)child->scale * sin(yaw),
		c = (double)child->scale * cos(yaw);
	return json_pack("[f,f,i,i,f,f,i,i,i,i,f,i,f,f,f,i]", c, s, 0, 0, -s, c, 0, 0, 0, 0,
		(double)child->scale, 0,
		child->at[0], child->at[1], child->at[2], 1);
}

static json_t *tile_of(json_t *volume, double error_m, const char *content)
{
	json_t *tile = json_pack("{s:o, s:f, s:s}", "boundingVolume", volume, "geometricError", error_m,
		"refine",
		"REPLACE");
	if (content)
		json_object_set_new(tile, "content", json_pack("{s:s}", "uri", content));
	return tile;
}

static void add_child(json_t *tile, json_t *child)
{
	if (!json_object_get(tile, "children"))
		json_object_set_new(tile, "children", json_array());
	json_array_append_new(json_object_get(tile, "children"), child);
}

static double error_of(const json_t *tile)
{
	return json_number_value(json_object_get(tile, "geometricError"));
}

/* ---- Plants ---- */

/* The plants of a tile: each level replaces the one before it. */
static void add_plants(struct tree *t, uint32_t id, json_t *parent)
{
	const struct eco_tile *tile = &t->x->pack->scene.tiles[id];
	uint32_t levels = 1;
	export_instances(t->x, id);
	for (uint32_t g = 0; g < tile->group_count; g++) {
		uint32_t own = t->x->plants[t->x->pack->scene.groups[tile->group_first + g].plant].levels;
		levels = own > levels ? own : levels;
	}
	for (uint32_t level = 0; level < levels; level++) {
		char name[EXPORT_NAME];
		double error_m;
		export_level(t->x, id, level, name, &error_m);
		t->x->tiles++;
		json_t *child = tile_of(box_of(tile->low, tile->high), error_m, name);
		add_child(parent, child);
		parent = child;
	}
}

static double diagonal_of(const struct eco_tile *tile)
{
	double size = 0;
	for (int k = 0; k < 3; k++)
		size += (tile->high[k] - tile->low[k]) * (tile->high[k] - tile->low[k]);
	return sqrt(size);
}

static void add_nested(struct tree *t, const struct eco_child *child, json_t *parent)
{
	const struct eco_tile *tile = &t->x->pack->scene.tiles[child->tile];
	char name[EXPORT_NAME];
	snprintf(name, sizeof name, "tileset-%u.json", child->tile);
	json_t *placed = tile_of(box_of(tile->low, tile->high), diagonal_of(tile), name);
	json_object_set_new(placed, "transform", transform_of(child));
	add_child(parent, placed);
	t->nested[child->tile] = 1;
}

/* No tile is better than its children. */
static json_t *add_tile(struct tree *t, uint32_t id, uint32_t depth)
{
	const struct eco_scene *s = &t->x->pack->scene;
	const struct eco_tile *tile = &s->tiles[id];
	char name[EXPORT_NAME];
	double error_m = 0;
	bool summary = tile->summary != ECO_NONE;
	if (depth > DEPTH_MAX)
		eco_stop(ECO_TOO_LARGE, "tiles lie in more than %u others", DEPTH_MAX);
	main_progress("writing tiles", NULL, (double)id / s->tile_count);
	if (summary)
		export_summary(t->x, id, name, &error_m);
	t->x->tiles++;
	json_t *out = tile_of(box_of(tile->low, tile->high), error_m, summary ? name : NULL);
	if (tile->group_count)
		add_plants(t, id, out);
	for (uint32_t i = tile->child_first; i < tile->child_first + tile->child_count; i++)
		if (s->children[i].placed)
			add_nested(t, &s->children[i], out);
		else
			add_child(out, add_tile(t, s->children[i].tile, depth + 1));
	const json_t *child;
	size_t i;
	json_array_foreach(json_object_get(out, "children"), i, child)
		error_m = fmax(error_m, error_of(child));
	json_object_set_new(out, "geometricError", json_real(error_m));
	return out;
}

/* ---- Ground ---- */

static void widen(double low[3], double high[3], const double other_low[3], const double other_high[3])
{
	for (int k = 0; k < 3; k++) {
		low[k] = fmin(low[k], other_low[k]);
		high[k] = fmax(high[k], other_high[k]);
	}
}

/* Contents are boxes of their own samples: a parent's holds its children's, too. NULL: the tile lies beyond
 * the rasters, as do those below it. */
static json_t *add_ground(struct tree *t, uint32_t id, double low[3], double high[3])
{
	const struct eco_ground_tile *ground = &t->x->pack->scene.ground[id];
	char name[EXPORT_NAME];
	json_t *children = json_array();
	export_ground(t->x, id, name, low, high);
	for (uint32_t i = 0; i < ground->child_count && *name; i++) {
		double below[2][3];
		json_t *child = add_ground(t, ground->child_first + i, below[0], below[1]);
		if (!child)
			continue;
		json_array_append_new(children, child);
		widen(low, high, below[0], below[1]);
	}
	double error_m = json_array_size(children) ? GROUND_ERROR * (double)ground->error_m : 0;
	json_t *out = *name ? tile_of(box_of(low, high), error_m, name) : NULL;
	t->x->tiles += *name != 0;
	if (json_array_size(children))
		json_object_set(out, "children", children);
	json_decref(children);
	return out;
}

/* ---- Tilesets ---- */

/* Plants and ground below one root. */
static json_t *with_ground(struct tree *t, const struct eco_tile *plants, json_t *root)
{
	double low[3], high[3];
	json_t *ground = add_ground(t, 0, low, high);
	widen(low, high, plants->low, plants->high);
	json_t *both = tile_of(box_of(low, high), NO_CONTENT_ERROR, NULL);
	add_child(both, root);
	add_child(both, ground);
	return both;
}

static void write_tileset(struct tree *t, uint32_t id, const char *name)
{
	const struct eco_scene *s = &t->x->pack->scene;
	const struct eco_tile *tile = &s->tiles[id];
	bool outer = id == s->root;
	json_t *root = add_tile(t, id, 0), *place = outer ? place_of(t->x) : NULL;
	if (outer && s->ground_count)
		root = with_ground(t, tile, root);
	if (place)
		json_object_set_new(root, "transform", place);
	export_json(t->x, name, json_pack("{s:{s:s, s:s}, s:f, s:o}", "asset", "version", "1.1", "generator",
		"ecopack " ECO_VERSION, "geometricError", fmax(diagonal_of(tile), error_of(root)), "root", root));
}

/* Nested files have greater numbers than what nests them. */
void export_tilesets(struct export *x)
{
	const struct eco_scene *s = &x->pack->scene;
	struct tree t = { x, eco_alloc(s->tile_count, 1) };
	write_tileset(&t, s->root, "tileset.json");
	for (uint32_t i = 0; i < s->tile_count; i++) {
		char name[EXPORT_NAME];
		snprintf(name, sizeof name, "tileset-%u.json", i);
		if (t.nested[i])
			write_tileset(&t, i, name);
	}
	free(t.nested);
}
