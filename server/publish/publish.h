/* A folder of plain files that shows scenes on any static host, without a server (README.md):
 *
 *   index.html, viewer/VERSION/...        the viewer of `make web`, with its scenes' descriptions in the page
 *   NAME/scene.json, NAME/species.json    what ecoserve answers to /v1/scenes/NAME, .../species
 *   NAME/ID/index.bin                     what plans are made from (index.h); ID: the pack's
 *   NAME/ID/chunks.bin                    all chunks, in the pack's order; of the inventory the named columns alone
 *   NAME/ID/first-N.bin                   ecoserve's answers to the first view, and to each saved one
 *
 * Files are written one by one, index.html last, so that a folder may be published into again. Other files there are
 * left alone, and so is what belongs to packs that were replaced. */
#pragma once

#include <stdint.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/status.h"

#define SRV_PUBLISH_VIEWS_MAX 100u

struct srv_publish {
	char *const *packs;      uint32_t count;         /* [NAME=]OUT.eco each, as ecoserve's */
	const char *folder;      /* is made if it is missing */
	const char *viewer;      /* NULL: where ecoserve finds it */
	const struct eco_string_pool *columns;   /* of the packs' rows, for all to see; NULL or empty: no rows at all */
	const char *views;       /* a camera script, whose keyframes are saved views of the only pack; NULL: none */
};
struct srv_published { uint64_t files, bytes, index_bytes, first_bytes; };       /* index, first: of all scenes */

enum eco_code srv_publish(const struct srv_publish *publish, struct srv_published *published, struct eco_error *error);
