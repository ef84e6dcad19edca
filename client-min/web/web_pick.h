/* The thing that is seen at a pixel of a drawn picture: which plant, and the cuts that draw it. */
#ifndef WEB_PICK_H
#define WEB_PICK_H

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"
#include "ecofiles/base/bytes.h"

#define WEB_PICK_REACH 6         /* pixels: the nearest plant within is taken, as twigs are thin */

struct web_pick {
	const struct view_store *store;
	const struct view_selection *selection;
	const struct lod_eye *eye;
	const struct view_table *owners;
	const struct view_picture *picture;
};

/* JSON at a pixel (from the top left; beside the picture is the sky):
 *
 *   { "kind": "sky" }
 *   { "kind": "ground", "at": [x, y, z], "distance_m": d }
 *   { "kind": "summary", ... as the ground, "number": n, "plant": NAME }     a point for many plants
 *   { "kind": "plant", ... as a summary, "height_m": h, "scale": s, "list": l, "index": i, "foot": [x, y, z],
 *     "cuts": [{ "role": NAME, "list": l, "first": f, "end": e, "of": primitives, "vertices": v }] }
 *
 * `at` is what is seen there, `foot` where the plant stands: metres from the scene's origin. `plant` is what
 * is drawn, the pack's plant of that number, which may stand for several species. `list` and `index` name the
 * one that was picked to the server, which knows its species and its row. */
void web_pick_write(const struct web_pick *pick, double x, double y, struct eco_writer *text);

/* A string of JSON, with its quotes; UTF-8 stays as it is. */
void web_say_name(struct eco_writer *text, const char *name);

#endif
