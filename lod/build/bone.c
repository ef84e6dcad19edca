#include "lod/build/bone.h"

#include <string.h>

#include "lod/light.h"
#include "lod/sort.h"
#include "lod/build/tube.h"

#define SIMILAR 1.6              /* widths that may differ along one line */
#define OFF_CHORD 0.25           /* of the width: a joint's distance from the line that replaces it */
#define RING_SLACK 1.25          /* how much wider than its widest ring a line may be */
#define CHAIN_MAX 64u            /* joints that one line may skip */

static double distance_to(struct lod_v3 p, struct lod_v3 a, struct lod_v3 b)
{
	struct lod_v3 ab = lod_v3_sub(b, a), ap = lod_v3_sub(p, a);
	double l2 = lod_v3_dot(ab, ab), t = l2 > 0 ? lod_v3_dot(ap, ab) / l2 : 0;
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	return lod_v3_distance(p, lod_v3_add(a, lod_v3_scale(ab, t)));
}

static double bone_length(const struct lod_tube *tube, const struct lod_raw_bone *b)
{
	return lod_v3_distance(tube->joints[b->joint[0]].place, tube->joints[b->joint[1]].place);
}

/* Width from area and length: a tube's diameter, or a strip's width. Limited by the rings, since the area of
 * a swelling, a cap or a fork may have next to no length. */
static double width_of(const struct lod_tube *tube, const uint32_t *chain, uint32_t bones, double area,
	double length, bool strip)
{
	double ring = 0;
	for (uint32_t i = 0; i <= bones; i++)
		ring = fmax(ring, tube->joints[chain[i]].ring);
	double most = ring > 0 ? RING_SLACK * (strip ? ring : ring / LOD_PI) : sqrt(area);
	return length > 0 ? fmin(area / (strip ? length : LOD_PI * length), most) : most;
}

/* Whether one line may replace the joints of chain[0 .. bones]: each is within a quarter of the width of the
 * line, widths are similar. */
static bool straight(const struct lod_tube *tube, const uint32_t *chain, const uint32_t *bone, uint32_t bones,
	bool strip)
{
	struct lod_v3 a = tube->joints[chain[0]].place, b = tube->joints[chain[bones]].place;
	double low = INFINITY, high = 0;
	for (uint32_t i = 0; i < bones; i++) {
		const struct lod_raw_bone *raw = &tube->bones[bone[i]];
		double length = bone_length(tube, raw),
			width = width_of(tube, chain + i, 1, raw->area, length, strip);
		double ring = fmax(tube->joints[chain[i]].ring, tube->joints[chain[i + 1]].ring) / (strip ? 1
			: LOD_PI);
		if (bones > 1 && lod_v3_distance(a, b) < 0.5 * length)
			return false;
		/* A bone shorter than wide has a length, and so a width, that the tilt of its rings
		 * decides. */
		if (length < ring)
			width = ring;
		low = fmin(low, width);
		high = fmax(high, width);
	}
	for (uint32_t i = 1; i < bones; i++)
		if (distance_to(tube->joints[chain[i]].place, a, b) > OFF_CHORD * low)
			return false;
	return high <= SIMILAR * low;
}

double lod_bone_away(const struct lod_bone *bone, struct lod_v3 point)
{
	return distance_to(point, bone->end[0], bone->end[1]) - bone->width / 2;
}

struct lines { struct lod_bones *bones; uint32_t capacity, span_capacity; struct lod_arena *arena; };

/* `items`, with room for one more than `count`. */
static void *grown(struct lines *lines, void *items, uint32_t count, uint32_t *capacity, size_t size)
{
	if (count < *capacity)
		return items;
	*capacity = *capacity ? 2 * *capacity : 1024;
	void *bigger = lod_arena_take(lines->arena, *capacity, size);
	if (count)
		memcpy(bigger, items, count * size);
	return bigger;
}

static struct lod_bone *add(struct lines *lines)
{
	struct lod_bones *out = lines->bones;
	out->items = grown(lines, out->items, out->count, &lines->capacity, sizeof *out->items);
	return &out->items[out->count++];
}

static void add_line(struct lines *lines, const struct lod_tube *tube, uint32_t component,
	const uint32_t *chain, const uint32_t *bone, uint32_t bones, bool strip)
{
	struct lod_v3 a = tube->joints[chain[0]].place, b = tube->joints[chain[bones]].place;
	double area = 0, length = lod_v3_distance(a, b);
	for (uint32_t i = 0; i < bones; i++) {
		area += tube->bones[bone[i]].area;
		tube->bones[bone[i]].line = lines->bones->count;
	}
	double width = width_of(tube, chain, bones, area, length, strip);
	*add(lines) = (struct lod_bone){ .end = { a, b }, .width = width, .component = component };
}

