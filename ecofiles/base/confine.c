#include "ecofiles/base/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "ecofiles/base/module.h"

/* ---- Folders ---- */

/* System calls by number: the C library of Debian 12 has no functions for Landlock. */

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
	ECO_PASS(restrict_to(paths, error));
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

/* ---- System calls ---- */

/* A list of refused calls, not of allowed ones: another version of a library or of the C library may make
 * calls that nobody foresaw, and reading a file must not fail for that. The harmful calls are well known. */

#define CALL(name) SCMP_SYS(name)
#define FCHMODAT2 452            /* on all machines; libseccomp 2.5.4 does not know its name */

static const int refused[] = {
	/* network and messages */
	CALL(socket), CALL(socketpair), CALL(connect), CALL(bind), CALL(listen), CALL(accept), CALL(accept4),
		CALL(sendto), CALL(sendmsg),
	CALL(sendmmsg), CALL(mq_open), CALL(msgget), CALL(semget), CALL(shmget),
	/* programs, processes, memory of others */
	CALL(execve), CALL(execveat), CALL(fork), CALL(vfork), CALL(ptrace), CALL(process_vm_readv),
	CALL(process_vm_writev), CALL(pidfd_open), CALL(pidfd_getfd), CALL(pidfd_send_signal), CALL(kcmp),
	CALL(rt_sigqueueinfo), CALL(rt_tgsigqueueinfo), CALL(tkill),
	/* changes to names of files */
	CALL(creat), CALL(mkdir), CALL(mkdirat), CALL(mknod), CALL(mknodat), CALL(rmdir), CALL(unlink),
	CALL(unlinkat), CALL(rename), CALL(renameat), CALL(renameat2), CALL(link), CALL(linkat),
	CALL(symlink), CALL(symlinkat), CALL(truncate), CALL(chmod), CALL(fchmod), CALL(fchmodat), FCHMODAT2,
	CALL(chown), CALL(lchown), CALL(fchown), CALL(fchownat), CALL(utime), CALL(utimes), CALL(utimensat),
	CALL(futimesat), CALL(setxattr), CALL(lsetxattr), CALL(fsetxattr), CALL(removexattr),
	CALL(lremovexattr), CALL(fremovexattr), CALL(open_by_handle_at),
	CALL(inotify_init1), CALL(fanotify_init),
	/* the system's state, and ways around this filter */
	CALL(mount), CALL(umount2), CALL(open_tree), CALL(move_mount), CALL(fsopen), CALL(fsconfig),
	CALL(fsmount), CALL(fspick), CALL(mount_setattr), CALL(pivot_root), CALL(chroot), CALL(setns),
	CALL(unshare), CALL(swapon),
	CALL(swapoff), CALL(reboot), CALL(sethostname), CALL(setdomainname), CALL(settimeofday),
	CALL(clock_settime), CALL(adjtimex), CALL(init_module), CALL(finit_module), CALL(delete_module),
	CALL(kexec_load), CALL(bpf), CALL(perf_event_open), CALL(userfaultfd), CALL(add_key),
	CALL(request_key), CALL(keyctl), CALL(io_uring_setup), CALL(io_uring_enter), CALL(io_uring_register),
	CALL(quotactl), CALL(acct), CALL(setuid), CALL(setgid), CALL(setreuid), CALL(setregid),
	CALL(setresuid), CALL(setresgid), CALL(setgroups), CALL(setfsuid), CALL(setfsgid), CALL(setsid),
	CALL(setpgid), CALL(setrlimit), CALL(syslog), CALL(vhangup), CALL(iopl), CALL(ioperm),
};

/* Calls that are refused if so many bits of an argument are these. */
static const struct { int call; unsigned argument; uint64_t mask, value; } rules[] = {
	/* open and openat for anything but reading */
#define OPENING(bit) { CALL(open), 1, bit, bit }, { CALL(openat), 2, bit, bit }
	OPENING(O_WRONLY), OPENING(O_RDWR), OPENING(O_CREAT), OPENING(O_TRUNC), OPENING(O_APPEND),
	/* threads are allowed, processes are not */
	{ CALL(clone), 0, CLONE_THREAD, 0 },
	/* typing into the terminal that the user goes on to use; the kernel reads 32 bits of the request */
	{ CALL(ioctl), 1, UINT32_MAX, TIOCSTI },
};

/* Signals go only to oneself; limits may be read but not changed. Calls with arguments behind a pointer,
 * which the filter cannot see, do not exist: the C library falls back on older ones. */
static int refuse_others(scmp_filter_ctx filter)
{
	const uint32_t refuse = SCMP_ACT_ERRNO(EPERM), absent = SCMP_ACT_ERRNO(ENOSYS);
	scmp_datum_t self = (scmp_datum_t)getpid();
	return seccomp_rule_add(filter, refuse, CALL(kill), 1, SCMP_A0(SCMP_CMP_NE, self, 0))
		| seccomp_rule_add(filter, refuse, CALL(tgkill), 1, SCMP_A0(SCMP_CMP_NE, self, 0))
		| seccomp_rule_add(filter, refuse, CALL(prlimit64), 1, SCMP_A2(SCMP_CMP_NE, 0, 0))
		| seccomp_rule_add(filter, absent, CALL(openat2), 0) | seccomp_rule_add(filter, absent, CALL(clone3), 0);
}

bool eco_guard_filter(void)
{
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
	int failed = !filter;
	if (failed)
		return false;
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		/* some calls do not exist on some machines */
		failed |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), refused[i], 0) == -ENOMEM;
	for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
		failed |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), rules[i].call, 1,
			SCMP_CMP(rules[i].argument, SCMP_CMP_MASKED_EQ, rules[i].mask, rules[i].value));
	failed |= refuse_others(filter);
	seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, 2);
	failed = failed != 0 || seccomp_load(filter) != 0;
	seccomp_release(filter);
	return !failed;
}
