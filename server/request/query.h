/* Parameters of requests, as openapi.yaml lists them.
 *
 * Numbers are plain decimals: [-]digits[.digits][e[+-]digits] for coordinates and angles, digits for counts.
 * Unknown parameters are refused, so that a misspelt budget is an error and not an unbounded answer. `pack`
 * is the id of the pack that the holdings of the request refer to: if the scene has been rebuilt since, the
 * server says so instead of mixing two packs. */
#pragma once

#include <stdbool.h>

#include "ecofiles/format/list.h"
#include "ecofiles/format/view.h"
#include "lod/plan/planner.h"
#include "server/request/target.h"

struct srv_pack_named { struct eco_chunk_id id; bool given; };

struct srv_query {
	struct eco_request request;
	lod_rule *rule;
	bool explain;
	struct srv_pack_named pack;
};

/* Fills *query; the view passes eco_view_check. ECO_BAD_INPUT with a text that names the parameter and says
 * what is wrong. */
enum eco_code srv_query_parse(struct srv_query *query, const struct srv_target *target,
	struct eco_error *error);

#define SRV_PLANTS_MAX 1024u     /* of an answer */
struct srv_plants_query { uint64_t first, count; struct srv_pack_named pack; };
/* ?first=N&count=N&pack=ID, all optional. */
enum eco_code srv_plants_query_parse(struct srv_plants_query *query, const struct srv_target *target,
	struct eco_error *error);

#define SRV_FIND_TEXT_BYTES 100u
#define SRV_FIND_BLOCKS 4u       /* of 4096 plants that are looked at for an answer, ... */
#define SRV_FIND_MAX 64u         /* ... and plants of it */
struct srv_find_query { char text[SRV_FIND_TEXT_BYTES + 1]; uint64_t first, count; struct srv_pack_named pack; };
/* ?text=T&first=N&count=N&pack=ID; all but the text are optional. */
enum eco_code srv_find_query_parse(struct srv_find_query *query, const struct srv_target *target,
	struct eco_error *error);

/* A route without parameters: ECO_BAD_INPUT if there are any. */
enum eco_code srv_query_none(const struct srv_target *target, struct eco_error *error);

bool srv_parse_number(const char *text, double *value);      /* finite decimal, whole text */
bool srv_parse_count(const char *text, uint64_t *value);     /* digits, whole text, below 2^64 */

/* 32 lower-case hex digits (upper case is refused: one chunk, one URL). */
bool srv_parse_id(const char *text, struct eco_chunk_id *id);
