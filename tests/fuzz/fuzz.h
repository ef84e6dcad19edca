/* Fuzz targets, each with a folder of seeds: tests/fuzz/corpus/NAME. A violation ends the program. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define FUZZ_TARGETS(X) X(camera) X(chunk) X(framing) X(gltf) X(holdings) X(impostor) X(obj) X(pack) X(request) \
	X(rows) X(scene) X(stream) X(texture) X(track)

#define FUZZ_DECLARE(name) void fuzz_##name(const uint8_t *bytes, size_t size);
FUZZ_TARGETS(FUZZ_DECLARE)
