/* Parts of sentences for messages, in bounded texts. */
#ifndef ECO_PHRASE_H
#define ECO_PHRASE_H

#include <stddef.h>
#include <stdint.h>

/* Appends a name to a list, after ", " if it is not the first. Names that do not fit are counted at its end: "oak, ash
 * and 12 more". `list` has `size` bytes, at least 32, and begins as "". */
void eco_phrase_add(char *list, size_t size, const char *name);

/* Ends a text of `size` bytes after a whole word, with " ...", if it lost bytes: `wanted` is what vsnprintf returned. */
void eco_phrase_cut(char *text, size_t size, int wanted);

/* "12,345"; returns `text`. */
const char *eco_phrase_count(uint64_t count, char text[32]);

/* The last part of a path, with either slash. */
const char *eco_path_last(const char *path);

#endif
