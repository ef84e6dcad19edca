#include "client-min/draw/view_picture.h"

#include <ctype.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

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
	eco_free(picture->rgb, picture->light, picture->cover, picture->owner, picture->depth,
		picture->surface, picture->soft);
	*picture = (struct view_picture){ 0 };
}

void view_picture_ray(const struct view_picture *picture, const struct lod_eye *eye, double x, double y,
	double ray[3])
{
	double u = ((x + 0.5) / picture->width * 2 - 1) * eye->tan_x + eye->middle[0],
		v = (1 - (y + 0.5) / picture->height * 2) * eye->tan_y + eye->middle[1];
	for (int k = 0; k < 3; k++)
		ray[k] = eye->forward[k] + u * eye->right[k] + v * eye->up[k];
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

/* ---- Words ---- */

/* Five columns by seven rows, from the top; the highest of five bits is the left column. */
static const struct { char letter; uint8_t row[7]; } glyphs[] = {
	{ '0', { 14, 17, 19, 21, 25, 17, 14 } }, { '1', { 4, 12, 4, 4, 4, 4, 14 } },
	{ '2', { 14, 17, 1, 2, 4, 8, 31 } }, { '3', { 31, 2, 4, 2, 1, 17, 14 } },
	{ '4', { 2, 6, 10, 18, 31, 2, 2 } }, { '5', { 31, 16, 30, 1, 1, 17, 14 } },
	{ '6', { 6, 8, 16, 30, 17, 17, 14 } }, { '7', { 31, 1, 2, 4, 8, 8, 8 } },
	{ '8', { 14, 17, 17, 14, 17, 17, 14 } }, { '9', { 14, 17, 17, 15, 1, 2, 12 } },
	{ 'A', { 14, 17, 17, 17, 31, 17, 17 } }, { 'B', { 30, 17, 17, 30, 17, 17, 30 } },
	{ 'C', { 14, 17, 16, 16, 16, 17, 14 } }, { 'D', { 28, 18, 17, 17, 17, 18, 28 } },
	{ 'E', { 31, 16, 16, 30, 16, 16, 31 } }, { 'F', { 31, 16, 16, 30, 16, 16, 16 } },
	{ 'G', { 14, 17, 16, 23, 17, 17, 15 } }, { 'H', { 17, 17, 17, 31, 17, 17, 17 } },
	{ 'I', { 14, 4, 4, 4, 4, 4, 14 } }, { 'J', { 7, 2, 2, 2, 2, 18, 12 } },
	{ 'K', { 17, 18, 20, 24, 20, 18, 17 } }, { 'L', { 16, 16, 16, 16, 16, 16, 31 } },
	{ 'M', { 17, 27, 21, 21, 17, 17, 17 } }, { 'N', { 17, 17, 25, 21, 19, 17, 17 } },
	{ 'O', { 14, 17, 17, 17, 17, 17, 14 } }, { 'P', { 30, 17, 17, 30, 16, 16, 16 } },
	{ 'Q', { 14, 17, 17, 17, 21, 18, 13 } }, { 'R', { 30, 17, 17, 30, 20, 18, 17 } },
	{ 'S', { 15, 16, 16, 14, 1, 1, 30 } }, { 'T', { 31, 4, 4, 4, 4, 4, 4 } },
	{ 'U', { 17, 17, 17, 17, 17, 17, 14 } }, { 'V', { 17, 17, 17, 17, 17, 10, 4 } },
	{ 'W', { 17, 17, 17, 21, 21, 21, 10 } }, { 'X', { 17, 17, 10, 4, 10, 17, 17 } },
	{ 'Y', { 17, 17, 17, 10, 4, 4, 4 } }, { 'Z', { 31, 1, 2, 4, 8, 16, 31 } },
	{ '.', { 0, 0, 0, 0, 0, 12, 12 } }, { ',', { 0, 0, 0, 0, 12, 4, 8 } },
	{ ':', { 0, 12, 12, 0, 12, 12, 0 } }, { '-', { 0, 0, 0, 31, 0, 0, 0 } },
	{ '_', { 0, 0, 0, 0, 0, 0, 31 } } };

#define LETTER_WIDTH 6u                  /* dots, with the gaps */
#define LETTER_HEIGHT 10u
#define MARGIN 5u

struct canvas { uint32_t width, height, dot; uint8_t *rgb; };    /* dot: pixels a dot of a letter */

static void draw_dot(const struct canvas *c, uint32_t x, uint32_t y)
{
	for (uint32_t j = y; j < y + c->dot && j < c->height; j++)
		for (uint32_t i = x; i < x + c->dot && i < c->width; i++)
			memset(c->rgb + 3 * ((size_t)j * c->width + i), 230, 3);
}

static void draw_letter(const struct canvas *c, char letter, uint32_t x, uint32_t y)
{
	for (size_t g = 0; g < sizeof glyphs / sizeof *glyphs; g++)
		for (uint32_t i = 0; i < 35 && glyphs[g].letter == toupper((unsigned char)letter); i++)
			if (glyphs[g].row[i / 5] >> (4 - i % 5) & 1)
				draw_dot(c, x + i % 5 * c->dot, y + i / 5 * c->dot);
}

/* Lines of at most `columns` letters, broken at line ends, else at spaces where that is possible; returns how
 * many there are. A canvas without pixels only counts them. */
static uint32_t write_words(const struct canvas *c, const char *words, uint32_t columns, uint32_t x,
	uint32_t y)
{
	uint32_t lines = 0;
	while (*words) {
		size_t count = strcspn(words, "\n"), end = count < columns ? count : columns;
		while (end < count && end > 0 && words[end] != ' ')
			end--;
		end = end || !count ? end : columns;
		for (size_t i = 0; i < end && c->rgb; i++)
			draw_letter(c, words[i], x + (uint32_t)i * LETTER_WIDTH * c->dot,
				y + lines * LETTER_HEIGHT * c->dot);
		lines++;
		words += end;
		words += *words == ' ' || *words == '\n';
	}
	return lines;
}

/* ---- Pictures side by side ---- */

/* matplotlib's "magma", at eighths. */
static void color_error(float error, uint8_t rgb[3])
{
	static const uint8_t at[9][3] = { { 0, 0, 4 }, { 28, 16, 68 }, { 79, 18, 123 }, { 129, 37, 129 },
		{ 181, 54, 122 }, { 229, 80, 100 }, { 251, 135, 97 }, { 254, 194, 135 }, { 252, 253, 191 } };
	float eighths = (error > 0 ? error < 1 ? error : 1 : 0) * 8;
	int i = eighths < 7 ? (int)eighths : 7;
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)((float)at[i][k] + (eighths - (float)i) * (float)(at[i + 1][k] - at[i][k])
			+ 0.5f);
}

