/* The coders that others have written: Draco, and meshoptimizer with zstd. */
#include <math.h>
#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "ecofiles/format/chunk/draco_shim.h"
#include "tests/bench/coders/bench_coders_rows.h"

#define TIMES 3
#define ZSTD_LEVEL 19

/* ---- Draco ---- */

struct draco_rows {
	struct eco_draco_column columns[CODERS_COLUMNS_MAX];
	uint32_t count, rows;
	int32_t *values;             /* of all columns */
};

/* Columns of one value, but the first corner's `first` in one. */
static bool draco_take(struct draco_rows *d, const struct coders_table *t, uint32_t first)
{
	*d = (struct draco_rows){ .rows = t->rows, .values = malloc((size_t)t->rows * t->columns
		* sizeof *d->values) };
	int32_t *at = d->values;
	for (uint32_t from = 0; from < t->columns && at; d->count++) {
		struct eco_draco_column *c = &d->columns[d->count];
		*c = (struct eco_draco_column){ .values = at,
			.components = (uint8_t)(from == 0 ? first : 1) };
		for (uint32_t i = 0; i < t->rows; i++)
			for (uint32_t k = 0; k < c->components; k++)
				*at++ = t->values[(size_t)t->columns * i + from + k];
		from += c->components;
	}
	return d->values != NULL;
}

static bool draco_choose(struct draco_rows *d)
{
	for (uint32_t i = 0; i < d->count; i++) {
		struct eco_draco_column *c = &d->columns[i], other = *c;
		size_t plain, difference;
		int32_t low = c->values[0], high = low;
		for (uint32_t k = 0; k < d->rows; k++) {
			low = c->values[k] < low ? c->values[k] : low;
			high = c->values[k] > high ? c->values[k] : high;
		}
		/* the shim's bound */
		bool fits = low >= -ECO_DRACO_VALUE_MAX && high <= ECO_DRACO_VALUE_MAX;
		if ((int64_t)high - low > ECO_DRACO_VALUE_MAX)
			return false;
		other.difference = true;
		c->difference = !fits || eco_draco_column_size(c, d->rows, &plain, NULL)
			|| eco_draco_column_size(&other, d->rows, &difference, NULL) || difference < plain;
	}
	return true;
}

static size_t draco_size(struct draco_rows *d, enum eco_draco_order order, double *ns)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	double best = INFINITY;
	bool good = !eco_draco_encode_rows(order, d->columns, d->count, d->rows, &bytes, &size, NULL);
	for (int i = 0; i < TIMES && good; i++) {
		double before = coders_now_ns();
		good = !eco_draco_decode_rows(order, bytes, size, d->columns, d->count, d->rows, NULL);
		best = fmin(best, coders_now_ns() - before);
	}
	*ns += best;
	free(bytes);
	return good ? size : SIZE_MAX;
}

static size_t draco_set(const struct coders_set *set, enum eco_draco_order order, double *ns)
{
	size_t sum = 4;
	bool good = true;
	*ns = 0;
	for (uint32_t i = 0; i < set->count && good; i++) {
		struct draco_rows d = { .count = 0 };
		struct coders_set one = { .count = 0 };
		good = coders_set_append(&one, &(struct coders_set){ { set->tables[i] }, 1 });
		if (good && order == ECO_DRACO_SEQUENTIAL)
			good = coders_table_sort(&one.tables[0]);
		good = good && draco_take(&d, &one.tables[0], CODERS_AXES);
		if (good && order == ECO_DRACO_SEQUENTIAL)
			good = draco_choose(&d);
		size_t size = good ? draco_size(&d, order, ns) : SIZE_MAX;
		good = size != SIZE_MAX;
		sum += good ? size + CODERS_RECORD_BYTES : 0;
		free(d.values);
		coders_set_free(&one);
	}
	return good ? sum : SIZE_MAX;
}

size_t coders_known_draco_kd(const struct coders_set *set, double *ns)
{
	return draco_set(set, ECO_DRACO_KD, ns);
}

size_t coders_known_draco_sequential(const struct coders_set *set, double *ns)
{
	return draco_set(set, ECO_DRACO_SEQUENTIAL, ns);
}

