/* Ladders: vertices of an organ at an anchor -> cuts. Two kinds (struct eco_ladder):
 *
 *   forms    the elements of one list in several forms, each cheaper than the next: points, lines, simple ones, the triangles
 *            themselves. Elements [0,f) are drawn in one form and [f,e) in the one before it.
 *   levels   the first points or lines, then the triangles, or the levels of simplified wood one after the other. A level is skipped
 *            where it would not draw more vertices than what came before it, so a ladder always ascends.
 *
 * Forms: a state is (stage, e, f). The curve's samples say which states are best (`reach` gives e, the sample's vertices give stage
 * and f); between two samples a leg leads from state to state, e and f growing in proportion, one element at a time. What a ladder
 * can draw are the states on its legs: their vertices ascend, so the greatest that a budget allows is found by bisection, and no
 * element that was drawn is ever missing in a larger amount, nor in a coarser form.
 *
 * The ladders of a plant's cells share the curve of the whole: a state is that of the region's elements, of which the whole-plant
 * list holds the first `before`, and the ladder what is left. */
#include "lod/ladder.h"

#include <assert.h>

static uint64_t primitives(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE ? 0 : scene->lists[list].primitive_count;
}

/* ---- Levels ---- */

/* Triangles as levels: level i is [start, end). Without levels the whole list is one. */
static uint32_t level_count(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->triangles) == 0 ? 0 : ladder->level_count ? ladder->level_count : 1;
}

static void level_range(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level, uint32_t *first,
	uint32_t *end)
{
	*first = level ? ladder->level_end[level - 1] : 0;
	*end = ladder->level_count ? ladder->level_end[level] : (uint32_t)primitives(scene, ladder->triangles);
}

static uint64_t level_vertices(const struct eco_scene *scene, const struct eco_ladder *ladder, uint32_t level)
{
	uint32_t first, end;
	level_range(scene, ladder, level, &first, &end);
	return 3u * (uint64_t)(end - first);
}

/* What is drawn before the first level: lines, or points. */
static uint32_t first_list(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->lines) ? ladder->lines : primitives(scene, ladder->points) ? ladder->points : ECO_NONE;
}

static uint64_t first_unit(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	return primitives(scene, ladder->lines) ? 2 : 1;
}

uint64_t lod_ladder_full(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	uint32_t levels = level_count(scene, ladder);
	if (levels)
		return level_vertices(scene, ladder, levels - 1);
	return first_unit(scene, ladder) * primitives(scene, first_list(scene, ladder));
}

/* Vertices of lines or points that lie at or below `vertices`. Such as would cost as much as everything are not drawn. */
static uint64_t first_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t unit = first_unit(scene, ladder), all = unit * primitives(scene, first_list(scene, ladder));
	uint64_t full = lod_ladder_full(scene, ladder);
	if (all > full)
		all = full / unit * unit;
	return vertices < all ? vertices / unit * unit : all;
}

static uint64_t levels_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	for (uint32_t level = level_count(scene, ladder); level-- > 0;) {
		uint64_t v = level_vertices(scene, ladder, level);
		if (v <= vertices && v > first_floor(scene, ladder, UINT64_MAX))
			return v;
	}
	return first_floor(scene, ladder, vertices);
}

static uint64_t levels_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	uint64_t unit = first_unit(scene, ladder), first = first_floor(scene, ladder, UINT64_MAX);
	if (vertices < first)
		return vertices / unit * unit + unit;
	for (uint32_t level = 0; level < level_count(scene, ladder); level++) {
		uint64_t v = level_vertices(scene, ladder, level);
		if (v > vertices && v > first)
			return v;
	}
	return UINT64_MAX;
}

/* ---- Forms ---- */

#define FORMS_MAX 4

struct forms {                       /* of one ladder */
	const struct eco_scene *scene;
	const struct eco_ladder *ladder;
	const struct eco_list *triangles;
	uint32_t list[FORMS_MAX], count;     /* coarsest first; the last are the triangles */
	uint32_t unit[FORMS_MAX];    /* vertices of an element, of all forms but the last */
	uint32_t each;               /* triangles of an element where all have the same number, else 0 */
	uint32_t own, before, total; /* elements: in the lists, in the whole-plant list, in the region */
};

static bool is_form(const struct eco_scene *scene, uint32_t list, uint32_t of)
{
	return list != ECO_NONE && scene->lists[list].coder == ECO_CODER_FORM && scene->lists[list].partner == of
		&& scene->lists[list].element_count == scene->lists[of].element_count;
}

