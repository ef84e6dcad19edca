#include "lod/forms.h"
#include "ecofiles/base/order.h"

#include <assert.h>
#include <math.h>

static bool list_is_empty(const struct eco_scene *scene, uint32_t list)
{
	return list == ECO_NONE || scene->lists[list].primitive_count == 0;
}

static bool is_form(const struct eco_scene *scene, uint32_t list, uint32_t of)
{
	return list != ECO_NONE && scene->lists[list].coder == ECO_CODER_FORM && scene->lists[list].partner
		== of && scene->lists[list].element_count == scene->lists[of].element_count;
}

bool lod_forms_find(struct lod_forms *forms, const struct eco_scene *scene, const struct eco_ladder *ladder)
{
	if (list_is_empty(scene, ladder->triangles) || ladder->level_count)
		return false;
	const struct eco_list *triangles = &scene->lists[ladder->triangles];
	const uint32_t coarse[] = { ladder->points, ladder->lines, ladder->simple };
	*forms = (struct lod_forms){ .scene = scene, .ladder = ladder, .triangles = triangles,
		.own = triangles->element_count,
		.before = ladder->before };
	for (int i = 0; i < 3; i++) {
		if (list_is_empty(scene, coarse[i]))
			continue;
		if (!is_form(scene, coarse[i], ladder->triangles))
			return false;
		const struct eco_list *list = &scene->lists[coarse[i]];
		forms->unit[forms->count] =
			eco_list_vertices(list) * (list->primitive_count / list->element_count);
		forms->list[forms->count++] = coarse[i];
	}
	forms->list[forms->count++] = ladder->triangles;
	forms->each = triangles->primitive_count % triangles->element_count ? 0
		: triangles->primitive_count / triangles->element_count;
	for (uint32_t c = 0; c < triangles->chunk_count && forms->each && scene->chunks; c++) {
		const struct eco_chunk *chunk = &scene->chunks[triangles->chunk_first + c];
		if (chunk->primitive_count != forms->each * chunk->element_count)
			forms->each = 0;
	}
	uint64_t region = (uint64_t)forms->own + forms->before;
	forms->total = region > ladder->total ? (uint32_t)region : ladder->total;
	return true;
}

/* Triangles of the first `elements`. Elements of a chunk may differ in triangles; here they are spread evenly
 * over it. */
static uint64_t triangles_of(const struct lod_forms *forms, uint32_t elements)
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

uint64_t lod_forms_range_end(const struct lod_forms *forms, uint32_t form, uint32_t elements)
{
	return form + 1 == forms->count ? triangles_of(forms, elements)
		: (uint64_t)elements * (forms->scene->lists[forms->list[form]].primitive_count / forms->own);
}

static uint64_t cost_of(const struct lod_forms *forms, uint32_t form, uint32_t elements)
{
	return form + 1 == forms->count ? 3 * triangles_of(forms, elements)
		: (uint64_t)forms->unit[form] * elements;
}

uint64_t lod_forms_vertices(const struct lod_forms *forms, const struct lod_forms_state *s)
{
	uint64_t all = cost_of(forms, s->stage, s->e);
	return s->f ? all - cost_of(forms, s->stage, s->f) + cost_of(forms, s->stage + 1, s->f) : all;
}

/* The mean cost of `elements` of the region, at the ladder's own cost an element. Exact if the ladder holds
 * the whole region. */
static double region_cost(const struct lod_forms *forms, uint32_t form, double elements)
{
	if (forms->own == forms->total)
		return (double)cost_of(forms, form, (uint32_t)elements);
	return (double)cost_of(forms, form, forms->own) * elements / forms->own;
}

/* The most elements that turn into triangles, from a form of `unit` vertices, for at most `vertices` more. */
static uint32_t triangles_afford(const struct lod_forms *forms, uint32_t unit, uint64_t vertices)
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
				uint64_t cost =
					3 * ((uint64_t)chunk->primitive_count * middle / chunk->element_count)
					- (uint64_t)unit * middle;
				*(cost <= vertices ? &low : &high) = middle;
			}
			return elements + low;
		}
		vertices -= more;
		elements += chunk->element_count;
	}
	return elements;
}

/* The most elements of the region, at most `most`, that turn from one form into another (`from` ECO_NONE:
 * from nothing) for at most `vertices` more. */
static double region_afford(const struct lod_forms *forms, uint32_t from, uint32_t to, double vertices,
double most)
{
	if (forms->own != forms->total || forms->each) {
		double gain = region_cost(forms, to, forms->own)
			- (from == ECO_NONE ? 0 : region_cost(forms, from, forms->own));
		double count = gain > 0 ? vertices * forms->own / gain : most;
		count = count < most ? count : most;
		return forms->own == forms->total ? (double)(uint32_t)count : count;
	}
	uint32_t unit = from == ECO_NONE ? 0 : forms->unit[from], count = to + 1 == forms->count
		? triangles_afford(forms, unit, (uint64_t)vertices)
		: (uint32_t)(vertices / (forms->unit[to] - unit));
	return count < most ? count : most;
}

