/* The encoder of SHAPES: which elements are placed, with which steps, and the writing of them. */
#include "ecofiles/format/chunk/chunk.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/chunk/chunk_shapes.h"

#define USES_LEAST 4u            /* fewest elements of a shape: with fewer, its entry costs too much */
#define UNITS_SAMPLE 256u        /* elements in the sample that steps and trends are chosen by */

struct encoding {
	const struct eco_chunk_input *input;
	const struct eco_stored *elements;
	uint32_t count;
	uint32_t *of;                /* shape of each stored element */
	struct eco_placing *placing;
	struct eco_shapes_codec codec;
};

static const int32_t *exact_of(const struct encoding *e, uint32_t i)
{
	return e->input->elements->exact + 3 * e->elements[i].corner_at;
}

static const int32_t *corner_of(const struct encoding *e, uint32_t i)
{
	return e->input->elements->position + 3 * e->elements[i].corner_at;
}

static void find_shapes(struct encoding *c)
{
	size_t *at = eco_alloc(c->count, sizeof *at);
	uint32_t *by_element = eco_alloc(c->count, sizeof *by_element);
	for (uint32_t i = 0; i < c->count; i++)
		at[c->elements[i].element] = c->elements[i].corner_at;
	eco_shapes_find(&c->codec.shapes,
		&(struct eco_shapes_input){ c->input->elements, c->input->first, c->input->end, at }, USES_LEAST,
		by_element);
	for (uint32_t i = 0; i < c->count; i++)
		c->of[i] = by_element[c->elements[i].element];
	free(at);
	free(by_element);
}

static void widen(int32_t low[], int32_t high[], uint32_t k, int32_t v, bool first)
{
	low[k] = first || v < low[k] ? v : low[k];
	high[k] = first || v > high[k] ? v : high[k];
}

/* A sample of the elements that have a shape, with their poses, which no step changes. */
struct posed { uint32_t element; bool good; struct eco_pose pose; };
struct sample { struct posed *items; uint32_t count; double soup_bits; };

static void take_sample(const struct encoding *c, struct sample *sample)
{
	uint32_t step = c->count / UNITS_SAMPLE + 1;
	sample->items = eco_alloc(c->count / step + 1, sizeof *sample->items);
	for (uint32_t i = 0; i < c->count; i += step) {
		struct posed *posed = &sample->items[sample->count];
		if (c->of[i] == ECO_SHAPE_NONE)
			continue;
		posed->element = i;
		posed->good = eco_shape_pose(&c->codec.shapes, &c->codec.shapes.items[c->of[i]], exact_of(c, i),
			&posed->pose);
		sample->count++;
	}
}

/* Size of elements with the steps in `shapes`. */
struct cost { double width; uint32_t placed, left; int32_t low[3], high[3]; };

static void add_cost(struct cost *cost, const struct encoding *c, const struct eco_shapes *shapes,
	const struct posed *posed)
{
	struct eco_placing p;
	bool fits = posed->good && eco_shape_round(shapes, &shapes->items[c->of[posed->element]],
		exact_of(c, posed->element), &posed->pose, &p);
	for (uint32_t k = 0; k < 3 && fits; k++)
		widen(cost->low, cost->high, k, p.size[k], cost->placed == 0);
	cost->placed += fits;
	cost->left += !fits;
}

/* About how many bits, if `more` other elements fit without widening any span. */
static double bits_of(const struct cost *cost, uint32_t more, double soup_bits)
{
	double width = cost->width;
	for (int k = 0; k < 3 && cost->placed > 0; k++)
		width += log2((double)cost->high[k] - cost->low[k] + 1);
	return (cost->placed + more) * (width + 40) + cost->left * fmax(soup_bits, width + 50);
}

#define BETWEEN 16u              /* elements from one look at the bits so far to the next */

/* About how many bits the sample takes with the steps in `shapes`; INFINITY as soon as that is more than
 * `least`. */
static double cost_of(const struct encoding *c, const struct eco_shapes *shapes, const struct sample *sample,
	double least)
{
	struct cost cost = { .width = 2.0 * (shapes->way_bits + 1) + shapes->roll_bits + 2
		- 3.0 * shapes->place_shift };
	for (uint32_t i = 0; i < sample->count; i++) {
		add_cost(&cost, c, shapes, &sample->items[i]);
		if (i % BETWEEN == 0 && bits_of(&cost, sample->count - 1 - i, sample->soup_bits) > least + 1)
			return INFINITY;
	}
	return bits_of(&cost, 0, sample->soup_bits);
}

