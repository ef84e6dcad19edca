/* Standing places of plants: tubes, boxes and cards, each with the oddity that its name says. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/model_try.h"

#include "ecofiles/format/pack.h"

static char text[200000];
static size_t used;
static int vertices;

static void put(const char *format, ...)
{
	va_list values;
	va_start(values, format);
	used += (size_t)vsnprintf(text + used, sizeof text - used, format, values);
	va_end(values);
}

/* A face of the last `count` vertices. */
static void put_face(int count)
{
	vertices += count;
	put("f");
	for (int i = count; i > 0; i--)
		put(" %d", vertices - i + 1);
	put("\n");
}

/* A tube of `sides` between two points (z up), open at both ends. */
static void tube(double x0, double y0, double z0, double x1, double y1, double z1, double radius, int sides)
{
	for (int i = 0; i < 2 * sides; i++) {
		double angle = 6.283185307179586 * (i % sides) / sides;
		put("v %.7f %.7f %.7f\n", (i < sides ? x0 : x1) + radius * cos(angle),
			(i < sides ? y0 : y1) + radius * sin(angle), i < sides ? z0 : z1);
	}
	for (int i = 0; i < sides; i++)
		put("f %d %d %d %d\n", vertices + i + 1, vertices + (i + 1) % sides + 1,
			vertices + (i + 1) % sides + 1 + sides, vertices + i + 1 + sides);
	vertices += 2 * sides;
}

/* A crown of leaves, which are square cards. */
static void crown(double x, double y, double z, double radius)
{
	for (int i = 0; i < 100; i++) {
		double at[3] = { x + radius * cos(i * 2.4) * (i % 10) / 10, y + radius * sin(i * 2.4) * (i % 10) / 10,
			z + radius * (i / 10 - 5) / 6 };
		put("v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\n", at[0] - 0.15, at[1], at[2], at[0], at[1],
			at[2] - 0.15, at[0] + 0.15, at[1], at[2], at[0], at[1], at[2] + 0.15);
		put_face(4);
	}
}

/* Pieces parted by ";": "t x0 y0 z0 x1 y1 z1 radius sides", "c x y z radius" or lines of the file. */
static void plant_of(const char *pieces)
{
	char all[1000], *rest = all;
	double v[8];
	used = 0;
	vertices = 0;
	snprintf(all, sizeof all, "%s", pieces);
	for (char *one; (one = strsep(&rest, ";"));)
		if (sscanf(one, "t %lf %lf %lf %lf %lf %lf %lf %lf", &v[0], &v[1], &v[2], &v[3], &v[4], &v[5], &v[6],
				&v[7]) == 8)
			tube(v[0], v[1], v[2], v[3], v[4], v[5], v[6], (int)v[7]);
		else if (sscanf(one, "c %lf %lf %lf %lf", &v[0], &v[1], &v[2], &v[3]) == 4)
			crown(v[0], v[1], v[2], v[3]);
		else
			put("%s\n", one);
}

/* Beside the keys of a model: "stands=x,y,z,most": its foot is that near in x and y, and at z. */
static void tell(const char *key, uint32_t number, const char *wanted, char *to, size_t size)
{
	double at[4] = { 0 };
	if (strcmp(key, "stands") != 0) {
		model_told(key, number, wanted, to, size);
		return;
	}
	sscanf(wanted, "%lf,%lf,%lf,%lf", &at[0], &at[1], &at[2], &at[3]);
	if (close_to(m.foot[0], at[0], at[3]) && close_to(m.foot[1], at[1], at[3]) && close_to(m.foot[2], at[2], 1e-5))
		snprintf(to, size, "%s", wanted);
	else
		snprintf(to, size, "%g %g %g", m.foot[0], m.foot[1], m.foot[2]);
}

static const struct eco_part_rule thin = { .kind = ECO_PART_NAME, .name = "thin", .is = ECO_ORGAN_WOOD };
#define STEM_BESIDE "o thick;t 0 0 .2 0 0 9 1 8;o thin;t 6 0 0 6 0 9 .05 8"

