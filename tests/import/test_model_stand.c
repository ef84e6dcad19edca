/* Standing places of plants: tubes, boxes and cards, each with the oddity that its name says. */
#include "ecofiles/import/model/model_import.h"
#include "tests/support/model_try.h"

#include "ecofiles/format/pack.h"

static char text[200000];
static size_t used;
static int vertices;

static void begin(void)
{
	used = 0;
	vertices = 0;
}

/* A tube of `sides` between two points (z up), open at both ends. */
static void tube(double x0, double y0, double z0, double x1, double y1, double z1, double radius, int sides)
{
	for (int i = 0; i < 2 * sides; i++) {
		double angle = 6.283185307179586 * (i % sides) / sides;
		used += (size_t)snprintf(text + used, sizeof text - used, "v %.7f %.7f %.7f\n",
			(i < sides ? x0 : x1) + radius * cos(angle),
			(i < sides ? y0 : y1) + radius * sin(angle), i < sides ? z0 : z1);
	}
	for (int i = 0; i < sides; i++)
		used += (size_t)snprintf(text + used, sizeof text - used, "f %d %d %d %d\n", vertices + i + 1,
			vertices + (i + 1) % sides + 1, vertices + (i + 1) % sides + 1 + sides,
			vertices + i + 1 + sides);
	vertices += 2 * sides;
}

/* A leaf: a square card around a point. */
static void leaf(double x, double y, double z, double size)
{
	used += (size_t)snprintf(text + used, sizeof text - used,
		"v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf %d %d %d %d\n", x - size / 2, y, z, x, y,
		z - size / 2, x + size / 2, y, z, x, y, z + size / 2, vertices + 1, vertices + 2,
		vertices + 3, vertices + 4);
	vertices += 4;
}

/* A crown of leaves around (0, 0, z). */
static void crown(double x, double y, double z, double radius)
{
	for (int i = 0; i < 100; i++)
		leaf(x + radius * cos(i * 2.4) * (i % 10) / 10, y + radius * sin(i * 2.4) * (i % 10) / 10,
			z + radius * (i / 10 - 5) / 6, 0.3);
}

static void stand(double height_m)
{
	import_file(input_text("stand", "plant.obj", text),
		&(struct eco_model_options){ .up = ECO_UP_Z, .unit_m = 1, .height_m = height_m });
}

static void expect_foot(double x, double y, double z)
{
	if (!close_to(m.foot[0], x, 0.02) || !close_to(m.foot[1], y, 0.02)
			|| !close_to(m.foot[2], z, 1e-5))
		fail_msg("the foot is at %g %g %g, not %g %g %g", m.foot[0], m.foot[1], m.foot[2], x, y,
			z);
}

UNIT_TEST(a_tree_off_its_origin_stands_on_its_stem)
{
	begin();
	tube(100, -40, 7, 101, -40, 15, 0.2, 8);             /* leaning */
	crown(103, -38, 15, 3);                              /* and lopsided */
	stand(0);
	expect_foot(100, -40, 7);
}

UNIT_TEST(twigs_that_hang_lower_than_the_stem_end_in_the_ground)
{
	begin();
	tube(0, 0, 5, 0, 0, 15, 0.4, 8);
	for (int i = 0; i < 24; i++)
		tube(4 * cos(i * 0.26), 4 * sin(i * 0.26), 4.2 + 0.03 * i, 0.2 * cos(i * 0.26),
			0.2 * sin(i * 0.26), 14, 0.02, 4);
	crown(0, 0, 13, 4);
	stand(0);
	assert_true(close_to(m.source.below, 0.8, 1e-5));
	expect_foot(0, 0, 5);
	stand(20);                                       /* the height is what shows */
	assert_true(close_to(m.scale, 20 / (eco_model_height(&m) / m.scale), 1e-6)
		&& close_to(eco_model_height(&m), 20, 1e-4));
}

