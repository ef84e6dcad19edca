/* The centre that elements are scaled about belongs to lod/: it is found here by asking for the geometry at
 * factor 1 and at factor 4, where every edge is twice as long: p4 = c + 2 (p1 - c). */
#include "client-min/view_record.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ground.h"
#include "client-min/draw/view_light.h"
#include "ecofiles/format/splat.h"
#include "lod/geometry.h"

/* ---- Impostors ---- */

#define HEAD_TEXELS 3u
#define TILE_TEXELS 2u
enum { TEXEL_BITS = 1, DEPTH_BITS = 4, COLOR_BITS = 16 };
_Static_assert(ECO_IMPOSTOR_TILES_MAX < 256 && ECO_IMPOSTOR_TEXELS_MAX < 256 && ECO_IMPOSTOR_COLORS <= 32,
	"fields of records are wide enough");

/* Starts of the parts of a level, and its end. */
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
		rings->count | eco_impostor_tiles(ECO_IMPOSTOR_FEW) << 8
			| (uint32_t)(impostor->opacity * ECO_IMPOSTOR_GAPS) << 16, at->colors, at->tiles,
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

uint32_t view_impostor_surface(const struct eco_list *list)
{
	return view_surface_cloud(LOD_IMPOSTOR_REACH, eco_level_share(list->level)) | VIEW_NEAR_SIDE;
}

/* ---- Lists ---- */

static uint32_t bits(float v)
{
	uint32_t b;
	memcpy(&b, &v, sizeof b);
	return b;
}

static uint32_t packed_color(const struct view_list *list, int32_t index)
{
	if (index < 0 || (uint32_t)index >= list->list.palette_count)
		return list->list.image == ECO_NONE ? 0x4f7f5f : 0xffffff;
	const uint8_t *c = list->palette[index];
	return (uint32_t)c[0] | (uint32_t)c[1] << 8 | (uint32_t)c[2] << 16;
}

/* The key's place in an owner, as eco_owner_summary lays it out: a unit and a mask. */
static uint64_t key_unit(void)
{
	return eco_owner_summary(1, 0) ^ eco_owner_summary(0, 0);
}

static uint32_t key_mask(void)
{
	uint64_t mask = eco_owner_summary(0xffff, 0) ^ eco_owner_summary(0, 0);
	assert((uint32_t)mask == 0);
	return (uint32_t)(mask >> 32);
}

uint32_t view_record_path(uint32_t path)
{
	return path * (uint32_t)(key_unit() >> 32);
}

uint32_t view_record_texels(const struct eco_list *list)
{
	switch (list->kind) {
	case ECO_LIST_TRIANGLES:
		return list->attributes & ECO_ATTR_UV && list->image != ECO_NONE ? 5 : 4;
	case ECO_LIST_LINES:
		return 2;
	case ECO_LIST_POINTS:
		return list->attributes & ECO_ATTR_SPLAT ? 4 : list->attributes & ECO_ATTR_PLANT ? 2 : 1;
	default:
		return 1;
	}
}

uint64_t view_record_span(const struct view_list *list, uint32_t first_chunk, uint32_t end_chunk)
{
	uint64_t texels = 0;
	if (list->list.kind != ECO_LIST_IMPOSTOR)
		return (uint64_t)view_list_chunks(list, first_chunk, end_chunk).primitive_count
			* view_record_texels(&list->list);
	for (uint32_t i = first_chunk; i < end_chunk; i++)
		texels += view_impostor_texels(&list->impostors[i]);
	return texels;
}

static void put(uint32_t **out, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	(*out)[0] = a, (*out)[1] = b, (*out)[2] = c, (*out)[3] = d;
	*out += 4;
}

static void put_point(uint32_t **out, const float *p, uint32_t w)
{
	put(out, bits(p[0]), bits(p[1]), bits(p[2]), w);
}

struct scratch { struct lod_geometry g; float *twice; uint8_t *code; };

static void scratch_free(struct scratch *s)
{
	lod_geometry_free(&s->g);
	free(s->twice);
	free(s->code);
}

static bool scratch_make(struct scratch *s, const struct eco_list *list, uint32_t count)
{
	*s = (struct scratch){ .twice = malloc(36u * (size_t)count + 1), .code = malloc((size_t)count + 1) };
	if (lod_geometry_make(&s->g, list, count, view_record_texels(list) == 5) && s->twice && s->code)
		return true;
	scratch_free(s);
	return false;
}

/* Codes of elements, one a primitive. */
static void find_codes(const struct eco_list *list, const struct eco_elements *e, uint8_t *code)
{
	bool point = list->kind == ECO_LIST_POINTS,
		has = list->attributes & (point ? ECO_ATTR_SIZE : ECO_ATTR_GROWTH);
	uint32_t at = has ? eco_list_extra_at(list, point ? ECO_ATTR_SIZE : ECO_ATTR_GROWTH) : 0;
	for (uint32_t i = 0; i < e->element_count; i++) {
		uint32_t count = e->corners[i] < 3 ? 1 : e->corners[i] - 2u;
		memset(code, has ? e->extra[(size_t)e->extra_count * i + at]
			: (int)(point ? ECO_SIZE_ONE : ECO_GROWTH_PLAIN), count);
		code += count;
	}
}

static uint32_t color_word(const struct view_list *list, const struct scratch *s, uint32_t i)
{
	return packed_color(list, s->g.color[i]) | (uint32_t)s->code[i] << 24 | (eco_list_is_wood(&list->list) ? VIEW_WOOD : 0);
}

