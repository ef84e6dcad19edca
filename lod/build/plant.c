/* From a model to lists, stage by stage: weld, organs, elements and lines, order, cells, palette, ladders.
 * Each stage has a file of its own; this one calls them. All memory is taken from one arena, so that an
 * interruption is a jump to one place. */
#include "lod/build/plant.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/build/grid.h"
#include "lod/build/plant_state.h"
#include "lod/build/summary.h"
#include "lod/sort.h"
#include "lod/vector.h"

#define TRIANGLES_MAX (1u << 28)
#define CELL_TRIANGLES 4096u
#define WHOLE_COMPONENT 512u     /* wood of up to this many triangles goes to one cell as a whole */

const char *const lod_solver_names[LOD_SOLVER_COUNT] =
	{ [LOD_SOLVER_GRID] = "grid", [LOD_SOLVER_SCALE] = "scale" };

uint32_t lod_build_cell(const struct lod_build *b, struct lod_v3 point)
{
	return b->cells.count ? lod_cells_at(&b->cells, point) : 0;
}

struct eco_ladder *lod_build_ladder(struct lod_build *b, const struct lod_group *group, uint32_t anchor,
	uint8_t flags)
{
	struct eco_ladder *ladder = lod_draft_ladder(&b->draft);
	ladder->anchor = anchor;
	ladder->organ = group->organ;
	ladder->flags = flags;
	ladder->importance = group->importance;
	return ladder;
}

static void advance(struct lod_build *b, double share)
{
	if (lod_plant_goes_on(b->options, share))
		return;
	b->code = eco_fail(b->error, ECO_INTERRUPTED, "%s: interrupted while it was built", b->plant->plant.name);
	longjmp(b->stopped, 1);
}

/* ---- Groups ---- */

static uint32_t image_of(const struct lod_build *b, uint32_t material)
{
	const struct eco_image *image = lod_mesh_image(b->model, material);
	return image ? (uint32_t)(image - b->model->images) : ECO_NONE;
}

static struct lod_group *find_group(struct lod_build *b, const struct lod_component *c)
{
	uint32_t model_image = image_of(b, c->material);
	struct lod_group *g = b->groups;
	while (g < b->groups + b->group_count && (g->organ != c->organ
			|| g->rule != c->importance || g->model_image != model_image))
		g++;
	if (g == b->groups + b->group_count) {
		*g = (struct lod_group){ .organ = c->organ, .rule = c->importance, .model_image = model_image,
			.image = ECO_NONE };
		b->group_count++;
	}
	return g;
}

/* The plant's images are those of its groups, in the model's order. */
static void number_images(struct lod_build *b)
{
	struct lod_plant *plant = b->plant;
	plant->images = eco_alloc(b->model->image_count, sizeof *plant->images);
	for (uint32_t image = 0; image < b->model->image_count; image++) {
		bool used = false;
		for (uint32_t g = 0; g < b->group_count; g++)
			if (b->groups[g].model_image == image) {
				b->groups[g].image = plant->image_count;
				used = true;
			}
		if (used)
			plant->images[plant->image_count++] = image;
	}
}

/* ---- Importance ---- */

/* Importance from colours that stand out (Deussen 2002, 4.3): petals and fruit in a rare colour keep more of
 * their vertices. A group's importance follows from the share of the plant's leaf area that clearly differs
 * from the group's mean colour: 1 up to half, rising to SALIENT_MOST at all of it. Hue and saturation count
 * more than brightness, which light changes. */
#define SALIENT_MOST 2.0             /* as much as users usually ask for */
#define BINS 4096                    /* of colours of all leaves */
/* Distances of colours in bytes: below ALIKE they are shades of one colour, beyond DIFFERENT they are clearly
 * different (lod/EXPERIMENTS.md, Colours that stand out). */
#define ALIKE 50.0
#define DIFFERENT 100.0

/* Area, and the sum of colours weighted by it. */
struct tone { double area, rgb[3]; };
struct tones { struct tone bins[BINS]; double area; };

static void add_tone(struct tone *tone, const uint8_t rgb[3], double area)
{
	tone->area += area;
	for (int k = 0; k < 3; k++)
		tone->rgb[k] += area * rgb[k];
}

static void add_tones(struct tones *plant, const uint8_t rgb[3], double area)
{
	plant->area += area;
	add_tone(&plant->bins[(rgb[0] >> 4) << 8 | (rgb[1] >> 4) << 4 | rgb[2] >> 4], rgb, area);
}

