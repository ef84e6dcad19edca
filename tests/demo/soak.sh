#!/bin/sh
# make soak [SECONDS=60]: 10,000 damaged models (MUTANTS), then 10,000 random requests (REQUESTS) against five
# scenes and a generated forest of 20,000 plants, then sixteen clients that decode and check everything for SECONDS; then ENDURE requests of all
# kinds, over which memory must not grow; then faults of memory and disk (FAULTS places of each kind, KILLS kills), what one address can
# do to others (LEAKS requests that leaked), and the server under the thread sanitizer. Exit 1 at the first violation.
# tests/README.md has what was seen.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
OUT=$BUILD/soak
. "$(dirname "$0")/../bench/mutants.sh"
mkdir -p "$OUT"
mutate "$OUT/mutants" "${MUTANTS:-10000}" "${SEED:-1}"
"$BUILD/ecopack" generate forest --plants 20000 -o "$OUT/forest" >"$OUT/log"
"$BUILD/ecopack" make "$OUT/forest/scene.json" -o "$OUT/forest.eco" >>"$OUT/log"
BUILD=$BUILD sh tests/bench/request_scenes.sh "$OUT/requests" >>"$OUT/log"
"$BUILD/bench/requests" "${REQUESTS:-10000}" "$OUT"/requests/*.eco "$OUT/forest.eco"
for scene in park grove forest; do "$BUILD/ecopack" generate $scene -o "$OUT/$scene" >>"$OUT/log"; done
serve "$OUT/serve.log" "forest=$OUT/forest.eco"
"$BUILD/ecoload" "$BASE/v1/scenes/forest" --camera "$OUT/forest/camera.json" --clients 16 --seconds "${SECONDS_LONG:-60}" --vertices 200000
grep -E 'VmRSS|VmHWM' "/proc/$SERVER_PID/status"
stop_serving

python3 tests/demo/chunk_ids.py "$OUT/forest.eco" >"$OUT/chunks"
serve "$OUT/endure.log" "forest=$OUT/forest.eco"
python3 tests/faults/endure.py "${BASE##*:}" forest $SERVER_PID "$OUT/chunks" "${ENDURE:-200000}"
stop_serving

FAULTS=${FAULTS:-100} KILLS=${KILLS:-1000} sh tests/faults/test_faults_make.sh
FAULTS=${FAULTS:-100} sh tests/faults/test_faults_serve.sh
serve "$OUT/attacks.log" "forest=$OUT/forest.eco"
python3 tests/faults/attacks.py "${BASE##*:}" forest $SERVER_PID "$OUT/attacks.json" "${LEAKS:-100000}"
stop_serving
sh tests/faults/threads.sh "${SECONDS_LONG:-60}"
