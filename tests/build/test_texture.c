/* Textures: what is written comes back, levels keep what is covered, and nobody gets texels that he cannot
 * see. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"
#include "ecofiles/format/texture.h"
#include "lod/build/texture.h"
#include "lod/light.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

#define SIDE 256u

static uint64_t state = 5;

/* Discs of one colour each on a clear ground of another. */
static struct eco_image leaves(uint32_t width, uint32_t height, uint32_t count)
{
	struct eco_image image = { width, height, malloc(4 * (size_t)width * height) };
	for (size_t i = 0; i < (size_t)width * height; i++)
		memcpy(image.rgba + 4 * i, "\xFF\x00\xFF\x20", 4);
	for (uint32_t n = 0; n < count; n++) {
		int x = (int)(lcg_bits(&state) % width), y = (int)(lcg_bits(&state) % height),
			r = 3 + (int)(lcg_bits(&state) % (width / 12));
		for (int v = y - r; v <= y + r; v++)
			for (int u = x - r; u <= x + r; u++)
				if (u >= 0 && v >= 0 && u < (int)width && v < (int)height
						&& (u - x) * (u - x) + (v - y) * (v - y) <= r * r)
					memcpy(image.rgba + 4 * ((size_t)v * width + (size_t)u),
						n % 2 ? "\x30\x70\x20\xFF" : "\x50\x90\x30\xFF", 4);
	}
	return image;
}

/* A square leaf of `side_m` with the whole image on it. */
struct card {
	struct eco_model model;
	struct eco_image image;
	struct eco_material material;
	float position[12], uv[8];
	uint32_t index[6], of[2];
};

static void card_make(struct card *c, struct eco_image image, float side_m)
{
	static const float uv[8] = { 0, 0, 1, 0, 1, 1, 0, 1 };
	static const uint32_t index[6] = { 0, 1, 2, 0, 2, 3 };
	*c = (struct card){ .image = image };
	memcpy(c->uv, uv, sizeof uv);
	memcpy(c->index, index, sizeof index);
	for (int i = 0; i < 4; i++) {
		c->position[3 * i] = side_m * uv[2 * i];
		c->position[3 * i + 2] = side_m * uv[2 * i + 1];
	}
	c->model = (struct eco_model){ .vertex_count = 4, .triangle_count = 2, .material_count = 1,
		.image_count = 1, .position = c->position, .uv = c->uv, .index = c->index, .material = c->of,
		.materials = &c->material, .images = &c->image };
}

static struct lod_texture make(struct card *c)
{
	struct lod_texture texture;
	assert_good(lod_texture_make(&texture, &c->model, 0, &cause));
	return texture;
}

/* A level from its strips; *largest (may be NULL): bytes of the largest. */
static struct eco_texture_part read_strips(const struct eco_writer *w, enum eco_list_kind kind, size_t *largest)
{
	struct eco_texture_part part = { 0 };
	struct eco_reader r = { .bytes = w->bytes, .size = w->size };
	while (r.at < r.size) {
		FREED(eco_texture_part) strip;
		size_t size = eco_read_u32(&r);
		assert_good(eco_texture_read(&strip, kind, eco_read_bytes(&r, size), size, &cause));
		assert_good(eco_texture_part_add(&part, &strip, &cause));
		if (largest)
			*largest = size > *largest ? size : *largest;
	}
	assert_false(r.failed);
	return part;
}

static struct eco_texture_part read_level(const struct lod_texture *texture, uint32_t i, bool outline)
{
	return read_strips(outline ? &texture->outlines[i] : &texture->colors[i],
		outline ? ECO_LIST_OUTLINE : ECO_LIST_IMAGE, NULL);
}

static double covered(const uint8_t *texels, size_t count, size_t step)
{
	size_t sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += texels[step * i] >= 128;
	return (double)sum / (double)count;
}

UNIT_TEST(impossible_parts_are_refused)
{
	static const uint8_t huge[9] = { 0xFF, 0xFF, 0xFF, 0x7F, 1 }, none[9] = { 0 },
		noise[40] = "RIFF\x20\0\0\0WEBPVP8 and then nothing at all";
	const struct eco_bytes bad[] = { { (uint8_t *)huge, 9 }, { (uint8_t *)none, 9 },
		{ (uint8_t *)huge, 3 } };
	struct eco_texture_part part;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(eco_texture_read(&part, ECO_LIST_OUTLINE, bad[i].at, bad[i].size, NULL), ECO_DAMAGED);
	assert_code(eco_texture_read(&part, ECO_LIST_IMAGE, noise, sizeof noise, &cause), ECO_DAMAGED, "WebP");
	assert_null(part.texels);
}

