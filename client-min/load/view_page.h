/* A load test's report as one HTML file: its figures, and plots as SVG, with nothing from elsewhere. */
#ifndef VIEW_PAGE_H
#define VIEW_PAGE_H

#include "client-min/load/view_load_report.h"

enum eco_code view_page_write(const struct view_load_summary *summary, const char *path,
	struct eco_error *error);

#endif
