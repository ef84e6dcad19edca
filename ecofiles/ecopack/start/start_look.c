/* The table: what its columns mean, in which units and in which CRS. */
#include "ecofiles/ecopack/start/start.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/model/import_file.h"
#include "ecofiles/scene/scene.h"

/* ---- Columns ---- */

static uint32_t find_named(const struct start *s, const char *name, const char *option)
{
	char there[250] = "";
	for (uint32_t i = 0; i < s->table.column_count; i++) {
		if (strcmp(s->table.columns[i], name) == 0)
			return i;
		eco_phrase_add(there, sizeof there, s->table.columns[i]);
	}
	eco_stop(ECO_BAD_INPUT, "%s %.60s: %.120s has no such column; there are: %s", option, name, s->options->table,
		there);
}

static void find_columns(struct start *s)
{
	const struct start_options *o = s->options;
	const struct { enum eco_role role; const char *name, *option; } given[] = { { ECO_ROLE_X, o->x, "--x" },
		{ ECO_ROLE_Y, o->y, "--y" }, { ECO_ROLE_SPECIES, o->species, "--species-column" },
		{ ECO_ROLE_HEIGHT, o->height, "--height-column" }, { ECO_ROLE_DBH, o->dbh, "--dbh-column" },
		{ ECO_ROLE_GIRTH, o->girth, "--girth-column" } };
	if (o->dbh && o->girth)
		eco_stop(ECO_BAD_INPUT, "--dbh-column and --girth-column: give one, trunks have one size");
	for (int i = 0; i < ECO_ROLE_COUNT; i++)
		s->columns.of[i] = ECO_NONE;
	s->columns.decimal = o->decimal ? o->decimal[0] : 0;
	for (size_t i = 0; i < sizeof given / sizeof *given; i++)
		if (given[i].name)
			s->columns.of[given[i].role] = find_named(s, given[i].name, given[i].option);
	s->tint_column = o->tint ? find_named(s, o->tint, "--tint") : ECO_NONE;
	eco_table_columns(&s->table, &s->columns);
	if (o->girth && !o->dbh)
		s->columns.of[ECO_ROLE_DBH] = ECO_NONE;
	if (s->columns.thousands_open)
		eco_stop(ECO_BAD_INPUT, "%.120s: do the commas in \"%.40s\" and \"%.40s\" part thousands or decimals? "
			"Nothing else in it says so: give --decimal . if they part thousands, else --decimal ,", o->table,
			start_column(s, s->columns.of[ECO_ROLE_X]), start_column(s, s->columns.of[ECO_ROLE_Y]));
}

static void say_column(struct start *s, enum eco_role role, const char *change, bool given)
{
	const char *name = start_column(s, s->columns.of[role]),
		   *rival = start_column(s, s->columns.rival[role]);
	char took[80];
	snprintf(took, sizeof took, "\"%.70s\"", name);
	if (given)
		start_guess(s, eco_role_names[role], took, change, "as you say");
	else
		start_guess(s, eco_role_names[role], took, change, "by its name and what stands in it%s%.60s%s",
			rival ? "; it might be \"" : "", rival ? rival : "", rival ? "\", too" : "");
}

static void say_offsets(struct start *s)
{
	const struct eco_offsets *o = &s->place.offsets;
	char took[160];
	if (o->quadrat_m > 0) {
		snprintf(took, sizeof took, "within quadrats of %g m, \"%.60s\"", o->quadrat_m,
			start_column(s, s->columns.of[ECO_ROLE_QUADRAT]));
		start_guess(s, "quadrats", took, "\"quadrat\" in the scene", "two digits of the column "
			"from the west, two of the row from the south; x and y fill them");
	}
	if (!o->polar)
		return;
	snprintf(took, sizeof took, "from centres: azimuth \"%.40s\" in %s, distance \"%.40s\" in %s",
		start_column(s, s->columns.of[ECO_ROLE_AZIMUTH]), o->whole_turn == 400 ? "gon" : "degrees",
		start_column(s, s->columns.of[ECO_ROLE_DISTANCE]), o->distance_unit);
	start_guess(s, "bearings", took, "\"polar\" in the scene", "%s; clockwise from north",
		s->place.from_geometry || s->columns.of[ECO_ROLE_X] != ECO_NONE
		? "several rows share each place, which so is a plot's centre" : "no column says a place");
}