static void draw_row(const struct view_compare *compare, uint32_t y, uint8_t *out)
{
	size_t width = compare->picture->width, first = y * width;
	memcpy(out, compare->picture->rgb + 3 * first, 3 * width);
	memcpy(out + 3 * width, compare->reference->rgb + 3 * first, 3 * width);
	for (size_t x = 0; x < width; x++)
		color_error(compare->error_map[first + x], out + 3 * (2 * width + x));
}

enum eco_code view_compare_draw(const struct view_compare *compare, uint8_t **rgb, uint32_t size[2],
	struct eco_error *error)
{
	uint32_t width = compare->picture->width, height = compare->picture->height, lines = 0;
	struct canvas canvas = { .width = 3 * width, .dot = width < 480 ? 1 : 2 };
	uint32_t advance = LETTER_WIDTH * canvas.dot, columns = width > 3 * advance ? width / advance - 2 : 1;
	for (int i = 0; i < 3; i++) {
		uint32_t here = write_words(&canvas, compare->words[i], columns, 0, 0);
		lines = here > lines ? here : lines;
	}
	canvas.height = height + (lines * LETTER_HEIGHT + 2 * MARGIN) * canvas.dot;
	canvas.rgb = calloc((size_t)canvas.width * canvas.height, 3);
	if (!canvas.rgb)
		return eco_no_memory(error, "a picture");
	for (uint32_t y = 0; y < height; y++)
		draw_row(compare, y, canvas.rgb + 3 * (size_t)y * canvas.width);
	for (uint32_t i = 0; i < 3; i++)
		write_words(&canvas, compare->words[i], columns, i * width + MARGIN * canvas.dot,
			height + MARGIN * canvas.dot);
	*rgb = canvas.rgb;
	size[0] = canvas.width;
	size[1] = canvas.height;
	return ECO_OK;
}

/* ---- Threads ---- */

#define THREADS_MAX 64u

struct share {
	void (*work)(void *ctx, uint32_t number);
	void *ctx;
	uint32_t number;
	pthread_t thread;
	bool started;
};

static void *run(void *ctx)
{
	const struct share *share = ctx;
	share->work(share->ctx, share->number);
	return NULL;
}

uint32_t view_thread_count(uint32_t wanted)
{
	uint32_t count = wanted ? wanted : 2;
	return count < THREADS_MAX ? count : THREADS_MAX;
}

void view_threads_run(uint32_t count, void (*work)(void *ctx, uint32_t number), void *ctx)
{
	struct share shares[THREADS_MAX];
	for (uint32_t i = 0; i < count; i++) {
		shares[i] = (struct share){ .work = work, .ctx = ctx, .number = i };
		shares[i].started = i && pthread_create(&shares[i].thread, NULL, run, &shares[i]) == 0;
	}
	for (uint32_t i = 0; i < count; i++)
		if (!shares[i].started)
			work(ctx, i);
	for (uint32_t i = 0; i < count; i++)
		if (shares[i].started)
			pthread_join(shares[i].thread, NULL);
}
