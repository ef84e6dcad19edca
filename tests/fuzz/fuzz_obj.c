/* Our own readers of models' text, OBJ and MTL. They read a soup that adds up, and whose
 * references fit; then it is cleaned as any other, with rules that look at all of it. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

#include "ecofiles/import/model/import_obj.h"
#include "ecofiles/import/model/model_clean.h"
#include "ecofiles/import/model/model_import.h"

static void check(const struct eco_model *m)
{
	uint64_t accounted = m->triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m->dropped[i];
	assert(accounted == m->triangles_in);
	for (uint32_t i = 0; i < m->triangle_count; i++)
		assert(m->material[i] < m->material_count && m->part[i] < m->part_count);
	for (uint32_t i = 0; i < m->material_count; i++)
		assert(m->materials[i].image == ECO_NONE || m->materials[i].image < m->image_count);
}

static void read_obj(const char *path)
{
	static const struct eco_part_rule rules[] =
		{ { .kind = ECO_PART_NAME, .name = (char *)"*l?a*", .is = 1 },
		{ .kind = ECO_PART_SIZE, .size = { 0, 0.1 }, .is = ECO_PART_LEFT_OUT },
		{ .kind = ECO_PART_COMPONENT, .component = 2, .is = 0 } };
	const struct eco_model_options options = { .rules = rules, .rule_count = 3 };
	struct eco_notes *notes = calloc(1, sizeof *notes);
	struct eco_model_frame frame = { .base = { 0 } };
	struct eco_model model = { .position = NULL };
	struct eco_error error = { .code = ECO_OK };
	assert(notes != NULL);
	if (eco_obj_read(&model, &frame, path, 100000, notes, &error) == ECO_OK) {
		check(&model);
		if (eco_model_clean(&model, &frame, &options, path, notes, &error) == ECO_OK)
			check(&model);
		assert(error.code == ECO_OK || error.text[0] != 0);
	}
	eco_model_free(&model);
	free(notes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	int memory = memfd_create("fuzz", 0);
	struct eco_mtl mtl = { .count = 0 };
	struct eco_error error = { .code = ECO_OK };
	char path[64];
	assert(memory >= 0 && write(memory, bytes, size) == (ssize_t)size);
	snprintf(path, sizeof path, "/proc/self/fd/%d", memory);
	read_obj(path);
	assert(eco_mtl_read(&mtl, path, &error) == ECO_OK);
	char **names = calloc(mtl.count + 1, sizeof *names);
	const struct eco_mtl_material **found = calloc(mtl.count + 1, sizeof *found);
	assert(names && found);
	for (uint32_t i = 0; i < mtl.count; i++)
		names[i] = mtl.items[i].name;
	eco_mtl_find(&mtl, names, mtl.count, found);
	for (uint32_t i = 0; i < mtl.count; i++)
		assert(found[i] && !strcasecmp(found[i]->name, names[i]));
	free(names);
	free(found);
	eco_mtl_free(&mtl);
	close(memory);
	return 0;
}