/* Noise takes more than a byte a texel. */
UNIT_TEST(large_levels_are_strips_of_few_bytes)
{
	struct eco_texture_part colors = { 400, 313, 3, malloc(3 * 400 * 313) },
		outline = { 400, 313, 1, malloc(400 * 313) };
	for (size_t i = 0; i < 3 * 400 * 313; i++)
		colors.texels[i] = (uint8_t)lcg_bits(&state);
	for (size_t i = 0; i < 400 * 313; i++)
		outline.texels[i] = lcg_bits(&state) & 1 ? 255 : 0;
	for (int k = 0; k < 2; k++) {
		const struct eco_texture_part *part = k ? &outline : &colors;
		FREED(eco_writer) w = { 0 };
		size_t largest = 0;
		assert_good(eco_texture_write_strips(&w, part, &cause));
		assert_true(w.size > (k ? 1 : 4) * ECO_TEXTURE_CHUNK_BYTES - ECO_TEXTURE_CHUNK_BYTES / 10);
		FREED(eco_texture_part) all = read_strips(&w, k ? ECO_LIST_OUTLINE : ECO_LIST_IMAGE, &largest);
		assert_true(largest <= ECO_TEXTURE_CHUNK_BYTES && all.width == 400 && all.height == 313);
		if (k)
			assert_memory_equal(all.texels, outline.texels, 400 * 313);
		all.height = 312;
		const struct eco_texture_part narrow = { 399, 1, all.channels, all.texels };
		assert_int_equal(eco_texture_part_add(&all, &narrow, NULL), ECO_DAMAGED);
		assert_int_equal(all.height, 312);
		/* more texels than a picture may have */
		struct eco_texture_part large = { ECO_TEXTURE_SIDE_MAX, ECO_PIXELS_MAX / ECO_TEXTURE_SIDE_MAX, 1, NULL };
		const struct eco_texture_part more = { ECO_TEXTURE_SIDE_MAX, 1, 1, all.texels };
		assert_int_equal(eco_texture_part_add(&large, &more, NULL), ECO_DAMAGED);
	}
	eco_texture_part_free(&colors);
	eco_texture_part_free(&outline);
}

UNIT_TEST(levels_halve_cover_as_much_and_are_what_payloads_hold)
{
	struct card card;
	FREED(lod_texture_levels) levels;
	card_make(&card, leaves(SIDE, SIDE / 2, 30), 2);
	FREED(lod_texture) texture = make(&card);
	lod_texture_levels_make(&levels, &card.model, 0);
	double all = covered(card.image.rgba + 3, SIDE * SIDE / 2, 4);
	assert_int_equal(texture.count, 4);      /* 32, 64, 128, 256 wide */
	assert_int_equal(levels.count, texture.count);
	assert_true(fabs((double)texture.texel_area / (2.0 * 2.0 / (SIDE * SIDE / 2)) - 1) < 1e-3);
	assert_true(levels.texel_area == texture.texel_area);
	for (uint32_t i = 0; i < texture.count; i++) {
		FREED(eco_texture_part) cut = read_level(&texture, i, true),
			seen = read_level(&texture, i, false);
		const struct eco_texture_part *colors = &levels.levels[i].colors;
		/* a strip each, behind its size */
		const struct eco_bytes payload[2] = { { texture.colors[i].bytes + 4, texture.colors[i].size - 4 },
			{ texture.outlines[i].bytes + 4, texture.outlines[i].size - 4 } };
		FREED(eco_writer) w = { 0 };
		size_t count = (32u << i) * (16u << i);
		double squares = 0;
		assert_true(cut.width == 32u << i && cut.height == 16u << i);
		assert_true(seen.width == cut.width && seen.height == cut.height);
		assert_true(colors->width == cut.width && colors->height == cut.height);
		assert_true(fabs(covered(cut.texels, count, 1) - all) < 0.01);
		assert_memory_equal(levels.levels[i].outline.texels, cut.texels, count);
		/* leaves are green, and what lies around them is: nothing of the clear texels' own colour */
		for (size_t k = 0; k < count; k++)
			assert_true(seen.texels[3 * k] < seen.texels[3 * k + 1]);
		for (size_t k = 0; k < 3 * count; k++)
			squares += pow(colors->texels[k] - seen.texels[k], 2);
		assert_true(sqrt(squares / (3 * (double)count)) < 12);
		assert_good(eco_texture_write_colors(&w, colors, &cause));
		assert_int_equal(w.size, payload[0].size);
		assert_memory_equal(w.bytes, payload[0].at, w.size);
		/* cut off anywhere it is refused, or another outline of the same size */
		for (size_t size = 0; size < payload[1].size; size += 1 + payload[1].size / 9) {
			struct eco_texture_part part;
			if (!eco_texture_read(&part, ECO_LIST_OUTLINE, payload[1].at, size, NULL))
				eco_texture_part_free(&part);
		}
		for (int outline = 0; outline < 2; outline++) {
			assert_true(eco_texture_texels(payload[outline].at, payload[outline].size, outline) == count);
			assert_true(eco_texture_texels(payload[outline].at, 5, outline) == 0);
		}
	}
	free(card.image.rgba);
}

