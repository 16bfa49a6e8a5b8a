# How a room becomes a target: one static library `aureole_<room>` with alias `aureole::<room>`.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

set(AUREOLE_SANITIZE "" CACHE STRING "Sanitizers to build with, as for -fsanitize= (address,undefined or thread)")

add_library(aureole_options INTERFACE)
target_compile_features(aureole_options INTERFACE cxx_std_20)
target_include_directories(aureole_options INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
target_compile_options(aureole_options INTERFACE
  -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual
  # One rounding per operation: the same build repeats a run bit for bit.
  -ffp-contract=off)
if(AUREOLE_SANITIZE)
  target_compile_options(aureole_options INTERFACE -fsanitize=${AUREOLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  target_link_options(aureole_options INTERFACE -fsanitize=${AUREOLE_SANITIZE})
endif()

# Rooms that every step goes through are compiled harder in what ships, and also as the optimiser's own code, so that the
# executable is linked across their files (aureole_link_hot()); tests link the plain objects beside it.
set(AUREOLE_HOT_FLAGS "")
if(CMAKE_BUILD_TYPE STREQUAL Release AND CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT AUREOLE_SANITIZE)
  set(AUREOLE_HOT_FLAGS -O3 -flto=auto -ffat-lto-objects)
endif()

# aureole_room(<name> [HOT] SOURCES a.cpp b.cpp PUBLIC deps... PRIVATE deps...)
function(aureole_room name)
  cmake_parse_arguments(ARG "HOT" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(aureole_${name} STATIC ${ARG_SOURCES})
  add_library(aureole::${name} ALIAS aureole_${name})
  target_link_libraries(aureole_${name} PUBLIC aureole_options ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  if(ARG_HOT)
    target_compile_options(aureole_${name} PRIVATE ${AUREOLE_HOT_FLAGS})
  endif()
endfunction()

function(aureole_link_hot executable)
  if(AUREOLE_HOT_FLAGS)
    target_link_options(${executable} PRIVATE -O3 -flto=auto)
  endif()
endfunction()

# aureole_test(<name> [SERIAL] LABELS unit SOURCES a.cpp LINK deps...): one Catch2 executable, one ctest entry for each
# case. SERIAL: nothing else runs beside it.
function(aureole_test name)
  cmake_parse_arguments(ARG "SERIAL" "TIMEOUT" "LABELS;SOURCES;LINK" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set(serial "")
  if(ARG_SERIAL)
    set(serial RUN_SERIAL TRUE)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE aureole_options aureole_catch ${ARG_LINK})
  catch_discover_tests(${name} TEST_PREFIX "${name}: " PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} ${serial})
endfunction()
