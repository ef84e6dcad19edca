/* What a view sees of an instance, in arithmetic that server and client share.
 *
 *   lod_eye_make(&eye, &view);                          once per request
 *   lod_place_instance(&place, &placement, &list, &p);  integers of an instance -> where it stands
 *   lod_instance_anchors(...)                           which of its anchors are seen, each in which band
 *
 * Only +, -, *, comparisons and correctly rounded division and sqrt on doubles, in a fixed order (-ffp-contract=off): the same
 * integers give the same answer on every machine, so a plan can name plants by rule (ecofiles/format/plan.h). */
#ifndef LOD_EYE_H
#define LOD_EYE_H

#include <stdbool.h>

#include "ecofiles/format/plan.h"

static inline double lod_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct lod_eye {
	double at[3];
	double right[3], up[3], forward[3];      /* orthonormal */
	double tan_x, tan_y;                     /* half extents of the image plane at distance 1 */
	double side[4][3];                       /* inward unit normals of the four side planes through the eye */
	double pixel_rad;                        /* height of a pixel on the image plane at distance 1: 2 tan_y / height */
};
void lod_eye_make(struct lod_eye *eye, const struct eco_view *view);   /* view must pass eco_view_check */

struct lod_place { double at[3]; double sine, cosine, scale; };        /* world = at + scale * turn(p) */
void lod_place_instance(struct lod_place *out, const struct eco_placement *placement, const struct eco_list *list,
	const struct eco_place *place);
void lod_place_point(const struct lod_place *place, const float p[3], double world[3]);

/* Does a sphere (world, metres) reach into the view pyramid? Conservative at its edges. */
bool lod_eye_sees(const struct lod_eye *eye, const double center[3], double radius);

/* Distance band of something at `world` that was scaled by `scale`: b such that distance / scale, blurred, lies in [2^(b/4), 2^((b+1)/4)) *
 * 2^-20 m, clamped to [0, ECO_BANDS). Apparent size, not distance, decides detail. Blurred: times a factor of the plant's own, in
 * [2^(-1/8), 2^(1/8)) by its hash (lod_share_hash), so that plants cross a band's border one after the other over a whole band of distances,
 * and no arc of the picture changes at once. Two plants side by side are at most one band apart, and a plant's cells and its body
 * are blurred alike. */
uint8_t lod_eye_band(const struct lod_eye *eye, const double world[3], double scale, uint32_t hash);
double lod_band_distance_m(uint8_t band);                              /* geometric middle of the band, for scale 1 */

/* How far from above something is seen that is `below` the eye (metres along the vertical) and `distance` away: 0 up to 12 degrees, 1 from 45. */
static inline double lod_seen_above(double below, double distance)
{
	double above = distance > 0 ? (below / distance - 0.2) / 0.5 : 0;
	return above < 0 ? 0 : above > 1 ? 1 : above;
}

/* The rule of a plan, for one instance: which anchors are drawn, and in which band each lies. anchors[0] is the whole plant, the
 * others its cells, anchor_first the index of anchors[0] in the scene. Writes nothing (returns 0) if the plant is out of view;
 * else first the whole plant and then, if its eco_gate_place is below `gate`, every cell in view. `hash` is the plant's lod_share_hash. `out` holds
 * anchor_count entries. */
struct lod_anchor_band { uint32_t anchor; uint8_t band; };
uint32_t lod_instance_anchors(const struct lod_eye *eye, const struct lod_place *place, const struct eco_anchor *anchors,
	uint32_t anchor_first, uint32_t anchor_count, uint32_t gate, uint32_t hash, struct lod_anchor_band *out);

/* Hash of an instance in [0, ECO_SHARE_ONE): which side of a cut's share it is on, and how its distance is blurred. */
uint32_t lod_share_hash(uint32_t path, uint32_t list, uint32_t index);
/* The same in another order: which plants of a tile come first where its summary gives way to them, whatever side of a cut's share they are on. */
static inline uint32_t lod_open_hash(uint32_t hash) { return (hash * 40503u + 12829u) % ECO_SHARE_ONE; }

#endif
