/* A published folder: its files, for a viewer of two files; what is refused before anything is written. */
#include <dirent.h>

#include "ecofiles/base/files.h"
#include "server/publish/publish.h"
#include "tests/support/input_files.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define DIR "build/tmp/test_publish"
#define SITE DIR "/site"
#define PACK DIR "/small.eco"
#define KEY(time, x) "{\"time_s\": " time ", \"eye\": [" x ", -9, 4], \"target\": [0, 0, 1], \"fov_y_deg\": 60}"
#define TOUR "\"keyframes\": [" KEY("0", "1") ", " KEY("6", "2") "]}"

static void write_viewer(const char *page)
{
	static const char *const ends[3] = { "", ".gz", ".br" };
	for (int i = 0; i < 3; i++) {
		char name[32];
		snprintf(name, sizeof name, "index.html%s", ends[i]);
		input_text("test_publish/viewer", name, page);
		snprintf(name, sizeof name, "a.mjs%s", ends[i]);
		input_text("test_publish/viewer", name, "import './b.mjs'; // .mj .mjs");
	}
}

static int start(void **state)
{
	(void)state;
	struct scene_builder b;
	if (system("rm -rf " DIR) != 0)
		return 1;
	folder_make(DIR);
	write_viewer("<meta charset=\"utf-8\">\n<script src=\"a.mjs\"></script>");
	input_text("test_publish", "tour.json", "{\"fps\": 2, " TOUR);
	input_text("test_publish", "walk.json", "{\"fps\": 2, \"above_ground\": true, " TOUR);
	int failed = small_pack_write(&b, PACK, NULL, &cause);
	scene_free(&b);
	return failed;
}

static char *text_of(const char *path)
{
	uint8_t *bytes;
	size_t size;
	assert_good(eco_file_read(path, 1 << 24, &bytes, &size, &cause));
	return (char *)bytes;
}

static void assert_text(const char *path, const char *has, const char *lacks)
{
	char *text = text_of(path);
	if ((has && !strstr(text, has)) || strstr(text, lacks))
		fail_msg("%s: %s", path, text);
	free(text);
}

static enum eco_code publish(const char *folder, const char *views, uint32_t packs, struct srv_published *made)
{
	char first[] = "a=" PACK, second[] = "b=" PACK, *const both[] = { first, second };
	return srv_publish(&(struct srv_publish){ both, packs, folder, DIR "/viewer", NULL, views }, made, &cause);
}

UNIT_TEST(a_folder_has_an_answer_for_each_keyframe_and_no_rows)
{
	struct srv_published made;
	input_text("test_publish/site", "index.html.tmp-1", "of one that was killed");
	for (int again = 0; again < 2; again++)
		assert_good(publish(SITE, DIR "/tour.json", 1, &made));
	assert_int_equal(made.files, 1 + 1 + 2 + 2 + 3);
	assert_int_not_equal(access(SITE "/index.html.tmp-1", F_OK), 0);
	assert_text(SITE "/index.html", "<meta charset=\"utf-8\">\n<script type=\"application/json\" id=\"published\">[{\"about\":",
		"trees.csv");
	assert_text(SITE "/index.html", "\"first\":[{\"eye\":", "a.mjs");
	assert_text(SITE "/a/scene.json", "\"name\":\"a\"", "trees.csv");
	assert_text(SITE "/a/species.json", "\"plants\":[", "trees.csv");
	assert_text(SITE "/viewer/a.js", "import './b.js'; // .mj .js", ".mjs");
	assert_good(publish(SITE, NULL, 2, &made));
	assert_text(SITE "/index.html", "\"name\":\"b\"", "trees.csv");
}

UNIT_TEST(a_refusal_leaves_the_folder_alone)
{
	struct srv_published made;
	input_text("test_publish/mine", "index.html", "mine");
	assert_code(publish(DIR "/mine", NULL, 1, &made), ECO_BAD_USAGE, "mine/index.html is a page of another kind");
	assert_code(publish(DIR "/none", DIR "/tour.json", 2, &made), ECO_BAD_USAGE, "--views needs exactly one pack");
	assert_code(publish(DIR "/none", DIR "/walk.json", 1, &made), ECO_BAD_INPUT, "from the ground");
	assert_code(publish(DIR "/none/below", NULL, 1, &made), ECO_IO, "none/below");
	assert_code(publish(DIR "/mine/index.html", NULL, 1, &made), ECO_IO, "index.html");
	folder_make(DIR "/full");
	input_text("test_publish/full", "viewer", "a file in its place");
	assert_code(publish(DIR "/full", NULL, 1, &made), ECO_IO, "full/viewer");
	assert_text(DIR "/mine/index.html", "mine", "script");
	assert_null(opendir(DIR "/none"));
	assert_null(opendir(DIR "/mine/viewer"));
	write_viewer("no page");
	assert_code(publish(SITE, NULL, 1, &made), ECO_BAD_INPUT, "build both");
	assert_text(SITE "/index.html", "\"name\":\"b\"", "no page");
}

UNIT_MAIN(start, NULL)
