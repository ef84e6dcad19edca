#include "lod/build/texture.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/list.h"
#include "lod/arena.h"
#include "lod/light.h"
#include "lod/vector.h"

#define TEXTURE_SMALLEST 32u             /* longest side of the first level, at most */
#define PIXEL_M 0.00076706               /* 2 tan(22.5 degrees) / 1080, 1 m away */
#define COARSE_AREA 0.01                 /* share of the textured area that may have larger ones */
#define OPAQUE 128
#define LEVELS_MAX 33                    /* down to a single texel */

#define WHOLE 65535u

/* Light, and the share that is opaque, both in 1/65535. Clear texels have light where they were filled. */
struct texel { uint16_t light[3], share; };
struct level { uint32_t width, height; struct texel *texels; };

static size_t count_of(const struct level *level) { return (size_t)level->width * level->height; }

static struct level level_like(uint32_t width, uint32_t height, struct lod_arena *arena)
{
	return (struct level){ width, height,
		lod_arena_take(arena, (size_t)width * height, sizeof(struct texel)) };
}

/* ---- Levels ---- */

static struct level first_level(const struct eco_image *image, struct lod_arena *arena)
{
	struct level level = level_like(image->width, image->height, arena);
	for (size_t i = 0; i < count_of(&level); i++) {
		level.texels[i].share = image->rgba[4 * i + 3] >= OPAQUE ? WHOLE : 0;
		for (int k = 0; k < 3; k++)
			level.texels[i].light[k] = lod_light_of[image->rgba[4 * i + k]];
	}
	return level;
}

/* Each texel is the mean of up to four, by how much of them is opaque. */
static struct level pull(const struct level *fine, struct lod_arena *arena)
{
	struct level coarse = level_like((fine->width + 1) / 2, (fine->height + 1) / 2, arena);
	for (uint32_t y = 0; y < coarse.height; y++)
		for (uint32_t x = 0; x < coarse.width; x++) {
			struct texel *mean = &coarse.texels[(size_t)y * coarse.width + x];
			uint64_t sum[3] = { 0 }, weight = 0, of = 0;
			for (uint32_t v = 2 * y; v < 2 * y + 2 && v < fine->height; v++)
				for (uint32_t u = 2 * x; u < 2 * x + 2 && u < fine->width; u++, of++) {
					const struct texel *texel = &fine->texels[(size_t)v * fine->width
						+ u];
					for (int k = 0; k < 3; k++)
						sum[k] += (uint64_t)texel->share * texel->light[k];
					weight += texel->share;
				}
			for (int k = 0; k < 3 && weight; k++)
				mean->light[k] = (uint16_t)((sum[k] + weight / 2) / weight);
			mean->share = (uint16_t)((weight + of - 1) / of);
		}
	return coarse;
}

/* Clear texels take the light of the coarser level. */
static void push(const struct level *coarse, const struct level *fine)
{
	for (uint32_t y = 0; y < fine->height; y++)
		for (uint32_t x = 0; x < fine->width; x++) {
			struct texel *texel = &fine->texels[(size_t)y * fine->width + x];
			if (!texel->share)
				memcpy(texel->light, coarse->texels[(size_t)(y / 2) * coarse->width + x / 2]
					.light, sizeof texel->light);
		}
}

/* From finest to a single texel. */
static uint32_t make_levels(struct level *levels, const struct eco_image *image, struct lod_arena *arena)
{
	uint32_t count = 1;
	levels[0] = first_level(image, arena);
	for (; levels[count - 1].width > 1 || levels[count - 1].height > 1; count++)
		levels[count] = pull(&levels[count - 1], arena);
	for (uint32_t i = count - 1; i > 0 && levels[count - 1].texels[0].share; i--)
		push(&levels[i], &levels[i - 1]);
	return count;
}

/* ---- Outlines ---- */

/* Opaque or clear, so that as much is opaque as shares say, everywhere: what a texel is too much or too
 * little is given to those after it (Floyd and Steinberg 1976). `errors`: two rows of width + 2. */
