/* The scenes that methods are compared on, made when they are first asked for and kept in the cache.
 *
 * Most are of `ecopack generate`, in the sizes of the literature: 640 trees of 10 M triangles, 1,500 palms of
 * 12 M, an outdoor scene of 120 M, 13,000 sunflowers and a maple of 70 M (Deussen 2002, table 1); 1,276 trees
 * of 63 M vertices and 5,000 of 1.3 G (Neubert 2011). `detail` multiplies the leaves until the sum fits. A
 * forest inventory comes from the data folder.
 *
 * A scene is a folder with scene.json and camera.json, a pack one file per order. Each has a stamp beside it
 * of its sources: ecopack itself, its options, and the files that it read; a pack's also holds a hash of the
 * pack. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/format/view.h"
#include "tests/bench/bench_state.h"

#define PATH 1024

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

bool bench_scene_quick(const char *name)
{
	const struct scene *scene = find(name);
	return scene && scene->quick;
}

/* ---- Stamps ---- */

/* Stamp of a file: of its bytes where it is small, else of size and time. */
static uint64_t stamp_of_file(const char *path)
{
	struct stat status;
	if (stat(path, &status))
		return 0;
	uint64_t parts[3] = { (uint64_t)status.st_size, (uint64_t)status.st_mtim.tv_sec,
		(uint64_t)status.st_mtim.tv_nsec };
	return XXH3_64bits(parts, sizeof parts);
}

static uint64_t stamp_of_program(const struct bench *bench)
{
	static uint64_t kept;
	char path[PATH];
	snprintf(path, sizeof path, "%s/ecopack", bench->build);
	kept = kept ? kept : bench_file_hash(path);
	return kept;
}

/* The stamp beside the file `what`, or "". */
static void stamp_read(const char *what, char text[512])
{
	char path[PATH + 32];
	snprintf(path, sizeof path, "%s.stamp", what);
	FILE *file = fopen(path, "rb");
	text[file ? fread(text, 1, 511, file) : 0] = 0;
	if (file)
		fclose(file);
}

static bool stamp_fits(const struct bench *bench, const char *what, const char *stamp)
{
	char text[512];
	stamp_read(what, text);
	return !access(what, R_OK) && *text && (bench->state->trust || !strncmp(text, stamp, strlen(stamp)));
}

static enum eco_code stamp_write(const char *what, const char *stamp, struct eco_error *error)
{
	char path[PATH + 32];
	snprintf(path, sizeof path, "%s.stamp", what);
	return eco_file_write(path, stamp, strlen(stamp), error);
}

/* ---- Folders with scene.json ---- */

static enum eco_code make_crown(struct bench *bench, const char *folder, struct eco_error *error)
{
	static const char scene[] = "{\"name\": \"crown\", \"plants\": {\"tree\": {\"model\": "
		"\"crown.obj\"}},\n \"instances\": [{\"plant\": \"tree\", \"at\": [0, 0, 0]}]}\n";
	char path[PATH], *text = NULL;
	size_t size = 0;
	(void)bench;
	enum eco_code code = bench_crown_write(folder, "crown", error);
	snprintf(path, sizeof path, "%s/camera.json", folder);
	FILE *out = open_memstream(&text, &size);
	if (!code && !out)
		return eco_fail(error, ECO_NO_MEMORY, "no memory");
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
	if (!code)
		code = eco_file_write(path, text, size, error);
	free(text);
	snprintf(path, sizeof path, "%s/scene.json", folder);
	return code ? code : eco_file_write(path, scene, sizeof scene - 1, error);
}

static enum eco_code make_scbi(struct bench *bench, const char *folder, struct eco_error *error)
{
	char path[PATH];
	if (!bench->data)
		return eco_fail(error, ECO_NOT_FOUND, "scbi is a forest inventory of the data folder: give "
			"it with --data (make bench DATA=DIR)");
	snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", bench->data);
	if (access(path, R_OK))
		return eco_fail(error, ECO_NOT_FOUND, "scbi: %.400s is not there", path);
	return bench_command(bench, error, "BUILD='%s' OUT='%s' DATA='%s' sh tests/demo/forest_scene.sh",
		bench->build, folder, bench->data);
}

static void scene_stamp(const struct bench *bench, const struct scene *s, char stamp[128])
{
	char path[PATH];
	uint64_t data = 0;
	if (s->origin == SCBI && bench->data) {
		snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", bench->data);
		data = stamp_of_file(path) ^ XXH3_64bits(bench->data, strlen(bench->data));
	}
	snprintf(stamp, 128, "%s %s %u %g %016llx %016llx\n", s->name, s->kind ? s->kind : "-", s->plants,
		s->detail, (unsigned long long)stamp_of_program(bench), (unsigned long long)data);
}

