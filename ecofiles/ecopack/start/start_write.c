/* The files: each is written beside its name, and all get their names when all are there. */
#include "ecofiles/ecopack/start/start.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/run.h"

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
	char *from = realpath(s->options->folder, NULL), *to = realpath(path, NULL);
	size_t same = 0, ups = 0;
	if (!from || !to)
		eco_end("a folder of the scene has gone");
	for (size_t i = 0; from[i] == to[i] && to[i] != 0; i++)
		if (to[i] == '/')
			same = i + 1;
	size_t length = strlen(from);
	if (strncmp(from, to, length) == 0 && to[length] == '/')
		same = length + 1;               /* it lies within the folder */
	for (size_t i = same; i < length; i++)
		ups += from[i] == '/';
	ups += same < length;
	char *seen = eco_alloc(3 * ups + strlen(to + same) + 1, 1);
	for (size_t i = 0; i < ups; i++)
		strcat(seen, "../");
	strcat(seen, to + same);
	free(from);
	free(to);
	return seen;
}

static void name_files(struct writing *w)
{
	const char *folder = w->start->options->folder;
	for (int i = 0; i < FILES; i++) {
		w->path[i] = start_text("%s/%s", folder, names[i]);
		w->beside[i] = start_text("%s/%s.start-%ld", folder, names[i], (long)getpid());
	}
}

static void remove_unfinished(void *writing)
{
	struct writing *w = writing;
	for (int i = 0; i < FILES; i++)
		unlink(w->beside[i]);
}

/* ---- The camera ---- */

/* The first look: from the south and a little above, at where many plants stand, near enough that a plant is
 * more than a dot. */

#define SEEN 200u                /* plants around the middle that the picture is for */
#define SQUARE_M 200.0
#define FAR_M 250.0              /* farther away plants are dots */
#define FIELD_DEG 45.0
#define STEEP 0.5                /* the look goes down no steeper, if that does not take it too far away */
#define UNKNOWN_M 10.0
#define CLEAR_M 10.0             /* around the eye no plant reaches so near to it */
#define STEPS 32                 /* of the ground between eye and target */

static int compare(const void *a, const void *b)
{
	double p = *(const double *)a, q = *(const double *)b;
	return (p > q) - (p < q);
}

static double ground_at(const struct map *m, double x, double y)
{
	double z = 0;
	if (m->has_ground)
		eco_ground_height(&m->ground, x, y, &z);
	return z;
}

static uint32_t count_around(double (*points)[2], uint32_t count, const double at[2])
{
	uint32_t around = 0;
	for (uint32_t i = 0; i < count; i++)
		around += fmax(fabs(points[i][0] - at[0]), fabs(points[i][1] - at[1])) <= SQUARE_M / 2;
	return around;
}

/* The medians of x and y; where they lie beside the plants, as in a river, the square that holds the most, or
 * half as many and nearer. */
static void find_crowd(const struct map *m, double at[2])
{
	uint32_t n = m->points.count;
	double *sorted = eco_alloc(n, sizeof *sorted), (*points)[2] = eco_alloc(n, sizeof *points);
	struct eco_cluster *crowds = eco_alloc(n, sizeof *crowds);
	for (int k = 0; k < 2; k++) {
		for (uint32_t i = 0; i < n; i++)
			sorted[i] = points[i][k] = (double)(k ? m->points.items[i].y : m->points.items[i].x);
		qsort(sorted, n, sizeof *sorted, compare);
		at[k] = sorted[n / 2];
	}
	const struct eco_cluster *near = eco_cluster_near(crowds, eco_clusters_find(points, n, SQUARE_M, crowds), at);
	if (count_around(points, n, at) < near->count)
		memcpy(at, near->middle, sizeof near->middle);
	free(sorted);
	free(points);
	free(crowds);
}

/* The plant nearest to `at`, and the distance within which SEEN others stand. */
static void find_middle(const struct map *m, double at[2], double *reach)
{
	uint32_t n = m->points.count, middle = 0;
	double *away = eco_alloc(n, sizeof *away), nearest = INFINITY;
	for (uint32_t i = 0; i < n; i++) {
		double distance = hypot((double)m->points.items[i].x - at[0], (double)m->points.items[i].y - at[1]);
		if (distance < nearest) {
			nearest = distance;
			middle = i;
		}
	}
	at[0] = (double)m->points.items[middle].x;
	at[1] = (double)m->points.items[middle].y;
	for (uint32_t i = 0; i < n; i++)
		away[i] = hypot((double)m->points.items[i].x - at[0], (double)m->points.items[i].y - at[1]);
	qsort(away, n, sizeof *away, compare);
	*reach = fmin(away[n > SEEN ? SEEN : n - 1], SQUARE_M / 2);
	free(away);
}

