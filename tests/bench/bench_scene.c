/* The scenes that methods are compared on, made when they are first asked for and kept in the cache.
 *
 * Most come from `ecopack generate`, in the sizes of the literature: 640 trees of 10 M triangles, 1,500 palms
 * of 12 M, an outdoor scene of 120 M, 13,000 sunflowers and a maple of 70 M (Deussen 2002, table 1); 1,276
 * trees of 63 M vertices and 5,000 of 1.3 G (Neubert 2011). `detail` multiplies the leaves until the sum
 * fits. A forest inventory comes from the data folder.
 *
 * A scene is a folder with scene.json and camera.json, a pack one file per order. Each has a stamp beside it
 * of its sources: ecopack itself, its options, and the folder of data. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/files.h"
#include "ecofiles/format/view.h"
#include "tests/bench/bench.h"
#include "tests/support/files.h"

#define PATH 1024
#define STAMP 256u

/* The quick bench looks at those whose packs take little: plants of few leaves. */
enum origin { GENERATED, CROWN, SCBI };
static const struct scene { const char *name; enum origin origin; const char *kind; unsigned plants;
	double detail; bool quick; } scenes[] = {
	{ "crown", CROWN, NULL, 1, 1, true },
	{ "trees640", GENERATED, "grove", 640, 1, false },
	{ "palms", GENERATED, "palms", 1500, 1.16, false },
	{ "outdoor", GENERATED, "outdoor", 40000, 1, true },
	{ "sunflowers", GENERATED, "sunflowers", 13001, 1, false },
	{ "trees1276", GENERATED, "grove", 1276, 1, false },
	{ "trees5000", GENERATED, "grove", 5000, 7, false },
	{ "park", GENERATED, "park", 60, 1, true },
	{ "grove", GENERATED, "grove", 320, 1, true },
	{ "forest", GENERATED, "forest", 2000, 1, true },
	{ "city", GENERATED, "city", 4000, 1, false },
	{ "scbi", SCBI, NULL, 0, 1, false } };
#define SCENES (sizeof scenes / sizeof *scenes)

static const struct scene *find(const char *name)
{
	for (size_t i = 0; i < SCENES; i++)
		if (!strcmp(scenes[i].name, name))
			return &scenes[i];
	return NULL;
}

bool bench_scene_asked(struct bench *bench, const char *name)
{
	bool asked = bench->full || find(name)->quick;
	if (!asked)
		bench_left_out(bench, name);
	return asked;
}

/* ---- Stamps ---- */

/* The stamp beside the file `what`, or "". */
static void stamp_read(const char *what, char text[STAMP])
{
	char path[PATH + 16];
	snprintf(path, sizeof path, "%s.stamp", what);
	FILE *file = fopen(path, "rb");
	text[file ? fread(text, 1, STAMP - 1, file) : 0] = 0;
	if (file)
		fclose(file);
}

static bool stamp_fits(const char *what, const char *stamp)
{
	char text[STAMP];
	stamp_read(what, text);
	return !access(what, R_OK) && !strcmp(text, stamp);
}

static void stamp_write(const char *what, const char *stamp)
{
	char path[PATH + 16];
	snprintf(path, sizeof path, "%s.stamp", what);
	file_write_text(path, stamp);
}

static void scene_stamp(const struct bench *bench, const struct scene *s, const char *order, char stamp[STAMP])
{
	static uint64_t program;
	char path[PATH];
	snprintf(path, sizeof path, "%s/ecopack", bench->build);
	program = program ? program : bench_file_hash(path);
	snprintf(stamp, STAMP, "%s %s %u %g %s %016llx %s", s->name, s->kind ? s->kind : "-", s->plants,
		s->detail, order ? order : "-", (unsigned long long)program,
		s->origin == SCBI ? bench->data : "");
}

const char *bench_pack_stamp(const char *path)
{
	static char stamp[STAMP];
	stamp_read(path, stamp);
	return stamp;
}

/* ---- Folders with scene.json ---- */

static void make_crown(const char *folder)
{
	char path[PATH];
	must(bench_crown_write(folder, "crown", must_error));
	snprintf(path, sizeof path, "%s/scene.json", folder);
	file_write_text(path, "{\"name\": \"crown\", \"plants\": {\"tree\": {\"model\": "
		"\"crown.obj\"}},\n \"instances\": [{\"plant\": \"tree\", \"at\": [0, 0, 0]}]}\n");
	snprintf(path, sizeof path, "%s/camera.json", folder);
	FILE *out = fopen(path, "wb");
	must(out ? ECO_OK : eco_fail(must_error, ECO_IO, "%s cannot be written", path));
	fputs("{\"fps\": 1, \"keyframes\": [", out);
	/* once around, from above down to eye level */
	for (int i = 0; i <= 16; i++) {
		double turn = 0.35 + i * 2 * M_PI / 16, r = 26 - 0.45 * i,
			z = 1.7 + 20 * (16 - i) / 16.0 * (16 - i) / 16.0;
		fprintf(out, "%s\n  {\"time_s\": %d, \"eye\": [%.2f, %.2f, %.2f], \"target\": [0, 0, 6.5], "
			"\"fov_y_deg\": 42}", i ? "," : "", i, r * cos(turn), r * sin(turn), z);
	}
	fputs("\n]}\n", out);
	fclose(out);
}

