/* The scenes that arguments name, opened at start and again whenever the operator wants: "[NAME=]OUT.eco" is
 * a pack, "FOLDER" all packs OUT.eco in it.
 *
 * Again: what has not changed is shared with the store before. Where a pack cannot be read, or is not well,
 * the scene that was made of its file before stays, and the report says so. */
#ifndef SRV_RELOAD_H
#define SRV_RELOAD_H

#include "server/store.h"

struct srv_sources {
	char *const *arguments; uint32_t count;
	const char *copies;              /* as struct srv_store */
	const atomic_bool *cancelled;
};

struct srv_reload {
	uint32_t opened, same, kept, gone;       /* scenes; kept: in place of what is not well */
	char why[2048]; /* what was not well, a line each; as many as there is room for */
};

/* Fills `store`, which the caller frees whatever comes. `before` NULL: the first time, when anything that is
 * not well is an error. */
enum eco_code srv_sources_load(const struct srv_sources *sources, const struct srv_store *before,
	struct srv_store *store, struct srv_reload *report, struct eco_error *error);

#endif
