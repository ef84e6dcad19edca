// first_picture.mjs CHROMIUM RUNS LINK BYTES: how long people wait for a picture. LINK, a permalink of the
// viewer, is opened through a line of 10 Mbit/s and 50 ms there and back: with an empty profile, and again
// with what the browser cached of the viewer (but of the scene nothing: a view a millimetre away, as the
// answer of a request that was made before is cached, too). Of each visit: when the first
// picture, the first of BYTES of the scene (from where on ecoview --progressive has the skill that is
// wanted), and the whole one are drawn, in milliseconds from the start of navigation, measured in the page;
// and when what a picture waits for was there. Also tasks of the page's thread of 50 ms or more, and how long
// keys that are pressed meanwhile wait.
import { Browser } from '../../client/web/browser.mjs';
import { shape } from '../../client/web/shape.mjs';

const [chromium, runs, link, bytes] = process.argv.slice(2);
const SIZE = [800, 600], BITS_PER_S = 1e7, ROUND_TRIP_MS = 50;
const complete = "document.getElementById('picture')?.dataset.complete === 'true'";

/** Runs in each page before its own scripts. */
function watch() {
	globalThis.seen = { drawn: [], tasks: [], waits: [] };
	const observe = (type, act, more = {}) => new PerformanceObserver((list) => list.getEntries().forEach(act))
		.observe({ type, buffered: true, ...more });
	observe('longtask', ({ startTime, duration }) => seen.tasks.push([startTime, duration]));
	observe('event', ({ name, startTime, processingEnd }) => {
		if (name.startsWith('key'))
			seen.waits.push(processingEnd - startTime);
	}, { durationThreshold: 16 });
	const { Worker } = globalThis;
	globalThis.Worker = class extends Worker {
		constructor(...parts) {
			super(...parts);
			seen.worker = performance.now();
			this.addEventListener('message', ({ data: { type, received, facts } }) => {
				if (type === 'opened')
					seen.opened = performance.now();
				if (type === 'drawn' && facts)
					seen.drawn.push([performance.now(), received, facts.predicted_q]);
			});
		}
	};
}

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

async function visit(browser, url) {
	await browser.open(url, ...SIZE);
	for (const end = Date.now() + 60000; Date.now() < end;) {
		// a key that does nothing to the picture
		await browser.send('Input.dispatchKeyEvent', { type: 'keyDown', key: 'x' });
		await browser.send('Input.dispatchKeyEvent', { type: 'keyUp', key: 'x' });
		if (await browser.evaluate(complete).catch(() => false))
			break;
		await new Promise((done) => setTimeout(done, 40));
	}
	const { drawn, tasks, waits, worker, opened } = await browser.evaluate('seen');
	const state = await browser.evaluate("document.getElementById('state').textContent");
	if (!drawn.length)
		throw new Error(`nothing was drawn: ${state}`);
	const files = await browser.evaluate(`performance.getEntriesByType('resource')
		.map(({ name, responseEnd, transferSize }) => [name, responseEnd, transferSize])`);
	const seen = drawn.map(([ms, received]) => `${Math.round(ms)} (${received} B)`);
	console.log(`pictures at ${seen.join(', ')} ms`);
	const good = drawn.find(([, received]) => received >= Number(bytes)) ?? drawn.at(-1);
	return { files: Math.max(...files.map(([, end]) => end)), worker, opened, first: drawn[0]?.[0],
		first_bytes: drawn[0]?.[1], good: good?.[0], good_bytes: good?.[1], whole: drawn.at(-1)?.[0],
		pictures: drawn.length, task: Math.max(0, ...tasks.map(([, ms]) => ms)), wait: Math.max(0, ...waits) };
}

function report(what, visits) {
	const text = (key) => `${key} ${Math.round(median(visits.map((one) => one[key] ?? NaN)))}`;
	console.log(`${what}: ${Object.keys(visits[0]).map(text).join(', ')}`);
	console.log(`  good, each: ${visits.map(({ good }) => Math.round(good)).join(' ')}`);
}

/** The link to a view a millimetre to the east. */
const beside = ({ href }) => href.replace(/(?<=[#&]eye=)[^,&]+/, (x) => (Number(x) + 0.001).toFixed(3));

const target = new URL(link), first = [], again = [];
const proxy = await shape(target.port, BITS_PER_S, ROUND_TRIP_MS);
target.port = proxy.port;
for (let i = 0; i < runs; i++) {
	const browser = new Browser(chromium);
	try {
		await browser.attach();
		await browser.send('Page.addScriptToEvaluateOnNewDocument', { source: `(${watch})()` });
		first.push(await visit(browser, target.href));
		await browser.evaluate(`new Promise((done) => { const r = indexedDB.deleteDatabase('ecostream');
			r.onsuccess = r.onerror = r.onblocked = () => done(1); localStorage.clear(); })`);
		await browser.open('about:blank', ...SIZE);
		again.push(await visit(browser, beside(target)));
	} finally {
		await browser.close();
	}
}
proxy.close();
report('empty cache', first);
report('again', again);
process.exit(0);
