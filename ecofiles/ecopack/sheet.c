/* ecopack sheet: a contact sheet of a pack, to see whether the import is right and what detail costs. A
 * row is a plant: facts, its organs in false colours (a leaf taken for wood is seen at once), full detail,
 * then ever fewer vertices, each picture with its vertices and its Q. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/chart.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/ecopack/sheet.h"
#include "ecofiles/base/phrase.h"

#define COLUMNS_MAX 16u
#define PAGE_HEIGHT 8000u        /* longer sheets are split into pages */
#define PAGES_MAX 1000u
#define MARGIN 24.0
#define HEAD 92.0
#define GAP 10.0
#define CAPTION 24.0
#define FACTS 260.0              /* width of the facts about a plant */
#define FACTS_HEIGHT 136.0       /* with all organs, without dropped triangles */

struct column { double share; uint64_t vertices; char title[32]; };      /* share 0: `vertices` counts */

struct sheet {
	struct eco_pack *pack;
	json_t *meta;
	struct column columns[COLUMNS_MAX]; uint32_t column_count;
	uint32_t *plants, plant_count;       /* to be drawn */
	uint32_t pixels;
	uint8_t *rgb;
	const char *output;
	struct eco_chart *chart;
	struct eco_chart_file *pages; uint32_t page_count, rows_a_page;
};

/* ---- Command line ---- */

static enum eco_code parse_column(const char *text, struct column *column, struct eco_error *error)
{
	char *end;
	double number = strtod(text, &end), below = 1;
	bool is_fraction = end != text && *end == '/';
	if (is_fraction) {
		const char *rest = end + 1;
		below = strtod(rest, &end);
		if (end == rest)
			below = NAN;
	}
	snprintf(column->title, sizeof column->title, "%.31s", text);
	column->share = number / below;
	bool is_count = !is_fraction && number > 1;
	if (is_count && number == floor(number) && number < 1e15) {
		column->share = 0;
		column->vertices = (uint64_t)number;
		char digits[32];
		snprintf(column->title, sizeof column->title, "%.20s vertices",
			eco_phrase_count(column->vertices, digits));
	} else if (end == text || *end || is_count || !(column->share > 0 && column->share <= 1))
		return eco_fail(error, ECO_BAD_USAGE, "--columns: %.40s is neither a share of all vertices "
			"such as 1/8 or 0.125, nor a number of "
			"vertices such as 3000", text);
	return ECO_OK;
}

static enum eco_code parse_columns(struct sheet *s, const char *list, struct eco_error *error)
{
	char text[512];
	if (strlen(list) >= sizeof text)
		return eco_fail(error, ECO_BAD_USAGE, "--columns: at most %u", COLUMNS_MAX);
	strcpy(text, list);
	for (char *at = text, *next; at; at = next) {
		next = strchr(at, ',');
		if (next)
			*next++ = 0;
		if (s->column_count == COLUMNS_MAX)
			return eco_fail(error, ECO_BAD_USAGE, "--columns: at most %u", COLUMNS_MAX);
		enum eco_code code = parse_column(at, &s->columns[s->column_count++], error);
		if (code)
			return code;
	}
	return ECO_OK;
}

static enum eco_code unknown_plant(const struct eco_scene *scene, const char *name, int length,
	struct eco_error *error)
{
	char known[300] = "";
	for (uint32_t i = 0; i < scene->plant_count; i++)
		eco_phrase_add(known, sizeof known, scene->plants[i].name);
	return eco_fail(error, ECO_NOT_FOUND, "--plants: the pack has no \"%.*s\"; it has: %s",
		length < 64 ? length : 64, name, known);
}

