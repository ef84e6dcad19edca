/* Small random scenes for tests of the planner and of what evaluates its plans: tables only. Every kind of
 * ladder (points, simple forms and triangles, blades, wood with levels, plain triangles, splats), plants with
 * and without cells, tiles in two levels, nested placements.
 *
 *   random_scene_make(&b, seed, nested);      b is empty or an earlier scene; scene_free(&b)
 *   random_pack_make(seed, nested, factor)    such a scene as an open pack with payloads: random bytes under
 *                                             true hashes */
#pragma once

#include "ecofiles/format/view.h"
#include "tests/support/scene_builder.h"

/* at most; leaves: exactly, up to 4; splats: most plants have a ladder of splats for the whole plant too */
struct random_sizes { uint32_t species, leaves, elements, places, cells; bool splats; };

uint64_t random_bits(struct scene_builder *b);
double random_real(struct scene_builder *b, double low, double high);
uint32_t random_below(struct scene_builder *b, uint32_t n);

/* `nested` adds placed copies of one eco file under the root. */
void random_scene_sized(struct scene_builder *b, uint64_t seed, uint32_t nested, struct random_sizes sizes);
void random_scene_make(struct scene_builder *b, uint64_t seed, uint32_t nested);
/* The same, with splats. */
void random_scene_splats(struct scene_builder *b, uint64_t seed, uint32_t nested);
/* A list of elements of one to four triangles; and another form of one, of one to four `corners` each. */
uint32_t random_fans(struct scene_builder *b, uint32_t elements, uint32_t owner);
uint32_t random_form(struct scene_builder *b, uint8_t kind, uint32_t of, uint32_t corners);

/* A scene of one plant: leaves with a curve, and if there are `splats` so many in a ladder for the whole
 * plant, with fp and fn of the first of them and of all. */
struct random_stand {
	float height_m, area, shares[4], errors[4], splat_errors[2][2];
	uint32_t leaves, splats;
};
void random_stand_make(struct scene_builder *b, const struct random_stand *stand);
/* A tile, with its instances of plant 0 in a square from `origin` on, m. */
uint32_t random_crowd(struct scene_builder *b, struct eco_tile tile, const double origin[2], double size);

/* The server never decodes, so that this is a pack to it; ground, an image and textured triangles are added.
 * Payloads of about `factor` times 10 bytes a primitive. */
struct random_pack { struct scene_builder r; struct eco_pack pack; uint8_t *map; };
struct random_pack *random_pack_make(uint64_t seed, uint32_t nested, uint32_t factor);
void random_pack_free(struct random_pack *p);

/* From somewhere in or around it. */
struct eco_view random_view(struct scene_builder *b);
