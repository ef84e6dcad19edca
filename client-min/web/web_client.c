/* Calls of a page into the C client: one view of one scene, in a browser (web_client.h). Longer than 600 lines: all of it works
 * on one struct, which the page holds by its address. */
#include "client-min/web/web_client.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_shader.h"
#include "client-min/view_query.h"
#include "client-min/view_select.h"
#include "client-min/web/web_light.h"
#include "client-min/web/web_program.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/bytes.h"
#include "ecofiles/base/order.h"
#include "lod/light.h"
#include "lod/raster/blocks.h"
#include "lod/raster/flip.h"

struct web {
	struct view_store *store;
	struct eco_wire_parser *parser;          /* of the answer under way; else NULL */
	struct eco_request request;
	/* what is drawn; it outlives the plan that it is of, until something of it may have gone */
	struct view_selection selection, casters;        /* casters: empty unless shadows are asked for */
	uint64_t evictions;                      /* of the store when it was made */
	double predicted_q, predicted_m16;
	struct view_gl *gl;
	struct view_picture picture;             /* that was drawn last, once somebody has asked */
	bool read;
	uint8_t *owners;                         /* of it */
	uint8_t *compared; size_t compared_size; /* colours, of web_compare */
	struct web_light light;
	struct lod_eye eye;                      /* of the picture */
	enum view_tint tint;
	bool smooth;
	bool *hidden; uint32_t hidden_count, hidden_room;        /* by plant; those behind them are shown */
	bool no_summaries, no_ground;
	uint64_t marked;                         /* the owner that is highlighted; 0: none */
	uint32_t samples;                        /* of each of its pixels; 0: what it shows is not here any more */
	uint32_t cut;                            /* up to which the next sample is recorded */
	struct view_sky sky;
	struct eco_writer body, text;
	uint64_t bytes;                          /* of answers */
	char query[VIEW_QUERY_BYTES];
	char digest[VIEW_DIGEST_BYTES];
	struct eco_error error;
};

struct web *web_new(double memory_max_bytes)
{
	struct web *web = calloc(1, sizeof *web);
	struct view_store_options options = { .memory_max = (uint64_t)memory_max_bytes, .images = true };
	if (web && view_store_new(&web->store, &options, &web->error)) {
		web_free(web);
		return NULL;
	}
	return web;
}

void web_free(struct web *web)
{
	if (!web)
		return;
	if (web->gl)
		web_light_free(&web->light);
	view_gl_close(web->gl);
	view_picture_free(&web->picture);
	free(web->owners);
	free(web->compared);
	free(web->hidden);
	eco_wire_parser_free(web->parser);
	view_select_free(&web->selection);
	view_select_free(&web->casters);
	view_store_free(web->store);
	eco_writer_free(&web->body);
	eco_writer_free(&web->text);
	free(web);
}

const char *web_error(const struct web *web)
{
	return web->error.text;
}

static void forget_error(struct web *web)
{
	web->error = (struct eco_error){ 0 };
}

static const char *end_text(struct web *web)
{
	eco_write_u8(&web->text, 0);
	return web->text.failed ? NULL : (const char *)web->text.bytes;
}

/* ---- Asking ---- */

/* For want of memory chunks may have gone that the selection draws. */
static void keep_selection(struct web *web)
{
	if (view_store_stats(web->store).evictions == web->evictions)
		return;
	view_select_free(&web->selection);
	view_select_free(&web->casters);
	web->samples = 0;
}

static struct eco_view view_of(const double view[10], double width, double height)
{
	struct eco_view v = { .fov_y_deg = view[9], .width = (uint32_t)width, .height = (uint32_t)height };
	memcpy(v.eye, view, sizeof v.eye);
	memcpy(v.target, view + 3, sizeof v.target);
	memcpy(v.up, view + 6, sizeof v.up);
	return v;
}

int web_request(struct web *web, const double view[10], double width, double height, double vertices,
	double bytes)
{
	forget_error(web);
	web->request = (struct eco_request){ .view = view_of(view, width, height),
		.vertices = (uint64_t)vertices, .bytes = bytes < 0 ? ECO_BYTES_UNBOUNDED : (uint64_t)bytes };
	enum eco_code code = eco_view_check(&web->request.view, &web->error);
	if (!code)
		view_store_begin(web->store);
	keep_selection(web);
	return (int)code;
}

