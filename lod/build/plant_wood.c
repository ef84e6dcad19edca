/* Wood: lines of the skeleton from afar, levels of the mesh nearby, which give way branch by branch. A plant
 * with cells shows its largest lines until its cells take over, and each cell is complete in itself. */
#include <string.h>

#include <meshoptimizer.h>

#include "lod/build/plant_state.h"
#include "lod/sort.h"

#define FAR_LINES 1024u          /* of the whole plant, the largest */
#define LEVEL_RADII 0.6          /* mean tube radii of a part by which its simplified levels may differ */
#define SAME_RADII 0.02          /* a level that differs by no more is as good as finer ones */
#define PAYS 0.7                 /* a level has at most this share of the next one's triangles */
#define LEAST 64u                /* triangles of a level: with fewer, lines serve better */

/* ---- Levels ---- */

/* Simplified levels of wood by meshoptimizer, then all of its triangles. Components of similar width are
 * simplified together, by an error in proportion to it at most; borders at the end of a cell are kept. All of
 * an object is simplified together, seams between colours with it, so that its walls stay closed. */

/* Triangles of the mesh that are simplified together, since they belong to components of similar width. */
struct part {
	const uint32_t *triangle;
	uint32_t count;
	double radius;               /* mean of the tubes, m; of an object its extent */
	bool keep_border;            /* neighbours of its triangles are in other cells */
};

/* Corners of triangles as a mesh for meshoptimizer: a vertex for each combination of place, texture
 * coordinates and component. */
struct wedges {
	uint32_t count;
	struct lod_corner *corner;
	float *position;             /* grid coordinates, exact in floats */
	uint32_t *index;
};

static void make_wedges(struct wedges *w, const struct lod_mesh *mesh, const uint32_t *triangles,
	uint32_t count, struct lod_arena *arena)
{
	uint32_t size = 16;
	while (size < 6 * (uint64_t)count)
		size *= 2;
	uint32_t *table = lod_arena_take(arena, size, sizeof *table);
	memset(table, 0xff, size * sizeof *table);
	w->count = 0;
	w->corner = lod_arena_take(arena, 3 * (size_t)count, sizeof *w->corner);
	w->position = lod_arena_take(arena, 9 * (size_t)count, sizeof *w->position);
	w->index = lod_arena_take(arena, 3 * (size_t)count, sizeof *w->index);
	for (uint32_t i = 0; i < 3 * count; i++) {
		uint32_t t = triangles[i / 3];
		const int32_t *uv = mesh->uv + 6 * (size_t)t + 2 * (i % 3);
		struct lod_corner c = { mesh->index[3 * (size_t)t + i % 3], mesh->component[t],
			{ uv[0], uv[1] } };
		uint64_t hash = lod_mix((uint64_t)(uint32_t)c.uv[0] << 32 | (uint32_t)c.uv[1]);
		uint32_t at = (uint32_t)lod_mix(c.vertex + lod_mix(c.component + hash)) & (size - 1);
		while (table[at] != ECO_NONE && memcmp(&w->corner[table[at]], &c, sizeof c))
			at = (at + 1) & (size - 1);
		if (table[at] == ECO_NONE) {
			table[at] = w->count;
			w->corner[w->count] = c;
			for (int a = 0; a < 3; a++)
				w->position[3 * (size_t)w->count + a] =
					(float)mesh->grid[3 * (size_t)c.vertex + a];
			w->count++;
		}
		w->index[i] = table[at];
	}
}

/* Simplifies a part to a share of its triangles, or until its surface would move by `reach` radii, beyond
 * which it would lose its form. Appends those with area to `out`, which has room for all. *moved: at least
 * the radii by which it does. */
static uint32_t simplify(struct lod_corner *out, const struct lod_mesh *mesh, const struct part *part,
	double share, double reach, double *moved, struct lod_arena *arena)
{
	if (part->count == 0)
		return 0;
	struct lod_arena_piece *mark = arena->last;
	struct wedges w;
	uint32_t kept = 0;
	make_wedges(&w, mesh, part->triangle, part->count, arena);
	unsigned int *simple = lod_arena_take(arena, 3 * (size_t)part->count, sizeof *simple);
	float extent = meshopt_simplifyScale(w.position, w.count, 3 * sizeof(float));
	float error = extent > 0 ? (float)(reach * part->radius / mesh->step / extent) : 1, made = 0;
	size_t indices = meshopt_simplify(simple, w.index, 3 * (size_t)part->count, w.position, w.count,
		3 * sizeof(float), 3 * (size_t)(part->count * share), error,
		part->keep_border ? meshopt_SimplifyLockBorder : 0, &made);
	*moved = fmax(*moved, error > 0 ? reach * (double)made / (double)error : 0);
	for (size_t i = 0; i + 2 < indices; i += 3) {
		struct lod_corner c[3] = { w.corner[simple[i]], w.corner[simple[i + 1]],
			w.corner[simple[i + 2]] };
		if (lod_mesh_flat(mesh, (uint32_t[]){ c[0].vertex, c[1].vertex, c[2].vertex }))
			continue;
		memcpy(out + 3 * (size_t)kept, c, sizeof c);
		kept++;
	}
	lod_arena_release(arena, mark);
	return kept;
}