static void diffuse(const struct level *level, int32_t *errors, uint8_t *texels)
{
	for (uint32_t y = 0; y < level->height; y++) {
		int32_t *here = errors + (y % 2) * (level->width + 2) + 1,
			*below = errors + (1 - y % 2) * (level->width + 2) + 1;
		memset(below - 1, 0, (level->width + 2) * sizeof *below);
		for (uint32_t x = 0; x < level->width; x++) {
			size_t at = (size_t)y * level->width + x;
			int32_t share = level->texels[at].share, wanted = share + here[x] / 16,
				opaque = share > 0 && (share == (int32_t)WHOLE
				|| 2 * wanted >= (int32_t)WHOLE), error = wanted - opaque * (int32_t)WHOLE;
			texels[at] = opaque ? 255 : 0;
			here[x + 1] += 7 * error;
			below[(int)x - 1] += 3 * error;
			below[x] += 5 * error;
			below[x + 1] += error;
		}
	}
}

static void parts_of(struct lod_texture_level *parts, const struct level *level, struct lod_arena *arena)
{
	parts->outline = (struct eco_texture_part){ level->width, level->height, 1, eco_alloc(count_of(level), 1) };
	parts->colors = (struct eco_texture_part){ level->width, level->height, 3, eco_alloc(count_of(level), 3) };
	diffuse(level, lod_arena_take(arena, 2 * ((size_t)level->width + 2), sizeof(int32_t)),
		parts->outline.texels);
	for (size_t i = 0; i < count_of(level); i++)
		for (int k = 0; k < 3; k++)
			parts->colors.texels[3 * i + k] = lod_light_byte(level->texels[i].light[k]);
}

/* ---- Texels on the plant ---- */

static double triangle_area(const struct eco_model *model, uint32_t t)
{
	struct lod_v3 p[3];
	for (int c = 0; c < 3; c++) {
		const float *at = model->position + 3 * (size_t)model->index[3 * (size_t)t + (size_t)c];
		p[c] = (struct lod_v3){ (double)at[0], (double)at[1], (double)at[2] };
	}
	struct lod_v3 n = lod_v3_cross(lod_v3_sub(p[1], p[0]), lod_v3_sub(p[2], p[0]));
	return sqrt(lod_v3_dot(n, n)) / 2;
}

static double triangle_texels(const struct eco_model *model, uint32_t t, const struct eco_image *image)
{
	double q[3][2];
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 2; k++)
			q[c][k] = (double)model->uv[2 * (size_t)model->index[3 * (size_t)t + (size_t)c]
				+ (size_t)k] * (k ? image->height : image->width);
	return fabs((q[1][0] - q[0][0]) * (q[2][1] - q[0][1])
		- (q[1][1] - q[0][1]) * (q[2][0] - q[0][0])) / 2;
}

/* The mean area of a texel, m^2; *spare: how many times the image can be halved before more than COARSE_AREA
 * of what it covers has texels larger than PIXEL_M. */
static double texel_area(const struct eco_model *model, uint32_t id, uint32_t *spare)
{
	double area = 0, texels = 0, coarse[ECO_TEXTURE_LEVELS_MAX] = { 0 };
	for (uint32_t t = 0; model->uv && t < model->triangle_count; t++) {
		if (model->materials[model->material[t]].image != id)
			continue;
		double a = triangle_area(model, t), n = triangle_texels(model, t, &model->images[id]);
		if (!(a > 0) || !(n > 0))
			continue;
		area += a;
		texels += n;
		double side = sqrt(a / n);
		for (uint32_t halved = 0; halved < ECO_TEXTURE_LEVELS_MAX; halved++, side *= 2)
			coarse[halved] += side > PIXEL_M ? a : 0;
	}
	for (*spare = 0; area > 0 && *spare + 1 < ECO_TEXTURE_LEVELS_MAX
			&& coarse[*spare + 1] <= COARSE_AREA * area; ++*spare)
		;
	return texels > 0 ? area / texels : 0;
}

/* ---- Levels that are kept ---- */

