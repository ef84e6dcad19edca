#include "ecofiles/import/places/flora.h"

#include <stdio.h>
#include <string.h>

#include "ecofiles/import/places/words.h"

const char *const eco_form_names[ECO_FORM_COUNT] = { "plant", "broad-leaved tree", "conifer", "column",
	"weeping tree", "palm", "shrub", "herb", "grass", "no plant" };

/* ---- Genera ---- */

/* Common names as words without marks (words.h): English, German, French, Spanish, Italian, Dutch; of the
 * commonest also Portuguese, Polish, Czech, Swedish and Russian. */
static const struct { const char *genus; enum eco_form form; const char *names; } genera[] = {
	{ "quercus", ECO_FORM_BROAD, "oak eiche chene roble encina quercia eik zomereik wintereik "
		"carvalho dab dub ek дуб" },
	{ "acer", ECO_FORM_BROAD, "maple ahorn erable arce acero esdoorn boxelder sycamore bordo klon "
		"javor lonn клен" },
	{ "tilia", ECO_FORM_BROAD, "linden basswood lime linde tilleul tilo tiglio lipa lind липа" },
	{ "fagus", ECO_FORM_BROAD, "beech buche hetre haya faggio beuk faia buk бук" },
	{ "fraxinus", ECO_FORM_BROAD, "ash esche frene fresno frassino freixo jesion jasan ясень" },
	{ "platanus", ECO_FORM_BROAD, "plane planetree platane platano plataan platan платан" },
	{ "betula", ECO_FORM_BROAD, "birch birke bouleau abedul betulla berk vidoeiro brzoza briza bjork "
		"береза" },
	{ "aesculus", ECO_FORM_BROAD, "horsechestnut buckeye rosskastanie marronnier castano "
		"ippocastano kasztanowiec jirovec каштан" },
	{ "castanea", ECO_FORM_BROAD, "chestnut kastanie edelkastanie chataignier castagno kastanje" },
	{ "ulmus", ECO_FORM_BROAD, "elm ulme orme olmo iep wiaz jilm alm вяз" },
	{ "carpinus", ECO_FORM_BROAD, "hornbeam hainbuche charme carpe carpino haagbeuk grab habr avenbok "
		"граб" },
	{ "ostrya", ECO_FORM_BROAD, "hophornbeam ironwood" },
	{ "alnus", ECO_FORM_BROAD, "alder erle aulne aliso ontano els amieiro olsza olse ольха" },
	{ "populus", ECO_FORM_BROAD, "poplar aspen cottonwood pappel peuplier chopo alamo pioppo "
		"populier tremble choupo topola topol osika asp тополь осина" },
	{ "salix", ECO_FORM_WEEPING, "willow weide saule sauce salice wilg salgueiro wierzba vrba pil "
		"ива верба" },
	{ "robinia", ECO_FORM_BROAD, "locust robinie robinier falsa akat акация" },
	{ "gleditsia", ECO_FORM_BROAD, "honeylocust gleditschie fevier" },
	{ "prunus", ECO_FORM_BROAD, "cherry plum kirsche pflaume cerisier prunier cerezo ciliegio kers "
		"cerejeira ameixeira wisnia czeremcha sliwa tresen slivon korsbar "
		"вишня черемуха слива" },
	{ "malus", ECO_FORM_BROAD, "apple crabapple apfel pommier manzano melo appel macieira jablon "
		"яблоня" },
	{ "pyrus", ECO_FORM_BROAD, "pear birne poirier peral pero peer pereira grusza hrusen груша" },
	{ "sorbus", ECO_FORM_BROAD, "rowan whitebeam eberesche vogelbeere sorbier serbal sorbo "
		"lijsterbes jarzab jarzebina jerab ronn рябина" },
	{ "crataegus", ECO_FORM_SHRUB, "hawthorn weissdorn aubepine espino biancospino meidoorn glog "
		"hloh hagtorn" },
	{ "juglans", ECO_FORM_BROAD, "walnut butternut walnuss noyer nogal noce walnoot nogueira orzech "
		"oresak орех" },
	{ "carya", ECO_FORM_BROAD, "hickory pecan" },
	{ "liriodendron", ECO_FORM_BROAD, "tuliptree tulpenbaum tulipier" },
	{ "liquidambar", ECO_FORM_BROAD, "sweetgum amberbaum copalme" },
	{ "nyssa", ECO_FORM_BROAD, "tupelo blackgum" },
	{ "magnolia", ECO_FORM_BROAD, "magnolia magnolie" },
	{ "catalpa", ECO_FORM_BROAD, "catalpa trompetenbaum" },
	{ "celtis", ECO_FORM_BROAD, "hackberry zurgelbaum micocoulier almez" },
	{ "zelkova", ECO_FORM_BROAD, "zelkova zelkove" },
	{ "ginkgo", ECO_FORM_BROAD, "ginkgo ginko maidenhair" },
	{ "ailanthus", ECO_FORM_BROAD, "ailanthus gotterbaum ailante ailanto" },
	{ "gymnocladus", ECO_FORM_BROAD, "coffeetree" },
	{ "morus", ECO_FORM_BROAD, "mulberry maulbeere murier morera gelso" },
	{ "cercis", ECO_FORM_BROAD, "redbud judasbaum" },
	{ "cornus", ECO_FORM_SHRUB, "dogwood hartriegel cornouiller cornejo kornoelje" },
	{ "amelanchier", ECO_FORM_SHRUB, "serviceberry felsenbirne amelanchier" },
	{ "sophora", ECO_FORM_BROAD, "pagodatree schnurbaum" },
	{ "styphnolobium", ECO_FORM_BROAD, "scholartree" },
	{ "koelreuteria", ECO_FORM_BROAD, "goldenraintree blasenesche" },
	{ "paulownia", ECO_FORM_BROAD, "paulownia blauglockenbaum" },
	{ "eucalyptus", ECO_FORM_BROAD, "eucalyptus gumtree eukalyptus eucalipto" },
	{ "ficus", ECO_FORM_BROAD, "fig feige figuier higuera" },
	{ "olea", ECO_FORM_BROAD, "olive olivier olivo" },
	{ "citrus", ECO_FORM_BROAD, "orange naranjo oranger arancio" },
	{ "jacaranda", ECO_FORM_BROAD, "jacaranda" },
	{ "melia", ECO_FORM_BROAD, "chinaberry" },
	{ "callistemon", ECO_FORM_SHRUB, "bottlebrush zylinderputzer" },
	{ "lagerstroemia", ECO_FORM_SHRUB, "crapemyrtle" },
	{ "pinus", ECO_FORM_CONIFER, "pine kiefer fohre pin pino den pinheiro sosna borovice skogstall fyr "
		"сосна" },
	{ "picea", ECO_FORM_CONIFER, "spruce fichte epicea abete spar swierk smrk rodgran ель" },
	{ "abies", ECO_FORM_CONIFER, "fir tanne sapin abeto jodla jedle пихта" },
	{ "pseudotsuga", ECO_FORM_CONIFER, "douglasfir douglas douglasie" },
	{ "larix", ECO_FORM_CONIFER, "larch larche meleze alerce larice lork modrzew modrin "
		"лиственница" },
	{ "tsuga", ECO_FORM_CONIFER, "hemlock" },
	{ "cedrus", ECO_FORM_CONIFER, "cedar zeder cedre cedro ceder" },
	{ "taxus", ECO_FORM_CONIFER, "yew eibe tejo tasso taxus teixo idegran" },
	{ "thuja", ECO_FORM_COLUMN, "arborvitae lebensbaum thuya tuya zywotnik zerav tuja туя" },
	{ "chamaecyparis", ECO_FORM_COLUMN, "falsecypress scheinzypresse" },
	{ "juniperus", ECO_FORM_COLUMN, "juniper wacholder genevrier enebro ginepro zimbro jalowiec "
		"можжевельник" },
	{ "cupressus", ECO_FORM_COLUMN, "cypress zypresse cypres cipres cipresso" },
	{ "sequoia", ECO_FORM_CONIFER, "redwood sequoia" },
	{ "sequoiadendron", ECO_FORM_CONIFER, "mammutbaum" },
	{ "metasequoia", ECO_FORM_CONIFER, "urweltmammutbaum" },
	{ "taxodium", ECO_FORM_CONIFER, "baldcypress sumpfzypresse" },
	{ "araucaria", ECO_FORM_CONIFER, "araucaria araukarie" },
	{ "phoenix", ECO_FORM_PALM, "datepalm palm palme palmier palmera palma palmeira" },
	{ "washingtonia", ECO_FORM_PALM, "fanpalm" },
	{ "trachycarpus", ECO_FORM_PALM, "hanfpalme" },
	{ "cocos", ECO_FORM_PALM, "coconut kokospalme cocotier" },
	{ "syagrus", ECO_FORM_PALM, "queenpalm" },
	{ "lindera", ECO_FORM_SHRUB, "spicebush" },
	{ "hamamelis", ECO_FORM_SHRUB, "witchhazel zaubernuss" },
	{ "corylus", ECO_FORM_SHRUB, "hazel hasel noisetier avellano nocciolo hazelaar leszczyna liska" },
	{ "syringa", ECO_FORM_SHRUB, "lilac flieder lilas sering lilak serik syren сирень" },
	{ "sambucus", ECO_FORM_SHRUB, "elder elderberry holunder sureau sauco" },
	{ "laburnum", ECO_FORM_BROAD, "goldregen cytise" },
	{ "viburnum", ECO_FORM_SHRUB, "viburnum schneeball viorne" },
	{ "ilex", ECO_FORM_SHRUB, "holly stechpalme houx acebo agrifoglio hulst" },
	{ "rhododendron", ECO_FORM_SHRUB, "azalea rhododendron" },
	{ "buxus", ECO_FORM_SHRUB, "boxwood buchsbaum buis boj" },
	{ "ligustrum", ECO_FORM_SHRUB, "privet liguster troene" },
	{ "rosa", ECO_FORM_SHRUB, "rose rosier rosal" },
};

