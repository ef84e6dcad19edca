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
	const first = (await entries()).filter((name) => name.endsWith('.bin'));
	expect(first.length === 1 && first[0].endsWith('first-0.bin'), `the page asked for ${first}, not for first-0.bin`);
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
