/* limit CPU_S WALL_S FILE PROGRAM ARGUMENT...: runs a program and ends it, with all that it started, when
 * these together have used CPU_S seconds of processor time, or after WALL_S seconds. FILE gets the seconds of
 * processor time, a number.
 *
 * Exit status: the program's; 128 + N after signal N; 124 if it was ended, and if for a limit, a line on
 * stderr says which; 127 if it cannot be started. What it leaves behind is ended, too.
 *
 * A busy machine makes no test slower in processor time, so that a limit of it fails no test that is well.
 * All descendants of this process are found in /proc by who their parent is: those whose parent ended become
 * children of this one (PR_SET_CHILD_SUBREAPER). Each counts what it and the children that it waited for have
 * used; those that this process waited for are in its own account. */
#include <dirent.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define PROCESSES_MAX 65536
#define LOOK_EVERY_MS 200
#define TERM_S 5.0                       /* from SIGTERM to SIGKILL */

static struct process { pid_t pid, parent; double cpu_s; bool is_ours; } processes[PROCESSES_MAX];
static size_t process_count;

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The name of a process is in parentheses and may hold anything, parentheses, too. */
static bool read_process(const char *pid, struct process *p)
{
	char path[64], text[1024];
	unsigned long user, system;
	long waited_user, waited_system;
	int parent;
	snprintf(path, sizeof path, "/proc/%.20s/stat", pid);
	FILE *file = fopen(path, "r");
	if (!file)
		return false;
	text[fread(text, 1, sizeof text - 1, file)] = 0;
	fclose(file);
	const char *at = strrchr(text, ')');
	if (!at || sscanf(at + 1, " %*c %d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %ld %ld", &parent,
			&user, &system, &waited_user,
		&waited_system) != 5)
		return false;
	*p = (struct process){ .pid = atoi(pid), .parent = parent };
	p->cpu_s = (double)(user + system + (unsigned long)waited_user + (unsigned long)waited_system)
		/ (double)sysconf(_SC_CLK_TCK);
	return true;
}

static void read_processes(void)
{
	DIR *folder = opendir("/proc");
	process_count = 0;
	for (struct dirent *entry; folder && (entry = readdir(folder)) && process_count < PROCESSES_MAX;)
		if (entry->d_name[0] >= '1' && entry->d_name[0] <= '9'
				&& read_process(entry->d_name, &processes[process_count]))
			process_count++;
	if (folder)
		closedir(folder);
}

static size_t mark_children(pid_t parent)
{
	size_t found = 0;
	for (size_t i = 0; i < process_count; i++)
		if (processes[i].parent == parent && !processes[i].is_ours) {
			processes[i].is_ours = true;
			found += 1 + mark_children(processes[i].pid);
		}
	return found;
}

/* Marks all descendants, and returns how many there are. */
static size_t find_descendants(void)
{
	read_processes();
	return mark_children(getpid());
}

/* The processor time of all descendants, living and gone. */
static double used_s(void)
{
	struct rusage usage;
	getrusage(RUSAGE_CHILDREN, &usage);
	double sum = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec)
		+ 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
	find_descendants();
	for (size_t i = 0; i < process_count; i++)
		if (processes[i].is_ours)
			sum += processes[i].cpu_s;
	return sum;
}

/* Waits for who has ended; true when `child` is among them. */
static bool reap(pid_t child, int *status)
{
	bool ended = false;
	int one;
	for (pid_t pid; (pid = waitpid(-1, &one, WNOHANG)) > 0;)
		if (pid == child) {
			*status = one;
			ended = true;
		}
	return ended;
}

static void pause_ms(int ms)
{
	nanosleep(&(struct timespec){ ms / 1000, ms % 1000 * 1000000L }, NULL);
}

/* Until none is left: what starts others meanwhile is found the next time. */
static void end_all(double term_s)
{
	int status;
	double start = now_s();
	while (find_descendants() > 0) {
		for (size_t i = 0; i < process_count; i++)
			if (processes[i].is_ours)
				kill(processes[i].pid, now_s() < start + term_s ? SIGTERM : SIGKILL);
		pause_ms(20);
		reap(0, &status);
	}
}

static pid_t start(char **argv, const sigset_t *signals)
{
	pid_t pid = fork();
	if (pid == 0) {
		sigprocmask(SIG_UNBLOCK, signals, NULL);
		execvp(argv[0], argv);
		perror(argv[0]);
		_exit(127);
	}
	return pid;
}

enum end { END_ITSELF, END_CPU, END_WALL, END_SIGNAL };

static enum end watch(pid_t child, double cpu_s, double wall_s, const sigset_t *signals, int *status)
{
	static const struct timespec pause = { 0, LOOK_EVERY_MS * 1000000L };
	double from = now_s();
	while (!reap(child, status)) {
		if (now_s() - from > wall_s)
			return END_WALL;
		if (used_s() > cpu_s)
			return END_CPU;
		int number = sigtimedwait(signals, NULL, &pause);
		if (number == SIGTERM || number == SIGINT)
			return END_SIGNAL;
	}
	return END_ITSELF;
}

static void write_used(const char *path)
{
	FILE *file = fopen(path, "w");
	if (!file)
		return;
	fprintf(file, "%.2f\n", used_s());
	fclose(file);
}

int main(int argc, char **argv)
{
	sigset_t signals;
	int status = 0;
	if (argc < 5 || !(atof(argv[1]) > 0) || !(atof(argv[2]) > 0)) {
		fputs("usage: limit CPU_S WALL_S FILE PROGRAM ARGUMENT...\n", stderr);
		return 2;
	}
	sigemptyset(&signals);
	sigaddset(&signals, SIGCHLD);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	sigprocmask(SIG_BLOCK, &signals, NULL);
	prctl(PR_SET_CHILD_SUBREAPER, 1);
	pid_t child = start(argv + 4, &signals);
	if (child < 0)
		return perror(argv[4]), 127;
	enum end end = watch(child, atof(argv[1]), atof(argv[2]), &signals, &status);
	if (end == END_CPU || end == END_WALL)
		fprintf(stderr, "limit: stopped after %s s of %s time: %s\n", argv[end == END_CPU ? 1 : 2],
			end == END_CPU ? "processor" : "wall", argv[4]);
	end_all(end == END_ITSELF ? 0 : TERM_S);
	write_used(argv[3]);
	if (end != END_ITSELF)
		return 124;
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
