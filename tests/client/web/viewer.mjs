// viewer.mjs URL CHROMIUM PLANTS.csv SCRIPT.json RELOAD [BELOW]: the page at / as somebody uses it, by pointer and by
// keyboard. URL is the scene's, PLANTS.csv its inventory (plant, easting, northing, height_m). What was
// recorded goes to SCRIPT.json. RELOAD is a command that gives the scene a pack of other plants. The server
// also has scenes named park, dusk of the same pack, and bare without a CRS. BELOW is the page's address by a
// proxy that has the server below a path.
import { execSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { Browser } from './browser.mjs';
import { shape } from './shape.mjs';

const [url, chromium, inventory, script, reload, below] = process.argv.slice(2);
const name = url.split('/').pop(), page = new URL(`/#scene=${name}&vertices=300000`, url).href;
const axe = 'build/web/npm/node_modules/axe-core/axe.min.js';
const samples = (count) => `document.getElementById('picture').dataset.samples === '${count}'`;
const complete = "document.getElementById('picture')?.dataset.complete === 'true'";
const rows = readFileSync(inventory, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
const browser = new Browser(chromium);
let faults = 0;

function expect(good, text) {
	if (!good)
		console.log(text);
	faults += !good;
}

const ask = (expression) => browser.evaluate(expression);
const hidden = (id) => ask(`document.getElementById('${id}').hidden`);
const text = (id) => ask(`document.getElementById('${id}').textContent`);

async function press(key, more = {}) {
	await browser.send('Input.dispatchKeyEvent', { type: 'keyDown', key, ...more });
	await browser.send('Input.dispatchKeyEvent', { type: 'keyUp', key, ...more });
}

const focused = () => ask('document.activeElement.id');
const openMenu = (id) => ask(`document.querySelector('#${id} > summary').click()`);
/** Moves the slider of the sun, or chooses another setting as a person does. */
const choose = (id, value, event = 'change') => ask(`{ const box = document.getElementById('${id}');
	box.value = '${value}'; box.dispatchEvent(new Event('${event}')); }`);
const chooseMode = (mode) => ask(`document.querySelector('[data-mode=${mode}]').click()`);

async function pressTab() {
	const tab = { key: 'Tab', code: 'Tab', windowsVirtualKeyCode: 9 };
	await browser.send('Input.dispatchKeyEvent', { type: 'rawKeyDown', ...tab });
	await browser.send('Input.dispatchKeyEvent', { type: 'keyUp', ...tab });
}

async function click(x, y) {
	for (const type of ['mousePressed', 'mouseReleased'])
		await browser.send('Input.dispatchMouseEvent', { type, x, y, button: 'left', clickCount: 1 });
}

/** The picture as it is on the screen, below the bar, without what is said of it. */
async function onScreen() {
	await ask("document.getElementById('card').style.opacity = 0");
	await browser.until(`${samples(16)} && ${complete}`);
	const png = await browser.picture({ x: 0, y: 60, width: 640, height: 350, scale: 1 });
	await ask("document.getElementById('card').style.opacity = ''");
	return png;
}

/** The height of what stands nearest to a place, and how near that is. */
function rowAt(easting, northing) {
	const apart = ([, x, y]) => Math.hypot(x - easting, y - northing);
	const row = rows.reduce((a, b) => apart(a) < apart(b) ? a : b);
	return { plant: row[0], height: Number(row[3]), apart: apart(row), number: rows.indexOf(row) + 1 };
}

/** A plant that is clicked says its species, also where the scene shows it as another, and its height, stands where its
 * row says, and which row that is. */
async function picksAPlant() {
	const { origin } = await ask('viewer.about');
	await press('h');
	await browser.until(complete);
	let picked = null, row = null, place = null;
	for (let i = 1; i < 16 && row?.plant !== 'cards-3'; i++)
		for (let j = 2; j < 7 && row?.plant !== 'cards-3'; j++) {
			if (picked)
				await press('Escape');
			place = [640 * i / 16, 480 * j / 8];
			await click(...place);
			if (!picked)
				expect(await ask("document.activeElement.id === 'picture' && !document.activeElement.matches(':focus-visible')"),
					'a click leaves the focus elsewhere, or draws a ring as for keys');
			await browser.until('viewer.picked');
			picked = await ask('viewer.picked');
			if (picked.kind === 'plant')
				row = rowAt(picked.foot[0] + origin.at[0], picked.foot[1] + origin.at[1]);
		}
	await browser.until(complete);
	const models = await ask('viewer.drawn.facts.models'), total = (list) => list.reduce((a, b) => a + b, 0);
	const apart = total(models.map((m) => m.height_m * m.count)) / total(rows.map((r) => Number(r[3])));
	expect(Math.abs(apart - 1) < 0.01, `all plants together are ${apart} times as high as their rows say`);
	expect(row?.plant === 'cards-3', 'no plant was found to click that is shown as another');
	expect(row.apart < 0.02 && picked.plant === 'cards-2',
		`a ${picked.plant} at ${picked.foot}: its row is a ${row.plant}, ${row.apart} m away`);
	expect(Math.abs(picked.height_m / row.height - 1) < 0.01,
		`it is ${picked.height_m} m high; its row says ${row.height} m`);
	await browser.until("document.querySelectorAll('#card-why li').length > 0");
	expect(await text('card-title') === row.plant, `a ${row.plant} is called ${await text('card-title')}`);
	const said = await text('card');
	const at = (picked.foot[0] + origin.at[0]).toFixed(2);
	const file = inventory.split('/').pop();
	expect(picked.crown_m > 0.1 && picked.crown_m < 40, `its crown is ${picked.crown_m} m wide`);
	for (const part of [at, origin.crs, 'Why: ', 'Crown width', 'Shown ascards-2', `Row${row.number} of ${file} (line ${row.number + 1})`])
		expect(said.includes(part), `what is said of the plant lacks ${part}: ${said}`);
	await ask("document.getElementById('picture').focus()");
	await pressTab();
	expect(await focused() === 'card-orbit', `after the picture the focus goes to ${await focused()}`);
	const marked = await onScreen();
	await press('Escape');
	const plain = await onScreen();
	expect(!marked.equals(plain), 'a plant that is clicked is not highlighted');
	await press('i');
	await browser.until('viewer.picked');
	await press('Escape');
	expect(plain.equals(await onScreen()), 'a highlight stays where the card is closed');
	await click(...place);
	await browser.until('viewer.picked');
	await ask("document.getElementById('card-orbit').click()");
	const [dx, dy] = await ask('viewer.camera.target').then((t) => t.map((v, i) => v - picked.foot[i]));
	expect(Math.hypot(dx, dy) < 1e-6, 'the camera does not look at the plant');
	await press('Escape');
	expect(await hidden('card'), 'Escape leaves the card');
}

async function showsItsFigures() {
	await openMenu('layers');
	await browser.until("document.querySelectorAll('#species li').length > 0");
	const two = "[...document.querySelectorAll('#species details')].find((box) => box.textContent.includes('Shown as cards-2'))";
	// a picture that comes later would take the focus from the list
	await browser.until(`${complete} && ${two}`);
	const both = await ask(`${two}.querySelector('summary').textContent`);
	expect(['cards-2 and cards-3', 'cards-3 and cards-2'].includes(both), `the legend calls both ${both}`);
	const high = `${two}.clientHeight`, low = await ask(high);
	await ask(`${two}.querySelector('summary').focus()`);
	await press(' ', { code: 'Space', text: ' ' });
	await browser.until(`${high} > ${low}`);
	// it stays open where the picture changes
	await press('h');
	await browser.until(`${complete} && ${high} > ${low}`);
	await openMenu('more');
	await ask("document.getElementById('details').open = true");
	expect(!await ask("document.getElementById('layers').open"), 'two menus are open');
	const { facts } = await ask('viewer.drawn');
	const drawn = facts.roles.filter(({ vertices }) => vertices);
	const sum = drawn.reduce((vertices, role) => vertices + role.vertices, 0);
	expect(sum === facts.vertices && sum <= 300000,
		`representations do not add up to ${facts.vertices} vertices`);
	const legend = await ask("document.querySelectorAll('#roles li').length");
	expect(legend === drawn.length, `${drawn.length} representations, ${legend} in the legend`);
	expect(facts.predicted_q > 0 && facts.predicted_q <= 1, `Q is ${facts.predicted_q}`);
	expect(facts.predicted_m16 >= 0 && facts.predicted_m16 < 20, `m16 is ${facts.predicted_m16}`);
	await ask("document.getElementById('explain').click()");
	await browser.until("document.querySelectorAll('#why .why').length > 0");
	const spent = await ask("[...document.querySelectorAll('#spent li')].map((li) => li.textContent)");
	const shares = spent.map((line) => /(\d+) %$/.exec(line)?.[1]).map(Number);
	const all = shares.reduce((a, b) => a + b, 0);
	expect(Math.abs(all - 100) <= spent.length && shares.every((v, i) => !i || v <= shares[i - 1] + 1),
		`what vertices are spent on does not add up: ${spent}`);
	expect(!/hull|lambda|summary|undefined/.test(spent + await text('why')), `the planner's words: ${spent}`);
	await press('c');
	expect(await ask('viewer.settings.kind') === 1, 'C does not change colours');
	await press('c');
	await ask("document.querySelector('#more > summary').focus()");
	await pressTab();
	expect(await focused() === 'whole', `in the menu the focus goes first to ${await focused()}`);
	await press('Escape');
	expect(!await ask("document.getElementById('more').open") && await ask("document.activeElement.parentElement.id === 'more'"),
		'Escape does not lead out of the menu');
	await ask("document.getElementById('picture').focus()");
}

async function movesByKeyboard() {
	const before = await ask('viewer.camera.view()');
	await browser.send('Input.dispatchKeyEvent', { type: 'keyDown', key: 'ArrowLeft' });
	await browser.until(`viewer.camera.view().eye[0] !== ${before.eye[0]}`);
	await browser.send('Input.dispatchKeyEvent', { type: 'keyUp', key: 'ArrowLeft' });
	const { eye } = await ask('viewer.camera.view()');
	expect(Math.hypot(...eye.map((v, i) => v - before.target[i])) > 1, 'the eye left its orbit');
	await browser.until(complete);
}

/** Layers are left out, and come back; a walker still stands on ground that is not drawn. A link has them. */
async function hasLayers() {
	const toggle = (layer) => ask(`document.querySelector('[data-layer=${layer}]').click()`), all = await onScreen();
	for (const layer of ['plants', 'ground']) {
		await toggle(layer);
		await browser.until(`location.hash.includes('hide=${layer}') && ${complete}`);
		const without = await onScreen();
		expect(!without.equals(all), `without ${layer} the picture is the same`);
		if (layer === 'plants') {
			await click(...(await ask("[innerWidth / 2, innerHeight * .7]")));
			await browser.until('viewer.picked');
			expect(await ask("viewer.picked.kind === 'ground'"), 'a plant that is not drawn is clicked');
			await press('Escape');
		}
		expect(await ask('viewer.drawn.ground') !== null, 'no ground to stand on');
		await toggle(layer);
		await browser.until(`location.hash.includes('hide=&') && ${complete}`);
		expect(all.equals(await onScreen()), `with ${layer} again the picture is another`);
	}
	expect(await hidden('has-objects'), 'a scene without objects offers them');
}

/** The vertices are the device's own until somebody chooses some, and the page keeps them. */
async function findsItsBudget() {
	const [before, after, kept] = await ask(`(() => { const before = viewer.budget; viewer.heard.paced({ factor: 1.5 });
		return [before, viewer.budget, localStorage.getItem('vertices')]; })()`);
	expect(after === Math.round(before * 1.5) && kept === String(after), `a budget of ${before} becomes ${after}, ${kept} is kept`);
	await choose('vertices', 14, 'input');
	await browser.until(`viewer.drawn.facts.vertices <= 16384 && location.hash.includes('vertices=16384') && ${complete}`);
	await choose('vertices', 0, 'input');
	await ask('viewer.heard.paced({ factor: 1 / 1.5 })');
	await browser.until(`viewer.drawn.facts.vertices > 16384 && location.hash.includes('vertices=0&') && ${complete}`);
	// pictures are compared from here on
	await ask("location.hash = location.hash.replace('vertices=0', 'vertices=300000')");
	await browser.until(`viewer.settings.vertices === 300000 && ${complete}`);
}

/** The sun of a time at the scene's place lights the picture, and is part of a link. */
async function hasASun() {
	const picture = savePlain;
	const usual = await picture();
	expect(await text('sun-text') === '10:00', `the sun is usually at ${await text('sun-text')}`);
	const { longitude_deg: longitude } = await ask('viewer.about.origin');
	await choose('date', '2026-06-21');
	await choose('sun', 720, 'input');
	await browser.until(complete);
	const noon = await picture(), minute = Math.round(Date.UTC(2026, 5, 21, 12) / 60000 - longitude * 4);
	const utc = new Date(minute * 60000).toISOString().slice(0, 16);
	expect(await ask('viewer.settings.sun') === utc, `noon is at ${await ask('viewer.settings.sun')}, not ${utc}`);
	await choose('sun', 1380, 'input');
	await browser.until(`location.hash.includes('sun=2026-06-21T') && ${complete}`);
	expect(!usual.equals(noon) && !noon.equals(await picture()), 'the hour changes nothing');
	await ask("location.hash = location.hash.replace(/&sun=[^&]*/, '&sun=')");
	await browser.until(`viewer.settings.sun === '' && ${complete}`);
	expect(usual.equals(await picture()), 'without an hour the picture is not what it was');
}

/** A walker stands on the ground, and stays there. */
async function walks() {
	const stands = 'Math.abs(viewer.camera.view().eye[2] - 1.7 - viewer.drawn.ground) < 0.02';
	await chooseMode('walk');
	await browser.until(`viewer.drawn.ground !== null && ${stands} && ${complete}`);
	const before = await ask('viewer.camera.view().eye');
	await browser.send('Input.dispatchKeyEvent', { type: 'keyDown', key: 'w' });
	await browser.until(`Math.hypot(viewer.camera.view().eye[0] - ${before[0]},
		viewer.camera.view().eye[1] - ${before[1]}) > 0.5`);
	await browser.send('Input.dispatchKeyEvent', { type: 'keyUp', key: 'w' });
	await browser.until(`${stands} && ${complete}`);
	await chooseMode('orbit');
}

/** The bytes of what the page offers to save while `act` is done. */
async function saved(act) {
	await ask(`globalThis.makeUrl ??= URL.createObjectURL;
		URL.createObjectURL = (blob) => { globalThis.offered = blob; return makeUrl(blob); };
		globalThis.offered = null`);
	await act();
	await browser.until('globalThis.offered');
	return Buffer.from(await ask(`offered.arrayBuffer().then((b) => [...new Uint8Array(b)])`));
}

/** The picture alone: a measured error names vertices by what the machine can do. */
const savePlain = () => saved(async () => {
	await ask("document.getElementById('caption').checked = false");
	await press('p');
});

/** Views are kept by the link and the browser, and a tour goes through them, as does ecoview by its script. */
async function keepsViews() {
	const clickOn = (id) => ask(`document.getElementById('${id}').click()`);
	await clickOn('add-view');
	await ask('viewer.camera.move(5, 0, 2)');
	await clickOn('add-view');
	const saidScript = await saved(() => clickOn('script')), { fps, keyframes } = JSON.parse(saidScript);
	expect(fps > 0 && keyframes.length === 2 && keyframes[1].eye[0] !== keyframes[0].eye[0], `a script of ${keyframes.length} views`);
	writeFileSync(script, saidScript);
	expect(await ask("location.hash.match(/views=[^&]*/)[0].split('~').length") === 5, 'the link lacks views');
	const at = (seconds, jumps = false) => ask(`import('/viewer/viewer_tools.mjs')
		.then(({ tourAt }) => tourAt(viewer.settings.views, ${seconds}, ${jumps}))`);
	const [from, to] = keyframes.map(({ eye }) => eye), middle = (await at(6 * 0.65)).eye;
	expect(String((await at(1)).eye) === String(from) && String((await at(6)).eye) === String(to) && await at(12) === null
		&& String((await at(5, true)).eye) === String(from), 'a tour does not lead from view to view');
	expect(middle.every((v, i) => Math.abs(v - (from[i] + to[i]) / 2) < 1e-6), `half way is ${middle}`);
	await clickOn('tour');
	await browser.until(`Math.hypot(...viewer.camera.view().eye.map((v, i) => v - [${from}][i])) < 1e-3`);
	await press('ArrowLeft');
	expect(await ask("document.getElementById('tour').getAttribute('aria-pressed') === 'false'"), 'a key does not end a tour');
	await ask("document.querySelector('#view-list [aria-label^=Remove]').click()");
	const kept = await ask('JSON.parse(localStorage.getItem(`views ${location.pathname}${viewer.settings.scene}`)).length');
	expect(kept === 1 && await ask('viewer.settings.views.length') === 1, `a view is not removed: ${kept} are kept`);
	await browser.until(complete);
}

/** Pictures have the size that is asked for, and a caption below them. */
async function savesPictures() {
	const sizes = async (caption) => {
		await ask(`document.getElementById('caption').checked = ${caption}`);
		const png = await saved(() => press('p'));
		expect(png.toString('latin1', 1, 4) === 'PNG' && png.length > 10000, `a picture of ${png.length} bytes`);
		return [png.readUInt32BE(16), png.readUInt32BE(20)];
	};
	await choose('still-width', 800);
	await choose('still-height', 500);
	const plain = await sizes(false), setVertices = async (from, to) => {
		await ask(`location.hash = location.hash.replace('vertices=${from}', 'vertices=${to}')`);
		await browser.until(`viewer.settings.vertices === ${to} && ${complete}`);
	};
	await setVertices(300000, 3000);
	const [width, height] = await sizes(true), [, count, flip, m16] = /(?:full detail \(|beside )([0-9.]+).* vertices\)?: FLIP (\S+), m16 (\S+)/.exec(await text('error')) ?? [];
	expect(count > 3 && flip > 0.001 && flip < 0.9 && m16 > 0.01 && m16 < 50, `the picture's error is ${await text('error')}`);
	await setVertices(3000, 300000);
	expect(await ask('viewer.drawn.facts.vertices <= 300000'), 'after a measurement all detail is drawn');
	expect(String(plain) === '800,500' && width === 800 && height > 530, `pictures of ${plain} and ${[width, height]}`);
	await browser.until(`document.getElementById('picture').dataset.complete === 'true'`);
	await ask("dispatchEvent(new Event('resize'))");
	expect(await ask("document.getElementById('still-width').value === '640'"), 'a picture is not as wide as the window by itself');
}

/** A species and a row are found among the plants in view; one that is chosen is looked at. */
async function findsPlants() {
	const found = async (words) => {
		await ask(`document.getElementById('found-note').textContent = ''`);
		await choose('query', words, 'input');
		await browser.until("document.getElementById('found-note').textContent !== ''");
		return ask("[...document.querySelectorAll('#found button')].map((one) => one.textContent)");
	};
	await press('h');
	await browser.until(complete);
	const three = rows.filter(([plant]) => plant === 'cards-3').length, all = await found('CARDS-3');
	expect(all.length === Math.min(20, three) && all.every((one) => one.startsWith('cards-3')), `of ${three}: ${all}`);
	const [row, ...others] = await found('7');
	expect(!others.length && row.includes('row 7 of'), `row 7 is ${row}, ${others}`);
	await ask("document.querySelector('#found button').click()");
	const { origin } = await ask('viewer.about'), { foot } = await ask('viewer.picked');
	expect(rowAt(foot[0] + origin.at[0], foot[1] + origin.at[1]).number === 7 && !await hidden('card'), 'another plant is chosen');
	// once it is in view its card is as that of one that was clicked
	await browser.until("document.querySelectorAll('#card-why li').length > 0");
	for (const part of ['Crown width', 'Why: ', 'Row7 of'])
		expect((await text('card')).includes(part), `the card of a plant that was found lacks ${part}: ${await text('card')}`);
	await press('Escape');
	expect(!(await found('no such tree')).length, 'something is found that is not there');
	await press('h');
	await browser.until(complete);
}

/** Two clicks on the ground measure what the camera knows. */
async function measures() {
	await press('m');
	await ask('viewer.heard.picked({ picked: { at: [1, 2, 3] } }), viewer.heard.picked({ picked: { kind: "sky" } })');
	await ask('viewer.heard.picked({ picked: { at: [4, 6, 15] } })');
	expect(await text('measured') === '13.0 m apart; 5.00 m level, 12.0 m high', `measured: ${await text('measured')}`);
	await click(320, 300);
	await browser.until("document.getElementById('measured').textContent.includes('to')");
	expect(await hidden('card'), 'who measures is told what a plant is');
	await press('Escape');
	expect(await hidden('measured'), 'Escape does not end a measurement');
	await browser.until("!document.querySelectorAll('#marks circle').length");
}

/** In a browser of German readers the page is German, all of it. */
async function speaksGerman() {
	const texts = () => ask(`[...document.body.querySelectorAll('*')].flatMap((e) => [e.ariaLabel, e.title,
		...[...e.childNodes].filter((n) => n.nodeType === 3).map((n) => n.data.trim())])
		.filter((text) => /[a-z]{2}/i.test(text ?? ''))`);
	await browser.open(new URL('/#scene=bare', url).href, 640, 480);
	await browser.until(complete);
	const agent = await ask('navigator.userAgent'), english = await texts();
	await browser.send('Emulation.setUserAgentOverride', { userAgent: agent, acceptLanguage: 'de-DE' });
	await browser.open(new URL('/#scene=bare', url).href, 640, 480);
	await browser.until(complete);
	const german = await texts(), same = german.filter((text) => english.includes(text));
	const alike = ['bare', 'grass', 'Link', 'city', 'dusk', 'meadow', 'park', 'kinds', 'picture', 'shade'];
	expect(await ask("document.documentElement.lang") === 'de' && german.includes('Ebenen') && german.length > 60,
		`German: ${german.slice(0, 9)}`);
	expect(same.every((text) => alike.includes(text) || /^[\d.,:×cm ]+$/.test(text)), `not German: ${same}`);
	await browser.send('Emulation.setUserAgentOverride', { userAgent: agent, acceptLanguage: 'en' });
}

/** Nothing that axe-core finds serious, whatever is open, in light and in dark. */
async function isAccessible() {
	for (const [width, height, dark] of [[1440, 900, false], [390, 844, true]]) {
		await browser.open(page, width, height, { dark, mobile: width < 500 });
		await browser.until(complete);
		await ask(`${readFileSync(axe, 'utf8')};1`);
		for (const menu of ['layers', 'find', 'views', 'more']) {
			await openMenu(menu);
			await ask("document.getElementById('details').open = true");
			const found = await ask(`axe.run().then(({ violations }) => violations.filter(({ impact }) =>
				['serious', 'critical'].includes(impact)).map(({ id, nodes }) => id + ': ' + nodes.map(({ target }) => target)))`);
			expect(!found.length, `${menu} at ${width} x ${height}: ${found.join('; ')}`);
		}
	}
}

/** A picture that is asked for in a motion is saved once that has ended, and then it is the whole one. */
async function savesWhatIsWhole() {
	const hold = (type) => browser.send('Input.dispatchKeyEvent', { type, key: 'ArrowLeft' });
	const moving = await saved(async () => {
		const before = await ask('viewer.drawn.number');
		await ask("document.getElementById('caption').checked = false");
		await hold('keyDown');
		await browser.until(`viewer.drawn.number > ${before} + 3`);
		await press('p');
		await ask('new Promise((done) => setTimeout(done, 300))');
		expect(!await ask('globalThis.offered'), 'the picture of a motion is saved');
		await hold('keyUp');
	});
	expect(await ask(`+document.getElementById('picture').dataset.samples >= 16 && ${complete}`), 'the picture is saved before it has its samples');
	expect(moving.equals(await savePlain()), 'what is saved in a motion is not the whole picture');
}

/** A link shows the same view, and what came once does not come again. */
async function comesBack() {
	await browser.until(`location.hash.includes('eye=') && ${complete}`);
	await ask('new Promise((done) => setTimeout(done, 400))');
	const link = await ask('location.href'), { eye } = await ask('viewer.camera.view()');
	await browser.open(link, 640, 480);
	await browser.until(complete);
	const again = await ask('viewer.camera.view()'), { received, facts } = await ask('viewer.drawn');
	expect(again.eye.every((v, i) => Math.abs(v - eye[i]) < 0.01),
		`the link shows ${again.eye}, not ${eye}`);
	expect(received < 0.2 * facts.bytes, `${received} bytes came again, of ${facts.bytes} that are held`);
	// by the worker, too: it fetches the modules that the page only asked for ahead
	const files = await ask(`performance.getEntriesByType('resource')
		.filter(({ name }) => name.includes('/viewer/'))
		.map(({ name, transferSize }) => [name.split('/').pop(), transferSize])`);
	const asked = files.filter(([, bytes]) => bytes).map(([file]) => file);
	expect(files.some(([file]) => file === 'eco_client.wasm') && !asked.length,
		`the server is asked again for ${asked}, which the browser has`);
}

/** Runs in each page before its own scripts: what passes between page and worker, and which of the page's own
 * calls would keep it from its input. */
function watch() {
	globalThis.passed = [];
	globalThis.worked = [];
	for (const name of ['compile', 'compileStreaming', 'instantiate', 'instantiateStreaming']) {
		const { [name]: own } = WebAssembly;
		WebAssembly[name] = (...values) => {
			worked.push(name);
			return own.apply(WebAssembly, values);
		};
	}
	const { getContext } = HTMLCanvasElement.prototype;
	HTMLCanvasElement.prototype.getContext = function (...values) {
		worked.push(values[0]);
		return getContext.apply(this, values);
	};
	const { Worker } = globalThis;
	globalThis.Worker = class extends Worker {
		constructor(...values) {
			super(...values);
			this.addEventListener('message', ({ data: { type, sampled = '' } }) => passed.push(`<${type}${sampled}`));
		}
		postMessage(message, ...values) {
			passed.push(`>${message.moving ? 'moving' : message.type ?? 'canvas'}`);
			super.postMessage(message, ...values);
		}
	};
}

/** Decoding and drawing are the worker's alone, whatever comes. A link's view is asked for before the worker
 * has opened the scene, so that it waits for nothing from the page. */
async function leavesThePageFree() {
	const link = await ask('location.href');
	const { identifier } = await browser.send('Page.addScriptToEvaluateOnNewDocument',
		{ source: `(${watch})()` });
	await ask(`new Promise((done) => { const asked = indexedDB.deleteDatabase('ecostream');
		asked.onsuccess = asked.onerror = asked.onblocked = () => done(1); localStorage.clear(); })`);
	await browser.open(link, 640, 480);
	await browser.until(complete);
	const { received } = await ask('viewer.drawn'), passed = await ask('passed'), worked = await ask('worked');
	expect(received > 10000 && !worked.length, `of ${received} bytes the page itself works on some: ${worked}`);
	const asked = passed.findIndex((it) => ['>draw', '>moving'].includes(it));
	expect(asked >= 0 && asked < passed.indexOf('<opened'), `a link's view is asked for late: ${passed.slice(0, 8)}`);
	await refinesAtRest();
	await browser.send('Page.removeScriptToEvaluateOnNewDocument', { identifier });
}

/** A picture at rest gets 16 samples, one after the other, until there is input: a moving one has one. */
async function refinesAtRest() {
	await browser.until(samples(16));
	const passed = await ask('passed'), counts = (list) => list.filter((it) => /^<(drawn|sampled)/.test(it)), all = counts(passed);
	const rest = all.slice(all.findLastIndex((it) => it === '<drawn1'));
	expect(String(rest) === String(['<drawn1', ...Array.from({ length: 15 }, (_, i) => `<sampled${i + 2}`)]),
		`a picture at rest has in turn: ${rest}`);
	// the input comes as soon as there are three samples of the next picture
	await ask(`new Promise((done) => {
		const picture = document.getElementById('picture');
		const send = (type) => picture.dispatchEvent(new KeyboardEvent(type, { key: 'ArrowLeft', bubbles: true }));
		const press = () => { send('keydown'); setTimeout(send, 200, 'keyup'); };
		const observer = new MutationObserver(() => {
			if (picture.dataset.samples !== '3')
				return;
			observer.disconnect();
			passed.length = 0;
			press();
			done();
		});
		observer.observe(picture, { attributeFilter: ['data-samples'] });
		press();
	})`);
	await browser.until(samples(16));
	const after = await ask('passed'), moving = after.slice(after.indexOf('>moving')), first = counts(moving).indexOf('<drawn1');
	expect(after.includes('>moving') && first >= 0 && first <= 2, `after an input samples go on: ${after}`);
	const end = moving.lastIndexOf('>draw'), drawn = counts(moving.slice(0, end)).slice(first);
	expect(end > 0 && drawn.every((it) => it === '<drawn1'), `a moving picture has more than a sample: ${moving}`);
}

/** A link to a scene that is not there says so, and shows another. The browser's way back leads to the scene
 * before. */
async function goesBack() {
	const shows = (scene) => browser.until(`viewer.settings.scene === '${scene}' && viewer.drawn?.facts
		&& document.title.startsWith('${scene}') && ${complete}`);
	await choose('scene', 'park');
	await shows('park');
	await ask('history.back()');
	await shows(name);
	await ask('history.forward()');
	await shows('park');
	await ask("location.hash = '#scene=elsewhere'");
	await browser.until(`document.getElementById('state').textContent.includes('no scene elsewhere') && ${complete}`);
	expect(await text('state').then((said) => said.includes(' elsewhere')), 'who looks for a scene is told nothing');
	await ask(`location.hash = '#scene=${name}'`);
	await shows(name);
}

/** A first visitor sees the place that the server names; the button leads to the whole scene. An eye that
 * the ground hides rises above it. */
async function looksWhereThereIsSomething() {
	const middle = ({ low, high }) => low.map((v, i) => (v + high[i]) / 2), same = (a, b) => Math.hypot(...a.map((v, i) => v - b[i])) < 1e-6;
	const { bounds, look } = await ask(`fetch('${url}').then((a) => a.json())`), { low } = bounds, high = low.map((v) => v + 50);
	const targets = await ask(`(() => {
		const { camera } = viewer, targets = [];
		document.getElementById('whole').click();
		targets.push(camera.target);
		camera.frame(${JSON.stringify({ low, high })}, 1.5);
		camera.distance = 100;
		const near = camera.haze();
		camera.distance = 6000;
		targets.push([...camera.target], camera.lift(camera.view().eye[2] - 5), camera.lift(9999), camera.view().eye, near, camera.haze());
		const { distance } = camera;
		camera.approach(camera.target, 0);
		targets.push(camera.distance / distance);
		return targets;
	})()`);
	expect(Math.abs(targets[7] - 1) < 1e-6, 'who looks at the ground comes as near as to a plant of no height');
	expect(look && same(targets[0], middle(bounds)), 'the button does not lead to the whole scene');
	expect(same(targets[1], middle({ low, high })) && !targets[2] && targets[3] && targets[4][2] > 9999, 'an eye stays below the ground');
	expect(targets[5] === 0 && targets[6] === 24000, `haze of ${targets[6]} m hides what is seen from 6 km`);
	await press('h');
	await browser.until(complete);
}

/** A visitor who names no scene sees one, however long the server takes to say which there are. */
async function looksAtTheFirst() {
	const { port, close } = await shape(new URL(url).port, 1e7, 600);
	await browser.open(`http://127.0.0.1:${port}/`, 640, 480);
	await browser.until(complete);
	const { target } = await ask('viewer.camera.view()');
	const { low, high } = await ask("fetch(`/v1/scenes/${viewer.settings.scene}`).then((a) => a.json()).then(({ look }) => look)");
	const apart = [0, 1].map((i) => target[i] - (low[i] + high[i]) / 2);
	expect(Math.hypot(...apart) < 1e-6, `at first the camera looks ${apart} m beside what there is`);
	close();
}

/** A visitor who moves on is sent what comes next, until he turns. The line is slow, so that there is something to give
 * up, and the park is large; the browser keeps nothing of this address. */
async function looksAhead() {
	const { port, close } = await shape(new URL(url).port, 3e5, 50);
	const hold = (type, key) => browser.send('Input.dispatchKeyEvent', { type, key });
	await browser.open(`http://127.0.0.1:${port}/#scene=park`, 640, 480);
	await browser.until('viewer.drawn?.facts');
	await hold('keyDown', 'w');
	await browser.until('viewer.drawn.ahead.asked > 0');
	const { ahead } = await ask('viewer.drawn');
	await hold('keyUp', 'w');
	await hold('keyDown', 's');
	await browser.until(`viewer.drawn.ahead.aborted > ${ahead.aborted}`);
	await hold('keyUp', 's');
	close();
	await losesTheServer(port);
}

/** A visitor who has no server any more is told so, and sees what he asked for once there is one again. */
async function losesTheServer(port) {
	await press('w');
	await browser.until("document.getElementById('state').textContent.includes('does not answer')");
	expect(!await ask(complete), 'a picture that could not be fetched is said to be complete');
	const { close } = await shape(new URL(url).port, 1e8, 5, port);
	await browser.until(`document.getElementById('state').textContent === '' && ${complete}`);
	close();
}

/** Drawings that a driver lost are drawn anew once there is one again, and who looks on is told. The page draws by itself here, as
 * in a browser without canvases for workers. */
async function losesTheContext() {
	const { identifier } = await browser.send('Page.addScriptToEvaluateOnNewDocument', { source: `{
		delete HTMLCanvasElement.prototype.transferControlToOffscreen;
		const { getContext } = HTMLCanvasElement.prototype;
		HTMLCanvasElement.prototype.getContext = function (...values) {
			const made = getContext.apply(this, values);
			if (values[0] === 'webgl2')
				globalThis.context = made;
			return made;
		} }` });
	await browser.open(await ask('location.href'), 640, 480);
	await browser.until(complete);
	const before = await savePlain();
	await ask("globalThis.lost = context.getExtension('WEBGL_lose_context'); lost.loseContext()");
	await browser.until("document.getElementById('state').textContent.includes('lost the picture')");
	await ask('lost.restoreContext()');
	await browser.until(`document.getElementById('state').textContent === '' && ${complete}`);
	expect(before.equals(await savePlain()), 'after a lost context the picture is another');
	await browser.send('Page.removeScriptToEvaluateOnNewDocument', { identifier });
	await browser.open(await ask('location.href'), 640, 480);
	await browser.until(complete);
}

/** A page that is open while the scene gets another pack shows that one. */
async function takesAnotherPack() {
	const names = 'viewer.drawn.facts.models.map(({ name }) => name).sort().join()';
	const before = await ask(names), scene = async () => (await fetch(url)).text(), old = await scene();
	execSync(reload);
	// until the server has read it
	for (let tries = 0; tries < 300 && await scene() === old; tries++)
		await new Promise((done) => setTimeout(done, 100));
	await press('h');
	await browser.until(`${complete} && ${names} !== ${JSON.stringify(before)}`);
}

/** The scene named bare has no CRS: the page says that the sun needs one, and up is no north. */
async function isNowhereOnEarth() {
	const sun = () => ask(`(([{ disabled }, note]) => [disabled, note.hidden, note.textContent])(
		['sun', 'sun-note'].map((id) => document.getElementById(id)))`);
	const [off, noteOff] = await sun();
	expect(!off && noteOff && await text('north') === 'N', 'the city has no place');
	await browser.open(new URL('/#scene=bare&sun=2026-06-21T10:00Z', url).href, 640, 480);
	await browser.until(complete);
	const [disabled, hidden, note] = await sun();
	expect(disabled && !hidden && note.includes('CRS'), `without a place a sun is offered: ${note}`);
	expect(await text('state').then((said) => said.includes('CRS')), 'nobody is told that the sun of a link is not used');
	expect(await text('north') === 'Y', `without a CRS the arrow says ${await text('north')}`);
	await ask("document.getElementById('state').click()");
	await hasAnObject();
}

/** A wall is no plant: its layer is offered, leaves the plant, and the card says what it is. */
async function hasAnObject() {
	const names = "viewer.drawn.facts.models.map(({ name }) => name).join()", toggle = "document.querySelector('[data-layer=objects]').click()";
	await browser.until(`!document.getElementById('has-objects').hidden && ${names} === 'grass,wall'`);
	const all = await onScreen();
	await ask(toggle);
	await browser.until(`location.hash.includes('hide=objects') && ${complete}`);
	expect(!all.equals(await onScreen()), 'an object is drawn in spite of its layer');
	await ask(toggle);
	await browser.until(`location.hash.includes('hide=&') && ${complete}`);
	expect(all.equals(await onScreen()), 'an object does not come back');
	await ask("viewer.heard.picked({ picked: { kind: 'plant', plant: 'wall', number: 1, height_m: 1, foot: [0, 0, 0], distance_m: 2 } })");
	expect(await text('card-title') === 'A building or other object', `a wall is ${await text('card-title')}`);
	await press('Escape');
}

/** A link's values are taken in every known form; the person is told of a value that cannot be read. Parameters
 * that others append are ignored. */
async function readsLinks() {
	const open = async (link) => {
		await browser.open(new URL(link, url).href, 320, 240);
		await browser.until(complete);
		return { ...await ask('viewer.settings'), said: await text('state'), view: await ask('viewer.camera.view()'),
			hash: await ask('location.hash') };
	};
	for (const [sun, taken] of [['2026-06-21T10:00Z', '2026-06-21T10:00'], ['2026-06-21T10:00', '2026-06-21T10:00'],
		['2026-06-21T12:00+02:00', '2026-06-21T10:00'], ['2026-06-21T12:00%2B02:00', '2026-06-21T10:00'],
		['2026-06-21T05:00:30-0500', '2026-06-21T10:00:30'], ['2026-06-21T10:00:00.000Z', '2026-06-21T10:00:00'], ['', '']]) {
		const { said, sun: got } = await open(`/#scene=city&sun=${sun}`);
		expect(got === taken && said === '', `sun=${sun} is taken as ${got}: ${said}`);
	}
	for (const fault of ['sun=noon', 'sun=2026-06-21', 'sun=2026-13-21T10:00Z', 'mode=swim', 'shadows=soft', 'kind=red',
		'vertices=-5', 'vertices=many', 'vertices=', 'vertices=1e9', 'hide=trees', 'views=a~1,2,3', 'views=b', 'bytes=-2',
		'bytes=1.5', 'eye=1,2&target=0,0,0',
		'eye=1,,3&target=0,0,0', 'eye=1,2,3,4&target=0,0,0']) {
		const { said, vertices, bytes, mode } = await open(`/#scene=city&${fault}`), [first] = fault.split('&');
		expect(said.includes(first) && said.includes('expected'), `${fault} is not said to be unreadable: ${said}`);
		expect(vertices === 0 && bytes === -1 && mode === 'orbit', `${fault} sets ${[vertices, bytes, mode]}`);
	}
	expect((await open('/#scene=city&eye=1,2,3')).said.includes('target'), 'an eye without a target is not told of');
	expect((await open('/#scene=city&eye=1,2,3&target=1,2,3')).said.includes('one place'), 'an eye that looks nowhere is not told of');
	const two = await open('/#scene=city&sun=noon&mode=fly&kind=x');
	expect(two.said.includes('sun=noon') && two.said.includes('kind=x') && two.mode === 'fly', `of two values: ${two.said}`);
	const { said, mode, view } = await open('/?fbclid=x&utm_source=a%20b#scene=city&mode=walk&eye=0,-90,40&target=0,0,5&fbclid=y&utm=z');
	expect(said === '' && mode === 'walk' && view.target.length === 3, `what others append is told of: ${said}`);
	await browser.until("location.hash.includes('eye=')");
	expect(await ask("location.search === '?fbclid=x&utm_source=a%20b'"), 'the address has lost what it had');
}

/** Another scene of the same place is seen from where the camera is, one of another place from where there is something. */
async function staysAtThePlace() {
	const show = async (scene) => {
		await choose('scene', scene);
		await browser.until(`viewer.about && viewer.settings.scene === '${scene}' && ${complete}`);
	};
	const apart = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]));
	await browser.open(new URL('/#scene=park', url).href, 640, 480);
	await browser.until(complete);
	await ask('viewer.camera.look([10, -40, 30], [3, 4, 10])');
	await show('dusk');
	const dusk = await ask('viewer.camera.view()');
	expect(apart(dusk.eye, [10, -40, 30]) < 1e-6 && apart(dusk.target, [3, 4, 10]) < 1e-6,
		`another scene of the place is seen from ${dusk.eye}`);
	await show('bare');
	expect(apart((await ask('viewer.camera.view()')).target, [0, 0, 0.5]) < 1, 'a scene of another place is not looked at');
	const box = (x, y, size) => ({ low: [x, y, 0], high: [x + size, y + size, 20] });
	const here = { crs: 'EPSG:32632', at: [1000, 2000, 500] }, there = { crs: 'EPSG:32632', at: [1100, 2000, 490] };
	const elsewhere = { crs: 'EPSG:32633', at: [1000, 2000, 500] };
	for (const [from, to, at] of [
		[[here, box(0, 0, 100)], [here, box(0, 0, 100)], [50, 50, 0]],
		[[here, box(0, 0, 100)], [there, box(-100, 0, 100)], [-50, 50, 10]],
		[[here, box(0, 0, 100)], [here, box(30, 30, 40)], [50, 50, 0]],
		[[here, box(0, 0, 100)], [here, box(-5000, -5000, 10000)], [50, 50, 0]],
		[[null, box(0, 0, 100)], [null, box(5, 0, 90)], [50, 50, 0]],
		[[here, box(0, 0, 100)], [there, box(0, 0, 100)], null],
		[[here, box(0, 0, 100)], [elsewhere, box(0, 0, 100)], null],
		[[here, box(0, 0, 100)], [null, box(0, 0, 100)], null],
		[[here, box(0, 0, 100)], [here, box(49, 49, 2)], null],
		[[null, box(0, 0, 100)], [null, box(40, 40, 30)], null]]) {
		const scene = ([origin, bounds]) => JSON.stringify({ origin, bounds });
		const [stays, target] = await ask(`(() => { const { camera } = viewer; camera.look([50, -100, 80], [50, 50, 0]);
			return [camera.transfer(${scene(from)}, ${scene(to)}), camera.target]; })()`);
		expect(stays === Boolean(at) && apart(target, at ?? [50, 50, 0]) < 1e-6, `from ${scene(from)} to ${scene(to)}: ${target}`);
	}
}

