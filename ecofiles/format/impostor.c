/* Impostors: bodies, directions, levels, and levels as bytes: see impostor.h.
 *
 * Texels are most of the bytes. A crown's outline repeats from tile to tile, but shifted: a point half a
 * radius in front of the middle moves by several texels between neighbouring directions. So a texel is looked
 * up in the two nearest tiles before it where its point lies there, by the depth of its own tile. That saves
 * a sixth to a quarter of the bytes (lod/EXPERIMENTS.md). It is computed in floats, by + - * / in a fixed
 * order: alike on every machine. */
#include "ecofiles/format/impostor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/range.h"

#define SIZE_MAX_M 1e6f
#define SEEN 9u                  /* how covered neighbouring tiles show a point: eighths, and unknown */
#define SEEN_UNKNOWN 8u
#define MODELS_TEXEL (64 * SEEN)
#define MODELS_CELL (5 * 4)      /* of what the tile before says, of differences */
#define STEPS 64u                /* of a difference in unary */

const struct eco_impostor_size eco_impostor_sizes[ECO_IMPOSTOR_LEVELS] = {
	{ ECO_IMPOSTOR_FEW, 16, 4, 8, 4 }, { ECO_IMPOSTOR_MANY, 32, 8, 8, 8 },
	{ ECO_IMPOSTOR_MANY, 64, 16, 16, 16 } };

/* ---- Bodies ---- */

bool eco_impostor_body_good(const struct eco_impostor_body *b)
{
	for (int k = 0; k < 3; k++)
		if (!(b->center[k] >= -SIZE_MAX_M && b->center[k] <= SIZE_MAX_M))
			return false;
	return b->wide >= 1e-6f && b->wide <= SIZE_MAX_M && b->high >= 1e-6f && b->high <= SIZE_MAX_M
		&& b->thick >= 0 && b->thick <= 2 * SIZE_MAX_M;
}

void eco_impostor_body_write(struct eco_writer *w, const struct eco_impostor_body *b)
{
	const float values[6] = { b->center[0], b->center[1], b->center[2], b->wide, b->high, b->thick };
	for (int i = 0; i < 6; i++)
		eco_write_f32(w, values[i]);
}

enum eco_code eco_impostor_body_read(struct eco_reader *r, struct eco_impostor_body *b,
	struct eco_error *error)
{
	float values[6];
	for (int i = 0; i < 6; i++)
		values[i] = eco_read_f32(r);
	*b = (struct eco_impostor_body){ { values[0], values[1], values[2] }, values[3], values[4],
		values[5] };
	if (r->failed || !eco_impostor_body_good(b))
		return eco_fail(error, ECO_DAMAGED, "impostor: a body that no plant has");
	return ECO_OK;
}

float eco_impostor_radius(const struct eco_impostor_body *b)
{
	return sqrtf(b->wide * b->wide + b->high * b->high);
}

/* ---- Directions ---- */

/* Rings are 22 or 15 degrees apart; so are directions along a ring, about. Every other ring is turned by
 * half a step. */
struct ring { uint32_t count; double elevation_deg; };
static const struct ring few[] = { { 12, 0 }, { 10, 22 }, { 8, 45 }, { 5, 67 }, { 1, 90 } };
static const struct ring many[] = { { 28, 0 }, { 24, 15 }, { 21, 30 }, { 17, 45 }, { 12, 60 }, { 6, 75 },
	{ 1, 90 } };
static const struct { const struct ring *rings; uint32_t count; } sets[] = {
	{ few, sizeof few / sizeof *few }, { many, sizeof many / sizeof *many } };

void eco_impostor_rings(enum eco_impostor_set set, struct eco_impostor_rings *rings)
{
	uint32_t first = 0;
	rings->count = sets[set].count;
	for (uint32_t i = 0; i < rings->count; i++) {
		const struct ring *ring = &sets[set].rings[i];
		struct eco_impostor_ring *out = &rings->items[i];
		*out = (struct eco_impostor_ring){ .first = first, .count = ring->count,
			.stored = i ? ring->count : ring->count / 2 };
		eco_angle16_sincos(eco_angle16_from_deg(ring->elevation_deg), &out->sine, &out->cosine);
		first += out->stored;
	}
}

uint32_t eco_impostor_tiles(enum eco_impostor_set set)
{
	struct eco_impostor_rings rings;
	eco_impostor_rings(set, &rings);
	const struct eco_impostor_ring *last = &rings.items[rings.count - 1];
	return last->first + last->stored;
}

