/* The stages are those of lod_plant_build up to its elements, so that element i here is element i of the
 * packed plant. No libm decides where a view is. */
#include "lod/build/foliage.h"

#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/build/element.h"
#include "lod/build/model_draw.h"

#define DISTANCE_RADII 16.0
#define FRAME 1.04 /* half the picture over the radius of the bounding sphere's silhouette */
#define LOWEST (-0.2)                /* range of heights on the unit sphere of views */
#define HIGHEST 0.95
#define SOUP 256u                    /* triangles in a batch */
#define SHIFT UINT64_MAX              /* number of the random choice of a spiral's start */

/* Per image of the model: whether it has transparent texels. */
static bool *find_holes(const struct eco_model *model, struct lod_arena *arena)
{
	bool *holes = lod_arena_take(arena, model->image_count, sizeof *holes);
	for (uint32_t i = 0; i < model->image_count; i++)
		holes[i] = eco_image_has_holes(&model->images[i]);
	return holes;
}

static void take_arrays(struct lod_foliage *foliage, const struct lod_elements *elements,
	struct lod_arena *arena)
{
	size_t corners = 0, n = elements->count;
	for (uint32_t i = 0; i < elements->count; i++)
		corners += elements->items[i].corners;
	foliage->count = elements->count;
	foliage->first = lod_arena_take(arena, n + 1, sizeof *foliage->first);
	foliage->triangle_first = lod_arena_take(arena, n + 1, sizeof *foliage->triangle_first);
	foliage->corner = lod_arena_take(arena, corners, sizeof *foliage->corner);
	foliage->uv = lod_arena_take(arena, corners, sizeof *foliage->uv);
	foliage->cutout = lod_arena_take(arena, n, sizeof *foliage->cutout);
	foliage->mask = lod_arena_take(arena, n, sizeof *foliage->mask);
	foliage->group = lod_arena_take(arena, n, sizeof *foliage->group);
	foliage->center = lod_arena_take(arena, n, sizeof *foliage->center);
	foliage->normal = lod_arena_take(arena, n, sizeof *foliage->normal);
	foliage->area = lod_arena_take(arena, n, sizeof *foliage->area);
}

/* Groups are numbered in the order of their first elements. */
static uint32_t group_of(struct lod_foliage *foliage, uint32_t *number, uint32_t organ, uint32_t image,
	uint32_t images)
{
	uint32_t *known = &number[(size_t)organ * (images + 1) + (image == ECO_NONE ? images : image)];
	if (*known == 0)
		*known = ++foliage->group_count;
	return *known - 1;
}

static void fill_element(struct lod_foliage *foliage, uint32_t i, const struct lod_foliage_parts *parts)
{
	const struct lod_element *e = &parts->elements->items[i];
	const struct lod_mesh *mesh = parts->mesh;
	int32_t uv[2 * ECO_CORNERS_MAX];
	uint32_t at = foliage->first[i];
	lod_element_uv(e, mesh, uv);
	for (uint32_t k = 0; k < e->corners; k++) {
		memcpy(foliage->corner[at + k], mesh->place + 3 * (size_t)e->vertex[k],
			sizeof foliage->corner[0]);
		for (int a = 0; a < 2; a++)
			foliage->uv[at + k][a] = (float)uv[2 * k + (uint32_t)a] / ECO_UV_ONE;
	}
	foliage->first[i + 1] = at + e->corners;
	foliage->triangle_first[i + 1] = foliage->triangle_first[i] + e->corners - 2u;
	foliage->center[i] = lod_element_center(e, mesh);
	foliage->normal[i] = lod_element_normal(e, mesh);
	for (uint32_t k = 0; k + 2 < e->corners; k++)
		foliage->area[i] += parts->organs->area[e->triangle[k]];
}

