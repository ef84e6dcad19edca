/* The planner of a published scene, for JavaScript: one scene an instance of the module. Requests and bodies are those
 * of ecoserve's .../stream and .../plan, from an index and the chunks' file.
 *
 *   planner_open(index, size)                 takes the bytes of an index
 *   planner_ask(target, holdings, size)       begins an answer
 *   while (planner_go() == PLANNER_WANTS)     JavaScript fetches what is wanted, to where it says
 *   planner_part(n)                           bytes of the body that are final once the first n wanted chunks are there
 *
 * Functions that return a status return one of HTTP's: 400 and more are faults, which planner_error describes. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define PLANNER_WANTS 100        /* lists of plants, without which the view cannot be planned */

/* 200; `index` is malloc'ed and the planner's from then on. */
int planner_open(uint8_t *index, size_t size);
const char *planner_error(void);
/* 200, or why the request is refused; `target`: as after GET, with its parameters. */
int planner_ask(const char *target, const uint8_t *holdings, size_t size);
/* 200: the body is planned and needs the chunks that are wanted; 204: nothing fits; PLANNER_WANTS. */
int planner_go(void);
/* Chunks in the order of the body: where they lie in the chunks' file, their bytes, where to put them. */
struct planner_wanted { double at, size, to; };
const struct planner_wanted *planner_wanted(void);
uint32_t planner_wanted_count(void);
/* The first `count` wanted chunks are there. Returns how many bytes of the body are final; -1: a fault. */
double planner_part(uint32_t count);
const uint8_t *planner_body(void);
/* The plan as JSON (openapi.yaml's Plan), of a request to .../plan; NULL: a fault. */
const char *planner_described(void);
/* Answers .../plants/{list} and .../find. `again`: what the call before wanted is there. 200: planner_body is the JSON,
 * and ends with a 0; PLANNER_WANTS; or why the request is refused. */
int planner_plants(const char *target, int again);
