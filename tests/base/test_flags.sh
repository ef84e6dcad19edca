#!/bin/sh
# The user's CPPFLAGS, CFLAGS, CXXFLAGS and LDFLAGS are in every compilation and every link, and programs and modules are hardened.
# BUILD is the folder of the programs. Prints what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
config=release
case $BUILD in */debug|*/sanitize|*/coverage|*/fuzz) config=${BUILD##*/} ;; esac
commands=build/tmp/flags-$$
failed=0
mkdir -p build/tmp
trap 'rm -f "$commands"' EXIT

complain() { echo "test_flags: $*"; failed=1; }

# Nothing is there, so that make -n says all that it would do.
env -u MAKEFLAGS -u MAKELEVEL "${MAKE:-make}" -n config="$config" B=build/tmp/none-$$ CPPFLAGS=-DUSER_CPP CFLAGS=-DUSER_C CXXFLAGS=-DUSER_CXX \
	LDFLAGS=-LUSER_LD all build/tmp/none-$$/bench/ecobench build/tmp/none-$$/bench/plans build/tmp/none-$$/tests/test_angle16 \
	build/tmp/none-$$/fuzz/fuzz_obj build/tmp/none-$$/o0/plans 2>/dev/null | sed -e :a -e "/\\\\$/{N;s/\\\\\n//;ta" -e "}" >"$commands"

# every LINES-PATTERN FLAG: and there are some
every() {
	[ "$(grep -Ec -- "$1" "$commands")" -gt 0 ] || complain "make -n names nothing like /$1/"
	grep -E -- "$1" "$commands" | grep -v -- "$2" | head -n 3 | grep . && complain "without $2"
}
every ' -c -o .*\.c$' -DUSER_CPP
every ' -c -o .*\.c$' -DUSER_C
every ' -c -o .*\.cpp$' -DUSER_CPP
every ' -c -o .*\.cpp$' -DUSER_CXX
every ' -c -o .*\.c(pp)?$' -fstack-protector-strong
every '-Wl,--as-needed' -LUSER_LD
every '-Wl,--as-needed' -Wl,-z,relro,-z,now
every ' -shared .*-o [^ ]*/eco[a-z]*\.so ' -DUSER_CXX
every ' -shared ' -DUSER_C
every '-Wl,--as-needed' -DUSER_C
if [ "$config" = release ]; then
	every ' -O2 .* -c -o .*/obj/' -D_FORTIFY_SOURCE=2
	every ' -c -o .*/o0/' -U_FORTIFY_SOURCE
else
	grep -q _FORTIFY_SOURCE=2 "$commands" && complain "config=$config is built with _FORTIFY_SOURCE"
fi

for file in ecopack ecoserve ecoview ecoload ecoassimp.so ecocairo.so ecogdal.so ecoimage.so ecoproj.so; do
	readelf -lW "$BUILD/$file" | grep -q GNU_RELRO || complain "$file: no relro"
	readelf -dW "$BUILD/$file" | grep -q 'BIND_NOW\|FLAGS_1.*NOW' || complain "$file: not bound at once"
done
[ "$config" != release ] || nm -D "$BUILD/ecoserve" | grep -q '_chk' || complain "ecoserve: neither stack protector nor _FORTIFY_SOURCE"
exit $failed
