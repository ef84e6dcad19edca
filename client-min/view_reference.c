/* What costs is triangles, and most of a forest is hidden behind the rest of it. So plants are taken in order
 * of distance, dealt to the threads in turn, and each thread asks its own coarse depth before it touches a
 * plant, and again before it touches a cell. Geometry is made once per cut and shared by all plants that draw
 * it. */
#include "client-min/view_reference.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_shade.h"
#include "client-min/view_table.h"
#include "lod/geometry.h"
#include "lod/light.h"
#include "lod/raster/raster.h"
#include "lod/raster/texel.h"

#define THREADS_MAX 64u
#define HAZE_M 3000.0
#define HIDE_TRIANGLES 24u               /* fewer are drawn sooner than asked about */

struct mesh {                            /* geometry of one cut */
	struct lod_raster_batch batch;
	struct lod_geometry geometry;
	uint8_t *rgb;
	uint8_t kind;
	float center[3], radius;         /* object space */
	bool by_point;                   /* a summary: each point has its own owner */
};

struct scene {
	const struct view_reference_job *job;
	const struct eco_plan *plan;
	struct mesh *meshes;             /* per cut */
	uint32_t *order;                 /* instances, near to far */
	uint8_t ground_rgb[ECO_GROUND_CELLS * ECO_GROUND_CELLS * 2][3];
};

struct worker {
	const struct scene *scene;
	struct lod_raster raster;
	uint32_t number, count;
	float ground[ECO_GROUND_CELLS * ECO_GROUND_CELLS * 18];      /* one tile's triangles */
	pthread_t thread;
	bool started;
};

/* ---- Geometry ---- */

static enum eco_code no_memory(struct eco_error *error)
{
	return eco_fail(error, ECO_NO_MEMORY, "no memory for the reference's geometry");
}

static void bound_sphere(struct mesh *mesh, uint32_t vertices)
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
	float largest = mesh->geometry.size ? 0 : 1;
	for (uint32_t i = 0; mesh->geometry.size && i < mesh->batch.count; i++)
		largest = fmaxf(largest, mesh->geometry.size[i]);
	if (mesh->kind == ECO_LIST_POINTS)
		mesh->radius += sqrtf(mesh->batch.area * largest);
	for (uint32_t i = 0; mesh->kind == ECO_LIST_LINES && i < mesh->batch.count; i++)
		mesh->radius = fmaxf(mesh->radius, (float)(sqrt(square) * 1.0001) + mesh->geometry.width[i]);
}

/* a side of the lattice of texels that a triangle's colour is the mean of */
#define TEXEL_STEPS 5

static void add_texel(struct lod_light *light, const struct eco_image *image, double u, double v)
{
	const uint8_t *texel = lod_texel_at(image, u, v);
	if (texel[3] >= 128)
		lod_light_add(light, texel, 1);
}

/* Mean light of a triangle's opaque texels; `rgb` stays where there is none. */
static void texture_color(const struct eco_image *image, const float *uv, uint8_t rgb[3])
{
	struct lod_light light = { .weight = 0 };
	for (int i = 0; i < TEXEL_STEPS; i++)
		for (int j = 0; i + j < TEXEL_STEPS; j++) {
			double a = (i + 1.0 / 3) / TEXEL_STEPS, b = (j + 1.0 / 3) / TEXEL_STEPS,
				c = 1 - a - b;
			add_texel(&light, image, a * uv[0] + b * uv[2] + c * uv[4],
				a * uv[1] + b * uv[3] + c * uv[5]);
		}
	lod_light_mean(&light, rgb);
}

