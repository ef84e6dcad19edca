#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/export/export.h"
#include "ecofiles/ecopack/export/plant_view.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/image.h"

#define PIXELS 96u               /* a side of the picture that a level is scored in */
static const uint64_t wanted[EXPORT_LEVELS] = { 64, 1024, UINT64_MAX };

/* ---- Meshes ---- */

static void pad(struct eco_writer *file)
{
	while (file->size % 4)
		eco_write_u8(file, 0);
}

static size_t write_array(struct eco_writer *file, const struct lod_bake *bakes, const uint32_t *images,
	uint32_t count, uint32_t image, enum export_array what)
{
	size_t from = file->size;
	uint32_t before = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_bake *b = &bakes[i];
		size_t vertices = b->vertex_count;
		if (images[i] != image || !b->index_count)
			continue;
		if (what == EXPORT_POSITION)
			eco_write_bytes(file, b->position, vertices * 3 * sizeof *b->position);
		else if (what == EXPORT_COLOR)
			eco_write_bytes(file, b->color, vertices * 4 * sizeof *b->color);
		else if (what == EXPORT_UV)
			eco_write_bytes(file, b->uv, vertices * 2 * sizeof *b->uv);
		for (uint32_t k = 0; what == EXPORT_INDEX && k < b->index_count; k++)
			eco_write_u32(file, before + b->index[k]);
		before += b->vertex_count;
	}
	pad(file);
	return from;
}

static void bound(struct export_part *part, const struct lod_bake *bake)
{
	for (size_t i = 0; i < (size_t)bake->vertex_count * 3; i++) {
		part->low[i % 3] = fminf(part->low[i % 3], bake->position[i]);
		part->high[i % 3] = fmaxf(part->high[i % 3], bake->position[i]);
	}
}

void export_mesh_make(const struct export *x, struct export_mesh *mesh, struct eco_writer *file,
	const struct lod_bake *bakes, const uint32_t *images, uint32_t count)
{
	mesh->parts = eco_alloc(count, sizeof *mesh->parts);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t image = images[i], known = 0;
		if (!bakes[i].index_count)
			continue;
		for (; known < mesh->part_count && mesh->parts[known].image != image; known++)
			;
		if (known == mesh->part_count)
			mesh->parts[mesh->part_count++] = (struct export_part){ .image = image,
				.low = { INFINITY, INFINITY, INFINITY },
				.high = { -INFINITY, -INFINITY, -INFINITY } };
		mesh->parts[known].vertices += bakes[i].vertex_count;
		mesh->parts[known].indices += bakes[i].index_count;
		mesh->triangles += bakes[i].index_count / 3;
		bound(&mesh->parts[known], &bakes[i]);
	}
	for (uint32_t i = 0; i < mesh->part_count; i++) {
		struct export_part *part = &mesh->parts[i];
		for (enum export_array what = 0; what < EXPORT_ARRAYS; what++)
			if (what != EXPORT_UV || part->image != ECO_NONE)
				part->at[what] = write_array(file, bakes, images, count, part->image, what);
	}
	mesh->bytes = file->size;
	if (file->failed)
		eco_end("no memory");
	if (!x->is_plain)
		export_mesh_compress(mesh, file);
}

void export_mesh_free(struct export_mesh *mesh)
{
	free(mesh->parts);
	*mesh = (struct export_mesh){ .parts = NULL };
}

/* ---- Plants ---- */

static void bake(struct export *x, struct export_mesh *mesh, struct eco_writer *file,
	const struct plant_view_drawing *drawing)
{
	struct lod_bake *bakes = eco_alloc(drawing->count, sizeof *bakes);
	uint32_t *images = eco_alloc(drawing->count, sizeof *images);
	for (uint32_t i = 0; i < drawing->count; i++) {
		const struct plant_view_batch *b = &drawing->batches[i];
		images[i] = b->geometry.uv ? b->list->image : ECO_NONE;
		eco_check(lod_bake_make(&bakes[i], &(struct lod_bake_input){ b->list->list, b->list->palette,
			&b->geometry, b->impostor, b->count, b->area }, x->error));
	}
	export_mesh_make(x, mesh, file, bakes, images, drawing->count);
	for (uint32_t i = 0; i < drawing->count; i++)
		lod_bake_free(&bakes[i]);
	free(bakes);
	free(images);
}

