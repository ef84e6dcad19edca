/* Shared by the encoder and the decoder of a SHAPES chunk: one description of the bytes. Private to
 * chunk_shapes*.c and chunk_corners_encode.c.
 *
 *   codec.shapes, head, extra_count, uv, seen, keys, slots  encoder: set; decoder: extra_count, uv, seen
 *   eco_shapes_start(&codec, elements); eco_range_write(&codec.range, &writer) or eco_range_read(...)
 *   eco_shapes_code_head(&codec);                           decoder: fills shapes, head; codec.failed:
 *                                                           impossible
 *   eco_corners_plan(&codec, &leaf);                        encoder: for an element that is not placed
 *   eco_shapes_code_leaf(&codec, &leaf); ...                each element, in stored order
 *   eco_range_end(&codec.range); */
#pragma once

#include "ecofiles/format/chunk/chunk_rows.h"
#include "ecofiles/base/range.h"
#include "ecofiles/format/chunk/shape.h"

/* ---- Corners ---- */

/* Corners of elements that are not placed shapes: each is stored as the miss of a prediction from the
 * corners before it, along axes of the element's own.
 *
 * Blades and leaves that are each bent a little differently have no shape in common, but they are alike in
 * other ways: how far along the first edge and across it the next corner lies, whether it is level, how
 * far the tip leaves the plane of the first corners. So a corner is predicted as a weighted sum of a few
 * vectors, its bases. The miss is stored along the first edge, a direction across it that is level or
 * points towards the third corner, and their normal: along one or two of these axes misses are small or
 * alike, along the plant's axes they would be equally large on all three. A trend is one set of weights.
 * Elements that begin at another corner or run the other way round need other weights, so a chunk has a
 * few trends, and each element names the one it follows, or none.
 *
 * Misses are rounded to a body-centred cubic lattice. With steps half as wide again as the grid's, no
 * corner is moved further than by the grid, and a corner takes 3/4 bit less (Conway and Sloane 1988,
 * "Sphere Packings, Lattices and Groups", chapter 2: the best covering of space by balls of one size). */

#define ECO_TRENDS_MAX 3u        /* per number of corners */
#define ECO_BASES_MAX 6u
#define ECO_WEIGHT_BITS 8u
#define ECO_WEIGHT_MAX (1 << 12)

struct eco_trend { int32_t weight[ECO_CORNERS_MAX][ECO_BASES_MAX]; };        /* in 256ths */

struct eco_frame {
	int64_t axis[3][3];          /* see eco_axes_first */
	int32_t base[ECO_BASES_MAX][3];
	uint32_t bases;
	int64_t length;              /* of the first edge */
	uint32_t of;                 /* corners known when the axes were set; 0: not set */
};

/* Sets axes and bases of corner k >= 1 from the corners before it, at[0..3k). `frame` is zeroed, or that
 * of an earlier corner of the same element, whose axes are used again. Differences of corners must be
 * below 2^30. */
void eco_corner_frame(struct eco_frame *frame, const int32_t *at, uint32_t k);
/* Number of bases of corner k: k - 1 edges and some vectors across them. */
uint32_t eco_corner_bases(uint32_t k);
/* The predicted place, along the axes, from corner 0. */
void eco_corner_guess(const struct eco_frame *frame, const int32_t *weight, int64_t guess[3]);
/* The place at `miss` steps from the guess. False: out of bounds. */
bool eco_corner_place(const struct eco_frame *frame, const int64_t guess[3], const int32_t miss[3],
	const int32_t *from, int32_t *at);

/* The lattice's step along the first axis. Along the other two it is twice that, offset by one where the
 * first axis has an odd number of steps. */
#define ECO_LATTICE_STEP 6

/* ---- The codec ---- */

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

void eco_shapes_start(struct eco_shapes_codec *codec, uint32_t elements);
void eco_shapes_code_head(struct eco_shapes_codec *codec);
void eco_shapes_code_leaf(struct eco_shapes_codec *codec, struct eco_leaf *leaf);

/* Writing: chooses the trend that fits an element that is not placed, and for each corner its miss or an
 * earlier corner. Fills trend, miss, found and position from `exact` and `coarse`. Call it just before the
 * element is coded. */
void eco_corners_plan(const struct eco_shapes_codec *codec, struct eco_leaf *leaf);
/* Writing: finds the trends of elements of `corners` corners. at[i] of `count` are their corners on the
 * fine grid; each stands for `share` elements. */
void eco_corners_trends(struct eco_shapes_head *head, uint32_t corners, const int32_t *const *at,
	uint32_t count, double share);
/* The slot that a corner with this key has or would get. */
uint32_t eco_corners_slot(const struct eco_shapes_codec *codec, const int32_t key[3]);

/* A placed shape's first corner: on the coarse grid, and the remaining steps of 2^place_shift; `offset`
 * from eco_shape_turn. */
void eco_shapes_first(const struct eco_shapes *shapes, const struct eco_placing *placing,
	const int32_t *offset, int64_t first[3], uint32_t rest[3]);
