/* Which parts of the plant stand as billboards (Kratt 2014, 3.2 and 3.4): first parts from the tips towards
 * the trunk, then the worst is split, and the cheapest is joined with the part that bears it where there are
 * too many billboards or joining costs nothing. Some of a part's faces decide. */
#include <math.h>
#include <string.h>

#include "tests/bench/baseline/billboard_cloud.h"

#define SAMPLE 96u                   /* faces that decide */
#define SEARCH_STEPS 20
#define PRICE 0.005                   /* of a billboard: share of the mean error of one at the tolerance */

/* ---- One part ---- */

/* The node after this one of what begins at `root`, in preorder: parts that begin farther out are passed
 * over. */
static uint32_t next_of(const struct billboard_work *w, uint32_t root, uint32_t node)
{
	const struct billboard_tree *tree = &w->plant->tree;
	for (node++; node < tree->end[root] && w->begins[node] != ECO_NONE;)
		node = tree->end[node];
	return node;
}

uint32_t billboard_part_faces(struct billboard_work *w, uint32_t root, uint32_t most)
{
	const struct billboard_tree *tree = &w->plant->tree;
	uint32_t count = 0;
	for (uint32_t i = root; i < tree->end[root]; i = next_of(w, root, i))
		for (uint32_t f = tree->face_first[i]; f < tree->face_first[i + 1]; f++)
			w->faces[count++] = &tree->faces[f];
	for (uint32_t i = 0; i < most && count > most; i++)
		w->faces[i] = w->faces[(uint64_t)i * count / most];
	return count < most ? count : most;
}

/* Area, and sigma as its mean over the area. */
static void weigh(const struct billboard_work *w, uint32_t root, struct billboard_fit *fit)
{
	const struct billboard_tree *tree = &w->plant->tree;
	fit->area = fit->sigma = 0;
	for (uint32_t i = root; i < tree->end[root]; i = next_of(w, root, i)) {
		fit->area += tree->area[i];
		fit->sigma += tree->area[i] * tree->sigma[i];
	}
	fit->sigma = fit->area > 0 ? fit->sigma / fit->area : 0;
}

static double loss(const struct billboard_work *w, const struct billboard_fit *fit)
{
	return fit->area * fit->error + w->price * fit->quad_count;
}

static void fit_form(const struct billboard_work *w, struct billboard_fit *fit, uint32_t root, uint32_t faces,
	uint32_t most)
{
	const struct billboard_fit_input input = { w->faces, faces, w->plant->tree.connector[root], most,
		w->epsilon };
	fit->quad_count = billboard_fit(fit->quads, fit->form, &input);
	fit->error = fit->sigma * billboard_uncovered(&input, fit->quads, fit->quad_count);
}

/* The best billboards, at most `most`, for what begins at `root`, which has faces. */
static void fit_part(struct billboard_work *w, uint32_t root, uint32_t most, struct billboard_fit *best)
{
	uint32_t faces = billboard_part_faces(w, root, SAMPLE);
	struct billboard_fit fit;
	bool any = false;
	weigh(w, root, &fit);
	for (uint32_t form = 0; form < LOD_BILLBOARD_FORMS; form++) {
		if (form == LOD_BILLBOARD_CROSS && most < 2)
			continue;
		fit.form = (uint8_t)form;
		fit_form(w, &fit, root, faces, most);
		if (!any || loss(w, &fit) < loss(w, best))
			*best = fit;
		any = true;
	}
}

/* The node at which a part splits most evenly by area; ECO_NONE if it cannot. */
static uint32_t find_cut(struct billboard_work *w, uint32_t root)
{
	const struct billboard_tree *tree = &w->plant->tree;
	uint32_t best = ECO_NONE;
	double best_less = 0;
	for (uint32_t i = root; i < tree->end[root]; i++)
		w->sum[i] = tree->area[i];
	for (uint32_t i = tree->end[root]; --i > root;)
		if (w->begins[i] == ECO_NONE)
			w->sum[tree->parent[i]] += w->sum[i];
	for (uint32_t i = next_of(w, root, root); i < tree->end[root]; i = next_of(w, root, i)) {
		double less = fmin(w->sum[i], w->sum[root] - w->sum[i]);
		/* what is left has faces, not only rounding errors */
		if (less > best_less && less > 1e-9 * w->sum[root]) {
			best_less = less;
			best = i;
		}
	}
	return best;
}

/* ---- All parts ---- */

static uint32_t bearer(const struct billboard_work *w, uint32_t part)
{
	uint32_t node = w->parts[part].root;
	if (!node)
		return ECO_NONE;
	do
		node = w->plant->tree.parent[node];
	while (w->begins[node] == ECO_NONE);
	return w->begins[node];
}

static void set_part(struct billboard_work *w, uint32_t part, uint32_t root, const struct billboard_fit *fit)
{
	w->parts[part] = (struct billboard_part){ .root = root, .fit = *fit };
	w->begins[root] = part;
	w->quad_count += fit->quad_count;
	for (uint32_t i = 0; i < w->part_count; i++)
		if (bearer(w, i) == part)
			w->parts[i].merge_known = false;
}

