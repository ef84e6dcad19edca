/* ecopack model: shows how import understood a model, for writing rules about its parts or finding out why
 * it looks wrong. It calls the functions that make calls; components have the numbers that rules use. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/grade.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/import/model/model_parts.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/scene/scene.h"

#define FILES_MAX 64u
#define SHOWN 20u                /* components listed */
#define NOTES_MAX 64u

struct seen {
	struct eco_model_options options;
	const char *unit, *up;       /* as given */
	struct eco_model model;
	struct eco_components components;
	uint8_t *organ;              /* per triangle; ECO_ORGAN_FOUND: covers nothing */
	double diagonal, light;      /* light: of foliage (grade.h) */
	char *notes[NOTES_MAX];
	uint32_t note_count;
};

static const char *organ_name(uint8_t organ)
{
	return organ < ECO_ORGAN_COUNT ? eco_organ_names[organ] : "-";
}

/* ---- Facts about the model ---- */

static void keep_note(void *ctx, const char *text)
{
	struct seen *s = ctx;
	if (s->note_count < NOTES_MAX && (s->notes[s->note_count] = strdup(text)))
		s->note_count++;
}

static void find_components(struct seen *s)
{
	uint32_t *place = eco_alloc(s->model.vertex_count, sizeof *place);
	struct eco_component all = { 0 };
	eco_model_places(&s->model, place);
	eco_components_find(&s->components, &s->model, place, true);
	free(place);
	for (uint32_t i = 0; i < s->components.count; i++)
		for (int k = 0; k < 3; k++) {
			all.low[k] = i ? fmin(all.low[k], s->components.items[i].low[k])
				: s->components.items[i].low[k];
			all.high[k] = i ? fmax(all.high[k], s->components.items[i].high[k])
				: s->components.items[i].high[k];
		}
	s->diagonal = eco_component_diagonal(&all);
}

static void note_light(struct seen *s)
{
	char text[200];
	s->light = grade_light(&s->model, s->organ);
	snprintf(text, sizeof text, "its foliage sends on %.0f %% of light, a leaf at most %.0f %%: \"grade\": true in "
		"SCENE.json darkens it", 100 * s->light, 100 * GRADE_MOST);
	if (s->light > GRADE_MOST)
		keep_note(s, text);
}

/* Area of each organ in component `which`; ECO_NONE: in all. */
static void organ_areas(const struct seen *s, uint32_t which, double area[ECO_ORGAN_COUNT])
{
	memset(area, 0, ECO_ORGAN_COUNT * sizeof *area);
	for (uint32_t t = 0; t < s->model.triangle_count; t++)
		if (s->organ[t] < ECO_ORGAN_COUNT && (which == ECO_NONE || s->components.of[t] == which))
			area[s->organ[t]] += eco_triangle_area(&s->model, t);
}

static uint8_t largest_organ(const double area[ECO_ORGAN_COUNT])
{
	uint8_t best = ECO_ORGAN_FOUND;
	for (uint8_t i = 0; i < ECO_ORGAN_COUNT; i++)
		if (area[i] > 0 && (best == ECO_ORGAN_FOUND || area[i] > area[best]))
			best = i;
	return best;
}

struct use { uint32_t triangles; double area, organ[ECO_ORGAN_COUNT]; };

/* Use of each material, or of each part. */
static struct use *uses_of(const struct seen *s, const uint32_t *of, uint32_t count)
{
	struct use *use = eco_alloc(count, sizeof *use);
	for (uint32_t t = 0; t < s->model.triangle_count; t++) {
		double area = eco_triangle_area(&s->model, t);
		use[of[t]].triangles++;
		use[of[t]].area += area;
		if (s->organ[t] < ECO_ORGAN_COUNT)
			use[of[t]].organ[s->organ[t]] += area;
	}
	return use;
}

static const char *part_of(const struct seen *s, uint32_t triangle)
{
	return s->model.part ? s->model.parts[s->model.part[triangle]].name : "";
}