/** A second scene of the place is beside the first one: here of the same pack, so the picture is the same. */
async function wipes() {
	const picture = async () => {
		await browser.until(`${complete} && ${samples(16)}`);
		await ask("document.getElementById('wipe').style.opacity = 0");
		return browser.picture({ x: 0, y: 60, width: 320, height: 100, scale: 1 });
	};
	await browser.open(new URL('/#scene=park&vertices=20000&shadows=none', url).href, 320, 240);
	const alone = await picture();
	await choose('beside', 'dusk');
	await browser.until("!document.getElementById('wipe').hidden");
	expect((await picture()).equals(alone), 'two scenes of one pack show another picture than one');
	await ask("document.getElementById('wipe').focus()");
	await press('ArrowRight');
	expect(await ask('viewer.settings.wipe') === 0.52, 'an arrow key does not move the handle');
	for (const key of ['ArrowUp', 'ArrowDown'])
		await press(key);
	expect(await ask('viewer.settings.wipe') === 0.52, 'arrows up and down do not move the handle there and back');
	await browser.until("location.hash.includes('beside=dusk&wipe=0.52')");
	await choose('beside', 'bare');
	await browser.until("document.getElementById('state').textContent === 'bare is not at this place.'");
	expect(await hidden('wipe') && await ask('viewer.settings.beside') === '', 'a scene of another place is beside it');
}

