#include "server/describe.h"

#include <jansson.h>
#include <stdio.h>

#include "ecofiles/format/ground_image.h"
#include "ecofiles/format/wire.h"
#include "lod/eye.h"
#include "server/request/query.h"

#define URL_BYTES 256

static const char *const kind_names[] = {
	[ECO_LIST_TRIANGLES] = "triangles", [ECO_LIST_LINES] = "lines", [ECO_LIST_POINTS] = "points",
	[ECO_LIST_INSTANCES] = "instances", [ECO_LIST_GROUND] = "ground",
	[ECO_LIST_IMAGE] = "image", [ECO_LIST_OUTLINE] = "outline", [ECO_LIST_GROUND_IMAGE] = "ground_image",
	[ECO_LIST_IMPOSTOR] = "impostor", [ECO_LIST_INVENTORY] = "inventory",
};

static const struct { uint32_t bit; const char *name; } need_names[] = {
	{ ECO_NEED_POINTS, "points" }, { ECO_NEED_LINES, "lines" }, { ECO_NEED_TRIANGLES, "triangles" },
	{ ECO_NEED_TEXTURES, "textures" }, { ECO_NEED_CUTOUTS, "cutouts" }, { ECO_NEED_GROUND, "ground" },
	{ ECO_NEED_CELLS, "cells" }, { ECO_NEED_SUMMARIES, "summaries" },
	{ ECO_NEED_PLACEMENTS, "placements" }, { ECO_NEED_SPLATS, "splats" },
	{ ECO_NEED_IMPOSTORS, "impostors" }, { ECO_NEED_GROUND_IMAGE, "ground_image" },
};

static void key_id(struct srv_json *json, const char *key, const struct eco_chunk_id *id)
{
	char text[SRV_ID_TEXT_BYTES];
	srv_format_id(text, id);
	srv_json_key_text(json, key, text);
}

static void key_url(struct srv_json *json, const char *key, const struct srv_scene *scene, const char *rest)
{
	char url[URL_BYTES];
	snprintf(url, sizeof url, "/v1/scenes/%s%s", scene->name, rest);
	srv_json_key_text(json, key, url);
}

/* Size of the PLAN frame's payload: the bytes of a view for a client that holds every chunk. */
static uint64_t plan_bytes(const struct eco_plan *plan)
{
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, plan);
	uint64_t size = w.size;
	eco_writer_free(&w);
	return size;
}

void srv_describe_health(struct srv_json *json, const struct srv_store *store)
{
	srv_json_open(json, '{');
	srv_json_key_text(json, "status", "ok");
	srv_json_key_count(json, "scenes", store->count);
	srv_json_close(json, '}');
}

void srv_describe_scenes(struct srv_json *json, const struct srv_store *store,
	bool (*may_see)(const struct srv_scene *scene, const void *ctx), const void *ctx)
{
	srv_json_open(json, '{');
	srv_json_key_open(json, "scenes", '[');
	for (uint32_t i = 0; i < store->count; i++) {
		const struct srv_scene *scene = store->scenes[i];
		if (may_see && !may_see(scene, ctx))
			continue;
		srv_json_open(json, '{');
		srv_json_key_text(json, "name", scene->name);
		key_id(json, "id", &scene->pack->id);
		srv_json_key_count(json, "instances", scene->pack->scene.tile_count
			? scene->pack->scene.tiles[scene->pack->scene.root].instance_count : 0);
		key_url(json, "href", scene, "");
		srv_json_close(json, '}');
	}
	srv_json_close(json, ']');
	srv_json_close(json, '}');
}

static void describe_needs(struct srv_json *json, uint32_t needs)
{
	srv_json_key_open(json, "needs", '[');
	for (size_t i = 0; i < sizeof need_names / sizeof *need_names; i++)
		if (needs & need_names[i].bit)
			srv_json_text(json, need_names[i].name);
	srv_json_close(json, ']');
}

static void describe_links(struct srv_json *json, const struct srv_scene *scene)
{
	srv_json_key_open(json, "links", '{');
	key_url(json, "self", scene, "");
	key_url(json, "plan", scene, "/plan{?eye,target,up,fov_y_deg,width,height,vertices,bytes,ground_px,"
		"texel_px,next_eye,next_target,name_from,rule,pack}");
	key_url(json, "stream", scene, "/stream{?eye,target,up,fov_y_deg,width,height,vertices,bytes,"
		"ground_px,texel_px,next_eye,next_target,name_from,rule,pack}");
	key_url(json, "chunk", scene, "/chunks/{id}");
	key_url(json, "plants", scene, "/plants/{list}{?first,count,pack}");
	key_url(json, "species", scene, "/species");
	srv_json_close(json, '}');
}

static void key_degrees(struct srv_json *json, const json_t *place, const char *key)
{
	srv_json_key_number(json, key, json_number_value(json_object_get(place, key)));
}