void web_fully(struct web *web)
{
	web->request.vertices = ECO_VERTICES_MAX;
	web->request.bytes = ECO_BYTES_UNBOUNDED;
	web->request.ground_px = ECO_GROUND_PX_MIN;
	web->request.texel_px = ECO_TEXEL_PX_MIN;
}

void web_next(struct web *web, const double next[6])
{
	web->request.next.given = true;
	memcpy(web->request.next.eye, next, sizeof web->request.next.eye);
	memcpy(web->request.next.target, next + 3, sizeof web->request.next.target);
}

const char *web_query(const struct web *web)
{
	return web->query;
}

const uint8_t *web_ask(struct web *web)
{
	eco_wire_parser_free(web->parser);
	web->parser = NULL;
	view_query_write(&web->request, NULL, web->query, sizeof web->query);
	eco_writer_free(&web->body);
	if (view_store_write_holdings(web->store, &web->body, &web->error)
			|| eco_wire_parser_new(&web->parser, &view_store_events, web->store, &web->error))
		return NULL;
	return web->body.bytes;
}

size_t web_body_size(const struct web *web)
{
	return web->body.size;
}

int web_feed(struct web *web, const uint8_t *bytes, size_t size)
{
	web->bytes += size;
	enum eco_code code = eco_wire_feed(web->parser, bytes, size, &web->error);
	keep_selection(web);
	return (int)code;
}

int web_finish(struct web *web)
{
	uint64_t vertices;
	enum eco_code code = eco_wire_finish(web->parser, &web->error);
	eco_wire_parser_free(web->parser);
	web->parser = NULL;
	if (code)
		return -(int)code;
	if (!view_store_again(web->store, &vertices))
		return 0;
	if (web->request.bytes != ECO_BYTES_UNBOUNDED)
		web->request.vertices = vertices;
	return 1;
}

/* ---- What is drawn ---- */

int web_hide(struct web *web, double plant, double hidden)
{
	forget_error(web);
	if (plant == WEB_SUMMARIES)
		web->no_summaries = hidden != 0;
	if (plant == WEB_GROUND)
		web->no_ground = hidden != 0;
	while (plant >= web->hidden_count) {
		if (!eco_array_grow(&web->hidden, &web->hidden_room, web->hidden_count, sizeof *web->hidden))
			return (int)eco_no_memory(&web->error, "what is hidden");
		web->hidden[web->hidden_count++] = false;
	}
	if (plant >= 0)
		web->hidden[(uint32_t)plant] = hidden != 0;
	return 0;
}

static bool is_hidden(const struct web *web, uint32_t plant)
{
	return plant == ECO_NONE ? web->no_summaries : plant < web->hidden_count && web->hidden[plant];
}

/* No cut draws what is hidden. Instances and the ground stay. */
static void hide_members(const struct web *web, struct view_selection *s)
{
	uint32_t kept = 0, first = 0;
	for (uint32_t c = 0; c < s->cut_count; c++) {
		uint32_t end = s->member_first[c + 1];
		for (uint32_t m = first; m < end; m++)
			if (!is_hidden(web, s->instances[s->members[m]].plant))
				s->members[kept++] = s->members[m];
		first = end;
		s->member_first[c + 1] = kept;
	}
}

/* Casters of shadows of the store's plan, once a picture needs them. */
static enum eco_code select_casters(struct web *web)
{
	struct lod_eye eye;
	if (!web->sky.shadows || web->light.shadow.keeps || web->casters.instance_count
			|| !view_store_plan(web->store))
		return ECO_OK;
	lod_eye_make(&eye, &web->request.view);
	enum eco_code code = view_select_casters(&web->casters, web->store, &eye, &web->error);
	if (!code)
		hide_members(web, &web->casters);
	return code;
}

int web_select(struct web *web)
{
	const struct eco_plan *plan = view_store_plan(web->store);
	struct view_selection selection;
	struct lod_eye eye;
	if (!plan)
		return -1;
	lod_eye_make(&eye, &web->request.view);
	forget_error(web);
	enum eco_code code = view_select_make(&selection, web->store, &eye, &web->error);
	if (code)
		return (int)code;
	view_select_free(&web->selection);
	web->selection = selection;
	hide_members(web, &web->selection);
	web->samples = 0;
	web_light_forget(&web->light);
	web->evictions = view_store_stats(web->store).evictions;
	web->predicted_q = eco_predicted_q(&plan->prediction);
	web->predicted_m16 = plan->m16;
	view_select_free(&web->casters);
	return 0;
}

