#!/bin/sh
# make determinism: the same scene packed, and the same views planned, by gcc without optimisation, by gcc -O3 and by clang, and planned under valgrind:
# the packs and plans are those of the build that is there, byte for byte.
#
#   determinism.sh BUILD     BUILD: where ecopack and bench/plans are
set -eu
BUILD=$1
out=build/determinism
rm -rf "$out/packs"
mkdir -p "$out/packs"
"$BUILD/ecopack" generate sunflowers --plants 12 --detail 0.2 -o "$out/scene" --quiet >/dev/null

variant() { # NAME CC CXX OPT; warnings of other compilers and optimisations are no errors
	name=$1
	${MAKE:-make} --no-print-directory -j"$(nproc)" CI= B="$out/$name" CC="$2" CXX="$3" OPT="$4" "$out/$name/ecopack" "$out/$name/ecoimage.so" "$out/$name/bench/plans" >"$out/$name.log" 2>&1 || {
		tail -n 20 "$out/$name.log"
		exit 1
	}
	run "$name" "$out/$name/ecopack" "$out/$name/bench/plans"
}

run() { # NAME ECOPACK PLANS
	for order in combined greedy; do
		$2 make "$out/scene/scene.json" -o "$out/packs/$1-$order.eco" --order "$order" --no-cache --quiet >/dev/null
		$3 "$out/packs/$1-$order.eco" >"$out/packs/$1-$order.plans"
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

failed=0
run here "$BUILD/ecopack" "$BUILD/bench/plans"
variant gcc-O0 gcc g++ -O0
variant gcc-O3 gcc g++ -O3
variant clang clang clang++ -O2
# Plans only: what reads models is confined to a child process in which valgrind can hardly run.
valgrind -q --vgdb=no --error-exitcode=9 "$BUILD/bench/plans" "$out/packs/here-combined.eco" >"$out/packs/valgrind.plans"
if cmp -s "$out/packs/valgrind.plans" "$out/packs/here-combined.plans"; then
	echo "valgrind: same plans"
else
	echo "valgrind: plans DIFFER"
	failed=1
fi
exit "$failed"