/* The scene's place on Earth, from the pack's META. null: the scene has its own coordinates only. */
static void describe_origin(struct srv_json *json, const json_t *meta)
{
	const json_t *origin = json_object_get(meta, "origin"), *place = json_object_get(meta, "place");
	const char *crs = json_string_value(json_object_get(meta, "crs"));
	double at[3];
	for (size_t i = 0; i < 3; i++)
		at[i] = json_number_value(json_array_get(origin, i));
	srv_json_key(json, "origin");
	if (crs && json_array_size(origin) == 3) {
		srv_json_open(json, '{');
		srv_json_key_text(json, "crs", crs);
		srv_json_key(json, "at");
		srv_json_point(json, at);
		srv_json_key_number(json, "height_m", at[2]);
		if (json_is_object(place)) {
			key_degrees(json, place, "longitude_deg");
			key_degrees(json, place, "latitude_deg");
			key_degrees(json, place, "convergence_deg");
		}
		srv_json_close(json, '}');
	} else {
		srv_json_null(json);
	}
}

/* null: none. */
static void key_cap(struct srv_json *json, const char *key, uint64_t most)
{
	srv_json_key(json, key);
	if (most == UINT64_MAX)
		srv_json_null(json);
	else
		srv_json_count(json, most);
}

/* null: without corners. */
static void key_box(struct srv_json *json, const char *key, const double *low, const double *high)
{
	srv_json_key(json, key);
	if (!low) {
		srv_json_null(json);
		return;
	}
	srv_json_open(json, '{');
	srv_json_key(json, "low");
	srv_json_point(json, low);
	srv_json_key(json, "high");
	srv_json_point(json, high);
	srv_json_close(json, '}');
}

void srv_describe_scene(struct srv_json *json, const struct srv_scene *scene, const struct srv_most *most)
{
	const struct eco_scene *tables = &scene->pack->scene;
	const struct eco_tile *root = tables->tile_count ? &tables->tiles[tables->root] : NULL;
	uint64_t payload_bytes = 0;
	for (uint32_t i = 0; i < tables->chunk_count; i++)
		payload_bytes += tables->chunks[i].size_bytes;
	srv_json_open(json, '{');
	srv_json_key_text(json, "name", scene->name);
	srv_json_key_text(json, "title", tables->name);
	key_id(json, "id", &scene->pack->id);
	srv_json_key_count(json, "plants", tables->plant_count);
	srv_json_key_count(json, "tiles", tables->tile_count);
	srv_json_key_count(json, "instances", root ? root->instance_count : 0);
	srv_json_key_count(json, "lists", tables->list_count);
	srv_json_key_count(json, "chunks", tables->chunk_count);
	srv_json_key_count(json, "payload_bytes", payload_bytes);
	key_box(json, "bounds", root ? root->low : NULL, root ? root->high : NULL);
	key_box(json, "look", root ? scene->outlook.low : NULL, root ? scene->outlook.high : NULL);
	srv_json_key_number(json, "near_m", tables->near_m);
	describe_origin(json, scene->meta);
	describe_needs(json, tables->needs);
	key_cap(json, "cap_vertices", most->vertices);
	key_cap(json, "cap_bytes", most->bytes);
	describe_links(json, scene);
	srv_json_close(json, '}');
}

/* ---- Plans ---- */

static void describe_prediction(struct srv_json *json, const struct eco_prediction *prediction)
{
	srv_json_key_open(json, "prediction", '{');
	srv_json_key_number(json, "tp_px", prediction->tp);
	srv_json_key_number(json, "fp_px", prediction->fp);
	srv_json_key_number(json, "fn_px", prediction->fn);
	srv_json_key_number(json, "q", eco_predicted_q(prediction));
	srv_json_close(json, '}');
}

static void describe_steps(struct srv_json *json, const struct srv_stream *stream)
{
	srv_json_key_open(json, "steps", '[');
	for (uint32_t i = 0; i < stream->step_count; i++) {
		srv_json_open(json, '{');
		srv_json_key_count(json, "vertices", stream->steps[i].plan.vertices);
		srv_json_key_count(json, "end_bytes", stream->steps[i].end_bytes);
		if (stream->input.scene->pack->scene.ground_count)
			srv_json_key_number(json, "ground_px", stream->steps[i].ground_px);
		srv_json_close(json, '}');
	}
	srv_json_close(json, ']');
}