/* The region's state at a sample of the curve, reduced to the ladder's own elements. A region in parts has
 * fractions of elements: rounding them would make a small share too small or too dear, and the ladder would
 * begin in another form than the rest of its plant. */
static struct lod_forms_state state_at(const struct lod_forms *forms, double share, double reach)
{
	bool whole = forms->own == forms->total;
	uint32_t stage = 0, last = forms->count - 1;
	double vertices = share * region_cost(forms, last, forms->total), e = reach * forms->total, f = 0;
	vertices = whole ? (double)(uint64_t)(vertices + 0.5) : vertices;
	e = whole ? (double)(uint32_t)(e + 0.5) : e;
	e = e < forms->total ? e : forms->total;
	if (region_cost(forms, last, e) < vertices)          /* too few elements for so many vertices */
		e = region_afford(forms, ECO_NONE, last, vertices, forms->total);
	if (region_cost(forms, 0, e) > vertices)
		e = region_afford(forms, ECO_NONE, 0, vertices, forms->total);
	while (stage + 1 < last && region_cost(forms, stage + 1, e) <= vertices)
		stage++;
	if (last > 0)
		f = region_afford(forms, stage, stage + 1, vertices - region_cost(forms, stage, e), e);
	e = e + 0.5 > forms->before ? e + 0.5 - forms->before : 0;
	f = f + 0.5 > forms->before ? f + 0.5 - forms->before : 0;
	struct lod_forms_state s = { stage, e < forms->own ? (uint32_t)e : forms->own, 0 };
	s.f = f < s.e ? (uint32_t)f : s.e;
	return s.e ? s : (struct lod_forms_state){ 0, 0, 0 };
}

/* Never fewer elements than before, nor coarser ones. */
static struct lod_forms_state ascend(struct lod_forms_state from, struct lod_forms_state to)
{
	if (to.stage < from.stage)
		return from;
	to.e = to.e > from.e ? to.e : from.e;
	if (to.stage == from.stage)
		to.f = to.f > from.f ? to.f : from.f;
	return to;
}

/* ---- Legs ---- */

/* The state after k steps along a leg within one stage. */
static struct lod_forms_state along(const struct lod_forms_leg *leg, uint64_t k)
{
	uint64_t e = leg->to.e - leg->from.e, f = leg->to.f - leg->from.f, steps = e + f;
	if (steps == 0)
		return leg->to;
	return (struct lod_forms_state){ leg->from.stage, leg->from.e + (uint32_t)(k * e / steps),
		leg->from.f + (uint32_t)(k * f / steps) };
}

static uint64_t leg_steps(const struct lod_forms_leg *leg)
{
	return (uint64_t)(leg->to.e - leg->from.e) + (leg->to.f - leg->from.f);
}

/* A leg into the next stage first turns all drawn elements into the finer form: the number of elements at
 * that point. */
static uint32_t crossing(const struct lod_forms *forms, const struct lod_forms_leg *leg)
{
	double left = (double)cost_of(forms, leg->from.stage + 1, leg->from.e) - (double)leg->vertices[0];
	double right = (double)leg->vertices[1] - (double)cost_of(forms, leg->from.stage + 1, leg->to.e), t;
	left = left > 0 ? left : 0;
	right = right > 0 ? right : 0;
	t = left + right > 0 ? left / (left + right) : 0;
	return leg->from.e + (uint32_t)(t * (leg->to.e - leg->from.e));
}

/* Legs from nothing to full detail, one after the other; a leg across stages comes in parts. */
struct walk { const struct lod_forms *forms; uint32_t sample; struct lod_forms_leg whole, leg; };

static void begin(struct walk *walk, const struct lod_forms *forms)
{
	*walk = (struct walk){ .forms = forms };
}

static bool same(const struct lod_forms_state *a, const struct lod_forms_state *b)
{
	return a->stage == b->stage && a->e == b->e && a->f == b->f;
}

static void next_sample(struct walk *walk)
{
	const struct lod_forms *forms = walk->forms;
	const struct eco_ladder *ladder = forms->ladder;
	struct lod_forms_leg *whole = &walk->whole;
	whole->from = whole->to;
	whole->vertices[0] = whole->vertices[1];
	whole->share[0] = whole->share[1];
	if (walk->sample < ladder->curve_count) {
		const struct eco_curve *sample = &forms->scene->curves[ladder->curve_first + walk->sample];
		whole->to = sample->share < 1
			? ascend(whole->from, state_at(forms, sample->share, sample->reach)) : whole->from;
		whole->share[1] = sample->share < 1 ? sample->share : whole->share[0];
	} else {
		whole->to = (struct lod_forms_state){ forms->count > 2 ? forms->count - 2 : 0, forms->own,
			forms->count > 1 ? forms->own : 0 };
		whole->share[1] = 1;
	}
	whole->vertices[1] = lod_forms_vertices(forms, &whole->to);
	walk->sample++;
}

