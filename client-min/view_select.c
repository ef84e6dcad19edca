/* The walk is the server's, repeated: every instance of every run, its anchors and bands in the shared
 * arithmetic of lod/eye.h, and for each the cuts that name the anchor, the band and the share. */
#include "client-min/view_select.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "client-min/view_record.h"
#include "ecofiles/base/angle16.h"
#include "ecofiles/base/array_grow.h"
#include "lod/tint.h"

#define INSTANCES_MAX (1u << 28)        /* looked at, seen or not */
#define PAIRS_MAX (1u << 30)            /* of an instance and a cut */

const char *const view_role_names[VIEW_ROLE_COUNT] = { "triangles", "simpler triangles", "lines", "points",
	"blended triangles", "blended simpler triangles", "blended lines", "blended points", "ellipsoids",
	"impostors", "summaries" };

struct walk {
	struct view_selection *out;
	const struct view_store *store;
	const struct eco_plan *plan;
	const struct lod_eye *eye;
	bool casters;                    /* also those out of sight */
	struct view_table anchors;       /* anchor -> its first cut */
	struct view_table gates;         /* plant -> end */
	struct lod_anchor_band *seen;
	uint32_t instance_room, first_room, pair_room, pair_count;
	uint64_t looked;
	struct eco_error *error;
};

static enum eco_code no_memory(struct walk *w)
{
	return eco_no_memory(w->error, "the plants in view");
}

/* ---- Cuts by anchor ---- */

/* A plan's rules are sorted by anchor (eco_plan_sort). */
static enum eco_code index_cuts(struct walk *w)
{
	const struct eco_plan *plan = w->plan;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if ((i == 0 || plan->cuts[i - 1].anchor != plan->cuts[i].anchor)
				&& !view_table_put(&w->anchors, plan->cuts[i].anchor, i))
			return no_memory(w);
	for (uint32_t i = 0; i < plan->gate_count; i++)
		if (!view_table_put(&w->gates, plan->gates[i].plant, plan->gates[i].end))
			return no_memory(w);
	return ECO_OK;
}

static const struct eco_list *list_of(const struct walk *w, const struct eco_cut *cut)
{
	return &view_store_list(w->store, cut->list)->list;
}

static enum view_role plain_role(const struct walk *w, const struct eco_cut *cut)
{
	switch (list_of(w, cut)->kind) {
	case ECO_LIST_LINES:
		return VIEW_ROLE_LINES;
	case ECO_LIST_POINTS:
		return cut->anchor == ECO_NONE ? VIEW_ROLE_SUMMARY : list_of(w, cut)->attributes
			& ECO_ATTR_SPLAT ? VIEW_ROLE_SPLATS : VIEW_ROLE_POINTS;
	case ECO_LIST_IMPOSTOR:
		return VIEW_ROLE_IMPOSTORS;
	default:
		return list_of(w, cut)->partner == ECO_NONE ? VIEW_ROLE_TRIANGLES : VIEW_ROLE_SIMPLE;
	}
}

static uint8_t blend_role(uint8_t role)
{
	static const uint8_t blend[VIEW_ROLE_COUNT] = { [VIEW_ROLE_TRIANGLES] = VIEW_ROLE_BLEND_TRIANGLES,
		[VIEW_ROLE_SIMPLE] = VIEW_ROLE_BLEND_SIMPLE, [VIEW_ROLE_LINES] = VIEW_ROLE_BLEND_LINES,
		[VIEW_ROLE_POINTS] = VIEW_ROLE_BLEND_POINTS };
	return blend[role] ? blend[role] : role;
}

/* The list whose elements a cut draws, in one form or another. */
static uint32_t elements_of(const struct walk *w, const struct eco_cut *cut)
{
	uint32_t partner = list_of(w, cut)->partner;
	return partner == ECO_NONE ? cut->list : partner;
}

static bool same_plants(const struct eco_cut *a, const struct eco_cut *b)
{
	return a->anchor == b->anchor && a->band_first == b->band_first && a->band_end == b->band_end
		&& a->share_first == b->share_first && a->share_end == b->share_end;
}

