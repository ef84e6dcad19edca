/* One scene file, from text to struct eco_source. Nothing here touches a file, so that tests and fuzzers
 * can feed anything. scene_tree.c opens files, follows children and checks that named files exist. */
#include "ecofiles/scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/scene/scene_parse.h"
#include "ecofiles/base/text.h"

#define INSTANCES_MAX (1u << 24)
#define HEIGHT_MAX_M 1000.0
#define SCALE_MIN 0.001
#define SCALE_MAX 1000.0
#define YAW_MAX 1e6

#define NUMBER(name, low, high, record, member) ECO_FIELD(name, NUMBER, low, high, record, member)
#define PLACED(record) \
	ECO_FIELD("at", NUMBERS | ECO_IS_REQUIRED, -ECO_METRES_MAX, ECO_METRES_MAX, record, at), \
	NUMBER("yaw_deg", -YAW_MAX, YAW_MAX, record, yaw_deg), \
	NUMBER("scale", SCALE_MIN, SCALE_MAX, record, scale)
static const struct eco_field scene_fields[] = {
	ECO_OTHER("name"),
	ECO_FIELD("crs", TEXT, 0, 0, source, crs),
	ECO_FIELD("vertical", TEXT, 0, 0, source, vertical),
	ECO_FIELD("date", TEXT, 0, 0, source, date),
	ECO_FIELD("origin", NUMBERS, -1e9, 1e9, source, origin),
	ECO_OTHER("ground"), ECO_OTHER("plants"), ECO_OTHER("instances"), ECO_OTHER("children"), ECO_OTHER("tile"),
	ECO_OTHER("season"), NUMBER("importance", ECO_IMPORTANCE_LEAST, ECO_IMPORTANCE_MOST, source, importance),
	ECO_FIELDS_END
};
static const struct eco_field instance_fields[] = {
	{ "plant", ECO_IS_OTHER | ECO_IS_REQUIRED, 0, 0, 0, 0 }, PLACED(source_instance),
	NUMBER("height_m", 0.001, HEIGHT_MAX_M, source_instance, height_m), ECO_FIELDS_END
};
static const struct eco_field child_fields[] = {
	ECO_FIELD("eco", PATH | ECO_IS_REQUIRED, 0, 0, source_child, eco), PLACED(source_child), ECO_FIELDS_END
};
static const struct eco_field tile_fields[] = {
	ECO_FIELD("instances", WHOLE, 1, 65536, source, tile_instances), ECO_FIELDS_END
};

/* ---- Instances and children ---- */

static void parse_instance(struct eco_source *source, const struct eco_json *at)
{
	struct eco_source_instance instance = { .scale = 1, .height_m = NAN };
	struct eco_json plant = eco_json_member(at, "plant");
	eco_scene_fields(source, at, instance_fields, &instance);
	instance.plant = eco_source_plant_of(source, &plant);
	instance.plant += eco_random_variant(0, source->instance_count,
		source->plants[instance.plant].variant_count);
	source->instances[source->instance_count++] = instance;
}

static void parse_instances(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "instances");
	size_t count, rows = 0, scatters = 0, footprints = 0;
	if (!node.value)
		return;
	eco_scene_need(eco_json_array(&node, INSTANCES_MAX));
	count = json_array_size(node.value);
	for (size_t i = 0; i < count; i++) {
		const json_t *item = json_array_get(node.value, i);
		rows += json_object_get(item, "from") != NULL;
		scatters += json_object_get(item, "scatter") != NULL;
		footprints += json_object_get(item, "extrude") != NULL;
	}
	source->instances = eco_alloc(count, sizeof *source->instances);
	source->positions = eco_alloc(rows, sizeof *source->positions);
	source->scatters = eco_alloc(scatters, sizeof *source->scatters);
	source->footprints = eco_alloc(footprints, sizeof *source->footprints);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_json_item(&node, i);
		if (json_object_get(item.value, "from"))
			eco_scene_parse_rows(source, &item, &source->positions[source->positions_count++]);
		else if (json_object_get(item.value, "scatter"))
			eco_scene_parse_scatter(source, &item, &source->scatters[source->scatter_count++]);
		else if (json_object_get(item.value, "extrude"))
			eco_scene_parse_footprints(source, &item, &source->footprints[source->footprints_count++]);
		else
			parse_instance(source, &item);
	}
}

