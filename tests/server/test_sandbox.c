/* The sandbox of ecoserve: seen from inside, in children that enter its sandbox, and from
 * outside, of the program. That it serves within is what all other tests of the program show. */
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <linux/io_uring.h>
#include <pthread.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/sandbox.h"
#include "tests/support/serve/http_client.h"
#include "tests/support/scene_packs.h"
#include "tests/support/serve/serve_program.h"
#include "tests/support/unit_test.h"

#define ROOM "build/tmp/sandbox"
#define PACKS ROOM "/packs"
#define OTHERS ROOM "/others"
#define COPIES ROOM "/copies"
#define PACK PACKS "/here.eco"

static char room[PATH_MAX];      /* for copies */

static int prepare(void **state)
{
	struct eco_error error = { 0 };
	program_find();
	program_sandboxed();
	if (system("mkdir -p " PACKS " " OTHERS " " COPIES) != 0)
		return 1;
	unlink(PACKS "/link.eco");
	if (!realpath(COPIES, room) || sample_pack_write(PACK, &error)
			|| sample_pack_write(OTHERS "/there.eco", &error)) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	return 0;
}

/* ---- From inside ---- */

static int enter(void)
{
	static char *const arguments[] = { PACK };
	static const struct srv_sources sources = { arguments, 1, COPIES, NULL };
	struct srv_user user;
	struct srv_store store;
	struct srv_reload report;
	struct eco_error error = { 0 };
	enum eco_code code = srv_sources_load(&sources, NULL, &store, &report, &error);
	code = code ? code : srv_user_find(&user, NULL, &error);
	code = code ? code : srv_sandbox_enter(&(struct srv_sandbox){ .sources = &sources, .store = &store,
		.user = &user, .required = true }, &error);
	if (code)
		fprintf(stderr, "%s\n", error.text);
	return (int)code;
}

/* Runs `tell` in a child inside the sandbox; returns the number of faults, which the child has printed. */
static int inside(int (*tell)(void))
{
	int status;
	fflush(NULL);
	pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		int code = enter();
		_exit(code == ECO_UNSUPPORTED ? 77 : code ? 100 : tell());
	}
	assert_true(waitpid(pid, &status, 0) == pid);
	if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
		skip();                  /* a kernel without Landlock, a container without filters */
	return WIFEXITED(status) ? WEXITSTATUS(status) : 101;
}

static long opens(const char *path, int how) { return open(path, how, 0600); }

#define TRY(call) try(#call, (call))
static int wrong;
static void try(const char *what, long result)
{
	bool refused = result < 0 && (errno == EPERM || errno == EACCES || errno == ENOSYS);
	if (!refused)
		fprintf(stderr, "%s: %ld, %s\n", what, result, result < 0 ? strerror(errno) : "allowed");
	wrong += !refused;
}

static int try_files(void)
{
	TRY(opens("/etc/passwd", O_RDONLY));
	TRY(opens("/proc/self/mem", O_RDWR));
	TRY(opens("/", O_RDONLY));
	TRY(opens("Makefile", O_RDONLY));
	TRY(opens(OTHERS "/there.eco", O_RDONLY));
	TRY(opens(PACKS "/../others/there.eco", O_RDONLY));
	TRY(opens(PACK, O_RDWR));
	TRY(opens(PACK, O_WRONLY | O_TRUNC));
	TRY(opens(PACKS "/new", O_WRONLY | O_CREAT));
	TRY(opens(PACKS, O_TMPFILE | O_RDWR));
	TRY(unlink(PACK));
	TRY(truncate(PACK, 0));
	TRY(chmod(PACK, 0777));
	TRY(mkdir(COPIES "/a", 0700));
	TRY(symlink("/etc", COPIES "/a"));
	TRY(link(PACK, COPIES "/a"));
	TRY(rename(PACK, COPIES "/a"));
	TRY(mount("none", COPIES, "tmpfs", 0, NULL));
	TRY(chroot(COPIES));
	return wrong;
}

