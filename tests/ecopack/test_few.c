/* Few models for many: how alike they look, which are chosen, and that a scene keeps its plants and their
 * heights. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/few.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/progress.h"
#include "lod/eye.h"
#include "tests/support/plant_models.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

#define MANY 60u

static uint64_t state = 7;
static double random_unit(void) { return lcg_bits(&state) / 2147483648.0; }

/* ---- Choosing ---- */

/* Points in the plane in three groups far apart, in turn. */
static void make_groups(double at[][2], double *difference, uint32_t count)
{
	static const double middle[3][2] = { { 0.1, 0.1 }, { 0.9, 0.2 }, { 0.4, 0.8 } };
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 2; k++)
			at[i][k] = middle[i % 3][k] + 0.1 * (random_unit() - 0.5);
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = 0; k < count; k++)
			difference[i * count + k] = hypot(at[i][0] - at[k][0], at[i][1] - at[k][1]);
}

static double cost(const double *difference, const double *weight, uint32_t count, const uint32_t *stand_in)
{
	double sum = 0;
	for (uint32_t i = 0; i < count; i++)
		sum += weight[i] * difference[i * count + stand_in[i]];
	return sum;
}

static uint32_t kept(const uint32_t *stand_in, uint32_t count)
{
	uint32_t sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		assert_true(stand_in[i] < count && stand_in[stand_in[i]] == stand_in[i]);
		sum += stand_in[i] == i;
	}
	return sum;
}

UNIT_TEST(three_groups_have_three_that_stand_for_them)
{
	static double at[MANY][2], difference[MANY * MANY], weight[MANY];
	uint32_t stand_in[MANY], again[MANY];
	make_groups(at, difference, MANY);
	for (uint32_t i = 0; i < MANY; i++)
		weight[i] = 1 + random_unit();
	assert_int_equal(few_choose(difference, weight, MANY, 3, stand_in, NULL), ECO_OK);
	assert_int_equal(few_choose(difference, weight, MANY, 3, again, NULL), ECO_OK);
	assert_memory_equal(stand_in, again, sizeof again);
	assert_int_equal(kept(stand_in, MANY), 3);
	for (uint32_t i = 0; i < MANY; i++)
		assert_int_equal(stand_in[i] % 3, i % 3);
}

UNIT_TEST(weights_decide_who_is_kept)
{
	static double at[9][2], difference[81], weight[9];
	uint32_t stand_in[9];
	make_groups(at, difference, 9);
	for (int heavy = 0; heavy < 3; heavy++) {
		for (int i = 0; i < 9; i++)
			weight[i] = i % 3 == heavy ? 100 : 1;
		few_choose(difference, weight, 9, 1, stand_in, NULL);
		assert_int_equal(stand_in[0] % 3, heavy);
		/* within the group, too */
		weight[heavy + 3] = 10000;
		few_choose(difference, weight, 9, 1, stand_in, NULL);
		assert_int_equal(stand_in[0], heavy + 3);
	}
	for (int i = 0; i < 9; i++)
		weight[i] = i < 2;
	few_choose(difference, weight, 9, 5, stand_in, NULL);
	assert_int_equal(kept(stand_in, 9), 2);          /* the others stand nowhere */
	memset(weight, 0, sizeof weight);
	few_choose(difference, weight, 9, 5, stand_in, NULL);
	assert_int_equal(kept(stand_in, 9), 1);
}

/* The least cost over all choices of `keep` of the models from `first` on. */
static double best_of_all(const double *difference, const double *weight, uint32_t count, uint32_t keep,
	uint32_t first, uint32_t *chosen, uint32_t have)
{
	double least = INFINITY;
	if (have == keep) {
		double sum = 0;
		for (uint32_t i = 0; i < count; i++) {
			double nearest = INFINITY;
			for (uint32_t k = 0; k < keep; k++)
				nearest = fmin(nearest, difference[i * count + chosen[k]]);
			sum += weight[i] * nearest;
		}
		return sum;
	}
	for (uint32_t i = first; i < count; i++) {
		chosen[have] = i;
		least = fmin(least,
			best_of_all(difference, weight, count, keep, i + 1, chosen, have + 1));
	}
	return least;
}

