#!/bin/sh
# packages.sh [--tell] PACKAGE...: installs those of the Debian packages that are not installed; does nothing, without a network, if all are.
# --tell: only says which.
set -u
tell=
[ "${1-}" != --tell ] || { tell=1; shift; }
command -v dpkg-query >/dev/null || {
	[ -n "$tell" ] || echo "packages: this is not Debian; it is up to you that these are here under their local names: $*" >&2
	exit 0
}
installed=" $(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null | sed -n 's/ installed$//p' | tr '\n' ' ')"
missing=
for package in "$@"; do
	case $installed in *" $package "*) ;; *) missing="$missing $package" ;; esac
done
[ -n "$missing" ] || exit 0
[ -z "$tell" ] || {
	echo "packages: missing$missing. What needs them will not build; make deps installs them" >&2
	exit 0
}

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
	echo "packages: apt-get could not install$missing; its message is above. It needs a network, and Debian 12's archive" >&2
	exit 1
}