/* Two cuts are a blend if one draws the first elements of a list and the other, in another form, those from
 * some element on. */
static void find_roles(struct walk *w)
{
	const struct eco_cut *cuts = w->plan->cuts;
	uint32_t n = w->plan->cut_count;
	for (uint32_t i = 0; i < n; i++)
		w->out->roles[i] = (uint8_t)plain_role(w, &cuts[i]);
	for (uint32_t i = 0; i < n; i++) {
		const struct eco_cut *rest = &cuts[i];
		if (rest->anchor == ECO_NONE || !rest->first)
			continue;
		uint32_t from = view_table_get(&w->anchors, rest->anchor);
		for (uint32_t j = from; j < n && cuts[j].anchor == rest->anchor; j++) {
			const struct eco_cut *front = &cuts[j];
			if (front->first || front->list == rest->list || !same_plants(front, rest)
					|| elements_of(w, front) != elements_of(w, rest))
				continue;
			w->out->roles[i] = blend_role(w->out->roles[i]);
			w->out->roles[j] = blend_role(w->out->roles[j]);
		}
	}
}

/* ---- Instances ---- */

static enum eco_code add_instance(struct walk *w, const struct view_instance *instance)
{
	struct view_selection *out = w->out;
	if (!eco_array_grow(&out->instances, &w->instance_room, out->instance_count, sizeof *out->instances)
			|| !eco_array_grow(&out->cut_first, &w->first_room, out->instance_count + 1,
			sizeof *out->cut_first))
		return no_memory(w);
	out->cut_first[out->instance_count] = w->pair_count;
	out->instances[out->instance_count++] = *instance;
	return ECO_OK;
}

static enum eco_code add_pair(struct walk *w, uint32_t cut)
{
	const struct eco_cut *c = &w->plan->cuts[cut];
	if (w->pair_count >= PAIRS_MAX || !eco_array_grow(&w->out->cuts, &w->pair_room, w->pair_count,
			sizeof *w->out->cuts))
		return no_memory(w);
	w->out->cuts[w->pair_count++] = cut;
	w->out->vertices += eco_cut_vertices(c, &view_store_list(w->store, c->list)->list);
	w->out->member_first[cut + 1]++;
	return ECO_OK;
}

/* The band nearest to the anchor's that some cut is for, of those from `from` on: out of sight a plant may be
 * in a band that no cut is for. */
static uint8_t caster_band(const struct walk *w, const struct lod_anchor_band *seen, uint32_t from)
{
	const struct eco_cut *cuts = w->plan->cuts;
	uint32_t i = view_table_get(&w->anchors, seen->anchor), band = seen->band, least = UINT32_MAX;
	for (; i < w->plan->cut_count && cuts[i].anchor == seen->anchor && least; i++) {
		const struct eco_cut *cut = &cuts[i];
		if (cut->band_end <= from)
			continue;
		uint32_t first = cut->band_first > from ? cut->band_first : from, nearest = seen->band < first ? first
			: seen->band >= cut->band_end ? cut->band_end - 1u : seen->band;
		uint32_t off = nearest > seen->band ? nearest - seen->band : seen->band - nearest;
		band = off < least ? nearest : band;
		least = off < least ? off : least;
	}
	return (uint8_t)band;
}

static enum eco_code add_cuts(struct walk *w, const struct lod_anchor_band *seen, uint32_t hash)
{
	const struct eco_cut *cuts = w->plan->cuts;
	uint32_t i = view_table_get(&w->anchors, seen->anchor);
	for (; i < w->plan->cut_count && cuts[i].anchor == seen->anchor; i++) {
		const struct eco_cut *cut = &cuts[i];
		if (seen->band >= cut->band_first && seen->band < cut->band_end && hash >= cut->share_first
				&& hash < cut->share_end) {
			ECO_PASS(add_pair(w, i));
		}
	}
	return ECO_OK;
}

/* The cuts of a plant that casts a shadow. Cells out of sight are seldom held. If one is not, the whole plant
 * casts too, as it is drawn beyond its gate. */
