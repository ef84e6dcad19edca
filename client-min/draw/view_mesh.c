#include "client-min/draw/view_mesh.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "client-min/draw/view_light.h"
#include "client-min/view_record.h"
#include "lod/leaf.h"
#include "lod/light.h"
#include "lod/raster/texel.h"
#include "lod/scattered.h"
#include "lod/tint.h"

/* ---- Geometry ---- */

static float length_of(const float v[3]) { return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

float view_mesh_reach(const struct view_mesh *mesh, uint32_t i)
{
	const struct lod_geometry *g = &mesh->geometry;
	if (g->width)
		return g->width[i];
	if (g->half)
		return fmaxf(length_of(g->half + 9 * (size_t)i), fmaxf(length_of(g->half + 9 * (size_t)i + 3),
			length_of(g->half + 9 * (size_t)i + 6)));
	return sqrtf(mesh->batch.area * 0.3183f * (g->size ? g->size[i] : 1));
}

static void bound_sphere(struct view_mesh *mesh, uint32_t vertices)
{
	float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	const float *p = mesh->geometry.position;
	for (uint32_t i = 0; i < vertices; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fminf(low[k], p[3 * (size_t)i + k]);
			high[k] = fmaxf(high[k], p[3 * (size_t)i + k]);
		}
	double square = 0;
	for (int k = 0; k < 3; k++) {
		mesh->center[k] = 0.5f * (low[k] + high[k]);
		square += 0.25 * ((double)high[k] - low[k]) * ((double)high[k] - low[k]);
	}
	mesh->radius = (float)(sqrt(square) * 1.0001);
	float largest = 0;
	for (uint32_t i = 0; mesh->list->list.kind != ECO_LIST_TRIANGLES && i < mesh->batch.count; i++)
		largest = fmaxf(largest, view_mesh_reach(mesh, i));
	mesh->radius += largest;
}

enum eco_code view_mesh_make(struct view_mesh *mesh, const struct view_store *store,
	const struct eco_cut *cut, const struct view_plant *plant, struct eco_error *error)
{
	const struct view_list *list = mesh->list = view_store_list(store, cut->list);
	uint32_t points = cut->end - cut->first, count = points << cut->halvings;
	const struct view_list *image = list->list.image == ECO_NONE ? NULL
		: view_store_list(store, list->list.image);
	if (list->list.kind == ECO_LIST_IMPOSTOR) {
		mesh->impostor = &list->impostors[cut->first];
		mesh->batch.count = mesh->impostor->cell_count;
		memcpy(mesh->center, mesh->impostor->body.center, sizeof mesh->center);
		mesh->radius = mesh->impostor->radius;
		return ECO_OK;
	}
	if (image && image->image.rgba && list->list.attributes & ECO_ATTR_UV)
		mesh->image = image;
	if (!lod_geometry_make(&mesh->geometry, &list->list, count, mesh->image))
		return eco_no_memory(error, "the geometry of a picture");
	uint32_t written = lod_list_geometry(&list->list, &list->elements, cut->first, cut->end, cut->scale,
		&mesh->geometry);
	assert(written == points);
	bool cutout = mesh->image && image->cutout;
	mesh->batch = (struct lod_raster_batch){ .count = count, .cutout = cutout ? &image->image : NULL,
		.area = ldexpf(list->list.unit_area * cut->scale, -cut->halvings) };
	mesh->halvings = cut->halvings;
	lod_scatter(&mesh->geometry, points, cut->first, cut->halvings,
		lod_ball_radius(&list->list, cut->scale));
	mesh->by_point = list->list.kind == ECO_LIST_POINTS && list->list.attributes & ECO_ATTR_PLANT;
	mesh->half_width = plant ? view_shape_of(plant).half_width : 0;
	bound_sphere(mesh, count * eco_list_vertices(&list->list));
	return ECO_OK;
}

void view_mesh_add_leaves(struct view_mesh *mesh, const struct eco_plant *plant)
{
	if (mesh->list->list.kind != ECO_LIST_POINTS && !mesh->impostor)
		return;
	mesh->batch.leaf = (float)(plant->leaf_width * ECO_LEAF_UNIT_M);
	/* the colour of a point is that of its leaf already */
	mesh->tone = mesh->geometry.half || mesh->impostor ? (float)plant->leaf_tone / ECO_TONE_ONE : 0;
	mesh->radius *= 1 + 0.5f * LOD_LEAF_RAGGED;
}

void view_mesh_free(struct view_mesh *mesh)
{
	lod_geometry_free(&mesh->geometry);
	*mesh = (struct view_mesh){ .list = NULL };
}

/* ---- Looks ---- */

#define STEPS_MAX 6                      /* samples along each side of a pixel */

/* A pixel's side in the texture: at least a texel long. Returns its length in texels. */
static double side_of(const struct eco_image *image, const double from[2], const double to[2], int axis,
	double side[2])
{
	double size[2] = { image->width, image->height }, texels = 0;
	for (int k = 0; k < 2; k++) {
		side[k] = to[k] - from[k];
		texels += side[k] * size[k] * side[k] * size[k];
	}
	texels = sqrt(texels);
	if (texels >= 1)
		return texels;
	side[axis] = 1 / size[axis];
	side[1 - axis] = 0;
	return 1;
}

/* The mean light (1/65535) of the opaque texels under a pixel, which in software takes the place of
 * filtering: uv at the pixel's centre, and one pixel to the right and one down. A pixel within a texel mixes
 * it with its neighbours. If nothing is opaque, it is the texel at the centre. */
static void texture_mean(const struct eco_image *image, const double uv[3][2], double light[3])
{
	struct lod_light sum = { .weight = 0 };
	double side[2][2];
	int steps[2];
	for (int a = 0; a < 2; a++) {
		double texels = side_of(image, uv[0], uv[1 + a], a, side[a]);
		steps[a] = texels < STEPS_MAX - 1 ? 1 + (int)ceil(texels) : STEPS_MAX;
	}
	for (int i = 0; i < steps[0]; i++)
		for (int j = 0; j < steps[1]; j++) {
			double a = (i + 0.5) / steps[0] - 0.5, b = (j + 0.5) / steps[1] - 0.5;
			const uint8_t *texel = lod_texel_at(image, uv[0][0] + a * side[0][0] + b * side[1][0],
				uv[0][1] + a * side[0][1] + b * side[1][1]);
			if (texel[3] >= 128)
				lod_light_add(&sum, texel, 1);
		}
	if (!(sum.weight > 0))
		lod_light_add(&sum, lod_texel_at(image, uv[0][0], uv[0][1]), 1);
	for (int k = 0; k < 3; k++)
		light[k] = sum.sum[k] / sum.weight;
}

/* uv where a ray meets the triangle's plane, but not beyond the triangle: pixels at its edges reach out. */
static void find_uv(const float *p, const float *uv, const double eye[3], const double ray[3], double out[2])
{
	double side[2][3], from[3], q[3], r[3];
	for (int k = 0; k < 3; k++) {
		side[0][k] = (double)p[3 + k] - p[k];
		side[1][k] = (double)p[6 + k] - p[k];
		from[k] = eye[k] - p[k];
	}
	lod_cross(ray, side[1], q);              /* Möller and Trumbore 1997 */
	lod_cross(from, side[0], r);
	double whole = lod_dot(side[0], q), b = lod_dot(from, q) / whole, c = lod_dot(ray, r) / whole;
	b = b > 0 ? b < 1 ? b : 1 : 0;
	c = c > 0 ? c < 1 - b ? c : 1 - b : 0;
	for (int k = 0; k < 2; k++)
		out[k] = (1 - b - c) * uv[k] + b * uv[2 + k] + c * uv[4 + k];
}

static void look_textured(const struct view_mesh *mesh, uint32_t triangle, const struct view_rays *rays,
	uint8_t rgb[3])
{
	const float *p = mesh->geometry.position + 9 * (size_t)triangle;
	double uv[3][2], light[3];
	for (int i = 0; i < 3; i++)
		find_uv(p, mesh->geometry.uv + 6 * (size_t)triangle, rays->eye, rays->ray[i], uv[i]);
	texture_mean(&mesh->image->image, uv, light);
	for (int k = 0; k < 3; k++)
		rgb[k] = lod_light_byte(light[k] * lod_light_of[rgb[k]] / 65535);
}

static uint32_t facet_of(const float *p)
{
	const double a[3] = { p[3] - p[0], p[4] - p[1], p[5] - p[2] }, b[3] = { p[6] - p[0], p[7] - p[1],
		p[8] - p[2] };
	double n[3];
	lod_cross(a, b, n);
	double length = sqrt(lod_dot(n, n)), part = length > 0 ? 1 / length : 0;
	const float normal[3] = { (float)(n[0] * part), (float)(n[1] * part), (float)(n[2] * part) };
	return view_surface_direction(VIEW_FACET, normal);
}

static uint32_t axis_of(const float *p)
{
	return view_surface_direction(VIEW_AXIS, (const float[3]){ p[3] - p[0], p[4] - p[1], p[5] - p[2] });
}

/* The radius of a point or a splat over half the width of its plant. */
static double reach_of(const struct view_mesh *mesh, uint32_t primitive)
{
	if (!(mesh->half_width > 0))
		return 1;
	if (!mesh->geometry.half)
		return (double)(view_mesh_reach(mesh, primitive) / mesh->half_width);
	const float *h = mesh->geometry.half + 9 * (size_t)primitive;
	float cube = h[0] * (h[4] * h[8] - h[5] * h[7]) + h[1] * (h[5] * h[6] - h[3] * h[8])
		+ h[2] * (h[3] * h[7] - h[4] * h[6]);
	return cbrt(fabs((double)cube)) / (double)mesh->half_width;
}

static uint32_t cloud_of(const struct view_mesh *mesh, uint32_t point)
{
	return view_surface_cloud(reach_of(mesh, point), eco_level_share(mesh->list->list.level));
}

/* The normal where the ray meets the ellipsoid, or passes it most closely: pixels at its rim reach out. In
 * the space where it is a ball of radius 1, eye and ray are measured along its half axes. */
static void ball_of(const struct view_mesh *mesh, uint32_t splat, const struct view_rays *rays, float out[3])
{
	const float *center = mesh->geometry.position + 3 * (size_t)splat;
	double from[3], ray[3], square[3], normal[3] = { 0 };
	for (int k = 0; k < 3; k++) {
		const float *half = mesh->geometry.half + 9 * (size_t)splat + 3 * k;
		from[k] = ray[k] = square[k] = 0;
		for (int i = 0; i < 3; i++) {
			from[k] += (rays->eye[i] - center[i]) * half[i];
			ray[k] += rays->ray[0][i] * half[i];
			square[k] += (double)half[i] * half[i];
		}
		from[k] /= square[k];
		ray[k] /= square[k];
	}
	double along = lod_dot(from, ray), length = lod_dot(ray, ray),
		rest = along * along - length * (lod_dot(from, from) - 1),
		t = -(along + (rest > 0 ? sqrt(rest) : 0)) / length;
	for (int k = 0; k < 9; k++)
		normal[k % 3] += (double)mesh->geometry.half[9 * (size_t)splat + (size_t)k] / square[k / 3]
			* (from[k / 3] + t * ray[k / 3]);
	length = sqrt(lod_dot(normal, normal));
	for (int k = 0; k < 3; k++)
		out[k] = (float)(normal[k] / length);
}

static bool is_wood(const struct view_mesh *mesh, uint32_t splat)
{
	return mesh->geometry.wood && mesh->geometry.wood[splat] > 0;
}

static uint32_t smooth_of(const struct view_mesh *mesh, uint32_t primitive, const struct view_rays *rays)
{
	float normal[3];
	if (mesh->impostor)
		return view_impostor_surface(&mesh->list->list);
	if (!mesh->geometry.half)
		return cloud_of(mesh, primitive);
	ball_of(mesh, primitive, rays, normal);
	return view_surface_ball(reach_of(mesh, primitive),
		is_wood(mesh, primitive) ? 0 : eco_level_share(mesh->list->list.level), normal);
}

/* A leaf on a splat or a point, in place of the mean of leaves. */
static uint32_t leaf_of(const struct view_mesh *mesh, uint32_t primitive, const struct view_rays *rays,
	uint32_t leaf, uint8_t rgb[3])
{
	const float *center = mesh->impostor ? mesh->center : mesh->geometry.position + 3 * (size_t)primitive;
	uint32_t look = leaf_look(leaf), side = leaf_side(look);
	float normal[3], tone = sqrtf(leaf_tone(leaf, look, mesh->tone));  /* of bytes, nearly */
	double to_eye[3] = { rays->eye[0] - center[0], rays->eye[1] - center[1], rays->eye[2] - center[2] }, turn[3];
	double far = sqrt(lod_dot(to_eye, to_eye));
	for (uint32_t k = 0; k < 3; k++) {
		rgb[k] = (uint8_t)fminf(tone * rgb[k] + 0.5f, 255);
		turn[k] = (double)leaf_turn(side, k);
	}
	uint32_t smooth = smooth_of(mesh, primitive, rays);
	if (!leaf_is_lit(leaf, look) || mesh->by_point)
		return smooth;
	float level = leaf_level(mesh->geometry.half ? (float)eco_level_share(mesh->list->list.level)
		: (float)(smooth >> 16 & 255) / 255, (float)(to_eye[2] / far));
	double length = sqrt(lod_dot(turn, turn)),
		reach = mesh->geometry.half ? reach_of(mesh, primitive) : (smooth & 65535) / 65535.0;
	if (leaf_is_level(look, level))
		return view_surface_leaf(reach, (const float[3]){ 0, 0, 1 });
	bool surface = mesh->geometry.half && leaf_is_surface(look);
	if (surface)
		ball_of(mesh, primitive, rays, normal);
	for (int k = 0; k < 3; k++)      /* at a splat's rim rounding would say which side is seen */
		normal[k] = surface ? normal[k] + 0.05f * (float)(to_eye[k] / far)
			: (float)(turn[k] / length + to_eye[k] / far);
	return view_surface_leaf(reach, normal);
}

static void color_of(const struct view_mesh *mesh, uint32_t primitive, uint8_t rgb[3])
{
	static const uint8_t plain[3] = { 95, 127, 79 }, white[3] = { 255, 255, 255 };
	const struct eco_list *list = &mesh->list->list;
	int32_t color = mesh->impostor ? 0 : mesh->geometry.color[primitive];
	bool listed = color >= 0 && (uint32_t)color < list->palette_count;
	memcpy(rgb, mesh->impostor ? mesh->impostor->rgb[primitive] : listed ? mesh->list->palette[color]
		: list->image != ECO_NONE ? white : plain, 3);
}

void view_mesh_look(const struct view_mesh *mesh, uint32_t primitive, const struct view_rays *rays,
	uint32_t leaf, uint8_t rgb[3], uint32_t *surface)
{
	color_of(mesh, primitive, rgb);
	if (mesh->impostor) {
		*surface = mesh->batch.leaf > 0 ? leaf_of(mesh, primitive, rays, leaf, rgb)
			: smooth_of(mesh, primitive, rays);
		return;
	}
	const struct eco_list *list = &mesh->list->list;
	if (mesh->image)
		look_textured(mesh, primitive, rays, rgb);
	if (list->kind == ECO_LIST_TRIANGLES)
		*surface = facet_of(mesh->geometry.position + 9 * (size_t)primitive);
	else if (list->kind == ECO_LIST_LINES)
		*surface = axis_of(mesh->geometry.position + 6 * (size_t)primitive);
	else if (mesh->batch.leaf > 0 && !is_wood(mesh, primitive))
		*surface = leaf_of(mesh, primitive, rays, leaf, rgb);
	else
		*surface = smooth_of(mesh, primitive, rays);
}

void view_mesh_tint(const struct view_mesh *mesh, uint32_t primitive, uint32_t tint, uint8_t rgb[3])
{
	struct lod_tint_wood wood = view_list_wood(mesh->list);
	uint8_t from[3];
	color_of(mesh, primitive, from);
	if (tint & LOD_TINT_WHOLE || !(eco_list_is_wood(&mesh->list->list) || is_wood(mesh, primitive)))
		lod_tint_apply(tint, tint & LOD_TINT_WHOLE ? NULL : &wood, from, rgb);
}
