/* The cache of finished plants: the pack is the same with and without it, damage is noticed and repaired, its
 * size is bounded, and a folder that cannot be used fails nothing. Drafts leave no trace in the pack that a
 * later make makes; what an interrupted make has finished is not made again. */
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ecofiles/format/image.h"
#include "ecofiles/ecopack/cache.h"
#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

static char folder[300];

static struct main_cache_key key_of(unsigned number)
{
	struct main_cache_key key = { { (uint8_t)number, (uint8_t)(number >> 8), 7 } };
	return key;
}

static void entry_path(char path[512], unsigned number)
{
	struct main_cache_key key = key_of(number);
	snprintf(path, 512, "%s/%s.plant", folder, eco_id_text(key.bytes).hex);
}

static uint32_t files_in(const char *path, const char *containing)
{
	uint32_t count = 0;
	DIR *dir = opendir(path);
	for (struct dirent *d; dir && (d = readdir(dir));)
		count += d->d_name[0] != '.' && strstr(d->d_name, containing);
	if (dir)
		closedir(dir);
	return count;
}

static bool holds(struct main_cache *cache, unsigned number, const char *text)
{
	struct main_cache_key key = key_of(number);
	uint8_t *bytes;
	size_t size;
	if (!main_cache_get(cache, &key, &bytes, &size))
		return false;
	bool same = size == strlen(text) && memcmp(bytes, text, size) == 0;
	free(bytes);
	assert_true(same);
	return true;
}

static void put(struct main_cache *cache, unsigned number, const char *text)
{
	struct main_cache_key key = key_of(number);
	main_cache_put(cache, &key, (const uint8_t *)text, strlen(text));
}

/* ---- Entries ---- */

UNIT_TEST(without_a_folder_all_is_missed)
{
	struct main_cache cache;
	for (int i = 0; i < 2; i++) {
		main_cache_open(&cache, i ? "" : NULL, 1 << 20);
		put(&cache, 1, "an oak");
		assert_false(holds(&cache, 1, "an oak"));
		main_cache_close(&cache);
	}
}

/* Every byte of an entry counts, and every length but its own. */
UNIT_TEST(every_damage_is_noticed)
{
	AT_END(main_cache_close) struct main_cache cache;
	char path[512];
	size_t size;
	folder_empty(folder);
	main_cache_open(&cache, folder, 1 << 20);
	put(&cache, 5, "some leaves");
	entry_path(path, 5);
	FREED_MEMORY uint8_t *bytes = file_read(path, &size);
	for (size_t i = 0; i <= 2 * size; i++) {
		if (i < size)
			bytes[i] ^= 0x10;
		/* one bit, then cut off at every length, then with a 0 behind it */
		file_write(path, bytes, i < size ? size : i < 2 * size ? i - size : size + 1);
		if (i < size)
			bytes[i] ^= 0x10;
		assert_false(holds(&cache, 5, "some leaves"));
	}
	put(&cache, 5, "some leaves");
	assert_true(holds(&cache, 5, "some leaves"));
}

UNIT_TEST(what_was_used_least_recently_goes)
{
	struct main_cache cache;
	char path[512], text[101];
	folder_empty(folder);
	memset(text, 'x', 100);
	text[100] = 0;
	main_cache_open(&cache, folder, 800);        /* seven entries of 108 bytes */
	for (unsigned i = 0; i < 12; i++) {
		put(&cache, i, text);
		entry_path(path, i);
		const struct timeval then[2] = { { 1000 + i, 0 }, { 1000 + i, 0 } };
		assert_int_equal(utimes(path, then), 0);
	}
	assert_true(holds(&cache, 0, text));         /* used just now */
	snprintf(path, sizeof path, "%s/notes.txt", folder);
	FILE *file = fopen(path, "wb");              /* what is not ours stays */
	fprintf(file, "%2000s", "");
	fclose(file);
	main_cache_close(&cache);
	main_cache_open(&cache, folder, 800);
	for (unsigned i = 0; i < 12; i++)
		assert_int_equal(holds(&cache, i, text), i == 0 || i >= 6);
	main_cache_close(&cache);
	assert_int_equal(files_in(folder, "notes.txt"), 1);
}

UNIT_TEST(what_others_left_unfinished_goes)
{
	struct main_cache cache;
	char path[600];
	folder_empty(folder);
	snprintf(path, sizeof path, "%s/000102030405060708090a0b0c0d0e0f.plant.tmp-999999", folder);
	file_write_text(path, "");
	main_cache_open(&cache, folder, 1000);
	put(&cache, 1, "an oak");
	main_cache_close(&cache);
	assert_int_equal(files_in(folder, ".tmp-"), 0);
	assert_int_equal(files_in(folder, ".plant"), 1);
}

UNIT_TEST(a_folder_that_cannot_be_fails_nothing)
{
	static const char *const folders[] = { "/proc/nothing/here", "/dev/null", "/dev/null/x" };
	for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
		AT_END(main_cache_close) struct main_cache cache;
		main_cache_open(&cache, folders[i], 1 << 20);
		put(&cache, 1, "an oak");
		put(&cache, 2, "a beech");
		assert_true(cache.told);
		assert_false(holds(&cache, 1, "an oak"));
	}
}

