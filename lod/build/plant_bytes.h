/* A finished plant as bytes, and back: a cache keeps the result of minutes of work.
 *
 *   lod_plant_write(&writer, &plant);
 *   lod_plant_read(&again, bytes, size, &error);        equal to `plant` in every field but its name
 *
 * The bytes are memory of the program that wrote them, with integers of lists as differences in varints. Only
 * the same program may read them, unchanged: keys of the cache name it, and its entries have hashes. */
#ifndef LOD_PLANT_BYTES_H
#define LOD_PLANT_BYTES_H

#include "ecofiles/base/bytes.h"
#include "lod/build/plant.h"

void lod_plant_write(struct eco_writer *writer, const struct lod_plant *plant);

/* On failure, such as of bytes that are cut off, *plant is empty. */
enum eco_code lod_plant_read(struct lod_plant *plant, const uint8_t *bytes, size_t size,
	struct eco_error *error);

#endif