static void write_images(struct export *x, const struct plant_view *plant)
{
	for (uint32_t i = 0; i < plant->list_count; i++) {
		const struct eco_image *image = &plant->lists[i].picture;
		struct eco_pixels pixels = { image->width, image->height, 4, image->rgba };
		char name[EXPORT_NAME];
		uint8_t *png = NULL;
		size_t size;
		if (!image->rgba)
			continue;
		snprintf(name, sizeof name, "plants/image-%u.png", i);
		eco_check(eco_png_encode(&pixels, &png, &size, x->error));
		export_file(x, name, png, size);
		free(png);
	}
}

/* How far a drawing is from full detail. */
static double error_of(struct plant_view *plant, const struct plant_view_drawing *drawing)
{
	const struct eco_scene *s = &plant->scene;
	const struct eco_anchor *whole = &s->anchors[s->plants[plant->number].anchor_first];
	return fmin(fmax(1 - plant_view_q(plant, drawing), 0), 1) * (double)whole->radius;
}

static void write_level(struct export *x, struct plant_view *plant, uint64_t vertices)
{
	struct export_plant *to = &x->plants[plant->number];
	struct export_mesh *mesh = &to->level[to->levels];
	struct plant_view_drawing drawing;
	struct eco_writer file = { 0 };
	char name[EXPORT_NAME];
	eco_check(plant_view_drawing_make(&drawing, plant, vertices, x->error));
	bake(x, mesh, &file, &drawing);
	snprintf(name, sizeof name, "plants/%u-%u.bin", plant->number, to->levels);
	export_file(x, name, file.bytes, file.size);
	double *error_m = &to->error_m[to->levels];
	*error_m = vertices < plant->full ? error_of(plant, &drawing) : 0;
	if (to->levels)
		*error_m = fmin(*error_m, error_m[-1]);
	to->levels++;
	plant_view_drawing_free(&drawing);
	eco_writer_free(&file);
}

bool export_is_object(const struct export *x, uint32_t number)
{
	return json_is_true(json_object_get(json_array_get(json_object_get(x->meta, "plants"), number), "object"));
}

void export_plant(struct export *x, uint32_t number)
{
	struct plant_view plant;
	eco_check(plant_view_open(&plant, x->pack, number, PIXELS, x->error));
	write_images(x, &plant);
	for (uint32_t i = 0; i < EXPORT_LEVELS; i++)
		/* a coarse level of an object would lack whole buildings */
		if (wanted[i] == UINT64_MAX || (wanted[i] * 2 <= plant.full && !export_is_object(x, number)))
			write_level(x, &plant, wanted[i] < plant.full ? wanted[i] : ECO_VERTICES_MAX);
	plant_view_close(&plant);
}

/* ---- Compression ---- */

/* Triangles for EXT_meshopt_compression, which viewers undo as fast as they load: triangles in an order in
 * which neighbours follow each other, vertices as triangles need them, and both as differences. Positions and
 * texture coordinates are rounded to a power of two and stay floats (filter EXPONENTIAL, one exponent for a
 * whole array), so that no transform has to undo a scale, which those of instances could not. */

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
	int size = exponent_of(largest), finest = mesh->precision_m > 0
		? exponent_of((float)mesh->precision_m) - 1 : POSITION_EXPONENT < size - POSITION_BITS
		? POSITION_EXPONENT : size - POSITION_BITS;
	return finest > size - MANTISSA_BITS ? finest : size - MANTISSA_BITS;
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

static void write_packed(struct export_part *part, enum export_array array, const void *values,
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
	write_packed(part, array, values, out);
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
	write_packed(part, EXPORT_INDEX, order.index, out);
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
