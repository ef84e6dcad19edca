/* The end of libecostream where pictures are: the store of ecoview, fed by hand, and what its plan draws.
 * Draws are the plan's cuts, with the instances that view_select_make finds for each; tiles of the ground
 * follow. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/library/ecostream_status.h"
#include "client-min/view_select.h"
#include "lod/scattered.h"

struct ecostream_client {
	struct view_store *store;
	struct eco_wire_parser *parser;  /* of the current stream, or NULL */
};

enum ecostream_code ecostream_client_new(struct ecostream_client **out, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct ecostream_client *client = calloc(1, sizeof *client);
	enum eco_code code = client ? view_store_new(&client->store, &(struct view_store_options){ 0 }, &own)
		: eco_no_memory(&own, "a client");
	if (code) {
		free(client);
		client = NULL;
	}
	*out = client;
	return library_done(error, code, &own);
}

static void end_stream(struct ecostream_client *client)
{
	eco_wire_parser_free(client->parser);
	client->parser = NULL;
}

void ecostream_client_free(struct ecostream_client *client)
{
	if (!client)
		return;
	end_stream(client);
	view_store_free(client->store);
	free(client);
}

enum ecostream_code ecostream_client_holdings(const struct ecostream_client *client, void **bytes,
	size_t *size, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct eco_writer writer = { 0 };
	*bytes = NULL;
	*size = 0;
	enum eco_code code = view_store_write_holdings(client->store, &writer, &own);
	if (code) {
		eco_writer_free(&writer);
		return library_done(error, code, &own);
	}
	*bytes = writer.bytes;
	*size = writer.size;
	return ECOSTREAM_OK;
}

enum ecostream_code ecostream_client_begin(struct ecostream_client *client, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	end_stream(client);
	view_store_begin(client->store);
	return library_done(error, eco_wire_parser_new(&client->parser, &view_store_events, client->store,
		&own), &own);
}

static enum eco_code not_begun(struct eco_error *error)
{
	return eco_fail(error, ECO_BAD_USAGE, "no stream has begun: ecostream_client_begin comes first");
}

enum ecostream_code ecostream_client_feed(struct ecostream_client *client, const void *bytes, size_t size,
	struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code = client->parser ? eco_wire_feed(client->parser, bytes, size, &own)
		: not_begun(&own);
	return library_done(error, code, &own);
}

enum ecostream_code ecostream_client_end(struct ecostream_client *client, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code = client->parser ? eco_wire_finish(client->parser, &own) : not_begun(&own);
	uint64_t vertices;
	if (!code && view_store_again(client->store, &vertices))
		code = eco_fail(&own, ECO_TOO_LARGE,
			"the cache evicted data that the plan needs: ask again with the current holdings, "
			"or for fewer vertices");
	end_stream(client);
	return library_done(error, code, &own);
}

/* ---- Pictures ---- */

struct ecostream_picture {
	const struct view_store *store;
	const struct eco_plan *plan;
	struct view_selection selection;
	uint32_t *cuts;                  /* of the plan, that are drawn: not those of ground and textures */
	uint32_t count;
};

static const struct view_list *list_of(const struct ecostream_picture *picture, uint32_t draw)
{
	return view_store_list(picture->store, picture->plan->cuts[picture->cuts[draw]].list);
}

static enum eco_code make(struct ecostream_picture *picture, const struct eco_view *view,
	struct eco_error *error)
{
	struct lod_eye eye;
	if (!picture->plan)
		return eco_fail(error, ECO_NOT_FOUND, "no plan has come: feed a stream, up to its first plan "
			"or on");
	ECO_PASS(eco_view_check(view, error));
	picture->cuts = calloc(picture->plan->cut_count + (size_t)1, sizeof *picture->cuts);
	if (!picture->cuts)
		return eco_no_memory(error, "a picture");
	for (uint32_t i = 0; i < picture->plan->cut_count; i++) {
		picture->cuts[picture->count] = i;
		picture->count += eco_list_vertices(&list_of(picture, picture->count)->list) > 0;
	}
	lod_eye_make(&eye, view);
	return view_select_make(&picture->selection, picture->store, &eye, error);
}

