#include "client-min/draw/view_gpu.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_record.h"
#include "ecofiles/base/array_grow.h"
#include "lod/scattered.h"

#define UPLOAD_BYTES (64u << 20)         /* of records made in memory at a time, roughly */

void view_gpu_init(struct view_gpu *gpu)
{
	GLint most = 0;
	*gpu = (struct view_gpu){ 0 };
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	gpu->side_max = most > 2048 ? (uint32_t)most : 2048;
}

static void free_list(struct view_gpu_list *g)
{
	glDeleteTextures(1, &g->records.texture);
	glDeleteTextures(1, &g->color);
}

void view_gpu_free(struct view_gpu *gpu)
{
	for (uint32_t i = 0; i < gpu->count; i++)
		free_list(&gpu->lists[i]);
	view_table_free(&gpu->table);
	free(gpu->lists);
	*gpu = (struct view_gpu){ 0 };
}

static enum eco_code out_of_memory(const struct view_list *list, struct eco_error *error)
{
	return eco_fail(error, ECO_NO_MEMORY, "the graphics driver has no memory for list %u", list->id);
}

/* The last list takes the place of one that goes. */
static void remove_list(struct view_gpu *gpu, uint32_t index)
{
	struct view_gpu_list *g = &gpu->lists[index], *last = &gpu->lists[--gpu->count];
	free_list(g);
	gpu->bytes -= g->records.room * VIEW_TEXEL_BYTES;
	view_table_remove(&gpu->table, g->id);
	if (last != g) {
		*g = *last;
		view_table_put(&gpu->table, g->id, index);
	}
}

/* A list that lost only some chunks goes as a whole: what is left of it is uploaded where it is drawn again.
 * */
void view_gpu_keep(struct view_gpu *gpu, const struct view_store *const *stores, uint32_t count)
{
	for (uint32_t i = gpu->count; i-- > 0;) {
		const struct view_gpu_list *g = &gpu->lists[i];
		uint32_t held = 0;
		for (uint32_t s = 0; s < count; s++) {
			const struct view_list *list = view_store_list(stores[s], g->id);
			held = list && list->chunk_count > held ? list->chunk_count : held;
		}
		if (held < g->chunks || (g->color && !held))
			remove_list(gpu, i);
	}
}

/* ---- Textures ---- */

unsigned view_gpu_texture(unsigned format, uint32_t width, uint32_t height, int filter)
{
	unsigned texture;
	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexStorage2D(GL_TEXTURE_2D, 1, format, (GLsizei)width, (GLsizei)height);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	return texture;
}

/* ---- Texels by number ---- */

static const struct { GLenum format, layout, type; uint32_t bytes; } kinds[] = {
	[VIEW_GPU_WORDS] = { GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16 },
	[VIEW_GPU_WORD] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 },
	[VIEW_GPU_COLOR] = { GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4 } };

/* The smallest power of two whose square holds so many texels, and at least 16. */
static uint32_t shift_for(const struct view_gpu *gpu, uint64_t texels)
{
	uint32_t shift = 4;
	while (2u << shift <= gpu->side_max && (uint64_t)1 << 2 * shift < texels)
		shift++;
	return shift;
}

/* An empty texture of at least so many texels in place of the one before. */
static void make_texels(struct view_gpu_texels *t, uint64_t texels)
{
	uint32_t width = 1u << t->shift, rows = (uint32_t)((texels + width - 1) >> t->shift);
	glDeleteTextures(1, &t->texture);
	t->texture = view_gpu_texture(kinds[t->kind].format, width, rows, GL_NEAREST);
	t->room = (uint64_t)rows << t->shift;
}

/* Whether the driver lacked memory since it was asked last. */
static bool driver_lacked_memory(void)
{
	bool lacked = false;
	for (GLenum failed; (failed = glGetError());)
		lacked = lacked || failed == GL_OUT_OF_MEMORY;
	return lacked;
}