/* Species that inventories of woods give by codes. */
static const struct { const char *genus, *epithets; } coded[] = {
	{ "abies", "alba amabilis balsamea concolor fraseri grandis lasiocarpa magnifica nordmanniana "
		"procera" },
	{ "acer", "campestre circinatum glabrum macrophyllum negundo nigrum pensylvanicum platanoides "
		"pseudoplatanus rubrum saccharinum saccharum spicatum" },
	{ "aesculus", "flava glabra hippocastanum" },
	{ "alnus", "glutinosa incana rubra viridis" },
	{ "amelanchier", "arborea laevis" },
	{ "betula", "alleghaniensis lenta nigra papyrifera pendula populifera pubescens" },
	{ "carpinus", "betulus caroliniana" },
	{ "carya", "cordiformis glabra illinoinensis laciniosa ovalis ovata tomentosa" },
	{ "castanea", "dentata sativa" },
	{ "celtis", "laevigata occidentalis" },
	{ "cercis", "canadensis siliquastrum" },
	{ "cornus", "florida mas sanguinea" },
	{ "corylus", "americana avellana colurna" },
	{ "crataegus", "laevigata monogyna" },
	{ "fagus", "grandifolia sylvatica" },
	{ "fraxinus", "americana angustifolia excelsior nigra ornus pennsylvanica quadrangulata" },
	{ "hamamelis", "virginiana" },
	{ "ilex", "aquifolium opaca" },
	{ "juglans", "cinerea nigra regia" },
	{ "juniperus", "communis occidentalis scopulorum virginiana" },
	{ "larix", "decidua kaempferi laricina occidentalis" },
	{ "lindera", "benzoin" },
	{ "liquidambar", "styraciflua" },
	{ "liriodendron", "tulipifera" },
	{ "magnolia", "acuminata grandiflora virginiana" },
	{ "malus", "sylvestris" },
	{ "nyssa", "aquatica sylvatica" },
	{ "ostrya", "carpinifolia virginiana" },
	{ "picea", "abies engelmannii glauca mariana omorika pungens rubens sitchensis" },
	{ "pinus", "albicaulis banksiana cembra contorta echinata halepensis jeffreyi lambertiana "
		"monticola mugo nigra palustris pinaster ponderosa resinosa rigida strobus sylvestris "
		"taeda virginiana" },
	{ "platanus", "acerifolia occidentalis orientalis" },
	{ "populus", "alba deltoides grandidentata nigra tremula tremuloides trichocarpa" },
	{ "prunus", "avium padus pensylvanica serotina spinosa virginiana" },
	{ "pseudotsuga", "menziesii" },
	{ "pyrus", "pyraster" },
	{ "quercus", "agrifolia alba bicolor cerris coccinea falcata garryana ilex imbricaria lobata "
		"macrocarpa michauxii montana muehlenbergii nigra palustris petraea phellos prinus "
		"pubescens robur rubra stellata suber velutina" },
	{ "robinia", "pseudoacacia" },
	{ "salix", "alba babylonica caprea fragilis nigra" },
	{ "sambucus", "nigra" },
	{ "sequoia", "sempervirens" },
	{ "sorbus", "americana aria aucuparia domestica torminalis" },
	{ "taxodium", "distichum" },
	{ "taxus", "baccata brevifolia" },
	{ "thuja", "occidentalis plicata" },
	{ "tilia", "americana cordata platyphyllos tomentosa" },
	{ "tsuga", "canadensis heterophylla mertensiana" },
	{ "ulmus", "alata americana glabra laevis minor rubra" },
	{ "viburnum", "lantana opulus prunifolium" },
};

