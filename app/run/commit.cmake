# cmake -D SOURCE=FOLDER -D FILE=commit.cpp -P commit.cmake
# Writes kCommit of commit.hpp: from git; of a source without git (git archive) from commit.txt,
# else empty. The file is touched only where its content changes.
set(commit "")
set(ENV{GIT_OPTIONAL_LOCKS} 0)  # another git may be at work
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --show-toplevel
                  OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH ${SOURCE} source)
  if(top STREQUAL source)  # not a repository that this source happens to lie in
    execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
endif()
if(NOT commit)
  file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/commit.txt archived REGEX "^[0-9a-f]+$")
  string(SUBSTRING "${archived}" 0 12 commit)
endif()
file(CONFIGURE OUTPUT ${FILE} @ONLY CONTENT [[
#include "app/run/commit.hpp"

namespace dampline::app {
extern const char* const kCommit = "@commit@";
}  // namespace dampline::app
]])
