#include "ecofiles/ecopack/export/export.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/view.h"

/* ---- Files ---- */

void export_file(struct export *x, const char *name, const void *bytes, size_t size)
{
	char path[PATH_MAX + EXPORT_NAME];
	snprintf(path, sizeof path, "%s/%s", x->dir, name);
	x->files++;
	x->bytes += size;
	eco_check(eco_file_write(path, bytes, size, x->error));
}

void export_json(struct export *x, const char *name, json_t *json)
{
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(15));
	export_file(x, name, text, strlen(text));
	free(text);
	json_decref(json);
}

static void make_folders(struct export *x)
{
	struct stat status;
	static const char *const parts[] = { "", "/plants", "/tiles" };
	char path[PATH_MAX + EXPORT_NAME];
	size_t size = strlen(x->final);
	while (size > 1 && x->final[size - 1] == '/')
		size--;
	if (!size || size + 32 > sizeof x->dir)
		eco_stop(ECO_BAD_USAGE, "--3dtiles: the folder's name is empty or too long");
	if (lstat(x->final, &status) == 0)
		eco_stop(ECO_BAD_USAGE, "--3dtiles %s: it is there, and is kept. Take another name", x->final);
	snprintf(x->dir, sizeof x->dir, "%.*s.tmp-%ld", (int)size, x->final, (long)getpid());
	for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
		snprintf(path, sizeof path, "%s%s", x->dir, parts[i]);
		if (mkdir(path, 0777))
			eco_check(eco_fail_write(x->error, x->final, errno));
		x->is_made = true;
	}
}

/* ---- All ---- */

static void write_all(void *export)
{
	struct export *x = export;
	const struct eco_scene *s = &x->pack->scene;
	make_folders(x);
	x->plants = eco_alloc(s->plant_count, sizeof *x->plants);
	if (!s->tile_count)
		eco_stop(ECO_BAD_INPUT, "the pack has no tiles");
	for (uint32_t i = 0; i < s->plant_count; i++) {
		main_progress("writing plants", s->plants[i].name, (double)i / s->plant_count);
		export_plant(x, i);
	}
	export_tilesets(x);
	/* else a machine that stops might show the folder without all of its files' bytes */
	eco_check(eco_folder_sync(x->dir, x->error));
	if (rename(x->dir, x->final))
		eco_check(eco_fail_write(x->error, x->final, errno));
}

static void remove_folder(void *export)
{
	struct export *x = export;
	if (x->is_made)
		eco_folder_remove(x->dir);
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
	struct export x = { .final = dir, .error = error, .pack = pack,
		.meta = json_loadb(pack->meta, pack->meta_size, 0, NULL), .is_plain = is_plain };
	eco_at_end(remove_folder, &x);
	enum eco_code code = eco_try(write_all, &x, error);
	main_progress_end();
	if (code)
		remove_folder(&x);
	eco_at_end(NULL, NULL);
	if (!code && !main_is_quiet)
		print_export(&x, dir);
	eco_inventory_free(&x.rows);
	for (uint32_t i = 0; x.plants && i < pack->scene.plant_count; i++)
		for (uint32_t level = 0; level < EXPORT_LEVELS; level++)
			export_mesh_free(&x.plants[i].level[level]);
	free(x.plants);
	json_decref(x.meta);
	return code;
}

/* ---- The command ---- */

static struct { const char *pack, *tiles; bool plain; struct eco_pack *opened; } given;

static void write_given(void *error)
{
	eco_check(eco_pack_open(&given.opened, given.pack, error));
	eco_check(export_tiles(given.opened, given.tiles, given.plain, error));
}

static enum eco_code run(int argc, char **argv, struct eco_error *error)
{
	memset(&given, 0, sizeof given);
	enum eco_code code = main_read(&main_command_export, argc, argv, error);
	code = code ? code : eco_try(write_given, error, error);
	eco_pack_close(given.opened);
	return code;
}

static const struct eco_option options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", .value = &given.pack, .is_required = true },
	{ "3dtiles", 0, ECO_OPTION_TEXT, "DIR", .value = &given.tiles, .is_required = true },
	{ "plain", 0, ECO_OPTION_FLAG, NULL, .value = &given.plain }, { 0 }
};

const struct main_command main_command_export = { { "ecopack export",
	"OUT.eco --3dtiles DIR [--plain]",
	"Writes a pack as 3D Tiles, which any web server or object store can serve.", options, main_common,
	"3D Tiles hold plants as instances of shared files in three levels of detail, with species "
	"and height, and far tiles as summaries of small triangles. ecoserve chooses anew for each view; a "
	"tile set has one choice for all views.\n", NULL }, run };
