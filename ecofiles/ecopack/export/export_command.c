#include <string.h>

#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/format/view.h"

static struct { const char *pack, *chunks, *tiles; uint64_t from; bool plain; } given;

static enum eco_code run(int argc, char **argv, struct eco_error *error)
{
	struct eco_pack *pack = NULL;
	memset(&given, 0, sizeof given);
	given.from = ECO_NAME_FROM;
	enum eco_code code = main_read(&main_command_export, argc, argv, error);
	if (!code && !given.chunks && !given.tiles)
		code = eco_fail(error, ECO_BAD_USAGE,
			"what to export? Give --static DIR, --3dtiles DIR or both");
	if (!code)
		code = eco_pack_open(&pack, given.pack, error);
	if (!code && given.chunks)
		code = export_chunks(pack, given.chunks, given.from, error);
	if (!code && given.tiles)
		code = export_tiles(pack, given.tiles, given.plain, error);
	eco_pack_close(pack);
	return code;
}

static const struct eco_option options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", &given.pack, .is_required = true },
	{ "static", 0, ECO_OPTION_TEXT, "DIR", &given.chunks,
		.help = "chunks as files, each named by the hash of its bytes: they never change, and packs "
		"may share a folder, which is made if missing" },
	{ "from", 0, ECO_OPTION_COUNT, "N", &given.from, 1, INT64_MAX,
		.help = "of chunks, only those of so many bytes; 1024 if not given, from where on ecoview "
		"fetches chunks by their names" },
	{ "3dtiles", 0, ECO_OPTION_TEXT, "DIR", &given.tiles,
		.help = "3D Tiles 1.1 for CesiumJS and others, into a folder that is not there yet; it "
		"appears complete or not at all" },
	{ "plain", 0, ECO_OPTION_FLAG, NULL, &given.plain,
		.help = "3D Tiles without EXT_meshopt_compression, for programs that do not read it; about "
		"three times the bytes" },
	{ 0 } };

const struct main_command main_command_export = { { "ecopack export",
	"OUT.eco [--static DIR [--from N]] [--3dtiles DIR [--plain]]",
	"Writes a pack as plain files that any web server or object store can serve.", options, main_common,
	"Chunks are for a server's answers that only name them: ecoview --chunks URL fetches them there. In "
	"3D Tiles plants are instances of shared files in three levels of detail, with species and height; "
	"far tiles are their summaries, as small triangles. ecoserve chooses for each view; these files are "
	"chosen once.\n", NULL }, run };
