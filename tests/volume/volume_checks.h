/* Assertions about volumes. */
#ifndef LINEAO_VOLUME_CHECKS_H
#define LINEAO_VOLUME_CHECKS_H

#include "volume_samples.h"

/* Asserts that the volume is the sample. origin: it has the sample's origin, else 0. */
void assert_volume(const io_volume *volume, uint32_t frames, bool mask, bool origin);
/* Reads files, asserting success; the text of a failure is printed. */
io_volume must_read_volume(const buffer *files, uint32_t count, const io_volume_options *options);
/* Asserts failure with a text that has the word, at file `at`; what was in out stays. */
void must_fail_volume(const buffer *files, uint32_t count, const io_volume_options *options,
                      uint32_t at, const char *word);
bool volume_warns(const io_volume *volume, const char *word);

#endif