/** On a phone, too, the first view fills much of the picture, and H shows all of the scene. */
async function fillsAPhone() {
	/** How much of the picture's height, and of its width, a box takes. */
	const shares = ({ low, high }, [width, height]) => ask(`(() => {
		const m = viewer.camera.matrix(${width / height}), [low, high] = ${JSON.stringify([low, high])};
		const at = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((i) => (n >> i & 1 ? high : low)[i]))
			.map(([x, y, z]) => [0, 1, 3].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]));
		return [1, 0].map((axis) => { const all = at.map((p) => p[axis] / p[2]);
			return [(Math.max(...all) - Math.min(...all)) / 2, Math.max(...all.map(Math.abs))]; });
	})()`);
	for (const [width, height, mobile] of [[390, 844, true], [360, 740, true], [1280, 720, false], [844, 390, true]]) {
		await browser.open(page, width, height, { mobile });
		await browser.until(complete);
		const { look, bounds } = await ask(`fetch('${url}').then((a) => a.json())`);
		const [[fills]] = await shares(look, [width, height]);
		expect(fills > 0.4, `at ${width} x ${height} the first view fills ${fills} of the height`);
		await press('h');
		const [[, high], [, wide]] = await shares(bounds, [width, height]);
		expect(Math.max(high, wide) < 1.001, `at ${width} x ${height} the whole scene takes ${[high, wide]}`);
	}
}

