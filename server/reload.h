/* The scenes that arguments name, opened at start and at each reload: "[NAME=]OUT.eco" is a pack, "FOLDER"
 * all packs OUT.eco in it. A reload shares unchanged packs with the store before. If a pack cannot be read,
 * or is not well, the scene that was made of its file before stays, and the report says so. */
#ifndef SRV_RELOAD_H
#define SRV_RELOAD_H

#include "server/store.h"

struct srv_sources {
	char *const *arguments; uint32_t count;
	const char *copies;              /* as struct srv_store */
	const atomic_bool *cancelled;
};

struct srv_reload {
	uint32_t opened, same, gone;     /* scenes */
	uint32_t bad;                    /* packs that are not well */
	char why[2048]; /* what was not well, with "; " between; as many as there is room for */
};

/* The file or folder of an argument; *name: SRV_NAME_BYTES + 1 bytes, "" where it names no scene. */
const char *srv_source_path(const char *argument, char name[SRV_NAME_BYTES + 1]);
/* Whether an argument gives a scene this name, so that no other pack may have it. */
bool srv_sources_name(const struct srv_sources *sources, const char *scene);

/* Fills `store`, which the caller frees whatever comes. `before` NULL: the first time, when names that cannot
 * be are an error, too. Without any scene it fails as the first of its packs did. */
enum eco_code srv_sources_load(const struct srv_sources *sources, const struct srv_store *before,
	struct srv_store *store, struct srv_reload *report, struct eco_error *error);

#endif
