/* A private copy holds what the file held, has no name, and fails with reasons. */
#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/files.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define FOLDER "build/tmp/test_private_copy"
#define FILE_PATH "build/tmp/test_private_copy.bin"
#define SIZE 100000u

static uint8_t bytes[SIZE], read_back[SIZE];

static int fill(void **state)
{
	for (uint32_t i = 0; i < SIZE; i++)
		bytes[i] = (uint8_t)(i * i >> 5);
	folder_make("build/tmp");
	folder_make(FOLDER);
	return 0;
}

static int file_of(size_t size)
{
	int file = open(FILE_PATH, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	assert_true(file >= 0);
	assert_int_equal(write(file, bytes, size), size);
	return file;
}

static unsigned names_in(const char *folder)
{
	DIR *names = opendir(folder);
	unsigned count = 0;
	assert_non_null(names);
	for (struct dirent *entry; (entry = readdir(names));)
		count += entry->d_name[0] != '.';
	closedir(names);
	return count;
}

UNIT_TEST(it_stays_when_the_file_changes)
{
	struct stat status;
	int file = file_of(SIZE), copy;
	lseek(file, 77, SEEK_SET);
	assert_good(eco_private_copy(&copy, file, "bytes", FOLDER, NULL, &cause));
	assert_int_equal(pwrite(file, bytes + 1000, 5000, 0), 5000);
	assert_int_equal(ftruncate(file, 10), 0);
	assert_int_equal(unlink(FILE_PATH), 0);
	close(file);
	assert_int_equal(pread(copy, read_back, SIZE, 0), SIZE);
	assert_memory_equal(read_back, bytes, SIZE);
	assert_int_equal(fstat(copy, &status), 0);
	assert_int_equal(status.st_size, SIZE);
	assert_int_equal(status.st_nlink, 0);
	assert_int_equal(names_in(FOLDER), 0);
	close(copy);
}

UNIT_TEST(no_folder_is_an_error_that_names_it)
{
	struct eco_error error = { 0 };
	int file = file_of(10), copy;
	assert_int_equal(eco_private_copy(&copy, file, "bytes", FOLDER "/none", NULL, &error), ECO_IO);
	assert_int_equal(copy, -1);
	assert_string_equal(error.text,
		"bytes: cannot make a private copy in " FOLDER "/none: No such file or "
		"directory");
	close(file);
}

UNIT_TEST(it_ends_when_it_is_cancelled)
{
	const atomic_bool cancelled = true;
	int file = file_of(10), copy;
	assert_code(eco_private_copy(&copy, file, "bytes", FOLDER, &cancelled, &cause), ECO_INTERRUPTED, "");
	assert_int_equal(copy, -1);
	close(file);
}

UNIT_MAIN(fill, NULL)
