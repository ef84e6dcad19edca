/* fork, limits, a memory file or a pipe for the result, a shared page for the error, and a pipe that
 * closes when the child dies. The parent waits for that pipe with a deadline, so that a child that ignores
 * its signals cannot hold it up. */
#include "ecofiles/base/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ecofiles/base/confine.h"
#include "ecofiles/base/progress.h"

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

#define GIB (1ull << 30)
#define SMALL_FACTOR 64u             /* zipped tables take 10, zipped models about 50 */
#define FILES_MAX 512u               /* a mosaic opens its parts */
#define GRACE_S 5u                   /* from the signal that can be caught to the one that cannot */
#define INTERRUPTED_S 0.1            /* in which a child that is interrupted ends */
#define CRASH_STACK (64u << 10)

/* Memory that parent and child share. The child may write anything here: the parent reads it after the
 * child's death and checks it. */
struct shared {
	struct eco_error error;
	int no_memory;               /* the child crashed after an allocation had failed */
};

struct eco_guard {
	struct shared *shared;
	struct eco_guard_limits limits;
	char what[304];
	pid_t pid;
	unsigned interruptions;      /* before it began */
	int life;                    /* reading end of a pipe that closes when the child is dead */
	int data;                    /* eco_guard_start: reading end of the pipe that the child writes to */
	FILE *stream;
	double waited_s;
	bool late, stopped, ended;   /* past the clock's limit; interrupted; at the end of the stream */
};

static _Atomic unsigned interruptions;
/* One fork at a time: another child would inherit the writing end of a pipe and keep it open as long as it
 * lives. */
static pthread_mutex_t forking = PTHREAD_MUTEX_INITIALIZER;

void eco_guard_interrupt(void) { atomic_fetch_add(&interruptions, 1); }

/* ---- Limits ---- */

struct eco_guard_limits eco_guard_limits_for(uint64_t bytes)
{
	uint64_t size = bytes < ECO_GUARD_MEMORY ? bytes : ECO_GUARD_MEMORY;
	uint64_t cpu_s = 120 + size / (64u << 10);
	return (struct eco_guard_limits){ .memory_bytes = 6 * GIB + 256 * size, .cpu_s = (uint32_t)cpu_s,
		.clock_s = (uint32_t)(2 * cpu_s) };
}

uint64_t eco_guard_small_memory(const char *const *paths, uint32_t count)
{
	uint64_t size = 0;
	struct stat status;
	for (uint32_t i = 0; i < count && size < ECO_GUARD_MEMORY; i++)
		if (stat(paths[i], &status) == 0 && status.st_size > 0)
			size += (uint64_t)status.st_size;
	return size < (ECO_GUARD_MEMORY - GIB) / SMALL_FACTOR ? GIB + SMALL_FACTOR * size : ECO_GUARD_MEMORY;
}

bool eco_guard_unpacks(const char *path)
{
	char head[16] = "";
	int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	ssize_t size = file >= 0 ? read(file, head, sizeof head) : 0;
	if (file >= 0)
		close(file);
	return (size >= 4 && memcmp(head, "PK\3\4", 4) == 0)
		|| (size == sizeof head && memcmp(head, "SQLite format 3", sizeof head) == 0);
}

static double wish(const char *variable, double least, double most)
{
	const char *text = getenv(variable);
	char *end = NULL;
	double value = text ? strtod(text, &end) : 0;
	return text && end != text && *end == 0 && value > 0 ? value < least ? least : value > most ? most
		: value : 0;
}

static struct eco_guard_limits effective(const struct eco_guard_limits *asked)
{
	struct eco_guard_limits l = asked ? *asked : (struct eco_guard_limits){ 0 };
	uint64_t machine = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
	double memory_gb = wish(ECO_GUARD_MEMORY_VARIABLE, 0.1, 1e6),
		cpu_s = wish(ECO_GUARD_SECONDS_VARIABLE, 1, 1e9);
	l.memory_bytes = l.memory_bytes != 0 ? l.memory_bytes : ECO_GUARD_MEMORY;
	if (l.memory_bytes > machine && machine >= GIB)
		l.memory_bytes = machine;
	l.cpu_s = l.cpu_s != 0 ? l.cpu_s : ECO_GUARD_CPU_S;
	l.clock_s = l.clock_s != 0 ? l.clock_s : ECO_GUARD_CLOCK_S;
	if (memory_gb > 0)
		l.memory_bytes = (uint64_t)(memory_gb * 1e9);
	if (cpu_s > 0) {
		l.cpu_s = (uint32_t)cpu_s;
		l.clock_s = 2 * l.cpu_s;
	}
	return l;
}

