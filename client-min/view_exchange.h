/* One request to the server of a scene and its answer, moved on by libcurl's multi interface. Chunks that an
 * answer only names come from a host of their own, which has them by their ids: several at once,
 * over connections that stay, while the answer comes.
 *
 *   view_exchange_new(&x, &options, &error);
 *   view_exchange_begin(x, &job, &error);
 *   until view_exchange_end(x)->done:
 *           wait for sockets of options.multi, at most until view_exchange_wakes_ms(x)
 *           view_exchange_transferred(curl, rc) for each message
 *           view_exchange_wake(x)
 *   view_exchange_free(x);
 *
 * Hosts of chunks may redirect, a few times, by http and https. */
#pragma once

#include <curl/curl.h>

#include "client-min/view_store.h"
#include "ecofiles/base/bytes.h"

struct view_exchange;

struct view_exchange_options {
	CURLM *multi;                    /* outlives it */
	const char *agent;
	/* a chunk is at chunks/ID, 32 hexadecimal digits; NULL: none is named */
	const char *chunks;
	long connect_ms;
	/* less than 1 KiB/s came of the answer, or a seventh of a chunk, for so long; 0: that is no matter */
	long stall_s, chunk_stall_s;
	bool fresh;                      /* each transfer has a connection of its own */
	/* a simulated line, which all transfers share; 0: as fast as it is */
	uint64_t bandwidth_bytes_s;
	double latency_ms;               /* of each request for a chunk */
	/* called when an exchange is done, within transferred or wake; may be NULL */
	void (*ended)(void *ctx);
	void *ctx;
};

struct view_exchange_job {
	const char *url;                         /* with its query */
	const struct eco_writer *body;           /* is posted, and outlives the exchange; NULL: GET */
	bool names;                              /* the answer is a stream that may name chunks */
	uint64_t most_bytes;                     /* of the answer with its chunks */
	/* takes a body of status 200: as it comes, or with names at once, when all chunks are here */
	enum eco_code (*take)(void *ctx, const uint8_t *bytes, size_t size, struct eco_error *error);
	void *ctx;
};

/* The state of an exchange. */
struct view_exchange_end {
	bool done;
	bool of_chunk;                   /* the transfer that failed was a chunk's; `error` names its URL */
	bool known;                      /* the host had a chunk, or said that it has trouble, once */
	/* the host sends nothing, or had chunks and takes no connection now */
	bool hangs;
	CURLcode rc;                     /* of the answer, or of the transfer that failed */
	const char *text;                /* of a failure: how long, how much, to where; never NULL */
	long status;                     /* HTTP; 0: there was none */
	const char *type;                /* of the content; NULL: not said */
	struct eco_error error;          /* of what was taken, or of a chunk */
	uint64_t bytes;                  /* of all bodies */
	uint64_t length;                 /* of the answer, as it says; 0: it does not */
	uint64_t named, named_bytes;     /* chunks */
	double first_byte_ms;            /* view_clock_ms; NaN: none came */
	double plan_ms;                  /* of Server-Timing; NaN: not said */
	double retry_ms;                 /* of Retry-After, from .1 to 30 s; 0: not said, longer, or a date */
	struct eco_writer problem;       /* the first 16 KiB of a body of another status */
};

enum eco_code view_exchange_new(struct view_exchange **x, const struct view_exchange_options *options,
	struct eco_error *error);
void view_exchange_free(struct view_exchange *x);                /* NULL is fine */
enum eco_code view_exchange_begin(struct view_exchange *x, const struct view_exchange_job *job,
	struct eco_error *error);
/* Ends all transfers; what came is known until the next exchange begins. */
void view_exchange_cancel(struct view_exchange *x);
const struct view_exchange_end *view_exchange_end(const struct view_exchange *x);

void view_exchange_transferred(CURL *curl, CURLcode rc);
double view_exchange_wakes_ms(const struct view_exchange *x);    /* INFINITY: only for its sockets */
void view_exchange_wake(struct view_exchange *x);

/* The payload of the next chunk in the order of names, for a store (view_store_find_by); ctx is the exchange.
 * ECO_IO: it did not come. */
view_store_find view_exchange_find;
/* After a failure, with names: what came of the stream is taken, up to the first chunk that is missing. */
void view_exchange_salvage(struct view_exchange *x);

/* ECO_BAD_USAGE: chunks cannot lie below that URL, as below one that is none of http or https. */
enum eco_code view_exchange_check_chunks(const char *url, struct eco_error *error);
double view_plan_ms_read(const char *value);     /* plan_ms of a header's value */
int view_url_length(const char *url);            /* without slashes at its end */
