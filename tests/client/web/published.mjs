// published.mjs SITE FOLDER URL...: the planner of a published folder against ecoserve. URL: .../v1/scenes/NAME of the
// same packs. Twenty views of each, one after the other as a client asks, with what it holds by then; two of them say
// where the camera will be next, and four are within bytes: every body is ecoserve's, byte by byte, from a host that
// knows Range and from one that does not.
import { createHash } from 'node:crypto';
import { createServer } from 'node:http';
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [site, folder, ...urls] = process.argv.slice(2);
const rows = /"columns":\[/.test(readFileSync(join(folder, 'index.html')));     // then answers about plants are compared, too
const ROUNDS_MOST = 2;
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

/** A static host. */
async function serve(ranges) {
	const host = { bytes: 0, requests: 0 }, named = new Map();
	const server = createServer(({ url, headers }, answer) => {
		const bytes = readFileSync(join(folder, decodeURIComponent(url.split('?')[0])));
		// a browser fetches one name once at a time, so parts of one name would come one after another
		expect((named.get(url) ?? headers.range) === headers.range, `${url} names ${named.get(url)} and ${headers.range}`);
		named.set(url, headers.range);
		const [, first, last] = ranges && /^bytes=(\d+)-(\d+)$/.exec(headers.range ?? '') || [];
		const part = first === undefined ? bytes : bytes.subarray(Number(first), Number(last) + 1);
		host.requests++;
		host.bytes += part.length;
		answer.writeHead(first === undefined ? 200 : 206).end(part);
	});
	server.keepAliveTimeout = 0;     // else a connection may end as it is used again
	await new Promise((done) => server.listen(0, '127.0.0.1', done));
	host.url = `http://127.0.0.1:${server.address().port}/`;
	host.close = () => { server.closeAllConnections(); server.close(); };
	return host;
}

const load = (name) => import(pathToFileURL(resolve(site, name)));
const { Planner, RangeFile, rangesOf } = await load('eco_planner_worker.mjs');
const { default: createClient } = await load('eco_client.mjs');
const { EcoStream } = await load('eco_stream.mjs');
const wasmOf = (name) => ({ instantiateWasm: (imports, done) => {
	WebAssembly.instantiate(readFileSync(join(site, name)), imports).then(({ instance }) => done(instance));
	return {};
} });
const client = await createClient(wasmOf('eco_client.wasm'));
const hash = (bytes) => createHash('sha256').update(bytes).digest('hex').slice(0, 16);

/** Views near and far, above and among the plants. */
function viewsOf({ bounds: { low, high } }) {
	const middle = low.map((v, i) => (v + high[i]) / 2), size = Math.max(high[0] - low[0], high[1] - low[1]);
	const places = [[0.9, -0.2, 0.3], [-0.1, 0.3, 0.06], [0.3, 0.5, 0.9], [-0.6, -0.4, 0.1], [0.02, 0.05, 3],
		[0.15, -0.1, 0.02], [-2, 3, 1], [0, 0.4, 0.01], [0.45, 0.45, 0.02], [0.1, 0.1, 0.1],
		[-0.3, 0.1, 0.04], [0.01, -0.02, 0.005], [1.5, 1.2, 0.2], [-0.2, -0.2, 0.5]];
	const look = (place, wanted) => ({ view: { eye: middle.map((v, i) => v + place[i] * size + (i === 2)), target: middle,
		fov_y_deg: 45 }, wanted: { width: 640, height: 480, vertices: 300000, bytes: -1, ...wanted } });
	const next = { eye: middle.map((v, i) => v + [0.3, 0.2, 0.1][i] * size), target: middle };
	return [...places.map((place) => look(place)), look([0.2, 0.2, 0.05], { next }), look([0.3, -0.3, 0.05], { next }),
		look([0.5, 0.1, 0.1], { bytes: 40000, vertices: 80000 }), look([-0.3, 0.6, 0.2], { bytes: 14000, vertices: 20000 }),
		look([0.05, 0.2, 0.03], { bytes: 100000 }), look([0.8, -0.7, 0.4], { bytes: 250000, vertices: 1000000 })];
}

/** A plant that is marked is described, and the colour of its class is that of the class that ecoserve names. */
async function describe(url, about) {
	const stream = new EcoStream(client, url, { pack: about.id }), [{ view, wanted }] = viewsOf(about);
	await stream.fetch(view, { ...wanted, detail: 'all' });
	stream.select();
	expect(stream.near(9).length === 3 && stream.said('mark', -1, 0) === null, 'no three plants are near');
	for (const { list, index } of stream.near(9)) {
		const { tint, crown_m: crown, cuts } = stream.said('mark', list, index), [row] = await stream.rows(list, index, 1);
		const [{ name }] = about.tints[0].classes.filter(({ color }) => color === tint);
		expect(name === row.class && crown > 0.1 && cuts.length, `a ${row.class} plant: ${tint}, ${name}, ${crown} m wide, ${cuts.length} cuts`);
	}
	stream.free();
}

/** Compares all views of a scene; what the client holds grows as it does in a page. */
async function compare(url, host) {
	const about = await (await fetch(url)).json(), name = url.split('/').pop();
	const planner = await Planner.open(`${host.url}${name}/${about.id}/`, wasmOf('eco_planner.wasm'));
	const figures = { rounds: 0, server: 0, ms: 0, bodies: 0, equal: 0, index: host.bytes };
	const answering = async (path, body, good = true) => {
		const parts = [], since = performance.now();
		const { status, error } = await planner.answer(path, body, (part) => parts.push(part));
		figures.ms += performance.now() - since;
		expect(!error || !good, `${name}: ${error}`);
		figures.rounds = Math.max(figures.rounds, planner.rounds);
		return { status, bytes: Buffer.concat(parts) };
	};
	for (const fresh of [true, false]) {
		const stream = new EcoStream(client, url, { pack: about.id });
		const ask = stream.ask.bind(stream);
		stream.ask = async () => {
			const body = client._web_ask(stream.web);
			const holdings = client.HEAPU8.slice(body, body + client._web_body_size(stream.web));
			const query = stream.query(), answer = await ask();
			const theirs = Buffer.from(await answer.arrayBuffer()), ours = await answering(`/stream?${query}`, holdings);
			figures.server += theirs.length;
			const equal = ours.status === answer.status && hash(ours.bytes) === hash(theirs);
			figures.bodies++;
			figures.equal += equal;
			expect(equal, `${name}: ${ours.bytes.length} bytes ${hash(ours.bytes)}, not ecoserve's ${theirs.length} ${hash(theirs)}: ${query}`);
			return new Response(answer.status === 204 ? null : theirs, { status: answer.status });
		};
		for (const { view, wanted } of viewsOf(about).slice(fresh ? 0 : 1, fresh ? undefined : 2))
			await stream.fetch(view, wanted);
		stream.free();
	}
	const query = 'eye=0,-50,20&target=0,0,0&width=64&height=48&vertices=3000&explain=1';
	const theirs = await (await fetch(`${url}/plan?${query}`)).text(), ours = await answering(`/plan?${query}`);
	expect(JSON.parse(theirs).explanation.rows.length && ours.bytes.toString() === theirs.replace(/"scene":"[^"]*"/, '"scene":""')
		|| ours.bytes.toString() === theirs, `${name}: a plan is explained otherwise`);
	for (const path of !rows ? [] : [...Array(4).keys(), about.lists - 2, about.lists - 1, about.lists].map((list) => `/plants/${list}?count=20`)
		.concat(['a', 'good', '2', 'no such text'].map((text) => `/find?text=${encodeURIComponent(text)}&count=9`), '/find?count=3')) {
		// the page knows the class of a plant by its colour
		const answer = await fetch(url + path), text = (await answer.text()).replace(/,"class":"[^"]*"/g, '');
		const { status, bytes } = await answering(path, null, answer.ok);
		expect(status === answer.status && (!answer.ok || bytes.toString() === text),
			`${name}${path}: ${status} ${bytes}, not ecoserve's ${answer.status} ${text}`);
	}
	if (rows)
		await describe(url, about);
	const refused = await planner.answer(`/stream?${query.replace('&explain=1', '')}&pack=${'0'.repeat(32)}`, null, () => {});
	expect(refused.status === 409, `${name}: another pack is answered with ${refused.status}`);
	expect(figures.rounds <= ROUNDS_MOST, `${name}: ${figures.rounds} rounds for places of plants`);
	console.log(`${name}: ${figures.equal} of ${figures.bodies} bodies equal; index ${figures.index}, host ${host.bytes} in ${host.requests}, server ${figures.server} bytes; `
		+ `${figures.rounds} rounds, ${figures.ms.toFixed(0)} ms, ${planner.m.HEAPU8.length >> 20} MiB`);
	return figures;
}

const { Camera } = await load('viewer_camera.mjs');
for (const { about, first: [{ eye, width, height }] } of JSON.parse(/ id="published">(.*)<\/script>/.exec(
	readFileSync(join(folder, 'index.html')))[1])) {
	const camera = new Camera();
	camera.reach(about.bounds, about.near_m);
	camera.frame(about.look, width / height);
	expect(camera.view().eye.every((v, i) => Math.abs(v - eye[i]) < camera.distance / 1e4),
		`${about.name}: the first answer is for ${eye}, the viewer begins at ${camera.view().eye}`);
}
/** Parts of a file of numbers from a host that fails at first, and later ignores Range once. */
async function readParts() {
	const { fetch } = globalThis, answers = [null, [206, 1], [206, 4], [200, 9]], file = new RangeFile('chunks.bin');
	globalThis.fetch = async () => {
		const [status, size] = answers.shift() ?? [];
		if (!status)
			throw new TypeError('no network');
		return new Response(Uint8Array.from({ length: size }, (_, i) => i), { status });
	};
	const parts = [];
	for (let i = 0; i < 3; i++)
		parts.push(await file.read(2, 6).then((bytes) => [...bytes].join(), ({ message }) => message));
	globalThis.fetch = fetch;
	return parts.join(' ');
}
const parts = await readParts();
expect(parts === 'no network 0,1,2,3 2,3,4,5', `parts of a file are ${parts}`);
expect(rangesOf([[0, 10, 1], [1000, 10, 2], [3000, 10, 3], [0, 10, 4]]).length === 3, 'ranges are not merged by gaps');
for (const ranges of [true, false]) {
	for (const url of urls) {
		const host = await serve(ranges);
		await compare(url, host);
		expect(ranges || host.requests === 2, `a host without Range was asked ${host.requests} times`);
		host.close();
	}
}
process.exit(faults ? 1 : 0);
