#include "client-min/view_geojson.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/json_read.h"
#include "ecofiles/base/module.h"

#define DIGITS 12 /* of numbers: a degree's ninth is a tenth of a millimetre */
#define TEXT_BYTES 256

struct seen {
	uint32_t instance;
	uint64_t pixels;
	double at[2];
	json_t *said;                /* openapi.yaml's Plants; NULL: not asked for */
};

static double rounded(double value, double step)
{
	return round(value / step) * step;
}

/* ---- What is seen ---- */

static int by_pixels(const void *a, const void *b)
{
	const struct seen *x = a, *y = b;
	if (x->pixels != y->pixels)
		return x->pixels > y->pixels ? -1 : 1;
	return x->instance < y->instance ? -1 : x->instance > y->instance;
}

/* Instances that are seen come first; *count: their number. *others: pixels of what is no instance. */
static enum eco_code find_seen(const struct view_geojson_job *job, struct seen *seen, uint32_t *count,
	uint64_t *others, struct eco_error *error)
{
	const struct view_selection *s = job->selection;
	const struct view_picture *picture = job->picture;
	struct view_table owners;
	if (!view_owners_make(&owners, s)) {
		view_table_free(&owners);
		return eco_no_memory(error, "the plants of a view");
	}
	for (uint32_t i = 0; i < s->instance_count; i++)
		seen[i].instance = i;
	for (size_t i = 0; i < (size_t)picture->width * picture->height; i++) {
		const struct view_instance *one = view_owners_find(&owners, s, picture->owner[i]);
		if (picture->owner[i])
			++*(one ? &seen[one - s->instances].pixels : others);
	}
	view_table_free(&owners);
	qsort(seen, s->instance_count, sizeof *seen, by_pixels);
	for (*count = 0; *count < s->instance_count && seen[*count].pixels;)
		++*count;
	return ECO_OK;
}

static enum eco_code place(const struct view_geojson_job *job, struct seen *seen, uint32_t count,
	struct eco_error *error)
{
	double (*places)[2] = calloc(count + 1u, sizeof *places);
	enum eco_code code = places ? ECO_OK : eco_no_memory(error, "places");
	for (uint32_t i = 0; i < count && !code; i++)
		for (int k = 0; k < 2; k++)
			places[i][k] =
				job->map->at[k] + job->selection->instances[seen[i].instance].place.at[k];
	if (!code && *job->map->crs) {
		const struct eco_proj_module *proj = eco_module(ECO_MODULE_PROJ, error);
		code = proj ? proj->crs_degrees(job->map->crs, places, count, error) : ECO_NOT_FOUND;
	}
	for (uint32_t i = 0; i < count && !code; i++)
		memcpy(seen[i].at, places[i], sizeof seen[i].at);
	free(places);
	return code;
}

/* ---- What is said of it ---- */

static void say_roles(const struct view_selection *s, uint32_t instance, char text[TEXT_BYTES])
{
	uint32_t said = 0;
	size_t used = 0;
	text[0] = 0;
	for (uint32_t i = s->cut_first[instance]; i < s->cut_first[instance + 1]; i++) {
		uint8_t role = s->roles[s->cuts[i]];
		if (!(said & 1u << role) && used < TEXT_BYTES)
			used += (size_t)snprintf(text + used, TEXT_BYTES - used, "%s%s", used ? ", " : "",
				view_role_names[role]);
		said |= 1u << role;
	}
}

#define TOGETHER 1024u /* plants that a server says at a time */

static int by_list(const void *a, const void *b, void *ctx)
{
	const struct view_selection *s = ctx;
	const struct view_instance *x = &s->instances[(*(struct seen *const *)a)->instance],
		*y = &s->instances[(*(struct seen *const *)b)->instance];
	if (x->list != y->list)
		return x->list < y->list ? -1 : 1;
	return x->index < y->index ? -1 : x->index > y->index;
}

/* Asks for plants of one list, all within TOGETHER of the first: {species, plant, file, row, line} of
 * openapi.yaml's Plants. */
static enum eco_code ask_together(const struct view_geojson_job *job, struct seen **seen, uint32_t count,
	struct eco_error *error)
{
	const struct view_instance *all = job->selection->instances, *first = &all[seen[0]->instance];
	char *text;
	enum eco_code code = view_fetch_plants(job->fetch, view_store_pack(job->store), first->list,
		first->index,
		all[seen[count - 1]->instance].index - first->index + 1, &text, error);
	if (code)
		return code;
	json_t *answer = json_loads(text, 0, NULL), *plants = json_object_get(answer, "plants");
	free(text);
	for (uint32_t i = 0; i < count && !code; i++) {
		uint32_t index = all[seen[i]->instance].index;
		seen[i]->said = json_incref(json_array_get(plants, index - first->index));
		if (!json_is_object(seen[i]->said))
			code = eco_fail(error, ECO_BAD_INPUT,
				"the server says nothing of plant %u of list %u, which "
				"it sent", index, first->list);
	}
	json_decref(answer);
	return code;
}

