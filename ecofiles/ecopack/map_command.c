/* ecopack map: shows where everything stands, before hours are spent on building. Reads a scene's
 * inventories as `ecopack make` does, so that a wrong column, zone or species map is seen at once, and so
 * are the rows left out. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/order.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/map.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/import/ground/ground_image_import.h"
#include "ecofiles/import/places/gis_files.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
#define SQUARES_MAX 1024u        /* of the ground's image, no finer than the map's pixels */
#define STRAY_SHARE 0.002        /* this share at each end may lie off the picture ... */
#define STRAY_FACTOR 5.0         /* ... if the picture can then be this much larger */

/* ---- The picture's view ---- */

ECO_ORDER(by_double, double, [0])

/* Bounds without the outermost plants, where that changes much: one place without its latitude must not
 * shrink a city to a dot. */
static void leave_strays(struct map *m, struct map_bounds *b)
{
	uint64_t stride = m->points.count / 200000 + 1, count = (m->points.count + stride - 1) / stride;
	double *sorted = eco_alloc(count, sizeof *sorted);
	struct map_bounds core = *b;
	for (int k = 0; k < 2; k++) {
		for (uint64_t i = 0; i < count; i++)
			sorted[i] =
				(double)(k ? m->points.items[i * stride].y : m->points.items[i * stride].x);
		qsort(sorted, count, sizeof *sorted, by_double);
		uint64_t few = (uint64_t)(STRAY_SHARE * (double)count + 0.999);
		if (count < 20)
			few = 0;
		core.low[k] = sorted[few];
		core.high[k] = sorted[count - 1 - few];
		double spare = 0.2 * (core.high[k] - core.low[k]);
		core.low[k] = fmax(core.low[k] - spare, b->low[k]);
		core.high[k] = fmin(core.high[k] + spare, b->high[k]);
	}
	free(sorted);
	double whole = fmax(b->high[0] - b->low[0], b->high[1] - b->low[1]),
		inner = fmax(core.high[0] - core.low[0], core.high[1] - core.low[1]);
	if (inner > 0 && whole > STRAY_FACTOR * inner)
		*b = core;
}

static void find_bounds(struct map *m, struct map_bounds *b)
{
	*b = MAP_NOTHING;
	for (uint64_t i = 0; i < m->points.count; i++)
		map_extend(b, (double)m->points.items[i].x, (double)m->points.items[i].y);
	if (m->points.count)
		leave_strays(m, b);
	for (uint32_t i = 0; i < m->outline_count; i++)
		for (int k = 0; k < 4; k++)
			map_extend(b, m->outlines[i].corners[2 * k], m->outlines[i].corners[2 * k + 1]);
	for (uint32_t i = 0; i < 2 * m->areas.count; i++)
		map_extend(b, m->areas.ends[2 * (size_t)i], m->areas.ends[2 * (size_t)i + 1]);
	if (m->has_ground && map_is_empty(b)) {
		const struct eco_ground *g = &m->ground;
		map_extend(b, g->x_m, g->y_m);
		map_extend(b, g->x_m + (g->columns - 1) * g->step_x_m, g->y_m + (g->rows - 1) * g->step_y_m);
	}
}

static void find_frame(struct map *m, uint32_t pixels)
{
	struct map_bounds b;
	find_bounds(m, &b);
	if (map_is_empty(&b))
		eco_stop(ECO_BAD_INPUT, "%s: there is nothing to show: no plant has a usable place (what was left out: see "
			"\"instances\")", m->sources.items[0].path);
	double side = fmax(fmax(b.high[0] - b.low[0], b.high[1] - b.low[1]), 1), spare = 0.03 * side;
	for (int k = 0; k < 2; k++) {            /* neither side is less than a third of the other */
		double middle = (b.low[k] + b.high[k]) / 2, half = fmax((b.high[k] - b.low[k]) / 2, side / 6)
			+ spare;
		m->view.low[k] = middle - half;
		m->view.high[k] = middle + half;
	}
	m->scale = pixels / (side + 2 * spare);
	m->width = floor((m->view.high[0] - m->view.low[0]) * m->scale);
	m->height = floor((m->view.high[1] - m->view.low[1]) * m->scale);
}

