#include "lod/organ.h"

#include <math.h>
#include <string.h>

#include "lod/sort.h"
#include "lod/texel.h"
#include "lod/vector.h"

/* Thresholds on 28 models from seven sources, measured: tubes have r/d <= 0.032 (one stout trunk: 0.037), solid leaves, crowns, pots
 * >= 0.058. Edge angles: tubes of four or more sides <= 1.6, of three 2.1, closed blades 2.2 to 3. */
#define THIN_CLEAR 0.033
#define THIN_LIMIT 0.045
#define THICK_CLEAR 0.058
#define ROUND_CLEAR 1.95
#define ROUND_LIMIT 2.15
#define BLADE_CLEAR 2.4
#define LENGTH_LEAST 0.7         /* of the diagonal; a blade folded to a right angle has 0.25 */

#define COPIES_MANY 50           /* components of one material and triangle count from which on they are taken for leaves in doubt */

enum verdict { CLEARLY_WOOD, RATHER_WOOD, RATHER_LEAF, CLEARLY_LEAF };

struct shape {                   /* sums over one component */
	double bend, angle, angle2;  /* length-weighted sums of signed, absolute and squared angle */
	double border, edges;        /* lengths */
	double glued;                /* length of border that continues in another component, and the last such component */
	uint32_t glued_to;
	double rgb[3], weight;
};

static struct lod_v3 corner(const struct lod_mesh *mesh, uint32_t t, uint32_t k)
{
	return lod_v3_of(mesh->place + 3 * (size_t)mesh->index[3 * (size_t)t + k % 3]);
}

static struct lod_v3 area_normal(const struct lod_mesh *mesh, uint32_t t)
{
	struct lod_v3 a = corner(mesh, t, 0);
	return lod_v3_scale(lod_v3_cross(lod_v3_sub(corner(mesh, t, 1), a), lod_v3_sub(corner(mesh, t, 2), a)), 0.5);
}

/* 1 or -1 per triangle, so that neighbours look to the same side: soups are wound at random. */
static int8_t *orient(const struct lod_mesh *mesh, struct lod_arena *arena)
{
	int8_t *sign = lod_arena_take(arena, mesh->triangle_count, sizeof *sign);
	struct lod_arena_piece *mark = arena->last;
	uint32_t *stack = lod_arena_take(arena, mesh->triangle_count, sizeof *stack), depth = 0;
	for (uint32_t seed = 0; seed < mesh->triangle_count; seed++) {
		if (sign[seed])
			continue;
		sign[seed] = 1;
		stack[depth++] = seed;
		while (depth) {
			uint32_t t = stack[--depth];
			for (uint32_t k = 0; k < 3; k++) {
				uint32_t edge = lod_mesh_across(mesh, t, k);
				if (edge == ECO_NONE || sign[edge / 3])
					continue;
				/* Wound alike, two triangles run along their common edge in opposite directions. */
				sign[edge / 3] = mesh->index[edge] == mesh->index[3 * t + k] ? (int8_t)-sign[t] : sign[t];
				stack[depth++] = edge / 3;
			}
		}
	}
	lod_arena_release(arena, mark);
	return sign;
}

static void add_edges(struct shape *shape, const struct lod_mesh *mesh, const int8_t *sign, uint32_t t)
{
	struct lod_v3 normal = lod_v3_scale(lod_v3_unit(area_normal(mesh, t)), sign[t]);
	for (uint32_t k = 0; k < 3; k++) {
		uint32_t edge = lod_mesh_across(mesh, t, k);
		double length = lod_v3_distance(corner(mesh, t, k), corner(mesh, t, k + 1));
		shape->edges += length;
		if (edge == ECO_NONE) {
			uint32_t other = mesh->across[3 * (size_t)t + k];
			shape->border += length;
			if (other != ECO_NONE) {
				shape->glued += length;
				shape->glued_to = mesh->component[other / 3];
			}
			continue;
		}
		uint32_t u = edge / 3;
		if (u < t)
			continue;
		struct lod_v3 other = lod_v3_scale(lod_v3_unit(area_normal(mesh, u)), sign[u]);
		double angle = lod_arc_cosine(lod_v3_dot(normal, other));
		struct lod_v3 away = lod_v3_sub(corner(mesh, u, edge % 3 + 2), corner(mesh, t, k));
		shape->bend += (lod_v3_dot(normal, away) < 0 ? angle : -angle) * length;
		shape->angle += angle * length;
		shape->angle2 += angle * angle * length;
	}
}