static void fill_wood(struct lod_foliage *foliage, const struct lod_foliage_parts *parts,
	struct lod_arena *arena)
{
	const struct lod_mesh *mesh = parts->mesh;
	for (int pass = 0; pass < 2; pass++) {
		uint64_t count = 0;
		for (uint32_t t = 0; t < mesh->triangle_count; t++) {
			if (mesh->collapsed[t] || parts->organs->components[mesh->component[t]].organ
					!= ECO_ORGAN_WOOD)
				continue;
			for (uint32_t k = 0; k < 3 && pass == 1; k++)
				memcpy(foliage->wood + 9 * count + 3 * k,
					mesh->place + 3 * (size_t)mesh->index[3 * (size_t)t + k],
					3 * sizeof(float));
			count++;
		}
		foliage->wood_count = count;
		if (pass == 0)
			foliage->wood = lod_arena_take(arena, count, 9 * sizeof *foliage->wood);
	}
}

void lod_foliage_from(struct lod_foliage *foliage, const struct lod_foliage_parts *parts,
	struct lod_arena *arena)
{
	const struct lod_mesh *mesh = parts->mesh;
	const struct eco_model *model = parts->model;
	*foliage = (struct lod_foliage){ .low = lod_v3_of(mesh->low), .high = lod_v3_of(mesh->high) };
	take_arrays(foliage, parts->elements, arena);
	bool *holes = find_holes(model, arena);
	const struct lod_mask *masks = lod_model_masks(model, arena);
	uint32_t *number = lod_arena_take(arena, ECO_ORGAN_COUNT * ((size_t)model->image_count + 1),
		sizeof *number);
	for (uint32_t i = 0; i < foliage->count; i++) {
		uint32_t triangle = parts->elements->items[i].triangle[0];
		const struct lod_component *c = &parts->organs->components[mesh->component[triangle]];
		const struct eco_image *image = lod_mesh_image(model, c->material);
		uint32_t image_index = image ? (uint32_t)(image - model->images) : ECO_NONE;
		fill_element(foliage, i, parts);
		foliage->group[i] = group_of(foliage, number, c->organ, image_index, model->image_count);
		if (image && lod_mesh_material(model, c->material)->cutout && holes[image_index]) {
			foliage->cutout[i] = image;
			foliage->mask[i] = lod_model_mask(model, masks, image);
		}
	}
	fill_wood(foliage, parts, arena);
}

/* ---- Directions ---- */

static double share_of(uint64_t hash)
{
	return ((double)(hash >> 11) + 0.5) / 9007199254740992.0;
}

/* A random unit vector in the plane, by rejection. */
static void turn_of(uint32_t seed, double *x, double *y)
{
	double length = 0;
	for (uint64_t i = 0; !(length > 1e-3) || length > 1; i++) {
		*x = 2 * share_of(eco_random(seed, 2 * i)) - 1;
		*y = 2 * share_of(eco_random(seed, 2 * i + 1)) - 1;
		length = *x * *x + *y * *y;
	}
	length = sqrt(length);
	*x /= length;
	*y /= length;
}

void lod_directions_spread(double (*directions)[3], uint32_t count, uint32_t seed)
{
	double x, y, shift = share_of(eco_random(seed, SHIFT));
	turn_of(seed, &x, &y);
	for (uint32_t i = 0; i < count; i++) {
		double z = LOWEST + (HIGHEST - LOWEST) * (i + shift) / count, flat = sqrt(1 - z * z);
		directions[i][0] = flat * x;
		directions[i][1] = flat * y;
		directions[i][2] = z;
		lod_turn_golden(&x, &y);
	}
}

/* ---- Sights ---- */

static double sphere(const struct lod_foliage *foliage, struct lod_v3 *center)
{
	double far = 0;
	*center = lod_v3_mix(foliage->low, foliage->high, 0.5);
	for (uint32_t i = 0; i < foliage->first[foliage->count]; i++)
		far = fmax(far, lod_v3_distance(*center, lod_v3_of(foliage->corner[i])));
	for (uint64_t i = 0; i < 3 * foliage->wood_count; i++)
		far = fmax(far, lod_v3_distance(*center, lod_v3_of(foliage->wood + 3 * i)));
	return far > 0 ? far : 1;
}

