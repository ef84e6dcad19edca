#include "tests/bench/baseline/paper_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_measure.h"
#include "ecofiles/format/chunk/chunk.h"
#include "lod/geometry.h"
#include "lod/ladder.h"

/* ---- Lists of the pack ---- */

static bool is_held(const struct eco_list *list)
{
	return list->kind != ECO_LIST_IMPOSTOR && !(list->attributes & ECO_ATTR_SPLAT);
}

static enum eco_code feed_list(struct paper_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_list *list = &s->scene->lists[id];
	const struct eco_group *groups = list->group_count ? eco_list_groups(s->scene, id) : NULL;
	enum eco_code code = view_store_events.list(s->store, id, list,
		s->scene->palette + list->palette_first, groups, error);
	for (uint32_t i = 0; i < list->chunk_count && !code; i++) {
		const uint8_t *bytes;
		size_t size;
		code = eco_pack_payload(s->pack, list->chunk_first + i, &bytes, &size, error);
		if (!code)
			code = view_store_events.chunk(s->store, id, i,
				&s->scene->chunks[list->chunk_first + i], bytes, error);
	}
	return code;
}

/* A paper scales all leaves alike. */
static void grow_plainly(const struct view_list *list)
{
	if (!list || !(list->list.attributes & ECO_ATTR_GROWTH))
		return;
	uint32_t at = eco_list_extra_at(&list->list, ECO_ATTR_GROWTH), each = list->elements.extra_count;
	for (uint32_t i = 0; i < list->elements.element_count; i++)
		list->elements.extra[(size_t)i * each + at] = ECO_GROWTH_PLAIN;
}

static enum eco_code feed_pack(struct paper_scene *s, struct eco_error *error)
{
	const struct eco_scene *scene = s->scene;
	enum eco_code code = view_store_events.scene(s->store, scene, &s->pack->id, error);
	for (uint32_t i = 0; i < scene->plant_count && !code; i++)
		code = view_store_events.plant(s->store, i, &scene->plants[i],
			scene->anchors + scene->plants[i].anchor_first, error);
	/* forms come after what they are forms of */
	for (int forms = 0; forms < 2; forms++)
		for (uint32_t i = 0; i < scene->list_count && !code; i++)
			if (is_held(&scene->lists[i]) && (scene->lists[i].partner != ECO_NONE) == forms)
				code = feed_list(s, i, error);
	for (uint32_t i = 0; i < scene->list_count && !code; i++)
		grow_plainly(view_store_list(s->store, i));
	return code;
}

/* ---- Two points a triangle ---- */

bool paper_is_leaves(const struct eco_ladder *ladder)
{
	return ladder->organ != ECO_ORGAN_WOOD && !(ladder->flags & ECO_LADDER_WHOLE) &&
		ladder->triangles != ECO_NONE;
}

/* Uniform on the triangle: a point of the parallelogram, turned back where it lies outside. */
void paper_two_points(const float corners[9], double u(void *ctx), void *ctx, double out[2][3])
{
	for (int i = 0; i < 2; i++) {
		double a = u(ctx), b = u(ctx);
		if (a + b > 1) {
			a = 1 - a;
			b = 1 - b;
		}
		for (int k = 0; k < 3; k++) {
			double o = (double)corners[k];
			out[i][k] = o + a * ((double)corners[3 + k] - o) + b * ((double)corners[6 + k] - o);
		}
	}
}

static double next_random(void *ctx)
{
	uint64_t *state = ctx;
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / 9007199254740992.0;
}

