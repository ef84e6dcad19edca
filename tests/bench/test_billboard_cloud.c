/* Billboard clouds: the skeleton, generators and quality by themselves, then whole clouds. Longer than 600
 * lines: all of them are tried on the same few trees. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/raster/raster.h"
#include "tests/bench/baseline/billboard_state.h"
#include "tests/support/foliage_random.h"
#include "tests/support/unit_test.h"

#define MOST 4096u                   /* triangles */

static float place[9 * MOST];
static uint32_t corner_of[3 * MOST], material_of[MOST];
static struct eco_model model;
static struct eco_error error;
static struct lod_arena arena;
static struct lod_billboard_plant *plant;
static struct lod_billboard_cloud cloud;

static const struct lod_v3 X = { 1, 0, 0 }, Y = { 0, 1, 0 }, Z = { 0, 0, 1 }, O = { 0, 0, 0 };

static void none(void)
{
	model = (struct eco_model){ .position = place, .index = corner_of, .material = material_of };
}

static void triangle(struct lod_v3 a, struct lod_v3 b, struct lod_v3 c)
{
	const struct lod_v3 p[3] = { a, b, c };
	assert_true(model.triangle_count < MOST);
	for (uint32_t k = 0; k < 3; k++) {
		float *to = place + 3 * model.vertex_count;
		to[0] = (float)p[k].x, to[1] = (float)p[k].y, to[2] = (float)p[k].z;
		corner_of[3 * model.triangle_count + k] = model.vertex_count++;
	}
	material_of[model.triangle_count++] = 0;
}

/* A rectangle: a corner and two edges. */
static void leaf(struct lod_v3 at, struct lod_v3 along, struct lod_v3 across)
{
	struct lod_v3 b = lod_v3_add(at, along), c = lod_v3_add(b, across), d = lod_v3_add(at, across);
	triangle(at, b, c);
	triangle(at, c, d);
}

/* A tube of four sides; its rings lie `step` apart. */
static void tube(struct lod_v3 from, struct lod_v3 to, double radius, double step)
{
	struct lod_v3 along = lod_v3_sub(to, from), u = lod_v3_unit(lod_v3_cross(along, fabs(along.x)
		> fabs(along.z) ? Z : X)), v = lod_v3_unit(lod_v3_cross(along, u));
	const struct lod_v3 side[4] = { lod_v3_scale(u, radius), lod_v3_scale(v, radius),
		lod_v3_scale(u, -radius), lod_v3_scale(v, -radius) };
	int rings = (int)(lod_v3_length(along) / step + 0.5);
	for (int i = 0; i < rings; i++)
		for (int k = 0; k < 4; k++) {
			struct lod_v3 low = lod_v3_mix(from, to, (double)i / rings),
				high = lod_v3_mix(from, to, (i + 1.0) / rings);
			struct lod_v3 a = lod_v3_add(low, side[k]), b = lod_v3_add(low, side[(k + 1) % 4]),
				c = lod_v3_add(high, side[(k + 1) % 4]), d = lod_v3_add(high, side[k]);
			triangle(a, b, c);
			triangle(a, c, d);
		}
}

static struct lod_v3 dice3(uint64_t *seed)
{
	double x = foliage_dice(seed), y = foliage_dice(seed);
	return (struct lod_v3){ x, y, foliage_dice(seed) };
}

/* A stem with boughs, and leaves along them. */
static void grow_tree(uint64_t seed, uint32_t boughs, uint32_t leaves)
{
	none();
	tube(O, (struct lod_v3){ 0, 0, 4 }, 0.1, 0.2);
	for (uint32_t i = 0; i < boughs; i++) {
		struct lod_v3 from = { 0.1, 0, 1 + 3.0 * i / boughs },
			to = lod_v3_add(from, lod_v3_scale(lod_v3_unit(dice3(&seed)), 1.5));
		tube(from, to, 0.03, 0.1);
		for (uint32_t k = 0; k < leaves; k++) {
			struct lod_v3 at = lod_v3_mix(from, to, (k + 1.0) / leaves), along = dice3(&seed);
			struct lod_v3 across = lod_v3_cross(along, dice3(&seed));
			at.z += 0.03;
			leaf(at, lod_v3_scale(lod_v3_unit(along), 0.2),
				lod_v3_scale(lod_v3_unit(across), 0.1));
		}
	}
}

static void open_plant(const struct lod_billboard_options *options)
{
	assert_ok(lod_billboard_plant_open(&plant, &model, options, &error), error);
}

static void make(const struct lod_billboard_options *options)
{
	open_plant(options);
	assert_ok(lod_billboard_cloud_make(&cloud, plant, options, &error), error);
}

