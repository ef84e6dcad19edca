/* Contents of a pack: counted from its tables; from META what the tables do not have. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/texture.h"
#include "lod/build/grid.h"

enum { KIND_SUMMARIES = ECO_LIST_INVENTORY + 1, KIND_SPLATS, KIND_COUNT };
static const char *const kind_names[KIND_COUNT] = { "", "triangles", "lines", "points", "instances", "ground",
	"images", "impostors", "outlines", "ground_images", "inventory", "summaries", "splats" };
static const char *const need_names[] = { "points", "lines", "triangles", "textures", "cutouts", "ground",
	"cells", "summaries", "placements", "splats", "impostors", "ground_image", "widths", "tints", "water" };

/* units: what bits are told of: primitives, texels of textures, plants of inventories */
struct kind_total { uint64_t lists, chunks, primitives, units, bytes; };

struct totals {
	struct kind_total kind[KIND_COUNT];
	uint64_t *plant_bytes;       /* per plant: chunks of its lists */
	uint64_t leaves, placed;
	/* chunks of triangles whose leaves are coded together (ECO_CODER_SHAPES) */
	uint64_t shape_chunks, shape_bytes;
};

static void count_shapes(const struct eco_pack *pack, const struct eco_list *list, struct totals *t)
{
	for (uint32_t c = list->chunk_first; c < list->chunk_first + list->chunk_count; c++) {
		const struct eco_chunk *chunk = &pack->scene.chunks[c];
		if (chunk->size_bytes < 2 || pack->map[chunk->offset + 1] != ECO_CODER_SHAPES)
			continue;
		t->shape_chunks++;
		t->shape_bytes += chunk->size_bytes;
	}
}

static uint64_t count_texels(const struct eco_pack *pack, const struct eco_list *list)
{
	uint64_t texels = 0;
	for (uint32_t c = list->chunk_first; c < list->chunk_first + list->chunk_count; c++)
		texels += eco_texture_texels(pack->map + pack->scene.chunks[c].offset,
			pack->scene.chunks[c].size_bytes, list->kind == ECO_LIST_OUTLINE);
	return texels;
}

static double bits_each(const struct kind_total *kind)
{
	return kind->units ? 8 * (double)kind->bytes / (double)kind->units : 0;
}

static uint64_t list_bytes(const struct eco_scene *s, const struct eco_list *list)
{
	uint64_t bytes = 0;
	for (uint32_t c = list->chunk_first; c < list->chunk_first + list->chunk_count; c++)
		bytes += s->chunks[c].size_bytes;
	return bytes;
}

/* Bytes of each plant's lists and of the textures that they show; those that plants share count for each.
 * Lists of a plant are adjacent. */
static void count_plants(const struct eco_scene *s, uint64_t *bytes)
{
	uint32_t *shown = eco_alloc(s->list_count, sizeof *shown);          /* by plant shown - 1 */
	for (uint32_t i = 0; i < s->list_count; i++) {
		const struct eco_list *list = &s->lists[i];
		if ((list->attributes & ECO_ATTR_PLANT) || list->kind == ECO_LIST_INSTANCES
				|| eco_list_has_texels(list) || list->owner >= s->plant_count)
			continue;
		bytes[list->owner] += list_bytes(s, list);
		for (uint32_t k = list->image; k != ECO_NONE && shown[k] != list->owner + 1; k = s->lists[k].image) {
			shown[k] = list->owner + 1;
			bytes[list->owner] += list_bytes(s, &s->lists[k]);
		}
	}
	free(shown);
}

static void count_up(const struct eco_pack *pack, struct totals *t)
{
	const struct eco_scene *s = &pack->scene;
	t->plant_bytes = eco_alloc(s->plant_count, sizeof *t->plant_bytes);
	count_plants(s, t->plant_bytes);
	for (uint32_t i = 0; i < s->list_count; i++) {
		const struct eco_list *list = &s->lists[i];
		struct kind_total *kind = &t->kind[list->attributes & ECO_ATTR_PLANT ? KIND_SUMMARIES
			: list->attributes & ECO_ATTR_SPLAT ? KIND_SPLATS : list->kind];
		if (list->kind == ECO_LIST_TRIANGLES)
			count_shapes(pack, list, t);
		kind->lists++;
		kind->chunks += list->chunk_count;
		kind->primitives += list->primitive_count;
		kind->units += list->primitive_count;
		if (eco_list_has_texels(list))
			kind->units += count_texels(pack, list) - list->primitive_count;
		else if (list->kind == ECO_LIST_INVENTORY)
			kind->units += s->place_count - list->primitive_count;
		kind->bytes += list_bytes(s, list);
	}
	t->leaves = s->tile_count;
	for (uint32_t i = 0; i < s->tile_count; i++) {
		uint64_t placed = 0;
		for (uint32_t c = s->tiles[i].child_first;
				c < s->tiles[i].child_first + s->tiles[i].child_count; c++)
			placed += s->children[c].placed;
		t->placed += placed;
		/* a tile that only places other eco files is a leaf of its own */
		t->leaves -= placed < s->tiles[i].child_count;
	}
}

