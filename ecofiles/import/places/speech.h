/* The language of a table's columns, and where on Earth inventories are kept in it. Numbers alone do not tell
 * Lyon from the coast of Somalia, which has its latitude and longitude swapped, nor one country's grid from
 * another's: columns named "hauteur" and "essence" do. Rough boxes; they decide only what nothing else
 * decides. */
#ifndef ECO_SPEECH_H
#define ECO_SPEECH_H

#include <stdbool.h>
#include <stdint.h>

/* A bit for each language that most of the names are in; 0: none is known. */
uint32_t eco_speech_of(const char *const *names, uint32_t count);
/* "French"; of several the first. `languages` is not 0. */
const char *eco_speech_name(uint32_t languages);
/* Whether a place (longitude, latitude) lies where one of the languages is written; `home`: in the countries
 * that keep most of such inventories. */
bool eco_speech_reaches(uint32_t languages, const double degrees[2], bool home);

#endif