/* Walks from joint `start` along bone `next` to the next end or fork, and lays lines as long as possible. */
static void lay_chain(struct lod_tube *tube, struct lines *lines, uint32_t component, uint32_t start,
	uint32_t next, bool strip)
{
	uint32_t chain[CHAIN_MAX + 2] = { start }, bone[CHAIN_MAX + 1], n = 0;
	for (;;) {
		if (next != ECO_NONE) {
			const struct lod_raw_bone *raw = &tube->bones[next];
			bone[n++] = next;
			chain[n] = raw->joint[0] == chain[n - 1] ? raw->joint[1] : raw->joint[0];
			tube->bones[next].line = UINT32_MAX - 1;         /* walked */
		}
		bool fits = next != ECO_NONE && n <= CHAIN_MAX && straight(tube, chain, bone, n, strip);
		if (!fits && n > 1) {
			uint32_t keep = next == ECO_NONE ? n : n - 1;
			add_line(lines, tube, component, chain, bone, keep, strip);
			memmove(chain, chain + keep, (n - keep + 1) * sizeof *chain);
			memmove(bone, bone + keep, (n - keep) * sizeof *bone);
			n -= keep;
		} else if (!fits && n == 1 && next == ECO_NONE) {
			add_line(lines, tube, component, chain, bone, 1, strip);
			n = 0;
		}
		if (next == ECO_NONE)
			return;
		const struct lod_joint *last = &tube->joints[chain[n]];
		next = ECO_NONE;
		if (last->degree == 2)
			for (int k = 1; k >= 0; k--)
				next = tube->bones[last->bone[k]].line == ECO_NONE ? last->bone[k] : next;
	}
}

static void lay_lines(struct lod_tube *tube, struct lines *lines, uint32_t component)
{
	double open = 0, rings = 0;
	for (uint32_t j = 0; j < tube->joint_count; j++) {
		rings += tube->joints[j].ring > 0;
		open += tube->joints[j].open > 0;
	}
	bool strip = open > 0.5 * rings;
	/* Chains start at ends and forks; the remaining bones form closed loops. */
	for (int loops = 0; loops < 2; loops++)
		for (uint32_t b = 0; b < tube->bone_count; b++)
			for (int k = 0; k < 2; k++) {
				const struct lod_raw_bone *bone = &tube->bones[b];
				if (bone->merged == ECO_NONE && bone->line == ECO_NONE
						&& (loops || tube->joints[bone->joint[k]].degree != 2))
					lay_chain(tube, lines, component, bone->joint[k], b, strip);
			}
}

/* The lines through each piece p of a slab: line[first[p] .. first[p + 1]). `spanned`, per line from `own`
 * on: 1 + the last triangle that has a span of it. */
struct through { uint32_t *first, *line, *spanned, own; };

static struct through find_lines(struct lod_tube *tube, const struct lod_bones *bones, uint32_t own,
	struct lod_arena *arena)
{
	uint32_t most = tube->offset[tube->triangle_count],
		*first = lod_arena_take(arena, (size_t)most + 2, sizeof *first);
	uint32_t *line = lod_arena_take(arena, tube->bone_count, sizeof *line);
	for (uint32_t b = 0; b < tube->bone_count; b++)
		first[tube->bones[b].piece + 2]++;
	for (uint32_t p = 2; p <= most + 1; p++)
		first[p] += first[p - 1];
	for (uint32_t b = 0; b < tube->bone_count; b++) {
		uint32_t into = b;
		while (tube->bones[into].merged != ECO_NONE)
			into = tube->bones[into].merged;
		line[first[tube->bones[b].piece + 1]++] = tube->bones[into].line;
	}
	return (struct through){ first, line, lod_arena_take(arena, bones->count - own, sizeof *line), own };
}

/* The nearest line through a piece, and how far `p` is from its surface; ECO_NONE if there is none. */
static uint32_t nearest_line(const struct through *through, const struct lod_bones *bones, uint32_t piece,
	struct lod_v3 p, double *away)
{
	uint32_t nearest = ECO_NONE;
	*away = INFINITY;
	for (uint32_t i = through->first[piece]; i < through->first[piece + 1]; i++) {
		double d = lod_bone_away(&bones->items[through->line[i]], p);
		if (d < *away) {
			*away = d;
			nearest = through->line[i];
		}
	}
	return nearest;
}

/* Error and colour: each vertex counts for the nearest line through its piece; lines from `own` on are this
 * component's. */
