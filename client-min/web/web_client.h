/* The client for a page: everything that a browser does not do itself. JavaScript (eco_layer.mjs) asks the
 * server and hands over what comes, byte by byte; what is held, what is drawn and how it looks is the code of
 * ecoview. All numbers are doubles, as JavaScript's are; a `view` is eye, target, up, then fov_y_deg: ten of
 * them.
 *
 *   web = web_new(memory_max)                       NULL: no memory
 *   web_request(web, view, width, height, vertices, bytes)      bytes < 0: no budget
 *   do
 *           body = web_ask(web)                     web_body_size(web) bytes, to be posted to
 *                                                   URL/stream?web_query(web); NULL: see web_error
 *           web_feed(web, bytes, size)              as they come
 *   while ((again = web_finish(web)) > 0)           0: all is here; below 0: see web_error
 *   web_prepare(web, width, height)                 before there is a plan: compiles what draws what is held
 *   web_select(web)                                 what the plan that has come draws from now on; -1: none
 *                                                   has
 *   web_draw(web, view, width, height, tint, smooth)        a picture, by the WebGL context that is current
 *   web_sample(web, vertices)                       adds a sample of each pixel's colour to that picture, or a
 *                                                   part of it, of about so many vertices; -1: it has all, or
 *                                                   this driver cannot
 *   web_present(web, depth, viewport, sky, ground)  puts it into the page's framebuffer (web_program.h)
 *   web_facts(web)                                  JSON: what a page shows of it
 *   web_pick(web, x, y)                             JSON: what is seen at a pixel of it
 *   web_free(web)
 *
 * An int above 0 is an enum eco_code: see web_error. Strings are valid until the next call. One thread. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct web;

struct web *web_new(double memory_max_bytes);
void web_free(struct web *web);
const char *web_error(const struct web *web);

int web_request(struct web *web, const double view[10], double width, double height, double vertices,
	double bytes);
/* Also of that request: full detail, whatever its budgets. */
void web_fully(struct web *web);
/* Also of that request: what a view from there, of eye and target, lacks comes last. */
void web_next(struct web *web, const double next[6]);
const char *web_query(const struct web *web);
const uint8_t *web_ask(struct web *web);
size_t web_body_size(const struct web *web);
int web_feed(struct web *web, const uint8_t *bytes, size_t size);
int web_finish(struct web *web);

int web_prepare(struct web *web, double width, double height);
int web_select(struct web *web);
int web_draw(struct web *web, const double view[10], double width, double height, double tint, double smooth);
/* From the next web_select on nothing of a plant of the pack is drawn, nor casts a shadow; hidden 0: it is drawn again. Two
 * numbers stand for points of many plants and for the ground, on which one walks all the same. */
#define WEB_SUMMARIES (-1)
#define WEB_GROUND (-2)
int web_hide(struct web *web, double plant, double hidden);
int web_sample(struct web *web, double vertices);
unsigned web_samples(const struct web *web);     /* of the last picture */
/* From now on the sun is where it is at a place and time (view_sun_at); a time of NaN: view_sun_usual there; a
 * place of NaN: where it usually is. */
void web_sun(struct web *web, double longitude_deg, double latitude_deg, double convergence_deg,
	double unix_s);
/* From now on shadows are cast (enum view_shadows: 0 none) by maps of so many texels a side (0: 1024), and
 * haze hides all but 1/e of what is haze_m metres away (0: as usual). resting 0: pictures use the map that one
 * before them made, if there is one of the same sun, and make none. */
int web_sky(struct web *web, double shadows, double shadow_size, double haze_m, double resting);
/* depth: 2 numbers, viewport: 4. */
void web_present(struct web *web, const double *depth, const double *viewport, double sky, double ground);
/* The last picture, rows from the top: 3 bytes of colour a pixel; 255 where a plant is, else 0; owners as
 * view_picture_owners has them. Only colours are of all samples, all else is the first's. They and web_pick
 * read it from the GPU, once. NULL: see web_error. */
const uint8_t *web_colors(struct web *web);
const uint8_t *web_cover(struct web *web);
const uint8_t *web_owners(struct web *web);
const char *web_facts(struct web *web);
/* JSON: { "picture_error": mean FLIP (lod/raster/flip.h), "m16": of blocks (lod/raster/blocks.h) } of the picture at the last
 * call beside the last picture, which is the truth; null: there is none of its size. Colours of all samples. NULL: see web_error. */
const char *web_compare(struct web *web);
/* Height of the ground that is drawn at a place, metres; NaN where there is none. */
double web_ground(const struct web *web, double x, double y);
/* JSON at a pixel (from the top left; beside the picture is the sky), or near one of a plant:
 *
 *   { "kind": "sky" }
 *   { "kind": "ground", "at": [x, y, z], "distance_m": d }
 *   { "kind": "summary", ... as the ground, "number": n, "plant": NAME }     a point for many plants
 *   { "kind": "plant", ... as a summary, "height_m": h, "scale": s, "list": l, "index": i, "foot": [x, y, z],
 *     "crown_m": w, "tint": "#rrggbb", "cuts": [{ "role": NAME, "list": l, "first": f, "end": e, "of": primitives, "vertices": v }] }
 *
 * `at` is what is seen there, `foot` where the plant stands: metres from the scene's origin. `plant` is the
 * pack's plant that is drawn, which may stand for several species; list and index name the one that was
 * picked to the server, which knows its species and its row. `crown_m` is the mean of two widths of what is held of
 * it; 0: unknown. `tint` is the colour of its class, black where that is its own. A plant that is picked is highlighted in what web_present shows. NULL: see web_error. */
const char *web_pick(struct web *web, double x, double y);
/* Plants in view, the nearest first, as web_pick says them up to `foot`, without `at`: JSON's array, of so many at
 * most. NULL: no memory. */
const char *web_plants(struct web *web, double most);
/* Highlights this plant, from now on; a list of -1: none. Nested scenes may have it several times: the nearest. JSON as of
 * web_pick, without `at`; null: it is not in view. NULL: no memory. */
const char *web_mark(struct web *web, double list, double index);
const char *web_digest(struct web *web);
