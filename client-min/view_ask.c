#include "client-min/view_ask.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ground.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/json_read.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/text.h"

/* ---- The scene's place ---- */

enum eco_code view_map_fetch(struct view_fetch *fetch, struct view_map *map, struct eco_error *error)
{
	char *text;
	enum eco_code code = view_fetch_scene(fetch, &text, error);
	if (code)
		return code;
	json_t *about = json_loads(text, 0, NULL), *origin = json_object_get(about, "origin");
	const char *crs = json_string_value(json_object_get(origin, "crs"));
	free(text);
	for (size_t i = 0; i < 3; i++)
		map->at[i] = json_number_value(json_array_get(json_object_get(origin, "at"), i));
	map->has_place = !json_unpack(origin, "{s:F, s:F, s:F}", "longitude_deg", &map->place.longitude_deg,
		"latitude_deg", &map->place.latitude_deg, "convergence_deg", &map->place.convergence_deg);
	if (snprintf(map->crs, sizeof map->crs, "%s", crs ? crs : "") >= (int)sizeof map->crs)
		code = eco_fail(error, ECO_UNSUPPORTED, "the scene's CRS has more than %zu letters; a pack "
			"made with its code, such as \"EPSG:32632\", says the same", sizeof map->crs);
	json_decref(about);
	return code;
}

/* ---- The ground ---- */

/* From so high, above every mountain, a pixel is as wide as the ground may be off. */
#define FROM_M 1e5
#define OFF_M 0.005
#define DEG 57.295779513082321

static enum eco_code ground_at(struct view_fetch *fetch, struct view_store *store, const double at[3],
	double *ground_m, struct view_fetch_result *sum, struct eco_error *error)
{
	struct eco_view view = { .eye = { at[0], at[1], FROM_M }, .target = { at[0], at[1], 0 },
		.up = { 0, 1, 0 }, .fov_y_deg = OFF_M / FROM_M * DEG, .width = 1, .height = 1 };
	struct eco_request request = { .view = view, .bytes = ECO_BYTES_UNBOUNDED };
	struct view_fetch_result result;
	struct view_ground ground = { .count = 0 };
	struct lod_eye eye;
	enum eco_code code = view_fetch_stream(fetch, store, &request, &result, error);
	sum->status = result.status;
	sum->retry_ms = result.retry_ms;
	sum->requests += result.requests;
	sum->bytes += result.bytes;
	lod_eye_make(&eye, &view);
	if (!code)
		code = view_ground_make(&ground, store, &eye, error);
	if (code || !view_ground_height(&ground, at[0], at[1], ground_m))
		*ground_m = 0;
	view_ground_free(&ground);
	return code;
}

enum eco_code view_stand(struct view_fetch *fetch, struct view_store *store, struct eco_request *request,
	struct view_fetch_result *result, struct eco_error *error)
{
	double eye_m, target_m;
	*result = (struct view_fetch_result){ .requests = 0 };
	ECO_PASS(ground_at(fetch, store, request->view.eye, &eye_m, result, error));
	ECO_PASS(ground_at(fetch, store, request->view.target, &target_m, result, error));
	request->view.eye[2] += eye_m;
	request->view.target[2] += target_m;
	request->next.eye[2] += eye_m;
	request->next.target[2] += target_m;
	return ECO_OK;
}

/* ---- Explanations ---- */

static const char *const columns[] = { "list", "first", "end", "tile", "plant", "band", "distance_m",
	"share_first", "share_end", "plants", "vertices", "expected_px", "seen_px", "gain_px", "next_lambda", "why", "reason" };
#define COLUMNS (sizeof columns / sizeof *columns)

void view_explain_open(struct view_explain *explain, const char *path)
{
	*explain = (struct view_explain){ .path = path };
	explain->out = open_memstream(&explain->text, &explain->size);
	if (!explain->out)
		eco_end("no memory");
	fputs("frame,lambda", explain->out);
	for (size_t i = 0; i < COLUMNS; i++)
		fprintf(explain->out, ",%s", columns[i]);
	fputc('\n', explain->out);
}

static void write_value(FILE *out, const json_t *value)
{
	if (json_is_string(value))
		eco_csv_write_text(out, json_string_value(value));
	else if (json_is_integer(value))
		fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
	else if (json_is_real(value))
		fprintf(out, "%.9g", json_real_value(value));
}