static int tidy(void **unit_state)
{
	lod_billboard_cloud_free(&cloud);
	lod_billboard_plant_close(plant);
	lod_arena_free(&arena);
	plant = NULL;
	return 0;
}
#define CLOUD_TEST(name) UNIT_TEST_BETWEEN(name, NULL, tidy)

static bool near(double a, double b) { return fabs(a - b) < 1e-6; }

/* ---- Quality ---- */

static struct billboard_face face_of(struct lod_v3 a, struct lod_v3 b, struct lod_v3 c)
{
	struct lod_v3 normal = lod_v3_scale(lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(c, a)), 0.5);
	return (struct billboard_face){ { a, b, c }, lod_v3_unit(normal), lod_v3_length(normal), 0 };
}

static const struct billboard_quad flat = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, 1, 2 };

UNIT_TEST(distance_is_to_the_rectangle_and_not_to_its_plane)
{
	assert_true(near(billboard_quad_distance(&flat, (struct lod_v3){ 0.5, -1.5, 0.3 }), 0.3));
	assert_true(near(billboard_quad_distance(&flat, (struct lod_v3){ 4, 0, 0 }), 3));
	assert_true(near(billboard_quad_distance(&flat, (struct lod_v3){ 0, -6, 3 }), 5));
}

UNIT_TEST(a_face_is_valid_if_every_corner_is_within_epsilon)
{
	const struct lod_v3 corner[3] = { O, X, { 0, 1, 0.2 } };
	struct billboard_validity v;
	struct billboard_face face;
	for (int k = 0; k < 3; k++) {        /* whichever corner it is */
		face = face_of(corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]);
		billboard_face_judge(&v, &face, &flat, 1, 0.2 + 1e-9);
		assert_true(v.valid && near(v.projected, 0.5));
		billboard_face_judge(&v, &face, &flat, 1, 0.2 - 1e-9);
		assert_true(!v.valid && near(v.projected, 0.5));
	}
	billboard_face_judge(&v, &face, NULL, 0, 9);
	assert_true(!v.valid && near(v.projected, 0));
}

UNIT_TEST(a_face_is_projected_on_the_nearest_billboard)
{
	struct billboard_quad quads[2] = { flat, flat };
	struct billboard_validity v;
	struct billboard_face face = face_of((struct lod_v3){ 0, 0, 1 }, (struct lod_v3){ 1, 0, 1 },
		(struct lod_v3){ 0, 1, 1 });
	quads[1].center.z = 1.5;
	quads[1].normal = (struct lod_v3){ 0, 0.8, 0.6 };
	quads[1].v = (struct lod_v3){ 0, 0.6, -0.8 };
	billboard_face_judge(&v, &face, quads, 2, 9);
	assert_int_equal(v.nearest, 1);
	assert_true(near(v.projected, 0.5 * 0.6));
}

UNIT_TEST(invalid_faces_lower_coverage_and_never_below_nothing)
{
	struct billboard_face faces[3] = { face_of(O, X, Y), face_of(O, X, (struct lod_v3){ 0, 0.5, 0 }),
		face_of((struct lod_v3){ 0, 0, 5 }, (struct lod_v3){ 1, 0, 5 },
		(struct lod_v3){ 0, 0.5, 5 }) };
	const struct billboard_face *list[3] = { &faces[0], &faces[1], &faces[2] };
	struct billboard_coverage c;
	billboard_coverage_of(&c, list, 3, &flat, 1, 1);
	assert_true(near(c.valid, 0.75) && near(c.invalid, 0.25) && near(c.area, 1));
	assert_true(near(billboard_coverage_value(&c), 0.5) && near(c.area_invalid, 0.25));
	assert_true(near(billboard_error(&c, 1), 0.5) && near(billboard_error(&c, 0.5), 0.25));
	billboard_coverage_of(&c, list + 1, 2, &flat, 1, 0);
	c.invalid *= 2;
	assert_true(near(billboard_coverage_value(&c), 0) && near(billboard_error(&c, 1), 1));
}

CLOUD_TEST(density_is_the_sum_of_balls_and_ends_at_the_radius)
{
	const struct lod_v3 at[4] = { { 0, 0, 0 }, { 0.05, 0, 0 }, { 0, 0, 0.1 }, { -0.2, 0, 0 } };
	double density[4];
	assert_int_equal(setjmp(arena.failed), 0);
	billboard_density(density, at, 4, 0.1, &arena);
	double half = (1 - 0.25) * (1 - 0.25);
	assert_true(near(density[0], half) && near(density[1], half));
	assert_true(near(density[2], 0) && near(density[3], 0));
	assert_true(near(billboard_sigma(0, 4), 1) && near(billboard_sigma(1, 4), 0.75));
	assert_true(near(billboard_sigma(5, 4), 0) && near(billboard_sigma(3, 0), 1));
}

