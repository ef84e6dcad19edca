/* Plants by name, Latin or common, in some twenty languages: the genus, the form of growth, the leaves and
 * the height behind a species' name or a model's. For choosing models, for sizes that a table does not have,
 * and for doubting those that it has. The names stand in words/genera.tsv, names.tsv, species.tsv,
 * growth.tsv, codes.tsv and forms.tsv.
 *
 * The genus decides. An epithet is looked up within its genus alone, and a word that is a genus is never
 * taken for another that is spelt like it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum eco_form {
	ECO_FORM_UNKNOWN, ECO_FORM_BROAD, ECO_FORM_CONIFER, ECO_FORM_COLUMN, ECO_FORM_WEEPING, ECO_FORM_PALM,
	ECO_FORM_SHRUB, ECO_FORM_HERB, ECO_FORM_GRASS,
	ECO_FORM_NOTHING,        /* a vacant place, a stump, a rock: no plant */
	ECO_FORM_COUNT
};
extern const char *const eco_form_names[ECO_FORM_COUNT];

enum eco_leaf { ECO_LEAF_UNKNOWN, ECO_LEAF_EVERGREEN, ECO_LEAF_DECIDUOUS };

/* A common name may mean one plant here and another there: a sycamore is a plane in America, a maple in Europe. */
enum eco_region { ECO_REGION_UNKNOWN, ECO_REGION_AMERICA, ECO_REGION_EUROPE, ECO_REGION_AFRICA, ECO_REGION_ASIA,
	ECO_REGION_OCEANIA };
/* The region of a place in degrees; NaN: unknown. */
enum eco_region eco_region_of(double longitude, double latitude);

struct eco_flora {
	const char *genus;           /* "quercus"; NULL: not known */
	char epithet[32];            /* "robur"; "": not said */
	enum eco_form form;
	enum eco_leaf leaf;
	double height_m;             /* that it usually reaches; 0: not known */
	char misspelt[48];           /* the word that is not quite a genus, or an epithet; "": spelt well */
	const char *meant;           /* the word taken for it; NULL: the epithet */
	char coded[64];              /* the species that a code stands for; "": it is none */
};

struct eco_flora_hint {
	enum eco_region region;
	/* the system of codes that the column uses: of codes.tsv, or "letters": two or three letters of each
	 * word of a species, "fasy", "QUEROB"; NULL: none */
	const char *codes;
	bool spelling;               /* also words of five letters and more that are nearly a genus, epithet or common name */
};

/* The plant that a name means; hint NULL: nothing is known beside the name. */
struct eco_flora eco_flora_of(const char *name, const struct eco_flora_hint *hint);
/* The form that words about a plant say, "evergreen conifer", and its leaves; no names. */
enum eco_form eco_form_of(const char *text, enum eco_leaf *leaf);
/* Whether a text about a place says that no plant stands there: "vacant site", "Baumstumpf", "REMPLACE";
 * whole: and nothing else. */
bool eco_flora_is_no_plant(const char *text, bool whole);

/* Whether a genus is known to have a species of that epithet. */
bool eco_flora_has_epithet(const char *genus, const char *epithet);
/* The shape of a genus's leaves as genera.tsv names it, "needle", and their length; of a form where the genus
 * is unknown or NULL. */
const char *eco_flora_leaf(const char *genus, enum eco_form form, double *leaf_cm);
/* Whether a system has the code. */
bool eco_flora_has_code(const char *system, const char *code);
/* The i-th system; NULL: no more. */
const char *eco_flora_system(size_t i);

/* Heights in metres between which a full-grown plant of that form is usual, and a typical one. A plant of
 * unknown form may be anything that grows. */
struct eco_form_size { double least_m, most_m, typical_m; };
struct eco_form_size eco_form_size(enum eco_form form);
/* Whether a plant of one form may stand for one of the other: trees for trees, low plants for low ones. */
bool eco_form_is_tree(enum eco_form form);
