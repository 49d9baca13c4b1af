# Writes the commit of the sources into a header, and leaves that alone when it has not changed.
#   cmake -D SOURCE=FOLDER -D HEADER=FILE -P write_commit.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=10 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
# Without git, in a plain clone: what HEAD names.
if(failed AND EXISTS ${SOURCE}/.git/HEAD)
  file(STRINGS ${SOURCE}/.git/HEAD commit LIMIT_COUNT 1)
  if(commit MATCHES "^ref: (.*)$" AND EXISTS ${SOURCE}/.git/${CMAKE_MATCH_1})
    file(STRINGS ${SOURCE}/.git/${CMAKE_MATCH_1} commit LIMIT_COUNT 1)
  endif()
  string(REGEX MATCH "^[0-9a-f]+" commit "${commit}")
  string(SUBSTRING "${commit}" 0 10 commit)
endif()
# Without either, in a container: what its builder says.
if(NOT commit)
  set(commit "$ENV{AURASIM_COMMIT}")
endif()
if(NOT commit)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define AURASIM_COMMIT \"@commit@\"\n" @ONLY)
