/* The part of a store that lies on the GPU: a texture of records per list, extended as chunks arrive, and
 * images as textures.
 *
 * Texels that are read by number lie row by row in a 2D texture as wide as a power of two: WebGL has no
 * buffer textures. Texel i is at (i & (width - 1), i >> shift). */
#pragma once

#include "client-min/view_select.h"

/* Texels of four 4-byte words, of one, of an sRGB colour with alpha (4 bytes), which shaders see as light. */
enum view_gpu_kind { VIEW_GPU_WORDS, VIEW_GPU_WORD, VIEW_GPU_COLOR };

struct view_gpu_texels {                 /* zero is empty */
	unsigned texture;
	enum view_gpu_kind kind;
	uint32_t shift;                  /* width: 1 << shift */
	uint64_t room;                   /* texels */
};

struct view_gpu_list {
	uint32_t id;
	struct view_gpu_texels records;  /* view_record.h, as a usampler2D */
	uint32_t chunks;                 /* uploaded */
	uint64_t texels;                 /* of them */
	/* POINTS: where their centres lie; a splat's longest half axis, or the largest root of eco_size */
	float low[3], high[3], reach;
	/* IMAGE: colour and alpha with mip levels; else 0. As far as it was shown */
	unsigned color;
	uint32_t shown[2];
};

struct view_gpu {                        /* zero is empty */
	struct view_gpu_list *lists;     uint32_t count, room;
	struct view_table table;
	uint32_t side_max;               /* of a texture */
	uint64_t bytes;                  /* of all records */
	bool unchecked;                  /* lists have textures that view_gpu_check was not asked about */
};

/* A texture without mip levels, which ends at its edges, bound to the unit that is active. */
unsigned view_gpu_texture(unsigned format, uint32_t width, uint32_t height, int filter);

void view_gpu_init(struct view_gpu *gpu);
void view_gpu_free(struct view_gpu *gpu);
/* Frees what is here of lists that none of the stores holds any more, or holds less of. */
void view_gpu_keep(struct view_gpu *gpu, const struct view_store *const *stores, uint32_t count);
/* The list with all chunks that the store holds uploaded. The pointer is valid until the next call. */
enum eco_code view_gpu_list(struct view_gpu *gpu, const struct view_list *list,
	const struct view_gpu_list **out, struct eco_error *error);
/* Whether the driver had memory for all lists since the last check: one question for all of them, as each
 * waits for the driver. If it had not, none is here any more. */
enum eco_code view_gpu_check(struct view_gpu *gpu, struct eco_error *error);

/* Room for so many texels; what was in it is gone where it grows. */
enum eco_code view_gpu_room(struct view_gpu *gpu, struct view_gpu_texels *stream, enum view_gpu_kind kind,
	uint64_t texels, struct eco_error *error);
/* Writes texels from number `at` on, within the room. */
void view_gpu_write(const struct view_gpu_texels *t, uint64_t at, const void *data, uint64_t count);
/* Both: replaces all texels, for what changes every frame. */
enum eco_code view_gpu_stream(struct view_gpu *gpu, struct view_gpu_texels *stream, enum view_gpu_kind kind,
	const void *data, uint64_t texels, struct eco_error *error);

/* The largest ratio of a half axis of these members' ellipses to its distance from the eye's plane; INFINITY:
 * it may be more than half. */
double view_extent_ellipses(const struct lod_eye *eye, const struct view_selection *selection,
	const struct view_gpu_list *g, const struct view_list *list, const struct eco_cut *cut,
	const uint32_t *members, uint32_t count);
