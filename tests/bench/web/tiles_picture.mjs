// tiles_picture.mjs TILES MODULES CHROMIUM CAMERA.json SIZE OUT.png: the first view of a camera script, of a
// scene that ecopack export --3dtiles wrote to TILES, in 3d-tiles-renderer (MODULES: make tiles-viewers), as a
// picture of SIZE (WxH) that tests/bench/apart.c compares with ecoview's by --tint own. Says which contents are
// drawn and how many bytes were fetched for it, as they are and by gzip -6.
import { createReadStream, existsSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { Browser } from '../../client/web/browser.mjs';

const [dir, modules, chromium, script, size, out] = process.argv.slice(2);
const here = join(dirname(fileURLToPath(import.meta.url)), '../../ecopack/tiles');
const [width, height] = size.split('x').map(Number), WAIT_MS = 600000;
const types = { '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json', '.gltf': 'model/gltf+json' };
const fetched = new Set();

const server = createServer((request, answer) => {
	const path = normalize(decodeURIComponent(request.url.split('?')[0])), [, first, ...rest] = path.split('/');
	const root = { tiles: dir, npm: modules }[first], file = root ? join(root, ...rest) : join(here, path);
	if (!existsSync(file) || !statSync(file).isFile())
		return answer.writeHead(404).end();
	if (first === 'tiles')
		fetched.add(file);
	answer.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' });
	createReadStream(file).pipe(answer);
});
await new Promise((done) => server.listen(0, '127.0.0.1', done));
const { eye, target, fov_y_deg: fov } = JSON.parse(readFileSync(script)).keyframes[0];
const browser = new Browser(chromium), begun = Date.now();
try {
	await browser.open(`http://127.0.0.1:${server.address().port}/renderer.html?eye=${eye}&target=${target}&fov=${fov}`,
		width, height);
	await browser.until("document.body.dataset.complete === 'true'", WAIT_MS);
	const shown = await browser.evaluate('shown');
	writeFileSync(out, await browser.picture());
	const files = [...fetched].map((file) => readFileSync(file));
	const sum = (size) => files.reduce((bytes, file) => bytes + size(file), 0);
	const instances = shown.reduce((count, one) => count + one.instances, 0);
	console.log(`${shown.length} contents with ${instances} instances of primitives, after ${Date.now() - begun} ms; `
		+ `${files.length} files fetched, ${sum((file) => file.length)} bytes, ${sum((file) => gzipSync(file).length)} by gzip`);
	if (browser.complaints.length)
		console.log(browser.complaints.join('\n'));
} finally {
	await browser.close();
	server.close();
}
