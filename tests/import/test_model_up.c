/* The axis of a soup that points up, by its shape. */
#include "ecofiles/import/model/model_clean.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/model_try.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* ---- Plants, z up ---- */

static uint32_t plain(struct soup *s)
{
	return soup_material(s, 153, 153, 153, ECO_NONE, false);
}

static void blades(struct soup *s, uint32_t material, int count, struct lod_v3 at, double length, double lean,
	double sink)
{
	for (int i = 0; i < count; i++) {
		struct lod_v3 d = soup_direction(s), last = at;
		d.z = 0;
		d = lod_v3_unit(d);
		for (int k = 1; k <= 6; k++) {
			double w = k / 6.0;
			struct lod_v3 next =
				lod_v3_add(at,
				(struct lod_v3){ d.x * lean * w * length, d.y * lean * w * length,
				(w - sink * w * w) * length });
			soup_tube(s, material, last, next, 0.01 * length, 0.008 * length, 3, 1);
			last = next;
		}
	}
}

static void tree(struct soup *s)
{
	soup_tree(s, 600, 0, false);
}

static void low_poly_tree(struct soup *s)
{
	soup_begin(s);
	soup_tube(s, plain(s), (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 2 }, 0.12, 0.1, 6, 2);
	soup_ball(s, plain(s), (struct lod_v3){ 0, 0, 3 }, 1.2, 6);
}

static void conifer(struct soup *s)
{
	soup_begin(s);
	uint32_t bark = plain(s), needle = plain(s);
	soup_tube(s, bark, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 10 }, 0.2, 0.02, 6, 10);
	for (int i = 0; i < 1500; i++) {
		double h = soup_random(s, 0, 1), a = soup_random(s, 0, 2 * LOD_PI),
			r = (1 - h) * 2.2 * sqrt(soup_random(s, 0, 1));
		soup_leaf(s, needle, (struct lod_v3){ r * cos(a), r * sin(a), 0.5 + 9.5 * h }, 0.3, 0.1);
	}
}

static void palm(struct soup *s)
{
	soup_begin(s);
	soup_tube(s, plain(s), (struct lod_v3){ 0.8, 0, 0 }, (struct lod_v3){ 0, 0, 6 }, 0.15, 0.12, 8, 12);
	blades(s, plain(s), 30, (struct lod_v3){ 0, 0, 6 }, 2, 1.2, 1.2);
}

static void grass_tuft(struct soup *s)
{
	soup_begin(s);
	blades(s, plain(s), 60, (struct lod_v3){ 0, 0, 0 }, 0.5, 0.8, 0.4);
}

static void potted_plant(struct soup *s)
{
	soup_begin(s);
	soup_tube(s, plain(s), (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 0.3 }, 0.12, 0.16, 16, 2);
	blades(s, plain(s), 40, (struct lod_v3){ 0, 0, 0.3 }, 0.7, 0.6, 0.3);
}

/* Crossed cards with bare ground between them, in a field that is longer than wide. */
static void patch_of_tufts(struct soup *s)
{
	soup_begin(s);
	uint32_t leaf = plain(s);
	for (int i = 0; i < 30; i++) {
		double x = soup_random(s, -11, 11), y = soup_random(s, -9, 9), a = soup_random(s, 0, LOD_PI);
		for (int k = 0; k < 2; k++, a += LOD_PI / 2)
			soup_quad(s, leaf, (struct lod_v3){ x, y, 0.6 },
				(struct lod_v3){ 0.6 * cos(a), 0.6 * sin(a), 0 },
				(struct lod_v3){ 0, 0, 0.6 });
	}
}

static void mushroom(struct soup *s)
{
	soup_begin(s);
	soup_tube(s, plain(s), (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 0.1 }, 0.015, 0.012, 10, 4);
	soup_ball(s, plain(s), (struct lod_v3){ 0, 0, 0.12 }, 0.05, 8);
}

/* ---- What does not tell ---- */

static void ball(struct soup *s)
{
	soup_begin(s);
	soup_ball(s, plain(s), (struct lod_v3){ 0, 0, 0 }, 1, 10);
}

