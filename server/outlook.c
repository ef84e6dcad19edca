#include "server/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/geometry.h"
#include "ecofiles/format/plan.h"

#define SQUARE_M 200.0
#define LEAST_M 40.0             /* wide, however few plants stand there */
#define POINTS_MAX (1u << 17)    /* plants of an eco file that are counted */
#define NESTED_MAX 64u           /* eco files in each other that are looked into */

struct file { uint32_t tile; struct eco_placement placement; };  /* an eco file where it is placed */

struct search {
	const struct eco_scene *scene;
	struct file file;                /* that is looked into */
	bool *below;                     /* of each tile: it is in this file */
	double (*plants)[2][3], (*points)[2];    /* foot and top of plants; points, which are sorted: their feet */
	struct eco_cluster *crowds;      /* of these points, and then one for each file that is placed in this */
	struct file *placed;
	uint32_t point_count, crowd_count, placed_count;
	uint64_t apart;                  /* one plant of so many is looked at */
};

/* ---- Boxes ---- */

static double width_of(const struct eco_scene *scene, const struct file *file)
{
	const struct eco_tile *t = &scene->tiles[file->tile];
	return fmax(t->high[0] - t->low[0], t->high[1] - t->low[1]) * file->placement.scale;
}

static void middle_of(const struct eco_scene *scene, const struct file *file, double middle[3])
{
	const struct eco_tile *t = &scene->tiles[file->tile];
	double inside[3];
	for (int k = 0; k < 3; k++)
		inside[k] = t->low[k] + (t->high[k] - t->low[k]) / 2;
	eco_placement_point(&file->placement, inside, middle);
}

static void empty_box(struct srv_outlook *box)
{
	for (int k = 0; k < 3; k++) {
		box->low[k] = INFINITY;
		box->high[k] = -INFINITY;
	}
}

static void widen_box(struct srv_outlook *box, const double at[3])
{
	for (int k = 0; k < 3; k++) {
		box->low[k] = fmin(box->low[k], at[k]);
		box->high[k] = fmax(box->high[k], at[k]);
	}
}

/* ---- Plants of a file ---- */

/* Takes plants of a group from the `next`th on; returns the next one of the group behind it. */
static uint64_t take_group(struct search *s, const struct eco_group *group, uint64_t next)
{
	const struct eco_list *list = &s->scene->lists[group->list];
	for (; next < group->count; next += s->apart) {
		struct eco_place place = eco_place_read(s->scene, group->place_first + next);
		double inside[3], (*plant)[3] = s->plants[s->point_count];
		for (int k = 0; k < 3; k++)
			inside[k] = list->grid_origin[k] + list->grid_step[k] * place.position[k];
		eco_placement_point(&s->file.placement, inside, plant[0]);
		memcpy(plant[1], plant[0], sizeof plant[1]);
		plant[1][2] += (double)s->scene->plants[group->plant].height_m * place.scale / 65536
			* s->file.placement.scale;
		memcpy(s->points[s->point_count++], plant[0], sizeof *s->points);
	}
	return next - group->count;
}

/* The box of the plants in a square around `middle`. */
static void box_square(const struct search *s, const double middle[2], struct srv_outlook *out)
{
	empty_box(out);
	for (uint32_t i = 0; i < s->point_count; i++) {
		double (*plant)[3] = s->plants[i];
		if (fabs(plant[0][0] - middle[0]) > SQUARE_M / 2 || fabs(plant[0][1] - middle[1]) > SQUARE_M /
			2) continue;
		widen_box(out, plant[0]);
		widen_box(out, plant[1]);
	}
}

/* ---- Files in files ---- */

/* Its plants as if they stood evenly. */
static void place_file(struct search *s, const struct eco_child *child)
{
	struct file file = { child->tile, eco_placement_inside(&s->file.placement, child) };
	const struct eco_tile *tile = &s->scene->tiles[child->tile];
	struct eco_cluster *crowd = &s->crowds[s->crowd_count + s->placed_count];
	double at[3], plants = (double)tile->instance_count / (double)s->apart;
	for (int k = 0; k < 2; k++)
		plants *= fmin(1, SQUARE_M / fmax((tile->high[k] - tile->low[k]) * file.placement.scale, 1e-9));
	middle_of(s->scene, &file, at);
	memcpy(crowd->middle, at, sizeof crowd->middle);
	crowd->count = (uint32_t)fmin(fmax(plants, 1), UINT32_MAX);
	s->placed[s->placed_count++] = file;
}

