#!/bin/sh
# sources.sh FOLDER PACKAGE...: Debian's source packages, with Debian's patches, as FOLDER/PACKAGE. They come by package lists of their own, in
# FOLDER: the machine's are left as they are, as sources are seldom among them, and nobody has to be root.
set -eu
folder=$(mkdir -p "$1" && cd "$1" && pwd)
shift
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial"
cat >"$folder/apt/sources.list" <<LIST
deb-src [signed-by=$keyring] http://deb.debian.org/debian bookworm main
deb-src [signed-by=$keyring] http://deb.debian.org/debian-security bookworm-security main
LIST
apt() {
	apt-get -qq -o Dir::Etc::SourceList="$folder/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null \
		-o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt/cache" -o APT::Sandbox::User="$(id -un)" "$@"
}
fail() {
	echo "make web: $1; it needs a network, and Debian 12's archive" >&2
	exit 1
}
echo "make web: fetching the sources of $*"
apt update || fail "apt-get could not fetch the lists of source packages"
cd "$folder"
for package; do
	rm -rf "$package" "${package}_"* "$package"-*
	apt source --download-only "$package" || fail "apt-get could not fetch the sources of $package"
	dpkg-source --no-copy -x "${package}_"*.dsc "$package" >apt/unpack.log 2>&1 || { cat apt/unpack.log >&2; fail "$package does not unpack"; }
	rm -f "${package}_"*
done
touch .done
