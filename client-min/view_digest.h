/* Two hashes that say whether two clients hold and draw the same: what was decoded, and which instances each
 * cut draws where. Not of anything that a graphics driver made. */
#ifndef VIEW_DIGEST_H
#define VIEW_DIGEST_H

#include "client-min/view_select.h"

#define VIEW_DIGEST_BYTES 34             /* elements-cuts, 16 hexadecimal digits each, and 0 */

/* Hashes all lists of the store, in any order of arrival, and the selection with its plan. */
enum eco_code view_digest_write(char out[VIEW_DIGEST_BYTES], const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error);

#endif