static void parse_children(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "children");
	if (!node.value)
		return;
	eco_scene_need(eco_json_array(&node, INSTANCES_MAX));
	source->children = eco_alloc(json_array_size(node.value), sizeof *source->children);
	for (size_t i = 0; i < json_array_size(node.value); i++) {
		struct eco_json item = eco_json_item(&node, i);
		struct eco_source_child *child = &source->children[source->child_count++];
		*child = (struct eco_source_child){ .source = ECO_NONE, .scale = 1 };
		eco_scene_fields(source, &item, child_fields, child);
	}
}

/* ---- The document ---- */

static void parse_name(struct eco_source *source, const struct eco_json *top)
{
	const char *slash = strrchr(source->path, '/'), *name = slash ? slash + 1 : source->path;
	struct eco_json node = eco_json_member(top, "name");
	size_t bytes = strcspn(name, ".");
	if (node.value) {
		eco_scene_need(eco_json_text(top, "name", 63, &name));
		bytes = strlen(name);
		eco_source_check_name(&node, name, bytes);
	}
	bytes = eco_utf8_cut(name, bytes, sizeof source->name - 1);
	memcpy(source->name, bytes ? name : "scene", bytes ? bytes : strlen("scene"));
	eco_utf8_tame(source->name, "", '_');        /* a file's name may be any bytes */
}

struct document { struct eco_source *source; const struct eco_json *top; };

static void parse_document(void *document)
{
	struct eco_source *source = ((struct document *)document)->source;
	const struct eco_json *top = ((struct document *)document)->top;
	struct eco_json origin = eco_json_member(top, "origin"), tile = eco_json_member(top, "tile");
	eco_scene_fields(source, top, scene_fields, source);
	parse_name(source, top);
	if (tile.value)
		eco_scene_fields(source, &tile, tile_fields, source);
	if (source->crs && !origin.value)
		eco_scene_fail(top, "\"origin\" is missing: a scene with a CRS needs the point that is its 0, 0, 0, "
			"such as \"origin\": [747375, 4308510, 0]");
	eco_scene_parse_ground(source, top);
	eco_scene_parse_season(top, &source->season);
	eco_scene_parse_plants(source, top);
	parse_instances(source, top);
	parse_children(source, top);
}

enum eco_code eco_source_parse(struct eco_source *source, const char *json, size_t size, const char *path,
	bool on_disk, struct eco_error *error)
{
	struct eco_error local = { .code = ECO_OK };
	struct eco_json_file file = { path, json, size, error ? error : &local };
	*source = (struct eco_source){ .path = eco_copy_text(path), .importance = 1,
		.tile_instances = ECO_TILE_INSTANCES, .on_disk = on_disk };
	if (size > ECO_SOURCE_BYTES_MAX) {
		eco_source_free(source);
		return eco_fail(error, ECO_TOO_LARGE, "%s: %zu bytes, at most %u are possible; keep many "
			"plants in a CSV file (\"from\")", path, size, ECO_SOURCE_BYTES_MAX);
	}
	json_t *root = eco_json_open(&file);
	struct eco_json top = eco_json_root(&file, root);
	enum eco_code code = root ? eco_try(parse_document, &(struct document){ source, &top }, file.error)
		: file.error->code;
	json_decref(root);
	if (code)
		eco_source_free(source);
	return code;
}

struct eco_frame eco_source_frame(const struct eco_source *s)
{
	return (struct eco_frame){ .crs = s->crs, .vertical = s->vertical,
		.origin = { s->origin[0], s->origin[1], s->origin[2] } };
}

void eco_source_free(struct eco_source *source)
{
	for (uint32_t i = 0; i < source->plant_count; i++)
		eco_source_plant_free(&source->plants[i]);
	for (uint32_t i = 0; i < source->positions_count; i++)
		eco_positions_spec_free(&source->positions[i]);
	for (uint32_t i = 0; i < source->scatter_count; i++)
		eco_scatter_spec_free(&source->scatters[i]);
	for (uint32_t i = 0; i < source->footprints_count; i++)
		eco_footprints_spec_free(&source->footprints[i]);
	for (uint32_t i = 0; i < source->child_count; i++)
		eco_scene_fields_free(child_fields, &source->children[i]);
	eco_free(source->plants, source->plants_by_name, source->instances, source->positions,
		source->scatters, source->footprints, source->children, source->path);
	eco_scene_fields_free(scene_fields, source);
	eco_ground_source_free(&source->ground);
	eco_ground_image_source_free(&source->ground_image);
	eco_scene_draws_free(source);
	*source = (struct eco_source){ .path = NULL };
}
