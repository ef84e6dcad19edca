#include "ecofiles/base/data_path.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

bool eco_data_path(const char *const *places, const char *file, char path[PATH_MAX])
{
	char folder[PATH_MAX];
	ssize_t length = readlink("/proc/self/exe", folder, sizeof folder - 1);
	folder[length > 0 ? length : 0] = 0;
	char *slash = strrchr(folder, '/');
	if (!slash)
		return false;
	*slash = 0;
	for (; *places; places++)
		if (snprintf(path, PATH_MAX, "%s%s/%s", folder, *places, file) < PATH_MAX
				&& access(path, F_OK) == 0)
			return true;
	return false;
}
