#!/usr/bin/env bash
# The module as its users have it: a wheel that is built against the library of a build folder, installed into a new
# virtual environment, and tested there. The packages that it needs are fetched from PyPI once.
#   check_module.sh SOURCE BUILD WORK PYTHON
set -euo pipefail
source=$1 build=$2 work=$3 python=$4
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
mkdir -p "$work"
cd "$work"

rm -rf environment library wheel lacking
"$python" -m venv environment
pip=(environment/bin/python -m pip)
requirements=$source/python/tests/requirements.txt
fetched=$("$python" --version; cat "$requirements")
if ! cmp -s <(echo "$fetched") packages/fetched; then
  rm -rf packages
  "${pip[@]}" download --quiet --dest packages -r "$requirements" ||
    { echo "PyPI cannot be reached: the Python module is not tested here"; exit 77; }
  echo "$fetched" > packages/fetched
fi
"${pip[@]}" install --quiet --no-index --find-links packages -r "$requirements"

cmake --install "$build" --prefix "$work/library" --component development > install.log
"${pip[@]}" wheel --quiet --no-deps --no-build-isolation --wheel-dir wheel --config-settings=build-dir="$work/build" \
  --config-settings=cmake.define.MICA_PREFIX="$work/library" "$source"
"${pip[@]}" install --quiet --no-index --no-deps wheel/*.whl

# Without a C++ package it says in one sentence what to install.
if cmake -S "$source/python" -B lacking -DCMAKE_DISABLE_FIND_PACKAGE_embree=TRUE \
  -DPython_EXECUTABLE="$PWD/environment/bin/python" \
  -Dnanobind_DIR="$(environment/bin/python -m nanobind --cmake_dir)" &> lacking.log ||
  ! tr -s ' \n' ' ' < lacking.log | grep -q 'lacks embree here: on Debian 12 .* sudo apt-get install g++ .*libembree-dev'; then
  cat lacking.log
  echo "configured without embree: expected to be told what to install"
  exit 1
fi

MICA_COMMAND=$build/mica environment/bin/python -m pytest --quiet -p no:cacheprovider "$source/python/tests"
environment/bin/python "$source/tests/differential/compare_parsers.py" "$build/tests/mica_read_files" "$source" 500