/* Shares of an object's extent: a third of a pixel for an object of 40 and of 10 pixels. */
static const double object_reach[] = { 1.0 / 128, 1.0 / 32 };
#define OBJECT_LEVELS (sizeof object_reach / sizeof object_reach[0])

/* How many times more triangles the next finer level has. If wood is all there is to draw, a budget between
 * two levels is not used, and small levels are few bytes. */
static double step_of(double triangles)
{
	return triangles > 512 ? 2 : 1.5;
}

/* From fine to coarse. Vertex counts ascend strictly, and each level has at most 70 % of the next one's triangles. */
static void make_levels(struct lod_levels *levels, const struct lod_mesh *mesh,
	const struct part *parts, uint32_t part_count, bool object, struct lod_arena *arena)
{
	uint32_t all = 0, room = LOD_LEVELS_SIMPLE, least = object ? 1 : LEAST;
	for (uint32_t p = 0; p < part_count; p++)
		all += parts[p].count;
	double target = all;
	for (uint32_t i = 0, finer = all; room > 0 && (object ? i < OBJECT_LEVELS : target >= LEAST); i++) {
		struct lod_arena_piece *mark = arena->last;
		struct lod_corner *corner = lod_arena_take(arena, 3 * (size_t)all, sizeof *corner);
		uint32_t count = 0;
		double moved = 0;
		target = object ? 0 : target / step_of(target);
		for (uint32_t p = 0; p < part_count; p++)
			count += simplify(corner + 3 * (size_t)count, mesh, &parts[p], target / all,
				object ? object_reach[i] : LEVEL_RADII, &moved, arena);
		if (count < least || count > PAYS * finer) {
			lod_arena_release(arena, mark);
			continue;
		}
		room = object || moved > SAME_RADII ? room : LOD_LEVELS_SIMPLE;
		levels->corner[--room] = corner;
		levels->triangle_count[room] = finer = count;
	}
	levels->count = LOD_LEVELS_SIMPLE - room;
	memmove(levels->corner, levels->corner + room, levels->count * sizeof *levels->corner);
	memmove(levels->triangle_count, levels->triangle_count + room, levels->count * sizeof *levels->triangle_count);
}

/* ---- Limbs ---- */

/* The triangles of all levels and the lines have an order in common: by limbs, which are bones that follow
 * each other in their order, the largest first. So a ladder may stand between two levels: limbs [0, k) are
 * drawn by the finer one, the others by the coarser one. */
#define LIMBS 32u                /* at most about so many; each has so large a share of the triangles at least */

/* Bones along the triangles around each vertex: bone[first[v] .. first[v + 1]), some more than once. */
struct along { uint32_t *first, *bone; };

static struct along find_along(struct lod_build *b)
{
	const struct lod_mesh *mesh = &b->mesh;
	const struct lod_bones *bones = &b->bones;
	struct along a = { lod_arena_take(&b->arena, mesh->vertex_count + 2u, sizeof *a.first),
		lod_arena_take(&b->arena, 3 * (size_t)bones->span_count, sizeof *a.bone) };
	for (uint32_t i = 0; i < 3 * bones->span_count; i++)
		a.first[mesh->index[3 * (size_t)bones->spans[i / 3].triangle + i % 3] + 2]++;
	for (uint32_t v = 2; v <= mesh->vertex_count + 1; v++)
		a.first[v] += a.first[v - 1];
	for (uint32_t i = 0; i < 3 * bones->span_count; i++)
		a.bone[a.first[mesh->index[3 * (size_t)bones->spans[i / 3].triangle + i % 3] + 1]++] = bones->spans[i / 3].bone;
	return a;
}