static enum eco_code find_data(const struct bench *bench, const char *name, struct eco_error *error)
{
	char path[PATH];
	snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", bench->data ? bench->data : "");
	return strcmp(name, "scbi") || (bench->data && !access(path, R_OK)) ? ECO_OK
		: eco_fail(error, ECO_NOT_FOUND, "scbi is a forest inventory of the data folder: give it with --data "
		"(make bench DATA=DIR)");
}

bool bench_scene_there(struct bench *bench, const char *name, char pack[512])
{
	struct eco_error why = { 0 };
	if (!bench_scene_asked(bench, name))
		return false;
	if (!find_data(bench, name, &why)) {
		bench_scene(bench, name, NULL, pack);
		return true;
	}
	bench_say(bench, "Without %s: %s", name, why.text);
	return false;
}

static void make_folder(struct bench *bench, const struct scene *s, char folder[PATH])
{
	char stamp[STAMP], scene[PATH];
	snprintf(folder, PATH, "%.900s/scenes/%s", bench->cache, s->name);
	snprintf(scene, sizeof scene, "%.1000s/scene.json", folder);
	must(find_data(bench, s->name, must_error));
	scene_stamp(bench, s, NULL, stamp);
	if (stamp_fits(scene, stamp))
		return;
	bench_progress(0, s->name);
	folder_make(folder);
	if (s->origin == CROWN)
		make_crown(folder);
	else if (s->origin == SCBI)
		bench_command("BUILD='%s' OUT='%s' DATA='%s' sh tests/demo/forest_scene.sh", bench->build,
			folder, bench->data);
	else
		bench_command("'%s/ecopack' generate %s -o '%s' --plants %u --detail %g --quiet",
			bench->build, s->kind, folder, s->plants, s->detail);
	stamp_write(scene, stamp);
}

/* ---- Packs ---- */

void bench_scene(struct bench *bench, const char *name, const char *order, char path[512])
{
	const struct scene *s = find(name);
	char folder[PATH], stamp[STAMP];
	make_folder(bench, s, folder);
	scene_stamp(bench, s, order, stamp);
	snprintf(path, 512, "%.400s/packs/%s%s%s.eco", bench->cache, name, order ? "-" : "", order ? order : "");
	if (stamp_fits(path, stamp))
		return;
	eco_progress_note("building %s%s%s", name, order ? ", leaves in order: " : "", order ? order : "");
	bench_command("mkdir -p '%s/packs' && '%s/ecopack' make '%s/scene.json' -o '%s'%s%s%s --cache '%s/plants' "
		"--cache-mb 16384", bench->cache, bench->build, folder, path, order ? " --order " : "",
		order ? order : "", bench->quiet ? " --quiet" : "", bench->cache);
	stamp_write(path, stamp);
}

void bench_model_pack(struct bench *bench, const struct bench_model *model, char pack[512])
{
	char scene[512];
	snprintf(scene, sizeof scene, "%.400s/packs", bench->cache);
	folder_make(scene);
	snprintf(scene, sizeof scene, "%.400s/packs/alone-%.60s.json", bench->cache, model->name);
	snprintf(pack, 512, "%.400s/packs/alone-%.60s.eco", bench->cache, model->name);
	char *place = realpath(model->path, NULL);   /* a scene's paths are relative to its own folder */
	json_t *made = json_pack("{s:s, s:{s:{s:s?}}, s:[{s:s, s:[i,i,i]}]}", "name", model->name, "plants",
		"plant", "model", place, "instances", "plant", "plant", "at", 0, 0, 0);
	must(json_dump_file(made, scene, 0) ? eco_fail(must_error, ECO_IO, "%s cannot be written", scene) : ECO_OK);
	json_decref(made);
	free(place);
	bench_command("'%s/ecopack' make '%s' -o '%s' --quiet --cache '%s/plants' --cache-mb 16384",
		bench->build, scene, pack, bench->cache);
}

/* ---- Views ---- */

#define VIEW_WIDTH 800u
#define VIEW_HEIGHT 600u
#define VIEWS_FPS 32.0

/* The scene's camera script with many frames between its keyframes. */
static struct eco_camera *load_camera(struct bench *bench, const char *name)
{
	char path[PATH];
	struct eco_camera *camera = NULL;
	snprintf(path, sizeof path, "%s/scenes/%s/camera.json", bench->cache, name);
	json_t *script = json_load_file(path, 0, NULL);
	if (!script)
		return NULL;
	json_object_set_new(script, "fps", json_real(VIEWS_FPS));
	char *text = json_dumps(script, JSON_COMPACT);
	json_decref(script);
	if (text && eco_camera_parse(&camera, text, strlen(text), path, NULL))
		camera = NULL;
	free(text);
	return camera;
}

uint32_t bench_scene_views(struct bench *bench, const char *name, struct eco_request *requests, uint32_t room)
{
	const struct scene *s = find(name);
	char folder[PATH];
	if (!s || !room)
		return 0;
	make_folder(bench, s, folder);
	struct eco_camera *camera = load_camera(bench, name);
	if (!camera)
		return 0;
	uint32_t frames = eco_camera_frame_count(camera);
	for (uint32_t i = 0; i < room; i++) {
		requests[i] = (struct eco_request){ .vertices = 1000000, .bytes = ECO_BYTES_UNBOUNDED };
		eco_camera_frame(camera, room > 1 ? (uint32_t)((uint64_t)i * (frames - 1) / (room - 1)) : 0,
			&requests[i].view);
		requests[i].view.width = VIEW_WIDTH;
		requests[i].view.height = VIEW_HEIGHT;
	}
	eco_camera_free(camera);
	return room;
}
