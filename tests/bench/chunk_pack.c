/* A pack with chunks of given sizes, which tests/bench/serve_speed.sh asks a server for.
 *
 *   chunk_pack OUT.eco BYTES...                      at most eight sizes, ascending */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/scene_packs.h"

int main(int argc, char **argv)
{
	uint32_t sizes[TEXTURE_LEVELS_MAX], count = 0;
	struct eco_error error = { 0 };
	if (argc < 3 || argc > 2 + (int)TEXTURE_LEVELS_MAX) {
		fprintf(stderr, "usage: chunk_pack OUT.eco BYTES...\n");
		return 2;
	}
	for (int i = 2; i < argc; i++)
		sizes[count++] = (uint32_t)strtoul(argv[i], NULL, 10);
	if (texture_pack_write(argv[1], sizes, count, &error))
		fprintf(stderr, "chunk_pack: %s\n", error.text);
	return eco_exit_status(error.code);
}