/* ---- The ground's image: squares as make reads them ---- */

struct picture {
	const struct map *m;
	struct eco_ground_image_reader *reader;
	uint8_t *rgba, *square;      /* the map's pixels; a square's texels */
};

/* The texels under the middles of the map's pixels. */
static void paint(const struct picture *p, const struct eco_list *list)
{
	const struct map *m = p->m;
	uint32_t width = (uint32_t)m->width, height = (uint32_t)m->height;
	double texel_m = list->grid_step[0];
	for (uint32_t y = 0; y < height; y++) {
		double north = m->view.high[1] - (y + 0.5) / m->scale,
			row = SIDE - (north - list->grid_origin[1]) / texel_m;
		if (!(row >= 0 && row < SIDE))
			continue;
		for (uint32_t x = 0; x < width; x++) {
			double east = m->view.low[0] + (x + 0.5) / m->scale,
				column = (east - list->grid_origin[0]) / texel_m;
			if (column >= 0 && column < SIDE)
				memcpy(p->rgba + 4 * ((size_t)y * width + x),
					p->square + 4 * ((size_t)row * SIDE + (size_t)column), 4);
		}
	}
}

static void read_square(const struct picture *p, struct eco_list list, bool is_root)
{
	struct eco_ground_image_tile tile = { .rgba = p->square };
	eco_check(eco_ground_image_next(p->reader, &tile, p->m->error));
	if (is_root) {
		memcpy(list.grid_origin, tile.low, sizeof tile.low);
		list.grid_step[0] = list.grid_step[1] = tile.texel_m;
	}
	for (uint32_t q = 0; q < 4 && tile.split; q++) {
		struct eco_list quarter = list;
		eco_ground_image_quarter(&quarter, q);
		read_square(p, quarter, false);
	}
	if (!tile.split)
		paint(p, &list);
}

static void read_squares(void *picture)
{
	read_square(picture, (struct eco_list){ .kind = ECO_LIST_GROUND_IMAGE }, true);
}

static void read_image(struct map *m)
{
	const struct eco_source *source = &m->sources.items[0];
	struct eco_ground_image_source image = source->ground_image;
	struct eco_ground_image_options options = { .source = &image, .scene_crs = source->crs,
		.origin = { source->origin[0], source->origin[1], source->origin[2] },
		.low = { m->bounds[0].low[0], m->bounds[0].low[1] },
		.high = { m->bounds[0].high[0], m->bounds[0].high[1] }, .tiles_max = SQUARES_MAX,
		.warn = main_note_text };
	struct eco_error missed = { .code = ECO_OK }, *error = m->error;
	struct eco_frame frame = eco_source_frame(source);
	struct eco_drawing *drawing = NULL;
	if (source->draw_count)
		eco_check(eco_drawing_open(&drawing, source->draws, source->draw_count, &frame, error));
	options.drawing = eco_drawing_ground(drawing);
	if (!image.file_count && !options.drawing) {
		eco_drawing_close(drawing);
		return;
	}
	main_progress("drawing", "the ground's image", 0.1);
	image.texel_m = image.texel_m > 1 / m->scale ? image.texel_m : 1 / m->scale;
	struct picture p = { .m = m, .rgba = eco_alloc((size_t)m->width * (size_t)m->height, 4),
		.square = eco_alloc(1, ECO_GROUND_IMAGE_BYTES) };
	m->image = p.rgba;
	eco_check(eco_ground_image_open(&p.reader, &options, error));
	m->error = &missed;              /* what the child says comes first */
	enum eco_code code = eco_try(read_squares, &p, &missed);
	m->error = error;
	eco_check(eco_ground_image_close(p.reader, error));
	if (code)
		eco_stop(code, "%s", missed.text);
	free(p.square);
	eco_drawing_close(drawing);
}

/* ---- The picture ---- */

static void write_picture(void *map)
{
	struct map *m = map;
	const struct eco_cairo_module *cairo = eco_module(ECO_MODULE_CAIRO, m->error);
	uint8_t *png = NULL;
	size_t size = 0;
	if (!cairo)
		eco_check(ECO_NOT_FOUND);
	find_frame(m, m->pixels);
	read_image(m);
	main_progress("drawing", NULL, 0.2);
	eco_check(cairo->map_png(m, &png, &size));
	main_progress("writing", NULL, 1);
	eco_check(eco_file_write(m->output, png, size, m->error));
	free(png);
}

