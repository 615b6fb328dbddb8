#!/usr/bin/env bash
# Builds the programs of a folder, by CMake and by pkg-config, and runs them there. Where Mica is installed, say
# CMAKE_PREFIX_PATH, PKG_CONFIG_PATH and LD_LIBRARY_PATH.
#   build_samples.sh FOLDER
set -euo pipefail
cd "$1"

cmake -B build -DCMAKE_BUILD_TYPE=Release > cmake.log || { cat cmake.log; exit 1; }
cmake --build build > build.log || { cat build.log; exit 1; }
read -ra flags < <(pkg-config --cflags --libs --static mica)
mkdir plain
for source in *.cpp; do
  name=${source%.cpp}
  c++ -std=c++17 -Wall -Wextra -Werror -pedantic "$source" "${flags[@]}" -o "plain/$name"
  for program in "build/$name" "plain/$name"; do
    "$program" > "$program.log" 2>&1 || { cat "$program.log"; echo "$program failed"; exit 1; }
    echo "$program runs"
  done
done
