/* A soup while a reader makes it: vertices in double, with colours, and meshes of one material each. At the
 * end it is known how far from the origin everything is, and which colours of vertices differ. Longer than
 * 600 lines: readers add to one soup, whose arrays no other file grows.
 *
 * Vertex colours become materials, one for each colour: lists have a colour per primitive, not per vertex.
 *
 * Colours of textured materials are multiplied into their images, in linear light as glTF means it. Lists of
 * triangles have an image and no colour beside it, while points and lines take their colours from texels and
 * materials: with the product in the texels all of them agree. Each further colour of an image needs a copy
 * of it; beyond a limit the nearest existing colour is used.
 *
 * Afterwards an image of one colour is that colour, and images that are equal texel by texel become one, so
 * that names, alpha modes and cut-offs without effect cost nothing in a pack.
 *
 * Longer than 600 lines: all steps work on one soup, whose tables no other file sees. */
#include "ecofiles/import/model/import_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/geometry.h"
#include "ecofiles/base/memory.h"

#define TINTS_MAX 32u                            /* per image */
#define COPIED_PIXELS_MAX ((uint64_t)1 << 26)    /* per model */

/* ---- Colours of vertices ---- */

struct tints {                   /* materials made from vertex colours, appended to the model's */
	struct eco_model *model;
	uint32_t base, count;        /* the model's own materials; the tints */
	uint64_t *key;
	uint32_t *table;             /* open addressing: tint + 1 */
};

static void tints_start(struct tints *t, struct eco_model *model)
{
	*t = (struct tints){ .model = model, .base = model->material_count };
	model->materials = eco_realloc(model->materials, (size_t)model->material_count + ECO_TINTS_MAX,
		sizeof *model->materials);
	t->key = eco_alloc(ECO_TINTS_MAX, sizeof *t->key);
	t->table = eco_alloc(4 * ECO_TINTS_MAX, sizeof *t->table);
}

static uint32_t distance(const uint8_t a[3], const uint8_t b[3])
{
	uint32_t sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (uint32_t)((a[k] - b[k]) * (a[k] - b[k]));
	return sum;
}

static void tinted(const struct eco_material *from, const uint8_t tint[3], uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = eco_srgb_from_linear(eco_linear_from_srgb(from->rgb[k])
			* eco_linear_from_srgb(tint[k]));
}

/* Material `material` times an sRGB colour, in linear light; itself for white, and beyond the limit. */
static uint32_t tints_get(struct tints *t, uint32_t material, const uint8_t rgb[3])
{
	struct eco_model *m = t->model;
	uint64_t key = (uint64_t)material << 24 | (uint64_t)rgb[0] << 16 | (uint64_t)rgb[1] << 8 | rgb[2];
	uint32_t slot = (uint32_t)((key * 0x9e3779b97f4a7c15u) >> 40) % (4 * ECO_TINTS_MAX);
	if (rgb[0] == 255 && rgb[1] == 255 && rgb[2] == 255)
		return material;
	while (t->table[slot] != 0 && t->key[t->table[slot] - 1] != key)
		slot = (slot + 1) % (4 * ECO_TINTS_MAX);
	if (t->table[slot] != 0)
		return t->base + t->table[slot] - 1;
	if (t->count == ECO_TINTS_MAX)
		return material;
	t->key[t->count++] = key;
	t->table[slot] = t->count;
	/* lod_organs_split knows a surface by its material's name, whatever its colours */
	if (m->materials[material].name[0] == 0)
		snprintf(m->materials[material].name, sizeof m->materials[material].name, "vertex colours %u",
			(unsigned)material + 1);
	struct eco_material *to = &m->materials[m->material_count];
	*to = m->materials[material];
	to->colourless = false;
	tinted(&m->materials[material], rgb, to->rgb);
	return m->material_count++;
}

void eco_tint_step(uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)((rgb[k] * 7 + 127) / 255 * 255 / 7);
}

static void tints_end(struct tints *t)
{
	free(t->key);
	free(t->table);
	*t = (struct tints){ .model = NULL };
}

/* ---- Colours of textures ---- */

