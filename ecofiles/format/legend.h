/* Classes of tints by the legend in a pack's META: [{"column", "classes": [{"name", "color", "plants"}]}]. */
#pragma once

#include <jansson.h>

#include "ecofiles/format/pack.h"

/* The name of the class of a place of an instance list; of classes of one colour the first. NULL: it has
 * none. Valid as long as `meta`. */
const char *eco_legend_class(const json_t *meta, const struct eco_scene *scene, uint32_t list, uint64_t place);
/* Its colour; NULL: none, or its own. */
const uint8_t *eco_legend_color(const struct eco_scene *scene, uint32_t list, uint64_t place);
