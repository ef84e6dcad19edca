/* Parts of sentences for messages, in bounded texts. */
#ifndef ECO_PHRASE_H
#define ECO_PHRASE_H

#include <stddef.h>
#include <stdint.h>

/* Appends a name to a list, after ", " if it is not the first; a name that does not fit becomes ", ...".
 * `list` has `size` bytes, at least 8, and begins as "". */
void eco_phrase_add(char *list, size_t size, const char *name);

/* "12,345"; returns `text`. */
const char *eco_phrase_count(uint64_t count, char text[32]);

/* The last part of a path, with either slash. */
const char *eco_path_last(const char *path);

#endif
