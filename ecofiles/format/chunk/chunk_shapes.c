/* SHAPES: the elements of a chunk as placed shapes, and the other elements as corners, in one adaptively
 * coded stream. Most chunks are small: with forty leaves, a second stream's frame or a table of symbols
 * costs more than its content.
 *
 * Stored order is that of ELEMENTS, along a Morton curve through first corners, so that forms of the
 * elements do not depend on this coding. A placed element stores the position of its first corner, as the
 * step along the curve from the element before: this takes log2(n!) bits less than n positions. Centres
 * have other steps than corners, so the two orders may differ by a little; a step back is a rare symbol.
 *
 * The same functions encode and decode. */

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/chunk/chunk_shapes.h"

#define KEY_BITS 20u             /* of each axis, along the curve */
#define UV_MAX ECO_ROWS_VALUE_MAX
#define COARSE_MAX (ECO_ROWS_VALUE_MAX >> ECO_EXACT_SHIFT)
#define SUM_MAX ((int64_t)1 << 30)
#define UNIT 1024                /* length of the bases that do not grow with the element */

/* ---- Prediction of corners, in integers, so that all machines get the same corners ---- */

/* Adds an edge as a base. Bases are edges, not vectors from corner 0: these are longer and would need
 * finer weights. */
static void add_edge(struct eco_frame *f, const int32_t *from, const int32_t *to)
{
	int32_t *base = f->base[f->bases++];
	for (int i = 0; i < 3; i++)
		base[i] = to[i] - from[i];
}

static void add_axis(struct eco_frame *f, const int64_t axis[3], int64_t length)
{
	int32_t *base = f->base[f->bases++];
	for (int i = 0; i < 3; i++)
		base[i] = (int32_t)(axis[i] * length >> ECO_AXIS_BITS);
}

uint32_t eco_corner_bases(uint32_t k)
{
	return k < 2 ? 0 : k == 2 ? 4 : k;
}

static void find_axes(struct eco_frame *f, const int32_t *at, uint32_t of)
{
	int64_t edge[3] = { 0 }, to[3];
	for (int i = 0; i < 3 && of > 1; i++) {
		edge[i] = (int64_t)at[3 + i] - at[i];
		to[i] = of > 2 ? (int64_t)at[6 + i] - at[i] : 0;
	}
	if (f->of < 2)
		f->length = eco_axes_first(edge, f->axis);
	eco_axes_others(of > 2 ? to : NULL, f->axis);
	f->of = of;
}

void eco_corner_frame(struct eco_frame *f, const int32_t *at, uint32_t k)
{
	if (f->of != (k < 3 ? k : 3))
		find_axes(f, at, k < 3 ? k : 3);
	f->bases = 0;
	for (uint32_t j = 1; j < k; j++)
		add_edge(f, at + 3 * j - 3, at + 3 * j);
	if (k > 1)
		add_axis(f, f->axis[2], f->length);
	if (k == 2) {
		add_axis(f, f->axis[1], f->length);
		add_axis(f, f->axis[1], UNIT);
	}
}

void eco_corner_guess(const struct eco_frame *f, const int32_t *weight, int64_t guess[3])
{
	int64_t sum[3];
	for (int i = 0; i < 3; i++) {
		sum[i] = 1 << (ECO_WEIGHT_BITS - 1);
		for (uint32_t j = 0; j < f->bases; j++)
			sum[i] += (int64_t)weight[j] * f->base[j][i];
		sum[i] >>= ECO_WEIGHT_BITS;
		sum[i] = sum[i] > SUM_MAX ? SUM_MAX : sum[i] < -SUM_MAX ? -SUM_MAX : sum[i];
	}
	for (int a = 0; a < 3; a++)
		guess[a] = (sum[0] * f->axis[a][0] + sum[1] * f->axis[a][1] + sum[2] * f->axis[a][2])
			>> ECO_AXIS_BITS;
}

