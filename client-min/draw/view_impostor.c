#include "client-min/draw/view_impostor.h"

#include <assert.h>
#include <string.h>

#include "client-min/draw/view_light.h"

#define HEAD_TEXELS 3u
#define TILE_TEXELS 2u
enum { TEXEL_BITS = 1, DEPTH_BITS = 4, COLOR_BITS = 16 };
_Static_assert(ECO_IMPOSTOR_TILES_MAX < 256 && ECO_IMPOSTOR_TEXELS_MAX < 256 && ECO_IMPOSTOR_COLORS <= 32,
	"fields of records are wide enough");

/* Where the parts of a level start, and where it ends. */
struct layout { uint32_t tiles, color_tiles, texels, depths, colors, end; };

static uint32_t texels_of(uint32_t tiles, uint32_t side, uint32_t bits)
{
	return (tiles * side * side * bits + 127) / 128;
}

static struct layout layout_of(const struct lod_impostor *impostor)
{
	const struct eco_impostor_size *size = &impostor->size;
	uint32_t tiles = eco_impostor_tiles(size->set), color_tiles = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	struct layout at = { .tiles = HEAD_TEXELS + impostor->rings.count };
	bool same = size->set == ECO_IMPOSTOR_FEW;
	at.color_tiles = at.tiles + (same ? 0 : tiles * TILE_TEXELS);
	at.texels = at.color_tiles + color_tiles * TILE_TEXELS;
	at.depths = at.texels + texels_of(tiles, size->texels, TEXEL_BITS);
	at.colors = at.depths + texels_of(tiles, size->depths, DEPTH_BITS);
	at.end = at.colors + texels_of(color_tiles, size->colors, COLOR_BITS);
	return at;
}

uint32_t view_impostor_texels(const struct lod_impostor *impostor) { return layout_of(impostor).end; }

static void put_floats(uint32_t *words, uint32_t texel, const float v[4])
{
	memcpy(words + 4 * (size_t)texel, v, 4 * sizeof *v);
}

static void put_bits(uint32_t *words, uint32_t texel, uint32_t i, uint32_t bits, uint32_t value)
{
	words[4 * (size_t)texel + i * bits / 32] |= value << i * bits % 32;
}

static void write_tiles(uint32_t *words, uint32_t texel, const struct lod_impostor_tile *tiles,
	uint32_t count)
{
	for (uint32_t i = 0; i < count; i++, texel += TILE_TEXELS) {
		const float (*a)[3] = tiles[i].axis;
		assert(a[0][2] == 0);
		put_floats(words, texel, (float[4]){ a[0][0], a[1][0], a[2][0], a[0][1] });
		put_floats(words, texel + 1, (float[4]){ a[1][1], a[2][1], a[1][2], a[2][2] });
	}
}

static void write_head(uint32_t *words, const struct lod_impostor *impostor, const struct layout *at)
{
	const struct eco_impostor_body *body = &impostor->body;
	const struct eco_impostor_size *size = &impostor->size;
	const struct eco_impostor_rings *rings = &impostor->rings;
	const float *center = body->center;
	const uint32_t rest[7] = {
		size->texels | size->depths << 8 | size->colors << 16 | size->depth_codes << 24,
		rings->count | eco_impostor_tiles(ECO_IMPOSTOR_FEW) << 8, at->colors, at->tiles,
		at->color_tiles, at->texels, at->depths };
	put_floats(words, 0, (float[4]){ center[0], center[1], center[2], impostor->radius });
	put_floats(words, 1, (float[4]){ body->thick });
	memcpy(words + 5, rest, sizeof rest);
	for (uint32_t i = 0; i < rings->count; i++) {
		const struct eco_impostor_ring *ring = &rings->items[i];
		put_floats(words, HEAD_TEXELS + i, (float[4]){ (float)ring->sine, (float)ring->cosine });
		words[4 * (HEAD_TEXELS + i) + 2] = ring->first | ring->stored << 8 | ring->count << 16;
	}
}

/* The inverses of eco_impostor_depth and eco_impostor_color. */
static uint32_t depth_code(float depth, uint32_t codes)
{
	return (uint32_t)(0.5f * (depth + 1) * (float)(codes - 1) + 0.5f);
}

static uint32_t color_code(const uint8_t rgb[3])
{
	uint32_t code = 0;
	for (uint32_t k = 0; k < 3; k++)
		code |= (rgb[k] * (ECO_IMPOSTOR_COLORS - 1) + 127) / 255 << 5 * k;
	return code;
}

void view_impostor_write(const struct lod_impostor *impostor, uint32_t *words)
{
	const struct eco_impostor_size *size = &impostor->size;
	struct layout at = layout_of(impostor);
	uint32_t tiles = eco_impostor_tiles(size->set);
	assert(size->depth_codes <= 1u << DEPTH_BITS);
	memset(words, 0, 16 * (size_t)at.end);
	write_head(words, impostor, &at);
	write_tiles(words, at.tiles, impostor->tile, tiles);
	write_tiles(words, at.color_tiles, impostor->color_tile, eco_impostor_tiles(ECO_IMPOSTOR_FEW));
	for (uint32_t i = 0; i < tiles * size->texels * size->texels; i++)
		put_bits(words, at.texels, i, TEXEL_BITS, impostor->texel[i]);
	for (uint32_t i = 0; i < tiles * size->depths * size->depths; i++)
		put_bits(words, at.depths, i, DEPTH_BITS, depth_code(impostor->depth[i], size->depth_codes));
	for (uint32_t i = 0; i < impostor->cell_count; i++)
		put_bits(words, at.colors, i, COLOR_BITS, color_code(impostor->rgb[i]));
}

uint32_t view_impostor_surface(const struct eco_list *list, const struct lod_impostor *impostor)
{
	return view_surface_cloud(1.0 / impostor->size.texels, eco_level_share(list->level));
}
