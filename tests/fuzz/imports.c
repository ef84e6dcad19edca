/* Targets that read what others wrote: requests, models, tables, scenes and tracks. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

#include "ecofiles/format/view.h"
#include "ecofiles/import/model/gltf.h"
#include "ecofiles/import/model/import_model.h"
#include "ecofiles/import/model/import_obj.h"
#include "ecofiles/import/model/model_clean.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/track/track.h"
#include "ecofiles/scene/scene.h"
#include "server/request/condition.h"
#include "server/request/framing.h"
#include "server/request/query.h"
#include "server/request/target.h"
#include "tests/fuzz/fuzz.h"

/* A head that passed: whole lines, none of which begins with a space, a colon or nothing. */
static void check_head(const char *head, size_t size)
{
	assert(size <= SRV_HEAD_BYTES_MAX && size >= sizeof "A / HTTP/1.0\r\n\r\n" - 1);
	assert(memcmp(head + size - 4, "\r\n\r\n", 4) == 0);
	for (size_t i = 0; i < size; i++) {
		unsigned char c = (unsigned char)head[i];
		assert(c == '\r' ? head[i + 1] == '\n' : c == '\n' ? i && head[i - 1] == '\r'
			: c == '\t' || (c >= 0x20 && c != 0x7f));
		if (c == '\n' && i + 3 < size)
			assert(!strchr(" \t:\r\n", head[i + 1]));
	}
}

/* A connection's bytes, as the gate reads them: at once, and in two parts, cut where the first byte says.
 * Heads that pass are what framing.h promises the HTTP library. */
void fuzz_framing(const uint8_t *input, size_t size)
{
	struct srv_framing whole = { 0 }, parts = { 0 };
	if (size < 1)
		return;
	size_t cut = input[0] % size, head = 0;
	char *bytes = malloc(size);
	memcpy(bytes, input + 1, size - 1);
	size_t passed = srv_framing_scan(&whole, bytes, size - 1), at = srv_framing_scan(&parts, bytes, cut);
	if (at == cut)
		at += srv_framing_scan(&parts, bytes + cut, size - 1 - cut);
	assert(at == passed && parts.problem == whole.problem && parts.heads == whole.heads);
	assert((passed < size - 1) == (whole.problem != SRV_PROBLEM_NONE) && !whole.problem == !whole.detail);
	struct srv_framing one = { 0 };
	for (at = 0; at < passed; at++) {
		uint32_t heads = one.heads;
		if (one.size == 0 && !one.body_left)     /* behind an empty line, if one comes first */
			head = bytes[at] == '\r' ? at + 2 : at;
		assert(srv_framing_scan(&one, bytes + at, 1) == 1);
		if (one.heads > heads)
			check_head(bytes + head, at + 1 - head);
	}
	free(bytes);
}

static void check_query(const struct srv_target *target)
{
	struct srv_query query;
	struct eco_error error = { 0 };
	enum eco_code code = srv_query_parse(&query, target, &error);
	assert(code == error.code && (code == ECO_OK || code == ECO_BAD_INPUT));
	if (code)
		return;
	const struct eco_view *view = &query.request.view;
	assert(eco_view_check(view, NULL) == ECO_OK && query.request.vertices <= ECO_VERTICES_MAX);
	for (int i = 0; i < 3; i++)
		assert(isfinite(view->eye[i]) && isfinite(view->target[i]) && isfinite(view->up[i]));
	assert(view->width >= 1 && view->width <= ECO_IMAGE_MAX && view->height >= 1
		&& view->height <= ECO_IMAGE_MAX);
}

static void check_target(const char *raw, size_t size)
{
	struct srv_target target;
	const char *variables[2];
	struct eco_error error = { 0 };
	enum eco_code code = srv_target_parse(&target, raw, size, &error);
	assert(code == error.code && (code == ECO_OK || code == ECO_BAD_INPUT || code == ECO_TOO_LARGE));
	if (code)
		return;
	for (uint32_t i = 0; i < target.segment_count; i++)
		assert(target.segments[i] >= target.text && target.segments[i][0] && target.segments[i][0]
			!= '.' && !strpbrk(target.segments[i], "/%\\ ")
			&& target.segments[i] + strlen(target.segments[i]) < target.text
			+ sizeof target.text);
	for (uint32_t i = 0; i < target.param_count; i++) {
		const char *value = target.params[i].value;
		assert(target.params[i].name[0] && value[0] && value + strlen(value) < target.text
			+ sizeof target.text);
		assert(srv_target_param(&target, target.params[i].name) == value);
		for (; *value; value++)
			assert(*value > 0x20 && *value < 0x7f);
	}
	const struct srv_route *route = srv_route_find(&target, variables);
	assert(!route || !variables[0] || variables[0][0]);
	check_query(&target);
	assert(srv_query_none(&target, NULL) == (target.param_count ? ECO_BAD_INPUT : ECO_OK));
}

