/* The files: each is written beside its name, and all get their names when all are there. */
#include "ecofiles/ecopack/start/start.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/progress.h"

#define MAP_PIXELS 1200u

enum { SCENE, MAP, CAMERA, FILES };
static const char *const names[FILES] = { "scene.json", "map.png", "camera.json" };

struct writing {
	struct start *start;
	char *beside[FILES], *path[FILES];
	struct map map;
};

/* ---- Paths ---- */

char *start_path(const struct start *s, const char *path)
{
	char *from = realpath(s->options->folder, NULL), *to = realpath(path, NULL), *seen = NULL;
	size_t same = 0, ups = 0;
	if (from && to) {
		for (size_t i = 0; from[i] == to[i] && to[i] != 0; i++)
			if (to[i] == '/')
				same = i + 1;
		size_t length = strlen(from);
		if (strncmp(from, to, length) == 0 && to[length] == '/')
			same = length + 1;       /* it lies within the folder */
		for (size_t i = same; i < length; i++)
			ups += from[i] == '/';
		ups += same < length;
		seen = malloc(3 * ups + strlen(to + same) + 1);
	}
	if (seen) {
		for (size_t i = 0; i < ups; i++)
			memcpy(seen + 3 * i, "../", 3);
		strcpy(seen + 3 * ups, to + same);
	}
	free(from);
	free(to);
	return seen;
}

static enum eco_code name_files(struct writing *w)
{
	const char *folder = w->start->options->folder;
	for (int i = 0; i < FILES; i++)
		if (asprintf(&w->path[i], "%s/%s", folder, names[i]) < 0 ||
			asprintf(&w->beside[i], "%s/%s.start-%ld", folder, names[i], (long)getpid()) < 0)
			return eco_fail(w->start->error, ECO_NO_MEMORY, "out of memory");
	return ECO_OK;
}

/* ---- Content ---- */

static enum eco_code write_camera(struct writing *w)
{
	char *text = NULL;
	enum eco_code code = start_camera(&w->map, &text, w->start->error);
	if (!code)
		code = eco_file_write(w->beside[CAMERA], text, strlen(text), w->start->error);
	free(text);
	return code;
}

/* The scene is read back as make reads it: what is wrong with it shows now. */
static enum eco_code write_all(struct writing *w)
{
	struct start *s = w->start;
	w->map.error = s->error;
	enum eco_code code = eco_file_write(w->beside[SCENE], s->scene, strlen(s->scene), s->error);
	if (!code)
		code = map_gather(&w->map, w->beside[SCENE]);
	if (!code && w->map.total == 0)
		code = eco_fail(s->error, ECO_BAD_INPUT, "%.200s: no row became a plant", s->options->table);
	if (!code)
		code = write_camera(w);
	return code ? code : map_write(&w->map, w->beside[MAP], MAP_PIXELS);
}

static enum eco_code give_names(struct writing *w)
{
	for (int i = 0; i < FILES; i++)
		if (rename(w->beside[i], w->path[i]) != 0)
			return eco_fail_write(w->start->error, w->path[i], errno);
	return ECO_OK;
}

enum eco_code start_write(struct start *s)
{
	struct writing w = { .start = s };
	enum eco_code code = name_files(&w);
	if (!code)
		code = write_all(&w);
	if (!code)
		code = give_names(&w);
	if (!code && w.map.off_ground > 0)
		main_note("%s: %llu of %llu plants stand beyond its border", s->dem.path,
			(unsigned long long)w.map.off_ground, (unsigned long long)w.map.total);
	for (int i = 0; i < FILES; i++) {
		if (w.beside[i])
			unlink(w.beside[i]);
		free(w.beside[i]);
		free(w.path[i]);
	}
	map_free(&w.map);
	return code;
}