bool eco_corner_place(const struct eco_frame *f, const int64_t guess[3], const int32_t miss[3],
	const int32_t *from, int32_t *at)
{
	int64_t along[3];
	along[0] = guess[0] + (int64_t)ECO_LATTICE_STEP * miss[0];
	for (int a = 1; a < 3; a++)
		along[a] = guess[a] + 2 * (int64_t)ECO_LATTICE_STEP * miss[a]
			+ ECO_LATTICE_STEP * (miss[0] & 1);
	for (int i = 0; i < 3; i++) {
		int64_t v = along[0] * f->axis[0][i] + along[1] * f->axis[1][i] + along[2] * f->axis[2][i];
		v = from[i] + ((v + ((int64_t)1 << (ECO_AXIS_BITS - 1))) >> ECO_AXIS_BITS);
		if (v > ECO_ROWS_VALUE_MAX || v < -ECO_ROWS_VALUE_MAX)
			return false;
		at[i] = (int32_t)v;
	}
	return true;
}

/* ---- Start ---- */

void eco_shapes_start(struct eco_shapes_codec *c, uint32_t elements)
{
	c->left = elements;
	c->key = 0;
	c->corners = 0;
	c->seen_count = 0;
	memset(c->uv_before, 0, sizeof c->uv_before);
	if (c->slots)
		memset(c->slots, 0xff, ((size_t)c->slot_mask + 1) * sizeof *c->slots);
	eco_bits_start(c->again, ECO_CORNERS_MAX);
	eco_bits_start(c->back_bits, 32);
	eco_bits_start(c->number, ECO_RANGE_NUMBER);
	eco_bits_start(c->flat, ECO_RANGE_NUMBER);
	eco_bits_start(c->weight, ECO_RANGE_NUMBER);
	eco_bits_start(c->kind, 128);
	eco_bits_start(c->corner_count, 4);
	eco_bits_start(&c->back, 1);
	eco_bits_start(&c->above, 1);
	eco_bits_start(c->up, ECO_STEPS_MODELLED);
	eco_bits_start(c->down, ECO_STEPS_MODELLED);
	eco_bits_start(c->way[0], sizeof c->way / sizeof c->way[0][0]);
	eco_bits_start(c->roll, sizeof c->roll / sizeof c->roll[0]);
	eco_bits_start(c->size[0], sizeof c->size / sizeof c->size[0][0]);
	eco_bits_start(c->extra[0], sizeof c->extra / sizeof c->extra[0][0]);
	eco_bits_start(c->texture[0], sizeof c->texture / sizeof c->texture[0][0]);
	eco_bits_start(c->trend[0], sizeof c->trend / sizeof c->trend[0][0]);
	eco_near_start(&c->near, c->miss[0], sizeof c->miss / sizeof c->miss[0][0]);
}

/* ---- The chunk's common data ---- */

/* A value that must be within [low, high]. */
static int32_t code_number(struct eco_shapes_codec *c, struct eco_bit *models, int32_t value, int32_t low,
	int32_t high)
{
	int32_t v = eco_range_number(&c->range, models, value);
	if (v < low || v > high) {
		c->failed = true;
		return low > 0 ? low : high < 0 ? high : 0;
	}
	return v;
}

static void code_span(struct eco_shapes_codec *c, struct eco_span *s)
{
	s->low = code_number(c, c->number, s->low, -ECO_ROWS_VALUE_MAX, ECO_ROWS_VALUE_MAX);
	s->bits = (uint8_t)eco_range_raw(&c->range, 5, s->bits);
	if (s->bits > 29)
		c->failed = true;
}

/* Number of zero bits at the end of all coordinates. */
static uint32_t common_shift(const struct eco_shapes *shapes)
{
	uint32_t any = 1u << 12;
	for (uint32_t i = 0; i < shapes->count; i++)
		for (uint32_t k = 0; k < 3u * shapes->items[i].corners; k++)
			any |= (uint32_t)shapes->items[i].position[k];
	return (uint32_t)__builtin_ctz(any);
}

