/* Limits of the daemon while it serves, so that an attacker who takes it over gains little:
 *
 *   srv_user_find(&user, "ecoserve", &error);                started as root, it becomes this user
 *   srv_sources_load(...); srv_endpoint_take(...);           what needs more comes first
 *   srv_sandbox_enter(&sandbox, &error);                     then no thread has been started yet
 *   srv_daemon_start(...);
 *
 * Files: it reads below the folders of its packs, and writes below that of their copies (Landlock). System
 * calls: those of a list (seccomp); none opens a socket, starts a program or makes memory executable.
 * Privileges: none, and none to be had. A reload works within this; a pack that lies elsewhere by then is
 * refused. Where a kernel has only a part of it, the rest holds. It cannot be undone. */
#ifndef SRV_SANDBOX_H
#define SRV_SANDBOX_H

#include <stdbool.h>

#include "server/log.h"
#include "server/reload.h"
#include "server/user.h"

struct srv_sandbox {
	const struct srv_sources *sources;
	const struct srv_store *store;           /* what they were loaded to */
	const struct srv_user *user;
	enum srv_log_form log_form;              /* of warnings */
	bool required;                           /* a part that this system does not have is an error */
};

/* Strings and lists of the sources must live as long as the process. Logs what this system does not have;
 * `required`: returns ECO_UNSUPPORTED instead. */
enum eco_code srv_sandbox_enter(const struct srv_sandbox *sandbox, struct eco_error *error);

/* Only the listed system calls from now on, for this thread and those that it starts; others fail with
 * EPERM. ECO_UNSUPPORTED: this system has no such filters. */
enum eco_code srv_sandbox_filter(struct eco_error *error);

#endif
