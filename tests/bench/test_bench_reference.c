/* Pictures of full detail in the cache of ecobench. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/view.h"
#include "tests/bench/bench_reference.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

#define WIDTH 37u
#define HEIGHT 11u
#define PIXELS (WIDTH * HEIGHT)

static int open_folder(void **state)
{
	scratch_open("reference");
	return 0;
}

static int close_folder(void **state)
{
	scratch_remove(scratch_root);
	return 0;
}

static struct bench_reference make(bool soft)
{
	struct bench_reference r = { .ceiling = soft ? 0.875 : NAN, .summaries = 7 };
	struct eco_error error = { 0 };
	assert_ok(view_picture_init(&r.picture, WIDTH, HEIGHT, &error), error);
	r.picture.soft = soft ? malloc(PIXELS) : NULL;
	r.picture.vertices = 3000000000u;
	r.picture.draw_ms = 12.5;
	for (uint32_t i = 0; i < PIXELS; i++) {
		r.picture.rgb[3 * i + i % 3] = (uint8_t)i;
		r.picture.cover[i] = i % 2 ? 255 : 0;
		r.picture.owner[i] = (uint64_t)i << 40;
		r.picture.depth[i] = 1 / (float)(i + 1);
		r.picture.surface[i] = ~i;
		if (soft)
			r.picture.soft[i] = (uint8_t)(i % 17);
	}
	return r;
}

static void assert_alike(const struct bench_reference *a, const struct bench_reference *b)
{
	assert_int_equal(a->picture.width, b->picture.width);
	assert_int_equal(a->picture.height, b->picture.height);
	assert_memory_equal(a->picture.rgb, b->picture.rgb, 3 * PIXELS);
	assert_memory_equal(a->picture.cover, b->picture.cover, PIXELS);
	assert_memory_equal(a->picture.owner, b->picture.owner, PIXELS * sizeof *a->picture.owner);
	assert_memory_equal(a->picture.depth, b->picture.depth, PIXELS * sizeof *a->picture.depth);
	assert_memory_equal(a->picture.surface, b->picture.surface, PIXELS * sizeof *a->picture.surface);
	assert_int_equal(a->picture.soft == NULL, b->picture.soft == NULL);
	if (a->picture.soft)
		assert_memory_equal(a->picture.soft, b->picture.soft, PIXELS);
	assert_int_equal(a->picture.vertices, b->picture.vertices);
	assert_true(a->picture.draw_ms == b->picture.draw_ms);
	assert_int_equal(isnan(a->ceiling), isnan(b->ceiling));
	assert_true(isnan(a->ceiling) || a->ceiling == b->ceiling);
	assert_int_equal(a->summaries, b->summaries);
}

UNIT_TEST(what_is_kept_is_read_again)
{
	for (int soft = 0; soft < 2; soft++) {
		struct bench_reference kept = make(soft), read;
		struct eco_error error = { 0 };
		assert_ok(bench_reference_write(in_root("references/one"), &kept, &error), error);
		assert_true(bench_reference_read(in_root("references/one"), &read));
		assert_alike(&kept, &read);
		view_picture_free(&kept.picture);
		view_picture_free(&read.picture);
	}
}

UNIT_TEST(damaged_and_missing_ones_are_none)
{
	struct bench_reference kept = make(true), read;
	struct eco_error error = { 0 };
	size_t size;
	assert_ok(bench_reference_write(in_root("two"), &kept, &error), error);
	uint8_t *bytes = file_read(in_root("two"), &size);
	for (size_t cut = 0; cut < size; cut += 7) {
		file_write(in_root("cut"), bytes, cut);
		assert_false(bench_reference_read(in_root("cut"), &read));
	}
	for (size_t at = 0; at < size; at += 7) {
		bytes[at] ^= 0x10;
		file_write(in_root("damaged"), bytes, size);
		assert_false(bench_reference_read(in_root("damaged"), &read));
		bytes[at] ^= 0x10;
	}
	assert_false(bench_reference_read(in_root("missing"), &read));
	free(bytes);
	view_picture_free(&kept.picture);
}

/* Another content, view or kind of counts is another picture; a pack that bench_scene did not build has
 * none. */
UNIT_TEST(names_follow_from_content_view_and_counts)
{
	char path[5][BENCH_REFERENCE_PATH];
	struct bench bench = { .cache = "cache", .build = "build" };
	struct eco_view view = { .eye = { 1, 2, 3 }, .fov_y_deg = 45, .width = WIDTH, .height = HEIGHT };
	file_write_text(in_root("pack.eco.stamp"), "-\nholds 0123456789abcdef\ntook 1 1\n");
	assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, true, path[0]));
	assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, true, path[1]));
	assert_string_equal(path[0], path[1]);
	assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, false, path[1]));
	view.eye[0] = 1.5;
	assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, true, path[2]));
	view.eye[0] = 1;
	file_write_text(in_root("pack.eco.stamp"), "-\nholds 0123456789abcdee\ntook 1 1\n");
	assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, true, path[3]));
	for (int i = 1; i < 4; i++)
		for (int k = 0; k < i; k++)
			assert_string_not_equal(path[i], path[k]);
	assert_false(bench_reference_path(&bench, in_root("other.eco"), &view, true, path[4]));
}

int main(void)
{
	return unit_tests_run(open_folder, close_folder);
}