uint32_t *view_pixels_of(const struct view_selection *selection, const struct view_picture *picture, uint64_t *others)
{
	uint32_t *pixels = eco_alloc((size_t)selection->instance_count + 1, sizeof *pixels);
	uint64_t unused = 0;
	struct view_table owners;
	if (!view_owners_make(&owners, selection))
		eco_end("no memory");
	for (size_t i = 0; i < (size_t)picture->width * picture->height; i++) {
		const struct view_instance *one = view_owners_find(&owners, selection, picture->owner[i]);
		if (picture->owner[i] && one)
			pixels[one - selection->instances]++;
		else if (picture->owner[i])
			++*(others ? others : &unused);
	}
	view_table_free(&owners);
	return pixels;
}

void view_pixels_by_distance(const struct view_selection *selection, const uint32_t *pixels, double px[LOD_DISTANCES])
{
	memset(px, 0, LOD_DISTANCES * sizeof *px);
	for (uint32_t i = 0; i < selection->instance_count; i++)
		px[lod_distance_of(selection->instances[i].distance_m)] += pixels[i];
}

struct shown { const struct view_full *full; struct view_selection selection; uint32_t *pixels; };

/* Are the row's plants those of the instance: of its whole plant, its band and its share? */
static bool is_of(const struct shown *shown, const json_t *row, const struct view_instance *one)
{
	const struct view_plant *plant = view_store_plant(shown->full->store, one->plant);
	double hash = one->hash / (double)ECO_SHARE_ONE, center[3];
	if (!plant || json_integer_value(json_object_get(row, "anchor")) != plant->plant.anchor_first
			|| !(hash >= json_number_value(json_object_get(row, "share_first")))
			|| !(hash < json_number_value(json_object_get(row, "share_end"))))
		return false;
	lod_place_point(&one->place, plant->anchors[0].center, center);
	return json_integer_value(json_object_get(row, "band"))
		== lod_eye_band(shown->full->eye, center, one->place.scale, one->hash);
}

/* Null where a row is of no whole plants, and where full detail was not drawn. */
static json_t *shown_by(const struct shown *shown, const json_t *row)
{
	json_int_t sum = 0;
	bool any = false;
	if (!shown->pixels || !json_object_get(row, "anchor"))
		return NULL;
	for (uint32_t i = 0; i < shown->selection.instance_count; i++)
		if (is_of(shown, row, &shown->selection.instances[i])) {
			sum += shown->pixels[i];
			any = true;
		}
	return any ? json_integer(sum) : NULL;
}

static void write_row(FILE *out, uint32_t frame, const json_t *lambda, const json_t *row)
{
	fprintf(out, "%u,", frame);
	write_value(out, lambda);
	for (size_t c = 0; c < COLUMNS; c++) {
		fputc(',', out);
		write_value(out, json_object_get(row, columns[c]));
	}
	fputc('\n', out);
}

static void write_distances(FILE *out, uint32_t frame, const json_t *why, const struct shown *shown)
{
	const json_t *expected = json_object_get(why, "expected_px");
	double px[LOD_DISTANCES];
	if (shown->pixels)
		view_pixels_by_distance(&shown->selection, shown->pixels, px);
	for (uint32_t i = 0; i < json_array_size(expected) && i < LOD_DISTANCES; i++) {
		json_t *row = json_pack("{s:f, s:O, s:s}", "distance_m", lod_distance_from_m(i),
			"expected_px", json_array_get(expected, i), "why", "distance");
		if (shown->pixels)
			json_object_set_new(row, "seen_px", json_real(px[i]));
		write_row(out, frame, json_object_get(why, "lambda"), row);
		json_decref(row);
	}
}

enum eco_code view_explain_write(FILE *out, uint32_t frame, const char *json, const struct view_full *full,
	struct eco_error *error)
{
	struct shown shown = { .full = full };
	if (full->picture) {
		ECO_PASS(view_select_make(&shown.selection, full->store, full->eye, error));
		shown.pixels = view_pixels_of(&shown.selection, full->picture, NULL);
	}
	json_error_t where;
	json_t *root = json_loads(json, 0, &where), *why = json_object_get(root, "explanation"),
		*rows = json_object_get(why, "rows"), *row;
	size_t i;
	bool good = json_is_array(rows);
	json_array_foreach(rows, i, row) {
		json_object_set_new(row, "seen_px", shown_by(&shown, row));
		write_row(out, frame, json_object_get(why, "lambda"), row);
	}
	write_distances(out, frame, why, &shown);
	json_decref(root);
	free(shown.pixels);
	view_select_free(&shown.selection);
	return good ? ECO_OK : eco_fail(error, ECO_UNSUPPORTED, "frame %u: the server does not explain its "
		"plans; it is older than this program", frame);
}

