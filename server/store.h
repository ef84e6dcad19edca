/* Sets of scenes, and their replacement while they are served. A scene is opened, checked, and never changed,
 * so that any number of threads read it without locks; only marks change, each once and atomically: per chunk
 * "hash checked", and the work of an ordinary plan. The planner's tables fill themselves likewise
 * (lod/plan/plan_tables.h).
 *
 * Payloads stay in the mapped pack: the system's page cache keeps those in use (figures: lod/EXPERIMENTS.md,
 * "Memory of client and server"). A cache of our own would hold the same bytes twice.
 *
 *   srv_store_init(&store);
 *   srv_store_add(&store, NULL, "scbi.eco", &error);         opens and checks the pack, takes its name
 *   const struct srv_scene *s = srv_store_find(&store, "scbi");
 *   srv_scene_payload(s, chunk, &bytes, &size, &error);      a chunk's bytes, hash checked the first time
 *   srv_catalog_replace(&catalog, &store, 0, 0, &error);     is served from now on
 *   edition = srv_catalog_hold(&catalog);                    for one request, to its end
 *   srv_edition_release(edition);
 *   srv_store_free(&store);
 *
 * A request holds the edition that it found when it came; later ones find the next. Editions share the scenes
 * whose files have not changed: each counts as a holder. Scenes that only the edition before had are kept for
 * a stated time, so that a client that was just told of a chunk still gets it. */
#pragma once

#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "ecofiles/format/pack.h"
#include "lod/plan/planner.h"

#define SRV_NAME_BYTES 64
#define SRV_SCENES_MAX 1024u
#define SRV_RETIRED_MAX 64u              /* scenes: each keeps its pack */

/* The identity of a file. */
struct srv_file { char *path; uint64_t device, number, size_bytes; int64_t modified_s, modified_ns; };

/* The first view of a scene: a box in metres, in the scene's coordinates. A picture of all trees of a city is
 * a haze of dots, and its middle may be a river; therefore the first view of a wide scene is a place with
 * many plants. */
struct srv_outlook { double low[3], high[3]; };

struct srv_scene {
	_Atomic(uint32_t) holders;
	char name[SRV_NAME_BYTES];
	struct eco_pack *pack;
	struct srv_file file;                    /* that the pack was read from; path NULL: not known */
	int64_t modified_s;                      /* when it was last changed, since 1970 */
	json_t *meta;                            /* of the pack; an object if it has none */
	struct lod_plan_tables *tables;
	struct srv_outlook outlook;
	_Atomic(uint64_t) typical_work;          /* of a plan (stream.h); 0: not found yet */
	uint32_t *by_id;                         /* chunk indices sorted by id */
	_Atomic(uint8_t) *checked;               /* per chunk: the payload's hash has been found right */
};

struct srv_store {
	struct srv_scene **scenes;
	uint32_t count;
	/* Set before scenes are added: packs are copied to this folder, so that a scene stays what was
	 * checked, whatever becomes of its file. NULL: they are mapped where they are; a file that is
	 * written over sends damage, and one that is cut short ends the process (SIGBUS). */
	const char *copies;
	const atomic_bool *cancelled;            /* set: no further pack is added (ECO_INTERRUPTED); or NULL */
};

void srv_store_init(struct srv_store *store);
/* Releases its scenes. */
void srv_store_free(struct srv_store *store);

/* Adds the pack at `path` as `name`; NULL takes the scene's own name where it is a valid one, else
 * srv_name_of_file. Names are [a-z0-9][a-z0-9_-]{0,62}. Errors name the file and say what to do. */
enum eco_code srv_store_add(struct srv_store *store, const char *name, const char *path,
	struct eco_error *error);
/* Shares a scene of another store, under its own name. */
enum eco_code srv_store_share(struct srv_store *store, struct srv_scene *scene, struct eco_error *error);
/* The scene that was read from `path` (any name: NULL), or NULL; `same`: and whose file has not changed. */
struct srv_scene *srv_store_find_file(const struct srv_store *store, const char *name, const char *path,
	bool same);

struct srv_scene *srv_store_find(const struct srv_store *store, const char *name);       /* or NULL */
bool srv_name_valid(const char *name);
/* "/data/Parque Eduardo VII.eco" -> "parque-eduardo-vii". Not a valid name where the file's has no letter or
 * digit that one may have. */
void srv_name_of_file(char name[SRV_NAME_BYTES], const char *path);

/* The payload in the mapped pack; valid as long as the store. ECO_DAMAGED names the chunk. Thread-safe. */
enum eco_code srv_scene_payload(const struct srv_scene *scene, uint32_t chunk, const uint8_t **bytes,
	size_t *size_bytes, struct eco_error *error);

/* ---- Editions ---- */

struct srv_edition {                     /* never changes */
	struct srv_store store;
	struct { struct srv_scene *scene; uint64_t until_us; } retired[SRV_RETIRED_MAX];         /* the latest first */
	uint32_t retired_count;
	_Atomic(uint32_t) holders;
};
struct srv_catalog {
	pthread_mutex_t mutex;
	struct srv_edition *current;     /* under the mutex; NULL: none yet */
};

struct srv_edition *srv_catalog_hold(struct srv_catalog *catalog);
void srv_edition_release(struct srv_edition *edition);           /* NULL is fine */
/* Shares the store's scenes; those that it does not have are kept until `until_us` (srv_clock_us). Replace
 * and retire are called by one thread at a time. */
enum eco_code srv_catalog_replace(struct srv_catalog *catalog, const struct srv_store *store,
	uint64_t until_us, uint64_t now_us, struct eco_error *error);
/* Forgets what was kept until now. */
enum eco_code srv_catalog_retire(struct srv_catalog *catalog, uint64_t now_us, struct eco_error *error);

/* The scene of this name, or NULL; `retired`: if there is none, one that was. */
struct srv_scene *srv_edition_find(const struct srv_edition *edition, const char *name, bool retired);
/* The chunk's scene of this name, which may be a retired one, and its index there; NULL: there is none. */
struct srv_scene *srv_edition_chunk(const struct srv_edition *edition, const char *name,
	const struct eco_chunk_id *id, uint32_t *chunk);

/* All of a scene that is at most SRV_OUTLOOK_WHOLE_M wide. In a wider one, the plants of a square of 200 m:
 * the one that holds the most, or half as many nearer to the scene's middle. All 0 without tiles. Looks at
 * some hundred thousand plants of an eco file at most, evenly. */
#define SRV_OUTLOOK_WHOLE_M 1000.0
enum eco_code srv_outlook_find(const struct eco_scene *scene, struct srv_outlook *out,
	struct eco_error *error);

/* ---- Sources ---- */

/* The scenes that arguments name, opened at start and at each reload: "[NAME=]OUT.eco" is a pack, "FOLDER"
 * all packs OUT.eco in it. A reload shares unchanged packs with the store before. If a pack cannot be read,
 * or is not well, the scene that was made of its file before stays, and the report says so. */
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
