# Shared by the scripts of this folder: two tiny scenes, what a program may do when something fails, and the library that makes it fail.
# FAULTS is how many places each kind is tried at (all: every one); BUILD the folder of the programs.
BUILD=${BUILD:-build}
NAME=$(basename "$0" .sh)
case $BUILD in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
DIR=$(mktemp -d)
failed=0
tried=0
trap 'jobs -p >"$DIR/jobs"; kill $(cat "$DIR/jobs") 2>/dev/null; rm -rf "$DIR"' EXIT     # dash knows no jobs in $(...)
complain() { echo "$NAME: $*"; failed=1; }

# sanitizers have an allocator of their own
case $BUILD in */sanitize*|*/thread*|*/fuzz*) exit 77 ;; esac
FAULT=$BUILD/tests/fault.so
[ -e "$FAULT" ] || exit 77
export FAULT_ALLOC= FAULT_OWN= FAULT_SHORT= FAULT_CLOCK= FAULT_SPARE=libseccomp ECO_IMPORT_SECONDS=2

for height in 1 2; do
	mkdir "$DIR/$height"
	printf 'v -0.05 0 0\nv 0.05 0 0\nv 0 0 %s\nf 1 2 3\n' $height >"$DIR/$height/blade.obj"
	echo '{ "plants": {"grass": {"model": "blade.obj"}}, "instances": [{"plant": "grass", "at": [0, 0]}, {"plant": "grass", "at": [1, 0]}] }' \
		>"$DIR/$height/scene.json"
done

# make HEIGHT OUT.eco : a pack of one of the scenes
make_pack() { "$BUILD/ecopack" make "$DIR/$1/scene.json" -o "$2" --draft --no-cache -q --jobs 1; }

# places COUNT : where to try, of COUNT places: all, or FAULTS of them, the first ones and some spread over the rest
places() {
	awk -v count="$1" -v wanted="${FAULTS:-8}" 'BEGIN {
		if (wanted == "all" || wanted >= count) { for (i = 1; i <= count; i++) print i; exit }
		for (i = 0; i < wanted; i++) { at = int(count ^ (i / (wanted - 1)) + .5); if (at != last) print at; last = at }
		for (i = 1; i < wanted; i++) print int(count * i / wanted) }' | sort -nu
}
