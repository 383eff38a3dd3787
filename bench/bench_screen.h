/* The benchmark of what sdfvessel.h does on the screen (L19 3.3 - 3.7): the void, the guiding
 * field, the parameterization and the ink on both backends, and pull-push beside inverse distances.
 */
#ifndef LINEAO_BENCH_SCREEN_H
#define LINEAO_BENCH_SCREEN_H

#include <cJSON.h>
#include <stdbool.h>

/* Adds "steps", "passes" and "fills", arrays of measurements, to the document. quick: small. folder
 * (Optional): only "fills", and their pictures go there. */
bool bench_screen_run(cJSON *document, bool quick, const char *folder);

/* Prints them as tables to standard output. */
void bench_screen_print(const cJSON *document);

#endif
