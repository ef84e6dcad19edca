/* Reads what server/openapi.yaml says of paths, methods and statuses: by its indentation, which is part of
 * its style. */
#ifndef TESTS_OPENAPI_H
#define TESTS_OPENAPI_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPENAPI_MAX 64

struct openapi_operation {
	char path[80], method[8];    /* method in capitals */
	unsigned statuses[24];
	unsigned status_count;
};
struct openapi { struct openapi_operation operations[OPENAPI_MAX]; unsigned count; };

/* The `paths` section; count is 0 if the file cannot be read. */
void openapi_read(struct openapi *api, const char *file_path);
const struct openapi_operation *openapi_find(const struct openapi *api, const char *path, const char *method);
bool openapi_documents(const struct openapi_operation *operation, unsigned status);

#endif
