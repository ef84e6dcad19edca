#include "lod/impostor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/lanes.h"

LOD_INLINE float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* ---- Opening ---- */

static void make_tiles(struct lod_impostor_tile *tiles, enum eco_impostor_set set,
	const struct eco_impostor_body *body, double radius)
{
	struct eco_impostor_axes axes[ECO_IMPOSTOR_TILES_MAX];
	uint32_t count = eco_impostor_tiles(set);
	eco_impostor_axes(set, axes);
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++) {
			double reach = eco_impostor_reach_up(body, &axes[i]);
			tiles[i].axis[0][k] = (float)(axes[i].right[k] / body->wide);
			tiles[i].axis[1][k] = (float)(axes[i].up[k] / reach);
			tiles[i].axis[2][k] = (float)(axes[i].toward[k] / radius);
		}
}

enum eco_code lod_impostor_open(struct lod_impostor *impostor, const struct eco_impostor_body *body,
	const struct eco_impostor_level *level, struct eco_error *error)
{
	*impostor = (struct lod_impostor){ .body = *body, .size = eco_impostor_sizes[level->level],
		.radius = eco_impostor_radius(body),
		.opacity = 1 - (float)level->gaps / ECO_IMPOSTOR_GAPS };
	const struct eco_impostor_size *size = &impostor->size;
	size_t tiles = eco_impostor_tiles(size->set), texels = tiles * size->texels * size->texels,
		depths = tiles * size->depths * size->depths;
	impostor->cell_count = eco_impostor_tiles(ECO_IMPOSTOR_FEW) * size->colors * size->colors;
	impostor->texel = malloc(texels);
	impostor->depth = malloc(depths * sizeof *impostor->depth);
	impostor->rgb = malloc(impostor->cell_count * sizeof *impostor->rgb);
	if (!impostor->texel || !impostor->depth || !impostor->rgb) {
		lod_impostor_close(impostor);
		return eco_fail(error, ECO_NO_MEMORY, "no memory to draw an impostor");
	}
	memcpy(impostor->texel, level->texel, texels);
	for (size_t i = 0; i < depths; i++)
		impostor->depth[i] = eco_impostor_depth(level->depth[i], size->depth_codes);
	for (size_t i = 0; i < impostor->cell_count; i++)
		for (int k = 0; k < 3; k++)
			impostor->rgb[i][k] = eco_impostor_color(level->color[3 * i + (size_t)k]);
	eco_impostor_rings(size->set, &impostor->rings);
	make_tiles(impostor->tile, size->set, body, impostor->radius);
	make_tiles(impostor->color_tile, ECO_IMPOSTOR_FEW, body, impostor->radius);
	return ECO_OK;
}

size_t lod_impostor_bytes(const struct lod_impostor *impostor)
{
	const struct eco_impostor_size *size = &impostor->size;
	size_t tiles = eco_impostor_tiles(size->set);
	return tiles * size->texels * size->texels + tiles * size->depths * size->depths * sizeof(float)
		+ impostor->cell_count * sizeof *impostor->rgb;
}

void lod_impostor_close(struct lod_impostor *impostor)
{
	free(impostor->texel);
	free(impostor->depth);
	free(impostor->rgb);
	memset(impostor, 0, sizeof *impostor);
}

/* ---- Looking from somewhere ---- */

/* The two tiles of a ring between whose directions a unit direction lies, seen from above, and the second
 * one's share. */
struct between { uint32_t tile[2]; float share; };

/* toward . direction of tile i's right: positive where the direction lies further on along the ring. On the
 * horizon the tiles of the second half are those of the first, reversed. */
static float beyond(const struct eco_impostor_ring *ring, const struct lod_impostor_tile *tiles, uint32_t i,
	const float direction[3])
{
	bool reversed = i >= ring->stored;
	const struct lod_impostor_tile *tile = &tiles[ring->first + (reversed ? i - ring->stored : i)];
	const float *right = tile->axis[0];
	float side = right[0] * direction[0] + right[1] * direction[1];
	return reversed ? -side : side;
}

