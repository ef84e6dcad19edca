/* The plants that a view shows as GeoJSON (RFC 7946) for a GIS: a point each, the plant with the most
 * pixels first; longitude and latitude of WGS 84 where the scene has a CRS, else the scene's metres.
 *
 *   species                 as its row states it; null: it states none; without a row as the scene names it
 *   plant, height_m         what it is shown as: the pack's plant; height as it is drawn
 *   file, row, line         of the inventory; null: it is of none that is known, the file has no lines
 *   pixels                  in which it is nearest to the eye
 *   distance_m              from the eye to its middle
 *   drawn_as                representations, such as "triangles, lines"
 *   at_m                    where it stands: metres from the scene's origin
 *
 * Plants that stand behind others, or are smaller than a pixel, are not there. Points that stand for many
 * plants name none: "summary_pixels" beside the features counts theirs. */
#ifndef VIEW_GEOJSON_H
#define VIEW_GEOJSON_H

#include <jansson.h>

#include "client-min/draw/view_picture.h"
#include "client-min/view_ask.h"
#include "client-min/view_select.h"

struct view_geojson_job {
	const struct view_store *store;
	const struct view_selection *selection;
	const struct view_picture *picture;      /* drawn of these */
	const struct view_map *map;
	struct view_fetch *fetch;                /* asks for species and rows; NULL: not asked for */
};
/* *out is the caller's. ECO_NOT_FOUND: PROJ is not there; ECO_BAD_INPUT: it does not know the CRS. */
enum eco_code view_geojson_make(const struct view_geojson_job *job, json_t **out, struct eco_error *error);
/* The same as DIR/frame-0000.geojson. */
enum eco_code view_geojson_save(const struct view_geojson_job *job, const char *dir, uint32_t frame,
	struct eco_error *error);

#endif