/* Tiles of the file have greater numbers than their parents. */
static uint64_t mark_tiles(struct search *s)
{
	const struct eco_scene *scene = s->scene;
	uint64_t plants = 0;
	memset(s->below, 0, scene->tile_count * sizeof *s->below);
	s->below[s->file.tile] = true;
	for (uint32_t t = s->file.tile; t < scene->tile_count; t++) {
		const struct eco_tile *tile = &scene->tiles[t];
		for (uint32_t g = 0; s->below[t] && g < tile->group_count; g++)
			plants += scene->groups[tile->group_first + g].count;
		for (uint32_t c = 0; s->below[t] && c < tile->child_count; c++) {
			const struct eco_child *child = &scene->children[tile->child_first + c];
			s->below[child->tile] |= !child->placed;
		}
	}
	return plants;
}

/* The file's own plants, and the files that are placed in it. */
static void find_crowds(struct search *s)
{
	uint64_t next = 0;
	s->apart = mark_tiles(s) / POINTS_MAX + 1;
	s->point_count = s->placed_count = 0;
	for (uint32_t t = s->file.tile; t < s->scene->tile_count; t++) {
		const struct eco_tile *tile = &s->scene->tiles[t];
		for (uint32_t g = 0; s->below[t] && g < tile->group_count; g++)
			next = take_group(s, &s->scene->groups[tile->group_first + g], next);
	}
	s->crowd_count = eco_clusters_find(s->points, s->point_count, SQUARE_M, s->crowds);
	for (uint32_t t = s->file.tile; t < s->scene->tile_count; t++) {
		const struct eco_tile *tile = &s->scene->tiles[t];
		for (uint32_t c = 0; s->below[t] && c < tile->child_count; c++)
			if (s->scene->children[tile->child_first + c].placed)
				place_file(s, &s->scene->children[tile->child_first + c]);
	}
}

/* Looks on into a file that is placed; false: *out is found. */
static bool look_into(struct search *s, const double middle[3], struct srv_outlook *out)
{
	find_crowds(s);
	const struct eco_cluster *crowd = eco_cluster_near(s->crowds, s->crowd_count + s->placed_count, middle);
	if (!crowd)
		return false;
	if (crowd >= s->crowds + s->crowd_count) {
		s->file = s->placed[crowd - s->crowds - s->crowd_count];
		return true;
	}
	box_square(s, crowd->middle, out);
	return false;
}

/* The corners of a file, wherever its plants are. */
static void box_file(const struct eco_scene *scene, const struct file *file, struct srv_outlook *out)
{
	const struct eco_tile *t = &scene->tiles[file->tile];
	empty_box(out);
	for (int corner = 0; corner < 8; corner++) {
		double at[3] = { (corner & 1 ? t->high : t->low)[0], (corner & 2 ? t->high : t->low)[1],
			(corner & 4 ? t->high : t->low)[2] };
		eco_placement_point(&file->placement, at, at);
		widen_box(out, at);
	}
}

static void find_spot(struct search *s, struct srv_outlook *out)
{
	double middle[3];
	middle_of(s->scene, &s->file, middle);
	for (uint32_t i = 0; i < NESTED_MAX && look_into(s, middle, out); i++) {
		box_file(s->scene, &s->file, out);
		if (width_of(s->scene, &s->file) <= SQUARE_M)
			break;
	}
	for (int k = 0; k < 2; k++) {
		double more = fmax(0, LEAST_M - (out->high[k] - out->low[k])) / 2;
		out->low[k] -= more;
		out->high[k] += more;
	}
}

enum eco_code srv_outlook_find(const struct eco_scene *scene, struct srv_outlook *out,
	struct eco_error *error)
{
	struct search s = { .scene = scene, .file = { scene->root, { .scale = 1 } } };
	*out = (struct srv_outlook){ { 0 }, { 0 } };
	if (!scene->tile_count)
		return ECO_OK;
	box_file(scene, &s.file, out);
	if (width_of(scene, &s.file) <= SRV_OUTLOOK_WHOLE_M)
		return ECO_OK;
	s.below = malloc(scene->tile_count * sizeof *s.below);
	s.points = malloc(POINTS_MAX * sizeof *s.points);
	s.plants = malloc(POINTS_MAX * sizeof *s.plants);
	s.crowds = malloc((POINTS_MAX + (size_t)scene->child_count) * sizeof *s.crowds);
	s.placed = malloc((scene->child_count + 1u) * sizeof *s.placed);
	bool made = s.below && s.plants && s.points && s.crowds && s.placed;
	if (made)
		find_spot(&s, out);
	eco_free(s.below, s.points, s.plants, s.crowds, s.placed);
	return made ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for another scene");
}
