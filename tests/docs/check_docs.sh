#!/usr/bin/env bash
# The documentation keeps what it promises: every job file in the repository and every job it shows is valid, and every
# file it points to is there.
#   check_docs.sh MICA SOURCE WORK
set -euo pipefail
mica=$1 source=$2 work=$3
documents=("$source"/*.md "$source"/docs/*.md)
failed=0
fail() {
  echo "$*" >&2
  failed=$((failed + 1))
}

rm -rf "$work" && mkdir -p "$work"
for document in "${documents[@]}"; do
  awk -v name="$work/$(basename "$document" .md)" '
    /^```toml$/ { file = name "-" ++count ".toml"; next }
    /^```$/     { file = ""; next }
    file        { print > file }' "$document"
  while read -r target; do
    [[ -e $(dirname "$document")/$target ]] || fail "$document: found no file $target"
  done < <(grep -o ']([^)]*)' "$document" | sed 's/^](//; s/[#)].*$//' | grep -v '^https*:')
done

for job in "$source"/data/jobs/*.toml "$work"/*.toml; do
  "$mica" check "$job" > /dev/null || fail "$job: not a valid job"
done
# The README's job is the file that it tells the reader to change.
diff "$source/data/jobs/first.toml" "$work/README-1.toml" || fail "README.md: its job differs from data/jobs/first.toml"
[[ $failed -eq 0 ]]
