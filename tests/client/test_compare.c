/* The picture that ecoview --compare writes, and what is measured for it. */
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_measure.h"
#include "ecofiles/format/image.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

static struct view_picture drawn(double share, double *ceiling)
{
	AT_END(scene_release) struct scene_held d = scene_hold_view(&grove, scene_view(), share);
	scene_select(&d);
	struct view_draw_job job = { d.store, &d.selection, &d.eye, 0.1, 2, NULL, VIEW_TINT_NONE, 1, false };
	struct view_picture p = scene_draw(&d, false, VIEW_TINT_NONE);
	assert_int_equal(view_measure_soft(&job, &p, NULL), ECO_OK);
	if (ceiling)
		assert_int_equal(view_measure_ceiling(&job, &p, ceiling, NULL), ECO_OK);
	return p;
}

UNIT_TEST(the_same_is_perfect_and_less_is_worse_by_every_measure)
{
	struct view_measures m[3];
	double ceiling = NAN;
	FREED(view_picture) full = drawn(1, &ceiling);
	static const double shares[] = { 1, 0.5, 0.1 };
	for (int i = 0; i < 3; i++) {
		FREED(view_picture) p = drawn(shares[i], NULL);
		view_measure_pair(&p, &full, NULL, &m[i]);
	}
	assert_true(m[0].score.q == 1 && m[0].score.owner_q == 1 && m[0].soft_q == 1 && m[0].picture_error == 0);
	assert_true(ceiling > 0.8 && ceiling <= 1);
	assert_true(m[1].soft_q < 1 && m[2].soft_q < m[1].soft_q);
	assert_true(m[1].picture_error > 0 && m[2].picture_error > m[1].picture_error);
}

static const uint8_t *at(const struct eco_image *image, uint32_t x, uint32_t y)
{
	return image->rgba + 4 * ((size_t)y * image->width + x);
}

static uint32_t lit_dots(const struct eco_image *image, uint32_t left, uint32_t right, uint32_t top)
{
	uint32_t dots = 0;
	for (uint32_t y = top; y < image->height; y++)
		for (uint32_t x = left; x < right; x++)
			dots += at(image, x, y)[0] > 200;
	return dots;
}

UNIT_TEST(file_has_three_pictures_and_their_words)
{
	enum { WIDTH = 480, HEIGHT = 30 };
	struct view_picture pictures[2];
	static float error_map[WIDTH * HEIGHT];
	uint32_t size[2];
	FREED_MEMORY uint8_t *rgb;
	for (int i = 0; i < 2; i++) {
		assert_int_equal(view_picture_init(&pictures[i], WIDTH, HEIGHT, NULL), ECO_OK);
		memset(pictures[i].rgb, 40 + 100 * i, 3 * WIDTH * HEIGHT);
	}
	error_map[WIDTH - 1] = 1;
	struct view_compare compare = { &pictures[0], &pictures[1], error_map, { "", "I\n-", "q 0.5" } };
	assert_int_equal(view_compare_draw(&compare, &rgb, size, NULL), ECO_OK);
	folder_make("build/tmp");
	assert_int_equal(eco_png_write(&(struct eco_pixels){ size[0], size[1], 3, rgb },
		"build/tmp/compare.png",
		NULL), ECO_OK);
	FREED(eco_image) image;
	assert_int_equal(eco_image_read(&image, "build/tmp/compare.png", NULL), ECO_OK);
	assert_true(image.width == 3 * WIDTH && image.height > HEIGHT);
	assert_int_equal(at(&image, WIDTH - 1, HEIGHT - 1)[0], 40);
	assert_int_equal(at(&image, WIDTH, 0)[0], 140);
	assert_memory_equal(at(&image, 2 * WIDTH, 0), ((uint8_t[4]){ 0, 0, 4, 255 }), 4);
	assert_memory_equal(at(&image, 3 * WIDTH - 1, 0), ((uint8_t[4]){ 252, 253, 191, 255 }), 4);
	/* dots are two pixels wide and high: an I has 11, a hyphen 5 */
	assert_int_equal(lit_dots(&image, 0, WIDTH, HEIGHT), 0);
	assert_int_equal(lit_dots(&image, WIDTH, 2 * WIDTH, HEIGHT), 4 * 16);
	assert_true(lit_dots(&image, 2 * WIDTH, 3 * WIDTH, HEIGHT) > 4 * 30);
	view_picture_free(&pictures[0]);
	view_picture_free(&pictures[1]);
}

/* Pictures of any width hold their words, if only a letter a line. */
UNIT_TEST(narrow_pictures_break_their_words)
{
	for (uint32_t width = 1; width < 40; width += 3) {
		FREED(view_picture) p;
		static const float error_map[40 * 2];
		uint32_t size[2];
		FREED_MEMORY uint8_t *rgb;
		assert_int_equal(view_picture_init(&p, width, 2, NULL), ECO_OK);
		struct view_compare compare = { &p, &p, error_map, { "many words of all lengths\n\n0.1",
			"", "x" } };
		assert_int_equal(view_compare_draw(&compare, &rgb, size, NULL), ECO_OK);
		assert_true(size[0] == 3 * width && size[1] > 2 + 10 * 3 && size[1] < 2 + 10 * 40);
	}
}

/* Gives the truth's file the name of another drawing of the same view. Returns the number of files. */
static int spoil_kept(bool spoil)
{
	DIR *all = opendir(scratch_root);
	int count = 0;
	for (const struct dirent *entry; (entry = readdir(all));) {
		char other[256];
		if (entry->d_name[0] == '.')
			continue;
		count++;
		snprintf(other, sizeof other, "%.17s0000000000000000-7.png", entry->d_name);
		if (spoil)
			assert_int_equal(renameat(dirfd(all), entry->d_name, dirfd(all), other), 0);
	}
	closedir(all);
	return count;
}

/* Colours of the truth are kept by view and light, as long as they are drawn alike. */
UNIT_TEST(truths_are_kept)
{
	AT_END(scene_release) struct scene_held d = scene_hold(&grove);
	scene_select(&d);
	struct view_draw_job job = { d.store, &d.selection, &d.eye, 0.1, 2, NULL, VIEW_TINT_NONE, 1, false };
	FREED(view_picture) first = scene_draw(&d, false, VIEW_TINT_NONE), again = scene_draw(&d, false, VIEW_TINT_NONE);
	size_t bytes = 3 * (size_t)first.width * first.height;
	double cpu_ms, again_ms;
	scratch_open("truths");
	assert_true(memcmp(first.rgb, again.rgb, bytes) == 0);
	assert_good(view_truth_draw(&job, scratch_root, &first, &cpu_ms, &cause));
	assert_true(cpu_ms > 0 && memcmp(first.rgb, again.rgb, bytes) != 0);
	assert_good(view_truth_draw(&job, scratch_root, &again, &again_ms, &cause));
	assert_true(cpu_ms == again_ms && memcmp(first.rgb, again.rgb, bytes) == 0);
	assert_int_equal(spoil_kept(true), 1);
	assert_good(view_truth_draw(&job, scratch_root, &again, &again_ms, &cause));
	assert_int_equal(spoil_kept(false), 1);
	assert_true(again_ms > 0 && memcmp(first.rgb, again.rgb, bytes) == 0);
	d.selection.sky.haze_m = 100;
	assert_good(view_truth_draw(&job, scratch_root, &again, &cpu_ms, &cause));
	assert_int_equal(spoil_kept(false), 2);
	assert_true(cpu_ms > 0 && memcmp(first.rgb, again.rgb, bytes) != 0);
	scratch_close(NULL);
}

UNIT_MAIN(scene_open, scene_close)