static void place_eye(struct lod_eye *eye, const double direction[3], struct lod_v3 center, double radius,
	uint32_t pixels)
{
	double away = DISTANCE_RADII * radius, half = FRAME * radius / sqrt(away * away - radius * radius);
	struct lod_v3 from = lod_v3_unit((struct lod_v3){ direction[0], direction[1], direction[2] });
	double flat = sqrt(from.x * from.x + from.y * from.y);
	struct lod_v3 right = flat > 1e-9 ? (struct lod_v3){ -from.y / flat, from.x / flat, 0 }
		: (struct lod_v3){ 1, 0, 0 };
	struct lod_v3 up = lod_v3_cross(from, right), at = lod_v3_add(center, lod_v3_scale(from, away));
	*eye = (struct lod_eye){ .at = { at.x, at.y, at.z }, .right = { right.x, right.y, right.z },
		.up = { up.x, up.y, up.z },
		.forward = { -from.x, -from.y, -from.z }, .tan_x = half, .tan_y = half,
		.pixel_rad = 2 * half / pixels };
}

static void gather_bits(const struct lod_sights *sights, const struct lod_raster *raster, uint64_t *mask)
{
	uint32_t row_words = sights->words / sights->pixels;
	for (uint32_t y = 0; y < sights->pixels; y++) {
		const uint8_t *cover = raster->cover + (size_t)y * sights->pixels;
		for (uint32_t x = 0; x < sights->pixels; x++)
			mask[(size_t)y * row_words + x / 64] |= (uint64_t)(cover[x] & 1) << (x % 64);
	}
}

static void draw_wood(const struct lod_sights *sights, uint32_t view, struct lod_raster *raster)
{
	const struct lod_foliage *foliage = sights->foliage;
	lod_raster_look(raster, &sights->eyes[view], sights->near_m);
	for (uint64_t first = 0; first < foliage->wood_count; first += 1u << 20) {
		uint64_t count = foliage->wood_count - first < 1u << 20 ? foliage->wood_count - first
			: 1u << 20;
		lod_raster_triangles(raster,
			&(struct lod_raster_batch){ .count = (uint32_t)count,
			.position = foliage->wood + 9 * first, .owner = 1 });
	}
}

static uint64_t bits_of(const uint64_t *mask, uint32_t words)
{
	uint64_t bits = 0;
	for (uint32_t i = 0; i < words; i++)
		bits += (uint64_t)__builtin_popcountll(mask[i]);
	return bits;
}

static void draw_reference(struct lod_sights *sights, uint32_t view, struct lod_raster *raster)
{
	draw_wood(sights, view, raster);
	gather_bits(sights, raster, sights->wood[view]);
	lod_sights_draw(sights, view,
		&(struct lod_sights_drawing){ .count = sights->foliage->count, .scale = 1 }, raster,
		sights->reference[view]);
	sights->reference_pixels[view] = bits_of(sights->reference[view], sights->words);
}

void lod_sights_make(struct lod_sights *sights, const struct lod_foliage *foliage,
	const double (*directions)[3], uint32_t count, uint32_t pixels, struct lod_arena *arena)
{
	struct lod_raster raster;
	struct lod_v3 center;
	double radius = sphere(foliage, &center);
	*sights = (struct lod_sights){ .foliage = foliage, .count = count, .pixels = pixels,
		.words = (pixels + 63) / 64 * pixels,
		.near_m = (DISTANCE_RADII - 4) * radius };
	sights->eyes = lod_arena_take(arena, count, sizeof *sights->eyes);
	sights->reference = lod_arena_take(arena, count, sizeof *sights->reference);
	sights->wood = lod_arena_take(arena, count, sizeof *sights->wood);
	sights->reference_pixels = lod_arena_take(arena, count, sizeof *sights->reference_pixels);
	for (uint32_t i = 0; i < count; i++) {
		sights->reference[i] = lod_arena_take(arena, sights->words, sizeof(uint64_t));
		sights->wood[i] = lod_arena_take(arena, sights->words, sizeof(uint64_t));
		place_eye(&sights->eyes[i], directions[i], center, radius, pixels);
	}
	lod_raster_init(&raster,
		&(struct lod_raster_options){ .width = pixels, .height = pixels, .silhouette = true });
	for (uint32_t i = 0; i < count; i++)
		draw_reference(sights, i, &raster);
	lod_raster_free(&raster);
}

