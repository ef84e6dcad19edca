/* The ground of a scene without rasters, laid through the feet of its plants. These come from the scene's
 * tables, which `make` and `link` both have, so that linked packs get the ground of the whole. Of more than
 * FEET_MAX plants, as many are taken, each so many plants along the tree. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/import/ground/ground.h"
#include "lod/eye.h"

#define FEET_MAX (1u << 20)
#define OFF_NOTED_M 0.1

struct feet {
	const struct eco_scene *scene;
	double (*at)[3]; uint32_t count;
	uint64_t apart;              /* plants from one that is taken to the next */
};

static void take(struct feet *f, const struct lod_place *file, const double at[3])
{
	double *to = f->at[f->count++];
	to[0] = file->at[0] + file->scale * (file->cosine * at[0] - file->sine * at[1]);
	to[1] = file->at[1] + file->scale * (file->sine * at[0] + file->cosine * at[1]);
	to[2] = file->at[2] + file->scale * at[2];
}

/* The first plant that is taken among those from number `first` on. */
static uint64_t taken_from(const struct feet *f, uint64_t first)
{
	uint64_t over = first % f->apart;
	return over ? f->apart - over : 0;
}

static void take_group(struct feet *f, const struct eco_group *group, const struct lod_place *file,
	uint64_t first)
{
	const struct eco_list *list = &f->scene->lists[group->list];
	for (uint64_t i = taken_from(f, first); i < group->count; i += f->apart) {
		struct eco_place p = eco_place_read(f->scene, group->place_first + i);
		double at[3];
		for (int k = 0; k < 3; k++)
			at[k] = list->grid_origin[k] + list->grid_step[k] * p.position[k];
		take(f, file, at);
	}
}

static struct lod_place placed(const struct lod_place *file, const struct eco_child *child)
{
	struct lod_place inner = *file;
	double sine, cosine;
	if (!child->placed)
		return inner;
	eco_angle16_sincos(child->turn, &sine, &cosine);
	inner.at[0] += file->scale * (file->cosine * child->at[0] - file->sine * child->at[1]);
	inner.at[1] += file->scale * (file->sine * child->at[0] + file->cosine * child->at[1]);
	inner.at[2] += file->scale * child->at[2];
	inner.sine = file->sine * cosine + file->cosine * sine;
	inner.cosine = file->cosine * cosine - file->sine * sine;
	inner.scale *= (double)child->scale;
	return inner;
}

/* first: the number of plants before the tile's. */
static void take_tile(struct feet *f, uint32_t id, const struct lod_place *file, uint64_t first)
{
	const struct eco_scene *s = f->scene;
	const struct eco_tile *tile = &s->tiles[id];
	if (taken_from(f, first) >= tile->instance_count)
		return;
	for (uint32_t g = tile->group_first; g < tile->group_first + tile->group_count; g++) {
		take_group(f, &s->groups[g], file, first);
		first += s->groups[g].count;
	}
	for (uint32_t c = tile->child_first; c < tile->child_first + tile->child_count; c++) {
		struct lod_place inner = placed(file, &s->children[c]);
		take_tile(f, s->children[c].tile, &inner, first);
		first += s->tiles[s->children[c].tile].instance_count;
	}
}

/* Plants that stand where the ground cannot go, as their neighbours are at other heights. */
static void note_off(const struct make *m, const struct feet *f)
{
	uint32_t off = 0;
	double most = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		double z;
		eco_ground_height(&m->ground, f->at[i][0], f->at[i][1], &z);
		off += fabs(f->at[i][2] - z) > OFF_NOTED_M;
		most = fmax(most, fabs(f->at[i][2] - z));
	}
	if (off)
		main_note(
			"the scene names no ground; that through its plants is more than %g m off %u of %u feet, "
			"at most %.2f m, as plants close together stand at other heights: give \"ground\" the rasters "
			"of their heights, or null for none",
			OFF_NOTED_M, off, f->count, most);
}

enum eco_code make_ground_through(struct make *m)
{
	const struct eco_tile *root = &m->scene.tiles[m->scene.root];
	struct feet f = { .scene = &m->scene, .apart = (root->instance_count + FEET_MAX - 1) / FEET_MAX };
	if (m->has_ground || root->instance_count == 0)
		return ECO_OK;
	if (!main_progress("laying ground through the plants", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	f.at = malloc((root->instance_count / f.apart + 1) * sizeof *f.at);
	if (!f.at)
		return eco_fail(m->error, ECO_NO_MEMORY, "no memory for the feet of plants");
	take_tile(&f, m->scene.root, &(struct lod_place){ .cosine = 1, .scale = 1 }, 0);
	struct eco_ground_feet feet = { .at = (const double (*)[3])f.at, .count = f.count,
		.low = { root->low[0], root->low[1] }, .high = { root->high[0], root->high[1] } };
	enum eco_code code = eco_ground_through(&m->ground, &feet, m->error);
	if (!code)
		code = make_ground_finish(m);
	if (!code) {
		note_off(m, &f);
		m->ground_through = true;
		code = make_ground_pack(m);
	}
	free(f.at);
	return code;
}