void lod_texture_levels_make(struct lod_texture_levels *kept, const struct eco_model *model, uint32_t id)
{
	struct lod_arena arena = { 0 };
	struct level levels[LEVELS_MAX];
	uint32_t finest, coarsest = 0, count = make_levels(levels, &model->images[id], &arena);
	double area = texel_area(model, id, &finest);
	while (levels[coarsest].width > TEXTURE_SMALLEST || levels[coarsest].height > TEXTURE_SMALLEST)
		coarsest++;
	finest = finest < coarsest ? finest : coarsest;
	while (levels[finest].width > ECO_TEXTURE_SIDE_MAX || levels[finest].height > ECO_TEXTURE_SIDE_MAX)
		finest++;
	assert(coarsest < count && coarsest - finest < ECO_TEXTURE_LEVELS_MAX);
	*kept = (struct lod_texture_levels){ .texel_area = (float)ldexp(area, (int)(2 * finest)) };
	for (uint32_t i = coarsest + 1; i-- > finest;)
		parts_of(&kept->levels[kept->count++], &levels[i], &arena);
	lod_arena_free(&arena);
}

/* ---- Smaller images ---- */

void lod_texture_shrink(struct eco_image *image, uint32_t side_most)
{
	struct lod_arena arena = { 0 };
	if (image->width <= side_most && image->height <= side_most)
		return;
	struct level level = first_level(image, &arena);
	while (level.width > side_most || level.height > side_most)
		level = pull(&level, &arena);
	uint8_t *opaque = lod_arena_take(&arena, count_of(&level), 1);
	diffuse(&level, lod_arena_take(&arena, 2 * ((size_t)level.width + 2), sizeof(int32_t)), opaque);
	image->width = level.width;
	image->height = level.height;
	for (size_t i = 0; i < count_of(&level); i++) {
		for (int k = 0; k < 3; k++)
			image->rgba[4 * i + (size_t)k] = lod_light_byte(level.texels[i].light[k]);
		image->rgba[4 * i + 3] = opaque[i];
	}
	lod_arena_free(&arena);
}

void lod_texture_levels_free(struct lod_texture_levels *levels)
{
	for (uint32_t i = 0; i < levels->count; i++) {
		eco_texture_part_free(&levels->levels[i].outline);
		eco_texture_part_free(&levels->levels[i].colors);
	}
	levels->count = 0;
}

/* ---- Chunks ---- */

/* The error of a level of half the texels, for struct lod_texture. */
static uint8_t loss_of(const struct eco_texture_part *coarse, const struct eco_texture_part *fine)
{
	uint64_t opaque = 0, wrong = 0;
	for (uint32_t y = 0; y < fine->height; y++)
		for (uint32_t x = 0; x < fine->width; x++) {
			uint8_t texel = fine->texels[(size_t)y * fine->width + x];
			opaque += texel != 0;
			wrong += texel != coarse->texels[(size_t)(y / 2) * coarse->width + x / 2];
		}
	uint64_t loss = opaque ? (wrong * ECO_LOSS_ONE + opaque) / (2 * opaque) : 0;
	return (uint8_t)(loss < 1 ? 1 : loss < ECO_LOSS_ONE ? loss : ECO_LOSS_ONE);
}

static enum eco_code write_levels(struct lod_texture *texture, const struct lod_texture_levels *levels,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < levels->count && !code; i++) {
		const struct lod_texture_level *level = &levels->levels[i];
		texture->count = i + 1;
		if (texture->outlines)
			code = eco_texture_write_strips(&texture->outlines[i], &level->outline, error);
		if (texture->outlines && i)
			texture->loss = loss_of(&level[-1].outline, &level->outline);
		if (!code)
			code = eco_texture_write_strips(&texture->colors[i], &level->colors, error);
	}
	return code;
}

enum eco_code lod_texture_make(struct lod_texture *texture, const struct eco_model *model, uint32_t id,
	struct eco_error *error)
{
	struct lod_texture_levels levels;
	bool holes = eco_image_has_holes(&model->images[id]);
	*texture = (struct lod_texture){ .colors = eco_alloc(ECO_TEXTURE_LEVELS_MAX, sizeof *texture->colors),
		.outlines = holes ? eco_alloc(ECO_TEXTURE_LEVELS_MAX, sizeof *texture->outlines) : NULL };
	lod_texture_levels_make(&levels, model, id);
	texture->texel_area = levels.texel_area;
	enum eco_code code = write_levels(texture, &levels, error);
	lod_texture_levels_free(&levels);
	if (code)
		lod_texture_free(texture);
	return code;
}

