/* The fuzz targets' main outside config=fuzz: runs the target once for every file named, and for every file in a folder named. What
 * a fuzzer once found stays found, with any compiler. */
#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static unsigned long replayed;

static int replay_file(const char *path, size_t size)
{
	uint8_t *bytes = malloc(size ? size : 1);        /* exactly as long as the file: sanitizers see a read beyond it */
	FILE *file = fopen(path, "rb");
	if (!bytes || !file || fread(bytes, 1, size, file) != size) {
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
		exit(1);
	}
	fclose(file);
	LLVMFuzzerTestOneInput(bytes, size);
	free(bytes);
	replayed++;
	return 0;
}

static int replay(const char *path)
{
	struct stat status;
	if (stat(path, &status) != 0) {
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
		return 1;
	}
	if (S_ISREG(status.st_mode))
		return replay_file(path, (size_t)status.st_size);
	struct dirent **entries;
	int count = scandir(path, &entries, NULL, alphasort), failed = count < 0;
	for (int i = 0; i < count; i++) {
		char inner[4096];
		snprintf(inner, sizeof inner, "%s/%s", path, entries[i]->d_name);
		if (entries[i]->d_name[0] != '.' && !failed)
			failed = replay(inner);
		free(entries[i]);
	}
	if (count >= 0)
		free(entries);
	return failed;
}

int main(int argc, char **argv)
{
	for (int i = 1; i < argc; i++)
		if (replay(argv[i]))
			return 1;
	if (!replayed) {
		fprintf(stderr, "%s: no input: name files or folders\n", argv[0]);
		return 1;
	}
	printf("%lu inputs replayed\n", replayed);
	return 0;
}
