#!/usr/bin/env bash
# The module as its users have it: a wheel that is built against the library of a build folder, installed into a new
# virtual environment, and tested there. The packages that it needs are fetched from PyPI once.
#   check_module.sh SOURCE BUILD WORK PYTHON
set -euo pipefail
source=$1 build=$2 work=$3 python=$4
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
mkdir -p "$work"
cd "$work"

fetched=$("$python" --version; cat "$source/python/tests/requirements.txt")
if ! cmp -s <(echo "$fetched") packages/fetched; then
  rm -rf packages
  "$python" -m pip download --quiet --dest packages -r "$source/python/tests/requirements.txt"
  echo "$fetched" > packages/fetched
fi

rm -rf environment library wheel
"$python" -m venv environment
pip=(environment/bin/python -m pip)
"${pip[@]}" install --quiet --no-index --find-links packages -r "$source/python/tests/requirements.txt"

cmake --install "$build" --prefix "$work/library" --component development > install.log
"${pip[@]}" wheel --quiet --no-deps --no-build-isolation --wheel-dir wheel --config-settings=build-dir="$work/build" \
  --config-settings=cmake.define.MICA_PREFIX="$work/library" "$source"
"${pip[@]}" install --quiet --no-index --no-deps wheel/*.whl

MICA_COMMAND=$build/mica environment/bin/python -m pytest --quiet -p no:cacheprovider "$source/python/tests"