/* ---- Meshoptimizer ---- */

/* Bytes by zstd, in `to`, of a buffer as large as ZSTD_compressBound says; and what reading takes. */
static size_t squeeze(const uint8_t *from, size_t size, uint8_t *to, size_t room, double *ns)
{
	size_t squeezed = ZSTD_compress(to, room, from, size, ZSTD_LEVEL);
	uint8_t *again = malloc(size + 1);
	double best = INFINITY;
	if (ZSTD_isError(squeezed) || !again) {
		free(again);
		return SIZE_MAX;
	}
	for (int i = 0; i < TIMES; i++) {
		double before = coders_now_ns();
		if (ZSTD_decompress(again, size, to, squeezed) != size)
			squeezed = SIZE_MAX;
		best = fmin(best, coders_now_ns() - before);
	}
	*ns += best;
	free(again);
	/* the library gives bytes as they are where that is smaller */
	return squeezed < size ? squeezed : size;
}

/* Columns less their least, in 1, 2 or 4 bytes each; a whole multiple of 4 in all. */
static size_t stride_of(const struct coders_table *t, uint8_t width[CODERS_COLUMNS_MAX],
	int32_t low[CODERS_COLUMNS_MAX])
{
	size_t stride = 0;
	for (uint32_t k = 0; k < t->columns; k++) {
		int32_t high = low[k] = t->values[k];
		for (uint32_t i = 0; i < t->rows; i++) {
			int32_t v = t->values[(size_t)t->columns * i + k];
			low[k] = v < low[k] ? v : low[k];
			high = v > high ? v : high;
		}
		uint32_t span = (uint32_t)high - (uint32_t)low[k];
		width[k] = span < 1u << 8 ? 1 : span < 1u << 16 ? 2 : 4;
		stride += width[k];
	}
	return (stride + 3) / 4 * 4;
}

static uint8_t *vertices_of(const struct coders_table *t, size_t *stride)
{
	uint8_t width[CODERS_COLUMNS_MAX], *vertices;
	int32_t low[CODERS_COLUMNS_MAX];
	*stride = stride_of(t, width, low);
	vertices = calloc(t->rows, *stride);
	for (uint32_t i = 0; i < t->rows && vertices; i++) {
		uint8_t *at = vertices + *stride * i;
		for (uint32_t k = 0; k < t->columns; k++)
			for (uint32_t b = 0; b < width[k]; b++)
				*at++ = (uint8_t)(((uint32_t)t->values[(size_t)t->columns * i + k]
					- (uint32_t)low[k]) >> 8 * b);
	}
	return vertices;
}

/* Bytes of so many vertices, with what a reader must know of their columns. */
static size_t code_vertices(const uint8_t *vertices, size_t count, size_t stride, double *ns)
{
	size_t bound = meshopt_encodeVertexBufferBound(count, stride), room = ZSTD_compressBound(bound);
	uint8_t *coded = malloc(bound), *small = malloc(room), *again = malloc(count * stride);
	size_t size = SIZE_MAX;
	double best = INFINITY;
	if (coded && small && again && stride <= 256) {
		size_t full = meshopt_encodeVertexBuffer(coded, bound, vertices, count, stride);
		size = full ? squeeze(coded, full, small, room, ns) : SIZE_MAX;
		for (int i = 0; i < TIMES && size != SIZE_MAX; i++) {
			double before = coders_now_ns();
			if (meshopt_decodeVertexBuffer(again, count, stride, coded, full)
					|| memcmp(again, vertices, count * stride))
				size = SIZE_MAX;
			best = fmin(best, coders_now_ns() - before);
		}
		*ns += best;
	}
	free(coded);
	free(small);
	free(again);
	return size;
}

size_t coders_known_meshopt(const struct coders_set *set, double *ns)
{
	size_t sum = 0;
	*ns = 0;
	for (uint32_t i = 0; i < set->count; i++) {
		struct coders_set one = { .count = 0 };
		bool good = coders_set_append(&one, &(struct coders_set){ { set->tables[i] }, 1 })
			&& coders_table_sort(&one.tables[0]);
		size_t stride = 0, size = SIZE_MAX;
		uint8_t *vertices = good ? vertices_of(&one.tables[0], &stride) : NULL;
		if (vertices)
			size = code_vertices(vertices, one.tables[0].rows, stride, ns);
		free(vertices);
		coders_set_free(&one);
		if (size == SIZE_MAX)
			return SIZE_MAX;
		sum += size + CODERS_RECORD_BYTES;
	}
	return sum;
}

