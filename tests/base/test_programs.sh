#!/bin/sh
# All programs meet their users alike: --help, --version, no arguments, and an option that is none; and no line of a help is longer than 100
# columns. BUILD is the folder of the programs. Prints what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
DIR=build/tmp/programs-sh-$$
failed=0
mkdir -p "$DIR"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_programs: $*"; failed=1; }

# run STATUS ARGUMENT...: the program's exit status, its output in $DIR/out and $DIR/err
run() {
	wanted=$1; shift
	"$BUILD/$path" "$@" >"$DIR/out" 2>"$DIR/err" </dev/null
	status=$?
	[ $status -eq "$wanted" ] || complain "$program $*: status $status instead of $wanted"
}

# says FILE PATTERN
says() { grep -Eq -- "$2" "$DIR/$1" || complain "$program: nothing like /$2/ in: $(head -c 300 "$DIR/$1")"; }
silent() { [ ! -s "$DIR/$1" ] || complain "$program: says on $1: $(head -c 300 "$DIR/$1")"; }

help() { # WHO ARGUMENT...
	who=$1; shift
	for option in --help -h; do
		run 0 "$@" $option
		silent err
		[ "$(head -n 1 "$DIR/out" | cut -d ' ' -f "1-$(($(echo "$who" | wc -w) + 1))")" = "usage: $who" ] || complain "$who $option: no usage first"
		[ "$(tail -n 1 "$DIR/out")" = "Exit status: 0 done, 1 failed, 2 wrong usage." ] || complain "$who $option: no exit status last"
		says out '^  -h, --help  '
		says out '^  -V, --version  '
		awk -v who="$who" 'length($0) > 100 { print "test_programs: " who " --help: " length($0) " columns: " $0; bad = 1 } END { exit bad }' \
			"$DIR/out" || failed=1
	done
}

version=$(sed -n 's/^#define ECO_VERSION "\(.*\)"/\1/p' ecofiles/base/version.h)
[ -n "$version" ] || complain "no version in ecofiles/base/version.h"
for path in ecopack ecoserve ecoview ecoload bench/ecobench; do
	program=$(basename $path)
	help "$program"
	for option in --version -V; do
		run 0 $option
		silent err
		[ "$(cat "$DIR/out")" = "$program $version" ] || complain "$program $option: $(cat "$DIR/out")"
	done
	run 2 --nonsense
	silent out
	says err "^$program: .*--nonsense"
	says err "^$program --help says how it is used$"
	# without arguments ecobench does all there is to do
	[ "$program" != ecobench ] || continue
	run 2
	silent out
	says err "^$program: .* is missing: "
	says err "^$program --help says how it is used$"
done

# ---- Counts and sizes of all programs take the same suffixes ----
suffixes() { # PROGRAM [COMMAND] -- OPTION...
	path=$1 program=$1; shift
	words=
	while [ "$1" != -- ]; do words="$words $1"; shift; done
	shift
	for option; do
		run 2 $words "--$option" 1kB
		says err "--$option 1kB: must be .*k, M or G behind it"
		run 2 $words "--$option" 1k --nonsense
		says err "has no --nonsense"
	done
}
suffixes ecoview -- vertices bytes
suffixes ecoload -- vertices bytes bandwidth name-from clients cold decode seed
suffixes ecoserve -- send-rate body-bytes bodies-bytes answer-bytes kept-bytes cap-vertices cap-bytes connections plans head-ms
suffixes ecopack make -- cache-mb
suffixes ecopack generate -- plants seed
suffixes ecopack map -- size
path=ecoload; program=ecoload
run 2 --rate 2k --nonsense
says err "has no --nonsense"

path=ecoview; program=ecoview
for size in '' 0 -1 63K 64MB 64X 1.5G ' 64M' 1025G 99999999999999999999G; do
	run 2 http://localhost/v1/scenes/none --camera none.json --size 8x8 --vertices 1 -o "$DIR/none" --memory "$size"
	says err "--memory .*from 64K to 1024G, perhaps with k, M or G behind it"
done
run 2 http://localhost/v1/scenes/none --camera none.json --size 8x8 --vertices 1 -o "$DIR/none" --chunks http://localhost --progressive 20000
says err "--progressive: not with --chunks"
for size in 65536 64K 64M 1024G; do
	run 1 http://localhost/v1/scenes/none --camera "$DIR/none.json" --size 8x8 --vertices 1 -o "$DIR/none" --memory "$size"
	says err "none.json"
