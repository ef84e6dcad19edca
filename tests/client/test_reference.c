/* The two ways to draw agree: OpenGL and the software rasteriser, pixel by pixel, mask and owners, and as
 * people see them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_reference.h"
#include "lod/build/texture.h"
#include "lod/tint.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define SEEN 0.005                       /* mean error that people see: textures are filtered in two ways */
#define TOLERANCE 0.0005                 /* of all pixels: vertices that floats snap to another 1/256 pixel */

static struct lod_texture texture;

/* A leaf-shaped picture: a disc with holes. */
static void make_texture(void)
{
	static uint8_t rgba[64 * 48 * 4];
	struct eco_image image = { 64, 48, rgba };
	struct eco_model model = { .images = &image, .image_count = 1 };
	for (int y = 0; y < 48; y++)
		for (int x = 0; x < 64; x++) {
			uint8_t *p = rgba + 4 * (y * 64 + x);
			int d = (x - 32) * (x - 32) + (y - 24) * (y - 24);
			p[0] = 60, p[1] = (uint8_t)(100 + x), p[2] = 40;
			p[3] = d < 500 && (x / 6 + y / 6) % 5 ? 255 : 0;
		}
	assert_good(lod_texture_make(&texture, &model, 0, &cause));
	assert_int_equal(texture.count, 2);
}

static int open_all(void **state)
{
	make_texture();
	static struct eco_bytes levels[2][2];
	for (uint32_t i = 0; i < texture.count; i++) {
		/* a strip each, behind its size */
		levels[0][i] = (struct eco_bytes){ texture.colors[i].bytes + 4, texture.colors[i].size - 4 };
		levels[1][i] = (struct eco_bytes){ texture.outlines[i].bytes + 4, texture.outlines[i].size - 4 };
	}
	scene_make(&grove, (const struct eco_bytes *const[2]){ levels[0], levels[1] }, texture.count);
	return scene_open_gl(state);
}

static int close_all(void **state)
{
	lod_texture_free(&texture);
	return scene_close(state);
}

static void draw_software(const struct scene_held *d, const struct eco_view *view, uint32_t threads,
	struct view_picture *picture)
{
	struct view_draw_job job = { d->store, &d->selection, &d->eye, 0.1, threads, NULL,
		VIEW_TINT_NONE, 1, false };
	assert_int_equal(view_picture_init(picture, view->width, view->height, NULL), ECO_OK);
	assert_int_equal(view_reference_draw(&job, picture, NULL), ECO_OK);
}

UNIT_TEST(opengl_and_software_agree)
{
	static const double eyes[][6] = { { -22, -19, 6.5, 0, 0, 2.5 }, { 0, -40, 30, 0, 0, 0 },
		{ 2, 1, 1.7, 9, 9, 3 }, { 4, -3, 40, 4.1, -3, 0 },
		{ 30, 3, 2, 0, 0, 4 } };
	if (!scene_gl)
		skip();
	for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
		struct eco_view view = scene_view();
		char name[32];
		memcpy(view.eye, eyes[i], sizeof view.eye);
		memcpy(view.target, eyes[i] + 3, sizeof view.target);
		AT_END(scene_release) struct scene_held d = scene_hold_view(&grove, view, 1);
		scene_select(&d);
		FREED(view_picture) soft = scene_draw(&d, false, VIEW_TINT_NONE),
		hard = scene_draw(&d, true, VIEW_TINT_NONE);
		struct picture_difference apart = picture_compare(&soft, &hard);
		print_message("view %zu: %llu vertices, masks differ in %.4f %%, owners in %.4f %% of "
			"pixels, bytes by %.4f, error seen %.5f\n", i, (unsigned long long)hard.vertices,
			100 * apart.masks, 100 * apart.owners, apart.bytes, apart.seen);
		snprintf(name, sizeof name, "reference-gl-%zu", i);
		picture_save(name, &hard);
		snprintf(name, sizeof name, "reference-cpu-%zu", i);
		picture_save(name, &soft);
		assert_true(apart.masks <= TOLERANCE && apart.owners <= TOLERANCE && apart.seen <= SEEN
			&& apart.bytes < 0.1);
		assert_true(hard.vertices == d.plan.vertices && soft.vertices == d.plan.vertices);
	}
}

/* Mean difference of bytes, and its part that has one sign. */
static void differ(const struct view_picture *a, const struct view_picture *b, double mean[2])
{
	size_t bytes = 3 * (size_t)a->width * a->height;
	mean[0] = mean[1] = 0;
	for (size_t i = 0; i < bytes; i++) {
		double apart = (double)a->rgb[i] - b->rgb[i];
		mean[0] += fabs(apart) / (double)bytes;
		mean[1] += apart / (double)bytes;
	}
}