/* The bone that a triangle's middle is nearest to, of those along its corners' triangles; 0 if there is none. */
static uint32_t bone_of(const struct lod_build *b, const struct along *along, const uint32_t vertex[3],
	uint32_t component)
{
	struct lod_v3 middle = { 0, 0, 0 };
	double least = INFINITY;
	uint32_t nearest = 0;
	for (uint32_t k = 0; k < 3; k++) {
		const float *place = b->mesh.place + 3 * (size_t)vertex[k];
		middle = lod_v3_add(middle, (struct lod_v3){ place[0] / 3.0, place[1] / 3.0, place[2] / 3.0 });
	}
	for (uint32_t k = 0; k < 3; k++)
		for (uint32_t i = along->first[vertex[k]]; i < along->first[vertex[k] + 1]; i++) {
			const struct lod_bone *bone = &b->bones.items[along->bone[i]];
			double away = bone->component == component ? lod_bone_away(bone, middle) : INFINITY;
			if (away < least || (away == least && along->bone[i] < nearest)) {
				least = away;
				nearest = along->bone[i];
			}
		}
	return nearest;
}

/* Sorts triangles, `size` bytes each, by limbs. Returns these. */
static int32_t *sort_by_limb(struct lod_build *b, void *triangles, const uint32_t *bone, uint32_t count, size_t size)
{
	int32_t *limb = lod_arena_take(&b->arena, count, sizeof *limb);
	struct lod_keyed *by = lod_arena_take(&b->arena, count, sizeof *by);
	uint8_t *copy = lod_arena_take(&b->arena, count, size), *to = triangles;
	memcpy(copy, triangles, count * size);
	for (uint32_t i = 0; i < count; i++)
		by[i] = (struct lod_keyed){ (uint64_t)b->limb[bone[i]], i };
	lod_sort(&b->arena, by, count);
	for (uint32_t i = 0; i < count; i++) {
		limb[i] = (int32_t)by[i].key;
		memcpy(to + i * size, copy + by[i].value * size, size);
	}
	return limb;
}

/* Bones become limbs by their triangles in full detail. */
static void find_limbs(struct lod_build *b, const uint32_t *bone, uint32_t count)
{
	uint32_t *own = lod_arena_take(&b->arena, b->bones.count, sizeof *own), sum = 0;
	int32_t limb = 0;
	for (uint32_t i = 0; i < count; i++)
		own[bone[i]]++;
	for (uint32_t i = 0; i < b->bones.count; i++) {
		b->limb[i] = limb;
		sum += own[i];
		limb += LIMBS * (uint64_t)sum >= count;
		sum = LIMBS * (uint64_t)sum >= count ? 0 : sum;
	}
}

/* Sorts the triangles of all levels, and those of full detail, by limbs. */
static void order_levels(struct lod_build *b, struct lod_levels *levels, uint32_t *triangle, uint32_t count)
{
	struct along along = find_along(b);
	const struct lod_mesh *mesh = &b->mesh;
	uint32_t *bone = lod_arena_take(&b->arena, count, sizeof *bone);
	for (uint32_t i = 0; i < count; i++)
		bone[i] = bone_of(b, &along, mesh->index + 3 * (size_t)triangle[i], mesh->component[triangle[i]]);
	find_limbs(b, bone, count);
	levels->limb[levels->count] = sort_by_limb(b, triangle, bone, count, sizeof *triangle);
	for (uint32_t l = 0; l < levels->count; l++) {
		for (uint32_t i = 0; i < levels->triangle_count[l]; i++) {
			const struct lod_corner *c = levels->corner[l] + 3 * (size_t)i;
			bone[i] = bone_of(b, &along, (uint32_t[]){ c[0].vertex, c[1].vertex, c[2].vertex }, c->component);
		}
		levels->limb[l] = sort_by_limb(b, levels->corner[l], bone, levels->triangle_count[l],
			3 * sizeof **levels->corner);
	}
}

/* ---- Lines ---- */

struct region { struct lod_line *lines; uint32_t count; double length, area, error; };

/* Triangles of one part are simplified together: components whose widths are in one octave, and those that
 * are whole apart from those that are cut. An object has no branches. */
static uint64_t part_of(const struct lod_build *b, uint32_t component)
{
	int octave = 0;
	if (!b->model->object)
		frexp(b->organs.components[component].radius, &octave);
	return (uint64_t)b->cut[component] << 32 | (uint32_t)(octave + 4096);
}

