/* Libraries of materials of Wavefront OBJ: one colour, one texture and one opacity each; and lines of both
 * files. */
#include "ecofiles/import/model/import_obj.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/memory.h"

#define MTL_BYTES_MAX ((uint64_t)1 << 28)
#define MATERIALS_MAX 65536u
#define SPACES " \t"

/* ---- Lines and words ---- */

void eco_obj_text_start(struct eco_obj_text *text, uint8_t *bytes, size_t size)
{
	text->at = (char *)bytes + (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
	text->end = (char *)bytes + size;
	text->blender = memmem(bytes, size < 4096 ? size : 4096, "Blender", 7) != NULL;
}

char *eco_obj_line(struct eco_obj_text *t, bool joins)
{
	char *start = t->at, *end;
	if (start >= t->end)
		return NULL;
	t->line++;
	for (end = start; end < t->end && *end != '\n' && *end != '\r'; end++)
		if (joins && *end == '\\' && (end[1] == '\n' || (end[1] == '\r' && end[2] == '\n'))) {
			memset(end, ' ', end[1] == '\r' ? 3 : 2);
			t->line++;
		}
	t->at = end + (end < t->end ? *end == '\r' && end[1] == '\n' ? 2 : 1 : 0);
	while (end > start && (end[-1] == ' ' || end[-1] == '\t'))
		end--;
	*end = 0;
	return start + strspn(start, SPACES);
}

char *eco_obj_word(char **line)
{
	char *word = *line + strspn(*line, SPACES), *end = word + strcspn(word, SPACES);
	if (*word == 0 || *word == '#')
		return NULL;
	*line = end + (*end != 0);
	*end = 0;
	return word;
}

char *eco_obj_arguments(char *line)
{
	char *rest = line + strcspn(line, SPACES);
	if (*rest != 0)
		*rest++ = 0;
	return rest + strspn(rest, SPACES);
}

/* ---- Statements ---- */

/* its arguments: a number of words, or up to a number of numbers */
struct option { const char *name; int words, numbers; };

static const struct option options[] = { { "-blendu", 1, 0 }, { "-blendv", 1, 0 }, { "-cc", 1, 0 },
	{ "-clamp", 1, 0 },
	{ "-texres", 1, 0 }, { "-imfchan", 1, 0 }, { "-type", 1, 0 }, { "-bm", 1, 0 }, { "-boost", 1, 0 },
	{ "-colorspace", 1, 0 },
	{ "-mm", 2, 0 }, { "-s", 0, 3 }, { "-o", 0, 3 }, { "-t", 0, 3 } };

static char *skip_space(char *at) { return at + strspn(at, SPACES); }

static char *skip_word(char *at) { return skip_space(at + strcspn(at, SPACES)); }

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
		at = skip_word(at);
		if (o->numbers > 0)
			at = read_numbers(at, o->numbers, !m ? NULL : strcmp(o->name, "-s") == 0
				? m->uv_scale
				: strcmp(o->name, "-o") == 0 ? m->uv_offset : NULL);
		for (int i = 0; i < o->words; i++)
			at = skip_word(at);
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
	*to = eco_copy_text(text);
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

/* d, opaque at 1, or Tr, opaque at 0. */
static void read_alpha(char *rest, struct eco_mtl_material *m, bool is_d)
{
	char *word = eco_obj_word(&rest), *end;
	if (word && strcmp(word, "-halo") == 0)
		word = eco_obj_word(&rest);
	double share = word ? strtod(word, &end) : 0;
	if (!word || *end != 0 || !isfinite(share) || (m->has_d && !is_d))
		return;
	m->alpha = is_d ? share : 1 - share;
	m->has_d |= is_d;
}

static void read_statement(struct eco_mtl_material *m, const char *key, char *rest)
{
	if (strcasecmp(key, "Kd") == 0)
		read_color(rest, m);
	else if (strcmp(key, "d") == 0 || strcasecmp(key, "Tr") == 0)
		read_alpha(rest, m, *key == 'd');
	else if (strcasecmp(key, "map_Kd") == 0)
		set_text(&m->texture, map_name(rest, m));
	else if (strcasecmp(key, "map_d") == 0 || strcasecmp(key, "map_opacity") == 0)
		set_text(&m->opacity, map_name(rest, NULL));
}

enum eco_code eco_mtl_read(struct eco_mtl *mtl, const char *path, struct eco_error *error)
{
	struct eco_obj_text text = { .path = path };
	uint8_t *bytes;
	size_t size;
	bool inside = false;
	ECO_PASS(eco_file_read(path, MTL_BYTES_MAX, &bytes, &size, error));
	eco_obj_text_start(&text, bytes, size);
	mtl->linear |= text.blender;
	for (char *line; (line = eco_obj_line(&text, false));) {
		char *rest = eco_obj_arguments(line);
		if (strcasecmp(line, "newmtl") == 0 && mtl->count < MATERIALS_MAX) {
			mtl->items = eco_realloc(mtl->items, (size_t)mtl->count + 1, sizeof *mtl->items);
			mtl->items[mtl->count++] = (struct eco_mtl_material){ .name = eco_copy_text(rest),
				.alpha = 1,
				.uv_scale = { 1, 1 } };
			inside = true;
		} else if (inside) {
			read_statement(&mtl->items[mtl->count - 1], line, rest);
		}
	}
	free(bytes);
	return ECO_OK;
}

/* The number of a name, in any case if `fold`. */
static uint32_t number_folded(struct eco_string_pool *names, const char *name, bool fold)
{
	char *text = eco_copy_text(name);
	for (char *c = text; fold && *c != 0; c++)
		*c = (char)tolower((unsigned char)*c);
	uint32_t number = eco_string_number(names, text);
	free(text);
	return number;
}

/* Finds the names that are not found yet. Each list of names is walked once: both may be long. */
static void find_names(const struct eco_mtl *mtl, char *const *names, uint32_t count, bool fold,
	const struct eco_mtl_material **found)
{
	struct eco_string_pool known = { 0 };
	uint32_t *last = eco_alloc((size_t)mtl->count + 1, sizeof *last);
	for (uint32_t i = 0; i < mtl->count; i++)
		last[number_folded(&known, mtl->items[i].name, fold)] = i;
	uint32_t known_count = known.count;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t number = !found[i] ? number_folded(&known, names[i], fold) : known_count;
		if (number < known_count)
			found[i] = &mtl->items[last[number]];
	}
	free(last);
	eco_string_pool_free(&known);
}

void eco_mtl_find(const struct eco_mtl *mtl, char *const *names, uint32_t count,
	const struct eco_mtl_material **found)
{
	memset(found, 0, count * sizeof *found);
	find_names(mtl, names, count, false, found);
	find_names(mtl, names, count, true, found);
}

void eco_mtl_free(struct eco_mtl *mtl)
{
	for (uint32_t i = 0; i < mtl->count; i++) {
		eco_free(mtl->items[i].name, mtl->items[i].texture, mtl->items[i].opacity);
	}
	free(mtl->items);
	*mtl = (struct eco_mtl){ .count = 0 };
}
