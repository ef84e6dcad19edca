#include "ecofiles/ecopack/export/export.h"

#include <dirent.h>
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

/* ---- Chunks ---- */

/* A pack's chunks as files for static hosts. A file is named by the chunk's id, the hash of
 * its bytes, so it never changes: what another pack has left in the folder is as good, and what is there is
 * kept. Servers answer with streams that name such chunks (server/stream.h), clients fetch them
 * (client-min/view_exchange.h). */

struct counts { uint64_t files, bytes, kept; };

static bool is_there(const char *path, const struct eco_chunk *chunk)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISREG(status.st_mode)
		&& status.st_size == (off_t)chunk->size_bytes;
}

static void write_chunk(const struct eco_pack *pack, uint32_t index, const char *dir, struct counts *counts,
	struct eco_error *error)
{
	const struct eco_chunk *chunk = &pack->scene.chunks[index];
	char path[4096];
	const uint8_t *bytes;
	size_t size;
	if (snprintf(path, sizeof path, "%s/%s", dir, eco_id_text(chunk->id.bytes).hex) >= (int)sizeof path)
		eco_stop(ECO_BAD_USAGE, "--static %.200s...: the path is too long", dir);
	eco_check(eco_pack_payload(pack, index, &bytes, &size, error));
	counts->files++;
	counts->bytes += size;
	if (is_there(path, chunk))
		counts->kept++;
	else
		eco_check(eco_file_write(path, bytes, size, error));
}

/* Removes files of an export that was killed: "ID.tmp-4711". */
static void remove_left_over(const char *dir)
{
	DIR *folder = opendir(dir);
	for (const struct dirent *entry; folder && (entry = readdir(folder));) {
		char id[2 * sizeof(struct eco_chunk_id) + 1];
		snprintf(id, sizeof id, "%.*s", (int)sizeof id - 1, entry->d_name);
		if (strspn(id, "0123456789abcdef") == sizeof id - 1 && eco_unfinished_is(entry->d_name, id))
			eco_unfinished_remove_file(dirfd(folder), entry->d_name);
	}
	if (folder)
		closedir(folder);
}

/* Chunks of `from` bytes and more into a folder, which is made if missing. */
static void export_chunks(const struct eco_pack *pack, const char *dir, uint64_t from, struct eco_error *error)
{
	const struct eco_scene *scene = &pack->scene;
	const struct eco_list *rows = eco_inventory_list(scene);
	/* no stream names those of rows */
	uint32_t count = rows ? rows->chunk_first : scene->chunk_count;
	struct counts counts = { 0 };
	if (mkdir(dir, 0777) && errno != EEXIST)
		eco_stop(ECO_IO, "--static %.330s: %s%s", dir, strerror(errno), eco_advice_write(errno));
	remove_left_over(dir);
	for (uint32_t i = 0; i < count; i++) {
		if (scene->chunks[i].size_bytes < from)
			continue;
		main_progress("exporting", scene->name, (double)i / count);
		write_chunk(pack, i, dir, &counts, error);
	}
	if (counts.kept < counts.files)
		eco_check(eco_folder_sync(dir, error));
	main_progress_end();
	if (!main_is_quiet)
		printf("%s: %" PRIu64 " chunks, %" PRIu64 " bytes; %" PRIu64 " were there\n", dir,
			counts.files, counts.bytes, counts.kept);
}

/* ---- The command ---- */

static struct { const char *pack, *chunks, *tiles; uint64_t from; bool plain; struct eco_pack *opened; } given;

static void write_given(void *error)
{
	if (!given.chunks && !given.tiles)
		eco_stop(ECO_BAD_USAGE, "nothing to export: give --static DIR, --3dtiles DIR or both");
	eco_check(eco_pack_open(&given.opened, given.pack, error));
	if (given.chunks)
		export_chunks(given.opened, given.chunks, given.from, error);
	if (given.tiles)
		eco_check(export_tiles(given.opened, given.tiles, given.plain, error));
}

static enum eco_code run(int argc, char **argv, struct eco_error *error)
{
	memset(&given, 0, sizeof given);
	given.from = ECO_NAME_FROM;
	enum eco_code code = main_read(&main_command_export, argc, argv, error);
	code = code ? code : eco_try(write_given, error, error);
	eco_pack_close(given.opened);
	return code;
}

static const struct eco_option options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", &given.pack, .is_required = true },
	{ "static", 0, ECO_OPTION_TEXT, "DIR", &given.chunks,
		.help = "write chunks as files, each named by the hash of its bytes. These files never "
		"change; packs may share a folder, which is made if missing" },
	{ "from", 0, ECO_OPTION_COUNT, "N", &given.from, 1, INT64_MAX,
		.help = "with --static: only chunks of at least N bytes; default 1024, from which "
		"ecoview fetches chunks by name" },
	{ "3dtiles", 0, ECO_OPTION_TEXT, "DIR", &given.tiles,
		.help = "write 3D Tiles 1.1 for CesiumJS and others into a new folder, which appears "
		"complete or not at all" },
	{ "plain", 0, ECO_OPTION_FLAG, NULL, &given.plain,
		.help = "3D Tiles without EXT_meshopt_compression, for programs that cannot read it; "
		"about three times the bytes" },
	{ 0 } };

const struct main_command main_command_export = { { "ecopack export",
	"OUT.eco [--static DIR [--from N]] [--3dtiles DIR [--plain]]",
	"Writes a pack as plain files that any web server or object store can serve.", options, main_common,
	"`ecoview --chunks URL` fetches exported chunks from any host; the server's answers then only name "
	"them. 3D Tiles hold plants as instances of shared files in three levels of detail, with species "
	"and height, and far tiles as summaries of small triangles. ecoserve chooses anew for each view; a "
	"tile set has one choice for all views.\n", NULL }, run };
