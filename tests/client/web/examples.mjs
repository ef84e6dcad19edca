// examples.mjs URL FOLDER CHROMIUM PLANTS.csv OUT: the example pages, from a server of another origin than
// the scene's. Each draws all of the scene's view; things of three.js hide plants and are hidden; on the
// map plants stand where the scene's inventory (plant, easting, northing) has them, which basemap.geojson
// in FOLDER repeats. Pictures go to OUT.
import { createReadStream, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { basename, extname, join } from 'node:path';
import { Browser } from './browser.mjs';

const [url, folder, chromium, inventory, out] = process.argv.slice(2);
const SIZE = [640, 480], TRIED = 5;
const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript',
	'.css': 'text/css' };
const complete = "document.body.dataset.complete === 'true'";
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

const server = createServer((request, answer) => {
	const file = join(folder, basename(request.url.split('?')[0]));
	if (!existsSync(file))
		return answer.writeHead(404).end();
	answer.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/json' });
	createReadStream(file).pipe(answer);
});
await new Promise((done) => server.listen(0, '127.0.0.1', done));
const browser = new Browser(chromium), ask = (expression) => browser.evaluate(expression);

const addressOf = (name, scene) =>
	`http://127.0.0.1:${server.address().port}/${name}.html?scene=${encodeURIComponent(scene)}`;

async function open(name) {
	await browser.open(addressOf(name, url), ...SIZE);
	await browser.until(complete);
	writeFileSync(join(out, `${name}.png`), await browser.picture());
	const covered = await ask('example.layer.cover().reduce((sum, c) => sum + (c > 0), 0)');
	expect(covered > 300, `${name}: plants cover ${covered} pixels`);
}

/** Pixels of pure red in the page. */
async function reds() {
	const png = (await browser.picture()).toString('base64');
	return ask(`(async () => {
		const bitmap = await createImageBitmap(await (await fetch('data:image/png;base64,${png}')).blob());
		const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
		context.drawImage(bitmap, 0, 0);
		const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
		let count = 0;
		for (let i = 0; i < data.length; i += 4)
			count += data[i] > 250 && data[i + 1] < 5 && data[i + 2] < 5;
		return count;
	})()`);
}

/** The plants and the ground hide a part of what three.js draws alone. */
async function sharesDepths() {
	const both = await reds();
	await ask('example.alone = true; example.redraw(); new Promise((done) => setTimeout(done, 300))');
	const alone = await reds();
	expect(both > 0 && both < alone, `three: ${both} red pixels among plants, ${alone} without`);
}

/** Seen from straight above, a plant is in the middle of the map where its row says. */
async function standsWhereItsRowSays() {
	const rows = readFileSync(inventory, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
	const { features } = JSON.parse(readFileSync(join(folder, 'basemap.geojson')));
	const { origin } = await ask(`fetch('${url}').then((answer) => answer.json())`);
	let found = 0;
	for (const { geometry: { coordinates }, properties: { row } } of features.slice(0, TRIED)) {
		await ask(`document.body.dataset.complete = false;
			example.map.jumpTo({ center: [${coordinates}], zoom: 20, pitch: 0, bearing: 30 }); true`);
		await browser.until(complete);
		const { kind, foot } = await ask('example.layer.pick(0.5, 0.5)'), [, x, y] = rows[row - 1];
		const apart = kind === 'plant' ? Math.hypot(foot[0] + origin.at[0] - x, foot[1] + origin.at[1] - y) : 0;
		found += kind === 'plant';
		expect(apart < 0.05, `map: in the middle stands the plant at ${foot}, not that of row ${row}: ${x}, ${y}`);
	}
	expect(found > TRIED / 2, `map: ${found} of ${TRIED} plants are in the middle`);
}

/** Without a server, and without a scene, a page says so, and what to do. */
async function saysWhatIsMissing() {
	const missing = new URL('/v1/scenes/none', url).href, dead = 'http://127.0.0.1:9/v1/scenes/none';
	for (const name of ['bare', 'three', 'map'])
		for (const [scene, said] of [[dead, '--cors'], [missing, 'no scene'], ['', 'Say which scene']]) {
			await browser.open(addressOf(name, scene), ...SIZE);
			await browser.until("document.querySelector('.error')");
			const text = await ask("document.querySelector('.error').textContent");
			expect(text.includes(said), `${name} of '${scene}' says: ${text}`);
		}
}

try {
	await open('bare');
	await open('three');
	await sharesDepths();
	await open('map');
	await standsWhereItsRowSays();
	expect(!browser.complaints.length, browser.complaints.join('\n'));
	await saysWhatIsMissing();
} finally {
	await browser.close();
	server.close();
}
process.exit(faults > 0 ? 1 : 0);