/* A target and a picture of that size, on the GPU and here. */
static enum eco_code prepare(struct web *web, uint32_t width, uint32_t height)
{
	struct view_gl_options options = { width, height };
	const struct view_store *store = web->store;
	enum eco_code code = web->gl ? view_gl_resize(web->gl, &options, &web->error)
		: view_gl_open(&web->gl, &options, &web->error);
	if (!code && (web->picture.width != width || web->picture.height != height)) {
		view_picture_free(&web->picture);
		code = view_picture_init(&web->picture, width, height, &web->error);
	}
	if (!code)
		view_gl_keep(web->gl, &store, 1);
	return code;
}

int web_prepare(struct web *web, double width, double height)
{
	forget_error(web);
	enum eco_code code = prepare(web, (uint32_t)width, (uint32_t)height);
	if (!code)
		code = view_gl_prepare(web->gl, web->store, &web->error);
	if (!code)
		code = web_light_prepare(&web->light, 0, false, &web->error);
	return (int)code;
}

/* Records at most about so many vertices; once all of the sample is, it is lit. */
static enum eco_code draw_sample(struct web *web, uint32_t sample, uint64_t most)
{
	struct lod_eye eye = web->eye;
	struct view_selection shown = web->selection;
	shown.ground.count = web->no_ground ? 0 : shown.ground.count;
	const struct view_draw_job job = { .store = web->store, .selection = &shown, .eye = &eye,
		.near_m = view_store_near_m(web->store), .tint = web->tint, .smooth = web->smooth };
	lod_eye_sample(&eye, sample);
	enum eco_code code = view_gl_record_part(web->gl, &job, most, &web->cut, &web->picture, &web->error);
	if (!code && web->cut < web->selection.cut_count)
		return ECO_OK;
	if (!code)
		code = web_light_draw(&web->light, web->gl, &job, web->picture.width, web->picture.height,
			&web->error);
	web->samples = code ? 0 : sample + 1;
	web->cut = 0;
	return code;
}

int web_draw(struct web *web, const double view[10], double width, double height, double tint, double smooth)
{
	struct eco_view v = view_of(view, width, height);
	forget_error(web);
	if (eco_view_check(&v, &web->error) || prepare(web, v.width, v.height))
		return (int)web->error.code;
	lod_eye_make(&web->eye, &v);
	web->selection.sky = web->sky;
	web->selection.sky.casters = web->casters.instance_count ? &web->casters : NULL;
	web->read = false;
	web->tint = (enum view_tint)tint;
	web->smooth = smooth > 0;
	web->cut = 0;
	return (int)draw_sample(web, 0, UINT64_MAX);
}

int web_sample(struct web *web, double vertices)
{
	forget_error(web);
	if (!web->samples || web->samples == LOD_SAMPLES_MAX
			|| !web_mean_prepare(&web->light.mean, &web->light.lit, web->samples + 1))
		return -1;
	return (int)draw_sample(web, web->samples, (uint64_t)vertices);
}

unsigned web_samples(const struct web *web)
{
	return web->samples;
}

/* Reads the last picture into memory; false, with an error: it cannot be read. */
static bool read_picture(struct web *web)
{
	forget_error(web);
	web->read = web->read || !view_gl_read(web->gl, 0, &web->picture, &web->error);
	return web->read;
}

void web_sun(struct web *web, double longitude_deg, double latitude_deg, double convergence_deg,
	double unix_s)
{
	struct view_sun_place place = { longitude_deg, latitude_deg, convergence_deg };
	memset(web->sky.sun, 0, sizeof web->sky.sun);
	if (!isfinite(longitude_deg) || !isfinite(latitude_deg) || !isfinite(convergence_deg))
		return;
	if (isfinite(unix_s))
		view_sun_at(&place, unix_s, web->sky.sun);
	else
		view_sun_usual(&place, web->sky.sun);
}

