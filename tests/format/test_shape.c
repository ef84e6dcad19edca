/* Shapes that repeat: found whatever their turn, size and stretch, placed no further off than rounding would
 * put them, and refused when damaged; and what is coded beside them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/chunk/shape.h"
#include "tests/support/unit_test.h"

#define LEAVES 400u

static uint32_t state = 1;

static double uniform(void)
{
	state = state * 1664525u + 1013904223u;
	return (state >> 8) / 16777216.0;
}

static const double quad[4][3] = { { 0, 0, 0 }, { 1, .4, .1 }, { 2.2, 0, 0 }, { 1, -.4, .1 } };
static const double kite[3][3] = { { 0, 0, 0 }, { 1, 1, 0 }, { 1.5, -.5, 0 } };

struct crown {
	struct eco_list list;
	struct eco_elements elements;
	uint8_t corners[LEAVES];
	int32_t position[15 * LEAVES], exact[15 * LEAVES], uv[10 * LEAVES], extra[LEAVES];
};

/* A random rotation: a quaternion of four normal numbers, which uniform ones of a ball stand for. */
static void random_turn(double m[3][3])
{
	double q[4], length;
	do {
		length = 0;
		for (int i = 0; i < 4; i++) {
			q[i] = 2 * uniform() - 1;
			length += q[i] * q[i];
		}
	} while (length > 1 || length < 0.01);
	double s = 2 / length, w = q[0], x = q[1], y = q[2], z = q[3];
	const double rows[3][3] = { { 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y) },
		{ s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x) },
		{ s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y) } };
	memcpy(m, rows, sizeof rows);
}

/* Leaves of two shapes; of `every` leaves one is bent at random and like no other. `steps`: the size of a
 * leaf on the coarse grid. */
static void make_leaves(struct crown *c, double steps, uint32_t every, bool wide, bool deep)
{
	state = 7;
	*c = (struct crown){ .list = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS,
		.attributes = ECO_ATTR_UV | ECO_ATTR_GROWTH } };
	struct eco_elements *e = &c->elements;
	*e = (struct eco_elements){ .extra_count = 1, .corners = c->corners, .position = c->position,
		.uv = c->uv, .extra = c->extra,
		.exact = c->exact };
	for (uint32_t i = 0; i < LEAVES; i++) {
		uint32_t corners = i % 3 ? 4 : 3;
		double m[3][3], size = steps * (0.5 + uniform()) * (1 << ECO_EXACT_SHIFT), at[3];
		const double stretch[3] = { 1, wide ? 0.5 + uniform() : 1, deep ? 2 * uniform() - 1 : 1 };
		random_turn(m);
		for (int k = 0; k < 3; k++)
			at[k] = uniform() * 32768;
		for (uint32_t k = 0; k < corners; k++)
			for (int row = 0; row < 3; row++) {
				double v = at[row];
				for (int j = 0; j < 3; j++)
					v += size * stretch[j] * m[row][j]
						* ((corners == 4 ? quad[k][j] : kite[k][j])
						+ (every && i % every == 0 ? uniform() : 0));
				e->exact[3 * e->corner_count + 3 * k + (uint32_t)row] =
					(int32_t)floor(v + 0.5);
				e->position[3 * e->corner_count + 3 * k + (uint32_t)row] =
					(int32_t)floor(v / 8 + 0.5);
			}
		for (uint32_t k = 0; k < corners; k++) {
			e->uv[2 * (e->corner_count + k)] = (int32_t)k * 100;
			e->uv[2 * (e->corner_count + k) + 1] = 4096 - (int32_t)k * 100;
		}
		e->extra[i] = (int32_t)(i % ECO_GROWTHS);
		e->corners[e->element_count++] = (uint8_t)corners;
		e->corner_count += corners;
		e->primitive_count += corners - 2;
	}
}

static void make_crown(struct crown *c, double steps, uint32_t every)
{
	make_leaves(c, steps, every, false, false);
}

static void encode(const struct crown *c, uint8_t **bytes, size_t *size, uint32_t *order)
{
	const struct eco_chunk_input input = { &c->list, &c->elements, 0, LEAVES, 3 };
	assert_good(eco_chunk_encode(&input, bytes, size, &cause));
	if (order)
		assert_good(eco_chunk_order(&input, order, &cause));
}

static enum eco_code decode(const struct crown *c, const uint8_t *bytes, size_t size,
	struct eco_elements *out)
{
	const struct eco_chunk chunk =
		{ .size_bytes = (uint32_t)size, .primitive_count = c->elements.primitive_count,
			.element_count = LEAVES };
	struct eco_error error = { 0 };
	return eco_chunk_decode(&c->list, &chunk, 3, bytes, size, out, &error);
}

