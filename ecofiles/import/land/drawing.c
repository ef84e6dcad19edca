#include "ecofiles/import/land/drawing_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "build/words/ground.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/words.h"

#define CLASSES (sizeof ground_rows / sizeof *ground_rows)
#define TEXEL_M 0.25         /* of the picture: a path has five */
#define WATER 0.988          /* cover of water: alpha ECO_GROUND_WATER */
#define FAR_M 4e6            /* from the origin the picture ends: one line across a continent spoils no scene */

/* ---- Classes ---- */

static bool is_of(uint32_t class, const char *kind) { return strcmp(ground_rows[class].of, kind) == 0; }

bool eco_land_class(uint32_t i, struct eco_land_class *class)
{
	if (i >= CLASSES)
		return false;
	const struct ground_row *row = &ground_rows[i];
	*class = (struct eco_land_class){ row->name, strcmp(row->plants, "none") ? row->plants : "", row->spacing,
		is_of(i, "line"), row->level > 0 };
	return true;
}

uint32_t eco_land_class_named(const char *name)
{
	for (uint32_t i = 0; i < CLASSES; i++)
		if (strcmp(ground_rows[i].name, name) == 0 && !is_of(i, "surface"))
			return i;
	return ECO_NONE;
}

uint32_t eco_land_class_told(const char *text, bool line)
{
	for (uint32_t i = 0; i < CLASSES; i++)
		if (is_of(i, line ? "line" : "area") && ground_rows[i].level > 0 && eco_words_any(text, ground_rows[i].words))
			return i;
	return ECO_NONE;
}

/* value "": the text has a word of the class; "*": any text but "no". */
struct eco_land_test { uint32_t class, column; char value[32]; };

static void add_test(struct eco_land_reader *r, uint32_t class, uint32_t column, const char *value, size_t bytes)
{
	eco_grow(&r->tests, &r->capacity, r->count, sizeof *r->tests);
	struct eco_land_test *test = &r->tests[r->count++];
	*test = (struct eco_land_test){ .class = class, .column = column };
	snprintf(test->value, sizeof test->value, "%.*s", (int)bytes, value);
}

/* Tags come before words. */
void eco_land_reader_open(struct eco_land_reader *r, char *const *columns, uint32_t count)
{
	const char *land = eco_words_set("land");
	*r = (struct eco_land_reader){ .tests = NULL };
	for (uint32_t class = 0; class < CLASSES; class++)
		for (const char *at = ground_rows[class].tags; *at;) {
			size_t key = strcspn(at, "= "), whole = strcspn(at, " ");
			for (uint32_t i = 0; i < count && key < whole; i++)
				if (strlen(columns[i]) == key && strncasecmp(columns[i], at, key) == 0)
					add_test(r, class, i, at + key + 1, whole - key - 1);
			at += whole + (at[whole] == ' ');
		}
	for (uint32_t class = 0; class < CLASSES; class++)
		for (uint32_t i = 0; i < count; i++)
			if (strcmp(ground_rows[class].words, "none") != 0 && eco_words_any(columns[i], land))
				add_test(r, class, i, "", 0);
}

void eco_land_reader_close(struct eco_land_reader *r) { free(r->tests); }

static bool passes(const struct eco_land_test *test, const char *text)
{
	if (!*test->value)
		return eco_words_any(text, ground_rows[test->class].words);
	return strcmp(test->value, "*") == 0 ? strcasecmp(text, "no") != 0 : strcasecmp(text, test->value) == 0;
}

/* The first class of that kind, or of any. */
static uint32_t class_of(const struct eco_land_reader *r, const char *const *fields, uint32_t count, const char *kind,
	uint32_t *column)
{
	for (uint32_t i = 0; i < r->count; i++) {
		const struct eco_land_test *test = &r->tests[i];
		const char *of = ground_rows[test->class].of, *text = test->column < count ? fields[test->column] : "";
		bool any = strcmp(of, "any") == 0 && strcmp(kind, "surface") != 0;
		if ((strcmp(of, kind) == 0 || any) && !eco_text_is_missing(text) && passes(test, text)) {
			*column = test->column;
			return test->class;
		}
	}
	return ECO_NONE;
}