/* ---- Triangles ---- */

/* Each corner as a row: its place, its texture coordinates, and the triangle's values. */
static bool corners_of(const struct coders_table *t, struct coders_table *corners)
{
	uint32_t uv = t->columns > 3 * t->corners + 2 * t->corners - 1 ? 2 : 0,
		extra = t->columns - (3 + uv) * t->corners;
	*corners = (struct coders_table){ .rows = t->rows * t->corners, .columns = 3 + uv + extra };
	corners->values = malloc((size_t)corners->rows * corners->columns * sizeof *corners->values);
	int32_t *at = corners->values;
	for (uint32_t i = 0; i < t->rows && at; i++) {
		const int32_t *row = t->values + (size_t)t->columns * i;
		for (uint32_t c = 0; c < t->corners; c++) {
			for (uint32_t k = 0; k < 3; k++)
				*at++ = row[3 * c + k] + (c ? row[k] : 0);
			for (uint32_t k = 0; k < uv; k++)
				*at++ = row[3 * t->corners + 2 * c + k];
			for (uint32_t k = 0; k < extra; k++)
				*at++ = row[t->columns - extra + k];
		}
	}
	return corners->values != NULL;
}

/* Puts indices and vertices in the order that their coders like; returns how many vertices there are. */
static size_t weld(uint8_t *vertices, uint32_t *index, uint32_t *remap, size_t count, size_t stride)
{
	size_t unique = meshopt_generateVertexRemap(remap, NULL, count, vertices, count, stride);
	meshopt_remapIndexBuffer(index, NULL, count, remap);
	meshopt_remapVertexBuffer(vertices, vertices, count, stride, remap);
	meshopt_optimizeVertexCacheStrip(index, index, count, unique);
	return meshopt_optimizeVertexFetch(vertices, index, count, vertices, unique, stride);
}

static size_t code_indices(const uint32_t *index, size_t count, size_t vertices, double *ns)
{
	size_t bound = meshopt_encodeIndexBufferBound(count, vertices), room = ZSTD_compressBound(bound);
	uint8_t *coded = malloc(bound), *small = malloc(room);
	uint32_t *again = malloc(count * sizeof *again);
	size_t size = SIZE_MAX;
	if (coded && small && again) {
		size_t full = meshopt_encodeIndexBuffer(coded, bound, index, count);
		size = full ? squeeze(coded, full, small, room, ns) : SIZE_MAX;
		double before = coders_now_ns();
		if (size != SIZE_MAX && meshopt_decodeIndexBuffer(again, count, sizeof *again, coded, full))
			size = SIZE_MAX;
		*ns += coders_now_ns() - before;
	}
	free(coded);
	free(small);
	free(again);
	return size;
}

size_t coders_known_mesh(const struct coders_set *set, double *ns)
{
	struct coders_table corners = { .rows = 0 };
	size_t stride = 0, indices = SIZE_MAX, places = SIZE_MAX;
	*ns = 0;
	if (set->count != 1 || set->tables[0].corners != 3 || !corners_of(&set->tables[0], &corners))
		return SIZE_MAX;
	uint8_t *vertices = vertices_of(&corners, &stride);
	uint32_t *index = malloc(corners.rows * sizeof *index), *remap = malloc(corners.rows * sizeof *remap);
	if (vertices && index && remap) {
		size_t count = weld(vertices, index, remap, corners.rows, stride);
		indices = code_indices(index, corners.rows, count, ns);
		places = code_vertices(vertices, count, stride, ns);
	}
	free(vertices);
	free(index);
	free(remap);
	free(corners.values);
	return indices == SIZE_MAX || places == SIZE_MAX ? SIZE_MAX
		: indices + places + 2 * CODERS_RECORD_BYTES;
}
