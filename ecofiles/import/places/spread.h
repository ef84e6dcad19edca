/* How numbers spread: quantiles of a stream, from an even selection of it, in bounded memory. The same
 * stream gives the same selection. */
#ifndef ECO_SPREAD_H
#define ECO_SPREAD_H

#include <stdbool.h>
#include <stdint.h>

#define ECO_SPREAD_KEPT 4096u

struct eco_spread {              /* zero is empty */
	float *kept;                 /* owned; every `stride`-th number */
	uint32_t count, stride;
	uint64_t seen;
	bool sorted;
};

/* False when memory ran out. */
bool eco_spread_add(struct eco_spread *spread, double number);
/* The number that this share of them does not exceed; NaN if there are none. */
double eco_spread_quantile(struct eco_spread *spread, double share);
void eco_spread_free(struct eco_spread *spread);

#endif
