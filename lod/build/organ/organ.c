#include "lod/build/organ/organ.h"

#include <math.h>
#include <string.h>

#include "ecofiles/base/order.h"
#include "lod/light.h"
#include "lod/build/organ/organ_state.h"
#include "lod/sort.h"
#include "lod/raster/texel.h"
#include "lod/vector.h"

/* Thresholds, set between what 28 models from seven sources show (lod/EXPERIMENTS.md, Organs). */
#define THIN_CLEAR 0.033
#define THIN_LIMIT 0.045
#define THICK_CLEAR 0.058
#define ROUND_CLEAR 1.95
#define ROUND_LIMIT 2.15
#define BLADE_CLEAR 2.4
#define LENGTH_LEAST 0.7         /* of the diagonal; a blade folded to a right angle has 0.25 */
#define FULL_LEAST 0.45          /* 4 V M / A^2; sections of 5 : 1 have 0.44, triangles 0.6 */
#define SOLID_LENGTH 0.4         /* of the diagonal, for thick components */
#define OPEN_MOST 0.2            /* share of border of a solid: trunks are open at their ends */
#define STOUT 0.1                /* r/d of components without a skeleton */

/* Share of a component's area that is cut out. Bark has none but for rounding at seams. */
#define CLEAR_LEAST 0.02

/* Components of one material and triangle count, from which on they are taken for leaves if in doubt. */
#define COPIES_MANY 50

enum verdict { CLEARLY_LEAF, RATHER_LEAF, SOLID, RATHER_WOOD, CLEARLY_WOOD };

struct finder {
	const struct lod_mesh *mesh;
	const struct eco_model *model;
	uint32_t count;              /* of components */
	struct lod_shape *shape;
	double area, height, extent, diagonal;       /* of the plant; extent: the largest of its three */
	/* per component */
	uint8_t *verdict, *organ;
	bool *fixed;                 /* by a rule */
	bool *thing;
	enum lod_hint *hint;
	/* By rising height: the middle of a component, and the area of it and all above. */
	double *middle, *above;
};

/* ---- By shape ---- */

/* An atlas for a whole plant has clear texels somewhere, so the component itself must show some. */
static bool is_cutout(const struct finder *f, uint32_t i)
{
	uint32_t material = f->shape[i].material;
	return lod_mesh_material(f->model, material)->cutout && lod_mesh_image(f->model, material)
		&& f->shape[i].clear > CLEAR_LEAST;
}

static enum verdict judge(const struct lod_shape *b, bool cutout)
{
	double d = b->diagonal, thin = b->radius / d;
	bool tube = b->length >= LENGTH_LEAST * d && b->turn <= BLADE_CLEAR;
	if (cutout)
		return CLEARLY_LEAF;
	if (b->round >= FULL_LEAST && b->length >= SOLID_LENGTH * d && (thin > THIN_LIMIT || !tube)
			&& b->open * (1 - b->glued) < OPEN_MOST)
		return SOLID;
	if (!tube || thin > THICK_CLEAR)
		return CLEARLY_LEAF;
	if (thin > THIN_LIMIT || b->turn > ROUND_LIMIT || b->round < FULL_LEAST)
		return RATHER_LEAF;
	return thin <= THIN_CLEAR && b->turn <= ROUND_CLEAR ? CLEARLY_WOOD : RATHER_WOOD;
}

/* ---- By names ---- */

/* Hints of parts count only if the parts differ in them: one name for all says what the plant is, not what
 * its organs are. The same holds for materials that are all called flowers. */
static void find_hints(struct finder *f, struct lod_arena *arena)
{
	const struct eco_model *model = f->model;
	bool parts = model->part && model->parts, varied = false, blooms = true;
	struct lod_arena_piece *mark = arena->last;
	enum lod_hint *material = lod_arena_take(arena, (size_t)model->material_count + 1, sizeof *material);
	enum lod_hint *part = lod_arena_take(arena, (size_t)model->part_count + 1, sizeof *part);
	for (uint32_t i = 0; i < model->material_count; i++) {
		material[i] = lod_name_hint(model->materials[i].name);
		blooms = blooms && material[i] == LOD_HINT_FLOWER;
	}
	for (uint32_t i = 0; parts && i < model->part_count; i++) {
		part[i] = lod_name_hint(model->parts[i].name);
		varied = varied || part[i] != part[0];
	}
	for (uint32_t i = 0; i < f->count; i++) {
		const struct lod_shape *b = &f->shape[i];
		uint32_t of = parts ? model->part[f->mesh->source[b->first]] : ECO_NONE;
		if (b->material < model->material_count && !blooms)
			f->hint[i] = material[b->material];
		if (f->hint[i] == LOD_HINT_NONE && varied && of < model->part_count)
			f->hint[i] = part[of];
	}
	lod_arena_release(arena, mark);
}

