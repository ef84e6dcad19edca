#include "tests/bench/pictures/bench_full.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/format/chunk/chunk.h"

/* ---- Lists ---- */

/* Ladders that full detail draws: a plant with cells is drawn by them, and splats stand for what is there. */
static bool is_full(const struct eco_ladder *ladder)
{
	return !(ladder->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE));
}

/* The last level; without levels all triangles. */
static void last_level(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t *first,
	uint32_t *end)
{
	uint32_t levels = ladder->level_count;
	*first = levels > 1 ? ladder->level_end[levels - 2] : 0;
	*end = levels ? ladder->level_end[levels - 1] : scene->lists[ladder->triangles].primitive_count;
}

static enum eco_code no_memory(struct eco_error *error)
{
	return eco_fail(error, ECO_NO_MEMORY, "no memory for a scene's full detail");
}

/* ---- Triangles ---- */

static struct bench_full_mesh *find_mesh(struct bench_full *full, uint32_t plant, uint32_t image,
	bool colored)
{
	for (uint32_t i = full->mesh_count; i-- > 0 && full->meshes[i].plant == plant;)
		if (full->meshes[i].image == image && full->meshes[i].colored == colored)
			return &full->meshes[i];
	struct bench_full_mesh *bigger = realloc(full->meshes, (full->mesh_count + 1u) * sizeof *bigger);
	if (!bigger)
		return NULL;
	full->meshes = bigger;
	full->meshes[full->mesh_count] = (struct bench_full_mesh){ .plant = plant, .image = image,
		.colored = colored };
	return &full->meshes[full->mesh_count++];
}

static bool resize(void *array, size_t size)
{
	void **slot = array, *moved = realloc(*slot, size);
	if (moved)
		*slot = moved;
	return moved;
}

bool bench_full_room(struct bench_full_mesh *mesh, uint32_t corners)
{
	if (mesh->room >= corners)
		return true;
	uint32_t room = corners < 1u << 30 ? 2 * corners : UINT32_MAX;
	if (!resize(&mesh->position, 3 * (size_t)room * sizeof *mesh->position)
			|| (mesh->image != ECO_NONE
			&& !resize(&mesh->uv, 2 * (size_t)room * sizeof *mesh->uv))
			|| (mesh->colored && !resize(&mesh->color, (size_t)room / 3 * sizeof *mesh->color)))
		return false;
	mesh->room = room;
	return true;
}

struct source { const struct eco_list *list; const struct eco_elements *elements; };

static void add_corner(struct bench_full_mesh *mesh, struct source from, uint32_t corner)
{
	size_t at = mesh->corners++;
	for (int k = 0; k < 3; k++)
		mesh->position[3 * at + (size_t)k] = (float)(from.list->grid_origin[k]
			+ from.elements->position[3 * (size_t)corner + (size_t)k]
			* from.list->grid_step[k]);
	for (size_t k = 0; k < 2 && mesh->uv; k++)
		mesh->uv[2 * at + k] = (float)from.elements->uv[2 * (size_t)corner + k] / ECO_UV_ONE;
}

/* Adds primitives [first, end) of a chunk, numbered from its first. */
static bool add_chunk(struct bench_full *full, uint32_t plant, struct source from, uint32_t first,
	uint32_t end)
{
	const struct eco_elements *e = from.elements;
	struct bench_full_mesh *mesh = find_mesh(full, plant, e->uv ? from.list->image : ECO_NONE,
		from.list->attributes & ECO_ATTR_COLOR);
	uint32_t primitive = 0, corner = 0;
	for (uint32_t i = 0; i < e->element_count; corner += e->corners[i++])
		for (uint32_t c = 2; c < e->corners[i]; c++, primitive++) {
			if (primitive < first || primitive >= end)
				continue;
			if (!mesh || !bench_full_room(mesh, mesh->corners + 3))
				return false;
			if (mesh->colored)
				mesh->color[mesh->corners / 3] = from.list->palette_first
					+ (uint32_t)e->extra[(size_t)i * e->extra_count];
			add_corner(mesh, from, corner);
			add_corner(mesh, from, corner + c - 1);
			add_corner(mesh, from, corner + c);
		}
	return true;
}

static enum eco_code add_ladder(struct bench_full *full, const struct eco_ladder *ladder,
	struct eco_error *error)
{
	const struct eco_scene *s = &full->pack->scene;
	const struct eco_list *list = &s->lists[ladder->triangles];
	uint32_t first, end, before = 0;
	enum eco_code code = ECO_OK;
	last_level(s, ladder, &first, &end);
	for (uint32_t c = 0; c < list->chunk_count && !code; c++) {
		const struct eco_chunk *chunk = &s->chunks[list->chunk_first + c];
		struct eco_elements elements = { 0 };
		const uint8_t *bytes;
		size_t size;
		if (before < end && before + chunk->primitive_count > first) {
			code = eco_pack_payload(full->pack, list->chunk_first + c, &bytes, &size, error);
			if (!code)
				code = eco_chunk_decode(list, chunk, c, bytes, size, &elements, error);
			if (!code && !add_chunk(full, ladder->plant, (struct source){ list, &elements },
					first > before ? first - before : 0, end - before))
				code = no_memory(error);
			eco_elements_free(&elements);
		}
		before += chunk->primitive_count;
	}
	return code;
}

/* ---- Places ---- */

