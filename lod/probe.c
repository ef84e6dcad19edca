/* A plant seen from all around. See probe.h. */
#include "lod/probe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DISTANCE_RADII 16.0
#define FRAME 1.04                   /* half the picture over the bounding sphere's silhouette */

struct lod_drawing {                 /* one cut, as triangles, lines or points; offsets into `floats` */
	uint8_t kind;
	uint32_t count;
	size_t position, uv, width;
	const struct eco_image *cutout;
	float area;
};

/* ---- Set-up ---- */

/* Centre of the bounding box, and the greatest distance of a vertex from it. */
static void bounds(struct lod_probe *probe, const struct eco_model *model)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, far2 = 0;
	for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
		const float *p = model->position + 3 * (size_t)model->index[i];
		for (int k = 0; k < 3; k++) {
			low[k] = p[k] < low[k] ? p[k] : low[k];
			high[k] = p[k] > high[k] ? p[k] : high[k];
		}
	}
	for (int k = 0; k < 3; k++)
		probe->center[k] = low[k] <= high[k] ? (low[k] + high[k]) / 2 : 0;
	for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
		const float *p = model->position + 3 * (size_t)model->index[i];
		double d[3] = { p[0] - probe->center[0], p[1] - probe->center[1], p[2] - probe->center[2] };
		double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
		far2 = d2 > far2 ? d2 : far2;
	}
	probe->radius = far2 > 0 ? sqrt(far2) : 1;
}

/* Heights from -0.2 to 0.95 of the unit sphere, each view a golden angle on from the last: a rotation, so no libm. */
static void place_eyes(struct lod_probe *probe)
{
	const double turn_x = -0.7373688780783197, turn_y = 0.6754902942615238;
	double away = DISTANCE_RADII * probe->radius, x = 1, y = 0;
	double half = FRAME * probe->radius / sqrt(away * away - probe->radius * probe->radius);
	probe->near_m = away - 4 * probe->radius;
	for (uint32_t i = 0; i < probe->views; i++) {
		struct lod_eye *eye = &probe->eyes[i];
		double z = -0.2 + 1.15 * (i + 0.5) / probe->views, flat = sqrt(1 - z * z), from[3] = { flat * x, flat * y, z };
		memset(eye, 0, sizeof *eye);
		for (int k = 0; k < 3; k++) {
			eye->at[k] = probe->center[k] + away * from[k];
			eye->forward[k] = -from[k];
		}
		eye->right[0] = -y, eye->right[1] = x;
		eye->up[0] = -z * x, eye->up[1] = -z * y, eye->up[2] = flat;
		eye->tan_x = eye->tan_y = half;
		eye->pixel_rad = 2 * half / probe->raster.height;
		double next = x * turn_x - y * turn_y;
		y = x * turn_y + y * turn_x;
		x = next;
	}
}

static bool has_holes(const struct eco_image *image)
{
	size_t pixels = (size_t)image->width * image->height;
	for (size_t i = 0; i < pixels; i++)
		if (image->rgba[4 * i + 3] < 128)
			return true;
	return false;
}

static bool allocate(struct lod_probe *probe)
{
	const struct lod_plant *plant = probe->plant;
	size_t pixels = (size_t)probe->raster.width * probe->raster.height;
	probe->eyes = calloc(probe->views, sizeof *probe->eyes);
	probe->reference = calloc(probe->views, pixels);
	probe->reference_pixels = calloc(probe->views, sizeof *probe->reference_pixels);
	probe->lists = calloc(plant->list_count + 1, sizeof *probe->lists);
	probe->cut = calloc(plant->image_count + 1, sizeof *probe->cut);
	return probe->eyes && probe->reference && probe->reference_pixels && probe->lists && probe->cut;
}

