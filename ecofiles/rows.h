/* A table being read row by row: what every inventory format is reduced to. A further format implements `next` and `close` and is
 * chosen in eco_rows_open. */
#ifndef ECO_ROWS_H
#define ECO_ROWS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/positions.h"

#define ECO_ROW_BYTES_MAX (1u << 20)
#define ECO_COLUMNS_MAX 4096u

struct eco_rows {
	/* Sets fields, field_count, row and line; *more is false, and nothing else set, after the last row. */
	enum eco_code (*next)(struct eco_rows *rows, bool *more, struct eco_error *error);
	void (*close)(struct eco_rows *rows);
	char **columns;              /* names, as written */
	uint32_t column_count;
	const char **fields;         /* of the current row, ended by 0; valid until the next call */
	uint32_t field_count;
	uint64_t row, line;          /* data rows from 1; line of the file where the row begins, from 1 */
};

/* Opens by the file's extension; today everything is taken for CSV. */
enum eco_code eco_rows_open(struct eco_rows **rows, const struct eco_positions_spec *spec, struct eco_error *error);
void eco_rows_close(struct eco_rows *rows);

/* CSV (RFC 4180): first row names the columns; fields may be quoted and then hold separators, line breaks and doubled quotes; lines
 * end in LF or CRLF; a byte order mark is passed over, and so are empty lines. Memory: one row. */
enum eco_code eco_rows_open_csv(struct eco_rows **rows, const char *path, char separator, struct eco_error *error);

/* glTF and GLB: a row for each instance (EXT_mesh_gpu_instancing), or, in files without, for each node that has a mesh. Columns: x, y, z
 * (metres, Z up), name (of the node, else of its mesh), mesh, yaw_deg (of the turn about the vertical), scale (the cube root of that of
 * volumes; none of quantized meshes), height_m (of the mesh, so placed; none where the file does not say its bounds); then scalar attributes of instances and "extras" of nodes, by their names. Line is row. */
enum eco_code eco_rows_open_gltf(struct eco_rows **rows, const char *path, struct eco_error *error);

#endif
