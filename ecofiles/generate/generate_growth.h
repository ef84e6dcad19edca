/* Plants of the library: wood by a habit, then leaves along its last branches.
 *
 *   gen_habit_grow(&mesh, organ, habit, size, &look, seed)          generate_growth.c
 *     gen_foliage_plan(&foliage, ...)        how many leaves, of what size       generate_foliage.c
 *     stems, boughs, twigs, shoots: tubes, and bearers of leaves
 *     gen_foliage_place(&foliage, bearers)   the leaves                          generate_foliage.c */
#pragma once

#include "ecofiles/generate/generate_plants.h"
#include "ecofiles/generate/library.h"

struct gen_plant_look {
	uint32_t bark, leaf, flower; /* 0xRRGGBB */
	const char *shape;           /* as in leaves.tsv */
	double leaf_cm, slim;        /* slim 0: of the shape */
	double flowers;              /* share of leaves that are flowers, at the ends of branches */
	bool is_bare;                /* without leaves */
	bool is_motley;              /* leaves differ in colour, as in autumn */
};

/* A piece of a branch along which leaves grow. start, part: where it lies along all of the branch that bears leaves, as shares. */
struct gen_bearer {
	struct gen_v3 from, along;
	double light, start, part;
	bool is_tip;
};

enum gen_arrangement { GEN_AROUND, GEN_RANKS, GEN_TUFT, GEN_FAN, GEN_RIBBON };

struct gen_foliage {
	struct gen_mesh *mesh;
	struct gen_random *random;
	enum gen_arrangement arrangement;
	enum gen_leaf_shape outline;
	double length, width; /* of a piece, metres */
	double angle_deg, droop, flowers;
	uint32_t pieces;      /* of a leaf */
	struct gen_spray spray; /* that a piece is; spray.leaves 0: a leaf or leaflet */
	uint32_t count;       /* leaves or sprays wanted; also of a tree in winter, whose shoots bear none */
	bool is_bare;         /* flowers without leaves */
	double lowest;        /* no leaf hangs below, metres */
	uint8_t leaf, flower; /* materials, GEN_SHADES of each */
	uint8_t cards[2];     /* of sprays of leaves and of flowers */
};
#define GEN_SHADES 5u
#define GEN_CELLS 4u

/* Sets sizes and count for `area` square metres of leaves: one by one if they are few, else as sprays. most_m:
 * greatest length of a leaf; part_m: length of a piece, 0: the genus's; slim: 0: the look's. */
void gen_foliage_plan(struct gen_foliage *foliage, const struct gen_plant_look *look, double area, double most_m,
	double part_m, double slim);
void gen_foliage_place(const struct gen_foliage *foliage, const struct gen_bearer *bearers, uint32_t count);
/* The way of a leaf or branch that leaves `way` under an angle, turned around it. */
struct gen_v3 gen_way_off(struct gen_v3 way, double degrees, double turn_deg);
/* One of GEN_SHADES by the light, 0 to 1, and by chance. */
uint8_t gen_foliage_shade(const struct gen_foliage *foliage, double light);

/* Grows habit number i, `height_m` high and `crown_m` wide; writes the organ of each material, and what its textures
 * "leaf" and "flower" show, if sprays[0].leaves is not 0. */
void gen_habit_grow(struct gen_mesh *mesh, uint8_t organ[GEN_MATERIALS_MAX], struct gen_spray sprays[2], size_t i,
	const struct eco_library_plant *plant, const struct gen_plant_look *look, uint64_t seed);
