#!/bin/sh
# make determinism: the same scene packed, and the same views planned, by gcc without optimisation, by gcc -O3, by clang and under valgrind: the
# packs and plans are those of the build that is there, byte for byte.
#
#   determinism.sh BUILD     BUILD: where ecopack and bench/plans are
set -eu
BUILD=$1
out=build/determinism
rm -rf "$out/packs"
mkdir -p "$out/packs"
"$BUILD/ecopack" generate sunflowers --plants 2 --detail 0.1 -o "$out/scene" --quiet >/dev/null
failed=0

build() { # NAME CC CXX OPT [CPPFLAGS]; warnings of other compilers and optimisations are no errors
	${MAKE:-make} --no-print-directory -j"$(nproc)" CI= B="$out/$1" CC="$2" CXX="$3" OPT="$4" CPPFLAGS="${5:-}" "$out/$1/ecopack" "$out/$1/ecoimage.so" "$out/$1/bench/plans" \
		>"$out/$1.log" 2>&1 || {
		tail -n 20 "$out/$1.log"
		exit 1
	}
}

variant() { # as build
	build "$@"
	both "$1" "" "$out/$1"
}

both() { # NAME RUNNER PROGRAMS: the two orders at a time
	one "$1" "$2" "$3" combined &
	one "$1" "$2" "$3" greedy
	wait
	for order in combined greedy; do
		for what in eco plans; do
			if cmp -s "$out/packs/$1-$order.$what" "$out/packs/here-$order.$what"; then
				echo "$1, order $order: same $what"
			else
				echo "$1, order $order: $what DIFFERS"
				failed=1
			fi
		done
	done
}

# Messages go through a pipe: a confined child that writes to a file is ended, and valgrind does so with its notes (--).
one() { # NAME RUNNER PROGRAMS ORDER
	{
		$2 "$3/ecopack" make "$out/scene/scene.json" -o "$out/packs/$1-$4.eco" --order "$4" --no-cache --quiet >/dev/null &&
			$2 "$3/bench/plans" "$out/packs/$1-$4.eco" >"$out/packs/$1-$4.plans" || rm -f "$out/packs/$1-$4".*
	} 2>&1 | grep -v '^--' || true
}

both here "" "$BUILD"
variant gcc-O0 gcc g++ -O0
variant gcc-O3 gcc g++ -O3
variant clang clang clang++ -O2
# Without fortified functions: valgrind 3.19 takes memmove's for memcpy's, and complains of what overlaps.
build plain gcc g++ -O2 -U_FORTIFY_SOURCE
# Everything takes thirty times as long there, also the children that read models, whose time is limited.
both valgrind "env ECO_IMPORT_SECONDS=100000 valgrind -q --vgdb=no --error-exitcode=9" "$out/plain"
exit "$failed"
