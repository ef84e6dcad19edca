/* The bytes of a first visit by what they are: payloads, the last plan and those before it, and the rest,
 * which is overhead. Nothing is drawn. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "server/stream.h"
#include "tests/bench/pictures/bench_views.h"

#define VERTICES 1000000u
#define LEAST_BYTES 99000.0      /* of the streams that the bar is about, but for what a budget leaves */
#define BAR 0.05

static const uint64_t budgets[] = { 100000, 300000, ECO_BYTES_UNBOUNDED };
#define BUDGETS (sizeof budgets / sizeof *budgets)

/* Payloads by what their lists are; then the rest. */
enum part { PLACES, SUMMARIES, GROUND, TEXTURES, IMPOSTORS, SPLATS, POINTS, LINES, TRIANGLES, PLANS, FRAMES,
	SCENE, PLANTS, RECORDS, GROUPS, PALETTES, CHUNKS, PARTS };
static const char *const parts[PARTS] = { "places", "summaries", "ground", "textures", "impostors", "splats",
	"points", "lines", "triangles", "plans", "frames", "scene and end", "plants", "records", "groups",
	"palettes", "heads" };

struct study { struct bench_table *table; double worst; uint32_t rows, within; };

/* One stream as it is read, and as its directories are written again to learn what their items take. */
struct reading {
	const struct eco_scene *scene;
	struct eco_wire_items items;
	struct eco_writer again;
	struct eco_range range;
	double bits[PARTS], before;
	uint64_t lists, chunks;
};

static double bits_at(const struct reading *r)
{
	return 8.0 * (double)(r->again.size + r->range.held) - log2(r->range.range);
}

/* What was written since it was last asked is of `part`. */
static void count(struct reading *r, enum part part)
{
	double now = bits_at(r);
	r->bits[part] += now - r->before;
	r->before = now;
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, struct eco_error *e)
{
	struct reading *r = ctx;
	struct eco_wire_item item = { .kind = ECO_ITEM_PLANT, .id = id, .plant = *plant };
	(void)e;
	eco_wire_item_code(&r->range, &r->items, &item);
	for (uint32_t i = 0; i < plant->anchor_count; i++) {
		struct eco_anchor anchor = anchors[i];
		eco_wire_anchor_code(&r->range, &r->items, &anchor);
	}
	count(r, PLANTS);
	return ECO_OK;
}

static enum eco_code on_list(void *ctx, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	const struct eco_group *groups, struct eco_error *e)
{
	struct reading *r = ctx;
	struct eco_wire_item item = { .kind = ECO_ITEM_LIST, .id = id, .list = *list };
	(void)palette, (void)e;
	eco_wire_item_code(&r->range, &r->items, &item);
	count(r, RECORDS);
	for (uint32_t i = 0; i < list->group_count; i++) {
		struct eco_group group = groups[i];
		eco_wire_group_code(&r->range, &r->items, i, &group);
	}
	count(r, GROUPS);
	if (list->palette_count && !eco_wire_same_palette(&r->items, list))
		r->bits[PALETTES] += 24.0 * list->palette_count;
	r->lists++;
	return ECO_OK;
}

static enum part part_of(const struct eco_list *list)
{
	switch (list->kind) {
	case ECO_LIST_INSTANCES: return PLACES;
	case ECO_LIST_GROUND: return GROUND;
	case ECO_LIST_IMAGE: case ECO_LIST_OUTLINE: return TEXTURES;
	case ECO_LIST_IMPOSTOR: return IMPOSTORS;
	case ECO_LIST_POINTS: return list->attributes & ECO_ATTR_PLANT ? SUMMARIES
		: list->attributes & ECO_ATTR_SPLAT ? SPLATS : POINTS;
	case ECO_LIST_LINES: return LINES;
	default: return TRIANGLES;
	}
}

static enum eco_code on_chunk(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *e)
{
	struct reading *r = ctx;
	struct eco_wire_item item = { .kind = ECO_ITEM_CHUNK, .id = list, .ordinal = ordinal, .chunk = *chunk };
	(void)payload, (void)e;
	eco_wire_item_code(&r->range, &r->items, &item);
	count(r, CHUNKS);
	r->bits[part_of(&r->scene->lists[list])] += 8.0 * chunk->size_bytes;
	r->chunks++;
	return ECO_OK;
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *e)
{
	struct reading *r = ctx;
	(void)e;
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, plan);
	r->bits[PLANS] += 8.0 * (double)w.size;
	eco_writer_free(&w);
	eco_plan_free(plan);
	return ECO_OK;
}