int web_sky(struct web *web, double shadows, double shadow_size, double haze_m, double resting)
{
	double size = shadow_size > 0 ? shadow_size : VIEW_SHADOW_SIZE;
	forget_error(web);
	web->sky.shadows = shadows == VIEW_SHADOWS_STANDARD || shadows == VIEW_SHADOWS_PERSPECTIVE
		? (enum view_shadows)shadows : VIEW_SHADOWS_NONE;
	web->sky.shadow_size = (uint32_t)fmin(fmax(size, VIEW_SHADOW_SIZE_MIN), VIEW_SHADOW_SIZE_MAX);
	web->sky.haze_m = haze_m > 0 ? haze_m : 0;
	web->light.shadow.keeps = resting == 0;
	return (int)select_casters(web);
}

void web_present(struct web *web, const double *depth, const double *viewport, double sky, double ground)
{
	struct web_place place = { .depth = { (float)depth[0], (float)depth[1] }, .sky = sky != 0,
		.ground = ground != 0 };
	for (int i = 0; i < 4; i++)
		place.viewport[i] = (int)viewport[i];
	for (uint32_t i = 0; web->marked && i < web->selection.instance_count && !place.marked; i++)
		place.marked = web->selection.instances[i].owner == web->marked ? i + 1 : 0;
	web_light_present(&web->light, web->gl, &place);
}

const uint8_t *web_colors(struct web *web)
{
	if (!read_picture(web) || web_light_read(&web->light, web->picture.rgb, &web->error))
		return NULL;
	return web->picture.rgb;
}

const uint8_t *web_cover(struct web *web)
{
	return read_picture(web) ? web->picture.cover : NULL;
}

const uint8_t *web_owners(struct web *web)
{
	size_t size = (size_t)web->picture.width * web->picture.height * 3;
	if (!read_picture(web))
		return NULL;
	uint8_t *rgb = realloc(web->owners, size);
	if (!rgb) {
		eco_no_memory(&web->error, "the owners of a picture");
		return NULL;
	}
	web->owners = rgb;
	view_picture_owners(&web->picture, rgb);
	return rgb;
}

const char *web_compare(struct web *web)
{
	uint32_t width = web->picture.width, height = web->picture.height, count = lod_block_count(width, height);
	size_t size = (size_t)width * height * 3;
	const uint8_t *rgb = web_colors(web);
	uint8_t *copy = rgb ? malloc(size) : NULL;
	struct lod_block *blocks = copy ? calloc(2 * (size_t)count, sizeof *blocks) : NULL;
	struct lod_block_error error;
	web->text.size = 0;
	if (blocks && web->compared && web->compared_size == size) {
		lod_blocks_make(blocks, width, height, web->compared);
		lod_blocks_make(blocks + count, width, height, rgb);
		lod_blocks_compare(&error, blocks, blocks + count, count);
		eco_write_format(&web->text, "{\"picture_error\":%.4f,\"m16\":%.3f}", lod_flip(&(struct lod_flip_input){ width,
			height, web->compared, rgb, NULL }), error.color);
	} else {
		eco_write_format(&web->text, "null");
	}
	free(blocks);
	free(web->compared);
	web->compared = copy ? memcpy(copy, rgb, size) : NULL;
	web->compared_size = size;
	return end_text(web);
}

const char *web_digest(struct web *web)
{
	forget_error(web);
	return view_digest_write(web->digest, web->store, &web->selection, &web->error) ? NULL : web->digest;
}

/* ---- What a page shows ---- */

/* A string of JSON, with its quotes; UTF-8 stays as it is. */
static void say_name(struct eco_writer *text, const char *name)
{
	eco_write_format(text, "\"");
	for (; *name; name++)
		if (*name == '"' || *name == '\\' || (unsigned char)*name < ' ')
			eco_write_format(text, "\\u%04x", (unsigned char)*name);
		else
			eco_write_format(text, "%c", *name);
	eco_write_format(text, "\"");
}

