/* Triangles take most of the time, and most of a forest is hidden behind the rest of it. So plants are taken
 * in order of distance, dealt to the threads in turn, and each thread asks its own coarse depth before it
 * touches a plant, and again before it touches a cell. Geometry is made once per cut and shared by all plants
 * that draw it. The rasteriser notes which primitive is nearest; colours and surfaces are looked up once a
 * pixel, when all is drawn, and then lit.
 *
 * Items number the ground's triangles first, TILE_TRIANGLES a tile, then the primitives of all cuts. */
#include "client-min/view_reference.h"

#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_mesh.h"
#include "client-min/draw/view_picture.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "lod/light.h"

#define HIDE_TRIANGLES 24u               /* fewer are drawn sooner than asked about */
#define TILE_TRIANGLES (2 * ECO_GROUND_CELLS * ECO_GROUND_CELLS)
#define COUNTED_MAX (1u << 22)           /* samples in one raster of a picture that is drawn in parts, ... */
#define LIT_MAX (1u << 20)               /* ... and where they are lit */

struct scene {
	const struct view_draw_job *job;
	const struct eco_plan *plan;
	struct view_mesh *meshes;        /* per cut */
	uint32_t *items;                 /* per cut: number of its first item; and the end */
	uint32_t *order;                 /* instances, near to far */
	struct view_table owners;
};

/* A picture of samples x samples a pixel is drawn in parts of whole pixels, that fit one raster. */
struct parts { uint32_t width, height, samples, part[2]; };      /* in pixels */

struct worker {
	const struct scene *scene;
	const struct lod_eye *eye;
	struct lod_raster raster;
	uint32_t count;                  /* of workers */
	struct view_picture *picture;    /* that is looked up */
	const struct lod_raster *drawn;
	struct parts parts;              /* of a picture of many samples a pixel, ... */
	struct view_coverage *coverage;  /* that is counted, ... */
	const struct view_lamp *lamp;    /* ... or lit */
	struct view_picture *whole;
	float ground[9 * TILE_TRIANGLES];        /* one tile's */
};

/* ---- Drawing ---- */

static bool stopped(const struct view_draw_job *job)
{
	return job->stop && *job->stop;
}

static void draw_ground(struct worker *w)
{
	const struct view_ground *ground = &w->scene->job->selection->ground;
	struct lod_place place = { .cosine = 1, .scale = 1 };
	memcpy(place.at, ground->at, sizeof place.at);
	lod_raster_object(&w->raster, &place);
	for (uint32_t i = 0; i < ground->count && !stopped(w->scene->job); i++) {
		struct lod_raster_batch batch = { .position = w->ground, .item = i * TILE_TRIANGLES };
		batch.count = view_ground_triangles(ground, &ground->tiles[i], w->ground);
		lod_raster_triangles(&w->raster, &batch);
	}
}

/* Summary points name their plants one by one. */
static void draw_summary(struct worker *w, const struct view_mesh *mesh, struct lod_raster_batch batch,
	uint32_t first, uint32_t path)
{
	const struct view_list *list = mesh->list;
	uint32_t item = batch.item;
	for (uint32_t i = 0; i < mesh->batch.count;) {
		uint32_t end = i + (1u << mesh->halvings);
		batch.owner = view_summary_owner(list, first + (i >> mesh->halvings), path);
		while (end < mesh->batch.count && view_summary_owner(list, first
				+ (end >> mesh->halvings), path) == batch.owner)
			end += 1u << mesh->halvings;
		struct lod_geometry from = lod_geometry_from(&mesh->geometry, &list->list, i);
		batch.count = end - i;
		batch.item = item + i;
		lod_raster_list(&w->raster, &list->list, &from, &batch);
		i = end;
	}
}

static void draw_mesh(struct worker *w, const struct view_instance *instance, uint32_t cut)
{
	const struct view_mesh *mesh = &w->scene->meshes[cut];
	struct lod_raster_batch batch = mesh->batch;
	batch.owner = instance->owner;
	batch.item = w->scene->items[cut];
	if (mesh->by_point) {
		draw_summary(w, mesh, batch, w->scene->plan->cuts[cut].first, instance->path);
		return;
	}
	if (mesh->batch.count >= HIDE_TRIANGLES) {
		double center[3];
		lod_place_point(&instance->place, mesh->center, center);
		if (lod_raster_hides(&w->raster, center, mesh->radius * lod_place_most(&instance->place)))
			return;
	}
	if (mesh->impostor)
		lod_raster_impostor(&w->raster, mesh->impostor, &batch);
	else
		lod_raster_list(&w->raster, &mesh->list->list, &mesh->geometry, &batch);
}