UNIT_TEST(a_pot_carries_its_plant)
{
	for (int walls = 0; walls < 2; walls++) {
		begin();
		tube(0, 0, 3, 0, 0, 9, 0.15, 6);
		if (walls == 0)
			tube(0, 0, 0, 0, 0, 3.5, 1, 12);
		for (int side = 0; side < 4 && walls == 1; side++) {    /* a box of four boards */
			double c = side % 2 == 0 ? (side == 0 ? 1 : -1) : 0,
				s = side % 2 == 1 ? (side == 1 ? 1 : -1) : 0;

			used += (size_t)snprintf(text + used, sizeof text - used,
				"v %g %g 0\nv %g %g 0\nv %g %g 3.5\nv %g %g 3.5\nf %d %d %d %d\n", c - s,
				s + c, c + s, s - c, c + s, s - c, c - s, s + c, vertices + 1, vertices + 2,
				vertices + 3, vertices + 4);
			vertices += 4;
		}
		crown(0.5, 0, 8, 2);
		stand(0);
		expect_foot(0, 0, 0);
	}
}

UNIT_TEST(a_trunk_in_pieces_below_a_hull_stands_on_its_lowest)
{
	begin();
	for (int i = 0; i < 10; i++)
		tube(2, 1, i * 0.3, 2, 1, i * 0.3 + 0.28, 0.1, 8);
	tube(2, 1, 2, 2, 1, 8, 1.5, 16);                     /* the crown as a hull */
	stand(0);
	expect_foot(2, 1, 0);
}

/* Its modeller let the trunk reach 0.6 below the origin, which is where it leaves the ground. */
UNIT_TEST(what_is_below_the_files_zero_is_in_the_ground)
{
	begin();
	tube(0, 0, -0.6, 0, 0, 9, 0.3, 8);
	crown(0, 0, 9, 3);
	stand(0);
	assert_true(close_to(m.source.below, 0.6, 1e-5));
	expect_foot(0, 0, 0);
	begin();                                             /* not where the origin is anywhere else */
	tube(0, 0, -4.5, 0, 0, 4.5, 0.3, 8);
	crown(0, 0, 4.5, 3);
	stand(0);
	expect_foot(0, 0, -4.5);
	begin();
	tube(30, 0, -0.6, 30, 0, 9, 0.3, 8);
	crown(30, 0, 9, 3);
	stand(0);
	expect_foot(30, 0, -0.6);
}

UNIT_TEST(a_bush_that_is_one_hull_stands_on_its_lower_part)
{
	begin();
	tube(5, 5, 0, 5, 5, 2, 1, 12);
	used += (size_t)snprintf(text + used, sizeof text - used, "v 5.95 5 -0.05\nf 1 2 %d\n", ++vertices);
		/* a tip at its rim */
	stand(0);
	assert_true(close_to(m.foot[0], 5, 0.15) && close_to(m.foot[1], 5, 0.15)
		&& close_to(m.foot[2], -0.05, 1e-6));
}

/* A part that rules call wood is the stem, whatever it looks like. */
UNIT_TEST(wood_by_rule_is_what_stands)
{
	const struct eco_part_rule rule = { .kind = ECO_PART_NAME, .name = (char *)"thin",
		.is = ECO_ORGAN_WOOD };
	const char *path;
	begin();
	used += (size_t)snprintf(text, sizeof text, "o thick\n");
	tube(0, 0, 0.2, 0, 0, 9, 1, 8);
	used += (size_t)snprintf(text + used, sizeof text - used, "o thin\n");
	tube(6, 0, 0, 6, 0, 9, 0.05, 8);
	path = input_text("stand", "rule.obj", text);
	import_file(path, &(struct eco_model_options){ .up = ECO_UP_Z, .unit_m = 1 });
	assert_true(close_to(m.foot[0], 0, 0.02));
	import_file(path, &(struct eco_model_options){ .up = ECO_UP_Z, .unit_m = 1, .rules = &rule,
		.rule_count = 1 });
	expect_foot(6, 0, 0);
}