/* Components whose triangles are in several cells. */
static void find_cut(struct lod_build *b)
{
	const struct lod_mesh *mesh = &b->mesh;
	b->cut = lod_arena_take(&b->arena, mesh->component_count, sizeof *b->cut);
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		bool cut = false;
		uint32_t first = mesh->member[mesh->member_first[c]];
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++)
			cut = cut || b->cell_of_triangle[mesh->member[i]] != b->cell_of_triangle[first];
		b->cut[c] = cut;
	}
}

/* Spans of one bone in one cell follow each other; together they are one line of that cell. */
void lod_wood_split(struct lod_build *b)
{
	const struct lod_bones *bones = &b->bones;
	struct lod_bones *parts = &b->parts;
	find_cut(b);
	*parts = (struct lod_bones){ .items =
		lod_arena_take(&b->arena, b->cells.count ? bones->span_count : 0, sizeof *parts->items) };
	if (b->cells.count == 0)
		return;
	struct lod_arena_piece *mark = b->arena.last;
	struct lod_keyed *by = lod_arena_take(&b->arena, bones->span_count, sizeof *by);
	for (uint32_t i = 0; i < bones->span_count; i++) {
		const struct lod_bone_span *span = &bones->spans[i];
		by[i] = (struct lod_keyed){ (uint64_t)span->bone << 32 | b->cell_of_triangle[span->triangle], i };
	}
	lod_sort(&b->arena, by, bones->span_count);
	for (uint32_t i = 0, next; i < bones->span_count; i = next) {
		double from = 1, to = 0;
		for (next = i; next < bones->span_count && by[next].key == by[i].key; next++) {
			from = fmin(from, bones->spans[by[next].value].from);
			to = fmax(to, bones->spans[by[next].value].to);
		}
		const struct lod_bone *bone = &bones->items[by[i].key >> 32];
		struct lod_bone *part = &parts->items[parts->count];
		*part = *bone;
		part->cell = (uint32_t)by[i].key;
		part->end[0] = lod_v3_mix(bone->end[0], bone->end[1], from);
		part->end[1] = lod_v3_mix(bone->end[0], bone->end[1], to);
		parts->count += from < to;
	}
	lod_arena_release(&b->arena, mark);
	lod_bones_sort(parts, b->options->seed, &b->arena);
}

/* Lines of the group in `cell` (ECO_NONE: of the whole plant), in order, at most `most`; length, area and
 * error are of all of them. */
static uint32_t take_lines(struct lod_build *b, const struct lod_group *group, uint32_t cell, uint32_t most,
	struct region *region)
{
	uint32_t found = 0;
	const struct lod_bones *bones = cell == ECO_NONE ? &b->bones : &b->parts;
	*region = (struct region){ .lines = lod_arena_take(&b->arena, bones->count, sizeof *region->lines) };
	for (uint32_t i = 0; i < bones->count; i++) {
		const struct lod_bone *bone = &bones->items[i];
		if (&b->groups[b->group_of_component[bone->component]] != group)
			continue;
		if (cell != ECO_NONE && bone->cell != cell)
			continue;
		double length = lod_v3_distance(bone->end[0], bone->end[1]);
		found++;
		region->length += length;
		region->area += LOD_PI / 2 * length * bone->width;
		region->error = fmax(region->error, bone->error);
		if (region->count == most)
			continue;
		struct lod_line *line = &region->lines[region->count++];
		*line = (struct lod_line){ .end = { bone->end[0], bone->end[1] }, .width = bone->width,
			.limb = b->limb ? b->limb[i] : 0 };
		memcpy(line->rgb, bone->rgb, 3);
	}
	return found;
}

static void add_lines(struct lod_build *b, const struct lod_group *group, uint32_t cell, uint32_t most,
	struct eco_ladder *ladder)
{
	struct lod_arena_piece *mark = b->arena.last;
	struct region region;
	uint32_t found = take_lines(b, group, cell, most, &region);
	ladder->lines = lod_draft_lines(&b->draft, region.lines, region.count);
	uint32_t stored = ladder->lines == ECO_NONE ? 0 : b->plant->lists[ladder->lines].list.primitive_count;
	ladder->total = region.count < found ? found : stored;
	ladder->length = (float)region.length;
	ladder->epsilon = (float)region.error;
	/* Wood without area on the grid has lines alone. */
	if (ladder->area <= 0)
		ladder->area = (float)region.area;
	lod_arena_release(&b->arena, mark);
}

