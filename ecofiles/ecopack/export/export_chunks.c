/* A pack's chunks as files for static hosts. A file is named by the chunk's id, the hash of
 * its bytes, so it never changes: what another pack has left in the folder is as good, and what is there is
 * kept. Servers answer with streams that name such chunks (server/stream.h), clients fetch them
 * (client-min/view_chunks.h). */
#include "ecofiles/ecopack/export/export.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/base/unfinished.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/format/inventory.h"

struct counts { uint64_t files, bytes, kept; };

static bool is_there(const char *path, const struct eco_chunk *chunk)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISREG(status.st_mode)
		&& status.st_size == (off_t)chunk->size_bytes;
}

static enum eco_code write_chunk(const struct eco_pack *pack, uint32_t index, const char *dir,
	struct counts *counts, struct eco_error *error)
{
	const struct eco_chunk *chunk = &pack->scene.chunks[index];
	char path[4096];
	const uint8_t *bytes;
	size_t size;
	int at = snprintf(path, sizeof path - 2 * sizeof chunk->id.bytes, "%s/", dir);
	if (at >= (int)(sizeof path - 2 * sizeof chunk->id.bytes))
		return eco_fail(error, ECO_BAD_USAGE, "--static %.200s...: the path is too long", dir);
	for (size_t i = 0; i < sizeof chunk->id.bytes; i++)
		at += snprintf(path + at, 3, "%02x", chunk->id.bytes[i]);
	enum eco_code code = eco_pack_payload(pack, index, &bytes, &size, error);
	if (code)
		return code;
	counts->files++;
	counts->bytes += size;
	if (is_there(path, chunk)) {
		counts->kept++;
		return ECO_OK;
	}
	return eco_file_write(path, bytes, size, error);
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

enum eco_code export_chunks(const struct eco_pack *pack, const char *dir, uint64_t from,
	struct eco_error *error)
{
	const struct eco_scene *scene = &pack->scene;
	const struct eco_list *rows = eco_inventory_list(scene);
	/* no stream names those of rows */
	uint32_t count = rows ? rows->chunk_first : scene->chunk_count;
	struct counts counts = { 0 };
	enum eco_code code = ECO_OK;
	if (mkdir(dir, 0777) && errno != EEXIST)
		return eco_fail(error, ECO_IO, "--static %.330s: %s%s", dir, strerror(errno),
			eco_advice_write(errno));
	remove_left_over(dir);
	for (uint32_t i = 0; i < count && !code; i++) {
		if (scene->chunks[i].size_bytes < from)
			continue;
		code = main_progress("exporting", scene->name, (double)i / count)
			? write_chunk(pack, i, dir, &counts, error)
			: eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	if (!code && counts.kept < counts.files)
		code = eco_folder_sync(dir, error);
	main_progress_end();
	if (!code && !main_is_quiet)
		printf("%s: %" PRIu64 " chunks, %" PRIu64 " bytes; %" PRIu64 " were there\n", dir,
			counts.files, counts.bytes, counts.kept);
	return code;
}
