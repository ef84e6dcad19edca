#!/bin/sh
# make deps: installs what is missing, upgrades what is older than what the machine's package lists know, and asks no network else. Debian's
# own programs are played by three scripts. Prints what failed; status 0 when nothing did.
set -u
DIR=$PWD/build/tmp/packages-sh-$$
failed=0
mkdir -p "$DIR/bin"
trap 'rm -rf "$DIR"' EXIT

# $DIR/have: "NAME VERSION" of what is installed; $DIR/lists: of what the lists know
cat >"$DIR/bin/dpkg-query" <<SH
#!/bin/sh
sed 's/ .*/ installed/' "$DIR/have"
SH
cat >"$DIR/bin/apt-cache" <<SH
#!/bin/sh
shift
for name; do
	have=\$(sed -n "s/^\$name //p" "$DIR/have")
	listed=\$(sed -n "s/^\$name //p" "$DIR/lists")
	printf '%s:\n  Installed: %s\n  Candidate: %s\n  Version table:\n' "\$name" "\${have:-(none)}" "\${listed:-\${have:-(none)}}"
done
SH
cat >"$DIR/bin/apt-get" <<SH
#!/bin/sh
echo "\$*" >>"$DIR/called"
[ ! -e "$DIR/offline" ]
SH
printf '#!/bin/sh\nexec "$@"\n' >"$DIR/bin/sudo"
chmod +x "$DIR/bin/"*

# deps STATUS CALL: what apt-get was called with last ("": never)
deps() {
	rm -f "$DIR/called"
	PATH="$DIR/bin:$PATH" tests/packages.sh one two three >"$DIR/out" 2>&1
	status=$?
	[ $status -eq "$1" ] || { echo "test_packages: status $status instead of $1: $(cat "$DIR/out")"; failed=1; }
	called=$(tail -n 1 "$DIR/called" 2>/dev/null | sed 's/.*--no-install-recommends *//; s/  */ /g')
	[ "$called" = "$2" ] || { echo "test_packages: apt-get was called with '$called' instead of '$2'"; failed=1; }
}

printf 'one 1.0-1\ntwo 2.0-1\nthree 1:3.0~rc1-1\n' >"$DIR/have"
: >"$DIR/lists"
deps 0 ""
cp "$DIR/have" "$DIR/lists"
deps 0 ""
printf 'one 1.0-2\ntwo 1.9-1\nthree 1:3.0-1\n' >"$DIR/lists"
deps 0 "one three"
touch "$DIR/offline"
deps 0 "update -qq"
grep -q 'could not upgrade one three' "$DIR/out" || { echo "test_packages: says nothing of what was not upgraded"; failed=1; }
rm "$DIR/offline"
printf 'one 1.0-2\ntwo 2.0-1\n' >"$DIR/have"
deps 0 "three"
touch "$DIR/offline"
deps 1 "update -qq"
PATH="$DIR/bin:$PATH" tests/packages.sh --tell one two three 2>&1 | grep -q 'missing three' || { echo "test_packages: --tell tells nothing"; failed=1; }
exit $failed
