/* The scenes that are served, which may be replaced while they are: by editions. A request holds the edition
 * that it found when it came, to its end; who comes later finds the next one. What only the edition before
 * had is kept for a stated time, so that a client that was just told of a chunk still gets it.
 *
 *   srv_catalog_new(&catalog, &store, &error);               the first edition shares the store's scenes
 *   edition = srv_catalog_hold(catalog);
 *   ... srv_store_find(&edition->store, "park") ...
 *   srv_edition_release(edition);
 *   srv_catalog_replace(catalog, &other, until_us, now_us, &error);      scenes of both are shared
 *   srv_catalog_retire(catalog, now_us, &error);             now and then: forgets what was kept until then
 *   srv_catalog_free(catalog);
 *
 * A mutex guards which edition is the current one; an edition never changes. */
#ifndef SRV_CATALOG_H
#define SRV_CATALOG_H

#include "server/store.h"

#define SRV_RETIRED_MAX 64u              /* scenes: each keeps its pack */
struct srv_retired { struct srv_scene *scene; uint64_t until_us; };
struct srv_edition {
	struct srv_store store;
	struct srv_retired *retired; uint32_t retired_count;     /* the latest first */
	_Atomic(uint32_t) holders;
};

struct srv_catalog;
enum eco_code srv_catalog_new(struct srv_catalog **catalog, const struct srv_store *store,
	struct eco_error *error);
/* After the last holder of an edition has released it; NULL is fine. */
void srv_catalog_free(struct srv_catalog *catalog);
struct srv_edition *srv_catalog_hold(struct srv_catalog *catalog);
void srv_edition_release(struct srv_edition *edition);           /* NULL is fine */

/* Scenes that `store` does not have are kept until `until_us` (srv_clock_us). Replace and retire are called
 * by one thread at a time. */
enum eco_code srv_catalog_replace(struct srv_catalog *catalog, const struct srv_store *store,
	uint64_t until_us, uint64_t now_us, struct eco_error *error);
enum eco_code srv_catalog_retire(struct srv_catalog *catalog, uint64_t now_us, struct eco_error *error);

/* The scene of this name, or NULL; `retired`: if there is none, one that was. */
struct srv_scene *srv_edition_find(const struct srv_edition *edition, const char *name, bool retired);
/* The chunk's scene of this name, which may be a retired one, and its index there; NULL: there is none. */
struct srv_scene *srv_edition_chunk(const struct srv_edition *edition, const char *name,
	const struct eco_chunk_id *id, uint32_t *chunk);

#endif
