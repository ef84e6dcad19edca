#include "tests/bench/bench_texels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/format/image.h"

#define PATH 1200
#define FILE_MOST (256u << 20)      /* bytes */

const char *const texels_names[TEXELS_CODERS] = { "WebP as stored", "AVIF 4:2:0", "AVIF 4:4:4",
	"JPEG XL" };

/* WebP's quality, AVIF's quantizer, JPEG XL's distance */
static const double settings[TEXELS_CODERS][TEXELS_SETTINGS] = { { ECO_TEXTURE_QUALITY },
	{ 56, 46, 36, 27, 19, 11, 3 }, { 60, 52, 42, 32, 23, 14, 5 },
	{ 8, 4.5, 2.6, 1.5, 0.8, 0.4, 0.1 } };

/* ---- Figures ---- */

double texels_error(const struct eco_texture_part *a, const struct eco_texture_part *b,
	const struct eco_texture_part *outline)
{
	double squares = 0, count = 0;
	for (size_t i = 0; i < (size_t)a->width * a->height; i++)
		for (uint32_t k = 0; k < 3 && outline->texels[i]; k++, count++) {
			double off = a->texels[a->channels * i + k] - (double)b->texels[b->channels * i + k];
			squares += off * off;
		}
	return sqrt(squares / count);
}

double texels_bytes_at(const struct texels_trial *trials, uint32_t count, double error, uint32_t *nearest)
{
	const struct texels_trial *above = NULL, *below = NULL;
	for (uint32_t i = 0; i < count; i++) {
		const struct texels_trial *t = &trials[i];
		if (t->error >= error && (!above || t->error < above->error))
			above = t;
		if (t->error <= error && (!below || t->error > below->error))
			below = t;
	}
	if (!above || !below || !(below->error > 0) || !(error > 0))
		return NAN;
	double span = log(above->error / below->error),
		share = span > 0 ? log(error / below->error) / span : 0;
	*nearest = (uint32_t)((share > 0.5 ? above : below) - trials);
	return below->bytes * pow(above->bytes / below->bytes, share);
}

size_t texels_avif_head(const uint8_t *bytes, size_t size)
{
	for (size_t at = 0, box; at + 8 <= size; at += box) {
		box = (size_t)bytes[at] << 24 | (size_t)bytes[at + 1] << 16 | (size_t)bytes[at + 2] << 8
			| bytes[at + 3];
		if (box < 8 || box > size - at)
			break;
		if (!memcmp(bytes + at + 4, "mdat", 4))
			return size - (box - 8);
	}
	return 0;
}

/* ---- WebP ---- */

static enum eco_code code_webp(struct texels_trial *trial, const struct eco_texture_part *colors,
	struct eco_texture_part *back, struct eco_error *error)
{
	struct eco_writer w = { 0 };
	enum eco_code code = eco_texture_write_colors(&w, colors, settings[TEXELS_WEBP][0], error);
	if (!code)
		code = eco_texture_read_colors(back, w.bytes, w.size, error);
	trial->bytes = (double)w.size;
	eco_writer_free(&w);
	return code;
}

/* ---- Programs ---- */

bool texels_coder_is_there(enum texels_coder coder)
{
	if (coder == TEXELS_WEBP)
		return true;
	return !system(coder == TEXELS_JXL ? "{ command -v cjxl && command -v djxl; } >/dev/null 2>&1"
		: "{ command -v avifenc && command -v avifdec; } >/dev/null 2>&1");
}

/* BASE.png becomes BASE.coded and, back from that, BASE.back. */
static enum eco_code run_programs(struct bench *bench, enum texels_coder coder, const char *base, double value,
	struct eco_error *error)
{
	if (coder == TEXELS_JXL)
		return bench_command(bench, error, "cd '%s' && cjxl --quiet --num_threads=0 --container=0 -d %g "
			"%s.png %s.coded 2>/dev/null && djxl --quiet --num_threads=0 %s.coded %s.ppm && "
			"mv %s.ppm %s.back", bench->cache, value, base, base, base, base, base, base);
	return bench_command(bench, error, "cd '%s' && avifenc -j 1 -c aom -s 6 -y %s --min 0 --max 63 -a "
		"end-usage=q -a cq-level=%g -o %s.coded %s.png >/dev/null && avifdec -j 1 -c dav1d "
		"--png-compress 0 %s.coded %s.out.png >/dev/null && mv %s.out.png %s.back", bench->cache,
		coder == TEXELS_AVIF_420 ? "420" : "444", value, base, base, base, base, base, base);
}

static enum eco_code weigh(struct texels_trial *trial, enum texels_coder coder, const char *base,
	struct eco_error *error)
{
	char path[PATH + 8];
	size_t size = 0;
	snprintf(path, sizeof path, "%s.coded", base);
	FILE *file = fopen(path, "rb");
	uint8_t *bytes = file ? malloc(FILE_MOST) : NULL;
	if (bytes)
		size = fread(bytes, 1, FILE_MOST, file);
	if (file)
		fclose(file);
	trial->bytes = (double)size;
	trial->head = bytes && coder != TEXELS_JXL ? (double)texels_avif_head(bytes, size) : 0;
	free(bytes);
	return size && size < FILE_MOST ? ECO_OK : eco_fail(error, ECO_IO, "%s: nothing is there, or more "
		"than %u bytes", path, FILE_MOST);
}

static enum eco_code read_back(struct eco_texture_part *back, const char *base, struct eco_error *error)
{
	char path[PATH + 8];
	struct eco_image image;
	snprintf(path, sizeof path, "%s.back", base);
	enum eco_code code = eco_image_read(&image, path, error);
	if (!code)
		*back = (struct eco_texture_part){ image.width, image.height, 4, image.rgba };
	return code;
}

static enum eco_code code_program(struct texels_trial *trial, struct bench *bench, enum texels_coder coder,
	const struct eco_texture_part *colors, struct eco_texture_part *back, uint32_t setting,
	struct eco_error *error)
{
	char name[32], base[PATH], path[PATH + 8];
	snprintf(name, sizeof name, "texels-%ld", (long)getpid());
	snprintf(base, sizeof base, "%s/%s", bench->cache, name);
	snprintf(path, sizeof path, "%s.png", base);
	enum eco_code code = eco_png_write(&(struct eco_pixels){ colors->width, colors->height, 3,
		colors->texels }, path, error);
	if (!code)
		code = run_programs(bench, coder, name, settings[coder][setting], error);
	if (!code)
		code = weigh(trial, coder, base, error);
	if (!code)
		code = read_back(back, base, error);
	for (size_t i = 0; i < 3; i++) {
		snprintf(path, sizeof path, "%s%s", base, (const char *const[]){ ".png", ".coded", ".back" }[i]);
		unlink(path);
	}
	return code;
}

enum eco_code texels_code(struct texels_trial *trial, struct bench *bench, enum texels_coder coder,
	const struct eco_texture_part *colors, const struct eco_texture_part *outline, uint32_t setting,
	struct eco_error *error)
{
	struct eco_texture_part back = { 0 };
	*trial = (struct texels_trial){ 0 };
	enum eco_code code = coder == TEXELS_WEBP ? code_webp(trial, colors, &back, error)
		: code_program(trial, bench, coder, colors, &back, setting, error);
	if (!code && (back.width != colors->width || back.height != colors->height))
		code = eco_fail(error, ECO_DAMAGED, "%s: %u x %u texels became %u x %u", texels_names[coder],
			colors->width, colors->height, back.width, back.height);
	if (!code)
		trial->error = texels_error(colors, &back, outline);
	eco_texture_part_free(&back);
	return code;
}