enum eco_code lod_probe_init(struct lod_probe *probe, const struct lod_plant *plant, const struct eco_model *model,
	const struct lod_probe_options *options, struct eco_error *error)
{
	memset(probe, 0, sizeof *probe);
	probe->plant = plant;
	probe->model = model;
	probe->views = options->views;
	enum eco_code code = lod_raster_init(&probe->raster,
		&(struct lod_raster_options){ .width = options->pixels, .height = options->pixels, .silhouette = true }, error);
	if (code)
		return code;
	if (!allocate(probe)) {
		lod_probe_free(probe);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u views of %u x %u pixels", options->views, options->pixels,
			options->pixels);
	}
	for (uint32_t i = 0; i < plant->list_count; i++)
		probe->lists[i] = plant->lists[i].list;
	for (uint32_t i = 0; i < plant->image_count; i++)
		probe->cut[i] = has_holes(&model->images[plant->images[i]]);
	probe->scene = (struct eco_scene){ .lists = probe->lists, .list_count = plant->list_count, .ladders = plant->ladders,
		.ladder_count = plant->ladder_count, .curves = plant->curves, .curve_count = plant->curve_count };
	bounds(probe, model);
	place_eyes(probe);
	return ECO_OK;
}

void lod_probe_free(struct lod_probe *probe)
{
	lod_raster_free(&probe->raster);
	free(probe->eyes);
	free(probe->reference);
	free(probe->reference_pixels);
	free(probe->lists);
	free(probe->cut);
	free(probe->drawings);
	free(probe->floats);
	memset(probe, 0, sizeof *probe);
}

/* ---- What to draw ---- */

void lod_probe_clear(struct lod_probe *probe)
{
	probe->drawing_count = 0;
	probe->float_count = 0;
}

static bool reserve(struct lod_probe *probe, size_t floats)
{
	if (probe->drawing_count == probe->drawing_capacity) {
		uint32_t capacity = probe->drawing_capacity ? 2 * probe->drawing_capacity : 64;
		struct lod_drawing *drawings = realloc(probe->drawings, capacity * sizeof *drawings);
		if (!drawings)
			return false;
		probe->drawings = drawings;
		probe->drawing_capacity = capacity;
	}
	if (probe->float_count + floats > probe->float_capacity) {
		size_t capacity = (probe->float_count + floats) / 2 * 3 + 4096;
		float *grown = realloc(probe->floats, capacity * sizeof *grown);
		if (!grown)
			return false;
		probe->floats = grown;
		probe->float_capacity = capacity;
	}
	return true;
}

enum eco_code lod_probe_add(struct lod_probe *probe, const struct eco_cut *cut, struct eco_error *error)
{
	const struct lod_list_draft *draft = &probe->plant->lists[cut->list];
	const struct eco_list *list = &draft->list;
	size_t count = cut->end - cut->first, corners = eco_list_vertices(list);
	bool holes = list->image != ECO_NONE && (list->attributes & ECO_ATTR_UV) && probe->cut[list->image];
	size_t positions = 3 * corners * count, uvs = holes ? 2 * corners * count : 0, widths = corners == 2 ? count : 0;
	if (!count)
		return ECO_OK;
	if (!reserve(probe, positions + uvs + widths))
		return eco_fail(error, ECO_NO_MEMORY, "no memory to measure %zu primitives", count);
	struct lod_drawing *drawing = &probe->drawings[probe->drawing_count++];
	*drawing = (struct lod_drawing){ .kind = list->kind, .position = probe->float_count, .uv = probe->float_count + positions,
		.width = probe->float_count + positions + uvs, .area = list->unit_area * cut->scale,
		.cutout = holes ? &probe->model->images[probe->plant->images[list->image]] : NULL };
	struct lod_geometry geometry = { probe->floats + drawing->position, holes ? probe->floats + drawing->uv : NULL,
		widths ? probe->floats + drawing->width : NULL, NULL };
	drawing->count = lod_list_geometry(list, &draft->elements, cut->first, cut->end, cut->scale, &geometry);
	probe->float_count += positions + uvs + widths;
	return ECO_OK;
}

/* ---- Drawing ---- */

