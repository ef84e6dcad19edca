// compare.mjs DIR SITE CHROMIUM URL...: the browser's client against ecoview, view by view. Of each scene's
// URL, .../NAME, DIR has NAME.json, the camera script, and NAME, ecoview's folder of its frames with
// --owners, and with --digest's lines in NAME/said. In node: the hashes of what is decoded and drawn are the
// same. In CHROMIUM (none: ''): those, too, and of each picture's pixels that plants cover, and of those
// that show the right plant, P and R are at least .995, and of all pixels as many have ecoview's colours, but
// for 2 of 255. No pixel is read for a frame, and no shader of shadows is compiled where none are asked for. The shader
// of more samples is compiled after the first picture. NAME.options are the layer's, in JSON.
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser } from './browser.mjs';

const [dir, site, chromium, ...urls] = process.argv.slice(2);
const LEAST = 0.995, ERRORS_ASKED = 6;
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

/** A scene's views, each with its digest and the file of its owners. */
function readScene(url) {
	const name = url.split('/').pop(), out = join(dir, name);
	const { keyframes } = JSON.parse(readFileSync(join(dir, `${name}.json`)));
	const { width, height, frames } = JSON.parse(readFileSync(join(out, 'report.json')));
	const said = readFileSync(join(out, 'said'), 'utf8');
	const digests = [...said.matchAll(/^frame \d+: digest (\S+)$/gm)].map(([, digest]) => digest);
	if (!digests.length || digests.length !== keyframes.length)
		throw new Error(`${out}/said has ${digests.length} digests of ${keyframes.length} frames`);
	const file = (i, kind) => join(out, `frame-${String(i).padStart(4, '0')}.${kind}png`);
	const views = keyframes.map(({ time_s, ...view }, i) => ({
		what: `${name}, frame ${i}`,
		view: { up: [0, 0, 1], ...view },
		wanted: { width, height, vertices: frames[i].budget_vertices, bytes: -1 },
		digest: digests[i],
		pictures: [file(i, 'owners.'), file(i, '')],
	}));
	return { url, views, options: JSON.parse(readFileSync(join(dir, `${name}.options`))) };
}

async function inNode(scenes) {
	const load = (name) => import(pathToFileURL(resolve(site, name)));
	const { default: createClient } = await load('eco_client.mjs');
	const { EcoStream } = await load('eco_stream.mjs');
	const wasm = readFileSync(join(site, 'eco_client.wasm'));
	const instantiateWasm = (imports, done) => {
		WebAssembly.instantiate(wasm, imports).then(({ instance }) => done(instance));
		return {};
	};
	const client = await createClient({ instantiateWasm });
	for (const { url, views } of scenes) {
		const stream = new EcoStream(client, url);
		for (const { what, view, wanted, digest } of views) {
			await stream.fetch(view, wanted);
			stream.select();
			const ours = stream.digest();
			expect(ours === digest, `${what}: WebAssembly's digest is ${ours}, ecoview's ${digest}`);
		}
		stream.free();
	}
}

// Runs in the page.
async function openLayer(url, options) {
	const { EcoLayer } = await import('/viewer/eco_layer.mjs');
	const gl = new OffscreenCanvas(16, 16).getContext('webgl2');
	const onError = (error) => { globalThis.failed = error.message; };
	globalThis.tested?.free();
	Object.assign(globalThis, { shadowTexts: 0, meanTexts: 0, early: null });
	gl.shaderSource = (shader, text) => {
		shadowTexts += /#define (SHADOW|CELLS)/.test(text);
		meanTexts += /u_count > 0/.test(text);
		WebGL2RenderingContext.prototype.shaderSource.call(gl, shader, text);
	};
	globalThis.tested = new EcoLayer({ url, gl, firstBytes: Infinity, ...options, onError });
	await tested.ready;
}

