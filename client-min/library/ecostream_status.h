/* From the rooms' codes and errors to those of ecostream.h, which are the same ones under public names. */
#pragma once

#include "client-min/library/ecostream.h"
#include "ecofiles/base/status.h"
#include "ecofiles/format/view.h"

/* Returns `code`; a failure's text goes to `error`, which may be NULL, unless one is there already. */
enum ecostream_code library_done(struct ecostream_error *error, enum eco_code code,
	const struct eco_error *own);

struct eco_view library_view_of(const struct ecostream_request *request);
