#include "ecofiles/base/file_write.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/unfinished.h"

enum eco_code eco_file_write(const char *path, const void *bytes, size_t size, struct eco_error *error)
{
	char beside[4096];
	if (snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof beside)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s...: the path is too long", path);
	FILE *out = fopen(beside, "wb");
	while (out && !eco_unfinished_lock(fileno(out))) {
		fclose(out);
		out = fopen(beside, "wb");
	}
	bool good = out && fwrite(bytes, 1, size, out) == size;
	if (out && fclose(out) != 0)
		good = false;
	if (good && rename(beside, path) == 0)
		return ECO_OK;
	enum eco_code code = eco_fail_write(error, path, errno);
	if (out)
		unlink(beside);
	return code;
}

enum eco_code eco_folder_sync(const char *path, struct eco_error *error)
{
	int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	bool good = folder >= 0 && syncfs(folder) == 0;
	enum eco_code code = good ? ECO_OK : eco_fail_write(error, path, errno);
	if (folder >= 0)
		close(folder);
	return code;
}
