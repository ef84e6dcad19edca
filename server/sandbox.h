/* Limits of the daemon while it serves, so that an attacker who takes it over gains little:
 *
 *   srv_user_find(&user, "ecoserve", &error);                started as root, it becomes this user
 *   srv_sources_load(...); srv_endpoint_take(...);           what needs more comes first
 *   srv_sandbox_enter(&sandbox, &error);                     then no thread has been started yet
 *   srv_daemon_start(...);
 *
 * Files: it reads below the folders of its packs, and writes below that of their copies (Landlock). System
 * calls: those of a list (seccomp); none opens a socket, starts a program or makes memory executable. Rights
 * of root: at most to pass over the permissions of files, if packs or copies need that and Landlock keeps it
 * to them. A reload works within this; a pack that lies elsewhere by then is refused. A kernel that has only
 * a part of it gives that part. It cannot be undone. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

#include "server/log.h"
#include "server/store.h"

#define SRV_USER_DEFAULT "nobody"

struct srv_user {
	uid_t user; gid_t group;
	bool changes;                    /* false: it stays who it is */
	bool was_asked_for;
};
/* NULL: SRV_USER_DEFAULT for root, no change for others. ECO_BAD_USAGE: there is no such user, or only root
 * can become one. */
enum eco_code srv_user_find(struct srv_user *user, const char *name, struct eco_error *error);

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
