/* Models become plants, several at a time. Source plants of the same files, read in the same way, are one
 * plant. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/grade.h"
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/impostor.h"
#include "ecofiles/format/texture.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/model/model_import.h"

/* ---- Distinct plants ---- */

static bool same_rules(const struct eco_source_plant *a, const struct eco_source_plant *b)
{
	if (a->part_count != b->part_count)
		return false;
	for (uint32_t i = 0; i < a->part_count; i++) {
		const struct eco_part_rule *p = &a->parts[i], *q = &b->parts[i];
		if (p->kind != q->kind || p->component != q->component || p->size[0] != q->size[0]
				|| p->size[1] != q->size[1] || p->is != q->is
				|| p->importance != q->importance
			|| (p->kind == ECO_PART_NAME && strcmp(p->name, q->name) != 0))
			return false;
	}
	return true;
}

static bool same_plant(const struct make_plant *plant, const struct eco_source_plant *source,
	double importance, const char *path)
{
	const struct eco_source_plant *s = plant->source;
	return strcmp(plant->path, path) == 0 && plant->importance == importance
		&& s->height_m == source->height_m && s->unit_m == source->unit_m && s->up == source->up && s->keep_origin == source->keep_origin
		&& memcmp(s->foot, source->foot, sizeof s->foot) == 0
		&& s->grade == source->grade && s->object == source->object
		&& memcmp(s->importance, source->importance, sizeof source->importance) == 0
		&& same_rules(s, source);
}

/* The files of a plant as one text: canonical paths, separated by newlines; a plant of the library says what it is. */
static char *paths_of(const struct eco_source_plant *source)
{
	const struct eco_library_plant *l = &source->library;
	char *all = NULL;
	if (source->model_count == 0 && asprintf(&all, "library: %s, %s, %.10g m, crown %.10g m, base %.10g, %s, %u", l->habit, l->genus,
			l->height_m, l->crown_m, l->base, eco_season_names[l->season], l->individual) < 0)
		eco_end("no memory");
	for (uint32_t i = 0; i < source->model_count; i++) {
		char *canonical = realpath(source->models[i], NULL), *longer = NULL;
		if (asprintf(&longer, "%s%s%s", all ? all : "", all ? "\n" : "", canonical ? canonical
				: source->models[i]) < 0)
			eco_end("no memory");
		free(canonical);
		free(all);
		all = longer;
	}
	return all;
}

/* Names are for people, so different plants should have different names. */
static void name_plant(struct make *m, struct make_plant *plant)
{
	const struct eco_source_plant *s = plant->source;
	char name[64];
	if (s->variant_count > 1)
		snprintf(name, sizeof name, "%.58s-%u", s->name, s->variant + 1);
	else
		snprintf(name, sizeof name, "%s", s->name);
	for (uint32_t i = 0; i < m->plant_count; i++) {
		if (&m->plants[i] != plant && strcmp(m->plants[i].name, name) == 0) {
			snprintf(plant->name, sizeof plant->name, "%.54s#%u", name,
				(unsigned)(plant - m->plants));
			return;
		}
	}
	memcpy(plant->name, name, sizeof name);
}

/* `importance`: of the eco file that names it. */
static uint32_t find_plant(struct make *m, const struct eco_source_plant *source, double importance)
{
	char *path = paths_of(source);
	for (uint32_t i = 0; i < m->plant_count; i++)
		if (same_plant(&m->plants[i], source, importance, path)) {
			free(path);
			return i;
		}
	struct make_plant *plant = &m->plants[m->plant_count++];
	*plant = (struct make_plant){ .source = source, .path = path, .importance = importance };
	name_plant(m, plant);
	return m->plant_count - 1;
}

static void find_plants(struct make *m)
{
	size_t most = 0;
	for (uint32_t s = 0; s < m->sources.count; s++)
		most += m->sources.items[s].plant_count;
	most += m->blocks.count;
	m->plants = eco_alloc(most, sizeof *m->plants);
	m->plant_of = eco_alloc(m->sources.count, sizeof *m->plant_of);
	for (uint32_t s = 0; s < m->sources.count; s++) {
		const struct eco_source *source = &m->sources.items[s];
		m->plant_of[s] = eco_alloc(source->plant_count, sizeof **m->plant_of);
		for (uint32_t i = 0; i < source->plant_count; i++)
			m->plant_of[s][i] = find_plant(m, &source->plants[i], source->importance);
	}
	for (uint32_t i = 0; i < m->blocks.count; i++, m->plant_count++)
		make_buildings_plant(m, i, &m->plants[m->plant_count]);
}

