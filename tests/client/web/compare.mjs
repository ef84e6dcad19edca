// compare.mjs URL SCRIPT.json WxH VERTICES SITE OUT [CHROMIUM]: the browser's client against ecoview, frame
// by frame of a camera script. OUT is ecoview's folder of the same frames, with --digest's lines in
// OUT/said and masks of --reference. In node: the hashes of what is decoded and drawn are the same. In
// CHROMIUM: those, too, and each picture's mask has P and R of at least .995 against ecoview's.
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser } from './browser.mjs';

const [url, script, size, vertices, site, out, chromium] = process.argv.slice(2);
const [width, height] = size.split('x').map(Number);
const frames = JSON.parse(readFileSync(script)).keyframes
	.map(({ time_s, ...view }) => ({ up: [0, 0, 1], ...view }));
const wanted = { width, height, vertices: Number(vertices), bytes: -1 };
const digests = [...readFileSync(join(out, 'said'), 'utf8').matchAll(/^frame \d+: digest (\S+)$/gm)]
	.map(([, digest]) => digest);
const LEAST = 0.995;
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

async function inNode() {
	const load = (name) => import(pathToFileURL(resolve(site, name)));
	const { default: createClient } = await load('eco_client.mjs');
	const { EcoStream } = await load('eco_stream.mjs');
	const wasm = readFileSync(join(site, 'eco_client.wasm'));
	const instantiateWasm = (imports, done) => {
		WebAssembly.instantiate(wasm, imports).then(({ instance }) => done(instance));
		return {};
	};
	const stream = new EcoStream(await createClient({ instantiateWasm }), url);
	for (const [i, view] of frames.entries()) {
		await stream.fetch(view, wanted);
		stream.select();
		const digest = stream.digest();
		expect(digest === digests[i],
			`frame ${i}: WebAssembly's digest is ${digest}, ecoview's ${digests[i]}`);
	}
}

// Runs in the page.
async function openLayer(url) {
	const { EcoLayer } = await import('/viewer/eco_layer.mjs');
	const gl = new OffscreenCanvas(16, 16).getContext('webgl2');
	const onError = (error) => { globalThis.failed = error.message; };
	globalThis.tested = new EcoLayer({ url, gl, onError });
	await tested.ready;
}

async function drawFrame(view, wanted, mask) {
	const { width, height } = wanted;
	await tested.load({ view, ...wanted });
	tested.present(view, [0, 0], width, height);
	const bitmap = await createImageBitmap(await (await fetch(mask)).blob());
	const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
	context.drawImage(bitmap, 0, 0);
	const theirs = context.getImageData(0, 0, width, height).data, ours = tested.cover();
	const counts = [0, 0, 0];       // in both, in ours alone, in theirs alone
	for (let i = 0; i < ours.length; i++)
		if (ours[i] || theirs[4 * i])
			counts[ours[i] ? theirs[4 * i] ? 0 : 1 : 2]++;
	return { digest: tested.stream.digest(), counts, failed: globalThis.failed };
}

async function inBrowser() {
	const browser = new Browser(chromium);
	const call = (f, ...values) => browser.evaluate(`(${f})(...${JSON.stringify(values)})`);
	try {
		await browser.open(new URL('/', url).href, 640, 480);
		await browser.until("document.getElementById('picture')?.dataset.complete === 'true'");
		const said = await browser.evaluate("document.getElementById('state').textContent");
		expect(said === '', `the page reports an error: ${said}`);
		await call(openLayer, url);
		for (const [i, view] of frames.entries()) {
			const mask = join(out, `frame-${String(i).padStart(4, '0')}.mask.png`);
			const data = `data:image/png;base64,${readFileSync(mask).toString('base64')}`;
			const { digest, counts, failed } = await call(drawFrame, view, wanted, data);
			expect(!failed && digest === digests[i], `frame ${i}: the page's digest is ${digest} `
				+ `(${failed ?? 'no error'}), ecoview's ${digests[i]}`);
			const [tp, fp, fn] = counts, precision = tp / (tp + fp), recall = tp / (tp + fn);
			console.log(`frame ${i}: P ${precision.toFixed(5)} R ${recall.toFixed(5)} `
				+ `of ${tp + fn} pixels`);
			expect(Math.min(precision, recall) >= LEAST,
				`frame ${i}: the page's mask differs from ecoview's`);
		}
		expect(!browser.complaints.length, browser.complaints.join('\n'));
	} finally {
		await browser.close();
	}
}

if (!digests.length || digests.length !== frames.length)
	throw new Error(`${out}/said has ${digests.length} digests of ${frames.length} frames`);
await inNode();
if (chromium)
	await inBrowser();
process.exit(faults > 0 ? 1 : 0);