/* ---- Doubts ---- */

#define STEM_LEAST 0.1           /* of the plant's diagonal; smaller green components are needles */

/* Bark is brown or grey, and darker than petals. */
static bool is_bark(const uint8_t rgb[3])
{
	return rgb[0] > rgb[1] && rgb[1] >= rgb[2] && rgb[0] < 190;
}

static bool is_plain(const struct lod_shape *b)
{
	return b->rgb[0] == b->rgb[1] && b->rgb[1] == b->rgb[2];
}

static uint32_t material_of(const struct finder *f, uint32_t component)
{
	uint32_t m = f->shape[component].material;
	return m < f->model->material_count ? m : f->model->material_count;
}

/* A voice is a material's green components, or its others. A palette or an atlas for a
 * whole plant has one material for bark and leaves, and tells them apart by colour alone. */
static uint32_t voice_of(const struct finder *f, uint32_t component)
{
	return 2 * material_of(f, component) + lod_colour_is_green(f->shape[component].rgb);
}

/* Sums over a voice's components: clear area of leaves and of wood, area in doubt; the radius of the thickest wood. */
struct clear { double area[2], doubt, radius; };

#define EVIDENCE 0.05            /* of the doubtful area: less that is clear decides nothing */

static bool settle_doubt(const struct finder *f, uint32_t i, const struct clear *of)
{
	const struct lod_shape *b = &f->shape[i];
	const double *clear = of->area;
	bool enough = clear[0] + clear[1] > EVIDENCE * of->doubt;
	if (enough && clear[1] > 3 * clear[0])
		return true;
	if (enough && clear[0] > 3 * clear[1])
		return false;
	if (f->hint[i] != LOD_HINT_NONE)
		return f->hint[i] == LOD_HINT_WOOD;
	if (lod_colour_is_green(b->rgb)
			&& (f->verdict[i] == RATHER_LEAF || b->diagonal < STEM_LEAST * f->diagonal))
		return false;
	return f->verdict[i] == RATHER_WOOD
		|| (f->verdict[i] == RATHER_LEAF && is_bark(b->rgb) && b->round >= FULL_LEAST);
}

/* Components of clear shape are decided by it, except logs on the ground: they are stout and need their name.
 * Leaves are not as large. */
#define FOOT 0.05                /* of the plant's height */
#define LOG_LEAST 0.5            /* of the plant's diagonal */
#define FRUIT 0.08               /* of the plant's diagonal: smaller solids are fruits and buds */
#define CROWN 1.25               /* times as thick as wood */

static bool on_ground(const struct finder *f, uint32_t i)
{
	return f->shape[i].low[2] - f->mesh->low[2] < FOOT * f->height;
}

static bool is_clear_wood(const struct finder *f, uint32_t i)
{
	const struct lod_shape *b = &f->shape[i];
	bool log = f->hint[i] == LOD_HINT_WOOD && b->diagonal > LOG_LEAST * f->diagonal && on_ground(f, i)
		&& !lod_colour_is_green(b->rgb) && !is_cutout(f, i);
	return f->verdict[i] == CLEARLY_WOOD || log;
}

/* A solid of a voice of wood is wood, too. But trees do not grow thicker upwards: above the ground, and
 * thicker than all clear wood, it is a crown that the file tells from bark by nothing. */
static bool is_solid_wood(const struct finder *f, uint32_t i, const struct clear *clear)
{
	const struct lod_shape *b = &f->shape[i];
	bool crown = b->radius > CROWN * clear->radius && b->diagonal > FRUIT * f->diagonal && !on_ground(f, i)
		&& f->hint[i] != LOD_HINT_WOOD;
	return clear->area[1] > 3 * clear->area[0] && !crown;
}