UNIT_TEST(texels_that_no_view_resolves_are_left_out)
{
	/* .767 mm a pixel: a leaf of 10 cm shows 130 texels */
	static const struct { float side_m; uint32_t width; } cases[] = { { 10, SIDE }, { 0.19f, SIDE },
		{ 0.1f, SIDE }, { 0.09f, SIDE / 2 }, { 0.02f, 32 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct card card;
		card_make(&card, leaves(SIDE, SIDE, 20), cases[i].side_m);
		FREED(lod_texture) texture = make(&card);
		FREED(eco_texture_part) last = read_level(&texture, texture.count - 1, true);
		assert_int_equal(last.width, cases[i].width);
		double side = (double)cases[i].side_m / last.width;
		assert_true(fabs((double)texture.texel_area / (side * side) - 1) < 1e-3);
		free(card.image.rgba);
	}
}

UNIT_TEST(any_shape_and_nothing_opaque)
{
	static const uint32_t sides[][2] = { { 300, 1 }, { 1, 300 }, { 40, 8 }, { 33, 31 } };
	for (size_t i = 0; i < sizeof sides / sizeof *sides; i++)
		for (int opaque = 0; opaque < 3; opaque++) {
			struct card card;
			size_t count = (size_t)sides[i][0] * sides[i][1];
			struct eco_image image = { sides[i][0], sides[i][1], calloc(count, 4) };
			for (size_t k = 0; k < count; k++)
				memcpy(image.rgba + 4 * k, "\x40\x80\x20\x00", 4);
			for (size_t k = 0; k < count && opaque; k += opaque == 1 ? 3 : 1)
				image.rgba[4 * k + 3] = 255;
			card_make(&card, image, 5);
			FREED(lod_texture) texture = make(&card);
			assert_true((opaque == 2) == !texture.outlines);
			FREED(eco_texture_part) first = read_level(&texture, 0, opaque < 2);
			assert_true(first.width <= 32 && first.height <= 32);
			size_t texels = (size_t)first.width * first.height;
			double now = opaque < 2 ? covered(first.texels, texels, 1) : 1;
			assert_true(opaque == 0 ? now == 0 : now > 0.1);
			free(image.rgba);
		}
}

/* Mean light of the opaque texels, and their share. */
static double mean_of(const struct eco_image *image, double light[3])
{
	double opaque = 0, texels = (double)image->width * image->height;
	memset(light, 0, 3 * sizeof *light);
	for (size_t i = 0; i < (size_t)texels; i++)
		if (image->rgba[4 * i + 3] >= 128) {
			opaque++;
			for (int k = 0; k < 3; k++)
				light[k] += lod_light_of[image->rgba[4 * i + (size_t)k]];
		}
	for (int k = 0; k < 3; k++)
		light[k] /= opaque;
	return opaque / texels;
}

UNIT_TEST(a_smaller_image_has_the_same_light_and_as_much_of_it_opaque)
{
	struct eco_image image = leaves(SIDE, SIDE / 2, 20);
	double before[3], after[3], share = mean_of(&image, before);
	lod_texture_shrink(&image, SIDE);
	assert_int_equal(image.width, SIDE);
	lod_texture_shrink(&image, 50);
	assert_int_equal(image.width, SIDE / 8);
	assert_int_equal(image.height, SIDE / 16);
	assert_true(fabs(mean_of(&image, after) / share - 1) < 0.02);
	for (int k = 0; k < 3; k++)
		assert_true(fabs(after[k] / before[k] - 1) < 0.02);
	free(image.rgba);
}
