// The viewer at /: which scene, where the camera is, and what people ask of it. All of it is in the address
// (#scene=...), so that a link shows what its sender saw. A worker makes the picture (viewer_engine.mjs).
// Longer than 600 lines: all that people ask for shares the camera, the settings and the engine's answers.
import { scenesHere, sceneUrl } from './eco_ask.mjs';
import { Camera, cameraKeys, withModifier } from './viewer_camera.mjs';
import { readLink, writeLink } from './viewer_link.mjs';
import { errorText, hasObjects, metres, nameSpecies, number, placeText, showError, showFacts, showLegend, showNorth,
	showPicked, showPlant, showReasons, showScale, showWhy } from './viewer_panel.mjs';
import { fixed, t, translatePage } from './viewer_text.mjs';
import { captioned, sayMeasured, scriptOf, showChoices, showMeasured, tourAt } from './viewer_tools.mjs';

const $ = (id) => document.getElementById(id);
const canvas = $('picture');
const [menus, modes, layers] = ['.menu', '[data-mode]', '[data-layer]'].map((all) => [...document.querySelectorAll(all)]);
const camera = new Camera();
// vertices 0: as many as this device draws in time (`budget`); hide: layers that are not drawn
const settings = { scene: '', mode: 'orbit', vertices: 0, bytes: -1, kind: 0, smooth: 0, sun: '',
	shadows: 'perspective', hide: [], views: [], beside: '', wipe: 0.5 };
const BUDGET = 300000, BUDGET_LEAST = 100000, BUDGET_MOST = 3e6;
const STILL_MS = 250, LOADING_MS = 300;
const AHEAD_S = 1;                       // what a moving camera will need so soon is asked for, too
let engine = null, about = null, settled = true, frame = 0, movedAt = -Infinity;
let ends = null, toured = null, saving = null;   // of what is measured; since when; the size of a picture to be saved
let token = null;                        // of a scene that is not for all: #scene=NAME&token=TOKEN
let asked = 0, drawn = null, picked = null, view = null, incompleteSince = 0, wasOffline = false;
let faults = [], sunIsLinked = false;    // what the address has that cannot be read; whether it has a sun
let scenes = [];                         // of this page: openapi.yaml's Scenes
let besides = false;                     // the second scene is there
let located = null;                      // the scene whose coordinates the camera has
let budget = Number(kept('vertices')) || BUDGET;

const say = (text, error = false) => {
	$('state').textContent = text;
	$('state').classList.toggle('error', error);
};

// ---- The address ----

function readAddress() {
	const { values, faults: found } = readLink(location.hash), { token: given = token, view: at = null } = values;
	for (const key of Object.keys(settings))
		settings[key] = values[key] ?? settings[key];
	[token, view, faults] = [given, at, found];
	sunIsLinked = Boolean(values.sun);
}

/** The solar time of the scene's place, in ms ahead of UTC. */
const solar = () => (about?.origin?.longitude_deg ?? NaN) * 240000;

const minuteOf = (ms) => new Date(Math.round(ms / 60000) * 60000).toISOString();

/** The usual time of the sun (view_sun_usual), in UTC: ten in the morning of midsummer. */
function usualSun() {
	const south = about?.origin?.latitude_deg < 0;
	const ms = Date.UTC(new Date().getUTCFullYear(), south ? 11 : 5, 21, 10) - solar();
	return Number.isFinite(ms) ? minuteOf(ms).slice(0, 16) : '';
}

const hasPlace = () => about?.origin?.longitude_deg !== undefined;

function sayFaults() {
	const noSun = sunIsLinked && about && !hasPlace()
		? [t("The link's sun is not used: the scene has no CRS, so its place on Earth is unknown.")] : [];
	if (faults.length || noSun.length)
		say([...faults, ...noSun].join(' '), true);
}

function writeAddress() {
	// before a scene is known the camera looks nowhere
	if (about)
		history.replaceState(null, '', writeLink(settings, camera.view()));
}

// ---- Pictures ----

