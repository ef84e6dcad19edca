#include "ecofiles/format/legend.h"

#include <stdio.h>
#include <string.h>

static const uint8_t *color_of(const struct eco_scene *scene, uint32_t list, uint64_t place)
{
	const struct eco_list *l = &scene->lists[list];
	uint8_t tint = l->attributes & ECO_ATTR_COLOR ? eco_place_read(scene, place).tint : 0;
	return tint && tint <= l->palette_count ? scene->palette[l->palette_first + tint - 1] : NULL;
}

const uint8_t *eco_legend_color(const struct eco_scene *scene, uint32_t list, uint64_t place)
{
	const uint8_t *rgb = color_of(scene, list, place);
	return rgb && (rgb[0] | rgb[1] | rgb[2]) ? rgb : NULL;
}

const char *eco_legend_class(const json_t *meta, const struct eco_scene *scene, uint32_t list, uint64_t place)
{
	const uint8_t *rgb = color_of(scene, list, place);
	const json_t *tint, *class;
	char wanted[8] = "";
	size_t t, c;
	if (!rgb)
		return NULL;
	if (eco_legend_color(scene, list, place))
		snprintf(wanted, sizeof wanted, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
	json_array_foreach(json_object_get(meta, "tints"), t, tint)
		json_array_foreach(json_object_get(tint, "classes"), c, class) {
			const char *color = json_string_value(json_object_get(class, "color"));
			if (strcmp(color ? color : "", wanted) == 0)
				return json_string_value(json_object_get(class, "name"));
		}
	return NULL;
}
