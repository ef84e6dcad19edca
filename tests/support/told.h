/* Expectations of results as text, for tables of cases. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

extern char import_said[8192];
void import_note(void *ctx, const char *text);       /* adds to it: what was said on the way */
void import_says(const char *text);
bool close_to(double a, double b, double most);
/* Checks of what was read. `wanted` is parted by "|": "key=value", numbers in it parted by commas and equal
 * but for rounding to float; "~text": this was said; "!text": it was not. A number may follow the key:
 * "rgb0=255,0,0". */
typedef void told_value(const char *key, uint32_t number, const char *wanted, char *to, size_t size);
void expect_told(const char *wanted, told_value *value_of);
