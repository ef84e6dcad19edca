/* Textures of a pack, shared by its plants. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"

/* All levels that both have are alike. */
static bool same_image(const struct make_texture *a, const struct make_texture *b)
{
	size_t size = (a->count < b->count ? a->count : b->count) * sizeof *a->colors;
	return a->outlined == b->outlined && memcmp(a->colors, b->colors, size) == 0
		&& (!a->outlined || memcmp(a->outlines, b->outlines, size) == 0);
}

uint32_t make_share_texture(struct make *m, const struct make_texture *texture)
{
	struct make_texture *all = m->textures.items;
	uint32_t at = 0;
	while (at < m->textures.count && !same_image(&all[at], texture))
		at++;
	if (at == m->textures.count) {
		make_add(&m->textures, texture, 1, sizeof *texture);
		return at;
	}
	const struct make_texture *fine = texture->count > all[at].count ? texture : &all[at],
		*other = fine == texture ? &all[at] : texture;
	/* what a texel of the finer one's last level covers where the other is seen */
	float area = ldexpf(other->texel_area, 2 * ((int)other->count - (int)fine->count));
	struct make_texture both = *fine;
	both.texel_area = fmaxf(fine->texel_area, area);
	all[at] = both;
	return at;
}

static struct make_texture describe(struct lod_texture *texture)
{
	struct make_texture t = { .count = texture->count, .outlined = texture->outlines,
		.texel_area = texture->texel_area, .from = texture };
	for (uint32_t k = 0; k < t.count; k++) {
		t.colors[k] = eco_chunk_hash(texture->colors[k].bytes, texture->colors[k].size);
		if (t.outlined)
			t.outlines[k] = eco_chunk_hash(texture->outlines[k].bytes, texture->outlines[k].size);
	}
	return t;
}

/* Finds each plant's textures among the shared ones. */
static void find(struct make *m)
{
	for (uint32_t p = 0; p < m->plant_count; p++) {
		struct make_plant *plant = &m->plants[p];
		plant->images = eco_alloc(plant->built.image_count, sizeof *plant->images);
		for (uint32_t i = 0; i < plant->built.image_count; i++) {
			struct make_texture texture = describe(&plant->textures[i]);
			plant->images[i] = make_share_texture(m, &texture);
		}
	}
}

static void pack(struct make *m, struct make_texture *shared)
{
	const struct lod_texture *texture = shared->from;
	struct eco_list list = { .kind = ECO_LIST_OUTLINE, .coder = ECO_CODER_BYTES, .owner = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE, .grid_step = { 1, 1, 1 },
		.unit_area = shared->texel_area, .level = texture->loss };
	if (texture->outlines)
		list.image = make_add_levels(m, &list, texture->outlines, texture->count);
	list.kind = ECO_LIST_IMAGE;
	list.level = 0;
	shared->list = make_add_levels(m, &list, texture->colors, texture->count);
}

void make_textures(struct make *m)
{
	find(m);
	struct make_texture *all = m->textures.items;
	for (uint32_t i = 0; i < m->textures.count; i++)
		pack(m, &all[i]);
	for (uint32_t p = 0; p < m->plant_count; p++)
		for (uint32_t i = 0; i < m->plants[p].built.image_count; i++)
			m->plants[p].images[i] = all[m->plants[p].images[i]].list;
}
