/* What the numbers say: the targets that were missed, and a table for people. */
#ifndef LINEAO_BENCH_REPORT_H
#define LINEAO_BENCH_REPORT_H

#include <cJSON.h>

/* Adds "targets" and "missed" (sentences) to the document of `bench --json`. */
void bench_report_judge(cJSON *document);

/* Prints the document to standard output. */
void bench_report_print(const cJSON *document);

#endif
