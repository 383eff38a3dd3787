/* Prints a fragment shader for glslangValidator: the prologue of lineao_shaders.h before the named
 * files. Build tool. */
#define LINEAO_SHADERS_GLSL
#include "lineao_shaders.h"

#include <stdio.h>

int main(int argc, char **argv) {
    char text[4096];
    (void)lao_shaders;
    (void)lao_shader_count;
    printf("#version 450\n#define LAO_GLSL 1\n#define LAO_PRECISE 1\n#define LAO_FRAGMENT 1\n");
    for (uint32_t i = 0; i < lao_shader_prologue_count; i++) {
        fputs(lao_shader_prologue[i], stdout);
    }
    for (int i = 1; i < argc; i++) {
        FILE *file = fopen(argv[i], "r");
        size_t n;
        if (!file) {
            fprintf(stderr, "cannot open %s\n", argv[i]);
            return 1;
        }
        while ((n = fread(text, 1, sizeof text, file)) > 0) {
            fwrite(text, 1, n, stdout);
        }
        fclose(file);
    }
    return 0;
}