/* A part of a row, whole rows, a part of a row. */
void view_gpu_write(const struct view_gpu_texels *t, uint64_t at, const void *data, uint64_t count)
{
	uint32_t width = 1u << t->shift;
	const uint8_t *bytes = data;
	glBindTexture(GL_TEXTURE_2D, t->texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	while (count) {
		uint32_t x = (uint32_t)at & (width - 1);
		bool part = x || count < width;
		uint64_t columns = !part ? width : count < width - x ? count : width - x;
		uint64_t rows = part ? 1 : count >> t->shift;
		glTexSubImage2D(GL_TEXTURE_2D, 0, (GLint)x, (GLint)(at >> t->shift), (GLsizei)columns,
			(GLsizei)rows, kinds[t->kind].layout, kinds[t->kind].type, bytes);
		bytes += columns * rows * kinds[t->kind].bytes;
		at += columns * rows;
		count -= columns * rows;
	}
}

enum eco_code view_gpu_room(struct view_gpu *gpu, struct view_gpu_texels *stream, enum view_gpu_kind kind,
	uint64_t texels, struct eco_error *error)
{
	uint64_t most = (uint64_t)gpu->side_max << shift_for(gpu, UINT64_MAX);
	if (texels > most)
		return eco_fail(error, ECO_TOO_LARGE, "the view needs %llu texels, the graphics driver "
			"allows %llu", (unsigned long long)texels, (unsigned long long)most);
	if (texels > stream->room || !stream->texture) {
		uint64_t room = texels + texels / 2;
		*stream = (struct view_gpu_texels){ stream->texture, kind, shift_for(gpu, room), 0 };
		make_texels(stream, room > most ? texels : room + 1);
		if (driver_lacked_memory())
			return eco_fail(error, ECO_NO_MEMORY, "the graphics driver has no memory for what is "
				"in view");
	}
	return ECO_OK;
}

enum eco_code view_gpu_stream(struct view_gpu *gpu, struct view_gpu_texels *stream, enum view_gpu_kind kind,
	const void *data, uint64_t texels, struct eco_error *error)
{
	enum eco_code code = view_gpu_room(gpu, stream, kind, texels, error);
	if (!code)
		view_gpu_write(stream, 0, data, texels);
	return code;
}

/* ---- Records ---- */

/* A list that outgrows its texture is written into a larger one from its start. */
static enum eco_code reserve(struct view_gpu *gpu, struct view_gpu_list *g, const struct view_list *list,
	uint64_t texels, struct eco_error *error)
{
	struct view_gpu_texels *records = &g->records;
	if (texels <= records->room)
		return ECO_OK;
	uint64_t whole = (uint64_t)list->list.primitive_count * view_record_texels(&list->list),
		room = texels + texels / 2;
	if (list->list.kind == ECO_LIST_IMPOSTOR)
		whole = room;
	room = room < whole ? room : whole;
	records->kind = VIEW_GPU_WORDS;
	records->shift = shift_for(gpu, whole);
	uint64_t most = (uint64_t)gpu->side_max << records->shift;
	if (texels > most)
		return eco_fail(error, ECO_TOO_LARGE, "list %u needs %llu texels, the graphics driver allows "
			"%llu: use --reference=cpu or fewer vertices", list->id, (unsigned long long)texels,
			(unsigned long long)most);
	gpu->bytes -= records->room * VIEW_TEXEL_BYTES;
	records->room = 0;
	g->chunks = 0;
	g->texels = 0;
	make_texels(records, room > most ? most : room);
	gpu->unchecked = true;
	gpu->bytes += records->room * VIEW_TEXEL_BYTES;
	return ECO_OK;
}

static void bound_points(struct view_gpu_list *g, const struct view_list *list, const uint32_t *words,
	uint64_t texels)
{
	uint32_t each = view_record_texels(&list->list);
	bool splats = list->list.attributes & ECO_ATTR_SPLAT;
	for (uint64_t i = 0; i < texels; i += each) {
		bool first = g->texels == 0 && i == 0;
		float at[3], reach = splats ? 0 : sqrtf(eco_size(words[4 * i + 3] >> 24));
		memcpy(at, words + 4 * i, sizeof at);
		for (int k = 0; k < 3; k++) {
			g->low[k] = first || at[k] < g->low[k] ? at[k] : g->low[k];
			g->high[k] = first || at[k] > g->high[k] ? at[k] : g->high[k];
		}
		for (uint32_t k = 1; k < each && splats; k++) {
			memcpy(at, words + 4 * (i + k), sizeof at);
			reach = fmaxf(reach, sqrtf(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]));
		}
		g->reach = first || reach > g->reach ? reach : g->reach;
	}
}

static enum eco_code upload_chunks(struct view_gpu_list *g, const struct view_list *list, uint32_t first,
	uint32_t end, struct eco_error *error)
{
	uint64_t texels = view_record_span(list, first, end);
	uint32_t *words = malloc(texels * VIEW_TEXEL_BYTES + 1);
	enum eco_code code = words ? view_record_write(list, first, end, words, error)
		: out_of_memory(list, error);
	if (!code) {
		if (list->list.kind == ECO_LIST_POINTS)
			bound_points(g, list, words, texels);
		view_gpu_write(&g->records, g->texels, words, texels);
		g->texels += texels;
		g->chunks = end;
	}
	free(words);
	return code;
}