/* A component in doubt goes with the clear ones of its material and colour, by area, if those agree. */
static void settle_doubts(struct finder *f, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct clear *clear = lod_arena_take(arena, 2 * ((size_t)f->model->material_count + 1), sizeof *clear);
	for (uint32_t i = 0; i < f->count; i++) {
		struct clear *of = &clear[voice_of(f, i)];
		f->verdict[i] = (uint8_t)judge(&f->shape[i], is_cutout(f, i));
		if (f->verdict[i] == CLEARLY_WOOD || f->verdict[i] == CLEARLY_LEAF)
			of->area[f->verdict[i] == CLEARLY_WOOD] += f->shape[i].area;
		else
			of->doubt += f->shape[i].area;
		if (f->verdict[i] == CLEARLY_WOOD)
			of->radius = fmax(of->radius, f->shape[i].radius);
	}
	for (uint32_t i = 0; i < f->count; i++) {
		const struct clear *of = &clear[voice_of(f, i)];
		bool wood = is_clear_wood(f, i);
		if (f->verdict[i] == RATHER_WOOD || f->verdict[i] == RATHER_LEAF)
			wood = settle_doubt(f, i, of);
		else if (f->verdict[i] == SOLID)
			wood = is_solid_wood(f, i, of);
		f->organ[i] = wood ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE;
	}
	lod_arena_release(arena, mark);
}

/* Components of one material and colour with the same number of triangles are copies of one part, stretched
 * and bent: they are one organ. The larger area wins; among many copies wood needs twice the area, since many
 * copies usually are leaves. */
static void settle_copies(struct finder *f, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	uint32_t n = f->count;
	struct lod_keyed *by = lod_arena_take(arena, n, sizeof *by);
	for (uint32_t i = 0; i < n; i++)
		by[i] = (struct lod_keyed){ (uint64_t)voice_of(f, i) << 32 | f->shape[i].triangle_count,
			i };
	lod_sort(arena, by, n);
	for (uint32_t first = 0, end; first < n; first = end) {
		double area[ECO_ORGAN_COUNT] = { 0 };
		for (end = first; end < n && by[end].key == by[first].key; end++)
			area[f->organ[by[end].value]] += f->shape[by[end].value].area;
		double need = end - first >= COPIES_MANY ? 2 : 1;
		bool wood = area[ECO_ORGAN_WOOD] > need * area[ECO_ORGAN_FOLIAGE];
		for (uint32_t i = first; i < end; i++)
			f->organ[by[i].value] = wood ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE;
	}
	lod_arena_release(arena, mark);
}

/* A patch of another colour inlaid in bark is bark: all of its border continues in wood. A bud at a stem's
 * end has next to no border. */
static void settle_inlays(struct finder *f)
{
	for (uint32_t i = 0; i < f->count; i++) {
		const struct lod_shape *b = &f->shape[i], *host = &f->shape[b->glued_to];
		if (b->open > 0.05 && b->glued > 0.75 && f->organ[b->glued_to] == ECO_ORGAN_WOOD
				&& b->area < 0.25 * host->area)
			f->organ[i] = ECO_ORGAN_WOOD;
	}
}

/* ---- Things, soil and herbs ---- */

#define THING_HEIGHT 0.7         /* of the plant's height at most, for a thing under the plant */
#define THING_ABOVE 0.3          /* of the plant's area that is above its middle */
#define VESSEL_RADIUS 0.2        /* of the diagonal; thick closed leaves have up to 0.16 */
#define STACK_LEAST 3u           /* solids that make a stem */
#define STACK_WIDTH 0.25         /* of its height */
#define FEW 4u                   /* components of the material of a vessel or soil */

/* Sorts components by the height of their middle and sums the area above each. */
static void sort_heights(struct finder *f, struct lod_arena *arena)
{
	uint32_t n = f->count;
	struct lod_keyed *by = lod_arena_take(arena, n, sizeof *by);
	f->middle = lod_arena_take(arena, n, sizeof *f->middle);
	f->above = lod_arena_take(arena, (size_t)n + 1, sizeof *f->above);
	for (uint32_t i = 0; i < n; i++)
		by[i] = (struct lod_keyed){
			lod_sort_key((double)f->shape[i].low[2] + f->shape[i].high[2] - 2 * f->mesh->low[2]),
			i };
	lod_sort(arena, by, n);
	for (uint32_t i = n; i-- > 0;) {
		const struct lod_shape *b = &f->shape[by[i].value];
		f->middle[i] = ((double)b->low[2] + b->high[2]) / 2;
		f->above[i] = f->above[i + 1] + b->area;
	}
}

static double area_above(const struct finder *f, double z)
{
	uint32_t low = 0, high = f->count;
	ECO_LEAST(low, high, i, f->middle[i] > z)
	return f->above[low];
}

