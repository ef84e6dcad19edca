/* The build, from beginning to end. */
#include "ecofiles/main_make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/main_progress.h"
#include "ecofiles/main_times.h"
#include "lod/summary.h"

#define GROUND_SIDE_MAX 1024u    /* the ground is sent whole */
#define GROUND_CHUNK 65536u
#define HEIGHT_STEP_M 0.01

void *make_append(struct make *m, struct make_array *array, size_t size)
{
	if (array->count == array->capacity) {
		uint64_t wanted = array->capacity ? 2 * array->capacity : 64;
		void *bigger = wanted < ECO_NONE ? realloc(array->items, wanted * size) : NULL;
		if (!bigger) {
			eco_fail(m->error, ECO_NO_MEMORY, "no memory for %llu records", (unsigned long long)wanted);
			return NULL;
		}
		array->items = bigger;
		array->capacity = wanted;
	}
	return (uint8_t *)array->items + size * array->count++;
}

static enum eco_code keep_list(struct make *m, uint32_t list_id)
{
	static const uint32_t needs[] = { [ECO_LIST_TRIANGLES] = ECO_NEED_TRIANGLES, [ECO_LIST_LINES] = ECO_NEED_LINES,
		[ECO_LIST_POINTS] = ECO_NEED_POINTS, [ECO_LIST_GROUND] = ECO_NEED_GROUND, [ECO_LIST_IMAGE] = ECO_NEED_TEXTURES };
	struct eco_list *stored = make_append(m, &m->lists, sizeof *stored);
	if (!stored)
		return ECO_NO_MEMORY;
	*stored = *eco_pack_list(m->writer, list_id);
	m->scene.needs |= needs[stored->kind];
	return ECO_OK;
}

enum eco_code make_add_list(struct make *m, const struct eco_list *list, const struct eco_elements *elements, const uint32_t *ends,
	uint32_t end_count, const struct eco_elements *partner, uint32_t *list_id)
{
	enum eco_code code = eco_pack_add_list(m->writer, list, elements, ends, end_count, partner, list_id, m->error);
	return code ? code : keep_list(m, *list_id);
}

enum eco_code make_add_encoded(struct make *m, const struct eco_list *list, const struct eco_encoded *encoded, uint32_t *list_id)
{
	enum eco_code code = eco_pack_add_encoded(m->writer, list, encoded, list_id, m->error);
	return code ? code : keep_list(m, *list_id);
}

uint32_t make_threads(const struct make *m)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	return m->options->jobs ? m->options->jobs : processors > 64 ? 64 : processors > 0 ? (uint32_t)processors : 1;
}

/* ---- Ground ---- */

static void warn(void *ctx, const char *text)
{
	main_note("%s: %s", ((const struct eco_source *)ctx)->ground_heights, text);
}

/* Heights as the pack will say them, so that plants stand on the ground that is drawn. */
static void round_heights(struct eco_ground *ground, double *low, double *step)
{
	size_t count = (size_t)ground->columns * ground->rows;
	double least = ground->height_m[0], most = least;
	for (size_t i = 1; i < count; i++) {
		least = fmin(least, ground->height_m[i]);
		most = fmax(most, ground->height_m[i]);
	}
	*step = lod_power_below(fmin(HEIGHT_STEP_M, most > least ? (most - least) / 1024 : 1));
	while ((most - least) / *step > 1 << 27)
		*step *= 2;
	*low = floor(least / *step) * *step + 0.0;
	for (size_t i = 0; i < count; i++)
		ground->height_m[i] = (float)(*low + floor((ground->height_m[i] - *low) / *step + 0.5) * *step);
}

static enum eco_code pack_ground(struct make *m, double low, double step)
{
	const struct eco_ground *g = &m->ground;
	uint32_t count = g->columns * g->rows, end_count = 0, ends[GROUND_SIDE_MAX * GROUND_SIDE_MAX / GROUND_CHUNK + 1];
	struct eco_list list = { .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS, .owner = ECO_NONE, .plant = ECO_NONE, .image = ECO_NONE,
		.partner = ECO_NONE, .grid_origin = { g->x_m, g->y_m, low }, .grid_step = { g->step_x_m, g->step_y_m, step },
		.columns = g->columns };
	struct eco_elements e = { .element_count = count, .corner_count = count, .primitive_count = count, .corners = malloc(count),
		.position = malloc(3 * sizeof(int32_t) * count) };
	if (!e.corners || !e.position) {
		eco_elements_free(&e);
		return eco_fail(m->error, ECO_NO_MEMORY, "no memory for %u ground samples", count);
	}
	for (uint32_t i = 0; i < count; i++) {
		e.corners[i] = 1;
		e.position[3 * (size_t)i] = (int32_t)(i % g->columns);
		e.position[3 * (size_t)i + 1] = (int32_t)(i / g->columns);
		e.position[3 * (size_t)i + 2] = (int32_t)floor((g->height_m[i] - low) / step + 0.5);
	}
	for (uint32_t end = 0; end < count; ends[end_count++] = end)
		end = count - end > GROUND_CHUNK ? end + GROUND_CHUNK : count;
	enum eco_code code = make_add_list(m, &list, &e, ends, end_count, NULL, &m->scene.ground);
	eco_elements_free(&e);
	return code;
}

