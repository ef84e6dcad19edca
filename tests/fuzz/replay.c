/* Stands in for libFuzzer: runs LLVMFuzzerTestOneInput on every file named on the command line and in every
 * folder named there, so that the corpora are part of the ordinary tests. Prints how many inputs were run. */
#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static int replay_file(const char *path)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes = NULL;
	size_t size = 0, got;
	if (!file) {
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
		return -1;
	}
	do {
		uint8_t *grown = realloc(bytes, size + 65536);
		if (!grown)
			abort();
		bytes = grown;
		got = fread(bytes + size, 1, 65536, file);
		size += got;
	} while (got > 0);
	fclose(file);
	/* An allocation of the exact size, so that a sanitizer sees a byte read too far. */
	uint8_t *exact = malloc(size > 0 ? size : 1);
	if (!exact)
		abort();
	memcpy(exact, bytes, size);
	LLVMFuzzerTestOneInput(exact, size);
	free(exact);
	free(bytes);
	return 1;
}

/* Inputs run, or -1. Hidden files are skipped; folders are not entered twice deep by links. */
static int replay(const char *path, int depth)
{
	struct stat status;
	struct dirent **entries;
	int count = 0, n;
	if (lstat(path, &status) != 0) {
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
		return -1;
	}
	if (!S_ISDIR(status.st_mode))
		return replay_file(path);
	n = depth > 8 ? -1 : scandir(path, &entries, NULL, alphasort);
	if (n < 0) {
		fprintf(stderr, "%s: cannot read the folder\n", path);
		return -1;
	}
	for (int i = 0; i < n; i++) {
		char *inner = NULL;
		int one = 0;
		if (entries[i]->d_name[0] != '.') {
			if (asprintf(&inner, "%s/%s", path, entries[i]->d_name) < 0)
				abort();
			one = replay(inner, depth + 1);
		}
		count = count < 0 || one < 0 ? -1 : count + one;
		free(inner);
		free(entries[i]);
	}
	free(entries);
	return count;
}

int main(int argc, char **argv)
{
	int count = 0;
	for (int i = 1; i < argc; i++) {
		int one = replay(argv[i], 0);
		if (one < 0)
			return 1;
		count += one;
	}
	printf("%d inputs replayed\n", count);
	return 0;
}
