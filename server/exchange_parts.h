/* What the files of an exchange share: exchange.c receives and sends, exchange_plan.c makes plans and streams,
 * exchange_direct.c answers what needs none. */
#ifndef SRV_EXCHANGE_PARTS_H
#define SRV_EXCHANGE_PARTS_H

#include "server/exchange.h"

/* A header of the request, or NULL. */
const char *srv_exchange_header(const struct srv_exchange *exchange, const char *name);
/* The path names the resource that a problem is about; NULL where it could not be parsed. */
const char *srv_exchange_path(const struct srv_exchange *exchange, char path[SRV_TARGET_BYTES_MAX]);

/* Makes exchange->answer a problem; `close`: the connection cannot be used again. */
void srv_exchange_problem(struct srv_exchange *exchange, enum srv_problem problem, const char *detail,
	bool close);
/* Lets preconditions count for exchange->answer, if there are any. */
void srv_exchange_judge(struct srv_exchange *exchange, const struct srv_validators *validators);

/* Reads the parameters and the body; true if there is something to plan, else an answer has been made. */
bool srv_exchange_prepare_plan(struct srv_exchange *exchange);
/* Hands it to a work thread, and suspends the connection until that is done. */
void srv_exchange_start_plan(struct srv_exchange *exchange);
/* Makes the answer of any other route. */
void srv_exchange_answer_direct(struct srv_exchange *exchange);

#endif
