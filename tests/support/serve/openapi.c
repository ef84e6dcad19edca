#include "tests/support/serve/openapi.h"

static void openapi_line(struct openapi *api, const char *line, char path[80])
{
	char word[80];
	unsigned status;
	size_t indent = strspn(line, " ");
	if (indent == 2 && sscanf(line, " %79[^: ]:", word) == 1 && word[0] == '/') {
		snprintf(path, 80, "%s", word);
	} else if (indent == 4 && sscanf(line, " %7[a-z]:", word) == 1 && api->count < OPENAPI_MAX) {
		struct openapi_operation *operation = &api->operations[api->count++];
		*operation = (struct openapi_operation){ 0 };
		snprintf(operation->path, sizeof operation->path, "%s", path);
		for (size_t i = 0; word[i]; i++)
			operation->method[i] = (char)(word[i] - 'a' + 'A');
	} else if (indent == 8 && sscanf(line, " \"%3u\":", &status) == 1 && api->count) {
		struct openapi_operation *operation = &api->operations[api->count - 1];
		operation->statuses[operation->status_count++] = status;
	}
}

void openapi_read(struct openapi *api, const char *file_path)
{
	char line[512], path[80] = "";
	bool in_paths = false;
	FILE *file = fopen(file_path, "r");
	*api = (struct openapi){ 0 };
	while (file && fgets(line, sizeof line, file)) {
		if (line[0] != ' ' && line[0] != '\n')
			in_paths = strncmp(line, "paths:", 6) == 0;
		else if (in_paths)
			openapi_line(api, line, path);
	}
	if (file)
		fclose(file);
}

const struct openapi_operation *openapi_find(const struct openapi *api, const char *path, const char *method)
{
	for (unsigned i = 0; i < api->count; i++)
		if (strcmp(api->operations[i].path, path) == 0 && strcmp(api->operations[i].method, method)
				== 0)
			return &api->operations[i];
	return NULL;
}

bool openapi_documents(const struct openapi_operation *operation, unsigned status)
{
	for (unsigned i = 0; i < operation->status_count; i++)
		if (operation->statuses[i] == status)
			return true;
	return false;
}
