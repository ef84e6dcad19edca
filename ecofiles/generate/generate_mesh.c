/* Random numbers, vectors and meshes for parametric plants. Coordinates are written as multiples of 0.1
 * mm, so that a square root or a sine that differs in its last bit changes nothing. */
#include "ecofiles/format/image.h"
#include "ecofiles/generate/generate_plants.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/base/angle16.h"

/* ---- Random numbers ---- */

uint64_t gen_random_bits(struct gen_random *random)
{
	return eco_random_next(&random->state);
}

double gen_random_unit(struct gen_random *random)
{
	return eco_random_unit(gen_random_bits(random));
}

double gen_random_in(struct gen_random *random, double low, double high)
{
	return low + (high - low) * gen_random_unit(random);
}

uint32_t gen_random_shade(struct gen_random *random, double light, double spread, uint32_t shades)
{
	return (uint32_t)gen_clamp((light + gen_random_in(random, -spread, spread)) * shades, 0, shades - 1);
}

/* ---- Vectors ---- */

struct gen_v3 gen_v3(double x, double y, double z) { return (struct gen_v3){ x, y, z }; }
struct gen_v3 gen_add(struct gen_v3 a, struct gen_v3 b) { return gen_v3(a.x + b.x, a.y + b.y, a.z + b.z); }
struct gen_v3 gen_sub(struct gen_v3 a, struct gen_v3 b) { return gen_v3(a.x - b.x, a.y - b.y, a.z - b.z); }
struct gen_v3 gen_mul(struct gen_v3 a, double s) { return gen_v3(a.x * s, a.y * s, a.z * s); }
struct gen_v3 gen_mad(struct gen_v3 a, struct gen_v3 b, double s) { return gen_add(a, gen_mul(b, s)); }
static double dot(struct gen_v3 a, struct gen_v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double gen_length(struct gen_v3 a) { return sqrt(dot(a, a)); }

struct gen_v3 gen_cross(struct gen_v3 a, struct gen_v3 b)
{
	return gen_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

struct gen_v3 gen_unit(struct gen_v3 a)
{
	double length = gen_length(a);
	return length > 1e-12 ? gen_mul(a, 1 / length) : gen_v3(0, 0, 1);
}

struct gen_v3 gen_across(struct gen_v3 a)
{
	return gen_unit(gen_cross(a, fabs(a.z) < 0.9 ? gen_v3(0, 0, 1) : gen_v3(1, 0, 0)));
}

struct gen_v3 gen_along(const struct gen_v3 *path, uint32_t count, double at, struct gen_v3 *way)
{
	uint32_t k = at < count - 1 ? (uint32_t)at : count - 2;
	struct gen_v3 step = gen_sub(path[k + 1], path[k]);
	*way = gen_unit(step);
	return gen_mad(path[k], step, at - k);
}

struct gen_v3 gen_turned(struct gen_v3 v, struct gen_v3 axis, double degrees)
{
	double s, c;
	eco_angle16_sincos(eco_angle16_from_deg(degrees), &s, &c);
	return gen_add(gen_add(gen_mul(v, c), gen_mul(gen_cross(axis, v), s)),
		gen_mul(axis, dot(axis, v) * (1 - c)));
}

struct gen_v3 gen_heading(double azimuth_deg, double elevation_deg)
{
	double sa, ca, se, ce;
	eco_angle16_sincos(eco_angle16_from_deg(azimuth_deg), &sa, &ca);
	eco_angle16_sincos(eco_angle16_from_deg(elevation_deg), &se, &ce);
	return gen_v3(ca * ce, sa * ce, se);
}

struct gen_v3 gen_random_way(struct gen_random *random)
{
	double z = gen_random_in(random, -1, 1), r = sqrt(1 - z * z), s, c;
	eco_angle16_sincos((uint16_t)gen_random_bits(random), &s, &c);
	return gen_v3(r * c, r * s, z);
}

double gen_clamp(double v, double low, double high) { return v < low ? low : v > high ? high : v; }

double gen_smooth(double from, double to, double v)
{
	double t = gen_clamp((v - from) / (to - from), 0, 1);
	return t * t * (3 - 2 * t);
}

/* ---- Meshes ---- */

void gen_mesh_free(struct gen_mesh *mesh)
{
	free(mesh->position);
	free(mesh->uv);
	free(mesh->faces);
	*mesh = (struct gen_mesh){ 0 };
}

uint8_t gen_material(struct gen_mesh *mesh, const char *name, uint32_t rgb, const char *texture)
{
	assert(mesh->material_count < GEN_MATERIALS_MAX);
	struct gen_material *m = &mesh->materials[mesh->material_count];
	snprintf(m->name, sizeof m->name, "%s", name);
	for (int k = 0; k < 3; k++)
		m->rgb[k] = (uint8_t)(rgb >> (16 - 8 * k));
	m->texture = texture;
	return (uint8_t)mesh->material_count++;
}

uint32_t gen_mixed(uint32_t a, uint32_t b, uint32_t part, uint32_t of)
{
	uint32_t rgb = 0;
	for (int bit = 16; bit >= 0; bit -= 8)
		rgb |= ((a >> bit & 255) * (of - part) + (b >> bit & 255) * part + of / 2) / of << bit;
	return rgb;
}

uint8_t gen_material_shades(struct gen_mesh *mesh, const char *name, uint32_t dark, uint32_t bright,
	uint32_t count)
{
	uint8_t first = (uint8_t)mesh->material_count;
	for (uint32_t i = 0; i < count; i++) {
		char shade[40];
		snprintf(shade, sizeof shade, "%.24s-%u", name, i);
		gen_material(mesh, shade, gen_mixed(dark, bright, i, count - 1), NULL);
	}
	return first;
}

static uint32_t add_vertex(struct gen_mesh *mesh, struct gen_v3 at, double u, double v)
{
	if (mesh->count == mesh->capacity) {
		mesh->capacity = mesh->capacity ? 2 * mesh->capacity : 1024;
		mesh->position = eco_realloc(mesh->position, mesh->capacity, sizeof *mesh->position);
		mesh->uv = eco_realloc(mesh->uv, mesh->capacity, sizeof *mesh->uv);
	}
	mesh->position[mesh->count] = at;
	mesh->uv[mesh->count][0] = (float)u;
	mesh->uv[mesh->count][1] = (float)v;
	return mesh->count++;
}

static void add_face(struct gen_mesh *mesh, uint8_t material, uint32_t corners, const uint32_t corner[])
{
	assert(corners == 3 || corners == 4);
	eco_grow(&mesh->faces, &mesh->face_capacity, mesh->face_count, sizeof *mesh->faces);
	struct gen_face *face = &mesh->faces[mesh->face_count++];
	*face = (struct gen_face){ .corners = (uint8_t)corners, .material = material };
	memcpy(face->corner, corner, corners * sizeof *corner);
}

uint32_t gen_vertex(struct gen_mesh *mesh, struct gen_v3 at) { return add_vertex(mesh, at, 0, 0); }

void gen_triangle(struct gen_mesh *mesh, uint8_t material, const uint32_t corner[3]) { add_face(mesh, material, 3, corner); }

/* Rings are carried along without twist: the first direction of each is that of the ring before, made
 * square to the path. */
void gen_tube(struct gen_mesh *mesh, uint8_t material, const struct gen_tube *tube)
{
	uint32_t n = tube->count, sides = tube->sides, before = 0;
	assert(n >= 2 && sides >= 3 && sides <= 32);
	struct gen_v3 side = gen_across(gen_sub(tube->points[1], tube->points[0]));
	double along_m = 0;
	for (uint32_t i = 0; i < n; i++) {
		struct gen_v3 ahead = gen_sub(tube->points[i + 1 < n ? i + 1 : i],
			tube->points[i ? i - 1 : 0]);
		struct gen_v3 way = gen_unit(ahead);
		side = gen_unit(gen_mad(side, way, -dot(side, way)));
		struct gen_v3 up = gen_cross(way, side);
		if (i)
			along_m += gen_length(gen_sub(tube->points[i], tube->points[i - 1]));
		bool tip = i + 1 == n && tube->radius[i] <= 0;
		uint32_t first = mesh->count;
		for (uint32_t k = 0; k < (tip ? 1 : sides); k++) {
			double s, c;
			eco_angle16_sincos((uint16_t)(65536u * k / sides), &s, &c);
			struct gen_v3 out = gen_add(gen_mul(side, c), gen_mul(up, s));
			add_vertex(mesh, gen_mad(tube->points[i], out, tube->radius[i]), (double)k / sides,
				along_m);
		}
		for (uint32_t k = 0; i && k < sides; k++) {
			uint32_t next = (k + 1) % sides;
			if (tip)
				add_face(mesh, material, 3, (uint32_t[]){ before + k, before + next, first });
			else
				add_face(mesh, material, 4,
					(uint32_t[]){ before + k, before + next, first + next, first + k });
		}
		before = first;
	}
}

/* ---- Leaves ---- */

#define EDGE (1.0 / 256)         /* in texture units: margin of a card, so that neighbours do not bleed in */

static void leaf_flat(struct gen_mesh *mesh, uint8_t material, const struct gen_leaf *leaf,
	struct gen_v3 side)
{
	bool card = leaf->shape == GEN_LEAF_CARD;
	struct gen_v3 half = gen_mul(side, leaf->width / 2), along = gen_mul(leaf->along, leaf->length);
	uint32_t corner[4];
	if (card) {
		double u0 = 0.5 * (leaf->cell % 2) + EDGE, v0 = 0.5 * (leaf->cell / 2) + EDGE,
			u1 = u0 + 0.5 - 2 * EDGE, v1 = v0 + 0.5 - 2 * EDGE;
		corner[0] = add_vertex(mesh, gen_sub(leaf->at, half), u0, v0);
		corner[1] = add_vertex(mesh, gen_add(leaf->at, half), u1, v0);
		corner[2] = add_vertex(mesh, gen_add(gen_add(leaf->at, along), half), u1, v1);
		corner[3] = add_vertex(mesh, gen_sub(gen_add(leaf->at, along), half), u0, v1);
	} else {
		struct gen_v3 middle = gen_mad(leaf->at, along, 0.45);
		corner[0] = add_vertex(mesh, leaf->at, 0.5, 0);
		corner[1] = add_vertex(mesh, gen_add(middle, half), 1, 0.45);
		corner[2] = add_vertex(mesh, gen_add(leaf->at, along), 0.5, 1);
		corner[3] = add_vertex(mesh, gen_sub(middle, half), 0, 0.45);
	}
	add_face(mesh, material, 4, corner);
}

/* Six corners, four triangles around the stalk: a leaf arching to its tip. */
static void leaf_hexagon(struct gen_mesh *mesh, uint8_t material, const struct gen_leaf *leaf,
	struct gen_v3 side)
{
	struct gen_v3 half = gen_mul(side, leaf->width / 2), along = gen_mul(leaf->along, leaf->length);
	struct gen_v3 sink = gen_mul(leaf->face, -leaf->bend * leaf->length);
	struct gen_v3 low = gen_mad(gen_mad(leaf->at, along, 0.3), sink, 0.1);
	struct gen_v3 high = gen_mad(gen_mad(leaf->at, along, 0.68), sink, 0.45);
	struct gen_v3 at[6] = { leaf->at, gen_mad(low, half, 0.95), gen_mad(high, half, 0.8),
		gen_add(gen_add(leaf->at, along), sink), gen_mad(high, half, -0.8),
		gen_mad(low, half, -0.95) };
	uint32_t corner[6];
	for (int i = 0; i < 6; i++)
		corner[i] = add_vertex(mesh, at[i], 0, 0);
	for (uint32_t i = 1; i < 5; i++)
		add_face(mesh, material, 3, (uint32_t[]){ corner[0], corner[i], corner[i + 1] });
}

/* Five corners: a strip that narrows to a point, as a fan of three triangles around one corner. */
static void leaf_blade(struct gen_mesh *mesh, uint8_t material, const struct gen_leaf *leaf,
	struct gen_v3 side)
{
	struct gen_v3 half = gen_mul(side, leaf->width / 2), along = gen_mul(leaf->along, leaf->length);
	struct gen_v3 sink = gen_mul(leaf->face, -leaf->bend * leaf->length);
	struct gen_v3 middle = gen_mad(gen_mad(leaf->at, along, 0.55), sink, 0.3);
	uint32_t corner[5] = {
		add_vertex(mesh, gen_mad(leaf->at, half, -1), 0, 0),
			add_vertex(mesh, gen_add(leaf->at, half), 1, 0),
		add_vertex(mesh, gen_mad(middle, half, 0.8), 1, 0.5),
		add_vertex(mesh, gen_mad(middle, half, -0.8), 0, 0.5),
		add_vertex(mesh, gen_add(gen_add(leaf->at, along), sink), 0.5, 1) };
	add_face(mesh, material, 3, (uint32_t[]){ corner[3], corner[0], corner[1] });
	add_face(mesh, material, 3, (uint32_t[]){ corner[3], corner[1], corner[2] });
	add_face(mesh, material, 3, (uint32_t[]){ corner[3], corner[2], corner[4] });
}

void gen_leaf(struct gen_mesh *mesh, uint8_t material, const struct gen_leaf *leaf)
{
	struct gen_leaf l = *leaf;
	l.along = gen_unit(l.along);
	l.face = gen_mad(l.face, l.along, -dot(l.face, l.along));
	l.face = gen_length(l.face) > 1e-6 ? gen_unit(l.face) : gen_across(l.along);
	struct gen_v3 side = gen_cross(l.along, l.face);
	if (l.shape == GEN_LEAF_HEXAGON)
		leaf_hexagon(mesh, material, &l, side);
	else if (l.shape == GEN_LEAF_BLADE)
		leaf_blade(mesh, material, &l, side);
	else
		leaf_flat(mesh, material, &l, side);
}

/* ---- Files ---- */

/* Never "-0.0000": the sign of a zero may differ between machines where the number does not. */
static double tidy(double v)
{
	double rounded = floor(v * 10000 + 0.5) / 10000;
	return rounded == 0 ? 0 : rounded;
}

static bool has_texture(const struct gen_mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->material_count; i++)
		if (mesh->materials[i].texture)
			return true;
	return false;
}

static void print_obj(const struct gen_mesh *mesh, const char *name, FILE *out)
{
	bool uv = has_texture(mesh);
	fprintf(out, "# %s: %u vertices, %u faces, metres, Y up\nmtllib %s.mtl\no %s\n", name, mesh->count,
		mesh->face_count, name, name);
	for (uint32_t i = 0; i < mesh->count; i++) {
		const struct gen_v3 *p = &mesh->position[i];
		fprintf(out, "v %.4f %.4f %.4f\n", tidy(p->x), tidy(p->z), tidy(-p->y));
	}
	for (uint32_t i = 0; uv && i < mesh->count; i++)
		fprintf(out, "vt %.4f %.4f\n", tidy(mesh->uv[i][0]), tidy(mesh->uv[i][1]));
	for (uint32_t m = 0; m < mesh->material_count; m++) {
		bool named = false;
		for (uint32_t f = 0; f < mesh->face_count; f++) {
			const struct gen_face *face = &mesh->faces[f];
			if (face->material != m)
				continue;
			if (!named)
				fprintf(out, "usemtl %s\n", mesh->materials[m].name);
			named = true;
			fputs("f", out);
			for (uint32_t c = 0; c < face->corners; c++)
				fprintf(out, uv ? " %u/%u" : " %u", face->corner[c] + 1, face->corner[c] + 1);
			fputs("\n", out);
		}
	}
}

static void print_mtl(const struct gen_mesh *mesh, FILE *out)
{
	for (uint32_t m = 0; m < mesh->material_count; m++) {
		const struct gen_material *material = &mesh->materials[m];
		fprintf(out, "newmtl %s\nKd %.4f %.4f %.4f\nKs 0 0 0\nillum 1\n", material->name,
			material->rgb[0] / 255.0, material->rgb[1] / 255.0, material->rgb[2] / 255.0);
		if (material->texture)
			fprintf(out, "map_Kd %s\nmap_d %s\n", material->texture, material->texture);
		fputs("\n", out);
	}
}

void gen_mesh_write(const struct gen_mesh *mesh, const char *folder, const char *name, struct eco_error *error)
{
	for (int part = 0; part < 2; part++) {
		char path[4096], *text = NULL;
		size_t size = 0;
		if (snprintf(path, sizeof path, "%s/%s.%s", folder, name, part ? "obj" : "mtl") >= (int)sizeof path)
			eco_stop(ECO_BAD_INPUT, "%s: path too long", folder);
		FILE *out = open_memstream(&text, &size);
		if (!out)
			eco_end("no memory");
		part ? print_obj(mesh, name, out) : print_mtl(mesh, out);
		if (fclose(out))
			eco_end("no memory");
		eco_check(eco_file_write(path, text, size, error));
		free(text);
	}
}
