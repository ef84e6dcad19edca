/* Real packs, written through the writer. */
#pragma once

#include "ecofiles/format/inventory.h"
#include "tests/support/scene_builder.h"

/* Two species (leaves, a point for each, and twigs; a textured bush), 400 plants in two tiles under a root
 * with a summary, ground. About 800 KB in 2,000 chunks, so that large budgets get coarse steps. `plain`:
 * bushes have no texture (the one they have is no picture). */
#define SAMPLE_PLANTS 100u           /* of each species in each tile */
enum eco_code sample_pack_write_on(const char *path, const struct eco_ground *ground, bool plain,
	struct eco_error *error);
/* On 16 x 16 samples: one tile. */
enum eco_code sample_pack_write(const char *path, struct eco_error *error);
/* The same with levels of these sizes, 1 MiB in all: the chunks of list SAMPLE_TEXTURE. */
#define SAMPLE_TEXTURE 3u
#define SAMPLE_LEVELS_MAX 8u
enum eco_code sample_pack_write_textured(const char *path, const uint32_t *sizes, uint32_t count,
	struct eco_error *error);

/* Every table and every kind of list in 8 KB: one plant with a cell, leaves in three forms, wood in two
 * levels, a texture, ground, a summary, instances in a tile of a nested eco file, their rows. `keep`: see
 * scene_write; without rows. Free *b with scene_free in any case. */
#define SMALL_PACK_PLANTS 7u
/* The small pack's places. */
extern const struct eco_inventory_row small_pack_rows[SMALL_PACK_PLANTS];
#define SMALL_PACK_META "{\"name\": \"small\"}"
enum eco_code small_pack_write(struct scene_builder *b, const char *path, struct eco_pack_writer **keep,
	struct eco_error *error);
/* Elements as it has them: spread over a small grid without a random source. */
struct eco_elements small_pack_elements(const struct eco_list *list, uint32_t count, uint8_t corners);
