#include "tests/support/plant_models.h"
#include "ecofiles/base/array_grow.h"

double soup_random(struct soup *s, double low, double high)
{
	return low + (high - low) * eco_random_unit(s->state = lod_mix(s->state));
}

void soup_begin(struct soup *s)
{
	memset(s, 0, sizeof *s);
	s->model.materials = s->material;
	s->model.images = s->image;
}

uint32_t soup_material(struct soup *s, uint8_t r, uint8_t g, uint8_t b, uint32_t image, bool cutout)
{
	s->material[s->model.material_count] = (struct eco_material){ .rgb = { r, g, b }, .image = image,
		.cutout = cutout };
	return s->model.material_count++;
}

uint32_t soup_disc_image(struct soup *s, uint32_t size)
{
	struct eco_image *image = &s->image[s->model.image_count];
	*image = (struct eco_image){ size, size, calloc((size_t)size * size, 4) };
	for (uint32_t y = 0; y < size; y++)
		for (uint32_t x = 0; x < size; x++) {
			double dx = (x + 0.5) / size - 0.5, dy = (y + 0.5) / size - 0.5;
			uint8_t rgba[4] = { (uint8_t)(x < size / 2 ? 40 : 90), 160, 30,
				dx * dx + dy * dy < 0.16 ? 255 : 0 };
			memcpy(image->rgba + 4 * ((size_t)y * size + x), rgba, 4);
		}
	return s->model.image_count++;
}

uint32_t soup_vertex(struct soup *s, struct lod_v3 p, double u, double v)
{
	struct eco_model *m = &s->model;
	if (m->vertex_count == s->vertex_capacity) {
		s->vertex_capacity = 2 * s->vertex_capacity + 64;
		m->position = realloc(m->position, 3 * (size_t)s->vertex_capacity * sizeof(float));
		m->uv = realloc(m->uv, 2 * (size_t)s->vertex_capacity * sizeof(float));
	}
	float *to = m->position + 3 * (size_t)m->vertex_count;
	to[0] = (float)p.x;
	to[1] = (float)p.y;
	to[2] = (float)p.z;
	m->uv[2 * (size_t)m->vertex_count] = (float)u;
	m->uv[2 * (size_t)m->vertex_count + 1] = (float)v;
	return m->vertex_count++;
}

void soup_triangle(struct soup *s, uint32_t material, uint32_t a, uint32_t b, uint32_t c)
{
	struct eco_model *m = &s->model;
	if (m->triangle_count == s->triangle_capacity) {
		s->triangle_capacity = 2 * s->triangle_capacity + 64;
		m->index = realloc(m->index, 3 * (size_t)s->triangle_capacity * sizeof(uint32_t));
		m->material = realloc(m->material, (size_t)s->triangle_capacity * sizeof(uint32_t));
	}
	uint32_t v[3] = { a, b, c };
	memcpy(m->index + 3 * (size_t)m->triangle_count, v, sizeof v);
	m->material[m->triangle_count++] = material;
	m->triangles_in++;
}

void soup_free(struct soup *s)
{
	eco_free(s->model.position, s->model.uv, s->model.index, s->model.material);
	for (uint32_t i = 0; i < s->model.image_count; i++)
		free(s->image[i].rgba);
	memset(s, 0, sizeof *s);
}

static void join_rings(struct soup *s, uint32_t material, uint32_t first, uint32_t rings, uint32_t sides)
{
	for (uint32_t i = 0; i < rings; i++)
		for (uint32_t k = 0; k < sides; k++) {
			uint32_t p = first + i * sides + k, q = first + i * sides + (k + 1) % sides;
			soup_triangle(s, material, p, q, q + sides);
			soup_triangle(s, material, p, q + sides, p + sides);
		}
}

void soup_tube(struct soup *s, uint32_t material, struct lod_v3 a, struct lod_v3 b, double r, double t,
	uint32_t sides, uint32_t rings)
{
	struct lod_v3 axis = lod_v3_unit(lod_v3_sub(b, a)), up = fabs(axis.z) < 0.8
		? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 };
	struct lod_v3 x = lod_v3_unit(lod_v3_cross(up, axis)), y = lod_v3_cross(axis, x);
	uint32_t first = s->model.vertex_count;
	for (uint32_t i = 0; i <= rings; i++)
		for (uint32_t k = 0; k < sides; k++) {
			double w = (double)i / rings, radius = r + (t - r) * w,
				angle = 2 * LOD_PI * k / sides;
			struct lod_v3 p =
				lod_v3_add(lod_v3_mix(a, b, w),
				lod_v3_add(lod_v3_scale(x, radius * cos(angle)),
				lod_v3_scale(y, radius * sin(angle))));
			soup_vertex(s, p, (double)k / sides, 4 * w);
		}
	join_rings(s, material, first, rings, sides);
}