/* Makes one kind of step coarser; false where it is at its limit. */
static bool coarsen(struct eco_shapes *s, int kind)
{
	if (kind == 0 ? s->way_bits == 0 : kind == 1 ? s->roll_bits == 0 : kind == 2 ? s->place_shift
			>= ECO_EXACT_SHIFT
			: s->size_shift[kind - 3] >= ECO_SHAPE_SHIFT_MAX
			|| (s->stretch == ECO_STRETCH_NONE && kind > 3)
			|| (s->stretch != ECO_STRETCH_ALL && kind > 4))
		return false;
	s->way_bits -= kind == 0;
	s->roll_bits -= kind == 1;
	s->place_shift += kind == 2;
	if (kind >= 3)
		s->size_shift[kind - 3]++;
	return true;
}

/* Coarser steps take fewer bits, but fewer elements fit and the others are stored as corners. Starts from
 * the finest useful steps and makes one kind after the other coarser as long as that pays. */
static void choose_steps(struct encoding *c, double soup_bits)
{
	struct sample sample = { .soup_bits = soup_bits };
	take_sample(c, &sample);
	struct eco_shapes best = c->codec.shapes;
	double least = cost_of(c, &best, &sample, INFINITY);
	for (bool better = true; better;) {
		const struct eco_shapes from = best;
		better = false;
		for (int kind = 0; kind < 6; kind++) {
			struct eco_shapes tried = from;
			double cost = coarsen(&tried, kind) ? cost_of(c, &tried, &sample, least) : INFINITY;
			if (cost < least) {
				least = cost;
				best = tried;
				better = true;
			}
		}
	}
	c->codec.shapes = best;
	free(sample.items);
}

/* Finds the range of first corners on the coarse grid, and whether they are in order along the curve. */
static void measure_first(struct encoding *c)
{
	struct eco_shapes_head *h = &c->codec.head;
	int32_t low[3], high[3];
	uint32_t widest = 0;
	for (uint32_t i = 0; i < c->count; i++)
		for (uint32_t k = 0; k < 3; k++)
			widen(low, high, k, corner_of(c, i)[k], i == 0);
	for (uint32_t k = 0; k < 3; k++) {
		h->first[k].low = low[k];
		widest = (uint32_t)(high[k] - low[k]) > widest ? (uint32_t)(high[k] - low[k]) : widest;
	}
	h->first[0].bits = (uint8_t)eco_bit_length(widest);
}

/* Whether the placed shape's first corner stays within the range of first corners. */
static bool in_spans(const struct eco_shapes_codec *c, const struct eco_placing *p,
	const struct eco_shape *shape)
{
	int32_t offset[3 * ECO_CORNERS_MAX];
	int64_t first[3];
	uint32_t rest[3];
	if (!eco_shape_turn(&c->shapes, shape, p, offset))
		return false;
	eco_shapes_first(&c->shapes, p, offset, first, rest);
	for (uint32_t i = 0; i < 3; i++)
		if (first[i] < c->head.first[i].low || (first[i] - c->head.first[i].low)
				>> c->head.first[0].bits)
			return false;
	return true;
}

static void place_all(struct encoding *e)
{
	struct eco_shapes_codec *c = &e->codec;
	for (uint32_t i = 0; i < e->count; i++) {
		const struct eco_shape *shape = e->of[i] == ECO_SHAPE_NONE ? NULL
			: &c->shapes.items[e->of[i]];
		if (shape && (!eco_shape_fit(&c->shapes, shape, exact_of(e, i), &e->placing[i])
				|| !in_spans(c, &e->placing[i], shape)))
			e->of[i] = ECO_SHAPE_NONE;
	}
}

static void measure_extra(struct encoding *e)
{
	const struct eco_elements *from = e->input->elements;
	int32_t low[ECO_ROWS_EXTRA_MAX], high[ECO_ROWS_EXTRA_MAX];
	for (uint32_t k = 0; k < from->extra_count; k++) {
		for (uint32_t i = 0; i < e->count; i++)
			widen(low, high, k,
				from->extra[(size_t)from->extra_count * (e->input->first + i) + k], i == 0);
		e->codec.head.extra[k] =
			(struct eco_span){ low[k], (uint8_t)eco_bit_length((uint32_t)(high[k] - low[k])) };
	}
}

/* Fits trends to a sample. */
static void find_trends(struct encoding *e)
{
	uint32_t step = e->count / UNITS_SAMPLE + 1;
	const int32_t **at = eco_alloc(e->count / step + 1, sizeof *at);
	for (uint32_t corners = 3; corners <= ECO_CORNERS_MAX; corners++) {
		uint32_t count = 0;
		for (uint32_t i = 0; i < e->count; i += step)
			if (e->of[i] == ECO_SHAPE_NONE && e->elements[i].corners == corners)
				at[count++] = exact_of(e, i);
		e->codec.head.trends[corners - 3] = 0;
		if (count)
			eco_corners_trends(&e->codec.head, corners, at, count, step);
	}
	free(at);
}

/* ---- Writing ---- */