static void color_mesh(struct mesh *mesh, const struct view_list *list, const struct view_list *image)
{
	static const uint8_t plain[3] = { 95, 127, 79 };
	struct lod_light all = { .weight = 0 };
	uint8_t mean[3] = { 255, 255, 255 };
	size_t texels = mesh->geometry.uv ? (size_t)image->image.width * image->image.height : 0;
	for (size_t i = 0; i < texels; i++)
		if (image->image.rgba[4 * i + 3] >= 128)
			lod_light_add(&all, image->image.rgba + 4 * i, 1);
	lod_light_mean(&all, mean);
	for (uint32_t i = 0; i < mesh->batch.count; i++) {
		int32_t c = mesh->geometry.color[i];
		const uint8_t *rgb = c >= 0 && (uint32_t)c < list->list.palette_count ? list->palette[c]
			: image ? mean : plain;
		memcpy(mesh->rgb + 3 * (size_t)i, rgb, 3);
		if (mesh->geometry.uv)
			texture_color(&image->image, mesh->geometry.uv + 6 * (size_t)i,
				mesh->rgb + 3 * (size_t)i);
	}
}

static enum eco_code make_mesh(struct mesh *mesh, const struct view_reference_job *job,
	const struct eco_cut *cut, struct eco_error *error)
{
	const struct view_list *list = view_store_list(job->store, cut->list);
	uint32_t count = cut->end - cut->first, corners = eco_list_vertices(&list->list);
	const struct view_list *image = list->list.image == ECO_NONE ? NULL
		: view_store_list(job->store, list->list.image);
	bool textured = image && image->image.rgba && list->list.attributes & ECO_ATTR_UV, cutout = textured
		&& image->cutout;
	mesh->kind = list->list.kind;
	mesh->geometry.position = malloc(12u * (size_t)count * corners + 1);
	mesh->geometry.uv = textured ? malloc(24u * (size_t)count + 1) : NULL;
	mesh->geometry.width = mesh->kind == ECO_LIST_LINES ? malloc(4u * (size_t)count + 1) : NULL;
	mesh->geometry.color = malloc(4u * (size_t)count + 1);
	bool sized = list->list.attributes & ECO_ATTR_SIZE;
	mesh->geometry.size = sized ? malloc(4u * (size_t)count + 1) : NULL;
	mesh->rgb = malloc(3u * (size_t)count + 1);
	if (!mesh->geometry.position || !mesh->geometry.color || !mesh->rgb
			|| (textured && !mesh->geometry.uv) || (sized && !mesh->geometry.size) ||
		(mesh->kind == ECO_LIST_LINES && !mesh->geometry.width))
		return no_memory(error);
	uint32_t written = lod_list_geometry(&list->list, &list->elements, cut->first, cut->end, cut->scale,
		&mesh->geometry);
	assert(written == count);
	mesh->batch = (struct lod_raster_batch){ .count = count, .position = mesh->geometry.position,
		.uv = cutout ? mesh->geometry.uv : NULL,
		.cutout = cutout ? &image->image : NULL, .width = mesh->geometry.width,
		.area = list->list.unit_area * cut->scale,
		.size = mesh->geometry.size, .rgb = mesh->rgb };
	mesh->by_point = mesh->kind == ECO_LIST_POINTS && list->list.attributes & ECO_ATTR_PLANT;
	color_mesh(mesh, list, image);
	bound_sphere(mesh, count * corners);
	return ECO_OK;
}

/* ---- Drawing ---- */

static bool stopped(const struct view_reference_job *job)
{
	return job->stop && *job->stop;
}

/* Two triangles a cell, their diagonal from south-west to north-east; in single floats, as OpenGL has them.
 */
static uint32_t tile_triangles(const struct view_ground *ground, const struct view_ground_tile *tile,
	float *out)
{
	static const uint32_t corner[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };
	for (uint32_t y = 0; y + 1 < tile->y.inner; y++)
		for (uint32_t x = 0; x + 1 < tile->x.inner; x++)
			for (int c = 0; c < 6; c++) {
				const int32_t *at = tile->list->elements.position
					+ 3 * (size_t)view_ground_sample(tile, x + corner[c][0],
					y + corner[c][1]);
				for (int k = 0; k < 3; k++)
					*out++ = (float)(at[k] - ground->anchor[k]) * ground->step[k];
			}
	return 2 * (tile->x.inner - 1) * (tile->y.inner - 1);
}

