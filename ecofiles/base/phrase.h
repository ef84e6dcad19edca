/* Parts of sentences for people, in bounded texts. */
#ifndef ECO_PHRASE_H
#define ECO_PHRASE_H

#include <stddef.h>
#include <stdint.h>

/* Adds a name to a list in a message, after ", " if it is not the first; what does not fit becomes one ", ...". `list` has `size` bytes, at
 * least 8, and begins as "". */
void eco_phrase_add(char *list, size_t size, const char *name);

/* "12,345"; returns `text`. */
const char *eco_phrase_count(uint64_t count, char text[32]);

#endif