/* Brightness, and red and blue relative to it. */
static void opponents(const struct tone *tone, double out[3])
{
	const double r = tone->rgb[0] / tone->area, g = tone->rgb[1] / tone->area,
		b = tone->rgb[2] / tone->area;
	out[0] = (2 * r + 5 * g + b) / 8;
	out[1] = r - out[0];
	out[2] = b - out[0];
}

static double distinct(const struct tone *a, const struct tone *b)
{
	double x[3], y[3];
	opponents(a, x);
	opponents(b, y);
	double light = (x[0] - y[0]) / 2, red = x[1] - y[1], blue = x[2] - y[2];
	return fmin(1, fmax(0, (sqrt(light * light + red * red + blue * blue) - ALIKE) / (DIFFERENT - ALIKE)));
}

/* Importance of a group of the plant's leaves, at least 1; 1 if either has no area. */
static double salience_of(const struct tones *plant, const struct tone *group)
{
	double differs = 0;
	if (!(plant->area > 0) || !(group->area > 0))
		return 1;
	for (uint32_t i = 0; i < BINS; i++)
		if (plant->bins[i].area > 0)
			differs += plant->bins[i].area * distinct(group, &plant->bins[i]);
	return 1 + (SALIENT_MOST - 1) * fmax(0, 2 * differs / plant->area - 1);
}

/* The importance that the user asked for: a rule's before an organ's; for leaves from their colours if the
 * user asked for none. */
static void find_importance(struct lod_build *b)
{
	const float *asked = b->options->importance;
	bool any = false;
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		any = any || asked[i] > 0;
	for (uint32_t g = 0; g < b->group_count; g++)
		b->groups[g].importance = asked[b->groups[g].organ] > 0 ? asked[b->groups[g].organ] : 1;
	struct lod_arena_piece *mark = b->arena.last;
	struct tones *plant = lod_arena_take(&b->arena, 1, sizeof *plant);
	struct tone *groups = lod_arena_take(&b->arena, b->group_count, sizeof *groups);
	for (uint32_t g = 0; g < b->group_count && !any; g++)
		for (uint32_t k = b->groups[g].first; k < b->groups[g].end; k++) {
			const struct lod_element *e = &b->elements.items[b->order[k]];
			for (uint32_t t = 0; t + 2 < e->corners; t++) {
				const uint8_t *rgb = b->organs.rgb[e->triangle[t]];
				add_tones(plant, rgb, b->organs.area[e->triangle[t]]);
				add_tone(&groups[g], rgb, b->organs.area[e->triangle[t]]);
			}
		}
	for (uint32_t g = 0; g < b->group_count && !any; g++)
		if (b->groups[g].organ != ECO_ORGAN_WOOD)
			b->groups[g].importance = (float)salience_of(plant, &groups[g]);
	for (uint32_t g = 0; g < b->group_count; g++)
		if (b->groups[g].rule)
			b->groups[g].importance = b->model->importances[b->groups[g].rule];
	lod_arena_release(&b->arena, mark);
}

static void find_groups(struct lod_build *b)
{
	const struct lod_mesh *mesh = &b->mesh;
	size_t rules = b->model->importance ? b->model->importance_count : 1;
	b->groups = lod_arena_take(&b->arena, rules * ECO_ORGAN_COUNT * ((size_t)b->model->image_count + 1),
		sizeof *b->groups);
	b->group_of_component = lod_arena_take(&b->arena, mesh->component_count,
		sizeof *b->group_of_component);
	for (uint32_t c = 0; c < mesh->component_count; c++)
		if (b->organs.components[c].organ == ECO_ORGAN_WOOD) {
			struct lod_group *group =
				find_group(b, &b->organs.components[c]);
			b->group_of_component[c] = (uint32_t)(group - b->groups);
		}
	for (uint32_t i = 0; i < b->elements.count; i++) {
		const struct lod_component *c =
			&b->organs.components[mesh->component[b->elements.items[b->order[i]].triangle[0]]];
		struct lod_group *group = find_group(b, c);
		group->first = group->end == 0 ? i : group->first;
		group->end = i + 1;
	}
	number_images(b);
	find_importance(b);
}

/* ---- Cells ---- */

static struct lod_v3 triangle_center(const struct lod_mesh *mesh, uint32_t t)
{
	struct lod_v3 sum = { 0, 0, 0 };
	for (uint32_t k = 0; k < 3; k++)
		sum = lod_v3_add(sum, lod_v3_of(mesh->place + 3 * (size_t)mesh->index[3 * (size_t)t + k]));
	return lod_v3_scale(sum, 1.0 / 3);
}