static void cloud_of_leaves(struct soup *s)
{
	soup_begin(s);
	soup_leaves(s, plain(s), 800, (struct lod_v3){ 0, 0, 0 }, 1, 0.1);
}

static void hedge(struct soup *s)
{
	soup_begin(s);
	uint32_t leaf = plain(s);
	for (int i = 0; i < 1500; i++)
		soup_leaf(s, leaf, (struct lod_v3){ soup_random(s, -3, 3), soup_random(s, -0.4, 0.4),
			soup_random(s, 0, 1.3) }, 0.1, 0.07);
}

static void ivy_on_a_wall(struct soup *s)
{
	soup_begin(s);
	uint32_t leaf = plain(s);
	for (int i = 0; i < 1500; i++) {
		double h = soup_random(s, 0, 1);
		soup_leaf(s, leaf,
			(struct lod_v3){ (0.1 + h) * soup_random(s, -1.2, 1.2), soup_random(s, -0.08, 0.08),
			3 * h }, 0.1, 0.07);
	}
}

static void flat_card(struct soup *s)
{
	soup_begin(s);
	soup_quad(s, plain(s), (struct lod_v3){ 0, 0, 1 }, (struct lod_v3){ 1, 0, 0 },
		(struct lod_v3){ 0, 0, 2 });
}

/* ---- Tests ---- */

/* The soup turned about its z axis by eighths of a turn, moved, scaled, and written with y or z up. */
static void place(const struct soup *from, float *position, int eighth, double scale, const double move[3],
	enum eco_up up)
{
	static const double cosine[3] = { 1, 0.70710678118654752, 0 };
	double c = eighth <= 2 ? cosine[eighth] : -cosine[4 - eighth], s = eighth <= 2 ? cosine[2 - eighth]
		: cosine[eighth - 2];
	for (uint32_t i = 0; i < from->model.vertex_count; i++) {
		const float *p = from->model.position + 3 * (size_t)i;
		double x = (c * p[0] - s * p[1]) * scale + move[0],
			y = (s * p[0] + c * p[1]) * scale + move[1], z = p[2] * scale + move[2];
		float *to = position + 3 * (size_t)i;
		to[0] = (float)x;
		to[1] = (float)(up == ECO_UP_Z ? y : z);
		to[2] = (float)(up == ECO_UP_Z ? z : -y);
	}
}

struct counts { uint32_t sure, right, wrong, surely_wrong; };

static struct counts ask(void (*make)(struct soup *s))
{
	static const double moves[3][3] = { { 0, 0, 0 }, { 40, -3, 7 }, { -300, 800, 55 } };
	struct counts counts = { 0, 0, 0, 0 };
	struct soup soup;
	make(&soup);
	struct eco_model turned = soup.model;
	turned.position = malloc(((size_t)soup.model.vertex_count * 3 + 1) * sizeof(float));
	for (int n = 0; n < 2 * 5 * 3; n++) {
		enum eco_up up = n % 2 ? ECO_UP_Y : ECO_UP_Z;
		double certainty = -1;
		place(&soup, turned.position, n / 2 % 5, n / 10 == 1 ? 100 : 1, moves[n / 10], up);
		bool right = eco_model_find_up(&turned, &certainty) == up;
		assert_true(certainty >= 0 && certainty <= 1);
		*(certainty >= ECO_UP_CERTAIN ? right ? &counts.sure : &counts.surely_wrong : right
			? &counts.right : &counts.wrong) += 1;
	}
	free(turned.position);
	soup_free(&soup);
	return counts;
}