/** Behind a proxy that has the server below a path the page shows what it shows at the root. */
async function showsBelowAPath() {
	await browser.open(`${below}?utm_source=a`, 640, 480);
	await browser.until(`viewer.drawn?.facts && ${complete}`);
	await browser.open(`${below}#scene=park&eye=10,-40,30&target=3,4,10`, 640, 480);
	await browser.until(`viewer.drawn?.facts && ${complete}`);
	expect(await ask(`location.href.startsWith('${below}#scene=park')`), 'the page leaves its path');
}

/** One finger turns, two move and come nearer, a tap says what is there. */
async function movesByTouch() {
	const places = async () => JSON.parse(await ask('JSON.stringify(viewer.camera.view())'));
	const apart = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]));
	const far = ({ eye, target }) => apart(eye, target);
	const touch = (type, ...points) => browser.send('Input.dispatchTouchEvent',
		{ type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
	/** Each finger from where it is put, by its step, six times. */
	const drag = async (from, steps) => {
		await touch('touchStart', ...from);
		for (let i = 1; i <= 6; i++)
			await touch('touchMove', ...from.map((point, finger) => point.map((v, k) => v + i * steps[finger][k])));
		await touch('touchEnd');
		return places();
	};
	await browser.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 2 });
	const before = await places();
	const turned = await drag([[300, 300]], [[12, 0]]);
	expect(apart(before.eye, turned.eye) > far(before) / 100 && Math.abs(far(turned) / far(before) - 1) < 0.001
		&& apart(before.target, turned.target) < far(before) / 1000, 'one finger does not turn around what is looked at');
	const nearer = await drag([[250, 300], [350, 300]], [[-8, 0], [8, 0]]);
	expect(far(nearer) < 0.9 * far(turned), `two fingers that part come from ${far(turned)} to ${far(nearer)} m`);
	const moved = await drag([[250, 300], [350, 300]], [[0, 8], [0, 8]]);
	expect(apart(nearer.target, moved.target) > far(nearer) / 100, 'two fingers do not move');
	await press('h');
	await browser.until(complete);
	await touch('touchStart', [320, 240]);
	await touch('touchEnd');
	await browser.until("!document.getElementById('card').hidden");
	await openMenu('more');
	expect(await ask("getComputedStyle(document.getElementById('card')).display") === 'none', 'the menu lies over the card');
	await openMenu('more');
	await press('Escape');
	await walksByTouch(touch);
	await browser.send('Emulation.setTouchEmulationEnabled', { enabled: false });
}

