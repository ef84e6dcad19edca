/* Modules: found beside the program or in the folder that is named, refused with a helpful text where they
 * are missing or not what they should be, and looked for again after that. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/module.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define FOLDER "build/tmp/modules"

static void put(const char *name, const char *bytes)
{
	char path[200];
	folder_make(FOLDER);
	snprintf(path, sizeof path, FOLDER "/%s", name);
	unlink(path);
	if (bytes)
		file_write_text(path, bytes);
}

static void assert_refused(enum eco_module module, const char *says, const char *and)
{
	struct eco_error error = { .code = ECO_OK };
	assert_null(eco_module(module, &error));
	assert_int_equal(error.code, ECO_NOT_FOUND);
	if (!strstr(error.text, says) || !strstr(error.text, and))
		fail_msg("neither \"%s\" nor \"%s\" in: %s", says, and, error.text);
}

UNIT_TEST(a_missing_module_says_what_for_and_where_it_was_looked_for)
{
	put("ecogdal.so", NULL);
	setenv(ECO_MODULES_VARIABLE, FOLDER, 1);
	assert_refused(ECO_MODULE_GDAL, "ecogdal.so, needed for rasters", "in " FOLDER);
	assert_null(eco_module(ECO_MODULE_GDAL, NULL));
}

UNIT_TEST(what_is_no_library_is_refused)
{
	put("ecogdal.so", "not a library");
	setenv(ECO_MODULES_VARIABLE, FOLDER, 1);
	assert_refused(ECO_MODULE_GDAL, "ecogdal.so, needed for rasters", "cannot be loaded");
	put("ecogdal.so", NULL);
}

/* The module of PROJ under GDAL's name has no table of GDAL's. */
UNIT_TEST(another_module_under_that_name_is_refused)
{
	/* the program's: the last of its path, which may lie below another of that name */
	char target[4096], *folder = target;
	ssize_t length = readlink("/proc/self/exe", target, sizeof target - 20);
	assert_true(length > 0);
	target[length] = 0;
	for (char *next = target; (next = strstr(next + 1, "/tests/"));)
		folder = next;
	strcpy(folder + 1, "ecoproj.so");
	put("ecogdal.so", NULL);
	assert_int_equal(symlink(target, FOLDER "/ecogdal.so"), 0);
	setenv(ECO_MODULES_VARIABLE, FOLDER, 1);
	assert_refused(ECO_MODULE_GDAL, FOLDER "/ecogdal.so", "belongs to another version");
	put("ecogdal.so", NULL);
}

UNIT_TEST(modules_above_the_programs_folder_are_found_and_kept)
{
	const uint32_t *table;
	unsetenv(ECO_MODULES_VARIABLE);
	table = eco_module(ECO_MODULE_PROJ, NULL);
	assert_non_null(table);
	assert_int_equal(*table, ECO_MODULE_VERSION);
	setenv(ECO_MODULES_VARIABLE, FOLDER, 1);
	assert_ptr_equal(eco_module(ECO_MODULE_PROJ, NULL), table);
}
