#include "tests/support/serve/serve_program.h"

#include <libgen.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/unit_test.h"

char program_path[PATH_MAX];

void program_find(void)
{
	char self[PATH_MAX - 16];
	ssize_t size = readlink("/proc/self/exe", self, sizeof self - 1);
	assert_true(size > 0);
	self[size] = 0;
	snprintf(program_path, sizeof program_path, "%s/../ecoserve", dirname(self));
	if (access(program_path, X_OK))
		program_path[0] = 0;
}

void program_sandboxed(void)
{
	unsetenv("ECOSERVE_NO_SANDBOX");
	setenv("ASAN_OPTIONS", "allocator_may_return_null=1:detect_leaks=0", 1);
}

/* However this test ends, by a failed assertion or by a signal. */
static void die_with(pid_t parent)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(127);
}

struct program program_start_in(const char *const *arguments, void (*prepare)(void))
{
	pid_t self = getpid();
	int out[2], err[2];
	assert_true(pipe(out) == 0 && pipe(err) == 0);
	pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		const char *argv[16] = { program_path };
		die_with(self);
		for (int i = 0; arguments[i]; i++)
			argv[i + 1] = arguments[i];
		dup2(out[1], 1);
		dup2(err[1], 2);
		if (prepare)
			prepare();
		execv(program_path, (char *const *)argv);
		_exit(127);
	}
	close(out[1]);
	close(err[1]);
	return (struct program){ pid, out[0], err[0] };
}

struct program program_start(const char *const *arguments)
{
	return program_start_in(arguments, NULL);
}

uint16_t program_ready(struct program *program, char line[256])
{
	size_t size = 0;
	while (size < 255 && read(program->out, line + size, 1) == 1 && line[size++] != '\n')
		continue;
	line[size] = 0;
	const char *colon = strrchr(line, ':');
	return (uint16_t)(colon ? atoi(colon + 1) : 0);
}

static void read_end(int fd, char text[PROGRAM_SAYS])
{
	size_t size = 0;
	for (ssize_t got; size < PROGRAM_SAYS - 1
			&& (got = read(fd, text + size, PROGRAM_SAYS - 1 - size)) > 0;)
		size += (size_t)got;
	text[size] = 0;
	close(fd);
}

int program_finish(struct program *program, char out[PROGRAM_SAYS], char err[PROGRAM_SAYS])
{
	int status;
	read_end(program->out, out);
	read_end(program->err, err);
	assert_true(waitpid(program->pid, &status, 0) == program->pid);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
