/* The models of a folder, and what is seen of those that are used. */
#include "ecofiles/ecopack/start/start.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/grade.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/import/model/model_parts.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"

#define DEPTH_MAX 4u
#define FILES_MAX 4096u
#define VARIANTS_MAX 8u

/* ---- Files ---- */

/* Formats from the one that says most of a model to the one that says least. */
static const char *const formats[] = { "glb", "gltf", "fbx", "dae", "zae", "obj", "ply", "3ds", "3mf",
	"stl" };
#define FORMATS (sizeof formats / sizeof *formats)

static size_t format_of(const char *path)
{
	const char *dot = strrchr(path, '.');
	for (size_t i = 0; dot && i < FORMATS; i++)
		if (strcasecmp(dot + 1, formats[i]) == 0)
			return i;
	return FORMATS;
}

bool start_is_model(const char *path)
{
	return format_of(path) < FORMATS;
}

/* `name` is that of a model, by which the file is found in a table. */
struct file { char *path, *name; off_t bytes; };
/* Names of the first `above` bytes of all paths, which lead to the folder of models, say nothing. */
struct files { struct file *file; uint32_t count, capacity; size_t above; };

static void add_file(const struct start *s, struct files *files, char *path, off_t bytes)
{
	eco_grow(&files->file, &files->capacity, files->count, sizeof *files->file);
	files->file[files->count++] = (struct file){ .path = path, .bytes = bytes };
	if (files->count > FILES_MAX)
		eco_stop(ECO_TOO_LARGE, "%.300s: more than %u models", s->options->models, FILES_MAX);
}

static void walk(struct start *s, struct files *files, const char *folder, unsigned depth)
{
	DIR *open = opendir(folder);
	if (!open && depth == 0)
		eco_stop(errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.300s, the folder of models: %s%s", folder,
			strerror(errno), eco_advice_read(errno));
	if (!open)
		eco_check(eco_fail_read(s->error, folder, errno));
	for (struct dirent *entry; (entry = readdir(open));) {
		char *path = NULL;
		struct stat file;
		if (entry->d_name[0] == '.')
			continue;
		path = start_text("%s/%s", folder, entry->d_name);
		bool there = stat(path, &file) == 0;
		if (there && S_ISREG(file.st_mode) && format_of(path) < FORMATS) {
			add_file(s, files, path, file.st_size);
			continue;
		}
		if (there && S_ISDIR(file.st_mode) && depth < DEPTH_MAX)
			walk(s, files, path, depth + 1);
		free(path);
	}
	closedir(open);
}

/* ---- Names ---- */

