#include "tests/support/model_try.h"

char import_said[8000];
struct eco_model m;

void import_note(void *ctx, const char *text)
{
	size_t used = strlen(import_said);
	snprintf(import_said + used, sizeof import_said - used, "%s\n", text);
}

void import_file(const char *path, const struct eco_model_options *options)
{
	struct eco_model_options all = options != NULL ? *options
		: (struct eco_model_options){ .height_m = 0 };
	uint64_t accounted;
	if (path) {
		all.paths = &path;
		all.path_count = 1;
	}
	all.warn = import_note;
	eco_model_free(&m);
	import_said[0] = 0;
	assert_good(eco_model_import(&m, &all, &cause));
	accounted = m.triangle_count;
	for (int i = 0; i < ECO_DROP_COUNT; i++)
		accounted += m.dropped[i];
	assert_int_equal(accounted, m.triangles_in);
	for (uint32_t i = 0; i < m.triangle_count * 3; i++)
		assert_true(m.index[i] < m.vertex_count);
	for (uint32_t i = 0; i < m.triangle_count; i++)
		assert_true(m.material[i] < m.material_count && m.part[i] < m.part_count);
}

void import_refuses(const char *path, enum eco_code wanted, const char *says)
{
	struct eco_model model;
	assert_code(eco_model_import(&model, &(struct eco_model_options){ .paths = &path, .path_count = 1 },
		&cause), wanted, says);
	assert_null(model.position);
}

void import_says(const char *text)
{
	if (!strstr(import_said, text))
		fail_msg("said: %s\n  wanted %s", import_said, text);
}

bool close_to(double a, double b, double most)
{
	return fabs(a - b) <= most;
}

const struct eco_material *material_of(const char *name)
{
	for (uint32_t i = 0; i < m.material_count; i++)
		if (strcmp(m.materials[i].name, name) == 0)
			return &m.materials[i];
	fail_msg("no material \"%s\"", name);
	return NULL;
}

void import_high(const char *path, double height_m)
{
	import_file(path, &(struct eco_model_options){ .height_m = height_m });
}

bool has_vertex(double x, double y, double z, const float *uv)
{
	for (uint32_t i = 0; i < m.vertex_count; i++) {
		const float *p = &m.position[i * 3], *q = m.uv ? &m.uv[i * 2] : NULL;
		bool there = close_to(p[0], x, 1e-5) && close_to(p[1], y, 1e-5) && close_to(p[2], z, 1e-5);
		if (there && (!uv || (q && close_to(q[0], uv[0], 1e-5) && close_to(q[1], uv[1], 1e-5))))
			return true;
	}
	return false;
}

bool has_place(double x, double y, double z) { return has_vertex(x, y, z, NULL); }