static const struct { const char *name, *pieces, *wanted; const struct eco_part_rule *rule; } plants[] = {
	/* leaning and lopsided */
	{ "a tree off its origin stands on its stem", "t 100 -40 7 101 -40 15 .2 8;c 103 -38 15 3", "stands=100,-40,7,.02", NULL },
	{ "a pot carries its plant", "t 0 0 3 0 0 9 .15 6;t 0 0 0 0 0 3.5 1 12;c .5 0 8 2", "stands=0,0,0,.02", NULL },
	{ "so does a box of four boards", "t 0 0 3 0 0 9 .15 6;c .5 0 8 2;v 1 -1 0;v 1 1 0;v 1 1 3.5;v 1 -1 3.5;v -1 1 0;v -1 1 3.5;"
		"v -1 -1 0;v -1 -1 3.5;f -8 -7 -6 -5;f -7 -4 -3 -6;f -4 -2 -1 -3;f -2 -8 -5 -1", "stands=0,0,0,.02", NULL },
	/* the crown is a hull */
	{ "a trunk in pieces stands on its lowest", "t 2 1 0 2 1 .28 .1 8;t 2 1 .3 2 1 .58 .1 8;t 2 1 .6 2 1 .88 .1 8;"
		"t 2 1 .9 2 1 1.18 .1 8;t 2 1 1.2 2 1 1.48 .1 8;t 2 1 1.5 2 1 1.78 .1 8;t 2 1 1.8 2 1 2.08 .1 8;"
		"t 2 1 2.1 2 1 2.38 .1 8;t 2 1 2.4 2 1 2.68 .1 8;t 2 1 2.7 2 1 2.98 .1 8;t 2 1 2 2 1 8 1.5 16",
		"stands=2,1,0,.02", NULL },
	/* the modeller let the trunk reach 0.6 below the origin, which is where it leaves the ground */
	{ "what is below the file's zero is in the ground", "t 0 0 -.6 0 0 9 .3 8;c 0 0 9 3", "below=.6|stands=0,0,0,.02", NULL },
	{ "but not far below", "t 0 0 -4.5 0 0 4.5 .3 8;c 0 0 4.5 3", "stands=0,0,-4.5,.02", NULL },
	{ "nor beside the origin", "t 30 0 -.6 30 0 9 .3 8;c 30 0 9 3", "stands=30,0,-.6,.02", NULL },
	/* with a tip at its rim */
	{ "a bush that is one hull stands on its lower part", "t 5 5 0 5 5 2 1 12;v 5.95 5 -.05;f 1 2 -1",
		"stands=5,5,-.05,.15", NULL },
	{ "wood of no rule is found by shape", STEM_BESIDE, "stands=0,0,.2,.02", NULL },
	{ "wood by rule is what stands", STEM_BESIDE, "stands=6,0,0,.02", &thin },
};

static void stand(double height_m, const struct eco_part_rule *rule)
{
	import_file(input_text("stand", "plant.obj", text), &(struct eco_model_options){ .up = ECO_UP_Z, .unit_m = 1,
		.height_m = height_m, .rules = rule, .rule_count = rule != NULL });
}

UNIT_TEST(plants_stand_on_their_stems)
{
	for (size_t i = 0; i < sizeof plants / sizeof *plants; i++) {
		print_message("# %s\n", plants[i].name);
		plant_of(plants[i].pieces);
		stand(0, plants[i].rule);
		expect_told(plants[i].wanted, tell);
	}
}

UNIT_TEST(twigs_that_hang_lower_than_the_stem_end_in_the_ground)
{
	plant_of("t 0 0 5 0 0 15 .4 8");
	for (int i = 0; i < 24; i++)
		tube(4 * cos(i * 0.26), 4 * sin(i * 0.26), 4.2 + 0.03 * i, 0.2 * cos(i * 0.26),
			0.2 * sin(i * 0.26), 14, 0.02, 4);
	crown(0, 0, 13, 4);
	stand(0, NULL);
	expect_told("below=.8|stands=0,0,5,.02", tell);
	stand(20, NULL);                                 /* the height is what shows */
	assert_true(close_to(m.scale, 20 / (eco_model_height(&m) / m.scale), 1e-6)
		&& close_to(eco_model_height(&m), 20, 1e-4));
}

/* A tower of 90 by 5 units that lies along x, on a level sheet, with a coarser level: 90 m, y up, nothing left out. */
UNIT_TEST(objects_stand_as_their_files_say)
{
	used = 0;
	vertices = 0;
	put("o ground\nv -50 0 -50\nv 150 0 -50\nv 150 0 50\nv -50 0 50\n");
	put_face(4);
	put("o tower_LOD0\nv 10 0 0\nv 100 0 0\nv 100 5 0\nv 10 5 0\n");
	put_face(4);
	put("o tower_LOD1\nv 10 0 2\nv 100 0 2\nv 100 5 2\n");
	put_face(3);
	const char *path = input_text("stand", "tower.obj", text);
	import_file(path, &(struct eco_model_options){ .object = true });
	assert_true(m.object);
	assert_int_equal(m.triangle_count, 5);
	assert_true(m.scale == 1 && m.source.up == ECO_UP_Y);
	assert_non_null(strstr(import_said, "taken for metres"));
	assert_true(has_place(100, 0, 5) && has_place(10, -2, 0) && has_place(150, -50, 0));
	import_file(path, &(struct eco_model_options){ .object = true, .unit_m = 0.3048, .up = ECO_UP_Z });
	assert_true(has_place(30.48, 1.524, 0));
	/* a point of the file, in its units */
	import_file(path, &(struct eco_model_options){ .object = true, .unit_m = 0.5, .up = ECO_UP_Z, .origin = { 90, 5, -50 } });
	assert_true(has_place(5, 0, 25) && has_place(-40, -2.5, 25));
	import_file(path, &(struct eco_model_options){ .up = ECO_UP_Z });
	assert_false(m.object);
	assert_true(m.triangle_count < 5);
}
