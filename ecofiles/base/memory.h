/* Memory, or the end of the program; work that stops at the first failure. For programs that run once, and for their
 * rooms: the daemon, the library and what reads a server's answers return errors instead (array_grow.h). */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/status.h"

/* Ends the program with status 1 and this error, from any thread, after what eco_at_end names. In a guarded
 * child (guard.h) it ends the child alone, and the parent reports that memory ran out. */
_Noreturn void eco_end(const char *why);
/* Removes unfinished outputs: called by eco_end with `ctx`. One at a time; NULL: nothing is to be removed. */
void eco_at_end(void (*undo)(void *ctx), void *ctx);

/* Calls steps(ctx) up to the first eco_stop, or eco_check that is not of ECO_OK, in this thread; returns its
 * code. Memory that functions hold then is lost, as the program ends soon. Calls may nest; each stops the
 * innermost. */
enum eco_code eco_try(void (*steps)(void *ctx), void *ctx, struct eco_error *error);
/* As eco_fail, with the error of eco_try. */
_Noreturn void eco_stop(enum eco_code code, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Stops where the code is not ECO_OK; the error of eco_try says why. */
void eco_check(enum eco_code code);

/* None of these returns NULL; the caller frees. eco_alloc zeroes; `count` may be 0. */
void *eco_alloc(size_t count, size_t size);
void *eco_realloc(void *items, size_t count, size_t size);
char *eco_copy_text(const char *text);
char *eco_copy_part(const char *text, size_t bytes_max);     /* as strndup */
/* Room for one more item of `size` bytes behind `count`. array: the address of the pointer to the items. */
void eco_grow(void *array, uint32_t *capacity, uint32_t count, size_t size);

/* The number of a text in a pool, which has it from then on. */
uint32_t eco_string_number(struct eco_string_pool *texts, const char *text);