static enum eco_code extend(struct view_gpu *gpu, struct view_gpu_list *g, const struct view_list *list,
	struct eco_error *error)
{
	enum eco_code code = reserve(gpu, g, list, view_record_span(list, 0, list->chunk_count), error);
	while (!code && g->chunks < list->chunk_count) {
		uint32_t end = g->chunks + 1;
		while (end < list->chunk_count
				&& view_record_span(list, g->chunks, end + 1) * VIEW_TEXEL_BYTES
				< UPLOAD_BYTES)
			end++;
		code = upload_chunks(g, list, g->chunks, end, error);
	}
	return code;
}

enum eco_code view_gpu_check(struct view_gpu *gpu, struct eco_error *error)
{
	uint32_t side_max = gpu->side_max;
	if (!gpu->unchecked || !driver_lacked_memory()) {
		gpu->unchecked = false;
		return ECO_OK;
	}
	unsigned long long bytes = gpu->bytes;
	view_gpu_free(gpu);
	gpu->side_max = side_max;
	return eco_fail(error, ECO_NO_MEMORY, "the graphics driver has no memory for %llu bytes of plants: "
		"use fewer vertices", bytes);
}

/* ---- Images ---- */

static enum eco_code upload_image(struct view_gpu_list *g, const struct view_list *list,
	struct eco_error *error)
{
	const struct eco_image *image = &list->image;
	GLint most = 0;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	if (!image->rgba || image->width > (uint32_t)most || image->height > (uint32_t)most)
		return eco_fail(error, ECO_UNSUPPORTED, "image %u (%u x %u) is not there or larger than the "
			"graphics driver's %d", list->id, image->width, image->height, most);
	glDeleteTextures(1, &g->color);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glGenTextures(1, &g->color);
	glBindTexture(GL_TEXTURE_2D, g->color);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, (GLsizei)image->width, (GLsizei)image->height, 0,
		GL_RGBA, GL_UNSIGNED_BYTE, image->rgba);
	glGenerateMipmap(GL_TEXTURE_2D);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
	memcpy(g->shown, list->shown, sizeof g->shown);
	return ECO_OK;
}

enum eco_code view_gpu_list(struct view_gpu *gpu, const struct view_list *list,
	const struct view_gpu_list **out, struct eco_error *error)
{
	uint32_t index = view_table_get(&gpu->table, list->id);
	if (index == UINT32_MAX) {
		if (!eco_array_grow(&gpu->lists, &gpu->room, gpu->count, sizeof *gpu->lists))
			return out_of_memory(list, error);
		index = gpu->count;
		if (!view_table_put(&gpu->table, list->id, index))
			return out_of_memory(list, error);
		gpu->lists[gpu->count++] = (struct view_gpu_list){ .id = list->id };
	}
	struct view_gpu_list *g = &gpu->lists[index];
	*out = g;
	if (list->list.kind == ECO_LIST_IMAGE)
		return g->color && memcmp(g->shown, list->shown, sizeof g->shown) == 0 ? ECO_OK
			: upload_image(g, list, error);
	return extend(gpu, g, list, error);
}

/* ---- Extents ---- */

double view_extent_ellipses(const struct lod_eye *eye, const struct view_selection *selection,
	const struct view_gpu_list *g, const struct view_list *list, const struct eco_cut *cut,
	const uint32_t *members, uint32_t count)
{
	bool splats = list->list.attributes & ECO_ATTR_SPLAT;
	double ball = lod_ball_radius(&list->list, cut->scale), radius = cut->halvings ? 2 * ball : 0;
	double reach = (double)g->reach * (splats ? sqrt((double)cut->scale) : ball), most = 0;
	float middle[3], half[3];
	for (int k = 0; k < 3; k++) {
		middle[k] = 0.5f * (g->low[k] + g->high[k]);
		half[k] = 0.5f * (g->high[k] - g->low[k]);
	}
	radius += sqrt((double)(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]));
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_place *place = &selection->instances[members[i]].place;
		double at[3], most_of = lod_place_most(place), far = -radius * most_of;
		lod_place_point(place, middle, at);
		for (int k = 0; k < 3; k++)
			far += (at[k] - eye->at[k]) * eye->forward[k];
		if (!(far > 2 * reach * most_of))
			return INFINITY;
		most = fmax(most, reach * most_of / far);
	}
	return most;
}
