/* Looks of models, see few.h. */
#include "ecofiles/ecopack/few.h"

#include <math.h>
#include <stdlib.h>

#include "lod/arena.h"
#include "lod/build/organ/organ.h"
#include "lod/build/weld.h"
#include "lod/vector.h"

#define WELD_BITS 14u
#define PARTS 4u                     /* a side of a triangle is cut into so many */
#define CLEAR 100.0                  /* bytes: colours that far apart have nothing in common (salience.c) */
#define LEAF_OCTAVES 32.0            /* of area, for a difference of 1 */
#define LEAF_MOST 0.25
#define HEIGHT_OCTAVES 16.0          /* of natural height, for a difference of 1 */
#define HEIGHT_MOST 0.25

struct sums { double area, square, rgb[3]; };

/* Adds a triangle in PARTS^2 parts, each at its middle, to the rows that they lie in. */
static void add_triangle(struct sums rows[FEW_ROWS], struct few_look *look, const struct lod_mesh *mesh,
	const struct lod_organs *organs, uint32_t t)
{
	struct lod_v3 a = lod_mesh_corner(mesh, t, 0), u = lod_v3_sub(lod_mesh_corner(mesh, t, 1), a),
		v = lod_v3_sub(lod_mesh_corner(mesh, t, 2), a);
	double area = organs->area[t] / (PARTS * PARTS), height = look->height_m;
	for (uint32_t i = 0; i < PARTS; i++)
		for (uint32_t k = 0; k < 2 * (PARTS - i) - 1; k++) {
			/* upright parts, and between them those upside down */
			double x = (i + (k % 2 ? 2.0 / 3 : 1.0 / 3)) / PARTS,
				y = (k / 2 + (k % 2 ? 2.0 / 3 : 1.0 / 3)) / PARTS;
			struct lod_v3 p = lod_v3_add(a, lod_v3_add(lod_v3_scale(u, x), lod_v3_scale(v, y)));
			double square = p.x * p.x + p.y * p.y, z = p.z / height * FEW_ROWS;
			uint32_t r = z <= 0 ? 0 : z >= FEW_ROWS ? FEW_ROWS - 1 : (uint32_t)z;
			rows[r].area += area;
			rows[r].square += area * square;
			for (int c = 0; c < 3; c++)
				rows[r].rgb[c] += area * organs->rgb[t][c];
			look->reach_m = fmax(look->reach_m, sqrt(square));
		}
}

/* A row is as wide as a disc of the same mean squared radius; of n layers of leaves n / (n + 1) of it is
 * covered, near the 1 - exp(-n) of leaves at random, and the same on all machines. A leaf shows half of its
 * area in the mean over directions. */
static void finish(struct few_look *look, const struct sums rows[FEW_ROWS])
{
	double height = look->height_m;
	for (uint32_t r = 0; r < FEW_ROWS; r++) {
		const struct sums *s = &rows[r];
		if (!(s->area > 0))
			continue;
		double wide = sqrt(2 * s->square / s->area) / height,
			outline = 2 * fmax(wide, 1e-6) / FEW_ROWS,
			layers = s->area / (height * height) / 2 / outline;
		look->row[r].wide = fmax(wide, 1e-6);
		look->row[r].cover = layers / (1 + layers);
		for (int c = 0; c < 3; c++)
			look->row[r].rgb[c] = s->rgb[c] / s->area;
	}
}

static void look_at(struct few_look *look, const struct eco_model *model, struct lod_arena *arena)
{
	struct lod_mesh mesh;
	struct lod_organs organs;
	struct sums rows[FEW_ROWS] = { { 0 } };
	double leaves = 0;
	uint32_t leaf_count = 0;
	lod_weld(&mesh, model, WELD_BITS, arena);
	lod_organs_find(&organs, &mesh, model, arena);
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		if (!mesh.collapsed[t])
			add_triangle(rows, look, &mesh, &organs, t);
	for (uint32_t c = 0; c < mesh.component_count; c++)
		if (organs.components[c].organ != ECO_ORGAN_WOOD) {
			leaves += organs.components[c].area;
			leaf_count++;
		}
	finish(look, rows);
	look->leaf = leaf_count ? leaves / leaf_count / (look->height_m * look->height_m) : 0;
}

enum eco_code few_look(struct few_look *look, const struct eco_model *model, struct eco_error *error)
{
	struct lod_arena arena = { 0 };
	*look = (struct few_look){ .height_m = fmax(eco_model_height(model), 1e-6) };
	if (setjmp(arena.failed)) {
		lod_arena_free(&arena);
		return eco_fail(error, ECO_NO_MEMORY, "no memory to look at a model of %u triangles",
			model->triangle_count);
	}
	look_at(look, model, &arena);
	lod_arena_free(&arena);
	return ECO_OK;
}

/* 0 to 1. Brightness counts half, as light changes it. */
static double colour_difference(const double a[3], const double b[3])
{
	double light = 0, d[3], square = 0;
	for (int k = 0; k < 3; k++)
		d[k] = a[k] - b[k];
	light = (2 * d[0] + 5 * d[1] + d[2]) / 8;
	square = light * light / 4 + (d[0] - light) * (d[0] - light) + (d[2] - light) * (d[2] - light);
	return fmin(1, sqrt(square) / CLEAR);
}

/* log2, the same on all machines, and continuous. */
static double octaves(double x)
{
	int exponent;
	double mantissa = frexp(x, &exponent);
	return exponent - 1 + (2 * mantissa - 1);
}

double few_difference(const struct few_look *a, const struct few_look *b)
{
	double wrong = 0, either = 0, leaf = 0;
	for (uint32_t r = 0; r < FEW_ROWS; r++) {
		double both = fmin(a->row[r].wide, b->row[r].wide), ca = a->row[r].cover,
			cb = b->row[r].cover;
		double rest = fmax(a->row[r].wide, b->row[r].wide) - both,
			covered = a->row[r].wide > b->row[r].wide ? ca : cb;
		wrong += rest * covered + both * (fabs(ca - cb)
			+ fmin(ca, cb) * colour_difference(a->row[r].rgb, b->row[r].rgb));
		either += rest * covered + both * fmax(ca, cb);
	}
	if (a->leaf > 0 && b->leaf > 0)
		leaf = fmin(LEAF_MOST, fabs(octaves(a->leaf) - octaves(b->leaf)) / LEAF_OCTAVES);
	double rows = either > 0 ? wrong / either : 0, height = fmin(HEIGHT_MOST,
		fabs(octaves(a->height_m) - octaves(b->height_m)) / HEIGHT_OCTAVES);
	return 1 - (1 - rows) * (1 - leaf) * (1 - height);
}
