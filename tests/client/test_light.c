/* Light: both sides of a leaf, what crowns let through, energy, haze, and a low sun's sky. */
#include <math.h>
#include <string.h>

#include "client-min/draw/view_light_inline.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

/* ---- Leaves ---- */

/* One leaf of the first plant in view, as one pixel of a picture: lit in *rgb. */
static void light_leaf(const struct scene_held *h, const float sun[3], const float normal[3], uint8_t rgb[3])
{
	static const uint8_t green[3] = { 70, 120, 40 };
	FREED(view_picture) one;
	const struct view_instance *at = h->selection.instances;
	struct view_selection s = h->selection;
	s.ground.count = 0;
	memcpy(s.sky.sun, sun, sizeof s.sky.sun);
	while (at->plant == ECO_NONE)
		at++;
	/* the leaf's plant is turned */
	const float turned[3] = { (float)((double)normal[0] * at->place.cosine
		+ (double)normal[1] * at->place.sine), (float)((double)normal[1] * at->place.cosine
		- (double)normal[0] * at->place.sine), normal[2] };
	assert_good(view_picture_init(&one, 1, 1, &cause));
	memcpy(one.rgb, green, sizeof green);
	one.cover[0] = 255;
	one.owner[0] = at->owner;
	one.depth[0] = (float)(1 / at->distance_m);
	one.surface[0] = view_surface_direction(VIEW_FACET, turned);
	struct view_draw_job job = { h->store, &s, &h->eye, 0.1, 1, NULL, VIEW_TINT_NONE, 1, false };
	struct view_lamp *lamp;
	assert_good(view_lamp_make(&lamp, &job, &one, &cause));
	view_lamp_light(lamp, &h->eye, &one, 1);
	view_lamp_free(lamp);
	memcpy(rgb, one.rgb, 3);
}

UNIT_TEST(leaves_have_two_sides_and_let_light_through)
{
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	scene_select(&h);
	const double *f = h.eye.forward;
	const float normal[3] = { -(float)f[0], -(float)f[1], -(float)f[2] }, back[3] = { (float)f[0],
		(float)f[1], (float)f[2] };
	/* towards the eye, and away from it, as high; and one that only grazes the leaf */
	const float ahead[3] = { (float)f[0], (float)f[1], 0.5f }, behind[3] = { -(float)f[0], -(float)f[1],
		0.5f }, beside[3] = { (float)f[1], -(float)f[0], 0.5f };
	uint8_t front[3], other[3], through[3], grazed[3];
	light_leaf(&h, behind, normal, front);
	light_leaf(&h, behind, back, other);
	assert_memory_equal(front, other, 3);            /* the side that is seen decides */
	light_leaf(&h, ahead, normal, through);
	light_leaf(&h, ahead, back, other);
	assert_memory_equal(through, other, 3);
	light_leaf(&h, beside, normal, grazed);
	print_message("lit %u %u %u, from behind %u %u %u, grazed %u %u %u\n", front[0], front[1], front[2],
		through[0], through[1], through[2], grazed[0], grazed[1], grazed[2]);
	/* it glows, in a yellower green than in light from the front */
	assert_true(through[1] > grazed[1] + 10 && through[1] < front[1]);
	assert_true(through[1] * front[2] > front[1] * through[2]);
}

/* ---- Energy ---- */

/* its tone is the mean of all plants' */
static const struct plant tree = { 0, 1, 6, 3, 6, 0.53125f };
static const struct sunlight noon = { { 0, 0.6f, 0.8f }, { 1.7f, 1.6f, 1.3f }, { 0.4f, 0.4f, 0.5f },
	{ 0.2f, 0.2f, 0.1f }, 1, 0 };

static vec3 direction(int i, int count)          /* a spiral from pole to pole */
{
	float z = 1 - 2 * ((float)i + 0.5f) / (float)count, r = sqrtf(1 - z * z), turn = 2.39996f * (float)i;
	return vec3(r * cosf(turn), r * sinf(turn), z);
}

static uint32_t surface_of(enum view_surface kind, vec3 n)
{
	const float d[3] = { n.x, n.y, n.z };
	return kind == VIEW_BALL ? view_surface_ball(1, 0, d) : view_surface_direction(kind, d);
}

static float most(vec3 v) { return fmaxf(v.x, fmaxf(v.y, v.z)); }

