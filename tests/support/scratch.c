#include "tests/support/scratch.h"

char scratch_root[256];

void scratch_open(const char *test)
{
	mkdir("build", 0777);
	mkdir("build/tmp", 0777);
	snprintf(scratch_root, sizeof scratch_root, "build/tmp/%s-%ld", test, (long)getpid());
	mkdir(scratch_root, 0777);
}

void scratch_remove(const char *path)
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

const char *in_root(const char *name)
{
	static char paths[16][512];
	static int next;
	char *path = paths[next++ % 16];
	snprintf(path, 512, "%s/%s", scratch_root, name);
	return path;
}

FILE *open_text(const char *name)
{
	FILE *file = fopen(in_root(name), "wb");
	assert_non_null(file);
	return file;
}

char *read_all(const char *name, size_t *size)
{
	FILE *file = fopen(in_root(name), "rb");
	assert_non_null(file);
	char *bytes = malloc(1 << 24);
	assert_non_null(bytes);
	*size = fread(bytes, 1, 1 << 24, file);
	fclose(file);
	return bytes;
}

void write_leaves(FILE *file, double height, int leaves)
{
	double l = height / 15;
	for (int i = 0; i < leaves; i++) {
		double x = (i * 37 % 100 - 50) / 100.0 * height * 0.7,
			y = height * (0.5 + i * 53 % 100 / 200.0);
		double z = (i * 71 % 100 - 50) / 100.0 * height * 0.7;
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf -4 -3 -2 -1\n", x, y, z,
			x + l / 2, y + l / 4, z, x + l, y, z + l / 3, x + l / 2, y - l / 4, z);
	}
}
