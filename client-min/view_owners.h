/* Table of a selection's instances by owner, the number that a picture's pixels hold. Open addressing. */
#ifndef VIEW_OWNERS_H
#define VIEW_OWNERS_H

#include "client-min/view_select.h"

struct view_owners {                     /* owns `slots`; the selection must outlive it */
	const struct view_selection *selection;
	uint32_t *slots, mask;           /* numbers of instances + 1; 0: empty */
};
enum eco_code view_owners_make(struct view_owners *owners, const struct view_selection *selection,
	struct eco_error *error);
/* NULL: no instance has it, as that of a summary's point. */
const struct view_instance *view_owners_find(const struct view_owners *owners, uint64_t owner);
void view_owners_free(struct view_owners *owners);

#endif