/* ---- Generators ---- */

static struct billboard_face fit_faces[256];
static const struct billboard_face *fit_list[256];
static struct billboard_fit_input fit_input;

static void fit_begin(struct lod_v3 connector)
{
	fit_input = (struct billboard_fit_input){ .faces = fit_list, .connector = connector, .sections = 4,
		.most = BILLBOARD_QUADS, .bend = 0.01 };
}

static void fit_leaf(struct lod_v3 a, struct lod_v3 b, struct lod_v3 c)
{
	fit_faces[fit_input.count] = face_of(a, b, c);
	fit_list[fit_input.count] = &fit_faces[fit_input.count];
	fit_input.count++;
}

/* Along x, rising to the height that `rise` says there. */
static void fit_frond(double (*rise)(double x))
{
	fit_begin(O);
	for (int i = 0; i < 32; i++) {
		double x = i / 32.0, end = (i + 1) / 32.0;
		fit_leaf((struct lod_v3){ x, -0.1, rise(x) }, (struct lod_v3){ x, 0.1, rise(x) },
			(struct lod_v3){ end, 0, rise(end) });
	}
}

static double level(double x) { return 0.3 * x; }
static double arch(double x) { return x * (1 - x); }

/* Of all corners; the mean distance goes to *mean unless that is NULL. */
static double worst_distance(const struct billboard_quad *quads, uint32_t count, double *mean)
{
	double worst = 0, sum = 0;
	for (uint32_t i = 0; i < fit_input.count; i++)
		for (int k = 0; k < 3; k++) {
			double best = INFINITY;
			for (uint32_t q = 0; q < count; q++)
				best = fmin(best, billboard_quad_distance(&quads[q], fit_faces[i].corner[k]));
			worst = fmax(worst, best);
			sum += best / (3 * fit_input.count);
		}
	if (mean)
		*mean = sum;
	return worst;
}

UNIT_TEST(a_plane_is_fitted_to_all_corners)
{
	struct billboard_quad quad[BILLBOARD_QUADS];
	fit_frond(level);
	assert_int_equal(billboard_fit(quad, LOD_BILLBOARD_PLANE, &fit_input), 1);
	assert_true(worst_distance(quad, 1, NULL) < 1e-9);
	assert_true(near(fabs(quad[0].normal.y), 0) && near(quad[0].width, sqrt(1.09) / 2));
	assert_true(near(quad[0].height, 0.1));
}

UNIT_TEST(a_cross_holds_the_axis_from_the_connector_to_the_corners)
{
	struct billboard_quad quad[BILLBOARD_QUADS];
	uint64_t seed = 3;
	struct lod_v3 connector = { 0.3, -0.2, 0.1 }, mean = { 0, 0, 0 };
	fit_begin(connector);
	for (int i = 0; i < 50; i++) {
		struct lod_v3 at = lod_v3_add(dice3(&seed), (struct lod_v3){ 2, 1, 2 });
		fit_leaf(at, lod_v3_add(at, X), lod_v3_add(at, Y));
		for (int k = 0; k < 3; k++)
			mean = lod_v3_add(mean, lod_v3_scale(lod_v3_sub(fit_faces[i].corner[k], connector),
				1.0 / 150));
	}
	assert_int_equal(billboard_fit(quad, LOD_BILLBOARD_CROSS, &fit_input), 2);
	assert_true(lod_v3_distance(billboard_axis(&fit_input), lod_v3_unit(mean)) < 1e-9);
	assert_true(near(lod_v3_dot(quad[0].normal, quad[1].normal), 0));
	for (int q = 0; q < 2; q++) {
		struct lod_v3 d = lod_v3_sub(connector, quad[q].center);
		assert_true(near(fabs(lod_v3_dot(quad[q].v, lod_v3_unit(mean))), 1));
		assert_true(near(lod_v3_dot(d, quad[q].normal), 0));
		for (uint32_t i = 0; i < fit_input.count; i++) {     /* the quad is as wide as the part */
			d = lod_v3_sub(fit_faces[i].corner[0], quad[q].center);
			assert_true(fabs(lod_v3_dot(d, quad[q].u)) <= quad[q].width + 1e-9);
			assert_true(fabs(lod_v3_dot(d, quad[q].v)) <= quad[q].height + 1e-9);
		}
	}
}

