/* Tables (rows.h): CSV; and GPX, KML and GeoJSON as GDAL hands them over, with a row for each position. GDAL
 * 3.6 does not hand over the times of KML's gx:Track: a file that has times is refused if none arrives. */
#include <string.h>

#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/track/track_read.h"

#define HEADER_ROWS 50u

/* A geometry says more than columns do. A placemark's height may count from the ground. */
static void take_place(struct eco_fix *fix, const struct track_table *table, const struct eco_rows *rows)
{
	const struct eco_rows_place *place = &rows->place;
	uint32_t mode = table->column[TRACK_MODE];
	bool there = place->kind == ECO_PLACE_POINT;
	for (int k = 0; k < 3; k++)
		fix->at[k] = there && !isnan(place->at[k]) ? place->at[k] : k < 2 ? NAN : fix->at[k];
	if (mode < rows->field_count && strstr(rows->fields[mode], "relativeTo")) {
		fix->above_m = fix->at[2];
		fix->at[2] = NAN;
	}
	fix->of_line = place->what[0] != 0;
}

static enum eco_code read_rows(struct eco_track *track, const struct track_table *table,
	struct eco_rows *rows, struct eco_error *error)
{
	bool more = true;
	enum eco_code code;
	while (!(code = rows->next(rows, &more, error)) && more) {
		struct eco_fix fix = track_row(table, rows->fields, rows->field_count, (uint32_t)rows->line);
		if (rows->has_geometry)
			take_place(&fix, table, rows);
		else if (*rows->fields[0] == '#')
			continue;
		if ((code = track_add(track, &fix, error)))
			return code;
	}
	return code;
}

/* The header is the first row in which a position is found, so that preambles may precede it. */
static enum eco_code find_header(struct track_table *table, struct eco_rows *rows, const char *path,
	struct eco_error *error)
{
	bool more = true, found = track_find_columns(table, (const char *const *)rows->columns,
		rows->column_count);
	enum eco_code code = ECO_OK;
	char list[200];
	eco_rows_list_columns(rows, list, sizeof list);
	while (!code && !found && !rows->has_geometry && more && rows->row < HEADER_ROWS)
		if (!(code = rows->next(rows, &more, error)) && more)
			found = track_find_columns(table, rows->fields, rows->field_count);
	return code || found || rows->has_geometry ? code : eco_fail(error, ECO_BAD_INPUT, "%.100s: no "
		"format is known that looks like this, and as a table it has no columns for a position; it "
		"begins \"%.60s\". If it is one, name its columns in the first line: t,lon,lat,alt or "
		"t,x,y,z, and yaw,pitch. " TRACK_FORMATS, path, list);
}

/* As the format of a geometry or its "crs" says, unless its numbers cannot be such. */
static bool is_degrees(struct eco_track *track, const struct eco_rows *rows)
{
	const char *stated = rows->crs && !rows->degrees_doubted ? rows->crs : NULL;
	if (stated ? strstr("EPSG:4326 EPSG:4979 OGC:CRS84", stated) != NULL : !rows->degrees_doubted)
		return true;
	eco_track_note(track, "its coordinates are no degrees: metres from the scene's origin, unless "
		"--track-crs says a CRS%s%.80s", stated ? ", as it does: " : "", stated ? stated : "");
	return false;
}

static enum eco_code read_layer(struct eco_track *track, const char *layer, struct eco_error *error)
{
	struct eco_rows_source source = { .path = track->path, .layer = layer, .vertices = true };
	struct eco_rows *rows;
	struct track_table table;
	enum eco_code code = track->format == ECO_TRACK_CSV ? eco_rows_open_csv(&rows, track->path, 0, error)
		: eco_rows_open_here(&rows, &source, error);
	if (code)
		return code;
	code = find_header(&table, rows, track->path, error);
	track->degrees = rows->has_geometry ? is_degrees(track, rows) : table.degrees;
	code = code ? code : read_rows(track, &table, rows, error);
	for (uint32_t i = 0; i < rows->note_count; i++)
		eco_track_note(track, "%s", rows->notes[i]);
	eco_rows_close(rows);
	return code;
}

/* Lines win over the points beside them, unless only these have times. */
static void keep_lines(struct eco_track *track)
{
	bool timed[2] = { false, false }, lines = false;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < track->count; i++) {
		lines |= track->fixes[i].of_line;
		timed[track->fixes[i].of_line] |= !isnan(track->fixes[i].time_s);
	}
	bool of_line = lines && (timed[1] || !timed[0]);
	for (uint32_t i = 0; i < track->count; i++)
		if (track->fixes[i].of_line == of_line)
			track->fixes[kept++] = track->fixes[i];
	if (kept < track->count)
		eco_track_note(track, "its %u %s are taken; %u positions beside them are left out", kept,
			of_line ? "positions of lines" : "points with times", track->count - kept);
	track->records -= track->count - kept;
	track->count = kept;
	track->timed = timed[of_line];
}

/* No time arrived: refuses what has some, whether it was read or not. */
static enum eco_code check_times(const struct eco_track *track, enum eco_code code, struct eco_error *error)
{
	static const char *const words[][2] = { { ":FlyTo>", "gx:FlyTo" }, { "\"times\"", "times" },
		{ "when>", "<when>, of a gx:Track" }, { "\"coordTimes\"", "coordTimes" } };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (strstr(track->text, words[i][0])) {
			*error = (struct eco_error){ 0 };
			return eco_fail(error, ECO_UNSUPPORTED, "%.200s: its times (of %s) do not arrive "
				"through GDAL; convert it to GPX or CSV (GPSBabel does)", track->path,
				words[i][1]);
		}
	return code;
}

enum eco_code track_read_rows(struct eco_track *track, struct eco_error *error)
{
	static const char *const layers[] = { "track_points", "route_points", "waypoints" };
	enum eco_code code = ECO_OK;
	if (track->format == ECO_TRACK_CSV)
		return read_layer(track, NULL, error);
	if (track->format != ECO_TRACK_GPX) {
		code = read_layer(track, NULL, error);
		keep_lines(track);
		return track->timed ? code : check_times(track, code, error);
	}
	for (int i = 0; !code && !track->count && i < 3; i++)
		code = read_layer(track, layers[i], error);
	if (!strstr(track->text, "</gpx>"))       /* GDAL is silent where a recorder's battery died */
		eco_track_note(track, "the file breaks off: %u points are read", track->records);
	return code;
}