static void check_conditions(const struct srv_conditions *conditions)
{
	static const uint64_t sizes[] = { 1, 100, UINT64_MAX };
	for (int i = 0; i < 3; i++) {
		struct srv_range range = srv_range_parse(conditions->range, sizes[i]);
		assert(range.kind != SRV_RANGE_PART || (range.first < range.end && range.end <= sizes[i]));
	}
	srv_etag_match(conditions->if_none_match, "\"0123456789abcdef0123456789abcdef\"");
	struct srv_json json = { 0 };
	srv_problem_write(&json, SRV_PROBLEM_TARGET, conditions->if_range, conditions->if_none_match);
	assert(!json.out.failed && json.out.size > 20);
	for (size_t i = 0; i < json.out.size; i++)
		assert(json.out.bytes[i] >= 0x20 && json.out.bytes[i] != 0x7f);
	eco_writer_free(&json.out);
}

/* One line of `text` from *at on, ended by a 0 in place of its newline; NULL at the end. */
static char *next_line(char *text, size_t size, size_t *at)
{
	if (*at >= size)
		return NULL;
	char *line = text + *at, *newline = memchr(line, '\n', size - *at);
	size_t length = newline ? (size_t)(newline - line) : size - *at;
	line[length] = 0;
	*at += length + 1;
	return line;
}

static void take_condition(struct srv_conditions *conditions, const char *name, const char *value)
{
	if (strcmp(name, "Range") == 0)
		conditions->range = value;
	else if (strcmp(name, "If-Range") == 0)
		conditions->if_range = value;
	else if (strcmp(name, "If-None-Match") == 0)
		conditions->if_none_match = value;
}

/* Target and headers of a request, as the daemon takes them apart. First line the target, then "name: value"
 * lines, an empty line. An accepted request must be within all bounds that later code relies on. */
void fuzz_request(const uint8_t *bytes, size_t size)
{
	struct srv_conditions conditions = { 0 };
	char *text = malloc(size + 1);
	size_t at = 0;
	memcpy(text, bytes, size);
	text[size] = 0;
	const uint8_t *newline = memchr(bytes, '\n', size);
	check_target(text, newline ? (size_t)(newline - bytes) : size);
	next_line(text, size, &at);
	for (char *line; (line = next_line(text, size, &at)) && *line;) {
		char *colon = strchr(line, ':');
		if (!colon)
			continue;
		*colon++ = 0;
		colon += strspn(colon, " ");
		take_condition(&conditions, line, colon);
	}
	check_conditions(&conditions);
	free(text);
}

#define TRIANGLES_MAX 10000u
#define VALUES_MAX 100000u           /* of accessors without bytes, which may have any number of zeros */

static void read_document(struct eco_gltf *doc)
{
	double matrix[16];
	for (uint32_t i = 0; i < 64; i++) {
		struct eco_gltf_accessor a;
		double values[16];
		if (i < doc->node_count)
			eco_gltf_node_matrix(doc, i, matrix, NULL);
		if (eco_gltf_accessor_open(doc, i, 0, &a, NULL) != ECO_OK)
			continue;
		for (uint64_t k = 0; k < a.count && k < VALUES_MAX; k++) {
			eco_gltf_element(&a, k, values);
			eco_gltf_element_index(&a, k);
		}
		eco_gltf_accessor_close(&a);
	}
}

static void read_model(const char *path)
{
	struct eco_model model = { .position = NULL };
	struct eco_model_frame frame = { .unit_m = 0 };
	struct eco_notes notes = { .used = 0 };
	if (eco_gltf_read_model(&model, &frame, path, TRIANGLES_MAX, &notes, NULL) == ECO_OK) {
		assert(model.triangle_count <= TRIANGLES_MAX && model.vertex_count <= 3 * TRIANGLES_MAX);
		for (uint32_t i = 0; i < model.triangle_count; i++) {
			assert(model.material[i] < model.material_count && model.part[i] < model.part_count);
			for (uint32_t c = 0; c < 3; c++)
				assert(model.index[i * 3 + c] < model.vertex_count
					|| model.index[i * 3 + c] == ECO_NONE);
		}
	}
	eco_model_free(&model);
}

void fuzz_gltf(const uint8_t *data, size_t size)
{
	int memory = memfd_create("fuzz", 0);
	struct eco_gltf *doc;
	char path[64];
	setenv("ECO_IMAGE_MODULE", "none", 1);
	assert(memory >= 0 && write(memory, data, size) == (ssize_t)size);
	snprintf(path, sizeof path, "/proc/self/fd/%d", memory);
	if (eco_gltf_open(&doc, path, NULL) == ECO_OK) {
		read_document(doc);
		eco_gltf_close(doc);
		read_model(path);
	} else {
		assert(!doc);
	}
	close(memory);
}