/* The plant is above the component, which is neither green nor small. */
static bool is_below(const struct finder *f, uint32_t i)
{
	const struct lod_shape *b = &f->shape[i];
	return !lod_colour_is_green(b->rgb) && b->diagonal > FRUIT * f->diagonal
		&& b->high[2] - f->mesh->low[2] < THING_HEIGHT * f->height && !is_cutout(f, i)
		&& area_above(f, ((double)b->low[2] + b->high[2]) / 2) > THING_ABOVE * f->area;
}

/* Whether a solid is a thing; `alone`: the plant is all solids. Brown ones are stones, logs and stumps, but a
 * brown lump above the ground is a crown in autumn. */
static bool is_thing(const struct finder *f, uint32_t i, bool alone)
{
	const struct lod_shape *b = &f->shape[i];
	if (f->hint[i] != LOD_HINT_NONE)
		return f->hint[i] == LOD_HINT_WOOD;
	if (alone && b->diagonal > FRUIT * f->diagonal)
		return !is_plain(b) && is_bark(b->rgb) && on_ground(f, i);
	return is_below(f, i) && on_ground(f, i);
}

static bool has_walls(const struct lod_shape *b)
{
	return b->radius > VESSEL_RADIUS * b->diagonal && b->length > SOLID_LENGTH * b->diagonal;
}

/* A pot with walls, or a level sheet: the soil in it, or the ground around a plant. */
static bool is_vessel(const struct finder *f, uint32_t i)
{
	const struct lod_shape *b = &f->shape[i];
	bool walls = has_walls(b) && on_ground(f, i);
	bool soil = b->level > 0.85 && b->high[2] - b->low[2] < 0.2 * b->diagonal;
	return (walls || soil) && is_below(f, i) && f->hint[i] != LOD_HINT_FOLIAGE
		&& f->hint[i] != LOD_HINT_FLOWER;
}

/* Solids of one material on top of each other, such as the rings of a palm's stem: together a tube from the
 * ground. */
struct stack { double low[3], high[3]; uint32_t count; };

static void put_on_stack(struct stack *stack, const struct lod_shape *b)
{
	for (int a = 0; a < 3; a++) {
		stack->low[a] = stack->count ? fmin(stack->low[a], b->low[a]) : b->low[a];
		stack->high[a] = stack->count ? fmax(stack->high[a], b->high[a]) : b->high[a];
	}
	stack->count++;
}

static bool is_stem(const struct finder *f, const struct stack *s)
{
	double wide = fmax(s->high[0] - s->low[0], s->high[1] - s->low[1]), high = s->high[2] - s->low[2];
	return s->count >= STACK_LEAST && wide < STACK_WIDTH * high && s->low[2] - f->mesh->low[2]
		< FOOT * f->height;
}

/* A component of the material and colour of things that stands below the plant as they do is a thing, too:
 * saucers, rims, branches of a stout trunk. */
static void settle_things(struct finder *f, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct sums { double things, all; uint32_t count; struct stack stack; } *of;
	of = lod_arena_take(arena, 2 * ((size_t)f->model->material_count + 1), sizeof *of);
	double solid = 0;
	sort_heights(f, arena);
	for (uint32_t i = 0; i < f->count; i++) {
		solid += f->verdict[i] == SOLID ? f->shape[i].area : 0;
		of[voice_of(f, i)].count++;
		of[voice_of(f, i)].all += f->shape[i].area;
		if (f->verdict[i] == SOLID)
			put_on_stack(&of[voice_of(f, i)].stack, &f->shape[i]);
	}
	for (uint32_t i = 0; i < f->count; i++) {
		bool thing = f->verdict[i] == SOLID && is_thing(f, i, solid > 0.8 * f->area);
		if (f->verdict[i] == SOLID && is_stem(f, &of[voice_of(f, i)].stack)
				&& !lod_colour_is_green(f->shape[i].rgb))
			f->organ[i] = ECO_ORGAN_WOOD;
		thing = thing
			|| (of[voice_of(f, i)].count <= FEW && f->organ[i] != ECO_ORGAN_WOOD
			&& is_vessel(f, i));
		if (thing) {
			f->organ[i] = ECO_ORGAN_WOOD;
			f->thing[i] = f->verdict[i] != SOLID || f->shape[i].diagonal > FRUIT * f->diagonal;
			of[voice_of(f, i)].things += f->shape[i].area;
		}
	}
	for (uint32_t i = 0; i < f->count; i++)
		if (2 * of[voice_of(f, i)].things > of[voice_of(f, i)].all && is_below(f, i)
				&& f->organ[i] != ECO_ORGAN_WOOD) {
			f->organ[i] = ECO_ORGAN_WOOD;
			f->thing[i] = true;
		}
	lod_arena_release(arena, mark);
}

