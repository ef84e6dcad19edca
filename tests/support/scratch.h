/* A folder of one run's own under build/tmp, and files in it: for tests that write packs and what they are made of. */
#ifndef TESTS_SCRATCH_H
#define TESTS_SCRATCH_H

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char root[256];

static inline void scratch_open(const char *test)
{
	mkdir("build", 0777);
	mkdir("build/tmp", 0777);
	snprintf(root, sizeof root, "build/tmp/%s-%ld", test, (long)getpid());
	mkdir(root, 0777);
}

/* A folder with files in it, and itself. */
static inline void scratch_remove(const char *path)
{
	DIR *folder = opendir(path);
	struct dirent *entry;
	char name[800];
	while (folder && (entry = readdir(folder))) {
		snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
		unlink(name);
	}
	if (folder)
		closedir(folder);
	rmdir(path);
}

/* Path of a file in it; sixteen may be in use at a time. */
static inline const char *in_root(const char *name)
{
	static char paths[16][512];
	static int next;
	char *path = paths[next++ % 16];
	snprintf(path, 512, "%s/%s", root, name);
	return path;
}

static inline FILE *open_text(const char *name)
{
	FILE *file = fopen(in_root(name), "wb");
	assert_non_null(file);
	return file;
}

/* Its first 16 MiB; the caller frees them. */
static inline char *read_all(const char *name, size_t *size)
{
	FILE *file = fopen(in_root(name), "rb");
	assert_non_null(file);
	char *bytes = malloc(1 << 24);
	assert_non_null(bytes);
	*size = fread(bytes, 1, 1 << 24, file);
	fclose(file);
	return bytes;
}

/* Quads around the upper half of a plant of that height, as lines of an OBJ file, Y up. */
static inline void write_leaves(FILE *file, double height, int leaves)
{
	double l = height / 15;
	for (int i = 0; i < leaves; i++) {
		double x = (i * 37 % 100 - 50) / 100.0 * height * 0.7, y = height * (0.5 + i * 53 % 100 / 200.0);
		double z = (i * 71 % 100 - 50) / 100.0 * height * 0.7;
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf -4 -3 -2 -1\n", x, y, z, x + l / 2, y + l / 4, z, x + l, y,
			z + l / 3, x + l / 2, y - l / 4, z);
	}
}

#endif