void eco_impostor_axes(enum eco_impostor_set set, struct eco_impostor_axes axes[ECO_IMPOSTOR_TILES_MAX])
{
	struct eco_impostor_rings rings;
	eco_impostor_rings(set, &rings);
	for (uint32_t k = 0; k < rings.count; k++) {
		const struct eco_impostor_ring *ring = &rings.items[k];
		double up = ring->sine, flat = ring->cosine, s, c;
		for (uint32_t i = 0; i < ring->stored; i++, axes++) {
			double step = (k & 1) && ring->count > 1 ? i + 0.5 : i;
			eco_angle16_sincos((uint16_t)(65536 * step / ring->count), &s, &c);
			*axes = (struct eco_impostor_axes){ { flat * c, flat * s, up }, { -s, c, 0 },
				{ -up * c, -up * s, flat } };
		}
	}
}

double eco_impostor_reach_up(const struct eco_impostor_body *body, const struct eco_impostor_axes *axes)
{
	return (double)body->high * axes->up[2] + (double)body->wide * axes->toward[2];
}

/* ---- Levels ---- */

enum eco_code eco_impostor_level_make(struct eco_impostor_level *level, uint32_t number,
	struct eco_error *error)
{
	const struct eco_impostor_size *size = &eco_impostor_sizes[number];
	size_t tiles = eco_impostor_tiles(size->set), few_tiles = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	*level = (struct eco_impostor_level){ .level = number,
		.texel = calloc(tiles * size->texels * size->texels, 1),
		.depth = calloc(tiles * size->depths * size->depths, 1),
		.color = calloc(few_tiles * size->colors * size->colors * 3, 1) };
	if (level->texel && level->depth && level->color)
		return ECO_OK;
	eco_impostor_level_free(level);
	return eco_fail(error, ECO_NO_MEMORY, "no memory for an impostor");
}

void eco_impostor_level_free(struct eco_impostor_level *level)
{
	free(level->texel);
	free(level->depth);
	free(level->color);
	memset(level, 0, sizeof *level);
}

struct codec {
	struct eco_range range;
	const struct eco_impostor_body *body;
	const struct eco_impostor_size *size;
	struct eco_impostor_level *level;        /* not changed in writing */
	uint32_t tiles;
	struct eco_impostor_axes axes[ECO_IMPOSTOR_TILES_MAX];
	struct eco_bit texel[MODELS_TEXEL], cell[MODELS_CELL][STEPS];
};

/* ---- Depths and colours: cells with codes ---- */

static int32_t cell_at(const struct eco_impostor_cells *c, uint32_t tile, uint32_t x, uint32_t y)
{
	return *eco_impostor_cell(c, tile, x, y);
}

static int32_t within(int32_t v, int32_t low, int32_t high)
{
	return v < low ? low : v > high ? high : v;
}

/* The prediction by the neighbours (the median of left, up and left + up - upper left), and which models code
 * the difference. */
static int32_t predict(const struct eco_impostor_cells *c, uint32_t tile, uint32_t x, uint32_t y,
	uint32_t *model)
{
	int32_t left = x ? cell_at(c, tile, x - 1, y) : -1, up = y ? cell_at(c, tile, x, y - 1) : -1,
		before = tile ? cell_at(c, tile - 1, x, y) : (int32_t)c->codes / 2, p = before, rough = 3;
	if (left >= 0 && up >= 0) {
		int32_t both = left + up - cell_at(c, tile, x - 1, y - 1);
		p = within(both, left < up ? left : up, left < up ? up : left);
		rough = within(left < up ? up - left : left - up, 0, 3);
	} else if (left >= 0 || up >= 0) {
		p = left >= 0 ? left : up;
	}
	*model = (uint32_t)(4 * (within(before - p, -2, 2) + 2) + rough);
	return p;
}

/* A difference modulo the number of codes, the nearest to 0 first: 0, -1, 1, -2, ... */
static int32_t code_difference(struct eco_range *r, struct eco_bit models[STEPS], int32_t difference,
	uint32_t codes)
{
	int32_t half = (int32_t)codes / 2;
	if (difference >= half)
		difference -= (int32_t)codes;
	if (difference < -half)
		difference += (int32_t)codes;
	uint32_t folded = (uint32_t)(difference < 0 ? -2 * difference - 1 : 2 * difference), n = 0;
	while (n + 1 < codes && eco_range_bit(r, &models[n], n < folded))
		n++;
	return n & 1 ? -(int32_t)(n + 1) / 2 : (int32_t)n / 2;
}