enum eco_code view_explain_frame(struct view_explain *explain, struct view_fetch *fetch, uint32_t frame,
	const struct eco_request *request, const struct view_full *full, struct eco_error *error)
{
	char *text;
	if (!explain->out)
		return ECO_OK;
	ECO_PASS(view_fetch_explanation(fetch, request, &text, error));
	enum eco_code code = view_explain_write(explain->out, frame, text, full, error);
	free(text);
	return code;
}

enum eco_code view_explain_close(struct view_explain *explain, bool keep, struct eco_error *error)
{
	if (explain->out && fclose(explain->out))
		eco_end("no memory");
	enum eco_code code = explain->out && keep ? eco_file_write(explain->path, explain->text, explain->size, error)
		: ECO_OK;
	free(explain->text);
	*explain = (struct view_explain){ 0 };
	return code;
}

/* ==== The plants of a view ==== */

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

ECO_ORDER_FALLING_TWO(by_pixels, struct seen, ->pixels, ->instance)

/* Instances that are seen come first; returns their number. *others: pixels of what is no instance. */
static uint32_t find_seen(const struct view_geojson_job *job, struct seen *seen, uint64_t *others)
{
	const struct view_selection *s = job->selection;
	uint32_t count = 0, *pixels = view_pixels_of(s, job->picture, others);
	for (uint32_t i = 0; i < s->instance_count; i++) {
		seen[i].instance = i;
		seen[i].pixels = pixels[i];
	}
	free(pixels);
	qsort(seen, s->instance_count, sizeof *seen, by_pixels);
	while (count < s->instance_count && seen[count].pixels)
		count++;
	return count;
}

static enum eco_code place(const struct view_geojson_job *job, struct seen *seen, uint32_t count,
	struct eco_error *error)
{
	double (*places)[2] = eco_alloc(count, sizeof *places);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 2; k++)
			places[i][k] =
				job->map->at[k] + job->selection->instances[seen[i].instance].place.at[k];
	if (*job->map->crs) {
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

/* Asks for plants of one list, all within TOGETHER of the first: {species, plant, class, file, row, line} of
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
				"the server did not describe plant %u of list %u, which it "
				"sent", index, first->list);
	}
	json_decref(answer);
	return code;
}

/* On failure some may have been said. */
static enum eco_code ask(const struct view_geojson_job *job, struct seen *seen, uint32_t count,
	struct eco_error *error)
{
	const struct view_instance *all = job->selection->instances;
	struct seen **sorted = eco_alloc(count, sizeof *sorted);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count; i++)
		sorted[i] = &seen[i];
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

static void set_row(json_t *properties, const json_t *said)
{
	static const char *const names[] = { "species", "plant", "class", "file", "row", "line" };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		json_t *value = json_object_get(said, names[i]);
		if (json_object_set_new(properties, names[i], value ? json_incref(value) : json_null()))
			eco_end("no memory");
	}
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
	if (seen->said)
		set_row(properties, seen->said);
	return json_pack("{s:s, s:{s:s, s:[f,f]}, s:o}", "type", "Feature", "geometry", "type", "Point",
		"coordinates", rounded(seen->at[0], step), rounded(seen->at[1], step), "properties",
		properties);
}

static json_t *collect(const struct view_geojson_job *job, const struct seen *seen, uint32_t count, uint64_t others)
{
	json_t *features = json_array();
	for (uint32_t i = 0; i < count; i++)
		if (json_array_append_new(features, feature_of(job, &seen[i])))
			eco_end("no memory");
	return json_pack("{s:s, s:I, s:o}", "type", "FeatureCollection", "summary_pixels", (json_int_t)others,
		"features", features);
}

enum eco_code view_geojson_make(const struct view_geojson_job *job, json_t **out, struct eco_error *error)
{
	struct seen *seen = eco_alloc(job->selection->instance_count, sizeof *seen);
	uint64_t others = 0;
	uint32_t count = find_seen(job, seen, &others);
	enum eco_code code = place(job, seen, count, error);
	if (!code)
		code = ask(job, seen, count, error);
	*out = code ? NULL : collect(job, seen, count, others);
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
	ECO_PASS(view_geojson_make(job, &json, error));
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(DIGITS));
	if (!text || eco_json_lost())
		eco_end("no memory");
	enum eco_code code = eco_file_write(path, text, strlen(text), error);
	free(text);
	json_decref(json);
	return code;
}
