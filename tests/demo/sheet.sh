#!/bin/sh
# make sheet: all habits of the library of plants, at their least, usual and greatest heights, beside their ranges of height, crown and base:
# build/sheet/index.html. HABITS="spruce|fir" in the environment: these alone.
set -eu
BUILD=${BUILD:-build}
. "$(dirname "$0")/common.sh"
OUT=$BUILD/sheet
WORDS=$(dirname "$0")/../../ecofiles/generate/words
rm -rf "$OUT"
mkdir -p "$OUT"

# a line a plant: habit, genus, height, crown, base, ranges
awk -F '\t' -v only="${HABITS:-.*}" '
	function crown(h,  w) { w = $c["young_m"] + h * $c["crown"]; return w < $c["widest_m"] ? w : $c["widest_m"] }
	/^#/ { next }
	!named[FILENAME]++ { split("", c); for (i = 1; i <= NF; i++) c[$i] = i; next }
	FILENAME ~ /genera[.]tsv$/ { known[$1] = 1; next }
	FILENAME ~ /looks/ { split($c["taxon"], part, " "); if ($c["taxon"] in known || (part[1] in known && !($c["habit"] in genus))) genus[$c["habit"]] = $c["taxon"]; next }
	$1 ~ "^(" only ")$" {
		low = $c["least_m"]; high = $c["most_m"]; base = $c["base"]; size[1] = low; size[2] = $c["height_m"]; size[3] = high
		for (i = 1; i <= 3; i++)
			printf "%s\t%s\t%g\t%g\t%g to %g m\t%.2g to %.2g m\t%.2g to %.2g m\n", $1, genus[$1], size[i], crown(size[i]), low, high,
				crown(low), crown(high), base * low, base * high
	}' "$WORDS/../../import/places/words/genera.tsv" "$WORDS/looks.tsv" "$WORDS/habits.tsv" >"$OUT/plants.tsv"
[ -s "$OUT/plants.tsv" ] || die "no habit is named like ${HABITS:-.*}"

jq -Rn '[inputs | split("\t") | {habit: .[0], genus: .[1], height_m: (.[2] | tonumber), crown_m: (.[3] | tonumber)}] | to_entries
	| {name: "sheet", plants: (map({key: "p\(.key)", value: ({library: .value.habit, height_m: .value.height_m, crown_m: .value.crown_m}
		+ if .value.genus == "" then {} else {genus: .value.genus} end)}) | from_entries),
	instances: map({plant: "p\(.key)", at: [400 * .key, 0], yaw_deg: 20})}' "$OUT/plants.tsv" >"$OUT/scene.json"
jq -Rn '[inputs | split("\t") | {h: (.[2] | tonumber), s: ([.[2], .[3] | tonumber] | max)}] | to_entries
	| {fps: 1, keyframes: map({time_s: .key, eye: [400 * .key, -1.75 * .value.s, ([1.7, 0.6 * .value.h] | min)],
	target: [400 * .key, 0, 0.5 * .value.h], fov_y_deg: 36})}' "$OUT/plants.tsv" >"$OUT/camera.json"

"$BUILD/ecopack" make --draft "$OUT/scene.json" -o "$OUT/sheet.eco" --quiet
serve "$OUT/serve.log" "$OUT/sheet.eco"
"$BUILD/ecoview" "$BASE/v1/scenes/sheet" --camera "$OUT/camera.json" --size 260x260 --vertices 1M -o "$OUT/pictures" >"$OUT/view.log"
stop_serving
{
	echo '<!doctype html><html lang="en"><meta charset="utf-8"><title>Library of plants</title><style>body{font:15px sans-serif} td{padding:2px 9px}</style>'
	echo '<table><tr><th>habit<th>height<th>crown<th>base<th>least<th>usual<th>greatest'
	awk -F '\t' '{ if (NR % 3 == 1) printf "<tr><td>%s<br>%s<td>%s<td>%s<td>%s", $1, $2, $5, $6, $7
		printf "<td><img src=\"pictures/frame-%04d.png\" alt=\"%s of %g m\">\n", NR - 1, $1, $3 }' "$OUT/plants.tsv"
	echo '</table></html>'
} >"$OUT/index.html"
echo "$(wc -l <"$OUT/plants.tsv") plants: $OUT/index.html"