/* A sky and a ground of light 1 and no sun: no surface of any kind and color is brighter. */
UNIT_TEST(no_surface_gives_more_light_than_it_gets)
{
	static const struct sunlight even = { { 0, 0, 1 }, { 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 }, 1, 0 };
	static const vec3 colors[] = { { 1, 1, 1 }, { 0.5f, 1, 0.2f }, { 0.9f, 1, 0.9f }, { 1, 0.3f, 0.3f } };
	float brightest = 0;
	for (uint32_t kind = 0; kind < 4; kind++)
		for (int i = 0; i < 200; i++) {
			vec3 n = direction(i, 200), eye = direction(i * 7 % 200, 200);
			uint32_t surface = kind == VIEW_CLOUD ? view_surface_cloud(1, i % 5 * 0.25)
				: surface_of((enum view_surface)kind, n);
			struct face seen = face_of(even, tree, surface, eye);
			for (size_t c = 0; c < sizeof colors / sizeof *colors; c++)
				brightest = fmaxf(brightest, most(plant_light(even, (plant){ .tone = 0.53125f },
					colors[c], seen.sun, crown(1, 1, 1), false)));
		}
	print_message("brightest of all surfaces: %.3f\n", (double)brightest);
	assert_true(brightest <= 1.01f && brightest > 0.99f);
	for (int i = 0; i < 1000; i++)
		assert_true(shown((float)i * 0.01f) <= shown((float)(i + 1) * 0.01f) && shown((float)i) <= 1);
}

/* ---- Crowns ---- */

static const float leaf_color[3] = { 0.08f, 0.17f, 0.03f };

static vec3 lit(const struct sunlight *s, uint32_t surface, vec3 at, vec3 eye)
{
	struct face seen = face_of(*s, tree, surface, eye);
	return plant_color(*s, tree, vec3(leaf_color[0], leaf_color[1], leaf_color[2]), seen, at, scale(eye, -1), -1, 0, 1,
		1e9f, false);
}

static vec3 in_tree(vec3 unit_place) { return vec3(3 * unit_place.x, 3 * unit_place.y, 6 + 6 * unit_place.z); }

/* A number in [0, 1) of each of a sequence of places in five dimensions that fill it evenly (Roberts 2018). */
static float even_number(int i, int dimension)
{
	double at = 0.5 + (i + 1) * pow(1 / 1.1347241384015194, dimension + 1);
	return (float)(at - floor(at));
}

static vec3 even_direction(int i, int dimension)
{
	float z = 2 * even_number(i, dimension) - 1, r = sqrtf(1 - z * z),
		turn = 6.2831853f * even_number(i, dimension + 1);
	return vec3(r * cosf(turn), r * sinf(turn), z);
}

/* Leaves of all directions, `level` of them level, fill the crown; each shows the area that it turns to the
 * eye, and others hide it. */
static float mean_of_leaves(const struct sunlight *s, float level, vec3 eye)
{
	vec3 back = unstretched(tree, eye);
	float sum = 0, weights = 0;
	for (int i = 0; i < 4000; i++) {
		vec3 n = (float)i < 4000 * level ? vec3(0, 0, 1) : even_direction(i, 0), at = scale(even_direction(i, 2), cbrtf(even_number(i, 4)));
		float weight = fabsf(dot(n, eye)) * expf(-5 * way_out(at, back));
		sum += weight * lit(s, surface_of(VIEW_FACET, n), in_tree(at), eye).y;
		weights += weight;
	}
	return sum / weights;
}

/* One ball as large as the crown. */
static float mean_of_ball(const struct sunlight *s, float level, vec3 eye)
{
	vec3 back = unstretched(tree, eye);
	float sum = 0, weights = 0;
	for (int i = 0; i < 4000; i++) {
		vec3 d = direction(i, 4000), n = unit(vec3(d.x, d.y, d.z * 0.5f));
		float weight = fmaxf(dot(d, back), 0);
		sum += weight * lit(s, view_surface_ball(1, (double)level, (const float[3]){ n.x, n.y, n.z }), in_tree(d), eye).y;
		weights += weight;
	}
	return sum / weights;
}

UNIT_TEST(a_crown_has_the_same_light_as_leaves_as_a_splat_and_as_a_point)
{
	double worst[2] = { 0, 0 }, mean[2] = { 0, 0 };
	for (int i = 0; i < 60; i++) {
		float level = (float)(i % 3) * 0.4f;
		vec3 eye = direction(i * 17 % 60, 60), sun = direction(i % 12, 30);
		struct sunlight s = noon;
		s.to = sun;
		double leaves = (double)mean_of_leaves(&s, level, eye), others[2] = { (double)mean_of_ball(&s, level, eye),
			(double)lit(&s, view_surface_cloud(1, (double)level), vec3(0, 0, 6), eye).y };
		for (int k = 0; k < 2; k++) {
			worst[k] = fmax(worst[k], fabs(log(others[k] / leaves)));
			mean[k] += log(others[k] / leaves) / 60;
		}
	}
	print_message("splats: %+.3f in the mean, at most %.3f; points: %+.3f, at most %.3f\n", mean[0],
		worst[0], mean[1], worst[1]);
	assert_true(fabs(mean[0]) < 0.04 && worst[0] < 0.16);
	assert_true(fabs(mean[1]) < 0.01 && worst[1] < 0.05);
}

