/* Plants one by one: every model of the data folder that reads as a plant, and the generated kinds.
 *
 * Files are chosen by the endings that ecopack reads; those that fail to read are named and left out. Models
 * of the data folder are read from a copy in the cache, where packed ones (.xz) are unpacked. */
#include <ftw.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/model_import.h"
#include "tests/bench/bench_leaves.h"

#define DEPTH_MAX 8
#define MODELS_MAX 4096u

static const char *const endings[] = { ".glb", ".gltf", ".obj", ".fbx", ".dae", ".ply", ".stl", ".3ds" };
static const char *const kinds[] = { "park", "forest", "sunflowers" };

/* The list that a scan fills. */
static struct bench_model *found;
static uint32_t found_count;
static bool generated;

static int visit(const char *path, const struct stat *status, int type, struct FTW *at)
{
	const char *name = path + at->base, *dot = strrchr(name, '.');
	bool is_model = false;
	(void)status;
	for (size_t i = 0; i < sizeof endings / sizeof *endings && dot && type == FTW_F; i++)
		is_model = is_model || !strcasecmp(dot, endings[i]);
	if (!is_model || found_count == MODELS_MAX || strlen(path) >= sizeof found->path)
		return 0;
	struct bench_model *m = &found[found_count++];
	*m = (struct bench_model){ .generated = generated };
	snprintf(m->path, sizeof m->path, "%s", path);
	snprintf(m->name, sizeof m->name, "%s%.50s", generated ? "generated-" : "", name);
	for (char *c = m->name; *c; c++)                     /* names stand in tables */
		*c = *c == ',' || *c == '"' || (unsigned char)*c < ' ' ? '_' : *c;
	return 0;
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

static enum eco_code import(const struct bench_model *model, struct eco_model *out, struct eco_error *error)
{
	const char *path = model->path;
	return eco_model_import(out, &(struct eco_model_options){ .paths = &path, .path_count = 1 }, error);
}

void bench_model_read(const struct bench_model *model, struct eco_model *out)
{
	must(import(model, out, must_error));
}

/* The number of leaves, or why it does not read. */
static json_t *look_at(void *ctx)
{
	const struct bench_model *model = ctx;
	struct eco_model read;
	struct eco_error why = { 0 };
	struct lod_arena arena = { 0 };
	struct lod_foliage foliage;
	if (import(model, &read, &why))
		return json_string(why.text);
	bool none = bench_foliage_make(&foliage, &read, &arena, &why);
	json_t *made = json_integer(none ? 0 : foliage.count);
	lod_arena_free(&arena);
	eco_model_free(&read);
	return made;
}

/* Kept, as it takes a second or two each. */
static bool reads(struct bench *bench, struct bench_model *model)
{
	char unit[640], stamp[64];
	snprintf(unit, sizeof unit, "model-%s-%s", model->name, model->path);
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(model->path));
	const json_t *kept = bench_unit(bench, unit, stamp, look_at, model);
	model->leaves = (uint32_t)json_integer_value(kept);
	if (json_is_string(kept))
		eco_progress_note("%s is left out: %s", model->path, json_string_value(kept));
	return !json_is_string(kept);
}

static void find_all(struct bench *bench)
{
	char folder[1024];
	found = eco_alloc(MODELS_MAX, sizeof *found);
	found_count = 0;
	generated = false;
	if (bench->data) {
		bench_command("cp -Ru '%s/models' '%s' && chmod -R u+w "
			"'%s/models' && find '%s/models' -name '*.xz' -exec sh -c 'for f; do [ -e \"${f%%.xz}\" ] "
			"|| xz -dk \"$f\" || exit; done' sh {} +", bench->data, bench->cache, bench->cache, bench->cache);
		snprintf(folder, sizeof folder, "%s/models", bench->cache);
		nftw(folder, visit, DEPTH_MAX, 0);
	}
	generated = true;
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		snprintf(folder, sizeof folder, "%s/scenes/plants-%s", bench->cache, kinds[i]);
		bench_command("[ -d '%s/models' ] || { mkdir -p '%s' && "
			"'%s/ecopack' generate %s -o '%s' --plants 20 --quiet; }", folder, folder, bench->build, kinds[i], folder);
		nftw(folder, visit, DEPTH_MAX, 0);
	}
}

struct bench_model *bench_models(struct bench *bench, uint32_t *count)
{
	uint32_t kept = 0;
	find_all(bench);
	qsort(found, found_count, sizeof *found, by_name);
	for (uint32_t i = 0; i < found_count; i++) {
		bool twice = kept && found[i].generated && !strcmp(found[kept - 1].name, found[i].name);
		bench_progress((double)i / found_count, found[i].name);
		if (!twice && reads(bench, &found[i]))
			found[kept++] = found[i];
	}
	qsort(found, kept, sizeof *found, by_leaves);
	*count = kept;
	return found;
}
