/* What the encoder and the decoder of a SHAPES chunk share: one description of the bytes for both. Private to chunk_shapes*.c.
 *
 *   codec.shapes, head, extra_count, uv, seen, slots        encoder: set; decoder: extra_count, uv, seen
 *   eco_shapes_start(&codec, elements); eco_range_write(&codec.range, &writer) or eco_range_read(...)
 *   eco_shapes_code_head(&codec);                           decoder: fills shapes and head; codec.failed where values are impossible
 *   eco_shapes_code_leaf(&codec, &leaf); ...                each element, in stored order
 *   eco_range_end(&codec.range); */
#ifndef ECO_CHUNK_SHAPES_H
#define ECO_CHUNK_SHAPES_H

#include "ecofiles/chunk_rows.h"
#include "ecofiles/range.h"
#include "ecofiles/shape.h"

#define ECO_STEPS_MODELLED 16u
#define ECO_WAY_MODELLED 2u      /* bits at the high end of values that are learned; those below are as good as random */
#define ECO_FIELD_MODELLED 3u
#define ECO_EXTRA_MODELLED 6u

/* A field's values lie in [low, low + 2^bits). */
struct eco_span { int32_t low; uint8_t bits; };

struct eco_shapes_head {
	bool sorted;                 /* along the curve */
	struct eco_span first[3];        /* first corners on the coarse grid; all of `bits` of [0] */
	struct eco_span size[3], extra[ECO_ROWS_EXTRA_MAX];
	/* [corners - 3][k]: corner k, relative to corner 0, is about the sum of these 1024ths of corners 1 to k - 1, relative to it. So leaves
	 * that are one another's affine images have but as many corners to be stored as span them. */
	bool has[ECO_CORNERS_MAX - 2];       /* whether there are elements of so many corners that are not placed */
	uint8_t simple[ECO_CORNERS_MAX - 2][ECO_CORNERS_MAX];        /* which of eco_shapes_simple those are; none of them from ECO_SIMPLE_WEIGHTS on */
	int32_t weight[ECO_CORNERS_MAX - 2][ECO_CORNERS_MAX][ECO_CORNERS_MAX - 1];
};

struct eco_shapes_codec {
	struct eco_range range;
	uint32_t extra_count;
	bool uv, failed;
	struct eco_shapes shapes;
	struct eco_shapes_head head;
	uint32_t left;               /* elements from here on */
	uint64_t key;                /* of the element before */
	uint8_t corners;             /* that it has */
	int32_t uv_before[2 * ECO_CORNERS_MAX];      /* of the last element that is not placed */
	/* Corners of elements that are not placed, on the coarse grid, each once: 3 values each, with room for all corners of the chunk.
	 * Leaves that hang together share corners. */
	int32_t *seen;
	uint32_t seen_count;
	uint32_t *slots, slot_mask;  /* writing: where a corner is in `seen`, by hash; empty: UINT32_MAX. More slots than corners */
	struct eco_bit number[ECO_RANGE_NUMBER], flat[ECO_RANGE_NUMBER], simple[8], kind[128], corner_count[4], back, above, up[ECO_STEPS_MODELLED], down[ECO_STEPS_MODELLED],
		way[2][1 << ECO_WAY_MODELLED], roll[1 << ECO_FIELD_MODELLED], size[3][1 << ECO_FIELD_MODELLED], extra[ECO_ROWS_EXTRA_MAX][1 << ECO_EXTRA_MODELLED],
		corner[ECO_CORNERS_MAX][ECO_RANGE_NUMBER], texture[2][ECO_RANGE_NUMBER],
		again[ECO_CORNERS_MAX], back_bits[32];
};

/* One element as it is coded. */
struct eco_leaf {
	uint32_t shape;              /* shapes.count: not placed */
	uint8_t corners;
	struct eco_placing placing;
	int32_t position[3 * ECO_CORNERS_MAX];       /* out, or of what is not placed, on the fine grid */
	int32_t uv[2 * ECO_CORNERS_MAX], extra[ECO_ROWS_EXTRA_MAX];
};

static inline uint32_t eco_bit_length(uint64_t v)
{
	return v ? 64u - (uint32_t)__builtin_clzll(v) : 0;
}

#define ECO_SIMPLE_WEIGHTS 4u    /* of the corner before, and of the one before that */
extern const int8_t eco_shapes_simple[ECO_SIMPLE_WEIGHTS][2];

/* What head.weight says of one coordinate of corner k >= 1, relative to corner 0. */
#define ECO_WEIGHT_BITS 10u
#define ECO_WEIGHT_MAX (1 << 14)
int64_t eco_shapes_predict(const struct eco_shapes_head *head, const int32_t *position, uint32_t corners, uint32_t k, uint32_t axis);

void eco_shapes_start(struct eco_shapes_codec *codec, uint32_t elements);
void eco_shapes_code_head(struct eco_shapes_codec *codec);
void eco_shapes_code_leaf(struct eco_shapes_codec *codec, struct eco_leaf *leaf);

/* Where a placed shape's first corner is, on the coarse grid and so many steps of 2^place_shift further; `offset` as of eco_shape_turn. */
void eco_shapes_first(const struct eco_shapes *shapes, const struct eco_placing *placing, const int32_t *offset, int64_t first[3],
	uint32_t rest[3]);

#endif
