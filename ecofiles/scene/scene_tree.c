/* A scene file and the files it nests. Each file is read once, however often it is placed (a hectare
 * planted a million times is one hectare); its real path identifies it. In the resulting list every file
 * comes before the files it names: the reverse of the order in which a depth-first walk finishes. */
#include "ecofiles/base/memory.h"
#include "ecofiles/scene/scene.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/model/import_file.h"
#include "ecofiles/scene/scene_parse.h"

#define DEPTH_MAX 64u

struct walk {
	struct eco_sources *sources;
	const char *path;                    /* of the outermost file */
	char **real;                         /* real path of each source; owned */
	bool *open;                          /* on the walk's path: naming it again is a cycle */
	uint32_t *finished, finished_count;
	uint32_t chain[DEPTH_MAX], depth;
	struct eco_error *error;
};

static enum eco_code read_text(const char *path, char **text, size_t *size, struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	uint8_t *bytes = NULL;
	enum eco_code code = eco_file_read(path, ECO_SOURCE_BYTES_MAX, &bytes, size, &own);
	*text = (char *)bytes;
	return code == ECO_OK ? code : eco_fail(error, code, "%s%s", own.text,
		code == ECO_TOO_LARGE ? "; keep many plants in a CSV file (\"from\")" : "");
}

/* Reads the naming file once more to give the error the place of child number `child`. */
static _Noreturn void fail_at_child(struct walk *walk, uint32_t source, uint32_t child, enum eco_code code,
	const char *text)
{
	struct eco_error unread = { .code = ECO_OK };
	struct eco_json_file file = { .name = walk->sources->items[source].path, .error = walk->error };
	char *json;
	if (read_text(file.name, &json, &file.size, &unread) == ECO_OK) {
		struct eco_json top, children, item, eco;
		file.text = json;
		json_t *root = eco_json_open(&file);
		top = eco_json_root(&file, root);
		if (root) {
			children = eco_json_member(&top, "children");
			item = eco_json_item(&children, child);
			eco = eco_json_member(&item, "eco");
			eco_json_fail(&eco, code, "%s", text);
		}
		json_decref(root);
	}
	eco_stop(code, "%s: %s", file.name, text);
}

/* "a.json -> b.json -> a.json", beginning with the file that is named again. */
static void chain_text(const struct walk *walk, uint32_t again, char *text, size_t size)
{
	size_t used = (size_t)snprintf(text, size, "a file cannot be inside itself: ");
	uint32_t i = 0;
	while (walk->chain[i] != again)
		i++;
	for (; i < walk->depth && used < size; i++)
		used += (size_t)snprintf(text + used, size - used, "%s -> ",
			walk->sources->items[walk->chain[i]].path);
	if (used < size)
		snprintf(text + used, size - used, "%s", walk->sources->items[again].path);
}

/* The new source's number. */
static uint32_t add_source(struct walk *walk, const char *path, char *real)
{
	struct eco_sources *sources = walk->sources;
	char *text;
	size_t size = 0;
	eco_check(read_text(path, &text, &size, walk->error));
	eco_check(eco_source_parse(&sources->items[sources->count], text, size, path, true, walk->error));
	free(text);
	walk->real[sources->count] = real;
	return sources->count++;
}

static void walk_source(struct walk *walk, uint32_t index);

static void walk_child(struct walk *walk, uint32_t parent, uint32_t number)
{
	struct eco_sources *sources = walk->sources;
	struct eco_source_child *child = &sources->items[parent].children[number];
	char *real = realpath(child->eco, NULL), text[360];
	uint32_t index = 0;
	if (!real)
		fail_at_child(walk, parent, number, ECO_IO, strerror(errno));
	while (index < sources->count && strcmp(walk->real[index], real) != 0)
		index++;
	child->source = index;
	if (index < sources->count) {
		free(real);
		if (!walk->open[index])
			return;
		chain_text(walk, index, text, sizeof text);
		fail_at_child(walk, parent, number, ECO_BAD_INPUT, text);
	}
	if (walk->depth >= DEPTH_MAX || index >= ECO_SOURCES_MAX) {
		snprintf(text, sizeof text, "more than %u files, or nested more than %u deep",
			ECO_SOURCES_MAX, DEPTH_MAX);
		fail_at_child(walk, parent, number, ECO_TOO_LARGE, text);
	}
	add_source(walk, child->eco, real);
	if (sources->items[index].ground.height_count > 0 ||
		sources->items[index].ground_image.file_count > 0 || sources->items[index].draw_count > 0) {
		snprintf(text, sizeof text, "%.200s has ground, but only the outermost file can: a nested "
			"file stands where it is placed", child->eco);
		fail_at_child(walk, parent, number, ECO_UNSUPPORTED, text);
	}
	walk_source(walk, index);
}

static void walk_source(struct walk *walk, uint32_t index)
{
	const struct eco_source *source = &walk->sources->items[index];
	walk->open[index] = true;
	walk->chain[walk->depth++] = index;
	for (uint32_t i = 0; i < source->child_count; i++) {
		struct eco_source_child *child = &source->children[i];
		if (i > 0 && strcmp(child->eco, child[-1].eco) == 0)
			child->source = child[-1].source;
		else
			walk_child(walk, index, i);
	}
	walk->depth--;
	walk->open[index] = false;
	walk->finished[walk->finished_count++] = index;
}

/* Orders the sources by the reverse of their finishing. */
static void order_sources(struct walk *walk)
{
	struct eco_sources *sources = walk->sources;
	uint32_t count = sources->count, *place = eco_alloc(count, sizeof *place);
	struct eco_source *items = eco_alloc(count, sizeof *items);
	for (uint32_t i = 0; i < count; i++) {
		place[walk->finished[i]] = count - 1 - i;
		items[count - 1 - i] = sources->items[walk->finished[i]];
	}
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t j = 0; j < items[i].child_count; j++)
			items[i].children[j].source = place[items[i].children[j].source];
	free(place);
	free(sources->items);
	sources->items = items;
}

static void load(void *ctx)
{
	struct walk *walk = ctx;
	char *real = realpath(walk->path, NULL);
	if (!real)
		eco_check(eco_fail_read(walk->error, walk->path, errno));
	walk_source(walk, add_source(walk, walk->path, real));
	order_sources(walk);
}

enum eco_code eco_sources_load(struct eco_sources *sources, const char *path, struct eco_error *error)
{
	struct walk walk = { .sources = sources, .path = path, .error = error };
	*sources = (struct eco_sources){ eco_alloc(ECO_SOURCES_MAX, sizeof *sources->items), 0 };
	walk.real = eco_alloc(ECO_SOURCES_MAX, sizeof *walk.real);
	walk.open = eco_alloc(ECO_SOURCES_MAX, sizeof *walk.open);
	walk.finished = eco_alloc(ECO_SOURCES_MAX, sizeof *walk.finished);
	enum eco_code code = eco_try(load, &walk, error);
	for (uint32_t i = 0; i < sources->count; i++)
		free(walk.real[i]);
	eco_free(walk.real, walk.open, walk.finished);
	if (code)
		eco_sources_free(sources);
	return code;
}

void eco_sources_free(struct eco_sources *sources)
{
	for (uint32_t i = 0; i < sources->count; i++)
		eco_source_free(&sources->items[i]);
	free(sources->items);
	*sources = (struct eco_sources){ .items = NULL };
}
