/* Cost of a plan in bytes that the client lacks, and the saving that a byte must bring.
 *
 * A second Lagrangian multiplier, allocation->price, is the number of wrong pixels that a byte must save. At
 * a price of 0 a plan is that of its vertices alone. Above it
 *
 * - a tile pays for its summary, chunk by chunk, and for its instance lists
 * - the bytes of a plant's lists are paid once, by all plants of the scene that draw them: a ladder is
 *   limited to where its next bytes save more, summed over plants, than they cost
 * - a plant's organs, which need many lists, are drawn by none of its plants unless they save more, over the
 *   ladder that shows the whole plant, than all their bytes cost
 * - a level of an impostor must set more right for each byte (lod/plan/texture_levels.h)
 *
 * A limit depends on which plants are drawn, and which are drawn depends on limits. Both are made in turn,
 * beginning without limits, a fixed number of times. All that is drawn then only becomes less, so the result
 * does not depend on what was asked before.
 *
 * Lists of a nested eco file are paid in equal parts by its visible occurrences. */
#pragma once

#include "lod/plan/allocation.h"

/* ---- What is in view ---- */

#define LISTS_OF_LADDER 5        /* points, lines, simple, triangles, impostor */

/* The longest prefix of each list of a ladder, in chunks. */
struct chunks { uint32_t of[LISTS_OF_LADDER]; };

/* A number of vertices that some plant may draw of a ladder. */
struct step {
	uint64_t vertices;
	struct chunks needs;
	double gain;                 /* what is saved there, ... */
	bool rests;                  /* ... whether some choice stays there, ... */
	double more_px;              /* ... and pixels that show the texture from there on */
	double shown;                /* share of what is drawn that shows the texture */
};

/* A ladder in view, and what each number of vertices that a plant may draw needs of its lists. Points give
 * way to triangles, so a step may need less than those before it: what is paid is what some plant draws. */
struct ladder_price {
	uint32_t ladder, plant;
	uint32_t first, count;       /* its choices, in lod_prices.choices */
	uint32_t steps;
	uint32_t lists[LISTS_OF_LADDER], list_count;
	const double *prefixes[LISTS_OF_LADDER];       /* of each list: of so many chunks */
	struct step *at;             /* in ascending vertices */
	uint32_t last;               /* step that the last relaxation draws, ... */
	double used;                 /* ... and bytes of what it draws */
	uint32_t limit;              /* the last step that may be drawn */
	uint32_t image, textured;    /* its texture, in lod_prices.images; the first step that shows it */
	double image_part;           /* bytes of the texture that this ladder is asked for */
	bool shows;                  /* some of it, while organs are judged */
	double seen_px;              /* of plants that draw the ladder */
	double image_lost;           /* what each that shows it has wrong, ... */
	double bare_lost;            /* ... and each that does not show it */
	double whole_lost;           /* wrong pixels of plants drawn as a whole, which show none of it */
};

/* A texture: levels of colours, and of its outline. */
struct image_price {
	uint32_t list, outline, users[2];    /* outline: or ECO_NONE; users: ladders of whole plants, of cells */
	uint32_t plant;              /* of the first ladder that shows it */
	uint8_t level;               /* of LOD_KIND_TEXTURES, where limits are a mix; its price then */
	double price;
	uint32_t most, levels;       /* of colours, that the view resolves; that are worth their bytes */
	uint32_t outline_levels;     /* likewise; 0: there is no outline */
	double bytes;                /* of all these */
	uint32_t shown;              /* by so many ladders, while organs are judged */
	bool used;
};

struct lod_prices {
	struct lod_arena memory;     /* of all of it */
	uint32_t *held, *kept;       /* per list: chunks that the client has; that come anyway */
	double factor;               /* times their bytes, that others count */
	struct ladder_price *ladders;        uint32_t ladder_count;
	struct image_price *images;          uint32_t image_count;
	uint32_t *choices;           /* of the allocation, by ladder */
	double *instances, *points;  /* per node: bytes of its instance lists; mean bytes of a point of its summary */
	double *part;                /* per node: of its tile's bytes, that an occurrence pays */
	bool *organs_off;            /* per plant */
	double *saved, *spent;       /* per plant: by its organs */
};

/* ---- Limits ---- */

/* Finds what everything in view would cost. `kept`: chunks that come anyway, sooner or later, so that all
 * others count `times` their bytes; NULL: all count once. */