static enum eco_code read_ground(struct make *m, double *low, double *step)
{
	struct eco_source *source = &m->sources.items[0];
	if (!source->ground_heights)
		return ECO_OK;
	if (!main_progress("reading ground", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = eco_ground_import(&m->ground, &(struct eco_ground_options){ .path = source->ground_heights,
		.crs = source->ground_crs, .scene_crs = source->crs, .origin = { source->origin[0], source->origin[1], source->origin[2] },
		.side_max = GROUND_SIDE_MAX, .warn = warn, .ctx = source }, m->error);
	if (code)
		return code;
	m->has_ground = true;
	round_heights(&m->ground, low, step);
	return ECO_OK;
}

/* ---- The whole ---- */

/* About 2^-17 of the scene's diameter, so that depth has resolution to spare, and never so far that it cuts into a plant looked at
 * closely. */
static double near_m(const struct make *m)
{
	const struct eco_tile *root = &m->scene.tiles[0];
	double square = 0;
	for (int i = 0; i < 3; i++) {
		double extent = root->high[i] - root->low[i];
		if (m->has_ground && i < 2)
			extent = fmax(extent, i ? m->ground.step_y_m * (m->ground.rows - 1) : m->ground.step_x_m * (m->ground.columns - 1));
		square += extent * extent;
	}
	double near = fmin(ldexp(sqrt(square), -17), m->ecos[0].smallest_m / 64);
	return lod_power_below(fmax(near, 1e-6));
}

static enum eco_code build(struct make *m)
{
	double low = 0, step = 0;
	main_times_stage(MAIN_STAGE_SCENE);
	if (!main_progress("reading the scene", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = eco_sources_load(&m->sources, m->options->scene, m->error);
	if (!code)
		code = eco_pack_create(&m->writer, m->options->pack, m->error);
	/* what is wrong with inventories and ground is said before the plants, which take longest */
	if (!code)
		code = make_places_check(m);
	main_times_stage(MAIN_STAGE_GROUND);
	if (!code)
		code = read_ground(m, &low, &step);
	if (!code)
		code = make_plants(m);
	main_times_stage(MAIN_STAGE_GROUND);
	if (!code && m->has_ground)
		code = pack_ground(m, low, step);
	main_times_stage(MAIN_STAGE_POSITIONS);
	if (!code)
		code = make_places(m);
	if (!code)
		code = make_tiles(m);
	if (code)
		return code;
	snprintf(m->scene.name, sizeof m->scene.name, "%s", m->sources.items[0].name);
	m->scene.near_m = near_m(m);
	char *meta = NULL;
	main_times_stage(MAIN_STAGE_WRITING);
	code = make_meta(m, &meta, m->error);
	if (!code && !main_progress("writing", NULL, 1))
		code = eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	if (!code) {
		struct eco_pack_writer *writer = m->writer;
		m->writer = NULL;        /* committing frees it, whatever happens */
		code = eco_pack_commit(writer, &m->scene, meta, m->error);
	}
	free(meta);
	return code;
}

enum eco_code make_pack(const struct make_options *options, struct eco_error *error)
{
	struct eco_error own = { 0 };
	struct make m = { .options = options, .error = error ? error : &own, .scene = { .ground = ECO_NONE } };
	enum eco_code code = build(&m);
	main_times_stage(MAIN_STAGE_NONE);
	main_progress_end();
	eco_pack_abort(m.writer);
	make_places_free(&m);
	make_plants_free(&m);
	eco_ground_free(&m.ground);
	eco_sources_free(&m.sources);
	struct make_array *arrays[] = { &m.anchors, &m.ladders, &m.curves, &m.tiles, &m.groups, &m.children, &m.lists, &m.places, &m.palette, &m.stands };
	for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
		free(arrays[i]->items);
	return code;
}
