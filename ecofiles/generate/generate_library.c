/* The library's plants: which habit and look a genus has in a season, and the model that comes of them. */
#include "ecofiles/generate/library.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/looks.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/generate/generate_growth.h"
#include "ecofiles/import/model/model_parts.h"
#include "ecofiles/import/places/words.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))
#define FRESH 0x9cbc54u    /* leaves that have just unfolded */
#define WITHERED 0xac8438u /* autumn of most genera */
#define STRAW 0xb8a070u    /* herbs in winter */
#define SLENDER_LEAST 0.02 /* width of a crown as a share of its height */
#define SLENDER_MOST 20.0
#define SHRUB_MOST_M 4.0     /* usual height of habits that shrubs may have: a juniper */

const char *const eco_season_names[ECO_SEASON_COUNT + 1] = { "summer", "autumn", "winter", "spring", NULL };

/* ---- Habits ---- */

/* False: no such habit; *number is then their count. */
static bool find_habit(const char *name, size_t *number, struct eco_habit *habit)
{
	for (*number = 0; eco_library_habit(*number, habit); ++*number)
		if (strcmp(habit->name, name) == 0)
			return true;
	return false;
}

/* The habit that a plant of this one has at a height, older or younger. */
static void find_age(double height_m, size_t *number, struct eco_habit *habit)
{
	struct eco_habit other;
	while (habit->grown && height_m > habit->most_m)
		find_habit(habit->grown, number, habit);
	for (size_t i = 0; height_m < habit->least_m && eco_library_habit(i, &other); i++)
		if (other.grown && strcmp(other.grown, habit->name) == 0) {
			*number = i;
			*habit = other;
		}
}

double eco_library_crown(const struct eco_habit *habit, double height_m)
{
	return fmin(habit->young_m + habit->crown * height_m, habit->widest_m);
}

double eco_library_height(const char *name)
{
	struct eco_habit habit;
	size_t number;
	return find_habit(name, &number, &habit) ? habit.height_m : 0;
}

/* The row of a species, else of its genus, else of a form, else the first. */
static const struct looks_row *look_of(const struct eco_flora *flora, enum eco_form form)
{
	char species[ECO_WORDS_BYTES] = "";
	if (flora)
		snprintf(species, sizeof species, "%s %s", flora->genus ? flora->genus : "", flora->epithet);
	const char *const names[] = { species, flora && flora->genus ? flora->genus : "", eco_form_names[form] };
	for (size_t k = 0; k < 3; k++)
		for (size_t i = 0; i < COUNT(looks_rows); i++)
			if (strcmp(looks_rows[i].taxon, names[k]) == 0)
				return &looks_rows[i];
	return looks_rows;
}

const char *eco_library_taxon_of(const struct eco_flora *flora)
{
	const struct looks_row *row = look_of(flora, ECO_FORM_UNKNOWN);
	return strchr(row->taxon, ' ') && flora->genus ? row->taxon : flora->genus ? flora->genus : "";
}

/* Plants grow as their row says, but for columns, weeping trees and shrubs of genera that mostly do not. */
const char *eco_library_habit_of(const struct eco_flora *flora)
{
	struct eco_habit habit;
	size_t number;
	enum eco_form form = flora->form < ECO_FORM_NOTHING ? flora->form : ECO_FORM_UNKNOWN;
	const struct looks_row *row = look_of(flora, form);
	find_habit(row->habit, &number, &habit);
	bool other = form == ECO_FORM_COLUMN || form == ECO_FORM_WEEPING || form == ECO_FORM_SHRUB;
	if (other && habit.like != form &&
		(form != ECO_FORM_SHRUB || (eco_form_is_tree(habit.like) && habit.height_m > SHRUB_MOST_M)) &&
		!(form == ECO_FORM_COLUMN && habit.like == ECO_FORM_CONIFER))
		find_habit(look_of(NULL, form)->habit, &number, &habit);
	return habit.name;
}

/* ---- Looks ---- */

static uint32_t rgb_of(const char *text)
{
	return (uint32_t)strtoul(text + 1, NULL, 16);
}

static bool is_given(const char *color)
{
	return color[0] == '#';
}

