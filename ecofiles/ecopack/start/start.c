/* ecopack start: from an inventory and a folder of models to a scene, a map and a camera. */
#include "ecofiles/ecopack/start/start.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/options.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/command.h"
#include "ecofiles/ecopack/run.h"

/* ---- Guesses ---- */

static void print_guess(const struct start_guess *g)
{
	int at = printf("  %-18s ", g->what);
	char text[560];
	snprintf(text, sizeof text, "%s  (%s)", g->took, g->why);
	eco_help_wrap(stdout, text, at > 0 ? (unsigned)at : 0, 21);
	if (g->change[0] != 0)
		printf("%21schange: %s\n", "", g->change);
	fflush(stdout);          /* what comes next may fork, or fail on standard error */
}

void start_guess(struct start *s, const char *what, const char *took, const char *change,
	const char *why, ...)
{
	eco_grow(&s->guesses, &s->guess_capacity, s->guess_count, sizeof *s->guesses);
	struct start_guess *g = &s->guesses[s->guess_count++];
	va_list arguments;
	va_start(arguments, why);
	eco_phrase_cut(g->why, sizeof g->why, vsnprintf(g->why, sizeof g->why, why, arguments));
	va_end(arguments);
	snprintf(g->what, sizeof g->what, "%s", what);
	snprintf(g->took, sizeof g->took, "%s", took);
	snprintf(g->change, sizeof g->change, "%s", change);
	if (!main_is_quiet)
		print_guess(g);
}

char *start_text(const char *format, ...)
{
	va_list arguments;
	char *text;
	va_start(arguments, format);
	if (vasprintf(&text, format, arguments) < 0)
		eco_end("no memory");
	va_end(arguments);
	return text;
}

void start_say(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (!main_is_quiet)
		vprintf(format, arguments);
	va_end(arguments);
	fflush(stdout);
}

static void start_free(struct start *s)
{
	for (uint32_t i = 0; i < s->model_count; i++) {
		for (uint32_t k = 0; k < s->models[i].path_count; k++)
			free(s->models[i].paths[k]);
		free(s->models[i].paths);
	}
	eco_table_free(&s->table);
	eco_table_values_free(&s->species);
	eco_free(s->models, s->matches, s->guesses);
	start_raster_free(&s->dem);
	start_raster_free(&s->image);
	for (uint32_t i = 0; i < s->raster_path_count; i++)
		free(s->raster_paths[i]);
	free(s->raster_paths);
	free(s->scene);
	json_decref(s->skip);
	json_decref(s->dead);
	json_decref(s->tint);
	json_decref(s->other);
	json_decref(s->buildings);
	json_decref(s->draws);
	json_decref(s->scatters);
	json_decref(s->objects);
}

/* ---- The folder ---- */

static void make_folder(const struct start_options *o, bool *made, struct eco_error *error)
{
	static const char *const names[] = { "scene.json", "map.png", "camera.json" };
	struct stat status;
	char path[4096];
	*made = mkdir(o->folder, 0777) == 0;
	if (!*made && errno != EEXIST)
		eco_check(eco_fail_write(error, o->folder, errno));
	if (!*made && stat(o->folder, &status) == 0 && !S_ISDIR(status.st_mode))
		eco_stop(ECO_BAD_INPUT, "-o %.300s exists and is not a folder; it is kept. Take another "
			"name", o->folder);
	for (size_t i = 0; i < 3 && !o->force; i++) {
		snprintf(path, sizeof path, "%.4000s/%s", o->folder, names[i]);
		if (access(path, F_OK) == 0)
			eco_stop(ECO_BAD_INPUT, "%.300s exists; --force replaces it, with all changes made "
				"by hand", path);
	}
}

/* ---- The command ---- */

static struct start_options asked;
static bool made;                        /* the folder */
static struct { struct eco_inputs inputs; struct start_options options; char folder[4096]; } given;

/* Whether two files have the same bytes: a copy would be drawn and planted twice. */
static bool same_bytes(const char *a, const char *b)
{
	struct stat one, other;
	bool same = stat(a, &one) == 0 && stat(b, &other) == 0 && S_ISREG(one.st_mode) && S_ISREG(other.st_mode) &&
		one.st_size == other.st_size;
	FILE *files[2] = { same ? fopen(a, "rb") : NULL, same ? fopen(b, "rb") : NULL };
	char blocks[2][4096];
	for (size_t size = 1; size && (same = same && files[0] && files[1]);) {
		size = fread(blocks[0], 1, sizeof *blocks, files[0]);
		same = fread(blocks[1], 1, sizeof *blocks, files[1]) == size && memcmp(blocks[0], blocks[1], size) == 0;
	}
	for (int i = 0; i < 2; i++)
		if (files[i])
			fclose(files[i]);
	return same;
}

