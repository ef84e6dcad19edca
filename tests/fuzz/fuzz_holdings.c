/* Holdings that a stranger posts. If they are accepted they are sorted, and have exactly these bytes. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_holdings holdings;
	struct eco_error error = { 0 };
	enum eco_code code = eco_wire_read_holdings(bytes, size, &holdings, &error);
	assert(code == error.code);
	if (code) {
		assert(error.text[0] && !holdings.items && !holdings.count);
		return 0;
	}
	struct eco_writer w = { 0 };
	eco_wire_write_holdings(&w, &holdings);
	assert(!w.failed && w.size == size && memcmp(w.bytes, bytes, size) == 0);
	for (uint32_t i = 0; i < holdings.count; i++) {
		assert(i == 0 || holdings.items[i].list > holdings.items[i - 1].list);
		assert(holdings.items[i].chunks > 0 && eco_holdings_chunks(&holdings, holdings.items[i].list)
			== holdings.items[i].chunks);
	}
	eco_writer_free(&w);
	free(holdings.items);
	return 0;
}
