#include "server/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <libgen.h>
#include <linux/capability.h>
#include <linux/fs.h>
#include <pwd.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include "ecofiles/base/confine.h"

/* ---- User ---- */

/* Capabilities by system call: libcap would be a library for two calls. */
#define OVER_FILES (1u << CAP_DAC_OVERRIDE)

enum eco_code srv_user_find(struct srv_user *user, const char *name, struct eco_error *error)
{
	bool is_root = geteuid() == 0;
	*user = (struct srv_user){ .user = geteuid(), .group = getegid(), .was_asked_for = name };
	if (!name && !is_root)
		return ECO_OK;
	errno = 0;
	const struct passwd *found = getpwnam(name ? name : SRV_USER_DEFAULT);
	if (!found && errno == ENOMEM)
		return eco_fail(error, ECO_NO_MEMORY, "no memory to look for a user");
	if (!found)
		return eco_fail(error, ECO_BAD_USAGE, "--user: there is no user '%.80s'",
			name ? name : SRV_USER_DEFAULT);
	user->changes = found->pw_uid != user->user;
	if (user->changes && !is_root)
		return eco_fail(error, ECO_BAD_USAGE, "--user %.80s: only root can become another user", name);
	user->user = found->pw_uid;
	user->group = found->pw_gid;
	return ECO_OK;
}

/* 0, or -1 and errno. */
static int set_capabilities(uint32_t permitted, uint32_t effective)
{
	struct __user_cap_header_struct header = { .version = _LINUX_CAPABILITY_VERSION_3 };
	const struct __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3] = { { .permitted = permitted,
		.effective = effective } };
	return (int)syscall(SYS_capset, &header, data);
}

static bool change(const struct srv_user *user)
{
	const gid_t none = 0;
	for (int right = 0; right <= CAP_LAST_CAP; right++)
		prctl(PR_CAPBSET_DROP, right, 0, 0, 0);
	return !prctl(PR_SET_KEEPCAPS, 1, 0, 0, 0) && !setgroups(0, &none)
		&& !setresgid(user->group, user->group, user->group)
		&& !setresuid(user->user, user->user, user->user)
		&& !set_capabilities(OVER_FILES, OVER_FILES);
}

/* From now on this process is that user, and of root's rights has that over files until it settles.
 * ECO_UNSUPPORTED: it is not allowed to. */
static enum eco_code become(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	const struct srv_user *user = sandbox->user;
	int last_signal = 0;
	pid_t parent = getppid();
	if (!user->changes)
		return ECO_OK;
	prctl(PR_GET_PDEATHSIG, &last_signal);
	if (!change(user))
		return eco_fail(error, ECO_UNSUPPORTED, "cannot become user %u: %s", (unsigned)user->user,
			strerror(errno));
	/* The change of user clears the signal that ends this process with its parent: set it again. */
	if (last_signal && (prctl(PR_SET_PDEATHSIG, last_signal) || getppid() != parent))
		raise(last_signal);
	return ECO_OK;
}

static bool all_allow(const char *const *path, int access)
{
	for (; path && *path; path++)
		if (faccessat(AT_FDCWD, *path, access, AT_EACCESS) && errno == EACCES)
			return false;
	return true;
}

/* ---- System calls ---- */

/* A list of allowed calls: ecoserve links few libraries, and their calls are known. Others fail with EPERM,
 * which callers handle, rather than end a server that may serve on. A call that a later C library makes in
 * place of an older one fails with ENOSYS, so that the older one is made. */
#define CALL(name) SCMP_SYS(name)