/* The ground, and every count-th instance from `first` on. */
static void draw_instances(struct worker *w, uint32_t first, uint32_t count)
{
	const struct scene *scene = w->scene;
	const struct view_selection *s = scene->job->selection;
	lod_raster_camera(&w->raster, w->eye, scene->job->near_m);
	draw_ground(w);
	for (uint32_t n = first; n < s->instance_count && !stopped(scene->job); n += count) {
		uint32_t i = scene->order[n];
		lod_raster_object(&w->raster, &s->instances[i].place);
		for (uint32_t p = s->cut_first[i]; p < s->cut_first[i + 1]; p++)
			draw_mesh(w, &s->instances[i], s->cuts[p]);
	}
}

static void draw_share(void *workers, uint32_t number)
{
	struct worker *w = (struct worker *)workers + number;
	draw_instances(w, number, w->count);
}

/* ---- Looking up ---- */

static void into_plant(const struct lod_place *place, const double v[3], double out[3])
{
	out[0] = (v[0] * place->cosine + v[1] * place->sine) / lod_place_width(place);
	out[1] = (v[1] * place->cosine - v[0] * place->sine) / lod_place_width(place);
	out[2] = v[2];
}

static void rays_of(const struct worker *w, uint32_t x, uint32_t y, const struct lod_place *place,
	struct view_rays *rays)
{
	const struct lod_eye *eye = w->eye;
	double ray[3], from[3];
	for (int k = 0; k < 3; k++)
		from[k] = (eye->at[k] - place->at[k]) / place->scale;
	into_plant(place, from, rays->eye);
	for (int i = 0; i < 3; i++) {
		view_picture_ray(w->picture, eye, x + (i == 1), y + (i == 2), ray);
		into_plant(place, ray, rays->ray[i]);
	}
}

struct facet { float corner[3][3], normal[3][3]; uint32_t item; bool made; };    /* of the ground */

static void find_facet(const struct view_ground *ground, uint32_t item, struct facet *f)
{
	const struct view_ground_tile *tile = &ground->tiles[item / TILE_TRIANGLES];
	uint32_t triangle = item % TILE_TRIANGLES, columns = tile->x.inner - 1;
	f->item = item;
	f->made = true;
	for (uint32_t c = 0; c < 3; c++) {
		const uint32_t *at = view_ground_corners[3 * (triangle & 1) + c];
		uint32_t sample = view_ground_sample(tile, triangle / 2 % columns + at[0],
			triangle / 2 / columns + at[1]);
		view_ground_place(ground, tile, sample, f->corner[c]);
		view_ground_normal(tile->list, sample, f->normal[c]);
	}
}

/* The samples' normals, mixed by where the pixel lies between them as seen from above. `f` is that of the
 * pixel before. */
static uint32_t look_ground(const struct worker *w, uint32_t x, uint32_t y, uint32_t item, struct facet *f)
{
	const struct view_ground *ground = &w->scene->job->selection->ground;
	const struct view_picture *picture = w->picture;
	double ray[3], p[2], share[3], sum = 0, depth = picture->depth[(size_t)y * picture->width + x];
	float mixed[3] = { 0, 0, 0 };
	if (!f->made || f->item != item)
		find_facet(ground, item, f);
	view_picture_ray(picture, w->eye, x, y, ray);
	for (int k = 0; k < 2; k++)
		p[k] = w->eye->at[k] - ground->at[k] + ray[k] / depth;
	for (int c = 0; c < 3; c++) {
		const float *a = f->corner[(c + 1) % 3], *b = f->corner[(c + 2) % 3];
		double at = ((double)b[0] - a[0]) * (p[1] - a[1]) - ((double)b[1] - a[1]) * (p[0] - a[0]);
		sum += share[c] = at > 0 ? at : 0;
	}
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++)
			mixed[k] += (float)(sum > 0 ? share[c] / sum : 1.0 / 3) * f->normal[c][k];
	return view_surface_direction(VIEW_FACET, mixed);
}

static uint32_t cut_of(const struct scene *scene, uint32_t item, uint32_t last)
{
	if (item >= scene->items[last] && item < scene->items[last + 1])
		return last;                     /* as the pixel before */
	uint32_t low = 0, high = scene->job->selection->cut_count - 1;
	ECO_LEAST(low, high, i, item < scene->items[i + 1])
	return low;
}