/* False for ladders of levels. */
static bool find_forms(struct forms *forms, const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	if (primitives(scene, ladder->triangles) == 0 || ladder->level_count)
		return false;
	const struct eco_list *triangles = &scene->lists[ladder->triangles];
	const uint32_t coarse[] = { ladder->points, ladder->lines, ladder->simple };
	*forms = (struct forms){ .scene = scene, .ladder = ladder, .triangles = triangles, .own = triangles->element_count,
		.before = ladder->before };
	for (int i = 0; i < 3; i++) {
		if (primitives(scene, coarse[i]) == 0)
			continue;
		if (!is_form(scene, coarse[i], ladder->triangles))
			return false;
		const struct eco_list *list = &scene->lists[coarse[i]];
		forms->unit[forms->count] = eco_list_vertices(list) * (list->primitive_count / list->element_count);
		forms->list[forms->count++] = coarse[i];
	}
	forms->list[forms->count++] = ladder->triangles;
	forms->each = triangles->primitive_count % triangles->element_count ? 0 : triangles->primitive_count / triangles->element_count;
	for (uint32_t c = 0; c < triangles->chunk_count && forms->each && scene->chunks; c++) {
		const struct eco_chunk *chunk = &scene->chunks[triangles->chunk_first + c];
		if (chunk->primitive_count != forms->each * chunk->element_count)
			forms->each = 0;
	}
	uint64_t region = (uint64_t)forms->own + forms->before;
	forms->total = region > ladder->total ? (uint32_t)region : ladder->total;
	return true;
}

/* Triangles of the first `elements`. Which of a chunk's have more than others is not known here: they are taken to be spread evenly. */
static uint64_t triangles_of(const struct forms *forms, uint32_t elements)
{
	const struct eco_list *list = forms->triangles;
	if (forms->each || elements == forms->own)
		return forms->each ? (uint64_t)forms->each * elements : list->primitive_count;
	uint64_t triangles = 0;
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		const struct eco_chunk *chunk = &forms->scene->chunks[list->chunk_first + c];
		if (elements < chunk->element_count)
			return triangles + (uint64_t)chunk->primitive_count * elements / chunk->element_count;
		elements -= chunk->element_count;
		triangles += chunk->primitive_count;
	}
	return triangles;
}

static uint64_t range_end(const struct forms *forms, uint32_t form, uint32_t elements)
{
	return form + 1 == forms->count ? triangles_of(forms, elements)
		: (uint64_t)elements * (forms->scene->lists[forms->list[form]].primitive_count / forms->own);
}

static uint64_t cost_of(const struct forms *forms, uint32_t form, uint32_t elements)
{
	return form + 1 == forms->count ? 3 * triangles_of(forms, elements) : (uint64_t)forms->unit[form] * elements;
}

/* Elements [0, f) in form stage + 1, elements [f, e) in form `stage`. */
struct state { uint32_t stage, e, f; };

static uint64_t vertices_of(const struct forms *forms, const struct state *s)
{
	uint64_t all = cost_of(forms, s->stage, s->e);
	return s->f ? all - cost_of(forms, s->stage, s->f) + cost_of(forms, s->stage + 1, s->f) : all;
}

/* The same on average, for elements of the region: each as dear as the ladder's own are. Exact where the ladder holds all of them. */
static double region_cost(const struct forms *forms, uint32_t form, double elements)
{
	if (forms->own == forms->total)
		return (double)cost_of(forms, form, (uint32_t)elements);
	return (double)cost_of(forms, form, forms->own) * elements / forms->own;
}

/* Most elements that may be drawn as triangles instead of as something of `unit` vertices, for so many more. */
static uint32_t triangles_afford(const struct forms *forms, uint32_t unit, uint64_t vertices)
{
	const struct eco_list *list = forms->triangles;
	uint32_t elements = 0;
	for (uint32_t c = 0; c < list->chunk_count; c++) {
		const struct eco_chunk *chunk = &forms->scene->chunks[list->chunk_first + c];
		uint64_t more = 3 * (uint64_t)chunk->primitive_count - (uint64_t)unit * chunk->element_count;
		if (more > vertices) {
			uint32_t low = 0, high = chunk->element_count;
			while (high - low > 1) {
				uint32_t middle = low + (high - low) / 2;
				uint64_t cost = 3 * ((uint64_t)chunk->primitive_count * middle / chunk->element_count) - (uint64_t)unit * middle;
				*(cost <= vertices ? &low : &high) = middle;
			}
			return elements + low;
		}
		vertices -= more;
		elements += chunk->element_count;
	}
	return elements;
}