static int try_calls(void)
{
	static char *const nothing[] = { NULL };
	struct io_uring_params ring = { 0 };
	char c = 'x';
	void *page = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	TRY(socket(AF_INET, SOCK_STREAM, 0));
	TRY(socket(AF_UNIX, SOCK_STREAM, 0));
	TRY(socket(AF_NETLINK, SOCK_RAW, 0));
	TRY(socketpair(AF_UNIX, SOCK_STREAM, 0, (int[2]){ 0 }));
	TRY(execve("/bin/true", nothing, nothing));
	TRY(fork());
	TRY(syscall(SYS_clone3, NULL, 0));
	TRY(syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, NULL, NULL, NULL, NULL));
	TRY(unshare(CLONE_NEWUSER));
	TRY(ptrace(PTRACE_TRACEME, 0, NULL, NULL));
	TRY(kill(getppid(), 0));
	TRY(kill(getpid(), 0));
	TRY(syscall(SYS_tgkill, getppid(), getppid(), 0));
	TRY(setuid(0));
	TRY(syscall(SYS_capset, NULL, NULL));
	TRY(prctl(PR_SET_DUMPABLE, 1));
	TRY(prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_RAISE, 1, 0, 0));
	TRY(ioctl(0, TIOCSTI, &c));
	TRY(mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED ? -1 : 0);
	TRY(mprotect(page, 4096, PROT_READ | PROT_EXEC));
	TRY(memfd_create("a", 0));
	TRY(syscall(SYS_io_uring_setup, 4, &ring));
	TRY(syscall(SYS_bpf, 0, NULL, 0));
	TRY(syscall(SYS_process_vm_readv, getppid(), NULL, 0, NULL, 0, 0));
	TRY(syscall(SYS_userfaultfd, 0));
	TRY(syscall(SYS_keyctl, 0, 0, 0, 0, 0));
	return wrong;
}

static void *set_true(void *flag)
{
	*(bool *)flag = true;
	return NULL;
}

/* As a reload and a daemon do; what listens was opened before. */
static int listener;

static int do_what_it_does(void)
{
	static char *const arguments[] = { PACKS };
	const struct srv_sources sources = { arguments, 1, COPIES, NULL };
	struct srv_store store;
	struct srv_reload report;
	struct eco_error error = { 0 };
	pthread_t thread;
	bool ran = false;
	char byte = 0;
	int at, taken;
	if (srv_sources_load(&sources, NULL, &store, &report, &error))
		return fprintf(stderr, "%s\n", error.text), 1;
	srv_store_free(&store);
	if (pthread_create(&thread, NULL, set_true, &ran) || pthread_join(thread, NULL) || !ran)
		return 2;
	at = eventfd(0, EFD_CLOEXEC);
	taken = accept4(listener, NULL, NULL, SOCK_CLOEXEC);
	if (at < 0 || taken < 0 || recv(taken, &byte, 1, 0) != 1 || send(taken, &byte, 1, MSG_NOSIGNAL) != 1)
		return 3;
	return write(STDERR_FILENO, "", 0) ? 4 : 0;
}

UNIT_TEST(files_elsewhere_and_writing_are_refused)
{
	assert_int_equal(inside(try_files), 0);
}

UNIT_TEST(calls_that_it_does_not_need_are_refused)
{
	assert_int_equal(inside(try_calls), 0);
}

UNIT_TEST(what_it_serves_with_is_allowed)
{
	uint16_t port;
	char byte = 'a';
	listener = http_listen(&port);
	int fd = http_connect(port);
	assert_int_equal(send(fd, &byte, 1, 0), 1);
	assert_int_equal(inside(do_what_it_does), 0);
	assert_int_equal(recv(fd, &byte, 1, 0), 1);
	close(fd);
	close(listener);
}

/* ---- From outside ---- */

#define START "--listen", "127.0.0.1:0", "--copies", room
#define ARGUMENTS(...) (const char *const[]){ __VA_ARGS__, NULL }

static bool has_landlock(void)
{
	return syscall(SYS_landlock_create_ruleset, NULL, 0, 1) > 0;
}

