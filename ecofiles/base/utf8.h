/* UTF-8 as Unicode 15, table 3-7, has it: no overlong forms, no surrogates, nothing beyond U+10FFFF. */
#ifndef ECO_UTF8_H
#define ECO_UTF8_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes of the character that `text`, of `size` bytes, begins with; 0 if it begins with none, or with NUL, or is empty. */
size_t eco_utf8_bytes(const char *text, size_t size);

/* True if `text` is UTF-8 and holds no NUL. */
bool eco_utf8_valid(const char *text, size_t size);

/* Bytes of the longest beginning of `text`, at most `most` of its `size`, that is so and ends with a whole character: for names made of
 * what may be anything, such as a file's. */
size_t eco_utf8_cut(const char *text, size_t size, size_t most);

#endif
