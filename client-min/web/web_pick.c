#include "client-min/web/web_pick.h"

#include <math.h>

void web_say_name(struct eco_writer *text, const char *name)
{
	eco_write_format(text, "\"");
	for (; *name; name++)
		if (*name == '"' || *name == '\\' || (unsigned char)*name < ' ')
			eco_write_format(text, "\\u%04x", (unsigned char)*name);
		else
			eco_write_format(text, "%c", *name);
	eco_write_format(text, "\"");
}

/* The pixel of a plant nearest to (x, y) and within reach, else that one; false beside the picture. */
static bool find_pixel(const struct view_picture *picture, double x, double y, uint32_t at[2])
{
	if (!(x >= 0 && y >= 0 && x < picture->width && y < picture->height))
		return false;
	int column = (int)x, row = (int)y, nearest = WEB_PICK_REACH * WEB_PICK_REACH + 1;
	at[0] = (uint32_t)column;
	at[1] = (uint32_t)row;
	for (int j = row - WEB_PICK_REACH; j <= row + WEB_PICK_REACH; j++)
		for (int i = column - WEB_PICK_REACH; i <= column + WEB_PICK_REACH; i++) {
			int apart = (i - column) * (i - column) + (j - row) * (j - row);
			if (i < 0 || j < 0 || i >= (int)picture->width || j >= (int)picture->height
					|| apart >= nearest
					|| !picture->cover[(size_t)j * picture->width + (size_t)i])
				continue;
			nearest = apart;
			at[0] = (uint32_t)i;
			at[1] = (uint32_t)j;
		}
	return true;
}

/* The place that is seen at a pixel, `depth` being 1 / distance forward of the eye. */
static void place_of(const struct web_pick *pick, const uint32_t at[2], double depth, double world[3])
{
	const struct lod_eye *eye = pick->eye;
	double u = ((at[0] + 0.5) / pick->picture->width * 2 - 1) * eye->tan_x,
		v = (1 - (at[1] + 0.5) / pick->picture->height * 2) * eye->tan_y;
	for (int k = 0; k < 3; k++)
		world[k] = eye->at[k] + (eye->forward[k] + u * eye->right[k] + v * eye->up[k]) / depth;
}

static void say_point(struct eco_writer *text, const char *name, const double p[3])
{
	eco_write_format(text, ",\"%s\":[%.4f,%.4f,%.4f]", name, p[0], p[1], p[2]);
}

static void say_model(const struct web_pick *pick, uint32_t number, struct eco_writer *text)
{
	const struct view_plant *plant = view_store_plant(pick->store, number);
	if (!plant)
		return;
	eco_write_format(text, ",\"number\":%u,\"plant\":", number);
	web_say_name(text, plant->plant.name);
}

static void say_cuts(const struct web_pick *pick, uint32_t instance, struct eco_writer *text)
{
	const struct view_selection *s = pick->selection;
	const char *comma = "";
	eco_write_format(text, ",\"cuts\":[");
	for (uint32_t i = s->cut_first[instance]; i < s->cut_first[instance + 1]; i++) {
		const struct eco_cut *cut = &s->plan_cuts[s->cuts[i]];
		const struct view_list *list = view_store_list(pick->store, cut->list);
		if (!list)
			continue;
		eco_write_format(text, "%s{\"role\":\"%s\",\"list\":%u,\"first\":%u,\"end\":%u,\"of\":%u,"
			"\"vertices\":%llu}", comma, view_role_names[s->roles[s->cuts[i]]], cut->list,
			cut->first, cut->end, list->list.primitive_count,
			(unsigned long long)eco_cut_vertices(cut, &list->list));
		comma = ",";
	}
	eco_write_format(text, "]");
}

static void say_plant(const struct web_pick *pick, const struct view_instance *instance,
	struct eco_writer *text)
{
	const struct view_plant *plant = view_store_plant(pick->store, instance->plant);
	say_model(pick, instance->plant, text);
	if (plant)
		eco_write_format(text, ",\"height_m\":%.3f", plant->plant.height_m * instance->place.scale);
	eco_write_format(text, ",\"scale\":%.4f,\"list\":%u,\"index\":%u", instance->place.scale,
		instance->list, instance->index);
	say_point(text, "foot", instance->place.at);
	say_cuts(pick, (uint32_t)(instance - pick->selection->instances), text);
}

void web_pick_write(const struct web_pick *pick, double x, double y, struct eco_writer *text)
{
	const struct view_picture *picture = pick->picture;
	uint32_t at[2];
	size_t pixel = 0;
	bool inside = find_pixel(picture, x, y, at);
	if (inside)
		pixel = (size_t)at[1] * picture->width + at[0];
	if (!inside || !(picture->depth[pixel] > 0)) {
		eco_write_format(text, "{\"kind\":\"sky\"}");
		return;
	}
	double world[3], apart = 0;
	uint64_t owner = picture->owner[pixel];
	const struct view_instance *instance = owner ? view_owners_find(pick->owners, pick->selection, owner) : NULL;
	place_of(pick, at, (double)picture->depth[pixel], world);
	for (int k = 0; k < 3; k++)
		apart += (world[k] - pick->eye->at[k]) * (world[k] - pick->eye->at[k]);
	eco_write_format(text, "{\"kind\":\"%s\"", !owner ? "ground" : instance ? "plant" : "summary");
	say_point(text, "at", world);
	eco_write_format(text, ",\"distance_m\":%.3f", sqrt(apart));
	if (instance)
		say_plant(pick, instance, text);
	else if (owner)
		say_model(pick, eco_owner_plant(owner), text);
	eco_write_format(text, "}");
}