/* By a link, as deployments do: the scene stays, the others are reloaded, and who asks is told. */
UNIT_TEST(a_reload_that_names_a_pack_elsewhere_is_refused)
{
	static const char path[] = PACKS "/link.eco: cannot open: Permission denied: ",
		advice[] = OTHERS "/there.eco is outside the folders";
	if (!has_landlock())
		skip();
	unlink(PACKS "/link.eco");
	assert_int_equal(symlink("here.eco", PACKS "/link.eco"), 0);
	struct program program = program_serve(ARGUMENTS(START, "there=" PACKS "/link.eco", PACK), NULL);
	unlink(PACKS "/link.eco");
	assert_int_equal(symlink("../others/there.eco", PACKS "/link.eco"), 0);
	http_expect(program.port, "POST", "/v1/admin/reload", "", 500, path);
	http_expect(program.port, "POST", "/v1/admin/reload", "", 500, advice);
	http_expect(program.port, "GET", "/v1/scenes/there", "", 200, NULL);
	unlink(PACKS "/link.eco");
	assert_int_equal(symlink("here.eco", PACKS "/link.eco"), 0);
	http_expect(program.port, "POST", "/v1/admin/reload", "", 200, NULL);
	program_stop(&program);
	unlink(PACKS "/link.eco");
}

/* As of a kernel before 5.13, or one in which it is switched off. */
static void without_landlock(void)
{
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
	seccomp_rule_add(filter, SCMP_ACT_ERRNO(EOPNOTSUPP), SYS_landlock_create_ruleset, 0);
	if (seccomp_load(filter))
		_exit(127);
}

UNIT_TEST(a_kernel_without_landlock_is_told_of)
{
	if (!has_landlock())
		skip();
	struct program program = program_serve(ARGUMENTS(START, PACK), without_landlock);
	http_expect(program.port, "GET", "/v1/scenes/sample", "", 200, NULL);
	program_stop(&program);
	assert_non_null(strstr(program.err, "ecoserve: warning: this system cannot confine a program to folders"));
	program = program_start(ARGUMENTS(START, "--require-sandbox", PACK), without_landlock);
	assert_int_equal(program_finish(&program), 1);
	assert_non_null(strstr(program.err, "(--require-sandbox)"));
	program = program_serve(ARGUMENTS(START, "--require-sandbox", PACK), NULL);
	program_stop(&program);
	assert_string_equal(program.err, "");
}

/* The value of a line of /proc/PID/status. */
static unsigned long status_of(pid_t pid, const char *name, int base)
{
	char path[64], line[256];
	unsigned long value = ULONG_MAX;
	snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
	FILE *file = fopen(path, "r");
	while (file && fgets(line, sizeof line, file))
		if (strncmp(line, name, strlen(name)) == 0)
			value = strtoul(line + strlen(name), NULL, base);
	if (file)
		fclose(file);
	return value;
}

/* It gives up what it does not need, and none of what it has may be had again. */
UNIT_TEST(root_becomes_another_user)
{
	if (geteuid() != 0 || !has_landlock())
		skip();
	for (int i = 0; i < 3; i++) {
		struct program program = program_serve(i == 1 ? ARGUMENTS(START, "--user", "root", PACK)
			: i == 2 ? ARGUMENTS(START, "--no-sandbox", PACK) : ARGUMENTS(START, PACK), NULL);
		assert_int_equal(status_of(program.pid, "Uid:", 10) == 0, i > 0);
		assert_int_equal(status_of(program.pid, "NoNewPrivs:", 10), i < 2);
		assert_int_equal(status_of(program.pid, "Seccomp:", 10), i < 2 ? 2 : 0);
		/* CAP_DAC_OVERRIDE, which copies in a folder of root's need */
		if (i == 0)
			assert_int_equal(status_of(program.pid, "CapPrm:", 16), 2);
		program_stop(&program);
		assert_string_equal(program.err, "");
	}
}

UNIT_TEST(users_that_it_cannot_become_are_refused)
{
	program_fails(ARGUMENTS(START, "--user", "no-such-user", PACK), 2, "there is no user 'no-such-user'");
	program_fails(ARGUMENTS(START, "--user", "root", "--no-sandbox", PACK), 2,
		"--no-sandbox and --user exclude each other");
	program_fails(ARGUMENTS(START, "--require-sandbox", "--no-sandbox", PACK), 2,
		"--no-sandbox and --require-sandbox exclude each other");
}

/* ---- A socket of systemd ---- */

