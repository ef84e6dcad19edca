#include "server/exchange.h"

#include <jansson.h>

#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/wire.h"
#include "lod/eye.h"

static const char *const kind_names[] = {
	[ECO_LIST_TRIANGLES] = "triangles", [ECO_LIST_LINES] = "lines", [ECO_LIST_POINTS] = "points",
	[ECO_LIST_INSTANCES] = "instances", [ECO_LIST_GROUND] = "ground",
	[ECO_LIST_IMAGE] = "image", [ECO_LIST_OUTLINE] = "outline", [ECO_LIST_GROUND_IMAGE] = "ground_image",
	[ECO_LIST_IMPOSTOR] = "impostor", [ECO_LIST_INVENTORY] = "inventory",
};

/* by their bits, from the lowest on */
static const char *const need_names[] = { "points", "lines", "triangles", "textures", "cutouts", "ground", "cells",
	"summaries", "placements", "splats", "impostors", "ground_image", "widths", "tints", "water" };

static struct eco_id_text pack_id(const struct srv_scene *scene) { return eco_id_text(scene->pack->id.bytes); }

/* NULL: a plant that is not there. */
static const char *plant_name(const struct eco_scene *scene, uint32_t plant)
{
	return plant < scene->plant_count ? scene->plants[plant].name : NULL;
}

static uint64_t instances_of(const struct eco_scene *scene)
{
	return scene->tile_count ? scene->tiles[scene->root].instance_count : 0;
}

/* The season of all plants of the library, if `ecopack make --season` named one. */
static void describe_season(struct srv_json *json, const json_t *meta)
{
	const char *season = json_string_value(json_object_get(meta, "season"));
	if (season)
		srv_json_add(json, "season:%s", season);
}

void srv_describe_scenes(struct srv_json *json, const struct srv_store *store,
	bool (*may_see)(const struct srv_scene *scene, const void *ctx), const void *ctx)
{
	char url[SRV_NAME_BYTES + 16];
	srv_json_add(json, "{scenes:[");
	for (uint32_t i = 0; i < store->count; i++) {
		const struct srv_scene *scene = store->scenes[i];
		if (may_see && !may_see(scene, ctx))
			continue;
		snprintf(url, sizeof url, "/v1/scenes/%s", scene->name);
		srv_json_add(json, "{name:%s title:%s id:%s instances:%lu href:%s", scene->name, scene->pack->scene.name,
			pack_id(scene).hex, instances_of(&scene->pack->scene), url);
		describe_season(json, scene->meta);
		srv_json_add(json, "}");
	}
	srv_json_add(json, "]}");
}

static void describe_needs(struct srv_json *json, uint32_t needs)
{
	srv_json_add(json, "needs:[");
	for (size_t i = 0; i < sizeof need_names / sizeof *need_names; i++)
		if (needs >> i & 1)
			srv_json_add(json, "%s", need_names[i]);
	srv_json_add(json, "]");
}

#define VIEW_PARAMETERS "{?eye,target,up,fov_y_deg,width,height,vertices,bytes,ground_px,texel_px,next_eye," \
	"next_target,name_from,rule,pack}"

static void describe_links(struct srv_json *json, const struct srv_scene *scene)
{
	static const char *const links[][2] = { { "self:%s", "" }, { "plan:%s", "/plan" VIEW_PARAMETERS },
		{ "stream:%s", "/stream" VIEW_PARAMETERS }, { "chunk:%s", "/chunks/{id}" },
		{ "plants:%s", "/plants/{list}{?first,count,pack}" }, { "find:%s", "/find{?text,first,count,pack}" },
		{ "species:%s", "/species" } };
	char url[SRV_NAME_BYTES + sizeof VIEW_PARAMETERS + 24];
	srv_json_add(json, "links:{");
	for (size_t i = 0; i < sizeof links / sizeof *links; i++) {
		snprintf(url, sizeof url, "/v1/scenes/%s%s", scene->name, links[i][1]);
		srv_json_add(json, links[i][0], url);
	}
	srv_json_add(json, "}");
}

