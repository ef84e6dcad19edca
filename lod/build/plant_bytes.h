/* A finished plant as bytes, and back: what a cache keeps of minutes of work.
 *
 *   lod_plant_write(&writer, &plant);
 *   lod_plant_read(&again, bytes, size, &error);        equal to `plant` in every field but its name, which is its owner's
 *
 * Little-endian. Records are those of a pack (pack_record.h); a varint is that of bytes.h, a delta is a zigzag varint of the difference to
 * the value before it, 0 before the first.
 *
 *   u32 x 6      anchors, ladders, curves, lists, palette, images: how many there are
 *   .            PLANT record without a name, then ANCHORS, LADDERS, CURVES, PALETTE (3 bytes a colour), u32 an image
 *   .            per organ: u32 components, elements, triangles, f64 area
 *   u32 x .      triangles in, stored, dropped for each reason; per kind of search: runs, converged
 *   per list     LISTS record; u32 ends, elements, corners, primitives, values an element (extra_count); u8 1 where there is uv
 *                ends: a varint each, the difference to the end before
 *                u8 corners of each element
 *                position: a delta each, from the same axis of the corner before; uv alike; extra from the same value of the element before
 *
 * There is no version: who keeps such bytes knows which program wrote them. */
#ifndef LOD_PLANT_BYTES_H
#define LOD_PLANT_BYTES_H

#include "ecofiles/base/bytes.h"
#include "lod/build/plant.h"

void lod_plant_write(struct eco_writer *writer, const struct lod_plant *plant);

/* Bytes from anywhere: ECO_DAMAGED where they are no plant (any index out of range, counts that do not add up, bytes left over), so that
 * what is read may be measured and packed like what was built. On failure *plant is empty. Allocates at most some times `size`. */
enum eco_code lod_plant_read(struct lod_plant *plant, const uint8_t *bytes, size_t size, struct eco_error *error);

#endif
