#include "image_file.h"

#include "image.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool image_fail(char *error, const char *path, const char *text) {
    if (error) {
        size_t length = strlen(path), room = 150;
        bool cut = length > room;
        const char *tail = path + (cut ? length - room : 0);
        while (cut && ((unsigned char)*tail & 0xC0) == 0x80)
            tail++; /* not inside a UTF-8 char */
        snprintf(error, IMAGE_ERROR_SIZE, "%s%s: %.90s", cut ? "..." : "", tail, text);
    }
    return false;
}

char *image_temp_create(const char *path, char *error) {
    size_t size = strlen(path) + 48;
    char *temp = malloc(size);
    if (!temp) {
        image_fail(error, path, "out of memory");
        return NULL;
    }
    for (int attempt = 0; attempt < 100; attempt++) {
        snprintf(temp, size, "%s.%ld-%d.tmp", path, (long)getpid(), attempt);
        int file = open(temp, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (file >= 0) {
            close(file);
            return temp;
        }
        if (errno != EEXIST)
            break;
    }
    image_fail(error, path, strerror(errno));
    free(temp);
    return NULL;
}

bool image_temp_finish(char *temp, const char *path, bool ok, char *error) {
    if (ok && rename(temp, path) != 0)
        ok = image_fail(error, path, strerror(errno));
    if (!ok)
        remove(temp);
    free(temp);
    return ok;
}
