/* The library of plants: every row of its tables grows into a valid model of the size asked for, the same
 * bytes each time; what is no plant gets an error that says what is one. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/generate/generate_growth.h"
#include "ecofiles/generate/library.h"
#include "ecofiles/import/model/model_parts.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

static struct eco_library_plant plant_of(const char *habit, double height_m, double crown_m)
{
	struct eco_library_plant plant = { .height_m = height_m, .crown_m = crown_m };
	snprintf(plant.habit, sizeof plant.habit, "%s", habit);
	return plant;
}

static void make(struct eco_model *model, const struct eco_library_plant *plant)
{
	assert_good(eco_library_make(model, plant, &cause));
}

/* ---- Sizes ---- */

static double width(const struct eco_model *m)
{
	double sum = 0;
	for (int k = 0; k < 8; k++) {
		struct gen_v3 way = gen_heading(22.5 * k, 0);
		double low = 0, high = 0;
		for (uint32_t i = 0; i < m->vertex_count; i++) {
			double at =
				way.x * (double)m->position[3 * i] + way.y * (double)m->position[3 * i + 1];
			low = fmin(low, at);
			high = fmax(high, at);
		}
		sum += (high - low) / 8;
	}
	return sum;
}

/* Without what textures cut out. */
static double area_of(const struct eco_model *m, uint8_t organ)
{
	double sum = 0, opaque[2] = { 1, 1 };
	for (uint32_t i = 0; i < m->image_count; i++) {
		const struct eco_image *image = &m->images[i];
		uint32_t texels = image->width * image->height, count = 0;
		for (uint32_t k = 0; k < texels; k++)
			count += image->rgba[4 * (size_t)k + 3] >= 128;
		assert_true(count > 0.08 * texels && count < 0.7 * texels);
		opaque[i] = (double)count / texels;
	}
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		uint32_t image = m->materials[m->material[t]].image;
		if (m->organ[t] == organ)
			sum += eco_triangle_area(m, t) * (image == ECO_NONE ? 1 : opaque[image]);
	}
	return sum;
}

static void check_valid(const struct eco_model *m, const char *what)
{
	if (m->vertex_count < 100 || m->vertex_count > 120000 ||
		m->triangle_count > ECO_LIBRARY_TRIANGLES_MAX)
		fail_msg("%s: %u vertices, %u triangles", what, m->vertex_count, m->triangle_count);
	for (uint32_t i = 0; i < m->vertex_count; i++)
		for (int k = 0; k < 3; k++)
			assert_true(
				isfinite(m->position[3 * i + k]) && (k < 2 || m->position[3 * i + k] >= 0));
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		assert_true(m->material[t] < m->material_count && m->organ[t] < ECO_ORGAN_COUNT);
		for (int c = 0; c < 3; c++)
			assert_true(m->index[3 * t + c] < m->vertex_count);
	}
	assert_int_equal(m->triangles_in, m->triangle_count + m->dropped[ECO_DROP_DEGENERATE]);
}

/* Leaves of a quarter of to six times the area under the crown and beside it; none on bare wood. */
static void check_leaves(const struct eco_model *m, const struct eco_habit *habit, double crown_m)
{
	double share = (area_of(m, ECO_ORGAN_FOLIAGE) + area_of(m, ECO_ORGAN_FLOWER)) / (0.39 * crown_m * (crown_m + habit->height_m));
	bool bare = strcmp(habit->name, "dead") == 0 || strcmp(habit->name, "bare") == 0 || strcmp(habit->name, "cactus") == 0;
	if (bare ? share > 0 : share < 0.25 || share > 6)
		fail_msg("%s: %g times the crown's area", habit->name, share);
}