static uint32_t merged_fit(struct billboard_work *w, uint32_t part, struct billboard_fit *fit)
{
	uint32_t to = bearer(w, part), root = w->parts[part].root;
	w->begins[root] = ECO_NONE;
	fit_part(w, w->parts[to].root, w->parts[part].fit.quad_count + w->parts[to].fit.quad_count - 1, fit);
	w->begins[root] = part;
	return to;
}

/* The part whose joining costs least, neither `but` nor borne by it, and leaves an error up to `most`;
 * ECO_NONE if there is none. */
static uint32_t cheapest_merge(struct billboard_work *w, uint32_t but, double most)
{
	uint32_t best = ECO_NONE;
	for (uint32_t i = 0; i < w->part_count; i++) {
		struct billboard_part *p = &w->parts[i];
		uint32_t to = bearer(w, i);
		if (to == ECO_NONE || i == but || to == but)
			continue;
		if (!p->merge_known) {
			struct billboard_fit fit;
			merged_fit(w, i, &fit);
			p->merge_cost = loss(w, &fit) - loss(w, &p->fit) - loss(w, &w->parts[to].fit);
			p->merge_error = fit.error;
			p->merge_known = true;
		}
		if (p->merge_error <= most && (best == ECO_NONE || p->merge_cost < w->parts[best].merge_cost))
			best = i;
	}
	return best;
}

static void merge(struct billboard_work *w, uint32_t part)
{
	struct billboard_fit fit;
	uint32_t to = merged_fit(w, part, &fit), last = --w->part_count;
	w->quad_count -= w->parts[part].fit.quad_count + w->parts[to].fit.quad_count;
	w->begins[w->parts[part].root] = ECO_NONE;
	if (part != last) {
		w->parts[part] = w->parts[last];
		w->begins[w->parts[part].root] = part;
	}
	to = to == last ? part : to;
	set_part(w, to, w->parts[to].root, &fit);
}

/* As many merges as the cap wants, and others that cost nothing and hold the tolerance. */
static void merge_down(struct billboard_work *w)
{
	for (;;) {
		bool over = w->quad_count > w->cap;
		uint32_t part = cheapest_merge(w, ECO_NONE, over ? INFINITY : BILLBOARD_TOLERANCE);
		if (part == ECO_NONE || (!over && w->parts[part].merge_cost > 0))
			break;
		merge(w, part);
	}
	if (w->quad_count > w->cap) {        /* one is left */
		struct billboard_fit fit;
		fit_part(w, 0, w->cap, &fit);
		w->quad_count = 0;
		set_part(w, 0, 0, &fit);
	}
}

static uint32_t worst_part(const struct billboard_work *w)
{
	uint32_t worst = ECO_NONE;
	double most = 0;
	for (uint32_t i = 0; i < w->part_count; i++) {
		const struct billboard_fit *fit = &w->parts[i].fit;
		if (w->parts[i].kept || fit->error <= BILLBOARD_TOLERANCE)
			continue;
		if (fit->area * fit->error > most) {
			most = fit->area * fit->error;
			worst = i;
		}
	}
	return worst;
}

/* Splits a part where there is room, or where that pays for a merge elsewhere; else keeps it. */
static void split_or_keep(struct billboard_work *w, uint32_t part)
{
	struct billboard_fit fit[2];
	uint32_t root = w->parts[part].root, cut = find_cut(w, root), merged = ECO_NONE, before, after;
	w->parts[part].kept = true;
	if (cut == ECO_NONE)
		return;
	w->begins[cut] = w->part_count;
	fit_part(w, root, BILLBOARD_QUADS, &fit[0]);
	fit_part(w, cut, BILLBOARD_QUADS, &fit[1]);
	w->begins[cut] = ECO_NONE;
	double gain = loss(w, &w->parts[part].fit) - loss(w, &fit[0]) - loss(w, &fit[1]);
	before = w->parts[part].fit.quad_count;
	after = fit[0].quad_count + fit[1].quad_count;
	if (w->quad_count - before + after > w->cap) {
		merged = cheapest_merge(w, part, INFINITY);
		if (merged == ECO_NONE || !(w->parts[merged].merge_cost < gain))
			return;
		merge(w, merged);
		part = w->begins[root];
		if (w->quad_count - before + after > w->cap) {       /* another must go */
			w->parts[part].kept = false;
			return;
		}
	}
	w->quad_count -= before;
	set_part(w, part, root, &fit[0]);
	w->begins[cut] = w->part_count++;
	set_part(w, w->begins[cut], cut, &fit[1]);
}

/* ---- The first parts ---- */

struct box { struct lod_v3 low, high; };

static struct box joined(struct box a, struct box b)
{
	return (struct box){ { fmin(a.low.x, b.low.x), fmin(a.low.y, b.low.y), fmin(a.low.z, b.low.z) },
		{ fmax(a.high.x, b.high.x), fmax(a.high.y, b.high.y), fmax(a.high.z, b.high.z) } };
}