/* Most elements of the region, up to `most`, for which turning them from one form into another (`from` of ECO_NONE: nothing) costs
 * no more than `vertices`. */
static double region_afford(const struct forms *forms, uint32_t from, uint32_t to, double vertices, double most)
{
	if (forms->own != forms->total || forms->each) {
		double gain = region_cost(forms, to, forms->own) - (from == ECO_NONE ? 0 : region_cost(forms, from, forms->own));
		double count = gain > 0 ? vertices * forms->own / gain : most;
		count = count < most ? count : most;
		return forms->own == forms->total ? (double)(uint32_t)count : count;
	}
	uint32_t unit = from == ECO_NONE ? 0 : forms->unit[from], count = to + 1 == forms->count
		? triangles_afford(forms, unit, (uint64_t)vertices) : (uint32_t)(vertices / (forms->unit[to] - unit));
	return count < most ? count : most;
}

/* The region's state at a sample of the curve, reduced to what is the ladder's own. A region in parts has fractions of elements: rounded,
 * the few of a small share would be too few or too dear, and the ladder would begin in another form than the rest of its plant. */
static struct state state_at(const struct forms *forms, double share, double reach)
{
	bool whole = forms->own == forms->total;
	uint32_t stage = 0, last = forms->count - 1;
	double vertices = share * region_cost(forms, last, forms->total), e = reach * forms->total, f = 0;
	vertices = whole ? (double)(uint64_t)(vertices + 0.5) : vertices;
	e = whole ? (double)(uint32_t)(e + 0.5) : e;
	e = e < forms->total ? e : forms->total;
	if (region_cost(forms, last, e) < vertices)          /* too few elements to draw so much */
		e = region_afford(forms, ECO_NONE, last, vertices, forms->total);
	if (region_cost(forms, 0, e) > vertices)
		e = region_afford(forms, ECO_NONE, 0, vertices, forms->total);
	while (stage + 1 < last && region_cost(forms, stage + 1, e) <= vertices)
		stage++;
	if (last > 0)
		f = region_afford(forms, stage, stage + 1, vertices - region_cost(forms, stage, e), e);
	e = e + 0.5 > forms->before ? e + 0.5 - forms->before : 0;
	f = f + 0.5 > forms->before ? f + 0.5 - forms->before : 0;
	struct state s = { stage, e < forms->own ? (uint32_t)e : forms->own, 0 };
	s.f = f < s.e ? (uint32_t)f : s.e;
	return s.e ? s : (struct state){ 0, 0, 0 };
}

/* Never less of anything than before. */
static struct state ascend(struct state from, struct state to)
{
	if (to.stage < from.stage)
		return from;
	to.e = to.e > from.e ? to.e : from.e;
	if (to.stage == from.stage)
		to.f = to.f > from.f ? to.f : from.f;
	return to;
}

struct leg { struct state from, to; uint64_t vertices[2]; double share[2]; };

/* The state k steps along a leg within one stage. */
static struct state along(const struct leg *leg, uint64_t k)
{
	uint64_t e = leg->to.e - leg->from.e, f = leg->to.f - leg->from.f, steps = e + f;
	if (steps == 0)
		return leg->to;
	return (struct state){ leg->from.stage, leg->from.e + (uint32_t)(k * e / steps), leg->from.f + (uint32_t)(k * f / steps) };
}

static uint64_t leg_steps(const struct leg *leg)
{
	return (uint64_t)(leg->to.e - leg->from.e) + (leg->to.f - leg->from.f);
}

/* Where a leg leads into the next stage it first makes all it draws the finer form: this many elements. */
static uint32_t crossing(const struct forms *forms, const struct leg *leg)
{
	double left = (double)cost_of(forms, leg->from.stage + 1, leg->from.e) - (double)leg->vertices[0];
	double right = (double)leg->vertices[1] - (double)cost_of(forms, leg->from.stage + 1, leg->to.e), t;
	left = left > 0 ? left : 0;
	right = right > 0 ? right : 0;
	t = left + right > 0 ? left / (left + right) : 0;
	return leg->from.e + (uint32_t)(t * (leg->to.e - leg->from.e));
}