static int handed_over, handed_count;

static void hand_over(void)
{
	char number[16];
	for (int i = 0; i < handed_count; i++)
		if (dup2(handed_over, 3 + i) < 0)
			_exit(127);
	fcntl(3, F_SETFD, 0);
	snprintf(number, sizeof number, "%d", (int)getpid());
	setenv("LISTEN_PID", number, 1);
	snprintf(number, sizeof number, "%d", handed_count);
	setenv("LISTEN_FDS", number, 1);
}

static void hand_over_to_another(void)
{
	hand_over();
	setenv("LISTEN_PID", "1", 1);
}

/* A socket or two are handed over: `says` so. */
static void refuse_handed(const char *const *arguments, const char *says)
{
	struct program program = program_start(arguments, hand_over);
	assert_int_equal(program_finish(&program), 2);
	assert_non_null(strstr(program.err, says));
}

UNIT_TEST(a_socket_that_is_handed_over_is_served)
{
	struct sockaddr_in at = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	socklen_t size = sizeof at;
	handed_over = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	handed_count = 1;
	assert_int_equal(bind(handed_over, (struct sockaddr *)&at, sizeof at), 0);
	refuse_handed(ARGUMENTS("--copies", room, PACK), "no TCP socket that listens");
	assert_int_equal(listen(handed_over, 16), 0);
	assert_int_equal(getsockname(handed_over, (struct sockaddr *)&at, &size), 0);
	int waiting = http_connect(ntohs(at.sin_port));          /* before there is a server */
	assert_true(http_send(waiting, "GET /healthz HTTP/1.1\r\nHost: t\r\n\r\n", 35));
	struct program program = program_serve(ARGUMENTS("--copies", room, PACK), hand_over);
	assert_int_equal(program.port, ntohs(at.sin_port));
	struct http_answer answer = http_receive(waiting, false, false);
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	close(waiting);
	program_stop(&program);
	refuse_handed(ARGUMENTS(START, PACK), "systemd has handed a socket over, too");
	program = program_serve(ARGUMENTS(START, PACK), hand_over_to_another);          /* nothing is handed over to it */
	assert_int_not_equal(program.port, ntohs(at.sin_port));
	program_stop(&program);
	handed_count = 2;
	refuse_handed(ARGUMENTS("--copies", room, PACK), "more than one socket");
	close(handed_over);
}

/* ---- The systemd unit: calls, address families and the user as systemd 252 sets them, read from the unit ---- */

#define UNIT "server/ecoserve.service.in"
#define SOMEBODY 65534u
#define CANNOT 126
#define CALLS_MAX 1024

static struct { bool allowed[CALLS_MAX]; bool inet, inet6, others; } unit;

/* A name of a call, or of a set of them; false: systemd knows no such set. */
static bool set_calls(const char *name, bool to)
{
	char line[256], word[64], command[128];
	unsigned count = 0;
	if (*name != '@') {
		int number = seccomp_syscall_resolve_name(name);
		if (number >= 0 && number < CALLS_MAX)
			unit.allowed[number] = to;
		return true;
	}
	snprintf(command, sizeof command, "systemd-analyze syscall-filter '%.40s' 2>/dev/null", name);
	FILE *lines = popen(command, "r");
	bool known = lines;
	while (known && fgets(line, sizeof line, lines))
		if (sscanf(line, "%63s", word) == 1 && word[0] != '#' && strcmp(word, name) != 0) {
			count++;
			known = set_calls(word, to);
		}
	return lines && pclose(lines) == 0 && known && count;
}

/* The words of each line "KEY=..."; a '~' before the first takes away. */
static bool read_words(const char *key, bool (*take)(const char *word, bool to))
{
	char line[1024];
	bool good = true, found = false;
	FILE *file = fopen(UNIT, "r");
	while (file && fgets(line, sizeof line, file)) {
		if (strncmp(line, key, strlen(key)) != 0)
			continue;
		char *words = line + strlen(key);
		bool to = *words != '~';
		found = true;
		for (char *word = strtok(words + !to, " \n"); word; word = strtok(NULL, " \n"))
			good = good && take(word, to);
	}
	if (file)
		fclose(file);
	return good && found;
}

