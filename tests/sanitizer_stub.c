/* Keeps drivers loaded in sanitizer builds, so that the leak checker can name their frames instead
 * of "<unknown module>". */
#include <dlfcn.h>

int dlclose(void *handle) {
    (void)handle;
    return 0;
}