UNIT_TEST(the_choice_is_the_best_of_all_or_near_it)
{
	uint32_t best = 0;
	for (int n = 0; n < 200; n++) {
		double at[10][2], difference[100], weight[10];
		uint32_t stand_in[10], chosen[4], count = 6 + lcg_bits(&state) % 5,
			keep = 1 + lcg_bits(&state) % 4;
		for (uint32_t i = 0; i < count; i++) {
			weight[i] = random_unit();
			at[i][0] = random_unit();
			at[i][1] = random_unit();
		}
		for (uint32_t i = 0; i < count; i++)
			for (uint32_t k = 0; k < count; k++)
				difference[i * count + k] = hypot(at[i][0] - at[k][0], at[i][1] - at[k][1]);
		few_choose(difference, weight, count, keep, stand_in, NULL);
		assert_true(kept(stand_in, count) <= keep);
		double least = best_of_all(difference, weight, count, keep, 0, chosen, 0),
			own = cost(difference, weight, count, stand_in);
		assert_true(own >= least - 1e-12 && own < 1.35 * least + 1e-12);
		best += own < least + 1e-12;
	}
	assert_true(best > 170);
}

/* ---- Looks ---- */

/* A stem, and blades in a cone or a ball. */
static void grow(struct soup *soup, bool cone, double wide, const uint8_t rgb[3])
{
	soup_begin(soup);
	uint32_t bark = soup_material(soup, 90, 70, 50, ECO_NONE, false);
	uint32_t green = soup_material(soup, rgb[0], rgb[1], rgb[2], ECO_NONE, false);
	soup_tube(soup, bark, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 9 }, 0.2, 0.05, 6, 4);
	for (int i = 0; i < 400; i++) {
		double z = 1 + 9 * soup_random(soup, 0, 1), x = (z - 5.5) / 4.5,
			r = wide * (cone ? (10 - z) / 9 : sqrt(fmax(0, 1 - x * x))), turn = 2.4 * i;
		struct lod_v3 at = { r * cos(turn), r * sin(turn), z };
		soup_leaf(soup, green, at, 0.4, 0.2);
	}
}

static struct few_look look_of(bool cone, double wide, const uint8_t rgb[3])
{
	struct soup soup;
	struct few_look look;
	struct eco_error error = { 0 };
	grow(&soup, cone, wide, rgb);
	assert_ok(few_look(&look, &soup.model, &error), error);
	soup_free(&soup);
	return look;
}

UNIT_TEST(looks_differ_by_form_width_and_colour)
{
	static const uint8_t green[3] = { 60, 120, 40 }, greener[3] = { 66, 128, 44 },
		red[3] = { 180, 40, 40 };
	struct few_look ball = look_of(false, 3, green), near_it = look_of(false, 3.2, greener),
		cone = look_of(true, 3, green), narrow = look_of(false, 1, green),
		autumn = look_of(false, 3, red);
	assert_true(fabs(ball.height_m - 10) < 0.6 && ball.reach_m > 2.5 && ball.reach_m < 3.6);
	assert_true(few_difference(&ball, &ball) == 0);
	const struct few_look *others[] = { &cone, &narrow, &autumn };
	double alike = few_difference(&ball, &near_it);
	assert_true(alike > 0 && alike < 0.2);
	for (int i = 0; i < 3; i++) {
		double d = few_difference(&ball, others[i]);
		assert_true(d > 2 * alike && d > 0.2 && d <= 1);
		assert_true(d == few_difference(others[i], &ball));
	}
}

/* ---- Scenes ---- */

/* Blades around a stem: in turn pillars, globes and cones, of six sizes. */
static void write_kinds(void)
{
	for (int n = 0; n < 6; n++) {
		char name[20];
		snprintf(name, sizeof name, "k%d.obj", n);
		FILE *file = open_text(name);
		double h = 4 + n, w = n % 3 == 0 ? 0.08 * h : 0.4 * h;
		for (int i = 0; i < 16; i++) {
			double z = h * (i + 0.5) / 17, t = z / h, r = n % 3 == 2 ? w * (1 - t)
				: n % 3 == 1 ? 2 * w * sqrt(t * (1 - t)) : w, x = r * cos(2.4 * i),
				y = r * sin(2.4 * i), s = 0.03 * h;
			fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\n", x, z, y, x + s, z, y, x, z + s,
				y + s);
			fprintf(file, "f %d %d %d\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
		}
		assert_int_equal(fclose(file), 0);
	}
}

#define PLANTS 24

