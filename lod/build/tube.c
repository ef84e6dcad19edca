/* See tube.h. Longer than 600 lines: the steps from a surface to its bones share slabs and joints. */
#include "lod/build/tube.h"

#include <assert.h>
#include <string.h>

#include "ecofiles/base/union.h"
#include "lod/heap.h"
#include "lod/sort.h"

#define SLAB_RADII 3.0           /* thickness of a slab, in mean radii of the component */
#define FRAGMENTS_PER_TRIANGLE 8.0
#define RING_RADII 4.0           /* largest distance of a ring of border from its centre */
#define FOOT 0.03                /* of a component's height: height of a closed trunk's foot */
#define FOOT_WIDTH 0.2           /* of the same: radius of that foot */
/* Share of a ring's diameter. A bone at an end is part of the line before it if it is no longer than that, or
 * than the mean radius. */
#define STUB 0.75
#define TIP_DEPTH 0.2            /* of a slab: the extent of a piece's end */

/* ---- Distance along the surface ---- */

/* Rings of border: the open ends of tubes. Slits and rims wider than a few radii are no rings. */
static void find_rings(struct lod_tube *tube, struct lod_arena *arena)
{
	uint32_t n = tube->vertex_count;
	tube->ring = lod_arena_take(arena, n, sizeof *tube->ring);
	tube->ring_center = lod_arena_take(arena, n, sizeof *tube->ring_center);
	struct lod_arena_piece *mark = arena->last;
	uint32_t *size = lod_arena_take(arena, n, sizeof *size);
	bool *wide = lod_arena_take(arena, n, sizeof *wide),
		*border = lod_arena_take(arena, n, sizeof *border);
	for (uint32_t v = 0; v < n; v++)
		tube->ring[v] = v;
	for (uint32_t t = 0; t < tube->triangle_count; t++)
		for (uint32_t k = 0; k < 3; k++) {
			if (lod_mesh_across(tube->mesh, tube->member[t], k) != ECO_NONE)
				continue;
			uint32_t a = tube->corner[3 * t + k], b = tube->corner[3 * t + (k + 1) % 3];
			border[a] = border[b] = true;
			tube->ring[eco_union_root(tube->ring, a)] = eco_union_root(tube->ring, b);
		}
	for (uint32_t v = 0; v < n; v++) {
		uint32_t r = eco_union_root(tube->ring, v);
		tube->ring_center[r] = lod_v3_add(tube->ring_center[r], lod_tube_place(tube, v));
		size[r]++;
	}
	for (uint32_t v = 0; v < n; v++)
		if (size[v])
			tube->ring_center[v] = lod_v3_scale(tube->ring_center[v], 1.0 / size[v]);
	for (uint32_t v = 0; v < n; v++) {
		uint32_t r = eco_union_root(tube->ring, v);
		wide[r] = wide[r] || lod_v3_distance(tube->ring_center[r], lod_tube_place(tube, v))
			> RING_RADII * tube->component->radius;
	}
	for (uint32_t v = 0; v < n; v++) /* flat: a root's own entry is read before it may become ECO_NONE */
		size[v] = border[v] && !wide[eco_union_root(tube->ring, v)] ? eco_union_root(tube->ring, v)
			: ECO_NONE;
	memcpy(tube->ring, size, n * sizeof *size);
	lod_arena_release(arena, mark);
}

/* A shortest path to a vertex is found at most once along each edge. */
struct spread { uint32_t *first, *around, *stack; struct lod_heap_item *heap; bool *source; };

static void start_spread(struct spread *s, const struct lod_tube *tube, struct lod_arena *arena)
{
	size_t n = tube->vertex_count, corners = 3 * (size_t)tube->triangle_count;
	*s = (struct spread){ lod_arena_take(arena, n + 2, sizeof *s->first),
		lod_arena_take(arena, corners, sizeof *s->around), lod_arena_take(arena, n, sizeof *s->stack),
		lod_arena_take(arena, n + 2 * corners, sizeof *s->heap), lod_arena_take(arena, n, sizeof *s->source) };
	for (uint32_t i = 0; i < 3 * tube->triangle_count; i++)
		s->first[tube->corner[i] + 2]++;
	for (size_t v = 2; v <= n + 1; v++)
		s->first[v] += s->first[v - 1];
	for (uint32_t i = 0; i < 3 * tube->triangle_count; i++)
		s->around[s->first[tube->corner[i] + 1]++] = i;
}