/* Legs from nothing to everything, one after the other; those that cross a stage come in parts. */
struct walk { const struct forms *forms; uint32_t sample; struct leg whole, leg; };

static void begin(struct walk *walk, const struct forms *forms)
{
	*walk = (struct walk){ .forms = forms };
}

static bool same(const struct state *a, const struct state *b)
{
	return a->stage == b->stage && a->e == b->e && a->f == b->f;
}

static void next_sample(struct walk *walk)
{
	const struct forms *forms = walk->forms;
	const struct eco_ladder *ladder = forms->ladder;
	struct leg *whole = &walk->whole;
	whole->from = whole->to;
	whole->vertices[0] = whole->vertices[1];
	whole->share[0] = whole->share[1];
	if (walk->sample < ladder->curve_count) {
		const struct eco_curve *sample = &forms->scene->curves[ladder->curve_first + walk->sample];
		whole->to = sample->share < 1 ? ascend(whole->from, state_at(forms, sample->share, sample->reach)) : whole->from;
		whole->share[1] = sample->share < 1 ? sample->share : whole->share[0];
	} else {
		whole->to = (struct state){ forms->count > 2 ? forms->count - 2 : 0, forms->own, forms->count > 1 ? forms->own : 0 };
		whole->share[1] = 1;
	}
	whole->vertices[1] = vertices_of(forms, &whole->to);
	walk->sample++;
}

/* The next leg; false at the end. */
static bool step(struct walk *walk)
{
	const struct forms *forms = walk->forms;
	if (same(&walk->leg.to, &walk->whole.to)) {
		if (walk->sample > forms->ladder->curve_count)
			return false;
		next_sample(walk);
		walk->leg.to = walk->whole.from;
		walk->leg.vertices[1] = walk->whole.vertices[0];
		walk->leg.share[1] = walk->whole.share[0];
	}
	struct leg *leg = &walk->leg, *whole = &walk->whole;
	leg->from = leg->to;
	leg->vertices[0] = leg->vertices[1];
	leg->share[0] = leg->share[1];
	leg->to = whole->to;
	if (leg->from.stage < whole->to.stage && leg->from.f == leg->from.e) {
		leg->from.stage++;
		leg->from.f = 0;
	}
	if (leg->from.stage < whole->to.stage) {
		struct leg rest = { leg->from, whole->to, { leg->vertices[0], whole->vertices[1] }, { 0, 0 } };
		uint32_t all = crossing(forms, &rest);
		leg->to = (struct state){ leg->from.stage, all, all };
	}
	leg->vertices[1] = vertices_of(forms, &leg->to);
	uint64_t length = whole->vertices[1] - whole->vertices[0];
	leg->share[1] = length ? whole->share[0] + (whole->share[1] - whole->share[0]) * (double)(leg->vertices[1] - whole->vertices[0]) / (double)length
		: whole->share[1];
	return true;
}

/* The leg on which `vertices` lie: the last that begins at or below them. */
static void find_leg(struct walk *walk, const struct forms *forms, uint64_t vertices)
{
	begin(walk, forms);
	step(walk);
	while (walk->leg.vertices[1] <= vertices && step(walk))
		;
}

/* Steps along the leg that draw no more than `vertices`. */
static uint64_t steps_within(const struct forms *forms, const struct leg *leg, uint64_t vertices)
{
	uint64_t low = 0, high = leg_steps(leg) + 1;
	while (high - low > 1) {
		uint64_t middle = low + (high - low) / 2;
		struct state s = along(leg, middle);
		*(vertices_of(forms, &s) <= vertices ? &low : &high) = middle;
	}
	return low;
}

static struct state floor_state(const struct forms *forms, uint64_t vertices, struct walk *walk)
{
	find_leg(walk, forms, vertices);
	return along(&walk->leg, steps_within(forms, &walk->leg, vertices));
}

static uint64_t forms_floor(const struct forms *forms, uint64_t vertices)
{
	struct walk walk;
	struct state s = floor_state(forms, vertices, &walk);
	return vertices_of(forms, &s);
}

static uint64_t forms_next(const struct forms *forms, uint64_t vertices)
{
	struct walk walk;
	for (begin(&walk, forms); step(&walk);) {
		if (walk.leg.vertices[1] <= vertices)
			continue;
		struct state s = along(&walk.leg, steps_within(forms, &walk.leg, vertices) + 1);
		return vertices_of(forms, &s);
	}
	return UINT64_MAX;
}

