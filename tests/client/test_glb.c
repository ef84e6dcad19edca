/* Views as glTF, read back by the importer's reader: they show what is drawn, plants share meshes, and an
 * empty view is a file, too. */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_bake.h"
#include "client-min/view_glb.h"
#include "client-min/view_reference.h"
#include "ecofiles/import/model/gltf.h"
#include "lod/raster/raster.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

static struct scene_builder scene;

static int make_scene(void **state)
{
	scene_make(&scene, NULL, 0);
	return 0;
}

static int free_scene(void **state)
{
	scene_free(&scene);
	return 0;
}

static struct eco_writer write_glb(const struct scene_held *h)
{
	struct eco_error error = { 0 };
	struct eco_writer file = { 0 };
	struct view_glb_job job = { .store = h->store, .selection = &h->selection, .view = &h->view };
	assert_ok(view_glb_write(&job, &file, &error), error);
	return file;
}

static struct eco_gltf *open_glb(const struct eco_writer *file)
{
	struct eco_gltf *doc;
	struct eco_error error = { 0 };
	assert_ok(eco_gltf_open_memory(&doc, "view.glb", file->bytes, file->size, &error), error);
	return doc;
}

/* ---- What it shows ---- */

struct drawing { struct eco_gltf *doc; struct lod_raster raster; uint64_t triangles, plants; double eye[3]; };

/* Y up to Z up. */
static void turn_up(const double in[3], float out[3])
{
	out[0] = (float)in[0];
	out[1] = (float)-in[2];
	out[2] = (float)in[1];
}

static void draw_primitive(struct drawing *d, const json_t *primitive, const double world[16], bool ground)
{
	struct eco_error error = { 0 };
	const json_t *attributes = json_object_get(primitive, "attributes");
	double *position, *index, *color;
	uint64_t vertices, count, colors;
	assert_ok(eco_gltf_read_floats(d->doc, eco_gltf_index(attributes, "POSITION"), 3, &position,
		&vertices, &error), error);
	assert_ok(eco_gltf_read_floats(d->doc, eco_gltf_index(attributes, "COLOR_0"), 4, &color, &colors,
		&error), error);
	assert_ok(eco_gltf_read_floats(d->doc, eco_gltf_index(primitive, "indices"), 1, &index, &count,
		&error), error);
	assert_int_equal(colors, vertices);
	assert_int_equal(count % 3, 0);
	float *corners = malloc(count * 3 * sizeof *corners);
	for (uint64_t i = 0; i < count; i++) {
		double at[3];
		assert_true(index[i] < (double)vertices);
		eco_gltf_apply(world, position + 3 * (size_t)index[i], at);
		turn_up(at, corners + 3 * i);
	}
	struct lod_place place = { .cosine = 1, .scale = 1 };
	lod_raster_object(&d->raster, &place);
	lod_raster_triangles(&d->raster, &(struct lod_raster_batch){ .count = (uint32_t)(count / 3),
		.position = corners, .owner = !ground });
	d->triangles += ground ? 0 : count / 3;
	free(corners);
	free(position);
	free(index);
	free(color);
}

static enum eco_code draw_node(void *ctx, uint32_t number, const double world[16])
{
	struct drawing *d = ctx;
	const json_t *node = eco_gltf_item(d->doc, "nodes", number), *primitive;
	const json_t *mesh = eco_gltf_item(d->doc, "meshes", eco_gltf_index(node, "mesh"));
	const char *name = eco_gltf_text(node, "name");
	size_t i;
	if (strcmp(name, "camera") == 0)
		memcpy(d->eye, world + 12, sizeof d->eye);
	d->plants += json_object_get(json_object_get(node, "extras"), "height_m") != NULL;
	json_array_foreach(json_object_get(mesh, "primitives"), i, primitive)
		draw_primitive(d, primitive, world, strcmp(name, "ground") == 0);
	return ECO_OK;
}

/* Triangles that a cut becomes for each of its plants. */
static uint64_t triangles_of(const struct scene_held *h, uint32_t c)
{
	const struct view_selection *s = &h->selection;
	const struct eco_cut *cut = &s->plan_cuts[c];
	uint64_t members = s->member_first[c + 1] - s->member_first[c],
		count = eco_cut_primitives(cut);
	switch (scene.scene.lists[cut->list].kind) {
	case ECO_LIST_TRIANGLES:
		return members * count;
	case ECO_LIST_LINES:
		return members * count * 6;
	default:
		return members * count * (count < 64 ? 20 : 8);
	}
}

