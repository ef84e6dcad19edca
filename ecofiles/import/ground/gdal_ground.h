/* Inside ecogdal.so: rasters in the scene, one raster as metres, and its colours. All of it runs within eco_try
 * (memory.h), in a child that reads one ground or one image and ends: failures stop it, and no raster is closed. */
#pragma once

#include <gdal.h>
#include <ogr_srs_api.h>

#include "ecofiles/import/ground/import_ground.h"

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

/* The frame in which rasters are placed. */
struct ground_scene {
	const char *scene_crs, *stated;      /* CRS of the scene, and of the rasters as it says; NULL: none */
	bool has_place;              /* the scene says where a raster lies, too: */
	const double *corner, *pixel;
	struct eco_notes *notes;
	OGRSpatialReferenceH crs;    /* NULL: none */
	char vertical[64];           /* of a compound CRS; else empty */
	/* for messages: what the scene says before a CRS, and after it; and the object it is in */
	const char *where[2], *what;
};

/* Sets the scene's CRS, which must be in metres. */
void ground_scene_check(struct ground_scene *scene);
/* Opens raster->path and finds its CRS; then where it lies. */
void ground_raster_open(struct ground_raster *raster, struct ground_scene *scene);
void ground_raster_place(struct ground_raster *raster, const struct ground_scene *scene);
/* Warps a dataset into a box of the scene's CRS (west, south, east, north; NULL: the dataset has no CRS
 * to convert) with `size` columns and rows. `more`: options of gdalwarp, ended by NULL. `path`: for the message. */
GDALDatasetH ground_warp(const char *path, GDALDatasetH from, OGRSpatialReferenceH crs, const double box[4],
	const int size[2], const char *const *more);
/* ECO_BAD_INPUT with GDAL's last message, unless it is good. */
void ground_gdal_check(bool good, const char *path, const char *doing);

/* Metres of one raster, averaged down to at most `columns` x `rows`, in the raster's order of rows; NaN:
 * no height. */
struct ground_samples {
	float *metres;
	uint32_t columns, rows;
	double transform[6];
};
void ground_samples_read(struct ground_samples *samples, const struct ground_raster *raster,
	const struct eco_ground_source *source, uint32_t columns, uint32_t rows, struct eco_notes *notes);

/* ---- Colours of one raster ---- */

struct ground_colors {
	struct ground_raster raster;
	bool by_class;               /* numbers of classes; else colours */
	bool by_range;               /* colours of numbers from range[0], black, to range[1], white */
	double range[2];
	int bands[3], alpha;         /* red, green, blue; alpha, 0: none */
	struct eco_ground_class *classes;
	uint32_t class_count; /* ascending; the scene's and the file's */
	bool has_nodata;
	double nodata;
};

/* Finds out what an opened raster shows; its CRS and place need not be known. `range`, black and white of
 * bands that are no bytes, is guessed and noted where it is empty, and then holds for all rasters. */
void ground_colors_open(struct ground_colors *colors, const struct eco_ground_image_source *source,
	double range[2], struct eco_notes *notes);
/* Puts a raster whose place was found where the scene says. */
void ground_colors_locate(struct ground_colors *colors, const struct eco_ground_image_source *source);

/* Colours of a square of ECO_GROUND_IMAGE_SIDE texels a side: west, south, east, north in the scene's
 * CRS; rows from the north. */
void ground_colors_read(const struct ground_colors *colors, const struct ground_scene *scene,
	const double bounds[4], uint8_t *rgba);
