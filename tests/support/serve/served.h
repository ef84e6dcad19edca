/* A scene of scratch.h's folder, made into a pack, served, and held by a client: what is seen of it.
 *
 *   served_open(&seen, "a.json", "a.eco");      a draft; fails the test where that fails
 *   served_look(&seen, &view, ground_px);       asks for a view; seen.selection is what is drawn of it
 *   served_close(&seen); */
#pragma once

#include "client-min/view_select.h"
#include "server/stream.h"

struct served {
	struct srv_store packs;
	const struct srv_scene *scene;
	struct view_store *held;
	struct view_selection selection;
	struct lod_eye eye;
	uint64_t vertices;               /* of each view; 0: ground alone, without its image */
};

/* Begins, feeds and ends a stream of the store; *bytes, if not NULL: its size. */
enum eco_code served_feed(struct view_store *held, const struct srv_stream *stream, uint64_t *bytes,
	struct eco_error *error);
/* A sample pack on hilly ground of side x side samples about the origin, written, opened and removed: its scene. */
const struct srv_scene *served_sample(struct srv_store *packs, const char *path, uint32_t side, double step_m,
	bool plain, double (*height)(double x, double y));

void served_open(struct served *seen, const char *json, const char *pack);
void served_look(struct served *seen, const struct eco_view *view, double ground_px);
void served_close(struct served *seen);