static void describe_ground(struct srv_json *json, const struct srv_stream *stream)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	const struct srv_step *last = &stream->steps[stream->step_count - 1];
	uint64_t tiles = 0, bytes = 0;
	srv_json_key(json, "ground");
	if (!scene->ground_count) {
		srv_json_null(json);
		return;
	}
	for (uint32_t i = 0; i < last->plan.cut_count; i++) {
		const struct eco_list *list = &scene->lists[last->plan.cuts[i].list];
		if (list->kind != ECO_LIST_GROUND)
			continue;
		tiles++;
		bytes += scene->chunks[list->chunk_first].size_bytes;
	}
	srv_json_open(json, '{');
	srv_json_key_count(json, "tiles", tiles);
	srv_json_key_count(json, "chunk_bytes", bytes);
	srv_json_key_number(json, "ground_px", last->ground_px);
	srv_json_close(json, '}');
}

/* A texture may be nobody's. */
static void describe_plant(struct srv_json *json, const struct eco_scene *scene, const struct eco_cut *cut)
{
	uint32_t plant = scene->lists[cut->list].owner;
	srv_json_key_text(json, "plant", plant < scene->plant_count ? scene->plants[plant].name : NULL);
}

/* Whom a cut is for: nobody (ground), all of a plant that have a texture, a tile's own list in its placement,
 * or instances of a plant by distance and share. */
static void describe_who(struct srv_json *json, const struct eco_scene *scene, const struct eco_cut *cut)
{
	srv_json_key_open(json, "who", '{');
	if (cut->anchor == ECO_NONE) {
		srv_json_key_count(json, "placement", cut->placement);
		if (scene->lists[cut->list].kind == ECO_LIST_IMAGE
				|| scene->lists[cut->list].kind == ECO_LIST_OUTLINE)
			describe_plant(json, scene, cut);
		else if (scene->lists[cut->list].kind == ECO_LIST_GROUND_IMAGE)
			srv_json_key_figure(json, "texel_m",
				eco_ground_image_texel_m(&scene->lists[cut->list], cut->end));
		else if (scene->lists[cut->list].kind != ECO_LIST_GROUND)
			srv_json_key_count(json, "tile", scene->lists[cut->list].owner);
		else
			srv_json_key_count(json, "level", scene->lists[cut->list].level);
	} else {
		describe_plant(json, scene, cut);
		srv_json_key_count(json, "anchor", cut->anchor);
		srv_json_key_count(json, "band_first", cut->band_first);
		srv_json_key_count(json, "band_end", cut->band_end);
		srv_json_key_figure(json, "distance_first_m", lod_band_distance_m(cut->band_first));
		srv_json_key_figure(json, "distance_last_m",
			lod_band_distance_m((uint8_t)(cut->band_end - 1)));
		srv_json_key_figure(json, "share_first", (double)cut->share_first / ECO_SHARE_ONE);
		srv_json_key_figure(json, "share_end", (double)cut->share_end / ECO_SHARE_ONE);
	}
	srv_json_close(json, '}');
}

static void describe_cuts(struct srv_json *json, const struct eco_scene *scene, const struct eco_plan *plan)
{
	srv_json_key_open(json, "cuts", '[');
	for (uint32_t i = 0; i < plan->cut_count && !json->out.failed; i++) {
		const struct eco_cut *cut = &plan->cuts[i];
		uint8_t kind = scene->lists[cut->list].kind;
		srv_json_open(json, '{');
		srv_json_key_count(json, "list", cut->list);
		srv_json_key_text(json, "kind", kind < sizeof kind_names / sizeof *kind_names
			? kind_names[kind] : NULL);
		srv_json_key_count(json, "first", cut->first);
		srv_json_key_count(json, "end", cut->end);
		srv_json_key_count(json, "of", scene->lists[cut->list].primitive_count);
		if (scene->lists[cut->list].partner != ECO_NONE)
			srv_json_key_count(json, "form_of", scene->lists[cut->list].partner);
		srv_json_key_figure(json, "scale", (double)cut->scale);
		describe_who(json, scene, cut);
		srv_json_close(json, '}');
	}
	srv_json_close(json, ']');
}

static void describe_placements(struct srv_json *json, const struct eco_plan *plan)
{
	srv_json_key_open(json, "placements", '[');
	for (uint32_t i = 0; i < plan->placement_count && !json->out.failed; i++) {
		srv_json_open(json, '{');
		srv_json_key(json, "at");
		srv_json_point(json, plan->placements[i].at);
		srv_json_key_number(json, "turn_deg", plan->placements[i].turn * (360.0 / 65536));
		srv_json_key_number(json, "scale", plan->placements[i].scale);
		srv_json_key_count(json, "path", plan->placements[i].path);
		srv_json_close(json, '}');
	}
	srv_json_close(json, ']');
}

static void describe_runs(struct srv_json *json, const struct eco_plan *plan)
{
	srv_json_key_open(json, "runs", '[');
	for (uint32_t i = 0; i < plan->run_count && !json->out.failed; i++) {
		srv_json_open(json, '{');
		srv_json_key_count(json, "placement", plan->runs[i].placement);
		srv_json_key_count(json, "list_first", plan->runs[i].list_first);
		srv_json_key_count(json, "list_end", plan->runs[i].list_end);
		srv_json_key_count(json, "left", plan->runs[i].left);
		srv_json_close(json, '}');
	}
	srv_json_close(json, ']');
}

