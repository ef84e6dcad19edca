#include "tests/support/serve/random_request.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/eye.h"

uint64_t dice_bits(struct dice *r) { return eco_random_next(&r->state); }
static double dice_real(struct dice *r, double low, double high)
{
	return low + (high - low) * eco_random_unit(dice_bits(r));
}
double dice_power(struct dice *r, double low, double high) { return pow(10, dice_real(r, low, high)); }

_Noreturn void random_stop(const char *what, const struct eco_error *error)
{
	fprintf(stderr, "%s: %s\n", what, error->text);
	exit(2);
}

/* A point in the body of some plant, found by a walk down the tree; false where the walk ends at a tile
 * without plants. */
static bool random_in_plant(struct dice *r, const struct eco_scene *scene, double point[3])
{
	struct eco_placement at = { .scale = 1 };
	const struct eco_tile *tile = &scene->tiles[scene->root];
	while (tile->child_count > 0 && (tile->group_count == 0 || dice_bits(r) % 8)) {
		const struct eco_child *child =
			&scene->children[tile->child_first + dice_bits(r) % tile->child_count];
		if (child->placed) {
			struct eco_list whole = { .grid_step = { 1e-3, 1e-3, 1e-3 } };
			struct eco_place as_place =
				{ .turn = child->turn,
					.scale = (uint32_t)fmax(1, (double)child->scale * 65536) };
			struct lod_place place;
			for (int i = 0; i < 3; i++)
				as_place.position[i] = (int32_t)fmax(-1e9, fmin(1e9, child->at[i] * 1000));
			lod_place_instance(&place, &at, &whole, &as_place);
			at.turn = (uint16_t)(at.turn + child->turn);
			at.scale *= (double)child->scale;
			memcpy(at.at, place.at, sizeof at.at);
		}
		tile = &scene->tiles[child->tile];
	}
	if (tile->group_count == 0)
		return false;
	const struct eco_group *group = &scene->groups[tile->group_first + dice_bits(r) % tile->group_count];
	const struct eco_list *list = &scene->lists[group->list];
	const struct eco_anchor *body = &scene->anchors[scene->plants[group->plant].anchor_first];
	struct eco_place p = eco_place_read(scene, group->place_first + dice_bits(r) % group->count);
	struct lod_place place;
	float inside[3];
	lod_place_instance(&place, &at, list, &p);
	for (int i = 0; i < 3; i++)
		inside[i] = body->center[i] + body->radius * (float)dice_real(r, -0.9, 0.9);
	lod_place_point(&place, inside, point);
	return true;
}

/* Eye and target: anywhere near and far, inside plants, on corners of the scene, beyond the horizon, straight
 * down with an up that is of no use. */
static void random_view(struct dice *r, const struct eco_scene *scene, struct eco_view *v)
{
	const struct eco_tile *root = &scene->tiles[scene->root];
	uint64_t kind = dice_bits(r) % 16;
	double reach = kind == 0 ? dice_power(r, 1, 5) : dice_power(r, -1, 1.5);
	for (int i = 0; i < 3; i++) {
		double middle = (root->low[i] + root->high[i]) / 2, half = (root->high[i] - root->low[i]) / 2
			+ 1e-3;
		v->target[i] = middle + half * dice_real(r, -1, 1);
		v->eye[i] = v->target[i] + half * reach * dice_real(r, -1, 1);
		v->up[i] = i == 2;
		if (kind == 1)
			v->eye[i] = dice_bits(r) % 2 ? root->low[i] : root->high[i];
		else if (kind == 2)
			v->target[i] = dice_bits(r) % 2 ? root->low[i] : root->high[i];
	}
	if (kind >= 3 && kind < 8 && random_in_plant(r, scene, v->eye) && kind < 5)
		random_in_plant(r, scene, v->target);
	if (kind == 8) {                     /* from a man's height, level */
		v->eye[2] = root->low[2] + dice_real(r, 0.5, 2.5);
		v->target[2] = v->eye[2];
	}
	if (kind == 9) {
		v->target[0] = v->eye[0];
		v->target[1] = v->eye[1];
		v->target[2] = v->eye[2] - dice_power(r, -3, 3);
	}
	if (dice_bits(r) % 8 == 0)
		for (int i = 0; i < 3; i++)
			v->up[i] = kind % 2 ? dice_real(r, -1, 1) : v->target[i] - v->eye[i];
	v->fov_y_deg = dice_bits(r) % 8 ? dice_real(r, 0.5, 150) : dice_bits(r) % 2 ? dice_power(r, -5, 0)
		: 180 - dice_power(r, -5, 1);
	v->width = (uint32_t)dice_power(r, 0, log10(4096.999));
	v->height = (uint32_t)dice_power(r, 0, log10(4096.999));
}

static uint64_t random_budget(struct dice *r)
{
	switch (dice_bits(r) % 20) {
	case 0: return dice_bits(r) % 4;
	case 1: return ECO_VERTICES_MAX;
	case 2: return (uint64_t)dice_power(r, 8, 15);
	default: return (uint64_t)dice_power(r, 0, 8);
	}
}

bool random_request(struct eco_request *request, const struct eco_scene *scene, uint64_t seed,
	uint64_t number)
{
	struct dice r = { seed * 0xD6E8FEB86659FD93u + number };
	dice_bits(&r);
	*request = (struct eco_request){ .bytes = ECO_BYTES_UNBOUNDED };
	random_view(&r, scene, &request->view);
	request->vertices = random_budget(&r);
	if (dice_bits(&r) % 4 == 0)
		request->bytes = (uint64_t)dice_power(&r, 1, 7.5);
	if (dice_bits(&r) % 8 == 0)
		request->ground_px = dice_power(&r, -2, 4);
	return eco_view_check(&request->view, NULL) == ECO_OK;
}

struct eco_view random_outlook(const struct eco_scene *scene, uint64_t seed, uint64_t number)
{
	struct dice r = { seed * 0x9E3779B97F4A7C15u + number };
	const struct eco_tile *root = &scene->tiles[scene->root];
	struct eco_view view = { .up = { 0, 0, 1 }, .width = 800, .height = 600 };
	double size = fmax(root->high[0] - root->low[0], root->high[1] - root->low[1]);
	dice_bits(&r);
	double away = dice_power(&r, log10(4), log10(fmax(8, 2 * size))), turn = dice_real(&r, 0, 6.28),
		up = dice_real(&r, 0.02, 1.3);
	view.fov_y_deg = dice_real(&r, 30, 65);
	for (int i = 0; i < 2; i++)
		view.target[i] = root->low[i] + (root->high[i] - root->low[i]) * dice_real(&r, 0.2, 0.8);
	view.target[2] = root->low[2] + fmin(8, 0.5 * (root->high[2] - root->low[2]));
	view.eye[0] = view.target[0] + away * cos(up) * cos(turn);
	view.eye[1] = view.target[1] + away * cos(up) * sin(turn);
	view.eye[2] = view.target[2] + away * sin(up);
	return view;
}

bool random_answer(const struct srv_scene *scene, const struct eco_request *request,
	const struct eco_holdings *holdings, uint64_t work_max, struct srv_body *body)
{
	struct srv_stream stream;
	struct eco_error error = { 0 };
	*body = (struct srv_body){ 0 };
	if (srv_stream_plan(&stream,
			&(struct srv_stream_input){ .scene = scene, .request = request,
			.holdings = holdings, .work_max = work_max }, &error))
		random_stop("planning", &error);
	bool fits = stream.fits;
	if (fits && srv_stream_write(&stream, body, &error))
		random_stop("writing", &error);
	srv_stream_free(&stream);
	return fits;
}
