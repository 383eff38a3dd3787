/* An installed lineao is found, compiles, links and is the version that its header says. */
#include <lineao.h>
#include <stdio.h>

int main(void) {
    const char *text = lao_result_text(LAO_OK);
    if (!text || !text[0])
        return 1;
    printf("lineao %d.%d.%d: %s\n", LAO_VERSION / 1000000, LAO_VERSION / 1000 % 1000,
           LAO_VERSION % 1000, text);
    return 0;
}