/** A value that this browser keeps by that name, or null. */
function kept(name) {
	try {
		return localStorage.getItem(name);
	} catch {
		return null;
	}
}

function keep(name, value) {
	try {
		localStorage.setItem(name, value);
	} catch {
		// then the next visit begins anew
	}
}

/** Several folders of one host may have a scene of this name. */
const viewsName = () => `views ${location.pathname}${settings.scene}`;

/** The engine: a worker's where canvases can be given away, else this page's. */
async function startEngine() {
	const worker = globalThis.engine;
	if (!worker) {
		const { port1, port2 } = new MessageChannel();
		(await import('./viewer_engine.mjs')).startEngine(canvas, port2);
		return port1;
	}
	const offscreen = canvas.transferControlToOffscreen();
	worker.onerror = () => say(t('The viewer could not be loaded; reload the page to try again.'), true);
	if (worker.failed)
		worker.onerror();
	worker.postMessage({ canvas: offscreen }, [offscreen]);
	return worker;
}

/** The place where a moving camera will soon be: as it went on since the last frame; null: it stands. */
function nextView(now, moving) {
	const { eye, target } = camera.view(), { last } = nextView, s = (now - last?.now) / 1000;
	nextView.last = moving ? { now, eye, target } : null;
	if (!moving || !(s > 0 && s < STILL_MS / 1000))
		return nextView.given = null;
	const on = (to, from) => to.map((v, i) => v + (v - from[i]) / s * AHEAD_S);
	const next = { eye: on(eye, last.eye), target: on(target, last.target) };
	const far = Math.hypot(...next.eye.map((v, i) => v - next.target[i]));
	// between two moves of a pointer it goes on as before
	if (!next.eye.every((v, i) => v === eye[i]) || !next.target.every((v, i) => v === target[i]))
		nextView.given = far > camera.near ? next : null;
	return nextView.given;
}

const redraw = () => { frame ||= requestAnimationFrame(draw); };

function draw(now) {
	frame = 0;
	if (camera.step(now) || tours(now))
		moved();
	const moving = camera.moving() || now - movedAt < STILL_MS;
	if (moving)
		redraw();
	const ratio = Math.min(devicePixelRatio, 2);
	const shown = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
	const still = moving ? null : saving, size = still ?? shown;
	const { vertices, bytes, kind, smooth, shadows, hide } = settings, sun = Date.parse(`${settings.sun}Z`) / 1000;
	const convergence = (about?.origin?.convergence_deg ?? 0) * Math.PI / 180;
	showScale(camera.metresAcross() / canvas.clientHeight, camera.heading() + convergence);
	if (!about)
		return;
	showMeasured(ends, camera.matrix(shown[0] / shown[1]));
	engine.postMessage({ type: 'draw', number: ++asked, still: !!still, matrix: camera.matrix(size[0] / size[1]), size,
		moving, eye: camera.view().eye, next: nextView(now, moving), vertices: vertices || budget, bytes, shadows,
		hide, sun: sun || null, wipe: settings.wipe,
		tint: kind ? 'kind' : 'none', smooth: !!smooth, haze: camera.haze() });
}

function moved() {
	movedAt = performance.now();
	canvas.dataset.complete = false;
	clearTimeout(moved.timer);
	moved.timer = setTimeout(writeAddress, 300);
	redraw();
}

function resized() {
	const ratio = Math.min(devicePixelRatio, 2);
	$('still-width').value = Math.round(canvas.clientWidth * ratio);
	$('still-height').value = Math.round(canvas.clientHeight * ratio);
	showWipe();
	moved();
}

function lookAt(box, whole = false) {
	camera.setMode('orbit');
	camera.frame(box, canvas.clientWidth / canvas.clientHeight, whole);
	camera.setMode(settings.mode);           // a walker looks ahead
	moved();
}

// ---- What the engine says ----

function showProgress({ complete, offline, received }) {
	// what a server did not answer is no error any more once it does
	if (offline)
		return;
	if (wasOffline)
		say('');
	wasOffline = false;
	const complained = $('state').classList.contains('error');
	if (complete) {
		incompleteSince = 0;
		if (!complained)
			say('');
		return;
	}
	incompleteSince ||= performance.now();
	if (!complained && performance.now() - incompleteSince > LOADING_MS)
		say(t('Loading, {} bytes so far', number(received)));
}

