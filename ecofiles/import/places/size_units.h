/* The unit of a column of sizes: by its name, else by how its numbers spread, held against plants as they
 * grow. No unit is taken if two would do. The same measure doubts a unit that a scene states. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum eco_quantity { ECO_QUANTITY_HEIGHT, ECO_QUANTITY_DBH, ECO_QUANTITY_GIRTH,
	ECO_QUANTITY_CROWN           /* a diameter */
};

struct eco_size_numbers { double middle, high; };        /* median and 98th percentile, above 0 */

struct eco_unit_guess {
	const char *unit;            /* "m", "cm", "mm", "in", "ft"; NULL: it must be asked for */
	const char *other;           /* the unit that would do as well, or better than the name's */
	bool by_name;
	char why[200];               /* the reason, or the question */
};

/* `name`: of the column; `beside`: the unit of another size of the same plants, as nobody measures heights in
 * feet and trunks in centimetres; both may be NULL. */
struct eco_unit_guess eco_unit_guess(enum eco_quantity quantity, const char *name, const char *beside,
	const struct eco_size_numbers *numbers);
/* The unit that a column's name says, or NULL. */
const char *eco_unit_of_name(const char *name);

/* The unit that the names of x and y both end with, and its metres; NULL, 1 metre: none. */
const char *eco_unit_of_place(const char *x, const char *y, double *metres);

#define ECO_SPREAD_KEPT 4096u

struct eco_spread {              /* zero is empty */
	float *kept;                 /* owned; every `stride`-th number */
	uint32_t count, stride;
	uint64_t seen;
	bool sorted;
};

void eco_spread_add(struct eco_spread *spread, double number);
/* The number that this share of them does not exceed; NaN if there are none. */
double eco_spread_quantile(struct eco_spread *spread, double share);
void eco_spread_free(struct eco_spread *spread);
