/* Shared by the encoder and the decoder of a SHAPES chunk: one description of the bytes. Private to
 * chunk_shapes*.c and chunk_corners*.c.
 *
 *   codec.shapes, head, extra_count, uv, seen, keys, slots  encoder: set; decoder: extra_count, uv, seen
 *   eco_shapes_start(&codec, elements); eco_range_write(&codec.range, &writer) or eco_range_read(...)
 *   eco_shapes_code_head(&codec);                           decoder: fills shapes, head; codec.failed:
 *                                                           impossible
 *   eco_corners_plan(&codec, &leaf);                        encoder: for an element that is not placed
 *   eco_shapes_code_leaf(&codec, &leaf); ...                each element, in stored order
 *   eco_range_end(&codec.range); */
#ifndef ECO_CHUNK_SHAPES_H
#define ECO_CHUNK_SHAPES_H

#include "ecofiles/format/chunk/chunk_corners.h"
#include "ecofiles/format/chunk/chunk_rows.h"
#include "ecofiles/base/range.h"
#include "ecofiles/format/chunk/shape.h"

#define ECO_STEPS_MODELLED 16u
#define ECO_WAY_MODELLED 2u      /* high bits that have models; those below are as good as random */
#define ECO_FIELD_MODELLED 3u
#define ECO_EXTRA_MODELLED 6u

/* A field's values lie in [low, low + 2^bits). */
struct eco_span { int32_t low; uint8_t bits; };

struct eco_shapes_head {
	bool sorted;                 /* along the curve */
	struct eco_span first[3];        /* of first corners, coarse grid; bits of all axes in [0] */
	struct eco_span size[3], extra[ECO_ROWS_EXTRA_MAX];
	uint8_t trends[ECO_CORNERS_MAX - 2];         /* number, at [corners - 3] */
	struct eco_trend trend[ECO_CORNERS_MAX - 2][ECO_TRENDS_MAX];
};

struct eco_shapes_codec {
	struct eco_range range;
	uint32_t extra_count;
	bool uv, failed;
	struct eco_shapes shapes;
	struct eco_shapes_head head;
	uint32_t left;               /* elements still to be coded, this one included */
	uint64_t key;                /* key of the element before */
	uint8_t corners;             /* corners of the element before */
	int32_t uv_before[2 * ECO_CORNERS_MAX];      /* uv of the last element that is not placed */
	/* Corners of elements that are not placed, each once: 3 values each, with room for all corners of
	 * the chunk. Connected leaves share corners. */
	int32_t *seen;
	uint32_t seen_count;
	int32_t *keys;               /* writing: as `seen`, on the coarse grid */
	uint32_t *slots, slot_mask;  /* writing: hash table, key to last corner; empty: UINT32_MAX */
	struct eco_near near;
	struct eco_scale miss[ECO_CORNERS_MAX][3];       /* per corner and coordinate */
	struct eco_bit number[ECO_RANGE_NUMBER], flat[ECO_RANGE_NUMBER], weight[ECO_RANGE_NUMBER], kind[128],
		corner_count[4];
	struct eco_bit back, above, up[ECO_STEPS_MODELLED], down[ECO_STEPS_MODELLED];
	struct eco_bit way[2][1 << ECO_WAY_MODELLED], roll[1 << ECO_FIELD_MODELLED],
		size[3][1 << ECO_FIELD_MODELLED];
	struct eco_bit extra[ECO_ROWS_EXTRA_MAX][1 << ECO_EXTRA_MODELLED], texture[2][ECO_RANGE_NUMBER];
	struct eco_bit trend[ECO_CORNERS_MAX - 2][4], again[ECO_CORNERS_MAX], back_bits[32];
};

/* One element as it is coded. */
struct eco_leaf {
	uint32_t shape;              /* shapes.count: not placed */
	uint8_t corners;
	struct eco_placing placing;
	int32_t position[3 * ECO_CORNERS_MAX];       /* decoded, or on the fine grid where not placed */
	int32_t uv[2 * ECO_CORNERS_MAX], extra[ECO_ROWS_EXTRA_MAX];
	/* for an element that is not placed: */
	uint8_t trend;               /* head.trends[]: none */
	int32_t miss[3 * ECO_CORNERS_MAX];
	uint32_t found[ECO_CORNERS_MAX];     /* writing: index in `seen`, or UINT32_MAX */
	const int32_t *coarse, *exact;       /* writing: its corners on both grids */
};

static inline uint32_t eco_bit_length(uint64_t v)
{
	return v ? 64u - (uint32_t)__builtin_clzll(v) : 0;
}

void eco_shapes_start(struct eco_shapes_codec *codec, uint32_t elements);
void eco_shapes_code_head(struct eco_shapes_codec *codec);
void eco_shapes_code_leaf(struct eco_shapes_codec *codec, struct eco_leaf *leaf);

/* Writing: chooses the trend that fits an element that is not placed, and for each corner its miss or an
 * earlier corner. Fills trend, miss, found and position from `exact` and `coarse`. Call it just before the
 * element is coded. */
void eco_corners_plan(const struct eco_shapes_codec *codec, struct eco_leaf *leaf);
/* Writing: finds the trends of elements of `corners` corners. at[i] of `count` are their corners on the
 * fine grid; each stands for `share` elements. False: out of memory. */
bool eco_corners_trends(struct eco_shapes_head *head, uint32_t corners, const int32_t *const *at,
	uint32_t count, double share);
/* The slot that a corner with this key has or would get. */
uint32_t eco_corners_slot(const struct eco_shapes_codec *codec, const int32_t key[3]);

/* A placed shape's first corner: on the coarse grid, and the remaining steps of 2^place_shift; `offset`
 * from eco_shape_turn. */
void eco_shapes_first(const struct eco_shapes *shapes, const struct eco_placing *placing,
	const int32_t *offset, int64_t first[3], uint32_t rest[3]);

#endif
