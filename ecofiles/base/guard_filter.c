/* A list of refused calls, not of allowed ones: another version of a library or of the C library may make
 * calls that nobody foresaw, and reading a file must not fail for that. The harmful calls are well known. */
#include "ecofiles/base/guard_filter.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/types.h>
#include <unistd.h>

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

/* open and openat for anything but reading. */
static int refuse_writing(scmp_filter_ctx filter)
{
	static const int bits[] = { O_WRONLY, O_RDWR, O_CREAT, O_TRUNC, O_APPEND };
	int failed = 0;
	for (size_t i = 0; i < sizeof bits / sizeof *bits; i++) {
		scmp_datum_t bit = (scmp_datum_t)bits[i];
		failed |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), CALL(open), 1,
			SCMP_A1(SCMP_CMP_MASKED_EQ, bit, bit));
		failed |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), CALL(openat), 1,
			SCMP_A2(SCMP_CMP_MASKED_EQ, bit, bit));
	}
	return failed;
}

/* The filter cannot see arguments behind a pointer, so such calls are refused; the C library falls back on
 * older ones. */
static int refuse_unseen(scmp_filter_ctx filter)
{
	return seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(openat2), 0)
		| seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), CALL(clone3), 0);
}

/* Typing into the terminal that the user goes on to use; the kernel reads 32 bits of the request. */
static int refuse_typing(scmp_filter_ctx filter)
{
	return seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), CALL(ioctl), 1,
		SCMP_A1(SCMP_CMP_MASKED_EQ, UINT32_MAX, TIOCSTI));
}

/* Threads are allowed, processes are not; signals only to oneself; limits may be read but not changed. */
static int refuse_others(scmp_filter_ctx filter)
{
	scmp_datum_t self = (scmp_datum_t)getpid();
	return seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), CALL(clone), 1,
		SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0)) | seccomp_rule_add(filter,
		SCMP_ACT_ERRNO(EPERM), CALL(kill), 1, SCMP_A0(SCMP_CMP_NE, self, 0))
		| seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), CALL(tgkill), 1,
		SCMP_A0(SCMP_CMP_NE, self, 0)) | seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM),
		CALL(prlimit64), 1, SCMP_A2(SCMP_CMP_NE, 0, 0));
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
	failed |= refuse_writing(filter) | refuse_unseen(filter) | refuse_others(filter)
		| refuse_typing(filter);
	seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, 2);
	failed = failed != 0 || seccomp_load(filter) != 0;
	seccomp_release(filter);
	return !failed;
}
