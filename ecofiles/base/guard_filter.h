/* The system calls that the child of guard.h may make: it may read files, use memory and start threads; it
 * may not write files, use the network or start programs. */
#ifndef ECO_GUARD_FILTER_H
#define ECO_GUARD_FILTER_H

#include <stdbool.h>

/* Sets the filter for the calling process, for good, and for threads that it starts from now on; open
 * files stay open. A refused call fails with EPERM. False where the kernel or a container allows no
 * filters: then only the limits hold. */
bool eco_guard_filter(void);

#endif
