#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/progress.h"
#include "ecofiles/ecopack/times.h"
#include "lod/build/summary.h"

/* Height of the smallest plant in each tile; INFINITY where there are none. */
static double smallest_m(const struct eco_scene *s)
{
	double *least = malloc((s->tile_count + 1u) * sizeof *least), all;
	if (!least)
		return 0;
	for (uint32_t id = s->tile_count; id-- > 0;) {
		const struct eco_tile *t = &s->tiles[id];
		least[id] = INFINITY;
		for (uint32_t g = t->group_first; g < t->group_first + t->group_count; g++)
			for (uint32_t i = 0; i < s->groups[g].count; i++)
				least[id] =
					fmin(least[id],
					eco_place_read(s, s->groups[g].place_first + i).scale / 65536.0
					* s->plants[s->groups[g].plant].height_m);
		for (uint32_t c = t->child_first; c < t->child_first + t->child_count; c++)
			least[id] =
				fmin(least[id], (double)s->children[c].scale * least[s->children[c].tile]);
	}
	all = least[s->root];
	free(least);
	return all;
}

/* About 2^-17 of the scene's diameter, which leaves depth resolution to spare, but never so far that it
 * cuts into a plant seen from close by. */
double make_near_m(const struct make *m)
{
	const struct eco_tile *root = &m->scene.tiles[0];
	double square = 0;
	for (int i = 0; i < 3; i++) {
		double extent = root->high[i] - root->low[i];
		if (m->has_ground && i < 2)
			extent = fmax(extent,
				i ? m->ground.step_y_m * (m->ground.rows - 1 - 2 * m->ground.margin)
				  : m->ground.step_x_m * (m->ground.columns - 1 - 2 * m->ground.margin));
		square += extent * extent;
	}
	double near = fmin(ldexp(sqrt(square), -17), smallest_m(&m->scene) / 64);
	return lod_power_below(fmax(near, 1e-6));
}

static enum eco_code build(struct make *m)
{
	main_times_stage(MAIN_STAGE_SCENE);
	if (!main_progress("reading the scene", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = eco_sources_load(&m->sources, m->options->scene, m->error);
	if (!code)
		code = eco_pack_create(&m->writer, m->options->pack, m->error);
	/* report errors of inventories and ground before the plants, which take longest */
	if (!code)
		code = make_places_check(m);
	main_times_stage(MAIN_STAGE_GROUND);
	if (!code)
		code = make_ground_read(m);
	if (!code && m->has_ground)
		make_doubt_ground(m);
	if (!code)
		code = make_image_look(m);
	if (!code)
		code = make_plants(m);
	main_times_stage(MAIN_STAGE_GROUND);
	if (!code)
		code = make_ground_pack(m);
	main_times_stage(MAIN_STAGE_POSITIONS);
	if (!code)
		code = make_places(m);
	if (!code)
		code = make_tiles(m);
	main_times_stage(MAIN_STAGE_GROUND);
	if (!code && !m->sources.items[0].ground.none)
		code = make_ground_through(m);
	if (!code)
		code = make_image(m);
	if (!code)
		code = make_inventory_pack(m);
	if (code)
		return code;
	snprintf(m->scene.name, sizeof m->scene.name, "%s", m->sources.items[0].name);
	m->scene.near_m = make_near_m(m);
	char *meta = NULL;
	main_times_stage(MAIN_STAGE_WRITING);
	code = make_meta(m, &meta, m->error);
	if (!code && !main_progress("writing", NULL, 1))
		code = eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	if (!code) {
		struct eco_pack_writer *writer = m->writer;
		m->writer = NULL;        /* committing frees it in any case */
		code = eco_pack_commit(writer, &m->scene, meta, m->error);
	}
	free(meta);
	return code;
}

enum eco_code make_pack(const struct make_options *options, struct eco_error *error)
{
	struct eco_error own = { 0 };
	struct make m = { .options = options, .error = error ? error : &own };
	if (options->cache && options->cache[0])
		make_cache_begin();
	main_cache_open(&m.cache, options->cache, options->cache_bytes ? options->cache_bytes
		: MAIN_CACHE_LIMIT_MB * (uint64_t)1048576);
	enum eco_code code = build(&m);
	main_times_stage(MAIN_STAGE_NONE);
	main_times_cache(m.cache.folder, m.cache.hits, m.cache.misses);
	main_cache_close(&m.cache);
	main_progress_end();
	eco_pack_abort(m.writer);
	make_places_free(&m);
	make_plants_free(&m);
	make_ground_free(&m);
	make_inventory_free(&m);
	make_species_free(&m);
	eco_sources_free(&m.sources);
	struct make_array *arrays[] = { &m.anchors, &m.ladders, &m.curves, &m.tiles, &m.groups, &m.children,
		&m.lists, &m.places, &m.palette, &m.stands };
	for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
		free(arrays[i]->items);
	return code;
}
