#!/bin/sh
# packages.sh [--tell] PACKAGE...: installs those of the Debian packages that are not installed, and those of which the machine's own package
# lists know a newer one. Does nothing, without a network, if all are there and none is older. --tell: only says which are missing.
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
[ -z "$tell" ] || {
	[ -z "$missing" ] || echo "packages: missing$missing. What needs them will not build; make deps installs them" >&2
	exit 0
}

# "NAME INSTALLED CANDIDATE" a line; without lists the candidate is what is installed
older=$(LC_ALL=C apt-cache policy $installed 2>/dev/null | awk '
	/^[^ ]/ { name = $1; sub(/:.*/, "", name) }
	/^  Installed:/ { have = $2 }
	/^  Candidate:/ && have != "(none)" && $2 != "(none)" && $2 != have { print name, have, $2 }' |
	while read -r name have candidate; do ! dpkg --compare-versions "$have" lt "$candidate" || printf ' %s' "$name"; done)
[ -n "$missing$older" ] || exit 0

sudo=
if [ "$(id -u)" -ne 0 ]; then
	command -v sudo >/dev/null || {
		[ -n "$missing" ] || { echo "packages: older than Debian's:$older. Run as root: apt-get install$older" >&2; exit 0; }
		echo "packages: missing$missing. Run as root: apt-get install$missing$older" >&2
		exit 1
	}
	sudo=sudo
fi
export DEBIAN_FRONTEND=noninteractive
[ -z "$missing" ] || echo "packages: installing$missing"
[ -z "$older" ] || echo "packages: upgrading$older"
$sudo apt-get update -qq && $sudo apt-get install -qq -y --no-install-recommends $missing $older >/dev/null && exit
[ -n "$missing" ] || { echo "packages: apt-get could not upgrade$older; its message is above. What is installed is used" >&2; exit 0; }
echo "packages: apt-get could not install$missing; its message is above. It needs a network, and Debian 12's archive" >&2
exit 1
