/* Triangles for EXT_meshopt_compression, which viewers undo as fast as they load: triangles in an order in
 * which neighbours follow each other, vertices as triangles need them, and both as differences. Positions and
 * texture coordinates are rounded to a power of two and stay floats (filter EXPONENTIAL, one exponent for a
 * whole array), so that no transform has to undo a scale, which those of instances could not. */
#include <math.h>
#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/export/export.h"

#define POSITION_EXPONENT -10    /* a millimetre, or of small meshes ... */
#define POSITION_BITS 15         /* ... of the farthest coordinate */
#define UV_EXPONENT -15          /* a quarter of a texel, of 8,192 a side */
#define MANTISSA_BITS 23         /* which the filter holds, and a sign */
#define EXPONENT_MIN -80
#define INDEX_VERSION 1          /* of the codec, which the extension asks for */

static const size_t strides[EXPORT_ARRAYS] = { 12, 8, 8, 4 };

size_t export_array_bytes(const struct export_part *part, enum export_array array)
{
	return strides[array] * (array == EXPORT_INDEX ? part->indices : part->vertices);
}

/* Exponent of the smallest power of two, among those that the filter knows, that is not below |value|. */
static int exponent_of(float value)
{
	int exponent;
	float fraction = frexpf(value, &exponent);
	exponent -= fraction == 0.5f;
	return fraction > 0 && exponent > EXPONENT_MIN ? exponent : EXPONENT_MIN;
}

static float largest_of(const float *values, size_t count)
{
	float largest = 0;
	for (size_t i = 0; i < count; i++)
		largest = fmaxf(largest, fabsf(values[i]));
	return largest;
}

static int32_t round_to(float value, int exponent) { return (int32_t)lrint(ldexp((double)value, -exponent)); }

/* In place, as the filter EXPONENTIAL reads them: 8 bits of exponent above 24 of a whole number. */
static void filter(float *values, size_t count, int exponent)
{
	for (size_t i = 0; i < count; i++) {
		uint32_t mantissa = (uint32_t)round_to(values[i], exponent) & 0xffffff,
			bits = (uint32_t)exponent << 24 | mantissa;
		memcpy(&values[i], &bits, sizeof bits);
	}
}

static void round_bounds(struct export_part *part, int exponent)
{
	for (int k = 0; k < 3; k++) {
		part->low[k] = ldexpf((float)round_to(part->low[k], exponent), exponent);
		part->high[k] = ldexpf((float)round_to(part->high[k], exponent), exponent);
	}
}

static int position_exponent(const struct export_mesh *mesh)
{
	float largest = 0;
	for (uint32_t i = 0; i < mesh->part_count; i++)
		largest = fmaxf(largest, fmaxf(largest_of(mesh->parts[i].low, 3),
			largest_of(mesh->parts[i].high, 3)));
	int size = exponent_of(largest), wanted = mesh->precision_m > 0
		? exponent_of((float)mesh->precision_m) - 1 : POSITION_EXPONENT < size - POSITION_BITS
		? POSITION_EXPONENT : size - POSITION_BITS;
	return wanted > size - MANTISSA_BITS ? wanted : size - MANTISSA_BITS;
}

/* ---- Order ---- */

struct order { uint32_t *index, *remap; };

static void order_make(struct order *order, struct export_part *part, const uint8_t *file)
{
	size_t count = part->indices;
	uint32_t *sorted = eco_alloc(count, sizeof *sorted);
	order->index = eco_alloc(count, sizeof *order->index);
	order->remap = eco_alloc(part->vertices, sizeof *order->remap);
	meshopt_spatialSortTriangles(sorted, (const void *)(file + part->at[EXPORT_INDEX]), count,
		(const void *)(file + part->at[EXPORT_POSITION]), part->vertices, 12);
	meshopt_optimizeVertexCacheStrip(sorted, sorted, count, part->vertices);
	meshopt_optimizeVertexFetchRemap(order->remap, sorted, count, part->vertices);
	meshopt_remapIndexBuffer(order->index, sorted, count, order->remap);
	free(sorted);
}

/* ---- Arrays ---- */

static void write_array(struct export_part *part, enum export_array array, const void *values,
	struct eco_writer *out)
{
	size_t count = array == EXPORT_INDEX ? part->indices : part->vertices, stride = strides[array],
		bound = array == EXPORT_INDEX ? meshopt_encodeIndexBufferBound(count, part->vertices)
			: meshopt_encodeVertexBufferBound(count, stride);
	uint8_t *bytes = eco_alloc(bound, 1);
	size_t size = array == EXPORT_INDEX ? meshopt_encodeIndexBuffer(bytes, bound, values, count)
		: meshopt_encodeVertexBuffer(bytes, bound, values, count, stride);
	part->at[array] = out->size;
	part->packed[array] = size;
	eco_write_bytes(out, bytes, size);
	while (out->size % 4)
		eco_write_u8(out, 0);
	free(bytes);
}

static void write_vertices(struct export_part *part, enum export_array array, const struct order *order,
	const uint8_t *file, int exponent, struct eco_writer *out)
{
	size_t numbers = export_array_bytes(part, array) / sizeof(float);
	float *values = eco_alloc(numbers, sizeof *values);
	meshopt_remapVertexBuffer(values, file + part->at[array], part->vertices, strides[array],
		order->remap);
	if (array != EXPORT_COLOR)
		filter(values, numbers, exponent);
	write_array(part, array, values, out);
	free(values);
}

static void write_part(struct export_part *part, const uint8_t *file, int exponent, struct eco_writer *out)
{
	struct order order;
	order_make(&order, part, file);
	write_vertices(part, EXPORT_POSITION, &order, file, exponent, out);
	write_vertices(part, EXPORT_COLOR, &order, file, 0, out);
	if (part->image != ECO_NONE) {
		const float *uv = (const void *)(file + part->at[EXPORT_UV]);
		int least = exponent_of(largest_of(uv, (size_t)part->vertices * 2)) - MANTISSA_BITS;
		write_vertices(part, EXPORT_UV, &order, file,
			least > UV_EXPONENT ? least : UV_EXPONENT, out);
	}
	write_array(part, EXPORT_INDEX, order.index, out);
	round_bounds(part, exponent);
	free(order.index);
	free(order.remap);
}

void export_mesh_compress(struct export_mesh *mesh, struct eco_writer *file)
{
	struct eco_writer out = { 0 };
	int exponent = position_exponent(mesh);
	meshopt_encodeIndexVersion(INDEX_VERSION);
	for (uint32_t i = 0; i < mesh->part_count; i++)
		write_part(&mesh->parts[i], file->bytes, exponent, &out);
	eco_writer_free(file);
	*file = out;
	mesh->bytes = out.size;
}
