/* Chunks that a stream names, fetched by their ids: from the server's chunks/{id}, or from any host that has
 * them as files of these names (ecopack export). Several at once, over connections that stay.
 *
 *   view_chunks_new(&chunks, &options, &error);
 *   view_chunks_want(chunks, &id, size, &error);             as names come: begins to fetch
 *   view_chunks_take(chunks, &id, size, &bytes, &error);     waits for one; what comes meanwhile is kept
 *   view_chunks_forget(chunks);                              after a stream
 *   view_chunks_free(chunks);
 *
 * Redirects are followed, a few of them, by http and https; what fails is asked for once more; a host that
 * says when (429 or 503 with Retry-After) is not asked before. A host that sends less than 1 KiB/s for 10 s
 * while its chunks are waited for hangs. One thread at a time. */
#ifndef VIEW_CHUNKS_H
#define VIEW_CHUNKS_H

#include <curl/curl.h>
#include <signal.h>

#include "ecofiles/format/pack.h"

struct view_chunks;

/* A stream that names chunks is held until they are there. */
#define VIEW_NAMED_STREAM_MAX ((uint64_t)256 << 20)

struct view_chunks_options {
	const char *url;                         /* a chunk is at url/ID, 32 hexadecimal digits */
	/* milliseconds: to connect, and without a byte */
	long connect_ms, stall_ms;
	/* a host that sends nothing but when it wants to be asked again is asked for so long; 0: it is an
	 * error
	 */
	long patience_ms;
	const volatile sig_atomic_t *stop;       /* not 0: end with ECO_INTERRUPTED; may be NULL */
};

/* ECO_BAD_USAGE: chunks cannot lie below it, as below one that is none of http or https. */
enum eco_code view_chunks_check_url(const char *url, struct eco_error *error);
enum eco_code view_chunks_new(struct view_chunks **chunks, const struct view_chunks_options *options,
	struct eco_error *error);
void view_chunks_free(struct view_chunks *chunks);               /* NULL is fine */

/* A chunk that is wanted already is fetched once. */
enum eco_code view_chunks_want(struct view_chunks *chunks, const struct eco_chunk_id *id, uint32_t size,
	struct eco_error *error);
/* *bytes: `size` of them, which have the hash that names the chunk, until forget. Errors name its URL:
 * ECO_DAMAGED where there are other bytes, ECO_IO where it does not come. */
enum eco_code view_chunks_take(struct view_chunks *chunks, const struct eco_chunk_id *id, uint32_t size,
	const uint8_t **bytes, struct eco_error *error);
void view_chunks_forget(struct view_chunks *chunks);
/* Whether the host may have later what it had not: of one that never sent a chunk, and never said that it has
 * trouble (408, 429, 500 and above), the address may be wrong. */
bool view_chunks_known(const struct view_chunks *chunks);
/* Whether it hangs, or had chunks and takes no connection now: what is wanted is to be had elsewhere. */
bool view_chunks_hangs(const struct view_chunks *chunks);

/* ---- What all that ask by HTTP share ---- */

/* A handle for http and https; it follows redirects where it is told to, at most 5. NULL: no memory. */
CURL *view_curl_new(const char *agent, long connect_ms);
/* Time that the last answer's Retry-After asks to wait, from .1 to 30 s; 0: none, a longer one, or a date. */
double view_retry_ms(CURL *curl);
/* Milliseconds of `plan;dur=` in the last answer's Server-Timing; NaN: they are not there. */
double view_plan_ms(CURL *curl);
double view_plan_ms_read(const char *value);                     /* the same of the header's value */
/* Length of a URL without slashes at its end. */
int view_url_length(const char *url);

#endif