/* Whether a name says no plant: that of a file which lies in a folder of its own, as on sites of models. */
static bool says_nothing(const char *name, size_t bytes)
{
	static const char *const words[] = { "", ".", "..", "scene", "model", "models", "mesh", "meshes", "object",
		"source", "untitled", "geometry", "export", "assets", "public", "static", "files", "3d" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (strlen(words[i]) == bytes && strncasecmp(name, words[i], bytes) == 0)
			return true;
	for (size_t i = 0; i < FORMATS; i++)
		if (strlen(formats[i]) == bytes && strncasecmp(name, formats[i], bytes) == 0)
			return true;
	return false;
}

/* The last folder of a path, after its first `above` bytes, whose name says something; *bytes of it, 0 if
 * there is none. */
static const char *folder_of(const char *path, size_t above, size_t *bytes)
{
	const char *name = eco_path_last(path), *end;
	while (name > path + above) {
		end = --name;            /* the slash after it */
		while (name > path + above && name[-1] != '/')
			name--;
		*bytes = (size_t)(end - name);
		if (!says_nothing(name, *bytes))
			return name;
	}
	*bytes = 0;
	return path;
}

/* The file's name without its ending; where that says nothing, its folder's, and with `both` after it. */
static char *name_of(const char *path, size_t above, bool both)
{
	const char *stem = eco_path_last(path), *dot = strrchr(stem, '.'), *from;
	size_t bytes = dot && dot != stem ? (size_t)(dot - stem) : strlen(stem), more;
	bool nothing = says_nothing(stem, bytes);
	from = folder_of(path, above, &more);
	if (more == 0 || (!nothing && !both))
		return start_text("%.*s", (int)bytes, stem);
	if (nothing)
		return start_text("%.*s", (int)more, from);
	return start_text("%.*s %.*s", (int)more, from, (int)bytes, stem);
}

static int by_name(const void *a, const void *b)
{
	const struct file *p = a, *q = b;
	int order = strcmp(p->name, q->name);
	size_t f = format_of(p->path), g = format_of(q->path);
	return order != 0 ? order : f != g ? (f < g ? -1 : 1) : strcmp(p->path, q->path);
}

static bool differ(const struct file *a, const struct file *b)
{
	return format_of(a->path) == format_of(b->path) && a->bytes != b->bytes;
}

static void name_file(struct file *f, size_t above, bool both)
{
	free(f->name);
	f->name = name_of(f->path, above, both);
}

/* Names all files and sorts them. Different models of one name are named after their folders, too. */
static void name_files(struct files *files)
{
	struct file *f = files->file;
	for (uint32_t i = 0; i < files->count; i++)
		name_file(&f[i], files->above, false);
	qsort(f, files->count, sizeof *f, by_name);
	for (uint32_t first = 0, end; first < files->count; first = end) {
		bool several = false;
		for (end = first + 1; end < files->count && strcmp(f[end].name, f[first].name) == 0; end++)
			several |= differ(&f[end - 1], &f[end]);
		for (uint32_t i = first; several && i < end; i++)
			name_file(&f[i], files->above, true);
	}
	qsort(f, files->count, sizeof *f, by_name);
}

/* ---- Plants ---- */

/* Length of a name without its number: "oak_2", "oak-b2", "oak 02" are an oak. */
static size_t base_bytes(const char *stem, size_t bytes)
{
	size_t end = bytes;
	while (end > 0 && stem[end - 1] >= '0' && stem[end - 1] <= '9')
		end--;
	if (end == bytes || end == 0)
		return bytes;
	while (end > 1 && strchr("_- .", stem[end - 1]))
		end--;
	return end;
}

static void set_words(struct start_model *m, const char *text)
{
	eco_words_of(text, m->words, sizeof m->words);
	m->flora = eco_flora_of(text, NULL);
	m->is_dead = eco_words_have(m->words, "dead") || eco_words_have(m->words, "bare")
		|| eco_words_have(m->words, "snow");
}

static bool name_is_taken(const struct start *s, const char *name)
{
	for (uint32_t i = 0; i < s->model_count; i++)
		if (strcmp(s->models[i].name, name) == 0)
			return true;
	return false;
}

struct start_model *start_model_add(struct start *s, const char *base, size_t bytes)
{
	eco_grow(&s->models, &s->model_capacity, s->model_count, sizeof *s->models);
	struct start_model *m = &s->models[s->model_count];
	*m = (struct start_model){ .height_m = 0 };
	snprintf(m->name, sizeof m->name, "%.*s", (int)(bytes < 56 ? bytes : 56), base);
	for (unsigned n = 2; name_is_taken(s, m->name); n++)
		snprintf(m->name, sizeof m->name, "%.*s %u", (int)(bytes < 56 ? bytes : 56), base, n);
	set_words(m, m->name);
	s->model_count++;
	return m;
}

static void add_model(struct start *s, const char *path, const char *base, size_t bytes)
{
	struct start_model *m = start_model_add(s, base, bytes);
	m->paths = eco_alloc(VARIANTS_MAX, sizeof *m->paths);
	m->paths[0] = start_text("%s", path);
	m->path_count = 1;
}

/* Files of one name in several formats are one; names that differ by a number alone are variants. */
static void group(struct start *s, const struct files *files)
{
	size_t before_base = 0;
	const char *before = "";
	for (uint32_t i = 0; i < files->count; i++) {
		const char *stem = files->file[i].name, *path = files->file[i].path;
		size_t bytes = strlen(stem), base = base_bytes(stem, bytes);
		struct start_model *last = s->model_count > 0 ? &s->models[s->model_count - 1] : NULL;
		if (strcmp(stem, before) == 0) {
			start_say("  %s: left out, as %s is the same "
				"model\n", path, last->paths[0]);
			continue;
		}
		bool alike = last && base < bytes && base == before_base && strncmp(stem, before, base) == 0;
		if (alike && eco_model_spare_level(stem) > 0) {
			start_say("  %s: left out, as %s is a finer level of it\n", path, last->paths[0]);
			continue;
		}
		if (alike && last->path_count < VARIANTS_MAX) {
			last->paths[last->path_count++] = start_text("%s", path);
			snprintf(last->name, sizeof last->name, "%.*s", (int)(base < 56 ? base : 56), stem);
		} else
			add_model(s, path, stem, bytes);
		before = stem;
		before_base = base;
	}
}

/* Bytes of a path before its folder's name; a file's is the one that it lies in. */
static size_t above_of(const char *models)
{
	struct stat status;
	size_t bytes = strlen(models);
	bool is_file = stat(models, &status) == 0 && S_ISREG(status.st_mode);
	for (int names = is_file ? 2 : 1; names > 0; names--) {
		while (bytes > 0 && models[bytes - 1] == '/')
			bytes--;
		while (bytes > 0 && models[bytes - 1] != '/')
			bytes--;
	}
	return bytes;
}

void start_models_find(struct start *s)
{
	struct files files = { .above = above_of(s->options->models) };
	struct stat folder;
	if (stat(s->options->models, &folder) == 0 && S_ISREG(folder.st_mode))
		add_file(s, &files, start_text("%s", s->options->models), folder.st_size);
	else
		walk(s, &files, s->options->models, 0);
	if (files.count == 0)
		eco_stop(ECO_NOT_FOUND, "%.200s: no model in it: " START_FORMATS, s->options->models);
	name_files(&files);
	group(s, &files);
	for (uint32_t i = 0; i < files.count; i++) {
		free(files.file[i].path);
		free(files.file[i].name);
	}
	free(files.file);
	start_say("%s: %u model%s\n", s->options->models, s->model_count, s->model_count == 1 ? "" : "s");
}

/* ---- Sizes ---- */

/* A model whose own height no such plant has gets a usual one; so does a tree of a few units, which are often
 * none of length. Variants of usual heights keep their own. */
static void settle_height(struct start *s, struct start_model *m, const struct eco_model *model)
{
	struct eco_form_size usual = eco_form_size(m->flora.form);
	char took[100], change[64];
	m->height_m = eco_model_height(model);
	bool guessed = model->source.unit_how == ECO_HOW_GUESSED;
	double least_m = guessed ? usual.typical_m / 3 : usual.least_m;
	bool odd = m->height_m < least_m || m->height_m > usual.most_m;
	if (!odd && !guessed)
		return;
	m->height_is_ours = odd || m->path_count == 1;
	double own = m->height_m;
	if (odd)
		m->height_m = usual.typical_m;
	snprintf(took, sizeof took, "%.40s is %.3g m high", m->name, m->height_m);
	snprintf(change, sizeof change, "its \"height_m\" in the scene");
	if (odd)
		start_guess(s, "size of a model", took, change, "its file says %.4g %s, where a %s "
			"has %.3g to "
			"%.3g m", guessed ? own / model->scale : own, guessed ? "without a unit" : "m",
			eco_form_names[m->flora.form], least_m, usual.most_m);
	else
		start_guess(s, "size of a model", took, change, "its file has no unit; metres, centimetres or "
			"millimetres by its height");
}

static void read_model(const struct start *s, struct eco_model *model, char *const *path)
{
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code = eco_model_import(model, &(struct eco_model_options){
		.paths = (const char *const *)path, .path_count = 1 }, &own);
	if (code && s->model_count == 1 && s->models[0].path_count == 1)
		eco_stop(code, "%.400s", own.text);
	if (code)
		eco_stop(code, "%.400s; or move it out of %.60s: another model will stand for its species", own.text,
			s->options->models);
}

/* A model that its format lays down is stood up. Variants that cannot be read are reported now, not when the scene
 * is packed. */
static void see(struct start *s, struct start_model *m, struct eco_model *model)
{
	char took[100];
	struct eco_model_options options = { .paths = (const char *const *)m->paths, .path_count = 1 };
	read_model(s, model, m->paths);
	for (uint32_t i = 1; i < m->path_count; i++) {
		struct eco_model variant = { 0 };
		read_model(s, &variant, &m->paths[i]);
		eco_model_free(&variant);
	}
	if (model->source.up_how == ECO_HOW_CONVENTION) {
		snprintf(took, sizeof took, "in %.40s %s points up", m->name, eco_up_name(model->source.up));
		start_guess(s, "stand of a model", took, "its \"up\" in the scene", "its file does not say "
			"so, its shape hardly tells, and that is usual for %.40s", model->source.format);
		return;
	}
	if (model->source.up_by_shape == ECO_UP_FOUND)
		return;
	m->up = options.up = model->source.up_by_shape;
	snprintf(took, sizeof took, "in %.40s %s points up", m->name, eco_up_name(m->up));
	start_guess(s, "stand of a model", took, "its \"up\" in the scene", "so it stands by its shape; "
		"as its format says, with %s up, it would lie", eco_up_name(model->source.up));
	eco_model_free(model);
	eco_check(eco_model_import(model, &options, s->error));
}

/* A leaf is brighter in no light than others; a model may be. */
static void settle_light(struct start *s, struct start_model *m, const struct eco_model *model)
{
	char took[160];
	uint8_t *organ = grade_organs(model);
	double light = grade_light(model, organ);
	free(organ);
	m->grade = light > GRADE_MOST;
	snprintf(took, sizeof took, "foliage of %.40s sends on %.0f %% of light, and is darkened to %.0f %%", m->name,
		100 * light, 100 * GRADE_TO);
	if (m->grade)
		start_guess(s, "light of a model", took, "its \"grade\" in the scene", "a leaf sends on at most %.0f %%",
			100 * GRADE_MOST);
}

void start_models_see(struct start *s)
{
	for (uint32_t i = 0; i < s->model_count; i++) {
		struct start_model *m = &s->models[i];
		struct eco_model model = { 0 };
		if (m->habit || (m->rows == 0 && i != s->fallback))
			continue;
		main_progress("looking at models", m->name, (double)i / s->model_count);
		see(s, m, &model);
		settle_height(s, m, &model);
		settle_light(s, m, &model);
		eco_model_free(&model);
	}
	main_progress_end();
}