static void measure(struct lod_tube *tube, const struct through *through, struct lod_bones *bones,
	uint32_t own, const struct lod_organs *organs, struct lod_arena *arena)
{
	struct lod_light *light = lod_arena_take(arena, bones->count - own, sizeof *light);
	for (uint32_t t = 0; t < tube->triangle_count; t++)
		for (uint32_t k = 0; k < 3; k++) {
			double away;
			uint32_t line = nearest_line(through, bones, lod_tube_piece_at(tube, t, k),
				lod_tube_place(tube, tube->corner[3 * t + k]), &away);
			if (line == ECO_NONE)
				continue;
			bones->items[line].error = fmax(bones->items[line].error, away);
			lod_light_add(&light[line - own], organs->rgb[tube->member[t]],
				organs->area[tube->member[t]]);
		}
	for (uint32_t i = own; i < bones->count; i++) {
		memcpy(bones->items[i].rgb, organs->components[bones->items[i].component].rgb, 3);
		lod_light_mean(&light[i - own], bones->items[i].rgb);
	}
}

/* ---- Spans ---- */

/* Triangle t of the mesh lies along line `bone`, between the least and the greatest place of its corners. */
static void add_span(struct lines *lines, const struct lod_mesh *mesh, uint32_t bone, uint32_t t)
{
	struct lod_bones *out = lines->bones;
	const struct lod_bone *line = &out->items[bone];
	struct lod_v3 along = lod_v3_sub(line->end[1], line->end[0]);
	double l2 = lod_v3_dot(along, along), from = 1, to = 0;
	for (uint32_t k = 0; k < 3; k++) {
		double at = l2 > 0 ? lod_v3_dot(lod_v3_sub(lod_mesh_corner(mesh, t, k), line->end[0]), along) / l2
			: 0;
		from = fmin(from, fmax(at, 0));
		to = fmax(to, fmin(at, 1));
	}
	out->spans = grown(lines, out->spans, out->span_count, &lines->span_capacity, sizeof *out->spans);
	out->spans[out->span_count++] = (struct lod_bone_span){ bone, t, (float)from, (float)to };
}

/* Spans of triangle t: lines of all pieces that it reaches into. */
static void add_spans(struct lines *lines, struct lod_tube *tube, const struct through *through, uint32_t t)
{
	for (uint32_t f = tube->offset[t]; f < tube->offset[t + 1]; f++) {
		uint32_t piece = lod_tube_piece(tube, f);
		for (uint32_t i = through->first[piece]; i < through->first[piece + 1]; i++) {
			uint32_t *spanned = &through->spanned[through->line[i] - through->own];
			if (*spanned != t + 1)
				add_span(lines, tube->mesh, through->line[i], tube->member[t]);
			*spanned = t + 1;
		}
	}
}

/* ---- Things ---- */

/* A triangle's area, never 0, so that sums of areas divide. */
static double area_of(const struct lod_mesh *mesh, uint32_t t)
{
	return lod_v3_length(lod_mesh_area_normal(mesh, t)) + 1e-30;
}

/* The least-squares line of a thing's middle along an axis, from end to end of its box: stems lean. */
static void fit_line(struct lod_bone *line, const struct lod_mesh *mesh, const struct lod_component *c,
	int axis)
{
	double area = 0, along = 0, square = 0;
	struct lod_v3 place = { 0, 0, 0 }, product = { 0, 0, 0 };
	for (uint32_t i = mesh->member_first[line->component]; i < mesh->member_first[line->component + 1];
			i++) {
		uint32_t t = mesh->member[i];
		struct lod_v3 sum = lod_v3_add(lod_mesh_corner(mesh, t, 0),
			lod_v3_add(lod_mesh_corner(mesh, t, 1), lod_mesh_corner(mesh, t, 2)));
		struct lod_v3 weighed = lod_v3_scale(sum, area_of(mesh, t) / 3);
		double at = lod_v3_axis(sum, axis) / 3;
		area += area_of(mesh, t);
		along += area_of(mesh, t) * at;
		square += area_of(mesh, t) * at * at;
		place = lod_v3_add(place, weighed);
		product = lod_v3_add(product, lod_v3_scale(weighed, at));
	}
	struct lod_v3 middle = lod_v3_scale(place, 1 / area);
	double spread = square - along * along / area;
	struct lod_v3 slope = lod_v3_scale(lod_v3_sub(product, lod_v3_scale(place, along / area)),
		spread > 0 ? 1 / spread : 0);
	for (int k = 0; k < 2; k++)
		line->end[k] =
			lod_v3_add(middle, lod_v3_scale(slope, (k ? c->high : c->low)[axis] - along / area));
}

