/* Questions to a server beside pictures: the scene's place on Earth, what its plants are, the height of its
 * ground, and why a plan is what it is. */
#ifndef VIEW_ASK_H
#define VIEW_ASK_H

#include <jansson.h>
#include <stdio.h>

#include "client-min/view_fetch.h"
#include "client-min/view_sky.h"

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

/* out NULL: nothing is explained */
struct view_explain { const char *path; char *text; size_t size; FILE *out; };

enum eco_code view_explain_open(struct view_explain *explain, const char *path, struct eco_error *error);
enum eco_code view_explain_frame(struct view_explain *explain, struct view_fetch *fetch, uint32_t frame,
	const struct eco_request *request, struct eco_error *error);
enum eco_code view_explain_close(struct view_explain *explain, bool keep, struct eco_error *error);
/* Writes the rows of a plan's JSON as lines. */
enum eco_code view_explain_write(FILE *out, uint32_t frame, const char *json, struct eco_error *error);

#endif