/* META's record of the i-th plant; NULL if META has none. */
static json_t *meta_plant(const json_t *meta, uint32_t i)
{
	return json_array_get(json_object_get(meta, "plants"), i);
}

static json_int_t dropped_sum(const json_t *plant)
{
	json_int_t sum = 0;
	const char *key;
	json_t *value;
	json_object_foreach(json_object_get(plant, "dropped"), key, value)
		sum += json_integer_value(value);
	return sum;
}

/* ---- JSON ---- */

static json_t *needs_json(uint32_t needs)
{
	json_t *names = json_array();
	for (size_t i = 0; i < sizeof need_names / sizeof *need_names; i++)
		if (needs >> i & 1)
			json_array_append_new(names, json_string(need_names[i]));
	return names;
}

static json_t *curve_json(const struct eco_scene *s, const struct eco_ladder *l)
{
	json_t *samples = json_array();
	for (uint32_t i = 0; i < l->curve_count; i++) {
		const struct eco_curve *c = &s->curves[l->curve_first + i];
		json_array_append_new(samples,
			json_pack("[f,f,f,f]", (double)c->share, (double)c->scale, (double)c->fp,
			(double)c->fn));
	}
	return samples;
}

/* The distance beyond which full detail is within half a pixel of the model, in a picture of 1080 pixels over
 * 45 degrees. META counts beside the grids: lists with placed shapes are stored on a finer grid than the one
 * to which their corners were rounded. */
static double nearest_m(const struct eco_scene *s, const json_t *meta, uint32_t plant)
{
	double most = json_number_value(json_object_get(meta_plant(meta, plant), "half_a_pixel_m"));
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].owner == plant
			&& (s->lists[i].kind == ECO_LIST_TRIANGLES || s->lists[i].kind == ECO_LIST_LINES))
			most = fmax(most, lod_grid_nearest_m(&s->lists[i], LOD_GRID_PIXEL_RAD));
	return most;
}

static json_t *plant_json(const struct eco_scene *s, const struct totals *t, const json_t *meta, uint32_t id)
{
	const struct eco_plant *p = &s->plants[id];
	json_t *ladders = json_array(), *from = meta_plant(meta, id);
	json_t *plant = from ? json_deep_copy(from) : json_object();
	for (uint32_t i = p->ladder_first; i < p->ladder_first + p->ladder_count; i++) {
		const struct eco_ladder *l = &s->ladders[i];
		if (l->anchor == p->anchor_first)
			json_array_append_new(ladders,
				json_pack("{s:s, s:b, s:f, s:f, s:o}", "organ", eco_organ_names[l->organ],
				"far", l->flags & ECO_LADDER_FAR ? 1 : 0, "importance", (double)l->importance,
				"area_m2", (double)l->area,
				"curve_share_scale_fp_fn", curve_json(s, l)));
	}
	json_object_set_new(plant, "name", json_string(p->name));
	const struct eco_anchor *whole = &s->anchors[p->anchor_first];
	json_object_update_new(plant, json_pack("{s:I, s:f, s:[f,f,f], s:f, s:f, s:I, s:I, s:I, s:o}",
		"triangles", (json_int_t)p->triangles, "area_m2", (double)p->area,
		"center_m", (double)whole->center[0], (double)whole->center[1], (double)whole->center[2],
		"radius_m", (double)whole->radius, "half_a_pixel_m", nearest_m(s, meta, id),
		"cells", (json_int_t)p->anchor_count - 1, "ladders", (json_int_t)p->ladder_count,
		"bytes", (json_int_t)t->plant_bytes[id], "whole_plant_ladders", ladders));
	if (from)
		json_object_set_new(plant, "triangles_dropped", json_integer(dropped_sum(from)));
	return plant;
}

/* The finest texels of the ground's image, metres. */
static double finest_texel_m(const struct eco_scene *s)
{
	double least = INFINITY;
	for (uint32_t i = 0; i < s->ground_image_count; i++)
		least = fmin(least, s->lists[s->ground_images[i].list].grid_step[0]);
	return least;
}