async function drawFrame(view, wanted, samples, pictures) {
	const { width, height } = wanted;
	await tested.load({ view, ...wanted });
	const { gl } = tested;
	const calls = { readPixels: 0, getError: 0 };
	for (const name of Object.keys(calls))
		gl[name] = (...values) => {
			calls[name]++;
			return WebGL2RenderingContext.prototype[name].apply(gl, values);
		};
	tested.wanted = tested.asked;
	tested.present(view, [0, 0], width, height);
	globalThis.early ??= meanTexts;
	// all samples but the second in parts
	while (tested.sampled < samples && tested.refine(tested.sampled > 1 ? wanted.vertices / 3 : undefined))
		tested.present(view, [0, 0], width, height);
	Object.keys(calls).forEach((name) => delete gl[name]);
	const pixelsOf = async (picture) => {
		const bitmap = await createImageBitmap(await (await fetch(picture)).blob());
		const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
		context.drawImage(bitmap, 0, 0);
		return context.getImageData(0, 0, width, height).data;
	};
	const [theirs, colors] = await Promise.all(pictures.map(pixelsOf));
	const ours = tested.owners(), cover = tested.cover(), lit = tested.colors();
	const apart = (i, k) => Math.abs(lit[3 * i + k] - colors[4 * i + k]);
	// pixels of ours, of theirs, of both, of both with one owner, covered ones without an owner, and those of
	// another colour
	const counts = [0, 0, 0, 0, 0, 0];
	for (let i = 0; i < cover.length; i++) {
		const owner = ours[3 * i] | ours[3 * i + 1] << 8 | ours[3 * i + 2] << 16;
		const other = theirs[4 * i] | theirs[4 * i + 1] << 8 | theirs[4 * i + 2] << 16;
		[owner, other, owner && other, owner && owner === other, !owner !== !cover[i],
			[0, 1, 2].some((k) => apart(i, k) > 2)]
			.forEach((counted, k) => { counts[k] += !!counted; });
	}
	return { digest: tested.stream.digest(), sampled: [tested.sampled, meanTexts, early], counts, calls, shadowTexts, failed: globalThis.failed };
}

/** Three pictures with shadows of a driver that refuses a part of their programs: what is complained of, and how many
 * programs there are after each. */
