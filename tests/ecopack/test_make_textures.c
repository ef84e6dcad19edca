/* Textures of packs: models that show one image share its lists, however large they are, and so do packs
 * that are linked. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/link.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/format/image.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

#define SIDE 256

/* Blotches of a seed's colours, a quarter of them holes. */
static void write_image(const char *name, uint64_t seed)
{
	static uint8_t rgba[SIDE * SIDE][4];
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			uint64_t noise = eco_random(seed, (uint64_t)(y / 8 * SIDE + x / 8));
			memcpy(rgba[y * SIDE + x], &noise, 3);
			rgba[y * SIDE + x][3] = noise >> 32 & 3 ? 255 : 0;
		}
	assert_int_equal(eco_png_write(&(struct eco_pixels){ SIDE, SIDE, 4, &rgba[0][0] }, in_root(name), NULL),
		ECO_OK);
}

/* Two crossed cards as high and wide as said, on a stem. */
static void write_card(const char *name, double size, const char *image)
{
	char file[32], text[96];
	snprintf(file, sizeof file, "%s.mtl", name);
	snprintf(text, sizeof text, "newmtl card\nmap_Kd %s\nnewmtl stem\nKd .4 .3 .2\n", image);
	write_text(file, text);
	snprintf(file, sizeof file, "%s.obj", name);
	FILE *obj = open_text(file);
	fprintf(obj, "mtllib %s.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl card\n", name);
	for (int k = 0; k < 2; k++)
		fprintf(obj, "v %f 0 %f\nv %f 0 %f\nv %f %f %f\nv %f %f %f\nf -4/1 -3/2 -2/3 -1/4\n", k ? 0 : -size / 2,
			k ? -size / 2 : 0, k ? 0 : size / 2, k ? size / 2 : 0, k ? 0 : size / 2, size,
			k ? size / 2 : 0, k ? 0 : -size / 2, size, k ? -size / 2 : 0);
	fprintf(obj, "usemtl stem\nv 0 0 0\nv %f 0 0\nv 0 %f 0\nf -3 -2 -1\n", size / 50, size / 4);
	assert_int_equal(fclose(obj), 0);
}

static void build(const char *scene, const char *pack)
{
	struct inspect_counts counts = { 0 };
	const struct make_options options = { .scene = in_root(scene), .pack = in_root(pack), .jobs = 2,
		.draft = true };
	assert_good(make_pack(&options, &cause));
	assert_good(inspect_verify(in_root(pack), stdout, &counts, &cause));
}

/* A scene of some of the models, one plant of each: NAME.json, NAME.eco. */
static void make(const char *name, const char *const *models, size_t count)
{
	char scene[600] = "{\"name\": \"s\", \"plants\": {", file[32], pack[32];
	for (size_t i = 0; i < count; i++)
		sprintf(scene + strlen(scene), "%s\"%s\": {\"model\": \"%s.obj\", \"unit\": \"m\"}", i ? ", " : "",
			models[i], models[i]);
	strcat(scene, "}, \"instances\": [");
	for (size_t i = 0; i < count; i++)
		sprintf(scene + strlen(scene), "%s{\"plant\": \"%s\", \"at\": [%zu, 0, 0]}", i ? ", " : "", models[i],
			9 * i);
	strcat(scene, "]}\n");
	snprintf(file, sizeof file, "%s.json", name);
	snprintf(pack, sizeof pack, "%s.eco", name);
	write_text(file, scene);
	build(file, pack);
}

static struct eco_pack *open_pack(const char *name)
{
	struct eco_pack *pack = NULL;
	assert_good(eco_pack_open(&pack, in_root(name), &cause));
	return pack;
}

static uint32_t lists_of(const struct eco_scene *s, enum eco_list_kind kind)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->list_count; i++)
		count += s->lists[i].kind == kind;
	return count;
}

/* The texture that a plant's triangles show. */
static const struct eco_list *texture_of(const struct eco_scene *s, const char *plant)
{
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_TRIANGLES && s->lists[i].image != ECO_NONE
				&& strcmp(s->plants[s->lists[i].owner].name, plant) == 0)
			return &s->lists[s->lists[i].image];
	fail_msg("%s shows no texture", plant);
	return NULL;
}

static int write_models(void **state)
{
	scratch_open("textures");
	eco_progress_quiet(true);
	write_image("leaf.png", 1);
	write_image("other.png", 2);
	write_card("small", .05, "leaf.png");
	write_card("large", 8, "leaf.png");
	write_card("third", 8, "other.png");
	return 0;
}

/* The small one needs fewer texels: its levels are the first of the large one's. */
UNIT_TEST(models_share_an_image_whatever_their_size)
{
	static const char *const all[] = { "small", "large", "third" };
	make("alone", all, 1);
	make("all", all, 3);
	struct eco_pack *alone = open_pack("alone.eco"), *pack = open_pack("all.eco");
	const struct eco_scene *s = &pack->scene;
	const struct eco_list *small = texture_of(s, "small"), *large = texture_of(s, "large"),
		*first = texture_of(&alone->scene, "small");
	assert_int_equal(lists_of(s, ECO_LIST_IMAGE), 2);
	assert_int_equal(lists_of(s, ECO_LIST_OUTLINE), 2);
	assert_ptr_equal(small, large);
	assert_ptr_not_equal(small, texture_of(s, "third"));
	assert_true(first->chunk_count < small->chunk_count);
	assert_int_equal(s->lists[small->image].chunk_count, small->chunk_count);
	for (uint32_t k = 0; k < first->chunk_count; k++)
		assert_memory_equal(&s->chunks[small->chunk_first + k].id,
			&alone->scene.chunks[first->chunk_first + k].id, sizeof(struct eco_chunk_id));
	/* a texel is as wide as on the large one */
	assert_float_equal(sqrt((double)large->unit_area), sqrt((double)texture_of(s, "third")->unit_area), 1e-6);
	eco_pack_close(alone);
	eco_pack_close(pack);
}

UNIT_TEST(linked_packs_share_an_image)
{
	static const char *const one[] = { "large" }, *const other[] = { "third", "small" };
	const char *parts[] = { in_root("one.eco"), in_root("other.eco") };
	make("one", one, 1);
	make("other", other, 2);
	const struct link_options options = { .parts = parts, .count = 2, .pack = in_root("linked.eco"), .jobs = 2 };
	assert_good(link_packs(&options, &cause));
	write_text("linked.json", "{\"name\": \"linked\", \"children\": [{\"eco\": \"one.json\", \"at\": [0, 0]}, "
		"{\"eco\": \"other.json\", \"at\": [0, 0]}]}\n");
	build("linked.json", "whole.eco");
	assert_true(files_alike(in_root("linked.eco"), in_root("whole.eco")));
	struct eco_pack *pack = open_pack("linked.eco");
	assert_int_equal(pack->scene.plant_count, 3);
	assert_int_equal(lists_of(&pack->scene, ECO_LIST_IMAGE), 2);
	assert_ptr_equal(texture_of(&pack->scene, "small"), texture_of(&pack->scene, "large"));
	eco_pack_close(pack);
}

UNIT_MAIN(write_models, scratch_close)
