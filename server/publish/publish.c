#include "server/publish/publish.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/files.h"
#include "ecofiles/format/inventory.h"
#include "server/describe.h"
#include "server/publish/index.h"
#include "server/site.h"

/* A first picture, as the viewer asks for it (client-min/web/viewer_first.js). */
#define FIRST_WIDTH 1280u
#define FIRST_HEIGHT 800u
#define FIRST_VERTICES 80000u
#define FIRST_BYTES 65536u
/* The viewer's first camera: .33 below the horizon, northwards, 45 degrees high (viewer_camera.mjs: frame). */
#define AHEAD 0.946042
#define DOWN (-0.324043)
#define HALF_TAN 0.414214
#define FOV_Y_DEG 45
#define CLOSE 0.9

#define PAGE_MARK "<meta charset=\"utf-8\">\n"   /* behind it the page gets its scenes */
#define PAGE_SCENES "<script type=\"application/json\" id=\"published\">"

struct folder {
	const char *path;
	struct srv_published *counts;
	struct eco_error *error;
};

/* ---- Files ---- */

static enum eco_code make_folder(const struct folder *f, const char *name)
{
	char path[PATH_MAX];
	if (snprintf(path, sizeof path, "%s/%s", f->path, name) >= (int)sizeof path)
		return eco_fail(f->error, ECO_BAD_USAGE, "%.200s...: the path is too long", f->path);
	return mkdir(path, 0777) && errno != EEXIST ? eco_fail(f->error, ECO_IO, "%.330s: %s%s", path, strerror(errno),
		eco_advice_write(errno)) : ECO_OK;
}

static enum eco_code write_file(const struct folder *f, const char *name, const void *bytes, size_t size)
{
	char path[PATH_MAX];
	if (snprintf(path, sizeof path, "%s/%s", f->path, name) >= (int)sizeof path)
		return eco_fail(f->error, ECO_BAD_USAGE, "%.200s...: the path is too long", f->path);
	f->counts->files++;
	f->counts->bytes += size;
	eco_unfinished_remove(path);
	return eco_file_write(path, bytes, size, f->error);
}

/* Takes the document, which is not written after a fault: `before`. */
static enum eco_code write_json(const struct folder *f, const char *name, struct srv_json *json, enum eco_code before)
{
	enum eco_code code = before;
	if (!code && srv_json_end(json))
		code = eco_no_memory(f->error, name);
	code = code ? code : write_file(f, name, json->out.bytes, json->out.size);
	eco_writer_free(&json->out);
	return code;
}

/* ---- First answers ---- */

/* As the viewer looks at a box at first. */
static struct eco_view first_view(const struct srv_outlook *look, double near_m)
{
	double half[3], tall = 10 * near_m, wide = tall;
	struct eco_view view = { .up = { 0, 0, 1 }, .fov_y_deg = FOV_Y_DEG, .width = FIRST_WIDTH, .height = FIRST_HEIGHT };
	for (int k = 0; k < 3; k++) {
		half[k] = (look->high[k] - look->low[k]) / 2;
		view.target[k] = look->low[k] + half[k];
	}
	for (int corner = 0; corner < 4; corner++) {
		double y = corner & 1 ? half[1] : -half[1], z = corner & 2 ? half[2] : -half[2];
		double nearer = y * AHEAD + z * DOWN;
		wide = fmax(wide, half[0] * FIRST_HEIGHT / FIRST_WIDTH / HALF_TAN - nearer);
		tall = fmax(tall, fabs(z * AHEAD - y * DOWN) / HALF_TAN - nearer);
	}
	double distance = CLOSE * fmin(tall, sqrt(tall * wide));
	view.eye[0] = view.target[0];
	view.eye[1] = view.target[1] - distance * AHEAD;
	view.eye[2] = view.target[2] - distance * DOWN;
	return view;
}

