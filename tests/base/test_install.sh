#!/bin/sh
# make install: from a folder that is no build tree, and after it was moved, programs find their modules; a C program finds the library by
# pkg-config and nothing but what is public in it; manual pages, completion and the unit are whole. BUILD is the folder of the programs. Prints
# what failed; status 0 when nothing did.
set -u
BUILD=${BUILD:-build}
TOP=$PWD
DIR=$TOP/build/tmp/install-sh-$$
failed=0
mkdir -p "$DIR/there"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_install: $*"; failed=1; }
config=$(basename "$BUILD"); flags=
[ "$config" != build ] || config=release
[ "$config" != sanitize ] || flags=-fsanitize=address,undefined

# jobs and flags of the make that runs this are not for this one
MAKEFLAGS= make -s config=$config install DESTDIR="$DIR/stage" PREFIX=/opt/eco >"$DIR/log" 2>&1 || complain "make install: $(tail -n 5 "$DIR/log")"
mv "$DIR/stage/opt/eco" "$DIR/moved" || exit 1
eco=$DIR/moved
PATH=$eco/bin:$PATH
cd "$DIR/there" || exit 1
unset ECO_MODULES

# ---- Programs and modules ----
for program in ecopack ecoserve ecoview ecoload; do
	[ "$($program --version)" = "$program $(sed -n 's/^#define ECO_VERSION "\(.*\)"/\1/p' "$TOP/ecofiles/base/version.h")" ] || complain "$program --version"
done
ecopack generate park -o park --detail 0.1 --quiet || complain "ecopack generate"
# a map is drawn by ecocairo.so, which lies nowhere but where make install put it
ecopack map park/scene.json -o map.png --quiet >log 2>&1 && [ -s map.png ] || complain "ecopack map: $(cat log)"
[ ! -e "$eco/bin/ecocairo.so" ] && [ -e "$eco/lib/ecostream/ecocairo.so" ] || complain "modules lie elsewhere"
mv "$eco/lib/ecostream" "$eco/lib/elsewhere"
ecopack map park/scene.json -o none.png --quiet >log 2>&1 && complain "a map without its module"
grep -q 'eco[a-z]*.so, needed for .*, is not beside the program.*\.\./lib/ecostream.*make install' log || complain "no module: $(cat log)"
mv "$eco/lib/elsewhere" "$eco/lib/ecostream"

# ---- The library ----
echo '{"plants": {"shrub": {"model": "park/models/shrub.obj"}}, "instances": [{"plant": "shrub", "at": [0, 0]}]}' >shrub.json
ecopack make shrub.json -o shrub.eco --quiet >log 2>&1 || complain "ecopack make: $(cat log)"
export PKG_CONFIG_PATH=$eco/lib/pkgconfig
cc -Wall -Wextra -Werror $flags -o user "$TOP/tests/client/library_user.c" $(pkg-config --define-prefix --cflags --libs ecostream) >log 2>&1 ||
	complain "a program with the library: $(cat log)"
counts=$(LD_LIBRARY_PATH=$eco/lib ./user shrub.eco 2>&1) || complain "library_user: $counts"
echo "$counts" | grep -Eq '^[1-9][0-9]* vertices, 1 plants, [1-9][0-9]* cuts, [1-9][0-9]* bytes$' || complain "library_user says: $counts"
[ "$(echo "$counts" | cut -d ' ' -f 1)" -le 300000 ] || complain "library_user exceeds its budget: $counts"
LD_LIBRARY_PATH=$eco/lib ./user none.eco >log 2>&1 && complain "library_user draws a pack that is not there"
grep -q none.eco log || complain "library_user without a pack: $(cat log)"
stray=$(nm -D --defined-only "$eco"/lib/libecostream.so.? | awk '{ print $3 }' | grep -Ev '^(ecostream_[a-z_]+@@ECOSTREAM_0|ECOSTREAM_0)$')
[ -z "$stray" ] || complain "the library shows $stray"
readelf -d user | grep -q 'NEEDED.*libecostream\.so\.[0-9]' || complain "the library has no soname"
for name in $(sed -n '/^ \*\|^typedef/d; s/.*\b\(ecostream_[a-z_]*\)(.*/\1/p' "$eco/include/ecostream.h" | sort -u); do
	nm -D --defined-only "$eco"/lib/libecostream.so.? | grep -q " $name@@" || complain "the library lacks $name"
done

# ---- The viewer: installed where `make web` was said, and found from there ----
site=$eco/share/ecostream/viewer
[ ! -e "$TOP/build/web/site/eco_client.wasm" ] || cmp -s "$TOP/build/web/site/eco_client.wasm" "$site/eco_client.wasm" || complain "the viewer is not installed"
rm -rf "$site" && mkdir -p "$site" && echo '<p>a viewer</p>' >"$site/index.html"
gzip -k "$site/index.html" && cp "$site/index.html.gz" "$site/index.html.br"
ecoserve --listen 127.0.0.1:0 shrub.eco >ready 2>log &
server=$!
for _ in $(seq 100); do [ -s ready ] && break; sleep 0.1; done
page=$(curl -s "$(grep -o 'http://[^ ]*' ready | head -n 1 | cut -d / -f 1-3)/")
kill $server; wait $server
[ "$page" = '<p>a viewer</p>' ] || complain "ecoserve shows $page: $(cat ready log)"

# ---- What is read, typed and started ----
for page in ecopack ecoserve ecoview ecoload $(ecopack --help | sed -n 's/^  ecopack \([a-z]*\) .*/ecopack-\1/p'); do
	grep -q '^\.SH SYNOPSIS' "$eco/share/man/man1/$page.1" && grep -Eq "^$page \\\\- [a-zN]" "$eco/share/man/man1/$page.1" || complain "no manual of $page"
done
completed() { # WORD...: what bash makes of the last of them
	bash -c '_init_completion() { cur=${COMP_WORDS[COMP_CWORD]} words=("${COMP_WORDS[@]}") cword=$COMP_CWORD; }
		_filedir() { COMPREPLY=(a file); }
		. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _ecostream "$1"; echo "${COMPREPLY[*]}"' \
		"$eco/share/bash-completion/completions/ecopack" "$@"
}
[ "$(completed ecopack ma)" = "make map" ] || complain "ecopack ma: $(completed ecopack ma)"
[ "$(completed ecopack make --or)" = "--order" ] || complain "ecopack make --or: $(completed ecopack make --or)"
[ "$(completed ecopack generate mea)" = "meadow" ] || complain "ecopack generate mea: $(completed ecopack generate mea)"
[ "$(completed ecoserve --li)" = "--listen" ] || complain "ecoserve --li: $(completed ecoserve --li)"
[ "$(completed ecoserve pa)" = "a file" ] || complain "ecoserve pa: $(completed ecoserve pa)"
unit=$eco/lib/systemd/system/ecoserve.service
grep -q '^ExecStart=/opt/eco/bin/ecoserve ' "$unit" || complain "the unit starts $(grep ^ExecStart "$unit")"
if command -v systemd-analyze >/dev/null; then
	exposure=$(systemd-analyze security --offline=true "$unit" 2>&1 | sed -n 's/.*Overall exposure level.*: \([0-9.]*\) .*/\1/p')
	awk -v exposure="${exposure:-9}" 'BEGIN { exit exposure > 1.5 }' || complain "the unit is open by ${exposure:-?}, 1.5 at most"
fi
for file in scene.schema.json openapi.yaml; do [ -s "$eco/share/ecostream/$file" ] || complain "no $file"; done
exit $failed
