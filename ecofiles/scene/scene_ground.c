/* "ground" of a scene file: the rasters, and statements that the rasters lack or that replace theirs. */
#include "ecofiles/import/ground/ground.h"
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

bool eco_scene_parse_place(const struct eco_json *at, uint32_t files, bool *has_place, double corner_m[2],
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
		return check_no_heights(&node) && eco_scene_parse_image(source, &image);
	return eco_json_required(&node, "heights") && eco_scene_parse_image(source, &image) &&
		eco_scene_parse_paths(source, &heights, "raster", ECO_GROUND_FILES_MAX, &ground->heights,
			&ground->height_count) &&
		eco_scene_copy_text(&node, "vertical", ECO_PATH_BYTES, &ground->vertical) &&
		parse_meaning(ground, &node) &&
		eco_scene_parse_place(&node, ground->height_count, &ground->has_place, ground->corner,
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
