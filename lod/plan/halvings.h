/* Into how many points those of summaries are scattered (lod/scattered.h): as few as make them narrow, and as
 * many as the vertices that the plan has left allow. */
#ifndef LOD_HALVINGS_H
#define LOD_HALVINGS_H

#include "lod/plan/planner_state.h"

/* Area factor of the points of a summary's entry, which has vertices. */
float lod_summary_scale(const struct lod_entry *entry);

/* The least width of a scattered point, pixels, at which all fit in the vertices left; infinite: none is
 * scattered. */
double lod_part_px(const struct lod_planner *p);
/* Halvings until points of the entry, where its tile is nearest, are no wider. 0 without vertices. */
uint8_t lod_halvings(const struct lod_planner *p, const struct lod_entry *entry, double part_px);

#endif