static void drop_copies(struct eco_inputs *inputs)
{
	uint32_t kept = 0;
	for (uint32_t i = 0, k; i < inputs->count; i++) {
		for (k = 0; k < kept && !same_bytes(inputs->names[k], inputs->names[i]); k++)
			;
		if (k < kept)
			start_say("  %s: left out, as %s has the same bytes\n", inputs->names[i], inputs->names[k]);
		else
			inputs->names[kept++] = inputs->names[i];
	}
	inputs->count = kept;
}

static void read_options(struct start *s, struct start_options *o)
{
	*o = given.options;
	drop_copies(&given.inputs);
	given.inputs.count = start_objects(s, given.inputs.names, start_buildings(s, given.inputs.names, given.inputs.count));
	uint32_t rasters = start_check_order(given.inputs.names, given.inputs.count) ? 2 : 1;
	o->table = given.inputs.names[0];
	o->models = rasters > 1 ? given.inputs.names[1] : NULL;
	o->rasters = given.inputs.names + rasters;
	o->raster_count = given.inputs.count - rasters;
	size_t bytes = strlen(o->folder);
	while (bytes > 1 && o->folder[bytes - 1] == '/')
		bytes--;
	if (snprintf(given.folder, sizeof given.folder, "%.*s", (int)bytes, o->folder) >= (int)sizeof given.folder)
		eco_stop(ECO_BAD_USAGE, "-o %.60s...: the path is too long", o->folder);
	o->folder = given.folder;
	if (o->separator && strcmp(o->separator, "tab") == 0)
		o->separator = "\t";
	if (o->separator && (strlen(o->separator) != 1 || !strchr(",;\t|", o->separator[0])))
		eco_stop(ECO_BAD_USAGE, "--separator is one of , ; | tab");
	if (o->decimal && (strlen(o->decimal) != 1 || !strchr(".,", o->decimal[0])))
		eco_stop(ECO_BAD_USAGE, "--decimal is . or ,");
}

/* The CRS of another scene is this one's; start_scene takes its origin, start_write its camera. */
void start_same_place(struct start *s)
{
	json_error_t why;
	const char *path = s->options->same_place;
	if (!path)
		return;
	s->other = json_load_file(path, 0, &why);
	const char *crs = json_string_value(json_object_get(s->other, "crs"));
	if (!s->other || !json_is_array(json_object_get(s->other, "origin")))
		eco_stop(ECO_BAD_INPUT, "--same-place-as %.300s: no scene with an \"origin\"%s%.100s", path,
			s->other ? "" : ": ", s->other ? "" : why.text);
	asked.scene_crs = asked.scene_crs ? asked.scene_crs : crs;
}

static void print_next(const char *folder)
{
	char name[64];
	start_name(folder, name);
	printf("\n%s: scene.json, map.png and camera.json are written. Look at map.png and at \"notes\" in "
		"scene.json; then:\n", folder);
	printf("  ecopack make --draft %s/scene.json -o %s/%s.eco   # seconds; later without --draft: "
		"minutes\n", folder, folder, name);
	printf("  ecoserve %s/%s.eco &\n", folder, name);
	printf("  ecoview http://127.0.0.1:8080/v1/scenes/%s --camera %s/camera.json --size 1280x720 "
		"--vertices 1000000 -o %s/picture\n", name, folder, folder);
	printf("  ecopack publish %s/%s.eco -o %s/site   # a folder that any web server shows\n", folder, name, folder);
}

static void run_steps(void *start)
{
	struct start *s = start;
	read_options(s, &asked);
	start_same_place(s);
	make_folder(&asked, &made, s->error);
	start_rasters(s);
	enum eco_code code = eco_try(start_look, s, s->error);
	if (code)
		start_told_raster(s, code);
	start_image_crs(s);
	start_objects_place(s);
	if (asked.models)
		start_models_find(s);
	start_match_species(s);
	start_land_plants(s);
	start_models_see(s);
	start_library_usual(s);
	start_tint(s);
	start_scene(s);
	start_write(s);
}

