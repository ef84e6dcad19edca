/* What the child of guard.h may ask of the kernel: to read files, to use memory and threads; not to write files, to talk to anybody or to
 * start programs. */
#ifndef ECO_GUARD_FILTER_H
#define ECO_GUARD_FILTER_H

#include <stdbool.h>

/* For the calling process, for good, and for threads it starts from now on; files that are open stay so. What is not allowed fails with
 * EPERM. False where the kernel or a container does not allow filters: then limits are all there is. */
bool eco_guard_filter(void);

#endif