/* ecoserve's answer. */
static enum eco_code write_first(const struct folder *f, const char *name, const struct srv_scene *scene,
	const struct eco_view *view)
{
	struct eco_request request = { .view = *view, .vertices = FIRST_VERTICES, .bytes = FIRST_BYTES,
		.ground_px = ECO_GROUND_PX, .texel_px = ECO_TEXEL_PX };
	struct srv_stream stream;
	struct srv_body body = { 0 };
	struct eco_writer bytes = { 0 };
	enum eco_code code = eco_view_check(view, f->error);
	if (code)
		return code;
	code = srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = scene, .request = &request,
		.work_max = SRV_INDEX_PLAN_TIMES * atomic_load(&scene->typical_work) }, f->error);
	if (code)
		return code;
	code = stream.fits ? srv_stream_write(&stream, &body, f->error) : ECO_OK;
	for (uint32_t i = 0; i < body.piece_count; i++)
		eco_write_bytes(&bytes, body.pieces[i].bytes, body.pieces[i].size);
	if (bytes.failed)
		code = eco_no_memory(f->error, "a first answer");
	code = code ? code : write_file(f, name, bytes.bytes, bytes.size);
	f->counts->first_bytes += bytes.size;
	eco_writer_free(&bytes);
	srv_body_free(&body);
	srv_stream_free(&stream);
	return code;
}

/* first-0.bin, and one for each saved view; says so in the page's description. */
static enum eco_code write_views(const struct folder *f, const char *own, const struct srv_scene *scene,
	const struct eco_camera *saved, struct srv_json *page)
{
	uint32_t count = 1 + (saved ? eco_camera_key_count(saved) : 0);
	char name[PATH_MAX];
	enum eco_code code = ECO_OK;
	if (count > SRV_PUBLISH_VIEWS_MAX)
		return eco_fail(f->error, ECO_TOO_LARGE, "%u saved views; at most %u are published", count - 1,
			SRV_PUBLISH_VIEWS_MAX - 1);
	srv_json_add(page, "first:[");
	for (uint32_t i = 0; i < count && !code; i++) {
		struct eco_view view = first_view(&scene->outlook, scene->pack->scene.near_m);
		if (i)
			eco_camera_key(saved, i - 1, &view);
		view.fov_y_deg = FOV_Y_DEG;
		snprintf(name, sizeof name, "%s/first-%u.bin", own, i);
		srv_json_add(page, "{eye:[%g %g %g] target:[%g %g %g] width:%u height:%u vertices:%u bytes:%u}", view.eye[0],
			view.eye[1], view.eye[2], view.target[0], view.target[1], view.target[2], view.width, view.height,
			FIRST_VERTICES, FIRST_BYTES);
		code = write_first(f, name, scene, &view);
	}
	srv_json_add(page, "]");
	return code;
}

/* ---- Rows ---- */

struct rows { struct eco_bytes *blocks; uint32_t count; };

static void free_rows(struct rows *rows)
{
	for (uint32_t i = 0; i < rows->count; i++)
		free(rows->blocks[i].at);
	free(rows->blocks);
}

/* For each cell that is published, its number in the pack's rows; those that say how sizes are known are, too. META then
 * names these alone. */
static enum eco_code choose_cells(const struct folder *f, const struct srv_scene *scene, const struct eco_string_pool *columns,
	uint32_t cells[ECO_INVENTORY_CELLS], uint32_t *count)
{
	json_t *all = json_object_get(scene->meta, "columns"), *kept = json_array();
	for (size_t i = 0; i < columns->count + 2u; i++) {
		const char *name = i < columns->count ? columns->items[i] : i == columns->count ? ECO_INVENTORY_HEIGHT_FROM
			: ECO_INVENTORY_CROWN_FROM, *other = NULL;
		uint32_t k = 0;
		while (k < ECO_INVENTORY_CELLS && (other = json_string_value(json_array_get(all, k))) && strcmp(other, name) != 0)
			k++;
		if (k < ECO_INVENTORY_CELLS && other) {
			cells[(*count)++] = k;
			json_array_append_new(kept, json_string(name));
		} else if (i < columns->count) {
			json_decref(kept);
			return eco_fail(f->error, ECO_BAD_INPUT, "--columns: the rows of %s have no column \"%.200s\"; `ecopack make "
				"--columns` puts it into the pack", scene->name, name);
		}
	}
	json_object_set_new(scene->meta, "columns", kept);
	return ECO_OK;
}

