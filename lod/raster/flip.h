/* The error that people see between two pictures when they flip from one to the other (Andersson and others,
 * "FLIP: A Difference Evaluator for Alternating Images", 2020), for low dynamic range, at 67.02 pixels per
 * degree: a screen 3840 pixels and 0.7 m wide, seen from 0.7 m. Nothing that is stored or sent depends on it:
 * two C libraries may differ in the last bits of exp, pow and cbrt. */
#pragma once

#include <stdint.h>

/* `test` is compared with `reference`: sRGB, 3 bytes a pixel, rows without gaps. */
struct lod_flip_input {
	uint32_t width, height;
	const uint8_t *test, *reference;
	float *error;                        /* receives a number in [0, 1] a pixel; may be NULL */
};
/* The mean error of all pixels, 0 to 1; 0 for pictures that are the same. A picture is worked on in bands, so
 * that memory grows with its width only. */
double lod_flip(const struct lod_flip_input *input);

/* CIELAB under D65 of linear sRGB, 0 to 1. */
void lod_lab(const double rgb[3], double lab[3]);
