/* A finished plant as bytes, and back: a cache keeps the result of minutes of work.
 *
 *   lod_plant_write(&writer, &plant);
 *   lod_plant_read(&again, bytes, size, &error);        equal to `plant` in every field but its name
 *
 * Little-endian. Records are those of a pack (pack_record.h); a varint is that of bytes.h; a delta is a
 * zigzag varint of the difference to the value before it, 0 before the first.
 *
 *   u32 x 7      numbers of anchors, ladders, curves, lists, colours, images, levels of an impostor
 *   .            PLANT record without a name, then ANCHORS, LADDERS, CURVES, PALETTE (3 bytes a colour),
 *                u32 an image
 *   .            per organ: u32 components, elements, triangles, f64 area
 *   u32 x .      triangles in, stored, dropped for each reason; per kind of search: runs, converged
 *   per list     LISTS record; u32 ends, elements, corners, primitives, values an element (extra_count);
 *                u8 flags: 1 with uv, 2 with exact positions
 *                ends: a varint each, the difference to the end before
 *                u8 corners of each element
 *                position: a delta each, to the same axis of the corner before; exact: a zigzag varint each,
 *                to the position; uv as position; extra: a delta to the same value of the element before
 *
 *   per level of the impostor: varint size, bytes; then, if there are levels, u8 how level leaves lie
 *
 * There is no version: the owner of such bytes knows the program that wrote them. */
#ifndef LOD_PLANT_BYTES_H
#define LOD_PLANT_BYTES_H

#include "ecofiles/base/bytes.h"
#include "lod/build/plant.h"

void lod_plant_write(struct eco_writer *writer, const struct lod_plant *plant);

/* Untrusted bytes: ECO_DAMAGED unless they are a plant (an index out of range, counts that do not add up,
 * bytes left over), so that the result may be measured and packed like a built plant. On failure *plant is
 * empty. Allocates at most a small multiple of `size`. */
enum eco_code lod_plant_read(struct lod_plant *plant, const uint8_t *bytes, size_t size,
	struct eco_error *error);

#endif
