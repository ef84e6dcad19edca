/* Capabilities by system call: libcap would be a library for two calls. */
#include "server/user.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <linux/capability.h>
#include <pwd.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

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

enum eco_code srv_user_become(const struct srv_user *user, struct eco_error *error)
{
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

enum eco_code srv_user_settle(bool may_keep, const char *const *read, const char *const *write,
	struct eco_error *error)
{
	int failed = set_capabilities(OVER_FILES, 0);
	bool keep = may_keep && !(all_allow(read, R_OK) && all_allow(write, R_OK | W_OK));
	uint32_t rights = keep ? OVER_FILES : 0;
	if (!failed && !set_capabilities(rights, rights))
		return ECO_OK;
	return eco_fail(error, ECO_UNSUPPORTED, "cannot give up root's rights: %s", strerror(errno));
}