/* The least height of an eye there that clears plants, and the ground on the way to the target. */
static double least_height(const struct map *m, const double eye[2], const double target[3])
{
	double least = ground_at(m, eye[0], eye[1]) + 1.7;
	for (uint32_t i = 0; i < m->points.count; i++) {
		const struct map_point *p = &m->points.items[i];
		double x = (double)p->x, y = (double)p->y,
		       height = p->height_m > 0 ? (double)p->height_m : m->typical_m;
		if (hypot(x - eye[0], y - eye[1]) < CLEAR_M)
			least = fmax(least, ground_at(m, x, y) + height + CLEAR_M / 2);
	}
	for (int i = 1; i < STEPS; i++) {
		double t = (double)i / STEPS, x = eye[0] + t * (target[0] - eye[0]),
		       y = eye[1] + t * (target[1] - eye[1]);
		/* the line from eye to target is above this ground by 2 m if the eye is so high */
		least = fmax(least, (ground_at(m, x, y) + 2 - t * target[2]) / (1 - t));
	}
	return least;
}

/* The height that one in ten exceeds. */
static double tall_m(const struct map *m)
{
	struct eco_spread heights = { 0 };
	for (uint32_t i = 0; i < m->points.count; i++)
		if (m->points.items[i].height_m > 0)
			eco_spread_add(&heights, (double)m->points.items[i].height_m);
	double tall = eco_spread_quantile(&heights, 0.9);
	eco_spread_free(&heights);
	return tall > 0 ? tall : UNKNOWN_M;
}

/* A camera script of one picture, malloc'ed. */
static char *start_camera(const struct map *map)
{
	double middle[2] = { 0, 0 }, reach = 0, tall = tall_m(map);
	if (map->points.count == 0)
		eco_stop(ECO_BAD_INPUT, "no plant is left to look at");
	find_crowd(map, middle);
	find_middle(map, middle, &reach);
	double away = fmin(fmax(reach + 2 * tall, 3 * tall), FAR_M - 1);
	double target[3] = { middle[0], middle[1], ground_at(map, middle[0], middle[1]) + tall / 2 },
		eye[3] = { middle[0], middle[1] - away };
	for (eye[2] = INFINITY; eye[2] - target[2] > STEEP * (target[1] - eye[1]) && away < FAR_M;
		away *= 1.25) {
		eye[1] = middle[1] - away;
		eye[2] = fmax(target[2] + away / 4, least_height(map, eye, target));
	}
	return start_text("{\"fps\": 1, \"keyframes\": [\n  {\"time_s\": 0, \"eye\": [%.2f, %.2f, %.2f], \"target\": [%.2f, "
		"%.2f, %.2f], \"fov_y_deg\": %g}]}\n", eye[0], eye[1], eye[2], target[0], target[1], target[2], FIELD_DEG);
}

/* ---- Content ---- */

/* The scene is read back as make reads it: what is wrong with it shows now. */
static void write_all(void *writing)
{
	struct writing *w = writing;
	struct start *s = w->start;
	w->map.error = s->error;
	eco_check(eco_file_write(w->beside[SCENE], s->scene, strlen(s->scene), s->error));
	eco_check(map_gather(&w->map, w->beside[SCENE]));
	if (w->map.total == 0)
		eco_stop(ECO_BAD_INPUT, "%.200s: no row became a plant", s->options->table);
	char *camera = start_camera(&w->map);
	eco_check(eco_file_write(w->beside[CAMERA], camera, strlen(camera), s->error));
	free(camera);
	eco_check(map_write(&w->map, w->beside[MAP], MAP_PIXELS));
	for (int i = 0; i < FILES; i++)
		if (rename(w->beside[i], w->path[i]) != 0)
			eco_check(eco_fail_write(s->error, w->path[i], errno));
}

void start_write(struct start *s)
{
	struct writing w = { .start = s };
	name_files(&w);
	eco_at_end(remove_unfinished, &w);
	enum eco_code code = eco_try(write_all, &w, s->error);
	eco_at_end(NULL, NULL);
	if (!code && w.map.off_ground > 0)
		main_note("%s: %llu of %llu plants stand beyond its border", s->dem.path,
			(unsigned long long)w.map.off_ground, (unsigned long long)w.map.total);
	remove_unfinished(&w);
	for (int i = 0; i < FILES; i++) {
		free(w.beside[i]);
		free(w.path[i]);
	}
	map_free(&w.map);
	eco_check(code);
}
