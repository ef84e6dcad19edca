/* Reading command lines: what ecoview and ecoload share. Numbers are whole arguments; what is left over is an error that names it. */
#ifndef VIEW_OPTIONS_H
#define VIEW_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* If argv[*at] is `name` (or name=VALUE): stores its value, advances *at past what was used and returns true. A missing value sets
 * *value to NULL. */
bool view_option(int argc, char **argv, int *at, const char *name, const char **value);
bool view_flag(char **argv, int *at, const char *name);

enum eco_code view_parse_count(const char *option, const char *text, uint64_t low, uint64_t high, uint64_t *out, struct eco_error *error);
enum eco_code view_parse_seconds(const char *option, const char *text, double *out, struct eco_error *error);
/* WxH */
enum eco_code view_parse_size(const char *option, const char *text, uint32_t *width, uint32_t *height, struct eco_error *error);

/* At the end of a program: `status`, or 1 after saying so if something that was printed did not get out. */
int view_output_status(int status, const char *program);

#endif
