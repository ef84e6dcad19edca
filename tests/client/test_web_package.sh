#!/bin/sh
# The package for npm: it holds the layer's files and no others, installs without a network, and is imported under its name. Skipped (77) where
# `make web` was not run since what it is made of changed, or there is no npm.
set -u
dir=$PWD/build/tmp/test_web_package
fail() { echo "test_web_package: $*"; exit 1; }
skip() { echo "test_web_package: skipped: $*"; exit 77; }
command -v npm >/dev/null || skip "there is no npm"
${MAKE:-make} --no-print-directory -q web-site 2>/dev/null || skip "make web was not run, or not since its sources changed"
rm -rf "$dir" && mkdir -p "$dir/page"
${MAKE:-make} --no-print-directory web-package >"$dir/out" || fail "make web-package: $(cat "$dir/out")"
export npm_config_cache="$dir/cache" npm_config_update_notifier=false
npm pack --dry-run --json ./build/web/package | jq -r '.[0].files[].path' | sort >"$dir/files" || fail "npm pack --dry-run"
printf '%s\n' LICENSE README.md eco_ask.mjs eco_client.mjs eco_client.wasm eco_keep.mjs eco_layer.mjs eco_planner.mjs eco_planner.wasm \
	eco_planner_worker.mjs eco_published.mjs eco_stream.mjs package.json | sort | diff - "$dir/files" || fail "other files"
npm pack --silent --pack-destination "$dir" ./build/web/package >/dev/null || fail "npm pack"
cd "$dir/page" || exit 1
npm install --offline --no-audit --no-fund --silent "$dir"/ecostream-*.tgz || fail "npm install"
node --input-type=module -e "
	import { EcoLayer, EcoError } from 'ecostream';
	import { EcoStream } from 'ecostream/stream';
	const eye = EcoLayer.eyeOf([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, -3, -4, 5, 5]);       // from 3, 4, 5 downwards
	const refused = await new EcoLayer({ url: 'http://127.0.0.1:9/v1/scenes/x', gl: null }).ready.catch((error) => error);
	if (String(eye) !== '3,4,5' || !(refused instanceof EcoError) || !EcoStream.prototype.find)
		throw new Error(eye + ' ' + refused);
" || fail "the package is not what its README says"
echo "ok: the package packs, installs and is imported"