UNIT_TEST(sections_of_a_strip_are_connected_and_follow_its_bend)
{
	struct billboard_quad quad[BILLBOARD_QUADS], plane[BILLBOARD_QUADS];
	fit_frond(arch);
	fit_input.bend = 1e-6;
	uint32_t count = billboard_fit(quad, LOD_BILLBOARD_STRIP, &fit_input);
	assert_int_equal(count, 4);
	billboard_fit(plane, LOD_BILLBOARD_PLANE, &fit_input);
	double strip_mean, plane_mean;
	assert_true(worst_distance(quad, count, &strip_mean) < 0.6 * worst_distance(plane, 1, &plane_mean));
	assert_true(strip_mean < 0.1 * plane_mean);
	for (uint32_t i = 0; i + 1 < count; i++) {
		const struct billboard_quad *next = &quad[i + 1];
		struct lod_v3 end = lod_v3_add(quad[i].center, lod_v3_scale(quad[i].v, quad[i].height)),
			begin = lod_v3_sub(next->center, lod_v3_scale(next->v, next->height));
		assert_true(lod_v3_distance(end, begin) < 1e-9);
		assert_true(near(lod_v3_dot(quad[i].u, quad[i + 1].u), 1));
	}
}

UNIT_TEST(sections_merge_while_the_bend_stays_small)
{
	struct billboard_quad quad[BILLBOARD_QUADS];
	fit_frond(level);
	assert_int_equal(billboard_fit(quad, LOD_BILLBOARD_STRIP, &fit_input), 1);
	fit_frond(arch);
	uint32_t last = 5;
	for (double bend = 1e-6; bend < 1; bend *= 10) {
		fit_input.bend = bend;
		uint32_t count = billboard_fit(quad, LOD_BILLBOARD_STRIP, &fit_input);
		assert_true(count <= last);
		last = count;
	}
	assert_int_equal(last, 1);
	fit_input.bend = 1e-6;
	fit_input.most = 2;
	assert_int_equal(billboard_fit(quad, LOD_BILLBOARD_STRIP, &fit_input), 2);
}

/* ---- Skeleton ---- */

static struct lod_mesh mesh;
static struct billboard_nodes nodes;
static struct billboard_link links[MOST];
static uint32_t order[MOST];

static void weld(void)
{
	lod_arena_free(&arena);
	assert_int_equal(setjmp(arena.failed), 0);
	lod_weld(&mesh, &model, 16, &arena);
	billboard_attach(&mesh, links, order, &arena);
}

/* The component of the model's triangle. */
static uint32_t component_of(uint32_t source)
{
	for (uint32_t t = 0; t < mesh.triangle_count; t++)
		if (mesh.source[t] == source)
			return mesh.component[t];
	fail();
	return ECO_NONE;
}

/* That bears the component of the model's triangle. */
static uint32_t bearer_of(uint32_t source)
{
	uint32_t parent = links[component_of(source)].parent;
	return parent == ECO_NONE ? ECO_NONE : mesh.component[parent / 3];
}

CLOUD_TEST(a_leaf_hangs_on_its_twig_and_not_on_the_leaf_beside_it)
{
	none();
	tube(O, (struct lod_v3){ 0, 0, 1 }, 0.02, 0.1);
	uint32_t twig = model.triangle_count;
	tube((struct lod_v3){ 0.02, 0, 0.5 }, (struct lod_v3){ 0.6, 0, 0.7 }, 0.01, 0.02);
	uint32_t first = model.triangle_count;
	for (int i = 0; i < 8; i++)
		leaf((struct lod_v3){ 0.1 + 0.06 * i, 0.012, 0.53 + 0.02 * i }, (struct lod_v3){ 0.05, 0, 0 },
			(struct lod_v3){ 0, 0.1, 0 });
	weld();
	assert_int_equal(bearer_of(0), ECO_NONE);
	assert_int_equal(order[0], component_of(0));
	assert_int_equal(bearer_of(twig), component_of(0));
	for (uint32_t i = 0; i < 8; i++)
		assert_int_equal(bearer_of(first + 2 * i), component_of(twig));
	/* neither names nor materials say so */
	for (uint32_t t = 0; t < model.triangle_count; t++)
		material_of[t] = t < twig ? 0 : 7;
	weld();
	assert_int_equal(bearer_of(first), component_of(twig));
}

/* A leaf beside both, which is found first by the other leaf. */
CLOUD_TEST(of_the_equally_near_the_largest_bears)
{
	none();
	tube(O, Z, 0.02, 0.1);
	uint32_t twig = model.triangle_count;
	tube((struct lod_v3){ 0.062, 0, 0.3 }, (struct lod_v3){ 0.462, 0, 0.3 }, 0.002, 0.02);
	uint32_t leaves = model.triangle_count;
	leaf((struct lod_v3){ 0.02, 0.001, 0.3 }, (struct lod_v3){ 0.1, 0, 0 },
		(struct lod_v3){ 0, 0, 0.005 });
	leaf((struct lod_v3){ 0.121, 0.002, 0.3 }, (struct lod_v3){ 0.03, 0.05, 0 },
		(struct lod_v3){ 0, 0.05, 0 });
	weld();
	assert_int_equal(bearer_of(leaves), component_of(0));
	assert_int_equal(bearer_of(twig), component_of(leaves));
	assert_int_equal(bearer_of(leaves + 2), component_of(twig));
}