/* ---- Building, in threads ---- */

struct work {
	struct make *m;
	pthread_mutex_t lock;
	/* held around importers: they fork, and the child must find their locks free */
	pthread_mutex_t libraries;
	uint32_t next, done;
	uint32_t idle;               /* threads without a plant; they help others */
	double *share;               /* per plant */
	uint32_t failed;             /* lowest plant that failed, whose error is reported */
	struct eco_error error;
	bool stop;
};

struct job { struct work *work; uint32_t plant; double from, to; struct eco_error error; };

/* Usual shares of a plant's time. */
#define IMPORTED 0.08
#define BUILT 0.35

static bool tell(void *ctx, double share)
{
	struct job *job = ctx;
	struct work *work = job->work;
	char detail[128];
	double sum = 0;
	pthread_mutex_lock(&work->lock);
	share = job->from + (job->to - job->from) * share;
	if (share > work->share[job->plant])         /* measuring stages restart the count */
		work->share[job->plant] = share;
	for (uint32_t i = 0; i < work->m->plant_count; i++)
		sum += work->share[i];
	snprintf(detail, sizeof detail, "%s (%u of %u)", work->m->plants[job->plant].name, work->done + 1,
		work->m->plant_count);
	bool go = !work->stop;
	pthread_mutex_unlock(&work->lock);
	main_progress("building plants", detail, sum / work->m->plant_count);
	return go;
}

static void keep_textures(struct make_plant *plant, const struct eco_model *model, struct eco_error *error)
{
	plant->textures = eco_alloc(plant->built.image_count, sizeof *plant->textures);
	for (uint32_t i = 0; i < plant->built.image_count; i++) {
		uint32_t id = plant->built.images[i];
		eco_check(lod_texture_make(&plant->textures[i], model, id, error));
		for (uint32_t k = 0; k < model->material_count; k++)
			plant->cutout = plant->cutout
				|| (model->materials[k].image == id && model->materials[k].cutout);
	}
}

static void warn(void *ctx, const char *text) { main_note("%s: %s", ((struct make_plant *)ctx)->name, text); }

static void enter(void *ctx, enum lod_plant_stage stage)
{
	static const enum main_stage stages[] = { [LOD_STAGE_ELEMENTS] = MAIN_STAGE_ELEMENTS,
		[LOD_STAGE_ORDERS] = MAIN_STAGE_ORDERS, [LOD_STAGE_LISTS] = MAIN_STAGE_LISTS,
		[LOD_STAGE_SPLATS] = MAIN_STAGE_SPLATS, [LOD_STAGE_CURVES] = MAIN_STAGE_CURVES };
	(void)ctx;
	main_times_stage(stages[stage]);
}

/* Does pieces of one plant's work with the help of idle threads. */
static void each(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces)
{
	struct work *work = ((struct job *)ctx)->work;
	pthread_mutex_lock(&work->lock);
	uint32_t taken = work->idle < count - 1 ? work->idle : count - 1;
	work->idle -= taken;
	pthread_mutex_unlock(&work->lock);
	main_each(&(struct main_each){ taken + 1, count, 1, piece, pieces });
	pthread_mutex_lock(&work->lock);
	work->idle += taken;
	pthread_mutex_unlock(&work->lock);
}

/* Builds and measures a plant, or takes it from the cache. */
static void build_or_recall(struct job *job, const struct eco_model *model)
{
	struct make *m = job->work->m;
	struct make_plant *plant = &m->plants[job->plant];
	struct lod_plant_options options = { .name = plant->name, .seed = 1, .order = m->options->order,
		.draft = m->options->draft, .progress = tell, .stage = enter, .each = each, .ctx = job };
	struct main_cache_key key;
	memcpy(options.importance, plant->source->importance, sizeof options.importance);
	main_times_stage(MAIN_STAGE_CACHE);
	bool cached = m->cache.folder[0] && main_cache_key(&key, model, &options);
	if (cached && main_cache_get_plant(&m->cache, &key, model, plant->name, &plant->built))
		return;
	job->from = IMPORTED;
	job->to = BUILT;
	eco_check(lod_plant_build(&plant->built, model, &options, &job->error));
	job->from = BUILT;
	job->to = 1;
	eco_check(lod_plant_measure(&plant->built, model, &options, &job->error));
	main_times_stage(MAIN_STAGE_CACHE);
	if (cached)
		main_cache_put_plant(&m->cache, &key, &plant->built);
}

