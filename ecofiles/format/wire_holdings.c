/* A client's holdings as it tells the server: the body of a POST, so the first bytes that a stranger
 * sends. */
#include "ecofiles/format/wire.h"

#include <stdlib.h>

void eco_wire_write_holdings(struct eco_writer *w, const struct eco_holdings *holdings)
{
	uint32_t before = 0;
	eco_write_u32(w, holdings->count);
	for (uint32_t i = 0; i < holdings->count; i++) {
		eco_write_varint(w, holdings->items[i].list - before);
		eco_write_varint(w, holdings->items[i].chunks);
		before = holdings->items[i].list;
	}
}

static enum eco_code read_items(struct eco_reader *r, struct eco_holding *items, uint32_t count,
	struct eco_error *error)
{
	uint64_t list = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint64_t step = eco_read_varint(r), chunks = eco_read_varint(r);
		if (r->failed)
			return eco_fail(error, ECO_BAD_INPUT, "holdings: item %u of %u is cut off or not a "
				"canonical number, near byte %zu", i, count, r->at);
		if (i && step == 0)
			return eco_fail(error, ECO_BAD_INPUT, "holdings: item %u repeats list %llu", i,
				(unsigned long long)list);
		if (step >= ECO_NONE - list)
			return eco_fail(error, ECO_BAD_INPUT, "holdings: item %u names a list beyond %u", i,
				ECO_NONE - 1);
		if (chunks == 0 || chunks > UINT32_MAX)
			return eco_fail(error, ECO_BAD_INPUT, "holdings: item %u holds %llu chunks: leave "
				"out lists of which nothing is held", i, (unsigned long long)chunks);
		list += step;
		items[i] = (struct eco_holding){ (uint32_t)list, (uint32_t)chunks };
	}
	if (r->at != r->size)
		return eco_fail(error, ECO_BAD_INPUT, "holdings: %zu bytes follow item %u, the last",
			r->size - r->at, count);
	return ECO_OK;
}

enum eco_code eco_wire_read_holdings(const uint8_t *bytes, size_t size, struct eco_holdings *holdings,
	struct eco_error *error)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	uint32_t count = eco_read_u32(&r);
	*holdings = (struct eco_holdings){ 0 };
	if (r.failed)
		return eco_fail(error, ECO_BAD_INPUT, "holdings: %zu bytes, at least 4 are needed for the "
			"count", size);
	if (count > ECO_HOLDINGS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "holdings: %u lists, at most %u", count,
			ECO_HOLDINGS_MAX);
	/* the smallest item takes two bytes: allocate no more than can be there */
	if (count > (size - r.at) / 2)
		return eco_fail(error, ECO_BAD_INPUT, "holdings: %zu bytes cannot hold %u items", size,
			count);
	struct eco_holding *items = malloc(count ? count * sizeof *items : 1);
	if (!items)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u holdings", count);
	enum eco_code code = read_items(&r, items, count, error);
	if (code) {
		free(items);
		return code;
	}
	*holdings = (struct eco_holdings){ items, count };
	return ECO_OK;
}
