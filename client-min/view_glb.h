/* A view as a file for other programs: glTF 2.0, binary, of plain triangles (lod/bake.h). Plants that draw
 * the same cuts share a mesh, and each is a node with its species' name, or where none is known, that of what
 * it is shown as; a camera sees the view. Y is up, as in glTF; metres from the scene's origin. No extension is
 * needed.
 *
 *   root   extras.vertices: what ecoview counts for the view; turns Z up to Y up
 *    |-- camera
 *    |-- ground                        its tiles, where there is ground
 *    |-- SPECIES ...                   a node a plant; extras: height_m, and species (null: its row states none),
 *    |                                 plant, file, row and line as in view_geojson.h, as far as known
 *    '-- summary ...                   points that stand for many plants */
#ifndef VIEW_GLB_H
#define VIEW_GLB_H

#include "client-min/view_plants.h"
#include "client-min/view_select.h"
#include "ecofiles/base/bytes.h"

struct view_glb_job {
	const struct view_store *store;
	const struct view_selection *selection;
	const struct eco_view *view;
	struct view_fetch *fetch;                /* asks for species and rows; NULL: not asked for */
};
/* The whole file into `out`, which the caller frees. ECO_TOO_LARGE beyond 4 GiB. */
enum eco_code view_glb_write(const struct view_glb_job *job, struct eco_writer *out, struct eco_error *error);
/* The same as DIR/frame-0000.glb. */
enum eco_code view_glb_save(const struct view_glb_job *job, const char *dir, uint32_t frame,
	struct eco_error *error);

#endif
