/* Pictures as files of the folder that -o names. */
#ifndef VIEW_SAVE_H
#define VIEW_SAVE_H

#include "ecofiles/format/image.h"

/* Makes the folder, and those that it lies in, where they are missing. */
enum eco_code view_save_dir(const char *dir, struct eco_error *error);

/* Writes DIR/NAME, a PNG; `format` makes the name of the frame's number. */
enum eco_code view_save(const char *dir, const char *format, uint32_t frame, const struct eco_pixels *pixels,
	struct eco_error *error) __attribute__((format(printf, 2, 0)));

#endif
