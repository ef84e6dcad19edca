/* A plant of a pack alone: its decoded lists, a camera that fits it, and the cuts that the planner
 * chooses. */
#include "ecofiles/ecopack/export/plant_view.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/image.h"
#include "ecofiles/format/texture.h"
#include "lod/geometry.h"
#include "lod/plan/planner.h"

#define AWAY_RADII 8.0           /* the camera's distance: a weak perspective */
#define DOWN 0.22                /* slope of the view, downwards */
#define MARGIN 1.06

/* ---- Textures ---- */

/* Its finest level. */
static void decode_picture(const struct plant_view *p, struct plant_view_list *to, struct eco_error *error)
{
	const struct eco_list *cut = to->image == ECO_NONE ? NULL : &p->pack->scene.lists[to->image];
	struct eco_texture_part colors = { 0 }, outline = { 0 };
	eco_check(eco_texture_read_level(&colors, p->pack, to->list, to->list->primitive_count - 1, error));
	if (cut)
		eco_check(eco_texture_read_level(&outline, p->pack, cut, cut->primitive_count - 1, error));
	eco_check(eco_texture_show(&to->picture, &colors, cut ? &outline : NULL, error));
	for (size_t i = 0; i < (size_t)to->picture.width * to->picture.height; i++)
		to->cutout = to->cutout || to->picture.rgba[4 * i + 3] < 128;
	eco_texture_part_free(&colors);
	eco_texture_part_free(&outline);
}

/* ---- Lists ---- */

static void decode_impostor(struct plant_view_list *to, uint32_t chunk, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	struct eco_impostor_body body;
	struct eco_impostor_level level;
	eco_check(eco_impostor_level_read(&level, &body, bytes, size, error));
	eco_check(lod_impostor_open(&to->impostors[chunk], &body, &level, error));
	eco_impostor_level_free(&level);
}

static void decode_list(struct plant_view *p, uint32_t id, struct eco_error *error)
{
	const struct eco_scene *s = &p->pack->scene;
	const struct eco_list *list = &s->lists[id];
	struct plant_view_list *to = &p->lists[id];
	*to = (struct plant_view_list){ .list = list, .palette = s->palette + list->palette_first,
		.image = list->image,
		.chunks = eco_alloc(list->chunk_count, sizeof *to->chunks),
		.impostors = list->kind == ECO_LIST_IMPOSTOR
			? eco_alloc(list->chunk_count, sizeof *to->impostors) : NULL };
	if (list->kind == ECO_LIST_IMAGE && list->chunk_count)
		decode_picture(p, to, error);
	for (uint32_t c = 0; c < list->chunk_count && list->kind != ECO_LIST_IMAGE; c++) {
		const struct eco_chunk *chunk = &s->chunks[list->chunk_first + c];
		const uint8_t *bytes;
		size_t size;
		eco_check(eco_pack_payload(p->pack, list->chunk_first + c, &bytes, &size, error));
		if (to->impostors)
			decode_impostor(to, c, bytes, size, error);
		else
			eco_check(eco_chunk_decode(list, chunk, c, bytes, size, &to->chunks[c], error));
		to->chunk_count++;
	}
}

static void decode_lists(struct plant_view *p, struct eco_error *error)
{
	const struct eco_scene *s = &p->pack->scene;
	const struct eco_plant *plant = &s->plants[p->number];
	for (uint32_t i = plant->ladder_first; i < plant->ladder_first + plant->ladder_count; i++) {
		const struct eco_ladder *ladder = &s->ladders[i];
		const uint32_t ids[] = { ladder->points, ladder->lines, ladder->simple, ladder->triangles,
			ladder->impostor };
		for (int k = 0; k < 5; k++) {
			if (ids[k] == ECO_NONE || p->lists[ids[k]].list)
				continue;
			decode_list(p, ids[k], error);
			p->lists[ids[k]].organ = ladder->organ;
			uint32_t image = s->lists[ids[k]].image;
			if (image != ECO_NONE && !p->lists[image].list)
				decode_list(p, image, error);
		}
	}
}

/* ---- A scene of one plant ---- */