/* Advances to the next leg; false at the end. */
static bool step(struct walk *walk)
{
	const struct lod_forms *forms = walk->forms;
	if (same(&walk->leg.to, &walk->whole.to)) {
		if (walk->sample > forms->ladder->curve_count)
			return false;
		next_sample(walk);
		walk->leg.to = walk->whole.from;
		walk->leg.vertices[1] = walk->whole.vertices[0];
		walk->leg.share[1] = walk->whole.share[0];
	}
	struct lod_forms_leg *leg = &walk->leg, *whole = &walk->whole;
	leg->from = leg->to;
	leg->vertices[0] = leg->vertices[1];
	leg->share[0] = leg->share[1];
	leg->to = whole->to;
	if (leg->from.stage < whole->to.stage && leg->from.f == leg->from.e) {
		leg->from.stage++;
		leg->from.f = 0;
	}
	if (leg->from.stage < whole->to.stage) {
		struct lod_forms_leg rest = { leg->from, whole->to, { leg->vertices[0], whole->vertices[1] },
			{ 0, 0 } };
		uint32_t all = crossing(forms, &rest);
		leg->to = (struct lod_forms_state){ leg->from.stage, all, all };
	}
	leg->vertices[1] = lod_forms_vertices(forms, &leg->to);
	uint64_t length = whole->vertices[1] - whole->vertices[0];
	leg->share[1] = length
		? whole->share[0]
		+ (whole->share[1] - whole->share[0]) * (double)(leg->vertices[1] - whole->vertices[0])
		/ (double)length
		: whole->share[1];
	return true;
}

/* ---- Questions ---- */

uint32_t lod_forms_legs_bound(const struct lod_forms *forms)
{
	return forms->ladder->curve_count + 1 + LOD_FORMS_MAX;
}

void lod_forms_keep(struct lod_forms *forms, struct lod_forms_leg *legs)
{
	struct walk walk;
	bool ascends = true;
	uint32_t count = 0;
	forms->leg_count = 0;
	for (begin(&walk, forms); step(&walk); count++) {
		assert(count < lod_forms_legs_bound(forms));
		legs[count] = walk.leg;
		if (count > 0)
			ascends = ascends && walk.leg.vertices[1] >= legs[count - 1].vertices[1]
				&& walk.leg.share[1] >= legs[count - 1].share[1];
	}
	if (ascends) {                       /* bisection needs ascending legs */
		forms->legs = legs;
		forms->leg_count = count;
	}
}

static bool ends_above(const struct lod_forms_leg *leg, uint64_t vertices, double share)
{
	return leg->vertices[1] > vertices || leg->share[1] > share;
}

/* The first leg that ends above `vertices` or above `share`, or the last leg. */
static struct lod_forms_leg leg_past(const struct lod_forms *forms, uint64_t vertices, double share)
{
	if (forms->leg_count) {
		uint32_t low = 0, high = forms->leg_count - 1;
		ECO_LEAST(low, high, i, ends_above(&forms->legs[i], vertices, share))
		return forms->legs[low];
	}
	struct walk walk;
	begin(&walk, forms);
	step(&walk);
	while (!ends_above(&walk.leg, vertices, share) && step(&walk))
		;
	return walk.leg;
}

static struct lod_forms_leg leg_at(const struct lod_forms *forms, uint64_t vertices)
{
	return leg_past(forms, vertices, INFINITY);
}
static struct lod_forms_leg leg_of_share(const struct lod_forms *forms, double share)
{
	return leg_past(forms, UINT64_MAX, share);
}

static bool draws_within(const struct lod_forms *forms, const struct lod_forms_leg *leg, uint64_t k,
	uint64_t vertices)
{
	struct lod_forms_state s = along(leg, k);
	return lod_forms_vertices(forms, &s) <= vertices;
}

/* Steps along the leg that draw at most `vertices`. If all elements cost the same they are linear in
 * `vertices` but for rounding, so the search first brackets the expected place. */