static void look_plant(const struct worker *w, uint32_t x, uint32_t y, uint32_t item, uint32_t *cut)
{
	const struct scene *scene = w->scene;
	struct view_picture *picture = w->picture;
	size_t i = (size_t)y * picture->width + x;
	struct view_rays rays;
	*cut = cut_of(scene, item, *cut);
	const struct view_mesh *mesh = &scene->meshes[*cut];
	bool has_rays = mesh->image || mesh->geometry.half || mesh->batch.leaf > 0,
		tinted = !mesh->by_point && view_store_needs(scene->job->store) & ECO_NEED_TINTS;
	const struct view_instance *instance = has_rays || tinted
		? view_owners_find(&scene->owners, scene->job->selection, picture->owner[i]) : NULL;
	if (has_rays)
		rays_of(w, x, y, &instance->place, &rays);
	view_mesh_look(mesh, item - scene->items[*cut], &rays,
		w->drawn->leaf[(size_t)y * w->drawn->width + x], picture->rgb + 3 * i, &picture->surface[i]);
	if (tinted)
		view_mesh_tint(mesh, item - scene->items[*cut], instance->tint, picture->rgb + 3 * i);
	if (scene->job->tint == VIEW_TINT_KIND)
		memcpy(picture->rgb + 3 * i, view_tint_colors[scene->job->selection->roles[*cut]], 3);
}

static void look_up(const struct worker *w, uint32_t first, uint32_t count)
{
	const struct view_picture *picture = w->picture;
	struct facet facet = { .made = false };
	uint32_t cut = 0;
	for (uint32_t y = first; y < picture->height; y += count)
		for (uint32_t x = 0; x < picture->width; x++) {
			size_t i = (size_t)y * picture->width + x;
			if (picture->owner[i])
				look_plant(w, x, y, w->drawn->item[i], &cut);
			else if (picture->depth[i] > 0)
				picture->surface[i] = look_ground(w, x, y, w->drawn->item[i], &facet);
		}
}

static void look_share(void *workers, uint32_t number)
{
	const struct worker *w = (struct worker *)workers + number;
	look_up(w, number, w->count);
}

static void take_drawn(const struct lod_raster *drawn, struct view_picture *picture)
{
	size_t pixels = (size_t)picture->width * picture->height;
	memcpy(picture->cover, drawn->cover, pixels);
	memcpy(picture->owner, drawn->owner, pixels * sizeof *picture->owner);
	memcpy(picture->depth, drawn->depth, pixels * sizeof *picture->depth);
}

/* ---- Many samples a pixel ---- */

static struct parts parts_of(uint32_t width, uint32_t height, uint32_t samples, uint32_t room)
{
	uint32_t side = 4096 / samples, most = room / (samples * samples);
	struct parts p = { width, height, samples, { width < side ? width : side, 0 } };
	p.part[1] = most / p.part[0] < height ? most / p.part[0] : height;
	return p;
}

/* Calls `work` for every part of a thread, which draws it all, so that what is in front hides what is behind. */
static void each_part(struct worker *w, const struct parts *p, uint32_t number,
	void (*work)(struct worker *w, const struct lod_eye *eye, uint32_t left, uint32_t top))
{
	uint32_t part = 0, size[2] = { w->raster.width, w->raster.height };
	for (uint32_t top = 0; top < p->height; top += p->part[1])
		for (uint32_t left = 0; left < p->width; left += p->part[0]) {
			if (part++ % w->count != number)
				continue;
			struct lod_eye eye = *w->scene->job->eye;
			lod_eye_part(&eye, p->width * p->samples, p->height * p->samples,
				(const uint32_t[2]){ left * p->samples, top * p->samples }, size);
			w->eye = &eye;
			lod_raster_clear(&w->raster);
			draw_instances(w, 0, 1);
			work(w, &eye, left, top);
		}
}

static void count_samples(struct worker *w, const struct lod_eye *eye, uint32_t left, uint32_t top)
{
	(void)eye;
	const struct view_coverage *c = w->coverage;
	const struct lod_raster *raster = &w->raster;
	uint32_t rows = raster->height / c->samples, columns = raster->width / c->samples;
	rows = rows < c->height - top ? rows : c->height - top;
	columns = columns < c->width - left ? columns : c->width - left;
	for (uint32_t y = 0; y < rows * c->samples; y++) {
		const uint8_t *cover = raster->cover + (size_t)y * raster->width;
		uint8_t *out = c->count + (size_t)(top + y / c->samples) * c->width + left;
		for (uint32_t x = 0; x < columns; x++)
			for (uint32_t k = 0; k < c->samples; k++)
				out[x] += *cover++ & 1;
	}
}