/* Distances along edges from all sources (Dijkstra); items of the heap that a shorter way replaced are skipped. */
static void spread(struct lod_tube *tube, struct spread *s)
{
	uint32_t count = 0;
	for (uint32_t v = 0; v < tube->vertex_count; v++) {
		tube->level[v] = s->source[v] ? 0 : INFINITY;
		if (s->source[v])
			lod_heap_push(s->heap, count++, (struct lod_heap_item){ 0, v });
	}
	while (count) {
		uint32_t v = s->heap[0].id;
		bool replaced = -s->heap[0].key > tube->level[v];
		s->heap[0] = s->heap[--count];
		lod_heap_sift(s->heap, count, 0);
		for (uint32_t i = s->first[v]; i < s->first[v + 1] && !replaced; i++)
			for (uint32_t k = 1; k < 3; k++) {
				uint32_t t = s->around[i] / 3,
					u = tube->corner[3 * t + (s->around[i] % 3 + k) % 3];
				double d = tube->level[v] + lod_v3_distance(lod_tube_place(tube, v),
					lod_tube_place(tube, u));
				if (d < tube->level[u]) {
					tube->level[u] = d;
					lod_heap_push(s->heap, count++, (struct lod_heap_item){ -d, u });
				}
			}
	}
}

/* The sources of distances: a tube starts with a ring, not with a corner. They are all of the ring of border
 * with `vertex`, or else the foot of a closed trunk: vertices connected to it, at most FOOT times `height`
 * above it and within FOOT_WIDTH times `height` of it. */
static void set_sources(const struct lod_tube *tube, struct spread *s, uint32_t vertex, double height)
{
	struct lod_v3 foot = lod_tube_place(tube, vertex);
	uint32_t *stack = s->stack, depth = 1;
	memset(s->source, 0, tube->vertex_count * sizeof *s->source);
	for (uint32_t v = 0; v < tube->vertex_count; v++)
		s->source[v] = v == vertex
			|| (tube->ring[vertex] != ECO_NONE && tube->ring[v] == tube->ring[vertex]);
	stack[0] = vertex;
	while (depth && tube->ring[vertex] == ECO_NONE) {
		uint32_t v = stack[--depth];
		for (uint32_t i = s->first[v]; i < s->first[v + 1]; i++)
			for (uint32_t k = 1; k < 3; k++) {
				uint32_t t = s->around[i] / 3,
					u = tube->corner[3 * t + (s->around[i] % 3 + k) % 3];
				struct lod_v3 p = lod_tube_place(tube, u);
				if (s->source[u] || p.z > foot.z + FOOT * height || lod_v3_distance(p, foot)
						> FOOT_WIDTH * height)
					continue;
				s->source[u] = true;
				stack[depth++] = u;
			}
	}
}

/* Distances from the lowest vertex, or from the vertex farthest from that. */
static void find_distances(struct lod_tube *tube, bool from_farthest, struct lod_arena *arena)
{
	uint32_t start = 0, farthest = 0;
	tube->level = lod_arena_take(arena, tube->vertex_count, sizeof *tube->level);
	struct lod_arena_piece *mark = arena->last;
	struct spread s;
	start_spread(&s, tube, arena);
	for (uint32_t v = 1; v < tube->vertex_count; v++)
		start = lod_tube_place(tube, v).z < lod_tube_place(tube, start).z ? v : start;
	set_sources(tube, &s, start, (double)tube->component->high[2] - tube->component->low[2]);
	spread(tube, &s);
	if (from_farthest) {
		for (uint32_t v = 1; v < tube->vertex_count; v++)
			farthest = tube->level[v] > tube->level[farthest] ? v : farthest;
		start = farthest;
		set_sources(tube, &s, start, 0);
		spread(tube, &s);
	}
	lod_arena_release(arena, mark);
	tube->closed_start = tube->ring[start] == ECO_NONE;
}

/* Levels in slabs instead of metres: a slab is a few radii thick, or thicker if triangles would be cut into
 * too many pieces. */
