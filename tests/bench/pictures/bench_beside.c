/* glTF: all plants whose bounds meet the view, at full detail or simplified by gltfpack (-si, -sa), instanced
 * and compressed by it, and the ground in sight. Bytes are those of its files and of the textures' outlines.
 * What it has written is read, packed as plants without levels, and drawn as ours are, so quantisation and
 * simplification count. Draco is not among them: its encoder knows no instances. */
#include "tests/bench/pictures/bench_beside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/format/texture.h"
#include "lod/raster/flip.h"
#include "tests/bench/pictures/bench_gltf.h"

const char bench_beside_chunks[] = "all chunks", bench_beside_gltf[] = "glTF -cc",
	bench_beside_fast[] = "glTF -c", bench_beside_webp[] = "WebP";

/* What gltfpack is told besides -mi; from most to least simplified. */
static const struct setting { const char *method, *name, *options; } settings[] = {
	{ bench_beside_gltf, "1 % of triangles", "-cc -si 0.01 -sa" },
	{ bench_beside_gltf, "10 % of triangles", "-cc -si 0.1 -sa" },
	{ bench_beside_gltf, "full detail", "-cc" },
	{ bench_beside_fast, "full detail", "-c" } };
#define SETTINGS (sizeof settings / sizeof *settings)

static const size_t stills[] = { 10000, 20000, 50000, 100000, 300000 };

struct bench_beside {
	struct bench *bench;
	char folder[600], version[64];       /* of gltfpack; "": it is not installed */
	char pack[512];                      /* that what follows is of; "": none */
	struct bench_full full;
	struct bench_client *whole, *drawn[SETTINGS];
};

/* ---- A scene ---- */

static void leave_scene(struct bench_beside *b)
{
	for (size_t i = 0; i < SETTINGS; i++) {
		bench_client_close(b->drawn[i]);
		b->drawn[i] = NULL;
	}
	bench_client_close(b->whole);
	b->whole = NULL;
	bench_full_close(&b->full);
	*b->pack = 0;
}

/* A client of the scene whose plants are what gltfpack makes of them. */
static enum eco_code open_drawn(struct bench_beside *b, size_t setting, struct eco_error *error)
{
	char glb[700], pack[700];
	struct bench_full read = { 0 };
	snprintf(glb, sizeof glb, "%s/kinds-%zu.glb", b->folder, setting);
	snprintf(pack, sizeof pack, "%s/kinds-%zu.eco", b->folder, setting);
	enum eco_code code = bench_command(b->bench, error, "gltfpack %s -kn -km -i '%s/kinds.gltf' -o '%s'",
		settings[setting].options, b->folder, glb);
	if (!code)
		code = bench_gltf_read(&read, &b->full, glb, error);
	if (!code)
		code = bench_gltf_pack(&b->full, &read, pack, error);
	bench_full_close(&read);
	if (!code)
		code = bench_client_open(&b->drawn[setting], pack, error);
	if (!code)
		bench_client_untimed(b->drawn[setting]);
	return code;
}

static enum eco_code enter_scene(struct bench_beside *b, const char *pack, struct eco_error *error)
{
	char path[700];
	if (!strcmp(b->pack, pack))
		return ECO_OK;
	leave_scene(b);
	snprintf(path, sizeof path, "%s/kinds.gltf", b->folder);
	enum eco_code code = bench_client_open(&b->whole, pack, error);
	if (!code)
		code = bench_full_open(&b->full, pack, error);
	if (!code)
		code = bench_command(b->bench, error, "rm -rf '%s' && mkdir -p '%s'", b->folder, b->folder);
	if (!code)
		code = bench_gltf_buffer(&b->full, b->folder, error);
	if (!code)
		code = bench_gltf_kinds(&b->full, path, error);
	for (size_t i = 0; i < SETTINGS && *b->version && !code; i++)
		code = open_drawn(b, i, error);
	if (!code)
		snprintf(b->pack, sizeof b->pack, "%s", pack);
	return code;
}

/* ---- Rows ---- */

struct row { const char *method, *setting; double bytes, vertices; };