static struct between find_between(const struct eco_impostor_ring *ring,
	const struct lod_impostor_tile *tiles, const float direction[3])
{
	struct between found = { { ring->first, ring->first }, 0 };
	for (uint32_t i = 0; i < ring->count && ring->count > 1; i++) {
		uint32_t next = i + 1 < ring->count ? i + 1 : 0;
		float past = beyond(ring, tiles, i, direction), ahead = -beyond(ring, tiles, next, direction);
		if (past >= 0 && ahead >= 0) {
			found.tile[0] = ring->first + i % ring->stored;
			found.tile[1] = ring->first + next % ring->stored;
			found.share = past + ahead > 0 ? past / (past + ahead) : 0;
			break;
		}
	}
	return found;
}

/* The ring below a unit direction, and how near the next one is: 0 to 1. */
static uint32_t find_rings(const struct eco_impostor_rings *rings, const float direction[3], float *upper)
{
	uint32_t low = 0;
	while (low + 2 < rings->count && direction[2] >= (float)rings->items[low + 1].sine)
		low++;
	const struct eco_impostor_ring *ring = &rings->items[low];
	float flat = sqrtf(direction[0] * direction[0] + direction[1] * direction[1]),
		past = direction[2] * (float)ring[0].cosine - flat * (float)ring[0].sine,
		ahead = flat * (float)ring[1].sine - direction[2] * (float)ring[1].cosine;
	past = past > 0 ? past : 0;
	ahead = ahead > 0 ? ahead : 0;
	*upper = past + ahead > 0 ? past / (past + ahead) : 0;
	return low;
}

static void order(struct lod_impostor_look *look, uint32_t i, uint32_t k)
{
	float weight = look->weight[i];
	uint32_t tile = look->tile[i];
	if (!(look->weight[k] > weight))
		return;
	look->weight[i] = look->weight[k];
	look->weight[k] = weight;
	look->tile[i] = look->tile[k];
	look->tile[k] = tile;
}

/* The heaviest first, so that rays that miss the plant are given up soon. */
static void choose_tiles(struct lod_impostor_look *look, const struct lod_impostor *impostor,
	const float direction[3])
{
	const struct eco_impostor_rings *rings = &impostor->rings;
	float upper;
	uint32_t low = find_rings(rings, direction, &upper);
	for (uint32_t k = 0; k < 2; k++) {
		struct between b = find_between(&rings->items[low + k], impostor->tile, direction);
		float part = k ? upper : 1 - upper;
		look->tile[2 * k] = b.tile[0];
		look->tile[2 * k + 1] = b.tile[1];
		look->weight[2 * k] = part * (1 - b.share);
		look->weight[2 * k + 1] = part * b.share;
	}
	order(look, 0, 1);
	order(look, 2, 3);
	order(look, 0, 2);
	order(look, 1, 3);
	order(look, 1, 2);
}

/* The nearest of the tiles that have colours. */
static uint32_t choose_color(const struct lod_impostor *impostor, const float direction[3])
{
	uint32_t best = 0, count = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	float nearest = -1;
	for (uint32_t i = 0; i < count; i++) {
		float near = fabsf(dot(impostor->color_tile[i].axis[2], direction));
		if (near > nearest) {
			nearest = near;
			best = i;
		}
	}
	return best;
}

void lod_impostor_look(struct lod_impostor_look *look, const struct lod_impostor *impostor,
	const float eye[3])
{
	float length = sqrtf(dot(eye, eye)), turn = (eye[2] < 0 ? -1 : 1) / (length > 0 ? length : 1);
	const float direction[3] = { eye[0] * turn, eye[1] * turn, eye[2] * turn };
	choose_tiles(look, impostor, direction);
	look->color_tile = choose_color(impostor, direction);
	memcpy(look->eye, eye, sizeof look->eye);
	for (uint32_t i = 0; i < LOD_IMPOSTOR_LOOKED; i++)
		for (int k = 0; k < 3; k++)
			look->from[i][k] = dot(impostor->tile[look->tile[i]].axis[k], eye);
}

/* ---- Looking up ---- */