static json_t *info_json(const struct eco_pack *pack, const struct totals *t, const json_t *meta)
{
	const struct eco_scene *s = &pack->scene;
	const struct eco_tile *root = &s->tiles[s->root];
	json_t *plants = json_array(), *lists = json_object();
	for (uint32_t i = 0; i < s->plant_count; i++)
		json_array_append_new(plants, plant_json(s, t, meta, i));
	for (int i = 1; i < KIND_COUNT; i++)
		if (t->kind[i].lists)
			json_object_set_new(lists, kind_names[i],
				json_pack("{s:I, s:I, s:I, s:I, s:f}", "lists", (json_int_t)t->kind[i].lists,
				"chunks", (json_int_t)t->kind[i].chunks, "primitives",
				(json_int_t)t->kind[i].primitives, "bytes", (json_int_t)t->kind[i].bytes,
				"bits_each", bits_each(&t->kind[i])));
	if (t->shape_chunks)
		json_object_set_new(json_object_get(lists, kind_names[ECO_LIST_TRIANGLES]),
			"of_placed_shapes",
			json_pack("{s:I, s:I}", "chunks", (json_int_t)t->shape_chunks, "bytes",
			(json_int_t)t->shape_bytes));
	json_t *info = json_pack("{s:s, s:s, s:I, s:f, s:o, s:I, s:I, s:I, s:I, s:f, s:[f,f,f], s:[f,f,f], "
		"s:I, s:o, s:o}", "name", s->name,
		"id", eco_id_text(pack->id.bytes).hex, "bytes", (json_int_t)pack->map_size, "near_m", s->near_m, "needs",
		needs_json(s->needs), "instances", (json_int_t)root->instance_count, "tiles",
		(json_int_t)s->tile_count, "leaf_tiles", (json_int_t)t->leaves, "placements",
		(json_int_t)t->placed, "area_m2", root->area, "low", root->low[0], root->low[1], root->low[2],
		"high", root->high[0], root->high[1], root->high[2], "curve_samples",
		(json_int_t)s->curve_count, "lists", lists, "plants", plants);
	if (s->ground_count) {
		const struct eco_ground_tile *top = &s->ground[0];
		const struct eco_list *list = &s->lists[top->list];
		json_object_set_new(info, "ground",
			json_pack("{s:O*, s:I, s:I, s:I, s:[f,f], s:[f,f], "
				  "s:[f,f], s:f, s:I, s:I}",
				"from", json_object_get(meta, "ground"), "columns",
				(json_int_t)(s->ground_columns - 2 * s->ground_margin), "rows",
				(json_int_t)(s->ground_rows - 2 * s->ground_margin), "margin",
				(json_int_t)s->ground_margin, "south_west_m", list->grid_origin[0],
				list->grid_origin[1], "step_m", list->grid_step[0], list->grid_step[1],
				"heights_m", (double)top->low_m, (double)top->high_m, "height_step_m",
				list->grid_step[2], "tiles", (json_int_t)s->ground_count, "levels",
				(json_int_t)top->level + 1));
	}
	if (s->ground_image_count) {
		const struct eco_list *top = &s->lists[s->ground_images[0].list];
		json_object_set_new(info, "ground_image",
			json_pack("{s:[f,f], s:f, s:f, s:I, s:I}", "south_west_m", top->grid_origin[0],
				top->grid_origin[1], "side_m", eco_ground_image_side_m(top), "finest_texel_m",
				finest_texel_m(s), "tiles", (json_int_t)s->ground_image_count, "bytes",
				(json_int_t)t->kind[ECO_LIST_GROUND_IMAGE].bytes));
	}
	static const char *const copied[] = { "generator", "order", "draft", "crs", "origin", "place",
		"eco_files", "off_ground", "rows", "columns", "tints", "drawn" };
	for (size_t i = 0; i < sizeof copied / sizeof *copied; i++)
		if (json_object_get(meta, copied[i]))
			json_object_set(info, copied[i], json_object_get(meta, copied[i]));
	return info;
}

/* ---- For people ---- */

/* The next of some keys, which are separated by spaces; false: there is none. */
static bool next_key(const char **keys, char key[64])
{
	int bytes = 0;
	if (sscanf(*keys, "%63s%n", key, &bytes) != 1)
		return false;
	*keys += bytes;
	return true;
}

static void print_value(FILE *out, const json_t *value)
{
	const char *key;
	json_t *part;
	size_t i;
	if (json_is_object(value)) {
		bool first = true;
		json_object_foreach((json_t *)value, key, part) {
			const json_t *elements = json_object_get(part, "elements");  /* of an organ */
			fprintf(out, "%s%s ", first ? "" : ", ", key);
			print_value(out, elements ? elements : part);
			first = false;
		}
	} else if (json_is_array(value)) {
		json_array_foreach(value, i, part) {
			fputs(i ? " " : "", out);
			print_value(out, part);
		}
	} else if (json_is_string(value)) {
		char *text = eco_copy_text(json_string_value(value));
		eco_utf8_tame(text, "", '?');        /* names from packs must not steer a terminal */
		fputs(text, out);
		free(text);
	} else if (json_is_integer(value))
		fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
	else if (json_is_real(value))
		fprintf(out, fabs(json_real_value(value)) < 1e5 ? "%.5g" : "%.10g", json_real_value(value));
	else
		fputs(json_is_true(value) ? "yes" : json_is_false(value) ? "no" : json_is_null(value) ? "none" : "", out);
}

