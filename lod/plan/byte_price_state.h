/* State of byte prices between relaxations (lod/plan/byte_price.h), and its part about textures: how many
 * levels of each are worth their bytes. Only byte_price*.c and image_price.c know of it. */
#pragma once

#include "lod/plan/allocation.h"

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
	uint32_t ladder;
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
	double image_lost, outline_lost;     /* what each that shows it has wrong: all, and by its outline; ... */
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
	double *instances, *points;  /* per node */
	double *part;                /* per node: of its tile's bytes, that an occurrence pays */
	bool *organs_off;            /* per plant */
	double *saved, *spent;       /* per plant: by its organs */
};

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
