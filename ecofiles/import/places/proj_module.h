/* Inside ecoproj.so: the functions in its table, and those that its parts share. */
#pragma once

#include <proj.h>

#include "ecofiles/base/module.h"

/* A context that neither prints nor asks the network; NULL: out of memory. */
PJ_CONTEXT *proj_quiet_context(void);
/* To longitude and latitude of `geodetic`, which it destroys; NULL: there is no way. */
PJ *proj_to_degrees(PJ_CONTEXT *context, const PJ *crs, PJ *geodetic);
/* Whether a CRS is projected and in metres, alone or as the map of a compound one. */
bool proj_is_metric_map(PJ_CONTEXT *context, const PJ *crs);

/* As in struct eco_proj_module. */
enum eco_code proj_crs_open(struct eco_crs_path **path, const struct eco_crs_request *request,
	struct eco_error *error);
enum eco_code proj_crs_convert(struct eco_crs_path *path, double xyz[3], bool *converted, const char **why,
	struct eco_error *error);
void proj_crs_close(struct eco_crs_path *path);

extern const struct eco_proj_module eco_proj_module;
