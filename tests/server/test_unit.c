/* ecoserve under what its systemd unit allows: the system calls, the address families and the user, as
 * systemd 252 would set them, taken from the unit itself. How open the unit is: tests/base/test_install.sh. */
#include <errno.h>
#include <grp.h>
#include <seccomp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/serve/http_client.h"
#include "tests/support/scene_packs.h"
#include "tests/support/serve/serve_program.h"
#include "tests/support/unit_test.h"

#define UNIT "server/ecoserve.service.in"
#define SOMEBODY 65534u
#define CANNOT 126
#define CALLS_MAX 1024

static struct { bool allowed[CALLS_MAX]; bool inet, inet6, others; } unit;
static char folder[] = "/tmp/ecoserve-unit-XXXXXX", pack[64];

static FILE *names_of(const char *set)
{
	char command[128];
	snprintf(command, sizeof command, "systemd-analyze syscall-filter '%.40s' 2>/dev/null", set);
	return popen(command, "r");
}

/* A name of a call, or of a set of them; false: systemd knows no such set. */
static bool set_calls(const char *name, bool to)
{
	char line[256], word[64];
	unsigned count = 0;
	if (*name != '@') {
		int number = seccomp_syscall_resolve_name(name);
		if (number >= 0 && number < CALLS_MAX)
			unit.allowed[number] = to;
		return true;
	}
	FILE *lines = names_of(name);
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
static int refuse(void)
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
	if (refuse() || seccomp_load(filter))
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

static int prepare(void **state)
{
	struct eco_error error = { 0 };
	program_find();
	program_sandboxed();
	if (!mkdtemp(folder) || chmod(folder, 0755))
		return 1;
	snprintf(pack, sizeof pack, "%s/here.eco", folder);
	return sample_pack_write(pack, &error) || chmod(pack, 0644);
}

static int clean(void **state)
{
	unlink(pack);
	return rmdir(folder);
}

UNIT_TEST(it_serves_under_the_filter_of_its_unit)
{
	const char *const arguments[] = { "--listen", "127.0.0.1:0", "--copies", "/var/tmp",
		"--require-sandbox", "--log", "json", pack, NULL };
	if (access("/usr/bin/systemd-analyze", X_OK) || !others_may_run_it())
		skip();
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
}

int main(void)
{
	return unit_tests_run(prepare, clean);
}