struct variant {                 /* an image with one colour */
	uint32_t source, image;      /* the first variant of a source takes its place */
	uint8_t rgb[3];
};

struct variants {
	struct eco_model *model;
	struct variant *items;
	uint32_t count;
	uint64_t copied_pixels;
	uint32_t replaced;           /* materials that got the nearest colour instead of theirs */
};

/* The variant of `source` nearest in colour, NULL if there is none; and their number. */
static const struct variant *nearest(const struct variants *t, uint32_t source, const uint8_t rgb[3],
	uint32_t *count)
{
	const struct variant *best = NULL;
	*count = 0;
	for (uint32_t i = 0; i < t->count; i++) {
		const struct variant *v = &t->items[i];
		if (v->source != source)
			continue;
		(*count)++;
		if (!best || distance(v->rgb, rgb) < distance(best->rgb, rgb))
			best = v;
	}
	return best;
}

/* Appends a copy of image `source` to the model's; returns its number. */
static uint32_t copy_image(struct variants *t, uint32_t source)
{
	struct eco_model *m = t->model;
	m->images = eco_realloc(m->images, (size_t)m->image_count + 1, sizeof *m->images);
	struct eco_image *from = &m->images[source], *to = &m->images[m->image_count];
	*to = *from;
	size_t pixels = (size_t)to->width * to->height;
	to->rgba = eco_alloc(pixels + 1, 4);
	memcpy(to->rgba, from->rgba, pixels * 4);
	t->copied_pixels += pixels;
	return m->image_count++;
}

/* Gives the material the variant of its image with its colour; texels do not change until all variants are
 * known. */
static void choose_variant(struct variants *t, struct eco_material *material)
{
	const struct eco_image *image = &t->model->images[material->image];
	uint32_t count, source = material->image;
	const struct variant *v = nearest(t, source, material->rgb, &count);
	struct variant made = { .source = source, .image = source };
	if (v && distance(v->rgb, material->rgb) > 0) {
		if (count < TINTS_MAX && t->model->image_count < ECO_MODEL_IMAGES_MAX
			&& t->copied_pixels + (uint64_t)image->width * image->height <= COPIED_PIXELS_MAX) {
			made.image = copy_image(t, source);
			v = NULL;
		} else {
			t->replaced++;
		}
	}
	if (!v) {
		memcpy(made.rgb, material->rgb, 3);
		t->items[t->count] = made;
		v = &t->items[t->count++];
	}
	material->image = v->image;
	memset(material->rgb, 255, 3);
}

static void multiply(struct eco_image *image, const uint8_t rgb[3])
{
	size_t count = (size_t)image->width * image->height;
	uint8_t table[3][256];
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 256; i++)
			table[k][i] = rgb[k] == 255 ? (uint8_t)i
				: eco_srgb_from_linear(eco_linear_from_srgb((uint8_t)i)
				* eco_linear_from_srgb(rgb[k]));
	for (size_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			image->rgba[i * 4 + (size_t)k] = table[k][image->rgba[i * 4 + (size_t)k]];
}

static bool same_pixels(const struct eco_image *a, const struct eco_image *b)
{
	return a->width == b->width && a->height == b->height
		&& memcmp(a->rgba, b->rgba, (size_t)a->width * a->height * 4) == 0;
}

/* An opaque image of one colour, such as a tool leaves in place of one that it took out. */
static bool is_plain(const struct eco_image *image)
{
	size_t bytes = (size_t)image->width * image->height * 4;
	return bytes > 0 && image->rgba[3] == 255 && memcmp(image->rgba, image->rgba + 4, bytes - 4) == 0;
}

/* Keeps the first of equal images, and none of one colour. */
static void merge_equal(struct eco_model *m)
{
	uint32_t as[ECO_MODEL_IMAGES_MAX];
	for (uint32_t k = 0; k < m->material_count; k++) {
		struct eco_material *of = &m->materials[k];
		if (of->image == ECO_NONE || !is_plain(&m->images[of->image]))
			continue;
		memcpy(of->rgb, m->images[of->image].rgba, 3);
		of->image = ECO_NONE;
		of->cutout = false;
	}
	for (uint32_t i = 0; i < m->image_count; i++) {
		as[i] = is_plain(&m->images[i]) ? ECO_NONE : 0;
		while (as[i] < i && (as[as[i]] != as[i] || !same_pixels(&m->images[as[i]], &m->images[i])))
			as[i]++;
	}
	eco_images_keep(m, as);
}

