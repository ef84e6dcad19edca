#include "ecofiles/base/private_copy.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/fs.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

#define PIECE_BYTES (16u << 20)

/* Not every file system has O_TMPFILE. */
static int nameless_file(const char *folder)
{
	char path[PATH_MAX];
	int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0400);
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
	int made = nameless_file(folder);
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