static void draw_all(struct lod_probe *probe)
{
	for (uint32_t i = 0; i < probe->drawing_count; i++) {
		const struct lod_drawing *drawing = &probe->drawings[i];
		struct lod_raster_batch batch = { .count = drawing->count, .position = probe->floats + drawing->position,
			.uv = drawing->cutout ? probe->floats + drawing->uv : NULL, .cutout = drawing->cutout,
			.width = probe->floats + drawing->width, .area = drawing->area, .owner = 1 };
		if (drawing->kind == ECO_LIST_TRIANGLES)
			lod_raster_triangles(&probe->raster, &batch);
		else if (drawing->kind == ECO_LIST_LINES)
			lod_raster_lines(&probe->raster, &batch);
		else
			lod_raster_points(&probe->raster, &batch);
	}
}

#define SOUP 512u

static void flush(struct lod_probe *probe, const struct eco_material *material, uint32_t count, const float *position,
	const float *uv)
{
	const struct eco_image *image = material->cutout && material->image != ECO_NONE ? &probe->model->images[material->image] : NULL;
	struct lod_raster_batch batch = { .count = count, .position = position, .uv = uv, .cutout = uv ? image : NULL, .owner = 1 };
	lod_raster_triangles(&probe->raster, &batch);
}

static void draw_model(struct lod_probe *probe)
{
	const struct eco_model *model = probe->model;
	float position[SOUP * 9], uv[SOUP * 6];
	uint32_t count = 0;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		for (uint32_t i = 0; i < 3; i++) {
			uint32_t vertex = model->index[3 * (size_t)t + i];
			memcpy(position + 9 * count + 3 * i, model->position + 3 * (size_t)vertex, 3 * sizeof(float));
			if (model->uv)
				memcpy(uv + 6 * count + 2 * i, model->uv + 2 * (size_t)vertex, 2 * sizeof(float));
		}
		count++;
		bool last = t + 1 == model->triangle_count || model->material[t + 1] != model->material[t];
		if (count == SOUP || last) {
			flush(probe, &model->materials[model->material[t]], count, position, model->uv ? uv : NULL);
			count = 0;
		}
	}
}

static void start_view(struct lod_probe *probe, uint32_t view)
{
	lod_raster_clear(&probe->raster);
	lod_raster_camera(&probe->raster, &probe->eyes[view], probe->near_m);
	lod_raster_object(&probe->raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
}

static bool keep(struct lod_probe *probe, void (*draw)(struct lod_probe *probe))
{
	size_t pixels = (size_t)probe->raster.width * probe->raster.height;
	bool any = false;
	for (uint32_t view = 0; view < probe->views; view++) {
		uint64_t covered = 0;
		start_view(probe, view);
		draw(probe);
		memcpy(probe->reference + view * pixels, probe->raster.cover, pixels);
		for (size_t i = 0; i < pixels; i++)
			covered += probe->raster.cover[i] & 1;
		probe->reference_pixels[view] = covered;
		any |= covered != 0;
	}
	return any;
}

bool lod_probe_keep(struct lod_probe *probe)
{
	return keep(probe, draw_all);
}

bool lod_probe_keep_model(struct lod_probe *probe)
{
	return keep(probe, draw_model);
}

void lod_probe_compare(struct lod_probe *probe, uint32_t stride, struct lod_probe_result *result)
{
	size_t pixels = (size_t)probe->raster.width * probe->raster.height;
	uint32_t used = 0;
	*result = (struct lod_probe_result){ 0 };
	for (uint32_t view = 0; view < probe->views; view += stride) {
		if (!probe->reference_pixels[view])
			continue;
		start_view(probe, view);
		draw_all(probe);
		struct lod_score score;
		lod_score(&score, &(struct lod_score_input){ .width = probe->raster.width, .height = probe->raster.height,
			.cover = probe->raster.cover, .reference = probe->reference + view * pixels });
		double covered = (double)probe->reference_pixels[view], loss = 1 - score.q;
		result->loss += loss;
		result->worst = loss > result->worst ? loss : result->worst;
		result->fp += (double)score.fp / covered;
		result->fn += (double)score.fn / covered;
		used++;
	}
	if (used) {
		result->loss /= used;
		result->fp /= used;
		result->fn /= used;
	}
}