CLOUD_TEST(a_tube_becomes_a_chain_that_forks_where_it_forks)
{
	uint32_t children[MOST] = { 0 }, tips = 0, forks = 0;
	none();
	tube(O, (struct lod_v3){ 0, 0, 0.5 }, 0.02, 0.05);
	leaf((struct lod_v3){ 0, 0.02, 0.5 }, (struct lod_v3){ 0, -0.04, 0 }, (struct lod_v3){ 0, 0, 0.1 });
	for (int side = 0; side < 2; side++)         /* two ribbons on the same edge */
		for (int i = 0; i < 10; i++) {
			double x = side ? -0.04 * i : 0.04 * i, z = 0.6 + 0.04 * i;
			leaf((struct lod_v3){ x, 0.02, z }, (struct lod_v3){ 0, -0.04, 0 },
				(struct lod_v3){ side ? -0.04 : 0.04, 0, 0.04 });
		}
	weld();
	assert_int_equal(mesh.component_count, 1);
	billboard_nodes_make(&nodes, &mesh, 0.08, &arena);
	for (uint32_t i = 1; i < nodes.count; i++) {
		assert_true(nodes.parent[i] < i);
		children[nodes.parent[i]]++;
	}
	for (uint32_t i = 0; i < nodes.count; i++) {
		tips += children[i] == 0;
		forks += children[i] > 1;
	}
	assert_int_equal(tips, 2);
	assert_int_equal(forks, 1);
	assert_true(nodes.count >= 15 && nodes.count <= 25);
}

CLOUD_TEST(the_tree_is_binary_and_has_every_face_once)
{
	struct billboard_tree tree;
	bool seen[MOST] = { false };
	grow_tree(5, 12, 20);
	weld();
	billboard_nodes_make(&nodes, &mesh, 0.1, &arena);
	billboard_tree_make(&tree, &nodes, &mesh, &arena);
	for (uint32_t i = 0; i < tree.count; i++) {
		uint32_t children = 0;
		for (uint32_t k = i + 1; k < tree.end[i]; k = tree.end[k], children++)
			assert_int_equal(tree.parent[k], i);
		assert_true(children <= 2);
	}
	assert_int_equal(tree.end[0], tree.count);
	assert_int_equal(tree.face_first[tree.count], tree.face_count);
	assert_int_equal(tree.face_count, mesh.triangle_count);
	for (uint32_t f = 0; f < tree.face_count; f++) {
		assert_false(seen[tree.faces[f].triangle]);
		seen[tree.faces[f].triangle] = true;
	}
}

/* ---- Clouds ---- */

static void check_cloud(uint32_t cap)
{
	assert_true(cloud.count <= cap);
	assert_true(cloud.error >= 0 && cloud.error <= 1 + 1e-9);
	assert_true(cloud.invalid >= 0 && cloud.invalid <= 1 + 1e-9);
	uint32_t parts = 0;
	for (int form = 0; form < LOD_BILLBOARD_FORMS; form++)
		parts += cloud.forms[form];
	assert_int_equal(parts, cloud.parts);
	for (uint32_t i = 0; i < cloud.count; i++) {
		const struct lod_billboard *b = &cloud.items[i];
		assert_true(b->part < cloud.parts && b->image.width && b->image.height);
		assert_true(isfinite(b->center.x + b->center.y + b->center.z));
		assert_true(lod_v3_length(b->u) > 0 && lod_v3_length(b->v) > 0);
		assert_true(fabs(lod_v3_dot(lod_v3_unit(b->u), lod_v3_unit(b->v))) < 1e-5);
	}
}

CLOUD_TEST(the_cap_is_never_exceeded_and_is_used)
{
	static const uint32_t caps[] = { 1, 2, 3, 5, 8, 13, 33, 70, 150 };
	double last = 2;
	grow_tree(7, 20, 12);
	for (size_t i = 0; i < sizeof caps / sizeof *caps; i++) {
		tidy(NULL);
		make(&(struct lod_billboard_options){ .cap = caps[i], .epsilon = 0.03 });
		check_cloud(caps[i]);
		assert_true(cloud.count + 2 >= 0.75 * caps[i]);
		assert_true(cloud.error <= last + 0.05);
		last = cloud.error;
	}
	assert_true(last < 0.4);
	/* first parts that are far too many */
	tidy(NULL);
	make(&(struct lod_billboard_options){ .cap = 10, .epsilon = 0.03, .box = 0.01 });
	check_cloud(10);
	assert_true(cloud.merges > 50);
	/* one first part */
	tidy(NULL);
	make(&(struct lod_billboard_options){ .cap = 40, .epsilon = 0.03, .box = 60 });
	check_cloud(40);
	assert_true(cloud.splits > 10 && cloud.count >= 32);
	tidy(NULL);
	make(&(struct lod_billboard_options){ .cap = 0 });
	assert_int_equal(cloud.count, 0);
}

