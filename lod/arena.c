#include "lod/arena.h"

#include <stdint.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"

struct lod_arena_piece {
	struct lod_arena_piece *before;
	max_align_t data[];
};

void *lod_arena_try(struct lod_arena *arena, size_t count, size_t size)
{
	size_t bytes;
	struct lod_arena_piece *piece = NULL;
	if (!__builtin_mul_overflow(count, size, &bytes) && bytes <= SIZE_MAX / 2)
		piece = calloc(1, sizeof *piece + bytes);
	arena->failed |= !piece;
	if (!piece)
		return NULL;
	piece->before = arena->last;
	arena->last = piece;
	return piece->data;
}

void *lod_arena_take(struct lod_arena *arena, size_t count, size_t size)
{
	void *taken = lod_arena_try(arena, count, size);
	if (!taken)
		eco_end("no memory");
	return taken;
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
	lod_arena_release(arena, NULL);
}
