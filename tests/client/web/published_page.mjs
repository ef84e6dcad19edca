// published_page.mjs CHROMIUM URL VIEW PICTURE.png: a published folder in the viewer, by a host of plain files. It draws,
// says what a plant is and why the picture is as it is, goes to a link's view, VIEW being one that was saved, and asks
// for nothing that a server would have to make.
import { writeFileSync } from 'node:fs';
import { Browser } from './browser.mjs';

const [chromium, url, saved, picture] = process.argv.slice(2);
const complete = "document.getElementById('picture')?.dataset.complete === 'true'";
const WAIT_MS = 600000;          // pictures are drawn by the processor
const browser = new Browser(chromium);
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

const ask = (expression) => browser.evaluate(expression);
const entries = () => ask("performance.getEntriesByType('resource').map(({ name }) => name)");

try {
	await browser.open(url, 400, 300);
	await browser.until(complete, WAIT_MS);
	expect(await ask('viewer.drawn.facts.vertices') > 1000, 'hardly anything is drawn');
	// what the planner needs comes in the background, but not before the first picture
	const when = (name) => ask(`performance.getEntriesByType('resource').find((it) => it.name.endsWith('${name}')).toJSON()`);
	await browser.until("performance.getEntriesByType('resource').filter(({ name }) => /index.bin|eco_planner.wasm/.test(name)).length === 2", WAIT_MS);
	const { responseEnd } = await when('first-0.bin');
	for (const name of ['index.bin', 'eco_planner.wasm', 'eco_planner.js', 'eco_published.js'])
		expect((await when(name)).startTime >= responseEnd, `${name} is asked for before first-0.bin is there`);
	writeFileSync(picture, await browser.picture());
	let picked = null;
	for (let i = 0; i < 24 && picked?.kind !== 'plant'; i++) {
		await ask(`(before = viewer.picked, engine.postMessage({ type: 'pick', at: [${0.12 + 0.15 * (i % 6)}, ${0.4 + 0.1 * Math.floor(i / 6)}] }))`);
		await browser.until('viewer.picked && viewer.picked !== before', WAIT_MS);
		picked = await ask('viewer.picked');
	}
	expect(picked.kind === 'plant', 'no plant was found to click');
	await browser.until("document.getElementById('card-why').children.length > 0", WAIT_MS);
	expect(await ask("document.getElementById('card-title').textContent") === picked.plant, 'a plant is named otherwise');
	const many = (await entries()).length;
	await ask(`location.hash = '${saved}'`);
	await browser.until(`Math.abs(viewer.camera.view().eye[0] - ${/eye=([^,]+)/.exec(saved)[1]}) < .01`);
	await browser.until(complete, WAIT_MS);
	expect((await entries()).length === many, 'a view asks the network past the worker');
	await browser.open(`${url}#${saved}`, 400, 300);
	await browser.until(complete, WAIT_MS);
	expect((await entries()).every((name) => !name.includes('/v1/')), 'the page asks for what no static host has');
	expect(!browser.complaints.length, `the page says: ${browser.complaints.join('; ')}`);
} finally {
	await browser.close();
}
process.exit(faults ? 1 : 0);
