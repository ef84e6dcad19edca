/* Bytes of the answer that carries a plan. */
#pragma once

#include <stdlib.h>

#include "ecofiles/format/wire_body.h"
#include "lod/plan/planner.h"
#include "tests/support/unit_test.h"

/* For a client that holds `held`, or NULL. */
static inline uint64_t plan_bytes(const struct eco_scene *scene, const struct eco_plan *plan,
	const struct eco_holdings *held)
{
	struct eco_wire_body body;
	struct eco_holdings needs;
	uint64_t bytes;
	assert_good(lod_plan_needs(scene, plan, &needs, &cause));
	assert_good(eco_wire_body_init(&body, scene, NULL, NULL, 0, &cause));
	assert_good(eco_wire_body_size(&body, held, plan, &needs, &bytes, &cause));
	eco_wire_body_free(&body);
	free(needs.items);
	return bytes;
}