uint32_t eco_land_class_of(const struct eco_land_reader *reader, const char *const *fields, uint32_t field_count, bool line,
	uint32_t *column)
{
	uint32_t own;
	return class_of(reader, fields, field_count, line ? "line" : "area", column ? column : &own);
}

/* ---- Features ---- */

struct reading { struct drawn_file *file; struct eco_land_reader reader; bool open; };

static bool is_water(uint32_t class) { return ground_rows[class].cover == WATER; }

static void set_color(struct drawn *item, uint32_t class)
{
	unsigned long color = strtoul(ground_rows[class].color + 1, NULL, 16);
	for (int k = 0; k < 3; k++)
		item->rgb[k] = (uint8_t)(color >> (16 - 8 * k));
	item->cover = (float)ground_rows[class].cover;
}

static float width_of(struct drawn_file *file, const struct drawn *item, const char *text)
{
	double number = file->spec->width_m, unit_m = 0, usual = ground_rows[item->class].width;
	if (!text || eco_text_is_missing(text))
		return (float)(number > 0 ? number : usual);
	enum eco_size_form form = eco_text_size(text, '.', &number, &unit_m);
	number *= unit_m > 0 ? unit_m : 1;
	if (form != ECO_FORM_NONE && form != ECO_FORM_STEMS && number > 0 && number <= ECO_DRAWN_WIDE_M)
		return (float)number;
	if (file->odd.count++ == 0)
		eco_phrase_cut(file->odd.example, sizeof file->odd.example,
			snprintf(file->odd.example, sizeof file->odd.example, "%s", text));
	return (float)usual;
}

/* A point is an edge without a length, and not drawn. */
static bool is_line(const struct eco_areas *areas, const struct eco_area *area)
{
	const struct eco_edge *e = areas->edges + area->edge_first;
	return area->edge_count > 1 || e->a[0] != e->b[0] || e->a[1] != e->b[1];
}

static bool take(void *ctx, uint32_t index, const struct eco_rows *rows, const char *const *texts)
{
	struct reading *r = ctx;
	struct drawn_file *file = r->file;
	const struct eco_area *area = &file->areas.items[index];
	const bool line = area->ring_edges == 0;
	uint32_t column, surface;
	struct drawn item = { .class = ECO_NONE };
	if (line && !is_line(&file->areas, area))
		return false;
	if (!r->open)
		eco_land_reader_open(&r->reader, rows->columns, rows->column_count);
	r->open = true;
	item.class = file->spec->class ? eco_land_class_named(file->spec->class)
		: eco_land_class_of(&r->reader, rows->fields, rows->field_count, line, &column);
	file->unknown += item.class == ECO_NONE;
	if (item.class == ECO_NONE || !(ground_rows[item.class].level > 0))
		return false;
	set_color(&item, item.class);
	if (line) {
		item.width_m = width_of(file, &item, texts[0]);
		surface = class_of(&r->reader, rows->fields, rows->field_count, "surface", &column);
		if (surface != ECO_NONE)
			set_color(&item, surface);
		if (!(item.width_m > 0) && item.class != eco_land_class_named("coastline"))
			return file->thin++, false;
	}
	file->areas.near_m = fmax(file->areas.near_m, 0.01 + (double)item.width_m / 2);
	eco_grow(&file->items, &file->capacity, index, sizeof *file->items);
	file->items[index] = item;
	return true;
}

