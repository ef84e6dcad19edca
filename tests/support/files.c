#include "tests/support/files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static _Noreturn void failed(const char *path)
{
	perror(path);
	abort();
}

void folder_make(const char *path)
{
	char part[512];
	snprintf(part, sizeof part, "%s/", path);
	for (char *slash = part; (slash = strchr(slash + 1, '/'));) {
		*slash = 0;
		mkdir(part, 0777);
		*slash = '/';
	}
}

void folder_empty(const char *path)
{
	DIR *folder = opendir(path);
	char name[800];
	for (struct dirent *entry; folder && (entry = readdir(folder));) {
		snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
		unlink(name);
	}
	if (folder)
		closedir(folder);
}

void file_write(const char *path, const void *bytes, size_t size)
{
	FILE *file = fopen(path, "wb");
	if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0)
		failed(path);
}

void file_write_text(const char *path, const char *text) { file_write(path, text, strlen(text)); }

uint8_t *file_read(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	if (!file || fseek(file, 0, SEEK_END))
		failed(path);
	*size = (size_t)ftell(file);
	rewind(file);
	uint8_t *bytes = malloc(*size + 1);
	if (!bytes || fread(bytes, 1, *size, file) != *size)
		failed(path);
	bytes[*size] = 0;
	fclose(file);
	return bytes;
}

bool files_alike(const char *one, const char *other)
{
	size_t one_size, other_size;
	uint8_t *a = file_read(one, &one_size), *b = file_read(other, &other_size);
	bool alike = one_size == other_size && memcmp(a, b, one_size) == 0;
	free(a);
	free(b);
	return alike;
}
