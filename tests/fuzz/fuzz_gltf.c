/* A glTF file from memory: the document, all its accessors and nodes, and the model in its scene, without
 * pictures. Whatever the bytes, a status or sound results, never a crash, nothing left behind. */
#include <assert.h>
#include <stdint.h>
#include <stdlib.h>

#include "ecofiles/import/model/gltf.h"
#include "ecofiles/import/model/import_model.h"

#define TRIANGLES_MAX 10000u
#define VALUES_MAX 100000u           /* of accessors without bytes, which may have any number of zeros */

static void read_accessors(struct eco_gltf *doc)
{
	size_t count = json_array_size(json_object_get(eco_gltf_json(doc), "accessors"));
	for (size_t i = 0; i < count && i < 64; i++) {
		struct eco_gltf_accessor a;
		double values[16];
		if (eco_gltf_accessor_open(doc, (uint32_t)i, 0, &a, NULL) != ECO_OK)
			continue;
		for (uint64_t k = 0; k < a.count && k < VALUES_MAX; k++) {
			eco_gltf_element(&a, k, values);
			eco_gltf_element_index(&a, k);
		}
		eco_gltf_accessor_close(&a);
	}
}

static void read_nodes(struct eco_gltf *doc)
{
	size_t count = json_array_size(json_object_get(eco_gltf_json(doc), "nodes"));
	double matrix[16];
	for (size_t i = 0; i < count && i < 64; i++)
		eco_gltf_node_matrix(doc, (uint32_t)i, matrix, NULL);
}

static void read_model(struct eco_gltf *doc)
{
	struct eco_model model = { .position = NULL };
	struct eco_model_frame frame = { .unit_m = 0 };
	struct eco_notes notes = { .used = 0 };
	if (eco_gltf_read_document(&model, &frame, doc, TRIANGLES_MAX, &notes, NULL) == ECO_OK) {
		assert(model.triangle_count <= TRIANGLES_MAX && model.vertex_count <= 3 * TRIANGLES_MAX);
		for (uint32_t i = 0; i < model.triangle_count; i++) {
			assert(model.material[i] < model.material_count && model.part[i] < model.part_count);
			for (uint32_t c = 0; c < 3; c++)
				assert(model.index[i * 3 + c] < model.vertex_count
					|| model.index[i * 3 + c] == ECO_NONE);
		}
	}
	eco_model_free(&model);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct eco_gltf *doc;
	setenv("ECO_IMAGE_MODULE", "none", 1);
	if (eco_gltf_open_memory(&doc, "build/tmp/fuzz/x.glb", data, size, NULL) != ECO_OK) {
		assert(!doc);
		return 0;
	}
	read_accessors(doc);
	read_nodes(doc);
	read_model(doc);
	eco_gltf_close(doc);
	return 0;
}