/* On failure some may have been said. */
static enum eco_code ask(const struct view_geojson_job *job, struct seen *seen, uint32_t count,
	struct eco_error *error)
{
	const struct view_instance *all = job->selection->instances;
	struct seen **sorted = calloc(count + 1u, sizeof *sorted);
	enum eco_code code = sorted ? ECO_OK : eco_no_memory(error, "rows of plants");
	for (uint32_t i = 0; i < count && !code; i++)
		sorted[i] = &seen[i];
	if (!code)
		qsort_r(sorted, count, sizeof *sorted, by_list, (void *)job->selection);
	for (uint32_t i = 0, end; i < count && !code && job->fetch; i = end) {
		const struct view_instance *first = &all[sorted[i]->instance];
		for (end = i + 1; end < count && all[sorted[end]->instance].list == first->list
				&& all[sorted[end]->instance].index - first->index < TOGETHER;)
			end++;
		code = ask_together(job, sorted + i, end - i, error);
	}
	free(sorted);
	return code;
}

/* False: no memory. */
static bool set_row(json_t *properties, const json_t *said)
{
	static const char *const names[] = { "species", "plant", "file", "row", "line" };
	bool good = true;
	for (size_t i = 0; i < sizeof names / sizeof *names && good; i++) {
		json_t *value = json_object_get(said, names[i]);
		good = !json_object_set_new(properties, names[i], value ? json_incref(value) : json_null());
	}
	return good;
}

static json_t *feature_of(const struct view_geojson_job *job, const struct seen *seen)
{
	const struct view_instance *one = &job->selection->instances[seen->instance];
	const struct view_plant *plant = view_store_plant(job->store, one->plant);
	const char *name = plant ? plant->plant.name : "";
	double height_m = plant ? plant->plant.height_m * one->place.scale : 0;
	const double *at = one->place.at, step = *job->map->crs ? 1e-9 : 1e-4;
	char roles[TEXT_BYTES];
	say_roles(job->selection, seen->instance, roles);
	json_t *properties = json_pack("{s:s, s:s, s:f, s:I, s:f, s:s, s:[f,f,f]}", "species", name,
		"plant", name, "height_m", rounded(height_m, 1e-3), "pixels",
		(json_int_t)seen->pixels, "distance_m", rounded(one->distance_m, 1e-3), "drawn_as", roles,
		"at_m", rounded(at[0], 1e-4), rounded(at[1], 1e-4), rounded(at[2], 1e-4));
	if (properties && seen->said && !set_row(properties, seen->said)) {
		json_decref(properties);
		return NULL;
	}
	return json_pack("{s:s, s:{s:s, s:[f,f]}, s:o}", "type", "Feature", "geometry", "type", "Point",
		"coordinates", rounded(seen->at[0], step), rounded(seen->at[1], step), "properties",
		properties);
}

static enum eco_code collect(const struct view_geojson_job *job, const struct seen *seen, uint32_t count,
	uint64_t others, json_t **out, struct eco_error *error)
{
	json_t *features = json_array();
	bool good = features;
	for (uint32_t i = 0; i < count && good; i++)
		good = json_array_append_new(features, feature_of(job, &seen[i])) == 0;
	*out = json_pack("{s:s, s:I, s:o}", "type", "FeatureCollection", "summary_pixels", (json_int_t)others,
		"features", features);
	if (good && *out)
		return ECO_OK;
	json_decref(*out);
	*out = NULL;
	return eco_no_memory(error, "the plants of a view");
}

enum eco_code view_geojson_make(const struct view_geojson_job *job, json_t **out, struct eco_error *error)
{
	struct seen *seen = calloc(job->selection->instance_count + 1u, sizeof *seen);
	uint32_t count = 0;
	uint64_t others = 0;
	*out = NULL;
	enum eco_code code = seen ? find_seen(job, seen, &count, &others, error)
				  : eco_no_memory(error, "the plants of a view");
	if (!code)
		code = place(job, seen, count, error);
	if (!code)
		code = ask(job, seen, count, error);
	if (!code)
		code = collect(job, seen, count, others, out, error);
	for (uint32_t i = 0; i < count; i++)
		json_decref(seen[i].said);
	free(seen);
	return code;
}

enum eco_code view_geojson_save(const struct view_geojson_job *job, const char *dir, uint32_t frame,
	struct eco_error *error)
{
	char path[4096];
	json_t *json;
	if (snprintf(path, sizeof path, "%s/frame-%04u.geojson", dir, frame) >= (int)sizeof path)
		return eco_fail(error, ECO_BAD_USAGE, "%.100s...: the folder's name is too long", dir);
	enum eco_code code = view_geojson_make(job, &json, error);
	if (code)
		return code;
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(DIGITS));
	code = text && !eco_json_lost() ? eco_file_write(path, text, strlen(text), error)
		    : eco_no_memory(error, "the plants of a view");
	free(text);
	json_decref(json);
	return code;
}