static const int allowed[] = {
	/* memory, threads, time */
	CALL(munmap), CALL(mremap), CALL(madvise), CALL(brk), CALL(futex), CALL(set_robust_list), CALL(rseq),
	CALL(gettid), CALL(getpid), CALL(sched_yield), CALL(sched_getaffinity), CALL(getcpu), CALL(exit),
	CALL(exit_group), CALL(restart_syscall), CALL(clock_gettime), CALL(clock_getres),
	CALL(clock_nanosleep), CALL(nanosleep), CALL(gettimeofday), CALL(time), CALL(getrandom),
	/* signals that come */
	CALL(rt_sigaction), CALL(rt_sigprocmask), CALL(rt_sigreturn), CALL(rt_sigtimedwait),
	CALL(sigaltstack),
	/* connections, which come by a socket that is open */
	CALL(accept), CALL(accept4), CALL(recvfrom), CALL(recvmsg), CALL(sendto), CALL(sendmsg),
	CALL(shutdown), CALL(setsockopt), CALL(getsockopt), CALL(getsockname), CALL(getpeername),
	CALL(sendfile), CALL(poll), CALL(ppoll), CALL(epoll_create1), CALL(epoll_ctl), CALL(epoll_wait),
	CALL(epoll_pwait), CALL(eventfd2),
	/* files, as far as Landlock opens them */
	CALL(read), CALL(readv), CALL(pread64), CALL(write), CALL(writev), CALL(close), CALL(lseek),
	CALL(openat), CALL(open), CALL(fstat), CALL(stat), CALL(lstat), CALL(newfstatat), CALL(statx),
	CALL(getdents64), CALL(readlink), CALL(readlinkat), CALL(getcwd), CALL(access),
	CALL(faccessat), CALL(faccessat2), CALL(unlink), CALL(unlinkat), CALL(fadvise64),
	/* what it is told of itself */
	CALL(getuid), CALL(geteuid), CALL(getgid), CALL(getegid), CALL(getrusage), CALL(sysinfo), CALL(uname),
};

/* Calls that are allowed if so many bits of an argument are these. */
static const struct { int call; unsigned argument; uint64_t mask, value; } rules[] = {
	/* kernels read 32 bits of a request to ioctl, prctl and fcntl */
	{ CALL(ioctl), 1, UINT32_MAX, (uint32_t)FICLONE }, { CALL(ioctl), 1, UINT32_MAX, FIONREAD },
	{ CALL(ioctl), 1, UINT32_MAX, TIOCOUTQ }, { CALL(ioctl), 1, UINT32_MAX, FIONBIO },
	{ CALL(ioctl), 1, UINT32_MAX, TCGETS }, { CALL(fcntl), 1, UINT32_MAX, F_GETFD },
	{ CALL(fcntl), 1, UINT32_MAX, F_SETFD }, { CALL(fcntl), 1, UINT32_MAX, F_GETFL },
	{ CALL(fcntl), 1, UINT32_MAX, F_SETFL }, { CALL(fcntl), 1, UINT32_MAX, F_DUPFD_CLOEXEC },
	{ CALL(prctl), 0, UINT32_MAX, PR_SET_NAME },
	/* memory is written or executed, never made executable */
	{ CALL(mmap), 2, PROT_EXEC, 0 }, { CALL(mprotect), 2, PROT_EXEC, 0 },
	/* threads, not processes */
	{ CALL(clone), 0, CLONE_THREAD, CLONE_THREAD },
};

/* Signals and limits of nobody but itself, as when it aborts. clone3 has its flags where a filter does not
 * see them. */
static int add_rules(scmp_filter_ctx to)
{
	int failed = seccomp_rule_add(to, SCMP_ACT_ERRNO(ENOSYS), CALL(clone3), 0)
		| seccomp_rule_add(to, SCMP_ACT_ALLOW, CALL(tgkill), 1, SCMP_A0(SCMP_CMP_EQ, (scmp_datum_t)getpid()))
		| seccomp_rule_add(to, SCMP_ACT_ALLOW, CALL(prlimit64), 2, SCMP_A0(SCMP_CMP_EQ, 0),
		SCMP_A2(SCMP_CMP_EQ, 0));
	for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++)
		/* some calls do not exist on some machines */
		failed |= seccomp_rule_add(to, SCMP_ACT_ALLOW, allowed[i], 0) == -ENOMEM;
	for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
		failed |= seccomp_rule_add(to, SCMP_ACT_ALLOW, rules[i].call, 1, SCMP_CMP(rules[i].argument,
			SCMP_CMP_MASKED_EQ, rules[i].mask, rules[i].value));
	return failed;
}

