#include "client-min/view_explain.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/csv.h"

static const char *const columns[] = { "list", "first", "end", "tile", "plant", "band", "distance_m",
	"share_first", "share_end", "plants", "vertices", "gain_px", "next_lambda", "why", "reason" };
#define COLUMNS (sizeof columns / sizeof *columns)

enum eco_code view_explain_open(struct view_explain *explain, const char *path, struct eco_error *error)
{
	*explain = (struct view_explain){ .path = path };
	if (asprintf(&explain->beside, "%s.tmp-%ld", path, (long)getpid()) < 0)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a table");
	explain->out = fopen(explain->beside, "w");
	if (!explain->out)
		return eco_fail(error, ECO_IO, "--explain %s: %s", path, strerror(errno));
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
	if (explain->out) {
		bool failed = ferror(explain->out) != 0;
		failed = fclose(explain->out) != 0 || failed;
		if (keep && (failed || rename(explain->beside, explain->path)))
			code = eco_fail(error, ECO_IO, "--explain %s: %s", explain->path, strerror(errno));
		if (!keep || code)
			unlink(explain->beside);
	}
	free(explain->beside);
	*explain = (struct view_explain){ 0 };
	return code;
}
