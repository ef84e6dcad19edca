/* A list of allowed calls: ecoserve links few libraries, and what they call is known. What is not on it fails
 * with EPERM, which callers handle, rather than end a server that may serve on. A call that a later C library
 * makes in place of an older one fails with ENOSYS, so that the older one is made. */
#include <errno.h>
#include <fcntl.h>
#include <linux/fs.h>
#include <sched.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <termios.h>
#include <unistd.h>

#include "server/sandbox.h"

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

/* Kernels read 32 bits of a request to ioctl, prctl and fcntl. */
static int allow_of(scmp_filter_ctx filter, int call, unsigned argument, uint32_t value)
{
	return seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 1,
		SCMP_CMP(argument, SCMP_CMP_MASKED_EQ, UINT32_MAX, value));
}

static int allow_requests(scmp_filter_ctx filter)
{
	return allow_of(filter, CALL(ioctl), 1, (uint32_t)FICLONE)
		| allow_of(filter, CALL(ioctl), 1, FIONREAD) | allow_of(filter, CALL(ioctl), 1, TIOCOUTQ)
		| allow_of(filter, CALL(ioctl), 1, FIONBIO) | allow_of(filter, CALL(ioctl), 1, TCGETS)
		| allow_of(filter, CALL(fcntl), 1, F_GETFD) | allow_of(filter, CALL(fcntl), 1, F_SETFD)
		| allow_of(filter, CALL(fcntl), 1, F_GETFL) | allow_of(filter, CALL(fcntl), 1, F_SETFL)
		| allow_of(filter, CALL(fcntl), 1, F_DUPFD_CLOEXEC)
		| allow_of(filter, CALL(prctl), 0, PR_SET_NAME);
}

/* Memory is written or executed, never made executable. */
static int allow_data(scmp_filter_ctx filter)
{
	return seccomp_rule_add(filter, SCMP_ACT_ALLOW, CALL(mmap), 1,
		SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0))
		| seccomp_rule_add(filter, SCMP_ACT_ALLOW, CALL(mprotect), 1,
		SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
}

/* Threads, not processes; signals and limits of nobody but itself, as when it aborts. clone3 has its flags
 * where a filter does not see them. */
static int allow_self(scmp_filter_ctx filter)
{
	scmp_datum_t self = (scmp_datum_t)getpid();
	return seccomp_rule_add(filter, SCMP_ACT_ALLOW, CALL(clone), 1,
		SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD))
		| seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(clone3), 0)
		| seccomp_rule_add(filter, SCMP_ACT_ALLOW, CALL(tgkill), 1, SCMP_A0(SCMP_CMP_EQ, self))
		| seccomp_rule_add(filter, SCMP_ACT_ALLOW, CALL(prlimit64), 2,
		SCMP_A0(SCMP_CMP_EQ, 0), SCMP_A2(SCMP_CMP_EQ, 0));
}

enum eco_code srv_sandbox_filter(struct eco_error *error)
{
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
	if (!filter)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a filter of system calls");
	int failed = 0;
	for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++)
		/* some calls do not exist on some machines */
		failed |= seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0) == -ENOMEM;
	failed |= allow_requests(filter) | allow_data(filter) | allow_self(filter);
	failed = failed != 0 || seccomp_load(filter) != 0;
	seccomp_release(filter);
	return failed ? eco_fail(error, ECO_UNSUPPORTED, "this system allows no filter of system calls")
		: ECO_OK;
}
