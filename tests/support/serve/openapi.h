/* Operations that server/openapi.yaml describes, read by its indentation, which is part of its style. */
#ifndef TESTS_OPENAPI_H
#define TESTS_OPENAPI_H

#include <stdbool.h>

/* Whether it describes this status of an operation (0: any); `method` in capitals. */
bool openapi_documents(const char *path, const char *method, unsigned status);
/* Its operations by GET and POST. */
unsigned openapi_count(void);

#endif