/* Words for a place where a plant was, or is to be. */
#define GONE "vacant stump stumps snag empty removed unbesetzt leer stumpf baumstumpf wurzelstock " \
	"stubben gefallt souche vide abattu tocon vacio alcorque ceppo vuoto stronk stobbe deadwood"

/* Words for forms, where no genus is named. */
static const struct { enum eco_form form; const char *words; } forms[] = {
	{ ECO_FORM_NOTHING, GONE " rock stone boulder log fels stein rocher piedra" },
	{ ECO_FORM_CONIFER, "conifer coniferous evergreen nadelbaum nadelholz conifere conifera naaldboom" },
	{ ECO_FORM_COLUMN, "columnar fastigiate fastigiata saulenform columnaris pyramidalis" },
	{ ECO_FORM_WEEPING, "weeping pendula trauer pleureur lloron piangente treur" },
	{ ECO_FORM_SHRUB, "bush shrub hedge strauch busch hecke arbuste buisson haie arbusto cespuglio siepe "
		"struik heester" },
	{ ECO_FORM_HERB, "flower flowers plant herb orchid orchids fern blume blumen staude fleur fleurs "
		"flor flores fiore bloem tulip daisy mushroom toadstool pilz seta fungo" },
	{ ECO_FORM_GRASS, "grass gras graser reed schilf herbe hierba erba bamboo bambus" },
	{ ECO_FORM_BROAD, "tree baum laubbaum laubholz arbre feuillu arbol albero boom arvore drzewo strom "
		"trad trae deciduous broadleaf hardwood broadleaved" },
};

