/* "ground" of a scene file: the rasters, statements that the rasters lack or that replace theirs, its image:
 * pictures, or classes and their colours, and what is drawn on it. */
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/ground/ground.h"
#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/scene/scene_parse.h"

#include <stdlib.h>
#include <string.h>

#define PLACE(record) \
	ECO_FIELD("north_west", NUMBERS, -1e9, 1e9, record, corner), ECO_OTHER("pixel")
static const struct eco_field ground_fields[] = {
	ECO_OTHER("heights"),
	ECO_FIELD("crs", CRS, 0, 0, ground_source, crs),
	ECO_FIELD("vertical", TEXT, 0, 0, ground_source, vertical),
	ECO_FIELD("band", WHOLE, 1, 65535, ground_source, band),
	ECO_FIELD("scale", NUMBER, -1e6, 1e6, ground_source, scale),
	ECO_FIELD("offset", NUMBER, -1e6, 1e6, ground_source, offset),
	ECO_FIELD("unit", UNIT, 0, 0, ground_source, unit_m),
	ECO_OTHER("nodata"), PLACE(ground_source), ECO_OTHER("image"), ECO_OTHER("draw"), ECO_FIELDS_END
};

static void parse_meaning(struct eco_ground_source *ground, const struct eco_json *at)
{
	struct eco_json nodata = eco_json_member(at, "nodata"), scale = eco_json_member(at, "scale");
	ground->no_holes = json_is_null(nodata.value);
	ground->has_nodata = nodata.value && !ground->no_holes;
	ground->has_offset = eco_json_member(at, "offset").value != NULL;
	if (ground->scale == 0 && scale.value)
		eco_scene_fail(&scale, "\"scale\": 0 would make all heights one");
	if (ground->has_nodata)
		eco_scene_need(eco_json_number(at, "nodata", -1e39, 1e39, &ground->nodata));
}

static void parse_place(const struct eco_json *at, uint32_t files, bool *has_place, double pixel_m[2])
{
	struct eco_json corner = eco_json_member(at, "north_west"), pixel = eco_json_member(at, "pixel");
	if ((!corner.value) != (!pixel.value))
		eco_scene_fail(at, "\"north_west\" (x and y of the raster's corner) and \"pixel\" (its pixels' "
			"size) go together");
	if (!corner.value)
		return;
	if (files > 1)
		eco_scene_fail(&corner, "several rasters cannot have one corner; give each a world file");
	*has_place = true;
	if (json_is_array(pixel.value)) {
		eco_scene_need(eco_json_numbers(at, "pixel", 2, 2, 1e-9, 1e6, pixel_m));
		return;
	}
	eco_scene_need(eco_json_number(at, "pixel", 1e-9, 1e6, &pixel_m[0]));
	pixel_m[1] = pixel_m[0];
}

/* ---- The image ---- */

static const struct eco_field image_fields[] = {
	ECO_FIELD("file", OTHER | ECO_IS_REQUIRED, 0, 0, ground_image_source, files),
	ECO_FIELD("crs", CRS, 0, 0, ground_image_source, crs),
	ECO_OTHER("classes"),
	ECO_FIELD("nodata", NUMBER, -1e39, 1e39, ground_image_source, nodata),
	ECO_FIELD("range", NUMBERS, -1e39, 1e39, ground_image_source, range),
	ECO_FIELD("texel_m", NUMBER, 1e-3, 1e6, ground_image_source, texel_m),
	PLACE(ground_image_source), ECO_FIELDS_END
};

void eco_scene_color(const struct eco_json *at, uint8_t rgb[3])
{
	unsigned value = 0;
	int end = 0;
	eco_scene_need(eco_json_is_text(at, 16));
	const char *text = json_string_value(at->value);
	if (strlen(text) != 7 || strspn(text + 1, "0123456789abcdefABCDEF") != 6
			|| sscanf(text, "#%6x%n", &value, &end) != 1 || end != 7)
		eco_scene_fail(at, "\"%s\" is no colour; write \"#rrggbb\", or null for none", text);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(value >> (16 - 8 * k));
}

ECO_ORDER(by_number, struct eco_ground_class, ->number)

static void parse_classes(struct eco_ground_image_source *image, const struct eco_json *at)
{
	struct eco_json member = { .file = NULL };
	if (!at->value)
		return;
	eco_scene_need(eco_json_names(at, ECO_GROUND_CLASSES_MAX));
	if (!json_object_size(at->value))
		eco_scene_fail(at, "\"classes\" has no class; leave it out for the file's own colours");
	image->classes = eco_alloc(json_object_size(at->value), sizeof *image->classes);
	while (eco_json_next(at, &member)) {
		struct eco_ground_class *class = &image->classes[image->class_count++];
		char *end;
		long number = strtol(member.key, &end, 10);
		if (end == member.key || *end || number != (int32_t)number)
			eco_scene_fail(&member, "\"%.40s\" is no number of a class", member.key);
		class->number = (int32_t)number;
		class->clear = json_is_null(member.value);
		if (!class->clear)
			eco_scene_color(&member, class->rgb);
	}
	qsort(image->classes, image->class_count, sizeof *image->classes, by_number);
	for (uint32_t i = 1; i < image->class_count; i++)
		if (image->classes[i].number == image->classes[i - 1].number)
			eco_scene_fail(at, "class %d comes twice", image->classes[i].number);
}

