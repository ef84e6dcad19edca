/* Plants one by one: every model of the data folder that reads as a plant, and the generated kinds.
 *
 * Nothing here knows the names of files: all are tried whose endings ecopack reads, and those that fail are
 * left out, aloud. Packed ones (.xz) are read from an unpacked copy in the cache, which is made anew for
 * another folder and after a change in it. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/bench_state.h"

#define PATH 1024
#define DEPTH_MAX 8u
#define MODELS_MAX 4096u

static const char *const endings[] = { ".glb", ".gltf", ".obj", ".fbx", ".dae", ".ply", ".stl", ".3ds" };
static const char *const generated[] = { "park", "forest", "sunflowers" };

struct list {
	struct bench_model *items;
	uint32_t count, room;
	bool packed;
	uint64_t stamp;              /* of all files: where they are, sizes and times; in any order */
};

static bool ends_with(const char *name, const char *ending)
{
	size_t n = strlen(name), e = strlen(ending);
	return n > e && !strcasecmp(name + n - e, ending);
}

static bool is_model(const char *name)
{
	for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
		if (ends_with(name, endings[i]))
			return true;
	return false;
}

static enum eco_code add(struct list *list, const char *path, const char *name, bool made,
	struct eco_error *error)
{
	if (list->count == list->room) {
		uint32_t room = list->room ? 2 * list->room : 32;
		struct bench_model *bigger = room > MODELS_MAX ? NULL
			: realloc(list->items, room * sizeof *bigger);
		if (!bigger)
			return eco_fail(error, ECO_TOO_LARGE, "%s: more than %u models, or no memory for "
				"them", path, MODELS_MAX);
		list->items = bigger;
		list->room = room;
	}
	struct bench_model *m = &list->items[list->count++];
	*m = (struct bench_model){ .generated = made };
	snprintf(m->path, sizeof m->path, "%.511s", path);
	snprintf(m->name, sizeof m->name, "%s%.50s", made ? "generated-" : "", name);
	for (char *c = m->name; *c; c++)                     /* names stand in tables */
		*c = *c == ',' || *c == '"' || (unsigned char)*c < ' ' ? '_' : *c;
	return ECO_OK;
}

/* Whether a packed file's unpacked sibling is there. */
static bool unpacked(const char *path)
{
	char sibling[PATH];
	snprintf(sibling, sizeof sibling, "%.*s", (int)(strlen(path) - 3), path);
	return access(sibling, R_OK) == 0;
}

static uint64_t stamp_of(const char *path, const struct stat *status)
{
	uint64_t parts[3] = { (uint64_t)status->st_size, (uint64_t)status->st_mtim.tv_sec,
		(uint64_t)status->st_mtim.tv_nsec };
	return XXH3_64bits_withSeed(parts, sizeof parts, XXH3_64bits(path, strlen(path)));
}

static enum eco_code scan(struct list *list, const char *folder, bool made, uint32_t depth,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	DIR *dir = depth < DEPTH_MAX ? opendir(folder) : NULL;
	for (struct dirent *entry; dir && !code && (entry = readdir(dir));) {
		char path[PATH];
		struct stat status;
		if (*entry->d_name == '.' || snprintf(path, sizeof path, "%s/%s", folder, entry->d_name)
				>= (int)sizeof ((struct bench_model *)0)->path ||
			stat(path, &status))
			continue;
		if (S_ISDIR(status.st_mode)) {
			code = scan(list, path, made, depth + 1, error);
			continue;
		}
		list->stamp += stamp_of(path, &status);
		if (is_model(entry->d_name))
			code = add(list, path, entry->d_name, made, error);
		else if (ends_with(entry->d_name, ".xz") && !unpacked(path))
			list->packed = true;
	}
	if (dir)
		closedir(dir);
	return code;
}

static int by_name(const void *a, const void *b)
{
	const struct bench_model *x = a, *y = b;
	int order = x->generated - y->generated;
	order = order ? order : strcmp(x->name, y->name);
	return order ? order : strcmp(x->path, y->path);
}

static int by_leaves(const void *a, const void *b)
{
	const struct bench_model *x = a, *y = b;
	int order = x->generated - y->generated;
	return order ? order : x->leaves != y->leaves ? (x->leaves < y->leaves ? -1 : 1) : by_name(a, b);
}

/* ---- What is read ---- */

static uint32_t count_leaves(const struct eco_model *model)
{
	struct lod_arena arena = { 0 };
	struct lod_foliage foliage;
	struct eco_error why = { 0 };
	uint32_t count = bench_foliage_make(&foliage, model, &arena, &why) ? 0 : foliage.count;
	lod_arena_free(&arena);
	return count;
}