void soup_turned(struct soup *s, uint32_t material, double z, double radius, double height,
	const double (*ring)[2], uint32_t rings, uint32_t sides)
{
	uint32_t first = s->model.vertex_count;
	for (uint32_t i = 0; i < rings * sides; i++) {
		double r = radius * ring[i / sides][0], turn = 2 * LOD_PI * (i % sides) / sides;
		soup_vertex(s, (struct lod_v3){ r * cos(turn), r * sin(turn), z + height * ring[i / sides][1] },
			0, 0);
	}
	join_rings(s, material, first, rings - 1, sides);
}

void soup_quad(struct soup *s, uint32_t material, struct lod_v3 at, struct lod_v3 u, struct lod_v3 v)
{
	uint32_t p[4];
	for (int i = 0; i < 4; i++) {
		double a = i == 0 || i == 3 ? -0.5 : 0.5, b = i < 2 ? -0.5 : 0.5;
		p[i] = soup_vertex(s, lod_v3_add(at, lod_v3_add(lod_v3_scale(u, a), lod_v3_scale(v, b))),
			a + 0.5, b + 0.5);
	}
	soup_triangle(s, material, p[0], p[1], p[2]);
	soup_triangle(s, material, p[0], p[2], p[3]);
}

struct lod_v3 soup_direction(struct soup *s)
{
	for (;;) {
		struct lod_v3 d = { soup_random(s, -1, 1), soup_random(s, -1, 1), soup_random(s, -1, 1) };
		double length = lod_v3_length(d);
		if (length > 0.1 && length < 1)
			return lod_v3_scale(d, 1 / length);
	}
}

void soup_leaf(struct soup *s, uint32_t material, struct lod_v3 at, double length, double width)
{
	struct lod_v3 u = soup_direction(s), v = lod_v3_unit(lod_v3_cross(u, soup_direction(s)));
	soup_quad(s, material, at, lod_v3_scale(u, length), lod_v3_scale(v, width));
}

void soup_leaves(struct soup *s, uint32_t material, int count, struct lod_v3 at, double radius, double size)
{
	for (int i = 0; i < count; i++)
		soup_leaf(s, material,
			lod_v3_add(at, lod_v3_scale(soup_direction(s), radius * sqrt(soup_random(s, 0, 1)))),
			size, 0.6 * size);
}

void soup_ball(struct soup *s, uint32_t material, struct lod_v3 at, double radius, uint32_t n)
{
	uint32_t first = s->model.vertex_count;
	for (uint32_t i = 1; i < n; i++)
		for (uint32_t k = 0; k < 2 * n; k++) {
			double t = LOD_PI * i / n, a = LOD_PI * k / n;
			soup_vertex(s,
				lod_v3_add(at,
				(struct lod_v3){ radius * sin(t) * cos(a), radius * sin(t) * sin(a),
				radius * cos(t) }), 0, 0);
		}
	uint32_t top = soup_vertex(s, lod_v3_add(at, (struct lod_v3){ 0, 0, radius }), 0, 0);
	uint32_t bottom = soup_vertex(s, lod_v3_add(at, (struct lod_v3){ 0, 0, -radius }), 0, 0);
	for (uint32_t k = 0; k < 2 * n; k++) {
		uint32_t l = (k + 1) % (2 * n);
		soup_triangle(s, material, top, first + k, first + l);
		soup_triangle(s, material, bottom, first + (n - 2) * 2 * n + l, first + (n - 2) * 2 * n + k);
		for (uint32_t i = 0; i + 2 < n; i++) {
			uint32_t p = first + i * 2 * n + k, q = first + i * 2 * n + l;
			soup_triangle(s, material, p, p + 2 * n, q + 2 * n);
			soup_triangle(s, material, p, q + 2 * n, q);
		}
	}
}