static struct eco_placement placed(const struct eco_placement *outer, const struct eco_child *child)
{
	double sine, cosine;
	if (!child->placed)
		return *outer;
	eco_angle16_sincos(outer->turn, &sine, &cosine);
	return (struct eco_placement){ .turn = (uint16_t)(outer->turn + child->turn),
		.scale = outer->scale * (double)child->scale,
		.at = { outer->at[0] + outer->scale * (cosine * child->at[0] - sine * child->at[1]),
			outer->at[1] + outer->scale * (sine * child->at[0] + cosine * child->at[1]),
			outer->at[2] + outer->scale * child->at[2] } };
}

static void add_stands(struct bench_full *full, uint32_t tile, const struct eco_placement *placement)
{
	const struct eco_scene *s = &full->pack->scene;
	const struct eco_tile *t = &s->tiles[tile];
	for (uint32_t g = t->group_first; g < t->group_first + t->group_count; g++) {
		const struct eco_group *group = &s->groups[g];
		const struct eco_list *list = &s->lists[group->list];
		for (uint32_t i = 0; i < group->count; i++) {
			struct eco_place place = eco_place_read(s, group->place_first + i);
			struct bench_full_stand *stand = &full->stands[full->stand_count++];
			stand->plant = group->plant;
			lod_place_instance(&stand->place, placement, list, &place);
		}
	}
	for (uint32_t c = t->child_first; c < t->child_first + t->child_count; c++) {
		struct eco_placement inner = placed(placement, &s->children[c]);
		add_stands(full, s->children[c].tile, &inner);
	}
}

enum eco_code bench_full_open(struct bench_full *full, const char *pack, struct eco_error *error)
{
	*full = (struct bench_full){ 0 };
	enum eco_code code = eco_pack_open(&full->pack, pack, error);
	if (code)
		return code;
	const struct eco_scene *s = &full->pack->scene;
	full->stands = malloc((s->tiles[s->root].instance_count + 1) * sizeof *full->stands);
	code = full->stands ? ECO_OK : no_memory(error);
	for (uint32_t i = 0; i < s->ladder_count && !code; i++)
		if (is_full(&s->ladders[i]) && s->ladders[i].triangles != ECO_NONE)
			code = add_ladder(full, &s->ladders[i], error);
	if (!code)
		add_stands(full, s->root, &(struct eco_placement){ .scale = 1 });
	if (code)
		bench_full_close(full);
	return code;
}

void bench_full_close(struct bench_full *full)
{
	for (uint32_t i = 0; i < full->mesh_count; i++) {
		free(full->meshes[i].position);
		free(full->meshes[i].uv);
		free(full->meshes[i].color);
	}
	free(full->meshes);
	free(full->stands);
	eco_pack_close(full->pack);
	*full = (struct bench_full){ 0 };
}

/* ---- Bytes ---- */

uint32_t bench_full_last_chunk(const struct eco_scene *scene, uint32_t image)
{
	return scene->lists[image].chunk_first + scene->lists[image].chunk_count - 1;
}

static void need_all(const struct eco_scene *s, bool *needed, uint32_t list)
{
	for (uint32_t c = 0; c < s->lists[list].chunk_count; c++)
		needed[s->lists[list].chunk_first + c] = true;
}

static void need_texture(const struct eco_scene *s, bool *needed, uint32_t image)
{
	for (; image != ECO_NONE; image = s->lists[image].image)
		needed[bench_full_last_chunk(s, image)] = true;
}

static void need_ladder(const struct eco_scene *s, bool *needed, const struct eco_ladder *ladder)
{
	if (ladder->triangles == ECO_NONE) {
		if (ladder->lines != ECO_NONE)
			need_all(s, needed, ladder->lines);
		return;
	}
	const struct eco_list *list = &s->lists[ladder->triangles];
	uint32_t first, end, before = 0;
	last_level(s, ladder, &first, &end);
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		uint32_t count = s->chunks[list->chunk_first + c].primitive_count;
		needed[list->chunk_first + c] |= before < end && before + count > first;
		before += count;
	}
	need_texture(s, needed, list->image);
}

static int by_offset(const void *a, const void *b)
{
	const struct eco_chunk *x = *(const struct eco_chunk *const *)a,
		*y = *(const struct eco_chunk *const *)b;
	return x->offset < y->offset ? -1 : x->offset > y->offset;
}

static uint64_t sum_once(const struct eco_scene *s, const bool *needed, const struct eco_chunk **chunks)
{
	uint32_t count = 0;
	uint64_t sum = 0;
	for (uint32_t c = 0; c < s->chunk_count; c++)
		if (needed[c])
			chunks[count++] = &s->chunks[c];
	qsort(chunks, count, sizeof *chunks, by_offset);
	for (uint32_t i = 0; i < count; i++)
		sum += i && chunks[i]->offset == chunks[i - 1]->offset ? 0 : chunks[i]->size_bytes;
	return sum;
}

enum eco_code bench_full_bytes(const struct eco_scene *s, uint64_t *bytes, struct eco_error *error)
{
	bool *needed = calloc((size_t)s->chunk_count + 1, sizeof *needed);
	const struct eco_chunk **chunks = malloc(((size_t)s->chunk_count + 1) * sizeof *chunks);
	bool good = needed && chunks;
	for (uint32_t i = 0; good && i < s->ladder_count; i++)
		if (is_full(&s->ladders[i]))
			need_ladder(s, needed, &s->ladders[i]);
	for (uint32_t i = 0; good && i < s->group_count; i++)
		need_all(s, needed, s->groups[i].list);
	for (uint32_t i = 0; good && i < s->ground_count; i++)
		if (!s->ground[i].child_count)
			need_all(s, needed, s->ground[i].list);
	if (good)
		*bytes = sum_once(s, needed, chunks);
	free(needed);
	free(chunks);
	return good ? ECO_OK : no_memory(error);
}

