# Writes the file by which CTest knows the suites of one GoogleTest program: one CTest test
# per suite, called like sim_physics.Gsab. A program
# takes 0.2 s to load its shared libraries, so one test per TEST would take minutes for nothing, and suites could
# not share what SetUpTestSuite computes.
#
#   cmake -DPROGRAM=... -DNAME=... -DOUTPUT=... -DPROPERTIES=... [-DEMULATOR=...] -P SonarcalDiscoverTests.cmake
#
# EMULATOR: the command, a list, that runs programs of another processor.
execute_process(COMMAND ${EMULATOR} ${PROGRAM} --gtest_list_tests
  OUTPUT_VARIABLE listed RESULT_VARIABLE result TIMEOUT 300)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests ended with ${result}")
endif()

# A suite: "Suite." or "Prefix/Suite.", at the beginning of a line, perhaps with a comment behind it.
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${listed}")
string(REGEX REPLACE "_test$" "" NAME ${NAME})
set(command "")
foreach(word IN LISTS EMULATOR PROGRAM)
  string(APPEND command " [=[${word}]=]")
endforeach()
set(text "")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  string(APPEND text
    "add_test([=[${NAME}.${suite}]=]${command} [=[--gtest_filter=${suite}.*]=])\n"
    "set_tests_properties([=[${NAME}.${suite}]=] PROPERTIES ${PROPERTIES})\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