void eco_model_bake_tints(struct eco_model *model, struct eco_notes *notes)
{
	struct variants t = { .model = model, .items = eco_alloc(ECO_MODEL_IMAGES_MAX, sizeof *t.items) };
	for (uint32_t i = 0; i < model->material_count; i++)
		if (model->materials[i].image != ECO_NONE)
			choose_variant(&t, &model->materials[i]);
	for (uint32_t i = 0; i < t.count; i++)
		multiply(&model->images[t.items[i].image], t.items[i].rgb);
	free(t.items);
	if (t.replaced > 0)
		eco_note(notes, "textures are used with more colours than are kept: %u materials are drawn "
			"in the nearest that is", t.replaced);
	merge_equal(model);
}

/* ---- Palettes: pictures whose triangles show one colour each, as models of few triangles have them. They
 * become colours of materials, which no coder of pictures blurs into those beside them ---- */

#define PALETTE_MOST 256u        /* colours of one picture: more are no palette */
#define TEXELS_MOST 4096         /* under a triangle: more are no swatch */
#define SLACK 1e-3               /* of a texel */
#define PLACE_MOST 1e12          /* in texels: beyond, one texel more is no other place */

struct colours { uint8_t seen[PALETTE_MOST][3]; uint32_t count; };

struct palettes {
	struct eco_model *model;
	bool *is_palette;            /* per image */
	uint8_t (*rgb)[3];           /* per triangle, of the texels that it shows */
	struct colours *colours;     /* per image */
};

static uint32_t wrap(double texel, uint32_t size)
{
	double left = fmod(texel, size);
	return (uint32_t)(left < 0 ? left + size : left);
}

/* The texels along axis k of the image under a triangle. */
static void span(const struct eco_model *m, uint32_t t, int k, double size, double *first, double *count)
{
	double low = INFINITY, high = -INFINITY;
	for (int c = 0; c < 3; c++) {
		double at = m->uv[2 * (size_t)m->index[3 * (size_t)t + (size_t)c] + (size_t)k] * size;
		low = fmin(low, at);
		high = fmax(high, at);
	}
	*first = floor(low + SLACK);
	*count = fmax(floor(high - SLACK) - *first, 0) + 1;
}

/* False if the triangle shows several colours, or clear texels. */
static bool one_colour(const struct eco_model *m, uint32_t t, const struct eco_image *image, uint8_t rgb[3])
{
	double x, y, width, height;
	const uint8_t *one = NULL;
	span(m, t, 0, image->width, &x, &width);
	span(m, t, 1, image->height, &y, &height);
	if (!(fabs(x) + fabs(y) <= PLACE_MOST && width * height <= TEXELS_MOST))
		return false;
	for (double v = y; v < y + height; v++)
		for (double u = x; u < x + width; u++) {
			const uint8_t *texel = image->rgba +
				4 * ((size_t)wrap(v, image->height) * image->width + wrap(u, image->width));
			if (texel[3] < 128 || (one && memcmp(one, texel, 3) != 0))
				return false;
			one = texel;
		}
	memcpy(rgb, one, 3);
	return true;
}

static bool see_colour(struct colours *c, const uint8_t rgb[3])
{
	for (uint32_t i = c->count; i-- > 0;)
		if (memcmp(c->seen[i], rgb, 3) == 0)
			return true;
	if (c->count == PALETTE_MOST)
		return false;
	memcpy(c->seen[c->count++], rgb, 3);
	return true;
}

/* As many pictures as there is room for all colours of all their materials. */
static void keep_room(struct palettes *p)
{
	const struct eco_model *m = p->model;
	uint64_t total = 0;
	for (uint32_t i = 0; i < m->image_count; i++) {
		uint64_t users = 0;
		for (uint32_t k = 0; k < m->material_count; k++)
			users += m->materials[k].image == i;
		uint64_t own = users * p->colours[i].count;
		p->is_palette[i] = p->is_palette[i] && total + own <= ECO_TINTS_MAX;
		total += p->is_palette[i] ? own : 0;
	}
}