/** Takes a scene: from now on views of it are asked for. The camera stays if the scene before lies at the same
 * place. */
function know(said) {
	about = said;
	showSettings();
	document.title = `${about.title ?? settings.scene} – ecostream`;
	$('draft').hidden = !about.draft;
	showLegend(about);
	if (!settings.views.length)
		settings.views = JSON.parse(kept(viewsName())) ?? [];
	showViews();
	camera.reach(about.bounds, about.near_m);
	const stays = !view && located && camera.transfer(located, about);
	located = about;
	if (!stays)
		lookAt(about.look);
	if (view)
		camera.look(...view);
	settled = Boolean(view);
	sayFaults();
	moved();
}

/** Another may have been clicked meanwhile. */
const isPicked = ({ list, index }) => picked?.list === list && picked?.index === index;

const heard = {
	opened(message) {
		// the head of the next visit's page then asks for less
		if (!token)
			keep(`kept ${settings.scene}`, message.about.id);
		if (message.about.id !== about?.id)
			know(message.about);
		putBeside();
	},
	besides({ about: other }) {
		besides = camera.transfer(about, other, false);
		if (!besides) {
			setBeside('');
			say(t('{} is not at this place.', other.name), true);
		}
		showWipe();
	},
	drawn(message) {
		drawn = message;
		showProgress(message);
		showOpened();
		if (settings.mode === 'walk' ? camera.stand(message.ground ?? about.bounds.low[2])
			: !settled && message.ground !== null && camera.lift(message.ground))
			redraw();
		settled ||= message.complete;
		canvas.dataset.complete = message.complete && message.number === asked && !frame;
		canvas.dataset.samples = message.sampled;
	},
	sampled({ sampled, more }) {
		canvas.dataset.samples = sampled;
		drawn.more = more;
	},
	named({ species }) {
		nameSpecies(species);
		$('has-objects').hidden = !hasObjects();
		showOpened();
	},
	paced({ factor }) {
		budget = Math.round(Math.min(BUDGET_MOST, Math.max(BUDGET_LEAST, budget * factor)));
		keep('vertices', budget);
		showSettings();
	},
	picked(message) {
		if (ends)
			return measure(message.picked.at);
		({ picked } = message);
		showPicked(picked, about.origin);
	},
	found({ text, found }) {
		const { eye } = camera.view(), away = ({ foot }) => Math.hypot(...foot.map((v, i) => v - eye[i]));
		const rowOf = ({ row, file }) => file ? [t('row {} of {}', row, file)] : [];
		const says = ({ cells = [] }) => cells.filter((cell) => cell?.toLowerCase().includes(text.toLowerCase()));
		showChoices($('found'), found, (plant) => [plant.said.species ?? plant.said.plant, metres(plant.height_m),
			t('{} away', metres(away(plant))), ...rowOf(plant.said), ...says(plant.said)].join(', '), choose);
		$('found-note').textContent = text && t(found.length < 20 ? 'Plants found: {}' : 'The first {} of more plants', found.length);
	},
	identified({ picked: of, plant }) {
		if (isPicked(of))
			showPlant(plant, of.number, of.columns);
	},
	explained({ reasons, picked: of, ...why }) {
		if (reasons && isPicked(of))
			showReasons(reasons);
		else if (!reasons)
			showWhy(why);
	},
	comparing() {
		say(t('The picture is compared with one of all detail'));
	},
	async saved({ blob, compares, facts, error }) {
		saving = null;
		redraw();
		if (error)
			showError(error);
		save(`${settings.scene}.png`, compares ? await captioned(blob, caption(facts, error)) : blob);
		if (!$('state').classList.contains('error'))
			say('');
	},
	failed({ text, offline }) {
		wasOffline = offline;
		say(t(text), true);
	},
};

// ---- Scenes and settings ----