static uint64_t steps_within(const struct lod_forms *forms, const struct lod_forms_leg *leg,
	uint64_t vertices)
{
	uint64_t low = 0, high = leg_steps(leg) + 1, length = leg->vertices[1] - leg->vertices[0];
	if (forms->each && length) {
		uint64_t guess = (vertices - leg->vertices[0]) * leg_steps(leg) / length;
		if (guess > 1 && guess < high && draws_within(forms, leg, guess - 1, vertices))
			low = guess - 1;
		if (guess >= low && guess + 1 < high && !draws_within(forms, leg, guess + 1, vertices))
			high = guess + 1;
	}
	while (high - low > 1) {
		uint64_t middle = low + (high - low) / 2;
		*(draws_within(forms, leg, middle, vertices) ? &low : &high) = middle;
	}
	return low;
}

static struct lod_forms_state floor_once(const struct lod_forms *forms, uint64_t vertices)
{
	struct lod_forms_leg leg = leg_at(forms, vertices);
	return along(&leg, steps_within(forms, &leg, vertices));
}

/* If elements differ in triangles a step may lower the cost, and bisection finds one of several places. The
 * loop goes on to a state that is found again from its own cost. */
struct lod_forms_state lod_forms_floor(const struct lod_forms *forms, uint64_t vertices)
{
	struct lod_forms_state s = floor_once(forms, vertices);
	while (!forms->each) {
		uint64_t cost = lod_forms_vertices(forms, &s);
		s = floor_once(forms, cost);
		if (lod_forms_vertices(forms, &s) == cost)
			break;
	}
	return s;
}

static bool is_floor(const struct lod_forms *forms, uint64_t vertices)
{
	struct lod_forms_state s = floor_once(forms, vertices);
	return forms->each || lod_forms_vertices(forms, &s) == vertices;
}

uint64_t lod_forms_next(const struct lod_forms *forms, uint64_t vertices)
{
	struct lod_forms_leg leg = leg_at(forms, vertices);
	if (leg.vertices[1] <= vertices)
		return UINT64_MAX;
	for (uint64_t k = steps_within(forms, &leg, vertices) + 1; k <= leg_steps(&leg); k++) {
		struct lod_forms_state s = along(&leg, k);
		uint64_t cost = lod_forms_vertices(forms, &s);
		if (cost > vertices && is_floor(forms, cost))
			return cost;
	}
	return is_floor(forms, leg.vertices[1]) ? leg.vertices[1] : lod_forms_next(forms, leg.vertices[1]);
}

/* The first leg that ends at or above `vertices`, or the last. */
static struct lod_forms_leg leg_up_to(const struct lod_forms *forms, uint64_t vertices)
{
	if (forms->leg_count)
		return leg_at(forms, vertices ? vertices - 1 : 0);
	struct walk walk;
	begin(&walk, forms);
	step(&walk);
	while (walk.leg.vertices[1] < vertices && step(&walk))
		;
	return walk.leg;
}

double lod_forms_first_share(const struct lod_forms *forms, uint64_t vertices)
{
	struct lod_forms_leg leg = leg_up_to(forms, vertices);
	uint64_t length = leg.vertices[1] - leg.vertices[0];
	double t = length ? ((double)vertices - (double)leg.vertices[0]) / (double)length : 1;
	return leg.share[0] + (t < 1 ? t : 1) * (leg.share[1] - leg.share[0]);
}

double lod_forms_share(const struct lod_forms *forms, uint64_t vertices)
{
	struct lod_forms_leg leg = leg_at(forms, vertices);
	uint64_t length = leg.vertices[1] - leg.vertices[0];
	double t = length ? (double)(vertices - leg.vertices[0]) / (double)length : 1;
	return leg.share[0] + (t < 1 ? t : 1) * (leg.share[1] - leg.share[0]);
}

uint64_t lod_forms_of_share(const struct lod_forms *forms, double share)
{
	struct lod_forms_leg leg = leg_of_share(forms, share);
	double t = share < leg.share[1] ? (share - leg.share[0]) / (leg.share[1] - leg.share[0]) : 1;
	uint64_t vertices = leg.vertices[0]
		+ (t > 0 ? (uint64_t)(t * (double)(leg.vertices[1] - leg.vertices[0]) + 1e-6) : 0);
	struct lod_forms_state s = along(&leg, steps_within(forms, &leg, vertices));
	vertices = lod_forms_vertices(forms, &s);
	s = lod_forms_floor(forms, vertices);
	return lod_forms_vertices(forms, &s);
}

uint64_t lod_forms_all_drawn(const struct lod_forms *forms)
{
	struct walk walk;
	for (begin(&walk, forms); step(&walk);)
		if (walk.leg.to.e == forms->own) {
			uint64_t low = 0, high = leg_steps(&walk.leg);
			ECO_LEAST(low, high, i, along(&walk.leg, i).e == forms->own)
			struct lod_forms_state s = along(&walk.leg, low);
			return lod_forms_vertices(forms, &s);
		}
	return UINT64_MAX;
}