/* Light falls from the sunny side inwards, and more of it from above than from below reaches a treetop. */
UNIT_TEST(a_crown_is_darker_inside_and_on_its_far_side)
{
	vec3 sun = unstretched(tree, vec3(noon.to.x, noon.to.y, noon.to.z));
	float before = 2;
	for (int i = 0; i <= 10; i++) {
		struct crown c = crown_at(scale(sun, 0.97f - 0.194f * (float)i), sun, 0);
		assert_true(c.sun < before);
		before = c.sun;
	}
	struct crown top = crown_at(vec3(0, 0, 0.9f), sun, 0);
	assert_true(before < 0.1f && top.sky > 0.9f && top.earth < 0.3f);
	double sum = 0;
	for (int i = 0; i < 20000; i++)
		sum += (double)clump(scale(direction(i, 20000), cbrtf((float)(i * 911 % 20000) / 20000)), 0.3f);
	assert_true(fabs(sum / 20000 / (double)CLUMP_DEPTH - 1) < 0.1);
}

/* ---- Pictures ---- */

static struct view_picture draw(const struct scene_held *h, const struct view_sky *sky)
{
	struct scene_held under = *h;
	under.selection.sky = *sky;
	return scene_draw(&under, false, VIEW_TINT_NONE);
}

/* The mean of a colour over ground, or over the sky's lowest pixels. */
static double mean_of(const struct view_picture *p, int channel, bool ground)
{
	double sum = 0, count = 0;
	for (uint32_t x = 0; x < p->width; x++)
		for (uint32_t y = p->height; y-- > 0;) {
			size_t i = (size_t)y * p->width + x;
			if (p->owner[i] || (p->depth[i] > 0) != ground)
				continue;
			sum += p->rgb[3 * i + (size_t)channel];
			count++;
			if (!ground)
				break;
		}
	return sum / fmax(count, 1);
}

UNIT_TEST(nearer_haze_hides_more)
{
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	scene_select(&h);
	FREED(view_picture) usual, same, near;
	usual = draw(&h, &(struct view_sky){ .haze_m = 0 });
	same = draw(&h, &(struct view_sky){ .haze_m = 20000 });
	near = draw(&h, &(struct view_sky){ .haze_m = 30 });
	assert_memory_equal(usual.rgb, same.rgb, 3 * (size_t)usual.width * usual.height);
	print_message("blue of ground: %.1f, in haze %.1f; of the sky %.1f\n", mean_of(&usual, 2, true),
		mean_of(&near, 2, true), mean_of(&near, 2, false));
	assert_true(mean_of(&near, 2, true) > mean_of(&usual, 2, true) + 20);
	assert_true(fabs(mean_of(&near, 2, false) - mean_of(&usual, 2, false)) < 1e-9);
}

/* Around a low sun the sky is red, away from it less so, and around a high one not at all. */
UNIT_TEST(a_low_sun_reddens_the_horizon)
{
	struct eco_view level = scene_view();
	level.target[2] = level.eye[2] + 3;
	AT_END(scene_release) struct scene_held h = scene_hold_view(&grove, level, 1);
	scene_select(&h);
	const double *f = h.eye.forward;
	const struct view_sky low = { .sun = { (float)f[0], (float)f[1], 0.08f } }, away = { .sun = {
		-(float)f[0], -(float)f[1], 0.08f } }, high = { .sun = { (float)f[0], (float)f[1], 2 } };
	const struct view_sky *skies[] = { &low, &away, &high };
	double red[3];
	for (int i = 0; i < 3; i++) {
		FREED(view_picture) p;
		p = draw(&h, skies[i]);
		red[i] = mean_of(&p, 0, false) / mean_of(&p, 2, false);
	}
	print_message("red over blue: %.3f towards a low sun, %.3f away from it, %.3f below a high one\n",
		red[0], red[1], red[2]);
	assert_true(red[0] > 1.1 * red[1] && red[1] > 1.05 * red[2]);
}

/* Water is told by the code of its alpha and by its blue; a flat look at it sees the sky, one from above what lies in it. */
UNIT_TEST(water_shows_the_sky_to_a_flat_look)
{
	const vec3 blue = { 0.04f, 0.08f, 0.107f }, gray = { 0.1f, 0.1f, 0.1f };
	const struct sunlight sun = lod_usual_light;
	float code = ECO_GROUND_WATER / 255.0f;
	assert_true(water_of(blue, code) == 1 && water_of(blue, 1) == 0 && water_of(gray, code) == 0 && water_of(blue, 0.9f) == 0);
	vec3 flat = water_color(sun, (ground_place){ 3, 4 }, blue, vec3(900, 0, -0.9f), 1), down = water_color(sun,
		(ground_place){ 3, 4 }, blue, vec3(0.1f, 0, -30), 1), none = water_color(sun, (ground_place){ 3, 4 }, blue, vec3(900, 0, -0.9f), 0);
	vec3 sky = background(sun, vec3(1, 0, 0.001f));
	assert_true(fabsf(flat.z - sky.z) < 0.1f * sky.z && flat.z > 3 * blue.z);
	assert_true(down.z < blue.z + 0.03f && none.z == blue.z);
}

UNIT_MAIN(scene_open, scene_close)