/** The answer that the page's head asked for (viewer_first.js), for the engine; null where that is no longer wanted, or
 * went wrong: then the engine asks by itself. The page knows the scene before the engine does. */
async function takeFirst(name) {
	const { scene, about, answer, view, wanted } = globalThis.first ?? {};
	globalThis.first = null;
	if (scene !== name || token)
		return null;
	try {
		const said = await about, described = said.ok ? await said.json() : null;
		if (!described || settings.scene !== name)
			return null;
		know(described);
		return { about: described, view, wanted, body: answer && bytesOf(answer, modifiedOf(said)) };
	} catch {
		return null;
	}
}

const modifiedOf = (answer) => answer.headers.get('last-modified');

/** An answer's bytes, which are of the pack that is described; or null. In one piece: as a stream each part
 * of it would wait for this page's thread. */
async function bytesOf(answer, modified) {
	const came = await answer.catch(() => null);
	const good = came?.status === 200 && modifiedOf(came) === modified;
	return good ? came.arrayBuffer().catch(() => null) : null;
}

/** The engine opens the scene while its first answer is on its way. */
async function sendOpen(message, first) {
	engine.postMessage({ ...message, first: first && { ...first, body: null, comes: !!first.body } });
	if (!first?.body)
		return;
	const body = await first.body;
	engine.postMessage({ type: 'answer', body }, body ? [body] : []);
}

function open(name) {
	settings.scene = name;
	showScenes();
	about = null;
	if (!name)
		return;
	closeCard();
	say(t('Loading'));
	const url = sceneUrl(name), opened = token;
	takeFirst(name).then((first) => {
		if (settings.scene === name)
			sendOpen({ type: 'open', url, token: opened }, first);
	});
}

function showSettings() {
	const { vertices, bytes, mode } = settings;
	$('vertices').value = vertices ? Math.log2(vertices) : 0;
	$('vertices-text').textContent = vertices ? number(vertices) : t('as fast as this device: {}', number(budget));
	$('bytes').value = bytes < 0 ? $('bytes').max : Math.log2(bytes);
	$('bytes-text').textContent = bytes < 0 ? t('no limit') : number(bytes);
	$('kind').checked = settings.kind;
	$('shadows').value = settings.shadows;
	showSun();
	showNorth(Boolean(about?.origin));
	for (const box of layers)
		box.checked = !settings.hide.includes(box.dataset.layer);
	camera.setMode(mode);
	for (const button of modes)
		button.setAttribute('aria-pressed', button.dataset.mode === mode);
	moved();
}

// ---- Several scenes of a place ----

/** Seasons of the scene, and what may be beside it. */
function showScenes() {
	const own = scenes.find(({ name }) => name === settings.scene), others = scenes.filter((scene) => scene !== own);
	const seasons = own?.season ? scenes.filter(({ title, season }) => season && title === own.title) : [];
	$('season').replaceChildren(...seasons.map(({ name, season }) => new Option(t(season), name, false, name === settings.scene)));
	$('season').hidden = seasons.length < 2;
	$('beside').replaceChildren(new Option(t('Nothing'), ''), ...others.map(({ name }) => new Option(name)));
	$('beside').value = settings.beside;
	$('beside-box').hidden = !others.length;
}

/** Asks the engine for the second scene. */
function putBeside() {
	const { beside } = settings, url = beside && beside !== settings.scene ? sceneUrl(beside) : null;
	besides = false;
	showWipe();
	engine.postMessage({ type: 'beside', url, token });
}

function setBeside(name) {
	settings.beside = name;
	putBeside();
	showScenes();
	moved();
}

function showWipe() {
	const { wipe, scene, beside } = settings, percent = Math.round(100 * wipe), names = $('wipe').children;
	$('wipe').hidden = !besides;
	$('wipe').style.left = `${100 * wipe}%`;
	$('wipe').setAttribute('aria-valuenow', percent);
	$('wipe').setAttribute('aria-valuetext', t('{} up to {} %, then {}', scene, percent, beside));
	[names[0].textContent, names[1].textContent] = [scene, beside];
}

