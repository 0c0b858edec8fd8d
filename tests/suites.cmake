# SPDX-License-Identifier: MIT
# Read by ctest, once for each room, with `program` and `room` set: one test a suite. A process a test
# took a fifth longer, and what tests of a suite share was made anew for each.
execute_process(COMMAND "${program}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status)
if(NOT status EQUAL 0)  # not built: ctest says so, and how the test that stands for the room ended
  add_test("${room}_NOT_BUILT" "${program}")
  return()
endif()
# Left to .ci/run, with the label gate: instructions counted, which hold for one compiler, and studies of accuracy and
# faults on many records, a third of what all tests take.
set(gate "Cost$|^Coverage|PlainSensors|LowPassTest|LateChannels|Places|FieldFaults|UnseenTruck|ATrucksNumbers|ADrivenMass|Outliers|WrongValues")
string(REGEX MATCHALL "(^|\n)[^ \n]+\\.( |\n)" suites "${listed}")
foreach(line ${suites})
  string(REGEX REPLACE "[\n ]|\\.[\n ]$" "" suite "${line}")
  add_test("${suite}" "${program}" "--gtest_filter=${suite}.*")
  set(labels ${room})
  if(suite MATCHES "${gate}")
    list(APPEND labels gate)
  endif()
  set_tests_properties("${suite}" PROPERTIES LABELS "${labels}" TIMEOUT 3600)
endforeach()