UNIT_TEST(a_file_shows_what_is_drawn)
{
	struct scene_held h = scene_hold(&scene);
	struct eco_error error = { 0 };
	struct view_picture picture;
	struct lod_score score;
	uint64_t triangles = 0, plants = 0;
	scene_select(&h);
	struct view_reference_job job = { h.store, &h.selection, &h.eye, 0.1, 1, NULL, VIEW_TINT_NONE };
	assert_ok(view_picture_init(&picture, h.view.width, h.view.height, &error), error);
	assert_ok(view_reference_draw(&job, &picture, &error), error);
	struct eco_writer file = write_glb(&h);
	struct drawing d = { .doc = open_glb(&file) };
	assert_ok(lod_raster_init(&d.raster, &(struct lod_raster_options){ h.view.width, h.view.height,
		.owner =
		true }, &error), error);
	lod_raster_camera(&d.raster, &h.eye, 0.1);
	assert_ok(eco_gltf_walk(d.doc, draw_node, &d, &error), error);
	lod_score(&score, &(struct lod_score_input){ h.view.width, h.view.height, d.raster.cover,
		picture.cover, NULL, NULL });
	for (uint32_t c = 0; c < h.selection.cut_count; c++)
		triangles += triangles_of(&h, c);
	for (uint32_t i = 0; i < h.selection.instance_count; i++)
		plants += h.selection.instances[i].plant != ECO_NONE
			&& h.selection.cut_first[i] < h.selection.cut_first[i + 1];
	print_message("P %.4f R %.4f, %llu triangles of %llu plants\n", score.precision, score.recall,
		(unsigned long long)d.triangles, (unsigned long long)d.plants);
	assert_int_equal(d.triangles, triangles);
	assert_int_equal(d.plants, plants);
	assert_true(score.precision > 0.97 && score.recall > 0.97);
	const double eye[3] = { h.eye.at[0], h.eye.at[2], -h.eye.at[1] };
	for (int k = 0; k < 3; k++)
		assert_true(fabs(d.eye[k] - eye[k]) < 1e-5);
	lod_raster_free(&d.raster);
	eco_gltf_close(d.doc);
	eco_writer_free(&file);
	view_picture_free(&picture);
	scene_release(&h);
}

UNIT_TEST(plants_that_draw_the_same_share_a_mesh)
{
	struct scene_held h = scene_hold(&scene);
	scene_select(&h);
	struct eco_writer file = write_glb(&h);
	struct eco_gltf *doc = open_glb(&file);
	const json_t *json = eco_gltf_json(doc), *node, *root = eco_gltf_item(doc, "nodes", 0);
	size_t meshes = json_array_size(json_object_get(json, "meshes")), i;
	uint32_t *users = calloc(meshes + 1, sizeof *users), most = 0;
	json_array_foreach(json_object_get(json, "nodes"), i, node) {
		uint32_t mesh = eco_gltf_index(node, "mesh");
		if (mesh != UINT32_MAX)
			most = ++users[mesh] > most ? users[mesh] : most;
	}
	for (i = 0; i < meshes; i++)
		assert_true(users[i] > 0);
	assert_true(most > 1);
	assert_int_equal(json_integer_value(json_object_get(json_object_get(root, "extras"), "vertices")),
		h.selection.vertices);
	free(users);
	eco_gltf_close(doc);
	eco_writer_free(&file);
	scene_release(&h);
}

UNIT_TEST(an_empty_view_is_a_file)
{
	struct view_store *store;
	struct view_store_options options = { 0 };
	struct scene_held h = { .view = scene_view() };
	assert_int_equal(view_store_new(&store, &options, NULL), ECO_OK);
	h.store = store;
	lod_eye_make(&h.eye, &h.view);
	assert_int_equal(view_select_make(&h.selection, store, &h.eye, NULL), ECO_OK);
	struct eco_writer file = write_glb(&h);
	struct eco_gltf *doc = open_glb(&file);
	static const char *const absent[] = { "meshes", "accessors", "bufferViews", "buffers", "images" };
	for (size_t i = 0; i < sizeof absent / sizeof *absent; i++)
		assert_null(json_object_get(eco_gltf_json(doc), absent[i]));
	assert_int_equal(json_array_size(json_object_get(eco_gltf_json(doc), "nodes")), 2);
	eco_gltf_close(doc);
	eco_writer_free(&file);
	view_select_free(&h.selection);
	view_store_free(store);
}

int main(void)
{
	return unit_tests_run(make_scene, free_scene);
}