static void say_columns(struct start *s)
{
	const struct start_options *o = s->options;
	char took[160];
	if (s->columns.thousands) {
		snprintf(took, sizeof took, "%s between thousands", s->columns.thousands == ',' ? "commas" : "points");
		start_guess(s, "coordinates", took, "--decimal", "%s", o->decimal ? "as you say"
			: "as they part groups of three digits everywhere");
	} else if (s->columns.decimal == ',')
		start_guess(s, "numbers", "decimal commas", "--decimal", "as most numbers have them");
	if (s->place.from_geometry)
		start_guess(s, "places", "the file's points", "--x, --y", "it has a geometry");
	else if (s->columns.of[ECO_ROLE_X] != ECO_NONE) {
		const char *x = start_column(s, s->columns.of[s->place.swapped ? ECO_ROLE_Y : ECO_ROLE_X]),
			*y = start_column(s, s->columns.of[s->place.swapped ? ECO_ROLE_X : ECO_ROLE_Y]);
		snprintf(took, sizeof took, "x is \"%.60s\", y is \"%.60s\"%s%s", x, y,
			s->place.unit ? ", in " : "", s->place.unit ? s->place.unit : "");
		start_guess(s, "places", took, "--x, --y", "%s", s->place.swapped
			? "swapped, see crs" : o->x && o->y ? "as you say" : "by their names and numbers");
	}
	say_offsets(s);
	if (s->columns.of[ECO_ROLE_SPECIES] == ECO_NONE)
		return;
	say_column(s, ECO_ROLE_SPECIES, "--species-column", o->species);
	for (uint32_t i = 0; i < 2 && s->columns.species_more[i] != ECO_NONE; i++) {
		snprintf(took, sizeof took, "\"%.70s\", joined to it", start_column(s, s->columns.species_more[i]));
		start_guess(s, "species", took, "\"species\" in the scene", "%s", i == 0
			? "it has the epithets of these genera, or cultivars" : "it has cultivars");
	}
}

/* ---- Places ---- */

static void find_place(struct start *s)
{
	const struct start_options *o = s->options;
	struct eco_place_asked asked = { .table = &s->table, .source = &s->source,
		.columns = &s->columns, .crs = o->crs,
		.scene_crs = o->scene_crs, .axes_said = o->x || o->y,
		.dem = s->dem.extent ? s->dem.extent : s->image.extent };
	eco_check(eco_place_guess(&s->place, &asked, s->error));
}

static void say_place(struct start *s)
{
	const struct eco_place_guess *p = &s->place;
	char took[80];
	start_guess(s, "crs of the table", p->crs[0] != 0 ? p->crs : "none", "--crs", "%s", p->crs_why);
	start_guess(s, "crs of the scene", p->scene_crs[0] != 0 ? p->scene_crs : "none", "--scene-crs", "%s",
		p->scene_why);
	snprintf(took, sizeof took, "%.10g, %.10g", p->origin[0], p->origin[1]);
	start_guess(s, "origin", took, "\"origin\" in the scene", "%s", p->origin_why);
}

static void check_units(const struct start *s)
{
	const struct start_options *o = s->options;
	const struct { const char *name, *unit; } given[] = { { "--height-unit", o->height_unit },
		{ "--dbh-unit", o->dbh_unit } };
	double metres;
	for (size_t i = 0; i < 2; i++)
		if (given[i].unit && !eco_unit_metres(given[i].unit, &metres))
			eco_stop(ECO_BAD_USAGE, "%s %.20s: the units are " ECO_UNITS, given[i].name, given[i].unit);
}

void start_look(void *start)
{
	struct start *s = start;
	const struct start_options *o = s->options;
	char rows[32];
	s->source = (struct eco_rows_source){ .path = o->table, .layer = o->layer,
		.separator = o->separator ? o->separator[0] : 0, .crowns = true };
	check_units(s);
	eco_check(eco_table_read(&s->table, &s->source, s->error));
	start_say("%s: %s row%s, %u column%s\n", o->table, eco_phrase_count(s->table.rows, rows),
		s->table.rows == 1 ? "" : "s", s->table.column_count, s->table.column_count == 1 ? "" : "s");
	for (uint32_t i = 0; i < s->table.note_count; i++)
		start_say("  %s\n", s->table.notes[i]);
	find_columns(s);
	find_place(s);
	say_columns(s);
	say_place(s);
	start_sizes(s);
}

/* ---- Rasters ---- */

/* By the ending. */
static bool is_raster(const char *path)
{
	static const char *const endings[] = { "tif", "tiff", "vrt", "asc", "img", "hgt", "bil", "jp2", "png", "jpg", "jpeg" };
	bool raster = false;
	for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
		raster |= eco_path_ends_with(path, endings[i]);
	return raster;
}

static bool is_folder(const char *path)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* The rasters: which holds the heights of the ground, and which its picture. */

static struct eco_raster_extent *read_extent(const struct start *s, const char *path)
{
	struct eco_raster_extent *extent = eco_alloc(1, sizeof *extent);
	eco_check(eco_raster_extent(path, extent, s->error));
	return extent;
}

