#include "ecofiles/ecopack/make.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/confine.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/run.h"
#include "lod/build/summary.h"

/* Height of the smallest plant in each tile; INFINITY where there are none. */
static double smallest_m(const struct eco_scene *s)
{
	double *least = eco_alloc(s->tile_count, sizeof *least), all;
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
static double near_m(const struct make *m)
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

/* A killed or interrupted build leaves these, which the next one to the same path removes, too. */
static void remove_unfinished(void *path)
{
	char name[PATH_MAX + 64];
	for (int i = 0; i < 2; i++) {
		snprintf(name, sizeof name, "%s.tmp-%ld%s", (const char *)path, (long)getpid(), i ? "-payloads" : "");
		unlink(name);
	}
}

void make_create(struct make *m)
{
	eco_at_end(remove_unfinished, (void *)m->options->pack);
	eco_check(eco_pack_create(&m->writer, m->options->pack, m->error));
}

/* The pack's columns: those that are named, of all inventories, and why sizes are as they are. */
static void take_columns(struct make *m)
{
	const struct eco_string_pool *columns = &m->options->columns;
	for (uint32_t i = 0; i < columns->count; i++)
		eco_string_number(&m->columns, columns->items[i]);
	if (columns->count) {
		eco_string_number(&m->columns, ECO_INVENTORY_HEIGHT_FROM);
		eco_string_number(&m->columns, ECO_INVENTORY_CROWN_FROM);
	}
	for (uint32_t s = 0; s < m->sources.count; s++)
		for (uint32_t i = 0; i < m->sources.items[s].positions_count; i++) {
			m->sources.items[s].positions[i].cells = (const char *const *)columns->items;
			m->sources.items[s].positions[i].cell_count = columns->count;
		}
}

static void begin(struct make *m)
{
	main_progress("reading the scene", NULL, 0);
	eco_check(eco_sources_load(&m->sources, m->options->scene, m->error));
	for (uint32_t s = 0; s < m->sources.count && m->options->season_given; s++)
		for (uint32_t i = 0; i < m->sources.items[s].plant_count; i++)
			m->sources.items[s].plants[i].library.season = m->options->season;
	take_columns(m);
	make_create(m);
}

static void lay_ground(struct make *m)
{
	if (!m->sources.items[0].ground.none)
		make_ground_through(m);
}

void make_commit(struct make *m, json_t *meta)
{
	char *text = json_dumps(meta, JSON_INDENT(1));
	struct eco_pack_writer *writer = m->writer;
	json_decref(meta);
	m->scene.near_m = near_m(m);
	main_progress("writing", NULL, 1);
	m->writer = NULL;                    /* committing frees it in any case */
	enum eco_code code = eco_pack_commit(writer, &m->scene, text, m->error);
	free(text);
	eco_check(code);
}

static void commit(struct make *m)
{
	snprintf(m->scene.name, sizeof m->scene.name, "%s", m->sources.items[0].name);
	make_commit(m, make_meta(m));
}

/* Errors of inventories and ground are reported before the plants, which take longest. */
static void build(void *make)
{
	static const struct { enum main_stage stage; void (*run)(struct make *m); } steps[] = {
		{ MAIN_STAGE_SCENE, begin }, { MAIN_STAGE_SCENE, make_places_check },
		{ MAIN_STAGE_GROUND, make_ground_read }, { MAIN_STAGE_GROUND, make_image_look },
		{ MAIN_STAGE_GROUND, make_plants }, { MAIN_STAGE_GROUND, make_ground_pack },
		{ MAIN_STAGE_POSITIONS, make_places }, { MAIN_STAGE_POSITIONS, make_tiles },
		{ MAIN_STAGE_GROUND, lay_ground }, { MAIN_STAGE_GROUND, make_image },
		{ MAIN_STAGE_GROUND, make_inventory_pack }, { MAIN_STAGE_WRITING, commit } };
	for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
		main_times_stage(steps[i].stage);
		steps[i].run(make);
	}
}

void make_tables_free(struct make *m)
{
	struct make_array *arrays[] = { &m->anchors, &m->ladders, &m->curves, &m->tiles, &m->groups,
		&m->children, &m->lists, &m->places, &m->palette, &m->stands, &m->textures };
	for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
		free(arrays[i]->items);
	free(m->plants);
	free(m->table);
	eco_pack_abort(m->writer);
	eco_at_end(NULL, NULL);
	make_ground_free(m);
	make_inventory_free(m);
	eco_string_pool_free(&m->columns);
}

enum eco_code make_pack(const struct make_options *options, struct eco_error *error)
{
	struct eco_error own = { 0 };
	struct make m = { .options = options, .error = error ? error : &own };
	if (options->cache && options->cache[0])
		main_cache_begin();
	main_cache_open(&m.cache, options->cache, options->cache_bytes ? options->cache_bytes
		: MAIN_CACHE_LIMIT_MB * (uint64_t)1048576);
	enum eco_code code = eco_try(build, &m, m.error);
	main_times_stage(MAIN_STAGE_NONE);
	main_times_cache(m.cache.folder, m.cache.hits, m.cache.misses);
	main_cache_close(&m.cache);
	main_progress_end();
	make_places_free(&m);
	make_buildings_free(&m);
	make_plants_free(&m);
	eco_sources_free(&m.sources);
	make_tables_free(&m);
	return code;
}

/* ---- Tables ---- */

/* Used by every step of a build: tables that grow, lists stored and kept in them, the number of threads. */

