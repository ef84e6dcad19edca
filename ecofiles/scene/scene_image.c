/* "image" of the ground of a scene file: pictures, or classes and their colours. */
#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/scene/scene_parse.h"

#include <stdlib.h>
#include <string.h>

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
			"\"classes\" has no class; leave it out for the file's own "
			"colours");
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

bool eco_scene_parse_image(struct eco_source *source, const struct eco_json *at)
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
		eco_scene_parse_place(at, image->file_count, &image->has_place, image->corner,
			image->pixel) &&
		eco_scene_parse_crs(source, at, "crs", &image->crs);
}
