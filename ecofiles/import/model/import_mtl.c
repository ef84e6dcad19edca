/* MTL: libraries of materials beside OBJ files. One colour, one texture and one opacity are read. Where
 * `d` and `Tr` disagree `d` wins, about which exporters agree more. A senseless line costs only itself: a
 * plant without a shininess is still a plant. */
#include "ecofiles/import/model/import_obj.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/array_grow.h"

#define MTL_BYTES_MAX ((uint64_t)1 << 28)
#define MATERIALS_MAX 65536u

/* its arguments: a number of words, or up to a number of numbers */
struct option { const char *name; int words, numbers; };

static const struct option options[] = { { "-blendu", 1, 0 }, { "-blendv", 1, 0 }, { "-cc", 1, 0 },
	{ "-clamp", 1, 0 },
	{ "-texres", 1, 0 }, { "-imfchan", 1, 0 }, { "-type", 1, 0 }, { "-bm", 1, 0 }, { "-boost", 1, 0 },
	{ "-colorspace", 1, 0 },
	{ "-mm", 2, 0 }, { "-s", 0, 3 }, { "-o", 0, 3 }, { "-t", 0, 3 } };

static char *skip_space(char *at)
{
	while (*at == ' ' || *at == '\t')
		at++;
	return at;
}

static char *skip_word(char *at)
{
	while (*at != 0 && *at != ' ' && *at != '\t')
		at++;
	return at;
}

static const struct option *option_at(const char *at)
{
	for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
		size_t length = strlen(options[i].name);
		if (strncasecmp(at, options[i].name, length) == 0
				&& (at[length] == ' ' || at[length] == '\t'))
			return &options[i];
	}
	return NULL;
}

/* Reads up to three numbers and keeps the first two. */
static char *read_numbers(char *at, int most, double *keep)
{
	for (int i = 0; i < most; i++) {
		char *end;
		double number = strtod(at, &end);
		if (end == at || (*end != 0 && *end != ' ' && *end != '\t') || !(fabs(number) <= 65536))
			break;
		if (keep && i < 2)
			keep[i] = number;
		at = skip_space(end);
	}
	return at;
}

/* The file name behind the options of a map_ statement, which may have spaces. */
static char *map_name(char *at, struct eco_mtl_material *m)
{
	const struct option *o;
	for (at = skip_space(at); (o = option_at(at));) {
		at = skip_space(skip_word(at));
		if (o->numbers > 0)
			at = read_numbers(at, o->numbers, !m ? NULL : strcmp(o->name, "-s") == 0
				? m->uv_scale
				: strcmp(o->name, "-o") == 0 ? m->uv_offset : NULL);
		for (int i = 0; i < o->words; i++)
			at = skip_space(skip_word(at));
	}
	size_t length = strlen(at);
	if (length >= 2 && at[0] == '"' && at[length - 1] == '"') {
		at[length - 1] = 0;
		at++;
	}
	return at;
}

static void set_text(char **to, const char *text)
{
	if (*text == 0)
		return;
	free(*to);
	*to = strdup(text);
}

static void read_color(char *rest, struct eco_mtl_material *m)
{
	double rgb[3];
	int count = 0;
	for (char *word; count < 3 && (word = eco_obj_word(&rest)); count++) {
		char *end;
		rgb[count] = strtod(word, &end);
		if (*end != 0 || !isfinite(rgb[count]))
			return;
	}
	if (count != 1 && count != 3)
		return;
	for (int k = 0; k < 3; k++)
		m->rgb[k] = rgb[count == 1 ? 0 : k];
	m->has_color = true;
}

static void read_share(char *rest, double *to, bool *has)
{
	char *word = eco_obj_word(&rest), *end;
	if (word && strcmp(word, "-halo") == 0)
		word = eco_obj_word(&rest);
	double share = word ? strtod(word, &end) : 0;
	if (!word || *end != 0 || !isfinite(share))
		return;
	*to = share;
	*has = true;
}

static void read_statement(struct eco_mtl_material *m, const char *key, char *rest)
{
	if (strcasecmp(key, "Kd") == 0)
		read_color(rest, m);
	else if (strcmp(key, "d") == 0)
		read_share(rest, &m->d, &m->has_d);
	else if (strcasecmp(key, "Tr") == 0)
		read_share(rest, &m->tr, &m->has_tr);
	else if (strcasecmp(key, "map_Kd") == 0)
		set_text(&m->texture, map_name(rest, m));
	else if (strcasecmp(key, "map_d") == 0 || strcasecmp(key, "map_opacity") == 0)
		set_text(&m->opacity, map_name(rest, NULL));
}

