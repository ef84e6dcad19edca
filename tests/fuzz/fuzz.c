/* All targets in one program, whose name says which of them it runs: fuzz_NAME. In place of libFuzzer's there
 * is a main that runs the target on each file and folder named on the command line, so that the corpora are
 * part of the ordinary tests. It skips hidden files and prints how many inputs were run. */
#include <errno.h>
#include <fts.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"
#include "tests/support/files.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
#define FUZZ_CALL(name) \
	if (strcmp(program_invocation_short_name, "fuzz_" #name) == 0) \
		fuzz_##name(bytes, size);
	FUZZ_TARGETS(FUZZ_CALL)
	return 0;
}

#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
static int replay_file(const char *path)
{
	size_t size;
	uint8_t *bytes = file_read(path, &size);
	/* An allocation of the exact size, so that a sanitizer sees a byte read too far. */
	uint8_t *exact = malloc(size > 0 ? size : 1);
	if (!exact)
		abort();
	memcpy(exact, bytes, size);
	free(bytes);
	LLVMFuzzerTestOneInput(exact, size);
	free(exact);
	return 1;
}

static int by_name(const FTSENT **a, const FTSENT **b) { return strcmp((*a)->fts_name, (*b)->fts_name); }

int main(int argc, char **argv)
{
	int count = 0;
	FTS *tree = argc > 1 ? fts_open(argv + 1, FTS_PHYSICAL | FTS_NOCHDIR, by_name) : NULL;
	for (FTSENT *entry; tree && (entry = fts_read(tree));) {
		if (entry->fts_errno && entry->fts_info != FTS_DP) {
			fprintf(stderr, "%s: %s\n", entry->fts_path, strerror(entry->fts_errno));
			return 1;
		}
		if (entry->fts_level > 0 && entry->fts_name[0] == '.')
			fts_set(tree, entry, FTS_SKIP);
		else if (entry->fts_info == FTS_F || entry->fts_info == FTS_SL)
			count += replay_file(entry->fts_path);
	}
	if (tree)
		fts_close(tree);
	printf("%d inputs replayed\n", count);
	return 0;
}
#endif