/* Sure answers of 30, at least and at most; none may be surely wrong. */
static const struct { const char *name; void (*make)(struct soup *s); uint32_t least, most; } shapes[] = {
	{ "tree", tree, 30, 30 }, { "low-poly tree", low_poly_tree, 30, 30 }, { "conifer", conifer, 30, 30 },
	{ "palm", palm, 30, 30 }, { "grass tuft", grass_tuft, 30, 30 }, { "potted plant", potted_plant, 30, 30 },
	{ "patch of tufts", patch_of_tufts, 30, 30 }, { "mushroom", mushroom, 24, 30 },
	/* these do not tell */
	{ "ball", ball, 0, 0 }, { "cloud of leaves", cloud_of_leaves, 0, 0 }, { "hedge", hedge, 0, 30 },
	{ "ivy on a wall", ivy_on_a_wall, 0, 30 }, { "flat card", flat_card, 0, 30 },
};

UNIT_TEST(shapes_tell_which_way_is_up_or_are_unsure)
{
	for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
		struct counts c = ask(shapes[i].make);
		if (c.surely_wrong || c.sure < shapes[i].least || c.sure > shapes[i].most)
			fail_msg("%s: of 30 surely right %u, right %u, wrong %u, surely wrong %u",
				shapes[i].name, c.sure, c.right, c.wrong, c.surely_wrong);
	}
}

UNIT_TEST(what_is_broken_does_not_count)
{
	struct soup soup;
	double certainty, again;
	tree(&soup);
	assert_int_equal(eco_model_find_up(&soup.model, &certainty), ECO_UP_Z);
	uint32_t far = soup_vertex(&soup, (struct lod_v3){ NAN, 0, 0 }, 0, 0),
		high = soup_vertex(&soup, (struct lod_v3){ 0, INFINITY, 0 }, 0, 0);
	soup_triangle(&soup, 0, 0, 1, far);
	soup_triangle(&soup, 0, 0, high, 2);
	soup_triangle(&soup, 0, 0, 1, 4000000000u);
	soup_vertex(&soup, (struct lod_v3){ 1e6, 1e6, 1e6 }, 0, 0);  /* of no triangle */
	assert_int_equal(eco_model_find_up(&soup.model, &again), ECO_UP_Z);
	assert_true(again == certainty);
	soup.model.triangle_count = 0;
	assert_int_equal(eco_model_find_up(&soup.model, &again), ECO_UP_Y);
	assert_true(again == 0);
	soup_free(&soup);
}

/* Imports the tree as a GLB, as it is or with y up, as glTF wants it. */
static void import_glb(bool y_up, enum eco_up up)
{
	struct soup soup;
	uint8_t *bytes;
	tree(&soup);
	gw_begin();
	uint32_t corners = 3 * soup.model.triangle_count;
	float *at = malloc(corners * 3 * sizeof *at);
	assert_non_null(at);
	for (uint32_t i = 0; i < corners; i++) {
		const float *p = &soup.model.position[3 * (size_t)soup.model.index[i]];
		const float turned[3] = { p[0], y_up ? p[2] : p[1], y_up ? -p[1] : p[2] };
		memcpy(&at[3 * (size_t)i], turned, sizeof turned);
	}
	gw_floats(at, corners, "VEC3", 3);
	size_t size = gw_glb_bytes(",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
		"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]", ' ', &bytes);
	import_file(input_bytes("model_up", "tree.glb", bytes, size),
		&(struct eco_model_options){ .up = up });
	free(bytes);
	free(at);
	soup_free(&soup);
}

UNIT_TEST(a_format_that_lays_a_tree_down_is_believed_and_doubted)
{
		import_glb(true, ECO_UP_FOUND);
	double height = eco_model_height(&m);
	assert_int_equal(m.source.up_by_shape, ECO_UP_FOUND);
	assert_null(strstr(import_said, "by its shape"));
	import_glb(false, ECO_UP_FOUND);
	assert_int_equal(m.source.up, ECO_UP_Y);
	assert_int_equal(m.source.up_by_shape, ECO_UP_Z);
	assert_true(fabs(eco_model_height(&m) - height) > 0.01);
	import_says("by its shape the z axis points up, though its format says y");
	import_glb(false, ECO_UP_Z);
	assert_int_equal(m.source.up_by_shape, ECO_UP_FOUND);
	assert_true(fabs(eco_model_height(&m) - height) < 1e-6);
	eco_model_free(&m);
}
