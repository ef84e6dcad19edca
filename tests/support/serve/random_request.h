/* Requests that nobody would think of, and the server's answers to them, for programs that look for
 * violations. A request depends on a seed and its number alone, so that one can be looked at again. */
#pragma once

#include "server/store.h"
#include "server/stream.h"

struct dice { uint64_t state; };
uint64_t dice_bits(struct dice *r);
/* Each power of ten as likely. */
double dice_power(struct dice *r, double low, double high);

/* Ends the program with status 2. */
_Noreturn void random_stop(const char *what, const struct eco_error *error);

/* False where the request layer refuses the view. */
bool random_request(struct eco_request *request, const struct eco_scene *scene, uint64_t seed,
	uint64_t number);

/* A likely view: a place in the scene, from 4 m to twice the scene's size away, from level to
 * nearly above, 800 x 600. */
struct eco_view random_outlook(const struct eco_scene *scene, uint64_t seed, uint64_t number);

/* The body of the answer, which the caller frees; false: 204. `work_max`: as struct srv_stream_input. */
bool random_answer(const struct srv_scene *scene, const struct eco_request *request,
	const struct eco_holdings *holdings, uint64_t work_max, struct srv_body *body);
