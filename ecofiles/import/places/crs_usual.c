/* CRSs that tables of plants are usually in, by codes of EPSG. PROJ's register has thousands, of which many mean the same
 * place on Earth or are for charts and mines. UTM zones are not here: they are told by their name. */
#include "ecofiles/import/places/crs_facts.h"

#include <stddef.h>

enum { REGION = 1, COUNTRY };    /* one of many grids of a country, or the one that most of its tables are in */

static const struct { uint32_t first, last, rank; } usual[] = {
	{ 31466, 31469, COUNTRY },                                       /* Germany: Gauss-Kruger */
	{ 31254, 31259, COUNTRY }, { 31287, 31287, COUNTRY },            /* Austria */
	{ 2056, 2056, COUNTRY }, { 21781, 21781, COUNTRY },              /* Switzerland */
	{ 2154, 2154, COUNTRY }, { 27572, 27572, COUNTRY }, { 3942, 3950, REGION },      /* France */
	{ 31370, 31370, COUNTRY }, { 3812, 3812, COUNTRY },              /* Belgium */
	{ 28992, 28992, COUNTRY }, { 2169, 2169, COUNTRY },              /* Netherlands, Luxembourg */
	{ 27700, 27700, COUNTRY }, { 29902, 29903, COUNTRY }, { 2157, 2157, COUNTRY },   /* Britain, Ireland */
	{ 3003, 3004, COUNTRY },                                         /* Italy */
	{ 3763, 3763, COUNTRY }, { 20790, 20791, COUNTRY }, { 27493, 27493, COUNTRY },   /* Portugal */
	{ 2180, 2180, COUNTRY }, { 2176, 2179, REGION },                 /* Poland */
	{ 5514, 5514, COUNTRY }, { 23700, 23700, COUNTRY },              /* Czechia and Slovakia, Hungary */
	{ 3794, 3794, COUNTRY }, { 3912, 3912, COUNTRY }, { 3765, 3765, COUNTRY },       /* Slovenia, Croatia */
	{ 3844, 3844, COUNTRY }, { 7801, 7801, COUNTRY },                /* Romania, Bulgaria */
	{ 2100, 2100, COUNTRY }, { 5253, 5259, REGION },                 /* Greece, Turkey */
	{ 3006, 3006, COUNTRY }, { 3021, 3021, COUNTRY }, { 3007, 3024, REGION },        /* Sweden */
	{ 3067, 3067, COUNTRY }, { 3873, 3885, REGION }, { 2391, 2394, REGION },         /* Finland */
	{ 5105, 5130, REGION }, { 3057, 3057, COUNTRY }, { 8088, 8088, COUNTRY },        /* Norway, Iceland */
	{ 3301, 3301, COUNTRY }, { 3059, 3059, COUNTRY }, { 3346, 3346, COUNTRY },       /* Estonia, Latvia, Lithuania */
	{ 2222, 2289, REGION }, { 3417, 3459, REGION }, { 26929, 26998, REGION },        /* United States: state planes */
	{ 32100, 32161, REGION },
	{ 2945, 2960, REGION }, { 3005, 3005, REGION }, { 3347, 3347, REGION }, { 3400, 3403, REGION },  /* Canada */
	{ 3978, 3978, REGION }, { 32181, 32198, REGION },
	{ 6372, 6372, COUNTRY }, { 9377, 9377, COUNTRY }, { 3116, 3116, REGION },        /* Mexico, Colombia */
	{ 5880, 5880, COUNTRY }, { 5343, 5349, REGION },                 /* Brazil, Argentina */
	{ 2193, 2193, COUNTRY }, { 27200, 27200, COUNTRY },              /* New Zealand */
	{ 2039, 2039, COUNTRY }, { 2046, 2055, REGION },                 /* Israel, South Africa */
	{ 2443, 2461, REGION }, { 6669, 6687, REGION },                  /* Japan */
	{ 5179, 5179, COUNTRY }, { 5185, 5188, REGION },                 /* Korea */
	{ 2326, 2326, COUNTRY }, { 3414, 3414, COUNTRY }, { 3826, 3826, COUNTRY },       /* Hong Kong, Singapore, Taiwan */
};

uint32_t eco_crs_usual(uint32_t epsg)
{
	for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
		if (epsg >= usual[i].first && epsg <= usual[i].last)
			return usual[i].rank;
	return 0;
}
