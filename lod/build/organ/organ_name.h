/* The organ that the name of a material or a part hints at, by words in a dozen languages. A hint only breaks
 * ties, since names are often wrong (a trunk's material on leaves, `Material.003`) and never needed. Private
 * to the finder of organs. */
#ifndef LOD_ORGAN_NAME_H
#define LOD_ORGAN_NAME_H

enum lod_hint { LOD_HINT_NONE, LOD_HINT_WOOD, LOD_HINT_FOLIAGE, LOD_HINT_FLOWER };

/* Pots, soil, rocks and fences hint at wood, which they are treated as. A name with words of different hints
 * gives none. UTF-8; case is ignored for ASCII. */
enum lod_hint lod_name_hint(const char *name);

#endif
