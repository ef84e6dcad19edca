/* What the name of a material or of a part hints at, in the words that people use in a dozen languages. Shape decides first: a hint only
 * breaks ties, for names are often wrong (a trunk's material on leaves, `Material.003`), and never needed. Private to the finder of
 * organs. */
#ifndef LOD_ORGAN_NAME_H
#define LOD_ORGAN_NAME_H

enum lod_hint { LOD_HINT_NONE, LOD_HINT_WOOD, LOD_HINT_FOLIAGE, LOD_HINT_FLOWER };

/* Pots, soil, rocks and fences hint at wood, as which they are treated. Names with words of different hints give none. UTF-8; case does
 * not count where it is ASCII. */
enum lod_hint lod_name_hint(const char *name);

#endif