static void code_shape(struct eco_shapes_codec *c, struct eco_shape *s, uint32_t shift)
{
	const int32_t most = ECO_SHAPE_COORDINATE_MAX >> shift;
	s->corners = (uint8_t)(3 + eco_range_raw(&c->range, 2, s->corners - 3u));
	for (uint32_t k = 0; k < 3u * s->corners; k++)
		s->position[k] = code_number(c, k % 3 == 2 ? c->flat : c->number,
			s->position[k] / (1 << shift), -most, most) * (1 << shift);
	for (uint32_t k = 0; c->uv && k < 2u * s->corners; k++) {
		int32_t before = k < 2 ? 0 : s->uv[k - 2];
		s->uv[k] = before + code_number(c, c->texture[k & 1], s->uv[k] - before, -UV_MAX - before,
			UV_MAX - before);
	}
}

static void code_shapes(struct eco_shapes_codec *c)
{
	struct eco_shapes *s = &c->shapes;
	s->count = (uint32_t)eco_range_raw(&c->range, 7, s->count);
	if (s->count > ECO_SHAPES_MAX)
		c->failed = true;
	if (c->failed || s->count == 0)
		return;
	s->stretch = (uint8_t)eco_range_raw(&c->range, 2, s->stretch);
	s->place_shift = (uint8_t)eco_range_raw(&c->range, 2, s->place_shift);
	s->way_bits = (uint8_t)eco_range_raw(&c->range, 4, s->way_bits);
	s->roll_bits = (uint8_t)eco_range_raw(&c->range, 4, s->roll_bits);
	if (s->way_bits > ECO_SHAPE_TURN_BITS_MAX || s->roll_bits > ECO_SHAPE_TURN_BITS_MAX)
		c->failed = true;
	for (uint32_t i = 0; i < 3; i++) {
		if (i > 0 && (s->stretch == ECO_STRETCH_NONE || (i == 2 && s->stretch != ECO_STRETCH_ALL)))
			continue;
		s->size_shift[i] = (uint8_t)eco_range_raw(&c->range, 3, s->size_shift[i]);
		code_span(c, &c->head.size[i]);
	}
	uint32_t shift = (uint32_t)eco_range_raw(&c->range, 4, c->range.writer ? common_shift(s) : 0);

	if (shift > 12)
		c->failed = true;
	for (uint32_t i = 0; i < s->count && !c->failed; i++)
		code_shape(c, &s->items[i], shift);
}

/* The default trend puts a corner near those before it: edges weigh 1, vectors across them 0. Weights are
 * coded relative to it. */
static void code_trends(struct eco_shapes_codec *c, uint32_t m)
{
	struct eco_shapes_head *h = &c->head;
	h->trends[m] = (uint8_t)eco_range_raw(&c->range, 2, h->trends[m]);
	for (uint32_t t = 0; t < h->trends[m]; t++)
		for (uint32_t k = 2; k < m + 3; k++)
			for (uint32_t j = 0; j < eco_corner_bases(k); j++) {
				int32_t usual = j + 1 < k ? 1 << ECO_WEIGHT_BITS : 0,
					*weight = &h->trend[m][t].weight[k][j];
				*weight = usual + code_number(c, c->weight, *weight - usual,
					-ECO_WEIGHT_MAX - usual, ECO_WEIGHT_MAX - usual);
			}
}

void eco_shapes_code_head(struct eco_shapes_codec *c)
{
	struct eco_shapes_head *h = &c->head;
	h->sorted = eco_range_raw(&c->range, 1, h->sorted);
	for (uint32_t i = 0; i < 3; i++)
		h->first[i].low = code_number(c, c->number, h->first[i].low, -COARSE_MAX, COARSE_MAX);
	h->first[0].bits = (uint8_t)eco_range_raw(&c->range, 5, h->first[0].bits);
	if (h->first[0].bits > 29)
		c->failed = true;
	for (uint32_t i = 0; i < c->extra_count; i++)
		code_span(c, &h->extra[i]);
	for (uint32_t m = 0; m < ECO_CORNERS_MAX - 2; m++)
		code_trends(c, m);
	if (!c->failed)
		code_shapes(c);
}