/** A finger on an arrow walks, until it is lifted. */
async function walksByTouch(touch) {
	expect(await ask("getComputedStyle(document.getElementById('pad')).display === 'none'"), 'arrows to walk are shown to who looks');
	await chooseMode('walk');
	await browser.until(`viewer.drawn.ground !== null && ${complete}`);
	const { eye } = await ask('viewer.camera.view()');
	const at = await ask("(({ x, y }) => [x + 20, y + 20])(document.querySelector('[data-key=w]').getBoundingClientRect())");
	await touch('touchStart', at);
	await browser.until(`Math.hypot(viewer.camera.view().eye[0] - ${eye[0]}, viewer.camera.view().eye[1] - ${eye[1]}) > 0.5`);
	await touch('touchEnd');
	expect(!await ask('viewer.camera.moving()'), 'who lifts the finger walks on');
	await chooseMode('orbit');
}

/** The menu says what is there, however it is called, in its own width. */
async function saysAnyName() {
	const facts = (models, vertices, species = null) => ask(`(async () => {
		const { nameSpecies, showFacts, showPicked, showPlant } = await import('/viewer/viewer_panel.mjs'), panel = document.querySelector('#layers > .box');
		const roles = [{ name: 'summaries', color: [0, 0, 0], vertices: ${vertices} }];
		nameSpecies(${JSON.stringify(species)});
		showFacts({ vertices: 9, plants: ${models.length}, bytes: 9, memory_bytes: 9, roles, models: ${JSON.stringify(models)} });
		panel.parentElement.open = true;
		showPicked({ kind: 'summary', ...${JSON.stringify(models[0] ?? {})}, plant: 'oak', at: [1, 2, 3], distance_m: 4 });
		const points = document.getElementById('card').textContent;
		showPicked({ kind: 'plant', number: 0, plant: 'Oak', height_m: 3, at: [1, 2, 3], distance_m: 4 });
		showPlant({ species: null, plant: 'oak' });
		const unstated = document.getElementById('card').textContent;
		showPicked({ kind: 'plant', number: 0, plant: 'Oak', height_m: 3, at: [1, 2, 3], distance_m: 4 });
		showPlant({ species: 'OAK', plant: 'oak', file: 'a', row: 3 });
		const same = document.getElementById('card').textContent;
		document.getElementById('card').hidden = true;
		const name = document.querySelector('#species li :is(summary, span)'), all = name?.parentElement.textContent;
		return [panel.scrollWidth <= panel.clientWidth, document.getElementById('species').textContent,
			document.getElementById('figures').textContent, points, unstated, same,
			name?.textContent, all?.slice(name.localName === 'summary' ? name.textContent.length : 0)];
	})()`);
	const [fits, names] = await facts([{ number: 0, name: 'A'.repeat(63), height_m: 8, count: 1e6 },
		{ number: 1, name: '<img src=x onerror="throw 1">', height_m: 8, count: 2 }], 0);
	expect(fits && names.includes('<img src=x'), `long names: ${fits}, ${names}`);
	const oak = [{ number: 0, name: 'oak', height_m: 8, count: 9 }];
	const stands = (of, ...species) => [{ plant: 'oak', species_count: of, species }];
	const some = [{ species: 'quru', plants: 7 }, { species: null, plants: 2 }, { species: 'oak', plants: 1 }];
	for (const [species, short, long] of [
		[stands(1, some[0]), 'quru', 'quru, shown as oak'], [stands(1, some[2]), 'oak', 'oak'],
		[stands(2, some[0], some[2]), 'quru and oak', 'Shown as oak: quru (7), oak (1)'],
		[stands(3, ...some), 'quru, species not stated and oak', 'Shown as oak: quru (7), species not stated (2), oak (1)'],
		[stands(40, ...some), 'quru, species not stated and 38 more',
			'Shown as oak: quru (7), species not stated (2), oak (1) and 37 more'],
		[[{ ...stands(2, ...some)[0], plant: 'of another pack' }], 'oak', 'oak']]) {
		const [, , , points, , , named, all] = await facts(oak, 0, species), both = short === long ? short : short + long;
		expect(named === short && all.startsWith(long) && points.includes(`Of these${both}Place`),
			`${JSON.stringify(species)}: ${named}, ${all}, ${points}`);
	}
	const [, , , , unstated, same] = await facts(oak, 0);
	expect(unstated.trim().startsWith('Species not stated') && unstated.includes('Shown asoak'), `not stated: ${unstated}`);
	expect(same.includes('OAK') && !same.includes('Shown as') && same.includes('Row3 of a'), `the same: ${same}`);
	const [card, ...classes] = await ask(`(async () => {
		const { showPicked, showPlant } = await import('/viewer/viewer_panel.mjs');
		showPicked({ kind: 'plant', plant: 'oak', number: 0, height_m: 12, crown_m: 5, foot: [0, 0, 0], distance_m: 9 });
		showPlant({ species: 'oak', plant: 'oak', cells: ['T1', null, 'trunk diameter'] }, 0, ['nr', 'health', 'height_from', 'crown_from']);
		const texts = [document.getElementById('card-facts').textContent];
		const tints = [{ column: 'health', classes: [{ name: 'good', color: null }, { name: 'poor', color: '#aa0000' }, { name: 'dead', color: '#aa0000' }] }];
		for (const tint of ['#aa0000', '#000000', undefined]) {
			showPicked({ kind: 'plant', plant: 'oak', number: 0, height_m: 12, tint, tints });
			texts.push(document.getElementById('card-facts').textContent);
		}
		document.getElementById('card').hidden = true;
		return texts;
	})()`);
	expect(String(classes) === 'Height12.0 mClasspoor (health),Height12.0 mClassgood (health),Height12.0 m', `cards of classes: ${classes}`);
	expect(card.startsWith('Height12.0 mguessed from trunk diameterCrown width5.00 mnrT1')
		&& !card.includes('health'), `a card with columns: ${card}`);
	const [, none, figures] = await facts([], 5);
	expect(none.startsWith('Only points') && figures.includes('more as points'), `only summaries: ${none}, ${figures}`);
}

try {
	await browser.open(page, 640, 480);
	await browser.until(complete);
	await picksAPlant();
	await showsItsFigures();
	await movesByKeyboard();
	await looksWhereThereIsSomething();
	await hasLayers();
	await findsItsBudget();
	await hasASun();
	await walks();
	await keepsViews();
	await findsPlants();
	await measures();
	await savesPictures();
	await savesWhatIsWhole();
	await comesBack();
	await goesBack();
	await leavesThePageFree();
	await losesTheContext();
	await takesAnotherPack();
	await isNowhereOnEarth();
	await movesByTouch();
	await saysAnyName();
	const state = await text('state');
	expect(state === '', `the page reports: ${state}`);
	expect(!browser.complaints.length, browser.complaints.join('\n'));
	await readsLinks();
	await staysAtThePlace();
	await wipes();
	await speaksGerman();
	if (existsSync(axe))
		await isAccessible();
	await fillsAPhone();
	if (below)
		await showsBelowAPath();
	expect(!browser.complaints.length, browser.complaints.join('\n'));
	await looksAtTheFirst();
	await looksAhead();
} finally {
	await browser.close();
}
process.exit(faults > 0 ? 1 : 0);
