/* Places of plants, read as `ecopack make` does but without models. Each nested file is read once. Its
 * plants are drawn if the plants of all nested files are few enough, else its outline. */
#include "ecofiles/ecopack/map.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/order.h"
#include "ecofiles/format/plan.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/land/areas.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"

#define EXPANDED_MAX 4000000u    /* plants of nested files drawn one by one */
#define OUTLINES_MAX 4000u
#define EDGES_MAX 2000000u
#define POINTS_MAX 500000000u

/* Prints a line and adds it to the legend. */
static void say(void *ctx, const char *text)
{
	struct map *m = ctx;
	main_note("%s", text);
	eco_grow(&m->lines, &m->line_capacity, m->line_count, sizeof *m->lines);
	snprintf(m->lines[m->line_count++].text, sizeof m->lines->text, "%s", text);
}

static void add_point(struct map_points *points, const struct map_point *point)
{
	if (points->count >= POINTS_MAX)
		eco_stop(ECO_TOO_LARGE, "a map has at most %u plants", POINTS_MAX);
	eco_grow(&points->items, &points->capacity, points->count, sizeof *point);
	points->items[points->count++] = *point;
}

/* ---- Kinds ---- */

struct named { const char *name; uint32_t source, plant; };

static int by_name(const void *a, const void *b)
{
	return strcmp(((const struct named *)a)->name, ((const struct named *)b)->name);
}

/* Variants, and plants of one name in several files, are one kind. */
static void find_kinds(struct map *m)
{
	uint64_t count = 0;
	for (uint32_t s = 0; s < m->sources.count; s++)
		count += m->sources.items[s].plant_count;
	struct named *names = eco_alloc(count, sizeof *names);
	m->kind_of = eco_alloc(m->sources.count, sizeof *m->kind_of);
	m->kinds = eco_alloc(count, sizeof *m->kinds);
	count = 0;
	for (uint32_t s = 0; s < m->sources.count; s++) {
		m->kind_of[s] = eco_alloc(m->sources.items[s].plant_count, sizeof **m->kind_of);
		for (uint32_t p = 0; p < m->sources.items[s].plant_count; p++)
			names[count++] = (struct named){ m->sources.items[s].plants[p].name, s, p };
	}
	qsort(names, count, sizeof *names, by_name);
	for (uint64_t i = 0; i < count; i++) {
		if (i == 0 || strcmp(names[i].name, names[i - 1].name) != 0) {
			m->kinds[m->kind_count] = (struct map_kind){ .low_m = INFINITY, .high_m = -INFINITY };
			snprintf(m->kinds[m->kind_count++].name, sizeof m->kinds->name, "%s", names[i].name);
		}
		m->kind_of[names[i].source][names[i].plant] = m->kind_count - 1;
	}
	free(names);
}

/* height_m: NAN where the plant's own counts; scale multiplies it. species NULL: as the plant is named. */
struct stand { const double *at; double height_m, scale; const char *species; uint32_t file, row, line; double crown_m,
	base; uint32_t class; };

static void add_plant(struct map *m, uint32_t source, uint32_t plant, const struct stand *stand)
{
	const double *at = stand->at;
	double height = isnan(stand->height_m) ? m->sources.items[source].plants[plant].height_m
		: stand->height_m;
	struct map_point point = { (float)at[0], (float)at[1],
		height > 0 ? (float)(height * stand->scale) : 0, (float)stand->crown_m, (float)stand->base, m->kind_of[source][plant], 0, stand->file,
		stand->row, stand->line, stand->class };
	point.species = eco_string_number(&m->species, stand->species ? stand->species
		: m->kinds[point.kind].name);
	if (source == 0 && m->has_ground) {
		double z;
		m->off_ground += !eco_ground_height(&m->ground, at[0], at[1], &z);
	}
	add_point(&m->own[source], &point);
}

static void add_instances(struct map *m, uint32_t source)
{
	const struct eco_source *s = &m->sources.items[source];
	for (uint32_t i = 0; i < s->instance_count; i++) {
		const struct eco_source_instance *one = &s->instances[i];
		add_plant(m, source, one->plant, &(struct stand){ .at = one->at, .height_m = one->height_m,
			.scale = one->scale });
		if (i % 4096 == 0)
			main_progress("reading positions", s->path, 0);
	}
}

