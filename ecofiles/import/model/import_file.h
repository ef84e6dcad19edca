/* Files of strangers, before a reader sees them: their beginning, and what they are by it; whole: files.h. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/files.h"

/* The file's first 64 KiB, followed by a 0; malloc'ed, NULL when memory ran out. 0 bytes if the file
 * cannot be read. */
char *eco_file_read_head(const char *path, size_t *size);

/* Refuses, by a file's first bytes (followed by a 0), files that no reader can read: empty, packed (zip
 * unless the format is one itself), pointers of Git LFS, web pages. `wanted`: "a model". */
enum eco_code eco_file_check_head(const char *path, const char *head, size_t size, bool holds_zip,
	const char *wanted, struct eco_error *error);

/* Whether a word is among the first `bytes` (at most 64 KiB) of a file, binary or not. */
bool eco_file_head_has(const char *path, size_t bytes, const char *word);

bool eco_path_ends_with(const char *path, const char *extension);

/* ---- Notes for the user that are not errors, one a line; notes that do not fit are dropped ---- */

struct eco_notes {
	char text[8192];
	size_t used;
};
void eco_note(struct eco_notes *notes, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Calls warn, unless it is NULL, for each. Notes may come from a child, so their end is set first. */
void eco_notes_tell(struct eco_notes *notes, void (*warn)(void *ctx, const char *text), void *ctx);

/* ---- Texts in them ---- */

/* Bytes of the space at the start of a text, 0 if there is none: ASCII, no-break (U+00A0), and thin spaces
 * (U+2000 to U+200A, U+202F). */
size_t eco_text_space(const char *text);
const char *eco_text_skip_spaces(const char *text);
/* For comparing: trims, makes runs of spaces one, and lowers case (Latin, Greek, Cyrillic). Writes at most
 * `size` bytes with the ending 0, cut if needed, and returns the length. */
size_t eco_text_fold(const char *text, char *folded, size_t size);
/* Whether a folded text fits a folded pattern, in which "*" is any text, also the empty one, and `one`,
 * unless it is 0, any character. Time: at worst the product of the lengths. */
bool eco_text_fits(const char *text, const char *pattern, char one);
