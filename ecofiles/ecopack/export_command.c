/* ecopack export: a pack's chunks as files for static hosts. A file is named by the chunk's id, the hash of
 * its bytes, so it never changes: what another pack has left in the folder is as good, and what is there is
 * kept. Servers answer with streams that name such chunks (server/stream.h), clients fetch them
 * (client-min/view_chunks.h). */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/view.h"

static struct { const char *pack, *folder; uint64_t from; } given;

struct counts { uint64_t files, bytes, kept; };

static bool is_there(const char *path, const struct eco_chunk *chunk)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISREG(status.st_mode)
		&& status.st_size == (off_t)chunk->size_bytes;
}

static enum eco_code write_chunk(const struct eco_pack *pack, uint32_t index, struct counts *counts,
	struct eco_error *error)
{
	const struct eco_chunk *chunk = &pack->scene.chunks[index];
	char path[4096];
	const uint8_t *bytes;
	size_t size;
	int at = snprintf(path, sizeof path - 2 * sizeof chunk->id.bytes, "%s/", given.folder);
	if (at >= (int)(sizeof path - 2 * sizeof chunk->id.bytes))
		return eco_fail(error, ECO_BAD_USAGE, "--static %.200s...: the path is too long",
			given.folder);
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

static enum eco_code export_chunks(const struct eco_pack *pack, struct counts *counts,
	struct eco_error *error)
{
	const struct eco_scene *scene = &pack->scene;
	enum eco_code code = ECO_OK;
	if (mkdir(given.folder, 0777) && errno != EEXIST)
		return eco_fail(error, ECO_IO, "--static %.400s: %s", given.folder, strerror(errno));
	main_catch_interrupts();
	for (uint32_t i = 0; i < scene->chunk_count && !code; i++) {
		if (scene->chunks[i].size_bytes < given.from)
			continue;
		code = main_progress("exporting", scene->name, (double)i / scene->chunk_count)
			? write_chunk(pack, i, counts, error)
			: eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	main_progress_end();
	return code;
}

static enum eco_code run(int argc, char **argv, struct eco_error *error)
{
	struct eco_pack *pack = NULL;
	struct counts counts = { 0 };
	memset(&given, 0, sizeof given);
	given.from = ECO_NAME_FROM;
	enum eco_code code = main_read(&main_command_export, argc, argv, error);
	if (!code)
		code = eco_pack_open(&pack, given.pack, error);
	if (!code)
		code = export_chunks(pack, &counts, error);
	eco_pack_close(pack);
	if (!code && !main_is_quiet)
		printf("%s: %" PRIu64 " chunks, %" PRIu64 " bytes; %" PRIu64 " were there\n", given.folder,
			counts.files, counts.bytes, counts.kept);
	return code;
}

static const struct eco_option options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", &given.pack, .is_required = true },
	{ "static", 0, ECO_OPTION_TEXT, "DIR", &given.folder, .is_required = true,
		.help = "the folder for the files; made if missing" },
	{ "from", 0, ECO_OPTION_COUNT, "N", &given.from, 1, INT64_MAX,
		.help = "only chunks of so many bytes; 1024 if not given, from where on ecoview fetches "
		"chunks by their names" }, { 0 } };

const struct main_command main_command_export = { { "ecopack export", "OUT.eco --static DIR [--from N]",
	"Writes a pack's chunks as files that any web server or object store can serve.", options,
	main_common,
	"Each file is named by the hash of its bytes and never changes: serve them as immutable. Packs may "
	"share a folder. ecoview --chunks URL fetches from there what a server's streams name.\n", NULL },
	run };
