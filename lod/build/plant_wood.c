/* Wood: lines of the skeleton from afar, levels of the mesh nearby. A plant with cells shows its largest
 * lines until its cells take over, and each cell is complete in itself. */
#include <string.h>

#include "lod/build/plant_state.h"

#define FAR_LINES 1024u          /* of the whole plant, the largest */
#define LEVEL_RADII 0.75         /* mean tube radii by which simplified levels may differ */

struct region { struct lod_line *lines; uint32_t count; double length, area, error; };

/* A line is in the cell of its triangles: its component's if that is kept whole, else that of its middle. */
static uint32_t cell_of_bone(const struct lod_build *b, const struct lod_bone *bone)
{
	const struct lod_mesh *mesh = &b->mesh;
	if (lod_build_whole(&b->organs.components[bone->component]))
		return b->cell_of_triangle[mesh->member[mesh->member_first[bone->component]]];
	return lod_build_cell(b, lod_v3_mix(bone->end[0], bone->end[1], 0.5));
}

/* Lines of the group in `cell` (ECO_NONE: anywhere), in order, at most `most`; length, area and error are of
 * all of them. */
static uint32_t take_lines(struct lod_build *b, const struct lod_group *group, uint32_t cell, uint32_t most,
	struct region *region)
{
	uint32_t found = 0;
	*region =
		(struct region){ .lines = lod_arena_take(&b->arena, b->bones.count, sizeof *region->lines) };
	for (uint32_t i = 0; i < b->bones.count; i++) {
		const struct lod_bone *bone = &b->bones.items[i];
		if (&b->groups[b->group_of_component[bone->component]] != group)
			continue;
		if (cell != ECO_NONE && cell_of_bone(b, bone) != cell)
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
	/* The lines of a cut component may reach into a cell without any of its triangles. */
	if (ladder->area <= 0)
		ladder->area = (float)region.area;
	lod_arena_release(&b->arena, mark);
}

/* Triangles of the group in the cell: first those of components that lie in it as a whole, then those of cut
 * components. */
static void add_triangles(struct lod_build *b, const struct lod_group *group, uint32_t cell,
	struct eco_ladder *ladder)
{
	struct lod_arena_piece *mark = b->arena.last;
	const struct lod_mesh *mesh = &b->mesh;
	uint32_t *whole = lod_arena_take(&b->arena, mesh->triangle_count, sizeof *whole), whole_count = 0;
	uint32_t *cut = lod_arena_take(&b->arena, mesh->triangle_count, sizeof *cut), cut_count = 0;
	double area = 0, surface = 0, length = 0;
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		bool same = true;
		uint32_t from = whole_count;
		if (b->organs.components[c].organ != ECO_ORGAN_WOOD || &b->groups[b->group_of_component[c]]
				!= group)
			continue;
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++) {
			uint32_t t = mesh->member[i];
			same = same && b->cell_of_triangle[t]
				== b->cell_of_triangle[mesh->member[mesh->member_first[c]]];
			if (mesh->collapsed[t] || b->cell_of_triangle[t] != cell)
				continue;
			whole[whole_count++] = t;
			area += b->organs.area[t];
		}
		if (whole_count > from) {
			surface += b->organs.components[c].area;
			length += b->organs.components[c].length;
		}
		if (!same) {
			memcpy(cut + cut_count, whole + from, (whole_count - from) * sizeof *cut);
			cut_count += whole_count - from;
			whole_count = from;
		}
	}
	ladder->area = (float)area;
	if (whole_count + cut_count) {
		struct lod_levels levels;
		lod_levels_make(&levels, mesh, &(struct lod_levels_input){ whole, cut, whole_count, cut_count,
			length > 0 ? LEVEL_RADII * surface / (2 * LOD_PI * length) : 0 }, &b->arena);
		memcpy(whole + whole_count, cut, cut_count * sizeof *cut);
		ladder->triangles = lod_draft_wood(&b->draft, &levels, whole, whole_count + cut_count,
			group->image, ladder);
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
