/* The daemon's user while it serves. Root reads and writes everything: started by root, the daemon becomes
 * another user. It keeps, of root's rights, at most that to pass over the permissions of files, where its
 * packs or the folder of their copies need that and Landlock keeps it to them. */
#ifndef SRV_USER_H
#define SRV_USER_H

#include <stdbool.h>
#include <sys/types.h>

#include "ecofiles/base/status.h"

#define SRV_USER_DEFAULT "nobody"

struct srv_user {
	uid_t user; gid_t group;
	bool changes;                    /* false: it stays who it is */
	bool was_asked_for;
};

/* NULL: SRV_USER_DEFAULT for root, no change for others. ECO_BAD_USAGE: there is no such user, or only root
 * can become one. */
enum eco_code srv_user_find(struct srv_user *user, const char *name, struct eco_error *error);
/* From now on this process is that user, and of root's rights has that over files until srv_user_settle.
 * Before any thread is started. ECO_UNSUPPORTED: it is not allowed to. */
enum eco_code srv_user_become(const struct srv_user *user, struct eco_error *error);
/* Gives that up for good, unless `may_keep` and a path of the lists, which end with NULL, cannot be read or
 * written without it. */
enum eco_code srv_user_settle(bool may_keep, const char *const *read, const char *const *write,
	struct eco_error *error);

#endif
