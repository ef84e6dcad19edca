/* The counted work of an ordinary request to a scene, which bounds that of any request: the median of a few
 * fixed requests, with eyes and targets anywhere in and around the scene, and pictures and budgets of any
 * size. It depends on the pack alone; a multiple of it cuts all servers' plans at the same place. */
#ifndef SRV_TYPICAL_H
#define SRV_TYPICAL_H

#include "server/store.h"

/* Work of the median request (struct lod_planner_stats), found at the first call, which takes about
 * SRV_TYPICAL_REQUESTS ordinary plans. Random requests to a wide scene mostly see little of it, and those
 * that see all need more than a few times that (lod/EXPERIMENTS.md, Wide scenes from the air). Therefore it
 * is at least a look at each plant, from SRV_TYPICAL_WORK_LEAST (.7 milliseconds) to SRV_TYPICAL_WORK_WIDE.
 * Any thread. */
#define SRV_TYPICAL_REQUESTS 63u
#define SRV_TYPICAL_WORK_LEAST 100000u
#define SRV_TYPICAL_WORK_WIDE 1000000u
uint64_t srv_typical_work(struct srv_scene *scene);
/* The same; 0: *cancelled was set meanwhile, and it was not found. */
uint64_t srv_typical_find(struct srv_scene *scene, const atomic_bool *cancelled);
/* Finds that of all scenes of a store. */
bool srv_typical_find_all(const struct srv_store *store, const atomic_bool *cancelled);

#endif