/* The pack's rows without all that is not published: files, numbers of rows, other columns. */
static enum eco_code make_rows(const struct folder *f, const struct srv_scene *scene, const struct eco_string_pool *columns,
	struct rows *rows)
{
	const struct eco_list *list = eco_inventory_list(&scene->pack->scene);
	uint32_t cells[ECO_INVENTORY_CELLS], count = 0;
	if (!columns || !columns->count) {
		json_object_del(scene->meta, "columns");
		return ECO_OK;
	}
	enum eco_code code = choose_cells(f, scene, columns, cells, &count);
	rows->blocks = code ? NULL : calloc(list ? list->chunk_count + 1u : 1, sizeof *rows->blocks);
	if (!code && !rows->blocks)
		code = eco_no_memory(f->error, "rows");
	for (uint32_t b = 0; list && b < list->chunk_count && !code; b++) {
		struct eco_inventory_block block;
		code = eco_inventory_read(&block, scene->pack, b * (uint64_t)ECO_INVENTORY_PLACES, f->error);
		for (uint32_t i = 0; i < block.count && !code; i++) {
			struct eco_inventory_row row = { .species = block.rows[i].species };
			for (uint32_t k = 0; k < count; k++)
				row.cells[k] = block.rows[i].cells[cells[k]];
			block.rows[i] = row;
		}
		if (!code)
			rows->blocks[rows->count++] = eco_inventory_encode(block.rows, block.count);
		eco_inventory_free(&block);
	}
	return code;
}

/* ---- A scene ---- */

static enum eco_code write_index(const struct folder *f, const char *own, const struct srv_scene *scene, const struct rows *rows)
{
	struct eco_writer index = { 0 };
	char name[PATH_MAX];
	uint64_t chunk_bytes, base = UINT64_MAX;
	const struct eco_scene *tables = &scene->pack->scene;
	struct eco_writer chunks = { 0 };
	enum eco_code code = srv_index_write(&index, scene, rows->blocks, &chunk_bytes, f->error);
	snprintf(name, sizeof name, "%s/index.bin", own);
	code = code ? code : write_file(f, name, index.bytes, index.size);
	f->counts->index_bytes += index.size;
	for (uint32_t i = 0; i < tables->chunk_count && !code; i++) {
		const uint8_t *bytes;
		size_t chunk_size;
		base = tables->chunks[i].offset < base ? tables->chunks[i].offset : base;
		code = srv_scene_payload(scene, i, &bytes, &chunk_size, f->error);
	}
	snprintf(name, sizeof name, "%s/chunks.bin", own);
	if (!code && rows->count) {
		eco_write_bytes(&chunks, scene->pack->map + base, chunk_bytes);
		for (uint32_t i = 0; i < rows->count; i++)
			eco_write_bytes(&chunks, rows->blocks[i].at, rows->blocks[i].size);
		code = chunks.failed ? eco_no_memory(f->error, "chunks") : write_file(f, name, chunks.bytes, chunks.size);
	} else if (!code) {
		code = write_file(f, name, chunk_bytes ? scene->pack->map + base : NULL, chunk_bytes);
	}
	eco_writer_free(&index);
	eco_writer_free(&chunks);
	return code;
}