enum ecostream_code ecostream_picture_make(struct ecostream_picture **out,
	const struct ecostream_client *client, const struct ecostream_request *request,
	struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct eco_view view = library_view_of(request);
	struct ecostream_picture *picture = calloc(1, sizeof *picture);
	*out = NULL;
	if (!picture)
		return library_done(error, eco_no_memory(&own, "a picture"), &own);
	picture->store = client->store;
	picture->plan = view_store_plan(client->store);
	enum eco_code code = make(picture, &view, &own);
	if (code)
		ecostream_picture_free(picture);
	else
		*out = picture;
	return library_done(error, code, &own);
}

void ecostream_picture_free(struct ecostream_picture *picture)
{
	if (!picture)
		return;
	view_select_free(&picture->selection);
	free(picture->cuts);
	free(picture);
}

/* ---- Draws ---- */

uint32_t ecostream_picture_draws(const struct ecostream_picture *picture)
{
	return picture->count + picture->selection.ground.count;
}

static enum ecostream_kind kind_of(const struct eco_list *list)
{
	switch (list->kind) {
	case ECO_LIST_TRIANGLES: return ECOSTREAM_TRIANGLES;
	case ECO_LIST_LINES: return ECOSTREAM_LINES;
	case ECO_LIST_IMPOSTOR: return ECOSTREAM_IMPOSTORS;
	default: return list->attributes & ECO_ATTR_SPLAT ? ECOSTREAM_ELLIPSOIDS : ECOSTREAM_POINTS;
	}
}

static const uint32_t *members_of(const struct ecostream_picture *picture, uint32_t draw, uint32_t *count)
{
	const uint32_t *first = &picture->selection.member_first[picture->cuts[draw]];
	*count = first[1] - first[0];
	return picture->selection.members + first[0];
}

void ecostream_picture_draw(const struct ecostream_picture *picture, uint32_t draw,
	struct ecostream_draw *info)
{
	*info = (struct ecostream_draw){ .kind = ECOSTREAM_GROUND, .places = 1 };
	if (draw >= picture->count) {
		const struct view_ground *ground = &picture->selection.ground;
		info->primitives = view_ground_triangles(ground, &ground->tiles[draw - picture->count], NULL);
		return;
	}
	const struct eco_cut *cut = &picture->plan->cuts[picture->cuts[draw]];
	const struct eco_list *list = &list_of(picture, draw)->list;
	const struct view_plant *plant = cut->anchor == ECO_NONE ? NULL : view_store_plant(picture->store,
		list->owner);
	info->kind = kind_of(list);
	info->primitives = (uint32_t)eco_cut_primitives(cut);
	members_of(picture, draw, &info->places);
	info->vertices = (uint64_t)info->primitives * info->places * eco_list_vertices(list);
	if (plant)
		memcpy(info->plant, plant->plant.name, sizeof info->plant);
}

static void put_place(struct ecostream_place *out, const struct lod_place *place)
{
	memcpy(out->at, place->at, sizeof out->at);
	out->sine = place->sine;
	out->cosine = place->cosine;
	out->scale = place->scale;
}

void ecostream_picture_places(const struct ecostream_picture *picture, uint32_t draw,
	struct ecostream_place *places)
{
	if (draw >= picture->count) {
		struct lod_place ground = { .cosine = 1, .scale = 1 };
		memcpy(ground.at, picture->selection.ground.at, sizeof ground.at);
		put_place(places, &ground);
		return;
	}
	uint32_t count;
	const uint32_t *members = members_of(picture, draw, &count);
	for (uint32_t i = 0; i < count; i++)
		put_place(&places[i], &picture->selection.instances[members[i]].place);
}

/* ---- Geometry ---- */

struct owned { struct lod_geometry made; float *radii; uint8_t *rgb; };

static bool make_ground(struct owned *owned, const struct view_ground *ground,
	const struct view_ground_tile *tile)
{
	owned->made.position = malloc(view_ground_triangles(ground, tile, NULL) * 9 * sizeof(float));
	if (owned->made.position)
		view_ground_triangles(ground, tile, owned->made.position);
	return owned->made.position != NULL;
}

static const struct lod_impostor *impostor_of(const struct ecostream_picture *picture, uint32_t draw)
{
	return &list_of(picture, draw)->impostors[picture->plan->cuts[picture->cuts[draw]].first];
}

