#include "ecofiles/base/json_memory.h"

#include <jansson.h>
#include <stdlib.h>

static _Thread_local bool lost;

static void *allocate(size_t size)
{
	void *room = malloc(size);
	lost = lost || !room;
	return room;
}

void eco_json_watch(void)
{
	json_set_alloc_funcs(allocate, free);
}

bool eco_json_lost(void) { return lost; }