static bool make_points(const struct view_list *from, const struct view_list *forms, struct eco_list *list,
	struct eco_elements *out)
{
	uint32_t count = from->list.primitive_count, colour = eco_list_extra_at(&forms->list, ECO_ATTR_COLOR);
	bool coloured = forms->list.attributes & ECO_ATTR_COLOR;
	struct lod_geometry corners = { 0 };
	uint64_t state = 1 + from->id;
	*out = (struct eco_elements){ .element_count = 2 * count,
		.corner_count = 2 * count,
		.primitive_count = 2 * count,
		.extra_count = coloured };
	out->corners = malloc(2u * count + 1);
	out->position = malloc((6u * (size_t)count + 1) * sizeof *out->position);
	out->extra = coloured ? calloc(2u * (size_t)count + 1, sizeof *out->extra) : NULL;
	if (!out->corners || !out->position || (coloured && !out->extra) ||
		!lod_geometry_make(&corners, &from->list, count, false))
		return false;
	lod_list_geometry(&from->list, &from->elements, 0, count, 1, &corners);
	memset(out->corners, 1, 2u * count);
	for (uint32_t e = 0, t = 0; e < from->elements.element_count; e++)
		for (uint32_t last = t + from->elements.corners[e] - 2u; t < last; t++) {
			double at[2][3];
			paper_two_points(corners.position + 9 * (size_t)t, next_random, &state, at);
			for (uint32_t i = 0; i < 2; i++) {
				for (int k = 0; k < 3; k++)
					out->position[3 * (2 * (size_t)t + i) + (size_t)k] = (int32_t)floor(
						(at[i][k] - list->grid_origin[k]) / list->grid_step[k] + 0.5);
				if (coloured)
					out->extra[2 * (size_t)t + i] =
						forms->elements
							.extra[(size_t)e * forms->elements.extra_count +
								colour];
			}
		}
	lod_geometry_free(&corners);
	return true;
}

/* Chunks reorder their elements, but points must stay beside those of their triangle: the store's copy is put
 * back into the order in which they were made. */
static enum eco_code feed_made(struct paper_scene *s, uint32_t id, const struct eco_list *list,
	const struct eco_elements *made, const struct view_list *like, struct eco_error *error)
{
	struct eco_chunk_input input = { .list = list, .elements = made, .end = made->element_count };
	struct eco_chunk chunk = { .primitive_count = made->primitive_count,
		.element_count = made->element_count };
	uint8_t *bytes = NULL;
	size_t size = 0;
	enum eco_code code = eco_chunk_encode(&input, &bytes, &size, NULL, error);
	chunk.size_bytes = (uint32_t)size;
	if (!code)
		code = view_store_events.list(s->store, id, list, (const uint8_t(*)[3])like->palette, NULL,
			error);
	if (!code) {
		chunk.id = eco_chunk_hash(bytes, size);
		code = view_store_events.chunk(s->store, id, 0, &chunk, bytes, error);
	}
	if (!code) {
		const struct eco_elements *held = &view_store_list(s->store, id)->elements;
		memcpy(held->position, made->position,
			3 * (size_t)made->corner_count * sizeof *made->position);
		if (made->extra_count)
			memcpy(held->extra, made->extra,
				(size_t)made->extra_count * made->element_count * sizeof *made->extra);
	}
	free(bytes);
	return code;
}

static enum eco_code add_points(struct paper_scene *s, uint32_t ladder, uint32_t id, struct eco_error *error)
{
	const struct eco_ladder *l = &s->scene->ladders[ladder];
	const struct view_list *from = view_store_list(s->store, l->triangles),
			       *forms = view_store_list(s->store, l->points);
	struct eco_list list = forms->list;
	struct eco_elements points;
	double region = (double)from->list.primitive_count * l->total / from->list.element_count;
	list.coder = ECO_CODER_ELEMENTS;
	list.attributes &= ECO_ATTR_COLOR;
	list.partner = ECO_NONE;
	list.primitive_count = list.element_count = 2 * from->list.primitive_count;
	list.chunk_count = 1;
	list.chunk_first = 0;
	list.unit_area = (float)((double)l->area / 2 / (2 * region));
	memcpy(list.grid_origin, from->list.grid_origin, sizeof list.grid_origin);
	memcpy(list.grid_step, from->list.grid_step, sizeof list.grid_step);
	enum eco_code code = make_points(from, forms, &list, &points)
		? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for points");
	if (!code)
		code = feed_made(s, id, &list, &points, forms, error);
	eco_elements_free(&points);
	s->points[ladder] = id;
	return code;
}

/* ---- Lines of one width ---- */

struct line { double width, length; uint32_t at; };

static double length_of(const struct view_list *list, uint32_t line)
{
	const int32_t *at = list->elements.position + 6 * (size_t)line;
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		double d = list->list.grid_step[k] * ((double)at[3 + k] - at[k]);
		sum += d * d;
	}
	return sqrt(sum);
}