struct eco_form_size eco_form_size(enum eco_form form)
{
	static const struct eco_form_size sizes[ECO_FORM_COUNT] = {
		[ECO_FORM_UNKNOWN] = { 0.05, 60, 3 }, [ECO_FORM_BROAD] = { 2, 50, 12 },
		[ECO_FORM_CONIFER] = { 2, 90, 18 }, [ECO_FORM_COLUMN] = { 1.5, 40, 10 },
		[ECO_FORM_WEEPING] = { 2, 40, 10 }, [ECO_FORM_PALM] = { 1.5, 40, 9 },
		[ECO_FORM_SHRUB] = { 0.3, 12, 2 }, [ECO_FORM_HERB] = { 0.03, 3, 0.5 },
		[ECO_FORM_GRASS] = { 0.03, 5, 0.4 }, [ECO_FORM_NOTHING] = { 0, 1000, 1 } };
	return sizes[form];
}

bool eco_form_is_tree(enum eco_form form)
{
	return form >= ECO_FORM_BROAD && form <= ECO_FORM_PALM;
}

/* ---- Matching ---- */

/* Letters of any alphabet. */
static size_t letters(const char *word)
{
	size_t count = 0;
	for (; *word != 0; word++)
		count += ((unsigned char)*word & 0xc0) != 0x80;
	return count;
}

/* Whether a list of words has `word`, or, where it is long, a word that it ends with: "stieleiche". */
static bool listed(const char *list, const char *word, bool ends)
{
	char found[ECO_WORD_BYTES];
	size_t length = strlen(word);
	while (eco_words_next(&list, found)) {
		size_t own = strlen(found);
		bool same = strcmp(found, word) == 0;
		bool plural = own + 1 == length && word[own] == 's' && strncmp(found, word, own) == 0;
		if (same || plural ||
			(ends && letters(found) >= 5 && length > own
			&& strcmp(word + length - own, found) == 0))
			return true;
	}
	return false;
}

static bool fits_genus(size_t i, const char *word)
{
	return strcmp(genera[i].genus, word) == 0 || listed(genera[i].names, word, true);
}

/* A word that lies within one letter, or two where it is long, of a genus or a name. */
static const char *nearly(size_t i, const char *word)
{
	unsigned most = letters(word) >= 8 ? 2 : 1;
	const char *list = genera[i].names;
	char name[ECO_WORD_BYTES];
	if (eco_words_distance(genera[i].genus, word, most) <= most)
		return genera[i].genus;
	while (eco_words_next(&list, name))
		if (letters(name) >= 5 && eco_words_distance(name, word, most) <= most)
			return genera[i].genus;
	return NULL;
}