/* Half by height, half by scale. */
static void write_stand(const char *name, const char *models)
{
	FILE *file = open_text(name);
	fprintf(file, "{%s\"plants\": {", models);
	for (int n = 0; n < 6; n++)
		fprintf(file, "%s\"k%d\": {\"model\": \"k%d.obj\", \"up\": \"y\", \"unit\": \"m\"}",
			n ? ", " : "", n, n);
	fputs("}, \"instances\": [", file);
	for (int i = 0; i < PLANTS; i++)
		fprintf(file, "%s{\"plant\": \"k%d\", \"at\": [%d, 0], \"%s\": %g}", i ? ", " : "", i % 6,
			10 * i, i % 2 ? "height_m" : "scale", i % 2 ? 3 + 0.5 * i : 0.5 + 0.05 * i);
	fputs("]}\n", file);
	assert_int_equal(fclose(file), 0);
}

static struct eco_pack *made(const char *scene, const char *to, uint32_t models)
{
	struct eco_error error = { 0 };
	struct eco_pack *pack = NULL;
	struct make_options options = { .scene = in_root(scene), .pack = in_root(to),
		.order = LOD_ORDER_COMBINED, .draft = true, .models = models };
	assert_ok(make_pack(&options, &error), error);
	assert_ok(eco_pack_open(&pack, in_root(to), &error), error);
	return pack;
}

/* Height and kind of the plant at x = 10 i, all of which must be there. */
static void standing(const struct eco_scene *s, double height[PLANTS], uint32_t plant[PLANTS])
{
	static const struct eco_placement here = { .scale = 1 };
	uint32_t count = 0;
	memset(height, 0, PLANTS * sizeof *height);
	for (uint32_t g = 0; g < s->group_count; g++)
		for (uint32_t i = 0; i < s->groups[g].count; i++, count++) {
			struct eco_place stored = eco_place_read(s, s->groups[g].place_first + i);
			struct lod_place place;
			lod_place_instance(&place, &here, &s->lists[s->groups[g].list], &stored);
			int at = (int)floor(place.at[0] / 10 + 0.5);
			assert_true(at >= 0 && at < PLANTS && height[at] == 0);
			height[at] = stored.scale / 65536.0 * (double)s->plants[s->groups[g].plant].height_m;
			plant[at] = s->groups[g].plant;
		}
	assert_int_equal(count, PLANTS);
}

UNIT_TEST(every_plant_keeps_its_place_and_its_height)
{
	double all[PLANTS], few[PLANTS];
	uint32_t kind[PLANTS], stand_in[PLANTS];
	char text[20000] = { 0 };
	write_stand("all.json", "");
	write_stand("three.json", "\"models\": 3, ");
	struct eco_pack *pack = made("all.json", "all.eco", 6), *other = made("three.json", "few.eco", 0);
	assert_int_equal(pack->scene.plant_count, 6);    /* 6 of 6 may be: all are kept */
	assert_int_equal(other->scene.plant_count, 3);
	standing(&pack->scene, all, kind);
	standing(&other->scene, few, stand_in);
	for (int i = 0; i < PLANTS; i++) {
		assert_true(fabs(few[i] / all[i] - 1) < 1e-3);
		assert_int_equal(stand_in[i], stand_in[i % 3]);          /* pillars for pillars */
		assert_true(i % 3 == 0 || stand_in[i] != stand_in[0]);
	}
	eco_pack_close(pack);
	eco_pack_close(other);
	FILE *out = tmpfile();
	assert_int_equal(inspect_info(in_root("few.eco"), false, out, NULL), ECO_OK);
	rewind(out);
	assert_true(fread(text, 1, sizeof text - 1, out) > 0);
	assert_non_null(strstr(text, "stands for 2 models, 8 plants"));
	fclose(out);
}

UNIT_TEST(the_options_win_over_the_scene)
{
	write_stand("three.json", "\"models\": 3, ");
	struct eco_pack *pack = made("three.json", "one.eco", 1);
	assert_int_equal(pack->scene.plant_count, 1);
	eco_pack_close(pack);
}

static int prepare(void **unused)
{
	scratch_open("few");
	main_progress_quiet(true);
	write_kinds();
	return 0;
}

static int clean_up(void **unused)
{
	scratch_remove(scratch_root);
	return 0;
}

int main(void) { return unit_tests_run(prepare, clean_up); }