/* Everything but positions comes back as it was; no corner is further from where it was than half a step
 * along each axis. */
static void compare(const struct crown *c, const struct eco_elements *out, const uint32_t *order)
{
	size_t from[LEAVES + 1] = { 0 }, corner = 0;
	for (uint32_t i = 0; i < LEAVES; i++)
		from[i + 1] = from[i] + c->corners[i];
	assert_int_equal(out->corner_count, c->elements.corner_count);
	for (uint32_t i = 0; i < LEAVES; i++) {
		uint32_t of = order[i], corners = c->corners[of];
		assert_int_equal(out->corners[i], corners);
		assert_int_equal(out->extra[i], c->extra[of]);
		assert_memory_equal(out->uv + 2 * corner, c->uv + 2 * from[of], 2 * corners * sizeof *c->uv);
		for (uint32_t k = 0; k < corners; k++) {
			double d2 = 0;
			for (uint32_t a = 0; a < 3; a++)
				d2 += pow(out->position[3 * (corner + k) + a]
					- c->exact[3 * (from[of] + k) + a], 2);
			/* half a step, and what `exact` itself was rounded by */
			assert_true(d2 <= 3 * 4.5 * 4.5);
		}
		corner += corners;
	}
}

/* Encodes and decodes; returns the share of the bytes that plain corners take. */
static double share_of(struct crown *c)
{
	uint32_t order[LEAVES];
	FREED_MEMORY uint8_t *bytes, *soup;
	size_t size, soup_size;
	FREED(eco_elements) out;
	int32_t *exact = c->elements.exact;
	encode(c, &bytes, &size, order);
	assert_int_equal(bytes[1], ECO_CODER_SHAPES);
	assert_int_equal(decode(c, bytes, size, &out), ECO_OK);
	compare(c, &out, order);
	c->elements.exact = NULL;
	encode(c, &soup, &soup_size, NULL);
	struct eco_payload payload;
	assert_good(eco_payload_read(&payload, soup, soup_size, &cause));
	assert_int_equal(payload.coder, ECO_CODER_ELEMENTS);
	c->elements.exact = exact;
	return (double)size / (double)soup_size;
}

/* Leaves of one shape, of any length, width and bend; of every so many one is like no other. */
UNIT_TEST(leaves_of_one_shape_are_placed)
{
	static const struct { double steps, most; uint32_t every; bool wide, deep; } rows[] = {
		{ 20, .85, 0, false, false }, { 20, 1, 3, false, false }, { 120, .73, 0, false, false },
		{ 120, 1, 6, false, false }, { 720, .7, 0, false, false }, { 60, .82, 0, true, false },
		{ 1500, .78, 0, true, false }, { 60, .89, 0, true, true }, { 1500, .86, 0, true, true } };
	static struct crown crown;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		make_leaves(&crown, rows[i].steps, rows[i].every, rows[i].wide, rows[i].deep);
		assert_true(share_of(&crown) < rows[i].most);
	}
}

/* Blades of five corners, tip in the middle, standing and bent each by another angle, as grass is; `both`:
 * some run the other way round. */
static void make_blades(struct crown *c, bool both)
{
	make_crown(c, 100, 1);
	for (uint32_t i = 0; i < LEAVES; i++) {
		double way = 6.3 * uniform(), lean = 0.2 + 0.5 * uniform(), bend = 0.9 * uniform(),
			length = 500 + 700 * uniform(), at[3];
		const double along[3] = { 0, 1, 1.9 }, wide[3] = { 20, 16, 0 };
		for (int a = 0; a < 3; a++)
			at[a] = 4096 * uniform();
		c->corners[i] = 5;
		for (uint32_t k = 0; k < 5; k++) {
			uint32_t node = k < 3 ? k : 4 - k, to = both && i % 3 == 0 ? 4 - k : k;
			double side = k < 2 ? wide[node] : k > 2 ? -wide[node] : 0,
				tilt = lean + (node == 2 ? bend : 0);
			double out = along[node] * length * sin(tilt), up = along[node] * length * cos(tilt);
			const double p[3] = { at[0] + out * cos(way) - side * sin(way),
				at[1] + out * sin(way) + side * cos(way), at[2] + up };
			for (uint32_t a = 0; a < 3; a++) {
				c->exact[15 * i + 3 * to + a] = (int32_t)floor(8 * p[a] + 0.5);
				c->position[15 * i + 3 * to + a] = (int32_t)floor(p[a] + 0.5);
				c->uv[10 * i + 2 * to + a % 2] = (int32_t)(k * 100);
			}
		}
	}
	c->elements.corner_count = 5 * LEAVES;
	c->elements.primitive_count = 3 * LEAVES;
}

