#include "lod/arena.h"

#include <stdint.h>
#include <stdlib.h>

struct lod_arena_piece {
	struct lod_arena_piece *before;
	max_align_t data[];
};

void *lod_arena_own(struct lod_arena *arena, size_t count, size_t size)
{
	void *memory = NULL;
	size_t bytes;
	if (!__builtin_mul_overflow(count, size, &bytes))
		memory = calloc(bytes ? bytes : 1, 1);
	if (!memory)
		longjmp(arena->failed, 1);
	return memory;
}

void *lod_arena_take(struct lod_arena *arena, size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2)
		longjmp(arena->failed, 1);
	struct lod_arena_piece *piece = lod_arena_own(arena, 1, sizeof *piece + (bytes ? bytes : 1));
	piece->before = arena->last;
	arena->last = piece;
	return piece->data;
}

void lod_arena_release(struct lod_arena *arena, const struct lod_arena_piece *mark)
{
	while (arena->last != mark) {
		struct lod_arena_piece *piece = arena->last;
		arena->last = piece->before;
		free(piece);
	}
}

void lod_arena_free(struct lod_arena *arena)
{
	if (arena->inner)
		lod_arena_free(arena->inner);
	arena->inner = NULL;
	lod_arena_release(arena, NULL);
}
