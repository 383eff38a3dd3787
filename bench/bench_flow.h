/* The benchmark of flow4d.h: pathlines of the phantom, no GPU. */
#ifndef LINEAO_BENCH_FLOW_H
#define LINEAO_BENCH_FLOW_H

#include <cJSON.h>
#include <stdbool.h>
#include <stdint.h>

/* Adds "flow", an array of measurements of `line_count` pathlines each, to the document. */
bool bench_flow_run(cJSON *document, uint32_t line_count);

/* Prints them as a table to standard output. */
void bench_flow_print(const cJSON *document);

#endif