static void draw_ground(struct worker *w)
{
	const struct view_ground *ground = &w->scene->job->selection->ground;
	struct lod_place place = { .cosine = 1, .scale = 1 };
	memcpy(place.at, ground->at, sizeof place.at);
	lod_raster_object(&w->raster, &place);
	for (uint32_t i = 0; i < ground->count && !stopped(w->scene->job); i++) {
		struct lod_raster_batch batch = { .position = w->ground, .rgb = w->scene->ground_rgb[0] };
		batch.count = tile_triangles(ground, &ground->tiles[i], w->ground);
		lod_raster_triangles(&w->raster, &batch);
	}
}

/* Summary points name their plants one by one. */
static void draw_summary(struct worker *w, const struct mesh *mesh, const struct eco_cut *cut, uint32_t path)
{
	const struct view_list *list = view_store_list(w->scene->job->store, cut->list);
	struct lod_raster_batch batch = mesh->batch;
	for (uint32_t i = 0; i < mesh->batch.count;) {
		uint64_t owner = view_summary_owner(list, cut->first + i, path);
		uint32_t end = i + 1;
		while (end < mesh->batch.count && view_summary_owner(list, cut->first + end, path) == owner)
			end++;
		batch.owner = owner;
		batch.count = end - i;
		batch.position = mesh->batch.position + 3 * (size_t)i;
		batch.rgb = mesh->batch.rgb + 3 * (size_t)i;
		batch.size = mesh->batch.size ? mesh->batch.size + i : NULL;
		lod_raster_points(&w->raster, &batch);
		i = end;
	}
}

static void draw_mesh(struct worker *w, const struct view_instance *instance, uint32_t cut)
{
	const struct mesh *mesh = &w->scene->meshes[cut];
	if (mesh->by_point) {
		draw_summary(w, mesh, &w->scene->plan->cuts[cut], instance->path);
		return;
	}
	if (mesh->batch.count >= HIDE_TRIANGLES) {
		double center[3];
		lod_place_point(&instance->place, mesh->center, center);
		if (lod_raster_hides(&w->raster, center, mesh->radius * instance->place.scale))
			return;
	}
	struct lod_raster_batch batch = mesh->batch;
	batch.owner = instance->owner;
	if (mesh->kind == ECO_LIST_TRIANGLES)
		lod_raster_triangles(&w->raster, &batch);
	else if (mesh->kind == ECO_LIST_LINES)
		lod_raster_lines(&w->raster, &batch);
	else
		lod_raster_points(&w->raster, &batch);
}

static void *work(void *ctx)
{
	struct worker *w = ctx;
	const struct scene *scene = w->scene;
	const struct view_selection *s = scene->job->selection;
	lod_raster_camera(&w->raster, scene->job->eye, scene->job->near_m);
	draw_ground(w);
	for (uint32_t n = w->number; n < s->instance_count && !stopped(scene->job); n += w->count) {
		uint32_t i = scene->order[n];
		lod_raster_object(&w->raster, &s->instances[i].place);
		for (uint32_t p = s->cut_first[i]; p < s->cut_first[i + 1]; p++)
			draw_mesh(w, &s->instances[i], s->cuts[p]);
	}
	return NULL;
}

static int by_distance(const void *a, const void *b, void *ctx)
{
	const struct view_instance *instances = ctx;
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	double dx = instances[x].distance_m, dy = instances[y].distance_m;
	return dx < dy ? -1 : dx > dy ? 1 : x < y ? -1 : x > y;
}

static enum eco_code prepare(struct scene *scene, struct eco_error *error)
{
	const struct view_selection *s = scene->job->selection;
	scene->meshes = calloc((size_t)s->cut_count + 1, sizeof *scene->meshes);
	scene->order = malloc(((size_t)s->instance_count + 1) * sizeof *scene->order);
	if (!scene->meshes || !scene->order)
		return no_memory(error);
	for (uint32_t i = 0; i < s->instance_count; i++)
		scene->order[i] = i;
	qsort_r(scene->order, s->instance_count, sizeof *scene->order, by_distance, s->instances);
	for (size_t i = 0; i < sizeof scene->ground_rgb / sizeof *scene->ground_rgb; i++)
		memcpy(scene->ground_rgb[i], (const uint8_t[3]){ 112, 108, 72 }, 3);
	enum eco_code code = ECO_OK;
	for (uint32_t c = 0; c < s->cut_count && !code; c++)
		if (s->member_first[c] != s->member_first[c + 1])
			code = make_mesh(&scene->meshes[c], scene->job, &scene->plan->cuts[c], error);
	return code;
}

