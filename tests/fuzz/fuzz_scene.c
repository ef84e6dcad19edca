/* SCENE.json from memory: whatever the text, a source or an error with a place, never a crash, nothing left
 * behind. */
#include <assert.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "ecofiles/scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_source source;
	enum eco_code code = eco_source_parse(&source, (const char *)data, size, "folder/scene.json", false, &error);
	if (code != ECO_OK) {
		assert(code == error.code && strncmp(error.text, "folder/scene.json", 17) == 0
			&& !source.path);
		return 0;
	}
	for (uint32_t i = 0; i < source.instance_count; i++)
		assert(source.instances[i].plant < source.plant_count && source.instances[i].scale > 0);
	for (uint32_t i = 0; i < source.positions_count; i++)
		assert((!source.positions[i].x) == (!source.positions[i].y) && source.positions[i].path);
	eco_source_free(&source);
	return 0;
}
