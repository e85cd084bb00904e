# list_suites.cmake, with -P: asks PROGRAM, of GoogleTest, for its suites, and writes FILE for ctest: each is one test, PREFIX.SUITE.
# A suite shares a process, and with it what its tests look at and the loading of libraries. One whose name begins with Slow is
# of the nightly run (ctest -L slow).
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n[^ \n]+\\." suites "\n${listed}") # their tests are indented
set(text "")
foreach(suite IN LISTS suites)
  string(STRIP "${suite}" suite)
  string(REGEX REPLACE "\\.$" "" name "${PREFIX}.${suite}")
  set(label "")
  if(suite MATCHES "^(.*/)?Slow")
    set(label " LABELS slow")
  endif()
  string(APPEND text "add_test([=[${name}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}*]=])\n"
    "set_tests_properties([=[${name}]=] PROPERTIES TIMEOUT 1800${label})\n")
endforeach()
file(WRITE ${FILE} "${text}")