void *make_append(struct make_array *array, size_t size)
{
	if (array->count == array->capacity) {
		uint64_t wanted = array->capacity ? 2 * array->capacity : 64;
		void *bigger = wanted < ECO_NONE ? realloc(array->items, wanted * size) : NULL;
		if (!bigger)
			eco_end("no memory");
		array->items = bigger;
		array->capacity = wanted;
	}
	return (uint8_t *)array->items + size * array->count++;
}

void make_add(struct make_array *array, const void *records, size_t count, size_t size)
{
	for (size_t i = 0; i < count; i++)
		memcpy(make_append(array, size), (const uint8_t *)records + i * size, size);
}

uint32_t make_add_colors(struct make *m, const uint8_t (*rgb)[3], uint32_t count)
{
	const uint8_t (*palette)[3] = m->palette.items;
	uint32_t first = 0;
	while (first + (uint64_t)count <= m->palette.count && memcmp(palette[first], rgb, count * sizeof *rgb) != 0)
		first++;
	if (first + (uint64_t)count > m->palette.count) {
		first = (uint32_t)m->palette.count;
		make_add(&m->palette, rgb, count, sizeof *rgb);
	}
	return first;
}

static uint32_t moved(const uint32_t *to, uint32_t index) { return index == ECO_NONE ? ECO_NONE : to[index]; }

void make_add_plant(struct make *m, uint32_t id, const struct make_tables *from,
	const uint32_t *lists)
{
	struct eco_plant *plant = &m->table[id];
	uint32_t curve_first = (uint32_t)m->curves.count;
	plant->anchor_first = (uint32_t)m->anchors.count;
	plant->ladder_first = (uint32_t)m->ladders.count;
	plant->ladder_count = from->ladder_count;
	make_add(&m->anchors, from->anchors, plant->anchor_count, sizeof *from->anchors);
	make_add(&m->curves, from->curves, from->curve_count, sizeof *from->curves);
	for (uint32_t i = 0; i < from->ladder_count; i++) {
		struct eco_ladder ladder = from->ladders[i];
		ladder.plant = id;
		ladder.anchor += plant->anchor_first - from->anchor_first;
		ladder.curve_first += curve_first - from->curve_first;
		ladder.points = moved(lists, ladder.points);
		ladder.lines = moved(lists, ladder.lines);
		ladder.simple = moved(lists, ladder.simple);
		ladder.triangles = moved(lists, ladder.triangles);
		ladder.impostor = moved(lists, ladder.impostor);
		make_add(&m->ladders, &ladder, 1, sizeof ladder);
	}
}

void make_keep_list(struct make *m, uint32_t list_id)
{
	const struct eco_list *stored = eco_pack_list(m->writer, list_id);
	m->scene.needs |= eco_list_needs(stored);
	make_add(&m->lists, stored, 1, sizeof *stored);
}

uint32_t make_add_list(struct make *m, const struct eco_list *list, const struct eco_elements *elements,
	const uint32_t *ends, uint32_t end_count, const struct eco_elements *partner)
{
	uint32_t id = eco_pack_add_list(m->writer, list, elements, ends, end_count, partner);
	make_keep_list(m, id);
	return id;
}

uint32_t make_add_encoded(struct make *m, const struct eco_list *list, const struct eco_encoded *encoded)
{
	uint32_t id = eco_pack_add_encoded(m->writer, list, encoded);
	make_keep_list(m, id);
	return id;
}

uint32_t make_add_bytes(struct make *m, const struct eco_list *list, const struct eco_bytes *chunks, uint32_t count)
{
	uint32_t id = eco_pack_add_bytes(m->writer, list, chunks, count);
	make_keep_list(m, id);
	return id;
}

uint32_t make_add_levels(struct make *m, const struct eco_list *list, const struct eco_writer *levels, uint32_t count)
{
	struct make_array chunks = { 0 };
	for (uint32_t i = 0; i < count; i++) {
		struct eco_reader r = { .bytes = levels[i].bytes, .size = levels[i].size };
		while (r.at < r.size) {
			size_t size = eco_read_u32(&r);
			uint8_t *strip = levels[i].bytes + r.at;
			eco_read_bytes(&r, size);
			const uint32_t last = r.at == r.size;
			make_add(&chunks, &(struct eco_encoded_chunk){ strip, size, last, last }, 1,
				sizeof(struct eco_encoded_chunk));
		}
	}
	uint32_t id = make_add_encoded(m, list, &(struct eco_encoded){ chunks.items, (uint32_t)chunks.count });
	free(chunks.items);
	return id;
}

uint32_t make_threads(const struct make *m)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	return m->options->jobs ? m->options->jobs : processors > 64 ? 64 : processors > 0
		? (uint32_t)processors : 1;
}

/* ---- --confine ---- */

/* Which folders a make needs: nothing that a scene names is among them unless it lies below its own. */

static void folder_of(char folder[PATH_MAX], const char *path)
{
	const char *slash = strrchr(path, '/');
	snprintf(folder, PATH_MAX, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
}

enum eco_code make_confine(const struct make_options *options, const char *folder, struct eco_error *error)
{
	static char scene[PATH_MAX], pack[PATH_MAX];
	static const char *readable[] = { NULL, NULL }, *writable[] = { pack, NULL, NULL };
	folder_of(scene, options->scene);
	folder_of(pack, options->pack);
	readable[0] = *folder ? folder : scene;
	if (options->cache && *options->cache && main_cache_make(options->cache))
		writable[1] = options->cache;
	const struct eco_confined_paths paths = { .readable = readable, .writable = writable };
	ECO_PASS(eco_confine(&paths, error));
	return eco_confined_may_read(options->scene) ? ECO_OK : eco_fail(error, ECO_BAD_USAGE, "%.200s does not lie below %.200s, to "
		"which --confine keeps reading", options->scene, readable[0]);
}
