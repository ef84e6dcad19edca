/* Where the time of a build goes, and how much memory each stage took: for `ecopack make --times`. Nothing of it goes into the pack. */
#ifndef ECO_MAIN_TIMES_H
#define ECO_MAIN_TIMES_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum main_stage {
	MAIN_STAGE_NONE,
	MAIN_STAGE_SCENE,            /* scene files, inventories opened */
	MAIN_STAGE_GROUND,
	MAIN_STAGE_MODELS,           /* the readers' own time and memory included */
	MAIN_STAGE_CACHE,            /* plants of earlier builds */
	MAIN_STAGE_ELEMENTS,         /* welding, organs, elements */
	MAIN_STAGE_ORDERS,
	MAIN_STAGE_LISTS,            /* cells, points, lines, levels */
	MAIN_STAGE_CURVES,           /* scales s_opt, and how fine a grid must be */
	MAIN_STAGE_TEXTURES,
	MAIN_STAGE_PACKING,          /* plants' lists */
	MAIN_STAGE_POSITIONS,
	MAIN_STAGE_TILES,            /* the tile tree and its instance lists */
	MAIN_STAGE_SUMMARIES,
	MAIN_STAGE_WRITING,
	MAIN_STAGE_COUNT
};

/* From now on the calling thread works on this, until it says otherwise. Threads that work on a stage at once add up. */
void main_times_stage(enum main_stage stage);
enum main_stage main_times_now(void);        /* of the calling thread */

/* Memory by stage needs the kernel's peak to be reset between stages, after which other tools read too little: only if asked for. */
void main_times_memory(bool wanted);

/* How many plants were in the cache (a folder; "": there is none) and how many were not, and how many lists came from the pack that is
 * replaced: for the lines under the table. */
void main_times_cache(const char *folder, uint64_t hits, uint64_t misses, uint64_t lists);

/* A table: elapsed and processor seconds by stage, and the most memory while it ran. */
void main_times_print(FILE *out);

/* Since the first stage: seconds by the clock, and the most memory of this process and of any of its readers, in MB. */
void main_times_total(double *elapsed_s, double *most_mb);

#endif
