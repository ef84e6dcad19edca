#include "client-min/draw/view_picture.h"

#include <stdlib.h>
#include <string.h>

enum eco_code view_picture_init(struct view_picture *picture, uint32_t width, uint32_t height,
	struct eco_error *error)
{
	size_t pixels = (size_t)width * height;
	*picture = (struct view_picture){ .width = width, .height = height };
	picture->rgb = calloc(pixels, 3);
	picture->cover = calloc(pixels, 1);
	picture->owner = calloc(pixels, sizeof *picture->owner);
	picture->depth = calloc(pixels, sizeof *picture->depth);
	picture->surface = calloc(pixels, sizeof *picture->surface);
	if (picture->rgb && picture->cover && picture->owner && picture->depth && picture->surface)
		return ECO_OK;
	view_picture_free(picture);
	return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture of %u x %u pixels", width, height);
}

void view_picture_free(struct view_picture *picture)
{
	free(picture->rgb);
	free(picture->cover);
	free(picture->owner);
	free(picture->depth);
	free(picture->surface);
	free(picture->soft);
	*picture = (struct view_picture){ 0 };
}

void view_picture_compare(const uint8_t *cover, const uint8_t *reference, uint32_t pixels, uint8_t *rgb)
{
	/* legible to most colour-blind people: light for right, orange for too much, blue for missing */
	static const uint8_t colors[4][3] = { { 0, 0, 0 }, { 245, 130, 32 }, { 40, 110, 255 },
		{ 235, 240, 225 } };
	for (uint32_t i = 0; i < pixels; i++)
		memcpy(rgb + 3 * (size_t)i, colors[(cover[i] != 0) + 2 * (reference[i] != 0)], 3);
}

void view_picture_owners(const struct view_picture *picture, uint8_t *rgb)
{
	size_t count = (size_t)picture->width * picture->height;
	for (size_t i = 0; i < count; i++) {
		uint64_t color = picture->owner[i] * 0x9E3779B97F4A7C15u >> 40;
		color |= picture->owner[i] && !color;
		for (int k = 0; k < 3; k++)
			rgb[3 * i + (size_t)k] = (uint8_t)(color >> 8 * k);
	}
}
