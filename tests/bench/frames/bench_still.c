#include "tests/bench/frames/bench_still.h"

#include <stdlib.h>

#include "client-min/view_reference.h"
#include "tests/bench/bench_fetch.h"

struct bench_still {
	struct srv_store scenes;
	struct view_store *store;
};

enum eco_code bench_still_open(struct bench_still **still, const char *pack, struct eco_error *error)
{
	struct bench_still *s = *still = calloc(1, sizeof *s);
	struct view_store_options options = { .images = true };
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory to draw %s", pack);
	srv_store_init(&s->scenes);
	enum eco_code code = srv_store_add(&s->scenes, "still", pack, error);
	if (!code)
		code = view_store_new(&s->store, &options, error);
	if (code) {
		bench_still_close(s);
		*still = NULL;
	}
	return code;
}

void bench_still_close(struct bench_still *still)
{
	if (!still)
		return;
	view_store_free(still->store);
	srv_store_free(&still->scenes);
	free(still);
}

const struct eco_scene *bench_still_scene(const struct bench_still *still)
{
	return &still->scenes.scenes[0]->pack->scene;
}

/* ---- Plants ---- */

void bench_plants_free(struct bench_plants *plants)
{
	free(plants->items);
	free(plants->cuts);
	*plants = (struct bench_plants){ 0 };
}

static int by_owner(const void *a, const void *b)
{
	const struct bench_plant *x = a, *y = b;
	return x->owner < y->owner ? -1 : x->owner > y->owner;
}

static enum eco_code list_plants(const struct bench_still *still, const struct view_selection *selection,
	const struct lod_eye *eye, struct bench_plants *plants, struct eco_error *error)
{
	const struct eco_plan *plan = view_store_plan(still->store);
	uint32_t cuts = 0;
	bench_plants_free(plants);
	*plants =
		(struct bench_plants){
		.items = malloc((selection->instance_count + 1u) * sizeof *plants->items),
		.cuts = malloc((selection->cut_first[selection->instance_count] + 1u)
		* sizeof *plants->cuts) };
	if (!plants->items || !plants->cuts)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u plants", selection->instance_count);
	for (uint32_t i = 0; i < selection->instance_count; i++) {
		const struct view_instance *instance = &selection->instances[i];
		if (instance->plant == ECO_NONE)
			continue;
		struct bench_plant *p = &plants->items[plants->count++];
		double center[3];
		lod_place_point(&instance->place,
			view_store_plant(still->store, instance->plant)->anchors[0].center, center);
		*p = (struct bench_plant){ .owner = instance->owner, .plant = instance->plant,
			.cut_first = cuts,
			.band = lod_eye_band(eye, center, instance->place.scale, instance->hash) };
		for (uint32_t c = selection->cut_first[i]; c < selection->cut_first[i + 1]; c++) {
			const struct eco_cut *cut = &plan->cuts[selection->cuts[c]];
			uint64_t vertices =
				(uint64_t)(cut->end - cut->first)
				* eco_list_vertices(&view_store_list(still->store, cut->list)->list);
			plants->cuts[cuts++] = (struct bench_cut){ cut->list, cut->first, cut->end,
				cut->scale, vertices };
			p->cut_count++;
			p->vertices += vertices;
		}
	}
	qsort(plants->items, plants->count, sizeof *plants->items, by_owner);
	return ECO_OK;
}

/* ---- Pictures ---- */

static enum eco_code draw(struct bench_still *still, const struct view_selection *selection,
	const struct lod_eye *eye, struct view_picture *picture, struct eco_error *error)
{
	double near_m = view_store_near_m(still->store) > 0 ? view_store_near_m(still->store) : 0.1;
	return view_reference_draw(&(struct view_reference_job){ still->store, selection, eye, near_m, 0,
		NULL, VIEW_TINT_NONE }, picture, error);
}

enum eco_code bench_still_draw(struct bench_still *still, const struct eco_request *request,
	struct view_picture *picture, struct bench_plants *plants, struct eco_error *error)
{
	struct view_selection selection = { 0 };
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	enum eco_code code = bench_fetch(NULL, still->scenes.scenes[0], request, still->store, error);
	if (!code)
		code = view_select_make(&selection, still->store, &eye, error);
	if (code)
		return code;
	view_picture_free(picture);
	code = view_picture_init(picture, request->view.width, request->view.height, error);
	if (!code)
		code = draw(still, &selection, &eye, picture, error);
	if (!code && plants)
		code = list_plants(still, &selection, &eye, plants, error);
	view_select_free(&selection);
	return code;
}

struct eco_view bench_still_between(const struct eco_view *a, const struct eco_view *b, double t)
{
	struct eco_view v = *a;
	for (int k = 0; k < 3; k++) {
		v.eye[k] += t * (b->eye[k] - a->eye[k]);
		v.target[k] += t * (b->target[k] - a->target[k]);
		v.up[k] += t * (b->up[k] - a->up[k]);
	}
	v.fov_y_deg += t * (b->fov_y_deg - a->fov_y_deg);
	return v;
}