/* In random order. */
static struct line *read_lines(const struct view_list *from)
{
	uint32_t n = from->elements.element_count, at = eco_list_extra_at(&from->list, ECO_ATTR_WIDTH);
	struct line *lines = malloc((n + 1u) * sizeof *lines);
	uint64_t state = 1 + from->id;
	for (uint32_t i = 0; lines && i < n; i++) {
		uint32_t other = (uint32_t)(next_random(&state) * (i + 1));
		lines[i] = lines[other];
		lines[other] = (struct line){ from->list.grid_step[0]
				* from->elements.extra[(size_t)from->elements.extra_count * i + at],
			length_of(from, i), i };
	}
	return lines;
}

bool paper_make_lines(const struct view_list *from, double width, struct paper_lines *made,
	struct eco_elements *out)
{
	struct line *lines = read_lines(from);
	const struct eco_elements *e = &from->elements;
	uint32_t n = e->element_count, each = e->extra_count, next = 0;
	uint32_t extra = eco_list_extra_at(&from->list, ECO_ATTR_WIDTH);
	double area = 0, length = 0;
	*out = (struct eco_elements){ .element_count = n, .corner_count = 2 * n, .primitive_count = n,
		.extra_count = each };
	out->corners = malloc(n + 1u);
	out->position = malloc((6u * (size_t)n + 1) * sizeof *out->position);
	out->extra = malloc(((size_t)each * n + 1) * sizeof *out->extra);
	bool enough = lines && out->corners && out->position && out->extra;
	if (enough)
		memset(out->corners, 2, n);
	for (int thick = 1; enough && thick >= 0; thick--)
		for (uint32_t i = 0; i < n; i++) {
			if ((lines[i].width > width) != thick)
				continue;
			memcpy(out->position + 6 * (size_t)next, e->position + 6 * (size_t)lines[i].at,
				6 * sizeof *out->position);
			memcpy(out->extra + (size_t)each * next, e->extra + (size_t)each * lines[i].at,
				each * sizeof *out->extra);
			if (!thick)
				out->extra[(size_t)each * next + extra] =
					(int32_t)fmin(fmax(1, width / from->list.grid_step[0]), 1 << 26);
			made->thick += (uint32_t)thick;
			area += thick ? 0 : lines[i].width * lines[i].length;
			length += thick ? 0 : lines[i].length;
			next++;
		}
	made->width = width;
	made->thin = length > 0 ? area / length : 0;
	free(lines);
	return enough;
}

static double mean_width(const struct line *lines, uint32_t count)
{
	double area = 0, length = 0;
	for (uint32_t i = 0; i < count; i++) {
		area += lines[i].width * lines[i].length;
		length += lines[i].length;
	}
	return length > 0 ? area / length : 0;
}

static enum eco_code add_lines(struct paper_scene *s, uint32_t ladder, uint32_t id, struct eco_error *error)
{
	const struct view_list *from = view_store_list(s->store, s->scene->ladders[ladder].lines);
	struct eco_list list = from->list;
	struct line *lines = read_lines(from);
	double mean = lines ? mean_width(lines, from->elements.element_count) : 0;
	free(lines);
	enum eco_code code = lines ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for lines");
	list.coder = ECO_CODER_ELEMENTS;
	list.partner = ECO_NONE;
	list.chunk_count = 1;
	list.chunk_first = 0;
	for (uint32_t i = 0; i < PAPER_WIDTHS && !code && mean > 0; i++) {
		struct paper_lines *made = &s->lines[(size_t)ladder * PAPER_WIDTHS + i];
		struct eco_elements elements;
		code = paper_make_lines(from, mean * pow(2, i / 2.0), made, &elements) ? ECO_OK
			: eco_fail(error, ECO_NO_MEMORY, "no memory for lines");
		if (!code)
			code = feed_made(s, id + i, &list, &elements, from, error);
		eco_elements_free(&elements);
		made->list = id + i;
	}
	return code;
}

/* ---- Tables ---- */

static bool count_triangles(struct paper_scene *s, uint32_t list)
{
	const struct eco_elements *e = &view_store_list(s->store, list)->elements;
	uint32_t *sums =
		s->triangles[list] ? s->triangles[list] : malloc((e->element_count + 1u) * sizeof *sums);
	if (!sums)
		return false;
	sums[0] = 0;
	for (uint32_t i = 0; i < e->element_count; i++)
		sums[i + 1] = sums[i] + e->corners[i] - 2;
	s->triangles[list] = sums;
	return true;
}