static void scale_levels(struct lod_tube *tube)
{
	double spans = 0, thick = SLAB_RADII * tube->component->radius;
	for (uint32_t t = 0; t < tube->triangle_count; t++) {
		const uint32_t *c = tube->corner + 3 * t;
		double low = fmin(tube->level[c[0]], fmin(tube->level[c[1]], tube->level[c[2]]));
		spans += fmax(tube->level[c[0]], fmax(tube->level[c[1]], tube->level[c[2]])) - low;
	}
	thick = fmax(thick, spans / (FRAGMENTS_PER_TRIANGLE * tube->triangle_count));
	for (uint32_t v = 0; v < tube->vertex_count; v++)
		tube->level[v] = thick > 0 ? tube->level[v] / thick : 0;
}

/* ---- Slabs ---- */

static uint32_t slab(const struct lod_tube *tube, uint32_t v)
{
	return (uint32_t)tube->level[v];
}

static void span_of(const struct lod_tube *tube, uint32_t t, uint32_t *low, uint32_t *high)
{
	*low = UINT32_MAX;
	*high = 0;
	for (uint32_t k = 0; k < 3; k++) {
		uint32_t s = slab(tube, tube->corner[3 * t + k]);
		*low = s < *low ? s : *low;
		*high = s > *high ? s : *high;
	}
}

static uint32_t fragment(const struct lod_tube *tube, uint32_t t, uint32_t s)
{
	uint32_t low, high;
	span_of(tube, t, &low, &high);
	assert(s >= low && s <= high);
	return tube->offset[t] + s - low;
}

uint32_t lod_tube_piece(struct lod_tube *tube, uint32_t f)
{
	return eco_union_root(tube->parent, f);
}

/* Area of a triangle below a level; levels s ascend. */
static double area_below(const double s[3], double area, double at)
{
	if (at <= s[0])
		return 0;
	if (at >= s[2])
		return area;
	if (at < s[1])
		return area * (at - s[0]) * (at - s[0]) / ((s[1] - s[0]) * (s[2] - s[0]));
	return area - area * (s[2] - at) * (s[2] - at) / ((s[2] - s[1]) * (s[2] - s[0]));
}

static void add_areas(struct lod_tube *tube, uint32_t t)
{
	struct lod_v3 p[3];
	double s[3], swap;
	for (uint32_t k = 0; k < 3; k++) {
		p[k] = lod_tube_place(tube, tube->corner[3 * t + k]);
		s[k] = tube->level[tube->corner[3 * t + k]];
	}
	for (int i = 0; i < 3; i++)
		if (s[i % 2] > s[i % 2 + 1]) {
			swap = s[i % 2];
			s[i % 2] = s[i % 2 + 1];
			s[i % 2 + 1] = swap;
		}
	double area = lod_v3_length(lod_v3_cross(lod_v3_sub(p[1], p[0]), lod_v3_sub(p[2], p[0]))) / 2,
		below = 0;
	for (uint32_t f = tube->offset[t]; f < tube->offset[t + 1]; f++) {
		double to = f + 1 == tube->offset[t + 1] ? area
			: area_below(s, area, (double)((uint32_t)s[0] + f - tube->offset[t] + 1));
		tube->area[f] = to - below;
		below = to;
	}
}

