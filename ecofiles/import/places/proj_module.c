/* ecoproj.so: the part of this system that calls PROJ. */
#include "ecofiles/import/places/proj_module.h"

ECO_MODULE_EXPORT const struct eco_proj_module eco_proj_module = {
	.version = ECO_MODULE_VERSION, .crs_open = proj_crs_open, .crs_convert = proj_crs_convert,
		.crs_close = proj_crs_close,
	.crs_look = proj_crs_look, .crs_choices = proj_crs_choices,
	.crs_place = proj_crs_place, .crs_degrees = proj_crs_degrees,
};

PJ_CONTEXT *proj_quiet_context(void)
{
	PJ_CONTEXT *context = proj_context_create();
	if (context) {
		proj_log_level(context, PJ_LOG_NONE);
		proj_context_set_enable_network(context, 0);
	}
	return context;
}