function setWipe(share) {
	settings.wipe = Math.round(Math.min(1, Math.max(0, share)) * 1000) / 1000;
	showWipe();
	redraw();
	clearTimeout(moved.timer);
	moved.timer = setTimeout(writeAddress, 300);
}

/** The sun by the solar time of the place, which needs no time zone. */
function showSun() {
	const ms = Date.parse(`${settings.sun || usualSun()}Z`) + solar(), off = Boolean(about) && !hasPlace();
	const [day, time] = Number.isFinite(ms) ? minuteOf(ms).split('T') : ['', ''];
	$('sun').value = Number(time.slice(0, 2)) * 60 + Number(time.slice(3, 5));
	$('sun-text').textContent = time.slice(0, 5);
	$('date').value = day;
	$('sun').disabled = $('date').disabled = off;
	$('sun-note').hidden = !off;
}

function setSun() {
	const ms = Date.parse(`${$('date').value}T00:00Z`) + $('sun').value * 60000 - solar();
	if (Number.isFinite(ms))
		set('sun', minuteOf(ms).slice(0, 16));
}

function set(key, value) {
	settings[key] = value;
	showSettings();
}

/** Figures of the picture, while a menu that has some is open. */
function showOpened() {
	if (drawn?.facts && menus.some((menu) => menu.open))
		showFacts(drawn.facts);
}

/** Colours by representation, with their legend. */
function showKinds(on) {
	set('kind', on ? 1 : 0);
	if (on)
		$('more').open = $('details').open = true;
}

function closeCard() {
	if (picked)
		engine.postMessage({ type: 'mark', plant: null });
	$('card').hidden = true;
	picked = null;
}

/** The card, or else the menu, which gives the focus back to its button. */
function closeOne() {
	const menu = menus.find(({ open }) => open);
	if (picked)
		closeCard();
	else if (ends)
		toggleMeasure();
	else if (menu) {
		menu.open = false;
		menu.firstElementChild.focus();
	}
}

/** The thing that is seen at a place of the picture; without a place, in its middle. */
function pick(at = [0.5, 0.5]) {
	if (about)
		engine.postMessage({ type: 'pick', at, measures: !!ends });
}

function measure(at) {
	if (at)
		ends = ends.length > 1 ? [at] : [...ends, at];
	sayMeasured(ends);
	redraw();
}

function toggleMeasure() {
	ends = ends ? null : [];
	closeCard();
	measure();
}

/** A plant that was looked for. */
function choose({ said, ...plant }) {
	picked = plant;
	showPicked(picked, about.origin);
	showPlant(said, plant.number, about.columns);
	// once it is in view it is as one that was clicked
	engine.postMessage({ type: 'mark', plant });
	orbitPicked();
}

/** Looks at what was clicked, from where a plant fills much of the picture. */
function orbitPicked() {
	const { foot, at, height_m: height = 0 } = picked, target = foot ? [...foot] : at;
	target[2] += height / 2;
	camera.approach(target, height * 2);
	set('mode', 'orbit');
	canvas.focus();
}

function save(name, blob) {
	const href = URL.createObjectURL(blob);
	Object.assign(document.createElement('a'), { download: name, href }).click();
	setTimeout(() => URL.revokeObjectURL(href), 1000);
}

function savePicture() {
	if (canvas.dataset.complete !== 'true' || drawn.more)
		say(t('The picture is saved once all of it is here'));
	saving = ['still-width', 'still-height'].map((id) => Math.max(16, Math.min(8192, Math.round($(id).value) || 0)));
	engine.postMessage({ type: 'save', compares: $('caption').checked });
	redraw();
}

/** A caption: the scene and its sun, the camera, and the picture's error: measured, else as it is expected. */
function caption({ vertices, predicted_q: q }, error) {
	const { eye, target } = camera.view();
	const sun = hasPlace() ? t('; sun of {}, {}', $('date').value, $('sun-text').textContent) : '';
	const date = about.date ? t('; data of {}', about.date) : '';
	return [`${about.title ?? settings.scene}${date}${sun}`,
		t('Eye {}; target {}', placeText(eye, about.origin), placeText(target, about.origin)),
		t('Pack {}; {} vertices', about.id.slice(0, 8), number(vertices))
			+ (error ? errorText(error) : q ? t('; expected agreement with full detail (Q) {}', fixed(q, 3)) : '')];
}