done
for time in '' now 2026-06-21 2026-06-21T25:00Z; do
	run 2 http://localhost/v1/scenes/none --camera none.json --size 8x8 --vertices 1 -o "$DIR/none" --sun "$time"
	says err "--sun .*such as 2026-06-21T10:00Z"
done
for kind in '' none Standard standard, standard,0 standard,63 perspective,8193 perspective,1024x 'perspective, 1024' standard,-9 perspective,99999999999; do
	run 2 http://localhost/v1/scenes/none --camera none.json --size 8x8 --vertices 1 -o "$DIR/none" --shadows "$kind"
	says err "--shadows .*must be no, standard or perspective.*of 64 to 8192 texels"
done
for kind in standard perspective,64 standard,8192; do
	run 1 http://localhost/v1/scenes/none --camera "$DIR/none.json" --size 8x8 --vertices 1 -o "$DIR/none" --shadows "$kind" --haze 900
	says err "none.json"
done

path=ecoload; program=ecoload
load() { run "$1" http://localhost/v1/scenes/none --camera none.json --clients 2 --seconds 1 $2; says err "$3"; }
load 2 "--cold 3" "--cold: there are 2 clients"
load 2 "--decode 3" "--decode: there are 2 clients"
load 2 "--arrivals random" "--arrivals: only with --rate"
load 2 "--arrivals often --rate 1" "--arrivals"
load 2 "--name-from 300" "--name-from: only with --chunks"
load 2 "--chunks nowhere" "should look like http://host/chunks"
load 1 "--rate 5 --arrivals random --cold 2 --decode 2" "none.json"

path=ecopack program=ecopack
"$BUILD/ecopack" --help >"$DIR/all"
commands=$(sed -n 's/^  ecopack \([a-z]*\) .*/\1/p' "$DIR/all")
[ "$(echo "$commands" | wc -w)" -ge 9 ] || complain "ecopack --help names only: $commands"
for command in $commands; do
	help "ecopack $command" "$command"
	run 0 "$command" --version
	run 2 "$command"
	says err "^ecopack: .* is missing: "
	says err "^ecopack $command --help says how it is used$"
	run 2 "$command" --nonsense
	says err "^ecopack: ecopack $command has no --nonsense$"
done

# each row of the table of helps is an option's of its program
grep -v '^#' ecofiles/base/words/help.tsv | tail -n +2 | while IFS="$(printf '\t')" read -r command option _; do
	case $option in *' '*) continue ;; esac
	"$BUILD"/$command --help | grep -q -e "--$option" || echo "help.tsv: $command has no --$option"
done >"$DIR/rows"
[ ! -s "$DIR/rows" ] || complain "$(cat "$DIR/rows")"

# what the system refuses: the path, the system's word, and what to do
mkdir "$DIR/models" && printf 'v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n' >"$DIR/models/oak.obj"
printf 'species,lon,lat\noak,11,48\n' >"$DIR/trees.csv"
printf '{"plants": {"oak": {"model": "models/oak.obj"}}, "instances": [{"plant": "oak", "at": [0, 0]}]}' >"$DIR/scene.json"
run 1 make "$DIR/scene.json" -o "$DIR/none/out.eco"; says err 'none/out.eco: .*No such file or directory; make its folder first'
run 1 map "$DIR/scene.json" -o "$DIR/none/map.png"; says err 'none/map.png: .*No such file or directory; make its folder first'
run 1 start "$DIR/trees.csv" "$DIR/models" -o "$DIR/none/my"; says err 'none/my: No such file or directory; make its folder first'
run 1 start "$DIR/trees.csv" "$DIR/models" -o "$DIR/trees.csv"; says err 'trees.csv exists and is not a folder; it is kept'
run 1 start "$DIR/trees.csv" "$DIR/none" -o "$DIR/my"; says err 'none, the folder of models: No such file or directory; check its name'
run 1 start "$DIR/none.csv" "$DIR/models" -o "$DIR/my"; says err 'none.csv: No such file or directory; check its name'
run 1 make "$DIR/trees.csv" -o "$DIR/out.eco"; says err 'trees.csv:1:1: this is no JSON.*ecopack start makes a scene of it'
run 1 info "$DIR/scene.json"; says err 'scene.json: not a pack: .*; ecopack make'
run 2 map "$DIR/scene.json" -o "$DIR/map.jpg"; says err 'map.jpg: pictures are PNG'
[ ! -e "$DIR/map.jpg" ] && [ ! -e "$DIR/my" ] && [ ! -e "$DIR/out.eco" ] || complain "something was written: $(ls "$DIR")"
run 2 frobnicate
says err '^ecopack: frobnicate is not a command; commands: start, make, '
exit $failed