static void code_cells(struct codec *codec, const struct eco_impostor_cells *c)
{
	eco_bits_start(codec->cell[0], sizeof codec->cell / sizeof codec->cell[0][0]);
	for (uint32_t tile = 0; tile < c->tiles; tile++)
		for (uint32_t i = 0; i < c->side * c->side; i++) {
			uint32_t model, x = i % c->side, y = i / c->side;
			int32_t p = predict(c, tile, x, y, &model), v = cell_at(c, tile, x, y) - p;
			v = p + code_difference(&codec->range, codec->cell[model], v, c->codes);
			if (codec->range.writer)
				continue;
			*eco_impostor_cell(c, tile, x, y) = (uint8_t)((v + (int32_t)c->codes)
				% (int32_t)c->codes);
		}
}

uint8_t eco_impostor_predict(const struct eco_impostor_cells *cells, uint32_t tile, uint32_t x, uint32_t y)
{
	uint32_t model;
	return (uint8_t)predict(cells, tile, x, y, &model);
}

struct eco_impostor_cells eco_impostor_depth_cells(const struct eco_impostor_level *level)
{
	const struct eco_impostor_size *size = &eco_impostor_sizes[level->level];
	return (struct eco_impostor_cells){ level->depth, eco_impostor_tiles(size->set), size->depths, 1,
		size->depth_codes };
}

struct eco_impostor_cells eco_impostor_color_cells(const struct eco_impostor_level *level, uint32_t channel)
{
	return (struct eco_impostor_cells){ level->color + channel, eco_impostor_tiles(ECO_IMPOSTOR_FEW),
		eco_impostor_sizes[level->level].colors, 3, ECO_IMPOSTOR_COLORS };
}

static void code_colors(struct codec *codec)
{
	for (uint32_t k = 0; k < 3; k++) {
		struct eco_impostor_cells cells = eco_impostor_color_cells(codec->level, k);
		code_cells(codec, &cells);
	}
}

/* ---- Texels ---- */

static uint32_t texel_at(const struct codec *codec, uint32_t tile, int32_t x, int32_t y)
{
	int32_t side = (int32_t)codec->size->texels;
	if (x < 0 || y < 0 || x >= side || y >= side)
		return 0;
	return codec->level->texel[((size_t)tile * codec->size->texels + (uint32_t)y) * codec->size->texels
		+ (uint32_t)x];
}

/* A texel, the one to its right, and both below them. */
static void texels_at(const struct codec *codec, uint32_t tile, int32_t x, int32_t y, uint8_t corner[4])
{
	const int32_t side = (int32_t)codec->size->texels;
	if (x >= 0 && y >= 0 && x + 1 < side && y + 1 < side) {
		const uint8_t *at = codec->level->texel + ((size_t)tile * (size_t)side + (size_t)y) * (size_t)side
			+ (size_t)x;
		memcpy(corner, at, 2);
		memcpy(corner + 2, at + side, 2);
	} else {
		for (int i = 0; i < 4; i++)
			corner[i] = (uint8_t)texel_at(codec, tile, x + (i & 1), y + (i >> 1));
	}
}

/* How much of a texel's surroundings is covered, (x, y) in texels from the tile's corner. */
static float covered_at(const struct codec *codec, uint32_t tile, float x, float y)
{
	float side = (float)codec->size->texels;
	if (!(x > -1 && y > -1 && x < side + 1 && y < side + 1))
		return 0;
	x -= 0.5f, y -= 0.5f;
	int32_t column = (int32_t)floorf(x), row = (int32_t)floorf(y);
	float u = x - (float)column, v = y - (float)row;
	uint8_t corner[4];
	texels_at(codec, tile, column, row, corner);
	float above = (1 - u) * (float)corner[0] + u * (float)corner[1];
	float below = (1 - u) * (float)corner[2] + u * (float)corner[3];
	return (1 - v) * above + v * below;
}