static void make_scene(struct plant_view *p)
{
	const struct eco_scene *s = &p->pack->scene;
	const struct eco_plant *plant = &s->plants[p->number];
	const struct eco_anchor *whole = &s->anchors[plant->anchor_first];
	p->scene_lists = eco_alloc(s->list_count + 1u, sizeof *p->scene_lists);
	memcpy(p->scene_lists, s->lists, s->list_count * sizeof *p->scene_lists);
	p->scene_lists[s->list_count] = (struct eco_list){ .kind = ECO_LIST_INSTANCES,
		.coder = ECO_CODER_ROWS, .attributes = ECO_ATTR_PLACE,
		.group_count = 1, .grid_step = { 1, 1, 1 }, .image = ECO_NONE, .partner = ECO_NONE,
		.primitive_count = 1, .element_count = 1 };
	p->tile = (struct eco_tile){ .area = plant->area, .instance_count = 1, .summary = ECO_NONE,
		.group_count = 1 };
	for (int k = 0; k < 3; k++) {
		p->tile.low[k] = (double)whole->center[k] - whole->radius;
		p->tile.high[k] = (double)whole->center[k] + whole->radius;
	}
	p->group = (struct eco_group){ .plant = p->number, .list = s->list_count, .count = 1 };
	/* scale 65536 / 65536, the rest 0 */
	memcpy(p->place + ECO_PLACE_BYTES - 4, (const uint8_t[4]){ 0, 0, 1, 0 }, 4);
	p->scene = *s;
	p->scene.root = 0;
	p->scene.ground = NULL, p->scene.ground_count = p->scene.ground_columns = p->scene.ground_rows = 0;
	p->scene.ground_images = NULL, p->scene.ground_image_count = 0;
	p->scene.tiles = &p->tile, p->scene.tile_count = 1;
	p->scene.groups = &p->group, p->scene.group_count = 1;
	p->scene.children = NULL, p->scene.child_count = 0;
	p->scene.lists = p->scene_lists, p->scene.list_count = s->list_count + 1;
	p->scene.places = p->place, p->scene.place_count = 1;
}

static void set_view(struct plant_view *p, const double target[3], double half, uint32_t pixels)
{
	memcpy(p->view.target, target, sizeof p->view.target);
	p->view.up[2] = 1;
	p->view.fov_y_deg = 2 * atan(half) * (180 / M_PI);
	p->view.width = p->view.height = pixels;
	lod_eye_make(&p->eye, &p->view);
}

/* Extends low and high by the batch's corners as seen, in tangents. */
static void see_batch(const struct lod_eye *eye, const struct plant_view_batch *b, double low[2],
	double high[2])
{
	size_t corners = b->impostor ? 0 : (size_t)b->count * eco_list_vertices(b->list->list);
	for (size_t i = 0; i < corners; i++) {
		const float *q = b->geometry.position + 3 * i;
		double d[3] = { q[0] - eye->at[0], q[1] - eye->at[1], q[2] - eye->at[2] };
		double w = d[0] * eye->forward[0] + d[1] * eye->forward[1] + d[2] * eye->forward[2];
		double x = (d[0] * eye->right[0] + d[1] * eye->right[1] + d[2] * eye->right[2]) / w;
		double y = (d[0] * eye->up[0] + d[1] * eye->up[1] + d[2] * eye->up[2]) / w;
		low[0] = fmin(low[0], x), high[0] = fmax(high[0], x);
		low[1] = fmin(low[1], y), high[1] = fmax(high[1], y);
	}
}

static void fit_view(struct plant_view *p, const struct plant_view_drawing *all, double target[3],
	double away)
{
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < all->count; i++)
		see_batch(&p->eye, &all->batches[i], low, high);
	if (!(high[0] >= low[0]))
		return;
	const struct lod_eye eye = p->eye;
	double x = (low[0] + high[0]) / 2, y = (low[1] + high[1]) / 2,
		half = fmax(high[0] - low[0], high[1] - low[1]) / 2 * MARGIN;
	for (int k = 0; k < 3; k++)
		target[k] = eye.at[k] + (eye.forward[k] + x * eye.right[k] + y * eye.up[k]) * away;
	set_view(p, target, fmax(half, 1e-4), p->view.width);
}

