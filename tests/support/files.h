/* Files that tests write and read as a whole. If that fails the program ends, and says which. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* With those that it lies in. */
void folder_make(const char *path);
/* Removes the files that are in it. */
void folder_empty(const char *path);

void file_write(const char *path, const void *bytes, size_t size);
void file_write_text(const char *path, const char *text);
/* With a 0 behind the last; the caller frees them. */
uint8_t *file_read(const char *path, size_t *size);
bool files_alike(const char *one, const char *other);