/* Triangles of the group in the cell, by parts. */
static uint32_t take_triangles(struct lod_build *b, const struct lod_group *group, uint32_t cell,
	uint32_t *triangle)
{
	const struct lod_mesh *mesh = &b->mesh;
	uint32_t count = 0;
	struct lod_arena_piece *mark = b->arena.last;
	struct lod_keyed *by = lod_arena_take(&b->arena, mesh->triangle_count, sizeof *by);
	for (uint32_t c = 0; c < mesh->component_count; c++)
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++) {
			uint32_t t = mesh->member[i];
			if (b->organs.components[c].organ != ECO_ORGAN_WOOD || mesh->collapsed[t]
					|| b->cell_of_triangle[t] != cell
					|| &b->groups[b->group_of_component[c]] != group)
				continue;
			by[count++] = (struct lod_keyed){ part_of(b, c), t };
		}
	lod_sort(&b->arena, by, count);
	for (uint32_t i = 0; i < count; i++)
		triangle[i] = by[i].value;
	lod_arena_release(&b->arena, mark);
	return count;
}

/* The longest side of the mesh's box. */
static double extent_of(const struct lod_mesh *mesh)
{
	double extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)mesh->high[k] - mesh->low[k]);
	return extent;
}

static void add_triangles(struct lod_build *b, const struct lod_group *group, uint32_t cell,
	struct eco_ladder *ladder)
{
	struct lod_arena_piece *mark = b->arena.last;
	const struct lod_mesh *mesh = &b->mesh;
	uint32_t *triangle = lod_arena_take(&b->arena, mesh->triangle_count, sizeof *triangle),
		count = take_triangles(b, group, cell, triangle), part_count = 0;
	struct part *parts = lod_arena_take(&b->arena, count, sizeof *parts);
	double area = 0;
	for (uint32_t i = 0, next; i < count; i = next) {
		double radius = 0;
		uint64_t key = part_of(b, mesh->component[triangle[i]]);
		for (next = i; next < count && part_of(b, mesh->component[triangle[next]]) == key; next++) {
			area += b->organs.area[triangle[next]];
			radius += b->organs.components[mesh->component[triangle[next]]].radius;
		}
		parts[part_count++] = (struct part){ triangle + i, next - i,
			b->model->object ? extent_of(mesh) : radius / (next - i),
			/* an object's pictures have levels of their own, which meet at borders */
			b->cut[mesh->component[triangle[i]]] || (b->model->object && b->group_count > 1) };
	}
	ladder->area = (float)area;
	if (count) {
		struct lod_levels levels = { .count = 0 };
		make_levels(&levels, mesh, parts, part_count, b->model->object, &b->arena);
		if (b->limb)
			order_levels(b, &levels, triangle, count);
		ladder->triangles = lod_draft_wood(&b->draft, &levels, triangle, count, group->image, ladder);
		if (b->model->object && ladder->level_count == 0) {      /* one level, of which no part is drawn */
			ladder->level_count = 1;
			ladder->level_end[0] = count;
		}
	}
	lod_arena_release(&b->arena, mark);
}

static double whole_area(const struct lod_build *b, const struct lod_group *group)
{
	double area = 0;
	for (uint32_t t = 0; t < b->mesh.triangle_count; t++) {
		uint32_t c = b->mesh.component[t];
		bool wood = b->organs.components[c].organ == ECO_ORGAN_WOOD;
		if (wood && !b->mesh.collapsed[t] && &b->groups[b->group_of_component[c]] == group)
			area += b->organs.area[t];
	}
	return area;
}

void lod_wood_ladders(struct lod_build *b, const struct lod_group *group, bool cells)
{
	if (!cells && b->cells.count == 0) {
		struct eco_ladder *ladder = lod_build_ladder(b, group, 0, 0);
		b->limb = b->bones.count ? lod_arena_take(&b->arena, b->bones.count, sizeof *b->limb) : NULL;
		add_triangles(b, group, 0, ladder);
		add_lines(b, group, ECO_NONE, UINT32_MAX, ladder);
	} else if (!cells) {
		struct eco_ladder *ladder = lod_build_ladder(b, group, 0, ECO_LADDER_FAR);
		ladder->area = (float)whole_area(b, group);
		add_lines(b, group, ECO_NONE, FAR_LINES, ladder);
		b->plant->ladder_count -= ladder->lines == ECO_NONE;
	}
	for (uint32_t cell = 0; cells && cell < b->cells.count; cell++) {
		struct eco_ladder *ladder = lod_build_ladder(b, group, 1 + cell, ECO_LADDER_NEAR);
		add_triangles(b, group, cell, ladder);
		add_lines(b, group, cell, UINT32_MAX, ladder);
		b->plant->ladder_count -= ladder->triangles == ECO_NONE && ladder->lines == ECO_NONE;
	}
}