/* Chooses all plants of each name (variants share one); without names, all plants. */
static enum eco_code choose_plants(struct sheet *s, const char *names, struct eco_error *error)
{
	const struct eco_scene *scene = &s->pack->scene;
	bool *chosen = calloc(scene->plant_count + 1u, sizeof *chosen);
	s->plants = calloc(scene->plant_count + 1u, sizeof *s->plants);
	enum eco_code code = chosen && s->plants ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory");
	for (const char *at = names, *end; at && !code; at = *end ? end + 1 : NULL) {
		bool any = false;
		end = at + strcspn(at, ",");
		for (uint32_t i = 0; i < scene->plant_count; i++)
			if (strlen(scene->plants[i].name) == (size_t)(end - at)
					&& !memcmp(scene->plants[i].name, at, (size_t)(end - at)))
				any = chosen[i] = true;
		if (!any)
			code = unknown_plant(scene, at, (int)(end - at), error);
	}
	for (uint32_t i = 0; i < scene->plant_count && !code; i++)
		if (!names || chosen[i])
			s->plants[s->plant_count++] = i;
	free(chosen);
	return code || s->plant_count ? code : eco_fail(error, ECO_BAD_INPUT, "the pack has no plants");
}

/* ---- Facts about a plant ---- */

struct facts {
	json_int_t triangles_in, dropped;
	double area[ECO_ORGAN_COUNT];
	const json_t *meta;
};

static struct facts find_facts(const struct sheet *s, uint32_t number)
{
	const struct eco_scene *scene = &s->pack->scene;
	const struct eco_plant *plant = &scene->plants[number];
	struct facts facts = { .meta = json_array_get(json_object_get(s->meta, "plants"), number) };
	const char *key;
	json_t *value, *organs = json_object_get(facts.meta, "organs");
	facts.triangles_in = json_integer_value(json_object_get(facts.meta, "triangles_in"));
	json_object_foreach(json_object_get(facts.meta, "dropped"), key, value)
		facts.dropped += json_integer_value(value);
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		facts.area[i] =
			json_number_value(json_object_get(json_object_get(organs, eco_organ_names[i]),
			"area_m2"));
	for (uint32_t i = plant->ladder_first; !facts.meta && i < plant->ladder_first + plant->ladder_count;
			i++)
		if (scene->ladders[i].anchor == plant->anchor_first
				&& !(scene->ladders[i].flags & ECO_LADDER_FAR))
			facts.area[scene->ladders[i].organ] += scene->ladders[i].area;
	return facts;
}

static const char *area_text(double area, char text[32])
{
	char whole[32];
	if (area > 0 && area < 0.1)
		snprintf(text, 32, "%.3g cm²", area * 1e4);
	else if (area < 100)
		snprintf(text, 32, "%.3g m²", area);
	else
		snprintf(text, 32, "%.20s m²", eco_phrase_count((uint64_t)fmin(area + 0.5, 1e15), whole));
	return text;
}

static void print_facts(const struct sheet *s, uint32_t number)
{
	const struct eco_plant *plant = &s->pack->scene.plants[number];
	struct facts facts = find_facts(s, number);
	char text[32];
	printf("%s: %.3g m, %u triangles", plant->name, (double)plant->height_m, plant->triangles);
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		if (facts.area[i] > 0)
			printf(", %s %s", eco_organ_names[i], area_text(facts.area[i], text));
	putchar('\n');
	const char *reason;
	json_t *count;
	json_object_foreach(json_object_get(facts.meta, "dropped"), reason, count)
		printf("    %lld of %lld triangles dropped: %s\n", (long long)json_integer_value(count),
			(long long)facts.triangles_in, reason);
}

/* ---- Drawing ---- */

static double column_x(const struct sheet *s, uint32_t column)
{
	return MARGIN + FACTS + GAP + column * (s->pixels + GAP);
}

/* The facts beside small pictures need their own height. */
static double row_height(const struct sheet *s) { return fmax(s->pixels + CAPTION, FACTS_HEIGHT) + GAP; }

static double write_organs(struct sheet *s, const struct facts *facts, double y)
{
	struct eco_chart_style style = { .size = 12, .room = FACTS - 20 };
	char text[80], area[32];
	double sum = 0;
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		sum += facts->area[i];
	for (int i = 0; i < ECO_ORGAN_COUNT; i++) {
		if (!(facts->area[i] > 0))
			continue;
		const uint8_t *rgb = sheet_organ_rgb[i];
		eco_chart_box(s->chart, MARGIN, y - 10, 11, 11,
			ECO_COLOR(rgb[0] << 16 | rgb[1] << 8 | rgb[2]));
		snprintf(text, sizeof text, "%s %s (%.0f %%)", eco_organ_names[i],
			area_text(facts->area[i], area), 100 * facts->area[i] / sum);
		eco_chart_text(s->chart, MARGIN + 17, y, &style, text);
		y += 16;
	}
	return y;
}