async function copyLink() {
	writeAddress();
	// only pages of this machine or by TLS may write to the clipboard
	const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
	say(copied ? t('Link copied') : t("The link is this page's address: {}", location.href));
}

function showWhole() {
	if (about)
		lookAt(about.bounds, true);
}

// ---- Views and tours ----

function showViews() {
	const look = ({ eye, target }) => {
		set('mode', 'orbit');
		camera.look(eye, target);
		moved();
	};
	showChoices($('view-list'), settings.views, ({ name }) => name, look,
		(view) => setViews(settings.views.filter((other) => other !== view)));
	$('tour').disabled = $('script').disabled = !settings.views.length;
}

/** The browser keeps them, and the address has them, so that a link shows them, too. */
function setViews(views) {
	settings.views = views;
	if (!token)
		keep(viewsName(), JSON.stringify(views));
	showViews();
	writeAddress();
}

function addView() {
	const { eye, target } = camera.view(), { views } = settings;
	const names = views.map(({ name }) => name), free = views.concat(null).map((_, i) => t('View {}', i + 1));
	setViews([...views, { name: free.find((name) => !names.includes(name)), eye, target }]);
}

/** Whether a tour moves the camera. */
function tours(now) {
	if (toured === null)
		return false;
	const view = tourAt(settings.views, Math.max(0, now - toured) / 1000, matchMedia('(prefers-reduced-motion)').matches);
	if (!view)
		return toggleTour(false);
	const { eye } = camera.view(), way = Math.hypot(...eye.map((v, i) => v - view.eye[i]));
	if (way > 1e-4)
		camera.look(view.eye, view.target);
	else
		redraw();                        // where it rests the picture gets its samples
	return way > 1e-4;
}

function toggleTour(on = toured === null) {
	toured = on && settings.views.length ? performance.now() : null;
	$('tour').setAttribute('aria-pressed', toured !== null);
	if (on)
		set('mode', 'orbit');
	return false;
}

const shortcuts = {
	c: () => showKinds(!settings.kind), p: savePicture, i: () => pick(), l: copyLink, h: showWhole, f: toggleFull,
	m: toggleMeasure, t: () => toggleTour(),
};

function toggleFull() {
	(document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()).catch(() => {});
}

/** Reads the address: at first, and when a link is pasted over it. `names`: of scenes; before they are
 * known the scene that the address names is taken on trust, so that its picture comes sooner. */
function goToAddress(names) {
	const { scene: before, beside } = settings;
	readAddress();
	const named = settings.scene, known = !names || names.includes(named) || token;
	if (!known)
		[settings.scene] = names;
	$('scene').value = settings.scene;
	if (settings.scene !== before)
		open(settings.scene);
	else if (settings.beside !== beside)
		setBeside(settings.beside);
	else if (view && about)
		camera.look(...view);
	showSettings();
	if (!known && named)
		faults.push(t('This server has no scene {}; this is {}.', named, settings.scene));
	sayFaults();
}

async function start() {
	engine = await startEngine();
	engine.onmessage = async ({ data }) => {
		try {
			await heard[data.type](data);
		} catch (error) {
			say(error.message, true);
		}
	};
	goToAddress(null);
	const here = await scenesHere().catch(() => null), names = here?.map(({ name }) => name);
	scenes = here ?? [];
	if (!here)
		return say(t('The server does not answer; reload the page to try again.'), true);
	if (token && !names.includes(settings.scene))
		names.push(settings.scene);
	if (!names.length)
		return say(t('This server has no scenes.'), true);
	$('scene').replaceChildren(...names.map((name) => new Option(name)));
	showScenes();
	addEventListener('hashchange', () => {
		say('');
		goToAddress(names);
	});
	goToAddress(names);
}

