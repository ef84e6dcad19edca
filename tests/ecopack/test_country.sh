#!/bin/sh
# A country from tiles, as README says: each tile a scene of its own, packed by `make -j2`, linked into one pack that is the whole byte for
# byte. One tile changes: only its pack is built again, and the whole is that of a full build.
set -eu
pack=$PWD/$BUILD/ecopack
dir=$BUILD/tmp/country-$$
trap 'rm -rf "$dir"' EXIT INT TERM
rm -rf "$dir" && mkdir -p "$dir/tiles"
"$pack" generate meadow -o "$dir/models" --plants 10 --quiet
cd "$dir"

tile() {        # NAME X Y PLANTS
	awk -v x="$2" -v y="$3" -v n="$4" -v seed="$2$3" 'BEGIN {
		srand(seed + n)
		printf "{\"name\": \"tile\", \"plants\": {\"grass\": {\"model\": \"../models/models/grass.obj\"}, \"daisy\": {\"model\": \"../models/models/daisy.obj\"}},\n\"instances\": ["
		for (i = 0; i < n; i++)
			printf "%s\n{\"plant\": \"%s\", \"at\": [%.2f, %.2f, 0]}", i ? "," : "", rand() < 0.7 ? "grass" : "daisy", x + 20 * rand(), y + 20 * rand()
		print "]}" }' >"tiles/$1.json"
}
tile a 0 0 150; tile b 20 0 120; tile c 0 20 180; tile d 20 20 90
cat >whole.json <<END
{"name": "country", "children": [{"eco": "tiles/a.json", "at": [0, 0, 0]}, {"eco": "tiles/b.json", "at": [0, 0, 0]},
 {"eco": "tiles/c.json", "at": [0, 0, 0]}, {"eco": "tiles/d.json", "at": [0, 0, 0]}]}
END
cat >Makefile <<END
TILES := \$(sort \$(wildcard tiles/*.json))
country.eco: \$(TILES:.json=.eco)
	'$pack' link \$^ -o \$@ --quiet
%.eco: %.json
	'$pack' make \$< -o \$@ --jobs 1 --draft --cache cache --quiet
	echo \$@ >>built
END
unset MAKEFLAGS MFLAGS MAKELEVEL || true

same() {        # SAYS WHEN TILES_BUILT
	: >built
	make -s -j2
	"$pack" verify country.eco >/dev/null
	rm -f full.eco
	"$pack" make whole.json -o full.eco --draft --cache cache --quiet
	cmp country.eco full.eco || { echo "$1: the linked pack is not the whole"; exit 1; }
	[ "$(wc -l <built)" -eq "$2" ] || { echo "$1: built $(cat built), not $2 tiles"; exit 1; }
}
same "from nothing" 4
sleep 1
tile c 0 20 181
same "after a change" 1
sleep 1
same "without a change" 0
