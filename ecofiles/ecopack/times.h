/* Time and memory of a build by stage, for `ecopack make --times`. Nothing of it goes into the pack. */
#ifndef ECO_MAIN_TIMES_H
#define ECO_MAIN_TIMES_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum main_stage {
	MAIN_STAGE_NONE,
	MAIN_STAGE_SCENE,            /* scene files, inventories opened */
	MAIN_STAGE_GROUND,
	MAIN_STAGE_MODELS,           /* with time and memory of the child processes */
	MAIN_STAGE_CACHE,            /* plants of earlier builds */
	MAIN_STAGE_ELEMENTS,         /* welding, organs, elements */
	MAIN_STAGE_ORDERS,
	MAIN_STAGE_LISTS,            /* cells, points, lines, levels */
	MAIN_STAGE_SPLATS,           /* fitted to whole plants */
	MAIN_STAGE_CURVES,           /* scales s_opt, and fineness of grids */
	MAIN_STAGE_TEXTURES,
	MAIN_STAGE_PACKING,          /* the plants' lists */
	MAIN_STAGE_POSITIONS,
	MAIN_STAGE_TILES,            /* the tile tree and its instance lists */
	MAIN_STAGE_SUMMARIES,
	MAIN_STAGE_WRITING,
	MAIN_STAGE_COUNT
};

/* Sets the calling thread's stage from now on. Times of threads in one stage add up. */
void main_times_stage(enum main_stage stage);
enum main_stage main_times_now(void);        /* of the calling thread */

/* Memory by stage resets the kernel's peak between stages, so that other tools read too little: only if
 * asked for. */
void main_times_memory(bool wanted);

/* Plants found in the cache (a folder; "": none), and plants not found: for the line under the table. */
void main_times_cache(const char *folder, uint64_t hits, uint64_t misses);

/* A table: elapsed and processor seconds by stage, and the most memory while it ran. */
void main_times_print(FILE *out);

/* Since the first stage: seconds by the clock, and greatest memory of this process and of any child, in
 * MB. */
void main_times_total(double *elapsed_s, double *most_mb);

#endif
