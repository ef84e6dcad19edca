/* Skins at rest: joints place a skinned mesh. The specification says to ignore its node's own place, which
 * is wrong by a factor of a hundred in files whose skeletons carry the scale or the axis. */
#include "ecofiles/import/model/import_gltf.h"

#include <stdlib.h>
#include <string.h>

static enum eco_code read_inverse(struct eco_gltf *doc, const json_t *json, struct eco_gltf_accessor *inverse,
	struct eco_error *error)
{
	*inverse = (struct eco_gltf_accessor){ .bytes = NULL };
	if (!json_object_get(json, "inverseBindMatrices"))
		return ECO_OK;
	return eco_gltf_accessor_open(doc, eco_gltf_index(json, "inverseBindMatrices"), 16, inverse, error);
}

enum eco_code gltf_skin_read(struct gltf_skin *skin, struct eco_gltf *doc, uint32_t index,
	struct eco_error *error)
{
	const json_t *json = eco_gltf_item(doc, "skins", index), *joints = json_object_get(json, "joints");
	size_t count = json_array_size(joints);
	struct eco_gltf_accessor inverse;
	if (!json)
		return eco_fail(error, ECO_DAMAGED, "%.300s: names skin %u, which is not there",
			eco_gltf_path(doc), index);
	enum eco_code code = read_inverse(doc, json, &inverse, error);
	if (code)
		return code;
	skin->matrix = count < ECO_NONE ? malloc((count + 1) * 16 * sizeof *skin->matrix) : NULL;
	if (!skin->matrix)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory for skin %u", eco_gltf_path(doc),
			index);
	skin->count = (uint32_t)count;
	for (size_t i = 0; i < count && code == ECO_OK; i++) {
		json_int_t node = json_is_integer(json_array_get(joints, i))
			? json_integer_value(json_array_get(joints, i)) : -1;
		double *matrix = &skin->matrix[i * 16], bind[16];
		code = eco_gltf_node_matrix(doc, node >= 0 && node < ECO_NONE ? (uint32_t)node : ECO_NONE,
			matrix, error);
		if (code == ECO_OK && i < inverse.count) {
			eco_gltf_element(&inverse, i, bind);
			eco_gltf_multiply(matrix, matrix, bind);
		}
	}
	eco_gltf_accessor_close(&inverse);
	return code;
}

bool gltf_skin_place(const struct gltf_skin *skin, const struct gltf_surface *s, uint32_t v, double out[3])
{
	const double from[3] = { (double)s->position[(size_t)v * 3], (double)s->position[(size_t)v * 3 + 1],
		(double)s->position[(size_t)v * 3 + 2] };
	double sum = 0, to[3] = { 0, 0, 0 };
	for (uint32_t i = 0; i < s->influences; i++) {
		uint32_t joint = s->joint[(size_t)v * s->influences + i];
		double weight = (double)s->weight[(size_t)v * s->influences + i], place[3];
		if (!(weight > 0) || joint >= skin->count)
			continue;
		eco_gltf_apply(&skin->matrix[(size_t)joint * 16], from, place);
		for (int k = 0; k < 3; k++)
			to[k] += weight * place[k];
		sum += weight;
	}
	for (int k = 0; k < 3; k++)
		out[k] = sum > 0 ? to[k] / sum : 0;
	return sum > 0;
}