static double number_in(const json_t *object, const char *key)
{
	return json_number_value(json_object_get(object, key));
}

/* "": there is none. */
static const char *text_in(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

/* The scene's place on Earth, from the pack's META. null: the scene has its own coordinates only. */
static void describe_origin(struct srv_json *json, const json_t *meta)
{
	const json_t *origin = json_object_get(meta, "origin"), *place = json_object_get(meta, "place");
	const char *crs = json_string_value(json_object_get(meta, "crs"));
	double at[3];
	for (size_t i = 0; i < 3; i++)
		at[i] = json_number_value(json_array_get(origin, i));
	if (!crs || json_array_size(origin) != 3) {
		srv_json_add(json, "origin:null");
		return;
	}
	srv_json_add(json, "origin:{crs:%s at:[%g %g %g] height_m:%g", crs, at[0], at[1], at[2], at[2]);
	if (json_is_object(place))
		srv_json_add(json, "longitude_deg:%g latitude_deg:%g convergence_deg:%g", number_in(place,
			"longitude_deg"), number_in(place, "latitude_deg"), number_in(place, "convergence_deg"));
	srv_json_add(json, "}");
}

/* By the pack's META: columns of inventories and their classes. */
static void describe_tints(struct srv_json *json, const json_t *meta)
{
	const json_t *tint, *class;
	size_t t, c;
	srv_json_add(json, "tints:[");
	json_array_foreach(json_object_get(meta, "tints"), t, tint) {
		srv_json_add(json, "{column:%s classes:[", text_in(tint, "column"));
		json_array_foreach(json_object_get(tint, "classes"), c, class) {
			json_int_t plants = json_integer_value(json_object_get(class, "plants"));
			srv_json_add(json, "{name:%s color:%s plants:%lu}", text_in(class, "name"),
				json_string_value(json_object_get(class, "color")), plants > 0 ? (uint64_t)plants : 0);
		}
		srv_json_add(json, "]}");
	}
	srv_json_add(json, "]");
}

/* Classes that are drawn on the ground, where there are some. */
static void describe_drawn(struct srv_json *json, const json_t *drawn)
{
	const json_t *class;
	size_t i;
	if (!drawn)
		return;
	srv_json_add(json, "drawn:[");
	json_array_foreach(drawn, i, class)
		srv_json_add(json, "{name:%s color:%s features:%lu}", text_in(class, "name"), text_in(class, "color"),
			(uint64_t)json_integer_value(json_object_get(class, "features")));
	srv_json_add(json, "]");
}

static void describe_columns(struct srv_json *json, const json_t *meta)
{
	const json_t *columns = json_object_get(meta, "columns"), *name;
	size_t i;
	if (!json_array_size(columns))
		return;
	srv_json_add(json, "columns:[");
	json_array_foreach(columns, i, name)
		srv_json_add(json, "%s", json_string_value(name));
	srv_json_add(json, "]");
}

static void describe_box(struct srv_json *json, const double *low, const double *high)
{
	srv_json_add(json, "{low:[%g %g %g] high:[%g %g %g]}", low[0], low[1], low[2], high[0], high[1], high[2]);
}

void srv_describe_scene(struct srv_json *json, const struct srv_scene *scene, const struct srv_most *most)
{
	const struct eco_scene *tables = &scene->pack->scene;
	const struct eco_tile *root = tables->tile_count ? &tables->tiles[tables->root] : NULL;
	uint64_t payload_bytes = 0;
	for (uint32_t i = 0; i < tables->chunk_count; i++)
		payload_bytes += tables->chunks[i].size_bytes;
	srv_json_add(json, "{name:%s title:%s id:%s plants:%u tiles:%u instances:%lu lists:%u chunks:%u",
		scene->name, tables->name, pack_id(scene).hex, tables->plant_count, tables->tile_count,
		instances_of(tables), tables->list_count, tables->chunk_count);
	srv_json_add(json, "payload_bytes:%lu", payload_bytes);
	if (root) {
		srv_json_add(json, "bounds:");
		describe_box(json, root->low, root->high);
		srv_json_add(json, "look:");
		describe_box(json, scene->outlook.low, scene->outlook.high);
	} else {
		srv_json_add(json, "bounds:null look:null");
	}
	srv_json_add(json, "near_m:%g draft:%d", (double)tables->near_m, json_is_true(json_object_get(scene->meta, "draft")));
	describe_origin(json, scene->meta);
	describe_needs(json, tables->needs);
	if (tables->needs & ECO_NEED_TINTS)
		describe_tints(json, scene->meta);
	describe_drawn(json, json_object_get(scene->meta, "drawn"));
	describe_columns(json, scene->meta);
	describe_season(json, scene->meta);
	if (*text_in(scene->meta, "date"))
		srv_json_add(json, "date:%s", text_in(scene->meta, "date"));
	srv_json_add(json, "cap_vertices:%lx cap_bytes:%lx", most->vertices, most->bytes);
	describe_links(json, scene);
	srv_json_add(json, "}");
}

/* ---- Species ---- */

static void describe_species(struct srv_json *json, const char *species, json_int_t plants)
{
	srv_json_add(json, "{species:%s", species);
	if (plants > 0)
		srv_json_add(json, "plants:%lu", (uint64_t)plants);
	srv_json_add(json, "}");
}

/* said: {"of": number of species, "most": [[name or null, plants], ...]}; NULL: nothing. The number is
 * at least that of the species named. */
static void describe_stood_for(struct srv_json *json, const char *plant, const json_t *said, bool object)
{
	const json_t *most = json_object_get(said, "most"), *one;
	uint64_t named = json_array_size(most), i, least = named ? named : 1;
	json_int_t of = json_integer_value(json_object_get(said, "of"));
	srv_json_add(json, "{plant:%s species_count:%lu species:[", plant, of > (json_int_t)least ? (uint64_t)of : least);
	if (!named)
		describe_species(json, plant, 0);
	json_array_foreach(most, i, one)
		describe_species(json, json_string_value(json_array_get(one, 0)),
			json_integer_value(json_array_get(one, 1)));
	srv_json_add(json, "]");
	if (object)
		srv_json_add(json, "object:%d", true);
	srv_json_add(json, "}");
}

void srv_describe_species(struct srv_json *json, const struct srv_scene *scene)
{
	const json_t *plants = json_object_get(scene->meta, "plants");
	srv_json_add(json, "{pack:%s plants:[", pack_id(scene).hex);
	for (uint32_t i = 0; i < scene->pack->scene.plant_count; i++) {
		const json_t *plant = json_array_get(plants, i);
		describe_stood_for(json, scene->pack->scene.plants[i].name, json_object_get(plant, "species"),
			json_is_true(json_object_get(plant, "object")));
	}
	srv_json_add(json, "]}");
}

/* ---- Plans ---- */

static void describe_ground(struct srv_json *json, const struct eco_scene *scene, const struct srv_step *last)
{
	uint32_t tiles = 0;
	uint64_t bytes = 0;
	for (uint32_t i = 0; i < last->plan.cut_count; i++) {
		const struct eco_list *list = &scene->lists[last->plan.cuts[i].list];
		if (list->kind != ECO_LIST_GROUND)
			continue;
		tiles++;
		bytes += scene->chunks[list->chunk_first].size_bytes;
	}
	if (scene->ground_count)
		srv_json_add(json, "ground:{tiles:%u chunk_bytes:%lu ground_px:%g}", tiles, bytes, last->plan.ground_px);
	else
		srv_json_add(json, "ground:null");
}

static void describe_steps(struct srv_json *json, const struct srv_stream *stream)
{
	srv_json_add(json, "steps:[");
	for (uint32_t i = 0; i < stream->step_count; i++) {
		const struct srv_step *step = &stream->steps[i];
		srv_json_add(json, "{vertices:%lu end_bytes:%lu", step->plan.vertices, step->end_bytes);
		if (stream->input.scene->pack->scene.ground_count)
			srv_json_add(json, "ground_px:%g", step->plan.ground_px);
		srv_json_add(json, "}");
	}
	srv_json_add(json, "]");
}

/* Owner of a list without an anchor: a plant, which a texture may lack, a tile, or a level of ground. */
static void describe_owner(struct srv_json *json, const struct eco_scene *scene, const struct eco_cut *cut)
{
	const struct eco_list *list = &scene->lists[cut->list];
	if (list->kind == ECO_LIST_IMAGE || list->kind == ECO_LIST_OUTLINE)
		srv_json_add(json, "plant:%s", plant_name(scene, list->owner));
	else if (list->kind == ECO_LIST_GROUND_IMAGE)
		srv_json_add(json, "texel_m:%.9g", eco_ground_image_texel_m(list, cut->end));
	else if (list->kind == ECO_LIST_GROUND)
		srv_json_add(json, "level:%u", list->level);
	else
		srv_json_add(json, "tile:%u", list->owner);
}

static double share_of(uint32_t share)
{
	return (double)share / ECO_SHARE_ONE;
}

/* Whom a cut is for: nobody (ground), all of a plant that have a texture, a tile's own list in its placement,
 * or instances of a plant by distance and share. */
static void describe_who(struct srv_json *json, const struct eco_scene *scene, const struct eco_cut *cut)
{
	srv_json_add(json, "who:{");
	if (cut->anchor == ECO_NONE) {
		srv_json_add(json, "placement:%u", cut->placement);
		describe_owner(json, scene, cut);
	} else {
		srv_json_add(json, "plant:%s anchor:%u band_first:%u band_end:%u distance_first_m:%.9g "
			"distance_last_m:%.9g share_first:%.9g share_end:%.9g", plant_name(scene,
			scene->lists[cut->list].owner), cut->anchor, cut->band_first, cut->band_end,
			lod_band_distance_m(cut->band_first), lod_band_distance_m((uint8_t)(cut->band_end -
			1)), share_of(cut->share_first), share_of(cut->share_end));
	}
	srv_json_add(json, "}");
}

static void describe_cut(struct srv_json *json, const struct eco_scene *scene, const struct eco_cut *cut)
{
	const struct eco_list *list = &scene->lists[cut->list];
	srv_json_add(json, "{list:%u kind:%s first:%u end:%u of:%u", cut->list,
		list->kind < sizeof kind_names / sizeof *kind_names ? kind_names[list->kind] : NULL,
		cut->first, cut->end, list->primitive_count);
	if (list->partner != ECO_NONE)
		srv_json_add(json, "form_of:%u", list->partner);
	srv_json_add(json, "scale:%.9g", (double)cut->scale);
	describe_who(json, scene, cut);
	srv_json_add(json, "}");
}

static void describe_tables(struct srv_json *json, const struct eco_scene *scene, const struct eco_plan *plan)
{
	srv_json_add(json, "placements:[");
	for (uint32_t i = 0; i < plan->placement_count && !json->out.failed; i++) {
		const struct eco_placement *at = &plan->placements[i];
		srv_json_add(json, "{at:[%g %g %g] turn_deg:%g scale:%g path:%lu}", at->at[0], at->at[1],
			at->at[2], at->turn * (360.0 / 65536), at->scale, (uint64_t)at->path);
	}
	srv_json_add(json, "] runs:[");
	for (uint32_t i = 0; i < plan->run_count && !json->out.failed; i++)
		srv_json_add(json, "{placement:%u list_first:%u list_end:%u left:%u}", plan->runs[i].placement,
			plan->runs[i].list_first, plan->runs[i].list_end, plan->runs[i].left);
	srv_json_add(json, "] gates:[");
	for (uint32_t i = 0; i < plan->gate_count && !json->out.failed; i++)
		srv_json_add(json, "{plant:%s band:%u share:%u}", plant_name(scene, plan->gates[i].plant),
			plan->gates[i].end / ECO_SHARE_ONE, plan->gates[i].end % ECO_SHARE_ONE);
	srv_json_add(json, "] cuts:[");
	for (uint32_t i = 0; i < plan->cut_count && !json->out.failed; i++)
		describe_cut(json, scene, &plan->cuts[i]);
	srv_json_add(json, "]");
}

static void describe_reason(struct srv_json *json, const struct eco_scene *scene,
	const struct lod_explanation *why, const struct lod_explained *row)
{
	const struct eco_cut *cut = &row->cut;
	char reason[128];
	lod_explain_text(reason, sizeof reason, why, row);
	srv_json_add(json, "{");
	if (cut->list != ECO_NONE)
		srv_json_add(json, "list:%u first:%u end:%u", cut->list, cut->first, cut->end);
	if (row->tile != ECO_NONE)
		srv_json_add(json, "tile:%u", row->tile);
	if (row->plant != ECO_NONE)
		srv_json_add(json, "plant:%s anchor:%u band:%u distance_m:%.9g share_first:%.9g share_end:%.9g",
			scene->plants[row->plant].name, cut->anchor, cut->band_first, lod_band_distance_m(cut->band_first),
			share_of(cut->share_first), share_of(cut->share_end));
	srv_json_add(json, "plants:%lu vertices:%lu expected_px:%.9g gain_px:%.9g next_lambda:%.9g why:%s reason:%s}",
		row->plants, row->vertices, row->expected_px, row->reason.gain, row->reason.next, lod_why_name(row->reason.why), reason);
}

static void describe_explanation(struct srv_json *json, const struct eco_scene *scene,
	const struct lod_explanation *why)
{
	srv_json_add(json, "explanation:{lambda:%.9g omitted:%lu expected_px:[", why->lambda, why->omitted);
	for (uint32_t i = 0; i < LOD_DISTANCES; i++)
		srv_json_add(json, "%.9g", why->expected_px[i]);
	srv_json_add(json, "] rows:[");
	for (uint32_t i = 0; i < why->count && !json->out.failed; i++)
		describe_reason(json, scene, why, &why->rows[i]);
	srv_json_add(json, "]}");
}

void srv_describe_plan(struct srv_json *json, const struct srv_stream *stream)
{
	const struct eco_scene *scene = &stream->input.scene->pack->scene;
	const struct srv_step *last = &stream->steps[stream->step_count - 1];
	const struct eco_plan *plan = &last->plan;
	const struct eco_prediction *prediction = &plan->prediction;
	srv_json_add(json, "{scene:%s pack:%s budget_vertices:%lu budget_bytes:%lx fits:%d bytes:%lu next_bytes:%lu",
		stream->input.scene->name, pack_id(stream->input.scene).hex, stream->input.request->vertices,
		stream->input.request->bytes, stream->fits, stream->body_bytes, stream->next_bytes);
	srv_json_add(json, "chunks:%lu chunk_bytes:%lu named_bytes:%lu vertices:%lu visible_plants:%lu plan_bytes:%lu",
		stream->chunk_count, stream->chunk_bytes, stream->named_bytes, plan->vertices,
		plan->visible_plants, eco_wire_plan_bytes(plan));
	srv_json_add(json, "sample_distance_rad:%g prediction:{tp_px:%g fp_px:%g fn_px:%g q:%g m16:%g}",
		plan->sample_distance, prediction->tp, prediction->fp, prediction->fn, eco_predicted_q(prediction), plan->m16);
	describe_ground(json, scene, last);
	describe_steps(json, stream);
	describe_tables(json, scene, plan);
	if (stream->input.explain)
		describe_explanation(json, scene, &last->why);
	srv_json_add(json, "}");
}