static const char *how_text(enum eco_how how)
{
	switch (how) {
	case ECO_HOW_GIVEN: return "as you say";
	case ECO_HOW_FORMAT: return "as the file says";
	case ECO_HOW_SHAPE: return "by its shape";
	case ECO_HOW_CONVENTION: return "as is usual in this format";
	case ECO_HOW_GUESSED: return "guessed from its height";
	case ECO_HOW_HEIGHT: return "from the height you say";
	default: return "unknown";
	}
}

/* ---- As a plant of SCENE.json ---- */

static json_t *text_json(const char *text)
{
	json_t *value = json_string(text);
	return value ? value : json_string("(not UTF-8)");
}

/* The first file's name up to its first dot, as a plant's name. */
static void plant_name(const struct seen *s, char name[64])
{
	snprintf(name, 64, "%.63s", eco_path_last(s->options.paths[0]));
	char *dot = strrchr(name, '.');
	if (dot && dot != name)
		*dot = 0;
	eco_utf8_tame(name, "", '_');
}

/* The plant's entry, with the options given and the guesses made. */
static json_t *plant_json(const struct seen *s)
{
	json_t *plant = json_object();
	const struct eco_model_source *source = &s->model.source;
	if (s->options.path_count == 1) {
		json_object_set_new(plant, "model", text_json(s->options.paths[0]));
	} else {
		json_t *files = json_array();
		for (uint32_t i = 0; i < s->options.path_count; i++)
			json_array_append_new(files, text_json(s->options.paths[i]));
		json_object_set_new(plant, "model", files);
	}
	if (s->up || source->up_how == ECO_HOW_SHAPE || source->up_how == ECO_HOW_CONVENTION)
		json_object_set_new(plant, "up", json_string(eco_up_name(source->up)));
	if (s->unit)
		json_object_set_new(plant, "unit", json_string(s->unit));
	if (s->options.height_m > 0)
		json_object_set_new(plant, "height_m", json_real(s->options.height_m));
	else if (source->unit_how == ECO_HOW_GUESSED)
		json_object_set_new(plant, "height_m",
			json_real(round(eco_model_height(&s->model) * 1000) / 1000));
	return plant;
}

static void print_plant(const struct seen *s)
{
	char name[64];
	plant_name(s, name);
	json_t *plants = json_object();
	json_object_set_new(plants, name, plant_json(s));
	char *text = json_dumps(plants, JSON_REAL_PRECISION(6));
	if (text)
		printf("\"plants\": %s\n", text);
	free(text);
	json_decref(plants);
}

/* ---- Facts ---- */

