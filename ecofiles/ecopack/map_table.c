#include <stdlib.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/map.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/import/places/gis_files.h"

static void point_of(void *ctx, uint64_t index, struct eco_point *out)
{
	const struct map *m = ctx;
	const struct map_point *p = &m->points.items[index];
	const double *origin = m->sources.items[0].origin;
	*out = (struct eco_point){ { origin[0] + (double)p->x, origin[1] + (double)p->y },
		m->species.items[p->species], m->kinds[p->kind].name, p->row ? m->files[p->file] : "",
		(double)p->height_m, p->row, p->line };
}

enum eco_code map_write_table(struct map *m, const char *path)
{
	const struct eco_source *outer = &m->sources.items[0];
	struct eco_point_table table = { .name = "plants", .crs = outer->crs, .count = m->points.count,
		.point = point_of, .ctx = m };
	uint8_t *bytes = NULL;
	size_t size = 0;
	if (m->not_expanded)
		return eco_fail(m->error, ECO_TOO_LARGE, "%s: nested files place %llu plants, more than a "
			"table takes one by one; write the tables of the nested files", path,
			(unsigned long long)m->not_expanded);
	if (!main_progress("writing", NULL, 1))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = eco_points_write(&table, path, &bytes, &size, m->error);
	if (!code)
		code = eco_file_write(path, bytes, size, m->error);
	free(bytes);
	return code;
}
