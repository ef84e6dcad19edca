#include "client-min/view_ask.h"

#include <stdlib.h>
#include <string.h>

#include "client-min/view_ground.h"
#include "ecofiles/base/text.h"
#include "ecofiles/base/files.h"

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
	enum eco_code code = ground_at(fetch, store, request->view.eye, &eye_m, result, error);
	if (!code)
		code = ground_at(fetch, store, request->view.target, &target_m, result, error);
	if (code)
		return code;
	request->view.eye[2] += eye_m;
	request->view.target[2] += target_m;
	request->next.eye[2] += eye_m;
	request->next.target[2] += target_m;
	return ECO_OK;
}

/* ---- Explanations ---- */

static const char *const columns[] = { "list", "first", "end", "tile", "plant", "band", "distance_m",
	"share_first", "share_end", "plants", "vertices", "gain_px", "next_lambda", "why", "reason" };
#define COLUMNS (sizeof columns / sizeof *columns)

enum eco_code view_explain_open(struct view_explain *explain, const char *path, struct eco_error *error)
{
	*explain = (struct view_explain){ .path = path };
	explain->out = open_memstream(&explain->text, &explain->size);
	if (!explain->out)
		return eco_no_memory(error, "a table");
	fputs("frame,lambda", explain->out);
	for (size_t i = 0; i < COLUMNS; i++)
		fprintf(explain->out, ",%s", columns[i]);
	fputc('\n', explain->out);
	return ECO_OK;
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

enum eco_code view_explain_write(FILE *out, uint32_t frame, const char *json, struct eco_error *error)
{
	json_error_t where;
	json_t *root = json_loads(json, 0, &where), *why = json_object_get(root, "explanation"),
		*rows = json_object_get(why, "rows"), *row;
	size_t i;
	bool good = json_is_array(rows);
	json_array_foreach(rows, i, row) {
		fprintf(out, "%u,", frame);
		write_value(out, json_object_get(why, "lambda"));
		for (size_t c = 0; c < COLUMNS; c++) {
			fputc(',', out);
			write_value(out, json_object_get(row, columns[c]));
		}
		fputc('\n', out);
	}
	json_decref(root);
	return good ? ECO_OK : eco_fail(error, ECO_UNSUPPORTED, "frame %u: the server does not explain its "
		"plans; it is older than this program", frame);
}

enum eco_code view_explain_frame(struct view_explain *explain, struct view_fetch *fetch, uint32_t frame,
	const struct eco_request *request, struct eco_error *error)
{
	char *text;
	if (!explain->out)
		return ECO_OK;
	enum eco_code code = view_fetch_explanation(fetch, request, &text, error);
	if (code)
		return code;
	code = view_explain_write(explain->out, frame, text, error);
	free(text);
	return code;
}

enum eco_code view_explain_close(struct view_explain *explain, bool keep, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	if (explain->out && fclose(explain->out))
		code = eco_no_memory(error, "a table");
	if (explain->out && keep && !code)
		code = eco_file_write(explain->path, explain->text, explain->size, error);
	free(explain->text);
	*explain = (struct view_explain){ 0 };
	return code;
}