CLOUD_TEST(a_part_is_split_evenly)
{
	grow_tree(7, 20, 12);
	make(&(struct lod_billboard_options){ .cap = 2, .epsilon = 0.03, .box = 60,
		.forms = 1u << LOD_BILLBOARD_PLANE });
	assert_int_equal(cloud.splits, 1);
	double size[2];
	for (int i = 0; i < 2; i++)
		size[i] = lod_v3_length(cloud.items[i].u) * lod_v3_length(cloud.items[i].v);
	assert_true(size[0] < 4 * size[1] && size[1] < 4 * size[0]);
}

CLOUD_TEST(forms_that_may_not_be_used_are_not)
{
	grow_tree(8, 12, 10);
	for (uint32_t form = 0; form < LOD_BILLBOARD_FORMS; form++) {
		tidy(NULL);
		make(&(struct lod_billboard_options){ .cap = 30, .forms = 1u << form });
		check_cloud(30);
		assert_int_equal(cloud.forms[form], cloud.parts);
		assert_true(cloud.parts > 3);
	}
}

CLOUD_TEST(a_plane_of_leaves_becomes_one_billboard)
{
	none();
	for (int i = 0; i < 40; i++)
		leaf((struct lod_v3){ i % 8 * 0.3, 0, 1 + i / 8 * 0.3 }, (struct lod_v3){ 0.2, 0, 0 },
			(struct lod_v3){ 0, 0, 0.1 + i % 3 * 0.05 });
	make(&(struct lod_billboard_options){ .cap = 30 });
	assert_int_equal(cloud.count, 1);
	assert_true(cloud.error < 1e-3 && cloud.invalid < 1e-9);
	struct lod_v3 normal = lod_v3_unit(lod_v3_cross(cloud.items[0].u, cloud.items[0].v));
	assert_true(fabs(normal.y) > 1 - 1e-6);
	assert_true(fabs(lod_v3_length(cloud.items[0].u) - 2.3 / 2) < 0.02);
}

/* A sparse crown high up, and the same leaves in a quarter of the width below. */
CLOUD_TEST(hidden_parts_get_fewer_billboards)
{
	uint64_t seed = 11;
	none();
	tube(O, (struct lod_v3){ 0, 0, 8 }, 0.05, 0.2);
	for (int i = 0; i < 300; i++) {
		struct lod_v3 at = dice3(&seed), along = lod_v3_scale(lod_v3_unit(dice3(&seed)), 0.1),
			across = lod_v3_scale(lod_v3_unit(lod_v3_cross(along, at)), 0.1);
		leaf(lod_v3_add(lod_v3_scale(at, 1.5), (struct lod_v3){ 0, 0, 6.5 }), along, across);
		leaf(lod_v3_add(lod_v3_scale(at, 0.3), (struct lod_v3){ 0, 0, 2 }), along, across);
	}
	/* lengths that no part of the lower crown holds either: only sigma tells them apart */
	make(&(struct lod_billboard_options){ .cap = 60, .epsilon = 0.004 });
	uint32_t above = 0, below = 0;
	for (uint32_t i = 0; i < cloud.count; i++)
		*(cloud.items[i].center.z > 4 ? &above : &below) += 1;
	assert_true(above > 1.5 * below);
}

CLOUD_TEST(epsilon_is_given_or_half_a_pixel_or_the_least_that_holds)
{
	grow_tree(9, 12, 10);
	open_plant(&(struct lod_billboard_options){ .cap = 1 });
	struct lod_billboard_options options = { .cap = 40, .epsilon = 0.07 };
	assert_ok(lod_billboard_cloud_make(&cloud, plant, &options, &error), error);
	assert_true(near(cloud.epsilon, 0.07));
	lod_billboard_cloud_free(&cloud);
	options = (struct lod_billboard_options){ .cap = 40, .pixels = 50 };
	assert_ok(lod_billboard_cloud_make(&cloud, plant, &options, &error), error);
	assert_true(near(cloud.epsilon, 0.01));
	lod_billboard_cloud_free(&cloud);
	options = (struct lod_billboard_options){ .cap = 40 };
	assert_ok(lod_billboard_cloud_make(&cloud, plant, &options, &error), error);
	assert_true(cloud.error <= 0.5);
	double free_of = cloud.epsilon;
	lod_billboard_cloud_free(&cloud);
	options.epsilon = free_of / 1.41421356;
	assert_ok(lod_billboard_cloud_make(&cloud, plant, &options, &error), error);
	assert_true(cloud.error > 0.5);
}

