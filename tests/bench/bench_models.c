/* Plants one by one: every model of the data folder that reads as a plant, and the generated kinds.
 *
 * Files are chosen by the endings that ecopack reads; those that fail to read are named and left out. Packed
 * ones (.xz) are read from an unpacked copy in the cache, which is made anew for another folder and after a
 * change in it. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/bench.h"

#define PATH 1024
#define DEPTH_MAX 8u
#define MODELS_MAX 4096u

static const char *const endings[] = { ".glb", ".gltf", ".obj", ".fbx", ".dae", ".ply", ".stl", ".3ds" };
static const char *const generated[] = { "park", "forest", "sunflowers" };

struct list {
	struct bench_model *items;   /* room for MODELS_MAX */
	uint32_t count;
	bool packed;
	uint64_t stamp;              /* of all files: where they are, sizes and times; in any order */
};

static bool ends_with(const char *name, const char *ending)
{
	size_t n = strlen(name), e = strlen(ending);
	return n > e && !strcasecmp(name + n - e, ending);
}

static void add(struct list *list, const char *path, const char *name, bool made)
{
	bool model = false;
	for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
		model = model || ends_with(name, endings[i]);
	if (!model || list->count == MODELS_MAX)
		return;
	struct bench_model *m = &list->items[list->count++];
	*m = (struct bench_model){ .generated = made };
	snprintf(m->path, sizeof m->path, "%.511s", path);
	snprintf(m->name, sizeof m->name, "%s%.50s", made ? "generated-" : "", name);
	for (char *c = m->name; *c; c++)                     /* names stand in tables */
		*c = *c == ',' || *c == '"' || (unsigned char)*c < ' ' ? '_' : *c;
}

static void scan(struct list *list, const char *folder, bool made, uint32_t depth)
{
	DIR *dir = depth < DEPTH_MAX ? opendir(folder) : NULL;
	for (struct dirent *entry; dir && (entry = readdir(dir));) {
		char path[PATH], sibling[PATH];
		struct stat status;
		int size = snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
		if (*entry->d_name == '.' || size >= (int)sizeof ((struct bench_model *)0)->path || stat(path,
			&status)) continue;
		if (S_ISDIR(status.st_mode)) {
			scan(list, path, made, depth + 1);
			continue;
		}
		uint64_t parts[3] = { (uint64_t)status.st_size, (uint64_t)status.st_mtim.tv_sec,
			(uint64_t)status.st_mtim.tv_nsec };
		list->stamp += XXH3_64bits_withSeed(parts, sizeof parts, XXH3_64bits(path, (size_t)size));
		snprintf(sibling, sizeof sibling, "%.*s", size - 3, path);
		list->packed = list->packed || (ends_with(path, ".xz") && access(sibling, R_OK));
		add(list, path, entry->d_name, made);
	}
	if (dir)
		closedir(dir);
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

/* ---- Reading ---- */

struct work { struct bench *bench; const struct bench_model *model; };

/* {"leaves"}, or {"why"} where it does not read. */
static enum eco_code look_at(void *ctx, json_t **made, struct eco_error *error)
{
	const struct work *w = ctx;
	struct eco_model read;
	struct eco_error why = { 0 };
	enum eco_code code = bench_model_read(w->bench, w->model, &read, &why);
	if (code == ECO_INTERRUPTED)
		return eco_fail(error, code, "interrupted");
	if (code) {
		*made = json_pack("{s:s}", "why", why.text);
		return ECO_OK;
	}
	struct lod_arena arena = { 0 };
	struct lod_foliage foliage;
	bool none = bench_foliage_make(&foliage, &read, &arena, &why);
	*made = json_pack("{s:i}", "leaves", none ? 0 : (int)foliage.count);
	lod_arena_free(&arena);
	eco_model_free(&read);
	return ECO_OK;
}

/* Kept, as it takes a second or two each. */
static enum eco_code reads(struct bench *bench, struct bench_model *model, bool *good, struct eco_error
	*error)
{
	char unit[640], stamp[64];
	struct stat status;
	struct work work = { bench, model };
	json_t *kept;
	*good = false;
	if (stat(model->path, &status))
		return ECO_OK;
	snprintf(unit, sizeof unit, "model-%s-%s", model->name, model->path);
	snprintf(stamp, sizeof stamp, "%lld %lld", (long long)status.st_size, (long long)status.st_mtime);
	enum eco_code code = bench_unit(bench, unit, stamp, look_at, &work, &kept, error);
	const char *why = json_string_value(json_object_get(kept, "why"));
	*good = !code && !why;
	model->leaves = (uint32_t)json_integer_value(json_object_get(kept, "leaves"));
	if (!code && why)
		bench_note(bench, "%s is left out: %s", model->path, why);
	return code;
}

static enum eco_code find_all(struct bench *bench, struct list *list, struct eco_error *error)
{
	char folder[PATH], copy[PATH];
	enum eco_code code = ECO_OK;
	if (bench->data) {
		snprintf(folder, sizeof folder, "%s/models", bench->data);
		scan(list, folder, false, 0);
	}
	if (list->packed) {
		snprintf(copy, sizeof copy, "%s/models-%016llx", bench->cache,
			(unsigned long long)list->stamp);
		if (access(copy, R_OK))
			code = bench_command(bench, error, "rm -rf '%s'/models* && cp -R '%s' '%s.tmp' && "
				"chmod -R u+w '%s.tmp' && find '%s.tmp' -name '*.xz' -exec xz -df {} + && "
				"mv '%s.tmp' '%s'", bench->cache, folder, copy, copy, copy, copy, copy);
		list->count = 0;
		scan(list, copy, false, 0);
	}
	for (size_t i = 0; i < sizeof generated / sizeof *generated && !code; i++) {
		snprintf(folder, sizeof folder, "%s/scenes/plants-%s", bench->cache, generated[i]);
		snprintf(copy, sizeof copy, "%.900s/models", folder);
		if (access(copy, R_OK))
			code = bench_command(bench, error,
				"mkdir -p '%s' && '%s/ecopack' generate %s -o '%s' --plants 20 " "--quiet",
				folder, bench->build, generated[i], folder);
		scan(list, copy, true, 0);
	}
	return code;
}

enum eco_code bench_models(struct bench *bench, struct bench_model **models, uint32_t *count,
	struct eco_error *error)
{
	struct list list = { .items = calloc(MODELS_MAX, sizeof *list.items) };
	if (!list.items)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a list of models");
	enum eco_code code = find_all(bench, &list, error);
	uint32_t kept = 0;
	qsort(list.items, list.count, sizeof *list.items, by_name);
	for (uint32_t i = 0; i < list.count && !code; i++) {
		bool good, twice = kept && list.items[i].generated
			&& !strcmp(list.items[kept - 1].name, list.items[i].name);
		bench_progress(bench, (double)i / list.count, list.items[i].name);
		if (twice)
			continue;
		code = reads(bench, &list.items[i], &good, error);
		if (good)
			list.items[kept++] = list.items[i];
	}
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
