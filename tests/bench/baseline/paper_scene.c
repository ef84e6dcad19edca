#include "tests/bench/baseline/paper_scene.h"

#include <stdlib.h>
#include <string.h>

#include "client-min/view_reference.h"
#include "lod/ladder.h"
#include "tests/bench/baseline/paper_rules.h"

/* ---- Lists of the pack ---- */

static bool is_held(const struct eco_list *list)
{
	return list->kind != ECO_LIST_IMPOSTOR && list->kind != ECO_LIST_INVENTORY
		&& !(list->attributes & ECO_ATTR_SPLAT);
}

/* A paper scales all leaves alike. */
static void grow_plainly(const struct view_list *list)
{
	if (!(list->list.attributes & ECO_ATTR_GROWTH))
		return;
	uint32_t at = eco_list_extra_at(&list->list, ECO_ATTR_GROWTH), each = list->elements.extra_count;
	for (uint32_t i = 0; i < list->elements.element_count; i++)
		list->elements.extra[(size_t)i * each + at] = ECO_GROWTH_PLAIN;
}

static enum eco_code feed_list(struct paper_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_list *list = &s->scene->lists[id];
	const struct eco_group *groups = list->group_count ? eco_list_groups(s->scene, id) : NULL;
	enum eco_code code = view_store_events.list(s->store, id, list,
		s->scene->palette + list->palette_first, groups, error);
	for (uint32_t i = 0; i < list->chunk_count && !code; i++) {
		const uint8_t *bytes;
		size_t size;
		code = eco_pack_payload(s->pack, list->chunk_first + i, &bytes, &size, error);
		code = code ? code : view_store_events.chunk(s->store, id, i,
			&s->scene->chunks[list->chunk_first + i], bytes, error);
	}
	return code;
}

static enum eco_code feed_pack(struct paper_scene *s, struct eco_error *error)
{
	const struct eco_scene *scene = s->scene;
	enum eco_code code = view_store_events.scene(s->store, scene, &s->pack->id, error);
	for (uint32_t i = 0; i < scene->plant_count && !code; i++)
		code = view_store_events.plant(s->store, i, &scene->plants[i],
			scene->anchors + scene->plants[i].anchor_first, error);
	/* forms come after what they are forms of */
	for (int forms = 0; forms < 2; forms++)
		for (uint32_t i = 0; i < scene->list_count && !code; i++)
			if (is_held(&scene->lists[i]) && (scene->lists[i].partner != ECO_NONE) == forms)
				code = feed_list(s, i, error);
	for (uint32_t i = 0; i < scene->list_count && !code; i++)
		if (view_store_list(s->store, i))
			grow_plainly(view_store_list(s->store, i));
	return code;
}

bool paper_is_leaves(const struct eco_ladder *ladder)
{
	return ladder->organ != ECO_ORGAN_WOOD && !(ladder->flags & ECO_LADDER_WHOLE)
		&& ladder->triangles != ECO_NONE;
}

/* ---- Tables ---- */

static enum eco_code count_triangles(struct paper_scene *s, uint32_t list, struct eco_error *error)
{
	const struct eco_elements *e = &view_store_list(s->store, list)->elements;
	uint32_t *sums = s->triangles[list];
	if (!sums)
		sums = s->triangles[list] = calloc(e->element_count + 1u, sizeof *sums);
	for (uint32_t i = 0; sums && i < e->element_count; i++)
		sums[i + 1] = sums[i] + e->corners[i] - 2;
	return sums ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for tables");
}

static enum eco_code make_tables(struct paper_scene *s, struct eco_error *error)
{
	const struct eco_scene *scene = s->scene;
	enum eco_code code = ECO_OK;
	s->triangles = calloc(scene->list_count + 1u, sizeof *s->triangles);
	s->wood_full = calloc(scene->plant_count + 1u, sizeof *s->wood_full);
	if (!s->triangles || !s->wood_full)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for tables");
	for (uint32_t i = 0; i < scene->ladder_count && !code; i++) {
		const struct eco_ladder *l = &scene->ladders[i];
		if (l->organ == ECO_ORGAN_WOOD && !(l->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE)))
			s->wood_full[l->plant] += (double)lod_ladder_full(scene, l);
		if (paper_is_leaves(l))
			code = count_triangles(s, l->triangles, error);
	}
	return code;
}

uint32_t paper_triangles(const struct paper_scene *s, uint32_t list, uint32_t elements)
{
	uint32_t most = s->scene->lists[list].element_count;
	return s->triangles[list][elements < most ? elements : most];
}

enum eco_code paper_scene_open(struct paper_scene **scene, const char *pack, struct eco_error *error)
{
	struct view_store_options options = { .images = true, .memory_max = 16ull << 30 };
	struct paper_scene *s = *scene = calloc(1, sizeof *s);
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %s", pack);
	enum eco_code code = eco_pack_open(&s->pack, pack, error);
	if (!code) {
		s->scene = &s->pack->scene;
		code = lod_plan_tables_make(&s->tables, s->scene, error);
	}
	code = code ? code : view_store_new(&s->store, &options, error);
	code = code ? code : feed_pack(s, error);
	code = code ? code : make_tables(s, error);
	code = code ? code : paper_deussen_lists(s, error);
	if (code) {
		paper_scene_close(s);
		*scene = NULL;
	}
	return code;
}

void paper_scene_close(struct paper_scene *s)
{
	if (!s)
		return;
	for (uint32_t i = 0; s->triangles && i < s->scene->list_count; i++)
		free(s->triangles[i]);
	free(s->triangles);
	free(s->points);
	free(s->lines);
	free(s->wood_full);
	view_store_free(s->store);
	lod_plan_tables_free(s->tables);
	if (s->pack)
		eco_pack_close(s->pack);
	free(s);
}

/* ---- Drawing ---- */

enum eco_code paper_draw(struct paper_scene *s, struct eco_plan *plan, const struct eco_view *view, bool soft,
	struct paper_frame *frame, struct eco_error *error)
{
	struct lod_eye eye;
	*frame = (struct paper_frame){ 0 };
	lod_eye_make(&eye, view);
	view_store_begin(s->store);
	enum eco_code code = view_store_events.plan(s->store, plan, error);
	code = code ? code : view_select_make(&frame->selection, s->store, &eye, error);
	struct view_reference_job job = { .store = s->store, .selection = &frame->selection, .eye = &eye,
		.near_m = view_store_near_m(s->store) };
	code = code ? code : view_picture_init(&frame->picture, view->width, view->height, error);
	code = code ? code : view_reference_draw(&job, &frame->picture, error);
	return code || !soft ? code : view_measure_soft(&job, &frame->picture, error);
}

void paper_frame_free(struct paper_frame *frame)
{
	view_picture_free(&frame->picture);
	view_select_free(&frame->selection);
}
