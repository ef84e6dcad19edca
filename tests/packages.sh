#!/bin/sh
# packages.sh PACKAGE...: installs those of the Debian packages that are not installed; does nothing, without a network, if all are.
set -u
command -v dpkg-query >/dev/null || {
	echo "packages: this is not Debian; it is up to you that these are here under their local names: $*" >&2
	exit 0
}
missing=
for package in "$@"; do
	dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

sudo=
if [ "$(id -u)" -ne 0 ]; then
	command -v sudo >/dev/null || {
		echo "packages: missing$missing. Run as root: apt-get install$missing" >&2
		exit 1
	}
	sudo=sudo
fi
echo "packages: installing$missing"
export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq && $sudo apt-get install -qq -y --no-install-recommends $missing >/dev/null || {
	echo "packages: apt-get could not install$missing; its message is above" >&2
	exit 1
}
