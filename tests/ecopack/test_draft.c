/* Drafts: packs for a first look. They are valid, cost less, and leave no trace in the pack that a later make
 * makes; what an interrupted make has finished is not made again. Last: how long a stage will take. */
#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ecofiles/ecopack/inspect.h"
#include "ecofiles/ecopack/link.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/ecopack/run.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

static char folder[300];

/* Leaves strewn over a stem. */
static void write_tree(const char *name, int leaves)
{
	FILE *file = fopen(in_root(name), "wb");
	assert_non_null(file);
	fputs("v 0 0 0\nv 0.1 0 0\nv 0.1 3 0\nf 1 2 3\n", file);
	for (int i = 0; i < leaves; i++) {
		double x = i * 37 % 100 / 33.0 - 1.5, z = i * 71 % 101 / 33.0 - 1.5,
			y = 2 + i * 53 % 97 / 40.0, l = 0.1 + i % 5 * 0.02;
		fprintf(file, "v %f %f %f\nv %f %f %f\nv %f %f %f\nv %f %f %f\nf -4 -3 -2 -1\n", x, y, z,
			x + l / 2, y + l / 4, z, x + l, y, z + l / 3, x + l / 2, y - l / 4, z);
	}
	assert_int_equal(fclose(file), 0);
}

static void write_scene(void)
{
	write_tree("bush.obj", 8);
	write_tree("tree.obj", 240);
	write_text("scene.json", "{\"name\": \"s\", \"plants\": {\"bush\": {\"model\": \"bush.obj\"}, "
		"\"tree\": {\"model\": \"tree.obj\"}}, \"instances\": [{\"plant\": \"bush\", \"at\": "
		"[0, 0]}, {\"plant\": \"tree\", \"at\": [9, 4]}]}\n");
}

static enum eco_code make(const char *pack, bool draft, bool cached)
{
	struct eco_error error = { 0 };
	struct make_options options = { .scene = in_root("scene.json"), .pack = in_root(pack), .jobs = 1,
		.cache = cached ? folder : NULL, .draft = draft,
		.order = draft ? LOD_ORDER_COMBINED : LOD_ORDER_GREEDY };
	enum eco_code code = make_pack(&options, &error);
	if (code == ECO_INTERRUPTED)
		assert_non_null(strstr(error.text, "1 of 2 plants are finished, and kept"));
	else
		assert_ok(code, error);
	return code;
}

static uint64_t count_curves(const char *name)
{
	struct eco_pack *pack;
	struct eco_error error = { 0 };
	assert_ok(eco_pack_open(&pack, in_root(name), &error), error);
	uint64_t count = pack->scene.curve_count;
	eco_pack_close(pack);
	return count;
}

/* Over the draft's own pack, with the draft's cache: what it left there must not show. */
UNIT_TEST(a_make_after_a_draft_is_as_if_there_had_been_none)
{
	struct eco_error error = { 0 };
	struct inspect_counts counts;
	FILE *unread = fopen("/dev/null", "w");
	make("fresh.eco", false, false);
	make("pack.eco", true, true);
	assert_ok(inspect_verify(in_root("pack.eco"), unread, &counts, &error), error);
	fclose(unread);
	assert_true(2 * count_curves("pack.eco") < count_curves("fresh.eco"));
	make("again.eco", true, false);
	assert_true(files_alike(in_root("again.eco"), in_root("pack.eco")));
	make("pack.eco", false, true);
	assert_true(files_alike(in_root("fresh.eco"), in_root("pack.eco")));
	make("pack.eco", true, true);
	assert_true(files_alike(in_root("again.eco"), in_root("pack.eco")));
}

/* As info says it; linked packs are a draft if one of them is. */
static bool is_draft(const char *name)
{
	struct eco_pack *pack;
	struct eco_error error = { 0 };
	assert_ok(eco_pack_open(&pack, in_root(name), &error), error);
	bool says = memmem(pack->meta, pack->meta_size, "\"draft\": true", 13) != NULL;
	eco_pack_close(pack);
	return says;
}

UNIT_TEST(packs_say_that_they_are_drafts)
{
	char fresh[300], draft[300], linked[300];
	struct eco_error error = { 0 };
	snprintf(fresh, sizeof fresh, "%s", in_root("fresh.eco"));
	snprintf(draft, sizeof draft, "%s", in_root("again.eco"));
	snprintf(linked, sizeof linked, "%s", in_root("linked.eco"));
	const char *const parts[] = { fresh, draft };
	assert_ok(link_packs(&(struct link_options){ linked, parts, 2, 1 }, &error), error);
	assert_true(is_draft("again.eco") && is_draft("linked.eco") && !is_draft("fresh.eco"));
	assert_ok(link_packs(&(struct link_options){ linked, parts, 1, 1 }, &error), error);
	assert_false(is_draft("linked.eco"));
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
		main_catch_interrupts();
		_exit(make("cut.eco", false, true) == ECO_INTERRUPTED ? 0 : 1);
	}
	for (int i = 0; i < 6000 && !(kept = only_plant(name)); i++)
		usleep(10000);
	kill(child, SIGINT);
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
	assert_int_equal(access(in_root("cut.eco"), F_OK), -1);
	make("cut.eco", false, true);
	assert_true(files_alike(in_root("fresh.eco"), in_root("cut.eco")));
	snprintf(path, sizeof path, "%s/%s", folder, name);
	assert_int_equal(stat(path, &after), 0);
	assert_true(after.st_ino == kept);           /* written anew it would be another file */
}

UNIT_TEST(the_time_left_is_told_once_it_can_be)
{
	static const struct { double elapsed_s, share; const char *text; } rows[] = {
		{ 0, 0, "" }, { 1, 0.5, "" }, { 10, 0.001, "" }, { 10, 1, "" }, { 10, 0, "" },
		{ 10, 0.5, ", about 10 s left" }, { 40, 0.4, ", about 60 s left" },
		{ 60, 0.25, ", about 3 min left" }, { 1e9, 0.02, ", about 1000000 min left" } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char text[32];
		main_progress_left(text, rows[i].elapsed_s, rows[i].share);
		assert_string_equal(text, rows[i].text);
	}
}

int main(void)
{
	scratch_open("draft");
	snprintf(folder, sizeof folder, "%s/kept", scratch_root);
	main_progress_quiet(true);
	write_scene();
	int failed = unit_tests_run(NULL, NULL);
	char command[400];
	snprintf(command, sizeof command, "rm -rf '%s'", scratch_root);
	return system(command) == 0 ? failed : 1;
}