static void write_triangle(const struct view_list *list, const struct scratch *s, uint32_t i, uint32_t texels,
	uint32_t **out)
{
	const float *p = s->g.position + 9 * (size_t)i, *twice = s->twice + 9 * (size_t)i,
		*uv = s->g.uv ? s->g.uv + 6 * (size_t)i : NULL;
	float center[3];
	for (int k = 0; k < 3; k++)
		center[k] = 2 * p[k] - twice[k];
	put_point(out, p, color_word(list, s, i));
	put_point(out, p + 3, bits(center[0]));
	put_point(out, p + 6, bits(center[1]));
	if (texels == 4) {
		put(out, bits(center[2]), 0, 0, 0);
		return;
	}
	put(out, bits(center[2]), bits(uv[0]), bits(uv[1]), bits(uv[2]));
	put(out, bits(uv[3]), bits(uv[4]), bits(uv[5]), 0);
}

static uint32_t packed_normal(const float n[3])
{
	int16_t a = (int16_t)floorf(n[0] * 32767 + 0.5f), b = (int16_t)floorf(n[1] * 32767 + 0.5f);
	return (uint32_t)(uint16_t)a | (uint32_t)(uint16_t)b << 16;
}

static void write_ground(const struct view_list *list, const struct eco_elements *e, uint32_t *out)
{
	uint32_t first = (uint32_t)((e->position - list->elements.position) / 3);
	for (uint32_t i = 0; i < e->element_count; i++) {
		const int32_t *p = e->position + 3 * (size_t)i;
		float normal[3];
		view_ground_normal(list, first + i, normal);
		put(&out, (uint32_t)p[0], (uint32_t)p[1], (uint32_t)p[2], packed_normal(normal));
	}
}

static void write_impostors(const struct view_list *list, uint32_t first, uint32_t end, uint32_t *out)
{
	for (uint32_t i = first; i < end; i++) {
		view_impostor_write(&list->impostors[i], out);
		out += 4 * (size_t)view_impostor_texels(&list->impostors[i]);
	}
}

enum eco_code view_record_write(const struct view_list *list, uint32_t first_chunk, uint32_t end_chunk,
	uint32_t *words, struct eco_error *error)
{
	if (list->list.kind == ECO_LIST_IMPOSTOR) {
		write_impostors(list, first_chunk, end_chunk, words);
		return ECO_OK;
	}
	struct eco_elements e = view_list_chunks(list, first_chunk, end_chunk);
	uint32_t count = e.primitive_count, texels = view_record_texels(&list->list);
	if (list->list.kind == ECO_LIST_GROUND) {
		write_ground(list, &e, words);
		return ECO_OK;
	}
	struct scratch s;
	if (!scratch_make(&s, &list->list, count))
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the geometry of list %u", list->id);
	struct lod_geometry twice = { .position = s.twice };
	struct eco_list plain = list->list;              /* whose elements all grow by the factor */
	plain.attributes &= (uint8_t)~ECO_ATTR_GROWTH;
	uint32_t written = lod_list_geometry(&list->list, &e, 0, count, 1, &s.g);
	assert(written == count);
	if (list->list.kind == ECO_LIST_TRIANGLES)
		lod_list_geometry(&plain, &e, 0, count, 4, &twice);
	find_codes(&list->list, &e, s.code);
	uint32_t first_point = first_chunk ? list->marks[first_chunk - 1].elements : 0;
	for (uint32_t i = 0; i < count; i++) {
		if (list->list.kind == ECO_LIST_TRIANGLES) {
			write_triangle(list, &s, i, texels, &words);
		} else if (list->list.kind == ECO_LIST_LINES) {
			put_point(&words, s.g.position + 6 * (size_t)i, bits(s.g.width[i]));
			put_point(&words, s.g.position + 6 * (size_t)i + 3, color_word(list, &s, i));
		} else {
			if (s.g.half)
				s.code[i] = (uint8_t)(s.g.opacity[i] * ECO_SPLAT_OPACITIES)
					| (s.g.wood[i] > 0 ? VIEW_WOOD >> 24 : 0);
			put_point(&words, s.g.position + 3 * (size_t)i, color_word(list, &s, i));
			for (uint32_t k = 0; k < 3 && s.g.half; k++)
				put_point(&words, s.g.half + 9 * (size_t)i + 3 * k, 0);
			if (texels == 2) {
				uint64_t owner = view_summary_owner(list, first_point + i, 0);
				put(&words, (uint32_t)owner, (uint32_t)(owner >> 32), key_mask(), 0);
			}
		}
	}
	scratch_free(&s);
	return ECO_OK;
}

/* ---- Instances ---- */

/* As lod/raster/raster.c makes them: differences in double, then rounded once. */
void view_instance_write(uint32_t *words, const struct lod_eye *eye, const struct view_instance *p,
	const struct view_plant *plant)
{
	const struct lod_place *place = &p->place;
	const double *axes[3] = { eye->right, eye->up, eye->forward };
	double offset[3] = { place->at[0] - eye->at[0], place->at[1] - eye->at[1],
		place->at[2] - eye->at[2] };
	double across = place->scale * lod_place_width(place), sine = place->sine * across, cosine = place->cosine * across;
	for (int i = 0; i < 3; i++) {
		const double *a = axes[i];
		put(&words, bits((float)(a[0] * cosine + a[1] * sine)),
			bits((float)(a[1] * cosine - a[0] * sine)), bits((float)(a[2] * place->scale)),
			bits((float)(a[0] * offset[0] + a[1] * offset[1] + a[2] * offset[2])));
	}
	uint32_t half = (bits(plant ? view_shape_of(plant).half_width : 0) + 0x8000u) & 0xFFFF0000u;
	put(&words, bits((float)place->scale), half | place->salt, bits((float)lod_place_width(place)), p->tint);
}
