#include "client-min/view_query.h"

#include <stdio.h>

static size_t append_numbers(char *out, size_t room, size_t at, const char *name, const double *v, int count)
{
	for (int i = 0; i < count && at < room; i++)
		at += (size_t)snprintf(out + at, room - at, "%s%s%.17g", i ? "," : name, i ? "" : "=", v[i]);
	return at;
}

size_t view_query_write(const struct eco_request *request, const struct eco_chunk_id *pack, char *out,
	size_t room)
{
	const struct eco_view *v = &request->view;
	size_t at = append_numbers(out, room, 0, "eye", v->eye, 3);
	at = append_numbers(out, room, at, "&target", v->target, 3);
	at = append_numbers(out, room, at, "&up", v->up, 3);
	at = append_numbers(out, room, at, "&fov_y_deg", &v->fov_y_deg, 1);
	if (at < room)
		at += (size_t)snprintf(out + at, room - at, "&width=%u&height=%u&vertices=%llu", v->width,
			v->height, (unsigned long long)request->vertices);
	if (at < room && request->bytes != ECO_BYTES_UNBOUNDED)
		at += (size_t)snprintf(out + at, room - at, "&bytes=%llu",
			(unsigned long long)request->bytes);
	if (at < room && request->ground_px > 0)
		at = append_numbers(out, room, at, "&ground_px", &request->ground_px, 1);
	if (at < room && request->texel_px > 0)
		at = append_numbers(out, room, at, "&texel_px", &request->texel_px, 1);
	if (at < room && request->name_from)
		at += (size_t)snprintf(out + at, room - at, "&name_from=%llu",
			(unsigned long long)request->name_from);
	if (at < room && request->next.given) {
		at = append_numbers(out, room, at, "&next_eye", request->next.eye, 3);
		at = append_numbers(out, room, at, "&next_target", request->next.target, 3);
	}
	if (at < room && pack)
		at += (size_t)snprintf(out + at, room - at, "&pack=%s", eco_id_text(pack->bytes).hex);
	return at;
}