/* A file in memory; its path is written to `path`. */
static int file_of(const uint8_t *bytes, size_t size, char path[64])
{
	int file = memfd_create("fuzz", 0);
	assert(file >= 0 && write(file, bytes, size) == (ssize_t)size);
	snprintf(path, 64, "/proc/self/fd/%d", file);
	return file;
}

static void check(const struct eco_model *m)
{
	uint64_t accounted = m->triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m->dropped[i];
	assert(accounted == m->triangles_in);
	for (uint32_t i = 0; i < m->triangle_count; i++)
		assert(m->material[i] < m->material_count && m->part[i] < m->part_count);
	for (uint32_t i = 0; i < m->material_count; i++)
		assert(m->materials[i].image == ECO_NONE || m->materials[i].image < m->image_count);
}

static void read_obj(const char *path)
{
	static const struct eco_part_rule rules[] =
		{ { .kind = ECO_PART_NAME, .name = (char *)"*l?a*", .is = 1 },
		{ .kind = ECO_PART_SIZE, .size = { 0, 0.1 }, .is = ECO_PART_LEFT_OUT },
		{ .kind = ECO_PART_COMPONENT, .component = 2, .is = 0 } };
	const struct eco_model_options options = { .rules = rules, .rule_count = 3 };
	struct eco_notes *notes = calloc(1, sizeof *notes);
	struct eco_model_frame frame = { .base = { 0 } };
	struct eco_model model = { .position = NULL };
	struct eco_error error = { .code = ECO_OK };
	assert(notes != NULL);
	if (eco_obj_read(&model, &frame, path, 100000, notes, &error) == ECO_OK) {
		check(&model);
		if (eco_model_clean(&model, &frame, &options, path, notes, &error) == ECO_OK)
			check(&model);
		assert(error.code == ECO_OK || error.text[0] != 0);
	}
	eco_model_free(&model);
	free(notes);
}

/* Our own readers of models' text, OBJ and MTL. They read a soup that adds up, and whose
 * references fit; then it is cleaned as any other, with rules that look at all of it. */
void fuzz_obj(const uint8_t *bytes, size_t size)
{
	struct eco_mtl mtl = { .count = 0 };
	struct eco_error error = { .code = ECO_OK };
	char path[64];
	int file = file_of(bytes, size, path);
	read_obj(path);
	assert(eco_mtl_read(&mtl, path, &error) == ECO_OK);
	char **names = calloc(mtl.count + 1, sizeof *names);
	const struct eco_mtl_material **found = calloc(mtl.count + 1, sizeof *found);
	assert(names && found);
	for (uint32_t i = 0; i < mtl.count; i++)
		names[i] = mtl.items[i].name;
	eco_mtl_find(&mtl, names, mtl.count, found);
	for (uint32_t i = 0; i < mtl.count; i++)
		assert(found[i] && !strcasecmp(found[i]->name, names[i]));
	free(names);
	free(found);
	eco_mtl_free(&mtl);
	close(file);
}

/* A sum over all that was read, which must not depend on chance. */
static uint64_t read_all(uint8_t how, const char *path)
{
	static const char separators[] = { 0, ',', ';', '\t' };
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	uint64_t sum = 0;
	bool more = true;
	enum eco_code code = eco_rows_open_csv(&rows, path, separators[how % 4], &error);
	if (code != ECO_OK) {
		assert(!rows && code == error.code && error.text[0] != 0);
		return code;
	}
	assert(rows->column_count <= ECO_COLUMNS_MAX && rows->note_count <= ECO_ROWS_NOTES_MAX);
	while (rows->next(rows, &more, &error) == ECO_OK && more) {
		uint64_t row = rows->row;
		assert(rows->field_count <= ECO_COLUMNS_MAX && row > 0
			&& (rows->place.kind != ECO_PLACE_POINT || rows->has_geometry));
		for (uint32_t i = 0; i < rows->field_count; i++)
			for (const char *c = rows->fields[i]; *c != 0; c++)
				sum = sum * 31 + (unsigned char)*c;
		sum += rows->line + (uint64_t)rows->place.kind;
	}
	eco_rows_close(rows);
	return sum;
}

static void read_texts(const uint8_t *data, size_t size)
{
	char *text = malloc(size + 1), folded[100], again[100];
	double number, unit_m;
	enum eco_size_form form;
	if (!text)
		return;
	memcpy(text, data, size);
	text[size] = 0;
	eco_text_fold(text, folded, sizeof folded);
	assert(eco_text_fold(folded, again, sizeof again) <= strlen(folded));
	assert(eco_text_fits(folded, "*", 0) && eco_text_fits("", folded, 0)
		== (strspn(folded, "*") == strlen(folded)));
	eco_text_is_missing(text);
	for (int comma = 0; comma < 2; comma++) {
		if (eco_text_number(text, comma ? ',' : '.', &number))
			assert(isfinite(number));
		form = eco_text_size(text, comma ? ',' : '.', &number, &unit_m);
		assert(form == ECO_FORM_NONE
			|| (number >= 0 && isfinite(number) && unit_m >= 0 && unit_m <= 1));
	}
	free(text);
}