static void limit(int resource, rlim_t most, rlim_t grace)
{
	struct rlimit now;
	if (getrlimit(resource, &now) != 0)
		return;
	if (now.rlim_max == RLIM_INFINITY || now.rlim_max > most + grace)
		now.rlim_max = most + grace;
	now.rlim_cur = now.rlim_max < most ? now.rlim_max : most;
	setrlimit(resource, &now);
}

/* The child begins with the parent's address space, however large: the limit is on what it adds. */
static uint64_t address_space_bytes(void)
{
	FILE *file = fopen("/proc/self/statm", "re");
	unsigned long pages = 0;
	if (!file)
		return 0;
	if (fscanf(file, "%lu", &pages) != 1)
		pages = 0;
	fclose(file);
	return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* ---- The child ---- */

static struct shared *crash_note;

/* A library may crash after a failed allocation: by a null pointer, or by an exception that nobody caught.
 * errno still tells. */
static void crashed(int number)
{
	if (errno == ENOMEM)
		crash_note->no_memory = 1;
	signal(number, SIG_DFL);
	raise(number);
}

void eco_guard_no_memory(void)
{
	if (crash_note)
		crash_note->no_memory = 1;
}

static void watch_crashes(struct shared *shared)
{
	static const int numbers[] = { SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL };
	static uint8_t stack[CRASH_STACK];
	struct sigaction action = { .sa_handler = crashed, .sa_flags = SA_ONSTACK | SA_NODEFER };
	crash_note = shared;
	sigaltstack(&(stack_t){ .ss_sp = stack, .ss_size = sizeof stack }, NULL);
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		sigaction(numbers[i], &action, NULL);
	errno = 0;
}

static void default_signals(void)
{
	static const int numbers[] = { SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU, SIGXFSZ, SIGALRM };
	sigset_t none;
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		signal(numbers[i], SIG_DFL);
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
}

/* Moves a descriptor above those of standard input, output and error, which the parent may have closed. */
static int lift(int descriptor)
{
	return descriptor > STDERR_FILENO ? descriptor : fcntl(descriptor, F_DUPFD, STDERR_FILENO + 1);
}

/* Closes every descriptor inherited from the parent but these two: the pack being written, and files that
 * libraries keep open. */
static void close_others(int a, int b)
{
	int low = a < b ? a : b, high = a < b ? b : a;
	if (low > 3)
		close_range(3, (unsigned)low - 1, 0);
	if (high > low + 1)
		close_range((unsigned)low + 1, (unsigned)high - 1, 0);
	close_range((unsigned)high + 1, ~0u, 0);
}

/* Closes standard input, and silences what libraries print, but under sanitizers, whose reports must be
 * seen. */
static void silence(void)
{
	int null = open("/dev/null", O_RDWR | O_CLOEXEC);
	if (null < 0)
		return;
	dup2(null, STDIN_FILENO);
	dup2(null, STDOUT_FILENO);
	if (!SANITIZED)
		dup2(null, STDERR_FILENO);
	if (null > STDERR_FILENO)
		close(null);
}

/* Asks the kernel to kill this process first if the machine runs out of memory. */
static void volunteer(void)
{
	int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
	if (file < 0)
		return;
	if (write(file, "1000", 4) < 0)
		errno = 0;               /* then the kernel treats it as any other process */
	close(file);
}

/* Keeps GDAL and PROJ from fetching from a server that a file names, and from running a program that it
 * holds. Needed where the kernel or the container allows no filter (confine.h). */
static void stay_offline(void)
{
	static const char *const settings[][2] = { { ECO_GUARD_CHILD_VARIABLE, "1" },
		{ "CPL_VSIL_CURL_ALLOWED_EXTENSIONS", ".none" },
		{ "PROJ_NETWORK", "OFF" },
		{ "GDAL_VRT_ENABLE_PYTHON", "NO" }, { "GDAL_SKIP", "WMS WCS WMTS HTTP OGCAPI EEDA EEDAI "
			"PLMOSAIC PLSCENES DAAS NGW STACTA STACIT WFS "
		"OAPIF CSW Elastic Carto AmigoCloud PostgreSQL PostGISRaster MySQL MSSQLSpatial ODBC OCI "
			"MongoDBv3 HANA" } };

	for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
		setenv(settings[i][0], settings[i][1], 1);
}

/* False: the program is confined (confine.h), and the kernel or a container does not allow it for this
 * child. */
static bool restrict_self(const struct eco_guard *g, rlim_t file_bytes)
{
	volunteer();
	stay_offline();
	limit(RLIMIT_CORE, 0, 0);
	limit(RLIMIT_CPU, g->limits.cpu_s, GRACE_S);
	limit(RLIMIT_NOFILE, FILES_MAX, 0);
	if (!SANITIZED) {
		limit(RLIMIT_FSIZE, file_bytes, 0);
		limit(RLIMIT_AS, address_space_bytes() + g->limits.memory_bytes, 0);
		watch_crashes(g->shared);
	}
	return eco_confine_child() && (eco_guard_filter() || !eco_is_confined());
}

static _Noreturn void child(struct eco_guard *g, eco_guard_work *work, void *ctx, int to, int life,
	pid_t parent)
{
	struct eco_error error = { .code = ECO_OK };
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(1);                    /* the parent died before prctl */
	default_signals();
	to = lift(to);
	life = lift(life);
	close_others(to, life);
	silence();
	bool may_run = restrict_self(g, !g->stream ? g->limits.memory_bytes : 0);
	FILE *out = fdopen(to, "wb");
	enum eco_code code = ECO_OK;
	if (!may_run)
		code = eco_fail(&error, ECO_UNSUPPORTED, "%s: this system allows no filter of system calls, "
			"without which a confined program reads nothing", g->what);
	else if (!out)
		code = eco_fail(&error, ECO_NO_MEMORY, "%s: out of memory", g->what);
	else
		code = work(ctx, out, &error);
	if (out && fflush(out) != 0 && !code)
		code = eco_fail(&error, ECO_IO, "%s: the result could not be handed over: %s", g->what,
			strerror(errno));
	/* libraries may lose the reason on the way */
	if (code && errno == ENOMEM)
		eco_guard_no_memory();
	error.code = code;
	g->shared->error = error;
	_exit(0);
}

/* ---- The parent ---- */

/* Waits until there is something to read or the other end is closed; ends the child when it is interrupted,
 * or at the clock's limit. */
static void await(struct eco_guard *g, int descriptor)
{
	struct pollfd poll_for = { .fd = descriptor, .events = POLLIN };
	double start = eco_clock_s(CLOCK_MONOTONIC), waited = g->waited_s;
	int ready;
	do {
		double left = g->limits.clock_s - g->waited_s;
		ready = poll(&poll_for, 1, left <= 0 ? 0 : left > INTERRUPTED_S ? (int)(1000 * INTERRUPTED_S)
			: (int)(left * 1000) + 1);
		g->waited_s = waited + eco_clock_s(CLOCK_MONOTONIC) - start;
		g->stopped = atomic_load(&interruptions) != g->interruptions;
	} while (!g->stopped && (ready < 0 ? errno == EINTR : ready == 0 && g->waited_s < g->limits.clock_s));
	g->late = g->late || (!g->stopped && ready == 0);
	if (g->late || g->stopped)
		kill(g->pid, SIGKILL);
}

static enum eco_code no_memory(const struct eco_guard *g, struct eco_error *error)
{
	return eco_fail(error, ECO_TOO_LARGE, "%s: reading it takes more than the %.3g GB of memory it may "
		"have; if the file is to be trusted, "
		"%s=%.0f allows more", g->what, (double)g->limits.memory_bytes / 1e9,
		ECO_GUARD_MEMORY_VARIABLE, 2 * (double)g->limits.memory_bytes / 1e9 + 1);
}

static enum eco_code no_time(const struct eco_guard *g, struct eco_error *error)
{
	return eco_fail(error, ECO_TOO_LARGE, "%s: not read within %u s%s; if the file is to be trusted, "
		"%s=%u allows more", g->what, g->late ? g->limits.clock_s : g->limits.cpu_s,
		g->late ? "" : " of processor time", ECO_GUARD_SECONDS_VARIABLE, 4 * g->limits.cpu_s);
}

static enum eco_code returned(const struct eco_guard *g, struct eco_error *error)
{
	const struct eco_error *said = &g->shared->error;
	if ((unsigned)said->code >= ECO_CODE_COUNT)
		return eco_fail(error, ECO_DAMAGED, "%s: the import came to no end", g->what);
	if (said->code == ECO_NO_MEMORY || (said->code != ECO_OK && (g->shared->no_memory
			|| strstr(said->text, "bad_alloc") || strstr(said->text, ": out of memory"))))
		return no_memory(g, error);
	return said->code == ECO_OK ? ECO_OK : eco_fail(error, said->code, "%s", said->text);
}

static enum eco_code killed(const struct eco_guard *g, int number, double cpu_s, struct eco_error *error)
{
	struct rlimit files;
	if (number == SIGINT || number == SIGTERM || number == SIGHUP || number == SIGQUIT)
		return eco_fail(error, ECO_INTERRUPTED, "%s: interrupted", g->what);
	if (number == SIGXCPU || (number == SIGKILL && cpu_s >= g->limits.cpu_s))
		return no_time(g, error);
	if (number == SIGXFSZ && getrlimit(RLIMIT_FSIZE, &files) == 0
			&& files.rlim_cur < g->limits.memory_bytes)
		return eco_fail(error, ECO_IO, "%s: its content takes more than the %llu bytes that a file "
			"may have here (ulimit -f): allow more", g->what, (unsigned long long)files.rlim_cur);
	if (number == SIGXFSZ)
		return eco_fail(error, ECO_TOO_LARGE, "%s: it unpacks to more than %.3g GB; if the file is "
			"to be trusted, %s=%.0f allows more", g->what, (double)g->limits.memory_bytes / 1e9,
			ECO_GUARD_MEMORY_VARIABLE, 2 * (double)g->limits.memory_bytes / 1e9 + 1);
	if (number == SIGKILL)
		return eco_fail(error, ECO_IO, "%s: the process that read it was killed from outside, "
			"perhaps because the machine ran out of memory", g->what);
	if (g->shared->no_memory)
		return no_memory(g, error);
	return eco_fail(error, ECO_DAMAGED, "%s: reading it ended with signal %d (%s): it is damaged, or "
		"meets a bug in the library that reads it; save it again with another program, or in another "
		"format", g->what, number, strsignal(number));
}

static enum eco_code verdict(struct eco_guard *g, int status, const struct rusage *used,
	struct eco_error *error)
{
	double cpu_s = (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec)
		+ 1e-6 * (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec);
	g->shared->error.text[sizeof g->shared->error.text - 1] = 0;
	if (g->late)
		return no_time(g, error);
	if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
		return returned(g, error);
	if (WIFSIGNALED(status))
		return killed(g, WTERMSIG(status), cpu_s, error);
	if (g->shared->no_memory || WEXITSTATUS(status) == ECO_GUARD_NO_MEMORY_STATUS)
		return no_memory(g, error);
	return eco_fail(error, ECO_DAMAGED, "%s: reading it ended with exit status %d: it is damaged, or meets "
		"a bug in the library that reads it; save it again with another program, or in another "
		"format",
		g->what, WEXITSTATUS(status));
}

/* Waits for the child's end and gives the verdict. */
static enum eco_code reap(struct eco_guard *g, struct eco_error *error)
{
	struct rusage used = { 0 };
	int status = 0;
	await(g, g->life);
	kill(g->pid, SIGKILL);           /* does nothing to a child that is ending by itself */
	while (wait4(g->pid, &status, 0, &used) < 0)
		if (errno != EINTR)
			return eco_fail(error, ECO_IO, "%s: %s", g->what, strerror(errno));
	if (g->stopped && WIFSIGNALED(status))
		return eco_fail(error, ECO_INTERRUPTED, "%s: interrupted", g->what);
	return verdict(g, status, &used, error);
}

static void shut(int *descriptor)
{
	if (*descriptor >= 0)
		close(*descriptor);
	*descriptor = -1;
}

static void free_guard(struct eco_guard *g)
{
	if (!g)
		return;
	shut(&g->life);
	shut(&g->data);
	if (g->shared != MAP_FAILED)
		munmap(g->shared, sizeof *g->shared);
	free(g);
}

static struct eco_guard *new_guard(const char *what, const struct eco_guard_limits *limits,
	struct eco_error *error)
{
	struct eco_guard *g = malloc(sizeof *g);
	if (g) {
		*g = (struct eco_guard){ .limits = effective(limits), .life = -1, .data = -1,
			.shared = mmap(NULL, sizeof *g->shared, PROT_READ | PROT_WRITE,
			MAP_SHARED | MAP_ANONYMOUS, -1, 0) };
		snprintf(g->what, sizeof g->what, "%.300s", what);
	}
	if (!g || g->shared == MAP_FAILED) {
		eco_fail(error, ECO_NO_MEMORY, "%.300s: no memory to read it into", what);
		free_guard(g);
		return NULL;
	}
	g->shared->error.code = ECO_CODE_COUNT;      /* until the child says otherwise */
	return g;
}

/* Forks, with all pipes open; the child writes to the descriptor `to`. */
static enum eco_code launch(struct eco_guard *g, eco_guard_work *work, void *ctx, int to,
	struct eco_error *error)
{
	int life[2] = { -1, -1 };
	pid_t parent = getpid();
	if (pipe2(life, O_CLOEXEC) != 0)
		return eco_fail(error, ECO_IO, "%s: no pipe to read it through: %s", g->what,
			strerror(errno));
	fflush(NULL);
	g->interruptions = atomic_load(&interruptions);
	g->life = life[0];
	g->pid = fork();
	if (g->pid == 0)
		child(g, work, ctx, to, life[1], parent);
	close(life[1]);
	if (g->pid < 0)
		return eco_fail(error, ECO_IO, "%s: no process to read it: %s", g->what, strerror(errno));
	return ECO_OK;
}

enum eco_code eco_guard_run(eco_guard_work *work, void *ctx, const char *what,
	const struct eco_guard_limits *limits, FILE **result, struct eco_error *error)
{
	struct eco_guard *g = new_guard(what, limits, error);
	int memory = g ? memfd_create("eco-guard", MFD_CLOEXEC) : -1;
	FILE *out = memory >= 0 ? fdopen(memory, "w+b") : NULL;
	enum eco_code code;
	*result = NULL;
	if (!g)
		return ECO_NO_MEMORY;
	if (!out)
		code = eco_fail(error, ECO_IO, "%s: no memory to read it into: %s", g->what, strerror(errno));
	else {
		pthread_mutex_lock(&forking);
		code = launch(g, work, ctx, memory, error);
		pthread_mutex_unlock(&forking);
		code = code ? code : reap(g, error);
	}
	if (code == ECO_OK && fseek(out, 0, SEEK_SET) == 0)
		*result = out;
	else if (out)
		fclose(out);
	else
		shut(&memory);
	free_guard(g);
	return code;
}

/* ---- A stream ---- */

static ssize_t read_pipe(void *cookie, char *to, size_t size)
{
	struct eco_guard *g = cookie;
	ssize_t got;
	do {
		await(g, g->data);
		got = g->late || g->stopped ? 0 : read(g->data, to, size);
	} while (got < 0 && errno == EINTR);
	g->ended = g->ended || got <= 0;
	return got;
}

enum eco_code eco_guard_start(struct eco_guard **guard, eco_guard_work *work, void *ctx, const char *what,
	const struct eco_guard_limits *limits, FILE **stream, struct eco_error *error)
{
	struct eco_guard *g = new_guard(what, limits, error);
	int data[2] = { -1, -1 };
	enum eco_code code;
	*guard = NULL;
	*stream = NULL;
	if (!g)
		return ECO_NO_MEMORY;
	g->stream = fopencookie(g, "rb", (cookie_io_functions_t){ .read = read_pipe });
	pthread_mutex_lock(&forking);
	if (!g->stream || setvbuf(g->stream, NULL, _IOFBF, 1u << 16) != 0 || pipe2(data, O_CLOEXEC) != 0)
		code = eco_fail(error, ECO_IO, "%s: no pipe to read it through: %s", g->what,
			strerror(errno));
	else {
		g->data = data[0];
		code = launch(g, work, ctx, data[1], error);
		shut(&data[1]);
	}
	pthread_mutex_unlock(&forking);
	if (!code) {
		*stream = g->stream;
		*guard = g;
		return ECO_OK;
	}
	if (g->stream)
		fclose(g->stream);
	free_guard(g);
	return code;
}

enum eco_code eco_guard_finish(struct eco_guard *g, struct eco_error *error)
{
	struct eco_error ignored = { .code = ECO_OK };
	bool ended;
	if (!g)
		return ECO_OK;
	ended = g->ended;
	fclose(g->stream);
	shut(&g->data);
	if (!ended)
		kill(g->pid, SIGKILL);
	enum eco_code code = reap(g, ended ? error : &ignored);
	free_guard(g);
	return ended || code == ECO_INTERRUPTED ? code : ECO_OK;
}