/* Draws full detail, first into a view around the plant's sphere, then into one that just holds it. */
static void look(struct plant_view *p, uint32_t pixels, struct eco_error *error)
{
	const struct eco_anchor *whole = &p->scene.anchors[p->scene.plants[p->number].anchor_first];
	double target[3] = { whole->center[0], whole->center[1], whole->center[2] },
		away = AWAY_RADII * (whole->radius > 0 ? whole->radius : 1);
	struct plant_view_drawing all;
	p->view = (struct eco_view){ .eye = { target[0], target[1] - away, target[2] + DOWN * away } };
	set_view(p, target, 1.2 / AWAY_RADII, pixels);
	eco_check(plant_view_drawing_make(&all, p, ECO_VERTICES_MAX, error));
	p->full = all.vertices;
	fit_view(p, &all, target, away);
	plant_view_raster(&p->raster, p, &p->eye, &all, false);
	memcpy(p->reference, p->raster.cover, (size_t)pixels * pixels);
	plant_view_drawing_free(&all);
}

/* ---- The planner's cuts ---- */

static void make_batch(const struct plant_view *p, const struct eco_cut *cut, struct plant_view_batch *b)
{
	const struct plant_view_list *list = b->list = &p->lists[cut->list];
	uint32_t count = cut->end - cut->first, from = 0, end;
	bool textured = list->list->kind == ECO_LIST_TRIANGLES && list->image != ECO_NONE
		&& list->list->attributes & ECO_ATTR_UV && p->lists[list->image].picture.rgba;
	b->area = list->list->unit_area * cut->scale;
	if (list->impostors) {
		b->impostor = &list->impostors[cut->first];
		b->count = b->impostor->cell_count;
		return;
	}
	if (!lod_geometry_make(&b->geometry, list->list, count, textured))
		eco_end("no memory");
	for (uint32_t c = 0; c < list->chunk_count && b->count < count; c++, from = end) {
		end = from + list->chunks[c].primitive_count;
		uint32_t first = cut->first > from ? cut->first : from, last = cut->end < end ? cut->end
			: end;
		if (first >= last)
			continue;
		struct lod_geometry at = lod_geometry_from(&b->geometry, list->list, b->count);
		b->count += lod_list_geometry(list->list, &list->chunks[c], first - from, last - from,
			cut->scale, &at);
	}
}

/* Whether a cut's rule applies to the one instance. */
static bool draws(const struct eco_cut *cut, const struct lod_anchor_band *seen, uint32_t seen_count,
	uint32_t hash)
{
	for (uint32_t i = 0; i < seen_count; i++)
		if (cut->anchor == seen[i].anchor)
			return cut->band_first <= seen[i].band && seen[i].band < cut->band_end
				&& cut->share_first <= hash && hash < cut->share_end;
	return false;
}

static void add_cuts(struct plant_view_drawing *d, const struct plant_view *p, const struct eco_plan *plan,
	struct lod_anchor_band *seen)
{
	const struct eco_plant *plant = &p->scene.plants[p->number];
	const struct eco_placement nowhere = { .scale = 1 };
	const struct eco_place origin = eco_place_read(&p->scene, 0);
	uint32_t gate = 0;
	for (uint32_t i = 0; i < plan->gate_count; i++)
		if (plan->gates[i].plant == p->number)
			gate = plan->gates[i].end;
	struct lod_place place;
	lod_place_instance(&place, plan->placement_count ? &plan->placements[0] : &nowhere,
		&p->scene.lists[p->group.list], &origin);
	uint32_t hash = lod_share_hash(plan->placement_count ? plan->placements[0].path : 0, p->group.list,
		0);
	uint32_t count = lod_instance_anchors(&p->eye, &place, p->scene.anchors + plant->anchor_first,
		plant->anchor_first, plant->anchor_count, gate, hash, seen);
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		const struct eco_cut *cut = &plan->cuts[i];
		if (cut->anchor == ECO_NONE || !draws(cut, seen, count, hash))
			continue;
		struct plant_view_batch *b = &d->batches[d->count++];
		make_batch(p, cut, b);
		b->first = d->primitives;
		d->primitives += b->count;
		d->vertices += (uint64_t)(cut->end - cut->first) * eco_list_vertices(b->list->list);
	}
}