static enum eco_code make_tables(struct paper_scene *s, struct eco_error *error)
{
	const struct eco_scene *scene = s->scene;
	enum eco_code code = ECO_OK;
	s->points = malloc((scene->ladder_count + 1u) * sizeof *s->points);
	s->lines = calloc((scene->ladder_count + 1u) * (size_t)PAPER_WIDTHS, sizeof *s->lines);
	s->triangles = calloc(scene->list_count + 1u, sizeof *s->triangles);
	s->wood_full = calloc(scene->plant_count + 1u, sizeof *s->wood_full);
	if (!s->points || !s->lines || !s->triangles || !s->wood_full)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for tables");
	for (uint32_t i = 0, id = scene->list_count; i < scene->ladder_count && !code; i++) {
		const struct eco_ladder *l = &scene->ladders[i];
		s->points[i] = ECO_NONE;
		if (l->lines != ECO_NONE && scene->lists[l->lines].primitive_count) {
			code = add_lines(s, i, id, error);
			id += PAPER_WIDTHS;
		}
		if (l->organ == ECO_ORGAN_WOOD && !(l->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE)))
			s->wood_full[l->plant] += (double)lod_ladder_full(scene, l);
		if (code || !paper_is_leaves(l))
			continue;
		if (!count_triangles(s, l->triangles))
			return eco_fail(error, ECO_NO_MEMORY, "no memory for tables");
		if (l->points != ECO_NONE && l->lines == ECO_NONE && scene->lists[l->triangles].element_count)
			code = add_points(s, i, id++, error);
	}
	return code;
}

uint32_t paper_triangles(const struct paper_scene *s, uint32_t list, uint32_t elements)
{
	uint32_t most = s->scene->lists[list].element_count;
	return s->triangles[list][elements < most ? elements : most];
}

enum eco_code paper_scene_open(struct paper_scene **scene, const char *pack, struct eco_error *error)
{
	struct view_store_options options = { .images = true, .memory_max = 16ull << 30 };
	struct paper_scene *s = *scene = calloc(1, sizeof *s);
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %s", pack);
	enum eco_code code = eco_pack_open(&s->pack, pack, error);
	if (!code) {
		s->scene = &s->pack->scene;
		code = lod_plan_tables_make(&s->tables, s->scene, error);
	}
	if (!code)
		code = view_store_new(&s->store, &options, error);
	if (!code)
		code = feed_pack(s, error);
	if (!code)
		code = make_tables(s, error);
	if (code) {
		paper_scene_close(s);
		*scene = NULL;
	}
	return code;
}

void paper_scene_close(struct paper_scene *s)
{
	if (!s)
		return;
	for (uint32_t i = 0; s->triangles && i < s->scene->list_count; i++)
		free(s->triangles[i]);
	free(s->triangles);
	free(s->points);
	free(s->lines);
	free(s->wood_full);
	view_store_free(s->store);
	lod_plan_tables_free(s->tables);
	if (s->pack)
		eco_pack_close(s->pack);
	free(s);
}

/* ---- Drawing ---- */

enum eco_code paper_draw(struct paper_scene *s, struct eco_plan *plan, const struct eco_view *view, bool soft,
	struct paper_frame *frame, struct eco_error *error)
{
	struct lod_eye eye;
	*frame = (struct paper_frame){ 0 };
	lod_eye_make(&eye, view);
	view_store_begin(s->store);
	enum eco_code code = view_store_events.plan(s->store, plan, error);
	if (!code)
		code = view_select_make(&frame->selection, s->store, &eye, error);
	struct view_reference_job job = { .store = s->store,
		.selection = &frame->selection,
		.eye = &eye,
		.near_m = view_store_near_m(s->store) };
	if (!code)
		code = view_picture_init(&frame->picture, view->width, view->height, error);
	if (!code)
		code = view_reference_draw(&job, &frame->picture, error);
	if (!code && soft)
		code = view_measure_soft(&job, &frame->picture, error);
	return code;
}

void paper_frame_free(struct paper_frame *frame)
{
	view_picture_free(&frame->picture);
	view_select_free(&frame->selection);
}