static void add_triangle(struct lod_component *c, struct shape *shape, const struct lod_mesh *mesh, const struct lod_organs *organs,
	uint32_t t)
{
	if (c->triangle_count++ == 0) {
		c->material = mesh->material[t];
		for (int a = 0; a < 3; a++) {
			c->low[a] = INFINITY;
			c->high[a] = -INFINITY;
		}
	}
	for (int k = 0; k < 3; k++)
		for (int a = 0; a < 3; a++) {
			float p = mesh->place[3 * (size_t)mesh->index[3 * (size_t)t + k] + a];
			c->low[a] = fminf(c->low[a], p);
			c->high[a] = fmaxf(c->high[a], p);
		}
	c->area += lod_v3_length(area_normal(mesh, t));
	for (int k = 0; k < 3; k++)
		shape->rgb[k] += organs->rgb[t][k] * organs->area[t];
	shape->weight += organs->area[t];
}

static double diagonal(const struct lod_component *c)
{
	struct lod_v3 low = lod_v3_of(c->low), high = lod_v3_of(c->high);
	return lod_v3_distance(low, high);
}

static void finish(struct lod_component *c, const struct shape *shape)
{
	double bend = fabs(shape->bend) / 2;
	c->length = bend / LOD_PI;
	c->radius = bend > 0 ? c->area / (2 * bend) : INFINITY;
	c->turn = shape->angle > 0 ? shape->angle2 / shape->angle : 0;
	/* A tube open at both ends has little border; a sheet's is a good part of all its edges. */
	c->closed = shape->border < 0.02 * shape->edges;
	for (int k = 0; k < 3; k++)
		c->rgb[k] = (uint8_t)(shape->weight > 0 ? shape->rgb[k] / shape->weight + 0.5 : 0);
}

static enum verdict judge(const struct lod_component *c, bool cutout)
{
	double d = diagonal(c), thin = c->radius / d;
	if (cutout || c->length < LENGTH_LEAST * d || thin > THICK_CLEAR || c->turn > BLADE_CLEAR)
		return CLEARLY_LEAF;
	if (thin <= THIN_CLEAR && c->turn <= ROUND_CLEAR)
		return CLEARLY_WOOD;
	return thin <= THIN_LIMIT && c->turn <= ROUND_LIMIT ? RATHER_WOOD : RATHER_LEAF;
}

static bool is_cutout(const struct eco_model *model, uint32_t material)
{
	return lod_mesh_material(model, material)->cutout && lod_mesh_image(model, material) != NULL;
}

/* Doubtful components go with the clear ones of their material, by area, where those speak clearly. */
static void settle_doubts(struct lod_organs *organs, const struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	double (*clear)[2] = lod_arena_take(arena, (size_t)model->material_count + 1, sizeof *clear);
	uint8_t *verdict = lod_arena_take(arena, mesh->component_count, sizeof *verdict);
	for (uint32_t i = 0; i < mesh->component_count; i++) {
		struct lod_component *c = &organs->components[i];
		uint32_t m = c->material < model->material_count ? c->material : model->material_count;
		verdict[i] = judge(c, is_cutout(model, c->material));
		if (verdict[i] == CLEARLY_WOOD || verdict[i] == CLEARLY_LEAF)
			clear[m][verdict[i] == CLEARLY_WOOD] += c->area;
	}
	for (uint32_t i = 0; i < mesh->component_count; i++) {
		struct lod_component *c = &organs->components[i];
		const double *known = clear[c->material < model->material_count ? c->material : model->material_count];
		bool wood = verdict[i] == CLEARLY_WOOD || verdict[i] == RATHER_WOOD;
		if (verdict[i] == RATHER_WOOD || verdict[i] == RATHER_LEAF)
			wood = known[1] > 3 * known[0] ? true : known[0] > 3 * known[1] ? false : wood;
		c->organ = wood ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE;
	}
	lod_arena_release(arena, mark);
}

/* Components of one material with the same number of triangles are copies of one part, stretched and bent: they are one organ. The
 * larger area wins; among many copies wood must be twice as much, since what comes in many copies usually is a leaf. */
static void settle_copies(struct lod_organs *organs, const struct lod_mesh *mesh, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *by = lod_arena_take(arena, mesh->component_count, sizeof *by);
	for (uint32_t i = 0; i < mesh->component_count; i++)
		by[i] = (struct lod_keyed){ (uint64_t)organs->components[i].material << 32 | organs->components[i].triangle_count, i };
	lod_sort(arena, by, mesh->component_count);
	for (uint32_t first = 0, end; first < mesh->component_count; first = end) {
		double area[ECO_ORGAN_COUNT] = { 0 };
		for (end = first; end < mesh->component_count && by[end].key == by[first].key; end++)
			area[organs->components[by[end].value].organ] += organs->components[by[end].value].area;
		double need = end - first >= COPIES_MANY ? 2 : 1;
		bool wood = area[ECO_ORGAN_WOOD] > need * area[ECO_ORGAN_FOLIAGE];
		for (uint32_t i = first; i < end; i++)
			organs->components[by[i].value].organ = wood ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE;
	}
	lod_arena_release(arena, mark);
}

