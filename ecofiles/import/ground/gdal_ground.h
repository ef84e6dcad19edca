/* Inside ecogdal.so: rasters in the scene, and one raster as metres, on its own grid. */
#ifndef ECO_GDAL_GROUND_H
#define ECO_GDAL_GROUND_H

#include <gdal.h>
#include <ogr_srs_api.h>

#include "ecofiles/import/ground/import_ground.h"

void ground_note(struct ground_notes *notes, const char *format, ...) __attribute__((format(printf, 2, 3)));

struct ground_raster {
	const char *path;
	GDALDatasetH file;
	OGRSpatialReferenceH crs;    /* horizontal; NULL: neither raster nor scene has one */
	char vertical[64];           /* datum stated by the file; else empty */
	double crs_unit_m;           /* unit of heights by the CRS; 0: not stated */
	double transform[6];         /* of pixels to its CRS */
	int columns, rows;
	bool direct;                 /* pixels are in the scene's metres, rows from the north or the south */
	double low[2], high[2], step[2];     /* in the scene's CRS: outer bounds, size of a pixel */
};

/* What rasters are placed in. */
struct ground_scene {
	const struct eco_ground_options *options;    /* as the caller gave them */
	struct ground_notes *notes;
	OGRSpatialReferenceH crs;    /* NULL: none; the owner destroys it */
	char vertical[64];           /* of a compound CRS; else empty */
	/* for messages: what the scene says before a CRS, and after it; and the object it is in */
	const char *where[2], *what;
};

/* Sets the scene's CRS, which must be in metres. */
enum eco_code ground_scene_check(struct ground_scene *scene, struct eco_error *error);
/* Opens raster->path and finds its CRS; then where it lies. Close it in any case. */
enum eco_code ground_raster_open(struct ground_raster *raster, struct ground_scene *scene,
	struct eco_error *error);
enum eco_code ground_raster_place(struct ground_raster *raster, const struct ground_scene *scene,
	struct eco_error *error);
void ground_raster_close(struct ground_raster *raster);
/* ECO_BAD_INPUT with GDAL's last message. */
enum eco_code ground_gdal_fail(const char *path, const char *doing, struct eco_error *error);

/* Metres of one raster, averaged down to at most `columns` x `rows`, in the raster's order of rows; NaN:
 * no height. */
struct ground_samples {
	float *metres;               /* owned */
	uint32_t columns, rows;
	double transform[6];
};
enum eco_code ground_samples_read(struct ground_samples *samples, const struct ground_raster *raster,
	const struct eco_ground_source *source, uint32_t columns, uint32_t rows, struct ground_notes *notes,
	struct eco_error *error);

#endif
