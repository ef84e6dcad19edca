#!/bin/sh
# 10,000 random cameras and budgets from 0 to 10^8 against a generated park: no violation, no crash, same request same bytes; 10^5 flipped
# bits and cut ends of the pack and of a stream: each noticed. ECO_REQUESTS and ECO_DAMAGES change the counts; under sanitizers they
# are a tenth.
set -eu
case $BUILD in */sanitize*) few=10 ;; *) few=1 ;; esac
dir=$BUILD/tmp/requests
rm -rf "$dir"; mkdir -p "$dir"
"$BUILD/ecopack" generate park -o "$dir/park" >"$dir/log" 2>&1 || { cat "$dir/log"; exit 1; }
"$BUILD/ecopack" make "$dir/park/scene.json" -o "$dir/park.eco" >"$dir/log" 2>&1 || { cat "$dir/log"; exit 1; }
"$BUILD/bench/requests" "$dir/park.eco" "${ECO_REQUESTS:-$((10000 / few))}" "${ECO_DAMAGES:-$((100000 / few))}"