static void find_palettes(struct palettes *p)
{
	struct eco_model *m = p->model;
	memset(p->is_palette, true, m->image_count);
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		uint32_t image = m->materials[m->material[t]].image;
		if (image != ECO_NONE && p->is_palette[image])
			p->is_palette[image] = one_colour(m, t, &m->images[image], p->rgb[t])
				&& see_colour(&p->colours[image], p->rgb[t]);
	}
	keep_room(p);
}

static void drop_palettes(struct eco_model *m, const bool *is_palette)
{
	uint32_t as[ECO_MODEL_IMAGES_MAX];
	for (uint32_t k = 0; k < m->material_count; k++)
		if (m->materials[k].image != ECO_NONE)
			m->materials[k].cutout &= !is_palette[m->materials[k].image];
	for (uint32_t i = 0; i < m->image_count; i++)
		as[i] = is_palette[i] ? ECO_NONE : i;
	eco_images_keep(m, as);
}

static void paint(struct palettes *p)
{
	struct tints tints;
	struct eco_model *m = p->model;
	tints_start(&tints, m);
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		uint32_t image = m->materials[m->material[t]].image;
		if (image != ECO_NONE && p->is_palette[image])
			m->material[t] = tints_get(&tints, m->material[t], p->rgb[t]);
	}
	tints_end(&tints);
	drop_palettes(m, p->is_palette);
}

void eco_model_take_palettes(struct eco_model *model)
{
	struct palettes p = { .model = model, .is_palette = eco_alloc((size_t)model->image_count + 1, 1),
		.rgb = eco_alloc((size_t)model->triangle_count + 1, sizeof *p.rgb),
		.colours = eco_alloc((size_t)model->image_count + 1, sizeof *p.colours) };
	if (model->uv && model->image_count > 0) {
		find_palettes(&p);
		paint(&p);
	}
	eco_free(p.is_palette, p.rgb, p.colours);
}

/* ---- The soup ---- */

#define NEAR 16.0                /* times the extent: floats then still resolve a millionth of it */
#define COARSE 1e-4              /* share of the extent: a coarser rounding of coordinates is reported */
#define ONE_COLOUR 0.02f         /* vertex colours this near to the first are one */

void eco_bounds_add(struct eco_bounds *b, const double place[3])
{
	for (int k = 0; k < 3 && isfinite(place[0] + place[1] + place[2]); k++) {
		b->low[k] = fmin(b->low[k], place[k]);
		b->high[k] = fmax(b->high[k], place[k]);
	}
}

static double extent_of(const struct eco_bounds *b)
{
	return fmax(fmax(0, b->high[0] - b->low[0]), fmax(b->high[1] - b->low[1], b->high[2] - b->low[2]));
}

void eco_model_reserve(struct eco_model *m, uint64_t vertices, uint64_t triangles)
{
	m->position = eco_alloc(vertices + 1, 3 * sizeof *m->position);
	m->uv = eco_alloc(vertices + 1, 2 * sizeof *m->uv);
	m->index = eco_alloc(triangles + 1, 3 * sizeof *m->index);
	m->material = eco_alloc(triangles + 1, sizeof *m->material);
	m->part = eco_alloc(triangles + 1, sizeof *m->part);
}

void eco_soup_part(struct eco_soup *s, const char *node, size_t node_bytes, const char *mesh,
	size_t mesh_bytes)
{
	struct eco_model *m = s->model;
	bool both = node_bytes && mesh_bytes
		&& (node_bytes != mesh_bytes || memcmp(node, mesh, node_bytes) != 0);
	struct eco_part part = { .name = "" };
	snprintf(part.name, sizeof part.name, "%.*s%s%.*s", (int)node_bytes, node, both ? "/" : "",
		both || !node_bytes ? (int)mesh_bytes : 0, mesh);
	if (!m->part_count || (m->part_count < ECO_MODEL_PARTS_MAX
			&& strcmp(m->parts[m->part_count - 1].name, part.name) != 0)) {
		eco_grow(&m->parts, &s->part_room, m->part_count, sizeof *m->parts);
		m->parts[m->part_count++] = part;
	}
	s->part = m->part_count - 1;
}

