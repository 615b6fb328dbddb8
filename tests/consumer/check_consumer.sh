#!/usr/bin/env bash
# Installs Mica into empty folders, static and shared, and builds and runs the samples against each.
#   check_consumer.sh SOURCE BUILD WORK
set -euo pipefail
source=$1 build=$2 work=$3
failed=0
fail() {
  echo "$*" >&2
  failed=$((failed + 1))
}

rm -rf "$work" && mkdir -p "$work"
cmake --install "$build" --prefix "$work/static" > "$work/install.log"
cmake --install "$build" --prefix "$work/shared" --component consumer >> "$work/install.log"

# A symbol that is not of the public namespace could be another program's.
library=$(find "$work/shared" -name 'libmica.so')
nm --dynamic --defined-only --demangle "$library" > "$work/symbols"
grep -q 'mica::v[0-9_]*::version()' "$work/symbols" || fail "$library: exports no mica::version()"
! grep -vE '^[0-9a-f]+ [A-Za-z] ((typeinfo|typeinfo name|vtable) for )?mica::v[0-9]+_[0-9]+::' "$work/symbols" ||
  fail "$library: exports what is above, expected names of include/mica only"

for kind in static shared; do
  prefix=$work/$kind
  if grep -rIlF -e "$source" -e "$work" "$prefix"; then
    fail "$prefix: these files name a folder of the machine that built them"
  fi
  # Of another version than 0.2.x, it is not the library that was asked for.
  for version in 0.1 0.3 1.0; do
    echo "find_package(mica $version CONFIG QUIET)
if(mica_FOUND OR NOT mica_CONSIDERED_VERSIONS)
  message(FATAL_ERROR \"version $version: found mica \${mica_VERSION}, expected to be refused\")
endif()" > "$work/refuse.cmake"
    cmake -DCMAKE_PREFIX_PATH="$prefix" -P "$work/refuse.cmake" || fail "$prefix: takes version $version"
  done
  cp -r "$source/samples" "$work/$kind-samples"
  cp "$source/tests/consumer/versions.cpp" "$work/$kind-samples"
  pkg_config=$(dirname "$(find "$prefix" -name mica.pc)")
  CMAKE_PREFIX_PATH=$prefix PKG_CONFIG_PATH=$pkg_config LD_LIBRARY_PATH=$(dirname "$pkg_config") \
    "$source/tests/consumer/build_samples.sh" "$work/$kind-samples" || fail "$kind: a sample does not build or run"
done
"$work/static/bin/mica" --version || fail "$work/static/bin/mica does not run"
[[ $failed -eq 0 ]]
