/* Textures of parts, in the order in which plants of a full build would show them. */
#include "ecofiles/ecopack/link_part.h"
#include "ecofiles/ecopack/make_textures.h"

static struct make_texture describe(struct link_part *part, uint32_t list)
{
	const struct eco_scene *s = &part->pack->scene;
	const struct eco_list *image = &s->lists[list],
		*outline = image->image == ECO_NONE ? NULL : &s->lists[image->image];
	struct make_texture t = { .count = image->chunk_count, .outlined = outline,
		.texel_area = image->unit_area, .from = part, .list = list };
	for (uint32_t k = 0; k < t.count; k++)
		t.colors[k] = s->chunks[image->chunk_first + k].id;
	for (uint32_t k = 0; outline && k < outline->chunk_count; k++)
		t.outlines[k] = s->chunks[outline->chunk_first + k].id;
	return t;
}

/* part->list_of is for now where a texture is in l->m.textures. */
static enum eco_code find(struct link *l, struct link_part *part)
{
	const struct eco_scene *s = &part->pack->scene;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < s->list_count && !code; i++)
		if (s->lists[i].kind == ECO_LIST_IMAGE) {
			struct make_texture texture = describe(part, i);
			code = make_share_texture(&l->m, &texture, &part->list_of[i]);
		}
	return code;
}

static enum eco_code copy(struct link *l, uint32_t id)
{
	struct make_texture *shared = (struct make_texture *)l->m.textures.items + id;
	struct link_part *part = shared->from;
	uint32_t image = shared->list, outline = part->pack->scene.lists[image].image;
	const uint32_t lists[] = { outline, image };
	enum eco_code code = ECO_OK;
	for (int i = outline == ECO_NONE; i < 2 && !code; i++) {
		struct eco_list record = link_list(part, lists[i]);
		record.owner = ECO_NONE;
		record.unit_area = shared->texel_area;
		code = link_copy(l, part, lists[i], &record);
	}
	shared->list = part->list_of[image];
	part->list_of[image] = id;
	return code;
}

static void refer(const struct link *l, struct link_part *part)
{
	const struct eco_scene *s = &part->pack->scene;
	const struct make_texture *all = l->m.textures.items;
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_IMAGE)
			part->list_of[i] = all[part->list_of[i]].list;
}

enum eco_code link_textures(struct link *l)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = l->count; i-- > 0 && !code;)
		code = find(l, &l->parts[i]);
	for (uint32_t i = 0; i < l->m.textures.count && !code; i++)
		code = copy(l, i);
	for (uint32_t i = 0; i < l->count && !code; i++)
		refer(l, &l->parts[i]);
	return code;
}
