/* jansson leaves out what it has no memory for, and mostly says nothing: json_object_set_new of a value that
 * was not made returns an error that few look at, and json_dumps drops keys. So a program asks once, at the
 * end of what it writes.
 *
 *   eco_json_watch();                                    first of all in main
 *   ... json_object_set_new(...) ... text = json_dumps(...);
 *   if (!text || eco_json_lost()) fail: no memory
 */
#ifndef ECO_JSON_MEMORY_H
#define ECO_JSON_MEMORY_H

#include <stdbool.h>

/* Before any other thread is there. For programs, not for libraries: there is one allocator for all of a
 * process. */
void eco_json_watch(void);
/* Has jansson lacked memory in this thread? */
bool eco_json_lost(void);

#endif
