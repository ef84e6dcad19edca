#!/bin/sh
# 4,000 random cameras and budgets over six generated scenes: what must always hold does (tests/bench/requests.c says what); `make soak` asks 10,000.
# ECO_REQUESTS changes the count; under sanitizers it is a tenth.
set -eu
case $BUILD in */sanitize*) few=10 ;; *) few=1 ;; esac
export XDG_CACHE_HOME="$PWD/build/cache"
dir=$BUILD/tmp/requests
rm -rf "$dir"; mkdir -p "$dir"
# an order, plants and drafts that take little time: what must hold depends on none of them, and `make soak` asks the same of the defaults
ORDER=combined DETAIL=0.25 DRAFT="park forest meadow tree" tests/bench/request_scenes.sh "$dir" >"$dir/log" 2>&1 || { cat "$dir/log"; exit 1; }
status=0
# two at a time
each=${ECO_REQUESTS:-$((4000 / few))}
"$BUILD/bench/requests" "$((each * 2 / 5))" "$dir/park.eco" "$dir/forest.eco" >"$dir/first" 2>&1 & first=$!
"$BUILD/bench/requests" "$((each * 3 / 5))" "$dir/nested.eco" "$dir/meadow.eco" "$dir/tree.eco" || status=1
wait "$first" || status=1
# hectares that stand many times: summaries are shared by all views of them
"$BUILD/ecopack" generate billion --plants 300000 -o "$dir/shared" --quiet
"$BUILD/ecopack" make --draft "$dir/shared/scene.json" -o "$dir/shared.eco" --quiet 2>>"$dir/log" || status=1
"$BUILD/bench/requests" "$((each / 40))" "$dir/shared.eco" || status=1
cat "$dir/first"
# the same within the work that a server allows if not told otherwise
"$BUILD/bench/requests" --times 5 "$((each / 10))" "$dir/park.eco" "$dir/meadow.eco" "$dir/nested.eco" || status=1
exit $status
