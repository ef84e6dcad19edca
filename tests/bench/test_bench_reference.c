/* Pictures of full detail in the cache of ecobench. */
#include <stdlib.h>
#include <string.h>

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
	struct bench_reference r = { .ceiling = 0.875, .summaries = 7 };
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

UNIT_TEST(what_is_kept_is_read_again_unless_it_is_damaged)
{
	for (int soft = 0; soft < 2; soft++) {
		struct bench_reference kept = make(soft), read;
		struct eco_error error = { 0 };
		size_t size;
		assert_ok(bench_reference_write(in_root("references/one"), &kept, &error), error);
		assert_true(bench_reference_read(in_root("references/one"), &read));
		const struct view_picture *a = &kept.picture, *b = &read.picture;
		assert_memory_equal(a->rgb, b->rgb, 3 * PIXELS);
		assert_memory_equal(a->cover, b->cover, PIXELS);
		assert_memory_equal(a->owner, b->owner, PIXELS * sizeof *a->owner);
		assert_memory_equal(a->depth, b->depth, PIXELS * sizeof *a->depth);
		assert_memory_equal(a->surface, b->surface, PIXELS * sizeof *a->surface);
		assert_true(soft ? !memcmp(a->soft, b->soft, PIXELS) : !b->soft);
		assert_true(a->width == b->width && a->height == b->height && a->vertices == b->vertices
			&& a->draw_ms == b->draw_ms && read.ceiling == 0.875 && read.summaries == 7);
		view_picture_free(&kept.picture);
		view_picture_free(&read.picture);
		uint8_t *bytes = file_read(in_root("references/one"), &size);
		for (size_t at = 0; soft && at < size; at += 7) {
			file_write(in_root("damaged"), bytes, at);
			assert_false(bench_reference_read(in_root("damaged"), &read));
			bytes[at] ^= 0x10;
			file_write(in_root("damaged"), bytes, size);
			assert_false(bench_reference_read(in_root("damaged"), &read));
			bytes[at] ^= 0x10;
		}
		free(bytes);
	}
}

/* Another content, view or kind of counts is another picture; a pack of another origin has none. */
UNIT_TEST(names_follow_from_content_view_and_counts)
{
	static const struct { const char *holds; double x; bool sees; } cases[] = { { "0123456789abcdef", 1,
		true },
		{ "0123456789abcdef", 1, false }, { "0123456789abcdef", 1.5, true }, { "0123456789abcdee", 1,
		true } };
	enum { CASES = sizeof cases / sizeof *cases };
	char path[CASES][BENCH_REFERENCE_PATH], again[BENCH_REFERENCE_PATH], stamp[80];
	struct bench bench = { .cache = "cache", .build = "build" };
	for (int i = 0; i < CASES; i++) {
		struct eco_view view = { .eye = { cases[i].x, 2, 3 }, .fov_y_deg = 45, .width = WIDTH, .height
			= HEIGHT };
		snprintf(stamp, sizeof stamp, "-\nholds %s\ntook 1 1\n", cases[i].holds);
		file_write_text(in_root("pack.eco.stamp"), stamp);
		assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, cases[i].sees, path[i]));
		assert_true(bench_reference_path(&bench, in_root("pack.eco"), &view, cases[i].sees, again));
		assert_string_equal(path[i], again);
		for (int k = 0; k < i; k++)
			assert_string_not_equal(path[i], path[k]);
		assert_false(bench_reference_path(&bench, in_root("other.eco"), &view, true, again));
	}
}

int main(void)
{
	return unit_tests_run(open_folder, close_folder);
}
