/* System calls by number: the C library of Debian 12 has no functions for Landlock. */
#include "ecofiles/base/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/landlock.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "ecofiles/base/module.h"

#define READ (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)
#define WRITE (LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG \
	| LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_REMOVE_DIR)
#define REST (LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_SOCK \
	| LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM)
/* Since its third version Landlock knows ftruncate as an access of its own; linux/landlock.h here may not. */
#define TRUNCATE (1ull << 14)
#define TRUNCATE_SINCE 3
#define OF_FILES (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE | TRUNCATE)

/* Libraries, their data (PROJ, GDAL), and what a process learns of itself. */
static const char *const own[] = { "/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/proc/self",
	"/dev/urandom" };

static struct eco_confined_paths confined_to;
static bool is_confined;

bool eco_is_confined(void)
{
	return is_confined;
}

static bool is_below(const char *real, const char *folder)
{
	char *top = realpath(folder, NULL);
	size_t length = top ? strlen(top) : 0;
	bool below = top && (!strcmp(top, "/") || (!strncmp(real, top, length)
		&& (real[length] == '/' || !real[length])));
	free(top);
	return below;
}

bool eco_confined_may_read(const char *path)
{
	char *real = is_confined ? realpath(path, NULL) : NULL;
	const char *const *folder = confined_to.readable;
	bool may = !real;
	for (; folder && *folder && !may; folder++)
		may = is_below(real, *folder);
	free(real);
	return may;
}

/* 0, or the error's number. */
static int allow(int rules, const char *path, uint64_t access)
{
	struct stat status;
	struct landlock_path_beneath_attr rule = { .parent_fd = open(path, O_PATH | O_CLOEXEC) };
	int failed = rule.parent_fd < 0 || fstat(rule.parent_fd, &status) ? errno : 0;
	if (!failed) {
		rule.allowed_access = S_ISDIR(status.st_mode) ? access : access & OF_FILES;
		failed = syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) 
			? errno : 0;
	}
	if (rule.parent_fd >= 0)
		close(rule.parent_fd);
	return failed;
}

static void allow_own(int rules, uint64_t write)
{
	char path[PATH_MAX];
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		allow(rules, own[i], READ);              /* some are not there, as /lib64 on other machines */
	allow(rules, "/dev/null", READ | write);
	for (int module = 0; module < ECO_MODULE_COUNT; module++)
		if (eco_module_find((enum eco_module)module, path))
			allow(rules, path, READ);
}

static enum eco_code allow_all(int rules, const char *const *path, uint64_t access, struct eco_error *error)
{
	for (; path && *path; path++) {
		int failed = allow(rules, *path, access);
		if (failed)
			return eco_fail(error, failed == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", *path,
				strerror(failed));
	}
	return ECO_OK;
}

static enum eco_code restrict_to(const struct eco_confined_paths *paths, struct eco_error *error)
{
	long version = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
	uint64_t write = WRITE | (version >= TRUNCATE_SINCE ? TRUNCATE : 0);
	struct landlock_ruleset_attr handled = { .handled_access_fs = READ | write | REST };
	int rules = version < 1 ? -1
		: (int)syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0);
	if (rules < 0)
		return eco_fail(error, ECO_UNSUPPORTED, "this system cannot confine a program to folders: "
			"its kernel has no Landlock, or it is switched off (%s)", strerror(errno));
	if (!paths->without_libraries)
		allow_own(rules, write);
	enum eco_code code = allow_all(rules, paths->readable, READ, error);
	code = code ? code : allow_all(rules, paths->writable, READ | write, error);
	if (!code &&
		(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || syscall(SYS_landlock_restrict_self, rules, 0)))
		code = eco_fail(error, ECO_UNSUPPORTED, "this system cannot confine a program to folders: %s",
			strerror(errno));
	close(rules);
	return code;
}

enum eco_code eco_confine(const struct eco_confined_paths *paths, struct eco_error *error)
{
	enum eco_code code = restrict_to(paths, error);
	if (code)
		return code;
	confined_to = *paths;
	is_confined = true;
	return ECO_OK;
}

bool eco_confine_child(void)
{
	struct eco_confined_paths paths = confined_to;
	paths.writable = NULL;
	return !is_confined || !restrict_to(&paths, NULL);
}