static double forms_share(const struct forms *forms, uint64_t vertices)
{
	struct walk walk;
	find_leg(&walk, forms, vertices);
	const struct leg *leg = &walk.leg;
	uint64_t length = leg->vertices[1] - leg->vertices[0];
	double t = length ? (double)(vertices - leg->vertices[0]) / (double)length : 1;
	return leg->share[0] + (t < 1 ? t : 1) * (leg->share[1] - leg->share[0]);
}

/* ---- Both ---- */

uint64_t lod_ladder_floor(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	struct forms forms;
	uint64_t full = lod_ladder_full(scene, ladder);
	if (vertices >= full)
		return full;
	return find_forms(&forms, scene, ladder) ? forms_floor(&forms, vertices) : levels_floor(scene, ladder, vertices);
}

uint64_t lod_ladder_next(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	struct forms forms;
	if (vertices >= lod_ladder_full(scene, ladder))
		return UINT64_MAX;
	return find_forms(&forms, scene, ladder) ? forms_next(&forms, vertices) : levels_next(scene, ladder, vertices);
}

struct eco_curve lod_ladder_curve(const struct eco_scene *scene, const struct eco_ladder *ladder, double share)
{
	const struct eco_curve *curve = scene->curves + ladder->curve_first;
	uint32_t n = ladder->curve_count;
	if (n == 0)
		return (struct eco_curve){ .share = (float)share, .scale = 1, .reach = 1 };
	if (share <= curve[0].share) {
		/* below one element there is nothing: the error goes to "all of it missing" */
		double t = curve[0].share > 0 && share > 0 ? share / curve[0].share : 0;
		return (struct eco_curve){ .share = (float)share, .scale = curve[0].scale, .reach = (float)(curve[0].reach * t),
			.fp = (float)(curve[0].fp * t), .fn = (float)(1 + (curve[0].fn - 1) * t) };
	}
	uint32_t low = 0, high = n - 1;
	if (share >= curve[high].share)
		return curve[high];
	while (high - low > 1) {
		uint32_t middle = (low + high) / 2;
		if (curve[middle].share <= share)
			low = middle;
		else
			high = middle;
	}
	double t = (share - curve[low].share) / ((double)curve[high].share - curve[low].share);
	return (struct eco_curve){
		.share = (float)share,
		.scale = (float)(curve[low].scale + t * (curve[high].scale - curve[low].scale)),
		.reach = (float)(curve[low].reach + t * (curve[high].reach - curve[low].reach)),
		.fp = (float)(curve[low].fp + t * (curve[high].fp - curve[low].fp)),
		.fn = (float)(curve[low].fn + t * (curve[high].fn - curve[low].fn)),
	};
}

uint64_t lod_ladder_stage_end(const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	struct forms forms;
	if (!find_forms(&forms, scene, ladder))
		return first_floor(scene, ladder, UINT64_MAX);
	if (forms.total == forms.own)
		return lod_ladder_full(scene, ladder);
	struct walk walk;
	for (begin(&walk, &forms); step(&walk);)
		if (walk.leg.to.e == forms.own) {
			uint64_t low = 0, high = leg_steps(&walk.leg);
			while (low < high) {
				uint64_t middle = low + (high - low) / 2;
				if (along(&walk.leg, middle).e == forms.own)
					high = middle;
				else
					low = middle + 1;
			}
			struct state s = along(&walk.leg, low);
			return vertices_of(&forms, &s);
		}
	return lod_ladder_full(scene, ladder);
}

double lod_ladder_share(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	struct forms forms;
	uint64_t full = lod_ladder_full(scene, ladder);
	if (vertices >= full && ladder->before == 0 && !(find_forms(&forms, scene, ladder) && forms.own < forms.total))
		return 1;
	if (find_forms(&forms, scene, ladder))
		return forms_share(&forms, vertices);
	double share = (double)vertices / (double)full, all = (double)primitives(scene, first_list(scene, ladder));
	if (level_count(scene, ladder) == 0 && ladder->total > all)          /* the largest lines of many */
		share *= all / ladder->total;
	return share < 1 ? share : 1;
}

static uint64_t forms_vertices(const struct forms *forms, double share)
{
	struct walk walk;
	begin(&walk, forms);
	step(&walk);
	while (walk.leg.share[1] <= share && step(&walk))
		;
	const struct leg *leg = &walk.leg;
	double t = share < leg->share[1] ? (share - leg->share[0]) / (leg->share[1] - leg->share[0]) : 1;
	uint64_t vertices = leg->vertices[0] + (t > 0 ? (uint64_t)(t * (double)(leg->vertices[1] - leg->vertices[0]) + 1e-6) : 0);
	struct state s = along(leg, steps_within(forms, leg, vertices));
	return vertices_of(forms, &s);
}