static enum eco_code add_caster(struct walk *w, uint32_t count, uint32_t hash, uint32_t gate)
{
	struct lod_anchor_band whole = w->seen[0];
	bool all = true;
	for (uint32_t s = 0; s < count; s++) {
		all = all && view_table_get(&w->anchors, w->seen[s].anchor) != UINT32_MAX;
		w->seen[s].band = caster_band(w, &w->seen[s], 0);
		ECO_PASS(add_cuts(w, &w->seen[s], hash));
	}
	if (all)
		return ECO_OK;
	whole.band = caster_band(w, &whole, (gate + ECO_SHARE_ONE - 1) / ECO_SHARE_ONE);
	return add_cuts(w, &whole, hash);
}

static double distance_m(const struct lod_eye *eye, const double p[3])
{
	double x = p[0] - eye->at[0], y = p[1] - eye->at[1], z = p[2] - eye->at[2];
	return sqrt(x * x + y * y + z * z);
}

static uint32_t tint_of(const struct view_list *list, const struct view_plant *plant, uint8_t code)
{
	uint32_t rgb = code && code <= list->list.palette_count ? lod_tint_word(list->palette[code - 1]) : 0;
	return rgb && !plant->plant.leaf_width ? rgb | LOD_TINT_WHOLE : rgb;
}

static enum eco_code walk_group(struct walk *w, const struct eco_placement *placement, uint32_t left,
	const struct view_list *list, const struct eco_group *group)
{
	const struct view_plant *plant = view_store_plant(w->store, group->plant);
	if (!plant)
		return eco_fail(w->error, ECO_DAMAGED, "the plan draws plants %u of list %u, which were not "
			"described", group->plant, list->id);
	w->looked += group->count;
	if (w->looked > INSTANCES_MAX)
		return eco_fail(w->error, ECO_TOO_LARGE, "the plan looks at more than %u plants",
			INSTANCES_MAX);
	void *seen = realloc(w->seen, plant->anchor_count * sizeof *w->seen);
	if (!seen)
		return no_memory(w);
	w->seen = seen;
	uint32_t gate = view_table_get(&w->gates, group->plant);
	gate = gate == UINT32_MAX ? 0 : gate;
	uint32_t key = eco_owner_leaf(list->list.owner) + placement->path;
	for (uint32_t i = group->first; i < group->first + group->count; i++) {
		struct eco_place place = eco_place_of(&list->list, &list->elements, i);
		struct view_instance instance = { .plant = group->plant, .path = placement->path,
			.tint = tint_of(list, plant, place.tint), .list = list->id, .index = i };
		lod_place_instance(&instance.place, placement, &list->list, &place);
		instance.hash = lod_share_hash(placement->path, list->id, i);
		instance.place.salt = instance.hash & 0xFFFF;
		if (lod_open_hash(instance.hash) < left)
			continue;
		uint32_t count = lod_instance_anchors(w->eye, &instance.place, plant->anchors,
			plant->plant.anchor_first, plant->anchor_count, gate, instance.hash, w->seen);
		if (!count)
			continue;
		double center[3];
		lod_place_point(&instance.place, plant->anchors[0].center, center);
		instance.distance_m = distance_m(w->eye, center);
		instance.owner = eco_owner_instance(key, group->plant, i);
		uint8_t band = w->seen[0].band;
		enum eco_code code = add_instance(w, &instance);
		if (!code && w->casters)
			code = add_caster(w, count, instance.hash, gate);
		for (uint32_t s = 0; s < count && !w->casters && !code; s++)
			code = add_cuts(w, &w->seen[s], instance.hash);
		if (code)
			return code;
		w->out->visible_plants++;
		w->out->coarse += plant->plant.anchor_count > 1
			&& eco_gate_place(band, instance.hash) >= gate;
	}
	return ECO_OK;
}

static enum eco_code walk_list(struct walk *w, const struct eco_placement *placement, uint32_t left,
	const struct view_list *list)
{
	if (list->list.kind != ECO_LIST_INSTANCES
			|| list->elements.primitive_count != list->list.primitive_count)
		return eco_fail(w->error, ECO_DAMAGED, "the plan draws the plants of list %u, which were "
			"not all sent", list->id);
	for (uint32_t i = 0; i < list->list.group_count; i++)
		ECO_PASS(walk_group(w, placement, left, list, &list->groups[i]));
	return ECO_OK;
}

