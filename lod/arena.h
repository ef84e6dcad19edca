/* Scratch memory of one build: taken piece by piece, given back all at once. Without memory the program ends
 * (memory.h). Each piece is an allocation, so that a sanitizer sees its bounds.
 *
 *   struct lod_arena arena = { 0 };
 *   x = lod_arena_take(&arena, count, sizeof *x);      never NULL, zeroed
 *   lod_arena_free(&arena); */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct lod_arena_piece;
struct lod_arena { struct lod_arena_piece *last; bool failed; };

/* Zeroed memory for count * size bytes. */
void *lod_arena_take(struct lod_arena *arena, size_t count, size_t size);
/* The same; NULL without memory, and arena->failed is set, so that it is enough to look there after several. */
void *lod_arena_try(struct lod_arena *arena, size_t count, size_t size);

/* Gives back every piece that was taken after `mark` (a value of arena->last). */
void lod_arena_release(struct lod_arena *arena, const struct lod_arena_piece *mark);
void lod_arena_free(struct lod_arena *arena);
