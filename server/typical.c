#include "server/typical.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "ecofiles/base/random.h"
#include "server/stream.h"

#define WORK_MOST 4000000u       /* of one of them: a scene so large is not asked for more */
#define BYTES_EVERY 4u           /* requests with a byte budget */
#define FAILED_MOST 4u           /* requests that need more tiles or plants than any may */
#define PLANT_WORK 40u           /* least that is ordinary, for each plant of the scene */

static double between(uint64_t *state, double low, double high)
{
	return low + (high - low) * eco_random_unit(eco_random_next(state));
}

/* Each power of two as likely, by arithmetic that every machine rounds alike. */
static uint64_t power(uint64_t *state, int low, int high)
{
	return (uint64_t)ldexp(1, low + (int)between(state, 0, high - low + 1));
}

static struct eco_request request_of(const struct eco_tile *root, uint64_t *state, uint32_t number)
{
	struct eco_request request = { .view = { .up = { 0, 0, 1 },
		.width = (uint32_t)power(state, 0, 12), .height = (uint32_t)power(state, 0, 12) },
		.bytes = ECO_BYTES_UNBOUNDED };
	double reach = ldexp((double)power(state, 0, 9), -4);
	request.view.fov_y_deg = between(state, 1, 150);
	for (int i = 0; i < 3; i++) {
		double middle = (root->low[i] + root->high[i]) / 2, half = (root->high[i] - root->low[i]) / 2
			+ 1e-3;
		request.view.target[i] = middle + half * between(state, -1, 1);
		request.view.eye[i] = request.view.target[i] + half * reach * between(state, -1, 1);
	}
	request.vertices = power(state, 0, 27);
	if (number % BYTES_EVERY == 0)
		request.bytes = power(state, 3, 25);
	return request;
}

static int ascending(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

/* 0: cancelled. */
static uint64_t median_work(const struct srv_scene *scene, const atomic_bool *cancelled)
{
	const struct eco_scene *tables = &scene->pack->scene;
	uint64_t works[SRV_TYPICAL_REQUESTS] = { 0 }, state = 1;
	for (uint32_t i = 0, failed = 0; i < SRV_TYPICAL_REQUESTS && tables->tile_count; i++) {
		struct eco_request request = request_of(&tables->tiles[tables->root], &state, i);
		struct srv_stream stream;
		if (eco_view_check(&request.view, NULL))
			continue;
		enum eco_code code = srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = scene,
			.request = &request, .work_max = WORK_MOST, .cancelled = cancelled }, NULL);
		if (code == ECO_INTERRUPTED)
			return 0;
		if (code == ECO_TOO_LARGE && ++failed == FAILED_MOST)
			return WORK_MOST;
		if (code)
			continue;
		works[i] = stream.work;
		srv_stream_free(&stream);
	}
	qsort(works, SRV_TYPICAL_REQUESTS, sizeof *works, ascending);
	uint64_t work = works[SRV_TYPICAL_REQUESTS / 2];
	return work > SRV_TYPICAL_WORK_LEAST ? work : SRV_TYPICAL_WORK_LEAST;
}

static uint64_t least_work(const struct srv_scene *scene)
{
	const struct eco_scene *tables = &scene->pack->scene;
	uint64_t plants = tables->tile_count ? tables->tiles[tables->root].instance_count : 0;
	const uint64_t wide = SRV_TYPICAL_WORK_WIDE, least = plants < wide ? PLANT_WORK * plants : wide;
	return least < SRV_TYPICAL_WORK_LEAST ? SRV_TYPICAL_WORK_LEAST : least < wide ? least : wide;
}

uint64_t srv_typical_find(struct srv_scene *scene, const atomic_bool *cancelled)
{
	static pthread_mutex_t finding = PTHREAD_MUTEX_INITIALIZER; /* one thread finds it, the others wait */
	uint64_t work = atomic_load(&scene->typical_work);
	if (work)
		return work;
	pthread_mutex_lock(&finding);
	work = atomic_load(&scene->typical_work);
	if (!work) {
		work = median_work(scene, cancelled);
		work = work == 0 || work > least_work(scene) ? work : least_work(scene);
		atomic_store(&scene->typical_work, work);
	}
	pthread_mutex_unlock(&finding);
	return work;
}

uint64_t srv_typical_work(struct srv_scene *scene)
{
	return srv_typical_find(scene, NULL);
}

bool srv_typical_find_all(const struct srv_store *store, const atomic_bool *cancelled)
{
	for (uint32_t i = 0; i < store->count; i++)
		if (!srv_typical_find(store->scenes[i], cancelled))
			return false;
	return true;
}