#define OVERLAP_MOST 0.1        /* of a tile: tiles may share a border of pixels */

static bool overlap(const struct eco_raster_extent *a, const struct eco_raster_extent *b)
{
	double share = 1;
	for (int k = 0; k < 2; k++) {
		double low = a->low[k] > b->low[k] ? a->low[k] : b->low[k],
		       high = a->high[k] < b->high[k] ? a->high[k] : b->high[k];
		share *= high > low ? (high - low) / (b->high[k] - b->low[k]) : 0;
	}
	return share > OVERLAP_MOST;
}

/* Whether a raster lies beside all tiles, in their CRS. */
static bool is_tile(const struct start_raster *raster, const struct eco_raster_extent *extent)
{
	bool beside = strcmp(raster->extent->crs, extent->crs) == 0;
	for (uint32_t i = 0; i < raster->tile_count; i++)
		beside = beside && !overlap(raster->tiles[i].extent, extent);
	return beside;
}

static void add_tile(struct start_raster *raster, const char *path, struct eco_raster_extent *extent)
{
	eco_grow(&raster->tiles, &raster->tile_capacity, raster->tile_count, sizeof *raster->tiles);
	raster->tiles[raster->tile_count++] = (struct start_tile){ path, extent };
	if (raster->tile_count == 1) {
		raster->path = path;
		raster->extent = eco_alloc(1, sizeof *extent);
		*raster->extent = *extent;
	}
	for (int k = 0; k < 2; k++) {
		if (extent->low[k] < raster->extent->low[k])
			raster->extent->low[k] = extent->low[k];
		if (extent->high[k] > raster->extent->high[k])
			raster->extent->high[k] = extent->high[k];
	}
}

void start_raster_free(struct start_raster *raster)
{
	for (uint32_t i = 0; i < raster->tile_count; i++)
		free(raster->tiles[i].extent);
	free(raster->tiles);
	free(raster->extent);
}

/* A raster without an option is sorted by its bands. */
static void sort_raster(struct start *s, const char *path)
{
	struct eco_raster_extent *extent = read_extent(s, path);
	bool heights = extent->kind == ECO_RASTER_HEIGHTS;
	struct start_raster *raster = heights ? &s->dem : &s->image;
	if (extent->kind == ECO_RASTER_DOUBTFUL)
		eco_stop(ECO_BAD_INPUT, "%.200s: heights, or a picture of the ground? %s; say --dem %.200s or --image "
			"%.200s", path, extent->bands, path, path);
	if (raster->path && !is_tile(raster, extent))
		eco_stop(ECO_BAD_INPUT, "%.200s and %.200s: both are rasters of %s, and they overlap, or differ in CRS; name one, or several as an "
			"array in the scene (%s FILE says what a file is)", raster->path, path, heights ? "heights" : "colours",
			heights ? "--dem" : "--image");
	add_tile(raster, path, extent);
	start_guess(s, heights ? "terrain" : "picture", path, "--dem, --image", "%s%s", extent->bands,
		raster->tile_count > 1 ? ", and lies beside the others: one ground" : "");
}

static int is_raster_entry(const struct dirent *entry) { return is_raster(entry->d_name); }

/* A raster, or those in a folder, as terrain comes in tiles. */
static void sort_rasters(struct start *s, char *path)
{
	struct dirent **entries = NULL;
	int count = is_folder(path) ? scandir(path, &entries, is_raster_entry, alphasort) : 0;
	for (int i = 0; i < count; i++) {
		char *file = start_text("%s/%s", path, entries[i]->d_name);
		eco_grow(&s->raster_paths, &s->raster_path_capacity, s->raster_path_count, sizeof *s->raster_paths);
		s->raster_paths[s->raster_path_count++] = file;
		free(entries[i]);
		sort_raster(s, file);
	}
	free(entries);
	if (count == 0)
		sort_raster(s, path);
}

void start_rasters(struct start *s)
{
	const struct start_options *o = s->options;
	if (o->dem)
		add_tile(&s->dem, o->dem, read_extent(s, o->dem));
	if (o->image)
		add_tile(&s->image, o->image, read_extent(s, o->image));
	for (uint32_t i = 0; i < o->raster_count; i++)
		sort_rasters(s, o->rasters[i]);
}

/* CSV may be read as a grid of points. */
void start_told_raster(struct start *s, enum eco_code code)
{
	static const char *const text[] = { "csv", "tsv", "txt" };
	struct eco_raster_extent *extent = eco_alloc(1, sizeof *extent);
	struct eco_error own = { .code = ECO_OK };
	bool raster = code == ECO_BAD_INPUT;
	for (size_t i = 0; i < sizeof text / sizeof *text && raster; i++)
		raster = !eco_path_ends_with(s->options->table, text[i]);
	if (raster && !eco_raster_extent(s->options->table, extent, &own)) {
		*s->error = own;
		eco_stop(ECO_BAD_INPUT, "%.300s is a raster, no table of plants: rasters come last, as in ecopack start TREES "
			"MODELS RASTER... -o DIR", s->options->table);
	}
	eco_check(code);
	abort();
}