static enum eco_code write_scene(const struct folder *f, const struct srv_scene *scene, const struct srv_publish *publish,
	const struct eco_camera *saved, struct srv_json *page)
{
	struct rows rows = { 0 };
	static const struct srv_most most = { UINT64_MAX, UINT64_MAX };
	struct srv_json about = { 0 }, species = { 0 };
	char own[SRV_NAME_BYTES + 40], name[sizeof own + 16];
	snprintf(own, sizeof own, "%s/%s", scene->name, eco_id_text(scene->pack->id.bytes).hex);
	enum eco_code code = make_folder(f, scene->name);
	code = code ? code : make_folder(f, own);
	code = code ? code : make_rows(f, scene, publish->columns, &rows);
	code = code ? code : write_index(f, own, scene, &rows);
	free_rows(&rows);
	srv_json_add(page, "{about:");
	srv_describe_scene(page, scene, &most);
	code = code ? code : write_views(f, own, scene, saved, page);
	srv_json_add(page, "}");
	srv_describe_scene(&about, scene, &most);
	srv_describe_species(&species, scene);
	snprintf(name, sizeof name, "%s/species.json", scene->name);
	code = write_json(f, name, &species, code);
	snprintf(name, sizeof name, "%s/scene.json", scene->name);
	return write_json(f, name, &about, code);
}

/* ---- The page ---- */

/* Text of the viewer. Many hosts do not know .mjs, and browsers take no module of another type: it is .js here. */
static void add_text(struct eco_writer *out, const uint8_t *text, size_t size)
{
	static const char end[] = ".mjs";
	for (size_t i = 0; i < size; i++)
		if (text[i] != 'm' || i < 1 || size - i < 3 || memcmp(text + i - 1, end, sizeof end - 1) != 0)
			eco_write_u8(out, text[i]);
}

static bool is_text(const struct srv_site_file *file)
{
	return strncmp(file->type, "text/", 5) == 0;
}

static enum eco_code write_viewer(const struct folder *f, const struct srv_site *site)
{
	char own[sizeof "viewer/" + SRV_SITE_VERSION_BYTES], name[sizeof own + SRV_SITE_NAME_BYTES];
	snprintf(own, sizeof own, "viewer/%s", site->version);
	enum eco_code code = make_folder(f, "viewer");
	code = code ? code : make_folder(f, own);
	for (uint32_t i = 0; i < site->count && !code; i++) {
		const struct srv_site_file *file = &site->files[i];
		const uint8_t *bytes = file->forms[SRV_FORM_PLAIN].bytes;
		size_t size = file->forms[SRV_FORM_PLAIN].size;
		struct eco_writer out = { 0 }, path = { 0 };
		if (strcmp(file->name, SRV_SITE_INDEX) == 0)
			continue;
		snprintf(name, sizeof name, "%s/%s", own, file->name);
		add_text(&path, (const uint8_t *)name, strlen(name) + 1);
		if (is_text(file))
			add_text(&out, bytes, size);
		else
			eco_write_bytes(&out, bytes, size);
		code = out.failed || path.failed ? eco_no_memory(f->error, "the viewer")
			: write_file(f, (const char *)path.bytes, out.bytes, out.size);
		eco_writer_free(&out);
		eco_writer_free(&path);
	}
	return code;
}

/* The viewer's page with its scenes. '<' is escaped, so that no name of a scene ends the script. */
static enum eco_code write_page(const struct folder *f, const struct srv_site *site, const struct srv_json *page)
{
	const struct srv_site_file *file = srv_site_find(site, SRV_SITE_INDEX);
	const char *text = (const char *)file->forms[SRV_FORM_PLAIN].bytes, *mark = strstr(text, PAGE_MARK);
	struct eco_writer out = { 0 };
	if (!mark)
		return eco_fail(f->error, ECO_BAD_INPUT, "the viewer's page has no %.22s: build both, viewer and ecopack",
			PAGE_MARK);
	mark += strlen(PAGE_MARK);
	add_text(&out, (const uint8_t *)text, (size_t)(mark - text));
	eco_write_format(&out, PAGE_SCENES);
	for (size_t i = 0; i < page->out.size; i++)
		if (page->out.bytes[i] == '<')
			eco_write_format(&out, "\\u003c");
		else
			eco_write_u8(&out, page->out.bytes[i]);
	eco_write_format(&out, "</script>\n");
	add_text(&out, (const uint8_t *)mark, strlen(mark));
	enum eco_code code = out.failed ? eco_no_memory(f->error, "the page") : write_file(f, SRV_SITE_INDEX, out.bytes, out.size);
	eco_writer_free(&out);
	return code;
}