static enum eco_code make_folder(struct bench *bench, const struct scene *s, char folder[PATH],
	struct eco_error *error)
{
	char stamp[128], scene[PATH + 16];
	snprintf(folder, PATH, "%s/scenes/%s", bench->cache, s->name);
	snprintf(scene, sizeof scene, "%s/scene.json", folder);
	scene_stamp(bench, s, stamp);
	if (stamp_fits(bench, scene, stamp))
		return ECO_OK;
	enum eco_code code = bench_command(bench, error, "mkdir -p '%s'", folder);
	bench_progress(bench, 0, s->name);
	if (!code && s->origin == GENERATED)
		code = bench_command(bench, error, "'%s/ecopack' generate %s -o '%s' --plants %u --detail "
			"%g --quiet", bench->build, s->kind, folder, s->plants, s->detail);
	else if (!code)
		code = s->origin == CROWN ? make_crown(bench, folder, error)
			: make_scbi(bench, folder, error);
	return code ? code : stamp_write(scene, stamp, error);
}

/* ---- Packs ---- */

static enum eco_code make_pack(struct bench *bench, const char *name, const char *order, const char *path,
	const char *stamp, struct eco_error *error)
{
	char folder[PATH], text[512];
	snprintf(folder, sizeof folder, "%s/scenes/%s", bench->cache, name);
	bench_note(bench, "building %s%s%s", name, order ? ", leaves in order: " : "", order ? order : "");
	enum eco_code code = bench_command(bench, error, "'%s/ecopack' make '%s/scene.json' -o '%s'%s%s%s "
		"--cache '%s/plants' --cache-mb 16384", bench->build, folder, path, order ? " --order " : "",
		order ? order : "", bench->state->quiet ? " --quiet" : "", bench->cache);
	snprintf(text, sizeof text, "%.320sholds %016llx\n", stamp,
		(unsigned long long)bench_file_hash(path));
	return code ? code : stamp_write(path, text, error);
}

enum eco_code bench_scene(struct bench *bench, const char *name, const char *order, char path[512],
	struct eco_error *error)
{
	const struct scene *s = find(name);
	char folder[PATH], stamp[256], of_scene[128];
	if (!s)
		return eco_fail(error, ECO_BAD_USAGE, "no scene is called %s", name);
	enum eco_code code = make_folder(bench, s, folder, error);
	if (code)
		return code;
	scene_stamp(bench, s, of_scene);
	snprintf(stamp, sizeof stamp, "%s %s", order ? order : "-", of_scene);
	if (snprintf(path, 512, "%s/packs/%s%s%s.eco", bench->cache, name, order ? "-" : "",
			order ? order : "") >= 512)
		return eco_fail(error, ECO_BAD_INPUT, "%s: path too long", bench->cache);
	if (stamp_fits(bench, path, stamp))
		return ECO_OK;
	code = bench_command(bench, error, "mkdir -p '%s/packs'", bench->cache);
	return code ? code : make_pack(bench, name, order, path, stamp, error);
}

const char *bench_pack_stamp(const char *path)
{
	static char holds[64];
	char text[512];
	stamp_read(path, text);
	const char *at = strstr(text, "\nholds ");
	snprintf(holds, sizeof holds, "pack %.16s", at ? at + 7 : "");
	return holds;
}

enum eco_code bench_model_pack(struct bench *bench, const struct bench_model *model, char pack[512],
	struct eco_error *error)
{
	char scene[512];
	snprintf(scene, sizeof scene, "%.400s/packs/alone-%.60s.json", bench->cache, model->name);
	snprintf(pack, 512, "%.400s/packs/alone-%.60s.eco", bench->cache, model->name);
	enum eco_code code = bench_command(bench, error, "mkdir -p '%s/packs'", bench->cache);
	char *place = realpath(model->path, NULL);   /* a scene's paths are relative to its own folder */
	if (!code && !place)
		code = eco_fail(error, ECO_IO, "%s: %s", model->path, strerror(errno));
	FILE *out = code ? NULL : fopen(scene, "wb");
	if (!code && !out)
		code = eco_fail(error, ECO_IO, "%s cannot be written", scene);
	if (!code) {
		json_t *made = json_pack("{s:s, s:{s:{s:s}}, s:[{s:s, s:[i,i,i]}]}", "name", model->name,
			"plants", "plant", "model", place, "instances", "plant", "plant", "at", 0, 0, 0);
		json_dumpf(made, out, 0);
		json_decref(made);
		fclose(out);
		code = bench_command(bench, error, "'%s/ecopack' make '%s' -o '%s' --quiet --cache "
			"'%s/plants' --cache-mb 16384", bench->build, scene, pack, bench->cache);
	}
	free(place);
	return code;
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
	json_t *script = bench_json_read(path);
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
	if (!s || !room || make_folder(bench, s, folder, NULL))
		return 0;
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