static void write_facts(struct sheet *s, uint32_t number, uint64_t full, double y)
{
	const struct eco_plant *plant = &s->pack->scene.plants[number];
	struct facts facts = find_facts(s, number);
	struct eco_chart_style style = { .size = 12, .room = FACTS - 8 },
		name = { .size = 15, .bold = true, .room = FACTS - 8 };
	struct eco_chart_style small = { .size = 11, .room = FACTS - 8, .color = ECO_COLOR(0xa03020) };
	double bottom = y + row_height(s) - GAP;
	const char *model = json_string_value(json_object_get(facts.meta, "model")), *reason;
	char text[160], a[32], b[32];
	eco_chart_text(s->chart, MARGIN, y + 14, &name, plant->name);
	y += 34;
	if (model && strcmp(model, plant->name) != 0) {
		eco_chart_text(s->chart, MARGIN, y, &style, model);
		y += 17;
	}
	snprintf(text, sizeof text, "%s high", eco_chart_length_text((double)plant->height_m, a));
	eco_chart_text(s->chart, MARGIN, y, &style, text);
	snprintf(text, sizeof text, "%s triangles, %s vertices", eco_phrase_count(plant->triangles, a),
		eco_phrase_count(full, b));
	eco_chart_text(s->chart, MARGIN, y += 17, &style, text);
	y = write_organs(s, &facts, y + 19);
	json_t *count;
	json_object_foreach(json_object_get(facts.meta, "dropped"), reason, count) {
		snprintf(text, sizeof text, "%s dropped: %.80s",
			eco_phrase_count((uint64_t)json_integer_value(count), a), reason);
		if (y < bottom)
			y = eco_chart_paragraph(s->chart, MARGIN, y + 2, 14, &small, text);
	}
}

/* Drawn below the picture: a length of at most half its width. */
static void scale_bar(struct sheet *s, const struct sheet_plant *plant, double x, double y)
{
	if (!(plant->metres_a_pixel > 0))
		return;
	double length = eco_chart_round_below(0.5 * s->pixels * plant->metres_a_pixel),
		wide = length / plant->metres_a_pixel;
	char text[32];
	struct eco_chart_style style = { .size = 12 };
	eco_chart_length_text(length, text);
	double left = x + (s->pixels - wide - 6 - eco_chart_text_width(s->chart, &style, text)) / 2,
		bottom = y + s->pixels + 14;
	const double shape[] = { left, bottom - 5, left, bottom, left + wide, bottom, left + wide,
		bottom - 5 };
	eco_chart_path(s->chart, &(struct eco_chart_path){ .points = shape, .count = 4, .line = 1.5,
		.color = ECO_COLOR(0x303030) });
	eco_chart_text(s->chart, left + wide + 6, y + s->pixels + 16, &style, text);
}

static enum eco_code draw_cell(struct sheet *s, struct sheet_plant *plant, uint32_t column, uint64_t vertices,
	enum sheet_colors colors, double y, struct eco_error *error)
{
	struct sheet_picture picture = { .rgb = s->rgb };
	enum eco_code code = sheet_plant_draw(plant, vertices, colors, &picture, error);
	if (code)
		return code;
	double x = column_x(s, column);
	struct eco_chart_style style = { .size = 12, .align = ECO_CHART_CENTER, .room = s->pixels };
	char text[96], count[32];
	eco_chart_pixels(s->chart, x, y, s->pixels, s->pixels, s->rgb, false);
	if (colors == SHEET_NATURAL) {
		eco_phrase_count(picture.vertices, count);
		if (column == 1)
			snprintf(text, sizeof text, "%s vertices", count);
		else
			snprintf(text, sizeof text, "Q %.3f · %s", picture.q, count);
		if (column > 1 && eco_chart_text_width(s->chart, &style, text) > s->pixels)
			snprintf(text, sizeof text, "Q %.3f", picture.q);
		eco_chart_text(s->chart, x + s->pixels / 2.0, y + s->pixels + 16, &style, text);
	}
	if (column == 0)
		scale_bar(s, plant, x, y);
	return ECO_OK;
}

