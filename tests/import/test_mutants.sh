#!/bin/sh
# Damaged models in five formats, a few hundred of them (ECO_MUTANTS changes the count; `make soak` takes 10,000): each is imported or
# refused within its limits, and nothing is left behind. Under sanitizers a tenth.
set -eu
. "$(dirname "$0")/../bench/mutants.sh"
case $BUILD in */sanitize*) few=10 ;; *) few=1 ;; esac
mutate "$BUILD/tmp/mutants" "${ECO_MUTANTS:-$((400 / few))}" 1
