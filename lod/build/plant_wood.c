/* Wood: lines of the skeleton from afar, levels of the mesh nearby. A plant with cells shows its largest
 * lines until its cells take over, and each cell is complete in itself. */
#include <string.h>

#include "lod/build/plant_state.h"
#include "lod/sort.h"

#define FAR_LINES 1024u          /* of the whole plant, the largest */
#define LEVEL_RADII 0.6          /* mean tube radii of a part by which its simplified levels may differ */

struct region { struct lod_line *lines; uint32_t count; double length, area, error; };

/* Width of the branch that a triangle of wood belongs to, metres; of a component that is kept whole, its mean. */
static double width_at(const struct lod_build *b, uint32_t t)
{
	const struct lod_component *component = &b->organs.components[b->mesh.component[t]];
	return b->bones.width_at[t] > 0 && !lod_build_whole(component) ? b->bones.width_at[t]
		: 2 * component->radius;
}

/* Triangles of one part are simplified together: branches whose widths are in one octave, and components that
 * are whole apart from those that are cut. */
static uint64_t part_of(const struct lod_build *b, uint32_t t)
{
	int octave;
	frexp(width_at(b, t), &octave);
	return (uint64_t)b->cut[b->mesh.component[t]] << 32 | (uint32_t)(octave + 4096);
}

/* Components whose triangles are in several cells or parts. */
static void find_cut(struct lod_build *b)
{
	const struct lod_mesh *mesh = &b->mesh;
	b->cut = lod_arena_take(&b->arena, mesh->component_count, sizeof *b->cut);
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		bool cut = false;
		uint32_t first = mesh->member[mesh->member_first[c]];
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++)
			cut = cut || b->cell_of_triangle[mesh->member[i]] != b->cell_of_triangle[first]
				|| part_of(b, mesh->member[i]) != part_of(b, first);
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

/* Lines of the group in `cell` (ECO_NONE: of the whole plant), in order, at most `most`; length, area and error
 * are of all of them. */
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
		*line = (struct lod_line){ .end = { bone->end[0], bone->end[1] }, .width = bone->width };
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

/* Triangles of the group in the cell, by the widths of their branches. */
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
			by[count++] = (struct lod_keyed){ part_of(b, t), t };
		}
	lod_sort(&b->arena, by, count);
	for (uint32_t i = 0; i < count; i++)
		triangle[i] = by[i].value;
	lod_arena_release(&b->arena, mark);
	return count;
}

static void add_triangles(struct lod_build *b, const struct lod_group *group, uint32_t cell,
	struct eco_ladder *ladder)
{
	struct lod_arena_piece *mark = b->arena.last;
	const struct lod_mesh *mesh = &b->mesh;
	uint32_t *triangle = lod_arena_take(&b->arena, mesh->triangle_count, sizeof *triangle),
		count = take_triangles(b, group, cell, triangle), part_count = 0;
	struct lod_levels_part *parts = lod_arena_take(&b->arena, count, sizeof *parts);
	double area = 0;
	for (uint32_t i = 0, next; i < count; i = next) {
		double width = 0;
		for (next = i; next < count && part_of(b, triangle[next]) == part_of(b, triangle[i]); next++) {
			area += b->organs.area[triangle[next]];
			width += width_at(b, triangle[next]);
		}
		parts[part_count++] = (struct lod_levels_part){ triangle + i, next - i,
			LEVEL_RADII * width / 2 / (next - i), b->cut[mesh->component[triangle[i]]] };
	}
	ladder->area = (float)area;
	if (count) {
		struct lod_levels levels;
		lod_levels_make(&levels, mesh, parts, part_count, &b->arena);
		ladder->triangles = lod_draft_wood(&b->draft, &levels, triangle, count, group->image, ladder);
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