/* ---- Drawing ---- */

struct soup {
	struct lod_raster *raster;
	const struct eco_image *cutout;      /* of its triangles */
	const struct lod_mask *mask;
	uint32_t count;
	float position[9 * SOUP], uv[6 * SOUP];
};

static void flush(struct soup *soup)
{
	if (soup->count)
		lod_raster_triangles(soup->raster,
			&(struct lod_raster_batch){ .count = soup->count, .position = soup->position,
			.uv = soup->cutout ? soup->uv : NULL, .cutout = soup->cutout, .mask = soup->mask, .owner = 1 });
	soup->count = 0;
}

/* A fan, scaled about the mean of its corners by the factor of edges. */
static void add_fan(struct soup *soup, const float (*corner)[3], const float (*uv)[2], uint32_t corners,
	const struct eco_image *cutout, const struct lod_mask *mask, double edge)
{
	float at[ECO_CORNERS_MAX][3];
	double center[3] = { 0, 0, 0 };
	for (uint32_t i = 0; i < corners; i++)
		for (int a = 0; a < 3; a++)
			center[a] += (double)corner[i][a] / corners;
	for (uint32_t i = 0; i < corners; i++)
		for (int a = 0; a < 3; a++)
			at[i][a] = edge == 1 ? corner[i][a]
				: (float)(center[a] + edge * (corner[i][a] - center[a]));
	if (soup->cutout != cutout || soup->count + corners - 2 > SOUP)
		flush(soup);
	soup->cutout = cutout;
	soup->mask = mask;
	for (uint32_t t = 0; t + 2 < corners; t++, soup->count++) {
		const uint32_t which[3] = { 0, t + 1, t + 2 };
		for (int k = 0; k < 3; k++) {
			memcpy(soup->position + 9 * soup->count + 3 * k, at[which[k]], sizeof at[0]);
			if (cutout)
				memcpy(soup->uv + 6 * soup->count + 2 * k, uv[which[k]], sizeof uv[0]);
		}
	}
}

void lod_sights_draw(const struct lod_sights *sights, uint32_t view, const struct lod_sights_drawing *drawing,
	struct lod_raster *raster, uint64_t *mask)
{
	const struct lod_foliage *foliage = sights->foliage;
	struct soup soup = { .raster = raster };
	lod_raster_look(raster, &sights->eyes[view], sights->near_m);
	for (uint32_t k = 0; k < drawing->count; k++) {
		uint32_t i = drawing->order ? drawing->order[k] : k, at = foliage->first[i];
		double factor = drawing->factor ? drawing->factor[i] : drawing->scale, edge = factor == 1 ? 1
			: sqrt(factor);
		if (drawing->shape && drawing->shape[i].corners)
			add_fan(&soup, (const float (*)[3])drawing->shape[i].corner, NULL,
				drawing->shape[i].corners, NULL, NULL, edge);
		else
			add_fan(&soup, (const float (*)[3])(foliage->corner + at),
				(const float (*)[2])(foliage->uv + at), foliage->first[i + 1] - at,
				foliage->cutout[i], foliage->mask ? foliage->mask[i] : NULL, edge);
	}
	flush(&soup);
	gather_bits(sights, raster, mask);
	for (uint32_t i = 0; i < sights->words; i++)
		mask[i] |= sights->wood[view][i];
}
