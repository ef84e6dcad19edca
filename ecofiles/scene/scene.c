/* One scene file, from text to struct eco_source. Nothing here touches a file, so that tests and fuzzers
 * can feed anything. scene_tree.c opens files, follows children and checks that named files exist. */
#include "ecofiles/scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/scene/scene_parse.h"
#include "ecofiles/base/utf8.h"

#define INSTANCES_MAX (1u << 24)
#define HEIGHT_MAX_M 1000.0
#define SCALE_MIN 0.001
#define SCALE_MAX 1000.0
#define YAW_MAX 1e6

static const char *const scene_fields[] = { "name", "crs", "vertical", "origin", "ground", "plants",
	"instances", "children", "tile", "importance", NULL };
static const char *const instance_fields[] = { "plant", "at", "yaw_deg", "scale", "height_m", NULL };
static const char *const child_fields[] = { "eco", "at", "yaw_deg", "scale", NULL };
static const char *const tile_fields[] = { "instances", NULL };

/* ---- Instances and children ---- */

static bool parse_instance(struct eco_source *source, const struct eco_json *at)
{
	struct eco_source_instance *slot = &source->instances[source->instance_count];
	struct eco_source_instance instance = { .scale = 1, .height_m = NAN };
	struct eco_json plant = eco_json_member(at, "plant");
	if (!eco_scene_object(at, instance_fields) || !eco_json_required(at, "plant")
			|| !eco_json_required(at, "at")
		|| !eco_source_plant_of(source, &plant, &instance.plant)
		|| !eco_json_numbers(at, "at", 2, 3, -ECO_METRES_MAX, ECO_METRES_MAX, instance.at)
		|| !eco_json_number(at, "yaw_deg", -YAW_MAX, YAW_MAX, &instance.yaw_deg)
		|| !eco_json_number(at, "scale", SCALE_MIN, SCALE_MAX, &instance.scale)
		|| !eco_json_number(at, "height_m", 0.001, HEIGHT_MAX_M, &instance.height_m))
		return false;
	instance.plant += eco_random_variant(0, source->instance_count,
		source->plants[instance.plant].variant_count);
	*slot = instance;
	source->instance_count++;
	return true;
}

static bool parse_instances(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "instances");
	size_t count, rows = 0, scatters = 0;
	if (!node.value)
		return true;
	if (!eco_json_array(&node, INSTANCES_MAX))
		return false;
	count = json_array_size(node.value);
	for (size_t i = 0; i < count; i++) {
		const json_t *item = json_array_get(node.value, i);
		rows += json_object_get(item, "from") != NULL;
		scatters += json_object_get(item, "scatter") != NULL;
	}
	source->instances = calloc(count + 1, sizeof *source->instances);
	source->positions = calloc(rows + 1, sizeof *source->positions);
	source->scatters = calloc(scatters + 1, sizeof *source->scatters);
	if (!source->instances || !source->positions || !source->scatters)
		return eco_json_no_memory(&node);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_json_item(&node, i);
		bool good;
		if (json_object_get(item.value, "from"))
			good = eco_scene_parse_rows(source, &item,
				&source->positions[source->positions_count++]);
		else if (json_object_get(item.value, "scatter"))
			good = eco_scene_parse_scatter(source, &item,
				&source->scatters[source->scatter_count++]);
		else
			good = parse_instance(source, &item);
		if (!good)
			return false;
	}
	return true;
}

static bool parse_child(struct eco_source *source, const struct eco_json *at)
{
	struct eco_source_child *child = &source->children[source->child_count++];
	struct eco_json node = eco_json_member(at, "eco");
	child->source = ECO_NONE;
	child->scale = 1;
	if (!eco_scene_object(at, child_fields) || !eco_json_required(at, "eco")
			|| !eco_json_required(at, "at")
		|| !eco_json_numbers(at, "at", 2, 3, -ECO_METRES_MAX, ECO_METRES_MAX, child->at)
		|| !eco_json_number(at, "yaw_deg", -YAW_MAX, YAW_MAX, &child->yaw_deg)
		|| !eco_json_number(at, "scale", SCALE_MIN, SCALE_MAX, &child->scale))
		return false;
	return eco_scene_parse_path(source, &node, &child->eco);
}