void lod_texture_free(struct lod_texture *texture)
{
	for (uint32_t i = 0; i < texture->count; i++) {
		eco_writer_free(&texture->colors[i]);
		if (texture->outlines)
			eco_writer_free(&texture->outlines[i]);
	}
	free(texture->colors);
	free(texture->outlines);
	*texture = (struct lod_texture){ 0 };
}

/* ---- Tiles of the ground's image ---- */

#define SIDE ECO_GROUND_IMAGE_SIDE

/* Half as wide and high, into `to` with rows of `stride` texels. */
static void halve(const uint8_t *from, uint32_t side, uint8_t *to, uint32_t stride)
{
	for (uint32_t y = 0; y < side / 2; y++)
		for (uint32_t x = 0; x < side / 2; x++) {
			uint8_t *out = to + 4 * ((size_t)y * stride + x);
			struct lod_light sum = { .weight = 0 };
			for (uint32_t k = 0; k < 4; k++) {
				const uint8_t *texel =
					from + 4 * ((size_t)(2 * y + k / 2) * side + 2 * x + k % 2);
				lod_light_add(&sum, texel, texel[3]);
			}
			memset(out, 0, 4);
			lod_light_mean(&sum, out);
			out[3] = (uint8_t)((sum.weight + 2) / 4);
		}
}

void lod_image_join(uint8_t *rgba, const uint8_t *const quarters[4])
{
	for (uint32_t q = 0; q < 4; q++)
		halve(quarters[q], SIDE,
			rgba + 4 * (size_t)((q / 2 ? 0 : SIDE / 2) * SIDE + q % 2 * (SIDE / 2)), SIDE);
}

/* Returns how many channels it takes: 3 where all is opaque. */
static uint32_t fill_clear(uint8_t *rgba, uint32_t side)
{
	struct lod_light sum = { .weight = 0 };
	uint8_t mean[3] = { 0, 0, 0 };
	uint32_t channels = 3;
	for (size_t i = 0; i < (size_t)side * side; i++) {
		lod_light_add(&sum, rgba + 4 * i, rgba[4 * i + 3]);
		channels = rgba[4 * i + 3] == 255 ? channels : 4;
	}
	lod_light_mean(&sum, mean);
	for (size_t i = 0; i < (size_t)side * side && channels == 4; i++)
		if (!rgba[4 * i + 3])
			memcpy(rgba + 4 * i, mean, 3);
	return channels;
}

static enum eco_code write_level(struct eco_writer *w, uint8_t *rgba, uint32_t side, struct eco_error *error)
{
	struct eco_texture_part part = { side, side, fill_clear(rgba, side), rgba };
	uint8_t *rgb = part.channels == 3 ? eco_alloc((size_t)side * side, 3) : rgba;
	for (size_t i = 0; i < (size_t)side * side && part.channels == 3; i++)
		memcpy(rgb + 3 * i, rgba + 4 * i, 3);
	part.texels = rgb;
	enum eco_code code = eco_texture_write_strips(w, &part, error);
	if (rgb != rgba)
		free(rgb);
	return code;
}

enum eco_code lod_image_levels(struct eco_writer *levels, const uint8_t *rgba, struct eco_error *error)
{
	uint8_t *now = eco_alloc((size_t)SIDE * SIDE, 4), *next = eco_alloc((size_t)SIDE * SIDE, 1);
	enum eco_code code = ECO_OK;
	uint32_t side = SIDE;
	memcpy(now, rgba, 4 * (size_t)SIDE * SIDE);
	for (uint32_t i = ECO_GROUND_IMAGE_LEVELS; i-- > 0 && !code; side /= 2) {
		if (i)
			halve(now, side, next, side / 2);
		code = write_level(&levels[i], now, side, error);
		if (i)
			memcpy(now, next, (size_t)side * side);
	}
	free(now);
	free(next);
	return code;
}