static void say_roles(struct web *web)
{
	const struct view_selection *s = &web->selection;
	uint64_t vertices[VIEW_ROLE_COUNT] = { 0 };
	for (uint32_t c = 0; c < s->cut_count; c++) {
		const struct eco_cut *cut = &s->plan_cuts[c];
		const struct view_list *list = view_store_list(web->store, cut->list);
		if (list)
			vertices[s->roles[c]] += eco_cut_vertices(cut, &list->list)
				* (s->member_first[c + 1] - s->member_first[c]);
	}
	eco_write_format(&web->text, "\"roles\":[");
	for (int i = 0; i < VIEW_ROLE_COUNT; i++) {
		const uint8_t *color = view_tint_colors[i];
		eco_write_format(&web->text, "%s{\"name\":\"%s\",\"color\":[%u,%u,%u],\"vertices\":%llu}",
			i ? "," : "", view_role_names[i], color[0], color[1], color[2],
			(unsigned long long)vertices[i]);
	}
	eco_write_format(&web->text, "],");
}

struct standing { uint32_t plant; double scale; };

ECO_ORDER(by_plant, struct standing, ->plant)

/* Plants of the pack in view, counted, and how high they are in the mean. */
static void say_models(struct web *web)
{
	const struct view_selection *s = &web->selection;
	struct standing *plants = malloc(((size_t)s->instance_count + 1) * sizeof *plants);
	uint32_t count = 0;
	eco_write_format(&web->text, "\"models\":[");
	for (uint32_t i = 0; plants && i < s->instance_count; i++)
		if (s->instances[i].plant != ECO_NONE)
			plants[count++] = (struct standing){ s->instances[i].plant, s->instances[i].place.scale };
	if (plants)
		qsort(plants, count, sizeof *plants, by_plant);
	for (uint32_t i = 0, end; i < count; i = end) {
		const struct view_plant *plant = view_store_plant(web->store, plants[i].plant);
		double scale = 0;
		for (end = i; end < count && plants[end].plant == plants[i].plant; end++)
			scale += plants[end].scale;
		eco_write_format(&web->text, "%s{\"number\":%u,\"name\":", i ? "," : "", plants[i].plant);
		say_name(&web->text, plant->plant.name);
		eco_write_format(&web->text, ",\"height_m\":%.2f,\"count\":%u}",
			plant->plant.height_m * scale / (end - i), end - i);
	}
	free(plants);
	eco_write_format(&web->text, "],");
}

const char *web_facts(struct web *web)
{
	struct view_store_stats stats = view_store_stats(web->store);
	web->text.size = 0;
	eco_write_format(&web->text, "{\"vertices\":%llu,\"plants\":%llu,",
		(unsigned long long)web->selection.vertices,
		(unsigned long long)web->selection.visible_plants);
	if (web->predicted_q == web->predicted_q)
		eco_write_format(&web->text, "\"predicted_q\":%.4f,\"predicted_m16\":%.3f,", web->predicted_q,
			web->predicted_m16);
	say_roles(web);
	say_models(web);
	eco_write_format(&web->text,
		"\"coarse\":%llu,\"bytes\":%llu,\"chunks\":%llu,\"memory_bytes\":%llu,\"decode_ms\":%.1f}",
		(unsigned long long)web->selection.coarse, (unsigned long long)web->bytes, (unsigned long long)stats.chunks,
		(unsigned long long)stats.memory_bytes, stats.decode_ms);
	return end_text(web);
}

double web_ground(const struct web *web, double x, double y)
{
	double height_m;
	return view_ground_height(&web->selection.ground, x, y, &height_m) ? height_m : NAN;
}

/* ---- What is seen at a pixel ---- */

#define PICK_REACH 6             /* pixels: the nearest plant within is taken, as twigs are thin */

/* The pixel of a plant nearest to (x, y) and within reach, else that one; false beside the picture. */
static bool find_pixel(const struct view_picture *picture, double x, double y, uint32_t at[2])
{
	if (!(x >= 0 && y >= 0 && x < picture->width && y < picture->height))
		return false;
	int column = (int)x, row = (int)y, nearest = PICK_REACH * PICK_REACH + 1;
	at[0] = (uint32_t)column;
	at[1] = (uint32_t)row;
	for (int j = row - PICK_REACH; j <= row + PICK_REACH; j++)
		for (int i = column - PICK_REACH; i <= column + PICK_REACH; i++) {
			int apart = (i - column) * (i - column) + (j - row) * (j - row);
			if (i < 0 || j < 0 || i >= (int)picture->width || j >= (int)picture->height
					|| apart >= nearest
					|| !picture->cover[(size_t)j * picture->width + (size_t)i])
				continue;
			nearest = apart;
			at[0] = (uint32_t)i;
			at[1] = (uint32_t)j;
		}
	return true;
}