enum eco_code map_write(struct map *m, const char *path, uint32_t pixels)
{
	m->output = path;
	m->pixels = pixels;
	return eco_try(write_picture, m, m->error);
}

/* ---- The table ---- */

static void point_of(void *ctx, uint64_t index, struct eco_point *out)
{
	const struct map *m = ctx;
	const struct map_point *p = &m->points.items[index];
	const double *origin = m->sources.items[0].origin;
	*out = (struct eco_point){ { origin[0] + (double)p->x, origin[1] + (double)p->y },
		m->species.items[p->species], m->kinds[p->kind].name, p->row ? m->files[p->file] : "",
		p->class ? m->tints.classes[p->class - 1].name : "",
		(double)p->height_m, (double)p->crown_m, p->row, p->line };
}

struct shapes { struct eco_shape *items; uint64_t count; uint32_t capacity; };

static void add_shape(struct shapes *s, const struct eco_areas *areas, uint32_t area, struct eco_shape shape)
{
	eco_grow(&s->items, &s->capacity, (uint32_t)s->count, sizeof *s->items);
	shape.ends = areas->edges[areas->items[area].edge_first].a;
	shape.ring_edges = areas->items[area].ring_edges;
	shape.edge_count = areas->items[area].edge_count;
	s->items[s->count++] = shape;
}

/* Buildings and what is drawn on the ground of the outermost file; `footprints`: as many as it has. */
static void add_shapes(struct map *m, struct shapes *s, struct eco_footprints *footprints, struct eco_drawing **drawing)
{
	const struct eco_source *outer = &m->sources.items[0];
	struct eco_frame frame = eco_source_frame(outer);
	const struct eco_areas *areas;
	const struct eco_draw_spec *spec;
	const char *class;
	uint32_t area;
	if (outer->draw_count)
		eco_check(eco_drawing_open(drawing, outer->draws, outer->draw_count, &frame, m->error));
	for (uint32_t i = 0; eco_drawing_feature(*drawing, i, &areas, &area, &class, &spec); i++)
		add_shape(s, areas, area, (struct eco_shape){ .object = "ground", .class = class, .file = spec->path });
	for (uint32_t f = 0; f < outer->footprints_count; f++) {
		eco_check(eco_footprints_read(&footprints[f], &outer->footprints[f], &frame, m->error));
		for (uint32_t i = 0; i < footprints[f].areas.count; i++)
			add_shape(s, &footprints[f].areas, i, (struct eco_shape){ .object = "building", .class = "",
				.file = outer->footprints[f].path, .height_m = footprints[f].items[i].height_m });
	}
}

/* Writes all plants that were gathered as a table with points, and buildings and ground (gis_files.h). */
static void write_table(struct map *m, const char *path)
{
	const struct eco_source *outer = &m->sources.items[0];
	struct shapes shapes = { .count = 0 };
	struct eco_footprints *footprints = eco_alloc(outer->footprints_count + 1u, sizeof *footprints);
	struct eco_drawing *drawing = NULL;
	add_shapes(m, &shapes, footprints, &drawing);
	struct eco_point_table table = { .name = "plants", .crs = outer->crs, .count = m->points.count,
		.has_classes = m->tints.class_count > 0,
		.point = point_of, .ctx = m, .shapes = shapes.items, .shape_count = shapes.count,
		.origin = { outer->origin[0], outer->origin[1] } };
	uint8_t *bytes = NULL;
	size_t size = 0;
	if (m->not_expanded)
		eco_stop(ECO_TOO_LARGE, "%s: nested files place %llu plants, more than a table takes one by one; write the "
			"tables of the nested files", path, (unsigned long long)m->not_expanded);
	main_progress("writing", NULL, 1);
	eco_check(eco_points_write(&table, path, &bytes, &size, m->error));
	eco_check(eco_file_write(path, bytes, size, m->error));
	free(bytes);
	free(shapes.items);
	for (uint32_t f = 0; f < outer->footprints_count; f++)
		eco_footprints_free(&footprints[f]);
	free(footprints);
	eco_drawing_close(drawing);
}

