/* What of a scene can hardly be meant: sizes that no such plant has, ground that no land is. Nothing is
 * changed for it; each is a line that says what to add. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/phrase.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/size_units.h"

#define STEEP 3.0 /* metres up for one across: one slope in ten of a real DEM is never so steep */
#define SLOPES 65536u

/* ---- Plants ---- */

/* By the plant's name; of a name that says nothing, by its first file's. */
static struct eco_flora flora_of(const struct make_plant *plant)
{
	struct eco_flora flora = eco_flora_of(plant->source->name, false);
	return flora.genus || flora.form != ECO_FORM_UNKNOWN ? flora
		: eco_flora_of(eco_path_last(plant->source->models[0]), false);
}

static void doubt_height(const struct make *m, uint32_t id, double middle_m, uint64_t count)
{
	const struct make_plant *plant = &m->plants[id];
	struct eco_flora flora = flora_of(plant);
	struct eco_form_size usual = eco_form_size(flora.form);
	char number[32];
	if (middle_m >= usual.least_m && middle_m <= usual.most_m)
		return;
	main_note("%s: half of its %s plants are %s %.3g m high, where a %s has %.3g to %.3g m; is the "
		"unit of its model or of its heights another? (\"height_m\" or \"unit\" of the plant says "
		"it)", plant->name,
		eco_phrase_count(count, number), middle_m > usual.most_m ? "more than" : "less "
			"than", middle_m,
		eco_form_names[flora.form], usual.least_m, usual.most_m);
}

static void doubt_plant(const struct make *m, uint32_t id, struct eco_spread *heights)
{
	const struct make_plant *plant = &m->plants[id];
	if (heights->seen > 0 && flora_of(plant).form == ECO_FORM_NOTHING)
		main_note("%s: by its name it is no plant; rocks and stumps take vertices from the "
			"plants", plant->name);
	else if (heights->seen > 0 && plant->source->height_m == 0)
		doubt_height(m, id, eco_spread_quantile(heights, 0.5), heights->seen);
}

/* Without memory there is no doubt. */
void make_doubt_plants(const struct make *m)
{
	struct eco_spread *heights = calloc(m->plant_count + 1u, sizeof *heights);
	for (uint32_t s = 0; heights && s < m->sources.count; s++)
		for (uint32_t i = 0; i < m->ecos[s].place_count; i++) {
			const struct make_place *place = &m->ecos[s].places[i];
			eco_spread_add(&heights[place->plant],
				place->scale * (double)m->plants[place->plant].built.plant.height_m);
		}
	for (uint32_t i = 0; heights && i < m->plant_count; i++) {
		doubt_plant(m, i, &heights[i]);
		eco_spread_free(&heights[i]);
	}
	free(heights);
}

/* ---- Ground ---- */

void make_doubt_ground(const struct make *m)
{
	const struct eco_ground *g = &m->ground;
	const struct eco_ground_source *source = &m->sources.items[0].ground;
	struct eco_spread slopes = { 0 };
	uint32_t across = g->columns - 1 - 2 * g->margin, up = g->rows - 1 - 2 * g->margin;      /* inside */
	uint64_t cells = (uint64_t)across * up;
	for (uint64_t i = 0; i < cells; i += cells / SLOPES + 1) {
		size_t at = (size_t)(g->margin + i / across) * g->columns + (size_t)(g->margin + i % across);
		double east = (double)(g->height_m[at + 1] - g->height_m[at]) / g->step_x_m,
			north = (double)(g->height_m[at + g->columns] - g->height_m[at]) / g->step_y_m;
		eco_spread_add(&slopes, hypot(east, north));
	}
	double steep = eco_spread_quantile(&slopes, 0.9);
	eco_spread_free(&slopes);
	if (steep > STEEP && source->unit_m == 0)
		main_note("%s: one slope in ten rises more than %.3g m on a metre, as no land does; are "
			"its heights in another unit? (\"ground\": {\"unit\": \"cm\"} or \"scale\" says "
			"it)", source->heights[0], steep);
}