static void scene_free(struct scene *scene)
{
	for (uint32_t c = 0; scene->meshes && c < scene->job->selection->cut_count; c++) {
		struct mesh *m = &scene->meshes[c];
		free(m->geometry.position);
		free(m->geometry.uv);
		free(m->geometry.width);
		free(m->geometry.color);
		free(m->geometry.size);
		free(m->rgb);
	}
	free(scene->meshes);
	free(scene->order);
}

/* Flat colours made legible: each plant a little lighter or darker than the next, haze with distance, sky
 * where nothing is. */
static void tell_apart(const struct lod_raster *raster, struct view_picture *picture, float haze_m)
{
	static const float air[3] = { 186, 204, 222 };
	size_t pixels = (size_t)picture->width * picture->height;
	for (size_t i = 0; i < pixels; i++) {
		float clear = raster->depth[i] > 0 ? expf(-1 / (haze_m * raster->depth[i])) : 0;
		uint32_t hash = (uint32_t)(picture->owner[i] * 0x9E3779B97F4A7C15u >> 56);
		float tone = clear * (picture->owner[i] ? 0.8f + 0.35f * (float)hash / 255 : 1);
		for (int k = 0; k < 3; k++)
			picture->rgb[3 * i + (size_t)k] = (uint8_t)fminf(255,
				raster->rgb[3 * i + (size_t)k] * tone + air[k] * (1 - clear));
	}
}

static enum eco_code run(struct worker *workers, uint32_t count, struct view_picture *picture,
	struct eco_error *error)
{
	struct lod_raster_options options = { .width = picture->width, .height = picture->height,
		.owner = true, .rgb = true };
	for (uint32_t i = 0; i < count; i++) {
		enum eco_code code = lod_raster_init(&workers[i].raster, &options, error);
		if (code)
			return code;
	}
	for (uint32_t i = 1; i < count; i++)
		workers[i].started = pthread_create(&workers[i].thread, NULL, work, &workers[i]) == 0;
	work(&workers[0]);
	for (uint32_t i = 1; i < count; i++) {
		if (workers[i].started)
			pthread_join(workers[i].thread, NULL);
		else
			work(&workers[i]);
		lod_raster_merge(&workers[0].raster, &workers[i].raster);
	}
	size_t pixels = (size_t)picture->width * picture->height;
	memcpy(picture->cover, workers[0].raster.cover, pixels);
	memcpy(picture->owner, workers[0].raster.owner, pixels * sizeof *picture->owner);
	tell_apart(&workers[0].raster, picture,
		(float)view_shade_haze_m(HAZE_M, workers[0].scene->job->eye->at[2]));
	return ECO_OK;
}

enum eco_code view_reference_draw(const struct view_reference_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	static const struct eco_plan nothing;
	struct scene scene = { .job = job, .plan = view_store_plan(job->store) };
	uint32_t count = job->threads ? job->threads < THREADS_MAX ? job->threads : THREADS_MAX : 2;
	struct worker *workers = calloc(count, sizeof *workers);
	double start = view_clock_ms();
	if (!workers)
		return no_memory(error);
	if (!scene.plan)
		scene.plan = &nothing;
	for (uint32_t i = 0; i < count; i++) {
		workers[i].scene = &scene;
		workers[i].number = i;
		workers[i].count = count;
	}
	enum eco_code code = prepare(&scene, error);
	if (!code)
		code = run(workers, count, picture, error);
	if (!code && stopped(job))
		code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	for (uint32_t i = 0; i < count; i++)
		lod_raster_free(&workers[i].raster);
	free(workers);
	scene_free(&scene);
	picture->vertices = job->selection->vertices;
	picture->draw_ms = view_clock_ms() - start;
	return code;
}
