/* The benchmark of sdfvessel.h: fields of embedded trees by the CPU and by both backends, rays
 * through them on both backends. */
#ifndef LINEAO_BENCH_VESSEL_H
#define LINEAO_BENCH_VESSEL_H

#include <cJSON.h>
#include <stdbool.h>

/* Adds "fields", "device_fields" and "rays", arrays of measurements, to the document. quick: small
 * trees, small pictures. */
bool bench_vessel_run(cJSON *document, bool quick);

/* Prints them as tables to standard output. */
void bench_vessel_print(const cJSON *document);

#endif