/* Linear between texels; there are none beyond the tile; x and y in [-1, 1], y up. */
LOD_INLINE float cover_at(const uint8_t *texel, uint32_t side, float x, float y)
{
	x = (0.5f + 0.5f * x) * (float)side - 0.5f;
	y = (0.5f - 0.5f * y) * (float)side - 0.5f;
	if (!(x > -1 && y > -1 && x < (float)side && y < (float)side))
		return 0;
	int32_t column = (int32_t)floorf(x), row = (int32_t)floorf(y), last = (int32_t)side - 1;
	float u = x - (float)column, v = y - (float)row;
	const uint8_t *at = texel + (ptrdiff_t)row * (ptrdiff_t)side + column;
	float a = column >= 0 && row >= 0 ? at[0] : 0, b = column < last && row >= 0 ? at[1] : 0,
		c = column >= 0 && row < last ? at[side] : 0,
		d = column < last && row < last ? at[side + 1] : 0;
	return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

/* The same of depths; the last ones go on beyond the tile. */
LOD_INLINE float depth_at(const float *depth, uint32_t side, float x, float y)
{
	float most = (float)(side - 1);
	x = (0.5f + 0.5f * x) * (float)side - 0.5f;
	y = (0.5f - 0.5f * y) * (float)side - 0.5f;
	x = x > 0 ? x < most ? x : most : 0;
	y = y > 0 ? y < most ? y : most : 0;
	uint32_t column = (uint32_t)x, row = (uint32_t)y, right = column + 1 < side ? 1 : 0,
		below = row + 1 < side ? side : 0;
	float u = x - (float)column, v = y - (float)row;
	const float *at = depth + row * side + column;
	return (1 - v) * ((1 - u) * at[0] + u * at[right])
		+ v * ((1 - u) * at[below] + u * at[below + right]);
}

/* The point at which a ray meets a tile: along the ray, and the square of the distance from the tile's middle. */
struct met { float along, out2; };

/* How much of a tile's texels the ray meets. */
LOD_INLINE float tile_cover(const struct lod_impostor *impostor, const struct lod_impostor_look *look,
	uint32_t i, const float ray[3], struct met *met)
{
	uint32_t tile = look->tile[i], depths = impostor->size.depths, side = impostor->size.texels;
	const float *from = look->from[i], (*axis)[3] = impostor->tile[tile].axis;
	float x = dot(axis[0], ray), y = dot(axis[1], ray), z = dot(axis[2], ray);
	float part = 1 / z, t = -from[2] * part;
	float deep = depth_at(impostor->depth + (size_t)tile * depths * depths, depths, from[0] + t * x,
		from[1] + t * y);
	t = (deep - from[2]) * part;
	x = from[0] + t * x;
	y = from[1] + t * y;
	*met = (struct met){ t, x * x + y * y };
	return cover_at(impostor->texel + (size_t)tile * side * side, side, x, y);
}

LOD_INLINE uint32_t cell_at(const struct lod_impostor *impostor, uint32_t tile, const float point[3])
{
	uint32_t side = impostor->size.colors;
	const float (*axis)[3] = impostor->color_tile[tile].axis;
	float x = (0.5f + 0.5f * dot(axis[0], point)) * (float)side,
		y = (0.5f - 0.5f * dot(axis[1], point)) * (float)side, most = (float)(side - 1);
	x = x > 0 ? x < most ? x : most : 0;
	y = y > 0 ? y < most ? y : most : 0;
	return (tile * side + (uint32_t)y) * side + (uint32_t)x;
}

LOD_CLONES bool lod_impostor_hit(const struct lod_impostor *impostor, const struct lod_impostor_look *look,
	const float ray[3], struct lod_impostor_hit *hit)
{
	float cover = 0, along = 0, out2 = 0, left = 1, point[3];
	for (uint32_t i = 0; i < LOD_IMPOSTOR_LOOKED; i++) {
		struct met met;
		float here = look->weight[i];
		if (!(here > 0))
			continue;
		left -= here;
		here *= tile_cover(impostor, look, i, ray, &met);
		if (cover + here + left < LOD_IMPOSTOR_HOPE)
			return false;
		if (!(here > 0))
			continue;
		cover += here;
		along += here * met.along;
		out2 += here * met.out2;
		if (cover >= LOD_IMPOSTOR_LEAST && left < LOD_IMPOSTOR_LIGHT)
			break;
	}
	if (!(cover >= LOD_IMPOSTOR_LEAST))
		return false;
	along /= cover;
	out2 = 1 - out2 / cover;
	for (int k = 0; k < 3; k++)
		point[k] = look->eye[k] + along * ray[k];
	hit->cell = cell_at(impostor, look->color_tile, point);
	hit->middle = along;
	hit->along = along - impostor->body.thick * sqrtf((out2 > 0 ? out2 : 0) / dot(ray, ray));
	return true;
}