CLOUD_TEST(parts_within_the_tolerance_are_kept)
{
	grow_tree(9, 12, 10);
	open_plant(&(struct lod_billboard_options){ .cap = 1 });
	uint32_t last = 0;
	for (double tolerance = 0.6; tolerance > 0.1; tolerance -= 0.2) {
		const struct lod_billboard_options options = { .cap = 300, .epsilon = 0.05, .box = 9,
			.tolerance = tolerance };
		lod_billboard_cloud_free(&cloud);
		assert_ok(lod_billboard_cloud_make(&cloud, plant, &options, &error), error);
		assert_true(cloud.count > last && cloud.error <= tolerance);
		last = cloud.count;
	}
}

/* ---- Pictures ---- */

#define PIXELS 128u

static void draw_model(struct lod_raster *raster)
{
	float position[9];
	for (uint32_t t = 0; t < model.triangle_count; t++) {
		for (uint32_t k = 0; k < 9; k++)
			position[k] = place[3 * corner_of[3 * t + k / 3] + k % 3];
		lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = 1, .position = position,
			.owner = 1 });
	}
}

/* Q of the cloud seen against y, from far away; the eye's right is x. */
static double q_seen(double half)
{
	struct lod_raster raster[2];
	struct lod_score score;
	struct lod_eye eye = { .at = { 0, -1000 * half, half }, .right = { 1, 0, 0 }, .up = { 0, 0, 1 },
		.forward = { 0, 1, 0 }, .tan_x = 0.0011, .tan_y = 0.0011, .pixel_rad = 0.0022 / PIXELS };
	for (int i = 0; i < 2; i++) {
		assert_ok(lod_raster_init(&raster[i], &(struct lod_raster_options){ .width = PIXELS,
			.height = PIXELS }, &error), error);
		lod_raster_clear(&raster[i]);
		lod_raster_camera(&raster[i], &eye, half);
		lod_raster_object(&raster[i], &(struct lod_place){ .cosine = 1, .scale = 1 });
	}
	draw_model(&raster[0]);
	lod_billboard_cloud_draw(&cloud, 1, &raster[1]);
	lod_score(&score, &(struct lod_score_input){ .width = PIXELS, .height = PIXELS,
		.cover = raster[1].cover, .reference = raster[0].cover });
	lod_raster_free(&raster[0]);
	lod_raster_free(&raster[1]);
	return score.q;
}

/* Of no symmetry. */
CLOUD_TEST(textures_show_what_stands_behind_them_the_right_way_round)
{
	for (int turned = 0; turned < 4; turned++) {
		none();
		leaf((struct lod_v3){ -1, 0, 0 }, (struct lod_v3){ 0.3, 0, 0 }, (struct lod_v3){ 0, 0, 2 });
		leaf((struct lod_v3){ -0.6, 0, 0.1 }, X, (struct lod_v3){ 0, 0, 0.2 });
		leaf((struct lod_v3){ 0.3, 0, 1.7 }, (struct lod_v3){ 0.4, 0, 0 },
			(struct lod_v3){ 0, 0, 0.2 });
		for (uint32_t i = 0; i < model.vertex_count; i++) {
			place[3 * i] *= turned & 1 ? -1 : 1;
			place[3 * i + 2] = turned & 2 ? 2 - place[3 * i + 2] : place[3 * i + 2];
		}
		tidy(NULL);
		make(&(struct lod_billboard_options){ .cap = 1 });
		assert_int_equal(cloud.count, 1);
		assert_true(q_seen(1) > 0.97);
	}
}

CLOUD_TEST(a_cloud_looks_like_its_tree)
{
	grow_tree(12, 16, 16);
	make(&(struct lod_billboard_options){ .cap = 100 });
	double q = q_seen(2);
	assert_true(q > 0.68);
	struct lod_billboard_options options = { .cap = 100, .valid_only = true };
	lod_billboard_cloud_free(&cloud);
	assert_ok(lod_billboard_cloud_make(&cloud, plant, &options, &error), error);
	assert_true(cloud.invalid > 0.01 && q_seen(2) < q);
}

