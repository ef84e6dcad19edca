/* The state of a pack writer: gathered by pack_writer.c, laid out and published by pack_commit.c. */
#ifndef ECO_PACK_WRITER_H
#define ECO_PACK_WRITER_H

#include "ecofiles/format/pack.h"

/* Finds chunks by their id, to store equal payloads once: open addressing over chunk indices + 1. */
struct id_table {
	uint32_t *slots;
	uint32_t size;               /* power of two, more than twice the chunks */
};

struct eco_pack_writer {
	char *path, *temporary, *folder;
	int file, spool;             /* -1 when closed */
	uint64_t spooled;
	struct eco_list *lists;
	uint32_t list_count, list_capacity;
	struct eco_chunk *chunks;    /* offsets relative to the spool until commit */
	uint32_t chunk_count, chunk_capacity;
	struct id_table ids;
};

/* Writes the error: what could not be done, and why (errno). Returns ECO_IO. */
enum eco_code eco_pack_io_failed(const char *path, const char *what, struct eco_error *error);

/* Writes all bytes, in as many calls as it takes. `path` is for errors. */
enum eco_code eco_pack_write_all(int file, const char *path, const void *bytes, size_t size,
	struct eco_error *error);

#endif
