#include "tests/bench/bench_walk.h"

#include <stdlib.h>

const char *must_stamp(const char *path)
{
	static char stamp[32];
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(path));
	return stamp;
}

const struct bench_model *bench_walk(struct bench_walk *w)
{
	if (!w->models)
		w->models = bench_models(w->bench, &w->count);
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