/* A card with a round hole, in colour. */
CLOUD_TEST(textures_have_the_models_colours_and_holes)
{
	static uint8_t rgba[16 * 16 * 4];
	static struct eco_image image = { 16, 16, rgba };
	static struct eco_material material = { .name = "leaf", .rgb = { 255, 255, 255 }, .cutout = true };
	static float uv[12];
	for (int i = 0; i < 256; i++) {
		int x = i % 16 - 8, y = i / 16 - 8;
		const uint8_t texel[4] = { 200, 30, 10, x * x + y * y < 16 ? 0 : 255 };
		memcpy(rgba + 4 * i, texel, 4);
	}
	none();
	leaf(O, lod_v3_scale(X, 2), Z);
	model.images = &image;
	model.image_count = model.material_count = 1;
	model.materials = &material;
	model.uv = uv;
	for (uint32_t i = 0; i < model.vertex_count; i++) {
		uv[2 * i] = place[3 * i] / 2;
		uv[2 * i + 1] = place[3 * i + 2];
	}
	make(&(struct lod_billboard_options){ .cap = 1 });
	const struct eco_image *baked = &cloud.items[0].image;
	uint32_t n = baked->width * baked->height, opaque = 0;
	for (uint32_t i = 0; i < n; i++) {
		const uint8_t *texel = baked->rgba + 4 * (size_t)i;
		opaque += texel[3] == 255;
		assert_true(!texel[3] || (texel[0] == 200 && texel[1] == 30 && texel[2] == 10));
	}
	uint32_t middle = baked->height / 2 * baked->width + baked->width / 2;
	assert_int_equal(baked->rgba[4 * (size_t)middle + 3], 0);
	double area = 4 * lod_v3_length(cloud.items[0].u) * lod_v3_length(cloud.items[0].v) * opaque / n;
	assert_true(fabs(area - 2 * (1 - 45 / 256.0)) < 0.03);      /* 45 texels lie in the hole */
}

/* ---- No failure ---- */

static bool same_cloud(const struct lod_billboard_cloud *a, const struct lod_billboard_cloud *b)
{
	if (a->count != b->count || a->texture_bytes != b->texture_bytes)
		return false;
	for (uint32_t i = 0; i < a->count; i++) {
		const struct lod_billboard *p = &a->items[i], *q = &b->items[i];
		if (memcmp(&p->center, &q->center, sizeof p->center) || p->image.width != q->image.width
				|| p->image.height != q->image.height || memcmp(p->image.rgba, q->image.rgba,
				4 * (size_t)p->image.width * p->image.height))
			return false;
	}
	return true;
}

CLOUD_TEST(the_same_plant_gives_the_same_cloud)
{
	struct lod_billboard_cloud first;
	const struct lod_billboard_options options = { .cap = 60 };
	grow_tree(13, 14, 14);
	make(&options);
	first = cloud;
	lod_billboard_plant_close(plant);
	make(&options);
	assert_true(same_cloud(&first, &cloud));
	lod_billboard_cloud_free(&first);
}

static void random_mesh(uint64_t seed)
{
	uint32_t kind = (uint32_t)(seed % 10), count = kind ? (uint32_t)(seed * 37 % 300) : 0;
	none();
	for (uint32_t i = 0; i < count; i++) {
		struct lod_v3 at = dice3(&seed), a = dice3(&seed), b = dice3(&seed);
		if (kind == 1)               /* needles and points */
			b = lod_v3_scale(a, i % 3 ? 1e-7 : 0);
		if (kind == 2)               /* one place */
			at = O;
		if (kind == 3)               /* a line of dots, high up */
			at = (struct lod_v3){ 0, 0, 1e3 * i }, a = lod_v3_scale(a, 1e-3);
		if (kind == 4)               /* without height */
			at.z = a.z = b.z = 0;
		if (kind == 5)               /* far apart, far away */
			at = lod_v3_add(lod_v3_scale(at, 1e5), (struct lod_v3){ 1e6, 1e6, 0 });
		if (kind == 6)               /* very small */
			at = lod_v3_scale(at, 1e-6), a = lod_v3_scale(a, 1e-6), b = lod_v3_scale(b, 1e-6);
		if (kind == 7 && i % 4 == 0)         /* no numbers */
			at.x = i % 8 ? NAN : INFINITY;
		triangle(at, lod_v3_add(at, a), lod_v3_add(at, b));
		if (kind == 8 && i)          /* fans around one vertex, an index that is not there */
			corner_of[3 * i] = i % 50 ? 0 : 3 * MOST + 1;
		if (kind == 9)
			material_of[i] = (uint32_t)(seed % 5);
	}
}

CLOUD_TEST(a_hundred_random_and_degenerate_meshes_do_not_fail)
{
	for (uint64_t seed = 1; seed <= 100; seed++) {
		uint32_t cap = (uint32_t)(1 + seed % 23);
		tidy(NULL);
		random_mesh(seed);
		make(&(struct lod_billboard_options){ .cap = cap, .epsilon = seed % 3 ? 0 : 0.02,
			.box = seed % 4 ? 0 : 0.05, .node = seed % 5 ? 0 : 0.3 });
		check_cloud(cap);
	}
}
