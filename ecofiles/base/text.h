/* Texts: UTF-8, parts of messages, cells of tables. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* ---- UTF-8 by Unicode 15, table 3-7: no overlong forms, no surrogates, nothing beyond U+10FFFF ---- */

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

/* ---- Parts of sentences for messages, in bounded texts ---- */

/* Appends a name to a list, after ", " if it is not the first. Names that do not fit are counted at its end:
 * "oak, ash and 12 more". `list` has `size` bytes, at least 32, and begins as "". */
void eco_phrase_add(char *list, size_t size, const char *name);

/* Ends a text of `size` bytes after a whole word, with " ...", if it lost bytes: `wanted` is what vsnprintf returned. */
void eco_phrase_cut(char *text, size_t size, int wanted);

/* "12,345"; returns `text`. */
const char *eco_phrase_count(uint64_t count, char text[32]);

/* The last part of a path, with either slash. */
const char *eco_path_last(const char *path);

/* ---- Tables ---- */

/* Writes a text as a cell of a CSV (RFC 4180), which a spreadsheet may open. Quotes it if it holds a separator, a quote or the end of a line. A spreadsheet
 * would run a text that begins as a formula does (=, +, -, @, a tab or the end of a line), so an apostrophe
 * comes before it. Numbers are written by other means: -1 is one. */
void eco_csv_write_text(FILE *out, const char *text);