static enum eco_code run_start(int argc, char **argv, struct eco_error *error)
{
	struct start s = { .options = &asked, .error = error };
	memset(&given, 0, sizeof given);
	enum eco_code code = main_read(&main_command_start, argc, argv, error);
	code = code ? code : eco_try(run_steps, &s, error);
	main_progress_end();
	start_free(&s);
	if (code && made)
		rmdir(asked.folder);
	if (!code && !main_is_quiet)
		print_next(asked.folder);
	return code;
}

static const struct eco_option options[] = {
	{ "the table", 0, ECO_OPTION_INPUTS, "TREES [MODELS] [RASTER...] [LAND...] [BUILDINGS...]", &given.inputs,
		.high = 1026, .is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "DIR", &given.options.folder, .is_required = true,
		.help = "the folder for scene.json, map.png and camera.json, which appear together or not "
			"at all" },
	{ "force", 0, ECO_OPTION_FLAG, NULL, &given.options.force, .help = "replace these files" },
	{ "crs", 0, ECO_OPTION_TEXT, "CRS", &given.options.crs,
		.help = "CRS of the table, such as EPSG:4326 for "
		"degrees" },
	{ "scene-crs", 0, ECO_OPTION_TEXT, "CRS", &given.options.scene_crs,
		.help = "projected CRS of the scene, in metres" },
	{ "x", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.x, .help = "column of eastings or longitudes" },
	{ "y", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.y, .help = "column of northings or latitudes" },
	{ "species-column", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.species,
		.help = "column of species, Latin or common names" },
	{ "plant", 0, ECO_OPTION_TEXT, "NAME", &given.options.plant,
		.help = "one model, or one habit of the library, for all rows" },
	{ "height-column", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.height,
		.help = "column of heights of plants" },
	{ "height-unit", 0, ECO_OPTION_TEXT, "U", &given.options.height_unit,
		.help = "unit of heights: m, cm, mm, in, ft" },
	{ "dbh-column", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.dbh,
		.help = "column of trunk diameters at breast height" },
	{ "girth-column", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.girth,
		.help = "column of trunk girths, in place of diameters" },
	{ "dbh-unit", 0, ECO_OPTION_TEXT, "U", &given.options.dbh_unit,
		.help = "unit of diameters or girths" },
	{ "tint", 0, ECO_OPTION_TEXT, "COLUMN", &given.options.tint,
		.help = "colours plants by the values of a column, such as their health; its values leave out no rows" },
	{ "dem", 0, ECO_OPTION_TEXT, "FILE", &given.options.dem,
		.help = "raster of heights; no guess by its bands" },
	{ "image", 0, ECO_OPTION_TEXT, "FILE", &given.options.image,
		.help = "picture of the ground, or its classes in colours" },
	{ "image-crs", 0, ECO_OPTION_TEXT, "CRS", &given.options.image_crs,
		.help = "CRS of the picture, if its file has none" },
	{ "same-place-as", 0, ECO_OPTION_TEXT, "SCENE", &given.options.same_place,
		.help = "takes origin, CRS and camera from another scene.json, so that views of both agree" },
	{ "layer", 0, ECO_OPTION_TEXT, "NAME", &given.options.layer,
		.help = "layer, in a file with several" },
	{ "separator", 0, ECO_OPTION_TEXT, "S", &given.options.separator,
		.help = "separator of columns: , ; | or tab" },
	{ "decimal", 0, ECO_OPTION_TEXT, "S", &given.options.decimal,
		.help = "decimal sign: . or ," }, { 0 } };

const struct main_command main_command_start = { { "ecopack start",
	"TREES [MODELS] [RASTER...] [LAND...] [BUILDINGS...] -o DIR [--force] "
	"[--crs CRS] [--x COLUMN --y COLUMN] [--height-unit U] ...",
	"Makes a scene from an inventory of plants, a folder of models, optional rasters (terrain, "
	"picture of the ground) and what lies around (footprints or models of buildings, roads, land use, an extract of OpenStreetMap), in any order. The "
	"library grows what the models lack, or all plants if there are none. It finds columns, units, CRS, origin, a model for each "
	"species and a camera, and prints each guess with its reason and the option that changes it.",
	options, main_common,
	"When two answers are equally good, it fails with an error that names both and the option that "
	"decides. It never reads from the terminal.\n", NULL }, run_start };