/* ---- Inventories ---- */

/* The file is read again for them. */
static void add_left_out(struct map *m, const struct eco_positions_spec *spec, const struct eco_frame *frame)
{
	struct eco_positions_spec others = *spec;
	struct eco_positions *reader = NULL;
	struct eco_position row;
	others.left_out = true;
	others.levels = 0;
	eco_check(eco_positions_open(&reader, &others, frame, m->error));
	for (;;) {
		eco_check(eco_positions_next(reader, &row, m->error));
		if (row.plant == ECO_NONE)
			break;
		add_point(&m->left_points, &(struct map_point){ .x = (float)row.at[0], .y = (float)row.at[1] });
	}
	eco_positions_close(reader);
}

static void add_rows(struct map *m, uint32_t source, const struct eco_positions_spec *spec)
{
	const struct eco_source *s = &m->sources.items[source];
	struct eco_frame frame = eco_source_frame(s);
	struct eco_positions *reader = NULL;
	struct eco_position row;
	uint32_t file = m->file_count;
	eco_grow(&m->files, &m->file_capacity, file, sizeof *m->files);
	m->files[m->file_count++] = eco_path_last(spec->path);
	eco_check(eco_positions_open(&reader, spec, &frame, m->error));
	for (uint64_t i = 0;; i++) {
		if (i % 4096 == 0)
			main_progress("reading positions", spec->path, 0);
		eco_check(eco_positions_next(reader, &row, m->error));
		if (row.plant == ECO_NONE)
			break;
		add_plant(m, source, row.plant, &(struct stand){ row.at, row.height_m, row.scale,
			row.species, file, row.row <= UINT32_MAX ? (uint32_t)row.row : 0,
			row.line <= UINT32_MAX && eco_positions_has_lines(reader) ? (uint32_t)row.line : 0,
			isnan(row.crown_radius_m) ? 0 : 2 * row.crown_radius_m * row.scale, isnan(row.base) ? 0 : row.base,
			eco_tints_value(&m->tints, &spec->tint, row.tint) });
	}
	eco_positions_report(reader, say, m);
	const struct eco_skipped *skipped = eco_positions_skipped(reader, &(uint64_t){ 0 });
	bool any = skipped[ECO_SKIP_FILTERED].count + skipped[ECO_SKIP_LEFT_OUT].count > 0;
	eco_positions_close(reader);
	if (any && source == 0)
		add_left_out(m, spec, &frame);
}

/* ---- Scattered plants ---- */

static void add_edges(struct map_edges *edges, const struct eco_areas *areas)
{
	for (uint32_t i = 0; i < areas->edge_count && edges->count < EDGES_MAX; i++) {
		const struct eco_edge *e = &areas->edges[i];
		map_add_edge(edges, (const double[4]){ e->a[0], e->a[1], e->b[0], e->b[1] });
	}
}

static void add_scattered(struct map *m, uint32_t source, const struct eco_scatter_spec *spec)
{
	const struct eco_source *s = &m->sources.items[source];
	struct eco_frame frame = eco_source_frame(s);
	struct eco_scatter *scatter = NULL;
	struct eco_scatter_place place;
	eco_check(eco_scatter_open(&scatter, spec, &frame, main_scatter_progress, spec->path, m->error));
	while (eco_scatter_next(scatter, &place))
		add_plant(m, source, place.plant, &(struct stand){ .at = place.at, .height_m = place.height_m,
			.scale = 1 });
	eco_scatter_report(scatter, say, m);
	/* nested files' areas would have to be turned; their plants show them */
	if (source == 0) {
		add_edges(&m->areas, eco_scatter_areas(scatter));
		add_edges(&m->clear_of, eco_scatter_clear_of(scatter));
	}
	eco_scatter_close(scatter);
}

/* ---- Nested files ---- */

static struct eco_placement inside(const struct eco_placement *outer, const struct eco_source_child *child)
{
	const struct eco_child like = { .at = { child->at[0], child->at[1], child->at[2] },
		.turn = eco_angle16_from_deg(child->yaw_deg), .scale = (float)child->scale };
	return eco_placement_inside(outer, &like);
}

static const struct eco_placement as_is = { .scale = 1 };