void eco_soup_mesh(struct eco_soup *s, uint32_t material, bool colored)
{
	eco_grow(&s->meshes, &s->mesh_room, s->mesh_count, sizeof *s->meshes);
	s->meshes[s->mesh_count++] = (struct eco_soup_mesh){ s->triangle_count, material, colored };
}

uint32_t eco_soup_vertex(struct eco_soup *s, const double place[3], const float uv[2], const float rgb[3])
{
	struct eco_soup_vertex v = { .place = { place[0], place[1], place[2] } };
	if (uv)
		memcpy(v.uv, uv, sizeof v.uv);
	if (rgb)
		memcpy(v.rgb, rgb, sizeof v.rgb);
	eco_grow(&s->vertices, &s->vertex_room, s->vertex_count, sizeof v);
	s->vertices[s->vertex_count] = v;
	return s->vertex_count++;
}

void eco_soup_triangle(struct eco_soup *s, uint32_t a, uint32_t b, uint32_t c)
{
	eco_grow(&s->triangles, &s->triangle_room, s->triangle_count, sizeof *s->triangles);
	s->triangles[s->triangle_count++] = (struct eco_soup_triangle){ { a, b, c }, s->part };
}

/* ---- Polygons ---- */

double *eco_soup_corners(struct eco_soup *s)
{
	if (!s->corners) {
		s->corners = eco_alloc(ECO_POLYGON_CORNERS_MAX, 3 * sizeof *s->corners);
		s->split = eco_alloc(ECO_POLYGON_CORNERS_MAX, 4 * sizeof *s->split);
	}
	return s->corners;
}

const uint32_t *eco_soup_split(struct eco_soup *s, uint32_t n)
{
	uint32_t *triangles = s->split + n;
	bool sound = n > 3;
	for (uint32_t i = 0; i < 3 * n && sound; i++)
		sound = isfinite(s->corners[i]);
	if (sound)
		eco_polygon_split(s->corners, n, s->split, triangles);
	for (uint32_t i = 0; i + 2 < n && !sound; i++) {
		triangles[i * 3] = 0;
		triangles[i * 3 + 1] = i + 1;
		triangles[i * 3 + 2] = i + 2;
	}
	return triangles;
}

/* ---- The end ---- */

/* The base to subtract: 0 unless coordinates are far from the origin for their extent. Whole numbers. */
static void set_positions(struct eco_soup *s)
{
	struct eco_bounds b = ECO_NO_BOUNDS;
	struct eco_model *m = s->model;
	double far = 0, *base = s->frame->base;
	for (uint32_t i = 0; i < s->vertex_count; i++)
		eco_bounds_add(&b, s->vertices[i].place);
	for (int k = 0; k < 3 && b.low[0] <= b.high[0]; k++)
		far = fmax(far, fmax(b.high[k], -b.low[k]));
	for (int k = 0; k < 3; k++) {
		double middle = (b.low[k] + b.high[k]) / 2;
		bool moves = far > NEAR * extent_of(&b) && middle > -1e15 && middle < 1e15;
		base[k] = moves ? (double)(int64_t)middle : 0;
	}
	for (uint32_t i = 0; i < s->vertex_count; i++) {
		for (int k = 0; k < 3; k++)
			m->position[(size_t)i * 3 + (size_t)k] = (float)(s->vertices[i].place[k] - base[k]);
		memcpy(&m->uv[(size_t)i * 2], s->vertices[i].uv, 2 * sizeof *m->uv);
	}
	m->vertex_count = s->vertex_count;
	if (isfinite(s->far) && s->far * 0x1p-24 > extent_of(&b) * COARSE)
		eco_note(s->notes,
			"its coordinates are up to %g from the origin, in single precision, and so only "
			"exact to %.2g of their unit: export it with a local origin",
			s->far, s->far * 0x1p-24);
}

struct colors { float first[3]; double sum[3]; uint64_t count; bool differ; };

