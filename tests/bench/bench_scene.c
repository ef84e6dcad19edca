/* The scenes that methods are compared on, made when they are first asked for and kept in the cache.
 *
 * Most are of `ecopack generate`, in the sizes of the literature: 640 trees of 10 M triangles, 1,500 palms of 12 M, an outdoor scene of 120 M,
 * 13,000 sunflowers and a maple of 70 M (Deussen 2002, table 1); 1,276 trees of 63 M vertices and 5,000 of 1.3 G (Neubert 2011). `detail`
 * multiplies the leaves until the sum fits. A forest inventory comes from the data folder.
 *
 * A scene is a folder with scene.json and camera.json, a pack one file per order. Each has a stamp beside it of what it was made from:
 * ecopack itself, what it was told, and the files that it read. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "ecofiles/view.h"
#include "tests/bench/bench_crown.h"
#include "tests/bench/bench_state.h"

#define PATH 1024

enum origin { GENERATED, CROWN, SCBI };
static const struct scene { const char *name; enum origin origin; const char *kind; unsigned plants; double detail; } scenes[] = {
	{ "crown", CROWN, NULL, 1, 1 },
	{ "trees640", GENERATED, "grove", 640, 1 },
	{ "palms", GENERATED, "palms", 1500, 1.16 },
	{ "outdoor", GENERATED, "outdoor", 40000, 1 },
	{ "sunflowers", GENERATED, "sunflowers", 13001, 1 },
	{ "trees1276", GENERATED, "grove", 1276, 1 },
	{ "trees5000", GENERATED, "grove", 5000, 7 },
	{ "scbi", SCBI, NULL, 0, 1 } };
#define SCENES (sizeof scenes / sizeof *scenes)
const char *const bench_scene_names[] = { "crown", "trees640", "palms", "outdoor", "sunflowers", "trees1276", "trees5000", "scbi", NULL };

static const struct scene *find(const char *name)
{
	for (size_t i = 0; i < SCENES; i++)
		if (!strcmp(scenes[i].name, name))
			return &scenes[i];
	return NULL;
}

/* ---- Stamps ---- */

/* Of a file: its bytes where it is small, else size and time. */
static uint64_t stamp_of_file(const char *path)
{
	struct stat status;
	if (stat(path, &status))
		return 0;
	uint64_t parts[3] = { (uint64_t)status.st_size, (uint64_t)status.st_mtim.tv_sec, (uint64_t)status.st_mtim.tv_nsec };
	return XXH3_64bits(parts, sizeof parts);
}

static uint64_t stamp_of_program(const struct bench *bench)
{
	static uint64_t kept;
	char path[PATH];
	snprintf(path, sizeof path, "%s/ecopack", bench->build);
	FILE *file = kept ? NULL : fopen(path, "rb");
	if (file) {
		static char part[1 << 16];
		XXH3_state_t *hash = XXH3_createState();
		XXH3_64bits_reset(hash);
		for (size_t n; (n = fread(part, 1, sizeof part, file)) > 0;)
			XXH3_64bits_update(hash, part, n);
		kept = XXH3_64bits_digest(hash);
		XXH3_freeState(hash);
		fclose(file);
	}
	return kept;
}

static bool stamp_fits(const struct bench *bench, const char *what, const char *stamp)
{
	char path[PATH + 32], line[256] = "";
	snprintf(path, sizeof path, "%s.stamp", what);
	FILE *file = fopen(path, "rb");
	if (file) {
		line[fread(line, 1, sizeof line - 1, file)] = 0;
		fclose(file);
	}
	return !access(what, R_OK) && *line && (bench->state->trust || !strcmp(line, stamp));
}

static enum eco_code stamp_write(const char *what, const char *stamp, struct eco_error *error)
{
	char path[PATH + 32];
	snprintf(path, sizeof path, "%s.stamp", what);
	return bench_file_write(path, stamp, strlen(stamp), error);
}

/* ---- Folders with scene.json ---- */

