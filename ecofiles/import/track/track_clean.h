/* Inside the cleaning of tracks. */
#ifndef ECO_TRACK_CLEAN_H
#define ECO_TRACK_CLEAN_H

#include "ecofiles/import/track/track.h"

/* Every fix gets a time, in file order not descending; see eco_track_clean for how. Positions are metres. */
enum eco_code track_repair_stamps(struct eco_track *track, double pace_m_s, struct eco_track_report *report, struct eco_error *error);
/* Metres; without heights, in the plane. */
double track_distance(const struct eco_fix *a, const struct eco_fix *b);
/* Speeds (in the plane, or with heights) over a second or more, so that rounding and noise do not pass for motion; stands are left out. At
 * most track->count, ascending; returns how many. */
uint32_t track_speeds(const struct eco_track *track, bool flat, double *speeds);
/* Sorts; 0 if there are none. */
double track_quantile(double *values, uint32_t count, double share);

#endif