/* At its usual size, its least, its greatest, and one that no such plant has. */
UNIT_TEST(every_habit_has_the_size_asked_for_and_a_believable_area_of_leaves)
{
	struct eco_habit habit;
	for (size_t i = 0; eco_library_habit(i, &habit); i++) {
		const double sizes[4][2] = { { habit.height_m, eco_library_crown(&habit, habit.height_m) },
			{ habit.least_m, 0 }, { habit.most_m, 0 },
			{ habit.height_m, 2.5 * eco_library_crown(&habit, habit.height_m) } };
		for (int k = 0; k < 4; k++) {
			struct eco_model model;
			struct eco_library_plant plant = plant_of(habit.name, sizes[k][0], sizes[k][1]);
			make(&model, &plant);
			check_valid(&model, habit.name);
			double crown = sizes[k][1] > 0 ? sizes[k][1] : eco_library_crown(&habit, sizes[k][0]);
			assert_true(fabs(eco_model_height(&model) / plant.height_m - 1) < 0.03);
			if (!(fabs(width(&model) / crown - 1) < 0.03))
				fail_msg("%s of %g m: a crown of %g m, not %g", habit.name, plant.height_m,
					width(&model), crown);
			if (k == 0)
				check_leaves(&model, &habit, crown);
			eco_model_free(&model);
		}
	}
}

/* The place of the lowest leaf, as a share of the height. */
static double lowest_leaf(const struct eco_library_plant *plant)
{
	struct eco_model m;
	double low = INFINITY;
	make(&m, plant);
	for (uint32_t t = 0; t < m.triangle_count; t++)
		for (int k = 0; k < 3 && m.organ[t] == ECO_ORGAN_FOLIAGE; k++)
			low = fmin(low, (double)m.position[3 * (size_t)m.index[3 * (size_t)t + k] + 2]);
	low /= eco_model_height(&m);
	eco_model_free(&m);
	return low;
}