static enum eco_code draw_row(struct sheet *s, uint32_t number, double y, struct eco_error *error)
{
	struct sheet_plant plant;
	enum eco_code code = sheet_plant_open(&plant, s->pack, number, s->pixels, error);
	if (code)
		return code;
	write_facts(s, number, plant.full, y);
	code = draw_cell(s, &plant, 1, ECO_VERTICES_MAX, SHEET_NATURAL, y, error);
	if (!code)
		code = draw_cell(s, &plant, 0, ECO_VERTICES_MAX, SHEET_ORGANS, y, error);
	for (uint32_t i = 0; i < s->column_count && !code; i++) {
		const struct column *c = &s->columns[i];
		uint64_t vertices = c->share > 0 ? (uint64_t)(c->share * (double)plant.full + 0.5)
			: c->vertices;
		code = draw_cell(s, &plant, i + 2, vertices, SHEET_NATURAL, y, error);
	}
	sheet_plant_close(&plant);
	return code;
}

static void draw_head(struct sheet *s, uint32_t page)
{
	const struct eco_scene *scene = &s->pack->scene;
	struct eco_chart_style title = { .size = 22, .bold = true },
		style = { .size = 12, .color = ECO_COLOR(0x606060) };
	struct eco_chart_style head = { .size = 13, .bold = true, .align = ECO_CHART_CENTER,
		.room = s->pixels };
	char text[160];
	eco_chart_text(s->chart, MARGIN, MARGIN + 20, &title, scene->name);
	snprintf(text, sizeof text, "%u kind%s of plants", scene->plant_count, scene->plant_count == 1 ? ""
		: "s");
	if (s->page_count > 1)
		snprintf(text + strlen(text), sizeof text - strlen(text), ", page %u of %u", page + 1,
			s->page_count);
	eco_chart_text(s->chart, MARGIN, MARGIN + 40, &style, text);
	eco_chart_text(s->chart, column_x(s, 0), MARGIN + 20, &style, "Shares are of the vertices of full "
		"detail. Q compares what is covered with full detail: 1 is no wrong pixel.");
	for (uint32_t i = 0; i < s->column_count + 2; i++)
		eco_chart_text(s->chart, column_x(s, i) + s->pixels / 2.0, HEAD - 10, &head,
			i == 0 ? "organs" : i == 1 ? "full detail" : s->columns[i - 2].title);
}

static enum eco_code draw_page(struct sheet *s, uint32_t page, struct eco_error *error)
{
	uint32_t first = page * s->rows_a_page, rows = s->plant_count - first;
	rows = rows < s->rows_a_page ? rows : s->rows_a_page;
	double width = column_x(s, s->column_count + 2) - GAP + MARGIN,
		height = HEAD + rows * row_height(s) + MARGIN - GAP;
	enum eco_code code = eco_chart_new(&s->chart, (uint32_t)width, (uint32_t)height, error);
	if (code)
		return code;
	draw_head(s, page);
	for (uint32_t i = 0; i < rows && !code; i++) {
		const char *name = s->pack->scene.plants[s->plants[first + i]].name;
		if (!main_progress("drawing", name, (double)(first + i) / s->plant_count))
			code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
		else
			code = draw_row(s, s->plants[first + i], HEAD + i * row_height(s), error);
	}
	if (!code)
		code = eco_chart_png(s->chart, &s->pages[page], error);
	eco_chart_free(s->chart);
	s->chart = NULL;
	return code;
}

/* ---- Pages ---- */