async function refuseShadows(url, view, { width, height, ...budgets }) {
	const { EcoLayer } = await import('/viewer/eco_layer.mjs');
	const gl = new OffscreenCanvas(16, 16).getContext('webgl2'), { prototype: own } = WebGL2RenderingContext;
	let programs = 0;
	gl.shaderSource = (shader, text) => own.shaderSource.call(gl, shader, /#define ROWS/.test(text) ? 'refused' : text);
	gl.createProgram = () => { programs++; return own.createProgram.call(gl); };
	gl.deleteProgram = (program) => { programs -= !!program; own.deleteProgram.call(gl, program); };
	const layer = new EcoLayer({ url, gl, shadows: 'standard', firstBytes: Infinity }), errors = [], counts = [];
	await layer.ready;
	await layer.load({ view, width, height, ...budgets });
	layer.wanted = layer.asked;
	for (let i = 0; i < 3; i++) {
		try {
			layer.present(view, [0, 0], width, height);
		} catch (error) {
			errors.push(error.message);
		}
		counts.push(programs);
	}
	layer.free();
	return { errors, counts };
}

/** How many samples a picture has whose driver draws no half floats, and what is complained of. */
async function refuseSamples(url, view, { width, height, ...budgets }) {
	const { EcoLayer } = await import('/viewer/eco_layer.mjs'), errors = [];
	const gl = new OffscreenCanvas(16, 16).getContext('webgl2'), { prototype: own } = WebGL2RenderingContext;
	gl.getExtension = (name) => name.startsWith('EXT_color_buffer') ? null : own.getExtension.call(gl, name);
	const layer = new EcoLayer({ url, gl, firstBytes: Infinity, onError: ({ message }) => errors.push(message) });
	await layer.ready;
	await layer.load({ view, width, height, ...budgets });
	layer.wanted = layer.asked;
	layer.present(view, [0, 0], width, height);
	const said = [layer.refines, layer.refine(), layer.sampled, layer.refines];
	layer.free();
	return [...said, ...errors];
}

/** Pictures with shadows: before all is here, of a camera that moves, at rest, moving again, at rest again. Each is
 * told by whether shaders of shadows and of leaves are compiled, depths cleared (one of the picture, one of a map), and
 * whether it has leaves; the last two are hurried. */
async function keepShadows(url, view, { width, height, ...budgets }) {
	const { EcoLayer } = await import('/viewer/eco_layer.mjs');
	const gl = new OffscreenCanvas(16, 16).getContext('webgl2'), { prototype: own } = WebGL2RenderingContext;
	const said = [];
	let texts = 0, leaves = 0, clears = 0;
	gl.shaderSource = (shader, text) => {
		texts += /#define (SHADOW|CELLS)/.test(text);
		leaves += /#define LEAVES/.test(text);
		own.shaderSource.call(gl, shader, text);
	};
	gl.clearBufferfv = (...values) => {
		clears += values[0] === gl.DEPTH;
		own.clearBufferfv.apply(gl, values);
	};
	const layer = new EcoLayer({ url, gl, shadows: 'perspective', firstBytes: Infinity });
	await layer.ready;
	await layer.load({ view, width, height, ...budgets });
	for (const moving of [false, true, false, true, false, true, false]) {
		[texts, leaves, clears, layer.moving, layer.hurried] = [0, 0, 0, moving, said.length > 4];
		const eye = view.eye.map((v) => v + 0.01 * said.length);
		layer.present({ ...view, eye }, [0, 0], width, height);
		said.push([texts, leaves, clears, layer.leafy].map(Number).map((n) => Math.min(n, 2)).join(''));
		layer.wanted = layer.asked;
	}
	layer.free();
	return said;
}

async function inBrowser(scenes) {
	const browser = new Browser(chromium);
	const call = (f, ...values) => browser.evaluate(`(${f})(...${JSON.stringify(values)})`);
	let least = 1, requests = 0;
	try {
		await browser.open(new URL('/', scenes[0].url).href, 640, 480);
		await browser.until("document.getElementById('picture')?.dataset.complete === 'true'");
		const said = await browser.evaluate("document.getElementById('state').textContent");
		expect(said === '', `the page reports an error: ${said}`);
		for (const { url, views, options } of scenes) {
			await call(openLayer, url, options);
			for (const { what, view, wanted, digest: theirs, pictures } of views) {
				const data = pictures.map((file) =>
					`data:image/png;base64,${readFileSync(file).toString('base64')}`);
				const { digest, sampled, counts, calls, shadowTexts, failed } = await call(drawFrame, view, wanted,
					options.samples, data);
				expect(!failed && digest === theirs, `${what}: the page's digest is ${digest} `
					+ `(${failed ?? 'no error'}), ecoview's ${theirs}`);
				const [page, ecoview, both, alike, odd, other] = counts, most = Math.max(page, ecoview);
				expect(page > 0 && odd === 0, `${what}: of ${page} pixels ${odd} are covered by none`);
				console.log(`${what}: ${ecoview} pixels; covered P ${(both / page).toFixed(5)} R `
					+ `${(both / ecoview).toFixed(5)}, owners P ${(alike / page).toFixed(5)} R `
					+ `${(alike / ecoview).toFixed(5)}; ${JSON.stringify(options)}, ${other} other colours`);
				const { samples } = options;
				expect(String(sampled) === String([samples, samples > 1 ? 1 : 0, 0]),
					`${what}: samples, shaders for them, and those before the first picture: ${sampled}`);
				expect(!calls.readPixels, `${what}: pixels are read ${calls.readPixels} times for a frame`);
				expect(!shadowTexts === !options.shadows,
					`${what}: ${shadowTexts} shaders of shadows are compiled`);
				// whoever asks waits for all that is drawn: not once a list
				expect(calls.getError <= ERRORS_ASKED,
					`${what}: the GPU is asked ${calls.getError} times for errors`);
				expect(alike >= LEAST * most, `${what}: the page's picture differs from ecoview's`);
				expect(other <= (1 - LEAST) * wanted.width * wanted.height,
					`${what}: ${other} pixels have other colours than ecoview's`);
				least = Math.min(least, alike / most);
				requests++;
			}
		}
		const [{ url, views: [{ view, wanted }] }] = scenes;
		const { errors, counts } = await call(refuseShadows, url, view, wanted);
		expect(errors.length === 1 && errors[0].includes('where shadows lie') && counts[1] === counts[2],
			`shadows that are refused: ${errors.length} errors, ${errors[0]}; programs ${counts}`);
		const refused = await call(refuseSamples, url, view, wanted);
		expect(String(refused) === 'true,false,1,false', `samples that are refused: ${refused}`);
		const kept = String(await call(keepShadows, url, view, wanted));
		expect(kept === '0010,0010,2221,0011,0021,0010,0021',
			`shadows and leaves before all is here, at rest and while moving: ${kept}`);
		console.log(`${requests} requests: P and R of owners are at least ${least.toFixed(5)}`);
		expect(!browser.complaints.length, browser.complaints.join('\n'));
	} finally {
		await browser.close();
	}
}

const scenes = urls.map(readScene);
await inNode(scenes);
if (chromium)
	await inBrowser(scenes);
process.exit(faults > 0 ? 1 : 0);
