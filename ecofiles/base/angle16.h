/* Angles as integers: a turn is 65536 steps counter-clockwise from +X. Sine and cosine come from a fixed
 * polynomial in plain IEEE doubles, so that server, client and build agree to the last bit on every
 * machine. */
#pragma once

#include <stdint.h>

void eco_angle16_sincos(uint16_t turn, double *sine, double *cosine);
uint16_t eco_angle16_from_deg(double degrees);          /* nearest step; any finite angle */