static enum eco_code read_file(struct drawn_file *file, const struct eco_frame *frame, struct eco_error *error)
{
	const struct eco_draw_spec *spec = file->spec;
	struct reading r = { .file = file };
	const char *width = spec->width;
	file->report.refused = "points, of no class that is drawn, or lines without a width";
	enum eco_code code = eco_areas_read(&file->areas,
		&(struct eco_areas_request){ .path = spec->path, .layer = spec->layer, .crs = spec->crs, .filters = spec->filters,
			.filter_count = spec->filter_count, .columns = &width, .column_count = 1, .take = take, .ctx = &r,
			.surfaces = true, .lines = true }, frame, &file->report, error);
	eco_land_reader_close(&r.reader);
	return code;
}

/* ---- The whole ---- */

static int by_level(const void *a, const void *b, void *ctx)
{
	const struct drawn_order *p = a, *q = b;
	const struct drawn_file *files = ctx;
	const struct drawn *x = &files[p->file].items[p->area], *y = &files[q->file].items[q->area];
	const struct eco_area *i = &files[p->file].areas.items[p->area], *j = &files[q->file].areas.items[q->area];
	double low = ground_rows[x->class].level, high = ground_rows[y->class].level;
	if (low != high)
		return low < high ? -1 : 1;
	if (i->size_m2 != j->size_m2)        /* a small one lies upon a large one */
		return i->size_m2 > j->size_m2 ? -1 : 1;
	return p->file != q->file ? (p->file > q->file) - (p->file < q->file) : (p->area > q->area) - (p->area < q->area);
}

static bool touches(const void *drawing, const double low[2], const double high[2])
{
	const struct eco_drawing *d = drawing;
	for (uint32_t i = 0; i < d->file_count; i++)
		if (eco_areas_near_box(&d->files[i].areas, low, high))
			return true;
	return false;
}

static enum eco_code paint(const void *drawing, const double low[2], double texel_m, uint8_t *rgba, struct eco_error *error)
{
	const struct eco_cairo_module *cairo = eco_module(ECO_MODULE_CAIRO, error);
	return cairo ? cairo->drawing_paint(drawing, low, texel_m, rgba, error) : ECO_NOT_FOUND;
}

static void gather(struct eco_drawing *d)
{
	struct eco_ground_drawing *g = &d->ground;
	uint64_t total = 0;
	const uint32_t coast = eco_land_class_named("coastline");
	*g = (struct eco_ground_drawing){ .texel_m = TEXEL_M, .touches = touches, .paint = paint, .ctx = d,
		.low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY } };
	for (uint32_t i = 0; i < d->file_count; i++)
		total += d->files[i].areas.count;
	d->order = eco_alloc(total + 1, sizeof *d->order);
	for (uint32_t i = 0; i < d->file_count; i++)
		for (uint32_t k = 0; k < d->files[i].areas.count; k++) {
			if (d->files[i].items[k].class == coast)
				continue;
			const struct eco_area *area = &d->files[i].areas.items[k];
			d->order[d->count++] = (struct drawn_order){ i, k };
			for (int axis = 0; axis < 2; axis++) {
				g->low[axis] = fmin(g->low[axis], fmax(-FAR_M, area->low[axis] - ECO_DRAWN_WIDE_M / 2));
				g->high[axis] = fmax(g->high[axis], fmin(FAR_M, area->high[axis] + ECO_DRAWN_WIDE_M / 2));
			}
		}
	qsort_r(d->order, d->count, sizeof *d->order, by_level, d->files);
}

static enum eco_code add_sea(struct eco_drawing *d, struct eco_error *error)
{
	const uint32_t coast = eco_land_class_named("coastline");
	const struct drawn_file *with = NULL;
	for (uint32_t i = 0; i < d->file_count; i++)
		for (uint32_t k = 0; k < d->files[i].areas.count && !with; k++)
			with = d->files[i].items[k].class == coast ? &d->files[i] : NULL;
	if (!with)
		return ECO_OK;
	struct drawn_file *sea = &d->files[d->file_count++];
	sea->spec = with->spec;
	sea->items = eco_alloc(1, sizeof *sea->items);
	sea->items[0].class = eco_land_class_named("sea");
	set_color(sea->items, sea->items[0].class);
	d->has_sea = true;
	return drawing_sea(sea, d->files, d->file_count - 1, coast, &d->gap, error);
}

