/* Views whose heights count from the ground (eco_camera_above_ground). Only the ground itself says where they
 * are, so it is asked for straight below, as for a picture of one pixel from far above. The tiles that come
 * are those of full detail, which a view from there needs anyway, and are held for it. */
#ifndef VIEW_STAND_H
#define VIEW_STAND_H

#include "client-min/view_fetch.h"

/* Raises eye and target of request->view by the ground below each, and the next view's by as much; nothing
 * where there is no ground. The store's plan is then not one to draw. *result: bytes and requests of all
 * that was asked. */
enum eco_code view_stand(struct view_fetch *fetch, struct view_store *store, struct eco_request *request,
	struct view_fetch_result *result, struct eco_error *error);

#endif