static struct eco_leaf leaf_of(const struct encoding *e, uint32_t i)
{
	const struct eco_elements *from = e->input->elements;
	size_t element = e->input->first + e->elements[i].element;
	struct eco_leaf l = { .shape = e->of[i] == ECO_SHAPE_NONE ? e->codec.shapes.count : e->of[i],
		.corners = e->elements[i].corners,
		.placing = e->placing[i], .coarse = corner_of(e, i), .exact = exact_of(e, i) };

	if (from->uv)
		memcpy(l.uv, from->uv + 2 * e->elements[i].corner_at, 2 * sizeof *l.uv * l.corners);
	for (uint32_t k = 0; k < from->extra_count; k++)
		l.extra[k] = from->extra[from->extra_count * element + k];
	return l;
}

static uint8_t write_all(struct encoding *e, struct eco_writer *w, bool sorted)
{
	struct eco_shapes_codec *c = &e->codec;
	c->head.sorted = sorted;
	c->extra_count = e->input->elements->extra_count;
	c->uv = e->input->elements->uv != NULL;
	eco_shapes_start(c, e->count);
	eco_range_write(&c->range, w);
	eco_shapes_code_head(c);
	for (uint32_t i = 0; i < e->count; i++) {
		struct eco_leaf l = leaf_of(e, i);
		if (l.shape == c->shapes.count)
			eco_corners_plan(c, &l);
		eco_shapes_code_leaf(c, &l);
	}
	assert(!c->failed);
	return (uint8_t)eco_range_end(&c->range);
}

static void measure_sizes(struct encoding *e)
{
	int32_t low[3] = { 0 }, high[3] = { 0 };
	bool first = true;
	for (uint32_t i = 0; i < e->count; i++) {
		for (uint32_t k = 0; k < 3 && e->of[i] != ECO_SHAPE_NONE; k++)
			widen(low, high, k, e->placing[i].size[k], first);
		first &= e->of[i] == ECO_SHAPE_NONE;
	}
	for (uint32_t k = 0; k < 3; k++)
		e->codec.head.size[k] =
			(struct eco_span){ low[k], (uint8_t)eco_bit_length((uint32_t)(high[k] - low[k])) };
}

/* Writes the chunk and keeps it in `stream` if it is the smallest so far. */
static void write_and_keep(struct encoding *e, bool sorted, struct eco_stream *stream)
{
	struct eco_writer w = { 0 };
	uint8_t zeros = write_all(e, &w, sorted);
	if (w.failed)
		eco_end("no memory");
	if (!stream->bytes || w.size < stream->size) {
		free((void *)stream->bytes);
		*stream = (struct eco_stream){ .zeros = zeros, .bytes = w.bytes, .size = w.size };
		w.bytes = NULL;
	}
	eco_writer_free(&w);
}

/* Tries shapes of ever more uses, at last none: a shape of few elements may save less than its entry
 * takes. Tries each with and without steps along the curve. */
static void write_smallest(struct encoding *e, struct eco_stream *stream)
{
	static const uint32_t uses[] = { 1, 8, 24, UINT32_MAX };
	for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
		uint32_t before = e->codec.shapes.count;
		eco_shapes_keep(&e->codec.shapes, e->of, e->count, uses[i]);
		if (i > 0 && e->codec.shapes.count == before)
			continue;
		measure_sizes(e);
		find_trends(e);
		write_and_keep(e, true, stream);
		if (i == 0)
			write_and_keep(e, false, stream);
	}
}

/* Room for all corners of the chunk, and at least twice as many slots. */
static void make_seen(struct encoding *e)
{
	struct eco_shapes_codec *c = &e->codec;
	size_t corners = 0;
	for (uint32_t i = 0; i < e->count; i++)
		corners += e->elements[i].corners;
	c->slot_mask = 1;
	while (c->slot_mask < 2 * corners)
		c->slot_mask = c->slot_mask << 1 | 1;
	c->seen = eco_alloc(corners, 3 * sizeof *c->seen);
	c->keys = eco_alloc(corners, 3 * sizeof *c->keys);
	c->slots = eco_alloc((size_t)c->slot_mask + 1, sizeof *c->slots);
}

void eco_shapes_encode(const struct eco_chunk_input *input, const struct eco_stored *elements, double soup_bits,
	struct eco_stream *stream)
{
	struct encoding *e = eco_alloc(1, sizeof *e);
	*stream = (struct eco_stream){ .size = 0 };
	e->input = input;
	e->elements = elements;
	e->count = input->end - input->first;
	e->of = eco_alloc(e->count, sizeof *e->of);
	e->placing = eco_alloc(e->count, sizeof *e->placing);
	make_seen(e);
	find_shapes(e);
	measure_first(e);
	if (e->codec.shapes.count)
		choose_steps(e, soup_bits);
	place_all(e);
	measure_extra(e);
	write_smallest(e, stream);
	eco_shapes_free(&e->codec.shapes);
	eco_free(e->codec.seen, e->codec.keys, e->codec.slots, e->of, e->placing, e);
}