UNIT_TEST(blades_that_bend_each_differently_follow_a_trend)
{
	static struct crown crown;
	for (int both = 0; both < 2; both++) {
		make_blades(&crown, both);
		assert_true(share_of(&crown) < 0.74);
	}
}

UNIT_TEST(damage_is_refused_or_harmless)
{
	static struct crown crown;
	FREED_MEMORY uint8_t *bytes;
	size_t size;
	struct eco_elements out;
	make_crown(&crown, 40, 9);
	encode(&crown, &bytes, &size, NULL);
	for (size_t cut = 0; cut < size; cut += 1 + cut / 64)
		assert_int_not_equal(decode(&crown, bytes, cut, &out), ECO_OK);
	for (size_t at = 0; at < size; at += 1 + at / 32)
		for (int bit = 0; bit < 8; bit += 3) {
			bytes[at] ^= (uint8_t)(1u << bit);
			if (decode(&crown, bytes, size, &out) == ECO_OK) {
				assert_int_equal(out.element_count, LEAVES);
				eco_elements_free(&out);
			}
			bytes[at] ^= (uint8_t)(1u << bit);
		}
}

static const struct eco_shape triangle =
	{ .corners = 3, .position = { 4096, 0, 0, -2048, 3547, 0, -2048, -3547, 0 } };

UNIT_TEST(placings_out_of_bounds_are_none)
{
	const struct eco_shapes shapes = { .count = 1, .stretch = ECO_STRETCH_ALL, .place_shift = 2,
		.size_shift = { 2, 2, 2 }, .way_bits = 9,
		.roll_bits = 9 };
	static const struct { struct eco_placing placing; bool turns, good; } cases[] = {
		{ { { 0, 0, 0 }, { 0, 0 }, 0, { 100, 100, 100 } }, true, true },
		{ { { 0, 0, 0 }, { 1023, 1023 }, 2047, { 0, -100, 100 } }, true, true },
		{ { { 0, 0, 0 }, { 1024, 0 }, 0, { 100, 100, 100 } }, false, false },
		{ { { 0, 0, 0 }, { 0, -1 }, 0, { 100, 100, 100 } }, false, false },
		{ { { 0, 0, 0 }, { 0, 0 }, 2048, { 100, 100, 100 } }, false, false },
		{ { { 0, 0, 0 }, { 0, 0 }, 0, { ECO_SHAPE_SIZE_MAX + 1, 100, 100 } }, false, false },
		{ { { 0, 0, 0 }, { 0, 0 }, 0, { 100, INT32_MIN, 100 } }, false, false },
		{ { { 0, INT32_MIN, 0 }, { 0, 0 }, 0, { 100, 100, 100 } }, true, false },
		{ { { 0, 0, INT32_MAX }, { 0, 0 }, 0, { 100, 100, 100 } }, true, false },
		{ { { 0, (1 << 26) - 1, 0 }, { 0, 0 }, 0, { 100, 100, 100 } }, true, false },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		int32_t offset[9], at[9];
		assert_int_equal(eco_shape_turn(&shapes, &triangle, &cases[i].placing, offset),
			cases[i].turns);
		if (cases[i].turns)
			assert_int_equal(eco_shape_place(&shapes, &cases[i].placing, offset, 3, at),
				cases[i].good);
	}
}

UNIT_TEST(a_placing_is_where_it_says)
{
	const struct eco_shapes shapes = { .count = 1, .stretch = ECO_STRETCH_WIDTH, .place_shift = 2,
		.size_shift = { 2, 1, 0 }, .way_bits = 14,
		.roll_bits = 8 };
	/* x points up, as nearly as can be; a quarter of a turn; twice as long as wide */
	const struct eco_placing placing = { { 10, 20, 30 }, { 1 << 14, 1 << 14 }, 1 << 8, { 100, 100, 0 } };
	int32_t offset[9], at[9];
	assert_true(eco_shape_turn(&shapes, &triangle, &placing, offset));
	assert_true(eco_shape_place(&shapes, &placing, offset, 3, at));
	const double along[3] = { 400, -200, -200 }, aside[3] = { 0, 173.2, -173.2 };
	for (int k = 0; k < 3; k++) {
		double level = hypot(at[3 * k] - 40, at[3 * k + 1] - 80);
		assert_true(fabs(at[3 * k + 2] - 120 - along[k]) < 1.5);
		assert_true(fabs(level - fabs(aside[k])) < 1.5);
	}
}