/* A plant of only tubes is a bare tree, unless they are green or many unbranched ones stand on the ground. */
static void settle_herbs(struct finder *f)
{
	double wood = 0, green = 0, straws = 0;
	uint32_t straw_count = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		const struct lod_shape *b = &f->shape[i];
		if (f->organ[i] != ECO_ORGAN_WOOD)
			continue;
		bool straw = b->length < 1.25 * b->diagonal && b->low[2] - f->mesh->low[2] < FOOT * f->height;
		wood += b->area;
		green += lod_colour_is_green(b->rgb) && f->hint[i] != LOD_HINT_WOOD ? b->area : 0;
		straws += straw && f->hint[i] != LOD_HINT_WOOD ? b->area : 0;
		straw_count += straw;
	}
	if (wood < 0.95 * f->area || (green < 0.9 * wood && (straws < 0.8 * wood || straw_count < 6)))
		return;
	for (uint32_t i = 0; i < f->count; i++)
		f->organ[i] = ECO_ORGAN_FOLIAGE;
}

/* ---- All ---- */

/* Triangles image by image, cut-outs separately, so that the sums of one image exist at a time. */
static void colour_triangles(struct lod_organs *organs, const struct lod_mesh *mesh,
	const struct eco_model *model, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *by = lod_arena_take(arena, mesh->triangle_count, sizeof *by);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const struct eco_image *image = lod_mesh_image(model, mesh->material[t]);
		bool cutout = lod_mesh_material(model, mesh->material[t])->cutout;
		by[t] = (struct lod_keyed){ image ? 2 * (uint64_t)(image - model->images) + 2 + cutout : 0,
			t };
	}
	lod_sort(arena, by, mesh->triangle_count);
	struct lod_arena_piece *sorted = arena->last;
	struct lod_texels texels = { 0 };
	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		uint32_t t = by[i].value;
		const struct eco_material *material = lod_mesh_material(model, mesh->material[t]);
		double share = 1;
		if (by[i].key > 0 && (i == 0 || by[i].key != by[i - 1].key)) {
			lod_arena_release(arena, sorted);
			lod_texels_open(&texels, lod_mesh_image(model, mesh->material[t]), material->cutout,
				arena);
		}
		if (by[i].key > 0)
			share = lod_texels_mean(&texels, material->rgb, mesh->uv + 6 * (size_t)t,
				organs->rgb[t]);
		else
			memcpy(organs->rgb[t], material->rgb, 3);
		/* A triangle without an opaque sample may still show something: a fraction of a sample's area
		 * keeps it drawable. */
		organs->area[t] = lod_v3_length(lod_mesh_area_normal(mesh, t)) * (share > 0 ? share : 1.0 / 256);
	}
	lod_arena_release(arena, mark);
}

void lod_organs_mean(const struct lod_organs *organs, const uint32_t *triangles, uint32_t count,
	uint8_t rgb[3])
{
	struct lod_light light = { { 0, 0, 0 }, 0 };
	memcpy(rgb, organs->rgb[triangles[0]], 3);
	for (uint32_t i = 0; i < count; i++)
		lod_light_add(&light, organs->rgb[triangles[i]], organs->area[triangles[i]]);
	lod_light_mean(&light, rgb);
}

static void prepare(struct finder *f, struct lod_arena *arena)
{
	uint32_t n = f->count;
	f->verdict = lod_arena_take(arena, n, sizeof *f->verdict);
	f->organ = lod_arena_take(arena, n, sizeof *f->organ);
	f->fixed = lod_arena_take(arena, n, sizeof *f->fixed);
	f->thing = lod_arena_take(arena, n, sizeof *f->thing);
	f->hint = lod_arena_take(arena, n, sizeof *f->hint);
	for (uint32_t i = 0; i < n; i++)
		f->area += f->shape[i].area;
	f->height = (double)f->mesh->high[2] - f->mesh->low[2];
	for (int a = 0; a < 3; a++)
		f->extent = fmax(f->extent, (double)f->mesh->high[a] - f->mesh->low[a]);
	f->diagonal = lod_v3_distance(lod_v3_of(f->mesh->low), lod_v3_of(f->mesh->high));
	find_hints(f, arena);
}