static enum eco_code walk_once(struct walk *w, uint32_t cut)
{
	const struct eco_placement *p = &w->plan->placements[w->plan->cuts[cut].placement];
	struct view_instance instance = { .plant = ECO_NONE, .path = p->path };
	memcpy(instance.place.at, p->at, sizeof p->at);
	eco_angle16_sincos(p->turn, &instance.place.sine, &instance.place.cosine);
	instance.place.scale = p->scale;
	enum eco_code code = add_instance(w, &instance);
	w->out->coarse++;
	return code ? code : add_pair(w, cut);
}

/* member_first counts so far, one place to the right; sums make it the table of contents, and a pass over the
 * pairs fills it. */
static enum eco_code finish(struct walk *w)
{
	struct view_selection *out = w->out;
	if (!eco_array_grow(&out->cut_first, &w->first_room, out->instance_count, sizeof *out->cut_first))
		return no_memory(w);
	out->cut_first[out->instance_count] = w->pair_count;
	for (uint32_t c = 0; c < out->cut_count; c++)
		out->member_first[c + 1] += out->member_first[c];
	out->members = malloc(((size_t)w->pair_count + 1) * sizeof *out->members);
	uint32_t *next = malloc(((size_t)out->cut_count + 1) * sizeof *next);
	if (!out->members || !next) {
		free(next);
		return no_memory(w);
	}
	memcpy(next, out->member_first, ((size_t)out->cut_count + 1) * sizeof *next);
	for (uint32_t i = 0; i < out->instance_count; i++)
		for (uint32_t p = out->cut_first[i]; p < out->cut_first[i + 1]; p++)
			out->members[next[out->cuts[p]]++] = i;
	free(next);
	if (out->vertices != w->plan->vertices && !w->casters)
		return eco_fail(w->error, ECO_DAMAGED, "the plan promises %llu vertices, drawing it comes "
			"to %llu: server and client disagree", (unsigned long long)w->plan->vertices,
			(unsigned long long)out->vertices);
	return ECO_OK;
}

static enum eco_code walk_runs(struct walk *w)
{
	const struct eco_plan *plan = w->plan;
	for (uint32_t r = 0; r < plan->run_count; r++)
		for (uint32_t id = plan->runs[r].list_first; id < plan->runs[r].list_end; id++) {
			const struct view_list *list = view_store_list(w->store, id);
			if (!list)
				return eco_fail(w->error, ECO_DAMAGED,
					"the plan draws the plants of list %u, which was not sent", id);
			ECO_PASS(walk_list(w, &plan->placements[plan->runs[r].placement],
				plan->runs[r].left, list));
		}
	return ECO_OK;
}

static enum eco_code make(struct view_selection *selection, const struct view_store *store,
	const struct lod_eye *eye, bool casters, struct eco_error *error)
{
	static const struct eco_plan nothing;
	*selection = (struct view_selection){ 0 };
	struct walk w = { .out = selection, .store = store, .plan = view_store_plan(store), .eye = eye,
		.casters = casters, .error = error };
	if (!w.plan)
		w.plan = &nothing;
	selection->cut_count = w.plan->cut_count;
	selection->roles = calloc(w.plan->cut_count + 1, sizeof *selection->roles);
	selection->member_first = calloc((size_t)w.plan->cut_count + 2, sizeof *selection->member_first);
	selection->plan_cuts = malloc((w.plan->cut_count + 1) * sizeof *selection->plan_cuts);
	enum eco_code code = selection->roles && selection->member_first && selection->plan_cuts
		? index_cuts(&w) : no_memory(&w);
	if (!code) {
		if (w.plan->cut_count)
			memcpy(selection->plan_cuts, w.plan->cuts, w.plan->cut_count * sizeof *w.plan->cuts);
		find_roles(&w);
		code = walk_runs(&w);
	}
	for (uint32_t c = 0; c < w.plan->cut_count && !code; c++)
		if (w.plan->cuts[c].anchor == ECO_NONE
				&& eco_list_vertices(&view_store_list(store, w.plan->cuts[c].list)->list))
			code = walk_once(&w, c);
	if (!code && !casters)
		code = view_ground_make(&selection->ground, store, eye, error);
	if (!code)
		code = view_image_make(&selection->image, store, error);
	if (!code)
		code = finish(&w);
	free(w.seen);
	view_table_free(&w.anchors);
	view_table_free(&w.gates);
	if (code)
		view_select_free(selection);
	return code;
}

