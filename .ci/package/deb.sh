#!/bin/sh
# make deb: Debian packages in build/deb, of a copy of the tree with a debian/ folder, and lintian over them. Status 0 if it finds neither errors
# nor warnings.
set -eu
cd "$(dirname "$0")/../.."
out=build/deb tree=build/deb/ecostream
version=$(sed -n 's/^#define ECO_VERSION "\(.*\)"/\1/p' ecofiles/base/version.h)
changed=$(sed -n '1s/.*(\(.*\)).*/\1/p' .ci/package/debian/changelog)
[ "$version" = "$changed" ] || { echo "deb: version.h says $version, .ci/package/debian/changelog says $changed" >&2; exit 1; }
rm -rf "$out"
mkdir -p "$tree"
cp -a .ci LICENSE Makefile README.md ecofiles lod server client-min tests "$tree"
cp -a .ci/package/debian "$tree/debian"
# the viewer, where `make web` was said
[ ! -e build/web/site/eco_client.wasm ] || { mkdir -p "$tree/build/web" && cp -a build/web/site "$tree/build/web/"; }
cd "$tree"
# what is set for this tree is not for the packages
unset CI CFLAGS CXXFLAGS CPPFLAGS LDFLAGS MAKEFLAGS MFLAGS 2>/dev/null || true
export DEB_BUILD_OPTIONS="parallel=$(nproc) noautodbgsym ${DEB_BUILD_OPTIONS-}"
dpkg-buildpackage --build=binary --no-sign >../build.log 2>&1 || { tail -n 30 ../build.log >&2; echo "deb: $out/build.log has all of it" >&2; exit 1; }
# what was put in comes out
[ ! -e ../../web/site/eco_client.wasm ] || dpkg-deb -c ../ecoserve_*.deb | grep eco_client.wasm >/dev/null || {
	echo "deb: the viewer is not in the package" >&2; exit 1; }
lintian --fail-on error,warning --allow-root ../*.changes
ls -l ../*.deb
