/* The view of an instance, in arithmetic that server and client share.
 *
 *   lod_eye_make(&eye, &view);                          once per request
 *   lod_place_instance(&place, &placement, &list, &p);  integers of an instance -> where it stands
 *   lod_instance_anchors(...)                           which of its anchors are seen, each in which band
 *
 * Only +, -, *, comparisons, correctly rounded division and sqrt on doubles, in a fixed order
 * (-ffp-contract=off): the same integers give the same answer on every machine, so a plan can name plants by
 * rule (ecofiles/format/plan.h). */
#pragma once

#include <stdbool.h>

#include "ecofiles/format/plan.h"

static inline double lod_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/* `out` is neither of both. */
static inline void lod_cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

struct lod_eye {
	double at[3];
	double right[3], up[3], forward[3];      /* orthonormal */
	double tan_x, tan_y;                     /* half extents of the image plane at distance 1 */
	double middle[2];                        /* of the picture there: right of and above where it looks */
	uint32_t sample;                         /* opacity's hash varies with it */
	double side[4][3];                       /* unit normals of the side planes through the eye, inward */
	double pixel_rad;                        /* height of a pixel on the image plane at distance 1 */
};
void lod_eye_make(struct lod_eye *eye, const struct eco_view *view);   /* view must pass eco_view_check */
/* The eye of a part of its picture: of width x height pixels, the part of size[0] x size[1] from column at[0]
 * and row at[1] on. So a picture of any size is drawn in parts. */
void lod_eye_part(struct lod_eye *eye, uint32_t width, uint32_t height, const uint32_t at[2],
	const uint32_t size[2]);
/* The eye that takes sample `number` of each pixel. Sample 0 is the pixel's middle; the first 4, 8 and 16 are
 * spread evenly around it (lod/EXPERIMENTS.md, Samples), and each further one lies farthest from those before. */
#define LOD_SAMPLES_MAX 64u
void lod_eye_sample(struct lod_eye *eye, uint32_t number);

/* world = at + scale * turn(p), with x and y of p times 1 + wider */
struct lod_place {
	double at[3];
	double sine, cosine, scale, wider;
	uint32_t salt;                   /* 16 bits that differ from plant to plant, of its lod_share_hash; 0 in measurements */
};
static inline double lod_place_width(const struct lod_place *place) { return 1 + place->wider; }
/* The greatest factor of a plant's lengths. */
static inline double lod_place_most(const struct lod_place *place)
{
	return place->wider > 0 ? place->scale * lod_place_width(place) : place->scale;
}
void lod_place_instance(struct lod_place *out, const struct eco_placement *placement,
	const struct eco_list *list, const struct eco_place *place);
void lod_place_point(const struct lod_place *place, const float p[3], double world[3]);

/* Whether a sphere (world, metres) reaches into the view pyramid. May say yes just outside its edges. */
bool lod_eye_sees(const struct lod_eye *eye, const double center[3], double radius);

/* Distance band of an instance at `world`, scaled by `scale`: b such that the blurred distance / scale lies
 * in [2^(b/4), 2^((b+1)/4)) * 2^-20 m, clamped to [0, ECO_BANDS). Apparent size, not distance, decides
 * detail. To blur is to multiply by a factor in [2^(-1/8), 2^(1/8)) that follows from the plant's hash
 * (lod_share_hash). Plants then cross a band's border one by one, and no arc of the picture changes at once.
 * Two plants side by side are at most one band apart; all anchors of a plant are blurred alike. */
uint8_t lod_eye_band(const struct lod_eye *eye, const double world[3], double scale, uint32_t hash);
double lod_band_distance_m(uint8_t band); /* geometric middle of the band, scale 1 */

/* Degree of a view from above, onto a point `below` metres lower than the eye: 0 up to 12 degrees, 1 from
 * 45. */
static inline double lod_seen_above(double below, double distance)
{
	double above = distance > 0 ? (below / distance - 0.2) / 0.5 : 0;
	return above < 0 ? 0 : above > 1 ? 1 : above;
}

/* The rule of a plan for one instance: which anchors are drawn, and in which band each lies. anchors[0] is
 * the whole plant, the others are its cells; anchor_first is the index of anchors[0] in the scene. Returns 0
 * and writes nothing if the plant is out of view. Otherwise writes the whole plant, and after it every cell
 * in view if the plant's eco_gate_place is below `gate`. `hash` is the plant's lod_share_hash. `out` holds
 * anchor_count entries. */
struct lod_anchor_band { uint32_t anchor; uint8_t band; };
uint32_t lod_instance_anchors(const struct lod_eye *eye, const struct lod_place *place,
	const struct eco_anchor *anchors, uint32_t anchor_first, uint32_t anchor_count, uint32_t gate,
	uint32_t hash, struct lod_anchor_band *out);

/* Hash of an instance in [0, ECO_SHARE_ONE): decides the side of a cut's share that it is on, and blurs its
 * distance. */
uint32_t lod_share_hash(uint32_t path, uint32_t list, uint32_t index);
/* A permutation of that hash: the order in which the plants of a tile replace its summary, independent of
 * shares. */
static inline uint32_t lod_open_hash(uint32_t hash) { return (hash * 40503u + 12829u) % ECO_SHARE_ONE; }

/* Distances by which pixels are summed: the first ends at 8 m, each other at twice that, the last nowhere. */
#define LOD_DISTANCES 5u
#define LOD_DISTANCE_FIRST_M 8.0
uint32_t lod_distance_of(double m);
/* Metres from which on a distance counts. */
double lod_distance_from_m(uint32_t distance);