/* A patch of another colour inlaid in bark is bark: all of its border continues in wood. */
static void settle_inlays(struct lod_organs *organs, const struct lod_mesh *mesh, const struct shape *shapes)
{
	for (uint32_t i = 0; i < mesh->component_count; i++) {
		struct lod_component *c = &organs->components[i];
		const struct lod_component *host = &organs->components[shapes[i].glued_to];
		if (shapes[i].glued > 0.75 * shapes[i].border && host->organ == ECO_ORGAN_WOOD && c->area < 0.1 * host->area)
			c->organ = ECO_ORGAN_WOOD;
	}
}

/* ---- Flowers ---- */

/* Colour without brightness: the shares of red, green and blue. */
static struct lod_v3 chroma(const uint8_t rgb[3])
{
	double sum = rgb[0] + rgb[1] + rgb[2] + 1;
	return (struct lod_v3){ rgb[0] / sum, rgb[1] / sum, rgb[2] / sum };
}

static bool stands_out(const uint8_t rgb[3], struct lod_v3 majority)
{
	int most = rgb[0] > rgb[1] ? rgb[0] : rgb[1], least = rgb[0] < rgb[1] ? rgb[0] : rgb[1];
	most = most > rgb[2] ? most : rgb[2];
	least = least < rgb[2] ? least : rgb[2];
	bool vivid = 10 * (most - least) > 4 * most && most > 60, pale = least > 140;
	bool green = rgb[1] > rgb[0] && rgb[1] > rgb[2];
	return lod_v3_distance(chroma(rgb), majority) > 0.15 && !green && (vivid || pale);
}

/* Only small components count: a brown pot is none, and autumn leaves are the majority that they would have to stand out from. */
#define SMALL 0.5                /* of the plant's largest extent */
static void find_flowers(struct lod_organs *organs, const struct lod_mesh *mesh)
{
	struct lod_v3 majority = { 0, 0, 0 };
	double weight = 0, found = 0, size = 0;
	for (int a = 0; a < 3; a++)
		size = fmax(size, (double)mesh->high[a] - mesh->low[a]);
	for (uint32_t i = 0; i < mesh->component_count; i++) {
		const struct lod_component *c = &organs->components[i];
		if (c->organ != ECO_ORGAN_FOLIAGE || diagonal(c) > SMALL * size)
			continue;
		majority = lod_v3_add(majority, lod_v3_scale(chroma(c->rgb), c->area));
		weight += c->area;
	}
	if (weight <= 0)
		return;
	majority = lod_v3_scale(majority, 1 / weight);
	for (int mark = 0; mark < 2; mark++)
		for (uint32_t i = 0; i < mesh->component_count; i++) {
			struct lod_component *c = &organs->components[i];
			if (c->organ != ECO_ORGAN_FOLIAGE || diagonal(c) > SMALL * size || !stands_out(c->rgb, majority))
				continue;
			if (!mark)
				found += c->area;
			else if (found < 0.5 * weight)
				c->organ = ECO_ORGAN_FLOWER;
		}
}

/* ---- All ---- */

static void colour_triangles(struct lod_organs *organs, const struct lod_mesh *mesh, const struct eco_model *model)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const struct eco_material *material = lod_mesh_material(model, mesh->material[t]);
		const struct eco_image *image = lod_mesh_image(model, mesh->material[t]);
		double share = 1;
		if (image)
			share = lod_texel_mean(image, material->cutout, material->rgb, mesh->uv + 6 * (size_t)t, organs->rgb[t]);
		else
			memcpy(organs->rgb[t], material->rgb, 3);
		/* No opaque sample among 16 does not mean nothing: a sixteenth of a sample's worth keeps it drawable. */
		organs->area[t] = lod_v3_length(area_normal(mesh, t)) * (share > 0 ? share : 1.0 / 256);
	}
}

void lod_organs_find(struct lod_organs *organs, const struct lod_mesh *mesh, const struct eco_model *model, struct lod_arena *arena)
{
	organs->components = lod_arena_take(arena, mesh->component_count, sizeof *organs->components);
	organs->area = lod_arena_take(arena, mesh->triangle_count, sizeof *organs->area);
	organs->rgb = lod_arena_take(arena, mesh->triangle_count, sizeof *organs->rgb);
	struct lod_arena_piece *mark = arena->last;
	const int8_t *sign = orient(mesh, arena);
	struct shape *shapes = lod_arena_take(arena, mesh->component_count, sizeof *shapes);
	colour_triangles(organs, mesh, model);
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++) {
			add_triangle(&organs->components[c], &shapes[c], mesh, organs, mesh->member[i]);
			add_edges(&shapes[c], mesh, sign, mesh->member[i]);
		}
		finish(&organs->components[c], &shapes[c]);
	}
	settle_doubts(organs, mesh, model, arena);
	settle_copies(organs, mesh, arena);
	settle_inlays(organs, mesh, shapes);
	find_flowers(organs, mesh);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const struct lod_component *c = &organs->components[mesh->component[t]];
		if (c->organ == ECO_ORGAN_WOOD || c->closed)
			organs->area[t] /= 2;
	}
	lod_arena_release(arena, mark);
}