bool lod_build_whole(const struct lod_component *c)
{
	return c->triangle_count <= WHOLE_COMPONENT;
}

static struct lod_v3 component_center(const struct lod_component *c)
{
	return lod_v3_mix(lod_v3_of(c->low), lod_v3_of(c->high), 0.5);
}

static void find_cells(struct lod_build *b)
{
	const struct lod_mesh *mesh = &b->mesh;
	b->cell_of_triangle = lod_arena_take(&b->arena, mesh->triangle_count, sizeof *b->cell_of_triangle);
	struct lod_arena_piece *mark = b->arena.last;
	size_t most = (size_t)b->elements.count + mesh->triangle_count;
	struct lod_v3 *center = lod_arena_take(&b->arena, most, sizeof *center);
	uint32_t *triangles = lod_arena_take(&b->arena, most, sizeof *triangles), count = b->elements.count;
	for (uint32_t i = 0; i < count; i++) {
		center[i] = b->center[i];
		triangles[i] = b->elements.items[i].corners - 2u;
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const struct lod_component *c = &b->organs.components[mesh->component[t]];
		if (c->organ != ECO_ORGAN_WOOD || mesh->collapsed[t])
			continue;
		center[count] = lod_build_whole(c) ? component_center(c) : triangle_center(mesh, t);
		triangles[count++] = 1;
	}
	lod_cells_make(&b->cells, &(struct lod_cells_input){ lod_v3_of(mesh->low), lod_v3_of(mesh->high),
		count, center, triangles, b->model->object ? UINT32_MAX : b->options->cell_triangles
		? b->options->cell_triangles : CELL_TRIANGLES });
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const struct lod_component *c = &b->organs.components[mesh->component[t]];
		b->cell_of_triangle[t] = lod_build_cell(b, lod_build_whole(c) ? component_center(c)
			: triangle_center(mesh, t));
	}
	lod_arena_release(&b->arena, mark);
}

/* ---- Anchors ---- */

/* A corner of a list in metres, as drawn. */
static struct lod_v3 drawn(const struct eco_list *list, const int32_t *p)
{
	return (struct lod_v3){ list->grid_origin[0] + p[0] * list->grid_step[0],
		list->grid_origin[1] + p[1] * list->grid_step[1],
		list->grid_origin[2] + p[2] * list->grid_step[2] };
}

/* Grows a box (pass 0), or a sphere around its middle (pass 1), to hold a list. */
struct bound { struct lod_v3 low, high; double radius; bool any; };

static void include(struct bound *bound, const struct lod_list_draft *list, int pass)
{
	for (uint32_t i = 0; i < list->elements.corner_count; i++) {
		struct lod_v3 p = drawn(&list->list, list->elements.position + 3 * (size_t)i);
		if (pass == 1) {
			bound->radius =
				fmax(bound->radius,
				lod_v3_distance(p, lod_v3_mix(bound->low, bound->high, 0.5)));
			continue;
		}
		if (!bound->any)
			bound->low = bound->high = p;
		bound->any = true;
		bound->low = (struct lod_v3){ fmin(bound->low.x, p.x), fmin(bound->low.y, p.y),
			fmin(bound->low.z, p.z) };
		bound->high = (struct lod_v3){ fmax(bound->high.x, p.x), fmax(bound->high.y, p.y),
			fmax(bound->high.z, p.z) };
	}
}

#define ANCHOR_STEPS 64.0        /* of a radius; anchors travel (wire_items.h), and so have few bits */

/* A sphere around the bound, no more than 3 % larger. */
static struct eco_anchor anchor_of(const struct bound *bound)
{
	double radius = bound->radius * 1.0001;
	struct lod_v3 middle = lod_v3_mix(bound->low, bound->high, 0.5), near = middle;
	if (radius > 0 && isfinite(radius)) {
		double step = lod_power_below(radius / ANCHOR_STEPS);
		near = (struct lod_v3){ floor(middle.x / step + 0.5) * step,
			floor(middle.y / step + 0.5) * step, floor(middle.z / step + 0.5) * step };
		radius = ceil((radius + lod_v3_distance(near, middle)) / step) * step;
	}
	return (struct eco_anchor){ { (float)near.x, (float)near.y, (float)near.z }, (float)radius };
}

