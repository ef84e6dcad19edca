/* Streams that come in: the store of ecoview, fed by hand. */
#include "client-min/library/ecostream_client.h"

#include <stdlib.h>

#include "client-min/library/ecostream_status.h"

enum ecostream_code ecostream_client_new(struct ecostream_client **out, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct ecostream_client *client = calloc(1, sizeof *client);
	enum eco_code code = client ? view_store_new(&client->store, &(struct view_store_options){ 0 }, &own)
		: eco_fail(&own, ECO_NO_MEMORY, "no memory for a client");
	if (code) {
		free(client);
		client = NULL;
	}
	*out = client;
	return library_done(error, code, &own);
}

static void end_stream(struct ecostream_client *client)
{
	eco_wire_parser_free(client->parser);
	client->parser = NULL;
}

void ecostream_client_free(struct ecostream_client *client)
{
	if (!client)
		return;
	end_stream(client);
	view_store_free(client->store);
	free(client);
}

enum ecostream_code ecostream_client_holdings(const struct ecostream_client *client, void **bytes,
	size_t *size, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct eco_holdings holdings;
	struct eco_writer writer = { 0 };
	*bytes = NULL;
	*size = 0;
	enum eco_code code = view_store_holdings(client->store, &holdings, &own);
	if (!code)
		eco_wire_write_holdings(&writer, &holdings);
	free(holdings.items);
	if (writer.failed)
		code = eco_fail(&own, ECO_NO_MEMORY, "no memory for the list of what is held");
	if (code) {
		eco_writer_free(&writer);
		return library_done(error, code, &own);
	}
	*bytes = writer.bytes;
	*size = writer.size;
	return ECOSTREAM_OK;
}

enum ecostream_code ecostream_client_begin(struct ecostream_client *client, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	end_stream(client);
	view_store_begin(client->store);
	return library_done(error, eco_wire_parser_new(&client->parser, &view_store_events, client->store,
		&own), &own);
}

static enum eco_code not_begun(struct eco_error *error)
{
	return eco_fail(error, ECO_BAD_USAGE, "no stream has begun: ecostream_client_begin comes first");
}

enum ecostream_code ecostream_client_feed(struct ecostream_client *client, const void *bytes, size_t size,
	struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code = client->parser ? eco_wire_feed(client->parser, bytes, size, &own)
		: not_begun(&own);
	return library_done(error, code, &own);
}

enum ecostream_code ecostream_client_end(struct ecostream_client *client, struct ecostream_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code = client->parser ? eco_wire_finish(client->parser, &own) : not_begun(&own);
	uint64_t vertices;
	if (!code && view_store_again(client->store, &vertices))
		code = eco_fail(&own, ECO_TOO_LARGE,
			"a part of what the plan needs had to go to stay within the memory: "
			"ask again, with the holdings of now, or for fewer vertices");
	end_stream(client);
	return library_done(error, code, &own);
}
