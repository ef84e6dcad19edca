/* Names as words: "Höhe (m)", "HOEHE_M", "decimalLatitude" and "utm17n_e" become "hohe m", "hoehe m",
 * "decimal latitude" and "utm 17 n e". For comparing the names of columns, species and files. The words that
 * are known stand in words/NAME.tsv; the Makefile makes build/words/NAME.table of each, an array of its
 * rows. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ECO_WORDS_BYTES 256u
#define ECO_WORD_BYTES 48u

/* Lower case (Latin and Cyrillic), letters without their marks, one space between runs of letters and of
 * digits. Cut to `size` bytes with the ending 0. Returns the length. */
size_t eco_words_of(const char *text, char *words, size_t size);
/* Goes to the next word of such a text; *at is the text at first. False behind the last. */
bool eco_words_next(const char **at, char word[ECO_WORD_BYTES]);
/* Whether a text of words has this word. */
bool eco_words_have(const char *words, const char *word);
/* Whether a name, as written, has one of these words. */
bool eco_words_any(const char *name, const char *words);
/* The words of a set of words/sets.tsv, which has it. */
const char *eco_words_set(const char *set);
/* Whether two words differ by two letters beside each other that are swapped, "heigth". */
bool eco_words_swapped(const char *a, const char *b);
/* Letters inserted, left out, replaced or swapped with their neighbours between two words; more than
 * `most`: most + 1. */
unsigned eco_words_distance(const char *a, const char *b, unsigned most);