void inspect_lines(FILE *out, const json_t *facts, const char *keys)
{
	for (char key[64]; next_key(&keys, key);) {
		const json_t *value = json_object_get(facts, key);
		if (!value)
			continue;
		fprintf(out, "  %-18s ", key);
		print_value(out, value);
		fputc('\n', out);
	}
}

/* Prints a record, or with widths given by a first call with `out` NULL, lined up. */
static void print_record(FILE *out, const char *name, const json_t *record, const char *keys, int *width)
{
	char *text = NULL, key[64];
	size_t size;
	for (bool is_name = name; is_name || next_key(&keys, key); is_name = false) {
		FILE *cell = open_memstream(&text, &size);
		const json_t *value = is_name ? NULL : json_object_get(record, key);
		if (!cell)
			return;
		if (is_name)
			fputs(name, cell);
		else if (record)
			print_value(cell, value);
		else
			fputs(key, cell);
		fclose(cell);
		if (out && !*keys)
			fputs(text, out);
		else if (out)
			fprintf(out, "%*s  ", is_name || json_is_string(value) ? -*width : *width, text);
		else if (*width < (int)size)
			*width = (int)size;
		width++;
		free(text);
	}
	if (out)
		fputc('\n', out);
}

void inspect_table(FILE *out, const char *title, const json_t *records, const char *keys)
{
	int width[32] = { 0 };
	size_t count = json_is_array(records) ? json_array_size(records) : json_object_size(records);
	if (!count)
		return;
	fputc('\n', out);
	for (int pass = 0; pass < 2; pass++) {
		const char *name = NULL;
		void *at = json_object_iter((json_t *)records);
		print_record(pass ? out : NULL, json_is_array(records) ? NULL : title, NULL, keys, width);
		for (size_t i = 0; i < count && i < INSPECT_ROWS; i++) {
			const json_t *record = json_array_get(records, i);
			if (at) {
				name = json_object_iter_key(at);
				record = json_object_iter_value(at);
				at = json_object_iter_next((json_t *)records, at);
			}
			print_record(pass ? out : NULL, name, record, keys, width);
		}
	}
	if (count > INSPECT_ROWS)
		fprintf(out, "... and %zu more\n", count - INSPECT_ROWS);
}

static const char *ending(uint64_t count) { return count == 1 ? "" : "s"; }

static void print_info(const struct eco_scene *s, const json_t *info, FILE *out)
{
	uint64_t plants = s->tiles[s->root].instance_count;
	fprintf(out, "%s: %" PRIu64 " plant%s of %u kind%s\n", s->name, plants, ending(plants), s->plant_count,
		ending(s->plant_count));
	inspect_lines(out, info, "id bytes draft crs origin near_m low high area_m2 needs tiles leaf_tiles placements "
		"ground ground_image order curve_samples off_ground rows columns");
	inspect_table(out, NULL, json_object_get(info, "plants"), "name height_m triangles_in triangles "
		"triangles_dropped cells grid_bits half_a_pixel_m area_m2 bytes organs");
	inspect_table(out, "lists", json_object_get(info, "lists"), "lists chunks primitives bytes bits_each");
	const json_t *tint;
	size_t i;
	json_array_foreach(json_object_get(info, "tints"), i, tint) {
		fputs("\ntints by ", out);
		print_value(out, json_object_get(tint, "column"));
		inspect_table(out, NULL, json_object_get(tint, "classes"), "name color plants");
	}
	if (json_object_get(info, "drawn"))
		inspect_table(out, "drawn", json_object_get(info, "drawn"), "name color features");
}

enum eco_code inspect_info(const char *path, bool json, FILE *out, struct eco_error *error)
{
	struct eco_pack *pack = NULL;
	struct totals totals = { 0 };
	enum eco_code code = eco_pack_open(&pack, path, error);
	if (code)
		return code;
	json_t *meta = json_loadb(pack->meta, pack->meta_size, 0, NULL);
	count_up(pack, &totals);
	json_t *info = info_json(pack, &totals, meta);
	if (json) {
		json_dumpf(info, out, JSON_INDENT(1));
		fputc('\n', out);
	} else
		print_info(&pack->scene, info, out);
	json_decref(info);
	json_decref(meta);
	free(totals.plant_bytes);
	eco_pack_close(pack);
	return code;
}