/* The sphere of everything that an anchor's ladders draw; the whole plant's holds everything. Rounded up. */
static void bound_anchors(struct lod_build *b)
{
	struct lod_plant *plant = b->plant;
	uint32_t count = 1 + b->cells.count;
	plant->anchors = eco_alloc(count, sizeof *plant->anchors);
	plant->plant.anchor_count = count;
	struct bound *bounds = lod_arena_take(&b->arena, count, sizeof *bounds);
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t l = 0; l < plant->ladder_count; l++) {
			const struct eco_ladder *ladder = &plant->ladders[l];
			const uint32_t lists[4] = { ladder->points, ladder->lines, ladder->simple,
				ladder->triangles };
			for (int i = 0; i < 4; i++) {
				if (lists[i] == ECO_NONE)
					continue;
				include(&bounds[0], &plant->lists[lists[i]], pass);
				if (ladder->anchor != 0)
					include(&bounds[ladder->anchor], &plant->lists[lists[i]], pass);
			}
		}
	for (uint32_t a = 0; a < count; a++) {
		plant->anchors[a] = anchor_of(&bounds[a]);
	}
}

/* ---- Palette ---- */

/* Every colour that a list refers to, weighted by its area. */
static void make_palette(struct lod_build *b)
{
	struct lod_arena_piece *mark = b->arena.last;
	const struct lod_mesh *mesh = &b->mesh;
	size_t most = (size_t)mesh->component_count + b->bones.count + b->elements.count
		+ 3 * (size_t)mesh->triangle_count;
	uint8_t (*rgb)[3] = lod_arena_take(&b->arena, most, sizeof *rgb);
	uint32_t *weights = lod_arena_take(&b->arena, most, sizeof *weights), count = 0;
	double unit = b->plant->plant.area > 0 ? 1e8 / b->plant->plant.area : 0;
	for (uint32_t c = 0; c < mesh->component_count; c++)
		if (b->organs.components[c].organ == ECO_ORGAN_WOOD) {
			memcpy(rgb[count], b->organs.components[c].rgb, 3);
			weights[count++] = (uint32_t)(b->organs.components[c].area / 2 * unit);
		}
	for (uint32_t i = 0; i < b->bones.count; i++) {
		const struct lod_bone *bone = &b->bones.items[i];
		memcpy(rgb[count], bone->rgb, 3);
		weights[count++] =
			(uint32_t)(lod_v3_distance(bone->end[0], bone->end[1]) * bone->width * unit);
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		if (image_of(b, mesh->material[t]) == ECO_NONE) {
			memcpy(rgb[count], b->organs.rgb[t], 3);
			weights[count++] = (uint32_t)(b->organs.area[t] * unit);
		}
	for (uint32_t i = 0; i < b->elements.count; i++) {
		const struct lod_element *e = &b->elements.items[i];
		if (image_of(b, mesh->material[e->triangle[0]]) == ECO_NONE) {
			lod_organs_mean(&b->organs, e->triangle, e->corners - 2u, rgb[count]);
			weights[count++] = (uint32_t)(b->area[i] * unit);
		}
		memcpy(rgb[count], b->point[i].rgb, 3);
		weights[count++] = (uint32_t)(b->area[i] * unit);
	}
	lod_palette_make(&b->palette, LOD_PALETTE_MAX, (const uint8_t (*)[3])rgb, weights, count, &b->arena);
	lod_arena_release(&b->arena, mark);
	b->plant->palette = eco_alloc(b->palette.count, sizeof *b->plant->palette);
	memcpy(b->plant->palette, b->palette.rgb, b->palette.count * sizeof *b->plant->palette);
	b->plant->palette_count = b->palette.count;
}

/* ---- Counting ---- */

static void count_everything(struct lod_build *b)
{
	struct lod_plant *plant = b->plant;
	const struct lod_mesh *mesh = &b->mesh;
	plant->triangles_in = b->model->triangle_count;
	for (int d = 0; d < ECO_DROP_COUNT; d++) {
		plant->triangles_in += b->model->dropped[d];
		plant->dropped[d] = b->model->dropped[d] + mesh->dropped[d];
	}
	plant->triangles_stored = mesh->triangle_count - mesh->unstored;
	double total = 0;
	for (uint32_t c = 0; c < mesh->component_count; c++)
		plant->organ[b->organs.components[c].organ].components++;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		struct lod_organ_stats *organ = &plant->organ[b->organs.components[mesh->component[t]].organ];
		if (mesh->collapsed[t])
			continue;
		organ->triangles++;
		organ->area += b->organs.area[t];
		total += b->organs.area[t];
	}
	plant->organ[ECO_ORGAN_WOOD].elements = plant->organ[ECO_ORGAN_WOOD].triangles;
	for (uint32_t i = 0; i < b->elements.count; i++) {
		uint32_t component = mesh->component[b->elements.items[i].triangle[0]];
		plant->organ[b->organs.components[component].organ].elements++;
	}
	plant->plant.triangles = plant->triangles_stored;
	plant->plant.area = (float)total;
	plant->plant.height_m = mesh->high[2] > 0 ? mesh->high[2] : 0;   /* above its foot, which is at 0 */
}