/* `score` NULL: a still, which has no owners. */
static void add_row(json_t *rows, const struct row *row, const struct lod_score *score, double wrong)
{
	json_t *item = json_pack("{s:s, s:s}", "method", row->method, "setting", row->setting);
	bench_shot_set(item, "bytes", row->bytes);
	bench_shot_set(item, "vertices", row->vertices);
	bench_shot_set(item, "q", score ? score->q : NAN);
	bench_shot_set(item, "skill", score ? score->skill : NAN);
	bench_shot_set(item, "owner_q", score ? score->owner_q : NAN);
	bench_shot_set(item, "picture_error", wrong);
	json_array_append_new(rows, item);
}

static enum eco_code look(const uint8_t *rgb, const struct view_picture *full, double *wrong,
	struct eco_error *error)
{
	return lod_flip(&(struct lod_flip_input){ full->width, full->height, rgb, full->rgb, NULL }, wrong,
		error);
}

/* ---- All chunks ---- */

static enum eco_code add_chunks(struct bench_beside *b, json_t *rows, struct eco_error *error)
{
	const struct lod_score same = { .q = 1, .skill = 1, .owner_q = 1 };
	uint64_t bytes = 0;
	enum eco_code code = bench_full_bytes(&b->full.pack->scene, &bytes, error);
	if (!code)
		add_row(rows, &(struct row){ bench_beside_chunks, "full detail", (double)bytes, NAN }, &same,
			0);
	return code;
}

/* ---- glTF ---- */

static double file_bytes(const char *folder, const char *name)
{
	char path[700];
	struct stat status;
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return stat(path, &status) ? NAN : (double)status.st_size;
}

/* Draws what one setting leaves of the plants. */
static enum eco_code draw_setting(struct bench_beside *b, size_t setting, const struct bench_view *view,
	double bytes, json_t *rows, struct eco_error *error)
{
	const struct view_picture *full = bench_client_full(b->whole), *drawn;
	struct lod_score score;
	double wrong;
	enum eco_code code = bench_client_reference(b->drawn[setting],
		&(struct eco_request){ .view = view->view }, NULL, error);
	if (code)
		return code;
	drawn = bench_client_full(b->drawn[setting]);
	lod_score(&score, &(struct lod_score_input){ full->width, full->height, drawn->cover, full->cover,
		drawn->owner, full->owner });
	code = look(drawn->rgb, full, &wrong, error);
	if (!code)
		add_row(rows, &(struct row){ settings[setting].method, settings[setting].name, bytes,
			(double)drawn->vertices }, &score, wrong);
	return code;
}

static enum eco_code add_setting(struct bench_beside *b, size_t setting, const struct bench_view *view,
	bool ground, uint64_t outlines, json_t *rows, struct eco_error *error)
{
	const char *options = settings[setting].options;
	double bytes = (double)outlines;
	/* the ground is what it is: -c or -cc alone */
	enum eco_code code = bench_command(b->bench, error, "cd '%s' && gltfpack %s -mi -i view.gltf "
		"-o view.glb", b->folder, options);
	if (!code && ground)
		code = bench_command(b->bench, error, "cd '%s' && gltfpack %.*s -i ground.gltf -o ground.glb",
			b->folder, (int)strcspn(options, " "), options);
	bytes += file_bytes(b->folder, "view.glb") + (ground ? file_bytes(b->folder, "ground.glb") : 0);
	return code ? code : draw_setting(b, setting, view, bytes, rows, error);
}

