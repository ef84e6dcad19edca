/* Parts of textures: the first byte's lowest two bits say whether an outline, colours, or those of the
 * ground, which may have alpha. An outline that is read
 * can be written, and is then read as the same. */
#include <assert.h>
#include <string.h>

#include "ecofiles/format/texture.h"

#define TEXELS_MAX (1u << 14)            /* more only make it slower */

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_texture_part part, again;
	if (!size || eco_texture_texels(bytes + 1, size - 1, !(bytes[0] & 3)) > TEXELS_MAX)
		return 0;
	enum eco_code code = (bytes[0] & 2 ? eco_texture_read_ground : bytes[0] & 1 ? eco_texture_read_colors
		: eco_texture_read_outline)(&part, bytes + 1, size - 1, &error);
	assert(code == error.code && (!code || !part.texels));
	if (code)
		return 0;
	size_t texels = (size_t)part.width * part.height;
	assert(part.width <= ECO_TEXTURE_SIDE_MAX && part.height <= ECO_TEXTURE_SIDE_MAX);
	if (part.channels == 1) {
		struct eco_writer w = { 0 };
		code = eco_texture_write_outline(&w, &part, &error);
		if (!code)
			code = eco_texture_read_outline(&again, w.bytes, w.size, &error);
		assert(!code && memcmp(part.texels, again.texels, texels) == 0);
		eco_texture_part_free(&again);
		eco_writer_free(&w);
	}
	eco_texture_part_free(&part);
	return 0;
}