static void cut_slabs(struct lod_tube *tube, struct lod_arena *arena)
{
	uint32_t low, high, total = 0;
	tube->offset = lod_arena_take(arena, (size_t)tube->triangle_count + 1, sizeof *tube->offset);
	for (uint32_t t = 0; t < tube->triangle_count; t++) {
		span_of(tube, t, &low, &high);
		tube->offset[t] = total;
		total += high - low + 1;
	}
	tube->offset[tube->triangle_count] = total;
	tube->parent = lod_arena_take(arena, total, sizeof *tube->parent);
	tube->area = lod_arena_take(arena, total, sizeof *tube->area);
	for (uint32_t f = 0; f < total; f++)
		tube->parent[f] = f;
	uint32_t *at_vertex = lod_arena_take(arena, tube->vertex_count, sizeof *at_vertex);
	struct lod_keyed *by = lod_arena_take(arena, 3 * (size_t)tube->triangle_count, sizeof *by);
	memset(at_vertex, 0xff, tube->vertex_count * sizeof *at_vertex);
	for (uint32_t t = 0; t < tube->triangle_count; t++) {
		add_areas(tube, t);
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t a = tube->corner[3 * t + k], b = tube->corner[3 * t + (k + 1) % 3],
				f = fragment(tube, t, slab(tube, a));
			if (at_vertex[a] == ECO_NONE)
				at_vertex[a] = f;
			tube->parent[lod_tube_piece(tube, f)] = lod_tube_piece(tube, at_vertex[a]);
			by[3 * t + k] =
				(struct lod_keyed){ a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a,
				t };
		}
	}
	/* Fragments of one slab that meet along an edge are one piece; an edge may have two or more
	 * triangles. */
	lod_sort(arena, by, 3 * tube->triangle_count);
	for (uint32_t i = 1; i < 3 * tube->triangle_count; i++) {
		if (by[i].key != by[i - 1].key)
			continue;
		uint32_t p = slab(tube, (uint32_t)by[i].key), q = slab(tube, (uint32_t)(by[i].key >> 32));
		for (uint32_t s = p < q ? p : q; s <= (p < q ? q : p); s++)
			tube->parent[lod_tube_piece(tube, fragment(tube, by[i].value, s))] =
				lod_tube_piece(tube, fragment(tube, by[i - 1].value, s));
	}
	for (uint32_t f = 0; f < total; f++) {
		uint32_t root = lod_tube_piece(tube, f);
		if (root != f) {
			tube->area[root] += tube->area[f];
			tube->area[f] = 0;
		}
	}
}

/* ---- Joints ---- */

struct crossing { struct lod_v3 middle; double length; uint32_t slab; bool open; };

/* The point at which level s crosses edge k of t. */
static bool cross_edge(const struct lod_tube *tube, uint32_t t, uint32_t k, uint32_t s, struct lod_v3 *at)
{
	uint32_t a = tube->corner[3 * t + k], b = tube->corner[3 * t + (k + 1) % 3];
	if ((slab(tube, a) < s) == (slab(tube, b) < s))
		return false;
	if (a > b) {                 /* the same point from both sides of the edge */
		uint32_t swap = a;
		a = b;
		b = swap;
	}
	*at = lod_v3_mix(lod_tube_place(tube, a), lod_tube_place(tube, b),
		(s - tube->level[a]) / (tube->level[b] - tube->level[a]));
	return true;
}

static void find_joints(struct lod_tube *tube, struct lod_arena *arena)
{
	uint32_t most = tube->offset[tube->triangle_count], count = 0;
	struct crossing *crossings = lod_arena_take(arena, most, sizeof *crossings);
	struct lod_keyed *by = lod_arena_take(arena, most, sizeof *by);
	for (uint32_t t = 0; t < tube->triangle_count; t++) {
		uint32_t low, high;
		span_of(tube, t, &low, &high);
		for (uint32_t s = low + 1; s <= high; s++) {
			struct lod_v3 p[3];
			uint32_t n = 0;
			struct crossing *c = &crossings[count];
			for (uint32_t k = 0; k < 3; k++)
				if (cross_edge(tube, t, k, s, &p[n])) {
					c->open = c->open || lod_mesh_across(tube->mesh, tube->member[t], k)
						== ECO_NONE;
					n++;
				}
			assert(n == 2);
			c->middle = lod_v3_mix(p[0], p[1], 0.5);
			c->length = lod_v3_distance(p[0], p[1]);
			c->slab = s;
			by[count] =
				(struct lod_keyed){ (uint64_t)lod_tube_piece(tube, fragment(tube, t, s - 1)) << 32
				| lod_tube_piece(tube, fragment(tube, t, s)), count };
			count++;
		}
	}
	lod_sort(arena, by, count);
	/* Every piece may get up to two ends beside its rings. */
	tube->joints = lod_arena_take(arena, (size_t)count + 2 * (size_t)most, sizeof *tube->joints);
	for (uint32_t i = 0, end; i < count; i = end) {
		struct lod_joint *j = &tube->joints[tube->joint_count++];
		*j = (struct lod_joint){ .piece = { (uint32_t)(by[i].key >> 32), (uint32_t)by[i].key },
			.slab = crossings[by[i].value].slab };
		double weight = 0;
		for (end = i; end < count && by[end].key == by[i].key; end++) {
			const struct crossing *c = &crossings[by[end].value];
			double w = c->length > 0 ? c->length : 1e-30;
			j->place = lod_v3_add(j->place, lod_v3_scale(c->middle, w));
			weight += w;
			j->ring += c->length;
			j->open += c->open;
		}
		j->place = lod_v3_scale(j->place, 1 / weight);
	}
}