static bool find_genus(const char *words, struct eco_flora *flora)
{
	char word[ECO_WORD_BYTES];
	/* a Latin name is surer than a common one: "plum pine (Podocarpus)", "Norway maple (Acer ...)" */
	for (int latin = 1; latin >= 0; latin--)
		for (const char *at = words; eco_words_next(&at, word);)
			for (size_t i = 0; i < sizeof genera / sizeof *genera; i++) {
				if (latin ? strcmp(genera[i].genus, word) != 0 : !fits_genus(i, word))
					continue;
				flora->genus = genera[i].genus;
				flora->form = genera[i].form;
				return true;
			}
	return false;
}

/* The first species whose genus and epithet begin with the two halves of a word of four or six letters. */
static bool find_coded(const char *word, struct eco_flora *flora)
{
	size_t half = strlen(word) / 2;
	char epithet[ECO_WORD_BYTES];
	if (strlen(word) != 4 && strlen(word) != 6)
		return false;
	for (size_t i = 0; i < sizeof coded / sizeof *coded; i++) {
		if (strncmp(coded[i].genus, word, half) != 0)
			continue;
		for (const char *at = coded[i].epithets; eco_words_next(&at, epithet);)
			if (strncmp(epithet, word + half, half) == 0) {
				find_genus(coded[i].genus, flora);
				snprintf(flora->coded, sizeof flora->coded, "%s %s", coded[i].genus, epithet);
				return true;
			}
	}
	return false;
}

static bool ends_in_one_of(const char *word, const char *endings)
{
	char ending[ECO_WORD_BYTES];
	size_t length = strlen(word);
	while (eco_words_next(&endings, ending)) {
		size_t own = strlen(ending);
		if (length > own + 1 && strcmp(word + length - own, ending) == 0)
			return true;
	}
	return false;
}

/* A Latin genus and what follows it, "Terminalia catappa": by its endings, which names in other languages
 * rarely have both. */
static bool is_binomial(const char *words)
{
	char genus[ECO_WORD_BYTES], epithet[ECO_WORD_BYTES];
	return eco_words_next(&words, genus) && eco_words_next(&words, epithet)
		&& ends_in_one_of(genus, "a us um is on os es as ix ys")
		&& ends_in_one_of(epithet, "a us um is i ii ae ens ans oides or ior");
}

/* Of a Latin name, only the first word may be a genus: "rosea" is no rose. */
static void find_misspelt(const char *words, struct eco_flora *flora)
{
	char word[ECO_WORD_BYTES];
	bool latin = is_binomial(words);
	for (size_t k = 0; eco_words_next(&words, word) && !(latin && k > 0); k++)
		for (size_t i = 0; letters(word) >= 5 && i < sizeof genera / sizeof *genera; i++) {
			const char *meant = nearly(i, word);
			if (!meant)
				continue;
			flora->genus = genera[i].genus;
			flora->form = genera[i].form;
			flora->meant = meant;
			snprintf(flora->misspelt, sizeof flora->misspelt, "%s", word);
			return;
		}
}

static enum eco_form form_by_word(const char *words, bool after_genus)
{
	char word[ECO_WORD_BYTES];
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
		/* of a known genus, words say no more than that it stands upright, weeps, or is gone; a stone
		 * pine is no stone */
		if (after_genus && forms[i].form != ECO_FORM_COLUMN && forms[i].form != ECO_FORM_WEEPING
				&& forms[i].form != ECO_FORM_NOTHING)
			continue;
		bool gone = after_genus && forms[i].form == ECO_FORM_NOTHING;
		for (const char *at = words; eco_words_next(&at, word);)
			if (listed(gone ? GONE : forms[i].words, word, true))
				return forms[i].form;
	}
	return ECO_FORM_UNKNOWN;
}

struct eco_flora eco_flora_of(const char *name, bool spelling)
{
	struct eco_flora flora = { .genus = NULL };
	char words[ECO_WORDS_BYTES];
	eco_words_of(name, words, sizeof words);
	bool known = find_genus(words, &flora);
	enum eco_form form = form_by_word(words, known);
	if (form != ECO_FORM_UNKNOWN)
		flora.form = form;
	else if (!known && spelling && !find_coded(words, &flora))
		find_misspelt(words, &flora);
	return flora;
}

bool eco_flora_is_code(const char *name)
{
	struct eco_flora flora = { .genus = NULL };
	char words[ECO_WORDS_BYTES];
	eco_words_of(name, words, sizeof words);
	return find_coded(words, &flora);
}