static enum eco_code read_body(struct reading *r, const struct srv_body *body, struct eco_error *error)
{
	static const struct eco_wire_events events = { .plant = on_plant, .list = on_list, .chunk = on_chunk,
		.plan = on_plan };
	struct eco_wire_parser *parser;
	eco_wire_items_start(&r->items);
	eco_range_write(&r->range, &r->again);
	r->before = bits_at(r);
	enum eco_code code = eco_wire_parser_new(&parser, &events, r, error);
	for (uint32_t i = 0; i < body->piece_count && !code; i++)
		code = eco_wire_feed(parser, body->pieces[i].bytes, body->pieces[i].size, error);
	if (!code)
		code = eco_wire_finish(parser, error);
	eco_wire_parser_free(parser);
	struct eco_chunk_id id = { { 0 } };
	double known = 0;
	r->again.size = 0;
	eco_wire_write_scene(&r->again, r->scene, &id);
	r->bits[SCENE] = 8.0 * (double)r->again.size + 8 * 16;
	for (int p = 0; p < PARTS; p++)
		known += p == FRAMES ? 0 : r->bits[p];
	r->bits[FRAMES] = 8.0 * (double)body->size_bytes - known;
	eco_writer_free(&r->again);
	return code;
}

static void add_row(struct study *s, const struct bench_view *view, uint64_t budget, const struct reading *r)
{
	double body = 0, over = 0;
	char text[512];
	size_t at = 0;
	for (int p = 0; p < PARTS; p++) {
		body += r->bits[p] / 8;
		over += p > PLANS ? r->bits[p] / 8 : 0;
		at += (size_t)snprintf(text + at, sizeof text - at, ",%.2f", r->bits[p] / 8e3);
	}
	over /= body;
	bench_table_row(s->table, "%s,%s,%.0f,%.1f,%.4f,%llu,%llu%s", view->scene, view->camera,
		budget == ECO_BYTES_UNBOUNDED ? NAN : (double)budget, body / 1e3, over,
		(unsigned long long)r->lists, (unsigned long long)r->chunks, text);
	if (body < LEAST_BYTES)
		return;
	s->rows++;
	s->within += over <= BAR;
	s->worst = fmax(s->worst, over);
}

static enum eco_code study_budget(struct study *s, const struct srv_scene *scene,
	const struct bench_view *view, uint64_t budget, struct eco_error *error)
{
	struct eco_request request = { .view = view->view, .vertices = VERTICES, .bytes = budget };
	struct srv_stream_input input = { .scene = scene, .request = &request };
	struct srv_stream stream = { 0 };
	struct srv_body body = { 0 };
	struct reading *reading = calloc(1, sizeof *reading);
	if (!reading)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a stream");
	reading->scene = &scene->pack->scene;
	enum eco_code code = srv_stream_plan(&stream, &input, error);
	if (!code && stream.fits) {
		code = srv_stream_write(&stream, &body, error);
		if (!code)
			code = read_body(reading, &body, error);
		if (!code)
			add_row(s, view, budget, reading);
	}
	srv_body_free(&body);
	srv_stream_free(&stream);
	free(reading);
	return code;
}

static enum eco_code study_view(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error)
{
	struct srv_store store;
	srv_store_init(&store);
	enum eco_code code = srv_store_add(&store, "bench", view->pack, error);
	for (size_t b = 0; b < BUDGETS && !code; b++)
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: study_budget(ctx, store.scenes[0], view, budgets[b], error);
	srv_store_free(&store);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *file;
	const json_t *scenes = bench_views_load(&file, error);
	char columns[512] = "scene,camera,bytes asked for,kB,overhead,list count,chunk count";
	if (!scenes)
		return error->code;
	for (int p = 0; p < PARTS; p++) {
		strcat(columns, ",");
		strcat(columns, parts[p]);
	}
	struct study s = { .table = bench_table_open(bench, "overhead", columns, true) };
	enum eco_code code = bench_views_each(bench, scenes, BENCH_VIEWS_QUICK, study_view, &s, error);
	bench_table_close(s.table);
	bench_say(bench, "First visits of at most a million vertices: kilobytes of what a stream is made of. "
		"Overhead is all but payloads and plans, over the body.");
	bench_key(bench, "overhead_worst", s.rows ? s.worst : NAN, "<= 0.05 in streams of 100 kB and more");
	bench_key(bench, "overhead_within", s.rows ? (double)s.within / s.rows : NAN,
		"share of streams of 100 kB and more within 5 %");
	json_decref(file);
	return code;
}

const struct bench_section bench_overhead = { "overhead", "Overhead: what bytes of streams are", run,
	.objects = "ecofiles-*.a lod*.a server.a " };
