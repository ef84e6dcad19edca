#include "tests/support/model_try.h"

#include "tests/support/cases.h"

struct eco_model m;

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

/* Whether a vertex at that place, with that uv where uv is asked for, is there. */
static bool has_vertex(double x, double y, double z, const float *uv)
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

/* ---- Expectations as text ---- */

/* The value of `key`, for triangle `t` where that matters, as text. Texels: as many as `wanted` has numbers. */
void model_told(const char *key, uint32_t t, const char *wanted, char *to, size_t size)
{
	static const char *const hows[] = { "unknown", "given", "format", "shape", "convention", "guessed", "height" };
	const uint32_t *dropped = m.dropped;
	const struct { const char *key; double values[3]; int count; } numbers[] = {
		{ "triangles", { m.triangle_count }, 1 }, { "in", { m.triangles_in }, 1 },
		{ "vertices", { m.vertex_count }, 1 }, { "materials", { m.material_count }, 1 },
		{ "images", { m.image_count }, 1 }, { "parts", { m.part_count }, 1 },
		{ "bad", { dropped[ECO_DROP_BAD_INDEX] }, 1 }, { "infinite", { dropped[ECO_DROP_NOT_FINITE] }, 1 },
		{ "degenerate", { dropped[ECO_DROP_DEGENERATE] }, 1 }, { "twice", { dropped[ECO_DROP_DUPLICATE] }, 1 },
		{ "clear", { dropped[ECO_DROP_TRANSPARENT] }, 1 }, { "out", { dropped[ECO_DROP_LEFT_OUT] }, 1 },
		{ "high", { eco_model_height(&m) }, 1 }, { "scale", { m.scale }, 1 }, { "below", { m.source.below }, 1 },
		{ "foot", { m.foot[0], m.foot[1], m.foot[2] }, 3 },
		{ "size", { m.source.size[0], m.source.size[1], m.source.size[2] }, 3 } };
	const struct eco_material *own = t < m.triangle_count ? &m.materials[m.material[t]] : NULL;
	const struct { const char *key, *text; } texts[] = { { "up", eco_up_name(m.source.up) },
		{ "up_how", hows[m.source.up_how] }, { "unit_how", hows[m.source.unit_how] },
		{ "material", own ? own->name : "" }, { "part", own ? m.parts[m.part[t]].name : "" } };
	const uint8_t *bytes = own ? own->rgb : NULL;
	size_t used = 0, count = strcmp(key, "rgb") == 0 ? 3 : 0;
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		for (int k = 0; k < numbers[i].count && strcmp(key, numbers[i].key) == 0; k++)
			used += (size_t)snprintf(to + used, size - used, k ? ",%.10g" : "%.10g", numbers[i].values[k]);
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		if (strcmp(key, texts[i].key) == 0)
			used += (size_t)snprintf(to + used, size - used, "%s", texts[i].text);
	if (strcmp(key, "cut") == 0 || strcmp(key, "grey") == 0)
		used += (size_t)snprintf(to, size, "%d", own && (*key == 'c' ? own->cutout : own->colourless));
	if (strcmp(key, "image") == 0)
		used += (size_t)snprintf(to, size, "%d", own && own->image != ECO_NONE ? (int)own->image : -1);
	if (strcmp(key, "texels") == 0 && own && own->image < m.image_count) {
		bytes = m.images[own->image].rgba;
		for (count = 1; (wanted = strchr(wanted, ',')); wanted++)
			count++;
	}
	for (size_t i = 0; i < count && bytes; i++)
		used += (size_t)snprintf(to + used, size - used, i ? ",%u" : "%u", bytes[i]);
	double at[5];
	int found = strcmp(key, "at") ? 0 : sscanf(wanted, "%lf,%lf,%lf,%lf,%lf", &at[0], &at[1], &at[2], &at[3], &at[4]);
	if (found >= 3 && has_vertex(at[0], at[1], at[2], found == 5 ? (float[]){ (float)at[3], (float)at[4] } : NULL))
		used += (size_t)snprintf(to, size, "%s", wanted);
	to[used] = 0;
}

struct model_case { const char *name, *file, *text, *beside, *beside_text, *options, *wanted; };

/* "up=z unit_m=0.5 height_m=2", of which each may be missing. */
static struct eco_model_options options_of(const char *text)
{
	static const char *const ups[] = { "any", "y", "z", "x", NULL };
	struct eco_model_options options = { .height_m = 0 };
	char up[8] = "any";
	const char *unit = text ? strstr(text, "unit_m=") : NULL, *height = text ? strstr(text, "height_m=") : NULL;
	if (text)
		sscanf(text, "up=%7s", up);
	options.up = (enum eco_up)cases_choice(up, ups);
	options.unit_m = unit ? strtod(unit + 7, NULL) : 0;
	options.height_m = height ? strtod(height + 9, NULL) : 0;
	return options;
}

void expect_models(const char *folder, const char *table)
{
	const char *name = "";
	char json[4000];
	uint32_t count;
	const struct model_case *cases = cases_read(table, sizeof *cases, &count);
	for (const struct model_case *c = cases; c < cases + count; c++) {
		const struct eco_model_options options = options_of(c->options);
		name = c->name ? c->name : name;
		print_message("# %s, %s\n", name, c->file);
		if (c->beside)
			input_text(folder, c->beside, c->beside_text);
		if (c->text && *c->text == '{')
			input_json(folder, c->file, strcpy(json, c->text));
		else if (c->text)
			input_text(folder, c->file, c->text);
		import_file(input_path(folder, c->file), &options);
		expect_told(c->wanted, model_told);
		if (c->beside)
			unlink(input_path(folder, c->beside));
	}
}