UNIT_TEST(the_default_follows_the_environment)
{
	struct row { const char *base, *home, *is; };
	uint32_t count;
	const struct row *rows = cases_rows("tests/ecopack/cases/cache_folders.tsv", "sss", sizeof *rows,
		&count);
	static char path[MAIN_CACHE_PATH];
	for (size_t i = 0; i < count; i++) {
		if (rows[i].base) setenv("XDG_CACHE_HOME", rows[i].base, 1); else unsetenv("XDG_CACHE_HOME");
		if (rows[i].home) setenv("HOME", rows[i].home, 1); else unsetenv("HOME");
		path[0] = 0;
		assert_int_equal(main_cache_default(path), rows[i].is[0] != 0);
		assert_string_equal(path, rows[i].is);
	}
}

/* ---- Packs ---- */

static enum eco_code try_make(const char *pack, const char *cache, enum lod_order_method order,
	const char *scene, struct eco_error *error)
{
	const struct make_options options = { .scene = in_root(scene), .pack = in_root(pack),
		.jobs = 1, .cache = cache, .order = order, .draft = order == LOD_ORDER_COMBINED };
	return make_pack(&options, error);
}

static void make(const char *pack, const char *cache, enum lod_order_method order, const char *scene)
{
	assert_good(try_make(pack, cache, order, scene, &cause));
}

/* Leaves with a texture, leaves with colours, a stem: all kinds of lists that a plant may have. */
static void write_scene(void)
{
	static const uint8_t pixels[] = { 20, 120, 30, 255, 20, 120, 30, 255, 20, 120, 30, 255, 0, 0, 0, 0 };
	assert_int_equal(eco_png_write(&(struct eco_pixels){ 2, 2, 4, pixels }, in_root("leaf.png"),
		NULL), ECO_OK);
	FILE *file = fopen(in_root("tree.obj"), "wb");
	assert_non_null(file);
	fputs("mtllib tree.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl bark\n", file);
	for (int k = 0; k < 9; k++)
		for (int i = 0; i < 4; i++)
			fprintf(file, "v %f %f %f\n", (i % 3 ? 0.1 : -0.1) + 0.02 * k, k * 0.5,
				i < 2 ? -0.1 : 0.1);
	for (int k = 0; k < 8; k++)
		for (int i = 0; i < 4; i++)
			fprintf(file, "f %d %d %d %d\n", 4 * k + i + 1, 4 * k + (i + 1) % 4 + 1,
				4 * k + (i + 1) % 4 + 5, 4 * k + i + 5);
	for (int i = 0; i < 300; i++) {
		double x = i * 37 % 100 / 33.0 - 1.5, z = i * 71 % 101 / 33.0 - 1.5,
			y = 2 + i * 53 % 97 / 40.0, l = 0.1 + i % 5 * 0.02;
		if (i % 150 == 0)
			fprintf(file, "usemtl %s\n", i ? "blossom" : "leaf");
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf -4/1 -3/2 -2/3 -1/4\n", x, y,
			z, x + l / 2, y + l / 4, z, x + l, y, z + l / 3, x + l / 2, y - l / 4, z);
	}
	assert_int_equal(fclose(file), 0);
	for (int i = 0; i < 2; i++) {
		char text[300];
		const char *name = i ? "arbre" : "tree";
		snprintf(text, sizeof text, "{\"name\": \"s\", \"plants\": {\"%s\": {\"model\": \"tree.obj\", \"unit\": "
			"\"m\"}}, \"instances\": [{\"plant\": \"%s\", \"at\": [0, 0, 0]}, {\"plant\": \"%s\", \"at\": [9, "
			"4, 0]}]}", name, name, name);
		write_text(i ? "renamed.json" : "scene.json", text);
	}
}

UNIT_TEST(packs_are_the_same_with_and_without)
{
	folder_empty(folder);
	write_scene();
	make("none.eco", NULL, LOD_ORDER_GREEDY, "scene.json");
	make("first.eco", folder, LOD_ORDER_GREEDY, "scene.json");
	assert_int_equal(files_in(folder, ".plant"), 1);
	make("second.eco", folder, LOD_ORDER_GREEDY, "scene.json");
	assert_int_equal(files_in(folder, ".plant"), 1);
	assert_true(files_alike(in_root("none.eco"), in_root("first.eco")));
	assert_true(files_alike(in_root("none.eco"), in_root("second.eco")));
	/* a plant's name is the scene's business, not the cache's */
	make("renamed.eco", folder, LOD_ORDER_GREEDY, "renamed.json");
	make("arbre.eco", NULL, LOD_ORDER_GREEDY, "renamed.json");
	assert_int_equal(files_in(folder, ".plant"), 1);
	assert_true(files_alike(in_root("renamed.eco"), in_root("arbre.eco")));
	assert_false(files_alike(in_root("renamed.eco"), in_root("none.eco")));
	/* another order and a rule about parts are other plants */
	make("other.eco", folder, LOD_ORDER_STOCHASTIC, "scene.json");
	assert_int_equal(files_in(folder, ".plant"), 2);
	make("pruned.eco", folder, LOD_ORDER_GREEDY, "pruned.json");
	assert_int_equal(files_in(folder, ".plant"), 3);
	make("pruned-none.eco", NULL, LOD_ORDER_GREEDY, "pruned.json");
	assert_true(files_alike(in_root("pruned.eco"), in_root("pruned-none.eco")));
}

