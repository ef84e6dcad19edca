/* Questions to a server beside pictures: the scene's place on Earth, what its plants are, the height of its
 * ground, and why a plan is what it is. */
#pragma once

#include <jansson.h>
#include <stdio.h>

#include "client-min/draw/view_picture.h"
#include "client-min/view_fetch.h"
#include "client-min/view_select.h"

/* ---- The scene's place ---- */

struct view_map {
	char crs[2048];                          /* "": plain metres */
	double at[3];                            /* the origin in it */
	struct view_sun_place place;             /* if the scene has a place on Earth */
	bool has_place;
};
/* ECO_UNSUPPORTED: the CRS does not fit. */
enum eco_code view_map_fetch(struct view_fetch *fetch, struct view_map *map, struct eco_error *error);

/* ---- Views whose heights count from the ground (eco_camera_above_ground) ---- */

/* Raises eye and target of request->view by the ground below each, and the next view's by as much. Asks for
 * the ground straight below, as for a picture of one pixel from far above: tiles of full detail come, which
 * the view needs anyway, and are held for it. The store's plan is then not one to draw. *result: bytes and
 * requests. */
enum eco_code view_stand(struct view_fetch *fetch, struct view_store *store, struct eco_request *request,
	struct view_fetch_result *result, struct eco_error *error);

/* ---- Why each cut of a plan is what it is (plan?explain=1), as a table; it appears complete or not at all
 * ---- */

/* Pixels of a picture that each instance of its selection has; the caller frees them. *others: those of what
 * is no instance; may be NULL. Ends the program without memory. */
uint32_t *view_pixels_of(const struct view_selection *selection, const struct view_picture *picture,
	uint64_t *others);
/* The same summed by the instances' distances, lod_distance_of. */
void view_pixels_by_distance(const struct view_selection *selection, const uint32_t *pixels,
	double px[LOD_DISTANCES]);

/* Full detail of a view, to say what shows in it beside what was expected; picture NULL: it was not drawn. */
struct view_full { const struct view_store *store; const struct lod_eye *eye; const struct view_picture *picture; };

/* out NULL: nothing is explained */
struct view_explain { const char *path; char *text; size_t size; FILE *out; };

void view_explain_open(struct view_explain *explain, const char *path);
enum eco_code view_explain_frame(struct view_explain *explain, struct view_fetch *fetch, uint32_t frame,
	const struct eco_request *request, const struct view_full *full, struct eco_error *error);
enum eco_code view_explain_close(struct view_explain *explain, bool keep, struct eco_error *error);
/* Writes the rows of a plan's JSON as lines; then one for each distance, whose `why` is "distance". */
enum eco_code view_explain_write(FILE *out, uint32_t frame, const char *json, const struct view_full *full,
	struct eco_error *error);

/* ---- The plants that a view shows as GeoJSON (RFC 7946) for a GIS: a point each, the plant with the most
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
