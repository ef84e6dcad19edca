#!/bin/sh
# What is found to be wood, foliage and flowers: a line for every model under DIR, in percent of its area, as `ecopack model` says it.
#
#   organs.sh DIR [EXPECTED.csv]
#
# EXPECTED.csv says what is obvious from names to whoever wrote it: lines of
#   model,name,organ
# two regular expressions without commas (of the file's name, of a material's or part's name; case does not count) and wood, foliage or
# flower; the first line that fits a material counts, else one that fits a part. `wrong` is then the share of the area of all materials
# (or parts) that some line fits which is found to be another organ; `-` where none fits. Exit status 1 if any is over 5 %.
set -eu
BUILD=${BUILD:-build}
DIR=${1:?organs.sh DIR [EXPECTED.csv]}
EXPECTED=${2:-/dev/null}
bad=0
printf '%-32s %9s %6s %6s %6s %7s %7s\n' model triangles wood foliage flower obvious wrong
find "$DIR" -type f \( -iname '*.obj' -o -iname '*.glb' -o -iname '*.gltf' -o -iname '*.fbx' -o -iname '*.ply' -o -iname '*.dae' \) | LC_ALL=C sort |
{ while read -r model; do
	if ! seen=$("$BUILD/ecopack" model --quiet --json "$model" 2>/dev/null); then
		printf '%-32s refused\n' "$(basename "$model")"
		continue
	fi
	line=$(printf '%s' "$seen" | jq -r --arg model "$(basename "$model")" --rawfile expected "$EXPECTED" '
		($expected | split("\n") | map(select(test("^[^#]")) | split(",") | {model: .[0], name: .[1], organ: .[2]})) as $rules |
		def organ($name): first($rules[] | select(.model as $m | ($model | test($m; "i"))) | select(.name as $n | ($name | test($n; "i"))) | .organ) // null;
		def judged: map(organ(.name) as $o | select($o) | {area: (.organs_m2 | add), good: .organs_m2[$o]});
		(.materials | judged) as $m | (if ($m | length) > 0 then $m else (.parts | judged) end) as $j |
		(.organs_m2 | add) as $all | ([$j[].area] | add // 0) as $known | ([$j[].good] | add // 0) as $good |
		def percent: if . == null then "-" else (. * 1000 | round / 10 | tostring) end;
		[.triangles_kept, (.organs_m2.wood / $all | percent), (.organs_m2.foliage / $all | percent), (.organs_m2.flower / $all | percent),
		 ($known / $all | percent), (if $known > 0 then 1 - $good / $known else null end | percent)] | map(tostring) | join(" ")')
	printf '%-32s %9s %6s %6s %6s %7s %7s\n' "$(basename "$model")" $line
	case ${line##* } in -|[0-4]|[0-4].*|5) ;; *) bad=1 ;; esac
done; exit $bad; }