static enum eco_code import_model(struct make_plant *plant, struct eco_model *model, struct eco_error *error)
{
	if (plant->block)
		return make_buildings_model(plant, model), ECO_OK;
	if (plant->source->model_count == 0)
		return eco_library_make(model, &plant->source->library, error);
	return eco_model_import(model,
		&(struct eco_model_options){ .paths = (const char *const *)plant->source->models,
		.path_count = plant->source->model_count, .height_m = plant->source->height_m,
		.unit_m = plant->source->unit_m, .up = plant->source->up, .keep_origin = plant->source->keep_origin,
		.origin = { plant->source->foot[0], plant->source->foot[1], plant->source->foot[2] },
		.object = plant->source->object, .rules = plant->source->parts,
		.rule_count = plant->source->part_count, .warn = warn, .ctx = plant }, error);
}

#define DRAFT_TEXELS 512u                /* of a side of a draft's texture */

static void build_plant(void *ctx)
{
	struct job *job = ctx;
	struct make_plant *plant = &job->work->m->plants[job->plant];
	struct eco_model model = { 0 };
	job->from = 0;
	job->to = IMPORTED;
	tell(job, 0);
	pthread_mutex_lock(&job->work->libraries);
	main_times_stage(MAIN_STAGE_MODELS);
	enum eco_code code = import_model(plant, &model, &job->error);
	main_times_stage(MAIN_STAGE_NONE);
	pthread_mutex_unlock(&job->work->libraries);
	eco_check(code);
	if (plant->source->grade)
		grade_foliage(&model);
	plant->triangles_in = model.triangles_in;
	memcpy(plant->dropped, model.dropped, sizeof plant->dropped);
	memcpy(plant->foot, model.foot, sizeof plant->foot);
	plant->scale = model.scale;
	main_times_stage(MAIN_STAGE_TEXTURES);
	/* a draft is built of the texels that it keeps */
	for (uint32_t i = 0; i < model.image_count && job->work->m->options->draft; i++)
		lod_texture_shrink(&model.images[i], DRAFT_TEXELS);
	build_or_recall(job, &model);
	main_times_stage(MAIN_STAGE_TEXTURES);
	keep_textures(plant, &model, &job->error);
	main_times_stage(MAIN_STAGE_NONE);
	eco_model_free(&model);
}

static void *work_on(void *ctx)
{
	struct work *work = ctx;
	for (;;) {
		pthread_mutex_lock(&work->lock);
		struct job job = { .work = work, .plant = work->next };
		bool more = !work->stop && work->next < work->m->plant_count;
		work->next += more;
		work->idle += !more;
		pthread_mutex_unlock(&work->lock);
		if (!more)
			return NULL;
		enum eco_code code = eco_try(build_plant, &job, &job.error);
		pthread_mutex_lock(&work->lock);
		work->done++;
		work->share[job.plant] = 1;
		/* a thread stopped by another's failure has none of its own */
		if (code && !(code == ECO_INTERRUPTED && work->stop)) {
			work->stop = true;
			if (job.plant < work->failed) {
				work->failed = job.plant;
				work->error = job.error;
			}
		}
		pthread_mutex_unlock(&work->lock);
	}
}

/* Importers fork. The C library's allocator supports that while other threads run. The address sanitizer's
 * does not: a child may wait for its lock for ever, so under it there is one thread. */
static uint32_t thread_count(const struct make *m)
{
#ifdef __SANITIZE_ADDRESS__
	(void)m;
	return 1;
#else
	return make_threads(m);
#endif
}

static void build_plants(struct make *m)
{
	uint32_t all = thread_count(m), jobs = all < m->plant_count ? all : m->plant_count, started = 0;
	struct work work = { .m = m, .idle = all - jobs, .lock = PTHREAD_MUTEX_INITIALIZER,
		.libraries = PTHREAD_MUTEX_INITIALIZER, .failed = ECO_NONE,
		.share = eco_alloc(m->plant_count, sizeof(double)) };
	pthread_t threads[MAIN_THREADS_MAX];
	while (started + 1 < jobs && pthread_create(&threads[started], NULL, work_on, &work) == 0)
		started++;
	work_on(&work);
	for (uint32_t i = 0; i < started; i++)
		pthread_join(threads[i], NULL);
	free(work.share);
	/* reports the failure, not the interruptions that it caused in other threads */
	if (work.failed != ECO_NONE)
		eco_stop(work.error.code, "%s", work.error.text);
}

