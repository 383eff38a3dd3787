/* Table 1 of Koehler 2017: static and animated frames, with either halo and either occlusion. */
#ifndef LINEAO_BENCH_TABLE1_H
#define LINEAO_BENCH_TABLE1_H

#include "bench_case.h"

/* Measures the eight rows on the first backend: to be run in a process of its own. Animated frames
 * show a trail of 25 ms in both directions of an 833 ms beat. NULL: reported. */
cJSON *bench_table1_run(const bench_case *it);

#endif
