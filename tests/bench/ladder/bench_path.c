/* Geometry saved against Cook along a camera path through 1,276 trees, frame by frame (Neubert 2011, section
 * 5 and table 2).
 *
 * Each plant in view stands at a distance d, over the greatest of any plant from the path. Cook draws (1 -
 * d)^2 of its foliage; ours what its species needs for the same Q there (bench_species.h). The frame's saving
 * is over the vertices of all plants in view. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/view.h"
#include "tests/bench/ladder/bench_species.h"

#define SCENE "trees1276"
#define SPECIES_MAX 32u
#define TREES_MAX 2000u
#define FRAMES 240u
#define FRAMES_QUICK 60u

struct species { char name[32]; struct bench_savings savings; };
struct tree { double at[3], height; const struct bench_savings *savings; };
struct path {
	struct species species[SPECIES_MAX];
	uint32_t species_count, tree_count, frame_count;
	struct tree trees[TREES_MAX];
	struct eco_request frames[FRAMES];
	double farthest;
};

/* ---- The scene's folder ---- */

static void read_species(struct bench *bench, struct path *p, const json_t *scene)
{
	const char *key;
	json_t *plant, *plants = json_object_get(scene, "plants");
	json_object_foreach(plants, key, plant) {
		const char *model = json_string_value(json_object_get(plant, "model"));
		struct bench_model file = { .generated = true };
		if (!model || p->species_count == SPECIES_MAX)
			continue;
		bench_progress((double)p->species_count / (double)json_object_size(plants), key);
		struct species *s = &p->species[p->species_count++];
		snprintf(s->name, sizeof s->name, "%s", key);
		snprintf(file.path, sizeof file.path, "%.200s/scenes/" SCENE "/%.200s", bench->cache, model);
		bench_savings_of(bench, &s->savings, &file);
	}
}

/* Lines plant,easting,northing,height_m. */
static void read_trees(struct path *p, const char *path, const json_t *origin)
{
	char line[256], name[32];
	FILE *file = fopen(path, "r");
	while (file && p->tree_count < TREES_MAX && fgets(line, sizeof line, file)) {
		struct tree *tree = &p->trees[p->tree_count];
		uint32_t i = 0;
		if (sscanf(line, "%31[^,],%lf,%lf,%lf", name, &tree->at[0], &tree->at[1], &tree->height) != 4)
			continue;
		while (i < p->species_count && strcmp(p->species[i].name, name))
			i++;
		tree->at[0] -= bench_cell(origin, 0);
		tree->at[1] -= bench_cell(origin, 1);
		tree->at[2] = tree->height / 2;
		tree->savings = &p->species[i].savings;
		p->tree_count += i < p->species_count && tree->savings->elements >= BENCH_ELEMENTS_LEAST;
	}
	if (file)
		fclose(file);
	if (!p->tree_count)
		must(eco_fail(must_error, ECO_BAD_INPUT, "%s: no tree of a species with %u leaves or more",
		path, BENCH_ELEMENTS_LEAST));
}

static void read_path(struct bench *bench, struct path *p)
{
	char path[1024];
	p->frame_count = bench_scene_views(bench, SCENE, p->frames, bench->full ? FRAMES : FRAMES_QUICK);
	snprintf(path, sizeof path, "%s/scenes/" SCENE "/scene.json", bench->cache);
	json_t *scene = json_load_file(path, 0, NULL);
	if (!p->frame_count || !scene)
		must(eco_fail(must_error, ECO_IO, "%s: no scene or no camera path", path));
	read_species(bench, p, scene);
	snprintf(path, sizeof path, "%s/scenes/" SCENE "/plants.csv", bench->cache);
	read_trees(p, path, json_object_get(scene, "origin"));
	json_decref(scene);
}

/* ---- Frames ---- */

static double distance_of(const struct tree *tree, const struct eco_view *view)
{
	return hypot(hypot(tree->at[0] - view->eye[0], tree->at[1] - view->eye[1]), tree->at[2]
		- view->eye[2]);
}

/* Whether the ball around the tree reaches into the cone around the picture. */
static bool in_view(const struct tree *tree, const struct eco_view *view)
{
	double along = 0, length = 0, away = distance_of(tree, view),
		tangent = tan(view->fov_y_deg * M_PI / 360);
	double cone = atan(tangent * hypot(1, (double)view->width / view->height));
	for (int a = 0; a < 3; a++) {
		double forward = view->target[a] - view->eye[a];
		along += forward * (tree->at[a] - view->eye[a]);
		length += forward * forward;
	}
	if (away <= tree->height / 2)
		return true;
	double cosine = along / (sqrt(length) * away);
	return acos(fmax(-1, fmin(1, cosine))) - asin(tree->height / 2 / away) < cone;
}

