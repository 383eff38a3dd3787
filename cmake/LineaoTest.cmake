# How tests, fuzz targets and script tests are registered, so that every one gets the same flags and environment.

find_package(PkgConfig QUIET)
if(LINEAO_TESTS AND PkgConfig_FOUND)
  pkg_check_modules(LINEAO_CMOCKA QUIET IMPORTED_TARGET cmocka)
endif()
add_feature_info(cmocka LINEAO_CMOCKA_FOUND "unit tests in C")

# Hermetic runs: no shader cache between them. Sanitizer settings do nothing in a plain build; intercept_tls_get_addr=0:
# since glibc allocates a thread's storage for a loaded driver with malloc, gcc 12's LeakSanitizer takes one block in 256
# for a layout of old and ends the program ("Tracer caught signal 11"). What is kept there is found without it.
set(LINEAO_TEST_ENVIRONMENT
  "MESA_SHADER_CACHE_DISABLE=1"
  "ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1:strict_string_checks=1:intercept_tls_get_addr=0"
  "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/lsan.supp:print_suppressions=0"
  "UBSAN_OPTIONS=print_stacktrace=1"
  "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/tsan.supp:ignore_noninstrumented_modules=1")
set(LINEAO_TEST_DIR ${PROJECT_BINARY_DIR}/tests)
set(LINEAO_TEST_SLOWDOWN 1) # how much longer a test may take in this kind of build
if(LINEAO_SANITIZE OR LINEAO_COVERAGE)
  set(LINEAO_TEST_SLOWDOWN 5)
endif()
file(MAKE_DIRECTORY ${LINEAO_TEST_DIR})

# Sanitizer builds keep drivers loaded to the end (tests/sanitizer_stub.c says why); for every program that opens one.
function(lineao_sanitizer_stub target)
  if(LINEAO_SANITIZE)
    target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/sanitizer_stub.c)
    target_link_options(${target} PRIVATE -rdynamic)
  endif()
endfunction()

# Private: the properties that every registered test has.
function(lineao_test_properties name labels timeout)
  if(NOT timeout)
    set(timeout 120)
  endif()
  math(EXPR timeout "${timeout} * ${LINEAO_TEST_SLOWDOWN}")
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT ${timeout}
    WORKING_DIRECTORY ${LINEAO_TEST_DIR} ENVIRONMENT "${LINEAO_TEST_ENVIRONMENT}")
endfunction()

# lineao_test(NAME name SOURCES file... [LIBRARIES target...] [LABELS label...] [ARGS arg...] [TIMEOUT seconds])
# A cmocka program, run in build/<preset>/tests; a timeout is 120 s unless told. LABELS slow: ./run check only;
# threads: also under the thread sanitizer. The macro LINEAO_SOURCE_DIR is the repository's path, as a string, and
# LINEAO_SLOWDOWN how much longer things may take than in a plain build; C99 and POSIX 2008 are there.
function(lineao_test)
  cmake_parse_arguments(PARSE_ARGV 0 test "" "NAME;TIMEOUT" "SOURCES;LIBRARIES;LABELS;ARGS")
  if(test_UNPARSED_ARGUMENTS OR NOT test_NAME OR NOT test_SOURCES)
    message(FATAL_ERROR "lineao_test: NAME and SOURCES are needed; not understood: ${test_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT LINEAO_CMOCKA_FOUND)
    message(FATAL_ERROR "lineao_test(${test_NAME}): cmocka is missing; ./run setup installs it")
  endif()
  add_executable(${test_NAME} ${test_SOURCES})
  set_target_properties(${test_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${LINEAO_TEST_DIR})
  target_include_directories(${test_NAME} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${test_NAME} PRIVATE "LINEAO_SOURCE_DIR=\"${PROJECT_SOURCE_DIR}\""
    LINEAO_SLOWDOWN=${LINEAO_TEST_SLOWDOWN} _POSIX_C_SOURCE=200809L)
  target_link_libraries(${test_NAME} PRIVATE ${test_LIBRARIES} lineao_core PkgConfig::LINEAO_CMOCKA)
  lineao_sanitizer_stub(${test_NAME})
  add_test(NAME ${test_NAME} COMMAND ${test_NAME} ${test_ARGS})
  lineao_test_properties(${test_NAME} "${test_LABELS}" "${test_TIMEOUT}")
endfunction()

# lineao_script_test(NAME name COMMAND command... [LABELS label...] [TIMEOUT seconds])
function(lineao_script_test)
  cmake_parse_arguments(PARSE_ARGV 0 test "" "NAME;TIMEOUT" "COMMAND;LABELS")
  add_test(NAME ${test_NAME} COMMAND ${test_COMMAND})
  lineao_test_properties(${test_NAME} "${test_LABELS}" "${test_TIMEOUT}")
endfunction()

# lineao_fuzzer(NAME name SOURCES file... [LIBRARIES target...] CORPUS directory)
# SOURCES define LLVMFuzzerTestOneInput. With LINEAO_FUZZ (preset fuzz) this is the libFuzzer program
# build/fuzz/fuzz/<name>; else a test that replays the corpus once, with any compiler.
function(lineao_fuzzer)
  cmake_parse_arguments(PARSE_ARGV 0 fuzz "" "NAME;CORPUS" "SOURCES;LIBRARIES")
  cmake_path(ABSOLUTE_PATH fuzz_CORPUS)
  add_executable(${fuzz_NAME} ${fuzz_SOURCES})
  target_include_directories(${fuzz_NAME} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${fuzz_NAME} PRIVATE ${fuzz_LIBRARIES} lineao)
  set_target_properties(${fuzz_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/fuzz)
  if(LINEAO_FUZZ)
    target_link_options(${fuzz_NAME} PRIVATE -fsanitize=fuzzer)
    file(WRITE ${PROJECT_BINARY_DIR}/fuzz/${fuzz_NAME}.corpus "${fuzz_CORPUS}\n")
  else()
    target_sources(${fuzz_NAME} PRIVATE ${PROJECT_SOURCE_DIR}/tests/fuzz_replay.c)
    add_test(NAME ${fuzz_NAME} COMMAND ${fuzz_NAME} ${fuzz_CORPUS})
    lineao_test_properties(${fuzz_NAME} "fuzz" "")
  endif()
endfunction()
