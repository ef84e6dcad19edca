#include "ecofiles/ecopack/export/export.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/base/json_memory.h"
#include "ecofiles/base/phrase.h"
#include "ecofiles/base/unfinished.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/progress.h"

/* ---- Files ---- */

enum eco_code export_file(struct export *x, const char *name, const void *bytes, size_t size)
{
	char path[PATH_MAX + EXPORT_NAME];
	snprintf(path, sizeof path, "%s/%s", x->dir, name);
	x->files++;
	x->bytes += size;
	return eco_file_write(path, bytes, size, x->error);
}

enum eco_code export_json(struct export *x, const char *name, json_t *json)
{
	char *text = json ? json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
	enum eco_code code = text && !eco_json_lost() ? export_file(x, name, text, strlen(text))
		: eco_fail(x->error, ECO_NO_MEMORY, "%s: no memory for it", name);
	free(text);
	json_decref(json);
	return code;
}

/* Contents of the folder: files that begin so, and these folders of files. */
static const char *const parts[] = { "tileset", "plants", "tiles", NULL };

/* Makes the folder under its first name, and locks it. */
static enum eco_code make_first(struct export *x, const char *dir)
{
	eco_unfinished_remove(dir, parts);
	for (;;) {
		if (mkdir(x->dir, 0777))
			return eco_fail_write(x->error, dir, errno);
		x->folder = open(x->dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
		if (x->folder >= 0 && eco_unfinished_lock(x->folder))
			return ECO_OK;
		if (x->folder < 0 && errno != ENOENT) {
			enum eco_code code = eco_fail_write(x->error, dir, errno);
			rmdir(x->dir);
			return code;
		}
		if (x->folder >= 0)
			close(x->folder);
	}
}

static enum eco_code make_folders(struct export *x, const char *dir)
{
	struct stat status;
	char path[PATH_MAX + EXPORT_NAME], last[PATH_MAX];
	size_t size = strlen(dir);
	while (size > 1 && dir[size - 1] == '/')
		size--;
	if (!size || size + 32 > sizeof x->dir)
		return eco_fail(x->error, ECO_BAD_USAGE, "--3dtiles: the folder's name is empty or too long");
	if (lstat(dir, &status) == 0)
		return eco_fail(x->error, ECO_BAD_USAGE,
			"--3dtiles %s: it is there, and is kept. Take another name",
			dir);
	snprintf(last, sizeof last, "%.*s", (int)size, dir);
	snprintf(x->dir, sizeof x->dir, "%.*s.tmp-%ld", (int)size, dir, (long)getpid());
	enum eco_code code = make_first(x, last);
	for (const char *const *below = parts + 1; *below && !code; below++) {
		snprintf(path, sizeof path, "%s/%s", x->dir, *below);
		if (mkdir(path, 0777))
			code = eco_fail_write(x->error, dir, errno);
	}
	return code;
}

/* ---- All ---- */

static enum eco_code write_all(struct export *x)
{
	const struct eco_scene *s = &x->pack->scene;
	enum eco_code code = ECO_OK;
	x->plants = calloc(s->plant_count + 1u, sizeof *x->plants);
	if (!x->plants)
		return eco_fail(x->error, ECO_NO_MEMORY, "no memory for plants");
	if (!s->tile_count)
		return eco_fail(x->error, ECO_BAD_INPUT, "the pack has no tiles");
	for (uint32_t i = 0; i < s->plant_count && !code; i++)
		code = main_progress("writing plants", s->plants[i].name, (double)i / s->plant_count)
			? export_plant(x, i) : eco_fail(x->error, ECO_INTERRUPTED, "interrupted");
	return code ? code : export_tilesets(x);
}

static void print_export(const struct export *x, const char *dir)
{
	uint64_t triangles = 0;
	char text[32];
	for (uint32_t i = 0; i < x->pack->scene.plant_count; i++)
		triangles += x->plants[i].levels ? x->plants[i].level[x->plants[i].levels - 1].triangles : 0;
	printf("%s/tileset.json: %" PRIu64 " tiles, %" PRIu64 " plants of %u kinds with %s triangles, ", dir,
		x->tiles,
		x->instances, x->pack->scene.plant_count, eco_phrase_count(triangles, text));
	printf("%" PRIu64 " files, %s bytes\n", x->files, eco_phrase_count(x->bytes, text));
}

enum eco_code export_tiles(struct eco_pack *pack, const char *dir, bool is_plain, struct eco_error *error)
{
	struct export x = { .folder = -1, .error = error, .pack = pack, .is_plain = is_plain };
	enum eco_code code = make_folders(&x, dir);
	if (!code)
		code = write_all(&x);
	/* else a machine that stops might show the folder without all of its files' bytes */
	if (!code)
		code = eco_folder_sync(x.dir, error);
	if (!code && rename(x.dir, dir))
		code = eco_fail_write(error, dir, errno);
	main_progress_end();
	if (code && x.folder >= 0)
		eco_unfinished_remove_folder(AT_FDCWD, x.dir, parts);
	if (x.folder >= 0)
		close(x.folder);
	if (!code && !main_is_quiet)
		print_export(&x, dir);
	eco_inventory_free(&x.rows);
	for (uint32_t i = 0; x.plants && i < pack->scene.plant_count; i++)
		for (uint32_t level = 0; level < EXPORT_LEVELS; level++)
			export_mesh_free(&x.plants[i].level[level]);
	free(x.plants);
	return code;
}
