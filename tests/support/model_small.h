/* Small models for tests, in the folder TEST_FOLDER below build/tmp. */
#ifndef TESTS_MODEL_SMALL_H
#define TESTS_MODEL_SMALL_H

#include "ecofiles/import/model/model_import.h"
#include "tests/support/model_try.h"

#ifndef TEST_FOLDER
#define TEST_FOLDER "model"
#endif

static inline void import_high(struct eco_model *model, const char *path, double height_m)
{
	import_file(model, path, &(struct eco_model_options){ .height_m = height_m });
}

/* Whether a vertex at that place, with that uv where uv is asked for, is there. */
static inline bool has_vertex(const struct eco_model *m, float x, float y, float z, const float *uv)
{
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		const float *p = &m->position[i * 3];
		if (fabsf(p[0] - x) + fabsf(p[1] - y) + fabsf(p[2] - z) < 1e-5f
			&& (!uv || (m->uv != NULL && fabsf(m->uv[i * 2] - uv[0])
			+ fabsf(m->uv[i * 2 + 1] - uv[1]) < 1e-5f)))
			return true;
	}
	return false;
}

/* Positions (0,0,0) (1,0,0) (0,1,0), uv (0,0) (1,0) (0,1), indices 0 1 2, as base64: 36 + 24 + 6 bytes. */
#define BUFFER "{'byteLength':66,'uri':'data:application/octet-stream;base64," \
	"AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" \
	"AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAABAAIA'}"
#define VIEWS "'bufferViews':[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36," \
	"'byteLength':24},{'buffer':0,'byteOffset':60," \
	"'byteLength':6}],'accessors':[{'bufferView':0,'componentType':5126,'count':3," \
	"'type':'VEC3','min':[0,0,0],'max':[1,1,0]}," \
	"{'bufferView':1,'componentType':5126,'count':3,'type':'VEC2'},{'bufferView':2," \
	"'componentType':5123,'count':3,'type':'SCALAR'}]"
#define MESH "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':1}," \
	"'indices':2,'material':0}]}]"

static inline const char *gltf(const char *name, const char *nodes, const char *rest)
{
	static char text[6000];
	snprintf(text, sizeof text, "{'asset':{'version':'2.0'},'scene':0,"
		"'scenes':[{'nodes':[0]}],'buffers':[" BUFFER "]," VIEWS ","
		MESH ",'nodes':[%s]%s}", nodes, rest);
	return input_json(TEST_FOLDER, name, text);
}

#endif