static void corners_of(const struct eco_placement *t, const struct map_bounds *b, double corners[8])
{
	for (int i = 0; i < 4; i++) {
		double at[3] = { i == 0 || i == 3 ? b->low[0] : b->high[0], i < 2 ? b->low[1] : b->high[1], 0 };
		eco_placement_point(t, at, at);
		memcpy(corners + 2 * i, at, 2 * sizeof *at);
	}
}

static void sum_up(struct map *m, uint32_t source)
{
	const struct eco_source *s = &m->sources.items[source];
	struct map_bounds *b = &m->bounds[source];
	*b = MAP_NOTHING;
	m->totals[source] = m->own[source].count;
	for (uint64_t i = 0; i < m->own[source].count; i++)
		map_extend(b, m->own[source].items[i].x, m->own[source].items[i].y);
	for (uint32_t i = 0; i < s->child_count; i++) {
		const struct map_bounds *nested = &m->bounds[s->children[i].source];
		struct eco_placement t = inside(&as_is, &s->children[i]);
		double corners[8];
		corners_of(&t, nested, corners);
		for (int k = 0; k < 4 && !map_is_empty(nested); k++)
			map_extend(b, corners[2 * k], corners[2 * k + 1]);
		if (__builtin_add_overflow(m->totals[source], m->totals[s->children[i].source],
				&m->totals[source]))
			m->totals[source] = UINT64_MAX;
	}
}

/* Counts how often each file is placed, through all nesting, then multiplies kinds by that. */
static void count_kinds(struct map *m)
{
	uint64_t *times = eco_alloc(m->sources.count, sizeof *times);
	times[0] = 1;
	for (uint32_t s = 0; s < m->sources.count; s++) {
		const struct eco_source *source = &m->sources.items[s];
		for (uint32_t i = 0; i < source->child_count; i++)
			if (__builtin_add_overflow(times[source->children[i].source], times[s],
					&times[source->children[i].source]))
				times[source->children[i].source] = UINT64_MAX;
		for (uint64_t i = 0; i < m->own[s].count; i++) {
			struct map_kind *kind = &m->kinds[m->own[s].items[i].kind];
			double height = (double)m->own[s].items[i].height_m;
			kind->count += times[s];
			kind->low_m = height > 0 ? fmin(kind->low_m, height) : kind->low_m;
			kind->high_m = fmax(kind->high_m, height > 0 ? height : -INFINITY);
		}
		m->placements += s ? times[s] : 0;
	}
	free(times);
}

static void add_bounds(struct map *m, uint32_t source, const struct eco_placement *t)
{
	if (m->outline_count == OUTLINES_MAX || map_is_empty(&m->bounds[source]))
		return;
	eco_grow(&m->outlines, &m->outline_capacity, m->outline_count, sizeof *m->outlines);
	struct map_outline *outline = &m->outlines[m->outline_count++];
	corners_of(t, &m->bounds[source], outline->corners);
	snprintf(outline->name, sizeof outline->name, "%s", m->sources.items[source].name);
}

/* Draws the files that `source` nests, and their plants if there is room for all. */
static void expand(struct map *m, uint32_t source, const struct eco_placement *t, bool plants, uint32_t depth)
{
	const struct eco_source *s = &m->sources.items[source];
	for (uint64_t i = 0; i < m->own[source].count && plants && depth; i++) {
		struct map_point point = m->own[source].items[i];
		double at[3] = { (double)point.x, (double)point.y, 0 };
		eco_placement_point(t, at, at);
		point.x = (float)at[0];
		point.y = (float)at[1];
		point.height_m *= (float)t->scale;
		point.crown_m *= (float)t->scale;
		add_point(&m->points, &point);
	}
	for (uint32_t i = 0; i < s->child_count; i++) {
		struct eco_placement nested = inside(t, &s->children[i]);
		if (depth == 0)
			add_bounds(m, s->children[i].source, &nested);
		if (plants)
			expand(m, s->children[i].source, &nested, plants, depth + 1);
	}
}

static int by_count(const void *a, const void *b)
{
	const struct map_kind *const *x = a, *const *y = b;
	if ((*x)->count != (*y)->count)
		return (*x)->count > (*y)->count ? -1 : 1;
	return strcmp((*x)->name, (*y)->name);
}