/* ---- Packing ---- */

struct packing { struct make *m; uint32_t id; uint32_t *lists; };

static void pack_list(struct packing *p, uint32_t i)
{
	struct make_plant *plant = &p->m->plants[p->id];
	const struct lod_list_draft *draft = &plant->built.lists[i];
	struct eco_list list = draft->list;
	list.owner = p->id;
	list.palette_first += list.palette_count ? plant->palette_first : 0;
	list.image = list.image == ECO_NONE ? ECO_NONE : plant->images[list.image];
	/* points end where their fans end */
	const struct lod_list_draft *partner = list.partner == ECO_NONE ? NULL : &plant->built.lists[list.partner],
		*ending = partner ? partner : draft;
	list.partner = partner ? p->lists[list.partner] : ECO_NONE;
	p->lists[i] = make_add_list(p->m, &list, &draft->elements, ending->ends, ending->end_count,
		partner ? &partner->elements : NULL);
}

/* How much of splats' colours is wood: only tints ask; with them wood's own colour ends the palette. */
static uint32_t settle_wood(struct make_plant *plant, bool tinted)
{
	struct lod_plant *built = &plant->built;
	uint32_t wood = 0;
	for (uint32_t i = 0; i < built->list_count; i++) {
		struct eco_list *list = &built->lists[i].list;
		if (!(list->attributes & ECO_ATTR_SPLAT) || !list->wood)
			continue;
		list->palette_count += tinted;
		built->palette_count -= !tinted;
		wood = list->wood = tinted ? list->wood : 0;
	}
	return wood;
}

/* Packs partners before their forms, and the impostor last. */
static void pack_lists(struct packing *p, uint32_t wood)
{
	const struct make_plant *plant = &p->m->plants[p->id];
	const struct lod_plant *built = &plant->built;
	const struct eco_list impostor = { .kind = ECO_LIST_IMPOSTOR, .coder = ECO_CODER_BYTES, .owner = p->id,
		.level = built->impostor_level, .image = ECO_NONE, .partner = ECO_NONE, .grid_step = { 1, 1, 1 },
		.wood = wood, .palette_count = wood ? 1 : 0,
		.palette_first = wood ? plant->palette_first + built->palette_count - 1 : 0 };
	for (int forms = 0; forms < 2; forms++)
		for (uint32_t i = 0; i < built->list_count; i++)
			if ((built->lists[i].list.partner != ECO_NONE) == forms)
				pack_list(p, i);
	if (built->impostor_count)
		p->lists[built->list_count] = make_add_bytes(p->m, &impostor, built->impostor, built->impostor_count);
}

static void pack_tables(struct packing *p)
{
	struct make *m = p->m;
	const struct lod_plant *built = &m->plants[p->id].built;
	m->table[p->id] = built->plant;
	for (uint32_t l = 0; l < built->ladder_count; l++)
		built->ladders[l].importance *= (float)m->plants[p->id].importance;
	make_add_plant(m, p->id, &(struct make_tables){ .anchors = built->anchors,
		.curves = built->curves, .curve_count = built->curve_count, .ladders = built->ladders,
		.ladder_count = built->ladder_count }, p->lists);
}

static void pack_plant(struct make *m, uint32_t id)
{
	struct make_plant *plant = &m->plants[id];
	const struct lod_plant *built = &plant->built;
	struct packing p = { m, id, eco_alloc(built->list_count + 1u, sizeof *p.lists) };
	uint32_t wood = settle_wood(plant, m->tinted);
	plant->palette_first = (uint32_t)m->palette.count;
	make_add(&m->palette, built->palette, built->palette_count, 3);
	pack_lists(&p, wood);
	pack_tables(&p);
	m->scene.needs |= built->image_count ? ECO_NEED_TEXTURES : 0;
	m->scene.needs |= plant->cutout ? ECO_NEED_CUTOUTS : 0;
	m->scene.needs |= built->plant.anchor_count > 1 ? ECO_NEED_CELLS : 0;
	free(p.lists);
}