/* sheet.png, or sheet-1.png, sheet-2.png, ... */
static void page_path(const struct sheet *s, uint32_t page, char path[4096])
{
	size_t length = strlen(s->output), stem = length > 4 && strcmp(s->output + length - 4, ".png") == 0
		? length - 4 : length;
	if (s->page_count == 1)
		snprintf(path, 4096, "%s", s->output);
	else
		snprintf(path, 4096, "%.*s-%u%s", (int)stem, s->output, page + 1, s->output + stem);
}

static enum eco_code make_pages(struct sheet *s, struct eco_error *error)
{
	char path[4096];
	s->rows_a_page = (uint32_t)((PAGE_HEIGHT - HEAD - MARGIN) / row_height(s));
	s->page_count = (s->plant_count + s->rows_a_page - 1) / s->rows_a_page;
	if (s->page_count > PAGES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%u plants would be %u pages; choose some with "
			"--plants", s->plant_count, s->page_count);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < s->page_count && !code; i++) {
		page_path(s, i, path);
		code = eco_chart_may_write(path, error);
	}
	s->pages = calloc(s->page_count, sizeof *s->pages);
	s->rgb = malloc(3 * (size_t)s->pixels * s->pixels);
	if (!code && (!s->pages || !s->rgb))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for pictures");
	for (uint32_t i = 0; i < s->page_count && !code; i++)
		code = draw_page(s, i, error);
	main_progress_end();
	for (uint32_t i = 0; i < s->page_count && !code; i++) {
		page_path(s, i, path);
		code = eco_file_write(path, s->pages[i].bytes, s->pages[i].size, error);
		if (!code && !main_is_quiet)
			printf("%s\n", path);
	}
	return code;
}

static void sheet_free(struct sheet *s)
{
	for (uint32_t i = 0; s->pages && i < s->page_count; i++)
		free(s->pages[i].bytes);
	free(s->pages);
	free(s->rgb);
	free(s->plants);
	json_decref(s->meta);
	eco_pack_close(s->pack);
}

static struct { const char *pack, *output, *columns, *plants; uint64_t pixels; } given;

static enum eco_code run_sheet(int argc, char **argv, struct eco_error *error)
{
	struct sheet s = { 0 };
	memset(&given, 0, sizeof given);
	given.columns = "1/2,1/4,1/8,1/16,1/32,1/64";
	given.pixels = 200;
	enum eco_code code = main_read(&main_command_sheet, argc, argv, error);
	s.output = given.output;
	s.pixels = (uint32_t)given.pixels;
	if (!code)
		code = parse_columns(&s, given.columns, error);
	if (!code)
		code = eco_chart_may_write(s.output, error);
	if (!code)
		code = eco_pack_open(&s.pack, given.pack, error);
	if (code)
		return code;
	s.meta = json_loadb(s.pack->meta, s.pack->meta_size, 0, NULL);
	code = choose_plants(&s, given.plants, error);
	if (!code)
		code = make_pages(&s, error);
	for (uint32_t i = 0; i < s.plant_count && !code && !main_is_quiet; i++)
		print_facts(&s, s.plants[i]);
	sheet_free(&s);
	return code;
}

static const struct eco_option options[] = {
	{ "the pack", 0, ECO_OPTION_INPUT, "OUT.eco", &given.pack, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "SHEET.png", &given.output, .is_required = true,
		.help = "a PNG, which appears complete or not at all; with many plants SHEET-1.png, "
		"SHEET-2.png, ..." },
	{ "columns", 0, ECO_OPTION_TEXT, "LIST", &given.columns,
		.help = "shares of all vertices, or numbers of them: 1/2,1/4,1/8,1/16,1/32,1/64 if not "
		"given" },
	{ "size", 0, ECO_OPTION_COUNT, "PX", &given.pixels, 48, 800,
		.help = "side of each picture, 48 to 800; 200 if not given" },
	{ "plants", 0, ECO_OPTION_TEXT, "LIST", &given.plants, .help = "only these, by name" }, { 0 } };

const struct main_command main_command_sheet = { {
	"ecopack sheet", "OUT.eco -o SHEET.png [--columns LIST] [--size PX] [--plants NAME,...]",
	"Draws every plant of a pack with less and less detail, and how good that is.", options, main_common,
	NULL, NULL }, run_sheet };