static void describe_gates(struct srv_json *json, const struct eco_scene *scene, const struct eco_plan *plan)
{
	srv_json_key_open(json, "gates", '[');
	for (uint32_t i = 0; i < plan->gate_count && !json->out.failed; i++) {
		uint32_t plant = plan->gates[i].plant;
		srv_json_open(json, '{');
		srv_json_key_text(json, "plant", plant < scene->plant_count ? scene->plants[plant].name
			: NULL);
		srv_json_key_count(json, "band", plan->gates[i].end / ECO_SHARE_ONE);
		srv_json_key_count(json, "share", plan->gates[i].end % ECO_SHARE_ONE);
		srv_json_close(json, '}');
	}
	srv_json_close(json, ']');
}

static void describe_row(struct srv_json *json, const struct eco_scene *scene,
	const struct lod_explanation *why, const struct lod_explained *row)
{
	char reason[128];
	lod_explain_text(reason, sizeof reason, why, row);
	srv_json_open(json, '{');
	if (row->cut.list != ECO_NONE) {
		srv_json_key_count(json, "list", row->cut.list);
		srv_json_key_count(json, "first", row->cut.first);
		srv_json_key_count(json, "end", row->cut.end);
	}
	if (row->tile != ECO_NONE)
		srv_json_key_count(json, "tile", row->tile);
	if (row->plant != ECO_NONE) {
		srv_json_key_text(json, "plant", scene->plants[row->plant].name);
		srv_json_key_count(json, "band", row->cut.band_first);
		srv_json_key_figure(json, "distance_m", lod_band_distance_m(row->cut.band_first));
		srv_json_key_figure(json, "share_first", (double)row->cut.share_first / ECO_SHARE_ONE);
		srv_json_key_figure(json, "share_end", (double)row->cut.share_end / ECO_SHARE_ONE);
	}
	srv_json_key_count(json, "plants", row->plants);
	srv_json_key_count(json, "vertices", row->vertices);
	srv_json_key_figure(json, "gain_px", row->reason.gain);
	srv_json_key_figure(json, "next_lambda", row->reason.next);
	srv_json_key_text(json, "why", lod_why_names[row->reason.why]);
	srv_json_key_text(json, "reason", reason);
	srv_json_close(json, '}');
}

static void describe_explanation(struct srv_json *json, const struct eco_scene *scene,
	const struct lod_explanation *why)
{
	srv_json_key_open(json, "explanation", '{');
	srv_json_key_figure(json, "lambda", why->lambda);
	srv_json_key_count(json, "omitted", why->omitted);
	srv_json_key_open(json, "rows", '[');
	for (uint32_t i = 0; i < why->count && !json->out.failed; i++)
		describe_row(json, scene, why, &why->rows[i]);
	srv_json_close(json, ']');
	srv_json_close(json, '}');
}

void srv_describe_plan(struct srv_json *json, const struct srv_stream *stream)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	const struct eco_request *request = stream->input.request;
	const struct srv_step *last = &stream->steps[stream->step_count - 1];
	const struct eco_plan *plan = &last->plan;
	srv_json_open(json, '{');
	srv_json_key_text(json, "scene", stream->input.scene->name);
	key_id(json, "pack", &stream->input.scene->pack->id);
	srv_json_key_count(json, "budget_vertices", request->vertices);
	srv_json_key(json, "budget_bytes");
	if (request->bytes == ECO_BYTES_UNBOUNDED)
		srv_json_null(json);
	else
		srv_json_count(json, request->bytes);
	srv_json_key_bool(json, "fits", stream->fits);
	srv_json_key_count(json, "bytes", stream->body_bytes);
	srv_json_key_count(json, "next_bytes", stream->next_bytes);
	srv_json_key_count(json, "chunks", stream->chunk_count);
	srv_json_key_count(json, "chunk_bytes", stream->chunk_bytes);
	srv_json_key_count(json, "named_bytes", stream->named_bytes);
	srv_json_key_count(json, "vertices", plan->vertices);
	srv_json_key_count(json, "visible_plants", plan->visible_plants);
	srv_json_key_count(json, "plan_bytes", plan_bytes(plan));
	srv_json_key_number(json, "sample_distance_rad", plan->sample_distance);
	describe_prediction(json, &plan->prediction);
	describe_ground(json, stream);
	describe_steps(json, stream);
	describe_placements(json, plan);
	describe_runs(json, plan);
	describe_gates(json, scene, plan);
	describe_cuts(json, scene, plan);
	if (stream->input.explain)
		describe_explanation(json, scene, &last->why);
	srv_json_close(json, '}');
}