/* The depth of a tile at (x, y) in texels, in radii. */
static float depth_at(const struct codec *codec, uint32_t tile, float x, float y)
{
	const uint8_t *depth = codec->level->depth
		+ (size_t)tile * codec->size->depths * codec->size->depths;
	uint32_t side = codec->size->depths;
	float scale = (float)side / (float)codec->size->texels, most = (float)(side - 1);
	x = x * scale - 0.5f, y = y * scale - 0.5f;
	x = x < 0 ? 0 : x > most ? most : x;
	y = y < 0 ? 0 : y > most ? most : y;
	uint32_t column = (uint32_t)x, row = (uint32_t)y, right = column + 1 < side ? column + 1 : column,
		low = row + 1 < side ? row + 1 : row;
	float u = x - (float)column, v = y - (float)row;
	float above = (1 - u) * eco_impostor_depth(depth[row * side + column], codec->size->depth_codes)
		+ u * eco_impostor_depth(depth[row * side + right], codec->size->depth_codes);
	float below = (1 - u) * eco_impostor_depth(depth[low * side + column], codec->size->depth_codes)
		+ u * eco_impostor_depth(depth[low * side + right], codec->size->depth_codes);
	return (1 - v) * above + v * below;
}

/* From texels of a tile, and depth in radii, to texels of another: linear. */
struct way { uint32_t tile; float x[4], y[4]; };

static void way_make(struct way *way, const struct codec *codec, uint32_t from, uint32_t to)
{
	const struct eco_impostor_axes *a = &codec->axes[from], *b = &codec->axes[to];
	const struct eco_impostor_body *body = codec->body;
	double side = codec->size->texels, wide = body->wide, radius = eco_impostor_radius(body),
		reach = eco_impostor_reach_up(body, a), to_reach = eco_impostor_reach_up(body, b);
	way->tile = to;
	for (int axis = 0; axis < 2; axis++) {
		const double *along = axis ? b->up : b->right;
		double step = axis ? -side / (2 * to_reach) : side / (2 * wide);
		double right = 0, up = 0, toward = 0;
		for (int k = 0; k < 3; k++) {
			right += along[k] * a->right[k];
			up += along[k] * a->up[k];
			toward += along[k] * a->toward[k];
		}
		float *out = axis ? way->y : way->x;
		right *= step * 2 * wide / side;
		up *= -step * 2 * reach / side;
		out[0] = (float)right;
		out[1] = (float)up;
		out[2] = (float)(step * radius * toward);
		out[3] = (float)(side / 2 - (right + up) * side / 2);
	}
}

/* The two nearest tiles before one, nearest first; opposite directions are alike. */
static uint32_t ways_make(struct way ways[2], const struct codec *codec, uint32_t tile)
{
	double best[2] = { -1, -1 };
	uint32_t nearest[2] = { 0, 0 }, count = tile < 2 ? tile : 2;
	for (uint32_t i = 0; i < tile; i++) {
		const double *a = codec->axes[tile].toward, *b = codec->axes[i].toward;
		double near = fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
		uint32_t at = near > best[0] ? 0 : near > best[1] ? 1 : 2;
		if (at == 0) {
			best[1] = best[0];
			nearest[1] = nearest[0];
		}
		if (at < 2) {
			best[at] = near;
			nearest[at] = i;
		}
	}
	for (uint32_t i = 0; i < count; i++)
		way_make(&ways[i], codec, tile, nearest[i]);
	return count;
}

static uint32_t seen_before(const struct codec *codec, const struct way *ways, uint32_t count, uint32_t tile,
	uint32_t column, uint32_t row)
{
	if (!count)
		return SEEN_UNKNOWN;
	float x = (float)column + 0.5f, y = (float)row + 0.5f, z = depth_at(codec, tile, x, y), sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct way *w = &ways[i];
		sum += (i ? 1.0f : 2.0f) * covered_at(codec, w->tile,
			w->x[0] * x + w->x[1] * y + w->x[2] * z + w->x[3],
			w->y[0] * x + w->y[1] * y + w->y[2] * z + w->y[3]);
	}
	return (uint32_t)(sum * (count > 1 ? 1 / 3.0f : 0.5f) * 7.99f);
}

static void code_texels(struct codec *codec)
{
	uint32_t side = codec->size->texels;
	eco_bits_start(codec->texel, MODELS_TEXEL);
	for (uint32_t tile = 0; tile < codec->tiles; tile++) {
		struct way ways[2];
		uint32_t count = ways_make(ways, codec, tile);
		for (uint32_t i = 0; i < side * side; i++) {
			int32_t x = (int32_t)(i % side), y = (int32_t)(i / side);
			uint32_t model = texel_at(codec, tile, x - 1, y)
				| texel_at(codec, tile, x, y - 1) << 1
				| texel_at(codec, tile, x - 1, y - 1) << 2
				| texel_at(codec, tile, x + 1, y - 1) << 3
				| texel_at(codec, tile, x - 2, y) << 4 | texel_at(codec, tile, x, y - 2) << 5
				| seen_before(codec, ways, count, tile, i % side, i / side) << 6;
			uint8_t *texel = &codec->level->texel[(size_t)tile * side * side + i];
			bool bit = eco_range_bit(&codec->range, &codec->texel[model], *texel);
			if (!codec->range.writer)
				*texel = bit;
		}
	}
}

