/* Scenes for cases at the edge of what numbers can say: real plants, built once, packed into a scene that
 * stands anywhere, served and drawn in this process.
 *
 *   stand = extreme_stand()                          a tree, a bush and grass, 60 of them in four tiles with
 *                                                    a summary above
 *   extreme_world_open(&world, stand, &site)         as a pack whose root places all of it by `site`; world =
 *                                                    extreme_world() at the origin
 *   extreme_site_view(&site, &view)                  a view of the stand where it would be at the origin ->
 *                                                    in that world
 *   extreme_plan, extreme_draw                       what the server answers; what a viewer draws of it
 *   extreme_world_close(&world); extreme_stand_free(&stand)
 *
 * A function that fails ends the test. */
#pragma once

#include "client-min/draw/view_picture.h"
#include "ecofiles/base/bytes.h"
#include "ecofiles/scene/scene.h"
#include "lod/build/plant.h"
#include "lod/eye.h"
#include "lod/plan/planner.h"
#include "server/store.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* A condition that must hold, and what to say if it does not. */
#define must_hold(holds, ...) \
	do { \
		if (!(holds)) \
			fail_msg(__VA_ARGS__); \
	} while (0)

#define EXTREME_PLANTS 4u
#define EXTREME_PLACES 60u
#define EXTREME_SIDE_M 40.0      /* of the shared stand: a square around the origin */

struct extreme_stand {
	struct lod_plant plants[EXTREME_PLANTS];     uint32_t plant_count;
	struct eco_source_instance places[EXTREME_PLACES];   uint32_t place_count;
};

/* Site of a stand. plain: by the numbers of its places, not by a transform. Zero: at the origin. */
struct extreme_site { double at[3]; uint16_t turn; double scale; bool plain; };

struct extreme_world { struct srv_store store; struct srv_scene *scene; };
static inline const struct eco_scene *extreme_tables(const struct extreme_world *world)
{
	return &world->scene->pack->scene;
}

/* Builds one more plant of a soup, in an order that takes little time, and frees the soup. */
enum eco_code extreme_stand_add(struct extreme_stand *stand, struct soup *soup, const char *name,
	struct eco_error *error);
void extreme_stand_place(struct extreme_stand *stand, const struct eco_source_instance *place);
void extreme_stand_free(struct extreme_stand *stand);
/* Made when first asked for, and never freed by tests. */
const struct extreme_stand *extreme_stand(void);
struct extreme_world *extreme_world(void);

void extreme_world_open(struct extreme_world *world, const struct extreme_stand *stand,
	const struct extreme_site *site);
void extreme_world_close(struct extreme_world *world);
/* Plant `index` of a group as the pack has it: on the grid of its list. */
struct lod_place extreme_placed(const struct extreme_world *world, uint32_t group, uint32_t index);

struct eco_view extreme_site_view(const struct extreme_site *site, const struct eco_view *view);
/* From beside the stand: all of it in view, 400 x 300. */
struct eco_request extreme_request(uint64_t vertices);

/* Plans for these tables, and checks that the plan is in order, within the budget, and of finite numbers that
 * make sense. The caller frees the plan; extreme_sound checks another's. */
void extreme_plan(const struct eco_scene *scene, const struct eco_request *request, struct eco_plan *plan);
void extreme_sound(const struct eco_plan *plan, const struct eco_request *request);
/* The same request must be answered by the same bytes, as it travels. Returns vertices and plants in view. */
struct extreme_look { uint64_t plants, vertices; };
struct extreme_look extreme_twice(const struct eco_scene *scene, const struct eco_request *request);

/* The caller frees the picture; `request->bytes` is unbounded. */
void extreme_draw(const struct extreme_world *world, const struct eco_request *request,
	struct view_picture *picture);
uint64_t extreme_covered(const struct view_picture *picture);
/* Share of pixels in which another plant is nearest, or none; or, where asked for, whose colour differs: haze
 * is so many metres deep and high, and the sun stands still, so that colours are not to be asked for where
 * the metre or the height is another, or the scene is turned. */
double extreme_pixels_differ(const struct view_picture *a, const struct view_picture *b, bool colours);