static json_t *rgb_json(const uint8_t rgb[3])
{
	char text[8];
	snprintf(text, sizeof text, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
	return json_string(text);
}

static json_t *organs_json(const double area[ECO_ORGAN_COUNT])
{
	json_t *organs = json_object();
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		json_object_set_new(organs, eco_organ_names[i], json_real(area[i]));
	return organs;
}

static json_t *materials_json(const struct seen *s)
{
	const struct eco_model *m = &s->model;
	struct use *use = uses_of(s, m->material, m->material_count);
	json_t *all = json_array();
	for (uint32_t i = 0; i < m->material_count; i++) {
		const struct eco_material *material = &m->materials[i];
		json_t *one = json_pack("{s:o, s:o, s:I, s:f, s:o}", "name", text_json(material->name),
			"color", rgb_json(material->rgb), "triangles", (json_int_t)use[i].triangles,
			"area_m2", use[i].area, "organs_m2", organs_json(use[i].organ));
		if (material->image != ECO_NONE) {
			json_object_set_new(one, "texture",
				json_pack("[I,I]", (json_int_t)m->images[material->image].width,
				(json_int_t)m->images[material->image].height));
			json_object_set_new(one, "cutout", json_boolean(material->cutout));
		}
		json_array_append_new(all, one);
	}
	free(use);
	return all;
}

static json_t *parts_json(const struct seen *s)
{
	const struct eco_model *m = &s->model;
	struct use *use = m->part ? uses_of(s, m->part, m->part_count) : NULL;
	json_t *all = json_array();
	for (uint32_t i = 0; use && i < m->part_count; i++)
		json_array_append_new(all, json_pack("{s:o, s:I, s:f, s:o}", "name",
			text_json(m->parts[i].name), "triangles", (json_int_t)use[i].triangles, "area_m2",
			use[i].area, "organs_m2", organs_json(use[i].organ)));
	free(use);
	return all;
}

static json_t *components_json(const struct seen *s)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < s->components.count && i < SHOWN; i++) {
		const struct eco_component *c = &s->components.items[i];
		double area[ECO_ORGAN_COUNT];
		organ_areas(s, i, area);
		json_array_append_new(all, json_pack("{s:I, s:I, s:f, s:f, s:[f,f], s:s, s:o, s:o}",
			"component", (json_int_t)i + 1, "triangles", (json_int_t)c->triangle_count,
			"area_m2", c->area, "size",
			s->diagonal > 0 ? eco_component_diagonal(c) / s->diagonal : 0.0,
			"z_m", c->low[2], c->high[2], "organ", organ_name(largest_organ(area)),
			"material", text_json(s->model.materials[s->model.material[c->first]].name),
			"part", text_json(part_of(s, c->first))));
	}
	return all;
}

static json_t *facts_json(const struct seen *s)
{
	const struct eco_model *m = &s->model;
	double area[ECO_ORGAN_COUNT];
	json_t *dropped = json_object(), *notes = json_array();
	organ_areas(s, ECO_NONE, area);
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		json_object_set_new(dropped, eco_drop_names[i], json_integer(m->dropped[i]));
	for (uint32_t i = 0; i < s->note_count; i++)
		json_array_append_new(notes, text_json(s->notes[i]));
	return json_pack("{s:o, s:[f,f,f], s:f, s:f, s:f, s:s, s:s, s:s, s:[f,f,f], s:I, s:I, s:o, "
		"s:o, s:f, s:o, s:o, s:I, s:o, s:o, s:o}", "format", text_json(m->source.format),
		"size_m", m->source.size[0] * m->scale, m->source.size[1] * m->scale,
		m->source.size[2] * m->scale, "height_m", eco_model_height(m),
		"below_m", m->source.below * m->scale, "unit_m", m->scale,
		"unit", how_text(m->source.unit_how), "up", eco_up_name(m->source.up),
		"up_found", how_text(m->source.up_how), "foot", m->foot[0], m->foot[1], m->foot[2],
		"triangles_in", (json_int_t)m->triangles_in, "triangles_kept", (json_int_t)m->triangle_count,
		"triangles_dropped", dropped, "organs_m2", organs_json(area), "foliage_light", s->light,
		"materials", materials_json(s),
		"parts", parts_json(s), "component_count", (json_int_t)s->components.count,
		"components", components_json(s), "notes", notes, "plant", plant_json(s));
}

static void print_text(const struct seen *s, const json_t *facts)
{
	for (uint32_t i = 0; i < s->options.path_count; i++)
		printf("%s%s", i ? " + " : "", s->options.paths[i]);
	putchar('\n');
	inspect_lines(stdout, facts, "format size_m height_m below_m unit_m unit up up_found foot triangles_in "
		"triangles_kept triangles_dropped organs_m2 foliage_light component_count");
	inspect_table(stdout, NULL, json_object_get(facts, "materials"), "name color triangles area_m2 texture cutout");
	inspect_table(stdout, NULL, json_object_get(facts, "parts"), "name triangles area_m2");
	inspect_table(stdout, NULL, json_object_get(facts, "components"),
		"component triangles area_m2 size z_m organ material part");
	for (uint32_t i = 0; i < s->note_count; i++)
		printf("%s  note: %s\n", i ? "" : "\n", s->notes[i]);
	printf("\nIn SCENE.json:\n");
	print_plant(s);
	printf("and with rules about its parts, for example:\n  \"parts\": [{\"component\": 1, \"is\": "
		"\"left out\"}, {\"size\": "
		"[0, 0.01], \"is\": \"foliage\"}, "
		"{\"name\": \"%s\", \"is\": \"wood\"}]\n", s->model.materials[0].name[0]
		? s->model.materials[0].name : "bark*");
}