UNIT_TEST(a_narrow_crown_begins_higher_and_a_measured_base_counts)
{
	static const struct { const char *habit; double height_m, usual_m, narrow_m; } cases[] = { { "spruce", 28, 8.9, 3.6 },
		{ "fir", 30, 8.7, 3.5 }, { "larch", 30, 9.6, 4 }, { "oval", 28, 14, 5 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_library_plant usual = plant_of(cases[i].habit, cases[i].height_m, cases[i].usual_m),
					 narrow = plant_of(cases[i].habit, cases[i].height_m, cases[i].narrow_m),
					 measured = narrow;
		measured.base = 0.7;
		if (lowest_leaf(&usual) > 0.2 || lowest_leaf(&narrow) < 0.3 || fabs(lowest_leaf(&measured) - 0.68) > 0.08)
			fail_msg("%s: leaves from %g, %g and %g of the height on", cases[i].habit, lowest_leaf(&usual),
				lowest_leaf(&narrow), lowest_leaf(&measured));
	}
}

/* Length of the leaf whose first vertex is `first`: to the farthest of its vertices, or a card's height. */
static double leaf_length(const struct gen_mesh *mesh, const struct gen_face *face, double card_leaves)
{
	const struct gen_v3 *p = mesh->position;
	double most = 0;
	if (mesh->materials[face->material].texture)
		return gen_length(gen_sub(p[face->corner[3]], p[face->corner[0]])) / card_leaves;
	for (uint32_t k = 1; k < face->corners; k++)
		most = fmax(most, gen_length(gen_sub(p[face->corner[k]], p[face->corner[0]])));
	return most;
}

struct lengths { double least, sum, most; uint32_t count; };

static struct lengths leaves_of(size_t habit, const struct eco_library_plant *plant, const struct gen_plant_look *look)
{
	struct gen_mesh mesh = { 0 };
	uint8_t organ[GEN_MATERIALS_MAX];
	struct gen_spray sprays[2];
	struct lengths all = { .least = 1e9 };
	gen_habit_grow(&mesh, organ, sprays, habit, plant, look, 7);
	for (uint32_t f = 0; f < mesh.face_count; f++) {
		if (organ[mesh.faces[f].material] != ECO_ORGAN_FOLIAGE)
			continue;
		double length = leaf_length(&mesh, &mesh.faces[f], sprays[0].height);
		all.least = fmin(all.least, length);
		all.most = fmax(all.most, length);
		all.sum += length;
		all.count++;
	}
	gen_mesh_free(&mesh);
	return all;
}

/* Single leaves and those of sprays, of habits whose leaves are as long as their genera's, at five sizes:
 * each within .7 to 1.4 of its true length, in plants that are five times as large as a leaf. A needle's or
 * scale's is its shoot's. */
UNIT_TEST(leaves_have_their_true_size)
{
	enum { KINDS = 6 };
	static const struct {
		const char *shape;
		double leaf_cm, length_m, whole_m; /* of a leaflet or shoot; of the leaf */
	} kinds[KINDS] = { { "simple", 5, 0.05, 0.05 }, { "simple", 12, 0.12, 0.12 }, { "lobed", 12, 0.12, 0.12 },
		{ "compound", 25, 0.09, 0.25 }, { "needle", 3, 0.12, 0.12 }, { "scale", 0.3, 0.07, 0.07 } };
	struct eco_habit habit;
	uint32_t habits = 0;
	for (size_t i = 0; eco_library_habit(i, &habit); i++) {
		const double sizes[] = { habit.least_m, sqrt(habit.least_m * habit.height_m), habit.height_m,
			sqrt(habit.height_m * habit.most_m), habit.most_m };
		for (size_t k = 0; k < 5; k++) {
			double crown = eco_library_crown(&habit, sizes[k]), mean[2];
			struct eco_library_plant plant = plant_of(habit.name, sizes[k], crown);
			struct lengths all[KINDS];
			for (size_t s = 0; s < KINDS; s++)
				all[s] = leaves_of(i, &plant, &(struct gen_plant_look){ .shape = kinds[s].shape,
					.leaf_cm = kinds[s].leaf_cm });
			for (size_t s = 0; s < 2; s++)
				mean[s] = all[s].sum / all[s].count;
			if (!(mean[1] > 1.5 * mean[0])) /* of no genus's size: palms, grasses, seedlings */
				continue;
			habits += k == 2;
			for (size_t s = 0; s < KINDS; s++) {
				double is = kinds[s].length_m;
				if (fmin(sizes[k], crown) >= 5 * kinds[s].whole_m &&
					(all[s].least < 0.7 * is || all[s].most > 1.4 * is))
					fail_msg("%s, %g m high, %s leaves of %g cm: %g to %g cm long",
						habit.name, sizes[k], kinds[s].shape, 100 * is,
						100 * all[s].least, 100 * all[s].most);
			}
		}
	}
	assert_true(habits > 25);
}

/* ---- Wood ---- */

/* Each piece of wood (of many, one in eight) begins within a piece before it, or at the ground: by vertices that a tube's first ring lies among. */
UNIT_TEST(wood_is_connected)
{
	struct eco_habit habit;
	for (size_t i = 0; eco_library_habit(i, &habit); i++) {
		struct eco_model m;
		struct eco_library_plant plant = plant_of(habit.name, habit.height_m, 0);
		make(&m, &plant);
		uint32_t *root = eco_alloc(m.vertex_count, sizeof *root), loose = 0, pieces = 0;
		for (uint32_t v = 0; v < m.vertex_count; v++)
			root[v] = v;
		for (uint32_t t = 0; t < m.triangle_count;
			t++) { /* a piece's first vertex, as pieces are drawn in turn */
			uint32_t *c = m.index + 3 * (size_t)t, least = root[c[0]];
			for (int k = 0; k < 3; k++)
				least = root[c[k]] < least ? root[c[k]] : least;
			for (int k = 0; k < 3; k++)
				root[c[k]] = least;
		}
		double near = 0.02 * habit.height_m + fmin(0.02 * habit.height_m, 0.08);
		for (uint32_t t = 0; t < m.triangle_count; t++) {
			uint32_t first = m.index[3 * (size_t)t];
			bool begins = root[first] == first && m.organ[t] == ECO_ORGAN_WOOD &&
				(t == 0 || m.index[3 * (size_t)t - 3] < first);
			const float *p = m.position + 3 * (size_t)first;
			double least = (double)p[2];
			pieces += begins;
			begins = begins && (pieces < 200 || pieces % 8 == 0);
			for (uint32_t u = 0; begins && u < t && least > near; u++) {
				if (m.organ[u] != ECO_ORGAN_WOOD)
					continue;
				struct gen_v3 q[3], at = gen_v3((double)p[0], (double)p[1], (double)p[2]);
				for (int k = 0; k < 3; k++) {
					const float *c = m.position + 3 * (size_t)m.index[3 * (size_t)u + k];
					q[k] = gen_v3((double)c[0], (double)c[1], (double)c[2]);
				}
				for (int k = 0; k < 3; k++) {
					struct gen_v3 edge = gen_sub(q[(k + 1) % 3], q[k]),
						      to = gen_sub(at, q[k]);
					double along = edge.x * to.x + edge.y * to.y + edge.z * to.z,
					       length = gen_length(edge);
					double share =
						length > 0 ? gen_clamp(along / (length * length), 0, 1) : 0;
					least = fmin(least,
						gen_length(gen_sub(at, gen_mad(q[k], edge, share))));
				}
			}
			loose += begins && least > near;
		}
		if (loose > 0)
			fail_msg("%s: %u of %u pieces of wood hang in the air", habit.name, loose, pieces);
		free(root);
		eco_model_free(&m);
	}
}

/* ---- Bytes ---- */

static uint64_t digest(const struct eco_model *m)
{
	uint64_t hash = 1469598103934665603u;
	const struct {
		const void *at;
		size_t bytes;
	} parts[] = { { m->position, 12 * (size_t)m->vertex_count },
		{ m->uv, m->uv ? 8 * (size_t)m->vertex_count : 0 },
		{ m->images[0].rgba, 4 * (size_t)m->images[0].width * m->images[0].height },
		{ m->index, 12 * (size_t)m->triangle_count }, { m->material, 4 * (size_t)m->triangle_count },
		{ m->materials, m->material_count * sizeof *m->materials } };
	for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
		for (size_t i = 0; i < parts[k].bytes; i++)
			hash = (hash ^ ((const uint8_t *)parts[k].at)[i]) * 1099511628211u;
	return hash;
}

static uint64_t digest_of(const struct eco_library_plant *plant)
{
	struct eco_model model;
	make(&model, plant);
	uint64_t hash = digest(&model);
	eco_model_free(&model);
	return hash;
}

#define GOLDEN 0x00728fa4513b076fu
UNIT_TEST(the_same_plant_is_the_same_bytes)
{
	struct eco_habit habit;
	uint64_t all = 0;
	for (size_t i = 0; eco_library_habit(i, &habit); i++) {
		struct eco_library_plant plant = plant_of(habit.name, habit.height_m, 0), other = plant;
		uint64_t hash = digest_of(&plant);
		all = all * 31 + hash;
		other.individual = 2;
		assert_true(hash == digest_of(&plant));
		assert_true(hash != digest_of(&other));
	}
	/* by every compiler; changes with each row of habits.tsv and leaves.tsv */
	if (all != GOLDEN)
		fail_msg("the plants of all habits have digest 0x%016" PRIx64, all);
}

/* ---- Genera ---- */

static struct eco_model model_of(const char *habit, const char *genus, enum eco_season season)
{
	struct eco_model model;
	struct eco_library_plant plant = plant_of(habit, 10, 0);
	snprintf(plant.genus, sizeof plant.genus, "%s", genus);
	plant.season = season;
	make(&model, &plant);
	return model;
}

UNIT_TEST(seasons_change_leaves_and_blossom)
{
	static const struct {
		const char *habit, *genus;
		enum eco_season season;
		bool leaves, flowers;
	} cases[] = { { "round", "Acer", ECO_SEASON_SUMMER, true, false },
		{ "round", "Acer", ECO_SEASON_WINTER, false, false },
		{ "round", "Prunus", ECO_SEASON_SPRING, true, true },
		{ "round", "Prunus", ECO_SEASON_SUMMER, true, false },
		{ "spruce", "Picea", ECO_SEASON_WINTER, true, false },
		{ "larch", "Larix", ECO_SEASON_WINTER, false, false },
		{ "multi-stemmed", "Hamamelis", ECO_SEASON_WINTER, false, true },
		{ "flower", "Papaver", ECO_SEASON_SPRING, true, true },
		{ "flower", "Papaver", ECO_SEASON_SUMMER, true, true },
		{ "flower", "Papaver", ECO_SEASON_AUTUMN, true, false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_model model = model_of(cases[i].habit, cases[i].genus, cases[i].season);
		if ((area_of(&model, ECO_ORGAN_FOLIAGE) > 0) != cases[i].leaves ||
			(area_of(&model, ECO_ORGAN_FLOWER) > 0) != cases[i].flowers)
			fail_msg("%s in %s: %g m2 of leaves, %g of flowers", cases[i].genus,
				eco_season_names[cases[i].season], area_of(&model, ECO_ORGAN_FOLIAGE),
				area_of(&model, ECO_ORGAN_FLOWER));
		eco_model_free(&model);
	}
}

/* A tree in winter is its wood in summer. */
UNIT_TEST(wood_is_the_same_in_all_seasons)
{
	uint32_t wood[ECO_SEASON_COUNT] = { 0 };
	for (int season = 0; season < ECO_SEASON_COUNT; season++) {
		struct eco_model model = model_of("oval", "Fagus", (enum eco_season)season);
		for (uint32_t t = 0; t < model.triangle_count; t++)
			wood[season] += model.organ[t] == ECO_ORGAN_WOOD;
		eco_model_free(&model);
		assert_true(wood[season] > 3000 && wood[season] <= wood[0] + wood[0] / 100 && wood[season] >= wood[0] - wood[0] / 100);
	}
}

UNIT_TEST(a_genus_has_its_habit)
{
	uint32_t count;
	const char *const (*cases)[2] = cases_read("tests/import/cases/habits.tsv", sizeof *cases, &count);
	for (size_t i = 0; i < count; i++) {
		struct eco_flora flora = eco_flora_of(cases[i][0], NULL);
		assert_string_equal(eco_library_habit_of(&flora), cases[i][1]);
		const char *taxon = eco_library_taxon_of(&flora);
		assert_int_equal(strncmp(taxon, flora.genus ? flora.genus : "", strlen(taxon) ? strcspn(taxon, " ") : 1), 0);
		assert_true(!strchr(taxon, ' ') || strcmp(strchr(taxon, ' ') + 1, flora.epithet) == 0);
	}
}

/* A tall young pine is an old one: bare below. A young palm has no stem. */
UNIT_TEST(a_habit_grows_older)
{
	struct eco_library_plant young = plant_of("pine young", 8, 4), old = plant_of("pine young", 20, 4);
	assert_true(lowest_leaf(&young) < 0.12 && lowest_leaf(&old) > 0.3);
	struct eco_library_plant palm = plant_of("feather palm", 1, 0), grown = plant_of("feather palm", 9, 0);
	assert_true(lowest_leaf(&palm) < 0.3 && lowest_leaf(&grown) > 0.4);
}

/* ---- What is no plant ---- */

UNIT_TEST(what_is_no_plant_is_an_error)
{
	struct eco_model model;
	struct eco_library_plant plant = plant_of("tree", 10, 0);
	assert_code(eco_library_make(&model, &plant, &cause), ECO_BAD_INPUT, "weeping");
	assert_code(eco_library_make(&model, &plant, &cause), ECO_BAD_INPUT, "crop rows");
	static const double bad[] = { 0, -1, 1e9, NAN, INFINITY, 0.001 };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		plant = plant_of("round", bad[i], 0);
		assert_code(eco_library_make(&model, &plant, &cause), ECO_BAD_INPUT, "m high");
		plant = plant_of("round", 10, bad[i]);
		if (bad[i] != 0)
			assert_code(eco_library_make(&model, &plant, &cause), ECO_BAD_INPUT, "crown");
	}
	plant = plant_of("round", 10, 0);
	plant.individual = 17;
	assert_code(eco_library_make(&model, &plant, &cause), ECO_BAD_INPUT, "individual");
	plant.individual = 1;
	plant.season = (enum eco_season)9;
	assert_code(eco_library_make(&model, &plant, &cause), ECO_BAD_INPUT, "season");
}

UNIT_MAIN(NULL, NULL)
