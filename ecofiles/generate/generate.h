/* Example scenes without any input: parametric plants, placed as in nature, on generated ground.
 *
 *   eco_generate(&(struct eco_generate_options){ .name = "park", .folder = "park", .seed = 1 }, &error);
 *
 * The folder then holds scene.json, models/ (OBJ, MTL, PNG), dem.tif, camera.json and, for a forest,
 * stems.csv. The same name, plants and seed give the same bytes on every machine: random numbers are
 * integers, angles come from ecofiles/base/angle16.h, other functions are polynomials and square roots, and
 * coordinates are written with few decimals. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_GENERATE_PLANTS_MAX 10000000000000u    /* nested scenes; scenes that list each plant: */
#define ECO_GENERATE_NAMED_MAX 20000000u
#define ECO_GENERATE_DETAIL_MAX 64.0

struct eco_generate_options {
	const char *name;            /* one of eco_generate_kinds */
	const char *folder;          /* made if absent; files of the same names are replaced whole */
	uint64_t plants;             /* about so many instances; 0: the scene's default */
	double detail;               /* woody plants: leaves times this, each as much smaller; 0: 1 */
	uint64_t seed;
	/* Called before each piece of work with its name and the share done; false stops with
	 * ECO_INTERRUPTED; may be NULL. */
	bool (*progress)(void *ctx, const char *stage, double share);
	void *ctx;
};

/* The scenes that can be generated, with one-line descriptions; ends with a NULL name. */
struct eco_generate_kind { const char *name, *says; uint64_t plants; };
extern const struct eco_generate_kind eco_generate_kinds[];

/* On failure scene.json is not written, so that half a folder is not taken for a scene. */
enum eco_code eco_generate(const struct eco_generate_options *options, struct eco_error *error);