/* Whether the surface divides in the first slabs. Then the start is not an end but the middle of a tube that
 * hangs with both ends up. */
static bool starts_in_the_middle(const struct lod_tube *tube)
{
	for (uint32_t i = 1; i < tube->joint_count; i++)     /* sorted by the piece below */
		if (tube->joints[i].piece[0] == tube->joints[i - 1].piece[0] && tube->joints[i].slab <= 2)
			return true;
	return false;
}

struct tip { double level; struct lod_v3 sum; uint32_t count; bool open; };

static void add_to_tip(const struct lod_tube *tube, struct tip *tip, uint32_t v)
{
	bool open = tube->ring[v] != ECO_NONE;
	if (open && !tip->open)
		*tip = (struct tip){ .level = tip->level, .open = true };
	if (open != tip->open)
		return;
	tip->sum = lod_v3_add(tip->sum, open ? tube->ring_center[tube->ring[v]] : lod_tube_place(tube, v));
	tip->count++;
}

/* Ends of pieces: the mean of their highest or lowest vertices, or the ring's centre at an open end. */
static struct tip *find_tips(struct lod_tube *tube, int sign, struct lod_arena *arena)
{
	struct tip *tips = lod_arena_take(arena, tube->offset[tube->triangle_count], sizeof *tips);
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t t = 0; t < tube->triangle_count; t++)
			for (uint32_t k = 0; k < 3; k++) {
				uint32_t v = tube->corner[3 * t + k];
				struct tip *tip = &tips[lod_tube_piece(tube, fragment(tube, t, slab(tube, v)))];
				double level = sign * (tube->level[v] - slab(tube, v)) + 1; /* in (0, 2) */
				if (pass == 0)
					tip->level = fmax(tip->level, level);
				else if (level > tip->level - TIP_DEPTH)
					add_to_tip(tube, tip, v);
			}
	return tips;
}

static uint32_t add_end(struct lod_tube *tube, uint32_t piece, const struct tip *tip, bool top)
{
	tube->joints[tube->joint_count] =
		(struct lod_joint){ .place = lod_v3_scale(tip->sum, 1.0 / tip->count),
		.piece = { top ? piece : ECO_NONE, top ? ECO_NONE : piece }, .fixed = tip->open };
	return tube->joint_count++;
}

static void add_bone(struct lod_tube *tube, uint32_t a, uint32_t b, uint32_t piece)
{
	uint32_t number = tube->bone_count++;
	tube->bones[number] = (struct lod_raw_bone){ .joint = { a, b }, .piece = piece, .line = ECO_NONE,
		.merged = ECO_NONE };
	for (int k = 0; k < 2; k++) {
		struct lod_joint *j = &tube->joints[k ? b : a];
		if (j->degree < 2)
			j->bone[j->degree] = number;
		j->degree++;
	}
}

/* The bones of one piece, whose joints are by[first .. end): from the widest ring below (else the bottom) to
 * all others. */
