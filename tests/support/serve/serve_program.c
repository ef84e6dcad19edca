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

struct program program_start(const char *const *arguments, void (*prepare)(void))
{
	pid_t self = getpid();
	int out[2], err[2];
	if (!program_path[0])
		skip();
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
	return (struct program){ .pid = pid, .out_fd = out[0], .err_fd = err[0] };
}

bool program_ready(struct program *program)
{
	char *line = program->line;
	size_t size = 0;
	while (size < sizeof program->line - 1 && read(program->out_fd, line + size, 1) == 1 && line[size++]
		!= '\n') continue;
	line[size] = 0;
	const char *colon = strrchr(line, ':');
	program->port = (uint16_t)(colon ? atoi(colon + 1) : 0);
	return program->port;
}

struct program program_serve(const char *const *arguments, void (*prepare)(void))
{
	struct program program = program_start(arguments, prepare);
	if (!program_ready(&program)) {
		program_finish(&program);
		fail_msg("%s", program.err);
	}
	return program;
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

int program_finish(struct program *program)
{
	int status;
	read_end(program->out_fd, program->out);
	read_end(program->err_fd, program->err);
	assert_true(waitpid(program->pid, &status, 0) == program->pid);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void program_stop(struct program *program)
{
	kill(program->pid, SIGTERM);
	if (program_finish(program) != 0)
		fail_msg("%s", program->err);
}

void program_fails(const char *const *arguments, int status, const char *says)
{
	struct program program = program_start(arguments, NULL);
	int ended = program_finish(&program);
	if (ended != status || program.out[0] || !strstr(program.err, says))
		fail_msg("'%s', %d:\n%s%s", says, ended, program.out, program.err);
}