enum eco_code eco_drawing_open(struct eco_drawing **drawing, const struct eco_draw_spec *specs, uint32_t count,
	const struct eco_frame *frame, struct eco_error *error)
{
	struct eco_drawing *d = *drawing = eco_alloc(1, sizeof *d);
	enum eco_code code = ECO_OK;
	d->files = eco_alloc(count + 2u, sizeof *d->files);
	for (; d->file_count < count && !code; d->file_count++) {
		d->files[d->file_count].spec = &specs[d->file_count];
		code = read_file(&d->files[d->file_count], frame, error);
	}
	code = code ? code : add_sea(d, error);
	if (!code)
		gather(d);
	if (code) {
		eco_drawing_close(d);
		*drawing = NULL;
	}
	return code;
}

const struct eco_ground_drawing *eco_drawing_ground(const struct eco_drawing *d)
{
	return d && d->count ? &d->ground : NULL;
}

bool eco_drawing_feature(const struct eco_drawing *d, uint32_t i, const struct eco_areas **areas, uint32_t *area,
	const char **class, const struct eco_draw_spec **spec)
{
	if (!d || i >= d->count)
		return false;
	const struct drawn_file *file = &d->files[d->order[i].file];
	*areas = &file->areas;
	*area = d->order[i].area;
	*class = ground_rows[file->items[*area].class].name;
	*spec = file->spec;
	return true;
}

bool eco_drawing_class(const struct eco_drawing *d, uint32_t i, const char **name, uint8_t rgb[3], uint64_t *features)
{
	struct drawn look;
	if (!d || i >= CLASSES)
		return false;
	set_color(&look, i);
	*name = ground_rows[i].name;
	memcpy(rgb, look.rgb, sizeof look.rgb);
	*features = 0;
	for (uint32_t k = 0; k < d->count; k++)
		*features += d->files[d->order[k].file].items[d->order[k].area].class == i;
	return true;
}

/* ---- Water ---- */

bool eco_drawing_has_water(const struct eco_drawing *d)
{
	bool water = false;
	for (uint32_t i = 0; d && i < d->count; i++)
		water |= is_water(d->files[d->order[i].file].items[d->order[i].area].class);
	return water;
}

struct samples { struct eco_ground *ground; const struct eco_areas *areas; uint32_t area; };

/* Widens `range` by the samples below an area, or sets them where level is no NaN; how many there are. */
static uint64_t each_sample(const struct samples *s, double range[2], double level)
{
	struct eco_ground *g = s->ground;
	const struct eco_area *a = &s->areas->items[s->area];
	uint64_t count = 0;
	uint32_t low[2], high[2];
	for (int k = 0; k < 2; k++) {
		double origin = k ? g->y_m : g->x_m, step = k ? g->step_y_m : g->step_x_m, most = (k ? g->rows : g->columns) - 1.0;
		low[k] = (uint32_t)fmin(fmax(ceil((a->low[k] - origin) / step), 0), most);
		high[k] = (uint32_t)fmin(fmax(floor((a->high[k] - origin) / step), 0), most);
	}
	for (uint32_t y = low[1]; y <= high[1]; y++)
		for (uint32_t x = low[0]; x <= high[0]; x++) {
			float *z = &g->height_m[(size_t)y * g->columns + x];
			if (!eco_area_holds(s->areas, s->area, g->x_m + x * g->step_x_m, g->y_m + y * g->step_y_m))
				continue;
			count++;
			range[0] = fmin(range[0], (double)*z);
			range[1] = fmax(range[1], (double)*z);
			*z = isnan(level) ? *z : (float)level;
		}
	return count;
}