static enum eco_code add_gltf(struct bench_beside *b, const struct bench_view *view, json_t *rows,
	struct eco_error *error)
{
	char path[700];
	struct lod_eye eye;
	uint64_t plants, outlines;
	bool ground;
	lod_eye_make(&eye, &view->view);
	snprintf(path, sizeof path, "%s/view.gltf", b->folder);
	enum eco_code code = bench_gltf_view(&b->full, &eye, path, &plants, &outlines, error);
	snprintf(path, sizeof path, "%s/ground", b->folder);
	if (!code)
		code = bench_gltf_ground(&b->full, &eye, path, &ground, error);
	for (size_t i = 0; i < SETTINGS && !code && plants; i++)
		code = bench_stopped(b->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: add_setting(b, i, view, ground, outlines, rows, error);
	return code;
}

/* ---- A still ---- */

/* The best picture of at most so many bytes. Its quality; 0: there is none. */
static enum eco_code encode(const struct view_picture *full, size_t budget, struct eco_writer *best,
	unsigned *quality, struct eco_error *error)
{
	const struct eco_texture_part part = { full->width, full->height, 3, full->rgb };
	unsigned low = 0, high = 101;
	while (high - low > 1) {
		unsigned middle = (low + high) / 2;
		struct eco_writer w = { 0 };
		enum eco_code code = eco_texture_write_colors(&w, &part, middle, error);
		bool fits = !code && w.size <= budget;
		eco_writer_free(fits ? best : &w);
		if (code)
			return code;
		if (fits)
			*best = w;
		*(fits ? &low : &high) = middle;
	}
	*quality = low;
	return ECO_OK;
}

static enum eco_code add_still(const struct view_picture *full, size_t budget, json_t *rows, bool *best,
	struct eco_error *error)
{
	struct eco_writer w = { 0 };
	struct eco_texture_part part = { 0 };
	unsigned quality = 0;
	double wrong;
	char setting[32];
	enum eco_code code = encode(full, budget, &w, &quality, error);
	if (!code && quality)
		code = eco_texture_read_colors(&part, w.bytes, w.size, error);
	if (!code && quality)
		code = look(part.texels, full, &wrong, error);
	snprintf(setting, sizeof setting, "quality %u", quality);
	if (!code && quality)
		add_row(rows, &(struct row){ bench_beside_webp, setting, (double)w.size, NAN }, NULL, wrong);
	*best = quality == 100;
	eco_texture_part_free(&part);
	eco_writer_free(&w);
	return code;
}

static enum eco_code add_stills(struct bench_beside *b, json_t *rows, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	bool best = false;
	for (size_t i = 0; i < sizeof stills / sizeof *stills && !best && !code; i++)
		code = add_still(bench_client_full(b->whole), stills[i], rows, &best, error);
	return code;
}

/* ---- The door ---- */

static enum eco_code make_rows(struct bench_beside *b, const struct bench_view *view, json_t *rows,
	struct eco_error *error)
{
	enum eco_code code = enter_scene(b, view->pack, error);
	if (!code)
		code = bench_client_reference(b->whole, &(struct eco_request){ .view = view->view }, NULL,
			error);
	if (!code)
		code = add_chunks(b, rows, error);
	if (!code && *b->version)
		code = add_gltf(b, view, rows, error);
	return code ? code : add_stills(b, rows, error);
}

enum eco_code bench_beside_rows(struct bench_beside *b, const struct bench_view *view, json_t **rows,
	struct eco_error *error)
{
	char unit[96], stamp[400], of[256];
	bench_view_stamp(view, of);
	snprintf(unit, sizeof unit, "beside-%s-%s", view->scene, view->camera);
	snprintf(stamp, sizeof stamp, "%s %s", of, b->version);
	*rows = bench_recall(b->bench, unit, stamp);
	if (*rows)
		return ECO_OK;
	json_t *made = json_array();
	enum eco_code code = make_rows(b, view, made, error);
	if (code)
		json_decref(made);
	else
		*rows = bench_keep(b->bench, unit, stamp, made);
	return code;
}

static void find_gltfpack(char version[64])
{
	FILE *says = popen("gltfpack -v 2>/dev/null", "r");
	if (!says || !fgets(version, 64, says) || strncmp(version, "gltfpack", 8))
		*version = 0;
	version[strcspn(version, "\n")] = 0;
	if (says)
		pclose(says);
}

enum eco_code bench_beside_open(struct bench_beside **beside, struct bench *bench, struct eco_error *error)
{
	struct bench_beside *b = *beside = calloc(1, sizeof *b);
	if (!b)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for figures");
	b->bench = bench;
	snprintf(b->folder, sizeof b->folder, "%.500s/gltf", bench->cache);
	find_gltfpack(b->version);
	bench_say(bench, "Beside ours. All chunks: payloads of all that full detail of the whole scene is "
		"made of, whatever the view: places, triangles, the last levels of textures, the finest "
		"ground. glTF: the plants whose bounds meet the view, all at one detail, instanced and "
		"compressed by gltfpack, with the ground; read again and drawn as ours are. WebP: one "
		"picture of full detail, which shows this view and no other.");
	if (!*b->version)
		bench_say(bench, "gltfpack is not installed: apt-get install gltfpack; its rows are left "
			"out.");
	return ECO_OK;
}

void bench_beside_close(struct bench_beside *beside)
{
	if (!beside)
		return;
	leave_scene(beside);
	free(beside);
}