static enum eco_code make_crown(struct bench *bench, const char *folder, struct eco_error *error)
{
	static const char scene[] = "{\"name\": \"crown\", \"plants\": {\"tree\": {\"model\": \"crown.obj\"}},\n"
		" \"instances\": [{\"plant\": \"tree\", \"at\": [0, 0, 0]}]}\n";
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
		double turn = 0.35 + i * 2 * M_PI / 16, r = 26 - 0.45 * i, z = 1.7 + 20 * (16 - i) / 16.0 * (16 - i) / 16.0;
		fprintf(out, "%s\n  {\"time_s\": %d, \"eye\": [%.2f, %.2f, %.2f], \"target\": [0, 0, 6.5], \"fov_y_deg\": 42}", i ? "," : "", i, r * cos(turn),
			r * sin(turn), z);
	}
	fputs("\n]}\n", out);
	fclose(out);
	if (!code)
		code = bench_file_write(path, text, size, error);
	free(text);
	snprintf(path, sizeof path, "%s/scene.json", folder);
	return code ? code : bench_file_write(path, scene, sizeof scene - 1, error);
}

static enum eco_code make_scbi(struct bench *bench, const char *folder, struct eco_error *error)
{
	char path[PATH];
	if (!bench->data)
		return eco_fail(error, ECO_NOT_FOUND, "scbi is a forest inventory of the data folder: give it with --data (make bench DATA=DIR)");
	snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", bench->data);
	if (access(path, R_OK))
		return eco_fail(error, ECO_NOT_FOUND, "scbi: %.400s is not there", path);
	return bench_command(bench, error, "BUILD='%s' OUT='%s' DATA='%s' sh tests/demo/forest_scene.sh", bench->build, folder, bench->data);
}

static void scene_stamp(const struct bench *bench, const struct scene *s, char stamp[128])
{
	char path[PATH];
	uint64_t data = 0;
	if (s->origin == SCBI && bench->data) {
		snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", bench->data);
		data = stamp_of_file(path) ^ XXH3_64bits(bench->data, strlen(bench->data));
	}
	snprintf(stamp, 128, "%s %s %u %g %016llx %016llx\n", s->name, s->kind ? s->kind : "-", s->plants, s->detail,
		(unsigned long long)stamp_of_program(bench), (unsigned long long)data);
}

static enum eco_code make_folder(struct bench *bench, const struct scene *s, char folder[PATH], struct eco_error *error)
{
	char stamp[128], scene[PATH + 16];
	snprintf(folder, PATH, "%s/scenes/%s", bench->cache, s->name);
	snprintf(scene, sizeof scene, "%s/scene.json", folder);
	scene_stamp(bench, s, stamp);
	if (stamp_fits(bench, scene, stamp))
		return ECO_OK;
	enum eco_code code = bench_folder_make(folder, error);
	bench_progress(bench, 0, s->name);
	if (!code && s->origin == GENERATED)
		code = bench_command(bench, error, "'%s/ecopack' generate %s -o '%s' --plants %u --detail %g --quiet", bench->build, s->kind, folder, s->plants,
			s->detail);
	else if (!code)
		code = s->origin == CROWN ? make_crown(bench, folder, error) : make_scbi(bench, folder, error);
	return code ? code : stamp_write(scene, stamp, error);
}

/* ---- Packs ---- */

enum eco_code bench_scene(struct bench *bench, const char *name, const char *order, char path[512], struct eco_error *error)
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
	if (snprintf(path, 512, "%s/packs/%s%s%s.eco", bench->cache, name, order ? "-" : "", order ? order : "") >= 512)
		return eco_fail(error, ECO_BAD_INPUT, "%s: path too long", bench->cache);
	if (stamp_fits(bench, path, stamp))
		return ECO_OK;
	char packs[PATH];
	snprintf(packs, sizeof packs, "%s/packs", bench->cache);
	code = bench_folder_make(packs, error);
	bench_note(bench, "building %s%s%s", name, order ? ", leaves in order: " : "", order ? order : "");
	if (!code)
		code = bench_command(bench, error, "'%s/ecopack' make '%s/scene.json' -o '%s'%s%s%s --cache '%s/plants' --cache-mb 16384", bench->build, folder, path,
			order ? " --order " : "", order ? order : "", bench->state->quiet ? " --quiet" : "", bench->cache);
	return code ? code : stamp_write(path, stamp, error);
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
		eco_camera_frame(camera, room > 1 ? (uint32_t)((uint64_t)i * (frames - 1) / (room - 1)) : 0, &requests[i].view);
		requests[i].view.width = VIEW_WIDTH;
		requests[i].view.height = VIEW_HEIGHT;
	}
	eco_camera_free(camera);
	return room;
}
