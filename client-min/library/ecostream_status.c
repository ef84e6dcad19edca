#include "client-min/library/ecostream_status.h"

#include <stdio.h>
#include <string.h>

#include "ecofiles/base/text.h"
#include "ecofiles/base/version.h"

_Static_assert((int)ECOSTREAM_BAD_USAGE == (int)ECO_BAD_USAGE && (int)ECOSTREAM_DAMAGED == (int)ECO_DAMAGED
	&& (int)ECOSTREAM_IO == (int)ECO_IO && (int)ECOSTREAM_INTERRUPTED == (int)ECO_INTERRUPTED
	&& (int)ECOSTREAM_INTERRUPTED + 1 == (int)ECO_CODE_COUNT, "public codes are the rooms'");

const char *ecostream_version(void) { return ECO_VERSION; }

enum ecostream_code library_done(struct ecostream_error *error, enum eco_code code,
	const struct eco_error *own)
{
	if (code && error && !error->code) {
		error->code = (enum ecostream_code)code;
		eco_phrase_cut(error->text, sizeof error->text,
			snprintf(error->text, sizeof error->text, "%s", own->text));
	}
	return (enum ecostream_code)code;
}

struct eco_view library_view_of(const struct ecostream_request *request)
{
	struct eco_view view = { .fov_y_deg = request->fov_y_deg, .width = request->width,
		.height = request->height };
	memcpy(view.eye, request->eye, sizeof view.eye);
	memcpy(view.target, request->target, sizeof view.target);
	memcpy(view.up, request->up, sizeof view.up);
	return view;
}