static struct box own_box(const struct billboard_tree *tree, uint32_t node)
{
	struct box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
	for (uint32_t i = 3 * tree->face_first[node]; i < 3 * tree->face_first[node + 1]; i++) {
		struct lod_v3 p = tree->faces[i / 3].corner[i % 3];
		box = joined(box, (struct box){ p, p });
	}
	return box;
}

/* Marks where parts begin whose boxes have diagonals up to `most`, if their nodes have; returns how many.
 * `hangs`: scratch. */
static uint32_t begin(struct billboard_work *w, const struct box *own, struct box *hangs, double most)
{
	const struct billboard_tree *tree = &w->plant->tree;
	uint32_t count = 1, first = ECO_NONE;
	memcpy(hangs, own, tree->count * sizeof *hangs);
	memset(w->begins, 0xff, tree->count * sizeof *w->begins);        /* ECO_NONE */
	for (uint32_t i = tree->count; --i > 0;) {
		struct box *to = &hangs[tree->parent[i]], both = joined(*to, hangs[i]);
		if (hangs[i].low.x > hangs[i].high.x)
			continue;
		if (lod_v3_distance(both.low, both.high) <= most) {
			*to = both;
			continue;
		}
		w->begins[i] = 0;
		first = i;
		count++;
	}
	if (hangs[0].low.x > hangs[0].high.x && first != ECO_NONE) {         /* the root has faces */
		w->begins[first] = ECO_NONE;
		count--;
	}
	w->begins[0] = 0;
	return count;
}

/* The first parts are those of the least box with parts for half the cap, in crosses all of it. */
void billboard_work_open(struct billboard_work *w, const struct lod_billboard_plant *plant,
	uint32_t cap, struct lod_arena *arena)
{
	const struct billboard_tree *tree = &plant->tree;
	struct box *own = lod_arena_take(arena, tree->count, sizeof *own),
		*hangs = lod_arena_take(arena, tree->count, sizeof *hangs);
	double low = 0, high = 64;
	uint32_t wanted = cap / 2 > 1 ? cap / 2 : 1;
	*w = (struct billboard_work){ .arena = arena, .plant = plant, .cap = cap,
		.begins = lod_arena_take(arena, tree->count, sizeof *w->begins),
		.roots = lod_arena_take(arena, tree->count, sizeof *w->roots),
		.faces = lod_arena_take(arena, tree->face_count, sizeof *w->faces),
		.sum = lod_arena_take(arena, tree->count, sizeof *w->sum) };
	for (uint32_t i = 0; i < tree->count; i++)
		own[i] = own_box(tree, i);
	for (int step = 0; step < SEARCH_STEPS; step++) {
		double middle = (low + high) / 2;
		*(begin(w, own, hangs, middle) > wanted ? &low : &high) = middle;
	}
	begin(w, own, hangs, high);
	for (uint32_t i = 0; i < tree->count; i++)
		if (w->begins[i] != ECO_NONE)
			w->roots[w->root_count++] = i;
	w->parts = lod_arena_take(arena, (size_t)w->root_count + cap + 1, sizeof *w->parts);
}

void billboard_parts_settle(struct billboard_work *w, double epsilon)
{
	const struct billboard_tree *tree = &w->plant->tree;
	double weight = 0;
	for (uint32_t i = 0; i < tree->count; i++)
		weight += tree->area[i] * tree->sigma[i];
	w->epsilon = epsilon;
	w->price = PRICE * weight / w->cap;
	w->quad_count = 0;
	w->part_count = w->root_count;
	memset(w->begins, 0xff, tree->count * sizeof *w->begins);        /* ECO_NONE */
	for (uint32_t i = 0; i < w->root_count; i++)
		w->begins[w->roots[i]] = i;
	for (uint32_t i = 0; i < w->part_count; i++) {
		w->parts[i] = (struct billboard_part){ .root = w->roots[i] };
		fit_part(w, w->roots[i], BILLBOARD_QUADS, &w->parts[i].fit);
		w->quad_count += w->parts[i].fit.quad_count;
	}
	merge_down(w);
	/* each step lowers the loss or keeps a part; more would be a matter of rounding */
	for (uint32_t left = 8 * (w->cap + w->part_count); left > 0; left--) {
		uint32_t part = worst_part(w);
		if (part == ECO_NONE)
			break;
		split_or_keep(w, part);
	}
	w->quad_count = 0;
	for (uint32_t i = 0; i < w->part_count; i++) {       /* again, for all faces */
		struct billboard_fit *fit = &w->parts[i].fit;
		uint32_t root = w->parts[i].root, faces = billboard_part_faces(w, root, tree->face_count);
		fit_form(w, fit, root, faces, fit->quad_count);
		w->quad_count += fit->quad_count;
	}
}

double billboard_parts_error(const struct billboard_work *w)
{
	double sum = 0, weight = 0;
	for (uint32_t i = 0; i < w->part_count; i++) {
		const struct billboard_fit *fit = &w->parts[i].fit;
		sum += fit->area * fit->error;
		weight += fit->area;
	}
	return weight > 0 ? sum / weight : 0;
}
