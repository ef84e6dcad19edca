/* Faults of the system, put before a program by LD_PRELOAD:
 *
 *   FAULT_ALLOC=N        the N-th allocation of memory fails; "N-": and all after it
 *   FAULT_OWN=1          only those count that the program itself asks for, not those of its libraries
 *   FAULT_SPARE=NAME     those of the library with NAME in its own do not count: libseccomp 2.5.4 crashes
 *                        or loops without memory, as only the start of a process may meet
 *   FAULT_COUNT=FD       at the end the number of allocations is written there, as a line
 *   FAULT_SHORT=1        write takes 7 bytes at most, where it goes to a file
 *   FAULT_CLOCK=S        clocks: every other time that the time of day is asked for it is S seconds later;
 *                        the monotonic clock goes S seconds ahead once, after 200 calls
 *
 * The C library's own calls of each other (fwrite's of write) do not pass here: strace does those. */
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#define CLOCK_CALLS 200
#define SHORT_BYTES 7

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static _Atomic(uint64_t) allocations;
static uint64_t failing;         /* 0: none */
static bool from_there_on, only_own, is_short;
static int count_to = -1;
static long jump_s;
static uintptr_t own_first, own_end, spared_first, spared_end;

/* The program is the first of all. */
static int find_code(struct dl_phdr_info *info, size_t size, void *spared)
{
	(void)size;
	for (int i = 0; i < info->dlpi_phnum; i++) {
		const ElfW(Phdr) *part = &info->dlpi_phdr[i];
		if (part->p_type != PT_LOAD || !(part->p_flags & PF_X))
			continue;
		uintptr_t first = info->dlpi_addr + part->p_vaddr, end = first + part->p_memsz;
		if (!own_end) {
			own_first = first;
			own_end = end;
		}
		if (spared && strstr(info->dlpi_name, spared)) {
			spared_first = first;
			spared_end = end;
		}
	}
	return 0;
}

static long number_of(const char *name)
{
	const char *text = getenv(name);
	return text ? atol(text) : 0;
}

__attribute__((constructor)) static void read_faults(void)
{
	const char *alloc = getenv("FAULT_ALLOC");
	dl_iterate_phdr(find_code, getenv("FAULT_SPARE"));
	from_there_on = alloc && strchr(alloc, '-');
	only_own = number_of("FAULT_OWN");
	is_short = number_of("FAULT_SHORT");
	count_to = getenv("FAULT_COUNT") ? (int)number_of("FAULT_COUNT") : -1;
	jump_s = number_of("FAULT_CLOCK");
	failing = (uint64_t)number_of("FAULT_ALLOC");    /* last: from here on it counts */
	atomic_store(&allocations, 0);
}

__attribute__((destructor)) static void tell_count(void)
{
	char line[32];
	int size = snprintf(line, sizeof line, "%llu\n", (unsigned long long)atomic_load(&allocations));
	if (count_to >= 0)
		(void)!syscall(SYS_write, count_to, line, (size_t)size);
}

static bool fails(const void *caller)
{
	uintptr_t at = (uintptr_t)caller;
	if ((!failing && count_to < 0) || (only_own && (at < own_first || at >= own_end))
			|| (at >= spared_first && at < spared_end))
		return false;
	uint64_t number = atomic_fetch_add(&allocations, 1) + 1;
	if (!failing || (from_there_on ? number < failing : number != failing))
		return false;
	errno = ENOMEM;
	return true;
}

#define CALLER __builtin_return_address(0)

void *malloc(size_t size) { return fails(CALLER) ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return fails(CALLER) ? NULL : __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return fails(CALLER) ? NULL : __libc_realloc(old, size); }
void *memalign(size_t alignment, size_t size) { return fails(CALLER) ? NULL : __libc_memalign(alignment, size); }
void *aligned_alloc(size_t alignment, size_t size)
{
	return fails(CALLER) ? NULL : __libc_memalign(alignment, size);
}
int posix_memalign(void **out, size_t alignment, size_t size)
{
	void *got = fails(CALLER) ? NULL : __libc_memalign(alignment, size);
	if (got)
		*out = got;
	return got ? 0 : ENOMEM;
}

ssize_t write(int file, const void *bytes, size_t size)
{
	struct stat about;
	if (is_short && size > SHORT_BYTES && fstat(file, &about) == 0 && S_ISREG(about.st_mode))
		size = SHORT_BYTES;
	return syscall(SYS_write, file, bytes, size);
}

int clock_gettime(clockid_t which, struct timespec *now)
{
	static atomic_uint calls;
	int failed = (int)syscall(SYS_clock_gettime, which, now);
	unsigned call = jump_s ? atomic_fetch_add(&calls, 1) : 0;
	if (jump_s && (which == CLOCK_REALTIME ? call % 2 : which == CLOCK_MONOTONIC && call >= CLOCK_CALLS))
		now->tv_sec += jump_s;
	return failed;
}
