/* META: facts for people and `ecopack info` that the tables do not have, such as the models' files and
 * dropped triangles by reason. */
#include "ecofiles/ecopack/make.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/version.h"
#include "ecofiles/import/places/crs.h"
#include "lod/build/grid.h"

static json_t *dropped_json(const struct make_plant *plant)
{
	json_t *reasons = json_object();
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		if (plant->built.dropped[i])
			json_object_set_new(reasons, eco_drop_names[i], json_integer(plant->built.dropped[i]));
	return reasons;
}

static json_t *organs_json(const struct make_plant *plant)
{
	json_t *organs = json_object();
	for (int i = 0; i < ECO_ORGAN_COUNT; i++) {
		const struct lod_organ_stats *s = &plant->built.organ[i];
		if (s->triangles == 0 && s->elements == 0)
			continue;
		json_object_set_new(organs, eco_organ_names[i],
			json_pack("{s:I, s:I, s:I, s:f}", "components", (json_int_t)s->components,
			"elements", (json_int_t)s->elements, "triangles", (json_int_t)s->triangles, "area_m2",
			floor(s->area * 1e6 + 0.5) / 1e6));
	}
	return organs;
}

/* Bits of the plant's largest extent on its finest grid. */
static uint32_t grid_bits(const struct make_plant *plant)
{
	double extent = fmax(2 * plant->reach, plant->high - plant->low), step = extent;
	uint32_t bits = 0;
	for (uint32_t i = 0; i < plant->built.list_count; i++)
		for (int axis = 0; axis < 3; axis++)
			step = fmin(step, plant->built.lists[i].list.grid_step[axis]);
	while (bits < 31 && ldexp(step, (int)bits) < extent)
		bits++;
	return bits;
}

/* The distance beyond which rounding to grids moves nothing by more than half a pixel. */
static double half_a_pixel_m(const struct lod_plant *plant)
{
	double most = 0;
	for (uint32_t i = 0; i < plant->list_count; i++)
		if (plant->lists[i].list.kind == ECO_LIST_TRIANGLES || plant->lists[i].list.kind
				== ECO_LIST_LINES)
			most = fmax(most, lod_grid_nearest_m(&plant->lists[i].list, LOD_GRID_PIXEL_RAD));
	return most;
}

/* The number of a plant's searches that converged before their bound. */
static json_t *searches_json(const struct lod_plant *plant)
{
	json_t *searches = json_object();
	for (int i = 0; i < LOD_SOLVER_COUNT; i++)
		if (plant->solved[i].runs)
			json_object_set_new(searches, lod_solver_names[i],
				json_pack("{s:I, s:I}", "runs", (json_int_t)plant->solved[i].runs,
				"converged", (json_int_t)plant->solved[i].converged));
	return searches;
}

static json_t *plant_json(const struct make_plant *plant)
{
	return json_pack("{s:s, s:s, s:f, s:I, s:I, s:o, s:o, s:I, s:f, s:o, s:[f,f,f], s:f}", "name",
		plant->name, "model", basename(plant->path),
		"height_m", floor((double)plant->built.plant.height_m * 1e4 + 0.5) / 1e4, "triangles_in",
		(json_int_t)plant->built.triangles_in,
		"triangles_stored", (json_int_t)plant->built.triangles_stored, "dropped", dropped_json(plant),
		"organs", organs_json(plant),
		"grid_bits", (json_int_t)grid_bits(plant), "half_a_pixel_m",
		floor(half_a_pixel_m(&plant->built) * 1e4 + 0.5) / 1e4,
		"searches", searches_json(&plant->built), "foot", plant->foot[0], plant->foot[1],
		plant->foot[2], "scale", plant->scale);
}

static json_t *rows_json(const struct make *m)
{
	json_t *skipped = json_object();
	uint64_t rows = 0;
	for (int k = 0; k < ECO_SKIP_COUNT; k++) {
		uint64_t count = 0;
		for (uint32_t s = 0; s < m->sources.count; s++)
			count += m->ecos[s].skipped[k].count;
		if (count)
			json_object_set_new(skipped, eco_skip_names[k], json_integer((json_int_t)count));
	}
	for (uint32_t s = 0; s < m->sources.count; s++)
		rows += m->ecos[s].rows;
	return json_pack("{s:I, s:o}", "read", (json_int_t)rows, "skipped", skipped);
}

const char *make_ground_origin(const struct make *m)
{
	return m->ground_through ? MAKE_GROUND_THROUGH : m->has_ground ? "rasters" : "none";
}

/* The origin's place on Earth; null without a CRS that PROJ knows. */
static json_t *place_json(const struct eco_source *outer)
{
	struct eco_crs_place place;
	struct eco_error unknown = { 0 };
	enum eco_code code = outer->crs ? eco_crs_place(outer->crs, outer->origin, &place, &unknown) : ECO_NOT_FOUND;
	if (code == ECO_NO_MEMORY)
		eco_end("no memory");
	if (code)
		return json_null();
	return json_pack("{s:f, s:f, s:f}", "longitude_deg", place.longitude_deg, "latitude_deg",
		place.latitude_deg, "convergence_deg", place.convergence_deg);
}

json_t *make_meta(const struct make *m)
{
	const struct eco_source *outer = &m->sources.items[0];
	json_t *plants = json_array(), *root;
	for (uint32_t i = 0; i < m->plant_count; i++)
		json_array_append_new(plants, plant_json(&m->plants[i]));
	make_species_say(m, plants);
	root = json_pack("{s:s, s:s, s:s, s:o, s:[f,f,f], s:o, s:I, s:I, s:I, s:s, s:I, s:o, s:o}",
		"generator",
		"ecopack " ECO_VERSION, "order", lod_order_names[m->options->order], "name", outer->name,
		"crs", outer->crs ? json_string(outer->crs) : json_null(), "origin", outer->origin[0],
		outer->origin[1], outer->origin[2], "place", place_json(outer), "eco_files",
		(json_int_t)m->sources.count, "instances",
		(json_int_t)m->ecos[0].instances, "tiles", (json_int_t)m->scene.tile_count, "ground",
		make_ground_origin(m), "off_ground", (json_int_t)m->off_ground, "rows", rows_json(m),
		"plants", plants);
	if (m->options->draft)
		json_object_set_new(root, "draft", json_true());
	return root;
}