/* ---- The command ---- */

/* Whether a PNG may be written at `path`: its folder exists, and the path is free, a PNG or an empty file. */
static void may_write(const char *path, struct eco_error *error)
{
	static const uint8_t png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
	const char *last = eco_path_last(path), *dot = strrchr(last, '.');
	uint8_t start[8];
	char folder[4096];
	struct stat status;
	bool there = stat(path, &status) == 0;
	if (!there && dot && strcasecmp(dot, ".png") != 0)
		eco_stop(ECO_BAD_USAGE, "%.350s: pictures are PNG, so let its name end in .png (ecopack map also writes "
			".gpkg and .geojson)", path);
	int fd = there && S_ISREG(status.st_mode) ? open(path, O_RDONLY | O_CLOEXEC) : -1;
	ssize_t got = fd >= 0 ? read(fd, start, sizeof start) : -1;
	if (fd >= 0)
		close(fd);
	if (there && got != 0 && (got != 8 || memcmp(start, png, 8) != 0))
		eco_stop(ECO_BAD_INPUT, "%.400s exists and is not a PNG; it is kept. Take another "
			"name", path);
	snprintf(folder, sizeof folder, "%.*s", last == path ? 1 : (int)(last - path),
		last == path ? "." : path);
	if (access(folder, W_OK | X_OK) != 0)
		eco_check(eco_fail_write(error, path, errno));
}

/* Prints the legend's content to a terminal. */
static void print_map(const struct map *m, const char *path)
{
	char range[32];
	printf("%s: %" PRIu64 " plant%s\n", path, m->total, m->total == 1 ? "" : "s");
	for (uint32_t i = 0; i < m->kind_count; i++)
		printf("  %-24s %10" PRIu64 "  %s\n", m->kinds[i].name, m->kinds[i].count,
			map_range_text(&m->kinds[i], range));
	for (uint32_t i = 0; i < m->tints.class_count; i++)
		printf("  %s: %-*s %10" PRIu64 "\n", m->tints.classes[i].column, (int)(22 - strlen(m->tints.classes[i].column)),
			m->tints.classes[i].name, m->tints.classes[i].plants);
	if (m->outside)
		printf("%" PRIu64 " stand outside the picture, far from the rest\n", m->outside);
	if (m->off_ground)
		printf("%" PRIu64 " stand beyond the ground's border\n", m->off_ground);
}

static struct { const char *scene, *output; uint64_t pixels; } given;

static void write_given(void *map)
{
	struct map *m = map;
	bool table = eco_points_knows(given.output);
	if (table && access(given.output, F_OK) == 0)
		eco_stop(ECO_BAD_USAGE, "%s exists, perhaps as an inventory; it is kept. Take another name",
			given.output);
	if (!table)
		may_write(given.output, m->error);
	eco_check(map_gather(m, given.scene));
	if (table)
		write_table(m, given.output);
	else
		eco_check(map_write(m, given.output, (uint32_t)given.pixels));
}

static enum eco_code run_map(int argc, char **argv, struct eco_error *error)
{
	struct map m = { .error = error };
	memset(&given, 0, sizeof given);
	given.pixels = 1200;
	enum eco_code code = main_read(&main_command_map, argc, argv, error);
	code = code ? code : eco_try(write_given, &m, error);
	main_progress_end();
	if (!code && !main_is_quiet)
		print_map(&m, given.output);
	map_free(&m);
	return code;
}

static const struct eco_option options[] = {
	{ "the scene file", 0, ECO_OPTION_INPUT, "SCENE.json", .value = &given.scene, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "MAP", .value = &given.output, .is_required = true },
	{ "size", 0, ECO_OPTION_COUNT, "PX", .value = &given.pixels, 200, 8000 }, { 0 }
};

const struct main_command main_command_map = { { "ecopack map",
	"SCENE.json -o MAP.png|MAP.gpkg|MAP.geojson [--size PX]",
	"Draws the positions of all plants without building models, and reports the rows that were left out.",
	options,
	main_common, NULL, NULL }, run_map };
