/* A library of plants without files: growth by the parameters of a habit (words/habits.tsv), colours and blossom by
 * genus and season (words/looks.tsv), leaves by shape and size (words/leaves.tsv, genera.tsv).
 *
 *   struct eco_library_plant plant = { .habit = "vase", .height_m = 18, .crown_m = 9, .genus = "Zelkova" };
 *   eco_library_check(&plant, &error);
 *   eco_library_make(&model, &plant, &error);       eco_model_free(&model)
 *
 * The same plant is the same bytes on every machine (generate.h says why). */
#pragma once

#include "ecofiles/base/status.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/flora.h"

enum eco_season {
	ECO_SEASON_SUMMER,
	ECO_SEASON_AUTUMN,
	ECO_SEASON_WINTER,
	ECO_SEASON_SPRING,
	ECO_SEASON_COUNT
};
extern const char *const eco_season_names[ECO_SEASON_COUNT + 1]; /* ends with NULL */

#define ECO_LIBRARY_LEAST_M 0.02
#define ECO_LIBRARY_MOST_M 150.0
#define ECO_LIBRARY_BASE_MOST 0.95
#define ECO_LIBRARY_INDIVIDUALS 16u
#define ECO_LIBRARY_TRIANGLES_MAX 60000u

struct eco_library_plant {
	char habit[24]; /* as in habits.tsv */
	/* height; mean width of the crown, 0: usual for the habit */
	double height_m, crown_m;
	double base; /* lower end of the crown as a share of the height; 0: by the habit and the crown's width; to BASE_MOST */
	char genus[48]; /* any name with a genus, of which a species may differ; "": a plant of the habit's form */
	enum eco_season season;
	uint32_t individual; /* from 1; 0: 1 */
};

struct eco_habit {
	const char *name;
	enum eco_form like;
	double height_m, least_m, most_m; /* usual, least and greatest height */
	double young_m, crown, widest_m;  /* usual width: of a seedling, and a share of the height, up to so much */
	const char *grown;                /* the habit that is grown above most_m; NULL: the same */
};
/* The habit number i; false: there are no more. */
bool eco_library_habit(size_t i, struct eco_habit *habit);
/* The usual width of such a plant's crown. */
double eco_library_crown(const struct eco_habit *habit, double height_m);
/* The usual height of that habit; 0: there is none of that name. */
double eco_library_height(const char *habit);
/* The species if it looks otherwise than its genus (looks.tsv), else the genus; "": it is not known. */
const char *eco_library_taxon_of(const struct eco_flora *flora);
/* The habit of a plant of that species, genus or form; always one of the table. */
const char *eco_library_habit_of(const struct eco_flora *flora);

/* ECO_BAD_INPUT: no such habit (the error names all), a size that no plant has, an individual that is none. */
enum eco_code eco_library_check(const struct eco_library_plant *plant, struct eco_error *error);
/* The plant as a model with its organs: height exactly, crown as the mean width of its hull from above. Errors: those
 * of the check. The caller frees the model. */
enum eco_code eco_library_make(struct eco_model *model, const struct eco_library_plant *plant,
	struct eco_error *error);