enum eco_code plant_view_drawing_make(struct plant_view_drawing *drawing, const struct plant_view *plant,
	uint64_t vertices, struct eco_error *error)
{
	struct eco_request request = { .view = plant->view, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED };
	struct lod_planner_input input = { .scene = &plant->scene, .request = &request };
	struct eco_plan plan;
	*drawing = (struct plant_view_drawing){ 0 };
	ECO_PASS(lod_plan(&plan, &input, error));
	struct lod_anchor_band *seen = eco_alloc(plant->scene.plants[plant->number].anchor_count, sizeof *seen);
	drawing->batches = eco_alloc(plan.cut_count, sizeof *drawing->batches);
	add_cuts(drawing, plant, &plan, seen);
	free(seen);
	eco_plan_free(&plan);
	return ECO_OK;
}

void plant_view_drawing_free(struct plant_view_drawing *drawing)
{
	for (uint32_t i = 0; i < drawing->count; i++)
		lod_geometry_free(&drawing->batches[i].geometry);
	free(drawing->batches);
	*drawing = (struct plant_view_drawing){ 0 };
}

/* ---- Drawing ---- */

static void raster_batch(struct lod_raster *raster, const struct plant_view *view,
	const struct plant_view_batch *b, bool one_by_one)
{
	const struct plant_view_list *image = b->geometry.uv ? &view->lists[b->list->image] : NULL;
	struct lod_raster_batch batch = { .owner = one_by_one ? (uint64_t)b->first + 1 : 1,
		.count = one_by_one ? 1 : b->count, .area = b->area,
		.cutout = image && image->cutout ? &image->picture : NULL };
	if (b->impostor) {
		lod_raster_impostor(raster, b->impostor, &(struct lod_raster_batch){ .owner = batch.owner });
		return;
	}
	for (uint32_t i = 0; i < b->count; i += batch.count, batch.owner++) {
		struct lod_geometry from = lod_geometry_from(&b->geometry, b->list->list, i);
		lod_raster_list(raster, b->list->list, &from, &batch);
	}
}

void plant_view_raster(struct lod_raster *raster, const struct plant_view *view, const struct lod_eye *eye,
	const struct plant_view_drawing *drawing, bool one_by_one)
{
	lod_raster_clear(raster);
	lod_raster_camera(raster, eye, view->scene.near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	for (uint32_t i = 0; i < drawing->count; i++)
		raster_batch(raster, view, &drawing->batches[i], one_by_one);
}

double plant_view_q(struct plant_view *view, const struct plant_view_drawing *drawing)
{
	struct lod_score score;
	plant_view_raster(&view->raster, view, &view->eye, drawing, false);
	lod_score(&score, &(struct lod_score_input){ .width = view->raster.width,
		.height = view->raster.height, .cover = view->raster.cover, .reference = view->reference });
	return score.q;
}

/* ---- The plant ---- */

struct opening { struct plant_view *view; uint32_t pixels; struct eco_error *error; };

static void open_view(void *ctx)
{
	const struct opening *o = ctx;
	lod_raster_init(&o->view->raster, &(struct lod_raster_options){ .width = o->pixels, .height = o->pixels });
	decode_lists(o->view, o->error);
	make_scene(o->view);
	look(o->view, o->pixels, o->error);
}

enum eco_code plant_view_open(struct plant_view *view, const struct eco_pack *pack, uint32_t number,
	uint32_t pixels, struct eco_error *error)
{
	assert(number < pack->scene.plant_count);
	*view = (struct plant_view){ .pack = pack, .number = number, .scene = pack->scene,
		.list_count = pack->scene.list_count,
		.lists = eco_alloc(pack->scene.list_count, sizeof *view->lists),
		.reference = eco_alloc(pixels, pixels) };
	enum eco_code code = eco_try(open_view, &(struct opening){ view, pixels, error }, error);
	if (code)
		plant_view_close(view);
	return code;
}

void plant_view_close(struct plant_view *view)
{
	for (uint32_t i = 0; view->lists && i < view->list_count; i++) {
		struct plant_view_list *list = &view->lists[i];
		for (uint32_t c = 0; c < list->chunk_count && list->chunks; c++)
			eco_elements_free(&list->chunks[c]);
		for (uint32_t c = 0; c < list->chunk_count && list->impostors; c++)
			lod_impostor_close(&list->impostors[c]);
		free(list->impostors);
		free(list->chunks);
		eco_image_free(&list->picture);
	}
	eco_free(view->lists, view->scene_lists, view->reference);
	lod_raster_free(&view->raster);
	*view = (struct plant_view){ 0 };
}