static void say_point(struct eco_writer *text, const char *name, const double p[3])
{
	eco_write_format(text, ",\"%s\":[%.4f,%.4f,%.4f]", name, p[0], p[1], p[2]);
}

static void say_model(const struct web *web, uint32_t number, struct eco_writer *text)
{
	const struct view_plant *plant = view_store_plant(web->store, number);
	if (!plant)
		return;
	eco_write_format(text, ",\"number\":%u,\"plant\":", number);
	say_name(text, plant->plant.name);
}

static void say_cuts(const struct web *web, uint32_t instance, struct eco_writer *text)
{
	const struct view_selection *s = &web->selection;
	const char *comma = "";
	eco_write_format(text, ",\"cuts\":[");
	for (uint32_t i = s->cut_first[instance]; i < s->cut_first[instance + 1]; i++) {
		const struct eco_cut *cut = &s->plan_cuts[s->cuts[i]];
		const struct view_list *list = view_store_list(web->store, cut->list);
		if (!list)
			continue;
		eco_write_format(text, "%s{\"role\":\"%s\",\"list\":%u,\"first\":%u,\"end\":%u,\"of\":%u,"
			"\"vertices\":%llu}", comma, view_role_names[s->roles[s->cuts[i]]], cut->list,
			cut->first, cut->end, list->list.primitive_count,
			(unsigned long long)eco_cut_vertices(cut, &list->list));
		comma = ",";
	}
	eco_write_format(text, "]");
}

/* The mean of a plant's widths along x and y, metres, by the list that is held and reaches farthest; 0: none is held
 * that has places. */
static double crown_of(const struct web *web, const struct view_instance *instance)
{
	double most = 0;
	for (uint32_t i = 0; i < view_store_list_count(web->store); i++) {
		const struct view_list *list = view_store_list_at(web->store, i);
		const struct eco_elements *e = &list->elements;
		double wide = 0;
		/* a summary's owner is a tile */
		if (list->list.kind > ECO_LIST_POINTS || list->list.attributes & ECO_ATTR_PLANT
				|| list->list.owner != instance->plant || !e->corner_count)
			continue;
		for (int axis = 0; axis < 2; axis++) {
			int32_t low = INT32_MAX, high = INT32_MIN;
			for (uint32_t c = 0; c < e->corner_count; c++) {
				int32_t p = e->position[3 * (size_t)c + (size_t)axis];
				low = p < low ? p : low;
				high = p > high ? p : high;
			}
			wide += ((double)high - low) * list->list.grid_step[axis] / 2;
		}
		most = fmax(most, wide);
	}
	return most * instance->place.scale * lod_place_width(&instance->place);
}

/* The colour of its class (legend.h); black: its own. Nothing of a plant without one. */
static void say_tint(const struct web *web, const struct view_instance *instance, struct eco_writer *text)
{
	const struct view_list *list = view_store_list(web->store, instance->list);
	uint8_t code = list && instance->index < list->elements.element_count
		? eco_place_of(&list->list, &list->elements, instance->index).tint : 0;
	if (code && code <= list->list.palette_count)
		eco_write_format(text, ",\"tint\":\"#%02x%02x%02x\"", list->palette[code - 1][0], list->palette[code - 1][1],
			list->palette[code - 1][2]);
}

static void say_plant(const struct web *web, const struct view_instance *instance, struct eco_writer *text)
{
	const struct view_plant *plant = view_store_plant(web->store, instance->plant);
	say_model(web, instance->plant, text);
	eco_write_format(text, ",\"height_m\":%.3f,\"scale\":%.4f,\"list\":%u,\"index\":%u",
		plant ? plant->plant.height_m * instance->place.scale : 0, instance->place.scale, instance->list, instance->index);
	say_point(text, "foot", instance->place.at);
}

/* The same, and more for its card. */
static void say_drawn(const struct web *web, const struct view_instance *instance, struct eco_writer *text)
{
	say_plant(web, instance, text);
	eco_write_format(text, ",\"crown_m\":%.3f", crown_of(web, instance));
	say_tint(web, instance, text);
	say_cuts(web, (uint32_t)(instance - web->selection.instances), text);
}

