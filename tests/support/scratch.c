#include "tests/support/scratch.h"

#include "tests/support/files.h"

char scratch_root[256];

void scratch_open(const char *test)
{
	snprintf(scratch_root, sizeof scratch_root, "build/tmp/%s-%ld", test, (long)getpid());
	folder_make(scratch_root);
}

int scratch_close(void **state)
{
	char command[300];
	snprintf(command, sizeof command, "rm -rf '%s'", scratch_root);
	return system(command);
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

void write_text(const char *name, const char *text) { file_write_text(in_root(name), text); }

char *read_all(const char *name, size_t *size)
{
	return (char *)file_read(in_root(name), size);
}

void write_shrub(const char *path, const char *head, double height, int leaves)
{
	FILE *file = fopen(path, "wb");
	double l = height / 15, w = height / 40;
	assert_non_null(file);
	fprintf(file, "%sv %f 0 0\nv %f 0 0\nv 0 %f %f\nv 0 %f %f\nf 1 2 3\nf 1 2 4\n", head, -w, w, height,
		w, height, -w);
	for (int i = 0; i < leaves; i++) {
		double x = (i * 37 % 100 - 50) / 100.0 * height * 0.7,
			y = height * (0.5 + i * 53 % 100 / 200.0);
		double z = (i * 71 % 100 - 50) / 100.0 * height * 0.7;
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf -4 -3 -2 -1\n", x, y, z,
			x + l / 2, y + l / 4, z, x + l, y, z + l / 3, x + l / 2, y - l / 4, z);
	}
	assert_int_equal(fclose(file), 0);
}