enum eco_code lod_prices_make(struct lod_allocation *allocation, const struct eco_holdings *kept,
	double times, struct eco_error *error);
void lod_prices_free(struct lod_allocation *allocation);      /* none made: fine */

/* Takes all limits away; sets them from what the last relaxation chose. The first time that was without
 * limits; before the last a ladder that shows a whole plant is kept as good as if no organs were drawn, so
 * that these have something to be compared with. */
void lod_prices_lift(struct lod_allocation *allocation);
void lod_prices_limit(struct lod_allocation *allocation, bool first, bool last);
/* Sets limits to what the last relaxation chose: filling a budget pays for no more. */
void lod_prices_tighten(struct lod_allocation *allocation);
/* Limits of all ladders in view; per plant, whether none of its organs is drawn, and which of LOD_KIND_TEXTURES its
 * textures pay. Set, they are those of the next relaxation that makes none. */
struct lod_mix { uint32_t *limits; bool *off; uint8_t *levels; bool used; };
#define LOD_KINDS_LEVELS 2u
void lod_kinds_set(struct lod_allocation *allocation, const struct lod_mix *mix);
/* Adds to each plant's bytes those of its lists, as the last relaxation chose them, and to its wrong pixels those for
 * want of textures. */
void lod_prices_of_kinds(struct lod_allocation *allocation, double *bytes, double *wrong);
/* Finds the mix of limits that leaves least wrong within `target` bytes, where a price, log2, leaves some. Relaxes
 * with it, or without where it is no better, and returns the bytes. */
double lod_kinds_share(struct lod_allocation *allocation, double lambda, double target, double octave,
	struct lod_mix *mix);
/* Are no organs of this plant drawn, by any of its plants? */
bool lod_prices_organs_off(const struct lod_allocation *allocation, uint32_t plant);

/* The first `points` of a tile's summary: bytes of the chunks that hold them, the points that these hold, and
 * those that all of them but the last do. */
struct lod_summary_price { double bytes, points, before; };
struct lod_summary_price lod_prices_summary(const struct lod_allocation *allocation, uint32_t node,
	double points);

/* Sets levels of textures anew, from what the last relaxation chose and the allocation's price. */
void lod_prices_levels(struct lod_allocation *allocation);
/* Bytes of what the last relaxation chose; wrong pixels for want of textures, or of levels of them. */
double lod_prices_bytes(struct lod_allocation *allocation);
double lod_prices_lost(const struct lod_allocation *allocation);

/* ---- The price that a number of bytes asks for: prices are log2 ---- */

/* Relaxes at a price, with its own limits or, if `mix` is used, with those; lod_prices_make came before. Returns the
 * bytes. */
double lod_price_relax(struct lod_allocation *allocation, double lambda, double octave, const struct lod_mix *mix);
/* Relaxes at a price whose bytes are at most `target`, and returns these bytes. near: log2 of a price that nearly fits;
 * NAN: not known. */
double lod_price_find(struct lod_allocation *allocation, double lambda, double target, double near, double *octave);
/* Wrong pixels that the last relaxation leaves. */
double lod_price_wrong(const struct lod_allocation *allocation);

/* ---- Parts of prices ---- */

/* Bytes of the chunks [from, to) of a list that the client lacks. */
double lod_prices_missing(const struct lod_allocation *allocation, uint32_t list, uint32_t from, uint32_t to);
/* Puts the longer of both into the sum. The bytes that chunks of a ladder take. */
void lod_prices_add_needs(struct chunks *sum, const struct chunks *more);
double lod_prices_of(const struct ladder_price *ladder, const struct chunks *needs);
/* Counts the work of limits, which are made of what all choices come to, as a relaxation is. */
void lod_prices_work(struct lod_allocation *allocation);
/* The share of a slot's plants that draw a choice. `all`: of a ladder that shows the whole plant, as if no
 * organs were drawn. */
double lod_prices_share(const struct lod_allocation *allocation, uint32_t ladder_choice, bool all);
/* Pixels that these plants should cover with it. */
double lod_prices_seen(const struct lod_allocation *allocation, uint32_t ladder_choice);

/* Finds the textures of the ladders in view, all levels taken that the view resolves; false: no memory. */
bool lod_images_make(struct lod_allocation *allocation);
/* Sets levels to those that are worth their bytes at the allocation's price, of what is drawn now. */
void lod_images_limit(struct lod_allocation *allocation);
