/* A plot as SVG text: lines over two axes, each linear or logarithmic. */
#ifndef VIEW_PLOT_H
#define VIEW_PLOT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define VIEW_PLOT_LINES_MAX 4u

struct view_plot_line { const char *name; const double *x, *y; uint32_t count; };

struct view_plot {
	const char *title, *x, *y;               /* what the axes measure */
	bool log_x, log_y;                       /* values that are not above 0 are left out then */
	struct view_plot_line lines[VIEW_PLOT_LINES_MAX]; uint32_t count;
	void (*label_x)(char *text, size_t size, double value);  /* of a tick; NULL: the number */
};

/* Points whose values are not finite break a line. */
void view_plot_write(FILE *out, const struct view_plot *plot);

#endif