/* Cuts off a statement's key; *rest becomes its arguments. */
static char *split_key(char *line, char **rest)
{
	char *end = skip_word(line);
	*rest = end;
	if (*end != 0) {
		*end = 0;
		*rest = skip_space(end + 1);
	}
	return line;
}

enum eco_code eco_mtl_read(struct eco_mtl *mtl, const char *path, struct eco_error *error)
{
	struct eco_obj_text text = { .path = path };
	struct eco_mtl_material *grown;
	uint8_t *bytes;
	size_t size;
	char *line, *key, *rest;
	bool inside = false;
	if (eco_file_read(path, MTL_BYTES_MAX, &bytes, &size, error) != ECO_OK)
		return error ? error->code : ECO_IO;
	mtl->linear |= memmem(bytes, size < 4096 ? size : 4096, "Blender", 7) != NULL;
	text.at = (char *)bytes + (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
	text.end = (char *)bytes + size;
	while ((line = eco_obj_line(&text, false))) {
		key = split_key(line, &rest);
		if (strcasecmp(key, "newmtl") == 0 && mtl->count < MATERIALS_MAX) {
			grown = realloc(mtl->items, ((size_t)mtl->count + 1) * sizeof *grown);
			if (!grown || !(mtl->items = grown, grown[mtl->count].name = strdup(rest))) {
				free(bytes);
				return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
			}
			grown[mtl->count] = (struct eco_mtl_material){ .name = grown[mtl->count].name,
				.uv_scale = { 1, 1 } };
			mtl->count++;
			inside = true;
		} else if (inside) {
			read_statement(&mtl->items[mtl->count - 1], key, rest);
		}
	}
	free(bytes);
	return ECO_OK;
}

/* The number of a name, in any case if `fold`; ECO_NONE when memory ran out. */
static uint32_t number_name(struct eco_string_pool *names, const char *name, bool fold)
{
	char *text = strdup(name);
	uint32_t number = ECO_NONE;
	for (char *c = text; fold && c && *c != 0; c++)
		*c = (char)tolower((unsigned char)*c);
	if (text && !eco_string_pool_add(names, text, &number))
		number = ECO_NONE;
	free(text);
	return number;
}

/* Finds the names that are not found yet. Each list of names is walked once: both may be long. */
static bool find_names(const struct eco_mtl *mtl, char *const *names, uint32_t count, bool fold,
	const struct eco_mtl_material **found)
{
	struct eco_string_pool known = { 0 };
	uint32_t *last = malloc(((size_t)mtl->count + 1) * sizeof *last);
	bool good = last != NULL;
	for (uint32_t i = 0; i < mtl->count && good; i++) {
		uint32_t number = number_name(&known, mtl->items[i].name, fold);
		good = number != ECO_NONE;
		if (good)
			last[number] = i;
	}
	uint32_t known_count = known.count;
	for (uint32_t i = 0; i < count && good; i++) {
		uint32_t number = !found[i] ? number_name(&known, names[i], fold) : known_count;
		good = number != ECO_NONE;
		if (number < known_count)
			found[i] = &mtl->items[last[number]];
	}
	free(last);
	eco_string_pool_free(&known);
	return good;
}

bool eco_mtl_find(const struct eco_mtl *mtl, char *const *names, uint32_t count,
	const struct eco_mtl_material **found)
{
	memset(found, 0, count * sizeof *found);
	return find_names(mtl, names, count, false, found) && find_names(mtl, names, count, true, found);
}

double eco_mtl_alpha(const struct eco_mtl_material *m)
{
	return m->has_d ? m->d : m->has_tr ? 1 - m->tr : 1;
}

void eco_mtl_free(struct eco_mtl *mtl)
{
	for (uint32_t i = 0; i < mtl->count; i++) {
		free(mtl->items[i].name);
		free(mtl->items[i].texture);
		free(mtl->items[i].opacity);
	}
	free(mtl->items);
	*mtl = (struct eco_mtl){ .count = 0 };
}