static void count_parts(void *workers, uint32_t number)
{
	struct worker *w = (struct worker *)workers + number;
	each_part(w, &w->parts, number, count_samples);
}

/* The mean light of a pixel's samples. */
static void mean_light(const struct worker *w, uint32_t x, uint32_t y, uint8_t rgb[3])
{
	uint32_t samples = w->parts.samples, count = samples * samples, sum[3] = { 0, 0, 0 };
	for (uint32_t i = 0; i < count; i++) {
		const uint16_t *one = w->picture->light + 3 * ((size_t)(y * samples + i / samples)
			* w->picture->width + x * samples + i % samples);
		for (int k = 0; k < 3; k++)
			sum[k] += one[k];
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = lod_light_byte((double)sum[k] / count);
}

static void light_samples(struct worker *w, const struct lod_eye *eye, uint32_t left, uint32_t top)
{
	const struct parts *p = &w->parts;
	take_drawn(&w->raster, w->picture);
	w->drawn = &w->raster;
	look_up(w, 0, 1);
	view_lamp_light(w->lamp, eye, w->picture, 1);
	for (uint32_t y = 0; y < p->part[1] && top + y < p->height; y++)
		for (uint32_t x = 0; x < p->part[0] && left + x < p->width; x++)
			mean_light(w, x, y, w->whole->rgb + 3 * ((size_t)(top + y) * p->width + left + x));
}

static void light_parts(void *workers, uint32_t number)
{
	struct worker *w = (struct worker *)workers + number;
	each_part(w, &w->parts, number, light_samples);
}

/* ---- Work ---- */

static int by_distance(const void *a, const void *b, void *ctx)
{
	const struct view_instance *instances = ctx;
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	double dx = instances[x].distance_m, dy = instances[y].distance_m;
	return dx < dy ? -1 : dx > dy ? 1 : x < y ? -1 : x > y;
}

static enum eco_code make_meshes(struct scene *scene, struct eco_error *error)
{
	const struct view_selection *s = scene->job->selection;
	uint64_t items = (uint64_t)s->ground.count * TILE_TRIANGLES;
	enum eco_code code = ECO_OK;
	for (uint32_t c = 0; c < s->cut_count && !code; c++) {
		scene->items[c] = (uint32_t)items;
		if (s->member_first[c] == s->member_first[c + 1])
			continue;
		uint32_t plant = s->instances[s->members[s->member_first[c]]].plant;
		const struct view_plant *of = plant == ECO_NONE ? NULL : view_store_plant(scene->job->store, plant);
		code = view_mesh_make(&scene->meshes[c], scene->job->store, &scene->plan->cuts[c], of, error);
		if (!code && of && !scene->job->smooth)
			view_mesh_add_leaves(&scene->meshes[c], &of->plant);
		items += scene->meshes[c].batch.count;
	}
	scene->items[s->cut_count] = (uint32_t)items;
	return code || items <= UINT32_MAX ? code : eco_fail(error, ECO_TOO_LARGE, "%llu primitives are too "
		"many to be drawn in software", (unsigned long long)items);
}

static enum eco_code scene_make(struct scene *scene, const struct view_draw_job *job,
	struct eco_error *error)
{
	static const struct eco_plan nothing;
	const struct view_selection *s = job->selection;
	*scene = (struct scene){ .job = job, .plan = view_store_plan(job->store) };
	if (!scene->plan)
		scene->plan = &nothing;
	scene->meshes = eco_alloc(s->cut_count, sizeof *scene->meshes);
	scene->items = eco_alloc((size_t)s->cut_count + 1, sizeof *scene->items);
	scene->order = eco_alloc(s->instance_count, sizeof *scene->order);
	for (uint32_t i = 0; i < s->instance_count; i++)
		scene->order[i] = i;
	qsort_r(scene->order, s->instance_count, sizeof *scene->order, by_distance, s->instances);
	if (!view_owners_make(&scene->owners, s))
		eco_end("no memory");
	return make_meshes(scene, error);
}

static void scene_free(struct scene *scene)
{
	for (uint32_t c = 0; c < scene->job->selection->cut_count; c++)
		view_mesh_free(&scene->meshes[c]);
	eco_free(scene->meshes, scene->items, scene->order);
	view_table_free(&scene->owners);
}

static struct worker *workers_make(const struct scene *scene, const struct lod_raster_options *options)
{
	uint32_t count = view_thread_count(scene->job->threads);
	struct worker *workers = eco_alloc(count, sizeof *workers);
	for (uint32_t i = 0; i < count; i++) {
		workers[i].scene = scene;
		workers[i].count = count;
		lod_raster_init(&workers[i].raster, options);
	}
	return workers;
}

static void workers_free(struct worker *workers)
{
	for (uint32_t i = 0, count = workers ? workers[0].count : 0; i < count; i++)
		lod_raster_free(&workers[i].raster);
	free(workers);
}

static enum eco_code record(void *ctx, const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	struct worker *workers = ctx;
	uint32_t count = workers[0].count;
	for (uint32_t i = 0; i < count; i++) {
		workers[i].eye = job->eye;
		workers[i].picture = picture;
		workers[i].drawn = &workers[0].raster;
		lod_raster_clear(&workers[i].raster);
	}
	view_threads_run(count, draw_share, workers);
	for (uint32_t i = 1; i < count; i++)
		lod_raster_merge(&workers[0].raster, &workers[i].raster);
	take_drawn(&workers[0].raster, picture);
	view_threads_run(count, look_share, workers);
	return stopped(job) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : ECO_OK;
}

enum eco_code view_reference_draw(const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	struct lod_raster_options options = { .width = picture->width, .height = picture->height,
		.owner = true, .item = true };
	struct scene scene;
	double start = view_clock_ms();
	enum eco_code code = scene_make(&scene, job, error);
	if (!code) {
		struct worker *workers = workers_make(&scene, &options);
		code = view_light_samples(job, record, workers, picture, error);
		workers_free(workers);
	}
	scene_free(&scene);
	picture->vertices = job->selection->vertices;
	picture->draw_ms = view_clock_ms() - start;
	return code;
}

static enum eco_code draw_parts(const struct scene *scene, const struct view_lamp *lamp, uint32_t samples,
	struct view_picture *whole, struct eco_error *error)
{
	const struct parts parts = parts_of(whole->width, whole->height, samples, LIT_MAX);
	struct lod_raster_options options = { .width = parts.part[0] * samples,
		.height = parts.part[1] * samples, .owner = true, .item = true };
	struct worker *workers = workers_make(scene, &options);
	uint32_t count = workers[0].count;
	struct view_picture *pictures = eco_alloc(count, sizeof *pictures);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code; i++) {
		workers[i].parts = parts;
		workers[i].lamp = lamp;
		workers[i].whole = whole;
		workers[i].picture = &pictures[i];
		code = view_picture_init(&pictures[i], options.width, options.height, error);
		pictures[i].light = eco_alloc((size_t)options.width * options.height, 3 * sizeof *pictures[i].light);
	}
	if (!code)
		view_threads_run(count, light_parts, workers);
	for (uint32_t i = 0; i < count; i++)
		view_picture_free(&pictures[i]);
	free(pictures);
	workers_free(workers);
	return !code && stopped(scene->job) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : code;
}
enum eco_code view_reference_fine(const struct view_draw_job *job, uint32_t samples,
	struct view_picture *picture, struct eco_error *error)
{
	struct lod_raster_options options = { .width = picture->width, .height = picture->height,
		.owner = true, .item = true };
	struct view_lamp *lamp = NULL;
	struct scene scene;
	double start = view_clock_ms();
	enum eco_code code = scene_make(&scene, job, error);
	if (!code) {
		struct worker *workers = workers_make(&scene, &options);
		code = record(workers, job, picture, error);
		workers_free(workers);
	}
	if (!code)
		code = view_lamp_make(&lamp, job, picture, error);
	if (!code)
		code = draw_parts(&scene, lamp, samples, picture, error);
	view_lamp_free(lamp);
	scene_free(&scene);
	picture->vertices = job->selection->vertices;
	picture->draw_ms = view_clock_ms() - start;
	return code;
}

enum eco_code view_reference_count(const struct view_draw_job *job, struct view_coverage *coverage,
	struct eco_error *error)
{
	const struct parts parts = parts_of(coverage->width, coverage->height, coverage->samples, COUNTED_MAX);
	struct lod_raster_options options = { .width = parts.part[0] * parts.samples,
		.height = parts.part[1] * parts.samples, .silhouette = true };
	struct scene scene;
	memset(coverage->count, 0, (size_t)coverage->width * coverage->height);
	enum eco_code code = scene_make(&scene, job, error);
	if (!code) {
		struct worker *workers = workers_make(&scene, &options);
		for (uint32_t i = 0; i < workers[0].count; i++) {
			workers[i].parts = parts;
			workers[i].coverage = coverage;
		}
		view_threads_run(workers[0].count, count_parts, workers);
		workers_free(workers);
	}
	scene_free(&scene);
	return !code && stopped(job) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : code;
}
