#include "ecofiles/base/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <linux/fs.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- Unfinished outputs ---- */

bool eco_unfinished_is(const char *name, const char *of)
{
	size_t length = strlen(of);
	if (strncmp(name, of, length) || strncmp(name + length, ".tmp-", 5))
		return false;
	const char *rest = name + length + 5;
	size_t digits = strspn(rest, "0123456789");
	return digits && !rest[digits];
}

bool eco_unfinished_lock(int file)
{
	struct stat status;
	return flock(file, LOCK_EX) || fstat(file, &status) || status.st_nlink;
}

void eco_unfinished_remove_file(int folder, const char *name)
{
	struct stat status;
	int file = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (file < 0)
		return;
	if (!fstat(file, &status) && S_ISREG(status.st_mode) && !flock(file, LOCK_EX | LOCK_NB))
		unlinkat(folder, name, 0);
	close(file);
}

void eco_unfinished_remove(const char *path)
{
	const char *slash = strrchr(path, '/'), *of = slash ? slash + 1 : path;
	char folder[PATH_MAX] = ".";
	if (slash && snprintf(folder, sizeof folder, "%.*s", slash == path ? 1 : (int)(slash - path), path)
			>= (int)sizeof folder)
		return;
	DIR *all = opendir(folder);
	for (const struct dirent *entry; all && (entry = readdir(all));)
		if (eco_unfinished_is(entry->d_name, of))
			eco_unfinished_remove_file(dirfd(all), entry->d_name);
	if (all)
		closedir(all);
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *walk)
{
	(void)status, (void)kind, (void)walk;
	remove(path);
	return 0;
}

void eco_folder_remove(const char *path) { nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS | FTW_MOUNT); }

/* ---- Whole files ---- */

enum eco_code eco_file_write(const char *path, const void *bytes, size_t size, struct eco_error *error)
{
	char beside[4096];
	if (snprintf(beside, sizeof beside, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof beside)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s...: the path is too long", path);
	FILE *out = fopen(beside, "wb");
	while (out && !eco_unfinished_lock(fileno(out))) {
		fclose(out);
		out = fopen(beside, "wb");
	}
	bool good = out && fwrite(bytes, 1, size, out) == size;
	if (out && fclose(out) != 0)
		good = false;
	if (good && rename(beside, path) == 0)
		return ECO_OK;
	enum eco_code code = eco_fail_write(error, path, errno);
	if (out)
		unlink(beside);
	return code;
}

enum eco_code eco_file_read(const char *path, uint64_t most, uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	size_t room = 1 << 16, n = 1;
	enum eco_code code = ECO_OK;
	FILE *file = fopen(path, "rb");
	*bytes = NULL;
	*size = 0;
	if (!file)
		return eco_fail_read(error, path, errno);
	for (; !code && n; *size += n) {
		room *= *size + 1 < room ? 1 : 2;
		uint8_t *more = realloc(*bytes, room);
		*bytes = more ? more : *bytes;
		n = more ? fread(more + *size, 1, room - *size - 1, file) : 0;
		if (!more)
			code = eco_fail(error, ECO_NO_MEMORY, "%.400s: out of memory", path);
		else if (ferror(file))
			code = eco_fail_read(error, path, errno);
		else if (*size + n > most)
			code = eco_fail(error, ECO_TOO_LARGE, "%.300s: more than the %llu bytes that are possible",
				path, (unsigned long long)most);
		else
			more[*size + n] = 0;
	}
	fclose(file);
	if (code) {
		free(*bytes);
		*bytes = NULL;
	}
	return code;
}

enum eco_code eco_folder_sync(const char *path, struct eco_error *error)
{
	int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	bool good = folder >= 0 && syncfs(folder) == 0;
	enum eco_code code = good ? ECO_OK : eco_fail_write(error, path, errno);
	if (folder >= 0)
		close(folder);
	return code;
}

/* ---- Private copies ---- */

#define PIECE_BYTES (16u << 20)

/* Not every file system has O_TMPFILE. */
int eco_file_nameless(const char *folder)
{
	char path[PATH_MAX];
	int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
	if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR))
		return file;
	if (snprintf(path, sizeof path, "%s/ecostream-XXXXXX", folder) >= (int)sizeof path) {
		errno = ENAMETOOLONG;
		return -1;
	}
	file = mkostemp(path, O_CLOEXEC);
	if (file >= 0)
		unlink(path);
	return file;
}

static bool is_set(const atomic_bool *flag)
{
	return flag && atomic_load(flag);
}

/* 0, or the error's number; ESTALE where the file ended before `size`, ECANCELED. */
static int copy_bytes(int copy, int file, off_t size, const atomic_bool *cancelled)
{
	off_t at = 0;
	if (is_set(cancelled))
		return ECANCELED;
	if (!ioctl(copy, FICLONE, file))
		return 0;
	while (at < size) {
		if (is_set(cancelled))
			return ECANCELED;
		off_t left = size - at;
		ssize_t sent = sendfile(copy, file, &at, left < PIECE_BYTES ? (size_t)left : PIECE_BYTES);
		if (sent < 0 && errno != EINTR)
			return errno;
		if (!sent)
			return ESTALE;
	}
	return 0;
}

enum eco_code eco_private_copy(int *copy, int file, const char *name, const char *folder,
	const atomic_bool *cancelled, struct eco_error *error)
{
	struct stat before, after, copied;
	*copy = -1;
	if (fstat(file, &before))
		return eco_fail_read(error, name, errno);
	int made = eco_file_nameless(folder);
	if (made < 0)
		return eco_fail(error, ECO_IO, "%s: cannot make a private copy in %s: %s", name, folder,
			strerror(errno));
	int failed = copy_bytes(made, file, before.st_size, cancelled);
	if (!failed && (fstat(file, &after) || fstat(made, &copied)))
		failed = errno;
	if (!failed && after.st_size == before.st_size && copied.st_size == before.st_size) {
		*copy = made;
		return ECO_OK;
	}
	close(made);
	if (failed == ECANCELED)
		return eco_fail(error, ECO_INTERRUPTED, "%s: its copying was interrupted", name);
	if (failed && failed != ESTALE)
		return eco_fail(error, ECO_IO, "%s: a private copy of %lld bytes in %s: %s", name,
			(long long)before.st_size, folder, strerror(failed));
	return eco_fail(error, ECO_BAD_INPUT,
		"%s: it changed while it was read; try again when it is complete", name);
}