/* Tables that are read by code of our own, and the texts in them. The first byte says how the rest is read:
 * as a CSV with separator found or given, or as texts. Every row that comes out is whole; two
 * readings are the same. */
void fuzz_rows(const uint8_t *data, size_t size)
{
	char path[64];
	if (size == 0)
		return;
	if (data[0] % 8 == 7) {
		read_texts(data + 1, size - 1);
		return;
	}
	int file = file_of(data + 1, size - 1, path);
	assert(read_all(data[0] % 8, path) == read_all(data[0] % 8, path));
	close(file);
}

/* SCENE.json from memory: whatever the text, a source or an error with a place, never a crash, nothing left
 * behind. */
void fuzz_scene(const uint8_t *data, size_t size)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_source source;
	enum eco_code code = eco_source_parse(&source, (const char *)data, size, "folder/scene.json", false, &error);
	if (code != ECO_OK) {
		assert(code == error.code && strncmp(error.text, "folder/scene.json", 17) == 0
			&& !source.path);
		return;
	}
	for (uint32_t i = 0; i < source.instance_count; i++)
		assert(source.instances[i].plant < source.plant_count && source.instances[i].scale > 0);
	for (uint32_t i = 0; i < source.positions_count; i++)
		assert((!source.positions[i].x) == (!source.positions[i].y) && source.positions[i].path);
	eco_source_free(&source);
}

#define FIXES_MAX 300u                   /* longer tracks only make it slower, and so do scripts */
#define FRAMES_MAX 1000u

/* In place of PROJ, which takes longer than all else together. */
static void to_metres(struct eco_track *track)
{
	for (uint32_t i = 0; track->degrees && i < track->count; i++)
		for (int axis = 0; axis < 2; axis++)
			track->fixes[i].at[axis] *= 111195;
	track->degrees = false;
	track->still_m = 0.1;
}

static void play(const struct eco_script *script)
{
	struct eco_camera *camera;
	struct eco_view view = { .width = 4, .height = 3 };
	struct eco_error error = { 0 };
	/* what lasts for years has times that are too large; nothing else may be wrong */
	if (script->frames <= FRAMES_MAX && script->length_s < 1e8) {
		enum eco_code code = eco_camera_parse(&camera, script->text, script->size, "made.json",
			&error);
		assert(code == ECO_OK);
		eco_camera_frame(camera, eco_camera_frame_count(camera) - 1, &view);
		assert(eco_view_check(&view, NULL) == ECO_OK);
		eco_camera_free(camera);
	}
}

static void fly(struct eco_track *track)
{
	struct eco_flight flight;
	struct eco_script script = { 0 };
	struct eco_track_options defaults = ECO_TRACK_DEFAULTS;
	defaults.fps = 2;                /* so that scripts of minutes are played, too */
	to_metres(track);
	eco_track_clean(track);
	const struct eco_track_report report = track->report;
	assert(report.fixes == report.kept + report.repeated + report.jumped && report.kept > 0);
	for (uint32_t i = 1; i < track->count; i++)
		assert(track->fixes[i].time_s > track->fixes[i - 1].time_s);
	eco_flight_make(&flight, track, &defaults);
	for (uint32_t i = 0; i < flight.count; i++)
		for (int k = 0; k < 3; k++)
			assert(isfinite(flight.samples[i].eye[k]) && isfinite(flight.samples[i].look[k])
				&& isfinite(flight.samples[i].up[k]));
	if (flight.count <= FIXES_MAX && eco_script_fit(&script, &flight, &defaults, NULL) == ECO_OK)
		play(&script);
	free(script.text);
	eco_flight_free(&flight);
}

/* Recorded tracks: whatever the bytes, an error or a track; and whatever the track, a flight and a script
 * that plays. */
void fuzz_track(const uint8_t *bytes, size_t size)
{
	struct eco_track track = { 0 };
	struct eco_error error = { 0 };
	char path[64];
	int file = file_of(bytes, size, path);
	enum eco_code code = eco_track_read(&track, path, &error);
	close(file);
	assert(code == error.code && (code == ECO_OK || !track.fixes));
	for (uint32_t i = 0; i < track.count; i++)
		assert(isfinite(track.fixes[i].at[0]) && isfinite(track.fixes[i].at[1]));
	if (code == ECO_OK && track.count > 0 && track.count <= FIXES_MAX)
		fly(&track);
	eco_track_free(&track);
}
