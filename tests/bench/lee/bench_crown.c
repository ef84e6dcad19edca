/* A broad-leaved tree with exactly 6,143 leaves, as many as Lee's. Shoots fill the lobes of a round
 * crown, twigs fan out from them, leaves stand around the twigs and face the light. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/generate/generate_plants.h"
#include "tests/bench/bench.h"

#define CROWN_LEAVES 6143u
#define SHOOTS 246u
#define TWIGS 5u
#define LEAVES 5u                /* on a twig: 6,150; the last twigs bear a few less */

static void grow_leaves(struct gen_mesh *mesh, uint8_t bark, uint8_t leaf, const struct gen_shoot *shoot,
	struct gen_random *random, uint32_t *left)
{
	for (uint32_t t = 0; t < TWIGS; t++) {
		struct gen_v3 way =
			gen_unit(gen_add(gen_mad(shoot->along, gen_random_way(random), 0.9),
			gen_v3(0, 0, 0.15)));
		double length = gen_random_in(random, 0.5, 0.9), radius[2] = { 0.006, 0 };
		struct gen_v3 points[2] = { shoot->at, gen_mad(shoot->at, way, length) },
			across = gen_across(way);
		gen_tube(mesh, bark, &(struct gen_tube){ points, radius, 2, 3 });
		for (uint32_t i = 0; i < LEAVES && *left; i++, --*left) {
			struct gen_v3 side =
				gen_turned(across, way, 137.5 * i + gen_random_in(random, -30, 30));
			struct gen_v3 along = gen_add(side, gen_mul(way, 0.7));
			along.z -= 0.25;
			double size = gen_random_in(random, 0.8, 1.15);
			gen_leaf(mesh, leaf,
				&(struct gen_leaf){
				.at = gen_mad(shoot->at, way, length * (i + 1.0) / LEAVES), .along = along,
				.face = gen_add(gen_mad(gen_v3(0, 0, 1), shoot->along, 0.7),
				gen_mul(gen_random_way(random), 0.6)),
				.length = 0.36 * size, .width = 0.24 * size, .shape = GEN_LEAF_RHOMB });
		}
	}
}

static void grow(struct gen_mesh *mesh)
{
	struct gen_random random = { .state = 6143 };
	struct gen_shoot shoots[SHOOTS];
	uint8_t bark = gen_material(mesh, "bark", 0x584838, NULL),
		leaf = gen_material(mesh, "leaf", 0x4c6e28, NULL);
	uint32_t left = CROWN_LEAVES;
	gen_tree(mesh, bark,
		&(struct gen_crown){ .height = 12, .base = 2.6, .radius = 4.6, .trunk_radius = 0.3,
		.lean = 0.4, .lobes = 15,
		.shoots = SHOOTS }, &random, shoots);
	for (uint32_t i = 0; i < SHOOTS; i++)
		grow_leaves(mesh, bark, leaf, &shoots[i], &random, &left);
}

struct eco_model bench_crown_make(void)
{
	struct gen_mesh mesh = { 0 };
	size_t triangles = 0;
	grow(&mesh);
	for (uint32_t i = 0; i < mesh.face_count; i++)
		triangles += mesh.faces[i].corners - 2u;
	struct eco_model model = { .position = eco_alloc(mesh.count, 3 * sizeof(float)),
		.index = eco_alloc(triangles, 3 * sizeof(uint32_t)), .material = eco_alloc(triangles,
		sizeof(uint32_t)),
		.materials = eco_alloc(mesh.material_count, sizeof *model.materials), .vertex_count
		= mesh.count,
		.material_count = mesh.material_count, .triangles_in = (uint32_t)triangles, .scale = 1 };
	for (uint32_t i = 0; i < mesh.count; i++) {
		model.position[3 * i] = (float)mesh.position[i].x;
		model.position[3 * i + 1] = (float)mesh.position[i].y;
		model.position[3 * i + 2] = (float)mesh.position[i].z;
	}
	for (uint32_t i = 0; i < mesh.material_count; i++) {
		struct eco_material *to = &model.materials[i];
		to->image = ECO_NONE;
		memcpy(to->name, mesh.materials[i].name, sizeof mesh.materials[i].name);
		memcpy(to->rgb, mesh.materials[i].rgb, sizeof to->rgb);
	}
	for (uint32_t i = 0; i < mesh.face_count; i++)
		for (uint32_t k = 0; k + 2 < mesh.faces[i].corners; k++) {   /* faces become fans */
			uint32_t *index = model.index + 3 * (size_t)model.triangle_count;
			index[0] = mesh.faces[i].corner[0];
			index[1] = mesh.faces[i].corner[k + 1];
			index[2] = mesh.faces[i].corner[k + 2];
			model.material[model.triangle_count++] = mesh.faces[i].material;
		}
	gen_mesh_free(&mesh);
	return model;
}

struct crown_file { struct gen_mesh mesh; const char *folder, *name; struct eco_error *error; };

static void write_file(void *ctx)
{
	const struct crown_file *file = ctx;
	gen_mesh_write(&file->mesh, file->folder, file->name, file->error);
}

enum eco_code bench_crown_write(const char *folder, const char *name, struct eco_error *error)
{
	struct crown_file file = { { 0 }, folder, name, error };
	grow(&file.mesh);
	enum eco_code code = eco_try(write_file, &file, error);
	gen_mesh_free(&file.mesh);
	return code;
}
