/* UTF-8 by Unicode 15, table 3-7: no overlong forms, no surrogates, nothing beyond U+10FFFF. */
#ifndef ECO_UTF8_H
#define ECO_UTF8_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes of the character at the start of `text` (`size` bytes); 0: not UTF-8, NUL, or empty. */
size_t eco_utf8_bytes(const char *text, size_t size);

/* Code of a character of so many bytes, as eco_utf8_bytes counts them. */
uint32_t eco_utf8_code(const char *text, size_t bytes);
/* False for controls (C0, DEL, C1), for line and paragraph separators, and for what turns the direction of
 * text. */
bool eco_utf8_printable(uint32_t code);

/* Whether `text` is UTF-8 without NUL. */
bool eco_utf8_valid(const char *text, size_t size);

/* Bytes of the character at the start of `text` if it is not printable; 0: it is, or is not UTF-8. */
size_t eco_utf8_control(const char *text, size_t size);
bool eco_utf8_has_control(const char *text, size_t size);
/* Puts `sign` in place of each byte of them, but for those of `keep`. */
void eco_utf8_tame(char *text, const char *keep, char sign);

/* Bytes of the longest beginning of `text` (`size` bytes), at most `most`, that is valid UTF-8 and ends
 * with a whole character: for names that may be any bytes, such as a file's. */
size_t eco_utf8_cut(const char *text, size_t size, size_t most);

#endif
