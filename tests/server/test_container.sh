#!/bin/sh
# The container's recipe: what it copies is there; where podman runs and reaches a registry, the image is built and shows a scene and the viewer.
# Skipped (77) in part without these, and as a whole without the viewer.
set -u
dir=build/tmp/test_container
recipe=.ci/package/Containerfile
fail() { echo "test_container: $*"; exit 1; }
skip() { echo "test_container: skipped: $*"; exit 77; }
[ -e build/web/site/index.html ] || skip "make web was not run"
for path in $(sed -n 's/^COPY \([^-][^ ]*\) .*/\1/p' $recipe); do
	[ -e "$path" ] || fail "$recipe copies $path, which is not there"
done
command -v podman >/dev/null || skip "there is no podman: only the recipe's files were looked for"
podman build -q -f $recipe -t ecoserve-test . >/dev/null 2>&1 || skip "podman builds no image here"
rm -rf "$dir" && mkdir -p "$dir"
"$BUILD/ecopack" generate city -o "$dir/city" --plants 20 --quiet >/dev/null && "$BUILD/ecopack" make --draft "$dir/city/scene.json" \
	-o "$dir/city.eco" --quiet || fail "no city"
box=$(podman run -d -p 127.0.0.1::8080 -v "$PWD/$dir/city.eco:/srv/city.eco:ro" ecoserve-test city=/srv/city.eco) || fail "the image does not start"
trap 'podman rm -f "$box" >/dev/null' EXIT
at=$(podman port "$box" 8080)
for _ in $(seq 100); do curl -sf -o /dev/null "http://$at/healthz" && break; sleep 0.1; done
curl -sf "http://$at/v1/scenes" | grep -q '"name":"city"' || fail "no scene"
curl -sf "http://$at/" | grep -q viewer.mjs || fail "no viewer"
echo "ok: the image shows a scene"