translatePage();
camera.listen(canvas, () => {
	toggleTour(false);
	moved();
}, pick);
addEventListener('resize', resized);
resized();
addEventListener('keydown', (event) => {
	const key = event.key.toLowerCase(), typing = event.target.matches('select, input:not([type=checkbox])');
	if (withModifier(event) || (typing && key !== 'escape'))
		return;
	if (key === 'escape')
		closeOne();
	else if (shortcuts[key] && !cameraKeys.has(key))
		shortcuts[key]();
});
document.addEventListener('fullscreenchange', () => $('full').setAttribute('aria-pressed', !!document.fullscreenElement));
$('full').hidden = !document.fullscreenEnabled;
$('full').onclick = toggleFull;
for (const menu of menus)
	menu.ontoggle = showOpened;
for (const button of modes)
	button.onclick = () => set('mode', button.dataset.mode);
for (const box of layers)
	box.onchange = () => set('hide', layers.filter(({ checked }) => !checked).map(({ dataset }) => dataset.layer));
$('season').onchange = $('scene').onchange = ({ target: { value: name } }) => {
	$('scene').value = name;
	[view, faults, sunIsLinked, settings.views] = [null, [], false, []];
	// so that the browser's way back leads to the scene before
	clearTimeout(moved.timer);
	writeAddress();
	history.pushState(null, '', `#scene=${encodeURIComponent(name)}`);
	open(name);
};
$('vertices').oninput = () => {
	const { value, min } = $('vertices');
	set('vertices', value === min ? 0 : Math.round(2 ** value));
};
$('bytes').oninput = () => {
	const { value, max } = $('bytes');
	set('bytes', value === max ? -1 : Math.round(2 ** value));
};
$('kind').onchange = () => showKinds($('kind').checked);
$('sun').oninput = $('date').onchange = setSun;
$('shadows').onchange = () => set('shadows', $('shadows').value);
$('whole').onclick = showWhole;
$('save').onclick = savePicture;
$('link').onclick = copyLink;
$('measure').onclick = toggleMeasure;
$('add-view').onclick = addView;
$('tour').onclick = () => toggleTour();
$('script').onclick = () => save(`${settings.scene}.camera.json`,
	new Blob([scriptOf(settings.views, camera.view())], { type: 'application/json' }));
$('query').oninput = () => {
	clearTimeout(choose.timer);
	choose.timer = setTimeout(() => engine.postMessage({ type: 'find', text: $('query').value.trim() }), 300);
};
$('beside').onchange = () => setBeside($('beside').value);
$('wipe').onpointerdown = ({ pointerId }) => $('wipe').setPointerCapture(pointerId);
$('wipe').onpointermove = ({ buttons, clientX }) => buttons && setWipe(clientX / innerWidth);
$('wipe').onkeydown = (event) => {
	const { wipe } = settings, back = wipe - 0.02, on = wipe + 0.02;
	const steps = { ArrowLeft: back, ArrowDown: back, ArrowRight: on, ArrowUp: on, Home: 0, End: 1 };
	if (steps[event.key] === undefined)
		return;
	event.stopPropagation();
	event.preventDefault();
	setWipe(steps[event.key]);
};
$('explain').onclick = () => engine.postMessage({ type: 'explain' });
$('card-orbit').onclick = orbitPicked;
$('card-close').onclick = closeCard;
// held, they are keys; without a pointer each press is a step
for (const button of document.querySelectorAll('[data-key]')) {
	const { dataset: { key } } = button, hold = () => {
		camera.held.add(key);
		moved();
	};
	button.onpointerdown = hold;
	button.onpointerup = button.onpointercancel = button.onpointerleave = () => camera.held.delete(key);
	button.oncontextmenu = (event) => event.preventDefault();
	button.onclick = ({ detail }) => {
		if (detail === 0)
			hold(setTimeout(() => camera.held.delete(key), 300));
	};
}
$('state').onclick = () => say('');
start().catch((error) => say(error.message, true));
// for tests and for the curious
globalThis.viewer = { camera, settings, heard, get about() { return about; }, get drawn() { return drawn; },
	get picked() { return picked; }, get budget() { return budget; } };
