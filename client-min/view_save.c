#include "client-min/view_save.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/format/image.h"

enum eco_code view_save(const char *dir, const char *format, uint32_t frame, const struct eco_pixels *pixels,
	struct eco_error *error)
{
	char name[64], path[4096];
	snprintf(name, sizeof name, format, frame);
	if (snprintf(path, sizeof path, "%s/%s", dir, name) >= (int)sizeof path)
		return eco_fail(error, ECO_BAD_USAGE, "-o: the folder's name is too long");
	return eco_png_write(pixels, path, error);
}

enum eco_code view_save_dir(const char *dir, struct eco_error *error)
{
	char path[4096];
	if (!*dir || snprintf(path, sizeof path, "%s", dir) >= (int)sizeof path)
		return eco_fail(error, ECO_BAD_USAGE, "-o takes a folder's name of at most %zu characters",
			sizeof path - 1);
	for (char *at = path + 1;; at++) {
		char kept = *at;
		if (kept && kept != '/')
			continue;
		*at = '\0';
		if (mkdir(path, 0777) && errno != EEXIST)
			return eco_fail(error, ECO_IO, "%s: %s", path, strerror(errno));
		*at = kept;
		if (!kept)
			break;
	}
	struct stat status;
	if (stat(dir, &status) || !S_ISDIR(status.st_mode))
		return eco_fail(error, ECO_IO, "%s is not a folder", dir);
	return ECO_OK;
}