static struct lod_v3 away(struct lod_v3 p, const struct lod_bone *line)
{
	struct lod_v3 ab = lod_v3_sub(line->end[1], line->end[0]), ap = lod_v3_sub(p, line->end[0]);
	double l2 = lod_v3_dot(ab, ab);
	return lod_v3_sub(ap, lod_v3_scale(ab, l2 > 0 ? lod_v3_dot(ap, ab) / l2 : 0));
}

/* A thing without a skeleton: one line along the longest side of its box, as wide as a tube whose surface is
 * as far from it. */
static void lay_thing(struct lines *lines, const struct lod_mesh *mesh, const struct lod_component *c,
	uint32_t component)
{
	int axis = 0;
	double area = 0, square = 0;
	for (int a = 1; a < 3; a++)
		axis = c->high[a] - c->low[a] > c->high[axis] - c->low[axis] ? a : axis;
	struct lod_bone *line = add(lines);
	*line = (struct lod_bone){ .component = component };
	memcpy(line->rgb, c->rgb, 3);
	fit_line(line, mesh, c, axis);
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++) {
		uint32_t t = mesh->member[i];
		struct lod_v3 a = away(lod_mesh_corner(mesh, t, 0), line),
			b = away(lod_mesh_corner(mesh, t, 1), line),
			d = away(lod_mesh_corner(mesh, t, 2), line);
		struct lod_v3 sum = lod_v3_add(a, lod_v3_add(b, d));
		area += area_of(mesh, t);
		square += area_of(mesh, t) * (lod_v3_dot(a, a) + lod_v3_dot(b, b) + lod_v3_dot(d, d)
			+ lod_v3_dot(sum, sum)) / 12;
	}
	line->width = 2 * sqrt(square / area);
	for (uint32_t i = mesh->member_first[component]; i < mesh->member_first[component + 1]; i++) {
		for (uint32_t k = 0; k < 3; k++)
			line->error = fmax(line->error,
				lod_bone_away(line, lod_mesh_corner(mesh, mesh->member[i], k)));
		add_span(lines, mesh, lines->bones->count - 1, mesh->member[i]);
	}
}

/* ---- All ---- */

/* Lines accumulate in the caller's arena; each component's work is freed at once, so it has an arena of its
 * own. */
void lod_bones_make(struct lod_bones *bones, const struct lod_mesh *mesh, const struct lod_organs *organs,
	struct lod_arena *arena)
{
	*bones = (struct lod_bones){ .count = 0 };
	struct lod_arena scratch = { 0 };
	struct lines *lines = lod_arena_take(arena, 1, sizeof *lines);
	*lines = (struct lines){ .bones = bones, .arena = arena };
	uint32_t *local = lod_arena_take(arena, mesh->vertex_count, sizeof *local);
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		struct lod_tube tube;
		uint32_t own = bones->count;
		if (organs->components[c].organ != ECO_ORGAN_WOOD)
			continue;
		if (organs->components[c].stout) {
			lay_thing(lines, mesh, &organs->components[c], c);
			continue;
		}
		lod_tube_make(&tube, mesh, organs, c, local, &scratch);
		lay_lines(&tube, lines, c);
		struct through through = find_lines(&tube, bones, own, &scratch);
		measure(&tube, &through, bones, own, organs, &scratch);
		for (uint32_t t = 0; t < tube.triangle_count; t++)
			add_spans(lines, &tube, &through, t);
		lod_arena_free(&scratch);
	}
}

void lod_bones_sort(struct lod_bones *bones, uint32_t seed, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *by = lod_arena_take(arena, bones->count, sizeof *by);
	struct lod_bone *copy = lod_arena_take(arena, bones->count, sizeof *copy);
	for (uint32_t i = 0; i < bones->count; i++) {
		const struct lod_bone *b = &bones->items[i];
		double size = lod_v3_distance(b->end[0], b->end[1]) * b->width;
		/* Half octaves, descending by the complement: the exponent and the first bit of the fraction
		 * of a double. */
		uint64_t octave = ~lod_sort_key(size) >> 51;
		by[i] = (struct lod_keyed){ octave << 32 | (uint32_t)lod_mix(lod_mix(seed) + i), i };
	}
	lod_sort(arena, by, bones->count);
	uint32_t *place = lod_arena_take(arena, bones->count, sizeof *place);
	for (uint32_t i = 0; i < bones->count; i++) {
		copy[i] = bones->items[by[i].value];
		place[by[i].value] = i;
	}
	if (bones->count)
		memcpy(bones->items, copy, bones->count * sizeof *copy);
	for (uint32_t i = 0; i < bones->span_count; i++)
		bones->spans[i].bone = place[bones->spans[i].bone];
	lod_arena_release(arena, mark);
}
