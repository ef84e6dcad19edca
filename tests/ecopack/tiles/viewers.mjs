// viewers.mjs DIR MODULES CHROMIUM OUT: other people's programs on the 3D Tiles of DIR (ecopack export
// --3dtiles). gltf-validator finds no fault in any content; 3d-tiles-tools packs the tileset and unpacks
// the same files; CesiumJS and 3d-tiles-renderer draw, from three distances, on each way from the root to a
// leaf the content of one tile, with as many instances as its file has. MODULES is a folder of npm
// packages; pictures go to OUT.
import { execFileSync } from 'node:child_process';
import { createReadStream, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { dirname, extname, join, normalize, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser } from '../../client/web/browser.mjs';

const [dir, modules, chromium, out] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url)), SIZE = [640, 480];
const DISTANCES = [0.2, 0.8, 6];                 // of the scene's radius, which is that of its ground
const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.json': 'application/json',
	'.gltf': 'model/gltf+json', '.css': 'text/css', '.wasm': 'application/wasm' };
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

function filesOf(folder, at = '') {
	return readdirSync(join(folder, at), { withFileTypes: true }).flatMap((entry) => entry.isDirectory()
		? filesOf(folder, join(at, entry.name)) : [join(at, entry.name)]);
}

// ---- Files ----

async function validate() {
	const validator = createRequire(resolve(modules, 'x.js'))('gltf-validator');
	const contents = filesOf(dir).filter((name) => name.endsWith('.gltf'));
	for (const name of contents) {
		const externalResourceFunction = async (uri) => new Uint8Array(readFileSync(join(dir, dirname(name), uri)));
		const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(join(dir, name))),
			{ uri: name, externalResourceFunction, maxIssues: 20 });
		const { numErrors, numWarnings, messages } = issues;
		expect(!numErrors && !numWarnings, `${name}: ${numErrors} errors and ${numWarnings} warnings by gltf-validator: `
			+ messages.filter(({ severity }) => severity < 2).map(({ code, pointer }) => `${code} ${pointer}`).join('; '));
	}
	console.log(`gltf-validator: ${contents.length} contents`);
}

function packAndUnpack() {
	const tool = (...parts) => execFileSync(process.execPath,
		[join(modules, '3d-tiles-tools/build/src/cli.mjs'), ...parts], { stdio: 'pipe' });
	const packed = join(out, 'packed.3tz'), unpacked = join(out, 'unpacked');
	tool('convert', '-i', join(dir, 'tileset.json'), '-o', packed, '-f');
	tool('convert', '-i', packed, '-o', unpacked, '-f');
	const before = filesOf(dir).sort(), after = filesOf(unpacked).sort();
	expect(before.join() === after.join(), `3d-tiles-tools: of ${before.length} files ${after.length} came back`);
	expect(after.every((name) => readFileSync(join(dir, name)).equals(readFileSync(join(unpacked, name)))),
		'3d-tiles-tools: what came back is not what was packed');
	console.log(`3d-tiles-tools: ${before.length} files`);
	rmSync(unpacked, { recursive: true });
	rmSync(packed);
}

// ---- Trees ----

/** Counts of a content: instances of plants, and drawn ones, a mesh's primitives each. */
function countsOf(name) {
	const { nodes, meshes, accessors } = JSON.parse(readFileSync(join(dir, name)));
	let instances = 0, drawn = 0;
	for (const { mesh, extensions } of nodes) {
		const attributes = extensions?.EXT_mesh_gpu_instancing?.attributes;
		const count = attributes ? accessors[attributes.TRANSLATION].count : 0;
		instances += count;
		drawn += count * (mesh === undefined ? 0 : meshes[mesh].primitives.length);
	}
	return { instances, drawn };
}

/** Every way from the root to a leaf: the names of contents on it. */
function waysOf(file, tile, above = []) {
	const uri = tile.content?.uri, name = uri && join(dirname(file), uri);
	if (name?.endsWith('.json'))
		return waysOf(name, JSON.parse(readFileSync(join(dir, name))).root, above);
	const way = name ? [...above, name] : above;
	return tile.children?.length ? tile.children.flatMap((child) => waysOf(file, child, way)) : [way];
}