static bool set_family(const char *name, bool to)
{
	*(strcmp(name, "AF_INET") == 0 ? &unit.inet : strcmp(name, "AF_INET6") == 0 ? &unit.inet6
		: &unit.others) = to;
	return true;
}

/* Call that systemd allows whatever the unit says: to start the program. */
static void allow(scmp_filter_ctx filter)
{
	for (int number = 0; number < CALLS_MAX; number++)
		if (unit.allowed[number])
			seccomp_rule_add(filter, SCMP_ACT_ALLOW, number, 0);
	seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(execve), 0);
}

/* RestrictAddressFamilies= and MemoryDenyWriteExecute= are filters of their own. */
static int refuse_what_it_denies(void)
{
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
	int failed = 0;
	for (unsigned family = 0; family < AF_MAX; family++)
		if (!(family == AF_INET && unit.inet) && !(family == AF_INET6 && unit.inet6))
			failed |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(EAFNOSUPPORT), SCMP_SYS(socket), 1,
				SCMP_A0(SCMP_CMP_EQ, family));
	failed |= seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(mmap), 1,
		SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_WRITE | PROT_EXEC, PROT_WRITE | PROT_EXEC))
		| seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(mprotect), 1,
		SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, PROT_EXEC));
	return failed | seccomp_load(filter);
}

static void as_the_unit_says(void)
{
	const gid_t none = 0;
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
	if (geteuid() == 0 && (setgroups(0, &none) || setgid(SOMEBODY) || setuid(SOMEBODY)))
		_exit(CANNOT);
	allow(filter);
	if (refuse_what_it_denies() || seccomp_load(filter))
		_exit(CANNOT);
}

static bool others_may_run_it(void)
{
	bool may = false;
	if (geteuid() != 0)
		return true;
	if (seteuid(SOMEBODY) == 0)
		may = eaccess(program_path, X_OK) == 0;
	return seteuid(0) == 0 && may;
}

UNIT_TEST(it_serves_under_the_filter_of_its_unit)
{
	char folder[] = "/tmp/ecoserve-unit-XXXXXX", pack[64];
	const char *const arguments[] = { "--listen", "127.0.0.1:0", "--copies", "/var/tmp",
		"--require-sandbox", "--log", "json", pack, NULL };
	if (access("/usr/bin/systemd-analyze", X_OK) || !others_may_run_it())
		skip();
	assert_true(mkdtemp(folder) && chmod(folder, 0755) == 0);
	snprintf(pack, sizeof pack, "%s/here.eco", folder);
	assert_good(sample_pack_write(pack, &cause));
	assert_int_equal(chmod(pack, 0644), 0);
	assert_true(read_words("SystemCallFilter=", set_calls));
	assert_true(read_words("RestrictAddressFamilies=", set_family));
	assert_false(unit.allowed[SCMP_SYS(mount)] || unit.allowed[SCMP_SYS(ptrace)] || unit.others);
	assert_true(unit.allowed[SCMP_SYS(accept4)] && unit.inet && unit.inet6);
	struct program program = program_start(arguments, as_the_unit_says);
	if (!program_ready(&program)) {
		int status = program_finish(&program);
		if (status == CANNOT || strstr(program.err, "--require-sandbox"))
			skip();          /* a container without filters, a kernel without Landlock */
		fail_msg("%s", program.err);
	}
	http_expect(program.port, "GET", "/healthz", "", 200, NULL);
	http_expect(program.port, "GET", "/v1/scenes/sample/stream?eye=50,-30,12&target=50,30,2&width=400&height=300"
		"&vertices=3000", "", 200, NULL);
	kill(program.pid, SIGHUP);
	assert_int_equal(sample_pack_write(pack, NULL), 0);      /* another file, which is copied */
	assert_int_equal(chmod(pack, 0644), 0);
	http_expect(program.port, "POST", "/v1/admin/reload", "", 200, NULL);
	http_expect(program.port, "GET", "/metrics", "", 200, NULL);
	program_stop(&program);
	assert_non_null(strstr(program.err, "\"event\":\"request\""));
	assert_null(strstr(program.err, "problem"));
	unlink(pack);
	rmdir(folder);
}

UNIT_MAIN(prepare, NULL)
