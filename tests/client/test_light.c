/* Light: both sides of a leaf, haze, and a low sun's sky. */
#include <math.h>
#include <string.h>

#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

/* ---- Leaves ---- */

/* One leaf of the first plant in view, as one pixel of a picture: lit in *rgb. */
static void light_leaf(const struct scene_held *h, const float sun[3], const float normal[3], uint8_t rgb[3])
{
	static const uint8_t green[3] = { 70, 120, 40 };
	FREED(view_picture) one;
	const struct view_instance *plant = h->selection.instances;
	struct view_selection s = h->selection;
	s.ground.count = 0;
	memcpy(s.sky.sun, sun, sizeof s.sky.sun);
	while (plant->plant == ECO_NONE)
		plant++;
	/* the leaf's plant is turned */
	const float turned[3] = { (float)((double)normal[0] * plant->place.cosine
		+ (double)normal[1] * plant->place.sine), (float)((double)normal[1] * plant->place.cosine
		- (double)normal[0] * plant->place.sine), normal[2] };
	assert_good(view_picture_init(&one, 1, 1, &cause));
	memcpy(one.rgb, green, sizeof green);
	one.cover[0] = 255;
	one.owner[0] = plant->owner;
	one.depth[0] = (float)(1 / plant->distance_m);
	one.surface[0] = view_surface_direction(VIEW_FACET, turned);
	struct view_draw_job job = { h->store, &s, &h->eye, 0.1, 1, NULL, VIEW_TINT_UNSHADED, 1 };
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
	same = draw(&h, &(struct view_sky){ .haze_m = 5200 });
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
	print_message("red over blue: %.3f towards a low sun, %.3f away from it, %.3f below a high one\n", red[0],
		red[1], red[2]);
	assert_true(red[0] > 1.1 * red[1] && red[1] > 1.05 * red[2]);
}

UNIT_MAIN(scene_open, scene_close)