/* ---- Positions ---- */

static uint64_t spread(uint64_t v)
{
	v = (v | v << 32) & 0x1f00000000ffff;
	v = (v | v << 16) & 0x1f0000ff0000ff;
	v = (v | v << 8) & 0x100f00f00f00f00f;
	v = (v | v << 4) & 0x10c30c30c30c30c3;
	return (v | v << 2) & 0x1249249249249249;
}

static uint32_t gather(uint64_t v)
{
	v &= 0x1249249249249249;
	v = (v | v >> 2) & 0x10c30c30c30c30c3;
	v = (v | v >> 4) & 0x100f00f00f00f00f;
	v = (v | v >> 8) & 0x1f0000ff0000ff;
	v = (v | v >> 16) & 0x1f00000000ffff;
	return (uint32_t)(v | v >> 32) & 0x1fffff;
}

static uint32_t code_steps(struct eco_shapes_codec *c, struct eco_bit *models, uint32_t most, uint32_t value)
{
	return eco_range_unary(&c->range, models, ECO_STEPS_MODELLED, most, value);
}

/* The gap from one key to the next. The gaps of n random keys are exponentially distributed, with a mean
 * that both sides know. Codes the gap's number of bits relative to the mean's, up or down, then the bits. */
static uint64_t code_key(struct eco_shapes_codec *c, uint32_t bits, uint64_t key)
{
	uint64_t end = (uint64_t)1 << bits, mean = (end - c->key) / c->left;
	uint32_t usual = eco_bit_length(mean);
	bool back = eco_range_bit(&c->range, &c->back, key < c->key);
	uint64_t gap = back ? c->key - key : key - c->key;
	uint32_t length = eco_bit_length(gap);
	if (eco_range_bit(&c->range, &c->above, length > usual))
		length = usual + 1 + code_steps(c, c->up, bits - (usual < bits ? usual + 1 : bits),
			length - usual - 1);
	else
		length = usual - code_steps(c, c->down, usual, usual - length);
	if (length > 62) {
		c->failed = true;
		return 0;
	}
	if (length > 0)
		gap = (uint64_t)1 << (length - 1) | eco_range_raw(&c->range, length - 1,
			gap & (((uint64_t)1 << (length - 1)) - 1));
	else
		gap = 0;
	if (back ? gap > c->key : gap >= end - c->key) {
		c->failed = true;
		return 0;
	}
	c->key = back ? c->key - gap : c->key + gap;
	return c->key;
}

/* The first corner on the coarse grid, relative to head.first. */
static void code_first(struct eco_shapes_codec *c, uint8_t corners, uint32_t first[3])
{
	uint32_t width = c->head.first[0].bits, bits = width < KEY_BITS ? width : KEY_BITS,
		rest = width - bits;
	if (corners != c->corners)
		c->key = 0;
	c->corners = corners;
	if (!c->head.sorted) {
		for (uint32_t i = 0; i < 3; i++)
			first[i] = (uint32_t)eco_range_raw(&c->range, width, first[i]);
		return;
	}
	uint64_t key = code_key(c, 3 * bits, spread(first[0] >> rest) << 2 | spread(first[1] >> rest) << 1
		| spread(first[2] >> rest));

	for (uint32_t i = 0; i < 3; i++)
		first[i] = gather(key >> (2 - i)) << rest | (uint32_t)eco_range_raw(&c->range, rest,
			first[i] & ((1u << rest) - 1));
}

/* ---- Elements ---- */

/* The step from centre to first corner, in 2^place_shift, from the offset alone, which both sides know. */
static int64_t lead_of(const struct eco_shapes *s, const int32_t *offset, uint32_t axis)
{
	return ((int64_t)offset[axis] + (1 << s->place_shift >> 1)) >> s->place_shift;
}