/* For this thread and those that it starts. */
static enum eco_code filter(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	(void)sandbox;
	scmp_filter_ctx to = seccomp_init(SCMP_ACT_ERRNO(EPERM));
	if (!to)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a filter of system calls");
	bool failed = add_rules(to) || seccomp_load(to);
	seccomp_release(to);
	return failed ? eco_fail(error, ECO_UNSUPPORTED, "this system allows no filter of system calls")
		: ECO_OK;
}

/* ---- Folders ---- */

/* As long as the process: what may be read, and what may be written. */
static char **folders;
static uint32_t folder_count;
static const char *copies[2];

static bool is_folder(const char *path)
{
	struct stat about;
	return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* The folder, or that of the file; false: no memory. One that is not there holds a pack that is not there. */
static bool add_folder(const char *path, bool is_file)
{
	char *copy = strdup(path), *folder = copy ? strdup(is_file ? dirname(copy) : copy) : NULL;
	free(copy);
	if (folder && is_folder(folder))
		folders[folder_count++] = folder;
	else
		free(folder);
	return folder;
}

/* The folder of a pack, and that of the file that its name links to. */
static bool add_folders_of(const char *path)
{
	char *real = realpath(path, NULL);
	bool added = add_folder(path, true) && (!real || add_folder(real, true));
	free(real);
	return added;
}

static enum eco_code list_folders(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	const struct srv_sources *sources = sandbox->sources;
	const struct srv_store *store = sandbox->store;
	char name[SRV_NAME_BYTES + 1];
	folders = calloc(2 * ((size_t)sources->count + store->count) + 1, sizeof *folders);
	bool added = folders;
	for (uint32_t i = 0; i < sources->count && added; i++) {
		const char *path = srv_source_path(sources->arguments[i], name);
		added = is_folder(path) ? add_folder(path, false) : add_folders_of(path);
	}
	for (uint32_t i = 0; i < store->count && added; i++)
		added = add_folders_of(store->scenes[i]->file.path);
	copies[0] = sources->copies;
	return added ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for the names of folders");
}

/* ---- All of it ---- */

static enum eco_code confine(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	(void)sandbox;
	return eco_confine(&(struct eco_confined_paths){ .readable = (const char *const *)folders, .writable = copies,
		.without_libraries = true }, error);
}

/* Gives up the right over files for good, unless folders confine it and one cannot be read or written without. */
static enum eco_code settle(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	if (!sandbox->user->changes)
		return ECO_OK;
	int failed = set_capabilities(OVER_FILES, 0);
	bool keep = eco_is_confined() && !(all_allow((const char *const *)folders, R_OK)
		&& all_allow(copies, R_OK | W_OK));
	uint32_t rights = keep ? OVER_FILES : 0;
	if (!failed && !set_capabilities(rights, rights))
		return ECO_OK;
	return eco_fail(error, ECO_UNSUPPORTED, "cannot give up root's rights: %s", strerror(errno));
}

/* The parts in their order, and the consequence for a system that lacks one; NULL: it must not. */
static const struct {
	enum eco_code (*enter)(const struct srv_sandbox *sandbox, struct eco_error *error);
	const char *without;
} parts[] = { { become, "it serves as root" }, { confine, "it may read whatever its user may" },
	{ settle, NULL }, { filter, "it may call whatever its user may" } };

enum eco_code srv_sandbox_enter(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	enum eco_code code = list_folders(sandbox, error);
	for (size_t i = 0; i < sizeof parts / sizeof *parts && !code; i++) {
		struct eco_error why = { 0 };
		code = parts[i].enter(sandbox, &why);
		bool lacks = code == ECO_UNSUPPORTED && parts[i].without;
		if (code && i == 0 && sandbox->user->was_asked_for)
			return eco_fail(error, code, "--user: %s", why.text);
		if (code && (!lacks || sandbox->required))
			return eco_fail(error, code, "%s%s", why.text, lacks ? " (--require-sandbox)" : "");
		if (code)
			srv_log_event(sandbox->log_form, true, "warning: %s; %s", why.text, parts[i].without);
		code = ECO_OK;
	}
	return code;
}