/* ---- The command ---- */

static struct { struct eco_inputs files; const char *unit, *up; double height_m; bool json, as_plant; } given;

static enum eco_code read_options(struct seen *s, struct eco_error *error)
{
	s->unit = given.unit;
	s->up = given.up;
	s->options.height_m = given.height_m;
	if (s->unit && !eco_unit_metres(s->unit, &s->options.unit_m))
		return eco_fail(error, ECO_BAD_USAGE, "--unit %.20s: unknown; units: " ECO_UNITS, s->unit);
	if (s->up && !eco_up_of(s->up, &s->options.up))
		return eco_fail(error, ECO_BAD_USAGE, "--up %.20s: x, y or z, the axis of the file that "
			"points up", s->up);
	s->options.paths = (const char *const *)given.files.names;
	s->options.path_count = given.files.count;
	s->options.warn = keep_note;
	s->options.ctx = s;
	return ECO_OK;
}

static enum eco_code see(struct seen *s, struct eco_error *error)
{
	main_progress("reading", eco_path_last(s->options.paths[0]), 0);
	enum eco_code code = eco_model_import(&s->model, &s->options, error);
	main_progress("looking at it", eco_path_last(s->options.paths[0]), 0.7);
	if (!code) {
		find_components(s);
		s->organ = grade_organs(&s->model);
		note_light(s);
	}
	main_progress_end();
	return code;
}

static enum eco_code run_model(int argc, char **argv, struct eco_error *error)
{
	struct seen *s = eco_alloc(1, sizeof *s);
	memset(&given, 0, sizeof given);
	enum eco_code code = main_read(&main_command_model, argc, argv, error);
	if (!code)
		code = read_options(s, error);
	if (!code)
		code = see(s, error);
	json_t *facts = code ? NULL : facts_json(s);
	if (!code && given.json) {
		json_dumpf(facts, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
		putchar('\n');
	} else if (!code && given.as_plant)
		print_plant(s);
	else if (!code)
		print_text(s, facts);
	json_decref(facts);
	for (uint32_t i = 0; i < s->note_count; i++) {
		if (code || (given.as_plant && !given.json))
			main_note("%s", s->notes[i]);
		free(s->notes[i]);
	}
	eco_components_free(&s->components);
	eco_model_free(&s->model);
	free(s->organ);
	free(s);
	return code;
}

static const struct eco_option options[] = {
	{ "the model file", 0, ECO_OPTION_INPUTS, "FILE", .value = &given.files, .high = FILES_MAX,
		.is_required = true },
	{ "unit", 0, ECO_OPTION_TEXT, "U", .value = &given.unit },
	{ "up", 0, ECO_OPTION_TEXT, "x|y|z", .value = &given.up },
	{ "height", 0, ECO_OPTION_NUMBER, "M", .value = &given.height_m, 0.001, 1000 },
	{ "json", 0, ECO_OPTION_FLAG, NULL, .value = &given.json },
	{ "as-plant", 0, ECO_OPTION_FLAG, NULL, .value = &given.as_plant }, { 0 }
};

const struct main_command main_command_model = { {
	"ecopack model", "FILE... [--unit U] [--up x|y|z] [--height M] [--json] [--as-plant]",
	"Prints the facts that import finds in a model, in the words of SCENE.json. Several files make one "
	"plant.",
	options, main_common, NULL, NULL }, run_model };