/* An entry whose hashes hold and whose plant is none. */
UNIT_TEST(an_entry_that_is_no_plant_is_built_anew)
{
	DIR *dir = opendir(folder);
	struct main_cache cache;
	main_cache_open(&cache, folder, 1 << 30);
	for (struct dirent *d; dir && (d = readdir(dir));) {
		struct main_cache_key key;
		unsigned byte;
		int read = 0;
		for (int i = 0; i < 16 && sscanf(d->d_name + 2 * i, "%2x", &byte) == 1; i++, read++)
			key.bytes[i] = (uint8_t)byte;
		if (read == 16)
			main_cache_put(&cache, &key, (const uint8_t *)"nothing at all", 14);
	}
	closedir(dir);
	main_cache_close(&cache);
	make("third.eco", folder, LOD_ORDER_GREEDY, "scene.json");
	assert_true(files_alike(in_root("none.eco"), in_root("third.eco")));
	make("fourth.eco", folder, LOD_ORDER_GREEDY, "scene.json");
	assert_true(files_alike(in_root("none.eco"), in_root("fourth.eco")));
}

/* ---- Drafts and interrupted makes ---- */

static uint64_t count_curves(const char *name)
{
	OWNED(eco_pack) *pack;
	assert_good(eco_pack_open(&pack, in_root(name), &cause));
	uint64_t count = pack->scene.curve_count;
	return count;
}

/* Over the draft's own pack, with the draft's cache: what it left there must not show. */
UNIT_TEST(a_make_after_a_draft_is_as_if_there_had_been_none)
{
	struct inspect_counts counts;
	FILE *unread = fopen("/dev/null", "w");
	make("fresh.eco", NULL, LOD_ORDER_GREEDY, "two.json");
	make("pack.eco", folder, LOD_ORDER_COMBINED, "two.json");
	assert_good(inspect_verify(in_root("pack.eco"), unread, &counts, &cause));
	fclose(unread);
	assert_true(2 * count_curves("pack.eco") < count_curves("fresh.eco"));
	make("again.eco", NULL, LOD_ORDER_COMBINED, "two.json");
	assert_true(files_alike(in_root("again.eco"), in_root("pack.eco")));
	make("pack.eco", folder, LOD_ORDER_GREEDY, "two.json");
	assert_true(files_alike(in_root("fresh.eco"), in_root("pack.eco")));
	make("pack.eco", folder, LOD_ORDER_COMBINED, "two.json");
	assert_true(files_alike(in_root("again.eco"), in_root("pack.eco")));
}

/* The name of the cache's only plant, and its file's number; 0: there is none. */
static ino_t only_plant(char name[64])
{
	DIR *dir = opendir(folder);
	ino_t found = 0;
	for (struct dirent *d; dir && (d = readdir(dir));)
		if (strlen(d->d_name) == 32 + strlen(".plant") && strstr(d->d_name, ".plant")) {
			strcpy(name, d->d_name);
			found = d->d_ino;
		}
	if (dir)
		closedir(dir);
	return found;
}

/* Interrupted by Ctrl-C once the bush is done, long before the tree is. */
UNIT_TEST(what_an_interrupted_make_has_finished_is_kept)
{
	char name[64], path[400];
	struct stat after;
	int status;
	ino_t kept;
	snprintf(path, sizeof path, "rm -rf '%s'", folder);
	assert_int_equal(system(path), 0);
	pid_t child = fork();
	if (child == 0) {
		struct eco_error error = { 0 };
		main_catch_interrupts();
		/* an assertion would go on with the tests in this process, and remove their files */
		_exit(try_make("cut.eco", folder, LOD_ORDER_GREEDY, "two.json", &error) != ECO_OK);
	}
	for (int i = 0; i < 6000 && !(kept = only_plant(name)); i++)
		usleep(10000);
	kill(child, SIGINT);
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
	assert_int_equal(access(in_root("cut.eco"), F_OK), -1);
	make("cut.eco", folder, LOD_ORDER_GREEDY, "two.json");
	assert_true(files_alike(in_root("fresh.eco"), in_root("cut.eco")));
	snprintf(path, sizeof path, "%s/%s", folder, name);
	assert_int_equal(stat(path, &after), 0);
	assert_true(after.st_ino == kept);           /* written anew it would be another file */
}

int main(void)
{
	scratch_open("cache");
	cases_write("tests/ecopack/cases/cache_files.tsv", scratch_root);
	snprintf(folder, sizeof folder, "%s/kept", scratch_root);
	eco_progress_quiet(true);
	return unit_tests_run(NULL, scratch_close);
}
