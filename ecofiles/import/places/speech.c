#include "ecofiles/import/places/speech.h"

#include <stddef.h>

#include "ecofiles/import/places/words.h"

#define LEAST_WORDS 2u           /* one may be a name */

enum language { GERMAN, FRENCH, SPANISH, ITALIAN, PORTUGUESE, DUTCH, POLISH, CZECH, SWEDISH, DANISH,
	NORWEGIAN, ENGLISH, LANGUAGES };

/* Words of columns, as eco_words_of writes them. */
static const struct { const char *name, *words; } speech[LANGUAGES] = {
	[GERMAN] = { "German",
		"baum baumart baumhohe baumhoehe baumnummer hohe hoehe umfang stammumfang durchmesser "
		"stammdurchmesser kronendurchmesser krone gattung art pflanzjahr standort strasse "
		"bezirk stadtteil lange laenge breite ostwert nordwert rechtswert hochwert deutsch "
		"botanisch" },
	[FRENCH] = { "French",
		"hauteur essence espece circonference circonf diametre genre libelle arbre arbres "
		"adresse commune quartier tronc houppier nom longitude latitude annee plantation "
		"francais" },
	[SPANISH] = { "Spanish",
		"altura especie nombre perimetro circunferencia diametro longitud latitud calle "
		"barrio distrito copa arbol arboles tronco cientifico comun este norte municipio" },
	[ITALIAN] = { "Italian",
		"altezza specie genere nome albero alberi chioma diametro circonferenza via "
		"longitudine latitudine comune tronco fusto quartiere indirizzo scientifico" },
	[PORTUGUESE] = { "Portuguese",
		"altura especie nome dap arvore arvores rua bairro copa circunferencia cientifico "
		"popular longitude latitude municipio tronco" },
	[DUTCH] = { "Dutch",
		"boom boomsoort boomhoogte hoogte stamdiameter stamomtrek omtrek soort soortnaam "
		"straat wijk kroon lengtegraad breedtegraad plantjaar aanlegjaar gemeente standplaats "
		"nederlandse" },
	[POLISH] = { "Polish",
		"gatunek wysokosc obwod srednica drzewo drzewa ulica dzielnica dlugosc szerokosc "
		"korona rodzaj nazwa pnia" },
	[CZECH] = { "Czech",
		"druh vyska obvod prumer strom stromy taxon ulice kmene kmen koruna sirka delka nazev" },
	[SWEDISH] = { "Swedish",
		"hojd tradart trad omkrets stamomkrets stamdiameter slag krona gata" },
	[DANISH] = { "Danish",
		"hojde trae traeart omkreds stammeomkreds diameter krone vej kommune" },
	[NORWEGIAN] = { "Norwegian",
		"hoyde tre treslag omkrets stammeomkrets diameter krone gate kommune" },
	[ENGLISH] = { "English",
		"species height trunk diameter girth street address site common botanical scientific "
		"name condition tree crown canopy spread dbh longitude latitude date planted park "
		"ward genus" },
};

static const struct { enum language language; bool home; double west, south, east, north; } boxes[] = {
	{ GERMAN, true, 5.5, 47.2, 15.1, 55.3 }, { GERMAN, true, 5.9, 45.8, 17.2, 49.1 },
	{ FRENCH, true, -5.5, 42.2, 8.3, 49.2 }, { FRENCH, true, 1.5, 49.2, 6.6, 51.6 },
	{ FRENCH, true, 8.5, 41.3, 9.7, 43.1 },
	{ FRENCH, true, -80, 44, -57, 63 }, { FRENCH, false, -18, -5, 31, 37.6 },
	{ FRENCH, false, 11, -13.5, 31, 5.5 }, { FRENCH, false, 42, -26, 60, -10 },
	{ FRENCH, false, 41.5, 10.8, 43.5, 12.8 }, { FRENCH, false, -63, 2, -51, 18.6 },
	{ FRENCH, false, 158, -24, 172, -18 }, { SPANISH, true, -18.5, 27.5, 4.5, 44 },
	{ SPANISH, true, -118.5, -56, -53, 33 }, { ITALIAN, true, 6.5, 35.4, 18.6, 47.2 },
	{ PORTUGUESE, true, -31.5, 32, -6, 42.2 }, { PORTUGUESE, true, -74, -34, -34, 5.5 },
	{ PORTUGUESE, false, 11, -27.5, 41, -4 }, { DUTCH, true, 2.4, 49.4, 7.3, 53.7 },
	{ DUTCH, false, -70, 1.8, -53, 13 }, { POLISH, true, 14, 49, 24.2, 55 },
	{ CZECH, true, 12, 47.7, 22.6, 51.1 }, { SWEDISH, true, 10.5, 55, 31.6, 70.1 },
	{ DANISH, true, 8, 54.5, 15.3, 57.8 }, { DANISH, false, -55, 59.5, -6, 84 },
	{ NORWEGIAN, true, 4.5, 57.9, 31.2, 80.9 }, { ENGLISH, true, -168, 18.5, -52, 72 },
	{ ENGLISH, true, -10.7, 49.8, 1.9, 61 }, { ENGLISH, true, 112, -44, 154, -10 },
	{ ENGLISH, true, 166, -47.5, 179, -34 },
	/* in English inventories are kept anywhere; but in the Indian Ocean, where Britain lies if swapped */
	{ ENGLISH, false, -180, -60, 49, 75 }, { ENGLISH, false, 61, -60, 180, 75 },
	{ ENGLISH, false, 49, 2, 61, 75 }, { ENGLISH, false, 49, -60, 61, -11 },
	{ ENGLISH, false, 55, -5, 56.5, -3.5 },
};

uint32_t eco_speech_of(const char *const *names, uint32_t count)
{
	uint32_t known[LANGUAGES] = { 0 }, most = LEAST_WORDS, languages = 0;
	for (uint32_t i = 0; i < count; i++) {
		char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
		eco_words_of(names[i], words, sizeof words);
		for (const char *at = words; eco_words_next(&at, word);)
			for (int l = 0; l < LANGUAGES; l++)
				known[l] += eco_words_have(speech[l].words, word);
	}
	for (int l = 0; l < LANGUAGES; l++)
		most = known[l] > most ? known[l] : most;
	for (int l = 0; l < LANGUAGES; l++)
		languages |= known[l] == most ? UINT32_C(1) << l : 0;
	return languages;
}

const char *eco_speech_name(uint32_t languages)
{
	return speech[__builtin_ctz(languages)].name;
}

bool eco_speech_reaches(uint32_t languages, const double degrees[2], bool home)
{
	for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++)
		if ((languages >> boxes[i].language & 1) && (boxes[i].home || !home)
				&& degrees[0] >= boxes[i].west && degrees[0] <= boxes[i].east
				&& degrees[1] >= boxes[i].south && degrees[1] <= boxes[i].north)
			return true;
	return false;
}