static void join_piece(struct lod_tube *tube, uint32_t piece, const struct lod_keyed *by, uint32_t first,
	uint32_t end, const struct tip *tops, const struct tip *bottoms)
{
	uint32_t root = ECO_NONE, start = tube->bone_count;
	bool above = false;
	double total = 0;
	for (uint32_t i = first; i < end; i++) {
		const struct lod_joint *j = &tube->joints[by[i].value];
		if (j->piece[1] == piece && (root == ECO_NONE || j->ring > tube->joints[root].ring))
			root = by[i].value;
		above = above || j->piece[0] == piece;
	}
	if (root == ECO_NONE && bottoms[piece].count)
		root = add_end(tube, piece, &bottoms[piece], false);
	for (uint32_t i = first; i < end; i++)
		if (by[i].value != root && root != ECO_NONE)
			add_bone(tube, root, by[i].value, piece);
	if (!above && root != ECO_NONE && tops[piece].count)
		add_bone(tube, root, add_end(tube, piece, &tops[piece], true), piece);
	/* Bones share the area by their lengths and rings. */
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t b = start; b < tube->bone_count; b++) {
			const struct lod_joint *from = &tube->joints[tube->bones[b].joint[0]],
				*to = &tube->joints[tube->bones[b].joint[1]];
			double share =
				lod_v3_distance(from->place,
				to->place) * (from->ring + 2 * to->ring + tube->component->radius);
			if (pass == 0)
				total += share;
			else
				tube->bones[b].area =
					tube->area[piece] * (total > 0 ? share / total
					: 1.0 / (tube->bone_count - start));
		}
}

static void find_bones(struct lod_tube *tube, struct lod_arena *arena)
{
	uint32_t most = tube->offset[tube->triangle_count], links = 0, rings = tube->joint_count;
	const struct tip *tops = find_tips(tube, 1, arena), *bottoms = find_tips(tube, -1, arena);
	struct lod_keyed *by = lod_arena_take(arena, 2 * (size_t)rings, sizeof *by);
	tube->bones = lod_arena_take(arena, 2 * (size_t)rings + most, sizeof *tube->bones);
	for (uint32_t j = 0; j < rings; j++)
		for (int k = 0; k < 2; k++)
			by[links++] = (struct lod_keyed){ tube->joints[j].piece[k], j };
	lod_sort(arena, by, links);
	for (uint32_t piece = 0, at = 0, end; piece < most; piece++) {
		if (tube->parent[piece] != piece)
			continue;
		for (end = at; end < links && by[end].key == piece; end++)
			;
		join_piece(tube, piece, by, at, end, tops, bottoms);
		at = end;
	}
}

/* ---- Stubs ---- */

static double bone_length(const struct lod_tube *tube, const struct lod_raw_bone *bone)
{
	return lod_v3_distance(tube->joints[bone->joint[0]].place, tube->joints[bone->joint[1]].place);
}

/* Degrees and bones of joints, without the merged bones. */
static void link_joints(struct lod_tube *tube)
{
	for (uint32_t j = 0; j < tube->joint_count; j++)
		tube->joints[j].degree = 0;
	for (uint32_t b = 0; b < tube->bone_count; b++)
		for (int k = 0; k < 2 && tube->bones[b].merged == ECO_NONE; k++) {
			struct lod_joint *j = &tube->joints[tube->bones[b].joint[k]];
			if (j->degree < 2)
				j->bone[j->degree] = b;
			j->degree++;
		}
}

/* A spur: a bone with a free end that is shorter than wide. Returns its inner joint, or ECO_NONE. */
static uint32_t spur_at(const struct lod_tube *tube, uint32_t b, int k)
{
	const struct lod_raw_bone *bone = &tube->bones[b];
	const struct lod_joint *end = &tube->joints[bone->joint[k]],
		*inner = &tube->joints[bone->joint[1 - k]];
	double wide = fmax(tube->component->radius, STUB / LOD_PI * fmax(inner->ring, end->ring));
	return end->degree == 1 && inner->degree > 1 && bone_length(tube, bone) <= wide ? bone->joint[1 - k]
		: ECO_NONE;
}

static void merge(struct lod_tube *tube, uint32_t spur, uint32_t into)
{
	tube->bones[into].area += tube->bones[spur].area;
	tube->bones[spur].merged = into;
}

/* A spur at a fork is a bump of the surface: it is dropped, and the longest bone there gets its area. */
static void drop_bumps(struct lod_tube *tube)
{
	for (uint32_t j = 0; j < tube->joint_count; j++)
		tube->joints[j].longest = ECO_NONE;
	for (uint32_t b = 0; b < tube->bone_count; b++)
		for (int k = 0; k < 2 && tube->bones[b].merged == ECO_NONE; k++) {
			struct lod_joint *j = &tube->joints[tube->bones[b].joint[k]];
			if (j->longest == ECO_NONE || bone_length(tube, &tube->bones[b])
					> bone_length(tube, &tube->bones[j->longest]))
				j->longest = b;
		}
	for (uint32_t b = 0; b < tube->bone_count; b++)
		for (int k = 0; k < 2 && tube->bones[b].merged == ECO_NONE; k++) {
			uint32_t inner = spur_at(tube, b, k);
			if (inner == ECO_NONE || tube->joints[inner].degree < 3 || tube->joints[inner].longest
					== b)
				continue;
			merge(tube, b, tube->joints[inner].longest);
			tube->joints[inner].degree--;
		}
}