void soup_tree(struct soup *s, uint32_t leaves, uint32_t flowers, bool textured)
{
	soup_begin(s);
	uint32_t bark = soup_material(s, 110, 80, 50, ECO_NONE, false);
	uint32_t leaf = soup_material(s, 60, 150, 40, textured ? soup_disc_image(s, 32) : ECO_NONE, textured);
	uint32_t petal = soup_material(s, 220, 30, 60, ECO_NONE, false);
	soup_tube(s, bark, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0.1, 0, 4.5 }, 0.15, 0.06, 8, 24);
	for (int i = 0; i < 12; i++) {
		struct lod_v3 from = { 0.1, 0, 2 + 0.2 * i }, d = soup_direction(s);
		d.z = fabs(d.z);
		soup_tube(s, bark, from, lod_v3_add(from, lod_v3_scale(d, 1.6)), 0.03, 0.01, 6, 12);
	}
	for (uint32_t i = 0; i < leaves + flowers; i++) {
		struct lod_v3 at = lod_v3_add((struct lod_v3){ 0, 0, 4 },
			lod_v3_scale(soup_direction(s), 2 * sqrt(soup_random(s, 0, 1))));
		soup_leaf(s, i < leaves ? leaf : petal, at, 0.12, 0.08);
	}
}

/* ---- Leaves alone ---- */

double foliage_dice(uint64_t *state)
{
	return 2 * eco_random_unit(*state = lod_mix(*state)) - 1;
}

static struct lod_v3 foliage_direction(uint64_t *state)
{
	struct lod_v3 d = { 0, 0, 0 };
	while (!(lod_v3_length(d) > 0.1) || lod_v3_length(d) > 1)
		d = (struct lod_v3){ foliage_dice(state), foliage_dice(state), foliage_dice(state) };
	return d;
}

static void foliage_leaf(struct lod_foliage *f, uint32_t i, struct lod_v3 at, struct lod_v3 along,
	struct lod_v3 across, uint32_t corners)
{
	static const double shape[6][2] = { { -1, 0 }, { -0.5, -0.4 }, { 0.5, -0.4 }, { 1, 0 }, { 0.5, 0.4 },
		{ -0.5, 0.4 } };
	f->first[i + 1] = f->first[i] + corners;
	f->triangle_first[i + 1] = f->triangle_first[i] + corners - 2;
	for (uint32_t k = 0; k < corners; k++) {
		const double *s = shape[k * 6 / corners];
		struct lod_v3 p =
			lod_v3_add(at, lod_v3_add(lod_v3_scale(along, s[0]), lod_v3_scale(across, s[1])));
		float *to = f->corner[f->first[i] + k];
		to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z;
		f->low = (struct lod_v3){ fmin(f->low.x, p.x), fmin(f->low.y, p.y), fmin(f->low.z, p.z) };
		f->high = (struct lod_v3){ fmax(f->high.x, p.x), fmax(f->high.y, p.y), fmax(f->high.z, p.z) };
	}
	f->center[i] = at;
	f->normal[i] = lod_v3_cross(along, across);
	f->area[i] = lod_v3_length(f->normal[i]);
}

void foliage_random(struct lod_foliage *f, const struct foliage_random *how, struct lod_arena *arena)
{
	uint64_t dice = how->seed;
	size_t n = how->leaves;
	*f = (struct lod_foliage){ .count = how->leaves, .group_count = 1, .wood_count = 1 };
	f->first = lod_arena_take(arena, n + 1, sizeof *f->first);
	f->triangle_first = lod_arena_take(arena, n + 1, sizeof *f->triangle_first);
	f->corner = lod_arena_take(arena, n * how->corners, sizeof *f->corner);
	f->uv = lod_arena_take(arena, n * how->corners, sizeof *f->uv);
	f->cutout = lod_arena_take(arena, n, sizeof *f->cutout);
	f->group = lod_arena_take(arena, n, sizeof *f->group);
	f->center = lod_arena_take(arena, n, sizeof *f->center);
	f->normal = lod_arena_take(arena, n, sizeof *f->normal);
	f->area = lod_arena_take(arena, n, sizeof *f->area);
	f->wood = lod_arena_take(arena, 9, sizeof *f->wood);
	f->wood[3] = 0.05f;
	f->wood[8] = (float)-how->radius;
	f->low.z = -how->radius;
	for (uint32_t i = 0; i < how->leaves; i++) {
		struct lod_v3 along = lod_v3_scale(lod_v3_unit(foliage_direction(&dice)), how->leaf);
		struct lod_v3 across =
			lod_v3_scale(lod_v3_unit(lod_v3_cross(along, foliage_direction(&dice))), how->leaf);
		foliage_leaf(f, i, lod_v3_scale(foliage_direction(&dice), how->radius), along, across,
			how->corners);
	}
}
