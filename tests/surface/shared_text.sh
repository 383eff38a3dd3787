#!/bin/sh
# Prints the shared text of a header, unless the prologue in front of it has it already.
echo '#ifndef VSF_FAR'
awk '/^\/\* [A-Z]+_SHARED_BEGIN \*\//{on = 1; next} /^\/\* [A-Z]+_SHARED_END \*\//{on = 0} on' "$1"
echo '#endif'