// ---- Viewers ----

function serve() {
	const roots = { tiles: dir, npm: modules, '': here };
	return new Promise((done) => {
		const server = createServer((request, answer) => {
			const path = normalize(decodeURIComponent(request.url.split('?')[0])), [, first] = path.split('/');
			const file = roots[first] ? join(roots[first], path.slice(first.length + 1)) : join(here, path);
			if (!existsSync(file) || !statSync(file).isFile())
				return answer.writeHead(404).end();
			answer.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' });
			createReadStream(file).pipe(answer);
		}).listen(0, '127.0.0.1', () => done(server));
	});
}

/** How many colours a picture has, and how many of its pixels are not what most are. */
function looksOf(png) {
	return `(async () => {
		const bitmap = await createImageBitmap(await (await fetch('data:image/png;base64,${png.toString('base64')}')).blob());
		const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
		context.drawImage(bitmap, 0, 0);
		const pixels = new Uint32Array(context.getImageData(0, 0, bitmap.width, bitmap.height).data.buffer), counts = new Map();
		for (const pixel of pixels)
			counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
		return [counts.size, pixels.length - Math.max(...counts.values())];
	})()`;
}

async function draws(browser, base, viewer, ways) {
	const instancesAt = [];
	for (const distance of DISTANCES) {
		await browser.open(`${base}/${viewer}.html?distance=${distance}`, ...SIZE);
		await browser.until("document.body.dataset.complete === 'true'", 120000);
		const shown = await browser.evaluate('shown'), names = new Map(shown.map(({ uri, instances }) => [
			normalize(decodeURIComponent(new URL(uri, `${base}/tiles/`).pathname)).slice('/tiles/'.length), instances]));
		for (const [name, instances] of names) {
			const { instances: all, drawn } = countsOf(name);
			expect(instances === (viewer === 'renderer' ? drawn : all),
				`${viewer} at ${distance}: ${name} has ${instances} instances, its file ${all} of ${drawn} primitives`);
		}
		// near by, ground is left out where nobody sees it
		const drawnOf = (way) => way.filter((name) => names.has(name)).length;
		const wrong = ways.filter((way) => way.length && drawnOf(way) !== 1
			&& (drawnOf(way) || !way[0].includes('ground-')));
		expect(!wrong.length, `${viewer} at ${distance}: ${wrong.length} of ${ways.length} ways are not drawn once, as ${wrong[0]}`);
		const plants = [...names.keys()].reduce((sum, name) => sum + countsOf(name).instances, 0);
		const png = await browser.picture(), [colors, pixels] = await browser.evaluate(looksOf(png));
		writeFileSync(join(out, `${viewer}-${distance}.png`), png);
		expect(colors > 8 && pixels > 30, `${viewer} at ${distance}: a picture of ${colors} colours, ${pixels} pixels beside the background`);
		console.log(`${viewer} at ${distance} radii: ${names.size} contents, ${plants} plants, ${pixels} pixels`);
		instancesAt.push(plants);
	}
	expect(instancesAt[0] > 0 && instancesAt[0] >= instancesAt[1] && instancesAt[2] === 0,
		`${viewer}: ${instancesAt} plants from near to far`);
}

mkdirSync(out, { recursive: true });
await validate();
packAndUnpack();
const server = await serve(), browser = new Browser(chromium);
try {
	const ways = waysOf('tileset.json', JSON.parse(readFileSync(join(dir, 'tileset.json'))).root);
	for (const viewer of ['renderer', 'cesium'])
		await draws(browser, `http://127.0.0.1:${server.address().port}`, viewer, ways);
	expect(!browser.complaints.length, browser.complaints.join('\n'));
} finally {
	await browser.close();
	server.close();
}
process.exit(faults > 0 ? 1 : 0);