/* ---- Bytes ---- */

static struct codec *codec_make(const struct eco_impostor_body *body, const struct eco_impostor_level *level)
{
	struct codec *codec = malloc(sizeof *codec);
	if (!codec)
		return NULL;
	codec->body = body;
	codec->level = (struct eco_impostor_level *)level;
	codec->size = &eco_impostor_sizes[level->level];
	codec->tiles = eco_impostor_tiles(codec->size->set);
	eco_impostor_axes(codec->size->set, codec->axes);
	return codec;
}

static void code_shape(struct codec *codec)
{
	struct eco_impostor_cells depths = eco_impostor_depth_cells(codec->level);
	code_cells(codec, &depths);
	code_texels(codec);
}

enum eco_code eco_impostor_level_write(struct eco_writer *w, const struct eco_impostor_body *body,
	const struct eco_impostor_level *level, size_t *shape_bytes, struct eco_error *error)
{
	struct eco_writer shape = { 0 }, color = { 0 };
	struct codec *codec = codec_make(body, level);
	uint32_t zeros[2] = { 0, 0 };
	size_t start = w->size;
	if (codec) {
		eco_range_write(&codec->range, &shape);
		code_shape(codec);
		zeros[0] = eco_range_end(&codec->range);
		eco_range_write(&codec->range, &color);
		code_colors(codec);
		zeros[1] = eco_range_end(&codec->range);
		eco_impostor_body_write(w, body);
		eco_write_u8(w, (uint8_t)(level->level | level->gaps << 4));
		eco_write_varint(w, shape.size);
		eco_write_u8(w, (uint8_t)zeros[0]);
		eco_write_bytes(w, shape.bytes, shape.size);
		if (shape_bytes)
			*shape_bytes = w->size - start;
		eco_write_u8(w, (uint8_t)zeros[1]);
		eco_write_bytes(w, color.bytes, color.size);
	}
	bool good = codec && !shape.failed && !color.failed && !w->failed;
	free(codec);
	eco_writer_free(&shape);
	eco_writer_free(&color);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for the bytes of an impostor");
}

/* The streams of a level: where they are, and the zeros that are not stored. */
struct streams { const uint8_t *bytes[2]; size_t size[2]; uint32_t zeros[2]; };

static bool find_streams(struct streams *s, struct eco_reader *r, uint32_t *level, uint32_t *gaps)
{
	uint32_t head = eco_read_u8(r);
	*level = head & 15;
	*gaps = head >> 4;
	uint64_t shape = eco_read_varint(r);
	s->zeros[0] = eco_read_u8(r);
	if (r->failed || *level >= ECO_IMPOSTOR_LEVELS || shape > r->size - r->at)
		return false;
	s->size[0] = (size_t)shape;
	s->bytes[0] = eco_read_bytes(r, s->size[0]);
	s->zeros[1] = eco_read_u8(r);
	s->size[1] = r->size - r->at;
	s->bytes[1] = eco_read_bytes(r, s->size[1]);
	return !r->failed;
}

enum eco_code eco_impostor_level_read(struct eco_impostor_level *level, struct eco_impostor_body *body,
	const uint8_t *bytes, size_t size, struct eco_error *error)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	struct streams streams;
	uint32_t number, gaps;
	*level = (struct eco_impostor_level){ .level = 0 };
	enum eco_code code = eco_impostor_body_read(&r, body, error);
	if (!code && !find_streams(&streams, &r, &number, &gaps))
		code = eco_fail(error, ECO_DAMAGED, "impostor: its %zu bytes are not a level", size);
	if (code)
		return code;
	code = eco_impostor_level_make(level, number, error);
	level->gaps = gaps;
	struct codec *codec = code ? NULL : codec_make(body, level);
	if (!code && !codec)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory to read an impostor");
	for (int i = 0; i < 2 && !code; i++) {
		eco_range_read(&codec->range, streams.bytes[i], streams.size[i]);
		if (i)
			code_colors(codec);
		else
			code_shape(codec);
		if (eco_range_end(&codec->range) != streams.zeros[i])
			code = eco_fail(error, ECO_DAMAGED, "impostor: level %u is damaged", number);
	}
	free(codec);
	if (code)
		eco_impostor_level_free(level);
	return code;
}
