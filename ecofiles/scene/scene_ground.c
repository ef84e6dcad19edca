/* "ground" of a scene file: the rasters, statements that the rasters lack or that replace theirs, and its image:
 * pictures, or classes and their colours. */
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/scene/scene_parse.h"

#include <stdlib.h>
#include <string.h>

static const char *const ground_fields[] = { "heights", "crs", "vertical", "band", "scale", "offset", "unit",
	"nodata", "north_west", "pixel", "image", NULL };

static bool parse_meaning(struct eco_ground_source *ground, const struct eco_json *at)
{
	struct eco_json nodata = eco_json_member(at, "nodata"), scale = eco_json_member(at, "scale");
	uint64_t band = 1;
	ground->no_holes = json_is_null(nodata.value);
	ground->has_nodata = nodata.value && !ground->no_holes;
	ground->has_offset = eco_json_member(at, "offset").value != NULL;
	if (!eco_json_whole(at, "band", 1, 65535, &band)
			|| !eco_json_number(at, "scale", -1e6, 1e6, &ground->scale)
		|| !eco_json_number(at, "offset", -1e6, 1e6, &ground->offset)
		|| !eco_scene_parse_unit(at, &ground->unit_m)
		|| (ground->has_nodata && !eco_json_number(at, "nodata", -1e39, 1e39, &ground->nodata)))
		return false;
	ground->band = (uint32_t)band;
	if (ground->scale == 0 && scale.value)
		return eco_json_fail(&scale, ECO_BAD_INPUT, "\"scale\": 0 would make all heights one");
	return true;
}

static bool parse_place(const struct eco_json *at, uint32_t files, bool *has_place, double corner_m[2],
	double pixel_m[2])
{
	struct eco_json corner = eco_json_member(at, "north_west"), pixel = eco_json_member(at, "pixel");
	if ((!corner.value) != (!pixel.value))
		return eco_json_fail(at, ECO_BAD_INPUT, "\"north_west\" (x and y of the raster's corner) "
			"and \"pixel\" (its pixels' size) go together");
	if (!corner.value)
		return true;
	if (files > 1)
		return eco_json_fail(&corner, ECO_BAD_INPUT, "several rasters cannot have one corner; give "
			"each a world file");
	*has_place = true;
	if (json_is_array(pixel.value)) {
		if (!eco_json_numbers(at, "pixel", 2, 2, 1e-9, 1e6, pixel_m))
			return false;
	} else {
		if (!eco_json_number(at, "pixel", 1e-9, 1e6, &pixel_m[0]))
			return false;
		pixel_m[1] = pixel_m[0];
	}
	return eco_json_numbers(at, "north_west", 2, 2, -1e9, 1e9, corner_m);
}

/* ---- The image ---- */

static const char *const image_fields[] = { "file", "crs", "classes", "nodata", "range", "texel_m",
	"north_west", "pixel", NULL };

/* "#rrggbb" */
static bool parse_color(const struct eco_json *at, uint8_t rgb[3])
{
	unsigned value = 0;
	int end = 0;
	if (!eco_json_is_text(at, 16))
		return false;
	const char *text = json_string_value(at->value);
	if (strlen(text) != 7 || strspn(text + 1, "0123456789abcdefABCDEF") != 6
			|| sscanf(text, "#%6x%n", &value, &end) != 1 || end != 7)
		return eco_json_fail(at, ECO_BAD_INPUT,
			"\"%s\" is no colour; write \"#rrggbb\", or null for none", text);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(value >> (16 - 8 * k));
	return true;
}

static int by_number(const void *a, const void *b)
{
	int32_t x = ((const struct eco_ground_class *)a)->number,
		y = ((const struct eco_ground_class *)b)->number;
	return (x > y) - (x < y);
}

