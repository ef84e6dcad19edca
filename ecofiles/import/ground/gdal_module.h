/* Inside ecogdal.so: the functions in its table. */
#pragma once

#include "ecofiles/base/module.h"

/* As in struct eco_gdal_module. */
enum eco_code gdal_ground_read(struct eco_ground_job *job, FILE *out, struct eco_error *error);
enum eco_code gdal_image_read(struct eco_ground_image_job *job, FILE *out, struct eco_error *error);
bool gdal_rows_knows(const char *path);
enum eco_code gdal_rows_open(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error);

extern const struct eco_gdal_module eco_gdal_module;