void eco_shapes_first(const struct eco_shapes *s, const struct eco_placing *placing, const int32_t *offset,
	int64_t first[3], uint32_t rest[3])
{
	uint32_t finer = ECO_EXACT_SHIFT - s->place_shift;
	for (uint32_t i = 0; i < 3; i++) {
		int64_t from = placing->center[i] + lead_of(s, offset, i) + (1 << finer >> 1);
		first[i] = from >> finer;
		rest[i] = (uint32_t)(from & ((1 << finer) - 1));
	}
}

static void code_center(struct eco_shapes_codec *c, struct eco_leaf *l, const int32_t *offset)
{
	uint32_t finer = ECO_EXACT_SHIFT - c->shapes.place_shift, first[3] = { 0 }, rest[3] = { 0 };
	int64_t at[3];
	if (c->range.writer)
		eco_shapes_first(&c->shapes, &l->placing, offset, at, rest);
	for (uint32_t i = 0; i < 3 && c->range.writer; i++)
		first[i] = (uint32_t)(at[i] - c->head.first[i].low);
	code_first(c, l->corners, first);
	uint32_t all = (uint32_t)eco_range_raw(&c->range, 3 * finer,
		rest[0] | rest[1] << finer | rest[2] << 2 * finer);

	for (uint32_t i = 0; i < 3; i++) {
		int64_t from = (int64_t)first[i] + c->head.first[i].low;
		from = from * (1 << finer) + (all >> i * finer & ((1u << finer) - 1)) - (1 << finer >> 1)
			- lead_of(&c->shapes, offset, i);
		if (from > 2 * (int64_t)ECO_ROWS_VALUE_MAX || from < -2 * (int64_t)ECO_ROWS_VALUE_MAX) {
			c->failed = true;
			return;
		}
		l->placing.center[i] = (int32_t)from;
	}
}

static int32_t code_in_span(struct eco_shapes_codec *c, struct eco_bit *models, unsigned modelled,
	const struct eco_span *s, int32_t value)
{
	return s->low + (int32_t)eco_range_field(&c->range, models, modelled, s->bits,
		(uint32_t)(value - s->low));
}

static void code_placed(struct eco_shapes_codec *c, struct eco_leaf *l)
{
	const struct eco_shape *shape = &c->shapes.items[l->shape];
	struct eco_placing *p = &l->placing;
	uint32_t way = c->shapes.way_bits + 1u, sizes = c->shapes.stretch == ECO_STRETCH_NONE ? 1
		: c->shapes.stretch == ECO_STRETCH_ALL ? 3 : 2;
	int32_t offset[3 * ECO_CORNERS_MAX];
	l->corners = shape->corners;
	for (uint32_t i = 0; i < 2; i++)
		p->way[i] = (int32_t)eco_range_field(&c->range, c->way[i], ECO_WAY_MODELLED, way,
			(uint32_t)p->way[i]);
	p->roll = (int32_t)eco_range_field(&c->range, c->roll, ECO_FIELD_MODELLED, c->shapes.roll_bits + 2u,
		(uint32_t)p->roll);
	for (uint32_t i = 0; i < sizes; i++)
		p->size[i] = code_in_span(c, c->size[i], ECO_FIELD_MODELLED, &c->head.size[i], p->size[i]);
	if (!eco_shape_turn(&c->shapes, shape, p, offset)) {
		c->failed = true;
		return;
	}
	code_center(c, l, offset);
	if (!c->failed && !eco_shape_place(&c->shapes, p, offset, shape->corners, l->position))
		c->failed = true;
	memcpy(l->uv, shape->uv, sizeof l->uv);
}

uint32_t eco_corners_slot(const struct eco_shapes_codec *c, const int32_t key[3])
{
	uint32_t slot = ((uint32_t)key[0] * 0x9e3779b1u ^ (uint32_t)key[1] * 0x85ebca6bu ^ (uint32_t)key[2]
		* 0xc2b2ae35u);
	slot = (slot ^ slot >> 15) & c->slot_mask;
	while (c->slots[slot] != UINT32_MAX
			&& memcmp(c->keys + 3 * (size_t)c->slots[slot], key, 3 * sizeof *key) != 0)
		slot = (slot + 1) & c->slot_mask;
	return slot;
}