void eco_drawing_level(const struct eco_drawing *d, struct eco_ground *ground, void (*say)(void *ctx, const char *text),
	void *ctx)
{
	const uint32_t water = eco_land_class_named("water");
	uint64_t still = 0, steep = 0;
	char line[200], counts[2][32];
	for (uint32_t i = 0; i < d->count; i++) {
		const struct drawn_file *file = &d->files[d->order[i].file];
		const struct samples s = { ground, &file->areas, d->order[i].area };
		double range[2] = { INFINITY, -INFINITY };
		if (file->items[s.area].class != water || file->items[s.area].width_m > 0 || !each_sample(&s, range, NAN))
			continue;
		if (range[1] - range[0] > ECO_STILL_M) {
			steep++;
			continue;
		}
		still++;
		each_sample(&s, range, range[0]);
	}
	if (!still && !steep)
		return;
	snprintf(line, sizeof line, "%s area%s of water %s level, at %s lowest; %s slope%s by more than %g m and stay%s",
		eco_phrase_count(still, counts[0]), still == 1 ? "" : "s", still == 1 ? "is" : "are", still == 1 ? "its" : "their",
		eco_phrase_count(steep, counts[1]), steep == 1 ? "s" : "", ECO_STILL_M, steep == 1 ? "s" : "");
	say(ctx, line);
}

/* ---- The report ---- */

static void say_classes(const struct drawn_file *file, void (*say)(void *ctx, const char *text), void *ctx)
{
	char line[512], all[400] = "", one[64], count[32];
	for (uint32_t class = 0; class < CLASSES; class++) {
		uint64_t features = 0;
		for (uint32_t i = 0; i < file->areas.count; i++)
			features += file->items[i].class == class;
		snprintf(one, sizeof one, "%.30s %s", ground_rows[class].name, eco_phrase_count(features, count));
		if (features)
			eco_phrase_add(all, sizeof all, one);
	}
	snprintf(line, sizeof line, "%.80s drawn: %s", file->spec->path, *all ? all : "nothing");
	say(ctx, line);
}

void eco_drawing_report(const struct eco_drawing *d, void (*say)(void *ctx, const char *text), void *ctx)
{
	char line[300], count[32];
	for (uint32_t i = 0; i < d->file_count; i++) {
		const struct drawn_file *file = &d->files[i];
		for (uint32_t k = 0; k < file->report.note_count; k++)
			say(ctx, file->report.notes[k]);
		say_classes(file, say, ctx);
		if (d->has_sea && i + 1 == d->file_count)
			say(ctx, d->gap ? "  the sea is not drawn, as its coastlines have gaps" : "  the sea lies to the right of coastlines, which go "
				"on straight where the file ends");
		eco_areas_report_say(&file->report, say, ctx);
		if (file->odd.count) {
			snprintf(line, sizeof line, "  %s widths are none between 0 and %g m (first: \"%s\"): the class's counts",
				eco_phrase_count(file->odd.count, count), ECO_DRAWN_WIDE_M, file->odd.example);
			say(ctx, line);
		}
		if (file->thin) {
			snprintf(line, sizeof line, "  %s of them are lines of a class of areas, which has no width: say \"width_m\", or a "
				"class of lines, such as \"class\": \"river\"", eco_phrase_count(file->thin, count));
			say(ctx, line);
		}
		if (file->unknown && !file->areas.count)
			say(ctx, "  none of its features has a class that is known: say one, such as \"class\": \"street\", or add words "
				"to ground.tsv");
	}
}

void eco_drawing_close(struct eco_drawing *d)
{
	for (uint32_t i = 0; d && i < d->file_count; i++) {
		eco_areas_free(&d->files[i].areas);
		eco_areas_report_free(&d->files[i].report);
		free(d->files[i].items);
	}
	if (d) {
		free(d->files);
		free(d->order);
	}
	free(d);
}