static void add_corners(struct colors *c, const struct eco_soup *s, uint32_t triangle)
{
	const uint32_t *v = s->triangles[triangle].v;
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3 && v[i] != ECO_NONE; k++) {
			float value = s->vertices[v[i]].rgb[k];
			value = isfinite(value) ? value : 1;
			c->first[k] = c->count ? c->first[k] : value;
			c->differ |= fabsf(value - c->first[k]) > ONE_COLOUR;
			c->sum[k] += (double)value;
		}
		c->count += v[i] != ECO_NONE;
	}
}

static void mean_of(const struct eco_soup *s, const struct colors *c, uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++) {
		double mean = c->sum[k] / (double)c->count;
		rgb[k] = s->linear ? eco_srgb_from_linear(mean) : eco_byte_from_share(mean);
	}
}

/* The material of a whole mesh, times the mean of its colours; ECO_NONE: they differ, and triangles have
 * materials of their own. With a picture, colours that differ are averaged, and counted: every further colour
 * would need another image, and would cut leaves and branches into pieces. */
static uint32_t material_of(struct eco_soup *s, struct tints *tints, uint32_t mesh, uint32_t end,
	uint32_t *averaged)
{
	const struct eco_soup_mesh *of = &s->meshes[mesh];
	struct colors c = { .count = 0 };
	uint8_t rgb[3];
	for (uint32_t t = of->triangle; t < end && of->colored; t++)
		add_corners(&c, s, t);
	if (c.count == 0)
		return of->material;
	if (c.differ && s->model->materials[of->material].image == ECO_NONE)
		return ECO_NONE;
	*averaged += c.differ;
	mean_of(s, &c, rgb);
	return tints_get(tints, of->material, rgb);
}

static uint32_t triangle_material(struct eco_soup *s, struct tints *tints, uint32_t material,
	uint32_t triangle)
{
	struct colors c = { .count = 0 };
	uint8_t rgb[3];
	add_corners(&c, s, triangle);
	if (c.count < 3)
		return material;
	mean_of(s, &c, rgb);
	eco_tint_step(rgb);
	return tints_get(tints, material, rgb);
}

/* Triangles of invisible materials are dropped. */
static void set_triangles(struct eco_soup *s, struct tints *tints, const char *fields)
{
	struct eco_model *m = s->model;
	uint32_t kept = 0, averaged = 0;
	for (uint32_t i = 0; i < s->mesh_count; i++) {
		const struct eco_soup_mesh *mesh = &s->meshes[i];
		uint32_t end = i + 1 < s->mesh_count ? mesh[1].triangle : s->triangle_count;
		if (s->invisible[mesh->material])
			continue;
		uint32_t whole = material_of(s, tints, i, end, &averaged);
		for (uint32_t t = mesh->triangle; t < end; t++, kept++) {
			m->material[kept] = whole != ECO_NONE ? whole
				: triangle_material(s, tints, mesh->material, t);
			memcpy(&m->index[(size_t)kept * 3], s->triangles[t].v, 3 * sizeof *m->index);
			m->part[kept] = s->triangles[t].part;
		}
	}
	const uint32_t hidden = s->triangle_count - kept;
	m->triangles_in = s->triangle_count;
	m->triangle_count = kept;
	m->dropped[ECO_DROP_TRANSPARENT] = hidden;
	if (hidden > 0)
		eco_note(s->notes, "%u triangles have materials with alpha below 0.5 (%s): they are left out",
			hidden,
			fields);
	if (averaged > 0)
		eco_note(s->notes,
			"%u textured meshes have vertex colours that differ: each is drawn in their "
			"mean", averaged);
}

void eco_soup_end(struct eco_soup *s, const char *fields)
{
	struct tints tints;
	tints_start(&tints, s->model);
	eco_model_reserve(s->model, s->vertex_count, s->triangle_count);
	if (!s->model->parts)
		s->model->parts = eco_alloc(1, sizeof *s->model->parts);
	set_positions(s);
	set_triangles(s, &tints, fields);
	tints_end(&tints);
}

void eco_soup_free(struct eco_soup *s)
{
	eco_free(s->vertices, s->triangles, s->meshes, s->corners, s->split);
}