static void apply_rules(struct finder *f)
{
	for (uint32_t i = 0; i < f->count; i++) {
		uint8_t rule = (uint8_t)f->mesh->rule[f->shape[i].first];
		f->fixed[i] = rule != ECO_ORGAN_FOUND;
		f->organ[i] = f->fixed[i] ? rule : f->organ[i];
	}
}

static void describe_components(struct lod_organs *organs, const struct finder *f)
{
	for (uint32_t i = 0; i < f->count; i++) {
		const struct lod_shape *b = &f->shape[i];
		struct lod_component *c = &organs->components[i];
		*c = (struct lod_component){ .triangle_count = b->triangle_count, .material = b->material,
			.organ = f->organ[i], .area = b->area,
			.importance = (uint8_t)(f->mesh->rule[b->first] >> 8),
			.radius = b->radius, .length = b->length, .turn = b->turn };
		/* A tube open at both ends has little border; a sheet's border is a good part of all its
		 * edges. */
		c->closed = b->open < 0.02;
		bool thick = f->verdict[i] == SOLID && b->radius > STOUT * b->diagonal;
		c->stout = c->organ == ECO_ORGAN_WOOD && (f->thing[i] || thick || has_walls(b));
		memcpy(c->low, b->low, sizeof c->low);
		memcpy(c->high, b->high, sizeof c->high);
		memcpy(c->rgb, b->rgb, sizeof c->rgb);
	}
}

/* A component without colours in the file gets the usual colour of its organ. */
static void colour_colourless(struct lod_organs *organs, const struct lod_mesh *mesh,
	const struct eco_model *model)
{
	static const uint8_t of_plants[ECO_ORGAN_COUNT][3] = { [ECO_ORGAN_WOOD] = { 97, 79, 62 },
		[ECO_ORGAN_FOLIAGE] = { 86, 116, 58 }, [ECO_ORGAN_FLOWER] = { 205, 190, 196 } },
		plaster[ECO_ORGAN_COUNT][3] = { [ECO_ORGAN_WOOD] = { 200, 196, 188 } };
	const uint8_t (*usual)[3] = model->object ? plaster : of_plants;
	for (uint32_t i = 0; i < mesh->component_count; i++)
		if (lod_mesh_material(model, organs->components[i].material)->colourless)
			memcpy(organs->components[i].rgb, usual[organs->components[i].organ], 3);
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		if (lod_mesh_material(model, mesh->material[t])->colourless)
			memcpy(organs->rgb[t], usual[organs->components[mesh->component[t]].organ], 3);
}

/* Components without a rule. */
static void find_by_shape(struct finder *f, struct lod_arena *arena)
{
	settle_doubts(f, arena);
	settle_things(f, arena);
	settle_copies(f, arena);
	apply_rules(f);
	settle_inlays(f);
	settle_herbs(f);
	apply_rules(f);
	lod_flowers_find(f->organ, f->shape, f->count, f->fixed, f->hint, f->extent);
}

void lod_organs_find(struct lod_organs *organs, struct lod_mesh *mesh, const struct eco_model *model,
	struct lod_arena *arena)
{
	organs->area = lod_arena_take(arena, mesh->triangle_count, sizeof *organs->area);
	organs->rgb = lod_arena_take(arena, mesh->triangle_count, sizeof *organs->rgb);
	colour_triangles(organs, mesh, model, arena);
	if (!model->object)
		lod_organs_split(mesh, model, (const uint8_t (*)[3])organs->rgb, arena);
	organs->components = lod_arena_take(arena, mesh->component_count, sizeof *organs->components);
	struct lod_arena_piece *mark = arena->last;
	struct finder f = { .mesh = mesh, .model = model, .count = mesh->component_count };
	f.shape = lod_shapes_find(mesh, (const uint8_t (*)[3])organs->rgb, organs->area, arena);
	prepare(&f, arena);
	if (!model->object)
		find_by_shape(&f, arena);
	describe_components(organs, &f);
	colour_colourless(organs, mesh, model);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const struct lod_component *c = &organs->components[mesh->component[t]];
		if (c->organ == ECO_ORGAN_WOOD || c->closed)
			organs->area[t] /= 2;
	}
	lod_arena_release(arena, mark);
}
