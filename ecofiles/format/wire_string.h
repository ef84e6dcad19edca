/* Strings on the wire are UTF-8 and short. */
#ifndef ECO_WIRE_STRING_H
#define ECO_WIRE_STRING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* True if `text` is UTF-8 (Unicode 15, table 3-7: no overlong forms, no surrogates) and holds no NUL. */
bool eco_utf8_valid(const uint8_t *text, size_t size);

/* Bytes of the longest beginning of `text` (`size` bytes), at most `most`, that is valid UTF-8 and ends
 * with a whole character: for names that may be any bytes, such as a file's. */
size_t eco_utf8_cut(const char *text, size_t size, size_t most);

#endif