/* Gives the commonest kinds colours of their own. A single remaining kind is not called "others". */
static void choose_colors(struct map *m)
{
	struct map_kind **order = eco_alloc(m->kind_count, sizeof *order);
	uint32_t present = 0;
	for (uint32_t i = 0; i < m->kind_count; i++)
		if (m->kinds[i].count)
			order[present++] = &m->kinds[i];
	qsort(order, present, sizeof *order, by_count);
	for (uint32_t i = 0; i < present; i++)
		order[i]->color = i < MAP_COLORS ? i : MAP_COLORS;
	m->other_count = present > MAP_COLORS ? present - MAP_COLORS : 0;
	free(order);
}

ECO_ORDER(by_float, float, [0])

static void find_typical_height(struct map *m)
{
	uint64_t stride = m->points.count / 100000 + 1;
	float *heights = eco_alloc(m->points.count / stride + 1, sizeof *heights);
	uint32_t count = 0;
	for (uint64_t i = 0; i < m->points.count; i += stride)
		if (m->points.items[i].height_m > 0)
			heights[count++] = m->points.items[i].height_m;
	qsort(heights, count, sizeof *heights, by_float);
	m->typical_m = count ? (double)heights[count / 2] : 0;
	free(heights);
}

/* ---- All ---- */

static void read_ground(struct map *m)
{
	struct eco_source *s = &m->sources.items[0];
	if (!s->ground.height_count)
		return;
	eco_check(eco_ground_import(&m->ground, &(struct eco_ground_options){ .source = &s->ground,
		.scene_crs = s->crs, .scene_vertical = s->vertical, .origin = { s->origin[0], s->origin[1],
		s->origin[2] }, .side_max = 2048, .warn = main_note_text }, m->error));
	m->has_ground = true;
}

static void read_sources(struct map *m)
{
	uint32_t count = m->sources.count;
	m->own = eco_alloc(count, sizeof *m->own);
	m->bounds = eco_alloc(count, sizeof *m->bounds);
	m->totals = eco_alloc(count, sizeof *m->totals);
	find_kinds(m);
	/* nested files come after the files that nest them, and are needed first */
	for (uint32_t s = count; s-- > 0;) {
		add_instances(m, s);
		for (uint32_t i = 0; i < m->sources.items[s].positions_count; i++)
			add_rows(m, s, &m->sources.items[s].positions[i]);
		for (uint32_t i = 0; i < m->sources.items[s].scatter_count; i++)
			add_scattered(m, s, &m->sources.items[s].scatters[i]);
		sum_up(m, s);
	}
	eco_check(eco_tints_settle(&m->tints, m->error));
	for (uint32_t s = 0; s < count; s++)
		for (uint64_t i = 0; i < m->own[s].count; i++)
			m->own[s].items[i].class = eco_tints_class(&m->tints, m->own[s].items[i].class);
}

static void gather(void *map)
{
	struct map *m = map;
	main_progress("reading the scene", NULL, 0);
	eco_check(eco_sources_load(&m->sources, m->scene, m->error));
	read_ground(m);
	read_sources(m);
	count_kinds(m);
	m->total = m->totals[0];
	m->points = m->own[0];
	m->own[0] = (struct map_points){ 0 };
	bool all = m->total - m->points.count <= EXPANDED_MAX;
	m->not_expanded = all ? 0 : m->total - m->points.count;
	expand(m, 0, &as_is, all, 0);
	choose_colors(m);
	find_typical_height(m);
}

enum eco_code map_gather(struct map *m, const char *scene)
{
	m->scene = scene;
	return eco_try(gather, m, m->error);
}

void map_free(struct map *m)
{
	for (uint32_t s = 0; s < m->sources.count; s++) {
		if (m->kind_of)
			free(m->kind_of[s]);
		if (m->own)
			free(m->own[s].items);
	}
	eco_free(m->kind_of, m->files, m->own, m->bounds, m->totals, m->kinds);
	eco_string_pool_free(&m->species);
	eco_tints_free(&m->tints);
	eco_free(m->points.items, m->left_points.items, m->lines, m->outlines, m->areas.ends,
		m->clear_of.ends, m->image);
	eco_ground_free(&m->ground);
	eco_sources_free(&m->sources);
	*m = (struct map){ 0 };
}