/* ---- All ---- */

static void build_ladders(struct lod_build *b)
{
	b->draft = (struct lod_draft){ .arena = &b->arena, .plant = b->plant, .mesh = &b->mesh,
		.organs = &b->organs,
		.palette = &b->palette };
	lod_draft_shade(&b->draft);
	for (int cells = 0; cells <= (b->cells.count > 0); cells++)
		for (uint32_t g = 0; g < b->group_count; g++) {
			if (b->groups[g].organ == ECO_ORGAN_WOOD)
				lod_wood_ladders(b, &b->groups[g], cells);
			else
				lod_leaves_ladders(b, &b->groups[g], cells);
			advance(b, 0.92 + 0.04 * (cells + (g + 1.0) / b->group_count));
		}
	b->plant->plant.ladder_count = b->plant->ladder_count;
}

static void build(struct lod_build *b)
{
	struct lod_arena *arena = &b->arena;
	advance(b, 0);
	lod_plant_enter(b->options, LOD_STAGE_ELEMENTS);
	lod_weld(&b->mesh, b->model, b->options->grid_bits ? b->options->grid_bits
		: lod_grid_bits_least(b->model), arena);
	if (!b->model->object)
		lod_elements_turn_diagonals(&b->mesh, arena);
	advance(b, 0.04);
	lod_organs_find(&b->organs, &b->mesh, b->model, arena);
	lod_elements_make(&b->elements, &b->mesh, &b->organs, arena);
	advance(b, 0.06);
	lod_plant_enter(b->options, LOD_STAGE_ORDERS);
	if (!b->model->object) {
		lod_bones_make(&b->bones, &b->mesh, &b->organs, arena);
		lod_bones_sort(&b->bones, b->options->seed, arena);
	}
	advance(b, 0.1);
	count_everything(b);
	lod_leaves_measure(b);
	lod_leaves_order(b);
	lod_plant_enter(b->options, LOD_STAGE_LISTS);
	find_groups(b);
	find_cells(b);
	lod_wood_split(b);
	lod_leaves_represent(b);
	make_palette(b);
	advance(b, 0.92);
	build_ladders(b);
	bound_anchors(b);
	advance(b, 1);
}

static enum eco_code check(const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error)
{
	const char *name = options->name ? options->name : "plant";
	if (model->triangle_count > TRIANGLES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%s: %u triangles, at most %u", name,
			model->triangle_count, TRIANGLES_MAX);
	if (options->grid_bits > LOD_WELD_BITS_MAX)
		return eco_fail(error, ECO_BAD_USAGE, "%s: a grid of %u bits, at most %u", name,
			options->grid_bits, LOD_WELD_BITS_MAX);
	return ECO_OK;
}

enum eco_code lod_plant_build(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error)
{
	*plant = (struct lod_plant){ 0 };
	enum eco_code code = check(model, options, error);
	if (code)
		return code;
	struct lod_build *b = eco_alloc(1, sizeof *b);
	b->plant = plant;
	b->model = model;
	b->options = options;
	b->error = error;
	strncpy(plant->plant.name, options->name ? options->name : "", sizeof plant->plant.name - 1);
	if (!setjmp(b->stopped)) {
		build(b);
		if (plant->triangles_stored == 0)
			b->code = eco_fail(error, ECO_BAD_INPUT, "%s: no triangle of its %u is left to draw: "
				"all are thinner than its grid, or transparent; is the model whole?", plant->plant.name, plant->triangles_in);
	}
	code = b->code;
	lod_arena_free(&b->arena);
	free(b);
	if (code)
		lod_plant_free(plant);
	return code;
}

void lod_plant_free(struct lod_plant *plant)
{
	if (!plant)
		return;
	for (uint32_t i = 0; i < plant->list_count; i++) {
		eco_elements_free(&plant->lists[i].elements);
		free(plant->lists[i].ends);
	}
	eco_free(plant->anchors, plant->ladders, plant->curves, plant->lists, plant->palette, plant->images);
	for (uint32_t i = 0; i < plant->impostor_count; i++)
		free(plant->impostor[i].at);
	free(plant->impostor);
	memset(plant, 0, sizeof *plant);
}
