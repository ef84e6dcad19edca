/* Which lists are forms of which: element i of one is element i of the other, whichever comes first. What is
 * known of that stays when the lists have gone. */
#ifndef VIEW_FORMS_H
#define VIEW_FORMS_H

#include "client-min/view_cache.h"

#define VIEW_FORMS_MAX 8u                /* of one list: each of its chunks is compared with each */

struct view_forms {                      /* zero is empty */
	struct view_table table;         /* list that has forms -> row */
	uint32_t (*rows)[VIEW_FORMS_MAX];        /* ids of forms, then UINT32_MAX */
	uint32_t count, room;
};
void view_forms_free(struct view_forms *forms);

/* Checks a list that is about to be held against those that it is a form of, or that are forms of it. */
enum eco_code view_forms_bind(struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list,
	struct eco_error *error);
/* The same for its chunk `ordinal`, which ends at element `elements`. */
enum eco_code view_forms_check(const struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list, uint32_t ordinal, uint32_t elements, struct eco_error *error);

#endif