static bool parse_classes(struct eco_ground_image_source *image, const struct eco_json *at)
{
	struct eco_json member = { .file = NULL };
	if (!at->value)
		return true;
	if (!eco_json_names(at, ECO_GROUND_CLASSES_MAX))
		return false;
	if (!json_object_size(at->value))
		return eco_json_fail(at, ECO_BAD_INPUT,
			"\"classes\" has no class; leave it out for the file's own colours");
	image->classes = calloc(json_object_size(at->value), sizeof *image->classes);
	if (!image->classes)
		return eco_json_no_memory(at);
	while (eco_json_next(at, &member)) {
		struct eco_ground_class *class = &image->classes[image->class_count];
		char *end;
		long number = strtol(member.key, &end, 10);
		if (end == member.key || *end || number != (int32_t)number)
			return eco_json_fail(&member, ECO_BAD_INPUT, "\"%.40s\" is no number of a class",
				member.key);
		class->number = (int32_t)number;
		class->clear = json_is_null(member.value);
		if (!class->clear && !parse_color(&member, class->rgb))
			return false;
		image->class_count++;
	}
	qsort(image->classes, image->class_count, sizeof *image->classes, by_number);
	for (uint32_t i = 1; i < image->class_count; i++)
		if (image->classes[i].number == image->classes[i - 1].number)
			return eco_json_fail(at, ECO_BAD_INPUT, "class %d comes twice",
				image->classes[i].number);
	return true;
}

static bool parse_image(struct eco_source *source, const struct eco_json *at)
{
	struct eco_ground_image_source *image = &source->ground_image;
	bool said_more = json_is_object(at->value);
	struct eco_json file = said_more ? eco_json_member(at, "file") : *at;
	if (!at->value)
		return true;
	if (said_more && (!eco_scene_object(at, image_fields) || !eco_json_required(at, "file")))
		return false;
	if (!eco_scene_parse_paths(source, &file, "image", ECO_GROUND_FILES_MAX, &image->files,
			&image->file_count))
		return false;
	if (!said_more)
		return true;
	struct eco_json classes = eco_json_member(at, "classes");
	struct eco_json range = eco_json_member(at, "range");
	image->has_nodata = eco_json_member(at, "nodata").value;
	image->has_range = range.value;
	if (range.value && !eco_json_numbers(at, "range", 2, 2, -1e39, 1e39, image->range))
		return false;
	if (range.value && !(image->range[0] < image->range[1]))
		return eco_json_fail(&range, ECO_BAD_INPUT, "\"range\" is [black, white], black being less");
	return eco_json_number(at, "nodata", -1e39, 1e39, &image->nodata) &&
		eco_json_number(at, "texel_m", 1e-3, 1e6, &image->texel_m) &&
		parse_classes(image, &classes) &&
		parse_place(at, image->file_count, &image->has_place, image->corner,
			image->pixel) &&
		eco_scene_parse_crs(source, at, "crs", &image->crs);
}

/* ---- The whole ---- */

/* Other fields say what heights mean. */
static bool check_no_heights(const struct eco_json *node)
{
	for (const char *const *field = ground_fields; *field; field++) {
		struct eco_json other = eco_json_member(node, *field);
		if (other.value && strcmp(*field, "image") != 0)
			return eco_json_fail(&other, ECO_BAD_INPUT,
				"\"%s\" is about \"heights\", which the ground does "
				"not have; what the image needs goes into it: \"image\": {\"file\": ...}",
				*field);
	}
	return true;
}

bool eco_scene_parse_ground(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "ground"), heights = eco_json_member(&node, "heights");
	struct eco_ground_source *ground = &source->ground;
	ground->none = json_is_null(node.value);
	if (!node.value || ground->none)
		return true;
	if (!eco_scene_object(&node, ground_fields))
		return false;
	struct eco_json image = eco_json_member(&node, "image");
	if (!heights.value && image.value)
		return check_no_heights(&node) && parse_image(source, &image);
	return eco_json_required(&node, "heights") && parse_image(source, &image) &&
		eco_scene_parse_paths(source, &heights, "raster", ECO_GROUND_FILES_MAX, &ground->heights,
			&ground->height_count) &&
		eco_scene_copy_text(&node, "vertical", ECO_PATH_BYTES, &ground->vertical) &&
		parse_meaning(ground, &node) &&
		parse_place(&node, ground->height_count, &ground->has_place, ground->corner,
			ground->pixel) &&
		eco_scene_parse_crs(source, &node, "crs", &ground->crs);
}

void eco_ground_source_free(struct eco_ground_source *ground)
{
	for (uint32_t i = 0; i < ground->height_count; i++)
		free(ground->heights[i]);
	free(ground->heights);
	free(ground->crs);
	free(ground->vertical);
	*ground = (struct eco_ground_source){ .heights = NULL };
}