/* The look of leaves in a season; herbs and grasses that are deciduous or yellow stay as straw. */
static void set_season(struct gen_plant_look *look, const struct looks_row *row, bool deciduous, bool woody,
	enum eco_season season)
{
	if (season == ECO_SEASON_SPRING)
		look->leaf = gen_mixed(look->leaf, FRESH, deciduous ? 45 : 12, 100);
	if (season == ECO_SEASON_AUTUMN && (deciduous || is_given(row->autumn))) {
		look->leaf = is_given(row->autumn) ? rgb_of(row->autumn) : WITHERED;
		look->is_motley = true;
	}
	if (season == ECO_SEASON_WINTER && !woody && (deciduous || is_given(row->autumn)))
		look->leaf = STRAW;
	look->is_bare = season == ECO_SEASON_WINTER && woody && deciduous;
	if (eco_words_have(row->blooms, eco_season_names[season]))
		look->flowers = row->share;
}

static struct gen_plant_look make_look(const struct eco_library_plant *plant, const struct eco_habit *habit)
{
	struct eco_flora flora = eco_flora_of(plant->genus, NULL);
	const struct looks_row *row = look_of(&flora, habit->like);
	bool woody = habit->like != ECO_FORM_HERB && habit->like != ECO_FORM_GRASS;
	enum eco_leaf leaf = flora.genus                                          ? flora.leaf
		: habit->like == ECO_FORM_CONIFER || habit->like == ECO_FORM_PALM ? ECO_LEAF_EVERGREEN
										  : ECO_LEAF_DECIDUOUS;
	struct gen_plant_look look = { .bark = rgb_of(row->bark),
		.leaf = rgb_of(row->leaf),
		.slim = row->slim,
		.flower =
			is_given(row->blossom) ? rgb_of(row->blossom) : gen_mixed(rgb_of(row->leaf), STRAW, 60, 100) };
	look.shape = eco_flora_leaf(flora.genus, habit->like, &look.leaf_cm);
	if (row->leaf_cm > 0)
		look.leaf_cm = row->leaf_cm;
	if (row->leaf_cm > 0 && row->slim > 0 && strcmp(look.shape, "compound") != 0)
		look.slim = row->slim;
	set_season(&look, row, leaf == ECO_LEAF_DECIDUOUS, woody, plant->season);
	return look;
}

/* ---- Plants ---- */

enum eco_code eco_library_check(const struct eco_library_plant *plant, struct eco_error *error)
{
	struct eco_habit habit;
	size_t number;
	char known[480] = "";         /* what fits a message with its place */
	if (!find_habit(plant->habit, &number, &habit)) {
		for (size_t i = 0; eco_library_habit(i, &habit); i++)
			eco_phrase_add(known, sizeof known, habit.name);
		return eco_fail(error, ECO_BAD_INPUT, "no habit \"%.24s\" in the library: %s", plant->habit, known);
	}
	if (!(plant->height_m >= ECO_LIBRARY_LEAST_M && plant->height_m <= ECO_LIBRARY_MOST_M))
		return eco_fail(error, ECO_BAD_INPUT, "%s, %g m high: a plant of the library is %g to %g m high",
			habit.name, plant->height_m, ECO_LIBRARY_LEAST_M, ECO_LIBRARY_MOST_M);
	if (plant->crown_m != 0 && !(plant->crown_m >= SLENDER_LEAST * plant->height_m &&
			plant->crown_m <= SLENDER_MOST * plant->height_m))
		return eco_fail(error, ECO_BAD_INPUT, "%s, %g m high with a crown of %g m: a crown is %g to %g times as "
			"wide as its plant is high", habit.name, plant->height_m, plant->crown_m, SLENDER_LEAST, SLENDER_MOST);
	if (!(plant->base >= 0 && plant->base <= ECO_LIBRARY_BASE_MOST))
		return eco_fail(error, ECO_BAD_INPUT, "%s with a crown from %g of its height on: it begins at 0 to %g",
			habit.name, plant->base, ECO_LIBRARY_BASE_MOST);
	if (plant->individual > ECO_LIBRARY_INDIVIDUALS)
		return eco_fail(error, ECO_BAD_INPUT, "individual %u: there are %u", plant->individual,
			ECO_LIBRARY_INDIVIDUALS);
	if ((unsigned)plant->season >= ECO_SEASON_COUNT)
		return eco_fail(error, ECO_BAD_INPUT, "season %u: there are %u", (unsigned)plant->season,
			(unsigned)ECO_SEASON_COUNT);
	return ECO_OK;
}

/* The same skeleton in all seasons. */
static uint64_t seed_of(const struct eco_library_plant *plant)
{
	uint64_t seed = (plant->individual ? plant->individual : 1) * 0x9E3779B97F4A7C15u +
		(uint64_t)(plant->height_m * 100 + 0.5);
	for (const char *c = plant->habit; *c; c++)
		seed = seed * 131 + (unsigned char)*c;
	for (const char *c = plant->genus; *c; c++)
		seed = seed * 131 + ((unsigned char)*c | 32u);
	return seed;
}

