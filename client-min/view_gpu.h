/* The part of a store that lies on the GPU: a buffer texture of records per list, extended as chunks arrive,
 * and images as textures. */
#ifndef VIEW_GPU_H
#define VIEW_GPU_H

#include "client-min/view_store.h"
#include "client-min/view_table.h"

struct view_gpu_list {
	uint32_t id;
	unsigned buffer, texture;        /* records (view_record.h) as a usamplerBuffer */
	uint32_t chunks;                 /* uploaded */
	uint64_t texels, room;
	/* IMAGE: filtered colour with mip levels, and nearest alpha; else 0. As far as it was shown */
	unsigned color, alpha;
	uint32_t shown[2];
};

struct view_gpu {                        /* zero is empty */
	struct view_gpu_list *lists;     uint32_t count, room;
	struct view_table table;
	uint64_t texels_max;             /* of a buffer texture */
	uint64_t bytes;                  /* of all records */
};

void view_gpu_init(struct view_gpu *gpu);
void view_gpu_free(struct view_gpu *gpu);
/* Frees what is here of lists that none of the stores holds any more, or holds less of. */
void view_gpu_keep(struct view_gpu *gpu, const struct view_store *const *stores, uint32_t count);
/* The list with all chunks that the store holds uploaded. The pointer is valid until the next call. */
enum eco_code view_gpu_list(struct view_gpu *gpu, const struct view_list *list,
	const struct view_gpu_list **out, struct eco_error *error);

/* A buffer texture whose content is replaced as a whole, for what changes every frame. `format` is a GL
 * format of 4-byte words. */
struct view_gpu_stream { unsigned buffer, texture; };
enum eco_code view_gpu_stream(struct view_gpu *gpu, struct view_gpu_stream *stream, unsigned format,
	const void *bytes, size_t size, uint64_t texels, struct eco_error *error);

#endif
