#!/bin/sh
# Part of make layers: no comment opens with Of, What, Who, Whoever, Where, So or That. The subject of a sentence is a noun that names the
# thing. Prints each such line; status 1 if there is one.
set -eu
cd "$(dirname "$0")/.."
opens='(/\*+|^[[:space:]]*\*|//|#) *(Of|What|Who|Whoever|Where|So|That)[ ,]'
found=$(git ls-files -- '*.c' '*.h' '*.cpp' '*.glsl' '*.mjs' '*.js' '*.py' '*.sh' '*.mk' Makefile .ci | xargs grep -nE -- "$opens" | grep -v '^tests/prose.sh:' || true)
[ -z "$found" ] || { echo "$found"; echo "prose: $(echo "$found" | wc -l) comments open with a word that is no subject"; exit 1; }
