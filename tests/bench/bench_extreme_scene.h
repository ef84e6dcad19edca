/* Scenes for extreme cases: real plants, built once, packed into a scene that stands anywhere, served and drawn in this process.
 *
 *   stand = extreme_stand_shared(x)                        a tree, a bush and grass, 60 of them in four tiles with a summary above
 *   extreme_world_open(&world, &stand, &site, &error)      as a pack whose root places all of it by `site`
 *   extreme_site_view(&site, &view)                        a view of the stand where it would be at the origin -> in that world
 *   extreme_plan, extreme_draw                             what the server answers; what a viewer draws of it
 *   extreme_world_close(&world); extreme_stand_free(&stand) */
#ifndef TESTS_BENCH_EXTREME_SCENE_H
#define TESTS_BENCH_EXTREME_SCENE_H

#include "client-min/view_picture.h"
#include "ecofiles/base/bytes.h"
#include "lod/build/plant.h"
#include "lod/plan/planner.h"
#include "server/store.h"
#include "tests/bench/bench_extreme.h"

#define EXTREME_PLANTS 4u

struct extreme_place { uint32_t plant; double at[3]; uint16_t turn; double scale; };

struct extreme_stand {
	struct lod_plant plants[EXTREME_PLANTS];     uint32_t plant_count;
	struct extreme_place *places;                uint32_t place_count;
	double side;                                 /* m: a square around the origin, cut into four tiles */
	double near_m;
	bool summaries;
};

/* Where a stand is. plain: by the numbers of its tiles and lists, not by a transform. Zero: at the origin. */
struct extreme_site { double at[3]; uint16_t turn; double scale; bool plain; };

struct extreme_world { struct srv_store store; struct srv_scene *scene; };

/* Builds one more plant of a model, in an order that takes little time. */
enum eco_code extreme_stand_add(struct extreme_stand *stand, const struct eco_model *model, const char *name, struct eco_error *error);
bool extreme_stand_place(struct extreme_stand *stand, const struct extreme_place *place);
void extreme_stand_free(struct extreme_stand *stand);
/* The stand that all families share, made when first asked for, and never freed by them; NULL where it cannot be (x has failed then). */
const struct extreme_stand *extreme_stand_shared(struct extreme *x);

enum eco_code extreme_world_open(struct extreme_world *world, const struct extreme_stand *stand, const struct extreme_site *site,
	struct eco_error *error);
/* The shared stand where it is; false where that cannot be (x has failed then). Close *world in any case. */
bool extreme_world_shared(struct extreme *x, struct extreme_world *world);
void extreme_world_close(struct extreme_world *world);

struct eco_view extreme_site_view(const struct extreme_site *site, const struct eco_view *view);

/* From beside the stand: all of it in view, 400 x 300. */
struct eco_request extreme_request(uint64_t vertices);

enum eco_code extreme_plan(struct extreme_world *world, const struct eco_request *request, struct eco_plan *plan, struct lod_planner_stats *stats,
	struct eco_error *error);
/* The caller frees the picture; `request->bytes` is unbounded. */
enum eco_code extreme_draw(struct extreme_world *world, const struct eco_request *request, struct view_picture *picture, struct eco_error *error);

/* A plan as it travels; the caller frees the bytes. */
struct eco_writer extreme_plan_bytes(const struct eco_plan *plan);
bool extreme_same_bytes(const struct eco_writer *a, const struct eco_writer *b);

/* What every plan must be: in order, within the budget, and of finite numbers that make sense. */
bool extreme_plan_sound(struct extreme *x, const struct eco_plan *plan, const struct eco_request *request);
/* Share of pixels in which another plant is nearest, or none; or, where asked for, whose colour differs: haze is so many metres deep and
 * high, so that colours are not to be asked for where the metre or the height is another. */
double extreme_pixels_differ(const struct view_picture *a, const struct view_picture *b, bool colours);

/* Plans for this scene's tables and request, and checks the plan; false where it failed. The caller frees the plan. */
bool extreme_plan_of(struct extreme *x, const struct eco_scene *scene, const struct eco_request *request, struct eco_plan *plan);

#endif