/* lambda of the order over Cook's, between the distances of the table that is finer there. */
static double ratio_at(const struct bench_savings *s, enum bench_order order, double d)
{
	enum bench_spacing spacing = d < bench_distance(BENCH_NEAR, BENCH_DISTANCES / 2) ? BENCH_NEAR
		: BENCH_EVEN;
	const double *ratio = s->ratio[order][spacing];
	uint32_t i = 0;
	while (i + 2 < BENCH_DISTANCES && bench_distance(spacing, i + 1) < d)
		i++;
	double low = bench_distance(spacing, i),
		t = fmin(1, fmax(0, (d - low) / (bench_distance(spacing, i + 1) - low)));
	return (1 - t) * ratio[i] + t * ratio[i + 1];
}

/* NaN where no tree is in view. */
static double saving_of(const struct path *p, const struct eco_view *view, enum bench_order order)
{
	double ours = 0, cook = 0;
	for (const struct tree *tree = p->trees; tree < p->trees + p->tree_count; tree++) {
		double d = distance_of(tree, view) / p->farthest, vertices = (1 - d) * (1
			- d) * tree->savings->vertices;
		if (!in_view(tree, view))
			continue;
		cook += vertices;
		ours += vertices * ratio_at(tree->savings, order, d);
	}
	return cook > 0 ? 1 - ours / cook : NAN;
}

/* Means, least and most of all frames. */
static void write_frames(struct bench *bench, const struct path *p)
{
	static const char *const printed[BENCH_ORDERS] = { "10.1,4.3,43.7", "17.4,2.2,23.6",
		"40.7,30.8,69.3", "-,-,-", "30.1,1.4,39.2", "-,-,-", "-,-,-", "-,-,-", "-,-,-" };
	static double x[FRAMES], y[BENCH_ORDERS][FRAMES];
	struct bench_series series[BENCH_ORDERS];
	struct bench_table *table = bench_table_open(bench, "path",
		"order (each with its best scale),mean %,least %,most "
		"%,Neubert 2011: mean %,Neubert 2011: least %,Neubert 2011: most %", true);
	for (int m = 0; m < BENCH_ORDERS; m++) {
		double least = INFINITY, most = -INFINITY, sum = 0;
		uint32_t counted = 0;
		for (uint32_t f = 0; f < p->frame_count; f++) {
			double saved = 100 * saving_of(p, &p->frames[f].view, (enum bench_order)m);
			x[f] = f;
			y[m][f] = saved;
			least = fmin(least, saved);
			most = fmax(most, saved);
			sum += isnan(saved) ? 0 : saved;
			counted += !isnan(saved);
		}
		bench_table_row(table, "%s,%.1f,%.1f,%.1f,%s", bench_order_names[m],
			counted ? sum / counted : NAN, least, most, printed[m]);
		series[m] = (struct bench_series){ bench_order_names[m], x, y[m], p->frame_count, false };
	}
	bench_table_close(table);
	bench_say(bench, "The paper's trees and path are not to be had, and it does not say by what its "
		"distances are divided. Rows differ from the printed ones as those of the species do; and "
		"here a frame's saving is over vertices: near trees have most, Cook draws nearly all of "
		"them, and little can be saved at equal Q.");
	bench_plot(bench, &(struct bench_plot){ .name = "path", .title =
		"1,276 trees: geometry saved against Cook at equal Q", .x = "frame", .y = "saved, %",
		.series = series, .series_count = BENCH_ORDERS });
}

static void run(struct bench *bench)
{
	static struct path p;
	memset(&p, 0, sizeof p);
	read_path(bench, &p);
	for (uint32_t f = 0; f < p.frame_count; f++)
		for (uint32_t i = 0; i < p.tree_count; i++)
			p.farthest = fmax(p.farthest, distance_of(&p.trees[i], &p.frames[f].view));
	bench_say(bench, "%u trees of %u species, %u frames. Distances are over %.0f m, the greatest "
		"between a tree and the path; what Q asks of a species comes from pictures of it alone, "
		"from views that no order or scale was made with.", p.tree_count, p.species_count,
		p.frame_count, p.farthest);
	write_frames(bench, &p);
}

const struct bench_section bench_path = { "path", "Geometry saved along a path through 1,276 trees", run };
