/* Point summaries of tiles. Eco files are summed up from the innermost out; of a nested file only its
 * stored summary is used. So a summary's cost does not depend on what lies below, and linking (link.c)
 * sums up packs that were built apart in the same way. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/make.h"

#include <stdlib.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/ecopack/run.h"
#include "lod/build/summary.h"

#define POOL_POINTS 2048u
#define SUMMARY_CHUNK 256u       /* a far tile asks for few points: small first chunks */

struct summary_list { struct eco_list list; struct eco_encoded encoded; bool any; };

static enum eco_code encode_summary(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	const struct make_summing *summing = ctx;
	const struct eco_scene *scene = &summing->m->scene;
	struct summary_list *made = result;
	struct lod_summary summary;
	struct eco_elements elements;
	uint32_t ends[64], tile = summing->first + (uint32_t)i;
	lod_summary_make(&summary, &(struct lod_summary_input){ .scene = scene,
		.pools = summing->pools, .tile = tile, .count = lod_summary_count(&scene->tiles[tile]),
		.seed = 1, .roots = (const struct lod_summary_root *const *)summing->roots,
		.color_of = summing->palette.color_of });
	made->any = summary.count > 0;
	if (made->any)
		lod_summary_list(&summary, scene, tile, summing->palette.count, &made->list, &elements);
	free(summary.points);
	if (!made->any)
		return ECO_OK;
	enum eco_code code = eco_pack_encode(&made->encoded, &made->list, &elements, ends,
		eco_chunk_split(elements.element_count, SUMMARY_CHUNK, ends, 64), error);
	eco_elements_free(&elements);
	return code;
}

static enum eco_code add_summary(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct make_summing *summing = ctx;
	struct make *m = summing->m;
	struct summary_list *made = result;
	(void)error;
	if (summing->done++ % 64 == 0)
		main_progress("summing up tiles", NULL, (double)summing->done / (double)m->tiles.count);
	if (made->any) {
		made->list.palette_first = summing->palette_first;
		((struct eco_tile *)m->tiles.items)[summing->first + i].summary
			= make_add_encoded(m, &made->list, &made->encoded);
		m->scene.needs |= ECO_NEED_SUMMARIES;
		make_refer(m);           /* the lists may have moved */
	}
	return ECO_OK;
}

static void drop_summary(void *result) { eco_encoded_free(&((struct summary_list *)result)->encoded); }

void make_summing_begin(struct make_summing *summing, struct make *m)
{
	*summing = (struct make_summing){ .m = m, .roots = eco_alloc(m->tiles.count, sizeof *summing->roots) };
}

static void choose_colors(struct make_summing *summing, uint32_t first, uint32_t count)
{
	struct make *m = summing->m;
	struct lod_summary_palette *palette = &summing->palette;
	make_refer(m);
	free(palette->color_of);
	lod_summary_palette_make(palette, &(struct lod_summary_input){ .scene = &m->scene,
		.pools = summing->pools, .roots = (const struct lod_summary_root *const *)summing->roots }, first, count);
	summing->palette_first = make_add_colors(m, (const uint8_t (*)[3])palette->rgb, palette->count);
	make_refer(m);
}

void make_summing_run(struct make_summing *summing, uint32_t first, uint32_t count)
{
	summing->first = first;
	choose_colors(summing, first, count);
	eco_check(main_jobs_run(&(struct main_jobs){ .count = count, .threads = make_threads(summing->m),
		.result_size = sizeof(struct summary_list), .work = encode_summary, .take = add_summary,
		.drop = drop_summary, .ctx = summing }, summing->m->error));
}

void make_summing_keep(struct make_summing *summing, uint32_t tile)
{
	struct make *m = summing->m;
	uint32_t list = m->scene.tiles[tile].summary;
	if (list == ECO_NONE)
		return;
	struct lod_summary_root *root = summing->roots[tile] = eco_alloc(1, sizeof *root);
	root->list = m->scene.lists[list];
	eco_check(eco_pack_read_points(m->writer, list, &root->elements, m->error));
	const struct eco_elements *e = &root->elements;
	for (uint32_t i = 0; i < e->element_count; i++)
		if ((uint32_t)e->extra[(size_t)i * e->extra_count] >= root->list.palette_count)
			eco_stop(ECO_DAMAGED, "the summary of tile %u names a colour that is not there", tile);
}

void make_summing_end(struct make_summing *summing)
{
	for (uint32_t i = 0; summing->pools && i < summing->m->plant_count; i++)
		lod_pool_free(&summing->pools[i]);
	free(summing->pools);
	free(summing->palette.color_of);
	for (uint64_t i = 0; summing->roots && i < summing->m->tiles.count; i++) {
		if (summing->roots[i])
			eco_elements_free(&summing->roots[i]->elements);
		free(summing->roots[i]);
	}
	free(summing->roots);
}

void make_summaries(struct make *m)
{
	struct make_summing summing;
	make_summing_begin(&summing, m);
	summing.pools = eco_alloc(m->plant_count, sizeof *summing.pools);
	for (uint32_t i = 0; i < m->plant_count; i++)
		lod_pool_make(&summing.pools[i], &m->plants[i].built, m->plants[i].palette_first, POOL_POINTS);
	for (uint32_t s = m->sources.count, end = (uint32_t)m->tiles.count; s-- > 0; end = m->ecos[s].tile_first) {
		make_summing_run(&summing, m->ecos[s].tile_first, end - m->ecos[s].tile_first);
		if (s > 0)
			make_summing_keep(&summing, m->ecos[s].tile_first);
	}
	make_summing_end(&summing);
}