static void remember(struct eco_shapes_codec *c, const struct eco_leaf *l, uint32_t k)
{
	if (c->range.writer) {
		memcpy(c->keys + 3 * (size_t)c->seen_count, l->coarse + 3 * k, 3 * sizeof *c->keys);
		c->slots[eco_corners_slot(c, l->coarse + 3 * k)] = c->seen_count;
	}
	memcpy(c->seen + 3 * (size_t)c->seen_count++, l->position + 3 * k, 3 * sizeof *c->seen);
}

/* A corner that occurred before is coded by how long ago. False: it did not occur, and only that is coded. */
static bool code_again(struct eco_shapes_codec *c, struct eco_leaf *l, uint32_t k)
{
	uint32_t ago = c->seen_count - l->found[k];
	if (!eco_range_bit(&c->range, &c->again[k], l->found[k] != UINT32_MAX))
		return false;
	ago = (uint32_t)eco_range_size(&c->range, c->back_bits, 5, ago);
	if (ago == 0 || ago > c->seen_count)
		c->failed = true;
	else
		memcpy(l->position + 3 * k, c->seen + 3 * (size_t)(c->seen_count - ago), 3 * sizeof *c->seen);
	return true;
}

/* A corner as the miss of its trend; without a trend, in the world's axes from the corner before. */
static void code_corner(struct eco_shapes_codec *c, struct eco_leaf *l, uint32_t k, struct eco_frame *frame)
{
	int32_t *miss = l->miss + 3 * k, *at = l->position + 3 * k;
	int64_t guess[3];
	for (uint32_t i = 0; i < 3; i++)
		miss[i] = eco_range_near(&c->range, &c->near, &c->miss[k][i], miss[i]);
	if (l->trend < c->head.trends[l->corners - 3]) {
		eco_corner_frame(frame, l->position, k);
		eco_corner_guess(frame, c->head.trend[l->corners - 3][l->trend].weight[k], guess);
		c->failed |= !eco_corner_place(frame, guess, miss, l->position, at);
	} else {
		for (uint32_t i = 0; i < 3; i++) {
			int64_t v = at[(int32_t)i - 3] + (int64_t)miss[i] * (1 << ECO_EXACT_SHIFT);
			c->failed |= v > ECO_ROWS_VALUE_MAX || v < -ECO_ROWS_VALUE_MAX;
			at[i] = (int32_t)v;
		}
	}
}

static void code_corners(struct eco_shapes_codec *c, struct eco_leaf *l)
{
	uint32_t first[3];
	struct eco_frame frame = { .of = 0 };
	l->corners = (uint8_t)(3 + (eco_range_tree(&c->range, c->corner_count, 2, l->corners - 3u)));
	for (uint32_t i = 0; i < 3; i++)
		first[i] = c->range.writer ? (uint32_t)(l->coarse[i] - c->head.first[i].low) : 0;
	code_first(c, l->corners, first);
	for (uint32_t i = 0; i < 3 && !c->failed; i++) {
		int64_t v = (int64_t)first[i] + c->head.first[i].low;
		c->failed = v > COARSE_MAX || v < -COARSE_MAX;
		l->position[i] = c->failed ? 0 : (int32_t)v * (1 << ECO_EXACT_SHIFT);
	}
	if (c->failed)
		return;
	uint32_t trends = c->head.trends[l->corners - 3], bits = eco_bit_length(trends);

	l->trend = (uint8_t)eco_range_tree(&c->range, c->trend[l->corners - 3], bits, l->trend);
	if (l->trend > trends)
		c->failed = true;
	remember(c, l, 0);
	for (uint32_t k = 1; k < l->corners && !c->failed; k++)
		if (!code_again(c, l, k)) {
			code_corner(c, l, k, &frame);
			remember(c, l, k);
		}
}

