#include "server/plants.h"

#include <jansson.h>
#include <string.h>

#include "ecofiles/format/inventory.h"
#include "server/request/query.h"

/* Takes one parameter. NULL, or what it should have been. */
static const char *take(struct srv_plants_query *query, const struct srv_param *param)
{
	if (strcmp(param->name, "first") == 0)
		return srv_parse_count(param->value, &query->first) ? NULL : "a whole number";
	if (strcmp(param->name, "count") == 0)
		return srv_parse_count(param->value, &query->count) && query->count >= 1
			&& query->count <= SRV_PLANTS_MAX ? NULL : "a whole number from 1 to 1024";
	query->has_pack = true;
	return srv_parse_id(param->value, &query->pack) ? NULL : "an id of 32 lower-case hex digits";
}

enum eco_code srv_plants_query(struct srv_plants_query *query, const struct srv_target *target,
	struct eco_error *error)
{
	*query = (struct srv_plants_query){ .count = SRV_PLANTS_MAX };
	for (uint32_t i = 0; i < target->param_count; i++) {
		const struct srv_param *param = &target->params[i];
		if (strcmp(param->name, "first") != 0 && strcmp(param->name, "count") != 0
				&& strcmp(param->name, "pack") != 0)
			return eco_fail(error, ECO_BAD_INPUT, "unknown parameter '%.40s'; known are first, count "
				"and pack", param->name);
		const char *wanted = take(query, param);
		if (wanted)
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%s': '%.80s' is not %s", param->name,
				param->value, wanted);
	}
	return ECO_OK;
}

uint32_t srv_plants_list(const struct srv_scene *scene, const char *text)
{
	const struct eco_scene *tables = &scene->pack->scene;
	uint64_t list;
	return srv_parse_count(text, &list) && list < tables->list_count &&
			tables->lists[list].kind == ECO_LIST_INSTANCES
		? (uint32_t)list
		: ECO_NONE;
}

static void describe_plant(struct srv_json *json, const struct eco_plant *plant,
	const struct eco_inventory_row *row)
{
	srv_json_open(json, '{');
	srv_json_key_text(json, "species", eco_inventory_species(row, plant->name));
	srv_json_key_text(json, "plant", plant->name);
	if (row->file) {
		srv_json_key_text(json, "file", row->file);
		srv_json_key_count(json, "row", row->row);
		if (row->line)
			srv_json_key_count(json, "line", row->line);
	}
	srv_json_close(json, '}');
}

/* Plants [first, end) of the list whose groups begin at `group`. */
static enum eco_code describe_all(struct srv_json *json, const struct eco_pack *pack,
	const struct eco_group *group, uint32_t first, uint32_t end, struct eco_error *error)
{
	struct eco_inventory_block block = { 0 };
	enum eco_code code = ECO_OK;
	for (uint32_t i = first; i < end && !code; i++) {
		while (i >= group->first + group->count)
			group++;
		uint64_t place = group->place_first + (i - group->first);
		const struct eco_inventory_row *row;
		code = eco_inventory_at(&block, pack, place, &row, error);
		if (!code)
			describe_plant(json, &pack->scene.plants[group->plant], row);
	}
	eco_inventory_free(&block);
	return code;
}

enum eco_code srv_describe_plants(struct srv_json *json, const struct srv_scene *scene, uint32_t list,
	const struct srv_plants_query *query, struct eco_error *error)
{
	const struct eco_pack *pack = scene->pack;
	uint32_t all = pack->scene.lists[list].primitive_count;
	char id[SRV_ID_TEXT_BYTES];
	if (query->first >= all)
		return eco_fail(error, ECO_BAD_INPUT,
			"parameter 'first': list %u has %u plants, the first is 0", list, all);
	uint32_t first = (uint32_t)query->first,
		 end = all - first < query->count ? all : first + (uint32_t)query->count;
	srv_format_id(id, &pack->id);
	srv_json_open(json, '{');
	srv_json_key_text(json, "pack", id);
	srv_json_key_count(json, "list", list);
	srv_json_key_count(json, "first", first);
	srv_json_key_count(json, "of", all);
	srv_json_key_open(json, "plants", '[');
	enum eco_code code = describe_all(json, pack, eco_list_groups(&pack->scene, list), first, end, error);
	srv_json_close(json, ']');
	srv_json_close(json, '}');
	return code;
}

/* ---- Species of the whole scene ---- */

static void describe_one(struct srv_json *json, const char *species, const json_t *plants)
{
	srv_json_open(json, '{');
	srv_json_key_text(json, "species", species);
	if (json_integer_value(plants) > 0)
		srv_json_key_count(json, "plants", (uint64_t)json_integer_value(plants));
	srv_json_close(json, '}');
}

/* said: {"of": number of species, "most": [[name or null, plants], ...]}; NULL: nothing. Where it names
 * more than it counts, there are as many as it names. */
static void describe_stood_for(struct srv_json *json, const char *plant, const json_t *said)
{
	const json_t *most = json_object_get(said, "most"), *one;
	json_int_t of = json_integer_value(json_object_get(said, "of"));
	size_t named = json_array_size(most), i;
	srv_json_open(json, '{');
	srv_json_key_text(json, "plant", plant);
	srv_json_key_count(json, "species_count", of > (json_int_t)named ? (uint64_t)of : named ? named : 1);
	srv_json_key_open(json, "species", '[');
	if (!named)
		describe_one(json, plant, NULL);
	json_array_foreach(most, i, one)
		describe_one(json, json_string_value(json_array_get(one, 0)), json_array_get(one, 1));
	srv_json_close(json, ']');
	srv_json_close(json, '}');
}

void srv_describe_species(struct srv_json *json, const struct srv_scene *scene)
{
	const struct eco_pack *pack = scene->pack;
	const json_t *species = json_object_get(scene->meta, "species");
	char id[SRV_ID_TEXT_BYTES];
	srv_format_id(id, &pack->id);
	srv_json_open(json, '{');
	srv_json_key_text(json, "pack", id);
	srv_json_key_open(json, "plants", '[');
	for (uint32_t i = 0; i < pack->scene.plant_count; i++)
		describe_stood_for(json, pack->scene.plants[i].name, json_array_get(species, i));
	srv_json_close(json, ']');
	srv_json_close(json, '}');
}