/* Rings tilt where a tube bends, since its inner side is shorter, which leaves a spur at its end. The bone
 * before it takes over its area and reaches as far along its own axis. */
static void drop_ends(struct lod_tube *tube)
{
	for (uint32_t b = 0; b < tube->bone_count; b++)
		for (int k = 0; k < 2 && tube->bones[b].merged == ECO_NONE; k++) {
			uint32_t inner = spur_at(tube, b, k), end = tube->bones[b].joint[k];
			if (inner == ECO_NONE || tube->joints[inner].degree != 2)
				continue;
			struct lod_joint *j = &tube->joints[inner];
			uint32_t other = j->bone[0] == b ? j->bone[1] : j->bone[0];
			struct lod_raw_bone *before = &tube->bones[other];
			struct lod_v3 far = tube->joints[before->joint[before->joint[0] == inner]].place;
			struct lod_v3 axis = lod_v3_unit(lod_v3_sub(j->place, far)),
				*tip = &tube->joints[end].place;
			if (!tube->joints[end].fixed && bone_length(tube, before)
					> bone_length(tube, &tube->bones[b]))
				*tip = lod_v3_add(j->place,
					lod_v3_scale(axis,
					fmax(0, lod_v3_dot(axis, lod_v3_sub(*tip, j->place)))));
			tube->joints[end].ring = j->ring;
			tube->joints[end].bone[0] = other;
			before->joint[before->joint[0] == inner ? 0 : 1] = end;
			j->degree = 0;
			merge(tube, b, other);
		}
}

static void drop_spurs(struct lod_tube *tube)
{
	for (int round = 0; round < 3; round++) {
		drop_bumps(tube);
		link_joints(tube);
		drop_ends(tube);
		link_joints(tube);
	}
}

/* ---- All ---- */

static void open_tube(struct lod_tube *tube, const struct lod_mesh *mesh, const struct lod_organs *organs,
	uint32_t c, uint32_t *local, struct lod_arena *arena)
{
	*tube = (struct lod_tube){ .mesh = mesh, .component = &organs->components[c],
		.member = mesh->member + mesh->member_first[c],
		.triangle_count = mesh->member_first[c + 1] - mesh->member_first[c] };
	tube->corner = lod_arena_take(arena, 3 * (size_t)tube->triangle_count, sizeof *tube->corner);
	tube->global = lod_arena_take(arena, 3 * (size_t)tube->triangle_count, sizeof *tube->global);
	for (uint32_t i = 0; i < 3 * tube->triangle_count; i++) {
		uint32_t v = mesh->index[3 * (size_t)tube->member[i / 3] + i % 3];
		if (local[v] >= tube->vertex_count || tube->global[local[v]] != v) {
			local[v] = tube->vertex_count;
			tube->global[tube->vertex_count++] = v;
		}
		tube->corner[i] = local[v];
	}
}

void lod_tube_make(struct lod_tube *tube, const struct lod_mesh *mesh, const struct lod_organs *organs,
	uint32_t c, uint32_t *local, struct lod_arena *arena)
{
	for (int from_farthest = 0; from_farthest < 2; from_farthest++) {
		open_tube(tube, mesh, organs, c, local, arena);
		find_rings(tube, arena);
		find_distances(tube, from_farthest, arena);
		scale_levels(tube);
		cut_slabs(tube, arena);
		find_joints(tube, arena);
		if (!tube->closed_start || !starts_in_the_middle(tube))
			break;
	}
	find_bones(tube, arena);
	drop_spurs(tube);
}

uint32_t lod_tube_piece_at(struct lod_tube *tube, uint32_t t, uint32_t k)
{
	return lod_tube_piece(tube, fragment(tube, t, slab(tube, tube->corner[3 * t + k])));
}