/* Texture coordinates: the same picture may lie elsewhere in the image, so the steps from corner to corner
 * of the element before predict this one's. */
static void code_texture(struct eco_shapes_codec *c, struct eco_leaf *l)
{
	for (uint32_t i = 0; i < 2u * l->corners; i++) {
		int64_t guess = i < 2 ? c->uv_before[i] : (int64_t)l->uv[i - 2] + c->uv_before[i]
			- c->uv_before[i - 2];
		int64_t v = guess + eco_range_number(&c->range, c->texture[i & 1],
			c->range.writer ? (int32_t)(l->uv[i] - guess) : 0);
		if (v > UV_MAX || v < -UV_MAX) {
			c->failed = true;
			return;
		}
		l->uv[i] = (int32_t)v;
	}
	memcpy(c->uv_before, l->uv, 2u * l->corners * sizeof *l->uv);
}

void eco_shapes_code_leaf(struct eco_shapes_codec *c, struct eco_leaf *l)
{
	uint32_t kinds = eco_bit_length(c->shapes.count);
	l->shape = eco_range_tree(&c->range, c->kind, kinds, l->shape);
	if (l->shape > c->shapes.count) {
		c->failed = true;
		return;
	}
	if (l->shape < c->shapes.count) {
		code_placed(c, l);
	} else {
		code_corners(c, l);
		if (c->uv && !c->failed)
			code_texture(c, l);
	}
	for (uint32_t i = 0; i < c->extra_count && !c->failed; i++) {
		l->extra[i] = code_in_span(c, c->extra[i], ECO_EXTRA_MODELLED, &c->head.extra[i],
			l->extra[i]);
		if (l->extra[i] > ECO_ROWS_VALUE_MAX)
			c->failed = true;
	}
	c->left--;
}

/* ---- Decoding ---- */

enum eco_code eco_shapes_decode(const struct eco_list *list, const struct eco_stream *stream,
	struct eco_elements *stored, struct eco_error *error)
{
	struct eco_shapes_codec *c = calloc(1, sizeof *c);
	struct eco_shape *shapes = calloc(ECO_SHAPES_MAX, sizeof *shapes);
	size_t corner = 0, primitives = 0;
	if (c)
		c->seen = malloc(3 * sizeof *c->seen * ((size_t)stored->corner_count + ECO_CORNERS_MAX));
	if (!c || !c->seen || !shapes) {
		if (c)
			free(c->seen);
		free(c);
		free(shapes);
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for its shapes");
	}
	c->shapes.items = shapes;
	c->extra_count = stored->extra_count;
	c->uv = (list->attributes & ECO_ATTR_UV) != 0;
	eco_shapes_start(c, stored->element_count);
	eco_range_read(&c->range, stream->bytes, stream->size);
	eco_shapes_code_head(c);
	for (uint32_t i = 0; i < stored->element_count && !c->failed; i++) {
		struct eco_leaf l = { .shape = 0 };
		eco_shapes_code_leaf(c, &l);
		if (c->failed || corner + l.corners > stored->corner_count) {
			c->failed = true;
			break;
		}
		stored->corners[i] = l.corners;
		memcpy(stored->position + 3 * corner, l.position, 3u * l.corners * sizeof *l.position);
		if (c->uv)
			memcpy(stored->uv + 2 * corner, l.uv, 2u * l.corners * sizeof *l.uv);
		for (uint32_t k = 0; k < c->extra_count; k++)
			stored->extra[(size_t)c->extra_count * i + k] = l.extra[k];
		corner += l.corners;
		primitives += l.corners - 2u;
	}
	bool good = !c->failed && eco_range_end(&c->range) == stream->zeros
		&& primitives == stored->primitive_count;

	eco_shapes_free(&c->shapes);
	free(c->seen);
	free(c);
	return good ? ECO_OK : eco_fail(error, ECO_DAMAGED, "chunk: its placed shapes are cut short or hold "
		"impossible values");
}
