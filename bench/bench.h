/* The benchmark as a command, for `lineao bench` and for lineao_bench. */
#ifndef LINEAO_BENCH_H
#define LINEAO_BENCH_H

/* Exit code: 0 = done, 1 = the work failed, 2 = wrong usage; one line "lineao: ..." tells why. */
int bench_command(int argc, char **argv);

#endif
