# Sourced by correctness.sh and correctness_over_dds.sh, which set `out`, the folder of the results, and `page`.
# shellcheck shell=bash

# shellcheck source=scripts/measured.sh
source scripts/measured.sh
begin_measuring "${page:?}" "${out:?}" double aurasim-lab
lab=build/release/aurasim-lab
rm -f "${out:?}"/{collision,loss}/summary.json
met=yes

# NAME OPTION...: an experiment, into $out/NAME. Exit code 1: it is done, but not every requirement is met.
run() {
  "$lab" experiment "$1" --out "$out/$1" "${@:2}" || { [[ $? == 1 && -s $out/$1/summary.json ]] && met=no; }
}