enum eco_code view_select_make(struct view_selection *selection, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error)
{
	return make(selection, store, eye, false, error);
}

enum eco_code view_select_casters(struct view_selection *selection, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error)
{
	struct lod_eye all = *eye;
	memset(all.side, 0, sizeof all.side);    /* planes that nothing is beyond */
	memset(all.forward, 0, sizeof all.forward);
	return make(selection, store, &all, true, error);
}

void view_select_free(struct view_selection *selection)
{
	eco_free(selection->instances, selection->cut_first, selection->cuts, selection->member_first,
		selection->members, selection->roles, selection->plan_cuts);
	view_ground_free(&selection->ground);
	view_image_free(&selection->image);
	*selection = (struct view_selection){ 0 };
}

uint64_t view_summary_owner(const struct view_list *list, uint32_t index, uint32_t path)
{
	const int32_t *extra = list->elements.extra + (size_t)index * list->elements.extra_count
		+ eco_list_extra_at(&list->list, ECO_ATTR_PLANT);
	return eco_owner_summary((uint32_t)extra[1] + eco_owner_leaf(list->list.owner) + path,
		(uint32_t)extra[0]);
}

bool view_owners_make(struct view_table *owners, const struct view_selection *selection)
{
	bool good = true;
	*owners = (struct view_table){ 0 };
	for (uint32_t i = 0; i < selection->instance_count && good; i++)
		good = view_table_get(owners, selection->instances[i].owner) != UINT32_MAX
			|| view_table_put(owners, selection->instances[i].owner, i);
	return good;
}

const struct view_instance *view_owners_find(const struct view_table *owners,
	const struct view_selection *selection, uint64_t owner)
{
	uint32_t index = view_table_get(owners, owner);
	return index == UINT32_MAX ? NULL : &selection->instances[index];
}

/* ---- Digests ---- */

static uint64_t hash(uint64_t before, const void *bytes, size_t size)
{
	return size ? XXH3_64bits_withSeed(bytes, size, before) : before;
}

static uint64_t hash_word(uint64_t before, uint64_t word)
{
	return hash(before, &word, sizeof word);
}

static uint64_t hash_elements(uint64_t h, const struct eco_elements *e)
{
	h = hash_word(hash_word(h, e->element_count), e->primitive_count);
	h = hash(h, e->corners, e->element_count);
	h = hash(h, e->position, (size_t)e->corner_count * 3 * sizeof *e->position);
	if (e->uv)
		h = hash(h, e->uv, (size_t)e->corner_count * 2 * sizeof *e->uv);
	return hash(h, e->extra, (size_t)e->element_count * e->extra_count * sizeof *e->extra);
}

static uint64_t hash_part(uint64_t h, const struct eco_texture_part *part)
{
	h = hash_word(hash_word(h, part->width), part->height);
	return part->texels ? hash(h, part->texels, (size_t)part->width * part->height * part->channels) : h;
}

static enum eco_code hash_impostor(uint64_t *h, const struct lod_impostor *impostor, struct eco_error *error)
{
	uint32_t texels = view_impostor_texels(impostor), *words = malloc((size_t)texels * 16 + 1);
	if (!words)
		return eco_no_memory(error, "a digest");
	view_impostor_write(impostor, words);
	*h = hash(*h, words, (size_t)texels * 16);
	free(words);
	return ECO_OK;
}

