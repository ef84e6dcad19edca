/* What the files of ecostream_client and ecostream_picture share. */
#ifndef ECOSTREAM_CLIENT_H
#define ECOSTREAM_CLIENT_H

#include "client-min/view_store.h"

struct ecostream_client {
	struct view_store *store;
	struct eco_wire_parser *parser;  /* of the stream under way, or NULL */
};

#endif