static void parse_image(struct eco_source *source, const struct eco_json *at)
{
	struct eco_ground_image_source *image = &source->ground_image;
	bool said_more = json_is_object(at->value);
	struct eco_json file = said_more ? eco_json_member(at, "file") : *at;
	if (!at->value)
		return;
	if (said_more)
		eco_scene_fields(source, at, image_fields, image);
	eco_scene_parse_paths(source, &file, "image", ECO_GROUND_FILES_MAX, &image->files, &image->file_count);
	if (!said_more)
		return;
	struct eco_json classes = eco_json_member(at, "classes");
	struct eco_json range = eco_json_member(at, "range");
	image->has_nodata = eco_json_member(at, "nodata").value;
	image->has_range = range.value;
	if (range.value && !(image->range[0] < image->range[1]))
		eco_scene_fail(&range, "\"range\" is [black, white], black being less");
	parse_classes(image, &classes);
	parse_place(at, image->file_count, &image->has_place, image->pixel);
}

/* ---- What is drawn ---- */

static const struct eco_field draw_fields[] = {
	ECO_FIELD("from", PATH | ECO_IS_REQUIRED, 0, 0, draw_spec, path), ECO_FIELD("layer", COLUMN, 0, 0, draw_spec, layer),
	ECO_FIELD("crs", CRS, 0, 0, draw_spec, crs), ECO_FIELD("class", TEXT, 0, 0, draw_spec, class),
	ECO_OTHER("width_m"), ECO_OTHER("only"), ECO_OTHER("skip"), ECO_FIELDS_END
};

static void parse_draw(struct eco_source *source, const struct eco_json *at, struct eco_draw_spec *spec)
{
	struct eco_json from = eco_json_member(at, "from"), class = eco_json_member(at, "class"),
		width = eco_json_member(at, "width_m");
	eco_json_place(&from, &spec->line, &spec->column);
	eco_scene_fields(source, at, draw_fields, spec);
	char there[400] = "";
	struct eco_land_class row;
	for (uint32_t i = 0; eco_land_class(i, &row); i++)
		if (row.drawn && eco_land_class_named(row.name) == i)
			eco_phrase_add(there, sizeof there, row.name);
	uint32_t named = spec->class ? eco_land_class_named(spec->class) : ECO_NONE;
	if (spec->class && (named == ECO_NONE || !eco_land_class(named, &row) || !row.drawn))
		eco_scene_fail(&class, "no class of the ground is \"%s\"; there are: %s", spec->class, there);
	if (width.value && json_is_string(width.value))
		eco_scene_copy(&width, ECO_COLUMN_BYTES, &spec->width);
	else if (width.value)
		eco_scene_need(eco_json_number(at, "width_m", 0.05, ECO_DRAWN_WIDE_M, &spec->width_m));
	eco_scene_parse_filters(at, &spec->filters, &spec->filter_count);
}

static void parse_draws(struct eco_source *source, const struct eco_json *at)
{
	if (!at->value)
		return;
	eco_scene_need(eco_json_array(at, ECO_DRAW_MAX));
	source->draws = eco_alloc(json_array_size(at->value) + 1, sizeof *source->draws);
	for (size_t i = 0; i < json_array_size(at->value); i++) {
		struct eco_json item = eco_json_item(at, i);
		parse_draw(source, &item, &source->draws[source->draw_count++]);
	}
}

void eco_scene_draws_free(struct eco_source *source)
{
	for (uint32_t i = 0; i < source->draw_count; i++) {
		eco_scene_fields_free(draw_fields, &source->draws[i]);
		free(source->draws[i].width);
		eco_filters_free(source->draws[i].filters, source->draws[i].filter_count);
	}
	free(source->draws);
}

/* ---- The whole ---- */

/* Other fields say what heights mean. */
static void check_no_heights(const struct eco_json *node)
{
	for (const struct eco_field *field = ground_fields; field->name; field++) {
		struct eco_json other = eco_json_member(node, field->name);
		if (other.value && strcmp(field->name, "image") != 0 && strcmp(field->name, "draw") != 0)
			eco_scene_fail(&other, "\"%s\" is about \"heights\", which the ground does not have; what "
				"the image needs goes into it: \"image\": {\"file\": ...}", field->name);
	}
}

void eco_scene_parse_ground(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "ground"), heights = eco_json_member(&node, "heights");
	struct eco_ground_source *ground = &source->ground;
	ground->none = json_is_null(node.value);
	if (!node.value || ground->none)
		return;
	eco_scene_fields(source, &node, ground_fields, ground);
	struct eco_json image = eco_json_member(&node, "image"), draw = eco_json_member(&node, "draw");
	if (!heights.value && (image.value || draw.value))
		check_no_heights(&node);
	else
		eco_scene_need(eco_json_required(&node, "heights"));
	parse_image(source, &image);
	parse_draws(source, &draw);
	if (!heights.value)
		return;
	eco_scene_parse_paths(source, &heights, "raster", ECO_GROUND_FILES_MAX, &ground->heights,
		&ground->height_count);
	parse_meaning(ground, &node);
	parse_place(&node, ground->height_count, &ground->has_place, ground->pixel);
}

void eco_ground_source_free(struct eco_ground_source *ground)
{
	eco_scene_paths_free(ground->heights, ground->height_count);
	eco_scene_fields_free(ground_fields, ground);
	*ground = (struct eco_ground_source){ .heights = NULL };
}

void eco_ground_image_source_free(struct eco_ground_image_source *source)
{
	eco_scene_paths_free(source->files, source->file_count);
	eco_scene_fields_free(image_fields, source);
	free(source->classes);
	*source = (struct eco_ground_image_source){ .files = NULL };
}