static enum eco_code hash_list(uint64_t *h, const struct view_list *list, struct eco_error *error)
{
	*h = hash_word(hash_word(*h, list->id), list->chunk_count);
	*h = hash(*h, list->palette, (size_t)list->list.palette_count * 3);
	*h = hash_elements(*h, &list->elements);
	for (uint32_t i = 0; list->parts && i < list->list.primitive_count; i++)
		*h = hash_part(*h, &list->parts[i]);
	for (uint32_t i = 0; list->impostors && i < list->chunk_count; i++)
		ECO_PASS(hash_impostor(h, &list->impostors[i], error));
	return ECO_OK;
}

static uint64_t hash_instance(uint64_t h, const struct view_instance *p)
{
	const double place[7] = { p->place.at[0], p->place.at[1], p->place.at[2], p->place.sine,
		p->place.cosine, p->place.scale, lod_place_width(&p->place) };
	h = hash(h, place, sizeof place);
	h = hash_word(hash_word(h, p->owner), (uint64_t)p->hash << 32 | p->plant);
	return p->tint ? hash_word(h, p->tint) : h;
}

static uint64_t hash_cut(uint64_t h, const struct eco_cut *cut)
{
	h = hash_word(h, (uint64_t)cut->list << 32 | cut->anchor);
	h = hash_word(h, (uint64_t)cut->first << 32 | cut->end);
	h = hash_word(h, cut->halvings);
	return hash(h, &cut->scale, sizeof cut->scale);
}

static uint64_t hash_drawn(const struct view_selection *s)
{
	uint64_t h = hash_word(0, s->vertices);
	for (uint32_t i = 0; i < s->instance_count; i++)
		h = hash_instance(h, &s->instances[i]);
	for (uint32_t c = 0; c < s->cut_count; c++) {
		h = hash_cut(h, &s->plan_cuts[c]);
		h = hash(h, s->members + s->member_first[c],
			(size_t)(s->member_first[c + 1] - s->member_first[c]) * sizeof *s->members);
	}
	return h;
}

enum eco_code view_digest_write(char out[VIEW_DIGEST_BYTES], const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error)
{
	uint64_t held = 0;               /* a sum: lists may have come in any order */
	for (uint32_t i = 0; i < view_store_list_count(store); i++) {
		uint64_t one = 0;
		ECO_PASS(hash_list(&one, view_store_list_at(store, i), error));
		held += one;
	}
	snprintf(out, VIEW_DIGEST_BYTES, "%016llx-%016llx", (unsigned long long)held,
		(unsigned long long)hash_drawn(selection));
	return ECO_OK;
}

/* ---- The sun ---- */

#define DEGREE (3.14159265358979323846 / 180)
#define J2000_S 946728000.0              /* noon of 2000-01-01, in unix seconds */

void view_sun_at(const struct view_sun_place *place, double unix_s, float sun[3])
{
	double n = (unix_s - J2000_S) / 86400;
	double anomaly = (357.528 + 0.9856003 * n) * DEGREE;
	double along = (280.460 + 0.9856474 * n + 1.915 * sin(anomaly) + 0.020 * sin(2 * anomaly)) * DEGREE,
		tilt = (23.439 - 0.0000004 * n) * DEGREE;
	double ascension = atan2(cos(tilt) * sin(along), cos(along)),
		declination = asin(sin(tilt) * sin(along));
	double sidereal = fmod(18.697374558 + 24.06570982441908 * n, 24) * 15 + place->longitude_deg;
	double hour = sidereal * DEGREE - ascension, latitude = place->latitude_deg * DEGREE;
	double up = sin(latitude) * sin(declination) + cos(latitude) * cos(declination) * cos(hour);
	double east = -cos(declination) * sin(hour),
		north = cos(latitude) * sin(declination) - sin(latitude) * cos(declination) * cos(hour);
	/* the map's north is turned clockwise */
	double turn = place->convergence_deg * DEGREE;
	sun[0] = (float)(east * cos(turn) - north * sin(turn));
	sun[1] = (float)(north * cos(turn) + east * sin(turn));
	sun[2] = (float)up;
}

void view_sun_usual(const struct view_sun_place *place, float sun[3])
{
	/* 10:00 UTC of 2000-12-21 and 2000-06-21; four minutes a degree */
	double unix_s = place->latitude_deg < 0 ? 977392800 : 961581600;
	view_sun_at(place, unix_s - place->longitude_deg * 240, sun);
}
