#include "tests/bench/bench_walk.h"

#include <stdlib.h>

struct making { json_t *(*make)(void *ctx); void *ctx; };

static enum eco_code make_unit(void *ctx, json_t **made, struct eco_error *error)
{
	const struct making *m = ctx;
	(void)error;
	*made = m->make(m->ctx);
	return ECO_OK;
}

json_t *must_unit(struct bench *bench, const char *name, const char *stamp, json_t *(*make)(void *ctx),
	void *ctx)
{
	json_t *unit;
	must(bench_unit(bench, name, stamp, make_unit, &(struct making){ make, ctx }, &unit, must_error));
	return unit;
}

const char *must_stamp(const char *path)
{
	static char stamp[32];
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(path));
	return stamp;
}

const struct bench_model *bench_walk(struct bench_walk *w)
{
	if (!w->models)
		must(bench_models(w->bench, &w->models, &w->count, must_error));
	while (w->next < w->count) {
		const struct bench_model *model = &w->models[w->next++];
		bool made = model->generated && w->quick_made;
		uint32_t found = w->quick_made ? w->found[made] : w->found[0] + w->found[1];
		if (model->leaves < w->leaves || (w->wants && !w->wants(w->bench, model)))
			continue;
		if (w->bench->full && w->found[0] + w->found[1] >= w->most)
			break;
		if (!w->bench->full && found >= (made ? w->quick_made : w->quick)) {
			bench_left_out(w->bench, model->name);
			continue;
		}
		bench_progress(w->bench, (double)w->next / w->count, model->name);
		return model;
	}
	free(w->models);
	w->models = NULL;
	return NULL;
}