void make_plants_pack(struct make *m)
{
	main_times_stage(MAIN_STAGE_PACKING);
	m->table = eco_alloc(m->plant_count, sizeof *m->table);
	for (uint32_t s = 0; s < m->sources.count; s++)
		for (uint32_t i = 0; i < m->sources.items[s].positions_count; i++)
			m->tinted |= m->sources.items[s].positions[i].tint.column != NULL;
	make_textures(m);
	for (uint32_t i = 0; i < m->plant_count; i++) {
		main_progress("packing plants", m->plants[i].name, (double)i / m->plant_count);
		make_body(&m->plants[i]);
		pack_plant(m, i);
	}
	m->scene.plants = m->table;
	m->scene.plant_count = m->plant_count;
}

void make_plants(struct make *m)
{
	make_buildings_read(m);
	find_plants(m);
	build_plants(m);
	make_buildings_say(m);
	make_plants_pack(m);
}

void make_plants_free(struct make *m)
{
	for (uint32_t i = 0; i < m->plant_count; i++) {
		struct make_plant *plant = &m->plants[i];
		for (uint32_t k = 0; plant->textures && k < plant->built.image_count; k++)
			lod_texture_free(&plant->textures[k]);
		eco_free(plant->textures, plant->images, plant->path);
		lod_plant_free(&plant->built);
	}
	for (uint32_t s = 0; m->plant_of && s < m->sources.count; s++)
		free(m->plant_of[s]);
	free(m->plant_of);
}

/* ---- Textures ---- */

/* Textures of a pack, shared by its plants. */

/* All levels that both have are alike. */
static bool same_image(const struct make_texture *a, const struct make_texture *b)
{
	size_t size = (a->count < b->count ? a->count : b->count) * sizeof *a->colors;
	return a->outlined == b->outlined && memcmp(a->colors, b->colors, size) == 0
		&& (!a->outlined || memcmp(a->outlines, b->outlines, size) == 0);
}

uint32_t make_share_texture(struct make *m, const struct make_texture *texture)
{
	struct make_texture *all = m->textures.items;
	uint32_t at = 0;
	while (at < m->textures.count && !same_image(&all[at], texture))
		at++;
	if (at == m->textures.count) {
		make_add(&m->textures, texture, 1, sizeof *texture);
		return at;
	}
	const struct make_texture *fine = texture->count > all[at].count ? texture : &all[at],
		*other = fine == texture ? &all[at] : texture;
	/* what a texel of the finer one's last level covers where the other is seen */
	float area = ldexpf(other->texel_area, 2 * ((int)other->count - (int)fine->count));
	struct make_texture both = *fine;
	both.texel_area = fmaxf(fine->texel_area, area);
	all[at] = both;
	return at;
}

static struct make_texture describe(struct lod_texture *texture)
{
	struct make_texture t = { .count = texture->count, .outlined = texture->outlines,
		.texel_area = texture->texel_area, .from = texture };
	for (uint32_t k = 0; k < t.count; k++) {
		t.colors[k] = eco_chunk_hash(texture->colors[k].bytes, texture->colors[k].size);
		if (t.outlined)
			t.outlines[k] = eco_chunk_hash(texture->outlines[k].bytes, texture->outlines[k].size);
	}
	return t;
}

/* Finds each plant's textures among the shared ones. */
static void find(struct make *m)
{
	for (uint32_t p = 0; p < m->plant_count; p++) {
		struct make_plant *plant = &m->plants[p];
		plant->images = eco_alloc(plant->built.image_count, sizeof *plant->images);
		for (uint32_t i = 0; i < plant->built.image_count; i++) {
			struct make_texture texture = describe(&plant->textures[i]);
			plant->images[i] = make_share_texture(m, &texture);
		}
	}
}

static void pack(struct make *m, struct make_texture *shared)
{
	const struct lod_texture *texture = shared->from;
	struct eco_list list = { .kind = ECO_LIST_OUTLINE, .coder = ECO_CODER_BYTES, .owner = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE, .grid_step = { 1, 1, 1 },
		.unit_area = shared->texel_area, .level = texture->loss };
	if (texture->outlines)
		list.image = make_add_levels(m, &list, texture->outlines, texture->count);
	list.kind = ECO_LIST_IMAGE;
	list.level = 0;
	shared->list = make_add_levels(m, &list, texture->colors, texture->count);
}

void make_textures(struct make *m)
{
	find(m);
	struct make_texture *all = m->textures.items;
	for (uint32_t i = 0; i < m->textures.count; i++)
		pack(m, &all[i]);
	for (uint32_t p = 0; p < m->plant_count; p++)
		for (uint32_t i = 0; i < m->plants[p].built.image_count; i++)
			m->plants[p].images[i] = all[m->plants[p].images[i]].list;
}
