/* fork, limits, a memory file for the result and a shared page for the error. */
#include "ecofiles/guard.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

static void limit(int resource, rlim_t most)
{
	struct rlimit now;

	if (getrlimit(resource, &now) != 0)
		return;
	if (now.rlim_max != RLIM_INFINITY && now.rlim_max < most)
		most = now.rlim_max;
	now.rlim_cur = now.rlim_max = most;
	setrlimit(resource, &now);
}

static _Noreturn void child(eco_guard_work *work, void *ctx, FILE *out, struct eco_error *shared)
{
	struct eco_error error = { .code = ECO_OK };
	enum eco_code code;

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	signal(SIGINT, SIG_DFL);
	signal(SIGTERM, SIG_DFL);
	limit(RLIMIT_CORE, 0);
	limit(RLIMIT_CPU, ECO_GUARD_CPU_S);
	alarm(2 * ECO_GUARD_CPU_S);          /* a file that never comes, a lock that is never given */
	if (!SANITIZED)
		limit(RLIMIT_AS, ECO_GUARD_MEMORY);
	code = work(ctx, out, &error);
	if (fflush(out) != 0 && code == ECO_OK)
		code = eco_fail(&error, ECO_IO, "the result could not be handed over: %s", strerror(errno));
	*shared = error;
	shared->code = code;
	_exit(0);
}

static enum eco_code verdict(int status, const struct eco_error *shared, const char *what, struct eco_error *error)
{
	if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
		if ((unsigned)shared->code >= ECO_CODE_COUNT)
			return eco_fail(error, ECO_DAMAGED, "%.300s: the import came to no end", what);
		return shared->code == ECO_OK ? ECO_OK : eco_fail(error, shared->code, "%s", shared->text);
	}
	if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM))
		return eco_fail(error, ECO_INTERRUPTED, "%.300s: interrupted", what);
	if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM))
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: not read within %u s", what, ECO_GUARD_CPU_S);
	if (WIFSIGNALED(status))
		return eco_fail(error, ECO_DAMAGED, "%.300s: reading it ended with signal %d (%s): it is damaged, too large, or meets a bug in the "
			"library that reads it", what, WTERMSIG(status), strsignal(WTERMSIG(status)));
	return eco_fail(error, ECO_DAMAGED, "%.300s: reading it ended with exit status %d", what, WEXITSTATUS(status));
}

static enum eco_code fork_and_wait(eco_guard_work *work, void *ctx, const char *what, FILE *out, struct eco_error *shared,
	struct eco_error *error)
{
	pid_t pid;
	int status;

	shared->code = ECO_CODE_COUNT;       /* until the child says otherwise */
	fflush(NULL);
	pid = fork();
	if (pid < 0)
		return eco_fail(error, ECO_IO, "%.300s: no process to read it: %s", what, strerror(errno));
	if (pid == 0)
		child(work, ctx, out, shared);
	while (waitpid(pid, &status, 0) < 0)
		if (errno != EINTR)
			return eco_fail(error, ECO_IO, "%.300s: %s", what, strerror(errno));
	shared->text[sizeof shared->text - 1] = 0;
	return verdict(status, shared, what, error);
}

enum eco_code eco_guard_run(eco_guard_work *work, void *ctx, const char *what, const struct eco_guard_limits *limits, FILE **result,
	struct eco_error *error)
{
	struct eco_error *shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	int memory = memfd_create("eco-guard", MFD_CLOEXEC);
	FILE *out = memory >= 0 ? fdopen(memory, "w+b") : NULL;
	enum eco_code code;

	(void)limits;
	*result = NULL;
	if (shared == MAP_FAILED || out == NULL)
		code = eco_fail(error, ECO_IO, "%.300s: no memory to read it into: %s", what, strerror(errno));
	else
		code = fork_and_wait(work, ctx, what, out, shared, error);
	if (code == ECO_OK && fseek(out, 0, SEEK_SET) == 0)
		*result = out;
	else if (out != NULL)
		fclose(out);
	else if (memory >= 0)
		close(memory);
	if (shared != MAP_FAILED)
		munmap(shared, sizeof *shared);
	return code;
}