/* A page that was not published is not replaced. */
static enum eco_code check_page(const struct folder *f)
{
	char path[PATH_MAX];
	struct eco_error why = { 0 };
	uint8_t *bytes;
	size_t size;
	snprintf(path, sizeof path, "%s/" SRV_SITE_INDEX, f->path);
	enum eco_code code = eco_file_read(path, UINT32_MAX, &bytes, &size, &why);
	bool ours = code == ECO_NOT_FOUND || (!code && strstr((const char *)bytes, PAGE_SCENES));
	free(bytes);
	return ours ? ECO_OK : code ? eco_fail(f->error, code, "%s", why.text)
		: eco_fail(f->error, ECO_BAD_USAGE, "%.330s is a page of another kind: name another folder, or remove it", path);
}

/* ---- All ---- */

static enum eco_code publish_all(const struct folder *f, const struct srv_store *store, const struct srv_site *site,
	const struct srv_publish *publish, const struct eco_camera *saved)
{
	struct srv_json page = { 0 };
	enum eco_code code = make_folder(f, "");
	code = code ? code : check_page(f);
	code = code ? code : write_viewer(f, site);
	srv_json_add(&page, "[");
	for (uint32_t i = 0; i < store->count && !code; i++)
		code = write_scene(f, store->scenes[i], publish, saved, &page);
	srv_json_add(&page, "]");
	code = code ? code : srv_json_end(&page);
	code = code ? code : write_page(f, site, &page);
	eco_writer_free(&page.out);
	return code ? code : eco_folder_sync(f->path, f->error);
}

static enum eco_code open_packs(struct srv_store *store, const struct srv_publish *publish, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < publish->count && !code; i++) {
		char name[SRV_NAME_BYTES + 1];
		const char *path = srv_source_path(publish->packs[i], name);
		code = srv_store_add(store, *name ? name : NULL, path, error);
	}
	if (!code)
		srv_typical_find_all(store, NULL);
	return code;
}

enum eco_code srv_publish(const struct srv_publish *publish, struct srv_published *published, struct eco_error *error)
{
	struct srv_site site;
	struct srv_store store;
	struct eco_camera *saved = NULL;
	const struct folder folder = { publish->folder, published, error };
	*published = (struct srv_published){ 0 };
	srv_store_init(&store);
	enum eco_code code = srv_site_open(&site, publish->viewer, error);
	if (!code && !srv_site_find(&site, SRV_SITE_INDEX))
		code = eco_fail(error, ECO_NOT_FOUND, "there is no viewer: `make web` in the source tree builds one, or "
			"name its folder by --viewer");
	if (!code && publish->views && publish->count > 1)
		code = eco_fail(error, ECO_BAD_USAGE, "--views needs exactly one pack; publish the others into another folder");
	if (!code && publish->views)
		code = eco_camera_load(&saved, publish->views, error);
	if (!code && saved && eco_camera_above_ground(saved))
		code = eco_fail(error, ECO_BAD_INPUT, "--views: heights of a saved view count from the scene's origin, not from "
			"the ground");
	code = code ? code : open_packs(&store, publish, error);
	code = code ? code : publish_all(&folder, &store, &site, publish, saved);
	eco_camera_free(saved);
	srv_store_free(&store);
	srv_site_free(&site);
	return code;
}