/* Whether it reads, and its leaves; kept, as it takes a second or two each. */
static bool reads(struct bench *bench, struct bench_model *model)
{
	char unit[640], stamp[64];
	struct stat status;
	struct eco_model read;
	struct eco_error error = { 0 };
	if (stat(model->path, &status))
		return false;
	snprintf(unit, sizeof unit, "model-%s-%s", model->name, model->path);
	snprintf(stamp, sizeof stamp, "%lld %lld", (long long)status.st_size, (long long)status.st_mtime);
	json_t *kept = bench_recall(bench, unit, stamp);
	if (!kept) {
		enum eco_code code = bench_model_read(bench, model, &read, &error);
		if (code == ECO_INTERRUPTED)
			return false;
		kept = bench_keep(bench, unit, stamp,
			json_pack("{s:b, s:i, s:s}", "reads", (int)!code, "leaves",
			code ? 0 : (int)count_leaves(&read), "why", error.text));
		if (!code)
			eco_model_free(&read);
	}
	bool good = json_is_true(json_object_get(kept, "reads"));
	model->leaves = (uint32_t)json_integer_value(json_object_get(kept, "leaves"));
	if (!good)
		bench_note(bench, "%s is left out: %s", model->path,
			json_string_value(json_object_get(kept, "why")));
	return good;
}

static enum eco_code make_generated(struct bench *bench, struct list *list, struct eco_error *error)
{
	char folder[PATH], models[PATH + 16];
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < sizeof generated / sizeof *generated && !code; i++) {
		snprintf(folder, sizeof folder, "%s/scenes/plants-%s", bench->cache, generated[i]);
		snprintf(models, sizeof models, "%s/scene.json", folder);
		if (access(models, R_OK)) {
			code = bench_folder_make(folder, error);
			if (!code)
				code = bench_command(bench, error,
					"'%s/ecopack' generate %s -o '%s' --plants 20 --quiet", bench->build,
					generated[i], folder);
		}
		snprintf(models, sizeof models, "%s/models", folder);
		if (!code)
			code = scan(list, models, true, 0, error);
	}
	return code;
}

static enum eco_code find_all(struct bench *bench, struct list *list, struct eco_error *error)
{
	char folder[PATH], copy[PATH];
	enum eco_code code = ECO_OK;
	if (bench->data) {
		snprintf(folder, sizeof folder, "%s/models", bench->data);
		code = scan(list, folder, false, 0, error);
		if (!code && list->packed) {
			snprintf(copy, sizeof copy, "%s/models-%016llx", bench->cache,
				(unsigned long long)list->stamp);
			if (access(copy, R_OK))
				code = bench_command(bench, error,
					"rm -rf '%s/models'* && cp -R '%s' '%s.tmp' && chmod -R u+w "
					"'%s.tmp' && find '%s.tmp' -name '*.xz' "
					"-exec xz -df {} + && mv '%s.tmp' '%s'", bench->cache, folder, copy,
					copy, copy, copy, copy);
			list->count = 0;
			if (!code)
				code = scan(list, copy, false, 0, error);
		}
	}
	return code ? code : make_generated(bench, list, error);
}

enum eco_code bench_models(struct bench *bench, struct bench_model **models, uint32_t *count,
	struct eco_error *error)
{
	struct list list = { 0 };
	int lock = bench_lock(bench);
	enum eco_code code = find_all(bench, &list, error);
	bench_unlock(lock);
	const char *before = bench_objects(bench, BENCH_OBJECTS_PLANTS);
	uint32_t kept = 0;
	if (list.count)
		qsort(list.items, list.count, sizeof *list.items, by_name);
	for (uint32_t i = 0; i < list.count && !code; i++) {
		bool twice = kept && list.items[i].generated
			&& !strcmp(list.items[kept - 1].name, list.items[i].name);
		bench_progress(bench, (double)i / list.count, list.items[i].name);
		if (!twice && reads(bench, &list.items[i]))
			list.items[kept++] = list.items[i];
		if (bench_stopped(bench))
			code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	bench_objects(bench, before);
	if (kept)
		qsort(list.items, kept, sizeof *list.items, by_leaves);
	if (code) {
		free(list.items);
		return code;
	}
	*models = list.items;
	*count = kept;
	return ECO_OK;
}

enum eco_code bench_model_read(struct bench *bench, const struct bench_model *model, struct eco_model *out,
	struct eco_error *error)
{
	const char *path = model->path;
	(void)bench;
	return eco_model_import(out, &(struct eco_model_options){ .paths = &path, .path_count = 1 }, error);
}