static bool parse_children(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "children");
	if (!node.value)
		return true;
	if (!eco_json_array(&node, INSTANCES_MAX))
		return false;
	source->children = calloc(json_array_size(node.value) + 1, sizeof *source->children);
	if (!source->children)
		return eco_json_no_memory(&node);
	for (size_t i = 0; i < json_array_size(node.value); i++) {
		struct eco_json item = eco_json_item(&node, i);
		if (!parse_child(source, &item))
			return false;
	}
	return true;
}

/* ---- The document ---- */

static bool parse_name(struct eco_source *source, const struct eco_json *top)
{
	const char *slash = strrchr(source->path, '/'), *name = slash ? slash + 1 : source->path;
	struct eco_json node = eco_json_member(top, "name");
	size_t bytes = strcspn(name, ".");
	if (node.value) {
		if (!eco_json_text(top, "name", 63, &name)
				|| !eco_source_name_is_fine(&node, name, strlen(name)))
			return false;
		bytes = strlen(name);
	}
	bytes = eco_utf8_cut(name, bytes, sizeof source->name - 1);
	memcpy(source->name, bytes ? name : "scene", bytes ? bytes : strlen("scene"));
	eco_utf8_tame(source->name, "", '_');        /* a file's name may be any bytes */
	return true;
}

static bool parse_tile(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "tile");
	uint64_t instances = ECO_TILE_INSTANCES;
	if (node.value
			&& (!eco_scene_object(&node, tile_fields)
			|| !eco_json_whole(&node, "instances", 1, 65536, &instances)))
		return false;
	source->tile_instances = (uint32_t)instances;
	return true;
}

static bool parse_document(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json origin = eco_json_member(top, "origin");
	if (!eco_scene_object(top, scene_fields) || !parse_name(source, top)
			|| !eco_scene_copy_text(top, "crs", ECO_PATH_BYTES, &source->crs)
		|| !eco_scene_copy_text(top, "vertical", ECO_PATH_BYTES, &source->vertical)
		|| !eco_json_numbers(top, "origin", 2, 3, -1e9, 1e9, source->origin)
		|| !eco_json_number(top, "importance", ECO_IMPORTANCE_LEAST, ECO_IMPORTANCE_MOST,
			&source->importance))
		return false;
	if (source->crs && !origin.value)
		return eco_json_fail(top, ECO_BAD_INPUT, "\"origin\" is missing: a scene with a CRS needs "
			"the point that is its 0, 0, 0, such as \"origin\": [747375, 4308510, 0]");
	return parse_tile(source, top) && eco_scene_parse_ground(source, top)
		&& eco_scene_parse_plants(source, top) && parse_instances(source, top)
		&& parse_children(source, top);
}

enum eco_code eco_source_parse_as(struct eco_source *source, const char *json, size_t size, const char *path,
	bool on_disk, struct eco_error *error)
{
	struct eco_error local = { .code = ECO_OK };
	struct eco_json_file file = { path, json, size, error ? error : &local };
	*source = (struct eco_source){ .path = strdup(path), .importance = 1, .on_disk = on_disk };
	if (!source->path)
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory", path);
	if (size > ECO_SOURCE_BYTES_MAX) {
		eco_source_free(source);
		return eco_fail(error, ECO_TOO_LARGE, "%s: %zu bytes, at most %u are possible; keep many "
			"plants in a CSV file (\"from\")", path, size, ECO_SOURCE_BYTES_MAX);
	}
	json_t *root = eco_json_open(&file);
	struct eco_json top = eco_json_root(&file, root);
	bool good = root && parse_document(source, &top);
	json_decref(root);
	if (good)
		return ECO_OK;
	eco_source_free(source);
	return file.error->code;
}

enum eco_code eco_source_parse(struct eco_source *source, const char *json, size_t size, const char *path,
	struct eco_error *error)
{
	return eco_source_parse_as(source, json, size, path, false, error);
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
	for (uint32_t i = 0; i < source->child_count; i++)
		free(source->children[i].eco);
	free(source->plants);
	free(source->plants_by_name);
	free(source->instances);
	free(source->positions);
	free(source->scatters);
	free(source->children);
	free(source->path);
	free(source->crs);
	free(source->vertical);
	eco_ground_source_free(&source->ground);
	eco_ground_image_source_free(&source->ground_image);
	*source = (struct eco_source){ .path = NULL };
}
