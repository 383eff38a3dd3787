/* For the writers of files: error texts, and files that appear only when complete. */
#ifndef LINEAO_IMAGE_FILE_H
#define LINEAO_IMAGE_FILE_H

#include <stdbool.h>
#include <stdio.h>

/* Writes "path: text" to error (may be NULL); a path too long for the line loses its beginning.
 * Returns false, for `return image_fail(...)`. */
bool image_fail(char *error, const char *path, const char *text);

/* Creates an empty file next to `path` and returns its name (for free()), or NULL with an error.
 * The file has the mode that fopen would give it. */
char *image_temp_create(const char *path, char *error);

/* Renames the complete temporary file to `path` (ok) or removes it (not ok, which must have set
 * the error), frees its name and returns whether `path` now is that file. */
bool image_temp_finish(char *temp, const char *path, bool ok, char *error);

#endif
