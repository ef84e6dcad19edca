/* Scratch memory of one build: taken piece by piece, given back all at once. A jump to the one place that cleans
 * up keeps failures out of the algorithms. Each piece is an allocation, so that a sanitizer sees its bounds.
 *
 *   struct lod_arena arena = { 0 };
 *   if (setjmp(arena.failed)) { lod_arena_free(&arena); ... return out of memory; }
 *   x = lod_arena_take(&arena, count, sizeof *x);      never NULL, zeroed
 *   lod_arena_free(&arena); */
#ifndef LOD_ARENA_H
#define LOD_ARENA_H

#include <setjmp.h>
#include <stddef.h>

struct lod_arena_piece;
struct lod_arena {
	struct lod_arena_piece *last;
	struct lod_arena *inner;     /* another arena that is freed with this one, or NULL */
	jmp_buf failed;              /* set by the owner before the first take */
};

/* Zeroed memory for count * size bytes (at least one); jumps to `failed` without memory or where the product
 * overflows. */
void *lod_arena_take(struct lod_arena *arena, size_t count, size_t size);

/* Gives back every piece that was taken after `mark` (a value of arena->last). */
void lod_arena_release(struct lod_arena *arena, const struct lod_arena_piece *mark);
void lod_arena_free(struct lod_arena *arena);

/* As lod_arena_take, but from malloc: the result outlives the arena, and the caller frees it. */
void *lod_arena_own(struct lod_arena *arena, size_t count, size_t size);

#endif