/* Colours are nearer to those of many samples the more there are; all else is the first sample's. Engines
 * agree, and threads and parts leave no trace. */
UNIT_TEST(samples_are_averaged)
{
	static const uint32_t counts[] = { 1, 4, 8, 16 };
	AT_END(scene_release) struct scene_held d = scene_hold(&grove);
	scene_select(&d);
	struct view_draw_job job = { d.store, &d.selection, &d.eye, 0.1, 2, NULL, VIEW_TINT_NONE, 1, false };
	FREED(view_picture) one, some, fine, other;
	size_t pixels = (size_t)d.view.width * d.view.height;
	struct view_picture *const pictures[4] = { &one, &some, &fine, &other };
	for (int i = 0; i < 4; i++)
		assert_good(view_picture_init(pictures[i], d.view.width, d.view.height, &cause));
	assert_good(view_reference_fine(&job, 8, &fine, &cause));
	job.threads = 3;
	assert_good(view_reference_fine(&job, 8, &other, &cause));
	assert_memory_equal(fine.rgb, other.rgb, 3 * pixels);
	double apart[2], before = INFINITY;
	for (int i = 0; i < 4; i++) {
		job.samples = counts[i];
		assert_good(view_reference_draw(&job, i ? &some : &one, &cause));
		differ(i ? &some : &one, &fine, apart);
		print_message("%u samples: %.3f from 64, %.3f with its sign\n", counts[i], apart[0], apart[1]);
		/* the byte of a mean of light is above the mean of bytes */
		assert_true(apart[0] < 0.75 * before && fabs(apart[1]) <= 1);
		before = apart[0];
	}
	assert_memory_equal(one.owner, some.owner, pixels * sizeof *one.owner);
	assert_memory_equal(one.cover, some.cover, pixels);
	assert_memory_equal(one.owner, fine.owner, pixels * sizeof *one.owner);
	if (!scene_gl)
		return;
	assert_good(view_gl_draw(scene_gl, &job, &other, &cause));
	struct picture_difference engines = picture_compare(&some, &other);
	print_message("engines: masks %.5f, bytes %.4f, seen %.5f\n", engines.masks, engines.bytes, engines.seen);
	assert_true(engines.masks <= TOLERANCE && engines.seen <= SEEN && engines.bytes < 0.3);
}

static uint64_t sum_of(const uint8_t *counts, uint32_t pixels)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < pixels; i++)
		sum += counts[i];
	return sum;
}

/* One sample a pixel is the mask; more are about as many; parts and threads leave no trace. Drawing stops when told. */
UNIT_TEST(samples_count_what_is_covered)
{
	struct eco_view view = scene_view();
	FREED(view_picture) p;
	uint32_t pixels = view.width * view.height;
	uint8_t *counts = malloc(2 * (size_t)pixels), *again = counts + pixels;
	AT_END(scene_release) struct scene_held d = scene_hold_view(&grove, view, 1);
	scene_select(&d);
	draw_software(&d, &view, 2, &p);
	struct view_draw_job job = { d.store, &d.selection, &d.eye, 0.1, 1, NULL, VIEW_TINT_NONE, 1, false };
	struct view_coverage coverage = { view.width, view.height, 1, counts };
	assert_int_equal(view_reference_count(&job, &coverage, NULL), ECO_OK);
	for (uint32_t i = 0; i < pixels; i++)
		assert_int_equal(counts[i], p.cover[i] != 0);
	FREED(view_picture) other;
	draw_software(&d, &view, 5, &other);
	assert_memory_equal(p.owner, other.owner, pixels * sizeof *p.owner);
	assert_memory_equal(p.rgb, other.rgb, 3 * pixels);
	static volatile sig_atomic_t stop = 1;
	job.stop = &stop;
	assert_int_equal(view_reference_draw(&job, &other, NULL), ECO_INTERRUPTED);
	job.stop = NULL;
	double covered = (double)sum_of(counts, pixels);
	for (coverage.samples = 4; coverage.samples <= 8; coverage.samples += 4) {
		coverage.count = counts;
		job.threads = 1;
		assert_int_equal(view_reference_count(&job, &coverage, NULL), ECO_OK);
		coverage.count = again;
		job.threads = 3;
		assert_int_equal(view_reference_count(&job, &coverage, NULL), ECO_OK);
		assert_memory_equal(counts, again, pixels);
		double samples = (double)sum_of(counts, pixels) / (coverage.samples * coverage.samples);
		assert_true(samples > 0.99 * covered && samples < 1.01 * covered);
	}
	free(counts);
}

/* ---- Tints ---- */

static const uint8_t tints[4][3] = { { 200, 30, 30 }, { 40, 60, 220 }, { 240, 220, 60 }, { 0, 0, 0 } };

