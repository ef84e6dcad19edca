/* How far pictures are apart, as people see it:
 *
 *   apart REFERENCE.png PICTURE.png...
 *
 * A line a picture: its mean error (FLIP, lod/raster/flip.h; 0: the same); P and R of what is plant in it, if
 * both are drawn before a gray ground and a black sky (ecoview --tint own, web/tiles_picture.mjs). */
#include <stdio.h>
#include <stdlib.h>

#include "client-min/draw/view_light.h"
#include "ecofiles/format/image.h"
#include "lod/raster/flip.h"

/* The caller frees *rgb; NULL: no memory. */
static uint8_t *rgb_of(const struct eco_image *image)
{
	size_t pixels = (size_t)image->width * image->height;
	uint8_t *rgb = malloc(3 * pixels);
	for (size_t i = 0; rgb && i < 3 * pixels; i++)
		rgb[i] = image->rgba[i / 3 * 4 + i % 3];
	return rgb;
}

static bool is_plant(const uint8_t *rgb)
{
	return (rgb[0] != rgb[1] || rgb[1] != rgb[2]) || (rgb[0] && rgb[0] != VIEW_OWN_GROUND);
}

static enum eco_code say(const struct eco_image *image, const uint8_t *reference, const char *path,
	struct eco_error *error)
{
	double wrong, covered = 0, wanted = 0, both = 0;
	uint8_t *rgb = rgb_of(image);
	struct lod_flip_input input = { image->width, image->height, rgb, reference, NULL };
	enum eco_code code = rgb ? lod_flip(&input, &wrong, error)
		: eco_fail(error, ECO_NO_MEMORY, "%s: no memory", path);
	for (size_t i = 0; i < (size_t)image->width * image->height && !code; i++) {
		bool here = is_plant(rgb + 3 * i), there = is_plant(reference + 3 * i);
		covered += here;
		wanted += there;
		both += here && there;
	}
	if (!code)
		printf("%s: picture error %.4f, P %.4f, R %.4f\n", path, wrong, both / covered, both / wanted);
	free(rgb);
	return code;
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	struct eco_image first = { 0 };
	if (argc < 3) {
		fprintf(stderr, "usage: apart REFERENCE.png PICTURE.png...\n");
		return 2;
	}
	enum eco_code code = eco_image_read(&first, argv[1], &error);
	uint8_t *reference = code ? NULL : rgb_of(&first);
	for (int i = 2; i < argc && reference && !code; i++) {
		struct eco_image image = { 0 };
		code = eco_image_read(&image, argv[i], &error);
		if (!code && (image.width != first.width || image.height != first.height))
			code = eco_fail(&error, ECO_BAD_USAGE, "%s: %u x %u, the reference is %u x %u", argv[i],
				image.width, image.height, first.width, first.height);
		if (!code)
			code = say(&image, reference, argv[i], &error);
		eco_image_free(&image);
	}
	if (code)
		fprintf(stderr, "apart: %s\n", error.text);
	free(reference);
	eco_image_free(&first);
	return code || !reference;
}