static bool make_ball(struct owned *owned, const struct lod_impostor *impostor)
{
	owned->made.position = malloc(3 * sizeof(float));
	owned->radii = malloc(sizeof(float));
	if (!owned->made.position || !owned->radii)
		return false;
	memcpy(owned->made.position, impostor->body.center, 3 * sizeof(float));
	*owned->radii = impostor->radius;
	return true;
}

static void put_colours(struct owned *owned, const struct view_list *list, uint32_t count)
{
	static const uint8_t white[3] = { 255, 255, 255 };
	for (uint32_t i = 0; i < count; i++) {
		int32_t color = owned->made.color[i];
		memcpy(owned->rgb + 3 * (size_t)i, color < 0 ? white : list->palette[color], 3);
	}
}

/* Discs of the points' radii have the area that the list and the cut say. */
static void put_radii(struct owned *owned, const struct eco_list *list, float scale, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		owned->radii[i] = sqrtf(list->unit_area * scale / (float)M_PI
			* (owned->made.size ? owned->made.size[i] : 1));
}

static bool make_list(struct owned *owned, const struct view_list *list, const struct eco_cut *cut)
{
	uint32_t points = cut->end - cut->first, count = points << cut->halvings;
	owned->rgb = malloc((size_t)count * 3);
	owned->radii = malloc((size_t)count * sizeof *owned->radii);
	if (!owned->rgb || !owned->radii || !lod_geometry_make(&owned->made, &list->list, count, false))
		return false;
	lod_list_geometry(&list->list, &list->elements, cut->first, cut->end, cut->scale, &owned->made);
	lod_scatter(&owned->made, points, cut->first, cut->halvings, lod_ball_radius(&list->list, cut->scale));
	put_colours(owned, list, count);
	put_radii(owned, &list->list, ldexpf(cut->scale, -cut->halvings), count);
	return true;
}

static bool make_geometry(struct owned *owned, const struct ecostream_picture *picture, uint32_t draw,
	enum ecostream_kind kind)
{
	const struct view_ground *ground = &picture->selection.ground;
	if (kind == ECOSTREAM_GROUND)
		return make_ground(owned, ground, &ground->tiles[draw - picture->count]);
	if (kind == ECOSTREAM_IMPOSTORS)
		return make_ball(owned, impostor_of(picture, draw));
	return make_list(owned, list_of(picture, draw), &picture->plan->cuts[picture->cuts[draw]]);
}

enum ecostream_code ecostream_picture_geometry(const struct ecostream_picture *picture, uint32_t draw,
	struct ecostream_geometry *geometry, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct ecostream_draw info;
	struct owned *owned = calloc(1, sizeof *owned);
	*geometry = (struct ecostream_geometry){ .owned = owned };
	ecostream_picture_draw(picture, draw, &info);
	if (!owned || !make_geometry(owned, picture, draw, info.kind)) {
		ecostream_geometry_free(geometry);
		return library_done(error, eco_no_memory(&own, "geometry"), &own);
	}
	bool balls = info.kind == ECOSTREAM_POINTS || info.kind == ECOSTREAM_IMPOSTORS;
	*geometry = (struct ecostream_geometry){ info.primitives, owned->made.position,
		balls ? owned->radii : owned->made.width, owned->made.half, owned->made.opacity, owned->rgb,
		owned };
	return ECOSTREAM_OK;
}

void ecostream_geometry_free(struct ecostream_geometry *geometry)
{
	struct owned *owned = geometry->owned;
	if (owned) {
		lod_geometry_free(&owned->made);
		free(owned->radii);
		free(owned->rgb);
	}
	free(owned);
	*geometry = (struct ecostream_geometry){ .primitives = 0 };
}

void ecostream_picture_look(const struct ecostream_picture *picture, uint32_t draw, const float eye[3],
	const float *rays, uint32_t count, float *along, uint8_t *rgb)
{
	const struct lod_impostor *impostor = impostor_of(picture, draw);
	struct lod_impostor_look look;
	float from[3];
	for (int k = 0; k < 3; k++)
		from[k] = eye[k] - impostor->body.center[k];
	lod_impostor_look(&look, impostor, from);
	for (uint32_t i = 0; i < count; i++) {
		struct lod_impostor_hit hit;
		bool met = lod_impostor_hit(impostor, &look, rays + 3 * (size_t)i, &hit);
		along[i] = met ? hit.along : INFINITY;
		if (met)
			memcpy(rgb + 3 * (size_t)i, impostor->rgb[hit.cell], 3);
	}
}