/* The grove, whose trees have one of four tints each; `code`: of the first of them. */
static void make_tinted(struct scene_builder *b, int32_t code)
{
	scene_make(b, NULL, 0);
	struct eco_elements *e = &b->elements[L_TREES];
	int32_t *extra = malloc(e->element_count * 3 * sizeof *extra);
	for (uint32_t i = 0; i < e->element_count; i++) {
		extra[3 * i] = i ? (int32_t)(1 + i % 4) : code;
		memcpy(extra + 3 * i + 1, e->extra + 2 * i, 2 * sizeof *extra);
	}
	free(e->extra);
	e->extra = extra;
	e->extra_count = 3;
	b->lists[L_TREES].attributes |= ECO_ATTR_COLOR;
	b->lists[L_TREES].palette_first = b->scene.palette_count;
	b->lists[L_TREES].palette_count = 4;
	scene_add_colors(b, tints, 4);
	b->scene.needs |= ECO_NEED_TINTS;
	scene_encode(b);
}

static const struct view_instance *instance_at(const struct view_selection *s, uint64_t owner)
{
	for (uint32_t i = 0; i < s->instance_count; i++)
		if (owner && s->instances[i].owner == owner)
			return &s->instances[i];
	return NULL;
}

/* Pixels of each class have the tint's mix with what they are without it, or, if wood, stay; in all forms of
 * the trees, and by both engines. The last class keeps its colours, and so do bushes and summaries. */
UNIT_TEST(tints_mix_with_the_colour_of_what_is_no_wood)
{
	struct scene_builder b, plain;
	make_tinted(&b, 1);
	scene_make(&plain, NULL, 0);
	AT_END(scene_release) struct scene_held d = scene_hold(&b), without = scene_hold(&plain);
	scene_select(&d);
	scene_select(&without);
	assert_true(view_store_needs(d.store) & ECO_NEED_TINTS);
	for (int by_gl = 0; by_gl <= (scene_gl != NULL); by_gl++) {
		FREED(view_picture) tinted = scene_draw(&d, by_gl, VIEW_TINT_OWN), own = scene_draw(&without, by_gl, VIEW_TINT_OWN);
		uint32_t mixed[4] = { 0 }, kept[4] = { 0 }, others = 0;
		double sum[4][3] = { { 0 } };
		for (uint32_t i = 0; i < own.width * own.height; i++) {
			const uint8_t *now = tinted.rgb + 3 * i, *before = own.rgb + 3 * i;
			const struct view_instance *tree = instance_at(&d.selection, own.owner[i]);
			assert_true(tinted.owner[i] == own.owner[i]);
			if (!tree || tree->list != L_TREES) {
				others += own.owner[i] != 0;
				assert_memory_equal(now, before, 3);
				continue;
			}
			uint32_t class = tree->index ? tree->index % 4 : 0;
			uint8_t expected[3];
			memcpy(expected, before, 3);
			lod_tint_apply(lod_tint_word(tints[class]), NULL, before, expected);
			bool same = memcmp(now, before, 3) == 0;
			for (int k = 0; k < 3; k++) {
				assert_true(same || abs(now[k] - expected[k]) <= 1);
				sum[class][k] += now[k];
			}
			kept[class] += same;
			mixed[class] += !same;
		}
		for (int c = 0; c < 4; c++) {
			uint32_t pixels = mixed[c] + kept[c];
			print_message("%s: class %d: %u pixels, %u kept, mean %.0f %.0f %.0f\n", by_gl ? "OpenGL" : "software", c,
				pixels, kept[c], sum[c][0] / pixels, sum[c][1] / pixels, sum[c][2] / pixels);
			assert_true(pixels > 500 && (c == 3 ? mixed[c] == 0 : mixed[c] > 9 * kept[c]));
		}
		assert_true(others > 500);
		assert_true(sum[0][0] > 1.5 * sum[0][1] && sum[1][2] > 1.5 * sum[1][0] && sum[2][1] > 1.3 * sum[2][2]);
	}
	scene_free(&b);
	scene_free(&plain);
}

/* A stream whose instance names a tint beyond its palette is refused. */
UNIT_TEST(a_tint_that_is_not_there_is_refused)
{
	struct scene_builder b;
	struct eco_view view = scene_view();
	struct eco_plan plan;
	make_tinted(&b, 5);
	scene_plan(&b, &view, 1, &plan);
	struct eco_error error = { 0 };
	assert_null(scene_store(&b, &plan, &error));
	assert_non_null(strstr(error.text, "colour outside its palette"));
	eco_plan_free(&plan);
	scene_free(&b);
}

UNIT_MAIN(open_all, close_all)
