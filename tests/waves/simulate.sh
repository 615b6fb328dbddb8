#!/usr/bin/env bash
# Runs a test program on Oclgrind's simulated device, which reports accesses outside of buffers, races between
# work-items and wrong calls of the API. Any report fails, also those after which the program goes on. (Several lanes
# that write the same value are no race to it, and uninitialised values are beyond it: version 21.10 gives up on vectors.)
#   simulate.sh PROGRAM [ARGUMENT...]
set -euo pipefail
log=$(mktemp)
trap 'rm -f "$log"' EXIT

code=0
oclgrind --check-api --data-races --log "$log" "$@" || code=$?
cat "$log"
[[ $code -eq 0 && ! -s $log ]]