uint64_t lod_ladder_vertices(const struct eco_scene *scene, const struct eco_ladder *ladder, double share)
{
	struct forms forms;
	if (find_forms(&forms, scene, ladder))
		return forms_vertices(&forms, share);
	double all = (double)primitives(scene, first_list(scene, ladder));
	if (level_count(scene, ladder) == 0 && ladder->total > all && all > 0)
		share *= ladder->total / all;
	return lod_ladder_floor(scene, ladder, (uint64_t)(share * (double)lod_ladder_full(scene, ladder) + 0.5));
}

double lod_ladder_density(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices)
{
	struct forms forms;
	struct walk walk;
	if (!find_forms(&forms, scene, ladder)) {
		double shown = (double)vertices / (double)first_unit(scene, ladder), total = ladder->total;
		return shown < total ? shown / total : 1;
	}
	return ((double)floor_state(&forms, vertices, &walk).e + forms.before) / forms.total;
}

/* The smallest share from which on the curve reaches `reach`. */
static double share_of_reach(const struct eco_scene *scene, const struct eco_ladder *ladder, double reach)
{
	const struct eco_curve *curve = scene->curves + ladder->curve_first;
	uint32_t i = 0;
	while (i < ladder->curve_count && curve[i].reach < reach)
		i++;
	if (i == 0 || i == ladder->curve_count)
		return i == 0 ? 0 : 1;
	double t = (reach - curve[i - 1].reach) / ((double)curve[i].reach - curve[i - 1].reach);
	return curve[i - 1].share + t * ((double)curve[i].share - curve[i - 1].share);
}

static float scale_at(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices, double density)
{
	if (ladder->organ == ECO_ORGAN_WOOD)
		return 1;
	density = density < 1 ? density : 1;
	double share = lod_ladder_share(scene, ladder, vertices);
	if (density > lod_ladder_density(scene, ladder, vertices)) {         /* cells show more: this list is scaled as they are */
		double half = ladder->total ? 0.5 / ladder->total : 0, least = share_of_reach(scene, ladder, density - half);
		share = share > least ? share : least;
	}
	return (float)(lod_ladder_curve(scene, ladder, share).scale / density);
}

static uint32_t put(struct eco_cut *cut, uint32_t list, uint64_t first, uint64_t end, float scale)
{
	if (first >= end)
		return 0;
	*cut = (struct eco_cut){ .list = list, .first = (uint32_t)first, .end = (uint32_t)end, .scale = scale };
	return 1;
}

static uint32_t forms_cuts(const struct forms *forms, uint64_t vertices, float scale, struct eco_cut cuts[LOD_LADDER_CUTS_MAX])
{
	struct walk walk;
	struct state s = floor_state(forms, vertices, &walk);
	uint32_t count = 0;
	assert(vertices_of(forms, &s) == vertices);
	if (s.f)
		count = put(cuts, forms->list[s.stage + 1], 0, range_end(forms, s.stage + 1, s.f), scale);
	return count + put(cuts + count, forms->list[s.stage], range_end(forms, s.stage, s.f), range_end(forms, s.stage, s.e), scale);
}

uint32_t lod_ladder_cuts(const struct eco_scene *scene, const struct eco_ladder *ladder, uint64_t vertices, double density,
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX])
{
	struct forms forms;
	if (vertices == 0)
		return 0;
	assert(density > 0);
	if (find_forms(&forms, scene, ladder))
		return forms_cuts(&forms, vertices, scale_at(scene, ladder, vertices, density), cuts);
	if (vertices <= first_floor(scene, ladder, UINT64_MAX))
		return put(cuts, first_list(scene, ladder), 0, vertices / first_unit(scene, ladder), scale_at(scene, ladder, vertices, density));
	for (uint32_t level = 0; level < level_count(scene, ladder); level++)
		if (level_vertices(scene, ladder, level) == vertices) {
			uint32_t first, end;
			level_range(scene, ladder, level, &first, &end);
			return put(cuts, ladder->triangles, first, end, 1);
		}
	assert(!"vertices is not a value that lod_ladder_floor returns");
	return 0;
}
