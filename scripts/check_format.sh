#!/usr/bin/env bash
# Is every source file as clang-format would write it?  --fix: writes them so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mode=(--dry-run -Werror)
[[ ${1:-} != --fix ]] || mode=(-i)

# What git tracks; without git (or in an unpacked archive), what lies there.
if listed=$(git ls-files 'src/*.h' 'src/*.cpp' 'tests/*.h' 'tests/*.cpp' 2>/dev/null) && [[ -n $listed ]]; then
  mapfile -t files <<<"$listed"
else
  mapfile -t files < <(find src tests -name '*.h' -o -name '*.cpp' | LC_ALL=C sort)
fi
present=()
for file in "${files[@]}"; do
  [[ ! -f $file ]] || present+=("$file")
done
[[ ${#present[@]} -gt 0 ]] || { echo "check_format.sh: no source files found" >&2; exit 1; }

clang-format "${mode[@]}" "${present[@]}"
echo "format: ${#present[@]} files"