static void say_pick(struct web *web, const struct view_table *owners, double x, double y,
	struct eco_writer *text)
{
	const struct view_picture *picture = &web->picture;
	uint32_t at[2];
	size_t pixel = 0;
	bool inside = find_pixel(picture, x, y, at);
	if (inside)
		pixel = (size_t)at[1] * picture->width + at[0];
	if (!inside || !(picture->depth[pixel] > 0)) {
		eco_write_format(text, "{\"kind\":\"sky\"}");
		return;
	}
	double world[3], apart = 0;
	uint64_t owner = picture->owner[pixel];
	const struct view_instance *instance = owner
		? view_owners_find(owners, &web->selection, owner) : NULL;
	web->marked = instance ? owner : 0;
	view_picture_ray(picture, &web->eye, at[0], at[1], world);
	for (int k = 0; k < 3; k++) {
		double to = world[k] / (double)picture->depth[pixel];
		world[k] = web->eye.at[k] + to;
		apart += to * to;
	}
	eco_write_format(text, "{\"kind\":\"%s\"", !owner ? "ground" : instance ? "plant" : "summary");
	say_point(text, "at", world);
	eco_write_format(text, ",\"distance_m\":%.3f", sqrt(apart));
	const struct view_image_color own = view_image_at(&web->selection.image, &(struct view_image_spot){ { world[0], world[1] },
		{ 0, 0 }, 0 });
	if (!owner && own.alpha > 0)
		eco_write_format(text, ",\"rgb\":[%u,%u,%u]", lod_light_byte(65535 * (double)own.light[0]),
			lod_light_byte(65535 * (double)own.light[1]), lod_light_byte(65535 * (double)own.light[2]));
	if (instance)
		say_drawn(web, instance, text);
	else if (owner)
		say_model(web, eco_owner_plant(owner), text);
	eco_write_format(text, "}");
}

const char *web_pick(struct web *web, double x, double y)
{
	struct view_table owners;
	if (!read_picture(web))
		return NULL;
	bool made = view_owners_make(&owners, &web->selection);
	web->text.size = 0;
	if (made)
		say_pick(web, &owners, x, y, &web->text);
	view_table_free(&owners);
	if (!made) {
		eco_no_memory(&web->error, "the owners of a picture");
		return NULL;
	}
	return end_text(web);
}

/* ---- Plants that are here ---- */

static int by_distance(const void *a, const void *b)
{
	const struct view_instance *const *x = a, *const *y = b;
	return ((*x)->distance_m > (*y)->distance_m) - ((*x)->distance_m < (*y)->distance_m);
}

const char *web_plants(struct web *web, double most)
{
	const struct view_selection *s = &web->selection;
	const struct view_instance **near = malloc(((size_t)s->instance_count + 1) * sizeof *near);
	uint32_t count = 0;
	web->text.size = 0;
	if (!near) {
		eco_no_memory(&web->error, "the plants in view");
		return NULL;
	}
	for (uint32_t i = 0; i < s->instance_count; i++)
		if (s->instances[i].plant != ECO_NONE)
			near[count++] = &s->instances[i];
	qsort(near, count, sizeof *near, by_distance);
	eco_write_format(&web->text, "[");
	for (uint32_t i = 0; i < count && i < most; i++) {
		eco_write_format(&web->text, "%s{\"kind\":\"plant\",\"distance_m\":%.3f", i ? "," : "", near[i]->distance_m);
		say_plant(web, near[i], &web->text);
		eco_write_format(&web->text, "}");
	}
	eco_write_format(&web->text, "]");
	free(near);
	return end_text(web);
}

const char *web_mark(struct web *web, double list, double index)
{
	const struct view_instance *nearest = NULL;
	for (uint32_t i = 0; i < web->selection.instance_count; i++) {
		const struct view_instance *p = &web->selection.instances[i];
		if (p->plant != ECO_NONE && p->list == list && p->index == index
				&& (!nearest || p->distance_m < nearest->distance_m))
			nearest = p;
	}
	web->marked = nearest ? nearest->owner : 0;
	web->text.size = 0;
	eco_write_format(&web->text, nearest ? "{\"kind\":\"plant\",\"distance_m\":%.3f" : "null",
		nearest ? nearest->distance_m : 0);
	if (nearest) {
		say_drawn(web, nearest, &web->text);
		eco_write_format(&web->text, "}");
	}
	return end_text(web);
}