static float tidy(double v)
{
	return (float)(floor(v * 10000 + 0.5) / 10000);
}

static void add_triangle(struct eco_model *model, const uint32_t corner[3], uint32_t material, uint8_t organ)
{
	uint32_t t = model->triangle_count;
	model->triangles_in++;
	memcpy(model->index + 3 * (size_t)t, corner, 3 * sizeof *corner);
	if (!(eco_triangle_area(model, t) > 0)) {
		model->dropped[ECO_DROP_DEGENERATE]++;
		return;
	}
	model->material[t] = material;
	model->organ[t] = organ;
	model->triangle_count++;
}

static void take_mesh(struct eco_model *model, const struct gen_mesh *mesh, const uint8_t organ[],
	const struct gen_spray sprays[2])
{
	model->position = eco_alloc(mesh->count, 3 * sizeof *model->position);
	model->index = eco_alloc(2 * (size_t)mesh->face_count, 3 * sizeof *model->index);
	model->material = eco_alloc(2 * (size_t)mesh->face_count, sizeof *model->material);
	model->organ = eco_alloc(2 * (size_t)mesh->face_count, sizeof *model->organ);
	model->materials = eco_alloc(mesh->material_count, sizeof *model->materials);
	model->vertex_count = mesh->count;
	model->material_count = mesh->material_count;
	for (uint32_t i = 0; i < mesh->count; i++) {
		float *p = model->position + 3 * (size_t)i;
		p[0] = tidy(mesh->position[i].x);
		p[1] = tidy(mesh->position[i].y);
		p[2] = tidy(mesh->position[i].z);
	}
	model->uv = sprays[0].leaves > 0 ? eco_alloc(mesh->count, 2 * sizeof *model->uv) : NULL;
	model->images = eco_alloc(2, sizeof *model->images);
	for (uint32_t i = 0; i < mesh->count && model->uv; i++) {
		model->uv[2 * (size_t)i] = mesh->uv[i][0];
		model->uv[2 * (size_t)i + 1] = 1 - mesh->uv[i][1];
	}
	for (uint32_t i = 0; i < mesh->material_count; i++) {
		struct eco_material *m = &model->materials[i];
		uint32_t is_flower = organ[i] == ECO_ORGAN_FLOWER;
		snprintf(m->name, sizeof m->name, "%s", mesh->materials[i].name);
		memcpy(m->rgb, mesh->materials[i].rgb, sizeof m->rgb);
		m->cutout = mesh->materials[i].texture && sprays[is_flower].leaves > 0;
		m->image = m->cutout ? model->image_count++ : ECO_NONE;
		if (m->cutout)
			gen_spray_paint(&model->images[m->image], &sprays[is_flower]);
	}
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		const struct gen_face *face = &mesh->faces[f];
		for (uint32_t k = 2; k < face->corners; k++)
			add_triangle(model,
				(uint32_t[]){ face->corner[0], face->corner[k - 1], face->corner[k] },
				face->material, organ[face->material]);
	}
}

enum eco_code eco_library_make(struct eco_model *model, const struct eco_library_plant *plant,
	struct eco_error *error)
{
	struct eco_habit habit;
	size_t number;
	struct gen_mesh mesh = { 0 };
	uint8_t organ[GEN_MATERIALS_MAX];
	struct gen_spray sprays[2];
	struct eco_library_plant sized = *plant;
	enum eco_code code = eco_library_check(plant, error);
	if (code)
		return code;
	find_habit(plant->habit, &number, &habit);
	find_age(plant->height_m, &number, &habit);
	if (sized.crown_m == 0)
		sized.crown_m = eco_library_crown(&habit, sized.height_m);
	struct gen_plant_look look = make_look(plant, &habit);
	gen_habit_grow(&mesh, organ, sprays, number, &sized, &look, seed_of(plant));
	*model = (struct eco_model){ .scale = 1,
		.source = { .up = ECO_UP_Z,
			.up_how = ECO_HOW_GIVEN,
			.unit_m = 1,
			.unit_how = ECO_HOW_GIVEN,
			.size = { sized.crown_m, sized.crown_m, sized.height_m } } };
	snprintf(model->source.format, sizeof model->source.format, "library");
	take_mesh(model, &mesh, organ, sprays);
	gen_mesh_free(&mesh);
	return ECO_OK;
}
