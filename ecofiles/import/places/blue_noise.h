/* Points that are evenly spread for any number of them: a progressive blue-noise set on a square that
 * repeats without seams.
 *
 * The most crowded random candidate is removed until the wanted number is left, and again for each halving of that
 * number. The reversed order of removal is the order of the set (Yuksel 2015, sample
 * elimination, with its progressive ordering). */
#ifndef ECO_BLUE_NOISE_H
#define ECO_BLUE_NOISE_H

#include <stdbool.h>
#include <stdint.h>

#define ECO_BLUE_NOISE_POINTS 4096u

/* x and y in 1/65536 of the square's side; the first n points are evenly spread for any n. The same on
 * every machine. */
void eco_blue_noise(uint16_t points[ECO_BLUE_NOISE_POINTS][2]);

#endif
