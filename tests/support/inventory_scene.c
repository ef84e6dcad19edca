#include "tests/support/inventory_scene.h"

static void inventory_say(void *ctx, const char *text)
{
	struct inventory *in = ctx;
	size_t used = strlen(in->report);
	snprintf(in->report + used, sizeof in->report - used, "%s\n", text);
}

static void inventory_put(struct inventory *in, const struct eco_source *source, const struct eco_position *p)
{
	size_t used = strlen(in->plants), size = sizeof in->plants;
#define INVENTORY_PUT(...) (used += used < size ? (size_t)snprintf(in->plants + used, size - used, \
	__VA_ARGS__) : 0)
	INVENTORY_PUT("%s%s %.9g %.9g", used > 0 ? " / " : "", source->plants[p->plant].name, p->at[0],
		p->at[1]);
	if (p->absolute)
		INVENTORY_PUT(" z%.9g", p->at[2]);
	if (!isnan(p->height_m))
		INVENTORY_PUT(" h%.9g", p->height_m);
	if (!isnan(p->crown_radius_m))
		INVENTORY_PUT(" c%.9g", p->crown_radius_m);
	if (p->scale != 1)
		INVENTORY_PUT(" s%.9g", p->scale);
#undef INVENTORY_PUT
	used = strlen(in->species);
	snprintf(in->species + used, sizeof in->species - used, "%s%s", used > 0 ? " / " : "",
		p->species ? p->species : "-");
}

static enum eco_code inventory_read_rows(struct inventory *in, const struct eco_source *source,
	struct eco_error *error)
{
	struct eco_frame frame = { .crs = source->crs, .vertical = source->vertical,
		.origin = { source->origin[0], source->origin[1], source->origin[2] } };
	struct eco_positions *reader;
	struct eco_position record;
	enum eco_code code = eco_positions_open(&reader, &source->positions[0], &frame, error);
	if (code)
		return code;
	while ((code = eco_positions_next(reader, &record, error)) == ECO_OK && record.plant != ECO_NONE)
		inventory_put(in, source, &record);
	if (!code)
		eco_positions_report(reader, inventory_say, in);
	eco_positions_close(reader);
	return code;
}

const struct inventory *inventory_of(const char *test, const char *scene, const char *file, const char *entry)
{
	static struct inventory in;
	struct eco_error error = { .code = ECO_OK };
	struct eco_source source;
	char json[6000], path[600];
	in = (struct inventory){ .plants = "" };
	snprintf(path, sizeof path, "%s", input_path(test, "scene.json"));
	snprintf(json, sizeof json, "{%s\"plants\":{\"oak\":{\"model\":\"m.obj\"},"
		"\"ash\":{\"model\":\"m.obj\"},\"elm\":{\"variants\":[\"a.obj\","
		"\"b.obj\",\"c.obj\"]}},\"instances\":[{\"from\":\"%s\"%s%s}]}", scene, file,
		*entry != 0 ? "," : "", entry);
	if (eco_source_parse(&source, json, strlen(json), path, false, &error) == ECO_OK) {
		inventory_read_rows(&in, &source, &error);
		eco_source_free(&source);
	}
	snprintf(in.error, sizeof in.error, "%s", error.text);
	return &in;
}
