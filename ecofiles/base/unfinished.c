#include "ecofiles/base/unfinished.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

bool eco_unfinished_is(const char *name, const char *of)
{
	size_t length = strlen(of);
	if (strncmp(name, of, length) || strncmp(name + length, ".tmp-", 5))
		return false;
	const char *rest = name + length + 5;
	size_t digits = strspn(rest, "0123456789");
	return digits && (!rest[digits] || !strcmp(rest + digits, "-payloads"));
}

bool eco_unfinished_lock(int file)
{
	struct stat status;
	return flock(file, LOCK_EX) || fstat(file, &status) || status.st_nlink;
}

/* The file or folder, locked; -1: a process writes it, or it is something else. */
static int open_left_over(int folder, const char *name, mode_t kind)
{
	struct stat status;
	int file = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (file >= 0 && !fstat(file, &status) && (status.st_mode & S_IFMT) == kind
			&& !flock(file, LOCK_EX | LOCK_NB))
		return file;
	if (file >= 0)
		close(file);
	return -1;
}

void eco_unfinished_remove_file(int folder, const char *name)
{
	int file = open_left_over(folder, name, S_IFREG);
	if (file < 0)
		return;
	unlinkat(folder, name, 0);
	close(file);
}

/* ---- Folders ---- */

static bool is_below(const char *name, const char *const *below)
{
	for (below++; *below; below++)
		if (!strcmp(name, *below))
			return true;
	return false;
}

static DIR *open_folder(int folder, const char *name)
{
	int file = openat(folder, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
	DIR *all = file >= 0 ? fdopendir(file) : NULL;
	if (file >= 0 && !all)
		close(file);
	return all;
}

static bool is_hidden(const struct dirent *entry) { return entry->d_name[0] == '.'; }

static bool holds_nothing_else(int folder, const char *name, const char *const *below)
{
	DIR *all = open_folder(folder, name);
	bool good = all != NULL;
	for (const struct dirent *entry; good && (entry = readdir(all));)
		good = is_hidden(entry) ? !strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")
			: is_below(entry->d_name, below)
				|| !strncmp(entry->d_name, below[0], strlen(below[0]));
	if (all)
		closedir(all);
	return good;
}

static void remove_files(int folder, const char *name)
{
	DIR *all = open_folder(folder, name);
	for (const struct dirent *entry; all && (entry = readdir(all));)
		if (!is_hidden(entry))
			unlinkat(dirfd(all), entry->d_name, 0);
	if (all)
		closedir(all);
	unlinkat(folder, name, AT_REMOVEDIR);
}

void eco_unfinished_remove_folder(int folder, const char *name, const char *const *below)
{
	int in = openat(folder, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
	for (const char *const *each = below + 1; in >= 0 && *each; each++)
		remove_files(in, *each);
	if (in >= 0)
		close(in);
	remove_files(folder, name);
}

void eco_unfinished_remove(const char *path, const char *const *below)
{
	const char *slash = strrchr(path, '/'), *of = slash ? slash + 1 : path;
	char folder[PATH_MAX] = ".";
	if (slash && snprintf(folder, sizeof folder, "%.*s", slash == path ? 1 : (int)(slash - path), path)
			>= (int)sizeof folder)
		return;
	DIR *all = opendir(folder);
	for (const struct dirent *entry; all && (entry = readdir(all));) {
		if (!eco_unfinished_is(entry->d_name, of))
			continue;
		int file = below ? open_left_over(dirfd(all), entry->d_name, S_IFDIR) : -1;
		if (file >= 0 && holds_nothing_else(dirfd(all), entry->d_name, below))
			eco_unfinished_remove_folder(dirfd(all), entry->d_name, below);
		if (file >= 0)
			close(file);
		if (!below)
			eco_unfinished_remove_file(dirfd(all), entry->d_name);
	}
	if (all)
		closedir(all);
}
