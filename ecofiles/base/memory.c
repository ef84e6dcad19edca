#include "ecofiles/base/memory.h"

#include <errno.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/base/guard.h"

static struct { void (*undo)(void *ctx); void *ctx; } at_end;

void eco_at_end(void (*undo)(void *ctx), void *ctx)
{
	at_end.ctx = ctx;
	at_end.undo = undo;
}

_Noreturn void eco_end(const char *why)
{
	static pthread_mutex_t once = PTHREAD_MUTEX_INITIALIZER;
	/* the outputs are the parent's; by the environment, as modules have a copy of this file each */
	if (getenv(ECO_GUARD_CHILD_VARIABLE))
		_exit(ECO_GUARD_NO_MEMORY_STATUS);
	pthread_mutex_lock(&once);           /* for ever: one thread ends the program */
	if (at_end.undo)
		at_end.undo(at_end.ctx);
	dprintf(STDERR_FILENO, "%s%s: %s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "",
		program_invocation_short_name, why);
	_exit(1);
}

static _Thread_local struct trial { jmp_buf back; struct eco_error *error; volatile enum eco_code code; } *trial;

enum eco_code eco_try(void (*steps)(void *ctx), void *ctx, struct eco_error *error)
{
	static _Thread_local struct eco_error unsaid;
	struct trial own = { .error = error ? error : &unsaid }, *const outer = trial;
	unsaid.code = ECO_OK;
	trial = &own;
	if (!setjmp(own.back))
		steps(ctx);
	trial = outer;
	return own.code;
}

#ifdef __SANITIZE_ADDRESS__
/* After a stop no leaks are looked for: it loses memory on purpose. */
static void end_at_once(int status, void *ctx)
{
	(void)ctx;
	fflush(NULL);
	_exit(status);
}
#endif

void eco_stop(enum eco_code code, const char *format, ...)
{
	char text[1024];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	eco_check(eco_fail(trial->error, code, "%s", text));
	abort();
}

void eco_check(enum eco_code code)
{
	if (!code)
		return;
	trial->code = code;
#ifdef __SANITIZE_ADDRESS__
	on_exit(end_at_once, NULL);
#endif
	longjmp(trial->back, 1);
}

static void *given(void *memory)
{
	if (!memory)
		eco_end("no memory");
	return memory;
}

void *eco_alloc(size_t count, size_t size) { return given(calloc(count ? count : 1, size ? size : 1)); }

void *eco_realloc(void *items, size_t count, size_t size)
{
	return given(reallocarray(items, count ? count : 1, size));
}

char *eco_copy_text(const char *text) { return given(strdup(text)); }
char *eco_copy_part(const char *text, size_t bytes_max) { return given(strndup(text, bytes_max)); }

void eco_grow(void *array, uint32_t *capacity, uint32_t count, size_t size)
{
	if (!eco_array_grow(array, capacity, count, size))
		eco_end("no memory");
}

uint32_t eco_string_number(struct eco_string_pool *texts, const char *text)
{
	uint32_t number;
	if (!eco_string_pool_add(texts, text, &number))
		eco_end("no memory");
	return number;
}
