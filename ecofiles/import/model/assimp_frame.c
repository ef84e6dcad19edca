/* Axes and units of formats, and how assimp changes them. As measured with assimp 5.2: Collada arrives
 * Y-up and in metres, whatever the file says. FBX arrives as in the file, with its axes and unit beside
 * it. 3DS is turned from Z-up to Y-up. The others arrive without a hint, most of them Y-up. */
#include "ecofiles/import/model/assimp_module.h"

#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct aiMetadataEntry *metadata(const struct aiScene *scene, const char *key)
{
	for (unsigned i = 0; scene->mMetaData && i < scene->mMetaData->mNumProperties; i++)
		if (strcmp(scene->mMetaData->mKeys[i].data, key) == 0)
			return &scene->mMetaData->mValues[i];
	return NULL;
}

static double metadata_number(const struct aiScene *scene, const char *key, double otherwise)
{
	const struct aiMetadataEntry *entry = metadata(scene, key);
	switch (entry ? entry->mType : AI_META_MAX) {
	case AI_INT32: return *(const int32_t *)entry->mData;
	case AI_DOUBLE: return *(const double *)entry->mData;
	case AI_FLOAT: return (double)*(const float *)entry->mData;
	default: return otherwise;
	}
}

static const char *metadata_text(const struct aiScene *scene, const char *key)
{
	const struct aiMetadataEntry *entry = metadata(scene, key);
	return entry && entry->mType == AI_AISTRING ? ((const struct aiString *)entry->mData)->data : "";
}

static void set_axes(double axes[3][3], const double to[3][3], double scale)
{
	for (int k = 0; k < 3; k++)
		for (int j = 0; j < 3; j++)
			axes[k][j] = to[k][j] * scale;
}

static const double as_it_is[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
static const double up_from_y[3][3] = { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } };

/* The file names the axes that point right, up and to the viewer, each with a sign; unless they form a
 * right-handed system, only up counts. Its unit is a number of centimetres. */
static void fbx_frame(const struct aiScene *scene, struct eco_model_frame *frame, double axes[3][3])
{
	static const char *const names[3][2] = { { "CoordAxis", "CoordAxisSign" },
		{ "FrontAxis", "FrontAxisSign" }, { "UpAxis", "UpAxisSign" } };
	double unit = metadata_number(scene, "UnitScaleFactor", 0), to[3][3] = { { 0 } }, determinant;
	int axis[3], sign[3];
	frame->unit_m = isfinite(unit) && unit >= 1e-6 && unit <= 1e9 ? unit / 100 : 0;
	for (int k = 0; k < 3; k++) {
		axis[k] = (int)metadata_number(scene, names[k][0], k == 0 ? 0 : k == 1 ? 2 : 1);
		sign[k] = metadata_number(scene, names[k][1], 1) < 0 ? -1 : 1;
		if (axis[k] >= 0 && axis[k] < 3)
			to[k][axis[k]] = k == 1 ? -sign[k] : sign[k];
	}
	determinant = to[0][0] * (to[1][1] * to[2][2] - to[1][2] * to[2][1])
		- to[0][1] * (to[1][0] * to[2][2] - to[1][2] * to[2][0])
		+ to[0][2] * (to[1][0] * to[2][1] - to[1][1] * to[2][0]);
	frame->up = axis[2] == 2 ? ECO_UP_Z : ECO_UP_Y;
	if (determinant > 0.5)
		set_axes(axes, (const double (*)[3])to, 1);
	else
		set_axes(axes, frame->up == ECO_UP_Z ? as_it_is : up_from_y, 1);
}

/* assimp has applied axes and unit; the head of the file says which. */
static void collada_frame(const char *path, struct eco_model_frame *frame, double axes[3][3])
{
	size_t size;
	char *head = eco_path_ends_with(path, ".dae") ? eco_file_read_head(path, &size) : NULL;
	const char *unit = head ? strstr(head, "<unit") : NULL,
		*up = head ? strstr(head, "<up_axis>") : NULL;
	const char *end = unit ? strchr(unit, '>') : NULL, *meter = unit
		? strstr(unit, "meter=") : NULL;
	frame->unit_m = 1;
	if (meter && end && meter < end && strtod(meter + 7, NULL) >= 1e-6 && strtod(meter + 7, NULL) <= 1e6)
		frame->unit_m = strtod(meter + 7, NULL);
	frame->up = up && strncmp(up + 9 + strspn(up + 9, " \t\r\n"), "Z_UP", 4) == 0 ? ECO_UP_Z : ECO_UP_Y;
	free(head);
	set_axes(axes, up_from_y, 1 / frame->unit_m);
}

void assimp_frame(const struct aiScene *scene, const char *path, struct eco_model_frame *frame,
	double axes[3][3])
{
	const char *format = metadata_text(scene, "SourceAsset_Format"), *dot = strrchr(path, '.');
	bool z = eco_path_ends_with(path, ".ply") || eco_path_ends_with(path, ".stl")
		|| eco_path_ends_with(path, ".3ds");
	snprintf(frame->format, sizeof frame->format, "%.60s", *format != 0 ? format : dot ? dot + 1
		: "unknown");
	if (strstr(frame->format, " Importer"))
		*strstr(frame->format, " Importer") = 0;
	frame->convention = z ? ECO_UP_Z : ECO_UP_Y;
	if (eco_path_ends_with(path, ".fbx")) {
		fbx_frame(scene, frame, axes);
	} else if (strstr(format, "Collada")) {
		collada_frame(path, frame, axes);
	} else if (eco_path_ends_with(path, ".3ds")) {
		set_axes(axes, up_from_y, 1);     /* assimp turned it: back to the file's axes */
	} else {
		set_axes(axes, as_it_is, 1);
	}
}