/* The picture's CRS, where its file says none: the scene's, if the plants' middle lies on it then. */
void start_image_crs(struct start *s)
{
	const struct eco_raster_extent *e = s->image.extent;
	const struct eco_place_guess *p = &s->place;
	if (e && s->options->image_crs) {
		s->image.crs = s->options->image_crs;
		start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "as you say");
		return;
	}
	if (!e || e->crs[0] != 0 || p->scene_crs[0] == 0)        /* plain metres, as the scene */
		return;
	for (int k = 0; k < 2; k++)
		if (p->origin[k] < e->low[k] || p->origin[k] > e->high[k])
			eco_stop(ECO_BAD_INPUT, "%.200s: in which CRS is it? Its file says none, and in the "
				"scene's, %s, it lies from %.0f, %.0f to %.0f, %.0f, where the plants are not; say "
				"--image-crs EPSG:...", s->image.path, p->scene_crs, e->low[0], e->low[1], e->high[0],
				e->high[1]);
	s->image.crs = p->scene_crs;
	start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "its file says none, and in the "
		"scene's the plants' middle lies on it");
}

/* ---- Order of arguments ---- */

/* Whether the arguments stand in their order: a table, a folder of models, rasters. */

enum kind { ABSENT, FOLDER, MODEL, RASTER, TABLE };

/* Folders within a folder may hold models beside their previews. */
static int is_model_entry(const struct dirent *entry)
{
	return start_is_model(entry->d_name) || (entry->d_type == DT_DIR && entry->d_name[0] != '.');
}

static bool has_rasters_alone(const char *folder)
{
	int (*const kinds[])(const struct dirent *) = { is_raster_entry, is_model_entry };
	int counts[2];
	for (int k = 0; k < 2; k++) {
		struct dirent **entries = NULL;
		counts[k] = scandir(folder, &entries, kinds[k], NULL);
		for (int i = 0; i < counts[k]; i++)
			free(entries[i]);
		free(entries);
	}
	return counts[0] > 0 && counts[1] <= 0;
}

/* By the ending, as each is told before it is read. */
static enum kind kind_of(const char *path)
{
	struct stat status;
	if (stat(path, &status) != 0)
		return ABSENT;
	if (S_ISDIR(status.st_mode))
		return eco_path_ends_with(path, "gdb") ? TABLE : has_rasters_alone(path) ? RASTER : FOLDER;
	return start_is_model(path) ? MODEL : is_raster(path) ? RASTER : TABLE;
}

bool start_is_table(const char *path) { return kind_of(path) == TABLE; }

/* Tables, models, rasters; what is absent stays first if it was. Without a table the first is told what it is. */
static void sort_names(char **names, uint32_t count)
{
	bool table = false;
	for (uint32_t i = 0; i < count; i++)
		table |= kind_of(names[i]) == TABLE;
	for (uint32_t i = 1; i < count && table; i++)
		for (uint32_t k = i; k > 0; k--) {
			static const int rank[] = { [ABSENT] = 1, [FOLDER] = 1, [MODEL] = 1, [RASTER] = 2, [TABLE] = 0 };
			enum kind a = kind_of(names[k - 1]), b = kind_of(names[k]);
			if (rank[a] <= rank[b] || (a == ABSENT && k == 1))
				break;
			char *name = names[k];
			names[k] = names[k - 1];
			names[k - 1] = name;
		}
}

bool start_check_order(char **names, uint32_t count)
{
	sort_names(names, count);
	static const char *const says[] = { "absent", "a folder", "a model", "a raster", "a table" };
	enum kind trees = kind_of(names[0]), models = count > 1 ? kind_of(names[1]) : RASTER;
	bool later = false;
	for (uint32_t i = 2; i < count; i++)
		later = later || kind_of(names[i]) == FOLDER || kind_of(names[i]) == MODEL;
	bool trees_bad = trees == FOLDER || trees == MODEL;
	bool models_bad = trees != ABSENT && ((models == RASTER && later) || models == TABLE);
	if (trees_bad || models_bad)
		eco_stop(ECO_BAD_INPUT, "TREES, %.250s, is %s, MODELS, %.250s, %s: one is the table of plants, such as trees.csv, the "
			"other a folder or a model (" START_FORMATS "), or a table whose features are known as buildings, "
			"roads or land use", names[0], says[trees], count > 1 ? names[1] : "-", says[count > 1 ? models : ABSENT]);
	return models != RASTER;
}
